// Linked from src/light_map/depth_pyramid/last.wesl by `cargo xtask shaders`: edit that, not this.

struct NearLight {
    half_extent: vec2f,
    node_texels: f32,
    padding: f32
}

@group(0) @binding(6)
var nodes: texture_2d<f32>;

@group(0) @binding(7)
var<uniform> light: NearLight;

const THREADS = 256u;

const HALVINGS = 8u;

const BINS = 256u;

const BINS_PER_OCTAVE = 8.0;

const PARTS = 16777216.0;

const MATTERS = 4096u;

const MAX_OF_NODE = 65536.0;

const MUST_GAIN = 2.0;

var<workgroup> hidden: array<atomic<u32>, BINS>;

var<workgroup> ends_of_threads: array<vec2f, THREADS>;

fn parts_hidden(node: vec2u, z: f32) -> u32 {
    let uv = min((vec2f(node) + 0.5) * light.node_texels / halving_view.map_size, vec2f(1.0));
    let from_center = space_warped_plane(halving_view, uv) / space_inverse_divisor(halving_view, uv);
    let width = space_texel_in_plane_at(halving_view, from_center) * light.node_texels * z;
    let share = min(width / (2.0 * light.half_extent), vec2f(1.0));
    return u32(ceil(min(share.x * share.y * PARTS, MAX_OF_NODE)));
}

fn bin_of(z: f32) -> u32 {
    return u32(clamp(BINS_PER_OCTAVE * log2(z / halving_view.near_m), 0.0, f32(BINS - 1u)));
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
    let z = min(halving_view.near_m * exp2(f32(bin) / BINS_PER_OCTAVE), space_z_of_depth(halving_view, farthest));
    return select(nearest, space_depth_of_z(halving_view, z), z >= MUST_GAIN * space_z_of_depth(halving_view, nearest));
}

fn ends_of_all(own: vec2f, thread: u32) -> vec2f {
    ends_of_threads[thread] = own;
    for (var i = 1u; i <= HALVINGS; i++) {
        let pairs = THREADS >> i;
        workgroupBarrier();
        if thread < pairs {
            ends_of_threads[thread] = halving_joined(ends_of_threads[thread], ends_of_threads[thread + pairs]);
        }
    }
    workgroupBarrier();
    return ends_of_threads[0];
}

@compute @workgroup_size(256)
fn make_last(@builtin(local_invocation_index) thread: u32) {
    halving_make_three_levels(vec2u(0u), thread);
    let size = textureDimensions(nodes);
    let count = size.x * size.y;
    let is_cut = halving_view.perspective == 1u && all(light.half_extent > vec2f(0.0));
    var own = vec2f(1e30, -1e30);
    for (var i = thread; i < count; i += THREADS) {
        let node = vec2u(i % size.x, i / size.x);
        let ends = textureLoad(nodes, node, 0).xy;
        own = halving_joined(own, ends);
        if is_cut {
            let z = space_z_of_depth(halving_view, select(ends.x, ends.y, halving_view.depth_sign > 0.0));
            atomicAdd(&hidden[bin_of(z)], parts_hidden(node, z));
        }
    }
    var ends = ends_of_all(own, thread);
    if thread != 0u {
        return;
    }
    if is_cut && halving_view.depth_sign > 0.0 {
        ends.y = near_end(ends.y, ends.x);
    }
    else if is_cut {
        ends.x = near_end(ends.x, ends.y);
    }
    textureStore(halving_fourth_level, vec2u(0u), halving_held(ends));
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

fn space_unwarped_depth(view: space_LightViewGpu, depth: f32, uv: vec2f) -> f32 {
    if !space_is_warped(view) {
        return depth;
    }
    return depth / space_inverse_divisor(view, uv);
}

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}
