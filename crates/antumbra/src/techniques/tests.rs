//! Every technique against closed forms and properties, on small images. Against the ray tracer they are held in the
//! laboratory's tests.

use antumbra_light::{Aabb, Light, LightShape};
use glam::camera::rh::proj;
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::TechniqueKind;
use crate::contract::{DepthConvention, DepthMapCaster, Mask, MaskChannels, Receivers};
use crate::gpu::Gpu;
use crate::light_map::central_view::fit_light_view;
use crate::shadow::{Casters, Frame};
use crate::testing::snapping::{HALF_PLANE, snapped_depth};
use crate::testing::{
    Case, Mesh, RECTANGLE, SIZE, View, draw_depth, float_texture, gpu, gpu_with, half_plane_visibility, read_layer,
    read_texture, rmse, run, test_ground, texture_of, view_of,
};

type Settings = &'static [(&'static str, &'static str)];
/// Bound on the error with some settings.
type Bound = (Settings, f32);

/// A technique's bounds under a half-plane: none for lights that it does not model.
#[derive(Default)]
struct ClosedForms {
    rectangle: &'static [Bound],
    two_points: &'static [Bound],
    disk: &'static [Bound],
    sphere: &'static [Bound],
    sun: &'static [Bound],
}

const DEFAULTS: Settings = &[];
const SAMPLES: Settings = &[("samples", "256")];
const SEARCH: Settings = &[("samples", "256"), ("search_samples", "256")];
/// What the rays converge to. Means over pixels have tests of their own: a quarter of the rays, nearer to the truth.
const RAYS: Settings = &[("samples", "256"), ("smooth", "false")];

/// A new technique follows its light, and gets bounds here, or says why not.
fn closed_forms(kind: TechniqueKind) -> ClosedForms {
    match kind {
        TechniqueKind::Pcss => ClosedForms {
            rectangle: &[(SEARCH, 0.003)],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(SEARCH, 0.004)],
            sphere: &[(SEARCH, 0.004)],
            sun: &[(&[("samples", "256"), ("search_samples", "256"), ("map_size", "2048")], 0.003)],
        },
        TechniqueKind::Smrt => ClosedForms {
            // By default a quarter of the rays in the same penumbra, and means of them.
            rectangle: &[(RAYS, 0.002), (SAMPLES, 0.004)],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(RAYS, 0.003)],
            sphere: &[(RAYS, 0.003)],
            sun: &[(&[("samples", "256"), ("map_size", "2048")], 0.003)],
        },
        TechniqueKind::Bitmask => ClosedForms {
            rectangle: &[(SAMPLES, 0.003)],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(SAMPLES, 0.004)],
            sphere: &[(SAMPLES, 0.004)],
            sun: &[(&[("samples", "256"), ("map_size", "2048")], 0.003)],
        },
        TechniqueKind::Backprojection => ClosedForms {
            rectangle: &[(DEFAULTS, 0.005)],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(&[("squares", "64")], 0.004)],
            sphere: &[(&[("squares", "64")], 0.004)],
            sun: &[(&[("squares", "64"), ("map_size", "2048")], 0.003)],
        },
        TechniqueKind::MultiLayer => ClosedForms { rectangle: &[(DEFAULTS, 0.02)], ..ClosedForms::default() },
        TechniqueKind::MultiView => ClosedForms {
            rectangle: &[
                (&[("samples", "64")], 0.007),
                (&[("samples", "256"), ("sample_set", "stratified")], 0.004),
                (&[("samples", "64"), ("compare", "hardware")], 0.007),
            ],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(SAMPLES, 0.004)],
            // Views are shared by receivers on all sides of the sphere: points within it are less even than those of one disc.
            sphere: &[(SAMPLES, 0.0045)],
            sun: &[(&[("samples", "256"), ("view_size", "2048")], 0.003)],
        },
        TechniqueKind::RayTraced => ClosedForms {
            rectangle: &[(SAMPLES, 0.003)],
            two_points: &[(DEFAULTS, 0.025)],
            disk: &[(SAMPLES, 0.004)],
            sphere: &[(SAMPLES, 0.004)],
            sun: &[(SAMPLES, 0.003)],
        },
        // Without penumbra, or with one of one width.
        TechniqueKind::Hard
        | TechniqueKind::AliasFree
        | TechniqueKind::Pcf
        | TechniqueKind::Vsm
        | TechniqueKind::Lvsm
        | TechniqueKind::Evsm
        | TechniqueKind::Esm
        | TechniqueKind::Convolution
        | TechniqueKind::Moment
        // Bounded by `masks_stay_in_range_and_larger_occluders_never_brighten` and by tests of their own.
        | TechniqueKind::PcssAnisotropic
        | TechniqueKind::Essm
        | TechniqueKind::Savsm
        | TechniqueKind::Vssm
        | TechniqueKind::Cssm
        | TechniqueKind::Evssm
        | TechniqueKind::Mssm
        | TechniqueKind::Reprojection
        | TechniqueKind::ReprojectionLayered
        | TechniqueKind::SampleBased => ClosedForms::default(),
    }
}

/// Every technique's bounds under one closed form.
fn bounds(of: fn(ClosedForms) -> &'static [Bound]) -> Vec<(TechniqueKind, Settings, f32)> {
    let bounds = TechniqueKind::ALL.iter().map(|kind| (*kind, of(closed_forms(*kind))));
    bounds.flat_map(|(kind, bounds)| bounds.iter().map(move |(settings, bound)| (kind, *settings, *bound))).collect()
}

#[test]
fn half_plane_under_a_rectangle_light() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    // What the camera sees of the ground below the occluder is part of the closed form too.
    let pixels = case.ground_pixels(test_ground);
    for (kind, settings, bound) in bounds(|forms| forms.rectangle) {
        let error = rmse(&pixels, &case.run(gpu, kind, settings), |p| half_plane_visibility(p.x, 1.0));
        println!("{kind} {settings:?}: rmse {error:.4}");
        assert!(error < bound, "{kind} {settings:?}: rmse {error} against {bound}");
    }
}

/// Where hosts bring no normals: up to its edges, on either side, a sheet before a ground faces a light that stands beside it,
/// which it would not by a difference to the ground's pixels.
#[test]
fn normals_from_depth_are_flat_up_to_a_silhouette() {
    let Some(gpu) = gpu() else { return };
    const HEIGHT: f32 = 1.5;
    const HALF: f32 = 0.9;
    for x in [-8.0, 8.0] {
        let light = Light::new(LightShape::Disk { radius_m: 0.1 }, Vec3::new(x, 5.0, 0.0), Vec3::ZERO);
        let view = View::new(Vec3::new(0.0, 4.5, 4.0), Vec3::new(0.0, 0.7, 0.0));
        let world_from_clip = (view.clip_from_view * view.view_from_world).inverse();
        let ground = Mesh::horizontal(gpu, Vec2::splat(-6.0), Vec2::splat(6.0), 0.0);
        let sheet = Mesh::horizontal(gpu, Vec2::splat(-HALF), Vec2::splat(HALF), HEIGHT);
        let case = Case::new(gpu, light, view, vec![ground, sheet]);
        // Nothing casts: what is dark faces away.
        let mask = case.run_with(gpu, TechniqueKind::Hard, &[], Casters::Meshes(&[])).expect("a good frame");
        let mut judged = 0;
        for (i, visibility) in mask.iter().enumerate() {
            let pixel = Vec2::new((i as u32 % SIZE.x) as f32, (i as u32 / SIZE.x) as f32);
            let ndc = (pixel + 0.5) / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
            let [near, far] = [1.0, 0.01].map(|depth| world_from_clip.project_point3(ndc.extend(depth)));
            let p = near + (far - near) * ((near.y - HEIGHT) / (near.y - far.y));
            if p.x.abs().max(p.z.abs()) < HALF - 1e-3 {
                assert_eq!(*visibility, 1.0, "the light at {x} m, seen at {p}");
                judged += 1;
            }
        }
        assert!(judged > 500, "{judged} pixels of the sheet");
    }
}

#[test]
fn every_flat_shape_gives_the_same_edge_as_its_closed_form() {
    let Some(gpu) = gpu() else { return };
    // A list of two points: V is 0, ½ or 1, with steps where each point clears the edge.
    let points = vec![Vec3::new(-0.5, 4.0, 0.0), Vec3::new(0.5, 4.0, 0.0)];
    let case = Case::half_plane(gpu, LightShape::Points { positions_m: points });
    let pixels = case.ground_pixels(test_ground);
    let truth = |p: Vec3| {
        let first_visible = -p.x * (1.0 - 0.375) / 0.375;
        0.5 * f32::from(u8::from(-0.5 > first_visible) + u8::from(0.5 > first_visible))
    };
    for (kind, settings, bound) in bounds(|forms| forms.two_points) {
        let error = rmse(&pixels, &case.run(gpu, kind, settings), truth);
        println!("{kind}, points: rmse {error:.4}");
        assert!(error < bound, "{kind}: {error} against {bound}");
    }
    // A disk and a sphere straight above have nearly the same penumbra: V is the disk's segment beyond the chord.
    let disk = |p: Vec3| {
        let c = (-p.x * (1.0 - 0.375) / 0.375 / 0.5).clamp(-1.0, 1.0);
        (c.acos() - c * (1.0 - c * c).sqrt()) / std::f32::consts::PI
    };
    let on_disk = (LightShape::Disk { radius_m: 0.5 }, bounds(|forms| forms.disk));
    let on_sphere = (LightShape::Sphere { radius_m: 0.5 }, bounds(|forms| forms.sphere));
    for (shape, bounds) in [on_disk, on_sphere] {
        let case = Case::half_plane(gpu, shape.clone());
        for (kind, settings, bound) in bounds {
            let error = rmse(&pixels, &case.run(gpu, kind, settings), disk);
            println!("{kind}, {shape:?}: rmse {error:.4}");
            assert!(error < bound, "{kind} {shape:?}: {error} against {bound}");
        }
    }
}

#[test]
fn a_sun_s_penumbra_grows_with_distance_alone() {
    let Some(gpu) = gpu() else { return };
    let angle = 10f32.to_radians();
    let case = Case::half_plane(gpu, LightShape::Sun { angular_diameter_rad: angle });
    // Straight down: the direction's tangent o is visible where x + 1.5 o > 0; uniform on the tangent disc.
    let radius = (0.5 * angle).tan();
    let truth = |p: Vec3| {
        let c = (-p.x / 1.5 / radius).clamp(-1.0, 1.0);
        (c.acos() - c * (1.0 - c * c).sqrt()) / std::f32::consts::PI
    };
    let pixels = case.ground_pixels(test_ground);
    for (kind, settings, bound) in bounds(|forms| forms.sun) {
        let error = rmse(&pixels, &case.run(gpu, kind, settings), truth);
        println!("{kind}, sun: rmse {error:.4}");
        assert!(error < bound, "{kind}: {error} against {bound}");
    }
}

#[test]
fn a_zero_size_light_gives_the_hard_shadow() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, LightShape::Rectangle { size_m: Vec2::ZERO });
    let pixels = case.ground_pixels(test_ground);
    // A texel's width on the ground; the filter may soften that much to each side of the edge.
    let texel_m = 4.0 * 2.0 * fit_light_view(&case.light, &[case.meshes[0].bounds], &[]).window.half_size.x / 1024.0;
    for kind in TechniqueKind::ALL {
        // What has a width of its own is told to have none.
        let mask = case.run(gpu, *kind, &of_those(*kind, &[("kernel_size", "1"), ("mips", "false"), QUICK]));
        for (i, p) in &pixels {
            // A filter over the pixel's footprint softens by half a pixel, which is 3 cm here.
            let over_pixels = matches!(kind, TechniqueKind::Essm | TechniqueKind::PcssAnisotropic);
            if p.x.abs() > if over_pixels { 6.0 } else { 1.5 } * texel_m {
                // Sums of weights round.
                let difference = mask[*i] - half_plane_visibility(p.x, 0.0);
                assert!(difference.abs() < 1e-4, "{kind} at {p}: {difference}");
            }
        }
    }
}

#[test]
fn masks_stay_in_range_and_larger_occluders_never_brighten() {
    let Some(gpu) = gpu() else { return };
    let small = Case::half_plane(gpu, RECTANGLE);
    let mut large = Case::half_plane(gpu, RECTANGLE);
    large.meshes[1] = Mesh::horizontal(gpu, Vec2::new(-4.0, -4.0), Vec2::new(0.3, 4.0), 1.5);
    let pixels = small.ground_pixels(test_ground);
    for kind in TechniqueKind::ALL {
        let settings = of_those(*kind, &[("rotate", "false"), ("map_size", "512"), QUICK]);
        let (a, b) = (small.run(gpu, *kind, &settings), large.run(gpu, *kind, &settings));
        assert!(a.iter().chain(&b).all(|v| (0.0..=1.0).contains(v)), "{kind}");
        // All dark and all lit are in range, too, and off by more than .5. What has one width of blur, or none, has another
        // penumbra than this one.
        let error = rmse(&pixels, &a, |p| half_plane_visibility(p.x, 1.0));
        println!("{kind}: rmse {error:.4}");
        let bound = if kind.facts().occluders.has_fixed_width() { 0.133 } else { 0.0214 };
        assert!(error < bound, "{kind}: rmse {error} against {bound}");
        for (i, p) in &pixels {
            // Chebyshev's bound widens a penumbra by what it takes for blockers: Yang et al. 2010 do not claim monotony.
            let rise = if *kind == TechniqueKind::Vssm { 0.04 } else { 0.02 };
            assert!(b[*i] <= a[*i] + rise, "{kind} at {p}: {} became {}", a[*i], b[*i]);
        }
    }
}

/// What the dearest technique does without: a finer central map changes its silhouettes by half a texel.
const QUICK: (&str, &str) = ("central_scale", "1");

/// Those of some settings that a technique has.
fn of_those<'a>(kind: TechniqueKind, settings: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    let has = |key: &str| kind.param_specs().iter().any(|spec| spec.key == key);
    settings.iter().copied().filter(|(key, _)| has(key)).collect()
}

/// What is left of a light above a receiver's horizon is a share, also where the horizon all but misses the light: rounding
/// once made shares of more than one.
#[test]
fn horizons_that_touch_a_light_leave_a_share_of_it() {
    let Some(gpu) = gpu() else { return };
    let radius = 0.5;
    let mut case = Case::half_plane(gpu, LightShape::Disk { radius_m: radius });
    // The occluder is out of the way.
    case.meshes = vec![Mesh::horizontal(gpu, Vec2::splat(-4.0), Vec2::splat(-3.9), 1.5)];
    // The light looks down. A receiver h beside it and 4 m below it, of normal (1, b) away from it and up, has its middle
    // 4 b − h above the horizon, which cuts the light where that is within ± its radius: just so, in all or nearly none.
    let eye = case.view.view_from_world.inverse().transform_point3(Vec3::ZERO);
    let mut normals = vec![[0.0, 1.0, 0.0, 0.0]; SIZE.element_product() as usize];
    let mut pixels = case.ground_pixels(|p| p.x.abs() > 0.1 && p.x.abs() < 3.0 && p.z.abs() < 3.0);
    pixels.retain(|(i, p)| {
        let beside = Vec2::new(p.x, p.z);
        let just_so = 1.0 - 10f32.powf(-2.0 - 5.0 * (*i as f32 * 0.618).fract());
        let height = just_so * radius * if i % 2 == 0 { 1.0 } else { -1.0 };
        let side = beside.normalize();
        let normal = Vec3::new(side.x, (beside.length() + height) / 4.0, side.y).normalize();
        normals[*i] = normal.extend(0.0).to_array();
        // Normals are turned to the camera.
        normal.dot(eye - *p) > 0.0
    });
    let normals = normal_texture(gpu, &normals);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    for kind in TechniqueKind::ALL {
        let mut technique = kind.create(gpu).expect("any device");
        for (key, value) in of_those(*kind, &[("map_size", "64"), ("view_size", "64"), QUICK]) {
            technique.set(key, value).expect("in range");
        }
        let mask = case.with_frame(Casters::Meshes(&casters), |frame| {
            let receivers = Receivers { normals: Some(&normals), ..frame.receivers };
            run(gpu, &mut technique, &Frame { receivers, ..*frame }).expect("a good frame")
        });
        let odd = mask.iter().find(|v| !(0.0..=1.0).contains(*v));
        assert_eq!(odd, None, "{kind}");
        let [lit, dark] = [0, 1].map(|which| {
            let values: Vec<f32> = pixels.iter().filter(|(i, _)| i % 2 == which).map(|(i, _)| mask[*i]).collect();
            assert!(values.len() > 500, "{} pixels", values.len());
            values.iter().sum::<f32>() / values.len() as f32
        });
        println!("{kind}: {lit:.4} of the light where nearly all is above the horizon, {dark:.4} where nearly none is");
        assert!(lit > 0.99 && dark < 0.01, "{kind}: {lit} and {dark}");
    }
}

/// `Rgba32Float` normals, row by row.
fn normal_texture(gpu: &Gpu, normals: &[[f32; 4]]) -> wgpu::TextureView {
    view_of(&texture_of(gpu, SIZE, wgpu::TextureFormat::Rgba32Float, normals))
}

#[test]
fn a_host_s_depth_map_gives_what_our_own_gives() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let bounds: Vec<_> = casters.iter().map(|caster| caster.bounds).collect();
    let view = fit_light_view(&case.light, &bounds, &[]);
    let size_px = UVec2::splat(1024);
    let map = view_of(&draw_depth(gpu, size_px, view.clip_from_world(), &casters));
    let given = Casters::DepthMap(DepthMapCaster {
        view: &map,
        size_px,
        clip_from_world: view.clip_from_world(),
        depth_convention: DepthConvention::Reversed,
    });
    for kind in taking_a_depth_map() {
        // Kernels counted in texels reach beyond what is seen: our own map is wider by them.
        let settings = of_those(kind, &[("kernel_size", "1"), ("mips", "false")]);
        let own = case.run(gpu, kind, &settings);
        let hosts =
            case.run_with(gpu, kind, &settings, given).unwrap_or_else(|error| panic!("{error}: {IF_IT_HAS_TO}"));
        let differing = own.iter().zip(&hosts).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
        assert!(differing < 20, "{kind}: {differing} pixels differ");
    }
    for kind in REFUSING_A_DEPTH_MAP {
        let error = case.run_with(gpu, kind, &[], given).unwrap_err().to_string();
        println!("{error}");
        assert!(error.starts_with(kind.name()) && !error.contains('\n'), "{kind}: {error}");
    }
    let error = case.run_with(gpu, TechniqueKind::MultiView, &[], given).unwrap_err();
    assert!(error.to_string().contains("each light point has its own view"));
}

const IF_IT_HAS_TO: &str = "a technique that has to refuse a host's depth map is listed in `REFUSING_A_DEPTH_MAP`";

/// Techniques that need the casters' triangles, and refuse a host's depth map.
const REFUSING_A_DEPTH_MAP: [TechniqueKind; 7] = [
    TechniqueKind::MultiView,
    TechniqueKind::MultiLayer,
    TechniqueKind::Reprojection,
    TechniqueKind::ReprojectionLayered,
    TechniqueKind::RayTraced,
    TechniqueKind::AliasFree,
    TechniqueKind::SampleBased,
];

/// All others.
fn taking_a_depth_map() -> Vec<TechniqueKind> {
    TechniqueKind::ALL.iter().copied().filter(|kind| !REFUSING_A_DEPTH_MAP.contains(kind)).collect()
}

/// How deep a host's map reaches is no matter: what lies behind the receivers, and texels in which there is nothing, shade none.
#[test]
fn a_host_s_depth_map_may_be_infinitely_deep() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let bounds = casters.iter().map(|caster| caster.bounds).reduce(Aabb::union);
    // Without the ground most of the map is empty.
    let casters: Vec<_> = casters.into_iter().filter(|caster| caster.bounds.max.y > 1.0).collect();
    assert_eq!(casters.len(), 1);
    let frame = case.light.frame();
    let [right, up, back] = [frame.right, frame.up, -frame.axis].map(|axis| axis.extend(0.0));
    let view_from_world = Mat4::from_cols(right, up, back, frame.center.extend(1.0)).inverse();
    let size_px = UVec2::splat(512);
    let fov_y = 2.0 * 1.2f32.atan();
    let near_m = 0.3;
    for kind in taking_a_depth_map() {
        let masks = [
            // Near and far change places: reversed.
            proj::directx::perspective(fov_y, 1.0, 12.0, near_m),
            proj::directx::perspective(fov_y, 1.0, 5e3, near_m),
            proj::directx::perspective_infinite_reverse(fov_y, 1.0, near_m),
        ]
        .map(|clip_from_view| {
            let clip_from_world = clip_from_view * view_from_world;
            let map = view_of(&draw_depth(gpu, size_px, clip_from_world, &casters));
            let depth_convention = DepthConvention::Reversed;
            let given = Casters::DepthMap(DepthMapCaster { view: &map, size_px, clip_from_world, depth_convention });
            case.with_frame(given, |frame| {
                let receivers = Receivers { bounds, ..frame.receivers };
                let mut technique = kind.create(gpu).expect("what every device has");
                let mask = run(gpu, &mut technique, &Frame { receivers, ..*frame });
                mask.unwrap_or_else(|error| panic!("{error}: {IF_IT_HAS_TO}"))
            })
        });
        for deep in &masks[1..] {
            let squares: f32 = deep.iter().zip(&masks[0]).map(|(a, b)| (a - b).powi(2)).sum();
            let rms = (squares / deep.len() as f32).sqrt();
            println!("{kind}: {rms:.1e} from the same map, twelve metres deep");
            assert!(rms < 1e-5, "{kind}: {rms}");
        }
    }
}

#[test]
fn bad_frames_say_what_would_be_right() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    case.mask = Mask::new(gpu.device(), UVec2::new(10, 10));
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let error = case.run_with(gpu, TechniqueKind::Hard, &[], Casters::Meshes(&casters)).unwrap_err();
    assert!(error.to_string().starts_with("hard: the mask's size is [10, 10], and must be"), "{error}");
}

#[test]
fn an_empty_scene_is_lit() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    for kind in TechniqueKind::ALL {
        let settings = of_those(*kind, &[("map_size", "64"), ("view_size", "64")]);
        let mask = case.run_with(gpu, *kind, &settings, Casters::Meshes(&[])).expect("nothing to cast");
        for (i, p) in case.ground_pixels(test_ground) {
            assert_eq!(mask[i], 1.0, "{kind} at {p}");
        }
    }
}

/// A graphics card interpolates depth between corners that it has moved to a grid of 1/256 of a pixel, which takes receivers some
/// hundredths of a millimetre off their triangles: neither side of an open caster shades itself for that.
#[test]
fn depth_between_moved_corners_casts_no_shadow() {
    let Some(gpu) = gpu_with(|_| wgpu::Limits::default()) else { return };
    let gpu = &gpu;
    // Half a step in each direction.
    gpu.pretend_snapped(1.0 / 512.0);
    let between_corners = Case::half_plane(gpu, RECTANGLE);
    let mut between_moved_ones = Case::half_plane(gpu, RECTANGLE);
    let clip_from_world = between_corners.view.clip_from_view * between_corners.view.view_from_world;
    let depth = snapped_depth(clip_from_world, SIZE, &HALF_PLANE);
    between_moved_ones.depth = view_of(&float_texture(gpu, SIZE, &depth));
    let pixels = between_corners.ground_pixels(test_ground);
    for kind in TechniqueKind::ALL {
        let settings = of_those(*kind, &[("samples", "64"), ("map_size", "256"), QUICK]);
        let [plain, moved] = [&between_corners, &between_moved_ones].map(|case| case.run(gpu, *kind, &settings));
        let off = pixels.iter().map(|(i, _)| (plain[*i] - moved[*i]).abs()).sum::<f32>() / pixels.len() as f32;
        println!("{kind}: {off:.5} apart");
        // Kernels of these two are differences of large sums: a receiver that is moved by so little has other digits of them.
        let is_rough = matches!(kind, TechniqueKind::Vssm | TechniqueKind::Evssm);
        assert!(off <= if is_rough { 0.05 } else { 1e-3 }, "{kind}: {off}");
    }
}

#[test]
fn lists_of_any_length_and_triangles_of_any_shape_are_taken() {
    let Some(gpu) = gpu() else { return };
    let mut case = Case::half_plane(gpu, RECTANGLE);
    let pixels = case.ground_pixels(test_ground);
    // Without area; a needle; through the light's plane, where its shadow falls beside the tested ground.
    let corners = [
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(0.0, 1.5, -4.0),
        Vec3::new(0.0, 1.5, 4.0),
        Vec3::new(1e-6, 1.5, 4.0),
        Vec3::new(-4.0, 2.0, -1.0),
        Vec3::new(-4.0, 8.0, -1.0),
        Vec3::new(-4.0, 8.0, 1.0),
    ];
    case.meshes.push(Mesh::new(gpu, &corners, &[0, 1, 2, 3, 4, 5, 6, 7, 8]));
    let fine = case.run(gpu, TechniqueKind::SampleBased, &[]);
    let error = rmse(&pixels, &fine, |p| half_plane_visibility(p.x, 1.0));
    println!("sample_based with odd triangles: rmse {error:.4}");
    assert!(error < 0.004, "rmse {error}");
    // 16² texels for 96² receivers, most of which share a few: another order of the same tests.
    for kind in [TechniqueKind::SampleBased, TechniqueKind::AliasFree] {
        assert!(case.run(gpu, kind, &[]) == case.run(gpu, kind, &[("map_size", "16")]), "{kind}");
    }
}

/// What a receiver on the ground sees of a light, at least and at most, past the half-plane's occluder and one triangle
/// more, point by point: a light point within a millimetre of the ground's plane may be hidden by it or not, and a receiver
/// within a millimetre of the light's plane may be before it or not.
fn seen_past(light: &Light, triangle: [Vec3; 3], x: Vec3, points: &[Vec3]) -> (f32, f32) {
    let frame = light.frame();
    let nudged = |by: f32| light.reaches(&frame, x + by * frame.axis);
    let crosses = |o: Vec3| {
        let way = o - x;
        let [a, b, c] = triangle.map(|corner| corner - x);
        let sides = [b.cross(c).dot(way), c.cross(a).dot(way), a.cross(b).dot(way)];
        let normal = (b - a).cross(c - a);
        let along = normal.dot(a) / normal.dot(way);
        (0.0..=1.0).contains(&along) && (sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0))
    };
    let under_occluder = |o: Vec3| o.y > 1.5 && x.x + (o.x - x.x) * 1.5 / o.y < 0.0;
    let (mut least, mut most) = (0.0, 0.0);
    for u in points {
        let o = light.point(&frame, *u, x).xyz;
        if !crosses(o) && !under_occluder(o) {
            least += f32::from(u8::from(o.y > 1e-3 && nudged(-1e-3)));
            most += f32::from(u8::from(o.y > -1e-3 && nudged(1e-3)));
        }
    }
    (least / points.len() as f32, most / points.len() as f32)
}

#[test]
fn receivers_on_the_light_s_plane_are_taken() {
    let Some(gpu) = gpu() else { return };
    // Lights whose plane is the ground, or that are cut by it, and casters through the plane: whatever a receiver there
    // sees of them, it is a part of the whole, the same whatever the order of the tests, and found in finite time.
    let shapes = [
        RECTANGLE,
        LightShape::Disk { radius_m: 0.5 },
        LightShape::Sphere { radius_m: 0.5 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.6, 0.3, 0.4) },
        LightShape::Points { positions_m: vec![Vec3::new(3.0, 0.0, 0.0), Vec3::new(3.0, 0.4, 0.2)] },
    ];
    let points = antumbra_light::SampleSet::R2.points(1024, 7);
    for shape in shapes {
        for axis in [Vec3::NEG_Y, Vec3::NEG_X] {
            let mut case = Case::half_plane(gpu, shape.clone());
            case.light = Light::new(shape.clone(), Vec3::new(3.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0) + axis);
            let corners = [Vec3::new(2.0, -1.0, -1.0), Vec3::new(2.0, 1.0, -1.0), Vec3::new(2.0, 1.0, 1.0)];
            case.meshes.push(Mesh::new(gpu, &corners, &[0, 1, 2]));
            let ground = case.ground_pixels(test_ground);
            assert!(ground.len() > 500, "only {} pixels", ground.len());
            for kind in [TechniqueKind::SampleBased, TechniqueKind::AliasFree] {
                let mask = case.run(gpu, kind, &[]);
                assert!(mask.iter().all(|v| (0.0..=1.0).contains(v)), "{kind} {shape:?} {axis}: out of range");
                // What `alias_free` takes for the light is its centre.
                let is_one_point = kind == TechniqueKind::AliasFree;
                let light = if is_one_point { case.light.scaled(0.0) } else { case.light.clone() };
                let points = if is_one_point { &points[..1] } else { &points[..] };
                let beyond = ground.iter().map(|(i, p)| {
                    let (least, most) = seen_past(&light, corners, *p, points);
                    (least - mask[*i]).max(mask[*i] - most).max(0.0)
                });
                let (worst, squares) = beyond.fold((0.0f32, 0.0), |(worst, sum), b| (worst.max(b), sum + b * b));
                let rms = (squares / ground.len() as f32).sqrt();
                println!("{kind} {shape:?} {axis}: {rms:.4} from what is seen, at worst {worst:.4}");
                assert!(rms <= 0.0065 && worst <= 0.035, "{kind} {shape:?} {axis}: {rms}, at worst {worst}");
                assert!(mask == case.run(gpu, kind, &[("map_size", "16")]), "{kind} {shape:?} {axis}: another order");
            }
        }
    }
}

/// The depth buffer's values in another texture: at `origin_px` of one of `size_px`, as `convert` has them.
fn depth_elsewhere(
    gpu: &Gpu,
    values: &[f32],
    size_px: UVec2,
    origin_px: UVec2,
    convert: impl Fn(f32) -> f32,
) -> wgpu::TextureView {
    let mut texels = vec![convert(0.5); size_px.element_product() as usize];
    for (row, of_row) in values.chunks(SIZE.x as usize).enumerate() {
        let first = ((origin_px.y + row as u32) * size_px.x + origin_px.x) as usize;
        for (to, from) in texels[first..].iter_mut().zip(of_row) {
            *to = convert(*from);
        }
    }
    view_of(&float_texture(gpu, size_px, &texels))
}

/// A viewport in a larger depth buffer gives the bits of a buffer of its own, in whatever layer of a host's array the mask
/// is; and a depth buffer that runs the other way what its rounding leaves.
#[test]
fn receivers_come_as_engines_have_them() {
    let Some(gpu) = gpu() else { return };
    let case = Case::half_plane(gpu, RECTANGLE);
    let casters: Vec<_> = case.meshes.iter().map(Mesh::caster).collect();
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(&read_texture(gpu, case.depth.texture(), 0, SIZE));
    let (larger_px, origin_px) = (UVec2::new(160, 131), UVec2::new(37, 22));
    let in_larger = depth_elsewhere(gpu, &values, larger_px, origin_px, |depth| depth);
    let standard = depth_elsewhere(gpu, &values, SIZE, UVec2::ZERO, |depth| 1.0 - depth);
    let array = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test masks"),
        size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 4 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: Mask::FORMAT,
        usage: wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let layer = Mask::of_layers(&array, 2, MaskChannels::One).expect("a layer of a good texture");
    let small = [("map_size", "128"), ("view_size", "64"), ("samples", "8"), ("search_samples", "8")];
    for kind in TechniqueKind::ALL {
        let technique = || {
            let mut technique = kind.create(gpu).expect("any device");
            for (key, value) in of_those(*kind, &small) {
                technique.set(key, value).expect("in range");
            }
            technique
        };
        case.with_frame(Casters::Meshes(&casters), |frame| {
            let whole = run(gpu, &mut technique(), frame).expect("a good frame");
            let viewport = Receivers { origin_px, depth: &in_larger, ..frame.receivers };
            let frame_in_layer = Frame { receivers: viewport, mask: &layer, ..*frame };
            run(gpu, &mut technique(), &frame_in_layer).expect("a good frame");
            let in_layer: Vec<f32> = bytemuck::pod_collect_to_vec(&read_layer(gpu, &array, 2));
            assert!(in_layer == whole, "{kind}: in a viewport");
            let flip = Mat4::from_cols(Vec4::X, Vec4::Y, -Vec4::Z, Vec4::new(0.0, 0.0, 1.0, 1.0));
            let receivers = Receivers {
                depth: &standard,
                depth_convention: DepthConvention::Standard,
                clip_from_view: flip * frame.receivers.clip_from_view,
                ..frame.receivers
            };
            let turned = run(gpu, &mut technique(), &Frame { receivers, ..*frame }).expect("a good frame");
            let off = whole.iter().zip(&turned).map(|(a, b)| (a - b).abs()).sum::<f32>() / whole.len() as f32;
            // Kernels of these two are differences of large sums: a receiver that rounding moves by some micrometres has other
            // digits of them. Measured .0052 and .0033, and at most 2e-6 for all others.
            let is_rough = matches!(kind, TechniqueKind::Vssm | TechniqueKind::Evssm);
            assert!(off <= if is_rough { 0.006 } else { 5e-6 }, "{kind}: standard depth is off by {off}");
            let beyond = Receivers { origin_px: origin_px + 40, ..viewport };
            let error = run(gpu, &mut technique(), &Frame { receivers: beyond, ..*frame }).unwrap_err();
            assert!(error.to_string().contains("within the depth buffer"), "{kind}: {error}");
        });
    }
}
