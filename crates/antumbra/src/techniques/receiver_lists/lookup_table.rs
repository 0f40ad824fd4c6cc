//! Lookup table of section 4.2: the bits of 128 light points behind each of a grid of planes.

use crate::contract::Error;
use crate::gpu::{Bindings, Stage};

use super::Options;
use super::groups::{MadeTable, TABLE_FORMAT};
use super::light_points::{LocalPoint, MAX_WORDS, WORD};

/// Lookup table of section 4.2, and the points for which it was computed.
#[derive(Debug)]
pub(super) struct Table {
    pub(super) view: wgpu::TextureView,
    size: u32,
    points: Vec<LocalPoint>,
    pub(super) bytes: u64,
    /// Bind group if the table is filled in the current frame.
    pub(super) bind_group: Option<wgpu::BindGroup>,
    pub(super) groups: [u32; 3],
}

impl Table {
    /// Allocates the lookup table, unless the present one is for the same points; drops it if light points are tested without it.
    pub(super) fn prepare(
        table: &mut Option<Self>,
        stage: &Stage<'_>,
        technique: &'static str,
        options: &Options,
        point_batch_count: usize,
    ) -> Result<(), Error> {
        let size = options.lookup_size;
        if size == 0 {
            *table = None;
            return Ok(());
        }
        let blocks = options.points.len().div_ceil(128) as u32;
        let limit = stage.device.limits().max_texture_dimension_3d;
        if point_batch_count > 1 || size * blocks > limit {
            return Err(Error::Unsupported {
                technique,
                needed: format!("a table of {size} × {size} × {} planes", u64::from(size) * u64::from(blocks)),
                had: format!("at most {limit} per side, for {} light points", MAX_WORDS * WORD),
                remedy: "set a smaller `lookup_size`, fewer `samples`, or `evaluation` to exact",
            });
        }
        if let Some(table) = table
            && table.size == size
            && table.points == options.points
        {
            // The table is filled only once.
            table.groups = [0; 3];
            table.bind_group = None;
            return Ok(());
        }
        let texture = stage.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra planes to light points"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: size * blocks },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: TABLE_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        *table = Some(Self {
            view: stage.device.create_view(&texture, &wgpu::TextureViewDescriptor::default()),
            size,
            points: options.points.clone(),
            bytes: u64::from(size).pow(3) * u64::from(blocks) * 16,
            bind_group: None,
            groups: [size.div_ceil(4), size.div_ceil(4), (size * blocks).div_ceil(4)],
        });
        Ok(())
    }

    /// Prepares the filling of a new table.
    pub(super) fn bind(
        &mut self,
        stage: &Stage<'_>,
        layout: &wgpu::BindGroupLayout,
        settings: &wgpu::Buffer,
        light_words: &wgpu::Buffer,
    ) {
        if self.bind_group.is_none() && self.groups != [0; 3] {
            let made = MadeTable { settings, light_words, table: &self.view };
            self.bind_group = Some(made.group(stage, layout));
        }
    }
}
