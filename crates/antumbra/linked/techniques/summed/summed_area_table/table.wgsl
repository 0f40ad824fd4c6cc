// Linked from src/techniques/summed/summed_area_table/table.wesl by `cargo xtask shaders`: edit that, not this.

alias Sum = vec4u;

struct TableUniform {
    size: vec2u,
    tile: u32,
    padding: u32
}

@group(0) @binding(0)
var source: texture_2d<u32>;

@group(0) @binding(1)
var table: texture_storage_2d<rgba32uint, write>;

@group(0) @binding(2)
var<uniform> shape: TableUniform;

@group(0) @binding(3)
var<storage, read_write> above: array<Sum>;

@group(0) @binding(4)
var<storage, read_write> before: array<Sum>;

@group(0) @binding(5)
var<storage, read_write> corner: array<Sum>;

@group(0) @binding(6)
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
    return textureLoad(source, texel, 0);
}

fn begin(origin: vec2u, region: u32, side: u32, t: u32) {

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

const overflow_BITS_OF_TWO_TO_32 = 1333788672u;

fn overflow_overflows(largest_sum: u32) -> bool {
    return largest_sum >= overflow_BITS_OF_TWO_TO_32;
}
