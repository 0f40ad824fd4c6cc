// Linked from src/techniques/ray_traced/tree/frames.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(6)
var<storage, read_write> nodes: array<vec4u>;

@compute @workgroup_size(64)
fn make_frames(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = shape_thread_index(id, workgroups);
    if index >= shape_shape.segment_count {
        return;
    }
    let segment = shape_segments[index];
    var box = boxes_box_of_run(segment.first_item, segment.first_item + segment.item_count);
    if nodes_is_empty(box) {
        box.low = vec3f();
        box.high = vec3f();
    }
    nodes[segment.first_node] = vec4u(bitcast<vec3u>(box.low), 0u);
    nodes[segment.first_node + 1u] = vec4u(bitcast<vec3u>(box.high), 0u);
}

@group(0) @binding(2)
var<storage, read_write> boxes_items: array<vec4f>;

@group(0) @binding(3)
var<storage, read_write> boxes_order: array<u32>;

@group(0) @binding(4)
var<storage, read_write> boxes_pyramid: array<vec4f>;

const boxes_GROUP = 8u;

const boxes_MAX_LEVELS = 10u;

fn boxes_level_count(count_below: u32) -> u32 {
    return (count_below + boxes_GROUP - 1u) / boxes_GROUP;
}

fn boxes_item_box(place: u32) -> nodes_Box {
    let item = boxes_order[place];
    return nodes_Box(boxes_items[2u * item].xyz, boxes_items[2u * item + 1u].xyz);
}

fn boxes_box_of_level(level: u32, first: u32, index: u32) -> nodes_Box {
    if level == 0u {
        return boxes_item_box(index);
    }
    let at = 2u * (first + index);
    return nodes_Box(boxes_pyramid[at].xyz, boxes_pyramid[at + 1u].xyz);
}

fn boxes_box_of_run(begin: u32, end: u32) -> nodes_Box {
    var box = nodes_empty_box();
    var a = begin;
    var b = end;
    var first = 0u;
    var count = shape_shape.item_count;
    for (var level = 0u; level < boxes_MAX_LEVELS; level++) {
        for (var k = 0u; k < boxes_GROUP; k++) {
            if a >= b || a % boxes_GROUP == 0u {
                break;
            }
            box = nodes_union_of(box, boxes_box_of_level(level, first, a));
            a += 1u;
        }
        for (var k = 0u; k < boxes_GROUP; k++) {
            if a >= b || b % boxes_GROUP == 0u {
                break;
            }
            b -= 1u;
            box = nodes_union_of(box, boxes_box_of_level(level, first, b));
        }
        if a >= b {
            break;
        }
        a /= boxes_GROUP;
        b /= boxes_GROUP;
        first += select(count, 0u, level == 0u);
        count = boxes_level_count(count);
    }
    return box;
}

struct nodes_Box {
    low: vec3f,
    high: vec3f
}

const nodes_NOTHING = 3e38;

fn nodes_empty_box() -> nodes_Box {
    return nodes_Box(vec3f(nodes_NOTHING), vec3f(-nodes_NOTHING));
}

fn nodes_union_of(a: nodes_Box, b: nodes_Box) -> nodes_Box {
    return nodes_Box(min(a.low, b.low), max(a.high, b.high));
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
