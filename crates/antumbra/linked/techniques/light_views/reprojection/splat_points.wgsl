// Linked from src/techniques/light_views/reprojection/splat_points.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(8, 8)
fn splat(@builtin(global_invocation_id) id: vec3u) {
    points_scatter_quad(2u * id.xy, splat_batch.first_slice + id.z);
}

@group(1) @binding(0)
var central_central_depth: texture_depth_2d_array;

@group(2) @binding(1)
var<uniform> group_views: splat_ViewGroup;

override points_BRINGS_TOGETHER: bool = true;

const points_NOWHERE = 4294967295u;

fn points_depth_at(texel: vec2u, slice: u32) -> f32 {
    let size = textureDimensions(central_central_depth);
    let depth = textureLoad(central_central_depth, min(texel, size - 1u), slice, 0);
    return select(0.0, depth, all(texel < size));
}

struct points_Quad {
    x: vec4f,
    y: vec4f,
    depth: vec4f
}

struct points_Stores {
    index: vec4u,
    depth_bits: vec4u
}

fn points_stores_of(quad: points_Quad, i: u32) -> points_Stores {
    let m = group_views.target_from_central[i];
    let moved = m[3];
    var x = m[0].x * quad.x + (m[1].x * quad.y + (m[2].x * quad.depth + moved.x));
    var y = m[0].y * quad.x + (m[1].y * quad.y + (m[2].y * quad.depth + moved.y));
    var z = m[0].z * quad.x + (m[1].z * quad.y + (m[2].z * quad.depth + moved.z));
    var is_stored = quad.depth > vec4f(0.0);
    if !splat_IS_AFFINE {
        let w = m[0].w * quad.x + (m[1].w * quad.y + (m[2].w * quad.depth + moved.w));
        x /= w;
        y /= w;
        z /= w;
        is_stored &= w > vec4f(0.0);
    }
    let size = vec4f(f32(splat_batch.view_size));
    let texel_x = floor(x);
    let texel_y = floor(y);
    is_stored &= (x >= vec4f(0.0)) & (y >= vec4f(0.0)) & (x < size) & (y < size) & (z > vec4f(0.0));
    if splat_HAS_REACH {
        let off_centre = max(abs(x - texel_x - 0.5), abs(y - texel_y - 0.5));
        is_stored &= off_centre <= vec4f(splat_batch.reach);
    }
    let map = group_views.first_map + i * group_views.map_step;
    let index = (map * splat_batch.view_size + vec4u(texel_y)) * splat_batch.row_texels + vec4u(texel_x);
    return points_Stores(select(vec4u(points_NOWHERE), index, is_stored), bitcast<vec4u>(min(z, vec4f(1.0))));
}

fn points_bring_together(index: ptr<function, u32>, bits: ptr<function, u32>, other_index: ptr<function, u32>, other_bits: u32) {
    let is_one = *index == *other_index;
    *bits = select(*bits, max(*bits, other_bits), is_one);
    *other_index = select(*other_index, points_NOWHERE, is_one);
}

fn points_scatter_into(quad: points_Quad, i: u32) {
    let stores = points_stores_of(quad, i);
    var at_0 = stores.index.x;
    var at_1 = stores.index.y;
    var at_2 = stores.index.z;
    var at_3 = stores.index.w;
    var bits_0 = stores.depth_bits.x;
    let bits_1 = stores.depth_bits.y;
    var bits_2 = stores.depth_bits.z;
    let bits_3 = stores.depth_bits.w;
    var right_0 = bits_1;
    if points_BRINGS_TOGETHER {
        points_bring_together(&at_0, &bits_0, &at_1, bits_1);
        points_bring_together(&at_2, &bits_2, &at_3, bits_3);
        points_bring_together(&at_0, &bits_0, &at_2, bits_2);
        points_bring_together(&at_1, &right_0, &at_3, bits_3);
    }
    if at_0 != points_NOWHERE {
        splat_keep(at_0, bits_0);
    }
    if at_1 != points_NOWHERE {
        splat_keep(at_1, right_0);
    }
    if at_2 != points_NOWHERE {
        splat_keep(at_2, bits_2);
    }
    if at_3 != points_NOWHERE {
        splat_keep(at_3, bits_3);
    }
}

fn points_scatter_quad(first: vec2u, slice: u32) {
    var depth = vec4f(points_depth_at(first, slice), points_depth_at(first + vec2u(1u, 0u), slice), points_depth_at(first + vec2u(0u, 1u), slice), points_depth_at(first + vec2u(1u, 1u), slice));
    let left_above = vec2f(first) + 0.5;
    let x = left_above.x + vec4f(0.0, 1.0, 0.0, 1.0);
    let y = left_above.y + vec4f(0.0, 0.0, 1.0, 1.0);
    if splat_TRIES_FACES {
        let m = group_views.metres_from_central;
        depth = select(vec4f(0.0), depth, vec4<bool>(splat_may_be_seen(m, vec2f(x.x, y.x), depth.x), splat_may_be_seen(m, vec2f(x.y, y.y), depth.y), splat_may_be_seen(m, vec2f(x.z, y.z), depth.z), splat_may_be_seen(m, vec2f(x.w, y.w), depth.w)));
    }
    if !any(depth > vec4f(0.0)) {
        return;
    }
    let quad = points_Quad(x, y, depth);
    points_scatter_into(quad, 0u);
    points_scatter_into(quad, 1u);
    points_scatter_into(quad, 2u);
    points_scatter_into(quad, 3u);
    points_scatter_into(quad, 4u);
    points_scatter_into(quad, 5u);
    points_scatter_into(quad, 6u);
    points_scatter_into(quad, 7u);
}

struct splat_SplatBatch {
    view_size: u32,
    row_texels: u32,
    first_group: u32,
    group_count: u32,
    first_slice: u32,
    has_receivers: u32,
    reach: f32,
    steepest: f32,
    width_of_depth: f32,
    width: f32,
    face_half_size: f32,
    face_slack_m: f32,
    light_reach: vec4f,
    light_axis: vec4f,
    light_front: vec4f,
    receivers: array<vec4f, 8>
}

struct splat_ViewGroup {
    target_from_central: array<mat4x4f, 8>,
    metres_from_central: mat4x4f,
    first_map: u32,
    map_step: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: array<vec4u, 11>
}

override splat_SYNCHRONIZED: bool = true;

override splat_IS_AFFINE: bool = false;

override splat_TRIES_FACES: bool = false;

override splat_HAS_REACH: bool = false;

@group(2) @binding(0)
var<uniform> splat_batch: splat_SplatBatch;

@group(2) @binding(2)
var<storage, read_write> splat_targets: array<atomic<u32>>;

fn splat_keep(index: u32, depth_bits: u32) {
    if splat_SYNCHRONIZED {
        atomicMax(&splat_targets[index], depth_bits);
    }
    else {
        atomicStore(&splat_targets[index], depth_bits);
    }
}

fn splat_project(m: mat4x4f, pos: vec2f, depth: f32) -> vec4f {
    return m[0] * pos.x + (m[1] * pos.y + (m[2] * depth + m[3]));
}

fn splat_may_be_seen(metres_from_central: mat4x4f, pos: vec2f, depth: f32) -> bool {
    let h = splat_project(metres_from_central, pos, depth);
    return max(abs(h.x), abs(h.y)) <= splat_batch.face_half_size * h.z + splat_batch.face_slack_m * h.w;
}
