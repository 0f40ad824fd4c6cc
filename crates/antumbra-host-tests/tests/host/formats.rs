//! Every technique draws masks of every format, for every light shape in one view and in several, without validation messages.
//!
//! wgpu's validation needs no driver, so the no-op device suffices. The long tier also uses the machine's device. The
//! library's own tests check the content of every format.

use antumbra::light::{Light, LightShape};
use antumbra::{Frame, Mask, MaskChannels, Recorder, TechniqueKind};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, small_shadow};
use antumbra_host_tests::raster::Picture;
use antumbra_host_tests::scene::{Camera, Scene, base_light_of};
use glam::{UVec2, Vec2, Vec3};

/// Small lights of every shape.
fn shapes() -> [LightShape; 6] {
    [
        LightShape::Rectangle { size_m: Vec2::new(1.2, 0.8) },
        LightShape::Disk { radius_m: 0.4 },
        LightShape::Sphere { radius_m: 0.3 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 0.1) },
        LightShape::Sun { angular_diameter_rad: 0.02 },
        LightShape::Points { positions_m: vec![Vec3::new(-3.0, 6.0, 3.0), Vec3::new(-2.8, 6.1, 3.0)] },
    ]
}

/// A light that needs one view, and one of the same shape among the receivers that is split into several.
fn lights(shape: LightShape) -> [Light; 2] {
    let several = match &shape {
        LightShape::Points { .. } => {
            let positions_m = vec![Vec3::Y, Vec3::new(0.2, 1.1, 0.0)];
            Light::new(LightShape::Points { positions_m }, Vec3::Y, Vec3::ZERO)
        }
        _ => Light { center: Vec3::new(-0.6, 0.9, 0.4), ..base_light_of(shape.clone()) },
    };
    let one = base_light_of(shape);
    let fov_rad = (!one.is_distant()).then_some(1.2);
    [Light { fov_rad, ..one }, several]
}

#[test]
fn no_message_for_any_format_of_mask_shape_of_light_and_technique() {
    says_nothing(&Device::idle());
}

#[test]
#[ignore = "long"]
fn no_message_on_the_machine_s_own_device() {
    if let Some(device) = Device::shared() {
        says_nothing(device);
    }
}

fn says_nothing(device: &Device) {
    let camera = Camera { size_px: UVec2::new(16, 9), ..Camera::base() };
    // A sun needs one view for a few metres and several for kilometres.
    let [small, large] = [1.0, 2500.0].map(|half_m| {
        let scene = Scene::base(half_m);
        (Picture::draw(device, &scene, &camera), HostCasters::new(device, &scene))
    });
    let formats = Mask::FORMATS.into_iter();
    let masks: Vec<Mask> = [MaskChannels::One, MaskChannels::Three]
        .into_iter()
        .flat_map(|channels| formats.clone().map(move |format| (channels, format)))
        .map(|(channels, format)| Mask::with_format(device.wgpu(), camera.size_px, channels, format))
        .collect();
    for kind in TechniqueKind::ALL {
        for shape in shapes() {
            for (i, light) in lights(shape).into_iter().enumerate() {
                let (picture, casters) = if light.is_distant() && i == 1 { &large } else { &small };
                let frame =
                    |mask| Frame { light: &light, casters: casters.all(), receivers: picture.receivers(), mask };
                let mut shadow = small_shadow(device, *kind);
                for mask in &masks {
                    let what = format!("{kind}, {:?}, {:?}, {light:?}", mask.texture().format(), mask.channels());
                    device.validated(&what, || {
                        let mut encoder = device.encoder();
                        let work = shadow.prepare(&frame(mask)).unwrap_or_else(|error| panic!("{error}"));
                        work.record(&mut Recorder::new(&mut encoder, None));
                        device.queue().submit([encoder.finish()]);
                    });
                }
                device.wait();
            }
        }
    }
}
