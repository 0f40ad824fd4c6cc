//! One light map, rendered here or supplied by the host, with its depth pyramid and the layers behind it: bind group 1 of the
//! passes that read it. The shader side is `map.wesl`.

use std::sync::Arc;

use antumbra_light::{Aabb, Light, LightShape};
use glam::{UVec2, Vec2};

use super::caster_depth::{CasterDepth, check_map_size};
use super::central_view::{central_fit, central_reach, fit_central_view_within, fit_seen_view};
use super::depth_layers::behind::LayersBehind;
use super::depth_pyramid::DepthPyramid;
use super::hosts_map::view_of_hosts_map;
use super::light_spread::LightSpread;
use super::light_view::{FitTo, FollowedLight, LightView, LightViewGpu, WindowShape};
use super::map_texels::map_texels;
use super::stable_fit::{corners_to_hold, in_whole_texels};
use crate::contract::{CastersKey, DrawnMap, Error, MapSize, PreparedCasters, PreparedFrame};
use crate::gpu::{
    Bindings, Content, EmbeddedGroup, Gpu, Lease, Recorder, Scratch, Span, Stage, bindings, create_uniform, samples,
    texels, write_uniform,
};

/// Shape of the light-plane window of a map rendered here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapWindow {
    /// Square along the light's right and up axes, for kernels measured in texels.
    Square,
    /// Square, except in a sun's cascades, which are long and narrow: a rectangle.
    Narrow,
    /// Rolled or warped to the seen receivers if that at least halves the width of their texels, else square; in a sun's cascades
    /// a rectangle along the light's right and up axes.
    Seen,
}

/// Settings of a map rendered here and of the layers behind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapSettings {
    /// Texels along a side.
    pub(crate) size: MapSize,
    pub(crate) window: MapWindow,
    /// Receiver-to-light segments that the window must contain.
    pub(crate) followed: FollowedLight,
    /// Number of depth layers, including the map itself; 1 unless the search is [`MapSearch::Layers`].
    pub(crate) layers: u32,
    /// Bytes per map texel of what the technique derives from the map, which limit an automatic map size.
    pub(crate) derived_bytes_per_texel: u32,
}

impl MapSettings {
    /// Square map of the nearest casters, without further layers.
    pub(crate) fn square(size: MapSize) -> Self {
        Self { size, window: MapWindow::Square, followed: FollowedLight::Whole, layers: 1, derived_bytes_per_texel: 0 }
    }

    /// [`Self::square`] with the window [`MapWindow::Narrow`].
    pub(crate) fn narrow(size: MapSize) -> Self {
        Self { window: MapWindow::Narrow, ..Self::square(size) }
    }
}

/// Structures that a technique searches in addition to the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapSearch {
    Nothing,
    /// Min/max depth pyramid of the map.
    Pyramid,
    /// Depth pyramid, and peeled layers behind the map.
    Layers,
}

bindings! {
    /// Bind group 1: the map.
    struct MapBindings = "light map", COMPUTE {
        0 light_view: Uniform,
        1 light_map: Texture(texels::DEPTH),
        2 light_map_sampler: Sampler(samples::TAKES),
    }

    /// Bind group 1: the map and its depth pyramid.
    struct PyramidBindings = "light map with its pyramid", COMPUTE, with map: MapBindings {
        3 light_map_pyramid: Texture(texels::FLOAT),
    }

    /// Bind group 1: the map, its depth pyramid, and the layers behind it.
    struct LayersBindings = "light map with layers behind it", COMPUTE, group 1 of all with further_layers,
        with searched: PyramidBindings
    {
        4 further_layers: TextureArray(texels::DEPTH),
    }
}

/// Size and layer count of a frame's textures; the textures are reused while both are unchanged.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::NoUninit)]
struct Shape {
    size_px: UVec2,
    /// Number of depth layers, including the map itself; 0 for a host's map.
    layers: u32,
}

/// Textures of one [`Shape`].
#[derive(Debug)]
struct Textures {
    shape: Shape,
    /// Lease of the map (if rendered here), the layers behind it, and its pyramid.
    lease: Lease,
    /// Map rendered here; `None` if the host supplies the map.
    map: Option<(Arc<wgpu::Texture>, wgpu::TextureView)>,
}

impl Textures {
    fn new(stage: &Stage<'_>, shape: Shape, has_pyramid: bool) -> Self {
        let Shape { size_px, layers } = shape;
        let of_maps = LayersBehind::bytes_of(size_px.x, layers);
        let of_pyramid = if has_pyramid { DepthPyramid::bytes_of(size_px) } else { 0 };
        let lease = Lease::new(&stage.device, of_maps + of_pyramid);
        let map = (layers > 0).then(|| {
            let texture = lease.texture(&stage.device, Scratch::LightMap, &descriptor(size_px.x));
            let view = stage.device.create_view(&texture, &wgpu::TextureViewDescriptor::default());
            (texture, view)
        });
        Self { shape, lease, map }
    }
}

/// Bindings of a map, by [`MapSearch`].
enum BoundMap<'a> {
    Alone(MapBindings<'a>),
    WithPyramid(PyramidBindings<'a>),
    WithLayers(LayersBindings<'a>),
}

/// One light map, with the pyramid and layers that a technique searches: bind group 1 of its passes.
#[derive(Debug)]
pub(crate) struct LightMap {
    technique: &'static str,
    casters: CasterDepth,
    pyramid: Option<DepthPyramid>,
    layers_behind: Option<LayersBehind>,
    /// Layout of bind group 1: view, depth, sampler; if searched, the pyramid at binding 3 and the layers behind the map at 4.
    pub(crate) layout: wgpu::BindGroupLayout,
    view_uniform: wgpu::Buffer,
    sampler: wgpu::Sampler,
    textures: Option<Textures>,
    /// Cache key of the contents of the map, its layers and its pyramid.
    content: Content<(CastersKey, Vec<u8>)>,
    /// Map of the last prepared frame, and whether no other light draws into it.
    last: Option<(wgpu::TextureView, bool)>,
    drawn: Option<DrawnMap>,
}

/// Map prepared for one frame.
#[derive(Debug)]
pub(crate) struct PreparedMap {
    /// Bind group 1.
    pub(crate) group: wgpu::BindGroup,
    /// Whether an earlier frame has drawn the map.
    is_drawn: bool,
    pub(crate) view: LightViewGpu,
    pub(crate) size_px: UVec2,
    /// Depth of texels without a caster.
    pub(crate) empty_depth: f32,
}

impl LightMap {
    pub(crate) fn new(gpu: &Gpu, technique: &'static str, search: MapSearch) -> Self {
        let casters = CasterDepth::new(gpu);
        let layout = match search {
            MapSearch::Nothing => MapBindings::layout(gpu),
            MapSearch::Pyramid => PyramidBindings::layout(gpu),
            MapSearch::Layers => LayersBindings::layout(gpu),
        };
        Self {
            technique,
            pyramid: (search != MapSearch::Nothing).then(|| DepthPyramid::new(gpu)),
            layers_behind: (search == MapSearch::Layers).then(|| LayersBehind::new(gpu, &casters)),
            casters,
            layout,
            view_uniform: create_uniform::<LightViewGpu>(gpu, "antumbra light view"),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("antumbra gather"),
                ..wgpu::SamplerDescriptor::default()
            }),
            textures: None,
            content: Content::default(),
            last: None,
            drawn: None,
        }
    }

    /// Fits and allocates the map and uploads its view, or takes the host's map, which has no layers behind it.
    pub(crate) fn prepare(
        &mut self,
        stage: &Stage<'_>,
        frame: &PreparedFrame<'_>,
        settings: MapSettings,
    ) -> Result<PreparedMap, Error> {
        let technique = self.technique;
        let layers = settings.layers;
        let (view, hosts_map, shape, empty_depth) = match &frame.casters {
            PreparedCasters::Draws(meshes) => {
                let bounds: Vec<Aabb> = meshes.iter().map(|mesh| mesh.bounds).collect();
                let view = own_view(stage, frame, &bounds, settings);
                let bytes_of = |size| self.bytes_of(settings, size);
                let map_size = map_texels(stage, frame, settings.size, bytes_of, &view, &bounds);
                check_map_size(stage, technique, map_size, "set a smaller `map_size`")?;
                let view = in_whole_texels(stage, view, UVec2::splat(map_size));
                self.casters.prepare(stage, &[view.clip_from_world()], meshes);
                let shape = Shape { size_px: UVec2::splat(map_size), layers };
                (view.to_gpu(map_size), None, shape, CasterDepth::CLEAR_DEPTH)
            }
            PreparedCasters::HostDepthMap(map) => {
                let view = view_of_hosts_map(technique, frame, map)?;
                let shape = Shape { size_px: map.size_px, layers: 0 };
                (view, Some(map.view), shape, map.depth_convention.background())
            }
        };
        let light_half_extent_m = areal_half_extent_m(frame.light);
        if self.textures.as_ref().is_none_or(|textures| textures.shape != shape) {
            // Textures of the old shape return their bytes to the budget before the new ones take theirs.
            self.textures = None;
            self.pyramid.iter_mut().for_each(DepthPyramid::release);
            self.layers_behind.iter_mut().for_each(LayersBehind::release);
            self.textures = Some(Textures::new(stage, shape, self.pyramid.is_some()));
        }
        let textures = self.textures.as_ref().expect("created above if missing");
        let lease = &textures.lease;
        let map =
            hosts_map.or(textures.map.as_ref().map(|(_, map)| map)).expect("the host's, or created with the textures");
        let of = [bytemuck::bytes_of(&view), bytemuck::bytes_of(&shape), bytemuck::bytes_of(&light_half_extent_m)];
        let key = stage.casters().filter(|_| lease.is_own()).map(|casters| (casters, of.concat()));
        let is_drawn = self.content.ask(key);
        write_uniform(stage, &self.view_uniform, &view);
        if let Some(pyramid) = &mut self.pyramid {
            pyramid.prepare(stage, lease, map, &self.view_uniform, shape.size_px, light_half_extent_m);
        }
        if let Some(behind) = &mut self.layers_behind {
            behind.prepare(stage, lease, map, shape.size_px.x, shape.layers.saturating_sub(1));
        }
        self.last = Some((map.clone(), lease.is_own()));
        self.drawn = Some(view.drawn_map(map, 1, empty_depth)).filter(|_| lease.is_own());
        let group = match self.bound(map) {
            BoundMap::Alone(bindings) => bindings.group(stage, &self.layout),
            BoundMap::WithPyramid(bindings) => bindings.group(stage, &self.layout),
            BoundMap::WithLayers(bindings) => bindings.group(stage, &self.layout),
        };
        Ok(PreparedMap { group, is_drawn, view, size_px: shape.size_px, empty_depth })
    }

    /// Bytes of a map of `size`² texels with its layers, its pyramid, and what the technique derives from it.
    fn bytes_of(&self, settings: MapSettings, size: u32) -> u64 {
        let of_pyramid = if self.pyramid.is_some() { DepthPyramid::bytes_of(UVec2::splat(size)) } else { 0 };
        let of_more = u64::from(settings.derived_bytes_per_texel) * u64::from(size).pow(2);
        LayersBehind::bytes_of(size, settings.layers) + of_pyramid + of_more
    }

    /// Returns the bindings of `light_map` with its pyramid and layers, where there are any.
    fn bound<'a>(&'a self, light_map: &'a wgpu::TextureView) -> BoundMap<'a> {
        let map = MapBindings { light_view: &self.view_uniform, light_map, light_map_sampler: &self.sampler };
        let Some(light_map_pyramid) = self.pyramid.as_ref().and_then(DepthPyramid::view) else {
            return BoundMap::Alone(map);
        };
        let searched = PyramidBindings { map, light_map_pyramid };
        match &self.layers_behind {
            None => BoundMap::WithPyramid(searched),
            Some(behind) => BoundMap::WithLayers(LayersBindings { searched, further_layers: behind.array() }),
        }
    }

    /// Bind group of the last prepared frame for a host's shader, and whether no other light's frame changes its contents.
    pub(crate) fn embedded(&self) -> Option<(EmbeddedGroup, bool)> {
        let (light_map, is_own) = self.last.as_ref()?;
        let group = match self.bound(light_map) {
            BoundMap::Alone(bindings) => EmbeddedGroup::of(&bindings),
            BoundMap::WithPyramid(bindings) => EmbeddedGroup::of(&bindings),
            BoundMap::WithLayers(bindings) => EmbeddedGroup::of(&bindings),
        };
        Some((group, *is_own))
    }

    /// Records the passes of the map and its layers (unless the host supplies the map) and of its pyramid (if there is one).
    /// Records nothing if an earlier frame has drawn them.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, frame: &PreparedFrame<'_>, prepared: &PreparedMap) {
        if prepared.is_drawn {
            return;
        }
        let own_map = self.textures.as_ref().and_then(|textures| textures.map.as_ref());
        if let (PreparedCasters::Draws(meshes), Some((_, map))) = (&frame.casters, own_map) {
            recorder.depth_pass("light map", Span::Only, map, CasterDepth::CLEAR_DEPTH, |pass| {
                self.casters.draw(pass, 0, meshes);
            });
            if let Some(behind) = &self.layers_behind {
                behind.record(recorder, &self.casters, meshes);
            }
        }
        if let Some(pyramid) = &self.pyramid {
            pyramid.record(recorder);
        }
    }

    /// Map of the last prepared frame with its layers and pyramid levels; `None` if lights share the map's texture.
    pub(crate) fn drawn(&self) -> Option<DrawnMap> {
        let map = self.drawn.clone()?;
        let layers_behind = self.layers_behind.as_ref().map(LayersBehind::drawn).unwrap_or_default();
        let levels = self.pyramid.as_ref().map(DepthPyramid::drawn).unwrap_or_default();
        Some(DrawnMap { layers_behind, levels, ..map })
    }

    /// Bytes of the map, its layers and its pyramid; 0 if lights share the textures.
    pub(crate) fn memory_bytes(&self) -> u64 {
        self.textures.as_ref().map_or(0, |textures| textures.lease.own_bytes())
    }
}

/// Returns the view of a map rendered here, before [`in_whole_texels`] aligns its texels.
fn own_view(stage: &Stage<'_>, frame: &PreparedFrame<'_>, casters: &[Aabb], settings: MapSettings) -> LightView {
    let window = settings.window;
    let (followed, reach) = (settings.followed, central_reach(frame.light));
    if stage.stable_box().is_some() {
        // A cascade's receivers lie at similar depths, so a warp would gain little, and it would move with the camera.
        let shape = if window == MapWindow::Square { WindowShape::Square } else { WindowShape::Rolled(Vec2::X) };
        let receivers = &corners_to_hold(stage, &frame.receivers);
        return fit_central_view_within(frame.light, followed, reach, &FitTo { casters, receivers, window: shape });
    }
    let corners = frame.receivers.corners();
    if window != MapWindow::Seen {
        let fit = FitTo { casters, receivers: &corners, window: WindowShape::Square };
        return fit_central_view_within(frame.light, followed, reach, &fit);
    }
    let seen = frame.receivers.seen_points(&corners);
    let fit = central_fit(frame.light, followed, reach, casters, &corners);
    fit_seen_view(&fit.for_many_windows(), &seen)
}

/// Half the sides of a light on its plane, metres; zero for suns and lists of points.
fn areal_half_extent_m(light: &Light) -> Vec2 {
    match light.shape {
        LightShape::Sun { .. } | LightShape::Points { .. } => Vec2::ZERO,
        _ => LightSpread::of(light).extent,
    }
}

/// Descriptor of a square depth map.
fn descriptor(size: u32) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: Some("antumbra light map"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: CasterDepth::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    }
}
