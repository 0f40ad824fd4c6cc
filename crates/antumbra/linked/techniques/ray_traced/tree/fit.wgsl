// Linked from src/techniques/ray_traced/tree/fit.wesl by `cargo xtask shaders`: edit that, not this.

fn vectors_of_node() -> u32 {
    return select(1u, 2u, shape_shape.is_top == 1u);
}

fn word_of(segment: shape_Segment, node: u32) -> u32 {
    return frames_nodes[segment.first_node + 2u + vectors_of_node() * node].w;
}

fn first_of_node(segment: shape_Segment, node: u32) -> u32 {
    var word = word_of(segment, node);
    for (var depth = 0u; depth < links_MAX_DEPTH; depth++) {
        if nodes_is_leaf(word) {
            break;
        }
        word = word_of(segment, node + 1u + depth);
    }
    return nodes_first_of_leaf(word);
}

const ROUNDING = 1e-6;

@compute @workgroup_size(64)
fn fit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let thread = shape_thread_index(id, workgroups);
    let nodes_per_item = vectors_of_node();
    if thread >= nodes_per_item * shape_shape.item_count {
        return;
    }
    let segment = shape_segment_of_item(thread / nodes_per_item);
    let node = thread - nodes_per_item * segment.first_item;
    let root = word_of(segment, 0u);
    if node >= select(root, 1u, nodes_is_leaf(root)) {
        return;
    }
    let word = word_of(segment, node);
    let first = segment.first_item + first_of_node(segment, node);
    let last = select(word_of(segment, word - 1u), word, nodes_is_leaf(word));
    let end = segment.first_item + nodes_first_of_leaf(last) + nodes_count_of_leaf(last);
    let box = boxes_box_of_run(first, end);
    let at = segment.first_node + 2u + nodes_per_item * node;
    if shape_shape.is_top == 1u {
        let margin = ROUNDING * max(abs(box.low), abs(box.high));
        let low = select(box.low - margin, vec3f(), nodes_is_empty(box));
        let high = select(box.high + margin, vec3f(), nodes_is_empty(box));
        frames_nodes[at] = vec4u(bitcast<vec3u>(low), word);
        frames_nodes[at + 1u] = vec4u(bitcast<vec3u>(high), boxes_order[first]);
        return;
    }
    let frame = nodes_Box(bitcast<vec3f>(frames_nodes[segment.first_node].xyz), bitcast<vec3f>(frames_nodes[segment.first_node + 1u].xyz));
    frames_nodes[at] = vec4u(nodes_packed_box(frame, box), word);
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

@group(0) @binding(6)
var<storage, read_write> frames_nodes: array<vec4u>;

const links_MAX_DEPTH = 64u;

const nodes_LEAF = 2147483648u;

const nodes_COUNT_SHIFT = 25u;

const nodes_COUNT_MASK = 63u;

const nodes_FIRST_MASK: u32 = 33554431;

fn nodes_is_leaf(word: u32) -> bool {
    return (word & nodes_LEAF) != 0u;
}

fn nodes_first_of_leaf(word: u32) -> u32 {
    return word & nodes_FIRST_MASK;
}

fn nodes_count_of_leaf(word: u32) -> u32 {
    return ((word >> nodes_COUNT_SHIFT) & nodes_COUNT_MASK) + 1u;
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

const nodes_STEPS = 65535.0;

fn nodes_step_of(frame: nodes_Box) -> vec3f {
    let size = max(abs(frame.low), abs(frame.high));
    let largest = max(size.x, max(size.y, size.z));
    return max(frame.high - frame.low, vec3f(max(1e-6 * largest, 1e-30))) / nodes_STEPS;
}

const nodes_PACK_MARGIN = 0.02;

fn nodes_packed_box(frame: nodes_Box, box: nodes_Box) -> vec3u {
    let step = nodes_step_of(frame);
    let low = vec3u(clamp(floor((box.low - frame.low) / step - nodes_PACK_MARGIN), vec3f(0.0), vec3f(nodes_STEPS)));
    let high = vec3u(clamp(ceil((box.high - frame.low) / step + nodes_PACK_MARGIN), vec3f(0.0), vec3f(nodes_STEPS)));
    let held = max(low, high);
    return vec3u(low.x | (low.y << 16u), low.z | (held.x << 16u), held.y | (held.z << 16u));
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
