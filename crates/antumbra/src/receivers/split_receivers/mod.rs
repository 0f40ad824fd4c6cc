//! Splits a multisampled depth buffer into two images of one sample per pixel.

use glam::{Mat4, UVec2};

use crate::contract::{Error, Receivers};
use crate::gpu::{
    Bindings, Commands, Gpu, Recorder, RetainedState, Span, Stage, array_view, bindings, color_pipeline, gpu_structs,
    slice_views, texels,
};
use crate::receivers::{DEPTH_FORMAT, NORMAL_FORMAT};
use crate::shaders;

#[cfg(test)]
mod tests;

/// Name of the type in errors.
const NAME: &str = "SplitReceivers";

/// The only multisample count in WebGPU.
const SAMPLES: u32 = 4;

gpu_structs! {
    pub(crate) struct Split {
        view_from_clip: Mat4,
        world_from_view: Mat4,
        origin_px: UVec2,
        size_px: UVec2,
        background_depth: f32,
        has_normals: u32,
        padding_0: u32,
        padding_1: u32,
    }
}

bindings! {
    struct Samples = "split receivers", FRAGMENT, group 0 of [SPLIT_RECEIVERS_SPLIT] {
        0 split: Uniform,
        1 depths: MultisampledTexture(texels::FLOAT),
        2 normals: MultisampledTexture(texels::FLOAT),
    }
}

/// Splits a multisampled depth buffer for techniques, which take one sample per pixel. The *front* image has the nearest
/// surface that a pixel's samples see. The *back* image has the farthest if it is another one, and background elsewhere.
///
/// A pixel on an edge thus has a visibility for each of its two surfaces. The host's shading uses that of the image whose depth is
/// nearer to the fragment's ([`SPLIT_WGSL`](Self::SPLIT_WGSL)). If three or more surfaces meet in one pixel, those between use the
/// nearer image. Depths are those at the pixel's centre, extrapolated along each surface from the sample that saw it, as a
/// rasteriser does. This avoids self-shadowing from an offset position. On strips narrower than a pixel, of which no neighbour
/// sees more, the sample's own depth is used. If the host has no normals, they come from the same extrapolation.
///
/// The sample count is 4, as in WebGPU. One instance serves a view and all its lights, and is recorded once per frame:
///
/// ```no_run
/// # use antumbra::*;
/// # fn example(gpu: &Gpu, recorder: &mut Recorder<'_>, receivers: Receivers<'_>, shadow: &mut AnyShadow,
/// #     light: &light::Light, casters: Casters<'_>, masks: &[Mask; 2]) -> Result<(), Error> {
/// let mut split = SplitReceivers::new(gpu); // kept from frame to frame
/// split.record(recorder, &receivers)?;      // whose depth has four samples a pixel
/// for (receivers, mask) in split.images(&receivers).into_iter().zip(masks) {
///     shadow.prepare(&Frame { light, casters, receivers, mask })?.record(recorder);
/// }
/// # Ok(())
/// # }
/// ```
///
/// The second image reuses the light maps cached for the first. Its receivers are few, so it costs little more than a technique
/// spends on background.
#[derive(Debug)]
pub struct SplitReceivers {
    gpu: Gpu,
    layout: wgpu::BindGroupLayout,
    no_normals: wgpu::TextureView,
    keep: RetainedState,
    made: Option<SplitImages>,
}

/// Front and back image.
#[derive(Debug)]
struct SplitImages {
    size_px: UVec2,
    normal_format: wgpu::TextureFormat,
    depth: [wgpu::TextureView; 2],
    depth_layers: wgpu::TextureView,
    normals: [wgpu::TextureView; 2],
}

impl SplitReceivers {
    /// WGSL function for a host's shading. It returns which of the two images, and hence which of two masks, contains a fragment of
    /// depth `position.z`. `depths` is [`depth_layers`](Self::depth_layers), `pixel` is relative to the viewport's corner.
    pub const SPLIT_WGSL: &'static str = "
fn antumbra_image(depths: texture_2d_array<f32>, pixel: vec2u, depth: f32) -> u32 {
    let front = textureLoad(depths, pixel, 0u, 0).x;
    let back = textureLoad(depths, pixel, 1u, 0).x;
    let has_back = back > 0.0 && back < 1.0;
    return select(0u, 1u, has_back && abs(depth - back) < abs(depth - front));
}
";

    /// Creates an instance for views of any size.
    pub fn new(gpu: &Gpu) -> Self {
        let no_normals = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("antumbra no normals"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: SAMPLES,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        Self {
            layout: Samples::layout(gpu),
            no_normals: gpu.device.create_view(&no_normals, &wgpu::TextureViewDescriptor::default()),
            gpu: gpu.clone(),
            keep: RetainedState::default(),
            made: None,
        }
    }

    /// Records the two images of `receivers`, whose depth and normals have four samples per pixel, and whose normals are of a
    /// renderable format.
    ///
    /// # Errors
    /// [`Error::BadFrame`] if depth or normals have another sample count, or do not contain the receivers.
    pub fn record(&mut self, recorder: &mut Recorder<'_>, receivers: &Receivers<'_>) -> Result<(), Error> {
        check(receivers)?;
        let view_from_clip = receivers.clip_from_view.as_dmat4().inverse().as_mat4();
        let world_from_view = receivers.view_from_world.as_dmat4().inverse().as_mat4();
        let normal_format = receivers.normals.map_or(NORMAL_FORMAT, |normals| normals.texture().format());
        if !self
            .made
            .as_ref()
            .is_some_and(|made| (made.size_px, made.normal_format) == (receivers.size_px, normal_format))
        {
            self.made = Some(SplitImages::new(&self.gpu, receivers.size_px, normal_format));
        }
        let made = self.made.as_ref().expect("created above if missing");
        let stage = Stage::new(&self.gpu, std::mem::take(&mut self.keep), None);
        let uniform = stage.uniform(
            "antumbra split receivers",
            &Split {
                origin_px: receivers.origin_px,
                size_px: receivers.size_px,
                view_from_clip,
                world_from_view,
                background_depth: receivers.depth_convention.background(),
                has_normals: receivers.normals.is_some().into(),
                padding_0: 0,
                padding_1: 0,
            },
        );
        let samples = Samples {
            split: &uniform,
            depths: receivers.depth,
            normals: receivers.normals.unwrap_or(&self.no_normals),
        };
        let group = samples.group(&stage, &self.layout);
        let pipeline = pipeline(&stage, &self.layout, normal_format);
        let (keep, uploads) = stage.finish();
        self.keep = keep;
        recorder.upload(uploads, Commands::default().end());
        for picture in 0..2 {
            recorder.color_pass("split receivers", Span::of(picture, 2), &made.targets(picture), |pass| {
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.draw(0..3, picture as u32..picture as u32 + 1);
            });
        }
        Ok(())
    }

    /// Returns the front and the back image of the receivers last recorded, with the camera and bounds of `receivers`.
    ///
    /// # Panics
    /// If nothing was recorded.
    pub fn images<'a>(&'a self, receivers: &Receivers<'a>) -> [Receivers<'a>; 2] {
        let made = self.made.as_ref().expect("`record` is called first");
        [0, 1].map(|picture: usize| Receivers {
            size_px: made.size_px,
            origin_px: UVec2::ZERO,
            depth: &made.depth[picture],
            normals: Some(&made.normals[picture]),
            ..*receivers
        })
    }

    /// Depths of the front and the back image, in two layers: a `texture_2d_array<f32>` for a host's shading. `None` before
    /// the first record.
    pub fn depth_layers(&self) -> Option<&wgpu::TextureView> {
        self.made.as_ref().map(|made| &made.depth_layers)
    }

    /// Size of the images, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| {
            let pixels = u64::from(made.size_px.x) * u64::from(made.size_px.y);
            let normal = made.normal_format.block_copy_size(None).unwrap_or(0);
            2 * pixels * u64::from(4 + normal)
        })
    }
}

fn check(receivers: &Receivers<'_>) -> Result<(), Error> {
    let bad = |what, had: String, needed: String| Err(Error::BadFrame { technique: NAME, what, had, needed });
    if receivers.size_px.min_element() == 0 {
        return bad("the receivers' size", format!("{}", receivers.size_px), "at least 1 × 1 pixel".into());
    }
    let end_px = receivers.origin_px.saturating_add(receivers.size_px);
    for (what, view) in [("the depth buffer", Some(receivers.depth)), ("the normals' texture", receivers.normals)] {
        let Some(texture) = view.map(wgpu::TextureView::texture) else { continue };
        if texture.sample_count() != SAMPLES {
            let had = format!("a texture with {} samples per pixel", texture.sample_count());
            return bad(
                what,
                had,
                format!("a texture with {SAMPLES} samples; one with a single sample needs no splitting"),
            );
        }
        let size_px = UVec2::new(texture.width(), texture.height());
        if end_px.cmpgt(size_px).any() {
            return bad(
                what,
                format!("{size_px} pixels large"),
                format!("at least {end_px}, to contain the receivers' rectangle"),
            );
        }
    }
    Ok(())
}

impl SplitImages {
    fn new(gpu: &Gpu, size_px: UVec2, normal_format: wgpu::TextureFormat) -> Self {
        let texture = |format| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("antumbra split receivers"),
                size: wgpu::Extent3d { width: size_px.x, height: size_px.y, depth_or_array_layers: 2 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let layers =
            |texture: &wgpu::Texture| -> [_; 2] { slice_views(gpu, texture).try_into().expect("of two layers") };
        let depth = texture(DEPTH_FORMAT);
        Self {
            size_px,
            normal_format,
            depth: layers(&depth),
            depth_layers: array_view(gpu, &depth),
            normals: layers(&texture(normal_format)),
        }
    }

    /// Returns the render targets of the front image, 0, or the back one, 1.
    fn targets(&self, picture: usize) -> [&wgpu::TextureView; 2] {
        [&self.depth[picture], &self.normals[picture]]
    }
}

fn pipeline(gpu: &Gpu, layout: &wgpu::BindGroupLayout, normal_format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let label = "antumbra split receivers";
    let targets = [DEPTH_FORMAT, normal_format]
        .map(|format| Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL }));
    color_pipeline(gpu, label, shaders::SPLIT_RECEIVERS_SPLIT, layout, &targets)
}
