//! Receivers: the host's depth buffer and the camera that it was rendered with.

use antumbra_light::{Aabb, ShadowDistance, hash_u32, polytope_corners, unit_f32};
use glam::{DMat4, DVec3, DVec4, Mat4, UVec2, Vec3, Vec4};

/// Point that may be visible, weighted by the relative number of pixels that it represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SeenPoint {
    pub(crate) pos_in_world: Vec3,
    pub(crate) weight: f32,
}

/// Depth convention of a depth buffer, which implies its background value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DepthConvention {
    /// 0 near, 1 far; cleared to 1.
    Standard,
    /// 1 near, 0 far or at infinity; cleared to 0.
    #[default]
    Reversed,
}

impl DepthConvention {
    /// Clear value of the depth buffer; pixels that hold it have no geometry.
    pub fn background(self) -> f32 {
        match self {
            Self::Standard => 1.0,
            Self::Reversed => 0.0,
        }
    }
}

/// Receivers of one frame. Positions are reconstructed from depth.
///
/// [`Receivers::new`] takes what every host has; `with_` and a field's name set the rest.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Receivers<'a> {
    /// Size of the mask and of the viewport in depth buffer and normals, pixels.
    pub size_px: UVec2,
    /// Corner of the viewport in depth buffer and normals, pixels; zero if it fills them.
    pub origin_px: UVec2,
    /// Depth buffer: `Depth32Float` or `R32Float`, single-sampled, usage `TEXTURE_BINDING`; a 2D view of the depth aspect alone,
    /// possibly of one layer of an array. `Depth24Plus` and the formats with a stencil work, too; 16 bits are too few.
    pub depth: &'a wgpu::TextureView,
    /// Depth convention.
    pub depth_convention: DepthConvention,
    /// Camera pose; a rigid transform.
    pub view_from_world: Mat4,
    /// Camera projection, jitter included, with a finite or infinite far plane.
    pub clip_from_view: Mat4,
    /// World-space *geometric* normals in xyz, either side, of the depth buffer's size and with `TEXTURE_BINDING`: `Rgba32Float`,
    /// `Rgba16Float`, `Rgba16Snorm` or `Rgba8Snorm`. 32-bit floats, or normals decoded from a 16-bit octahedral encoding, avoid
    /// artefacts in grazing light. `None` derives them from depth, which is less exact at silhouettes.
    pub normals: Option<&'a wgpu::TextureView>,
    /// World-space box that holds every receiver; light maps are fitted to the part that the camera sees. `None` uses the casters'
    /// box. Unknown sides may be infinite.
    pub bounds: Option<Aabb>,
    /// World-space points whose convex hull holds every receiver, for hosts that have one tighter than `bounds`; otherwise empty.
    /// [`enclosing_corners`](antumbra_light::enclosing_corners) computes such points.
    pub hull: &'a [Vec3],
    /// World-space points that the camera sees, evenly spread over its pixels: a few hundred; last frame's depth buffer will do.
    /// Maps whose texels differ in size place the small ones there. Empty: anywhere in the hull.
    pub seen: &'a [Vec3],
    /// Maximum camera distance of shadows; receivers beyond it are lit, are in no map and cost nothing. `None`: unlimited.
    pub shadow_distance: Option<ShadowDistance>,
    /// Generation counter: change it whenever the contents of depth buffer or normals change. If counter, camera, light and a set
    /// of casters are unchanged, a frame records nothing, because the mask still holds it. `None`: contents change in each frame.
    pub version: Option<u64>,
}

impl<'a> Receivers<'a> {
    /// Receivers that fill a depth buffer of `size_px` pixels, seen by `camera`. Normals are derived from depth, bounds are the
    /// casters', and each frame counts as changed.
    pub fn new(depth: &'a wgpu::TextureView, size_px: UVec2, camera: Camera) -> Self {
        Self {
            size_px,
            origin_px: UVec2::ZERO,
            depth,
            depth_convention: camera.depth_convention,
            view_from_world: camera.view_from_world,
            clip_from_view: camera.clip_from_view,
            normals: None,
            bounds: None,
            hull: &[],
            seen: &[],
            shadow_distance: None,
            version: None,
        }
    }

    /// Sets [`origin_px`](Self::origin_px).
    pub fn with_origin_px(self, origin_px: UVec2) -> Self {
        Self { origin_px, ..self }
    }

    /// Sets [`normals`](Self::normals).
    pub fn with_normals(self, normals: impl Into<Option<&'a wgpu::TextureView>>) -> Self {
        Self { normals: normals.into(), ..self }
    }

    /// Sets [`bounds`](Self::bounds).
    pub fn with_bounds(self, bounds: impl Into<Option<Aabb>>) -> Self {
        Self { bounds: bounds.into(), ..self }
    }

    /// Sets [`hull`](Self::hull).
    pub fn with_hull(self, hull: &'a [Vec3]) -> Self {
        Self { hull, ..self }
    }

    /// Sets [`seen`](Self::seen).
    pub fn with_seen(self, seen: &'a [Vec3]) -> Self {
        Self { seen, ..self }
    }

    /// Sets [`shadow_distance`](Self::shadow_distance).
    pub fn with_shadow_distance(self, shadow_distance: impl Into<Option<ShadowDistance>>) -> Self {
        Self { shadow_distance: shadow_distance.into(), ..self }
    }

    /// Sets [`version`](Self::version).
    pub fn with_version(self, version: impl Into<Option<u64>>) -> Self {
        Self { version: version.into(), ..self }
    }

    /// Camera of the depth buffer.
    pub(crate) fn camera(&self) -> Camera {
        Camera {
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            depth_convention: self.depth_convention,
        }
    }
}

/// Camera of a depth buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Pose.
    pub view_from_world: Mat4,
    /// Projection.
    pub clip_from_view: Mat4,
    /// Depth convention.
    pub depth_convention: DepthConvention,
}

impl Camera {
    /// Camera position in world space, in double precision as far as the matrix has it.
    pub(crate) fn eye_in_world(&self) -> DVec3 {
        self.view_from_world.as_dmat4().inverse().w_axis.truncate()
    }

    fn clip_from_world(&self) -> DMat4 {
        self.clip_from_view.as_dmat4() * self.view_from_world.as_dmat4()
    }

    /// Frustum planes: `plane · (x, 1) ≥ 0` inside.
    pub(crate) fn frustum_planes(&self) -> [DVec4; 5] {
        frustum_planes(self.clip_from_world())
    }

    /// World-space box of the visible part of the near plane.
    fn near_box(&self) -> Aabb {
        let world_from_clip = self.clip_from_world().inverse();
        let near = 1.0 - f64::from(self.depth_convention.background());
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Aabb::of(corners.map(|(x, y)| world_from_clip.project_point3(DVec3::new(x, y, near)).as_vec3()))
    }

    /// Rows z and w of the clip-from-world matrix: a depth buffer's values are z / w.
    pub(crate) fn clip_depth_rows(&self) -> [Vec4; 2] {
        let clip_from_world = self.clip_from_world();
        [clip_from_world.row(2).as_vec4(), clip_from_world.row(3).as_vec4()]
    }
}

/// Source of receivers. Points have no camera; work that depends on one is skipped.
#[derive(Clone, Copy, Debug)]
pub enum Surfaces<'a> {
    /// A depth buffer; neighbouring pixels mostly see the same surface.
    Depth {
        /// The depth buffer.
        depth: &'a wgpu::TextureView,
        /// Its camera.
        camera: Camera,
    },
    /// Points in any order, in rows of texels. Neighbouring texels are unrelated.
    Points {
        /// Texture with position in xyz and width in w. A texel is a point if its normal's w is not zero.
        positions: &'a wgpu::TextureView,
        /// Whether the host provides normals: then points lie on surfaces, otherwise anywhere, even inside closed casters.
        on_surfaces: bool,
    },
}

/// Receivers of one frame, as techniques receive them.
#[derive(Clone, Copy, Debug)]
pub struct PreparedReceivers<'a> {
    /// Size of the mask and of the receivers' textures, pixels.
    pub size_px: UVec2,
    /// Corner of the receivers in their textures, pixels.
    pub origin_px: UVec2,
    /// Source of the receivers.
    pub surfaces: Surfaces<'a>,
    /// World-space normals; always present for points.
    pub normals: Option<&'a wgpu::TextureView>,
    /// As [`Receivers::bounds`].
    pub bounds: Option<Aabb>,
    /// As [`Receivers::hull`].
    pub hull: &'a [Vec3],
    /// As [`Receivers::seen`].
    pub seen: &'a [Vec3],
    /// As [`Receivers::shadow_distance`].
    pub shadow_distance: Option<ShadowDistance>,
}

impl<'a> From<Receivers<'a>> for PreparedReceivers<'a> {
    fn from(receivers: Receivers<'a>) -> Self {
        Self {
            size_px: receivers.size_px,
            origin_px: receivers.origin_px,
            surfaces: Surfaces::Depth { depth: receivers.depth, camera: receivers.camera() },
            normals: receivers.normals,
            bounds: receivers.bounds,
            hull: receivers.hull,
            seen: receivers.seen,
            shadow_distance: receivers.shadow_distance,
        }
    }
}

impl<'a> PreparedReceivers<'a> {
    /// Camera; `None` for points.
    pub(crate) fn camera(&self) -> Option<&Camera> {
        match &self.surfaces {
            Surfaces::Depth { camera, .. } => Some(camera),
            Surfaces::Points { .. } => None,
        }
    }

    /// Texture that passes over the receivers read: depth or positions.
    pub(crate) fn texels(&self) -> &'a wgpu::TextureView {
        match self.surfaces {
            Surfaces::Depth { depth, .. } => depth,
            Surfaces::Points { positions, .. } => positions,
        }
    }

    /// Whether neighbouring texels are mostly of one surface, so that one can be interpolated from the others.
    pub(crate) fn have_neighbours(&self) -> bool {
        matches!(self.surfaces, Surfaces::Depth { .. })
    }

    /// World-space points whose convex hull holds every receiver: the host's hull, or the corners of the part of `bounds` that the
    /// camera sees. Empty if there is neither.
    pub(crate) fn corners(&self) -> Vec<Vec3> {
        if !self.hull.is_empty() {
            return self.hull.to_vec();
        }
        let Some(bounds) = self.bounds.filter(|bounds| !bounds.is_empty()) else { return Vec::new() };
        let Some(planes) = self.frustum_planes() else { return bounds.corners().to_vec() };
        let corners = seen_corners(bounds, &planes);
        // Rounding may leave an empty intersection; the whole box is still valid.
        if corners.is_empty() { bounds.corners().to_vec() } else { corners }
    }

    /// World-space box in which receivers may lie inside a closed caster: the camera's near plane, which may show a caster's
    /// inside, or points that may be anywhere.
    pub(crate) fn box_within(&self) -> Aabb {
        const ANYWHERE: Aabb = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        match &self.surfaces {
            Surfaces::Depth { camera, .. } => camera.near_box(),
            Surfaces::Points { on_surfaces: true, .. } => Aabb::EMPTY,
            Surfaces::Points { on_surfaces: false, .. } => self.bounds.unwrap_or(ANYWHERE),
        }
    }

    /// Plane across the view at the shadow distance, if there is one: `plane · (x, 1) ≥ 0` in front of it. Points behind it are
    /// farther from the eye than the shadow distance.
    pub(crate) fn shadow_end_plane(&self) -> Option<DVec4> {
        let (camera, end_m) = (self.camera()?, f64::from(self.shadow_distance?.end_m));
        // The camera looks along −z, and its matrix is rigid.
        Some(camera.view_from_world.as_dmat4().row(2) + DVec4::W * end_m)
    }

    /// Frustum planes of the camera: `plane · (x, 1) ≥ 0` inside; `None` for points.
    pub(crate) fn frustum_planes(&self) -> Option<[DVec4; 5]> {
        self.camera().map(Camera::frustum_planes)
    }
}

/// Maximum number of points that [`PreparedReceivers::seen_points`] returns.
const SEEN_POINTS: u32 = 512;

impl PreparedReceivers<'_> {
    /// Points that the camera sees, of equal weight, or else points of the convex hull of `corners` within the view, each weighted
    /// by the pixels that a surface there covers: 1 / w². Without a camera all weights are equal.
    pub(crate) fn seen_points(&self, corners: &[Vec3]) -> Vec<SeenPoint> {
        if !self.seen.is_empty() {
            let every = self.seen.len().div_ceil(SEEN_POINTS as usize);
            let seen = self.seen.iter().step_by(every);
            return seen.map(|p| SeenPoint { pos_in_world: *p, weight: 1.0 }).collect();
        }
        let clip_from_world = self.camera().map(|camera| camera.clip_from_view * camera.view_from_world);
        let corner = |u: f32| corners[((u * corners.len() as f32) as usize).min(corners.len() - 1)];
        let points = if corners.is_empty() { 0 } else { SEEN_POINTS };
        (0..points)
            .map(|i| {
                // Gaps between sorted random numbers weight four corners: uniform over each tetrahedron.
                let u = |j: u32| unit_f32(hash_u32(7 * i + j));
                let mut cuts = [u(4), u(5), u(6)];
                cuts.sort_by(f32::total_cmp);
                corner(u(0)) * cuts[0]
                    + corner(u(1)) * (cuts[1] - cuts[0])
                    + corner(u(2)) * (cuts[2] - cuts[1])
                    + corner(u(3)) * (1.0 - cuts[2])
            })
            .filter_map(|pos_in_world| {
                let Some(clip_from_world) = clip_from_world else {
                    return Some(SeenPoint { pos_in_world, weight: 1.0 });
                };
                let clip = clip_from_world * pos_in_world.extend(1.0);
                let is_seen = clip.w > 0.0 && clip.x.abs() <= clip.w && clip.y.abs() <= clip.w;
                is_seen.then(|| SeenPoint { pos_in_world, weight: 1.0 / (clip.w * clip.w) })
            })
            .collect()
    }
}

fn frustum_planes(clip_from_world: DMat4) -> [DVec4; 5] {
    // A point is seen where −w ≤ x ≤ w, −w ≤ y ≤ w and w ≥ 0; the near and far planes cut little more.
    let [x, y, w] = [0, 1, 3].map(|i| clip_from_world.row(i));
    [w + x, w - x, w + y, w - y, w]
}

/// Returns the corners of the part of a box in front of all planes.
fn seen_corners(bounds: Aabb, frustum_planes: &[DVec4]) -> Vec<Vec3> {
    let planes = [frustum_planes, &bounds.planes()].concat();
    polytope_corners(&planes, f64::from(bounds.diagonal()))
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::{proj, view};

    use super::*;

    /// The corners of a cube inside the view are the cube's; those of a cube larger than the view are the view's.
    #[test]
    fn corners_hold_what_is_seen_and_little_more() {
        let clip_from_world = proj::directx::perspective_infinite_reverse(1.0, 1.5, 0.1)
            * view::look_at_mat4(Vec3::new(3.0, 2.0, 6.0), Vec3::ZERO, Vec3::Y);
        let cube = |half: f32| Aabb { min: Vec3::splat(-half), max: Vec3::splat(half) };
        let small = seen_corners(cube(0.5), &frustum_planes(clip_from_world.as_dmat4()));
        for corner in cube(0.5).corners() {
            assert!(small.iter().any(|p| p.abs_diff_eq(corner, 1e-3)), "{corner} of {small:?}");
        }
        let bounds = cube(20.0);
        let large = seen_corners(bounds, &frustum_planes(clip_from_world.as_dmat4()));
        assert!(large.len() >= 6);
        for p in &large {
            let clip = clip_from_world * p.extend(1.0);
            let room = 1e-2;
            assert!(clip.x.abs() <= clip.w + room && clip.y.abs() <= clip.w + room, "{p}");
            assert!(p.cmpge(bounds.min - room).all() && p.cmple(bounds.max + room).all(), "{p}");
        }
        // A visible point at the far side of the box lies in the hull's bounding box.
        let hull_box = Aabb::of(large.iter().copied());
        let deep = Vec3::new(-9.0, -6.0, -18.0);
        assert!(deep.cmpge(hull_box.min).all() && deep.cmple(hull_box.max).all(), "{hull_box:?}");
    }
}
