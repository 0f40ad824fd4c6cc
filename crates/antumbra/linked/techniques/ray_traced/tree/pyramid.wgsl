// Linked from src/techniques/ray_traced/tree/pyramid.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn make_level(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let level = shape_shape.step;
    var first_below = 0u;
    var first = 0u;
    var count_below = shape_shape.item_count;
    for (var below = 1u; below < min(level, boxes_MAX_LEVELS); below++) {
        count_below = boxes_level_count(count_below);
        first_below = first;
        first += count_below;
    }
    let group = shape_thread_index(id, workgroups);
    if group >= boxes_level_count(count_below) {
        return;
    }
    var box = nodes_empty_box();
    for (var k = 0u; k < boxes_GROUP; k++) {
        let index = boxes_GROUP * group + k;
        if index < count_below {
            box = nodes_union_of(box, boxes_box_of_level(level - 1u, first_below, index));
        }
    }
    boxes_pyramid[2u * (first + group)] = vec4f(box.low, 0.0);
    boxes_pyramid[2u * (first + group) + 1u] = vec4f(box.high, 0.0);
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

fn shape_thread_index(id: vec3u, group_counts: vec3u) -> u32 {
    return id.y * group_counts.x * 64u + id.x;
}
