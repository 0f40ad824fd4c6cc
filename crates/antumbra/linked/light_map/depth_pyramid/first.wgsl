// Linked from src/light_map/depth_pyramid/first.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var map: texture_2d<f32>;

@group(0) @binding(1)
var level: texture_storage_2d<rg32float, write>;

@group(0) @binding(2)
var<uniform> view: space_LightViewGpu;

fn depth_at(texel: vec2u) -> f32 {
    let held = min(texel, textureDimensions(map) - 1u);
    return space_unwarped_depth(view, textureLoad(map, held, 0).x, (vec2f(held) + 0.5) / view.map_size);
}

@compute @workgroup_size(8, 8)
fn first(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(level)) {
        return;
    }
    let a = depth_at(2u * id.xy);
    let b = depth_at(2u * id.xy + vec2u(1, 0));
    let c = depth_at(2u * id.xy + vec2u(0, 1));
    let d = depth_at(2u * id.xy + vec2u(1, 1));
    textureStore(level, id.xy, vec4f(min(min(a, b), min(c, d)), max(max(a, b), max(c, d)), 0.0, 0.0));
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
    held_from_m: f32,
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
