//! Snippets of the book (`docs/`) and the README, compiled. A test of `antumbra-book` compares each snippet with these lines.
//! Nothing here is run; the examples run the same calls.
#![cfg(feature = "single_map")]
#![allow(dead_code, unused_mut, unused_variables, reason = "a snippet shows what a host has, not what it does with it")]

#[path = "book/start.rs"]
mod start;

use antumbra::casters::{Caster, Indices, Instances, Mesh, PositionFormat, Positions};
use antumbra::light::{Aabb, Cone, Light, LightShape};
use antumbra::{
    AnyShadow, Budget, CasterSet, Casters, Denoise, Error, Frame, Gpu, LightSet, LightSetFrame, Mask, MaskChannels,
    MemoryPlan, PointBuffer, PointFrame, PointReceivers, RangedLight, Receivers, Recorder, SplitReceivers,
    TechniqueKind,
};
use glam::{Mat4, UVec2, Vec2, Vec3};

/// README.md, In your renderer.
fn in_your_renderer(
    device: wgpu::Device,
    queue: wgpu::Queue,
    mut encoder: wgpu::CommandEncoder,
    casters: CasterSet,
    (size_px, receivers): (UVec2, Receivers<'_>),
) -> Result<(), Error> {
    let gpu = Gpu::new(&device, &queue);
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?;
    let shape = LightShape::Rectangle { size_m: Vec2::new(1.2, 0.6) };
    let light = Light::new(shape, Vec3::new(1.5, 4.5, 2.5), Vec3::ZERO); // position and target, metres
    let mask = Mask::new(&device, size_px);

    // Each frame, after your depth pass and before shading:
    let casters = Casters::Set { set: &casters, layers: u32::MAX };
    let frame = Frame { light: &light, casters, receivers, mask: &mask };
    shadow.prepare(&frame)?.record(&mut Recorder::new(&mut encoder, None));
    Ok(())
}

/// docs/lights.md.
fn lights(position: Vec3, target: Vec3, direction: Vec3) {
    let bulb = Light::new(LightShape::Sphere { radius_m: 0.03 }, position, target);
    let window = Light::new(LightShape::Rectangle { size_m: Vec2::new(1.2, 1.5) }, position, target);
    let sun = Light::new(LightShape::Sun { angular_diameter_rad: 0.0093 }, Vec3::ZERO, direction); // in which light travels
    let spot = Light {
        cone: Some(Cone { inner_rad: 0.3, outer_rad: 0.5 }),
        ..Light::new(LightShape::Disk { radius_m: 0.04 }, position, target)
    };
}

/// docs/integrating.md, Set up.
fn set_up(device: wgpu::Device, queue: wgpu::Queue, size_px: UVec2) -> Result<(), Error> {
    let gpu = Gpu::new(&device, &queue); // cheap to clone; all clones share compiled pipelines
    let mut casters = CasterSet::new(&gpu); // one for all lights
    let mask = Mask::new(&device, size_px); // one for each light and camera
    let mut shadow = TechniqueKind::Smrt.create(&gpu)?; // one for each light and camera
    Ok(())
}

/// docs/integrating.md, Casters.
fn casters(
    mut casters: CasterSet,
    (vertices, indices): (wgpu::Buffer, wgpu::Buffer),
    (vertex_count, index_count, bounds): (u32, u32, Aabb),
    world_from_object: Mat4,
) -> Result<(), Error> {
    let mesh = casters.add_mesh(&Mesh {
        vertex_count,
        positions: Positions { buffer: &vertices, offset: 0, stride: 32, format: PositionFormat::Float32x3 },
        texture_coordinates: None, // needed for a surface with a texture
        indices: Some(Indices {
            buffer: &indices,
            format: wgpu::IndexFormat::Uint32,
            first_index: 0,
            count: index_count,
            base_vertex: 0,
        }),
        topology: wgpu::PrimitiveTopology::TriangleList,
        closed: true, // a watertight mesh
        bounds,       // object space
    })?;
    let caster = casters.add(&Caster::new(mesh, Instances::Matrices(&[world_from_object])))?;
    // When it moves:
    casters.set_instances(caster, Instances::Matrices(&[world_from_object]))?;
    Ok(())
}

/// docs/integrating.md, Many lights.
fn many_lights(
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

/// docs/integrating.md, Within a budget.
fn within_a_budget(
    gpu: Gpu,
    (casters, receivers): (CasterSet, Receivers<'_>),
    (lamps, range_m): (Vec<Light>, f32),
    size_px: UVec2,
    mut recorder: Recorder<'_>,
) -> Result<(), Error> {
    let mut lights = LightSet::new();
    let masks = Mask::packed(gpu.device(), size_px, MaskChannels::One, wgpu::TextureFormat::Rgba8Unorm, lamps.len());
    for (lamp, mask) in lamps.iter().zip(masks) {
        lights.add(RangedLight::new(lamp.clone(), range_m), TechniqueKind::Smrt.create(&gpu)?, mask)?;
    }
    // Each frame, after `casters.update`; `set_light` moves a light:
    let frame = LightSetFrame { casters: &casters, receivers, budget: Budget::Lights(4) };
    lights.prepare(&frame)?.record(&mut recorder);
    let states: Vec<_> = lights.ids().map(|id| lights.mask_state(id)).collect();
    Ok(())
}

/// docs/integrating.md, Half resolution.
fn half_resolution(mut shadow: AnyShadow) {
    shadow.set_half_resolution(true); // or the field Shadow::half_resolution
}

/// docs/integrating.md, Known before anything is allocated.
fn known_beforehand(
    gpu: Gpu,
    (size_px, format): (UVec2, wgpu::TextureFormat),
    (lights, casters, receivers): (Vec<Light>, Casters<'_>, Receivers<'_>),
) -> Result<(), Error> {
    let plan = MemoryPlan::new(&gpu);
    let mask = Mask::with_format(plan.gpu().device(), size_px, MaskChannels::One, format); // takes no memory
    let mut shadows = Vec::new();
    for light in &lights {
        let mut shadow = TechniqueKind::Pcss.create(plan.gpu())?;
        drop(shadow.prepare(&Frame { light, casters, receivers, mask: &mask })?);
        shadows.push(shadow);
    }
    let retained: u64 = shadows.iter().map(AnyShadow::memory_bytes).sum();
    let shared = plan.gpu().memory_bytes().shared;
    let of_each_kind = plan.resources(); // by label, most bytes first
    Ok(())
}

/// docs/integrating.md, Depth buffers.
fn four_samples_a_pixel(
    mut recorder: Recorder<'_>,
    mut split: SplitReceivers,
    receivers: Receivers<'_>,
    (light, casters, mut shadow): (&Light, Casters<'_>, AnyShadow),
    (front, back): (Mask, Mask),
) -> Result<(), Error> {
    split.record(&mut recorder, &receivers)?; // a SplitReceivers, kept from frame to frame
    for (receivers, mask) in split.images(&receivers).into_iter().zip([&front, &back]) {
        shadow.prepare(&Frame { light, casters, receivers, mask })?.record(&mut recorder);
    }
    Ok(())
}

/// docs/integrating.md, Few samples, made smooth.
fn few_samples(mut shadow: AnyShadow) -> Result<(), Box<dyn std::error::Error>> {
    shadow.set("search_samples", "8")?;
    shadow.set("samples", "8")?;
    shadow.set_denoise(Some(Denoise::default())); // or the field Shadow::denoise
    Ok(())
}

/// docs/integrating.md, Fewer pixels.
fn fewer_pixels(mut shadow: AnyShadow) -> Result<(), Box<dyn std::error::Error>> {
    shadow.set("sub", "true")?;
    Ok(())
}

/// docs/integrating.md, Map size.
fn map_size(mut shadow: AnyShadow) -> Result<(), Box<dyn std::error::Error>> {
    shadow.set("map_size", "auto")?;
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
