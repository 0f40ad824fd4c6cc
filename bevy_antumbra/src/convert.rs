//! Conversion from Bevy's vectors to the library's, which are of another version of glam.

use antumbra::light::Aabb;
use bevy::math::Affine3A;

pub fn vec3(v: bevy::math::Vec3) -> glam::Vec3 {
    glam::Vec3::from_array(v.to_array())
}

pub fn mat4(m: &bevy::math::Mat4) -> glam::Mat4 {
    glam::Mat4::from_cols_array(&m.to_cols_array())
}

pub fn affine(a: &Affine3A) -> glam::Mat4 {
    mat4(&bevy::math::Mat4::from(*a))
}

/// Returns the bounds of a transformed box; an empty box stays empty.
pub fn moved(bounds: Aabb, world_from_object: &glam::Mat4) -> Aabb {
    if bounds.is_empty() {
        return bounds;
    }
    Aabb::of(bounds.corners().map(|corner| world_from_object.transform_point3(corner)))
}
