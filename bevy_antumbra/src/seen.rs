//! Points that a view's camera sees, read back a few frames late.
//!
//! Light maps concentrate their texels where the camera sees something, and a sun's cascades begin at the nearest point. A late
//! hint costs only sharpness for some frames: the bounds of this frame define which surfaces receive.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Number of points along each side of the view.
const CELLS: u32 = 24;
const BYTES: u64 = CELLS as u64 * CELLS as u64 * 4;

/// Uniform `Grid` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Grid {
    origin_px: glam::UVec2,
    size_px: glam::UVec2,
    cells: glam::UVec2,
    padding: glam::UVec2,
}

/// Pass that gathers depths, one per device.
pub struct SeenGatherer {
    device: wgpu::Device,
    pipeline: wgpu::ComputePipeline,
}

/// Points that a view's camera sees, and their readback.
pub struct Seen {
    /// Visible points in world space; empty until the first readback completes.
    pub points: Vec<glam::Vec3>,
    grid: wgpu::Buffer,
    depths: wgpu::Buffer,
    readback: wgpu::Buffer,
    /// Bind group, with the depth view that it was created for.
    group: Option<(wgpu::TextureView, wgpu::BindGroup)>,
    state: State,
    /// Result of mapping the buffer, set by wgpu's callback on another thread.
    outcome: Arc<AtomicU8>,
    /// World-from-clip matrix of the frame being read back.
    world_from_clip: glam::Mat4,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Idle,
    /// Recorded, but possibly not submitted.
    Recorded,
    Mapping,
}

const WAITING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

impl SeenGatherer {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("bevy_antumbra seen"),
            source: wgpu::ShaderSource::Wgsl(include_str!("seen.wgsl").into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("bevy_antumbra seen"),
            layout: None,
            module: &module,
            entry_point: Some("gather"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { device: device.clone(), pipeline }
    }

    /// Creates the resources of a view, without points.
    pub fn start(&self) -> Seen {
        let buffer = |label, size, usage| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        Seen {
            points: Vec::new(),
            grid: buffer("bevy_antumbra seen grid", size_of::<Grid>() as u64, Usage::UNIFORM | Usage::COPY_DST),
            depths: buffer("bevy_antumbra seen", BYTES, Usage::STORAGE | Usage::COPY_SRC),
            readback: buffer("bevy_antumbra seen readback", BYTES, Usage::MAP_READ | Usage::COPY_DST),
            group: None,
            state: State::Idle,
            outcome: Arc::default(),
            world_from_clip: glam::Mat4::IDENTITY,
        }
    }

    /// Records the pass, unless a readback is in progress.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        queue: &wgpu::Queue,
        seen: &mut Seen,
        depth: &wgpu::TextureView,
        (origin_px, size_px): (glam::UVec2, glam::UVec2),
        world_from_clip: glam::Mat4,
    ) {
        if seen.state != State::Idle {
            return;
        }
        let grid = Grid { origin_px, size_px, cells: glam::UVec2::splat(CELLS), padding: glam::UVec2::ZERO };
        queue.write_buffer(&seen.grid, 0, bytemuck::bytes_of(&grid));
        let kept = seen.group.take().filter(|(of, _)| of == depth);
        let (_, group) = seen.group.insert(kept.unwrap_or_else(|| {
            let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("bevy_antumbra seen"),
                layout: &self.pipeline.get_bind_group_layout(0),
                entries: &[
                    entry(0, seen.grid.as_entire_binding()),
                    entry(1, wgpu::BindingResource::TextureView(depth)),
                    entry(2, seen.depths.as_entire_binding()),
                ],
            });
            (depth.clone(), group)
        }));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("bevy_antumbra seen"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &*group, &[]);
        pass.dispatch_workgroups(CELLS.div_ceil(8), CELLS.div_ceil(8), 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&seen.depths, 0, &seen.readback, 0, BYTES);
        (seen.state, seen.world_from_clip) = (State::Recorded, world_from_clip);
    }
}

impl Seen {
    /// Advances the readback without waiting. Call it after a frame's commands are submitted.
    pub fn advance(&mut self) {
        match self.state {
            State::Idle => {}
            State::Recorded => {
                self.outcome.store(WAITING, Ordering::Release);
                let outcome = Arc::clone(&self.outcome);
                self.readback.map_async(wgpu::MapMode::Read, .., move |result| {
                    outcome.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
                });
                self.state = State::Mapping;
            }
            State::Mapping => match self.outcome.load(Ordering::Acquire) {
                MAPPED => {
                    if let Ok(bytes) = self.readback.get_mapped_range(..) {
                        self.points = points(bytemuck::cast_slice(&bytes), &self.world_from_clip);
                    }
                    self.readback.unmap();
                    self.state = State::Idle;
                }
                FAILED => self.state = State::Idle,
                _ => {}
            },
        }
    }
}

/// Returns the world-space points of depths, without the background.
fn points(depths: &[f32], world_from_clip: &glam::Mat4) -> Vec<glam::Vec3> {
    let place = |i: usize| {
        let cell = glam::Vec2::new((i as u32 % CELLS) as f32, (i as u32 / CELLS) as f32);
        let across = (cell + 0.5) / CELLS as f32;
        glam::Vec2::new(2.0 * across.x - 1.0, 1.0 - 2.0 * across.y)
    };
    let seen = depths.iter().enumerate().filter(|(_, depth)| **depth > 0.0);
    let world = seen.map(|(i, depth)| world_from_clip.project_point3(place(i).extend(*depth)));
    world.filter(|point| point.is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_become_places_and_background_none() {
        let view_from_clip = glam::camera::rh::proj::directx::perspective_infinite_reverse(1.0, 1.0, 0.1).inverse();
        let mut depths = vec![0.0; (CELLS * CELLS) as usize];
        depths[0] = 0.1 / 4.0;
        let points = points(&depths, &view_from_clip);
        assert_eq!(points.len(), 1, "one is not background");
        let reach = 4.0 * (0.5f32).tan() * (1.0 - 1.0 / CELLS as f32);
        assert!(points[0].abs_diff_eq(glam::Vec3::new(-reach, reach, -4.0), 1e-4), "{}", points[0]);
    }
}
