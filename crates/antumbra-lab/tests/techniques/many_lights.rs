//! `examples/many_lights`, a renderer that uses nothing of this project but the library: its masks against the ray tracer,
//! and against the laboratory's masks of the same scene.

use antumbra::Casters;
use antumbra_lab::device::LabDevice;
use antumbra_lab::gpu_scene::GpuScene;
use antumbra_lab::metrics::compare_visibility;
use antumbra_lab::picture::{Visibility, pixel_count};
use antumbra_lab::progress::Silent;
use antumbra_lab::readback::{read_f32, read_f32_layer, read_rgba8};
use antumbra_lab::receivers::{Layer, ReceiverImages, ReceiverPass};
use antumbra_lab::technique_run::{TechniqueChoice, create, draw};
use antumbra_lab::truth::{LightTruth, SurfacePoint, trace};
use antumbra_light::{Aabb, Light};
use antumbra_reference::VisibilityOptions;
use antumbra_scene::{AlphaMode, Camera, Image, Instance, Material, Mesh, Scene, Setup, Wrap};
use glam::{DVec2, UVec2, Vec2, Vec3};

use crate::common::lab;
use crate::edge_cases::usual_bound;

#[path = "../../../../examples/many_lights/buffers.rs"]
mod buffers;
#[path = "../../../../examples/many_lights/meshes.rs"]
mod meshes;
#[path = "../../../../examples/many_lights/pipelines.rs"]
mod pipelines;
#[path = "../../../../examples/many_lights/renderer.rs"]
mod renderer;
#[path = "../../../../examples/many_lights/scene.rs"]
mod scene;
#[path = "../../../../examples/many_lights/shadows.rs"]
mod shadows;

use meshes::{LEAF_SIZE, PACKED_OFFSET, PACKED_SCALE, Vertex, VertexBuffer, leaf_texels};
use renderer::Renderer;

const VIEW_SIZE: UVec2 = UVec2::new(96, 72);
const FRAMES: usize = 6;
/// Number of frames after which no resource is created.
const SETTLED: usize = 2;
/// Allowance on RMSE for different rounding: depth from 0 to 1, 16-bit positions, half-precision normals. It may change one
/// pixel of three thousand from dark to lit, at a contact with the ground.
const ROUNDING: f64 = 0.004;

#[test]
fn masks_of_a_foreign_renderer_are_as_good_as_the_laboratory_s() {
    let Some(lab) = lab() else { return };
    let mut renderer = Renderer::new(&lab.device, &lab.queue, VIEW_SIZE).expect("any device");
    let first_masks = draw_frames(lab, &mut renderer);
    let picture = read_rgba8(lab, renderer.targets.color.texture()).expect("a device that works");
    let sky = picture.iter().filter(|texel| **texel == picture[0]).count();
    assert!(sky < picture.len() / 2, "{sky} texels of sky");

    let scene = lab_scene(&renderer.scene);
    let gpu_scene = GpuScene::upload(lab, &scene);
    for (view, first_masks) in first_masks.iter().enumerate() {
        let setup = Setup { camera: lab_camera(&renderer.scene.cameras[view]), lights: renderer.scene.lights.to_vec() };
        let options = VisibilityOptions { samples: 256, ..VisibilityOptions::default() };
        let mut truths = trace(&scene, &setup, VIEW_SIZE, &options, &Silent).expect("a scene that can be traced");
        let images = ReceiverPass::new(lab)
            .render(lab, &gpu_scene, &setup.camera, VIEW_SIZE, Layer::FirstHits)
            .expect("a scene that can be seen");
        let seen = drawn_surfaces(lab, &renderer, view, &images);
        for (i, (light, truth)) in setup.lights.iter().zip(&mut truths).enumerate() {
            let others =
                truth.unjudge_mismatched_surfaces(&seen, setup.camera.eye) + judge_no_edge_of_reach(truth, light);
            let judged = truth.judged.iter().filter(|judged| **judged).count();
            let mask = read_mask(lab, &renderer, view, i);
            let lab_mask = lab_mask(lab, &renderer, (view, i), &gpu_scene, &images);
            let [ours, of_lab, before] = [&mask, &lab_mask, &first_masks[i]].map(|mask| rmse(truth, mask));
            let kind = renderer.shadows.of_light(view, i).kind();
            let who = format!("view {view}, {}, {kind}", light.name);
            println!(
                "{who}: rmse {ours:.4}, and the laboratory's {of_lab:.4}, over {judged} pixels, {others} not judged; \
                 the first frame's {before:.4}"
            );
            let bound = usual_bound(kind).expect("a bound of every technique");
            assert!(judged > 500 && others < 10, "{who}: {judged} pixels, and {others} not judged");
            assert!(ours <= f64::from(bound), "{who}: rmse {ours} against {bound}");
            assert!(ours <= of_lab + ROUNDING, "{who}: rmse {ours} against the laboratory's {of_lab}");
            assert!(before > 4.0 * ours, "{who}: the first frame's mask is off by {before}, this one's by {ours}");
        }
    }
}

/// Draws frames in which everything moves. Returns the masks of the first frame by view.
fn draw_frames(lab: &LabDevice, renderer: &mut Renderer) -> [Vec<Visibility>; 2] {
    let mut made = vec![renderer.shadows.gpu().objects_created()];
    let mut first_masks = [Vec::new(), Vec::new()];
    // The path is repeated, because a light's parts create maps when the camera first sees their receivers.
    for frame in (0..FRAMES).chain(0..FRAMES) {
        renderer.draw(0.2 * frame as f32).expect("a good frame");
        lab.check().expect("no error");
        made.push(renderer.shadows.gpu().objects_created());
        if made.len() == 2 {
            let lights = 0..renderer.scene.lights.len();
            first_masks = [0, 1].map(|view| lights.clone().map(|i| read_mask(lab, renderer, view, i)).collect());
        }
    }
    assert_eq!(made[0].programs, made[FRAMES].programs, "warm-ups compile what frames need");
    // The size of lists of `multi_layer` follows the visible receivers, so lists may be recreated.
    let maps = |frame: usize| (made[frame].programs, made[frame].textures);
    assert_eq!(maps(FRAMES + SETTLED), maps(2 * FRAMES), "frames that only move make no maps");
    first_masks
}

fn read_mask(lab: &LabDevice, renderer: &Renderer, view: usize, light: usize) -> Visibility {
    let values = read_f32_layer(lab, renderer.shadows.masks(view), light as u32).expect("a device that works");
    assert!(values.iter().all(|v| (0.0..=1.0).contains(v)), "view {view}, light {light}: not in [0, 1]");
    Visibility::one(VIEW_SIZE, values)
}

/// Draws the laboratory's mask of a light with the same technique and parameters, from casters and receivers in its own formats.
/// Receivers' optional inputs are omitted as in the example, and casters have the example's bounds, to which light maps are fitted.
fn lab_mask(
    lab: &LabDevice,
    renderer: &Renderer,
    (view, light): (usize, usize),
    scene: &GpuScene,
    images: &ReceiverImages,
) -> Visibility {
    let shadow = renderer.shadows.of_light(view, light);
    let settings = shadow.params().map(|(spec, value)| (spec.key.to_owned(), value.to_string())).collect();
    // The renderer's handle has compiled the pipelines.
    let choice = TechniqueChoice::with_settings(shadow.kind(), settings);
    let mut technique = create(renderer.shadows.gpu(), &choice).expect("good settings");
    let receivers = images.receivers().with_bounds(None).with_hull(&[]).with_seen(&[]);
    let mut casters = scene.casters();
    assert_eq!(casters.len(), renderer.scene.objects.len());
    for (caster, object) in casters.iter_mut().zip(&renderer.scene.objects) {
        let matrices = object.world_from_object.iter();
        caster.bounds = Aabb::of(matrices.flat_map(|m| object.part.bounds.corners().map(|p| m.transform_point3(p))));
    }
    draw(lab, &mut technique, &renderer.scene.lights[light], Casters::Meshes(&casters), receivers, 1)
        .expect("a good frame")
        .visibility
}

fn rmse(truth: &LightTruth, mask: &Visibility) -> f64 {
    let metrics = compare_visibility(&truth.visibility, mask, &truth.judged).expect("images of one size");
    metrics.rmse.expect("judged pixels")
}

/// Excludes the pixels at the edge of a light's frustum, which rounding puts on either side, and returns their number.
fn judge_no_edge_of_reach(truth: &mut LightTruth, light: &Light) -> usize {
    let Some(fov) = light.fov_rad else { return 0 };
    let frame = light.frame();
    let [narrower, wider] = [0.9999, 1.0001].map(|factor| Light { fov_rad: Some(factor * fov), ..light.clone() });
    let mut at_edge = 0;
    for (judged, hit) in truth.judged.iter_mut().zip(truth.first_hits.iter()) {
        let Some(hit) = hit else { continue };
        if narrower.reaches(&frame, hit.position) != wider.reaches(&frame, hit.position) {
            at_edge += usize::from(*judged);
            *judged = false;
        }
    }
    at_edge
}

/// Surfaces of a view by pixel: positions from the example's depth, with normals from the laboratory's image.
fn drawn_surfaces(
    lab: &LabDevice,
    renderer: &Renderer,
    view: usize,
    images: &ReceiverImages,
) -> Vec<Option<SurfacePoint>> {
    let depth = read_f32(lab, renderer.targets.depth.texture()).expect("a device that works");
    let camera = &renderer.scene.cameras[view];
    let size = VIEW_SIZE.as_dvec2();
    let view_from_clip = camera.clip_from_view((size.x / size.y) as f32).as_dmat4().inverse();
    let world_from_view = camera.view_from_world().as_dmat4().inverse();
    let position = |i: usize| {
        let (x, y) = (i % VIEW_SIZE.x as usize, i / VIEW_SIZE.x as usize);
        let depth = depth[(2 * y + view) * VIEW_SIZE.x as usize + x];
        let ndc = (DVec2::new(x as f64, y as f64) + 0.5) / size * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
        let in_view = view_from_clip.project_point3(ndc.extend(f64::from(depth)));
        (depth < 1.0).then(|| world_from_view.transform_point3(in_view).as_vec3())
    };
    let of_lab = images.read_surface_points(lab).expect("a device that works");
    let surface = |(i, of_lab): (usize, Option<SurfacePoint>)| {
        // The normal is zero if only the example shows a surface.
        let normal = of_lab.map_or(Vec3::ZERO, |point| point.normal);
        position(i).map(|position| SurfacePoint { position, normal })
    };
    assert_eq!(of_lab.len(), pixel_count(VIEW_SIZE));
    of_lab.into_iter().enumerate().map(surface).collect()
}

fn lab_camera(camera: &scene::Camera) -> Camera {
    let scene::Camera { eye, target, fov_y_rad, near_m, far_m } = *camera;
    Camera { eye, target, up: Vec3::Y, fov_y_rad, near_m, far_m, shadow_distance: None }
}

/// The example's current scene in the laboratory's format: unpacking and skinning, which the GPU does, are done here.
fn lab_scene(example: &scene::Scene) -> Scene {
    let rgba8 = leaf_texels();
    let leaf = Image { width: LEAF_SIZE, height: LEAF_SIZE, rgba8, wrap: [Wrap::Clamp; 2] };
    let mut lab_scene = Scene { name: "many_lights".into(), images: vec![leaf], ..Scene::default() };
    for (material, object) in example.objects.iter().enumerate() {
        let mesh = Mesh { material, ..lab_mesh(example, &object.part) };
        let corners = Aabb::of(mesh.indices.iter().map(|i| mesh.positions[*i as usize]));
        let (told, room) = (object.part.bounds, 1e-4);
        assert!(corners.min.cmpge(told.min - room).all(), "{corners:?} in {told:?}");
        assert!(corners.max.cmple(told.max + room).all(), "{corners:?} in {told:?}");
        lab_scene.meshes.push(mesh);
        let instance = |matrix: &_| Instance { mesh: material, world_from_object: *matrix };
        lab_scene.instances.extend(object.world_from_object.iter().map(instance));
        let has_holes = object.alpha_cutoff > 0.0;
        lab_scene.materials.push(Material {
            base_color_image: has_holes.then_some(0),
            alpha: if has_holes { AlphaMode::Mask { cutoff: object.alpha_cutoff } } else { AlphaMode::Opaque },
            ..Material::default()
        });
    }
    lab_scene
}

fn lab_mesh(example: &scene::Scene, part: &meshes::Part) -> Mesh {
    let range = part.vertices.start as usize..part.vertices.end as usize;
    let (positions, uvs): (Vec<Vec3>, Vec<Vec2>) = match part.buffer {
        VertexBuffer::Plain => example.meshes.vertices[range].iter().map(|v| (v.position, v.uv)).unzip(),
        VertexBuffer::Skinned => {
            example.meshes.skin_vertices[range].iter().map(|v| (skinned(example, v), v.uv)).unzip()
        }
        VertexBuffer::Packed => {
            let unpacked = |vertex: &meshes::PackedVertex| {
                let [x, y, z, _] = vertex.position.map(|v| f32::from(v) / 32767.0);
                (Vec3::new(x, y, z) * PACKED_SCALE + PACKED_OFFSET, Vec2::ZERO)
            };
            example.meshes.packed_vertices[range].iter().map(unpacked).unzip()
        }
    };
    let indices = &example.meshes.indices[part.indices.start as usize..part.indices.end as usize];
    Mesh {
        normals: vec![Vec3::Y; positions.len()],
        positions,
        uvs,
        indices: indices.iter().map(|i| u32::from(*i) + part.base_vertex).collect(),
        closed: part.is_closed,
        ..Mesh::default()
    }
}

/// Linear blend skinning.
fn skinned(example: &scene::Scene, vertex: &Vertex) -> Vec3 {
    let by_joint = vertex.joints.iter().zip(vertex.weights).map(|(joint, weight)| {
        f32::from(weight) / 255.0 * example.joints[usize::from(*joint)].transform_point3(vertex.position)
    });
    by_joint.sum()
}
