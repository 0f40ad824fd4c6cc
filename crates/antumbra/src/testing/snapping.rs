//! A rasteriser that interpolates depth between corners as graphics cards place them: on a grid of 1/256 of a pixel, where
//! software Vulkan interpolates between the corners themselves.

use glam::{DMat4, DVec2, DVec3, DVec4, Mat4, UVec2, Vec3};

/// Steps of the grid in a pixel: 8 bits, which all desktop cards have.
const STEPS_PER_PIXEL: f64 = 256.0;

/// The triangles of [`Case::half_plane`](super::Case::half_plane).
pub(crate) const HALF_PLANE: [[Vec3; 3]; 4] = {
    const fn at(x: f32, y: f32, z: f32) -> Vec3 {
        Vec3::new(x, y, z)
    }
    [
        [at(-6.0, 0.0, -6.0), at(-6.0, 0.0, 6.0), at(6.0, 0.0, 6.0)],
        [at(-6.0, 0.0, -6.0), at(6.0, 0.0, 6.0), at(6.0, 0.0, -6.0)],
        [at(-4.0, 1.5, -4.0), at(-4.0, 1.5, 4.0), at(0.0, 1.5, 4.0)],
        [at(-4.0, 1.5, -4.0), at(0.0, 1.5, 4.0), at(0.0, 1.5, -4.0)],
    ]
};

/// The reversed depth buffer of some triangles, row by row.
pub(crate) fn snapped_depth(clip_from_world: Mat4, size: UVec2, triangles: &[[Vec3; 3]]) -> Vec<f32> {
    let clip_from_world = clip_from_world.as_dmat4();
    let mut depth = vec![0.0f32; (size.x * size.y) as usize];
    for triangle in triangles {
        let corners = before_near_plane(clip_from_world, triangle);
        // A fan.
        for i in 2..corners.len() {
            draw(&mut depth, size, [corners[0], corners[i - 1], corners[i]].map(|corner| on_grid(corner, size)));
        }
    }
    depth
}

/// What is left of a triangle beyond the near plane, where z = w.
fn before_near_plane(clip_from_world: DMat4, triangle: &[Vec3; 3]) -> Vec<DVec4> {
    let corners = triangle.map(|corner| clip_from_world * corner.as_dvec3().extend(1.0));
    let inside = |corner: DVec4| corner.w - corner.z;
    let mut left = Vec::new();
    for (a, b) in [0, 1, 2].map(|i| (corners[i], corners[(i + 1) % 3])) {
        if inside(a) >= 0.0 {
            left.push(a);
        }
        if (inside(a) >= 0.0) != (inside(b) >= 0.0) {
            left.push(a.lerp(b, inside(a) / (inside(a) - inside(b))));
        }
    }
    left
}

/// Pixels across and down, and depth.
fn on_grid(corner: DVec4, size: UVec2) -> DVec3 {
    let ndc = corner.truncate() / corner.w;
    let at_px = (DVec2::new(ndc.x, -ndc.y) * 0.5 + 0.5) * size.as_dvec2();
    ((at_px * STEPS_PER_PIXEL).round() / STEPS_PER_PIXEL).extend(ndc.z)
}

fn draw(depth: &mut [f32], size: UVec2, [a, b, c]: [DVec3; 3]) {
    let area_of = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let [at_a, at_b, at_c] = [a, b, c].map(DVec3::truncate);
    let area = area_of(at_a, at_b, at_c);
    if area == 0.0 {
        return;
    }
    for (i, texel) in (0..).zip(depth) {
        let p = UVec2::new(i % size.x, i / size.x).as_dvec2() + 0.5;
        let weights = DVec3::new(area_of(p, at_b, at_c), area_of(p, at_c, at_a), area_of(p, at_a, at_b)) / area;
        if weights.min_element() >= 0.0 {
            *texel = texel.max(weights.dot(DVec3::new(a.z, b.z, c.z)) as f32);
        }
    }
}
