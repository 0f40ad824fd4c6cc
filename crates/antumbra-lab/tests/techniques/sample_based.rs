//! `alias_free` and `sample_based` against the ray tracer, from the same receivers and with the same light points: bit
//! for bit, and against the truth.

use std::sync::atomic::AtomicBool;

use antumbra::techniques::sample_based::{SampleBased, SampleBasedParams};
use antumbra::{Casters, Frame, Mask, MeshCaster, Receivers, Recorder, Technique, TechniqueKind};
use antumbra_lab::device::LabDevice;
use antumbra_lab::gpu_scene::GpuScene;
use antumbra_lab::readback::{read_f32, read_rgba32f};
use antumbra_lab::receivers::{Layer, ReceiverImages, ReceiverPass};
use antumbra_lab::technique_run::{TechniqueChoice, create, run};
use antumbra_light::{EmissionTexture, Light, LightShape, SampleSet};
use antumbra_reference::{ReceiverPoint, SampledLight, Tracer, VisibilityOptions};
use antumbra_scene::{LoadOptions, Scene, Setup, load};
use glam::{UVec2, Vec2, Vec3};

use crate::common::{ONCE, lab};

const SIZE: UVec2 = UVec2::new(128, 72);

/// A scene as the camera sees it on the GPU, and the ray tracer's receivers at the very same places.
pub(crate) struct Same {
    setup: Setup,
    gpu_scene: GpuScene,
    images: ReceiverImages,
    tracer: Tracer,
    /// `None` for background.
    points: Vec<Option<ReceiverPoint>>,
}

impl Same {
    pub(crate) fn new(lab: &LabDevice, spec: &str, change: impl FnOnce(&mut Light)) -> Self {
        let scene = load(spec, &LoadOptions::default()).expect("a scene that is there");
        let mut setup = Setup::for_scene(&scene);
        change(&mut setup.lights[0]);
        Self::of(lab, &scene, setup)
    }

    fn of(lab: &LabDevice, scene: &Scene, setup: Setup) -> Self {
        let gpu_scene = GpuScene::upload(lab, scene);
        let images = ReceiverPass::new(lab)
            .render(lab, &gpu_scene, &setup.camera, SIZE, Layer::FirstHits)
            .expect("a scene that can be seen");
        let positions = positions_as_the_shaders_have_them(lab, &images);
        let normals = read_rgba32f(lab, &images.geometric_normal).expect("a device that works");
        let tracer = Tracer::new(scene).expect("a scene that can be traced");
        let primary = tracer.primary(&setup.camera, SIZE).points;
        let points = positions
            .into_iter()
            .zip(normals)
            .zip(primary)
            .map(|((position, n), traced)| {
                position.map(|position| {
                    let point = ReceiverPoint::new(position, Vec3::new(n[0], n[1], n[2]));
                    // A position from a depth buffer is uncertain: its distance from the surface that the tracer finds
                    // there, twice; and where that sees another surface, at an edge, what the technique allows for.
                    let allowed = (position.length() + position.distance(setup.camera.eye)) / (1 << 18) as f32;
                    let off_surface = traced
                        .filter(|traced| traced.position.distance(position) < 1e-3)
                        .map_or(allowed, |traced| 2.0 * (traced.position - position).dot(point.normal).abs());
                    ReceiverPoint { hair_m: point.hair_m.max(off_surface.min(allowed)), ..point }
                })
            })
            .collect();
        Self { setup, gpu_scene, images, tracer, points }
    }

    pub(crate) fn light(&self) -> &Light {
        &self.setup.lights[0]
    }

    pub(crate) fn casters(&self) -> Vec<MeshCaster<'_>> {
        self.gpu_scene.casters()
    }

    pub(crate) fn receivers(&self) -> Receivers<'_> {
        self.images.receivers()
    }

    pub(crate) fn pixel_count(&self) -> usize {
        self.points.len()
    }

    pub(crate) fn mask(&self, lab: &LabDevice, kind: TechniqueKind, settings: &[(&str, &str)]) -> Vec<f32> {
        let settings = settings.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
        let mut technique = create(&lab.gpu(), &TechniqueChoice { kind, settings }).expect("good settings");
        let casters = self.gpu_scene.casters();
        let run = run(lab, &mut technique, self.light(), Casters::Meshes(&casters), self.images.receivers(), &ONCE);
        let visibility = run.expect("a good frame").visibility;
        (0..self.points.len()).map(|i| visibility.at(i, 0)).collect()
    }

    /// The light's hard shadow from the same receivers.
    fn traced_hard(&self) -> Vec<f32> {
        let light = self.light();
        let (frame, center) = (light.frame(), light.center);
        let traced = |point: &Option<ReceiverPoint>| {
            let Some(point) = point else { return 1.0 };
            let towards = if light.is_distant() { -light.axis } else { center - point.position };
            if !light.reaches(&frame, point.position) || point.normal.dot(towards) <= 0.0 {
                return 0.0;
            }
            let occluded = if light.is_distant() {
                self.tracer.occluded_towards(point.origin(), towards)
            } else {
                self.tracer.occluded(point.origin(), center)
            };
            if occluded { 0.0 } else { 1.0 }
        };
        self.points.iter().map(traced).collect()
    }

    /// Against the truth from these receivers, over pixels that face the light.
    fn rmse(&self, ours: &[f32]) -> f64 {
        self.truth(&VisibilityOptions::default()).rmse(ours)
    }

    /// Visibility from these receivers by other light points at each.
    pub(crate) fn truth(&self, options: &VisibilityOptions) -> Truth {
        let seen: Vec<usize> = (0..self.points.len()).filter(|i| self.points[*i].is_some()).collect();
        let points: Vec<ReceiverPoint> = seen.iter().filter_map(|i| self.points[*i]).collect();
        let image = self
            .tracer
            .visibility_at(&points, self.light(), options, &|_| {}, &AtomicBool::new(false))
            .expect("a good light");
        let judged = seen.into_iter().zip(image.values).zip(image.faces_light_center);
        Truth { judged: judged.filter_map(|((i, v), faces)| faces.then_some((i, v[0]))).collect() }
    }

    /// Every pixel's bits, by the order of the sample set: words of 64, as [`Tracer::visible_mask`] has them.
    fn bits(&self, lab: &LabDevice, params: &SampleBasedParams) -> Vec<Vec<u64>> {
        let gpu = lab.gpu();
        let mut technique = SampleBased::new(&gpu).expect("a device with WebGPU's limits");
        let mask = Mask::new(&lab.device, SIZE);
        let casters = self.gpu_scene.casters();
        let frame = Frame {
            light: self.light(),
            casters: Casters::Meshes(&casters),
            receivers: self.images.receivers(),
            mask: &mask,
        };
        technique.prepare(&gpu, &frame, &SampleBasedParams { keep_bits: true, ..*params }).expect("a good frame");
        let mut encoder = lab.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        technique.record(&mut Recorder::new(&mut encoder, None), &frame);
        let source = technique.bits().expect("bits are kept");
        let copy = lab.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("bits"),
            size: source.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(source, 0, &copy, 0, source.size());
        lab.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |_| {});
        lab.check().expect("no error");
        let mapped = copy.get_mapped_range(..).expect("mapped");
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&mapped);
        let order = technique.bit_order();
        let masks = read_f32(lab, mask.texture()).expect("a device that works");
        words
            .chunks_exact(order.len().div_ceil(32))
            .zip(masks)
            .map(|(pixel, visibility)| {
                let mut bits = vec![0u64; order.len().div_ceil(64)];
                for (slot, &i) in order.iter().enumerate() {
                    // A mask of 0 was written for pixels that are in no list.
                    let bit = u64::from(pixel[slot / 32] >> (slot % 32) & 1) * u64::from(visibility > 0.0);
                    bits[i as usize / 64] |= bit << (i % 64);
                }
                bits
            })
            .collect()
    }

    /// Bits that differ from the ray tracer's, and all bits, over pixels with geometry.
    fn differing_bits(&self, lab: &LabDevice, params: &SampleBasedParams) -> (u64, u64) {
        let options = VisibilityOptions {
            samples: params.samples,
            set: params.sample_set,
            seed: params.seed,
            same_set_for_all_pixels: true,
        };
        let light = SampledLight::new(self.light(), &options).expect("a good light");
        let ours = self.bits(lab, params);
        let (mut differing, mut all) = (0, 0);
        for (i, point) in self.points.iter().enumerate() {
            let Some(point) = point else { continue };
            // A dark pixel under a light with a hole may have bits in the hole: `bits` cannot tell it from one that is
            // in no list.
            if self.light().emission.is_some() && ours[i].iter().all(|word| *word == 0) {
                continue;
            }
            let traced = self.tracer.visible_mask(&light, i, point);
            differing += traced.iter().zip(&ours[i]).map(|(a, b)| u64::from((a ^ b).count_ones())).sum::<u64>();
            all += u64::from(light.points_per_receiver());
        }
        (differing, all)
    }
}

/// Pixels that face the light, with what they see of it.
pub(crate) struct Truth {
    judged: Vec<(usize, f32)>,
}

impl Truth {
    pub(crate) fn rmse(&self, ours: &[f32]) -> f64 {
        let square = |(i, truth): &(usize, f32)| f64::from(ours[*i] - truth).powi(2);
        (self.judged.iter().map(square).sum::<f64>() / self.judged.len() as f64).sqrt()
    }
}

/// World positions by pixel in single precision, operation by operation as `wesl/frame.wesl` has them; `None` for
/// background.
fn positions_as_the_shaders_have_them(lab: &LabDevice, images: &ReceiverImages) -> Vec<Option<Vec3>> {
    let depths = read_f32(lab, &images.depth).expect("a device that works");
    let view_from_clip = images.clip_from_view.as_dmat4().inverse().as_mat4();
    let world_from_view = images.view_from_world.as_dmat4().inverse().as_mat4();
    let position = |(i, depth): (u32, f32)| {
        let pixel = UVec2::new(i % SIZE.x, i / SIZE.x).as_vec2();
        let ndc = (pixel + 0.5) / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        let view = view_from_clip * ndc.extend(depth).extend(1.0);
        (depth > 0.0).then(|| (world_from_view * (view.truncate() / view.w).extend(1.0)).truncate())
    };
    (0..).zip(depths).map(position).collect()
}

/// What to do to a scene's light.
type Change<'a> = &'a dyn Fn(&mut Light);

#[test]
fn alias_free_is_the_traced_hard_shadow() {
    let Some(lab) = lab() else { return };
    // Pixels that may differ, of 9216: those within the depth buffer's rounding of an edge. In the lawn blades are
    // thinner than pixels, and so is what rounding can do.
    for (scene, most) in [
        ("overlap", 0),
        ("lantern-wall", 0),
        ("window", 0),
        ("columns", 0),
        ("tilted-planes", 0),
        ("spheres", 0),
        ("knot?triangles=20000", 0),
        ("hairball", 0),
        ("fence-geometry", 1),
        ("shanty", 0),
        ("ring-in-grass", 8),
    ] {
        let same = Same::new(lab, &format!("builtin:{scene}"), |_| {});
        let ours = same.mask(lab, TechniqueKind::AliasFree, &[]);
        let traced = same.traced_hard();
        let differing = ours.iter().zip(&traced).filter(|(a, b)| a != b).count();
        println!("{scene}: {differing} of {} pixels differ", ours.len());
        assert!(differing <= most, "{scene}: {differing} pixels differ");
    }
}

#[test]
fn sample_based_has_the_tracer_s_bits() {
    let Some(lab) = lab() else { return };
    for (scene, most) in [
        ("overlap", 1e-4),
        ("lantern-wall", 1e-4),
        ("stacked-panels", 1e-4),
        ("window", 1e-4),
        ("columns", 1e-4),
        ("spheres", 1e-4),
        ("knot?triangles=20000", 1e-4),
        // Wires and hairs thinner than a pixel: their depth is extrapolated, and moves a receiver by micrometres.
        ("hairball", 3e-4),
        ("fence-geometry", 6e-4),
    ] {
        let same = Same::new(lab, &format!("builtin:{scene}"), |_| {});
        let params = SampleBasedParams { sample_set: SampleSet::Sobol, ..SampleBasedParams::default() };
        let (differing, all) = same.differing_bits(lab, &params);
        let part = differing as f64 / all as f64;
        println!("{scene}: {differing} of {all} bits differ: {part:.1e}");
        assert!(part <= most, "{scene}: {part} of the bits differ");
    }
}

#[test]
fn every_shape_of_light_has_the_tracer_s_bits() {
    let Some(lab) = lab() else { return };
    let ring = |light: &Light| {
        let frame = light.frame();
        let at = |i: u32| {
            let angle = i as f32 * std::f32::consts::TAU / 48.0;
            frame.center + 0.4 * (frame.right * angle.cos() + frame.up * angle.sin())
        };
        LightShape::Points { positions_m: (0..48).map(at).collect() }
    };
    let annulus = || {
        let luminance = |i: u32| {
            let from_middle = (UVec2::new(i % 16, i / 16).as_vec2() - 7.5).length();
            f32::from(u8::from((3.0..8.0).contains(&from_middle)))
        };
        EmissionTexture { width: 16, height: 16, luminance: (0..256).map(luminance).collect() }
    };
    let lights: [(&str, Change<'_>); 6] = [
        ("disk", &|light| light.shape = LightShape::Disk { radius_m: 0.4 }),
        ("sphere", &|light| light.shape = LightShape::Sphere { radius_m: 0.4 }),
        ("ellipsoid", &|light| light.shape = LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) }),
        ("sun", &|light| light.shape = LightShape::Sun { angular_diameter_rad: 0.1 }),
        ("ring of points", &|light| light.shape = ring(light)),
        ("annulus", &|light| {
            light.shape = LightShape::Rectangle { size_m: Vec2::splat(0.8) };
            light.emission = Some(annulus());
        }),
    ];
    for (name, change) in lights {
        let same = Same::new(lab, "builtin:overlap", change);
        let params = SampleBasedParams { samples: 200, sample_set: SampleSet::Sobol, ..SampleBasedParams::default() };
        let (differing, all) = same.differing_bits(lab, &params);
        println!("{name}: {differing} of {all} bits differ");
        assert!(differing as f64 <= 1e-4 * all as f64, "{name}: {differing} of {all} bits differ");
        // What the bits add up to, weights included, against the truth's own points.
        let ours = same.mask(lab, TechniqueKind::SampleBased, &[("samples", "1024"), ("sample_set", "sobol")]);
        let rmse = same.rmse(&ours);
        println!("{name}, 1024: rmse {rmse:.4}");
        assert!(rmse <= 0.008, "{name}: rmse {rmse}");
    }
}

#[test]
fn more_points_come_closer_to_the_truth() {
    let Some(lab) = lab() else { return };
    for scene in ["columns", "window", "stacked-panels", "spheres", "shanty"] {
        let same = Same::new(lab, &format!("builtin:{scene}"), |_| {});
        for (samples, bound) in [("64", 0.03), ("256", 0.010), ("1024", 0.006)] {
            let ours = same.mask(lab, TechniqueKind::SampleBased, &[("samples", samples), ("sample_set", "sobol")]);
            let rmse = same.rmse(&ours);
            println!("{scene}, {samples}: rmse {rmse:.4}");
            assert!(rmse <= bound, "{scene}, {samples}: rmse {rmse}");
        }
    }
}

#[test]
fn the_table_is_close_to_the_tests() {
    let Some(lab) = lab() else { return };
    let ellipsoid = |light: &mut Light| light.shape = LightShape::Ellipsoid { radii_m: Vec3::new(0.5, 0.2, 0.3) };
    let none = |_: &mut Light| {};
    let cases: [(&str, Change<'_>); 3] = [("columns", &none), ("overlap", &none), ("overlap", &ellipsoid)];
    for (scene, change) in cases {
        let same = Same::new(lab, &format!("builtin:{scene}"), change);
        let exact = same.mask(lab, TechniqueKind::SampleBased, &[]);
        let table = same.mask(lab, TechniqueKind::SampleBased, &[("evaluation", "lookup")]);
        let mean = exact.iter().zip(&table).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / exact.len() as f64;
        println!("{scene}: mean |ΔV| {mean:.5}");
        assert!(mean <= 0.004, "{scene}: mean |ΔV| {mean}");
    }
}

#[test]
fn no_switch_changes_a_bit() {
    let Some(lab) = lab() else { return };
    for scene in ["columns", "knot?triangles=10000"] {
        let same = Same::new(lab, &format!("builtin:{scene}"), |_| {});
        let on = SampleBasedParams { samples: 64, ..SampleBasedParams::default() };
        let bits = same.bits(lab, &on);
        for off in [
            SampleBasedParams { stop_when_occluded: false, ..on },
            SampleBasedParams { penumbra_only: false, ..on },
            SampleBasedParams { cut_by_plane: false, ..on },
            SampleBasedParams { cull_facing: false, ..on },
        ] {
            assert!(bits == same.bits(lab, &off), "{scene}: {off:?}");
        }
    }
}
