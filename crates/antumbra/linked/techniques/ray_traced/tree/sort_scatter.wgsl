// Linked from src/techniques/ray_traced/tree/sort_scatter.wesl by `cargo xtask shaders`: edit that, not this.

const THREADS = 128u;

const ITEMS_PER_THREAD = shape_BLOCK_ITEMS / THREADS;

var<workgroup> tally: array<u32, sort_DIGITS * THREADS>;

var<workgroup> thread_sums: array<u32, THREADS>;

var<workgroup> digit_firsts: array<u32, sort_DIGITS>;

@compute @workgroup_size(128)
fn scatter(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) thread: u32) {
    let index = group.y * groups.x + group.x;
    let block = sort_block_at(min(index, shape_shape.block_count - 1u));
    let end = select(block.first, block.end, index < shape_shape.block_count);
    let first = block.first + thread * ITEMS_PER_THREAD;
    for (var digit = 0u; digit < sort_DIGITS; digit++) {
        tally[digit * THREADS + thread] = 0u;
    }
    for (var k = 0u; k < ITEMS_PER_THREAD; k++) {
        if first + k < end {
            tally[sort_digit_of(sort_keys_in[first + k]) * THREADS + thread] += 1u;
        }
    }
    workgroupBarrier();
    var sum = 0u;
    for (var k = 0u; k < sort_DIGITS; k++) {
        let count = tally[thread * sort_DIGITS + k];
        tally[thread * sort_DIGITS + k] = sum;
        sum += count;
    }
    thread_sums[thread] = sum;
    workgroupBarrier();
    for (var reach = 1u; reach < THREADS; reach *= 2u) {
        var below = 0u;
        if thread >= reach {
            below = thread_sums[thread - reach];
        }
        workgroupBarrier();
        thread_sums[thread] += below;
        workgroupBarrier();
    }
    let before = thread_sums[thread] - sum;
    for (var k = 0u; k < sort_DIGITS; k++) {
        tally[thread * sort_DIGITS + k] += before;
    }
    workgroupBarrier();
    if thread < sort_DIGITS {
        digit_firsts[thread] = tally[thread * THREADS];
    }
    workgroupBarrier();
    for (var k = 0u; k < ITEMS_PER_THREAD; k++) {
        if first + k < end {
            let key = sort_keys_in[first + k];
            let digit = sort_digit_of(key);
            let entry = digit * THREADS + thread;
            let place = sort_counts[block.first_count + digit * block.count_stride] + tally[entry] - digit_firsts[digit];
            tally[entry] += 1u;
            sort_keys_out[place] = key;
            sort_order_out[place] = sort_order_in[first + k];
        }
    }
}

struct shape_Segment {
    first_item: u32,
    item_count: u32,
    first_block: u32,
    first_node: u32,
    first_triangle: u32,
    triangle_stride: u32,
    source_triangle: u32,
    padding: u32
}

struct shape_TreeShape {
    item_count: u32,
    segment_count: u32,
    block_count: u32,
    is_top: u32,
    step: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32
}

@group(0) @binding(0)
var<uniform> shape_shape: shape_TreeShape;

@group(0) @binding(1)
var<storage, read> shape_segments: array<shape_Segment>;

const shape_BLOCK_ITEMS = 2048u;

fn shape_segment_of_block(block: u32) -> u32 {
    var low = 0u;
    var high = shape_shape.segment_count;
    for (var turn = 0u; turn < 32u; turn++) {
        let middle = (low + high) / 2u;
        if high - low <= 1u {
            break;
        }
        if shape_segments[middle].first_block <= block {
            low = middle;
        }
        else {
            high = middle;
        }
    }
    return low;
}

@group(0) @binding(2)
var<storage, read> sort_keys_in: array<u32>;

@group(0) @binding(3)
var<storage, read> sort_order_in: array<u32>;

@group(0) @binding(4)
var<storage, read_write> sort_keys_out: array<u32>;

@group(0) @binding(5)
var<storage, read_write> sort_order_out: array<u32>;

@group(0) @binding(6)
var<storage, read_write> sort_counts: array<u32>;

const sort_DIGITS = 16u;

fn sort_digit_of(key: u32) -> u32 {
    return (key >> (4u * shape_shape.step)) & (sort_DIGITS - 1u);
}

struct sort_Block {
    first: u32,
    end: u32,
    first_count: u32,
    count_stride: u32
}

fn sort_block_at(index: u32) -> sort_Block {
    let segment = shape_segments[shape_segment_of_block(index)];
    let blocks = (segment.item_count + shape_BLOCK_ITEMS - 1u) / shape_BLOCK_ITEMS;
    let block = index - segment.first_block;
    let first = segment.first_item + block * shape_BLOCK_ITEMS;
    let end = min(first + shape_BLOCK_ITEMS, segment.first_item + segment.item_count);
    return sort_Block(first, end, sort_DIGITS * segment.first_block + block, blocks);
}
