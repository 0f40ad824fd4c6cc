//! Memory plans: the planned memory of a light equals that of the frame drawn, to the byte.

use antumbra::light::{Light, LightShape};
use antumbra::{AnyShadow, Frame, Gpu, Mask, MaskChannels, MemoryBytes, MemoryPlan, Recorder, TechniqueKind};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, kind_of};
use antumbra_host_tests::raster::Picture;
use antumbra_host_tests::scene::{Camera, Scene, base_light, base_light_of};
use glam::{UVec2, Vec3};

/// A panel, a lamp among its receivers, and a sun over kilometres.
fn lights() -> [Light; 3] {
    let lamp = base_light_of(LightShape::Sphere { radius_m: 0.1 });
    [
        base_light(),
        Light { center: Vec3::new(-0.6, 0.9, 0.4), ..lamp },
        base_light_of(LightShape::Sun { angular_diameter_rad: 0.02 }),
    ]
}

/// Size of frame and map.
#[derive(Clone, Copy)]
enum Size {
    /// The technique's default map size.
    Own,
    Small,
}

impl Size {
    /// Returns a frame's size in pixels, and the technique's settings.
    fn of(self, kind: TechniqueKind) -> (UVec2, Vec<(&'static str, &'static str)>) {
        let has = |key: &str| kind.param_specs().iter().any(|spec| spec.key == key);
        let small = [("map_size", "128"), ("view_size", "64"), ("samples", "8"), ("sub", "true")];
        match self {
            Self::Own => (UVec2::new(96, 54), Vec::new()),
            Self::Small => (UVec2::new(40, 24), small.into_iter().filter(|(key, _)| has(key)).collect()),
        }
    }
}

/// A mask format that requires conversion.
const CONVERTED: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Pairs that cover each size and each mask format once; then the remaining pairs.
const PAIRS: [(Size, wgpu::TextureFormat); 2] = [(Size::Own, Mask::FORMAT), (Size::Small, CONVERTED)];
const OTHER_PAIRS: [(Size, wgpu::TextureFormat); 2] = [(Size::Own, CONVERTED), (Size::Small, Mask::FORMAT)];

fn shadow_of(gpu: &Gpu, kind: TechniqueKind, settings: &[(&str, &str)]) -> AnyShadow {
    let mut shadow = kind.create(gpu).expect("any device");
    settings.iter().for_each(|(key, value)| shadow.set(key, value).expect("in range"));
    shadow
}

/// Memory that a light retains, and memory that all lights share.
type Taken = (u64, MemoryBytes);

/// Prepares and records one frame. Returns its memory.
fn taken(shadow: &mut AnyShadow, gpu: &Gpu, frame: &Frame<'_>, encoder: &mut wgpu::CommandEncoder) -> Taken {
    shadow.prepare(frame).expect("a good frame").record(&mut Recorder::new(encoder, None));
    (shadow.memory_bytes(), gpu.memory_bytes())
}

/// For every technique, three lights, sizes and formats, the plan creates nothing on the device and has the numbers of the
/// frame drawn. Reported memory omits next to nothing of the allocated memory.
fn plans_are_kept(device: &Device, kinds: &[TechniqueKind], pairs: &[(Size, wgpu::TextureFormat)]) {
    /// Maximum of unreported memory: uniforms and placeholder textures of one texel, bytes for all views into which a light is split.
    const MAX_LEFT_OUT: u64 = 128 << 10;
    for kind in kinds {
        // One library handle for each technique: its lights share compiled programs, and what another technique shares is not counted.
        let gpu = Gpu::new(device.wgpu(), device.queue());
        for (size, format) in pairs {
            let (size_px, settings) = size.of(*kind);
            for light in lights() {
                let half_m = if light.is_distant() { 2500.0 } else { 10.0 };
                let scene = Scene::base(half_m);
                let picture = Picture::draw(device, &scene, &Camera { size_px, ..Camera::base() });
                let casters = HostCasters::for_gpu(device, &gpu, &scene);
                let what = format!("{kind}, {size_px}, {format:?}, {:?}", light.shape);
                let mask = Mask::with_format(device.wgpu(), size_px, MaskChannels::One, *format);
                let frame =
                    Frame { light: &light, casters: casters.all(), receivers: picture.receivers(), mask: &mask };
                let mut encoder = device.encoder();

                let before = gpu.objects_created();
                let plan = MemoryPlan::new(&gpu);
                let mut planned_shadow = shadow_of(plan.gpu(), *kind, &settings);
                let planned = taken(&mut planned_shadow, plan.gpu(), &frame, &mut encoder);
                assert_eq!(gpu.objects_created(), before, "{what}: the plan creates");

                let mut shadow = shadow_of(&gpu, *kind, &settings);
                let real = taken(&mut shadow, &gpu, &frame, &mut encoder);
                device.queue().submit([encoder.finish()]);
                device.wait();
                assert_eq!(planned, real, "{what}");

                let allocated: u64 = plan.resources().iter().map(|resource| resource.bytes).sum();
                let reported = planned.0 + planned.1.shared;
                println!("{what}: {} bytes retained, {} shared, {allocated} in all", planned.0, planned.1.shared);
                assert!(reported > 0 && reported <= allocated, "{what}: {reported} of {allocated}");
                let left_out = allocated - reported;
                assert!(left_out <= MAX_LEFT_OUT, "{what}: {left_out}: {:?}", plan.resources());
            }
        }
    }
}

#[test]
fn a_light_takes_what_was_planned() {
    plans_are_kept(&Device::idle(), TechniqueKind::ALL, &PAIRS);
}

#[test]
#[ignore = "long"]
fn every_size_and_format_takes_what_was_planned() {
    plans_are_kept(&Device::idle(), TechniqueKind::ALL, &OTHER_PAIRS);
}

/// Half-resolution receivers and masks, which lights share, are planned, too.
#[test]
fn half_resolution_takes_what_was_planned() {
    let device = Device::idle();
    let size_px = UVec2::new(97, 54);
    let scene = Scene::base(10.0);
    let picture = Picture::draw(&device, &scene, &Camera { size_px, ..Camera::base() });
    for name in ["pcss", "smrt", "sample_based"] {
        for light in lights() {
            let gpu = Gpu::new(device.wgpu(), device.queue());
            let casters = HostCasters::for_gpu(&device, &gpu, &scene);
            let mask = Mask::new(device.wgpu(), size_px);
            let frame = Frame { light: &light, casters: casters.all(), receivers: picture.receivers(), mask: &mask };
            let mut encoder = device.encoder();
            let mut of = |gpu: &Gpu, is_half: bool| {
                let mut shadow = shadow_of(gpu, kind_of(name), &[]);
                shadow.set_half_resolution(is_half);
                let taken = taken(&mut shadow, gpu, &frame, &mut encoder);
                // Shared resources are freed with the last light, so the state is kept.
                (taken, shadow)
            };
            let [full_plan, plan] = [(); 2].map(|()| MemoryPlan::new(&gpu));
            let (planned_full, _full) = of(full_plan.gpu(), false);
            let (planned, _planned) = of(plan.gpu(), true);
            let (real, _real) = of(&gpu, true);
            assert_eq!(planned, real, "{name}, {:?}", light.shape);
            let label = "antumbra half resolution";
            let half = plan.resources().into_iter().find(|found| found.label == label).expect("planned");
            // Depth, normals, mask.
            assert_eq!((half.count, half.bytes), (3, (4 + 16 + 4) * 49 * 27), "{name}");
            assert!(full_plan.resources().iter().all(|found| found.label != label), "{name}: {planned_full:?}");
        }
    }
}

/// Plans also match on the machine's device, with its limits, features and driver faults.
#[test]
fn a_light_takes_what_was_planned_on_the_machine_s_own_device() {
    let Some(device) = Device::shared() else { return };
    plans_are_kept(device, &["pcss", "essm", "multi_layer"].map(kind_of), &[PAIRS, OTHER_PAIRS].concat());
}

/// Lights share memory and divide the budget in a plan as they do when drawn.
#[test]
fn many_lights_take_what_was_planned() {
    let device = Device::idle();
    let scene = Scene::base(10.0);
    let camera = Camera { size_px: UVec2::new(32, 18), ..Camera::base() };
    let picture = Picture::draw(&device, &scene, &camera);
    let casters = HostCasters::new(&device, &scene);
    device.gpu.set_map_budget(40 << 20);
    for name in ["pcss", "essm"] {
        let lights: Vec<Light> =
            (0..6).map(|i| Light { center: Vec3::new(i as f32 - 2.5, 1.2, 0.5), ..lights()[1].clone() }).collect();
        let taken = |gpu: &Gpu, masks: &[Mask]| {
            let mut shadows: Vec<AnyShadow> = lights.iter().map(|_| shadow_of(gpu, kind_of(name), &[])).collect();
            let mut encoder = device.encoder();
            for ((shadow, light), mask) in shadows.iter_mut().zip(&lights).zip(masks) {
                let frame = Frame { light, casters: casters.all(), receivers: picture.receivers(), mask };
                taken(shadow, gpu, &frame, &mut encoder);
            }
            (shadows.iter().map(AnyShadow::memory_bytes).collect::<Vec<_>>(), gpu.memory_bytes(), shadows)
        };
        let masks =
            |gpu: &Gpu| -> Vec<Mask> { lights.iter().map(|_| Mask::new(gpu.device(), camera.size_px)).collect() };
        let plan = MemoryPlan::new(&device.gpu);
        let (planned, shared, _) = taken(plan.gpu(), &masks(plan.gpu()));
        let (real, real_shared, kept) = taken(&device.gpu, &masks(&device.gpu));
        assert_eq!((&planned, shared), (&real, real_shared), "{name}");
        assert!(
            shared.own_maps > 0 && planned.iter().any(|bytes| *bytes < planned[0]),
            "{name}: {planned:?}, {shared:?}"
        );
        // A plan beside these lights has the rest of the budget.
        let beside = MemoryPlan::new(&device.gpu);
        let (_, all, _) = taken(beside.gpu(), &masks(beside.gpu()));
        assert!(all.own_maps + real_shared.own_maps <= 40 << 20, "{name}: {all:?} beside {real_shared:?}");
        drop(kept);
    }
}

/// A plan needs no resource to exist: receivers and a mask of 4K are planned by their descriptors.
#[test]
fn what_is_planned_takes_no_memory() {
    let device = Device::idle();
    let scene = Scene::base(10.0);
    let casters = HostCasters::new(&device, &scene);
    let picture = Picture::draw(&device, &scene, &Camera { size_px: UVec2::new(16, 9), ..Camera::base() });
    let plan = MemoryPlan::new(&device.gpu);
    assert!(plan.resources().is_empty());
    let size_px = UVec2::new(3840, 2160);
    let depth_texture = plan.gpu().device().create_texture(&wgpu::TextureDescriptor {
        label: Some("planned depth"),
        size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let depth = depth_texture.create_view(&wgpu::TextureViewDescriptor::default());
    drop(depth_texture);
    let mask = Mask::new(plan.gpu().device(), size_px);
    let light = base_light();
    let mut receivers = picture.receivers().with_normals(None);
    (receivers.size_px, receivers.depth) = (size_px, &depth);
    let frame = Frame { light: &light, casters: casters.all(), receivers, mask: &mask };
    let mut shadow = shadow_of(plan.gpu(), kind_of("sample_based"), &[]);
    drop(shadow.prepare(&frame).expect("a good frame"));
    let pixels = u64::from(size_px.x) * u64::from(size_px.y);
    assert!(shadow.memory_bytes() > 12 * pixels, "{} bytes", shadow.memory_bytes());
    let of_label = |label: &str| plan.resources().iter().find(|found| found.label == label).map(|found| found.bytes);
    assert_eq!(of_label("planned depth"), Some(4 * pixels), "the view holds it");
    assert!(of_label("view-sample lists").is_some_and(|bytes| bytes >= 4 * pixels), "{:?}", plan.resources());
    drop((shadow, mask, depth));
    let left: u64 = plan.resources().iter().map(|resource| resource.bytes).sum();
    assert!(left < 64 << 10, "only what all lights share stays with the device: {:?}", plan.resources());
}
