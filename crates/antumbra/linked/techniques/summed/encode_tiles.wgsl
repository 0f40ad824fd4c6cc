// Linked from src/techniques/summed/encode_tiles.wesl by `cargo xtask shaders`: edit that, not this.

@group(3) @binding(0)
var basis: texture_storage_2d<rgba32uint, write>;

const REGION = 64u;

@compute @workgroup_size(64)
fn encode_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) t: u32) {
    let size = textureDimensions(basis);
    let side = 1u << package_techniques_summed_uniform_soft.tile_log2;
    let region = max(side, REGION);
    let origin = group.xy * region;
    package_techniques_summed_source__1begin_values(size, origin, region, side, t);
    for (var y = 0u; y < region; y++) {
        for (var x = t; x < region; x += 64u) {
            let texel = origin + vec2u(x, y);
            if all(texel < size) {
                textureStore(basis, texel, package_techniques_summed_source__1value_at(texel));
            }
        }
    }
}

@group(1) @binding(3)
var package__1light_map__1blocker_range__2light_map_pyramid: texture_2d<f32>;

@group(1) @binding(0)
var<uniform> package__1light_map_map__1light_view: package__1light_map_space_LightViewGpu;

@group(1) @binding(1)
var package__1light_map_map__1light_map: texture_depth_2d;

fn package__1light_map_map__2uv_of_texel(texel: vec2i) -> vec2f {
    return (vec2f(texel) + 0.5) / package__1light_map_map__1light_view.map_size;
}

fn package__1light_map_map__1unwarped_texel(texel: vec2i) -> f32 {
    return package__1light_map_space__1unwarped_depth(package__1light_map_map__1light_view, textureLoad(package__1light_map_map__1light_map, texel, 0), package__1light_map_map__2uv_of_texel(texel));
}

struct package__1light_map_space_LightViewGpu {
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
    padding: f32,
    warp: vec2f,
    plane_center: vec2f
}

fn package__1light_map_space__1is_warped(view: package__1light_map_space_LightViewGpu) -> bool {
    return any(view.warp != vec2f());
}

fn package__1light_map_space__1warped_plane(view: package__1light_map_space_LightViewGpu, uv: vec2f) -> vec2f {
    let from_origin = uv - view.uv_origin;
    return view.plane_from_uv.xy * from_origin.x + view.plane_from_uv.zw * from_origin.y;
}

fn package__1light_map_space__1inverse_divisor(view: package__1light_map_space_LightViewGpu, uv: vec2f) -> f32 {
    return max(1.0 - dot(view.warp, package__1light_map_space__1warped_plane(view, uv)), 0.0001);
}

fn package__1light_map_space__1unwarped_depth(view: package__1light_map_space_LightViewGpu, depth: f32, uv: vec2f) -> f32 {
    if !package__1light_map_space__1is_warped(view) {
        return depth;
    }
    return depth / package__1light_map_space__1inverse_divisor(view, uv);
}

fn package__1light_map_space__2z_of_depth(view: package__1light_map_space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

const package_primitives__1depth_basis_convolution_PI = 3.141592653589793;

fn package_primitives__1depth_basis_convolution__1convolution_frequency(k: u32) -> f32 {
    return (2.0 * f32(k) - 1.0) * package_primitives__1depth_basis_convolution_PI;
}

fn package_primitives__1depth_basis_convolution__1encode_convolution(z: f32, k: u32) -> vec2f {
    let angle = package_primitives__1depth_basis_convolution__1convolution_frequency(k) * z;
    return vec2f(sin(angle), cos(angle));
}

fn package_primitives__1depth_basis_exponential__1encode_exponential(z: f32, c: f32) -> f32 {
    return exp(c * (z - 1.0));
}

fn package_primitives__1depth_basis_exponential__2encode_exponential_z(z: f32, c: f32) -> vec3f {
    let e = package_primitives__1depth_basis_exponential__1encode_exponential(z, c);
    return vec3f(e, z * e, z);
}

fn package_primitives__1depth_basis__1exponential_variance__1warp_exponential(t: f32, c: vec2f) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(exp(c.x * u), -exp(-c.y * u));
}

fn package_primitives__1depth_basis__1exponential_variance__2encode_exponential_variance(t: f32, c: vec2f) -> vec4f {
    let w = package_primitives__1depth_basis__1exponential_variance__1warp_exponential(t, c);
    return vec4f(w.x, w.x * w.x, w.y, w.y * w.y);
}

fn package_primitives__1depth_basis_moment__1encode_moments(t: f32) -> vec4f {
    let u = 2.0 * t - 1.0;
    let u2 = u * u;
    return vec4f(u, u2, u * u2, u2 * u2);
}

fn package_primitives__1depth_basis_moment__1quantize_moments(m: vec4f) -> vec4f {
    return vec4f(1.5 * m.x - 2.0 * m.z + 0.5, 4.0 * (m.y - m.w), 0.8660254 * m.x - 0.3849002 * m.z + 0.5, 0.5 * (m.y + m.w));
}

fn package_primitives__1depth_basis_variance__1encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

const package_techniques_summed__1depth_range__1FARTHEST_M = 10000000.0;

struct package_techniques_summed__1depth_range_DepthRange {
    near_m: f32,
    far_m: f32
}

fn package_techniques_summed__1depth_range__1depth_range() -> package_techniques_summed__1depth_range_DepthRange {
    var range = package_techniques_summed__1depth_range_DepthRange(package__1light_map_map__1light_view.near_m, min(package__1light_map_map__1light_view.far_m, package_techniques_summed__1depth_range__1FARTHEST_M));
    if package_techniques_summed_uniform_soft.range_from_map == 1u {
        let ends = textureLoad(package__1light_map__1blocker_range__2light_map_pyramid, vec2u(0u), textureNumLevels(package__1light_map__1blocker_range__2light_map_pyramid) - 1u);
        let a = package__1light_map_space__2z_of_depth(package__1light_map_map__1light_view, ends.x);
        let b = package__1light_map_space__2z_of_depth(package__1light_map_map__1light_view, ends.y);
        range = package_techniques_summed__1depth_range_DepthRange(clamp(min(a, b), -package_techniques_summed__1depth_range__1FARTHEST_M, package_techniques_summed__1depth_range__1FARTHEST_M), clamp(max(a, b), -package_techniques_summed__1depth_range__1FARTHEST_M, package_techniques_summed__1depth_range__1FARTHEST_M));
    }
    range.far_m = max(range.far_m, range.near_m + 0.001 * max(abs(range.near_m), 1.0));
    return range;
}

fn package_techniques_summed__1depth_range__2t_of_z(range: package_techniques_summed__1depth_range_DepthRange, z_m: f32) -> f32 {
    return (z_m - range.near_m) / (range.far_m - range.near_m);
}

fn package_techniques_summed__1depth_range__2t_of_depth(range: package_techniques_summed__1depth_range_DepthRange, depth: f32) -> f32 {
    return saturate(package_techniques_summed__1depth_range__2t_of_z(range, package__1light_map_space__2z_of_depth(package__1light_map_map__1light_view, depth)));
}

@id(1)
override package_techniques_summed_encode_PART: u32 = 0u;

fn package_techniques_summed_encode_encode(range: package_techniques_summed__1depth_range_DepthRange, stored: f32) -> vec4f {
    let t = package_techniques_summed__1depth_range__2t_of_depth(range, stored);
    let is_empty = stored == package_techniques_summed_uniform_soft.empty_depth;
    switch package_techniques_summed_uniform_BASIS {
        case package_techniques_summed_uniform__1BASIS_EXPONENTIAL {
            return select(vec4f(package_primitives__1depth_basis_exponential__2encode_exponential_z(t, package_techniques_summed_uniform_soft.exponent), 1.0), vec4f(), is_empty);
        }
        case package_techniques_summed_uniform__2BASIS_EXPONENTIAL_VARIANCE {
            let c = vec2f(package_techniques_summed_uniform_soft.exponent, package_techniques_summed_uniform_soft.negative_exponent);
            let w = package_primitives__1depth_basis__1exponential_variance__2encode_exponential_variance(t, c);
            let scale = exp(-c);
            return vec4f(w.x * scale.x, w.y * scale.x * scale.x, -w.z * scale.y, w.w * scale.y * scale.y);
        }
        case package_techniques_summed_uniform__1BASIS_MOMENT {
            return package_primitives__1depth_basis_moment__1quantize_moments(package_primitives__1depth_basis_moment__1encode_moments(t));
        }
        case package_techniques_summed_uniform__1BASIS_CONVOLUTION {
            if package_techniques_summed_encode_PART == 4u {
                return vec4f(t, 0.0, 0.0, 0.0);
            }
            let k = 1u + 2u * (package_techniques_summed_encode_PART % 2u);
            let terms = vec4f(package_primitives__1depth_basis_convolution__1encode_convolution(t, k), package_primitives__1depth_basis_convolution__1encode_convolution(t, k + 1u));
            return 0.5 + 0.5 * terms * select(1.0, t, package_techniques_summed_encode_PART >= 2u);
        }
        case default {
            return vec4f(package_primitives__1depth_basis_variance__1encode_variance(t), 0.0, 0.0);
        }
    }
}

@group(3) @binding(7)
var package_techniques_summed_source_tiles: texture_storage_2d<rgba32float, write>;

const package_techniques_summed_source__1MOST_TILES = 16u;

var<workgroup> package_techniques_summed_source_least: array<atomic<u32>, 32>;

var<workgroup> package_techniques_summed_source_greatest: array<atomic<u32>, 32>;

var<workgroup> package_techniques_summed_source_samples: array<vec3f, 64>;

var<workgroup> package_techniques_summed_source__1tile_slopes: array<vec2f, 16>;

var<workgroup> package_techniques_summed_source_planes: array<package_techniques_summed__1tile_basis_TilePlane, 16>;

var<private> package_techniques_summed_source__1values_range: package_techniques_summed__1depth_range_DepthRange;

var<private> package_techniques_summed_source__1values_origin: vec2u;

var<private> package_techniques_summed_source__1values_side: u32;

var<private> package_techniques_summed_source__1values_across: u32;

const package_techniques_summed_source__1NO_SAMPLE = vec3f(0.0, 0.0, 1e30);

fn package_techniques_summed_source_ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 2147483648u, ~bits, bits >= 2147483648u);
}

fn package_techniques_summed_source__1of_ordered(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 2147483647u, bits >= 2147483648u));
}

fn package_techniques_summed_source__1sample_at(size: vec2u, texel: vec2u) -> vec3f {
    if any(texel + 1u >= size) {
        return package_techniques_summed_source__1NO_SAMPLE;
    }
    let a = package__1light_map_map__1unwarped_texel(vec2i(texel));
    let b = package__1light_map_map__1unwarped_texel(vec2i(texel) + vec2i(1, 0));
    let c = package__1light_map_map__1unwarped_texel(vec2i(texel) + vec2i(0, 1));
    if a == package_techniques_summed_uniform_soft.empty_depth || b == package_techniques_summed_uniform_soft.empty_depth || c == package_techniques_summed_uniform_soft.empty_depth {
        return package_techniques_summed_source__1NO_SAMPLE;
    }
    let level = package_techniques_summed__1tile_basis_nearness(a);
    return vec3f(package_techniques_summed__1tile_basis_nearness(b) - level, package_techniques_summed__1tile_basis_nearness(c) - level, level);
}

fn package_techniques_summed_source__2tile_of_place(place: u32) -> u32 {
    return (place / 8u * package_techniques_summed_source__1values_across / 8u) * package_techniques_summed_source__1values_across + place % 8u * package_techniques_summed_source__1values_across / 8u;
}

fn package_techniques_summed_source__1find_slopes(t: u32) {
    let own = package_techniques_summed_source_samples[t];
    let tile = package_techniques_summed_source__2tile_of_place(t);
    let middle = 0.5 * (package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_least[2u * tile])) + package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_greatest[2u * tile])));
    var count = 0u;
    var rank = vec2u();
    for (var place = 0u; place < 64u; place++) {
        let other = package_techniques_summed_source_samples[place];
        if package_techniques_summed_source__2tile_of_place(place) == tile && other.z <= middle {
            count++;
            rank += select(vec2u(), vec2u(1u), (other.xy < own.xy) | ((other.xy == own.xy) & vec2<bool>(place < t)));
        }
    }
    if own.z <= middle {
        if rank.x == count / 2u {
            package_techniques_summed_source__1tile_slopes[tile].x = own.x;
        }
        if rank.y == count / 2u {
            package_techniques_summed_source__1tile_slopes[tile].y = own.y;
        }
    }
}

struct package_techniques_summed_source_Bounds {
    low: vec2f,
    high: vec2f
}

const package_techniques_summed_source__1NO_BOUNDS = package_techniques_summed_source_Bounds(vec2f(1e30), vec2f(-1e30));

fn package_techniques_summed_source__1bounds_of(a: package_techniques_summed_source_Bounds, b: package_techniques_summed_source_Bounds) -> package_techniques_summed_source_Bounds {
    return package_techniques_summed_source_Bounds(min(a.low, b.low), max(a.high, b.high));
}

fn package_techniques_summed_source__1bounds_between(ends: vec2f, slope: vec2f, first: vec2f, last: vec2f) -> package_techniques_summed_source_Bounds {
    let a = package_techniques_summed__1tile_basis_nearness(ends.x);
    let b = package_techniques_summed__1tile_basis_nearness(ends.y);
    let near_end = slope * first;
    let far_end = slope * last;
    let least_rise = min(near_end, far_end);
    let greatest_rise = max(near_end, far_end);
    let low = min(a, b);
    let high = max(a, b);
    return package_techniques_summed_source_Bounds(vec2f(low, low - greatest_rise.x - greatest_rise.y), vec2f(high, high - least_rise.x - least_rise.y));
}

fn package_techniques_summed_source__1block_bounds(size: vec2u, first: vec2u, side: u32, level: u32, slope: vec2f) -> package_techniques_summed_source_Bounds {
    let offset = vec2f((first - package_techniques_summed_source__1values_origin) % package_techniques_summed_source__1values_side) + 0.5;
    let ends = textureLoad(package__1light_map__1blocker_range__2light_map_pyramid, first / side, level).xy;
    if ends.x != package_techniques_summed_uniform_soft.empty_depth && ends.y != package_techniques_summed_uniform_soft.empty_depth {
        return package_techniques_summed_source__1bounds_between(ends, slope, offset, offset + f32(side - 1u));
    }
    var bounds = package_techniques_summed_source__1NO_BOUNDS;
    if ends.x == ends.y {
        return bounds;
    }
    for (var i = 0u; i < side * side; i++) {
        let step = vec2u(i % side, i / side);
        if all(first + step < size) {
            let stored = package__1light_map_map__1unwarped_texel(vec2i(first + step));
            if stored != package_techniques_summed_uniform_soft.empty_depth {
                let place = offset + vec2f(step);
                bounds = package_techniques_summed_source__1bounds_of(bounds, package_techniques_summed_source__1bounds_between(vec2f(stored), slope, place, place));
            }
        }
    }
    return bounds;
}

fn package_techniques_summed_source__1note_bounds(tile: u32, bounds: package_techniques_summed_source_Bounds) {
    for (var i = 0u; i < 2u; i++) {
        atomicMin(&package_techniques_summed_source_least[2u * tile + i], package_techniques_summed_source_ordered(bounds.low[i]));
        atomicMax(&package_techniques_summed_source_greatest[2u * tile + i], package_techniques_summed_source_ordered(bounds.high[i]));
    }
}

fn package_techniques_summed_source__1find_bounds(size: vec2u, t: u32, region: u32) {
    let level = min(1u, textureNumLevels(package__1light_map__1blocker_range__2light_map_pyramid) - 1u);
    let side = 2u << level;
    let across = region / side;
    var bounds = package_techniques_summed_source__1NO_BOUNDS;
    var last_tile = 0u;
    for (var block = t; block < across * across; block += 64u) {
        let place = side * vec2u(block % across, block / across);
        let first = package_techniques_summed_source__1values_origin + place;
        if all(first < size) {
            let tile = place.y / package_techniques_summed_source__1values_side * package_techniques_summed_source__1values_across + place.x / package_techniques_summed_source__1values_side;
            if tile != last_tile {
                package_techniques_summed_source__1note_bounds(last_tile, bounds);
                bounds = package_techniques_summed_source__1NO_BOUNDS;
                last_tile = tile;
            }
            bounds = package_techniques_summed_source__1bounds_of(bounds, package_techniques_summed_source__1block_bounds(size, first, side, level, package_techniques_summed_source__1tile_slopes[tile]));
        }
    }
    package_techniques_summed_source__1note_bounds(last_tile, bounds);
}

fn package_techniques_summed_source__1begin_values(size: vec2u, origin: vec2u, region: u32, side: u32, t: u32) {
    if package_techniques_summed_uniform_BASIS != package_techniques_summed_uniform__1BASIS_TILES {
        package_techniques_summed_source__1values_range = package_techniques_summed__1depth_range__1depth_range();
        return;
    }
    package_techniques_summed_source__1values_origin = origin;
    package_techniques_summed_source__1values_side = side;
    package_techniques_summed_source__1values_across = region / side;
    if t < 2u * package_techniques_summed_source__1MOST_TILES {
        atomicStore(&package_techniques_summed_source_least[t], 4294967295u);
        atomicStore(&package_techniques_summed_source_greatest[t], 0u);
    }
    if t < package_techniques_summed_source__1MOST_TILES {
        package_techniques_summed_source__1tile_slopes[t] = vec2f();
    }
    workgroupBarrier();
    let sample = package_techniques_summed_source__1sample_at(size, origin + (2u * vec2u(t % 8u, t / 8u) + 1u) * region / 16u);
    package_techniques_summed_source_samples[t] = sample;
    if sample.z < package_techniques_summed_source__1NO_SAMPLE.z {
        atomicMin(&package_techniques_summed_source_least[2u * package_techniques_summed_source__2tile_of_place(t)], package_techniques_summed_source_ordered(sample.z));
        atomicMax(&package_techniques_summed_source_greatest[2u * package_techniques_summed_source__2tile_of_place(t)], package_techniques_summed_source_ordered(sample.z));
    }
    workgroupBarrier();
    package_techniques_summed_source__1find_slopes(t);
    workgroupBarrier();
    package_techniques_summed_source__1find_bounds(size, t, region);
    workgroupBarrier();
    if t < package_techniques_summed_source__1values_across * package_techniques_summed_source__1values_across {
        let low = vec2f(package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_least[2u * t])), package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_least[2u * t + 1u])));
        let high = vec2f(package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_greatest[2u * t])), package_techniques_summed_source__1of_ordered(atomicLoad(&package_techniques_summed_source_greatest[2u * t + 1u])));
        var plane = package_techniques_summed__1tile_basis__1EMPTY_TILE;
        if low.x <= high.x {
            plane = package_techniques_summed__1tile_basis__1tile_plane(vec2f(), low.x, high.x, side);
            let tilted = package_techniques_summed__1tile_basis__1tile_plane(package_techniques_summed_source__1tile_slopes[t], low.y, high.y, side);
            if tilted.w <= 2.0 * plane.w {
                plane = tilted;
            }
        }
        package_techniques_summed_source_planes[t] = plane;
        let tile = origin / side + vec2u(t % package_techniques_summed_source__1values_across, t / package_techniques_summed_source__1values_across);
        if all(tile * side < size) {
            textureStore(package_techniques_summed_source_tiles, tile, plane);
        }
    }
    workgroupBarrier();
}

fn package_techniques_summed_source__1value_at(texel: vec2u) -> vec4u {
    let stored = package__1light_map_map__1unwarped_texel(vec2i(texel));
    var value: vec4f;
    if package_techniques_summed_uniform_BASIS == package_techniques_summed_uniform__1BASIS_TILES {
        let offset = texel - package_techniques_summed_source__1values_origin;
        let tile = offset / package_techniques_summed_source__1values_side;
        let plane = package_techniques_summed_source_planes[tile.y * package_techniques_summed_source__1values_across + tile.x];
        value = package_techniques_summed__1tile_basis__2encode_in_tile(stored, plane, vec2f(offset - tile * package_techniques_summed_source__1values_side) + 0.5);
    }
    else {
        value = package_techniques_summed_encode_encode(package_techniques_summed_source__1values_range, stored);
    }
    return vec4u(round(saturate(value) * package_techniques_summed_uniform_soft.value_scale));
}

alias package_techniques_summed__1tile_basis_TilePlane = vec4f;

const package_techniques_summed__1tile_basis__1EMPTY_TILE = package_techniques_summed__1tile_basis_TilePlane(0.0, 0.0, 0.0, -1.0);

fn package_techniques_summed__1tile_basis_nearness(depth: f32) -> f32 {
    let scaled = (depth - package__1light_map_map__1light_view.depth_offset) / package__1light_map_map__1light_view.depth_scale;
    return select(-scaled, max(scaled, 1e-7), package__1light_map_map__1light_view.perspective == 1u);
}

fn package_techniques_summed__1tile_basis__1plane_nearness(tile: package_techniques_summed__1tile_basis_TilePlane, offset: vec2f) -> f32 {
    return tile.x + dot(tile.yz, offset);
}

fn package_techniques_summed__1tile_basis__1tile_plane(slope: vec2f, least: f32, greatest: f32, side: u32) -> package_techniques_summed__1tile_basis_TilePlane {
    let farthest = least + f32(side) * (min(slope.x, 0.0) + min(slope.y, 0.0));
    if package__1light_map_map__1light_view.perspective == 1u {
        let span = select(1000000000.0, package_techniques_summed_uniform_soft.exponent * log(1.0 + (greatest - least) / farthest), farthest > 0.1 * least);
        return package_techniques_summed__1tile_basis_TilePlane(least, slope, span);
    }
    return package_techniques_summed__1tile_basis_TilePlane(least, slope, package_techniques_summed_uniform_soft.exponent * (greatest - least));
}

fn package_techniques_summed__1tile_basis__2encode_in_tile(stored: f32, tile: package_techniques_summed__1tile_basis_TilePlane, offset: vec2f) -> vec4f {
    if stored == package_techniques_summed_uniform_soft.empty_depth {
        return vec4f();
    }
    let own = package_techniques_summed__1tile_basis_nearness(stored);
    let plane = package_techniques_summed__1tile_basis__1plane_nearness(tile, offset);
    let n = package_techniques_summed_uniform_soft.exponent * select(own - plane, log(own / plane), package__1light_map_map__1light_view.perspective == 1u);
    let e = exp(-n);
    return vec4f(e, n * e, n / max(tile.w, 1e-20), 1.0);
}

@id(0)
override package_techniques_summed_uniform_BASIS: u32 = 0u;

const package_techniques_summed_uniform__1BASIS_TILES = 0u;

const package_techniques_summed_uniform__1BASIS_EXPONENTIAL = 1u;

const package_techniques_summed_uniform__2BASIS_EXPONENTIAL_VARIANCE = 3u;

const package_techniques_summed_uniform__1BASIS_MOMENT = 4u;

const package_techniques_summed_uniform__1BASIS_CONVOLUTION = 5u;

struct package_techniques_summed_uniform_SoftUniform {
    light_extent: vec2f,
    light_extent_axis: f32,
    bias_scale: f32,
    light_covariance: vec3f,
    exponent: f32,
    light_mean: vec2f,
    negative_exponent: f32,
    value_scale: f32,
    tile_log2: u32,
    range_from_map: u32,
    empty_depth: f32,
    non_planar: f32,
    subdivisions: u32,
    search_scales: u32,
    search_taps: u32,
    row_height: f32,
    is_ellipse: u32,
    with_footprint: u32,
    direct_texels: f32,
    max_part_texels: f32,
    bleeding_reduction: f32,
    may_read_map: u32,
    padding_0: f32,
    padding_1: f32
}

@group(2) @binding(0)
var<uniform> package_techniques_summed_uniform_soft: package_techniques_summed_uniform_SoftUniform;
