// Linked from src/techniques/summed/summed_area_table/table.wesl with encoded by `cargo xtask shaders`: edit that, not this.

alias Sum = vec4u;

struct TableUniform {
    size: vec2u,
    tile: u32,
    padding: u32
}

@group(3) @binding(1)
var table: texture_storage_2d<rgba32uint, write>;

@group(3) @binding(2)
var<uniform> shape: TableUniform;

@group(3) @binding(3)
var<storage, read_write> above: array<Sum>;

@group(3) @binding(4)
var<storage, read_write> before: array<Sum>;

@group(3) @binding(5)
var<storage, read_write> corner: array<Sum>;

@group(3) @binding(6)
var<storage, read_write> largest: array<atomic<u32>>;

const BLOCK = 16u;

const RUN = 4u;

const PANEL = 64u;

const STRIP = 8u;

const SEGMENT = 8u;

const BATCH = 8u;

const MAX_TILE = 256u;

fn blocks() -> vec2u {
    return (shape.size + BLOCK - 1u) / BLOCK;
}

fn tile_side() -> u32 {
    if shape.tile > 0u {
        return shape.tile;
    }
    var log2 = 0u;
    for (; log2 + 1u < arrayLength(&largest); log2++) {
        if overflow_overflows(atomicLoad(&largest[log2 + 1u])) {
            break;
        }
    }
    return BLOCK << log2;
}

fn source_at(texel: vec2u) -> Sum {
    if any(texel >= shape.size) {
        return Sum(0);
    }
    return source_value_at(texel);
}

fn begin(origin: vec2u, region: u32, side: u32, t: u32) {
    source_begin_values(shape.size, origin, region, side, t);
}

var<workgroup> runs: array<array<Sum, 4>, 16>;

var<workgroup> rows: array<array<Sum, 16>, 16>;

fn block_sums(origin: vec2u, t: u32) -> array<Sum, 4> {
    let row = t / RUN;
    let run = t % RUN;
    var a: array<Sum, 4>;
    a[0] = source_at(origin + vec2u(RUN * run, row));
    for (var i = 1u; i < RUN; i++) {
        a[i] = a[i - 1u] + source_at(origin + vec2u(RUN * run + i, row));
    }
    runs[row][run] = a[3];
    workgroupBarrier();
    var left = Sum(0);
    for (var i = 0u; i < run; i++) {
        left += runs[row][i];
    }
    for (var i = 0u; i < RUN; i++) {
        rows[row][RUN * run + i] = left + a[i];
    }
    workgroupBarrier();
    let column = t % BLOCK;
    let part = t / BLOCK;
    a[0] = rows[RUN * part][column];
    for (var i = 1u; i < RUN; i++) {
        a[i] = a[i - 1u] + rows[RUN * part + i][column];
    }
    runs[column][part] = a[3];
    workgroupBarrier();
    var top = Sum(0);
    for (var i = 0u; i < part; i++) {
        top += runs[column][i];
    }
    for (var i = 0u; i < RUN; i++) {
        a[i] += top;
    }
    return a;
}

@compute @workgroup_size(64)
fn sum_blocks(@builtin(workgroup_id) block: vec3u, @builtin(local_invocation_index) t: u32) {
    let origin = block.xy * BLOCK;
    begin(origin, BLOCK, 0u, t);
    let sums = block_sums(origin, t);
    let column = t % BLOCK;
    let part = t / BLOCK;
    let padded = blocks() * BLOCK;
    if part == RUN - 1u {
        above[block.y * padded.x + origin.x + column] = sums[3];
    }
    if column == BLOCK - 1u {
        for (var i = 0u; i < RUN; i++) {
            before[block.x * padded.y + origin.y + RUN * part + i] = sums[i];
        }
    }
}

@compute @workgroup_size(64)
fn carry(@builtin(global_invocation_id) id: vec3u) {
    let count = blocks();
    let padded = count * BLOCK;
    var sum = Sum(0);
    if id.x < padded.x {
        for (var first = 0u; first < count.y; first += BATCH) {
            var own: array<Sum, BATCH>;
            for (var i = 0u; i < BATCH; i++) {
                own[i] = above[min(first + i, count.y - 1u) * padded.x + id.x];
            }
            for (var i = 0u; i < BATCH; i++) {
                if first + i < count.y {
                    above[(first + i) * padded.x + id.x] = sum;
                    sum += own[i];
                }
            }
        }
    }
    else if id.x < padded.x + padded.y {
        let y = id.x - padded.x;
        for (var first = 0u; first < count.x; first += BATCH) {
            var own: array<Sum, BATCH>;
            for (var i = 0u; i < BATCH; i++) {
                own[i] = before[min(first + i, count.x - 1u) * padded.y + y];
            }
            for (var i = 0u; i < BATCH; i++) {
                if first + i < count.x {
                    before[(first + i) * padded.y + y] = sum;
                    sum += own[i];
                }
            }
        }
    }
}

@compute @workgroup_size(64)
fn carry_corners(@builtin(global_invocation_id) id: vec3u) {
    let count = blocks();
    if id.x >= count.y {
        return;
    }
    var sum = Sum(0);
    for (var first = 0u; first < count.x; first += BATCH) {
        var own: array<Sum, BATCH>;
        for (var i = 0u; i < BATCH; i++) {
            own[i] = above[(id.x * count.x + min(first + i, count.x - 1u)) * BLOCK + BLOCK - 1u];
        }
        for (var i = 0u; i < BATCH; i++) {
            if first + i < count.x {
                corner[id.x * count.x + first + i] = sum;
                sum += own[i];
            }
        }
    }
}

@compute @workgroup_size(64)
fn finish(@builtin(workgroup_id) block: vec3u, @builtin(local_invocation_index) t: u32) {
    let origin = block.xy * BLOCK;
    begin(origin, BLOCK, 0u, t);
    let sums = block_sums(origin, t);
    let column = t % BLOCK;
    let part = t / BLOCK;
    let padded = blocks() * BLOCK;
    let from_others = above[block.y * padded.x + origin.x + column] + corner[block.y * blocks().x + block.x];
    for (var i = 0u; i < RUN; i++) {
        let texel = origin + vec2u(column, RUN * part + i);
        if all(texel < shape.size) {
            textureStore(table, texel, sums[i] + from_others + before[block.x * padded.y + texel.y]);
        }
    }
}

var<workgroup> column_totals: array<Sum, 64>;

@compute @workgroup_size(64)
fn total_blocks(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) t: u32) {
    let origin = group.xy * vec2u(PANEL, BLOCK);
    begin(origin, PANEL, 0u, t);
    var total = Sum(0);
    for (var y = 0u; y < BLOCK; y++) {
        total += source_at(origin + vec2u(t, y));
    }
    column_totals[t] = total;
    workgroupBarrier();
    let block = vec2u(origin.x / BLOCK + t / BLOCK, group.y);
    if t % BLOCK == 0u && block.x < blocks().x {
        for (var i = 1u; i < BLOCK; i++) {
            total += column_totals[t + i];
        }
        corner[block.y * blocks().x + block.x] = total;
    }
}

fn chunk_side(count: vec2u) -> u32 {
    let most = max(count.x, count.y);
    var side = 1u;
    for (; 16u * side < most; side *= 2u) {
    
    }
    return side;
}

fn square_sum(first: vec2u, side: u32, count: vec2u) -> vec4f {
    var sum = vec4f();
    let end = min(first + side, count);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            sum += vec4f(corner[y * count.x + x]);
        }
    }
    return sum;
}

fn largest_channel(sum: vec4f) -> f32 {
    return max(max(sum.x, sum.y), max(sum.z, sum.w));
}

var<workgroup> chunks: array<vec4f, 256>;

@compute @workgroup_size(256)
fn choose_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) t: u32) {
    let count = blocks();
    let level = group.x;
    let side = 1u << level;
    let chunk = chunk_side(count);
    let place = vec2u(t % 16u, t / 16u);
    var most = 0.0;
    var sum = vec4f();
    if side < chunk {
        for (var y = 0u; y < chunk; y += side) {
            for (var x = 0u; x < chunk; x += side) {
                most = max(most, largest_channel(square_sum(place * chunk + vec2u(x, y), side, count)));
            }
        }
    }
    else {
        sum = square_sum(place * chunk, chunk, count);
    }
    chunks[t] = sum;
    workgroupBarrier();
    if side >= chunk {
        let span = min(side / chunk, 16u);
        if all(place % span == vec2u(0u)) {
            sum = vec4f();
            for (var y = 0u; y < span; y++) {
                for (var x = 0u; x < span; x++) {
                    sum += chunks[t + 16u * y + x];
                }
            }
            most = largest_channel(sum);
        }
    }
    atomicMax(&largest[level], bitcast<u32>(most));
}

var<workgroup> strip: array<array<Sum, 72>, 8>;

var<workgroup> segment_ends: array<array<Sum, 8>, 8>;

var<workgroup> panels_before: array<Sum, MAX_TILE>;

var<workgroup> shared_side: u32;

@compute @workgroup_size(64)
fn sum_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) t: u32) {
    if t == 0u {
        shared_side = tile_side();
    }
    let side = workgroupUniformLoad(&shared_side);
    let region = max(side, PANEL);
    let origin = group.xy * region;
    if any(origin >= shape.size) {
        return;
    }
    begin(origin, region, side, t);
    let end = min(vec2u(region), shape.size - origin);
    let row = t / SEGMENT;
    let segment = t % SEGMENT;
    let first_segment = ((segment * SEGMENT) & ~(side - 1u)) / SEGMENT;
    for (var panel = 0u; panel < end.x; panel += PANEL) {
        var down = Sum(0);
        for (var y = 0u; y < end.y; y += STRIP) {
            if (y & (side - 1u)) == 0u {
                down = Sum(0);
            }
            for (var i = 0u; i < STRIP; i++) {
                down += source_at(origin + vec2u(panel + t, y + i));
                strip[i][t + t / SEGMENT] = down;
            }
            workgroupBarrier();
            var along: array<Sum, 8>;
            var sum = Sum(0);
            if segment == 0u && panel > 0u {
                sum = panels_before[y + row];
            }
            for (var i = 0u; i < SEGMENT; i++) {
                sum += strip[row][(SEGMENT + 1u) * segment + i];
                along[i] = sum;
            }
            segment_ends[row][segment] = sum;
            workgroupBarrier();
            var left = Sum(0);
            for (var i = first_segment; i < segment; i++) {
                left += segment_ends[row][i];
            }
            if segment == SEGMENT - 1u && side > PANEL {
                panels_before[y + row] = sum + left;
            }
            for (var i = 0u; i < SEGMENT; i++) {
                let texel = origin + vec2u(panel + SEGMENT * segment + i, y + row);
                if all(texel < shape.size) {
                    textureStore(table, texel, along[i] + left);
                }
            }
        }
    }
}

@group(1) @binding(3)
var blocker_range_light_map_pyramid: texture_2d<f32>;

@group(1) @binding(0)
var<uniform> map_light_view: space_LightViewGpu;

@group(1) @binding(1)
var map_light_map: texture_depth_2d;

fn map_uv_of_texel(texel: vec2i) -> vec2f {
    return (vec2f(texel) + 0.5) / map_light_view.map_size;
}

fn map_unwarped_texel(texel: vec2i) -> f32 {
    return space_unwarped_depth(map_light_view, textureLoad(map_light_map, texel, 0), map_uv_of_texel(texel));
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

fn space_z_of_depth(view: space_LightViewGpu, depth: f32) -> f32 {
    let scaled = depth - view.depth_offset;
    let divisor = select(scaled, 1e-20 * view.depth_scale, scaled == 0.0);
    return select(scaled / view.depth_scale, view.depth_scale / divisor, view.perspective == 1u);
}

const convolution_PI = 3.141592653589793;

fn convolution_convolution_frequency(k: u32) -> f32 {
    return (2.0 * f32(k) - 1.0) * convolution_PI;
}

fn convolution_encode_convolution(z: f32, k: u32) -> vec2f {
    let angle = convolution_convolution_frequency(k) * z;
    return vec2f(sin(angle), cos(angle));
}

fn exponential_encode_exponential(z: f32, c: f32) -> f32 {
    return exp(c * (z - 1.0));
}

fn exponential_encode_exponential_z(z: f32, c: f32) -> vec3f {
    let e = exponential_encode_exponential(z, c);
    return vec3f(e, z * e, z);
}

fn exponential_variance_warp_exponential(t: f32, c: vec2f) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(exp(c.x * u), -exp(-c.y * u));
}

fn exponential_variance_encode_exponential_variance(t: f32, c: vec2f) -> vec4f {
    let w = exponential_variance_warp_exponential(t, c);
    return vec4f(w.x, w.x * w.x, w.y, w.y * w.y);
}

fn moment_encode_moments(t: f32) -> vec4f {
    let u = 2.0 * t - 1.0;
    let u2 = u * u;
    return vec4f(u, u2, u * u2, u2 * u2);
}

fn moment_quantize_moments(m: vec4f) -> vec4f {
    return vec4f(1.5 * m.x - 2.0 * m.z + 0.5, 4.0 * (m.y - m.w), 0.8660254 * m.x - 0.3849002 * m.z + 0.5, 0.5 * (m.y + m.w));
}

fn variance_encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

const depth_range_FARTHEST_M = 10000000.0;

struct depth_range_DepthRange {
    near_m: f32,
    far_m: f32
}

fn depth_range_depth_range() -> depth_range_DepthRange {
    let view_far_m = min(map_light_view.far_m, depth_range_FARTHEST_M);
    var range = depth_range_DepthRange(map_light_view.near_m, view_far_m);
    if uniform_soft.range_from_map == 1u {
        let ends = textureLoad(blocker_range_light_map_pyramid, vec2u(0u), textureNumLevels(blocker_range_light_map_pyramid) - 1u);
        let a = space_z_of_depth(map_light_view, ends.x);
        let b = space_z_of_depth(map_light_view, ends.y);
        let farthest_m = view_far_m + 0.001 * (view_far_m - map_light_view.near_m);
        range = depth_range_DepthRange(clamp(min(a, b), -depth_range_FARTHEST_M, farthest_m), clamp(max(a, b), -depth_range_FARTHEST_M, farthest_m));
    }
    range.far_m = max(range.far_m, range.near_m + 0.001 * max(abs(range.near_m), 1.0));
    return range;
}

fn depth_range_t_of_z(range: depth_range_DepthRange, z_m: f32) -> f32 {
    return (z_m - range.near_m) / (range.far_m - range.near_m);
}

fn depth_range_t_of_depth(range: depth_range_DepthRange, depth: f32) -> f32 {
    return saturate(depth_range_t_of_z(range, space_z_of_depth(map_light_view, depth)));
}

override encode_PART: u32 = 0u;

fn encode_encode(range: depth_range_DepthRange, stored: f32) -> vec4f {
    let t = depth_range_t_of_depth(range, stored);
    let is_empty = stored == uniform_soft.empty_depth;
    switch uniform_BASIS {
        case uniform_BASIS_EXPONENTIAL {
            return select(vec4f(exponential_encode_exponential_z(t, uniform_soft.exponent), 1.0), vec4f(), is_empty);
        }
        case uniform_BASIS_EXPONENTIAL_VARIANCE {
            let c = vec2f(uniform_soft.exponent, uniform_soft.negative_exponent);
            let w = exponential_variance_encode_exponential_variance(t, c);
            let scale = exp(-c);
            return vec4f(w.x * scale.x, w.y * scale.x * scale.x, -w.z * scale.y, w.w * scale.y * scale.y);
        }
        case uniform_BASIS_MOMENT {
            return moment_quantize_moments(moment_encode_moments(t));
        }
        case uniform_BASIS_CONVOLUTION {
            if encode_PART == 4u {
                return vec4f(t, 0.0, 0.0, 0.0);
            }
            let k = 1u + 2u * (encode_PART % 2u);
            let terms = vec4f(convolution_encode_convolution(t, k), convolution_encode_convolution(t, k + 1u));
            return 0.5 + 0.5 * terms * select(1.0, t, encode_PART >= 2u);
        }
        case default {
            return vec4f(variance_encode_variance(t), 0.0, 0.0);
        }
    }
}

@group(3) @binding(7)
var source_tiles: texture_storage_2d<rgba32float, write>;

const source_MAX_TILES = 16u;

var<workgroup> source_least: array<atomic<u32>, 32>;

var<workgroup> source_greatest: array<atomic<u32>, 32>;

var<workgroup> source_samples: array<vec3f, 64>;

var<workgroup> source_tile_slopes: array<vec2f, 16>;

var<workgroup> source_planes: array<tile_basis_TilePlane, 16>;

var<private> source_values_range: depth_range_DepthRange;

var<private> source_values_origin: vec2u;

var<private> source_values_side: u32;

var<private> source_values_across: u32;

const source_NO_SAMPLE = vec3f(0.0, 0.0, 1e30);

fn source_ordered(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 2147483648u, ~bits, bits >= 2147483648u);
}

fn source_of_ordered(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 2147483647u, bits >= 2147483648u));
}

fn source_sample_at(size: vec2u, texel: vec2u) -> vec3f {
    if any(texel + 1u >= size) {
        return source_NO_SAMPLE;
    }
    let a = map_unwarped_texel(vec2i(texel));
    let b = map_unwarped_texel(vec2i(texel) + vec2i(1, 0));
    let c = map_unwarped_texel(vec2i(texel) + vec2i(0, 1));
    if a == uniform_soft.empty_depth || b == uniform_soft.empty_depth || c == uniform_soft.empty_depth {
        return source_NO_SAMPLE;
    }
    let level = tile_basis_nearness(a);
    return vec3f(tile_basis_nearness(b) - level, tile_basis_nearness(c) - level, level);
}

fn source_tile_of_place(place: u32) -> u32 {
    return (place / 8u * source_values_across / 8u) * source_values_across + place % 8u * source_values_across / 8u;
}

fn source_find_slopes(t: u32) {
    let own = source_samples[t];
    let tile = source_tile_of_place(t);
    let middle = 0.5 * (source_of_ordered(atomicLoad(&source_least[2u * tile])) + source_of_ordered(atomicLoad(&source_greatest[2u * tile])));
    var count = 0u;
    var rank = vec2u();
    for (var place = 0u; place < 64u; place++) {
        let other = source_samples[place];
        if source_tile_of_place(place) == tile && other.z <= middle {
            count++;
            rank += select(vec2u(), vec2u(1u), (other.xy < own.xy) | ((other.xy == own.xy) & vec2<bool>(place < t)));
        }
    }
    if own.z <= middle {
        if rank.x == count / 2u {
            source_tile_slopes[tile].x = own.x;
        }
        if rank.y == count / 2u {
            source_tile_slopes[tile].y = own.y;
        }
    }
}

struct source_Bounds {
    low: vec2f,
    high: vec2f
}

const source_NO_BOUNDS = source_Bounds(vec2f(1e30), vec2f(-1e30));

fn source_bounds_of(a: source_Bounds, b: source_Bounds) -> source_Bounds {
    return source_Bounds(min(a.low, b.low), max(a.high, b.high));
}

fn source_bounds_between(ends: vec2f, slope: vec2f, first: vec2f, last: vec2f) -> source_Bounds {
    let a = tile_basis_nearness(ends.x);
    let b = tile_basis_nearness(ends.y);
    let near_end = slope * first;
    let far_end = slope * last;
    let min_rise = min(near_end, far_end);
    let greatest_rise = max(near_end, far_end);
    let low = min(a, b);
    let high = max(a, b);
    return source_Bounds(vec2f(low, low - greatest_rise.x - greatest_rise.y), vec2f(high, high - min_rise.x - min_rise.y));
}

fn source_block_bounds(size: vec2u, first: vec2u, side: u32, level: u32, slope: vec2f) -> source_Bounds {
    let offset = vec2f((first - source_values_origin) % source_values_side) + 0.5;
    let ends = textureLoad(blocker_range_light_map_pyramid, first / side, level).xy;
    if ends.x != uniform_soft.empty_depth && ends.y != uniform_soft.empty_depth {
        return source_bounds_between(ends, slope, offset, offset + f32(side - 1u));
    }
    var bounds = source_NO_BOUNDS;
    if ends.x == ends.y {
        return bounds;
    }
    for (var i = 0u; i < side * side; i++) {
        let step = vec2u(i % side, i / side);
        if all(first + step < size) {
            let stored = map_unwarped_texel(vec2i(first + step));
            if stored != uniform_soft.empty_depth {
                let place = offset + vec2f(step);
                bounds = source_bounds_of(bounds, source_bounds_between(vec2f(stored), slope, place, place));
            }
        }
    }
    return bounds;
}

fn source_note_bounds(tile: u32, bounds: source_Bounds) {
    for (var i = 0u; i < 2u; i++) {
        atomicMin(&source_least[2u * tile + i], source_ordered(bounds.low[i]));
        atomicMax(&source_greatest[2u * tile + i], source_ordered(bounds.high[i]));
    }
}

fn source_find_bounds(size: vec2u, t: u32, region: u32) {
    let level = min(1u, textureNumLevels(blocker_range_light_map_pyramid) - 1u);
    let side = 2u << level;
    let across = region / side;
    var bounds = source_NO_BOUNDS;
    var last_tile = 0u;
    for (var block = t; block < across * across; block += 64u) {
        let place = side * vec2u(block % across, block / across);
        let first = source_values_origin + place;
        if all(first < size) {
            let tile = place.y / source_values_side * source_values_across + place.x / source_values_side;
            if tile != last_tile {
                source_note_bounds(last_tile, bounds);
                bounds = source_NO_BOUNDS;
                last_tile = tile;
            }
            bounds = source_bounds_of(bounds, source_block_bounds(size, first, side, level, source_tile_slopes[tile]));
        }
    }
    source_note_bounds(last_tile, bounds);
}

fn source_begin_values(size: vec2u, origin: vec2u, region: u32, side: u32, t: u32) {
    if uniform_BASIS != uniform_BASIS_TILES {
        source_values_range = depth_range_depth_range();
        return;
    }
    source_values_origin = origin;
    source_values_side = side;
    source_values_across = region / side;
    if t < 2u * source_MAX_TILES {
        atomicStore(&source_least[t], 4294967295u);
        atomicStore(&source_greatest[t], 0u);
    }
    if t < source_MAX_TILES {
        source_tile_slopes[t] = vec2f();
    }
    workgroupBarrier();
    let sample = source_sample_at(size, origin + (2u * vec2u(t % 8u, t / 8u) + 1u) * region / 16u);
    source_samples[t] = sample;
    if sample.z < source_NO_SAMPLE.z {
        atomicMin(&source_least[2u * source_tile_of_place(t)], source_ordered(sample.z));
        atomicMax(&source_greatest[2u * source_tile_of_place(t)], source_ordered(sample.z));
    }
    workgroupBarrier();
    source_find_slopes(t);
    workgroupBarrier();
    source_find_bounds(size, t, region);
    workgroupBarrier();
    if t < source_values_across * source_values_across {
        let low = vec2f(source_of_ordered(atomicLoad(&source_least[2u * t])), source_of_ordered(atomicLoad(&source_least[2u * t + 1u])));
        let high = vec2f(source_of_ordered(atomicLoad(&source_greatest[2u * t])), source_of_ordered(atomicLoad(&source_greatest[2u * t + 1u])));
        var plane = tile_basis_EMPTY_TILE;
        if low.x <= high.x {
            plane = tile_basis_tile_plane(vec2f(), low.x, high.x, side);
            let tilted = tile_basis_tile_plane(source_tile_slopes[t], low.y, high.y, side);
            if tilted.w <= 2.0 * plane.w {
                plane = tilted;
            }
        }
        source_planes[t] = plane;
        let tile = origin / side + vec2u(t % source_values_across, t / source_values_across);
        if all(tile * side < size) {
            textureStore(source_tiles, tile, plane);
        }
    }
    workgroupBarrier();
}

fn source_value_at(texel: vec2u) -> vec4u {
    let stored = map_unwarped_texel(vec2i(texel));
    var value: vec4f;
    if uniform_BASIS == uniform_BASIS_TILES {
        let offset = texel - source_values_origin;
        let tile = offset / source_values_side;
        let plane = source_planes[tile.y * source_values_across + tile.x];
        value = tile_basis_encode_in_tile(stored, plane, vec2f(offset - tile * source_values_side) + 0.5);
    }
    else {
        value = encode_encode(source_values_range, stored);
    }
    return vec4u(round(saturate(value) * uniform_soft.value_scale));
}

const overflow_BITS_OF_TWO_TO_32 = 1333788672u;

fn overflow_overflows(largest_sum: u32) -> bool {
    return largest_sum >= overflow_BITS_OF_TWO_TO_32;
}

alias tile_basis_TilePlane = vec4f;

const tile_basis_EMPTY_TILE = tile_basis_TilePlane(0.0, 0.0, 0.0, -1.0);

fn tile_basis_nearness(depth: f32) -> f32 {
    let scaled = (depth - map_light_view.depth_offset) / map_light_view.depth_scale;
    return select(-scaled, max(scaled, 1e-7), map_light_view.perspective == 1u);
}

fn tile_basis_plane_nearness(tile: tile_basis_TilePlane, offset: vec2f) -> f32 {
    return tile.x + dot(tile.yz, offset);
}

fn tile_basis_tile_plane(slope: vec2f, least: f32, greatest: f32, side: u32) -> tile_basis_TilePlane {
    let farthest = least + f32(side) * (min(slope.x, 0.0) + min(slope.y, 0.0));
    if map_light_view.perspective == 1u {
        let span = select(1000000000.0, uniform_soft.exponent * log(1.0 + (greatest - least) / farthest), farthest > 0.1 * least);
        return tile_basis_TilePlane(least, slope, span);
    }
    return tile_basis_TilePlane(least, slope, uniform_soft.exponent * (greatest - least));
}

fn tile_basis_encode_in_tile(stored: f32, tile: tile_basis_TilePlane, offset: vec2f) -> vec4f {
    if stored == uniform_soft.empty_depth {
        return vec4f();
    }
    let own = tile_basis_nearness(stored);
    let plane = tile_basis_plane_nearness(tile, offset);
    let n = uniform_soft.exponent * select(own - plane, log(own / plane), map_light_view.perspective == 1u);
    let e = exp(-n);
    return vec4f(e, n * e, n / max(tile.w, 1e-20), 1.0);
}

override uniform_BASIS: u32 = 0u;

const uniform_BASIS_TILES = 0u;

const uniform_BASIS_EXPONENTIAL = 1u;

const uniform_BASIS_EXPONENTIAL_VARIANCE = 3u;

const uniform_BASIS_MOMENT = 4u;

const uniform_BASIS_CONVOLUTION = 5u;

struct uniform_SoftUniform {
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
var<uniform> uniform_soft: uniform_SoftUniform;
