// Linked from src/light_map/depth_pyramid/levels.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn make_levels(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    halving_make_three_levels(group.xy, thread);
    if thread < 4u {
        let place = vec2u(thread % 2u, thread / 2u);
        let texel = 2u * group.xy + place;
        if halving_is_within(texel, textureDimensions(halving_fourth_level)) {
            textureStore(halving_fourth_level, texel, halving_held(halving_fourth_ends(place)));
        }
    }
}

override halving_IS_OF_MAP: bool = false;

@group(0) @binding(0)
var halving_source: texture_2d<f32>;

@group(0) @binding(1)
var<uniform> halving_view: space_LightViewGpu;

@group(0) @binding(2)
var halving_first_level: texture_storage_2d<rg32float, write>;

@group(0) @binding(3)
var halving_second_level: texture_storage_2d<rg32float, write>;

@group(0) @binding(4)
var halving_third_level: texture_storage_2d<rg32float, write>;

@group(0) @binding(5)
var halving_fourth_level: texture_storage_2d<rg32float, write>;

const halving_MAKERS = 64u;

var<workgroup> halving_of_second: array<vec2f, 64>;

var<workgroup> halving_of_third: array<vec2f, 16>;

fn halving_joined(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(min(a.x, b.x), max(a.y, b.y));
}

fn halving_source_ends(texel: vec2u) -> vec2f {
    let inside = min(texel, textureDimensions(halving_source) - 1u);
    let value = textureLoad(halving_source, inside, 0);
    if halving_IS_OF_MAP {
        return vec2f(space_unwarped_depth(halving_view, value.x, (vec2f(inside) + 0.5) / halving_view.map_size));
    }
    return value.xy;
}

fn halving_held(ends: vec2f) -> vec4f {
    return vec4f(ends, 0.0, 0.0);
}

fn halving_is_within(texel: vec2u, size: vec2u) -> bool {
    return all(texel < size);
}

fn halving_make_first(texel: vec2u) -> vec2f {
    let corner = 2u * texel;
    let upper = halving_joined(halving_source_ends(corner), halving_source_ends(corner + vec2u(1, 0)));
    let lower = halving_joined(halving_source_ends(corner + vec2u(0, 1)), halving_source_ends(corner + vec2u(1, 1)));
    let ends = halving_joined(upper, lower);
    if halving_is_within(texel, textureDimensions(halving_first_level)) {
        textureStore(halving_first_level, texel, halving_held(ends));
    }
    return ends;
}

fn halving_make_three_levels(group: vec2u, thread: u32) {
    if thread < halving_MAKERS {
        let texel = 8u * group + vec2u(thread % 8u, thread / 8u);
        let corner = 2u * texel;
        let upper = halving_joined(halving_make_first(corner), halving_make_first(corner + vec2u(1, 0)));
        let lower = halving_joined(halving_make_first(corner + vec2u(0, 1)), halving_make_first(corner + vec2u(1, 1)));
        let ends = halving_joined(upper, lower);
        halving_of_second[thread] = ends;
        if halving_is_within(texel, textureDimensions(halving_second_level)) {
            textureStore(halving_second_level, texel, halving_held(ends));
        }
    }
    workgroupBarrier();
    if thread < halving_MAKERS / 4u {
        let place = vec2u(thread % 4u, thread / 4u);
        let texel = 4u * group + place;
        let corner = 16u * place.y + 2u * place.x;
        let ends = halving_joined(halving_joined(halving_of_second[corner], halving_of_second[corner + 1u]), halving_joined(halving_of_second[corner + 8u], halving_of_second[corner + 9u]));
        halving_of_third[thread] = ends;
        if halving_is_within(texel, textureDimensions(halving_third_level)) {
            textureStore(halving_third_level, texel, halving_held(ends));
        }
    }
    workgroupBarrier();
}

fn halving_fourth_ends(place: vec2u) -> vec2f {
    let corner = 8u * place.y + 2u * place.x;
    return halving_joined(halving_joined(halving_of_third[corner], halving_of_third[corner + 1u]), halving_joined(halving_of_third[corner + 4u], halving_of_third[corner + 5u]));
}

struct space_LightViewGpu {
    origin_in_world: vec3f,
    perspective: u32,
    right_in_world: vec3f,
    depth_scale: f32,
    up_in_world: vec3f,
    depth_offset: f32,
    axis_in_world: vec3f,
    depth_sign: f32,
    uv_from_plane: vec4f,
    plane_from_uv: vec4f,
    uv_origin: vec2f,
    map_size: vec2f,
    near_m: f32,
    far_m: f32,
    texel_in_plane: f32,
    complete_from_m: f32,
    warp: vec2f,
    plane_center: vec2f
}

fn space_is_warped(view: space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn space_warped_plane(view: space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn space_inverse_divisor(view: space_LightViewGpu, uv: vec2f) -> f32 {
    return max(1.0 - dot(view.warp, space_warped_plane(view, uv)), 0.0001);
}

fn space_unwarped_depth(view: space_LightViewGpu, depth: f32, uv: vec2f) -> f32 {
    if !space_is_warped(view) {
        return depth;
    }
    return depth / space_inverse_divisor(view, uv);
}
