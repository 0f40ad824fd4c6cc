//! Setup files: meaning, messages about faults, and round trips through writing and reading.

use std::path::Path;

use antumbra_light::{Cone, EmissionTexture, Light, LightShape, ShadowDistance};
use glam::{UVec2, Vec2, Vec3};

use super::framing::Subject;
use super::{Assumed, Setup};
use crate::{Aabb, Scene, builtin};

fn read(text: &str) -> Result<Setup, String> {
    Setup::from_toml(text, Path::new("dir/s.toml")).map_err(|e| e.to_string())
}

const CAMERA: &str = "[camera]\neye = [4, 4.0, 6]\ntarget = [0.0, 0.5, 0.0]\n";

#[test]
fn defaults_are_those_of_the_format() {
    let setup = read(&format!("{CAMERA}[[light]]\nshape = \"disk\"\nradius = 0.25\n")).unwrap();
    let c = setup.camera;
    assert_eq!((c.eye, c.target, c.up), (Vec3::new(4.0, 4.0, 6.0), Vec3::new(0.0, 0.5, 0.0), Vec3::Y));
    assert_eq!((c.fov_y_rad, c.near_m, c.far_m), (45f32.to_radians(), 0.05, 200.0));
    let light = &setup.lights[0];
    assert_eq!((light.center, light.axis, light.up), (Vec3::new(0.0, 5.0, 0.0), Vec3::NEG_Y, Vec3::Z));
    assert_eq!((light.fov_rad, light.color, light.candela_or_lux, light.intensity), (None, Vec3::ONE, None, 1.0));
    assert_eq!(light.shape, LightShape::Disk { radius_m: 0.25 });
}

#[test]
fn every_shape_reads() {
    for (own, shape) in [
        ("shape='rectangle'\nsize=[1.0, 0.5]", LightShape::Rectangle { size_m: Vec2::new(1.0, 0.5) }),
        ("shape='disk'\nradius=0.25", LightShape::Disk { radius_m: 0.25 }),
        ("shape='sphere'\nradius=1", LightShape::Sphere { radius_m: 1.0 }),
        ("shape='ellipsoid'\nradii=[0.4,0.2,0.1]", LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 0.1) }),
        (
            "shape='sun'\ndirection=[-1,-2,-1]\nangular_diameter=2.0",
            LightShape::Sun { angular_diameter_rad: 2f32.to_radians() },
        ),
        ("shape='sun'\ndirection=[0,-1,0]", LightShape::Sun { angular_diameter_rad: 0.53f64.to_radians() as f32 }),
        (
            "shape='points'\npositions=[[0,1,0],[0,3,0]]",
            LightShape::Points { positions_m: vec![Vec3::Y, 3.0 * Vec3::Y] },
        ),
    ] {
        let setup = read(&format!("{CAMERA}[[light]]\n{own}\n")).unwrap();
        assert_eq!(setup.lights[0].shape, shape);
    }
    let sun = read(&format!("{CAMERA}[[light]]\nshape='sun'\ndirection=[-1,-2,-1]")).unwrap().lights.remove(0);
    assert!(sun.axis.abs_diff_eq(Vec3::new(-1.0, -2.0, -1.0).normalize(), 1e-7));
}

#[test]
fn mistakes_are_named_with_line_and_remedy() {
    let light = |own: &str| format!("{CAMERA}[[light]]\n{own}\n");
    for (text, wants) in [
        (String::new(), ["s.toml:1", "[camera]", "eye"].as_slice()),
        (CAMERA.into(), &["s.toml:4", "[[light]]"]),
        (light("shape = 'disk'\nradus = 1.0"), &["s.toml:6", "\"radus\"", "did you mean `radius`?"]),
        (light("shape = 'disk'\nsize = [1, 1]"), &["s.toml:6", "\"size\"", "belongs to rectangle", "`radius`"]),
        (light("shape = 'disc'\nradius = 1.0"), &["s.toml:5", "\"disc\"", "did you mean `disk`?"]),
        (light("shape = 'disk'"), &["s.toml:4", "`radius` is missing"]),
        (light("radius = 1"), &["`shape` is missing", "`ellipsoid`"]),
        (light("shape = 'disk'\nradius = '1'"), &["s.toml:6", "`radius` is a string", "a number"]),
        (light("shape = 'disk'\nradius = -1.0"), &["s.toml:4", "`radius`", "not negative"]),
        (light("shape = 'disk'\nradius = nan"), &["`radius`"]),
        (light("shape = 'rectangle'\nsize = [1]"), &["`size`", "a list of 2 numbers"]),
        (light("shape = 'sun'"), &["`direction` is missing"]),
        (light("shape = 'points'\npositions = [[1, 2]]"), &["`positions`", "[x, y, z]"]),
        (light("shape = 'points'\npositions = []"), &["`positions`"]),
        (light("shape = 'disk'\nradius = 1\ntarget = [0, 5, 0]"), &["s.toml:4", "`center` and `target`"]),
        (light("shape = 'disk'\nradius = 1\nfov = 180"), &["`fov`", "below 180"]),
        (light("shape = 'rectangle'\nsize = [1, 1]\ntexture = 'no.png'"), &["s.toml:7", "\"no.png\"", "PNG"]),
        (format!("{CAMERA}[light]\nshape = 'disk'"), &["[[light]]", "two brackets"]),
        (format!("{CAMERA}[[lights]]\nshape = 'disk'"), &["s.toml:4", "did you mean `light`?"]),
        (format!("{CAMERA}fov = 3\n[[light]]"), &["s.toml:4", "[camera]", "did you mean `fov_y`?"]),
        (format!("{CAMERA}fov_y = 0.0\n[[light]]"), &["s.toml:4", "`fov_y`", "above 0"]),
        (format!("{CAMERA}near = 300.0\n[[light]]"), &["`far`", "above `near`"]),
        (format!("{CAMERA}up = [0.0, 0.0, 0.0]\n[[light]]"), &["s.toml:4", "`up`", "parallel"]),
        ("[camera]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n".into(), &["`eye` and `target`", "must differ"]),
        ("[camera]\neye = [1, 2, inf]\ntarget = [1, 2, 3]\n".into(), &["s.toml:2", "`eye`", "finite"]),
        ("[camera\n".into(), &["s.toml:1", "TOML"]),
        ("[camera]\neye = [1, 2, 3]\neye = [1, 2, 3]\n".into(), &["s.toml:3"]),
    ] {
        let error = read(&text).unwrap_err();
        for want in wants {
            assert!(error.contains(want), "{text}\n{error}\nlacks {want}");
        }
        assert!(!error.contains('\n'), "{error}");
    }
}

/// Asserts that setups are equal, axes to within the last bit or two that normalizing changes.
fn close(a: &Setup, b: &Setup) {
    assert_eq!(a.camera, b.camera);
    assert_eq!(a.lights.len(), b.lights.len());
    for (a, b) in a.lights.iter().zip(&b.lights) {
        assert!(a.axis.abs_diff_eq(b.axis, 3e-7), "{} {}", a.axis, b.axis);
        assert_eq!(a.emission.is_some(), b.emission.is_some());
        assert_eq!(Light { axis: a.axis, emission: None, ..b.clone() }, Light { emission: None, ..a.clone() });
    }
}

#[test]
fn writing_and_reading_keeps_everything() {
    let mut lights = Vec::new();
    let shapes = [
        LightShape::Rectangle { size_m: Vec2::new(1.1, 0.3) },
        LightShape::Disk { radius_m: 0.1 },
        LightShape::Sphere { radius_m: 1e-7 },
        LightShape::Ellipsoid { radii_m: Vec3::new(0.4, 0.2, 1e9) },
        LightShape::Sun { angular_diameter_rad: 0.009_250_245 },
        LightShape::Points { positions_m: vec![Vec3::new(0.1, 0.2, 0.3), Vec3::NEG_ONE] },
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        let mut light = Light::new(shape, Vec3::new(1e4, 7.3, -0.1), Vec3::new(0.3, 0.1 * k as f32, 0.0));
        light.name = format!("light \"{k}\"\n#");
        light.fov_rad = (k % 2 == 0).then_some(1.234_567);
        light.cone = (k % 3 == 0).then_some(Cone { inner_rad: 0.234_567, outer_rad: 0.6 });
        light.color = Vec3::new(0.1, 0.2, 0.3);
        light.candela_or_lux = (k % 2 == 1).then_some(812.5);
        light.up = Vec3::new(0.1, 0.9, 0.2);
        lights.push(light);
    }
    for distance in [1e7, 1e12, 1e18] {
        let mut light = lights[1].clone();
        light.center = Vec3::new(distance, 0.3, -distance);
        lights.push(light);
    }
    let luminance: Vec<f32> = (0..12).map(|k| k as f32 / 11.0).collect();
    lights[0].emission = Some(EmissionTexture::gray(4, 3, luminance.clone()));
    let camera = Setup::for_scene(&Scene::default()).camera;
    let setup = Setup { camera, lights };
    let back = read(&setup.to_toml()).unwrap();
    close(&setup, &back);
    let emission = back.lights[0].emission.as_ref().unwrap();
    assert_eq!((emission.width, emission.height), (4, 3));
    for (got, want) in emission.luminance.iter().zip(&luminance) {
        assert!((got - want).abs() < 1e-4, "{got} {want}");
    }
}

#[test]
fn a_shadow_distance_has_a_fade_and_bounds() {
    let with = |keys: &str| read(&format!("{CAMERA}{keys}\n[[light]]\nshape='disk'\nradius=0.25\n"));
    let distance = |keys: &str| with(keys).unwrap().camera.shadow_distance;
    assert_eq!(distance(""), None);
    assert_eq!(distance("shadow_distance = 150"), Some(ShadowDistance::new(150.0)));
    let both = Some(ShadowDistance { end_m: 150.0, fade_m: 12.5 });
    assert_eq!(distance("shadow_distance = 150\nshadow_fade = 12.5"), both);
    let setup = with("shadow_distance = 150\nshadow_fade = 12.5").unwrap();
    assert_eq!(read(&setup.to_toml()).unwrap().camera.shadow_distance, both);
    for (keys, part) in [
        ("shadow_distance = 0", "`shadow_distance` is 0, and must be a length in metres, positive and finite"),
        ("shadow_distance = 9\nshadow_fade = 10", "`shadow_fade` is 10, and must be a length in metres, from 0"),
        ("shadow_fade = 10", "`shadow_fade` is given without `shadow_distance`"),
    ] {
        let message = with(keys).unwrap_err();
        assert!(message.contains(part), "{keys}: {message}");
    }
}

#[test]
fn a_texture_is_luminance_with_its_first_row_on_top() {
    let folder = tempfile::tempdir().unwrap();
    let mut picture = image::RgbImage::new(2, 2);
    picture.put_pixel(1, 0, image::Rgb([255, 255, 255]));
    picture.put_pixel(0, 1, image::Rgb([0, 255, 0]));
    picture.save(folder.path().join("t.png")).unwrap();
    let text = format!("{CAMERA}[[light]]\nshape = 'rectangle'\nsize = [1, 1]\ntexture = 't.png'\n");
    let setup = Setup::from_toml(&text, &folder.path().join("s.toml")).unwrap();
    let emission = setup.lights[0].emission.as_ref().unwrap();
    assert!((emission.luminance_at(Vec2::new(0.75, 0.75)) - 1.0).abs() < 1e-5);
    assert!((emission.luminance_at(Vec2::new(0.25, 0.25)) - 0.7152).abs() < 1e-5);
    assert_eq!(emission.luminance_at(Vec2::new(0.25, 0.75)), 0.0);
    // Its colours are kept as well, also through a file.
    let written = read(&setup.to_toml()).unwrap();
    for emission in [emission, written.lights[0].emission.as_ref().unwrap()] {
        assert!(emission.color_at(Vec2::new(0.25, 0.25)).abs_diff_eq(Vec3::Y, 1e-4), "{emission:?}");
        assert!(emission.color_at(Vec2::new(0.75, 0.75)).abs_diff_eq(Vec3::ONE, 1e-4), "{emission:?}");
    }
}

#[test]
fn built_ins_survive_being_written() {
    for info in builtin::NAMES {
        let setup = Setup::for_scene(&builtin::build(info.name).unwrap());
        close(&setup, &read(&setup.to_toml()).unwrap());
    }
}

#[test]
fn framing_shows_every_corner_at_every_scale() {
    for (center, size) in [
        (Vec3::ZERO, 2.0),
        (Vec3::new(100.0, -20.0, 3.0), 1e-3),
        (Vec3::splat(1.4e7), 1.0),
        (Vec3::ZERO, 1e-30),
        (Vec3::ZERO, 1e17),
    ] {
        let bounds = Aabb { min: center - 0.5 * size, max: center + 0.5 * size };
        let camera = super::framing::camera(&alone(bounds), 1.0);
        super::check_camera(&camera).unwrap();
        let light = super::framing::key_light(bounds);
        light.validate().unwrap();
        let px = glam::UVec2::splat(100);
        for corner in bounds.corners() {
            let clip = camera.clip_from_view(px) * (camera.view_from_world() * corner.extend(1.0));
            assert!(clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.w > camera.near_m, "{corner} {clip}");
            assert!(light.reaches(&light.frame(), corner), "{corner}");
        }
    }
    super::check_camera(&super::framing::camera(&alone(Aabb::EMPTY), 1.0)).unwrap();
}

/// Subject that is only a box.
fn alone(bounds: Aabb) -> Subject {
    Subject { bounds, all: bounds, has_shadow: false }
}

/// A box of six faces that look inwards, or outwards.
fn hollow(size: Vec3, inwards: bool) -> Scene {
    let corners = Aabb { min: Vec3::ZERO, max: size }.corners();
    let middle = 0.5 * size;
    let mut mesh = crate::Mesh { positions: corners.to_vec(), normals: vec![Vec3::Y; 8], ..Default::default() };
    for axis in 0..3 {
        for end in [0.0, size[axis]] {
            let side: Vec<u32> = (0..8).filter(|k| corners[*k as usize][axis] == end).collect();
            for t in [[side[0], side[1], side[2]], [side[3], side[2], side[1]]] {
                let [a, b, c] = t.map(|k| corners[k as usize]);
                let looks_in = (b - a).cross(c - a).dot(middle - a) > 0.0;
                mesh.indices.extend(if looks_in == inwards { t } else { [t[0], t[2], t[1]] });
            }
        }
    }
    Scene {
        name: "box".into(),
        meshes: vec![mesh],
        materials: vec![crate::Material::default()],
        instances: vec![crate::Instance { mesh: 0, world_from_object: glam::Mat4::IDENTITY }],
        ..Scene::default()
    }
}

#[test]
fn rooms_are_seen_from_inside_and_solids_from_outside() {
    let size = Vec3::new(8.0, 3.0, 5.0);
    let is_inside = |p: Vec3| p.cmpgt(Vec3::ZERO).all() && p.cmplt(size).all();
    let Assumed { setup: room, line, framing } = Setup::assumed(&hollow(size, true));
    assert!(is_inside(room.camera.eye) && is_inside(room.lights[0].center), "{room:?}");
    assert!(framing.is_none());
    super::check_camera(&room.camera).unwrap();
    assert!(room.camera.eye.y > 1.0 && room.camera.target.distance(room.camera.eye) > 2.0, "{:?}", room.camera);
    let line = line.unwrap();
    assert!(
        line.contains("inside the room") && line.contains("below the ceiling") && line.contains("--setup"),
        "{line}"
    );

    let Assumed { setup: solid, line, framing: frames_solid } = Setup::assumed(&hollow(size, false));
    assert!(!is_inside(solid.camera.eye) && line.unwrap().contains("that frames it") && frames_solid.is_some());
    // A box that no one can stand in is an object, whichever way its faces look.
    let Assumed { setup: toy, .. } = Setup::assumed(&hollow(0.1 * size, true));
    assert!(toy.camera.eye.cmpgt(0.1 * size).any(), "{:?}", toy.camera);
}

#[test]
fn what_a_scene_says_is_not_assumed() {
    let whole = builtin::build("overlap").unwrap();
    assert_eq!(Setup::assumed(&whole).line, None);
    let unlit = Scene { lights: Vec::new(), ..whole.clone() };
    let Assumed { setup, line, .. } = Setup::assumed(&unlit);
    assert_eq!(setup.camera, whole.cameras[0]);
    assert!(line.is_some_and(|line| line.contains("no lights") && !line.contains("no camera")));
}

/// Corners are near opposite edges of the image and none lies outside, for any aspect ratio.
#[test]
fn an_object_fills_the_frame() {
    for size in [Vec3::splat(0.1), Vec3::new(0.1, 1.0, 0.1), Vec3::new(3.0, 0.1, 3.0), Vec3::new(100.0, 15.0, 100.0)] {
        for px in [UVec2::splat(100), UVec2::new(1280, 720), UVec2::new(9, 16)] {
            let bounds = Aabb { min: Vec3::ZERO, max: size };
            let camera = super::framing::camera(&alone(bounds), px.x as f32 / px.y as f32);
            let clip_from_world = camera.clip_from_view(px) * camera.view_from_world();
            let places = bounds.corners().map(|corner| clip_from_world.project_point3(corner).truncate());
            let most = places.into_iter().fold(Vec2::MIN, Vec2::max);
            let least = places.into_iter().fold(Vec2::MAX, Vec2::min);
            let reach = most.max(-least).max_element();
            assert!((0.9..=1.0).contains(&reach), "{size}, {px}: {reach}");
            // The margins are equal.
            assert!((most + least).abs().max_element() < 0.01, "{size}, {px}: {least} to {most}");
        }
    }
}

/// Kilometres of ground do not belong to the subject of an image; the walls of a hall with small objects in it do.
#[test]
fn grounds_do_not_make_specks_of_what_stands_on_them() {
    let mut village = hollow(Vec3::new(10.0, 6.0, 10.0), false);
    let small = village.meshes[0].clone();
    for (k, x) in [0.0, 40.0, 80.0].into_iter().enumerate() {
        let mut mesh = small.clone();
        mesh.positions.iter_mut().for_each(|p| *p += Vec3::new(x, 0.0, 7.0 * k as f32));
        village.meshes.push(mesh);
        village.instances.push(crate::Instance { mesh: k + 1, world_from_object: glam::Mat4::IDENTITY });
    }
    let houses = village.bounds();
    assert_eq!(Subject::of(&village).bounds, houses);
    village.add_ground();
    let ground = village.meshes.last_mut().unwrap();
    ground.positions.iter_mut().for_each(|p| *p *= Vec3::new(10.0, 1.0, 10.0));
    let subject = Subject::of(&village);
    assert_eq!(subject.bounds, houses);
    assert!(subject.all.diagonal() > 30.0 * houses.diagonal());
    // The far plane lies behind the ground.
    assert!(super::framing::camera(&subject, 1.0).far_m > subject.all.diagonal());

    let mut hall = hollow(Vec3::new(10.0, 6.0, 10.0), false);
    let mut thing = small;
    thing.positions.iter_mut().for_each(|p| *p = *p * 0.05 + 1.0);
    hall.meshes.push(thing);
    hall.instances.push(crate::Instance { mesh: 1, world_from_object: glam::Mat4::IDENTITY });
    assert_eq!(Subject::of(&hall).bounds, hall.bounds());
}

/// The image of an object that is put on a ground includes a good part of its shadow.
#[test]
fn shadows_on_the_ground_are_in_the_picture() {
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(5.0, 2.5, 2.5) };
    let px = UVec2::new(1280, 720);
    let camera = super::framing::camera(&Subject { has_shadow: true, ..alone(bounds) }, 16.0 / 9.0);
    let light = super::framing::key_light(bounds).center;
    let clip_from_world = camera.clip_from_view(px) * camera.view_from_world();
    for corner in bounds.corners() {
        let half = corner.with_y(1.25);
        let shadow = light + (half - light) * (light.y / (light.y - 1.25));
        assert!(shadow.y.abs() < 1e-4);
        for point in [corner, shadow] {
            let place = clip_from_world.project_point3(point);
            assert!(place.truncate().abs().max_element() <= 1.0, "{point} at {place}");
        }
    }
}

#[test]
fn the_documented_example_reads() {
    let page = include_str!("../../../../docs/formats.md");
    let example = page.split("```").nth(1).and_then(|block| block.strip_prefix("toml")).expect("a block of TOML");
    let setup = Setup::from_toml(example, Path::new("formats.md")).expect("the example is right");
    // Its light looks straight down with `up` along the axis, which gives way to +Z.
    assert_eq!((setup.lights[0].axis, setup.lights[0].up), (Vec3::NEG_Y, Vec3::Z));
}
