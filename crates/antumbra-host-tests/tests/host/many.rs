//! Many moving lamps among many moving casters: CPU time, memory, and no creation of resources.

use std::time::{Duration, Instant};

use antumbra::light::{Light, LightShape};
use antumbra::{AnyShadow, Frame, Mask, MaskChannels, Recorder, TechniqueKind};
use antumbra_host_tests::device::Device;
use antumbra_host_tests::host::{HostCasters, kind_of, small_shadow};
use antumbra_host_tests::raster::Picture;
use antumbra_host_tests::scene::{Camera, Mesh, Object, Scene};
use glam::{Mat4, UVec2, Vec3};

/// A ground and a hundred boxes above it.
pub(crate) fn crowd() -> Scene {
    let mut scene = Scene { objects: vec![Object::of(Mesh::ground(10.0))] };
    let unit = Mesh::cuboid(Vec3::splat(-0.15), Vec3::splat(0.15));
    scene.objects.extend((0..100).map(|i| Object { mesh: unit.clone(), world_from_object: place(i, 0) }));
    scene
}

/// Matrix of a box in a frame.
pub(crate) fn place(i: usize, frame: u32) -> Mat4 {
    let turn = frame as f32 * 0.05 + i as f32;
    let middle = Vec3::new((i % 10) as f32 - 4.5, 0.5, (i / 10) as f32 - 4.5);
    Mat4::from_translation(middle + 0.3 * Vec3::new(turn.cos(), 0.5 * turn.sin(), turn.sin()))
        * Mat4::from_rotation_y(turn)
}

/// A lamp among the boxes in a frame.
fn lamp(i: usize, frame: u32) -> Light {
    let turn = frame as f32 * 0.03 + 0.7 * i as f32;
    let middle = Vec3::new((i % 8) as f32 - 3.5, 1.6, 2.0 * (i / 8) as f32 - 3.0);
    let center = middle + 0.2 * Vec3::new(turn.sin(), turn.cos(), turn.cos());
    Light::new(LightShape::Sphere { radius_m: 0.05 }, center, center - Vec3::Y)
}

struct Crowd<'a> {
    device: &'a Device,
    casters: HostCasters,
    picture: Picture,
    shadows: Vec<(AnyShadow, Mask)>,
}

impl<'a> Crowd<'a> {
    fn new(device: &'a Device, size_px: UVec2, shadows: Vec<AnyShadow>) -> Self {
        let scene = crowd();
        let picture = Picture::draw(device, &scene, &Camera { size_px, ..Camera::base() });
        let mask = || Mask::with_channels(device.wgpu(), size_px, MaskChannels::One);
        let shadows = shadows.into_iter().map(|shadow| (shadow, mask())).collect();
        Self { device, casters: HostCasters::new(device, &scene), picture, shadows }
    }

    /// Draws one frame of all lamps in one submission. Returns its CPU time.
    fn draw(&mut self, frame: u32) -> Duration {
        for i in 0..100 {
            self.casters.set_matrix(i + 1, place(i, frame));
        }
        self.casters.update(self.device);
        let mut encoder = self.device.encoder();
        let began = Instant::now();
        for (i, (shadow, mask)) in self.shadows.iter_mut().enumerate() {
            let light = lamp(i, frame);
            let frame = Frame { light: &light, casters: self.casters.all(), receivers: self.picture.receivers(), mask };
            shadow.prepare(&frame).expect("a good frame").record(&mut Recorder::new(&mut encoder, None));
        }
        let took = began.elapsed();
        self.device.queue().submit([encoder.finish()]);
        self.device.wait();
        took
    }

    fn masks(&self) -> Vec<Vec<f32>> {
        self.shadows.iter().map(|(_, mask)| self.device.read_layer(mask.texture(), 0)).collect()
    }
}

/// With shared maps each light draws its map before reading it, so the masks equal those of lights that own maps.
#[test]
fn lights_that_share_maps_have_the_masks_of_those_that_own_them() {
    let Some(device) = Device::shared() else { return };
    for name in ["hard", "pcss", "essm", "multi_layer", "multi_view", "reprojection", "reprojection_layered"] {
        let size_px = UVec2::new(48, 27);
        let draw = |budget: u64| {
            device.gpu.set_map_budget(budget);
            let shadows = (0..8).map(|_| small_shadow(device, kind_of(name))).collect();
            let mut crowd = Crowd::new(device, size_px, shadows);
            (0..3).for_each(|frame| _ = crowd.draw(frame));
            let memory = device.gpu.memory_bytes();
            (crowd.masks(), memory)
        };
        let (owned, of_owned) = draw(u64::MAX);
        let (shared, of_shared) = draw(0);
        assert!(owned == shared, "{name}");
        println!("{name}: {of_owned:?}, {of_shared:?}");
        assert!(of_owned.own_maps > 0 && of_shared.own_maps == 0, "{name}: {of_owned:?}, {of_shared:?}");
        // Eight lamps of several parts each share the textures of one part.
        assert!(of_shared.shared - of_owned.shared <= of_owned.own_maps / 8, "{name}: {of_owned:?}, {of_shared:?}");
        // A budget in between is respected.
        let (some, of_some) = draw(of_owned.own_maps / 2);
        assert!(some == owned, "{name}");
        assert!((1..=of_owned.own_maps / 2).contains(&of_some.own_maps), "{name}: {of_some:?}");
    }
}

/// Thirty-two lamps at default settings need no more memory than promised for the techniques of one map. Memory of all is printed.
#[test]
fn thirty_two_lamps_hold_to_their_memory() {
    const PROMISED: [&str; 5] = ["pcss", "smrt", "essm", "vssm", "cssm"];
    for name in ["hard", "pcss", "smrt", "essm", "vssm", "cssm", "multi_layer"] {
        let device = Device::idle();
        let kind = kind_of(name);
        let shadows = (0..32).map(|_| kind.create(&device.gpu).expect("any device")).collect();
        let mut crowd = Crowd::new(&device, UVec2::new(32, 18), shadows);
        let mut times: Vec<Duration> = (0..16).map(|frame| crowd.draw(frame)).collect();
        times.drain(..5);
        times.sort();
        let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
        let memory = device.gpu.memory_bytes();
        let all: u64 = crowd.shadows.iter().map(|(shadow, _)| shadow.memory_bytes()).sum();
        println!(
            "{name}: {:.0} MiB of the lights, {:.0} shared, {:.2} ms to prepare and record",
            mib(all),
            mib(memory.shared),
            times[times.len() / 2].as_secs_f64() * 1e3
        );
        assert!(all > 0 && memory.own_maps <= 256 << 20, "{name}: {memory:?}");
        if PROMISED.contains(&name) {
            assert!(all + memory.shared <= 400 << 20, "{name}: {all} bytes, {memory:?}");
        }
    }
}

/// Number of lamps, and settings of their techniques in addition to the small ones.
type Lamps = (usize, Vec<(&'static str, &'static str)>);

/// Thirty-two lamps, and some with resources whose size depends on the positions of lamps and casters.
fn steady_lamps(kind: TechniqueKind) -> Vec<Lamps> {
    let has = |key: &str| kind.param_specs().iter().any(|spec| spec.key == key);
    // Tiles of tables are 32 to 64 texels wide.
    let mut all = vec![(32, if has("search_scales") { vec![("map_size", "512")] } else { Vec::new() })];
    all.extend(has("scan").then(|| (4, vec![("map_size", "1024"), ("scan", "doubling")])));
    all.extend(has("sub").then(|| (4, vec![("sub", "true")])));
    all
}

/// After ten frames, lamps among 101 casters, which all move except the ground, create no wgpu resource.
fn moving_lamps(kinds: &[TechniqueKind]) {
    let device = Device::idle();
    for kind in kinds {
        for (lamps, settings) in steady_lamps(*kind) {
            let shadow = |_| {
                let mut shadow = small_shadow(&device, *kind);
                settings.iter().for_each(|(key, value)| shadow.set(key, value).expect("in range"));
                shadow
            };
            let mut crowd = Crowd::new(&device, UVec2::new(16, 9), (0..lamps).map(shadow).collect());
            (0..10).for_each(|frame| _ = crowd.draw(frame));
            let before = device.gpu.objects_created();
            (10..60).for_each(|frame| _ = crowd.draw(frame));
            assert_eq!(before, device.gpu.objects_created(), "{lamps} lamps, {kind}, {settings:?}");
        }
    }
}

/// Split into as many tests as small machines have cores: each takes about ten seconds.
mod moving_lamps_make_nothing {
    use super::TechniqueKind;

    fn part(i: usize, parts: usize) -> Vec<TechniqueKind> {
        TechniqueKind::ALL.iter().copied().skip(i).step_by(parts).collect()
    }

    #[test]
    fn first() {
        super::moving_lamps(&part(0, 4));
    }

    #[test]
    fn second() {
        super::moving_lamps(&part(1, 4));
    }

    #[test]
    fn third() {
        super::moving_lamps(&part(2, 4));
    }

    #[test]
    fn fourth() {
        super::moving_lamps(&part(3, 4));
    }
}

/// Prints the resources that 32 lamps at default settings create in frames 10 to 60, and their memory, by technique.
#[test]
#[ignore = "prints figures, and takes minutes"]
fn what_thirty_two_lamps_create_and_take() {
    for kind in TechniqueKind::ALL {
        let device = Device::idle();
        let shadows = (0..32).map(|_| kind.create(&device.gpu).expect("any device")).collect();
        let mut crowd = Crowd::new(&device, UVec2::new(32, 18), shadows);
        (0..10).for_each(|frame| _ = crowd.draw(frame));
        let before = device.gpu.objects_created().total();
        (10..60).for_each(|frame| _ = crowd.draw(frame));
        let created = device.gpu.objects_created().total() - before;
        let retained: u64 = crowd.shadows.iter().map(|(shadow, _)| shadow.memory_bytes()).sum();
        let [retained, shared] = [retained, device.gpu.memory_bytes().shared].map(|bytes| bytes >> 20);
        println!("{kind}: {created} objects, {retained} MiB retained, {shared} MiB shared");
    }
}
