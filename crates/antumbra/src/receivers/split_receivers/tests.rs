//! Tests with a square above a ground, drawn with four samples per pixel, against what each sample's ray hits.

use glam::camera::rh::{proj, view};
use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};

use super::SplitReceivers;
use crate::TechniqueKind;
use crate::contract::{DepthConvention, Mask, Receivers};
use crate::gpu::{Gpu, Recorder, depth_state};
use crate::shadow::{Casters, Frame};
use crate::testing::{Mesh, gpu, read_layer, run, view_of};

const SIZE: UVec2 = UVec2::new(72, 56);
const ORIGIN: UVec2 = UVec2::new(9, 5);
const SHEET_HEIGHT: f32 = 1.0;
const SHEET: [Vec2; 2] = [Vec2::new(-1.3, -1.1), Vec2::new(1.2, 0.75)];
const GROUND: [Vec2; 2] = [Vec2::splat(-4.0), Vec2::splat(4.0)];

/// Positions of WebGPU's four samples in a pixel.
const SAMPLES: [Vec2; 4] =
    [Vec2::new(0.375, 0.125), Vec2::new(0.875, 0.375), Vec2::new(0.125, 0.625), Vec2::new(0.625, 0.875)];

struct Camera {
    view_from_world: Mat4,
    clip_from_view: Mat4,
    convention: DepthConvention,
}

impl Camera {
    fn new(convention: DepthConvention) -> Self {
        let aspect = SIZE.x as f32 / SIZE.y as f32;
        let clip_from_view = match convention {
            DepthConvention::Reversed => proj::directx::perspective_infinite_reverse(0.8, aspect, 0.1),
            DepthConvention::Standard => proj::directx::perspective(0.8, aspect, 0.1, 30.0),
        };
        // Rolled, so that depth changes along rows and columns.
        let up = Vec3::new(0.35, 1.0, 0.0);
        let view_from_world = view::look_at_mat4(Vec3::new(1.5, 3.2, 4.5), Vec3::new(0.1, 0.2, 0.0), up);
        Self { view_from_world, clip_from_view, convention }
    }

    /// Returns where the ray through an image position hits the plane at a height, and its depth there.
    fn at_height(&self, place_px: Vec2, height: f32) -> (Vec3, f32) {
        let ndc = place_px / SIZE.as_vec2() * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        let clip_from_world = self.clip_from_view.as_dmat4() * self.view_from_world.as_dmat4();
        let through = |depth: f64| clip_from_world.inverse().project_point3(ndc.as_dvec2().extend(depth));
        let (a, b) = (through(0.9), through(0.99));
        let pos = a + (b - a) * ((f64::from(height) - a.y) / (b.y - a.y));
        (pos.as_vec3(), clip_from_world.project_point3(pos).z as f32)
    }

    fn receivers<'a>(&self, depth: &'a wgpu::TextureView, normals: Option<&'a wgpu::TextureView>) -> Receivers<'a> {
        Receivers {
            size_px: SIZE,
            origin_px: ORIGIN,
            depth,
            depth_convention: self.convention,
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            normals,
            bounds: None,
            hull: &[],
            seen: &[],
            shadow_distance: None,
            version: None,
        }
    }
}

/// Shaders of a host, with a normal per vertex.
const HOST_WGSL: &str = "
    struct Varyings { @builtin(position) clip: vec4f, @location(0) normal: vec4f }
    @vertex fn vertex(@location(0) clip: vec4f, @location(1) normal: vec4f) -> Varyings {
        return Varyings(clip, normal);
    }
    @fragment fn draw(in: Varyings) -> @location(0) vec4f { return in.normal; }
";

fn host_pipeline(gpu: &Gpu, convention: DepthConvention, samples: u32) -> wgpu::RenderPipeline {
    let device = gpu.device();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(HOST_WGSL.into()),
    });
    let compare = match convention {
        DepthConvention::Reversed => wgpu::CompareFunction::Greater,
        DepthConvention::Standard => wgpu::CompareFunction::Less,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 32,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
            })],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(depth_state(wgpu::TextureFormat::Depth32Float, compare, true)),
        multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba16Float.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Returns two triangles per rectangle: clip position, normal.
fn host_vertices(camera: &Camera, rectangles: &[(f32, [Vec2; 2])]) -> Vec<Vec4> {
    let clip_from_world = camera.clip_from_view * camera.view_from_world;
    rectangles
        .iter()
        .flat_map(|(height, [min, max])| {
            let corners = [*min, Vec2::new(min.x, max.y), *max, *min, *max, Vec2::new(max.x, min.y)];
            corners
                .map(|c| [clip_from_world * Vec4::new(c.x, *height, c.y, 1.0), Vec4::new(0.0, 1.0 + height, 0.0, 0.0)])
        })
        .flatten()
        .collect()
}

/// Draws as a host: rectangles at heights, with upward normals that distinguish them.
fn draw(gpu: &Gpu, camera: &Camera, rectangles: &[(f32, [Vec2; 2])], samples: u32) -> [wgpu::Texture; 2] {
    let vertices = host_vertices(camera, rectangles);
    let device = gpu.device();
    let pipeline = host_pipeline(gpu, camera.convention, samples);
    let [depth, normals] = [wgpu::TextureFormat::Depth32Float, wgpu::TextureFormat::Rgba16Float].map(|format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE.x + 20, height: SIZE.y + 11, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        })
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: size_of_val(vertices.as_slice()) as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&vertices));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let (depth_view, normals_view) = (view_of(&depth), view_of(&normals));
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &normals_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(camera.convention.background()),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..wgpu::RenderPassDescriptor::default()
    });
    let (origin, size) = (ORIGIN.as_vec2(), SIZE.as_vec2());
    pass.set_viewport(origin.x, origin.y, size.x, size.y, 0.0, 1.0);
    pass.set_pipeline(&pipeline);
    pass.set_vertex_buffer(0, buffer.slice(..));
    pass.draw(0..vertices.len() as u32 / 2, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    [depth, normals]
}

/// Returns the distance of a position from a rectangle's edges: negative outside.
fn margin([min, max]: [Vec2; 2], pos: Vec3) -> f32 {
    let p = Vec2::new(pos.x, pos.z);
    (p - min).min(max - p).min_element()
}

/// Returns the heights of a pixel's nearest and farthest surface, by its samples' rays, each `None` for background; `None` if a
/// sample is too near to an edge.
fn surfaces(camera: &Camera, pixel: UVec2) -> Option<[Option<f32>; 2]> {
    let mut seen = [false; 3];
    for sample in SAMPLES {
        let place_px = pixel.as_vec2() + sample;
        let sheet = margin(SHEET, camera.at_height(place_px, SHEET_HEIGHT).0);
        let ground = margin(GROUND, camera.at_height(place_px, 0.0).0);
        if sheet.abs() < 2e-3 || ground.abs() < 2e-3 {
            return None;
        }
        seen[if sheet > 0.0 {
            0
        } else if ground > 0.0 {
            1
        } else {
            2
        }] = true;
    }
    let heights = [Some(SHEET_HEIGHT), Some(0.0)];
    let of = |i: usize| heights.get(i).copied().flatten();
    let front = seen.iter().position(|seen| *seen)?;
    let back = if seen[0] && seen[1] { Some(0.0) } else { None };
    Some([of(front), back])
}

/// Whether a pixel or one beside it, and a pixel that shares a side with that one, show only the surface at a height: narrower
/// strips have the depth of a sample elsewhere in the pixel.
fn is_wide(camera: &Camera, pixel: UVec2, height: f32) -> bool {
    let is_whole = |at: glam::IVec2| {
        let is_in = at.cmpge(glam::IVec2::ZERO).all() && at.cmplt(SIZE.as_ivec2()).all();
        let sees = |sample: &Vec2| {
            let sheet = margin(SHEET, camera.at_height(at.as_vec2() + *sample, SHEET_HEIGHT).0) > 0.0;
            let ground = margin(GROUND, camera.at_height(at.as_vec2() + *sample, 0.0).0) > 0.0;
            if height > 0.0 { sheet } else { ground && !sheet }
        };
        is_in && SAMPLES.iter().all(sees)
    };
    let sides = [glam::IVec2::X, glam::IVec2::NEG_X, glam::IVec2::Y, glam::IVec2::NEG_Y];
    let around = (-1..=1).flat_map(|y| (-1..=1).map(move |x| glam::IVec2::new(x, y)));
    around.map(|step| pixel.as_ivec2() + step).any(|at| is_whole(at) && sides.iter().any(|side| is_whole(at + *side)))
}

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)))
}

fn texel<T: Copy>(values: &[T], pixel: UVec2) -> T {
    values[(pixel.y * SIZE.x + pixel.x) as usize]
}

#[test]
fn pictures_hold_both_surfaces_of_edges_at_the_pixels_centre() {
    let Some(gpu) = gpu() else { return };
    for convention in [DepthConvention::Reversed, DepthConvention::Standard] {
        let camera = Camera::new(convention);
        let drawn = draw(gpu, &camera, &[(0.0, GROUND), (SHEET_HEIGHT, SHEET)], 4);
        let [depth, normals] = drawn.each_ref().map(view_of);
        for normals in [None, Some(&normals)] {
            let receivers = camera.receivers(&depth, normals);
            let mut split = SplitReceivers::new(gpu);
            let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            split.record(&mut Recorder::new(&mut encoder, None), &receivers).expect("four samples");
            gpu.queue.submit([encoder.finish()]);
            let pictures = split.images(&receivers);
            let depths = [0, 1].map(|layer| -> Vec<f32> {
                bytemuck::pod_collect_to_vec(&read_layer(gpu, pictures[0].depth.texture(), layer))
            });
            let mut on_edges = 0;
            for pixel in pixels() {
                let Some(heights) = surfaces(&camera, pixel) else { continue };
                if heights.iter().flatten().any(|height| !is_wide(&camera, pixel, *height)) {
                    continue;
                }
                for (picture, height) in heights.into_iter().enumerate() {
                    let had = texel(&depths[picture], pixel);
                    let expected = height
                        .map_or(convention.background(), |height| camera.at_height(pixel.as_vec2() + 0.5, height).1);
                    // Some units in the last place, and the extrapolation's error.
                    let tolerance = if height.is_some() { 4e-6 } else { 0.0 };
                    assert!(
                        (had - expected).abs() <= tolerance,
                        "{convention:?} picture {picture} at {pixel}: {had}, not {expected}"
                    );
                }
                on_edges += u32::from(heights[1].is_some());
            }
            assert!(on_edges > 30, "{on_edges} pixels of two surfaces");
            check_normals(gpu, &camera, &pictures, normals.is_some());
        }
    }
}

/// Checks that derived normals are upright, and that a host's are those of the surface.
fn check_normals(gpu: &Gpu, camera: &Camera, pictures: &[Receivers<'_>; 2], are_host_s: bool) {
    for (layer, picture) in pictures.iter().enumerate() {
        let texture = picture.normals.expect("pictures have normals").texture();
        let bytes = read_layer(gpu, texture, layer as u32);
        let values: Vec<Vec4> = if are_host_s {
            let halves: Vec<[u16; 4]> = bytemuck::pod_collect_to_vec(&bytes);
            halves.into_iter().map(|h| Vec4::from(h.map(crate::testing::f32_of_half))).collect()
        } else {
            bytemuck::pod_collect_to_vec(&bytes)
        };
        for pixel in pixels() {
            let Some(Some(height)) = surfaces(camera, pixel).map(|heights| heights[layer]) else { continue };
            if !is_wide(camera, pixel, height) {
                continue;
            }
            let normal = texel(&values, pixel).truncate();
            if are_host_s {
                assert!((normal.y - 1.0 - height).abs() < 0.01, "the surface's own, at {pixel}: {normal}");
            } else {
                assert!(normal.y.abs() > 0.9999, "upright at {pixel}: {normal}");
            }
        }
    }
}

/// A surface has the same shadow as when it is drawn alone, up to its edges.
#[test]
fn masks_of_both_pictures_are_those_of_each_surface_alone() {
    let Some(gpu) = gpu() else { return };
    let camera = Camera::new(DepthConvention::Reversed);
    let sheet = Mesh::horizontal(gpu, SHEET[0], SHEET[1], SHEET_HEIGHT);
    let light = antumbra_light::Light::new(
        antumbra_light::LightShape::Disk { radius_m: 0.4 },
        Vec3::new(0.9, 4.0, 0.3),
        Vec3::ZERO,
    );
    let casters = [sheet.caster()];
    let mut shadow = TechniqueKind::SampleBased.create(gpu).expect("any device");
    let mut visibility = |receivers: Receivers<'_>| {
        let mask = Mask::new(gpu.device(), SIZE);
        let frame = Frame { light: &light, casters: Casters::Meshes(&casters), receivers, mask: &mask };
        run(gpu, &mut shadow, &frame).expect("a good frame")
    };
    let mut alone = |rectangle| {
        let [depth, _] = draw(gpu, &camera, &[rectangle], 1);
        visibility(camera.receivers(&view_of(&depth), None))
    };
    let (ground, sheet_alone) = (alone((0.0, GROUND)), alone((SHEET_HEIGHT, SHEET)));
    let [depth, _] = draw(gpu, &camera, &[(0.0, GROUND), (SHEET_HEIGHT, SHEET)], 4).map(|texture| view_of(&texture));
    let receivers = camera.receivers(&depth, None);
    let mut split = SplitReceivers::new(gpu);
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    split.record(&mut Recorder::new(&mut encoder, None), &receivers).expect("four samples");
    gpu.queue.submit([encoder.finish()]);
    let masks = split.images(&receivers).map(&mut visibility);
    let (mut off, mut judged, mut on_edges) = (0.0_f32, 0, 0);
    for pixel in pixels() {
        let Some(heights) = surfaces(&camera, pixel) else { continue };
        for (mask, height) in masks.iter().zip(heights) {
            let Some(height) = height else { continue };
            // A surface seen by a sample but not at the centre is not in the image drawn alone.
            let (bounds, truth) = if height > 0.0 { (SHEET, &sheet_alone) } else { (GROUND, &ground) };
            if margin(bounds, camera.at_height(pixel.as_vec2() + 0.5, height).0) < 2e-3 {
                continue;
            }
            if (texel(mask, pixel) - texel(truth, pixel)).abs() > 0.02 {
                println!("{pixel} {height} {} {} {heights:?}", texel(mask, pixel), texel(truth, pixel));
            }
            off = off.max((texel(mask, pixel) - texel(truth, pixel)).abs());
            judged += 1;
            on_edges += u32::from(heights[1].is_some());
        }
    }
    println!("{judged} judged, {on_edges} on edges, off by {off} at most");
    assert!(judged > 2400 && on_edges > 40, "{judged} judged, {on_edges} on edges");
    // Positions differ by some micrometres, which may move a sample or two of a pixel across an edge.
    assert!(off <= 3.0 / 256.0, "off by {off}");
}

#[test]
fn what_is_not_multisampled_is_refused() {
    let Some(gpu) = gpu() else { return };
    let camera = Camera::new(DepthConvention::Reversed);
    let [depth, _] = draw(gpu, &camera, &[(0.0, GROUND)], 1).map(|texture| view_of(&texture));
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut recorder = Recorder::new(&mut encoder, None);
    let error = SplitReceivers::new(gpu).record(&mut recorder, &camera.receivers(&depth, None)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "SplitReceivers: the depth buffer is a texture with 1 samples per pixel, and must be a texture with 4 samples; one \
         with a single sample needs no splitting"
    );
    let [depth, _] = draw(gpu, &camera, &[(0.0, GROUND)], 4).map(|texture| view_of(&texture));
    let beyond = Receivers { origin_px: ORIGIN + 30, ..camera.receivers(&depth, None) };
    let error = SplitReceivers::new(gpu).record(&mut recorder, &beyond).unwrap_err().to_string();
    assert!(error.contains("to contain the receivers' rectangle"), "{error}");
    // The GPU must finish before the test ends the process.
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device finishes");
}
