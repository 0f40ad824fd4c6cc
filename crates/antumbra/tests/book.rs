//! The snippets of the book (`docs/`), compiled. A test of `antumbra-book` holds each snippet against these lines; nothing here is
//! run, since the examples run the same calls.
#![cfg(feature = "single_map")]
#![allow(dead_code, unused_mut, unused_variables, reason = "a snippet shows what a host has, not what it does with it")]

use antumbra::light::{Aabb, Light, LightShape};
use antumbra::{
    AnyShadow, CasterSet, Casters, Denoise, DepthConvention, Error, Frame, Gpu, Mask, MaskChannels, MeshCaster,
    Opacity, PointBuffer, PointFrame, PointReceivers, Receivers, Recorder, SplitReceivers, TechniqueKind,
};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// docs/start.md, The library in thirty lines.
fn the_library_in_thirty_lines(
    device: wgpu::Device,
    queue: wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    (position_buffer, index_buffer, instance_buffer): (wgpu::Buffer, wgpu::Buffer, wgpu::Buffer),
    (index_count, bounds): (u32, Aabb),
    (size_px, depth_view): (UVec2, wgpu::TextureView),
    (view_from_world, clip_from_view): (Mat4, Mat4),
) -> Result<(), Error> {
    // Once: a light of physical size, a technique, a mask of the picture's size.
    let gpu = Gpu::new(&device, &queue);
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?;
    let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) };
    let light = Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO);
    let mask = Mask::new(&device, size_px);

    // Each frame: what casts, and the depth buffer that you have anyway.
    let casters = [MeshCaster {
        positions: &position_buffer, // [f32; 3] a vertex
        indices: &index_buffer,      // u32, three a triangle
        first_triangle: 0,
        index_count,
        instances: &instance_buffer, // world-from-object matrices
        first_instance: 0,
        instance_count: 1,
        closed: true,
        opacity: Opacity::Opaque,
        bounds,
        version: None,
    }];
    let receivers = Receivers {
        size_px,
        origin_px: UVec2::ZERO, // or a viewport's corner
        depth: &depth_view,
        depth_convention: DepthConvention::Reversed,
        view_from_world,
        clip_from_view,
        normals: None,         // derived from depth
        bounds: None,          // the casters' box
        hull: &[],             // or points around what is seen, for tighter light maps
        seen: &[],             // or some points that are seen, for finer shadows there
        shadow_distance: None, // or how far from the camera shadows are drawn
        version: None,         // or a number that changes with the depth buffer, for frames in which nothing does
    };
    let frame = Frame { light: &light, casters: Casters::Meshes(&casters), receivers, mask: &mask };
    let work = shadow.prepare(&frame)?;
    work.record(&mut Recorder::new(&mut encoder, None));
    Ok(())
}

/// docs/integrating.md, Once.
fn once(device: wgpu::Device, queue: wgpu::Queue, size_px: UVec2) -> Result<(), Error> {
    let gpu = Gpu::new(&device, &queue); // clone it; programs are made once for all clones
    let mut casters = CasterSet::new(&gpu); // what casts, for all lights
    let mask = Mask::new(&device, size_px); // one a light
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?; // one a light and view
    Ok(())
}

/// docs/integrating.md, Each frame.
fn each_frame(
    mut encoder: wgpu::CommandEncoder,
    mut casters: CasterSet,
    lights: Vec<(&Light, &mut AnyShadow, &Mask)>,
    receivers: Receivers<'_>,
) -> Result<(), Error> {
    let mut recorder = Recorder::new(&mut encoder, None);
    casters.update(&mut recorder)?;
    for (light, shadow, mask) in lights {
        let casters = Casters::Set { set: &casters, layers: u32::MAX };
        let work = shadow.prepare(&Frame { light, casters, receivers, mask })?;
        work.record(&mut recorder);
    }
    Ok(())
}

/// docs/integrating.md, Depth buffers and masks of yours.
fn four_samples_a_pixel(
    mut recorder: Recorder<'_>,
    mut split: SplitReceivers,
    receivers: Receivers<'_>,
    (light, casters, mut shadow): (&Light, Casters<'_>, AnyShadow),
    (front, back): (Mask, Mask),
) -> Result<(), Error> {
    split.record(&mut recorder, &receivers)?; // a SplitReceivers, kept from frame to frame
    for (receivers, mask) in split.pictures(&receivers).into_iter().zip([&front, &back]) {
        shadow.prepare(&Frame { light, casters, receivers, mask })?.record(&mut recorder);
    }
    Ok(())
}

/// docs/integrating.md, Few samples, made smooth.
fn few_samples(mut shadow: AnyShadow) -> Result<(), Box<dyn std::error::Error>> {
    shadow.set("search_samples", "8")?;
    shadow.set("samples", "8")?;
    shadow.set_denoise(Some(Denoise::default())); // Shadow::denoise, where the technique is known at compile time
    Ok(())
}

/// docs/advise.md, The preset.
fn a_preset(gpu: Gpu) -> Result<(), Box<dyn std::error::Error>> {
    let mut shadow = TechniqueKind::Pcss.create(&gpu)?;
    shadow.set("map_size", "2048")?;
    shadow.set("means", "ranges")?;
    Ok(())
}

/// docs/integrating.md, Points in place of a depth buffer.
fn points_in_place_of_a_depth_buffer(
    shadow: &mut AnyShadow,
    (light, casters): (Light, Casters<'_>),
    (point_buffer, normal_buffer, visibilities): (wgpu::Buffer, wgpu::Buffer, wgpu::Buffer),
    (count, bounds): (u32, Aabb),
    mut recorder: Recorder<'_>,
) -> Result<(), Error> {
    let receivers = PointReceivers {
        normals: Some(PointBuffer::packed(&normal_buffer)), // or `None`: each faces the light
        ..PointReceivers::new(count, PointBuffer::packed(&point_buffer), bounds)
    };
    let channels = MaskChannels::One; // or three floats a point, where casters tint
    let frame = PointFrame { light: &light, casters, receivers, visibilities: &visibilities, channels };
    shadow.prepare_points(&frame)?.record(&mut recorder);
    Ok(())
}

/// docs/integrating.md, Visibility in your own shaders.
fn visibility_in_your_own_shaders(
    (shadow, frame): (&mut AnyShadow, Frame<'_>),
    mut recorder: Recorder<'_>,
    (my_wgsl, my_globals, my_material): (&str, wgpu::BindGroupLayout, wgpu::BindGroupLayout),
) -> Result<(), Error> {
    shadow.prepare(&frame)?.record(&mut recorder);
    let function = shadow.shader_function(2, "sun_")?; // your bind group, and how all names begin
    let source = format!("{}\n{}", function.wgsl, my_wgsl); // calls sun_visibility_at(position, normal, pixel)
    let layouts = [Some(&my_globals), Some(&my_material), Some(&function.layout)];
    // In the pass: set_bind_group(2, &function.bind_group, &[]).
    Ok(())
}
