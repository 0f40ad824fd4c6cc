// Linked from src/techniques/ray_traced/tree/hierarchy.wesl by `cargo xtask shaders`: edit that, not this.

fn common_bits(segment: shape_Segment, i: i32, j: i32) -> i32 {
    if j < 0 || j >= i32(segment.item_count) {
        return -1;
    }
    let a = links_keys[segment.first_item + u32(i)];
    let b = links_keys[segment.first_item + u32(j)];
    if a == b {
        return 32 + i32(countLeadingZeros(u32(i) ^ u32(j)));
    }
    return i32(countLeadingZeros(a ^ b));
}

fn end_of(segment: shape_Segment, i: i32, side: i32) -> i32 {
    let least = common_bits(segment, i, i - side);
    var reach = 2;
    for (var doubling = 0u; doubling < 30u; doubling++) {
        if common_bits(segment, i, i + reach * side) <= least {
            break;
        }
        reach *= 2;
    }
    var length = 0;
    for (var halving = 0u; halving < 31u; halving++) {
        reach /= 2;
        if reach < 1 {
            break;
        }
        if common_bits(segment, i, i + (length + reach) * side) > least {
            length += reach;
        }
    }
    return i + length * side;
}

fn split_of(segment: shape_Segment, first: i32, last: i32) -> i32 {
    let in_common = common_bits(segment, first, last);
    var split = first;
    var reach = last - first;
    for (var halving = 0u; halving < 32u; halving++) {
        reach = (reach + 1) / 2;
        if split + reach < last && common_bits(segment, first, split + reach) > in_common {
            split += reach;
        }
        if reach <= 1 {
            break;
        }
    }
    return split;
}

fn set_parent(segment: shape_Segment, first: i32, last: i32, is_first: bool, parent: u32) {
    let child = segment.first_item + u32(select(first, last, is_first));
    links_parents[2u * child + select(0u, 1u, first == last)] = parent;
}

@compute @workgroup_size(64)
fn link(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = shape_thread_index(id, workgroups);
    if item >= shape_shape.item_count {
        return;
    }
    let segment = shape_segment_of_item(item);
    let i = i32(item - segment.first_item);
    if i == 0 {
        links_parents[2u * item + select(0u, 1u, segment.item_count == 1u)] = links_NONE;
    }
    if i + 1 >= i32(segment.item_count) {
        return;
    }
    let side = select(-1, 1, common_bits(segment, i, i + 1) > common_bits(segment, i, i - 1));
    let end = end_of(segment, i, side);
    links_ends[item] = segment.first_item + u32(end);
    let first = min(i, end);
    let last = max(i, end);
    let split = split_of(segment, first, last);
    set_parent(segment, first, split, true, item);
    set_parent(segment, split + 1, last, false, item);
}

@group(0) @binding(2)
var<storage, read> links_keys: array<u32>;

@group(0) @binding(3)
var<storage, read_write> links_ends: array<u32>;

@group(0) @binding(4)
var<storage, read_write> links_parents: array<u32>;

const links_NONE = 4294967295u;

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

fn shape_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}

fn shape_segment_index_of_item(item: u32) -> u32 {
    var low = 0u;
    var high = shape_shape.segment_count;
    for (var turn = 0u; turn < 32u; turn++) {
        let middle = (low + high) / 2u;
        if high - low <= 1u {
            break;
        }
        if shape_segments[middle].first_item <= item {
            low = middle;
        }
        else {
            high = middle;
        }
    }
    return low;
}

fn shape_segment_of_item(item: u32) -> shape_Segment {
    return shape_segments[shape_segment_index_of_item(item)];
}
