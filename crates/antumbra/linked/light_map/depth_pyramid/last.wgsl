// Linked from src/light_map/depth_pyramid/last.wesl by `cargo xtask shaders`: edit that, not this.

struct NearLight {
    half_extent: vec2f,
    node_texels: f32,
    padding: f32
}

@group(0) @binding(0)
var nodes: texture_2d<f32>;

@group(0) @binding(1)
var level: texture_storage_2d<rg32float, write>;

@group(0) @binding(2)
var<uniform> view: space_LightViewGpu;

@group(0) @binding(3)
var<uniform> light: NearLight;

const THREADS = 256u;

const BINS = 256u;

const BINS_PER_OCTAVE = 8.0;

const PARTS = 16777216.0;

const MATTERS = 4096u;

const MOST_OF_NODE = 65536.0;

const MUST_GAIN = 2.0;

var<workgroup> hidden: array<atomic<u32>, BINS>;

var<workgroup> lows: array<f32, THREADS>;

var<workgroup> highs: array<f32, THREADS>;

fn parts_hidden(node: vec2u, z: f32) -> u32 {
    let uv = min((vec2f(node) + 0.5) * light.node_texels / view.map_size, vec2f(1.0));
    let from_center = space_warped_plane(view, uv) / space_inverse_divisor(view, uv);
    let width = space_texel_in_plane_at(view, from_center) * light.node_texels * z;
    let share = min(width / (2.0 * light.half_extent), vec2f(1.0));
    return u32(ceil(min(share.x * share.y * PARTS, MOST_OF_NODE)));
}

fn bin_of(z: f32) -> u32 {
    return u32(clamp(BINS_PER_OCTAVE * log2(z / view.near_m), 0.0, f32(BINS - 1u)));
}

fn near_end(nearest: f32, farthest: f32) -> f32 {
    var parts = 0u;
    var bin = 0u;
    for (; bin < BINS; bin++) {
        parts += atomicLoad(&hidden[bin]);
        if parts > MATTERS {
            break;
        }
    }
    let z = min(view.near_m * exp2(f32(bin) / BINS_PER_OCTAVE), space_z_of_depth(view, farthest));
    return select(nearest, space_depth_of_z(view, z), z >= MUST_GAIN * space_z_of_depth(view, nearest));
}

@compute @workgroup_size(256)
fn last(@builtin(local_invocation_index) t: u32) {
    let size = textureDimensions(nodes);
    let count = size.x * size.y;
    let is_cut = view.perspective == 1u && all(light.half_extent > vec2f(0.0));
    var low = 1e30;
    var high = -1e30;
    for (var i = t; i < count; i += THREADS) {
        let node = vec2u(i % size.x, i / size.x);
        let ends = textureLoad(nodes, node, 0).xy;
        low = min(low, ends.x);
        high = max(high, ends.y);
        if is_cut {
            let z = space_z_of_depth(view, select(ends.x, ends.y, view.depth_sign > 0.0));
            atomicAdd(&hidden[bin_of(z)], parts_hidden(node, z));
        }
    }
    lows[t] = low;
    highs[t] = high;
    workgroupBarrier();
    if t != 0u {
        return;
    }
    for (var i = 1u; i < THREADS; i++) {
        low = min(low, lows[i]);
        high = max(high, highs[i]);
    }
    if is_cut && view.depth_sign > 0.0 {
        high = near_end(high, low);
    }
    else if is_cut {
        low = near_end(low, high);
    }
    textureStore(level, vec2u(0u), vec4f(low, high, 0.0, 0.0));
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

fn space_depth_of_z(view: space_LightViewGpu, z_m: f32) -> f32 {
    return view.depth_scale * select(z_m, 1.0 / z_m, view.perspective == 1u) + view.depth_offset;
}

fn space_texel_in_plane_at(view: space_LightViewGpu, from_center: vec2f) -> f32 {
    if !space_is_warped(view) {
        return view.texel_in_plane;
    }
    let w = 1.0 + dot(view.warp, from_center);
    let u = view.plane_from_uv.xy / view.map_size.x;
    let v = view.plane_from_uv.zw / view.map_size.y;
    return w * max(length(u + from_center * dot(view.warp, u)), length(v + from_center * dot(view.warp, v)));
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

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}
