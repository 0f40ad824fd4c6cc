// Linked from src/techniques/ray_traced/tree/codes.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(5)
var<storage, read_write> keys: array<u32>;

const CELLS = 1024.0;

fn spread(value: u32) -> u32 {
    var v = value & 1023u;
    v = (v | (v << 16u)) & 50331903u;
    v = (v | (v << 8u)) & 50393103u;
    v = (v | (v << 4u)) & 51130563u;
    return (v | (v << 2u)) & 153391689u;
}

fn code_of(frame: nodes_Box, box: nodes_Box) -> u32 {
    if nodes_is_empty(box) {
        return 0u;
    }
    let extent = max(frame.high - frame.low, vec3f(1e-30));
    let part = (0.5 * box.low + 0.5 * box.high - frame.low) / extent;
    let cell = vec3u(clamp(part * CELLS, vec3f(0.0), vec3f(CELLS - 1.0)));
    return spread(cell.x) | (spread(cell.y) << 1u) | (spread(cell.z) << 2u);
}

@compute @workgroup_size(64)
fn make_codes(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = shape_thread_index(id, workgroups);
    if item >= shape_shape.item_count {
        return;
    }
    let segment = shape_segment_of_item(item);
    let frame = nodes_Box(bitcast<vec3f>(frames_nodes[segment.first_node].xyz), bitcast<vec3f>(frames_nodes[segment.first_node + 1u].xyz));
    keys[item] = code_of(frame, nodes_Box(boxes_items[2u * item].xyz, boxes_items[2u * item + 1u].xyz));
    boxes_order[item] = item;
}

@group(0) @binding(2)
var<storage, read_write> boxes_items: array<vec4f>;

@group(0) @binding(3)
var<storage, read_write> boxes_order: array<u32>;

@group(0) @binding(6)
var<storage, read_write> frames_nodes: array<vec4u>;

struct nodes_Box {
    low: vec3f,
    high: vec3f
}

fn nodes_is_empty(box: nodes_Box) -> bool {
    return any(box.low > box.high);
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
