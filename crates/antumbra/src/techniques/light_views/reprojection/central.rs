//! Views that fragments are reprojected from and to: one from the light's centre, or the faces of a cube around it, and as
//! many from each light point; and the matrices between their images.

use antumbra_light::{Aabb, Light, LightFrame, LightPoint};
use glam::{DMat4, DVec4, Mat4, Vec3};

use super::behind::CenterBehindLight;
use super::gpu_types::{SplatBatch, ViewGroup};
use super::settings::{ReprojectionProjection, Settings};
use crate::light_map::central_view::{central_fit, central_reach};
use crate::light_map::light_view::{FollowedLight, LightView, LightViewGpu, Window};
use crate::light_map::occluding_bounds::OccludingBounds;
use crate::techniques::light_views::{Batch, views_from};

/// Maximum tangent of a plane view: a wider one is cut or wasteful, and a cube takes its place.
const WIDEST_PLANE_TANGENT: f32 = 2.5;

/// Number of faces of a cube, in the order of `sample_views.wesl`; the last looks back and is left out for lights that
/// emit nothing there.
const CUBE_FACES: usize = 6;

/// Border of a cube's face beyond its edge, texels: bilinear quads and the bias stay on the face.
const FACE_BORDER_TEXELS: f32 = 2.0;

/// Near plane of a cube's faces, as a fraction of the far plane: reversed 32-bit depths keep their precision.
const CUBE_NEAR_FRACTION: f32 = 1e-3;

/// Number of targets of a group, as in `splat.wesl`.
const GROUP_SIZE: usize = 8;

/// Difference from (0, 0, 0, 1), over a whole image, below which a matrix's last row counts as that: the precision with which
/// light points in 32 bits lie in one plane, and a thousandth of the distance between texels.
const AFFINE_PRECISION: f64 = 1e-6;

/// Views of a frame.
#[derive(Debug)]
pub(super) struct Views {
    /// Central views: one, or the faces of a cube.
    pub(super) central: Vec<LightView>,
    /// Targets: as many views for each light point, point by point.
    pub(super) targets: Vec<LightView>,
    /// Texels along a side of a central view.
    pub(super) central_size: u32,
    /// Texels along a side of a target.
    pub(super) view_size: u32,
    /// Position of the central views, if they are from behind the light.
    pub(super) behind: Option<CenterBehindLight>,
}

/// Matrices from the central images to the targets'.
#[derive(Debug)]
pub(super) struct Matrices {
    /// Matrices by central view, face and point: see [`target_from_central`].
    pub(super) target_from_central: Vec<Mat4>,
    /// Matrices by central view and face: see [`metres_from_central`].
    metres_from_central: Vec<Mat4>,
    /// Whether w is 1 in all of `target_from_central`.
    pub(super) is_affine: bool,
}

/// Range of the groups of one central view in one batch.
#[derive(Clone, Copy, Debug)]
pub(super) struct GroupRange {
    pub(super) first: u32,
    pub(super) count: u32,
}

impl Views {
    pub(super) fn of(
        light: &Light,
        points: &[LightPoint],
        casters: &[Aabb],
        receivers: &[Vec3],
        settings: &Settings,
    ) -> Self {
        let from_middle = central_plane(light, casters, receivers);
        let (central_size, view_size) = (settings.central_size, settings.view_size);
        let behind = settings.may_be_from_behind().then(|| CenterBehindLight::of(light, &from_middle)).flatten();
        let from_behind = behind.and_then(|behind| behind.plane(light, casters, receivers));
        if from_behind.is_some() || !needs_cube(light, &from_middle, settings.projection) {
            let targets = views_from(light, points, casters, receivers, &[]);
            let behind = behind.filter(|_| from_behind.is_some());
            let central = vec![from_behind.unwrap_or(from_middle)];
            return Self { central, targets, central_size, view_size, behind };
        }
        let (central_size, view_size) = ((central_size / 2).max(1), (view_size / 2).max(1));
        // Casters farther than all receivers cast no shadow on them.
        let of_receivers = Aabb::of(receivers.iter().copied());
        let of_casters = || OccludingBounds::new(light, casters, receivers).all().fold(Aabb::EMPTY, Aabb::union);
        let all = if of_receivers.is_empty() { of_casters() } else { of_receivers };
        let looks_back = light.is_omnidirectional() && is_behind(&from_middle.frame, receivers, all);
        let behind = behind.filter(|_| !light.is_omnidirectional());
        let middle = behind.map_or(from_middle.frame, |behind| behind.frame);
        let (central, targets) = central_and_target_cubes(middle, points, all, looks_back, (central_size, view_size));
        Self { central, targets, central_size, view_size, behind }
    }

    /// Number of maps of each light point.
    pub(super) fn faces(&self) -> u32 {
        self.central.len() as u32
    }

    /// Corners of a box in the image of a central view: texels and depth, homogeneous.
    pub(super) fn in_central(&self, view: usize, bounds: Aabb) -> [[f32; 4]; 8] {
        let texels_from_world = texels_from_world(&self.central[view], self.central_size);
        bounds.corners().map(|corner| (texels_from_world * corner.as_dvec3().extend(1.0)).as_vec4().to_array())
    }

    /// Plane of the light's front in the image of a central view: see [`SplatBatch`].
    pub(super) fn light_front_in_central(&self, view: usize) -> [f32; 4] {
        let Some(behind) = self.behind else { return [0.0, 0.0, 0.0, 1.0] };
        let texels_from_world = texels_from_world(&self.central[view], self.central_size);
        (texels_from_world.inverse().transpose() * behind.front_in_world()).as_vec4().to_array()
    }

    /// Fields of a [`SplatBatch`] that describe the light: see `hides_nothing` in `surfels.wesl`.
    pub(super) fn light_in_central(&self, view: usize, points: &[LightPoint]) -> SplatBatch {
        let central = &self.central[view];
        let LightFrame { center, right, up, axis } = central.frame;
        let reach = |along: &dyn Fn(&LightPoint) -> Vec3| {
            points.iter().fold(Vec3::ZERO, |most, point| most.max(along(point).abs()))
        };
        let on_axes = |v: Vec3| Vec3::new(v.dot(right), v.dot(up), v.dot(axis));
        // Metres; for directions, tangents.
        let reach = if central.perspective {
            reach(&|point| on_axes(point.xyz - center))
        } else {
            reach(&|point| on_axes(point.xyz) / point.xyz.dot(axis).abs().max(1e-20)).with_z(0.0)
        };
        let LightViewGpu { depth_scale, depth_offset, uv_from_plane, uv_origin, .. } =
            central.to_gpu(self.central_size);
        let texels_each = self.central_size as f32 / depth_scale;
        let [xx, xy, yx, yy] = uv_from_plane;
        let light_reach = [xx * reach.x, xy * reach.x, yx * reach.y, yy * reach.y].map(|part| texels_each * part);
        let origin = uv_origin * self.central_size as f32;
        let light_axis = [origin.x, origin.y, depth_offset, reach.z / depth_scale];
        SplatBatch { light_reach, light_axis, ..SplatBatch::default() }
    }

    /// Computes all matrices.
    pub(super) fn matrices(&self, settings: &Settings) -> Matrices {
        let target_from_central = target_from_central(self, settings.bias_before.then_some(settings.bias_scale));
        let is_affine = target_from_central.iter().all(|matrix| matrix.row(3) == glam::Vec4::W);
        Matrices { target_from_central, metres_from_central: metres_from_central(self), is_affine }
    }
}

impl Matrices {
    /// Returns the matrices in groups, by batch, central view and face; and the range of groups of each central view in
    /// each batch.
    pub(super) fn groups(&self, faces: u32, batches: &[Batch]) -> (Vec<ViewGroup>, Vec<Vec<GroupRange>>) {
        let faces = faces as usize;
        let points = self.target_from_central.len() / (faces * faces);
        let mut groups = Vec::new();
        let mut ranges = Vec::with_capacity(batches.len());
        for batch in batches {
            let in_batch = batch.first as usize..(batch.first + batch.count) as usize;
            let of_views = (0..faces).map(|view| {
                let first = groups.len() as u32;
                for face in 0..faces {
                    for begin in in_batch.clone().step_by(GROUP_SIZE) {
                        let list = (view * faces + face) * points;
                        let end = (begin + GROUP_SIZE).min(in_batch.end);
                        let mut group = ViewGroup {
                            metres_from_central: self.metres_from_central[view * faces + face].to_cols_array(),
                            first_map: ((begin - in_batch.start) * faces + face) as u32,
                            map_step: faces as u32,
                            ..ViewGroup::default()
                        };
                        let matrices = &self.target_from_central[list + begin..list + end];
                        for (to, matrix) in group.target_from_central.iter_mut().zip(matrices) {
                            *to = matrix.to_cols_array();
                        }
                        groups.push(group);
                    }
                }
                GroupRange { first, count: groups.len() as u32 - first }
            });
            ranges.push(of_views.collect());
        }
        (groups, ranges)
    }
}

/// Central view in a single plane.
fn central_plane(light: &Light, casters: &[Aabb], receivers: &[Vec3]) -> LightView {
    let fit = central_fit(light, FollowedLight::Whole, central_reach(light), casters, receivers).for_many_windows();
    fit.view(LightView::best_roll(|window| fit.view(window)))
}

/// Whether any receiver is behind the plane through `middle`; if none are known, whether part of `all` is.
fn is_behind(middle: &LightFrame, receivers: &[Vec3], all: Aabb) -> bool {
    let behind = |x: &Vec3| (*x - middle.center).dot(middle.axis) < 0.0;
    if receivers.is_empty() { all.corners().iter().any(behind) } else { receivers.iter().any(behind) }
}

/// Whether the central view is a cube: if requested, or if a plane view would be cut. Lights that shine all around come in
/// parts, each of which a plane holds.
fn needs_cube(light: &Light, plane: &LightView, projection: ReprojectionProjection) -> bool {
    !light.is_distant()
        && match projection {
            ReprojectionProjection::Plane => false,
            ReprojectionProjection::Cube => true,
            ReprojectionProjection::Auto => {
                light.max_angle_tangent().is_none() && plane.window.half_size.max_element() > WIDEST_PLANE_TANGENT
            }
        }
}

/// Cube faces around the light's centre, and around each light point.
fn central_and_target_cubes(
    middle: LightFrame,
    points: &[LightPoint],
    all: Aabb,
    looks_back: bool,
    (central_size, view_size): (u32, u32),
) -> (Vec<LightView>, Vec<LightView>) {
    let faces = if looks_back { CUBE_FACES } else { CUBE_FACES - 1 };
    let cube = |center: Vec3, size| {
        let far_m = if all.is_empty() {
            1.0
        } else {
            all.corners().iter().map(|corner| corner.distance(center)).fold(0.0, f32::max)
        };
        cube_faces(LightFrame { center, ..middle }, far_m, size).into_iter().take(faces)
    };
    let central = cube(middle.center, central_size).collect();
    (central, points.iter().flat_map(|point| cube(point.xyz, view_size)).collect())
}

/// Faces of a cube around `frame`'s centre, in the order of [`CUBE_FACES`].
fn cube_faces(frame: LightFrame, far_m: f32, size: u32) -> [LightView; CUBE_FACES] {
    let LightFrame { right, up, axis, .. } = frame;
    let half_size = 1.0 / (1.0 - 2.0 * FACE_BORDER_TEXELS / size as f32).max(0.5);
    // Each (right, up, -axis) is right-handed.
    [
        (right, up, axis),
        (-axis, up, right),
        (axis, up, -right),
        (right, -axis, up),
        (right, axis, -up),
        (-right, up, -axis),
    ]
    .map(|(right, up, axis)| LightView {
        frame: LightFrame { right, up, axis, ..frame },
        perspective: true,
        window: Window::square(half_size),
        near_m: far_m * CUBE_NEAR_FRACTION,
        far_m: far_m * 1.001,
        complete_from_m: 0.0,
    })
}

/// Matrices from texels and depth of the centre to texels and depth of a target: for each central view, a list for each face.
///
/// With bias before reprojection, the central depth first moves away from the light by the automatic bias of the
/// central map: Z grows by the factor 1 + b, or by b if rays are parallel, so that depth changes affinely.
fn target_from_central(views: &Views, bias_before: Option<f32>) -> Vec<Mat4> {
    let Views { central, targets, central_size, view_size, .. } = views;
    let mut matrices = Vec::with_capacity(central.len() * targets.len());
    for view in central {
        let mut world_from_texels = texels_from_world(view, *central_size).inverse();
        if let Some(bias_scale) = bias_before {
            let bias = 0.5 * bias_scale * view.texel_in_plane(*central_size);
            world_from_texels *= view.depth_moved_away(bias);
        }
        let faces = central.len();
        for target in (0..faces).flat_map(|face| targets.iter().skip(face).step_by(faces)) {
            let matrix = texels_from_world(target, *view_size) * world_from_texels;
            // Any multiple is the same transform; this one keeps w near 1.
            let scale = matrix.w_axis.w.abs().max(matrix.row(3).abs().max_element());
            matrices.push(snapped(matrix * scale.recip(), *central_size).as_mat4());
        }
    }
    matrices
}

/// Returns the matrix with a last row of exactly (0, 0, 0, 1), if it differs from that only by rounding.
fn snapped(mut matrix: DMat4, central_size: u32) -> DMat4 {
    let off = (matrix.row(3) - DVec4::W).abs();
    let size = f64::from(central_size);
    if (off.x + off.y) * size + off.z + off.w < AFFINE_PRECISION {
        matrix.x_axis.w = 0.0;
        matrix.y_axis.w = 0.0;
        matrix.z_axis.w = 0.0;
        matrix.w_axis.w = 1.0;
    }
    matrix
}

/// Matrices, for each central view and each face, from texels and depth of the view to metres from the centre of the central
/// views along the face's axes, homogeneous.
fn metres_from_central(views: &Views) -> Vec<Mat4> {
    let metres_from_world = |frame: &LightFrame| {
        let rows = [frame.right, frame.up, frame.axis].map(|axis| {
            let axis = axis.as_dvec3();
            axis.extend(-axis.dot(frame.center.as_dvec3()))
        });
        DMat4::from_cols(rows[0], rows[1], rows[2], DVec4::W).transpose()
    };
    let central = &views.central;
    let mut matrices = Vec::with_capacity(central.len() * central.len());
    for view in central {
        let world_from_texels = texels_from_world(view, views.central_size).inverse();
        matrices.extend(central.iter().map(|face| (metres_from_world(&face.frame) * world_from_texels).as_mat4()));
    }
    matrices
}

/// Matrix from world space to texels and depth of a view's map, homogeneous.
pub(super) fn texels_from_world(view: &LightView, size: u32) -> DMat4 {
    let half = 0.5 * f64::from(size);
    let texels_from_clip = DMat4::from_cols(
        DVec4::new(half, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -half, 0.0, 0.0),
        DVec4::Z,
        DVec4::new(half, half, 0.0, 1.0),
    );
    texels_from_clip * view.clip_from_world_f64()
}
