//! Every technique with translucent casters: alpha is coverage, transmission tints.

use antumbra::TechniqueKind;
use antumbra_lab::device::LabDevice;
use antumbra_lab::metrics::compare_visibility;
use antumbra_lab::picture::Visibility;
use antumbra_lab::progress::Silent;
use antumbra_lab::technique_run::{TechniqueChoice, create};
use antumbra_lab::truth::{LightTruth, trace};
use antumbra_lab::view::View;
use antumbra_light::{Light, LightShape};
use antumbra_reference::VisibilityOptions;
use antumbra_scene::{
    AlphaMode, Camera, Image, Instance, LoadOptions, Material, Mesh, Scene, Setup, Volume, Wrap, load,
};
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::common::{case_file, lab};

/// Techniques that say that translucent casters dim and tint their light.
fn knowing() -> Vec<TechniqueKind> {
    TechniqueKind::ALL.iter().copied().filter(|kind| kind.facts().translucent).collect()
}

/// One technique of each other family, which treats a caster as opaque or absent.
const OF_EACH_OTHER_FAMILY: [TechniqueKind; 4] =
    [TechniqueKind::Hard, TechniqueKind::Vsm, TechniqueKind::Essm, TechniqueKind::Reprojection];

const SIZE: UVec2 = UVec2::new(96, 54);

/// A sheet of 2 `half` metres at `height`, facing up, with texture coordinates from 0 to 1.
fn sheet(half: f32, height: f32, material: usize) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0f32)];
    Mesh {
        positions: corners.map(|(x, z)| Vec3::new(half * x, height, half * z)).to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: corners.map(|(x, z)| 0.5 * Vec2::new(x, z) + 0.5).to_vec(),
        indices: vec![0, 2, 1, 0, 3, 2],
        material,
        ..Mesh::default()
    }
}

/// Cards of a material above a floor, one above the other. The camera looks at the centre of their shadow, past the cards.
fn cards(heights: &[f32], material: Material, images: Vec<Image>) -> (Scene, Setup) {
    let mut meshes = vec![sheet(4.0, 0.0, 0)];
    meshes.extend(heights.iter().map(|height| sheet(0.5, *height, 1)));
    let instances = (0..meshes.len()).map(|mesh| Instance { mesh, world_from_object: Mat4::IDENTITY }).collect();
    let scene = Scene {
        name: "cards".into(),
        meshes,
        materials: vec![Material::default(), material],
        images,
        instances,
        ..Scene::default()
    };
    let camera = Camera {
        eye: Vec3::new(0.0, 6.0, 6.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov_y_rad: 0.7,
        near_m: 0.05,
        far_m: 100.0,
        shadow_distance: None,
    };
    let light = Light::new(LightShape::Rectangle { size_m: Vec2::splat(0.05) }, Vec3::Y * 4.0, Vec3::ZERO);
    (scene, Setup { camera, lights: vec![light] })
}

fn run(lab: &LabDevice, scene: &Scene, setup: &Setup, kind: TechniqueKind, size_px: UVec2) -> Visibility {
    run_with(lab, scene, setup, &TechniqueChoice::default_of(kind), size_px)
}

fn run_with(lab: &LabDevice, scene: &Scene, setup: &Setup, choice: &TechniqueChoice, size_px: UVec2) -> Visibility {
    let mut technique = create(&lab.gpu(), choice).expect("good settings");
    let view = View::new(lab, scene, setup, size_px).expect("a good scene");
    let visibility = view.draw(&mut technique, 0, 1).expect("a good frame").visibility;
    lab.check().expect("no validation error");
    visibility
}

fn truth(scene: &Scene, setup: &Setup, size_px: UVec2) -> LightTruth {
    let options = VisibilityOptions { samples: 256, ..VisibilityOptions::default() };
    trace(scene, setup, size_px, &options, &Silent).expect("a good scene").swap_remove(0)
}

/// Red, green and blue at the image's centre.
fn in_the_middle(visibility: &Visibility) -> Vec3 {
    let middle = (SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize;
    Vec3::from_array([0, 1, 2].map(|channel| visibility.at(middle, channel.min(visibility.channel_count() - 1))))
}

/// Checks the centre of the cards' shadow: `passes` within `slack` for techniques that support translucency, and 0 or 1 for
/// one of each other family.
fn check(lab: &LabDevice, name: &str, cards: &(Scene, Setup), passes: Vec3, slack: f32, channels: usize) {
    let kinds = [&knowing()[..], &OF_EACH_OTHER_FAMILY].concat();
    check_by(lab, &kinds, name, cards, passes, slack, channels);
}

/// Checks these techniques.
fn check_by(
    lab: &LabDevice,
    kinds: &[TechniqueKind],
    name: &str,
    (scene, setup): &(Scene, Setup),
    passes: Vec3,
    slack: f32,
    channels: usize,
) {
    let traced = truth(scene, setup, SIZE);
    assert!(
        in_the_middle(&traced.visibility).abs_diff_eq(passes, slack.max(4e-3)),
        "{name}: {}",
        in_the_middle(&traced.visibility)
    );
    assert_eq!(traced.visibility.channel_count(), channels, "{name}");
    let stops = 1.0 - passes.dot(Vec3::new(0.2126, 0.7152, 0.0722));
    let as_opaque = Vec3::splat(if stops >= 0.5 { 0.0 } else { 1.0 });
    for &kind in kinds {
        let knows = kind.facts().translucent;
        // The others need no fine maps: the shadow's centre is fifteen texels from its edge in small maps.
        let is_small = |key: &&str| !knows && kind.param_specs().iter().any(|spec| spec.key == *key);
        let small = ["map_size", "view_size"].into_iter().filter(is_small);
        let settings = small.map(|key| (key.to_owned(), "256".to_owned())).collect();
        let visibility = run_with(lab, scene, setup, &TechniqueChoice::with_settings(kind, settings), SIZE);
        let v = in_the_middle(&visibility);
        // Filtered maps leak slightly.
        let (want, slack) = if knows { (in_the_middle(&traced.visibility), slack) } else { (as_opaque, 0.03) };
        assert!(v.abs_diff_eq(want, slack), "{name}: {kind} has {v} where {want} is right");
        assert_eq!(visibility.channel_count(), channels, "{name}: {kind}");
    }
}

fn blended(color: Vec4) -> Material {
    Material { base_color: color, alpha: AlphaMode::Blend, ..Material::default() }
}

#[test]
fn alpha_covers_and_never_tints() {
    let Some(lab) = lab() else { return };
    for (name, color) in [
        ("white, alpha 1", Vec4::ONE),
        ("red, alpha .5", Vec4::new(1.0, 0.0, 0.0, 0.5)),
        ("red, alpha .25", Vec4::new(1.0, 0.0, 0.0, 0.25)),
    ] {
        let passes = Vec3::splat(1.0 - color.w);
        check_by(lab, TechniqueKind::ALL, name, &cards(&[1.0], blended(color), Vec::new()), passes, 0.016, 1);
    }
}

#[test]
fn alpha_of_vertices_and_textures_covers() {
    let Some(lab) = lab() else { return };
    let texels = [[255, 0, 0, 102], [255, 0, 0, 102]];
    let image = Image { width: 2, height: 1, rgba8: texels.to_vec(), wrap: [Wrap::Clamp; 2] };
    let textured = Material { base_color_image: Some(0), ..blended(Vec4::new(1.0, 1.0, 1.0, 0.75)) };
    check(lab, "textured", &cards(&[1.0], textured, vec![image]), Vec3::splat(0.7), 0.016, 1);
    let mut faded = cards(&[1.0], blended(Vec4::ONE), Vec::new());
    // Alpha falls from 1 to .5 along the card.
    faded.0.meshes[1].colors = [1.0, 0.5, 0.5, 1.0].map(|alpha| Vec3::ONE.extend(alpha)).to_vec();
    check(lab, "vertices", &faded, Vec3::splat(0.25), 0.03, 1);
}

#[test]
fn transmission_tints_by_metalness_and_volume() {
    let Some(lab) = lab() else { return };
    let glass = Material { base_color: Vec4::new(1.0, 0.5, 0.25, 0.3), transmission: 0.8, ..Material::default() };
    let tint = Vec3::new(0.8, 0.4, 0.2);
    check_by(lab, TechniqueKind::ALL, "glass", &cards(&[1.0], glass.clone(), Vec::new()), tint, 0.02, 3);
    let half_metal = Material { metallic: 0.5, ..glass.clone() };
    check(lab, "half of metal", &cards(&[1.0], half_metal, Vec::new()), 0.5 * tint, 0.02, 3);
    let metal = Material { metallic: 1.0, ..glass.clone() };
    check(lab, "metal", &cards(&[1.0], metal, Vec::new()), Vec3::ZERO, 4e-3, 1);
    let absorbs = Volume {
        thickness_m: 0.1,
        thickness_image: None,
        attenuation_color: Vec3::new(1.0, 0.25, 0.25),
        attenuation_distance_m: 0.2,
    };
    let volume = Material { base_color: Vec4::ONE, transmission: 1.0, volume: Some(absorbs), ..Material::default() };
    check(lab, "volume", &cards(&[1.0], volume, Vec::new()), Vec3::new(1.0, 0.5, 0.5), 0.02, 3);
    let both = Material { alpha: AlphaMode::Blend, ..glass };
    check(lab, "blended glass", &cards(&[1.0], both, Vec::new()), 0.7 + 0.3 * tint, 0.02, 3);
}

#[test]
fn transmission_is_of_texels() {
    let Some(lab) = lab() else { return };
    // Half of the card is glass. The shadow's centre is at the border and is not tested.
    let texels = (0..16).map(|x| [if x < 8 { 0 } else { 255 }, 7, 7, 7]).collect();
    let image = Image { width: 16, height: 1, rgba8: texels, wrap: [Wrap::Clamp; 2] };
    let glass = Material { transmission: 1.0, transmission_image: Some(0), ..Material::default() };
    let (scene, setup) = cards(&[1.0], glass, vec![image]);
    let traced = truth(&scene, &setup, SIZE);
    for kind in [&knowing()[..], &OF_EACH_OTHER_FAMILY].concat() {
        let visibility = run(lab, &scene, &setup, kind, SIZE);
        let metrics = compare_visibility(&traced.visibility, &visibility, &traced.judged).expect("images of one size");
        // Without glass, or with glass alone, the error is at least .12; a hard edge has .045.
        let rmse = metrics.rmse.expect("judged pixels");
        println!("half of glass: {kind}: rmse {rmse:.4}");
        assert!(rmse < if kind.facts().translucent { 0.02 } else { 0.07 }, "{kind}: rmse {rmse}");
    }
}

#[test]
fn surfaces_in_a_row_multiply() {
    let Some(lab) = lab() else { return };
    // The two faces of a closed box are surfaces in a row, too.
    for heights in [&[1.0, 1.2][..], &[0.8, 1.0, 1.2]] {
        let passes = Vec3::splat(0.5f32.powi(heights.len() as i32));
        check(
            lab,
            "half, again and again",
            &cards(heights, blended(Vec4::new(0.0, 1.0, 0.0, 0.5)), Vec::new()),
            passes,
            0.1,
            1,
        );
    }
}

#[test]
fn files_of_reports_have_their_shadows() {
    let Some(lab) = lab() else { return };
    let size_px = UVec2::new(160, 90);
    for case in [
        "blend_a1_1",
        "blend_0.5",
        "blend_cubes",
        "node_visibility_used",
        "node_visibility_required",
        "webp_used_no_fallback",
        "webp_required",
        "transmission_metal_1.0",
        "transmissionTexture_at_0",
        "volume_red_10cm",
    ] {
        let Some((file, setup)) = case_file(case) else { return };
        let scene = load(&file, &LoadOptions::default()).expect("a good scene");
        let traced = truth(&scene, &setup, size_px);
        for kind in [TechniqueKind::SampleBased, TechniqueKind::MultiView, TechniqueKind::MultiLayer] {
            let visibility = run(lab, &scene, &setup, kind, size_px);
            let metrics =
                compare_visibility(&traced.visibility, &visibility, &traced.judged).expect("images of one size");
            let rmse = metrics.rmse.expect("judged pixels");
            println!("{case}: {kind}: rmse {rmse:.4}");
            assert!(rmse <= 0.02, "{case}: {kind}: rmse {rmse}");
        }
    }
}
