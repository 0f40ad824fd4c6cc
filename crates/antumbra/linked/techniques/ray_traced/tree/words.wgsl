// Linked from src/techniques/ray_traced/tree/words.wesl by `cargo xtask shaders`: edit that, not this.

fn write_node(segment: shape_Segment, run: links_Run, parent: u32, most: u32) {
    if links_size_of_parent(parent) <= most {
        return;
    }
    let leaves_before = links_starts[run.first] - links_starts[segment.first_item];
    var index = 2u * leaves_before;
    var above = parent;
    var first = run.first;
    for (var depth = 0u; depth < links_MAX_DEPTH; depth++) {
        if above == links_NONE {
            break;
        }
        let first_above = links_run_of_node(above).first;
        index += select(0u, 1u, first == first_above);
        first = first_above;
        above = links_parents[2u * above];
    }
    var word = 0u;
    if links_size_of(run) <= most {
        word = nodes_leaf_word(run.first - segment.first_item, links_size_of(run));
    }
    else {
        word = index + 2u * (links_starts[run.last + 1u] - links_starts[run.first]) - 1u;
    }
    let vectors = select(1u, 2u, shape_shape.is_top == 1u);
    links_nodes[segment.first_node + 2u + vectors * index].w = word;
}

@compute @workgroup_size(64)
fn write_words(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = shape_thread_index(id, workgroups);
    if item >= shape_shape.item_count {
        return;
    }
    let index = shape_segment_index_of_item(item);
    let segment = shape_segments[index];
    let most = links_leaf_size(index, segment.item_count);
    write_node(segment, links_Run(item, item), links_parents[2u * item + 1u], most);
    if item + 1u < segment.first_item + segment.item_count {
        write_node(segment, links_run_of_node(item), links_parents[2u * item], most);
    }
}

@group(0) @binding(3)
var<storage, read_write> links_ends: array<u32>;

@group(0) @binding(4)
var<storage, read_write> links_parents: array<u32>;

@group(0) @binding(5)
var<storage, read_write> links_tallies: array<atomic<u32>>;

@group(0) @binding(6)
var<storage, read_write> links_starts: array<u32>;

@group(0) @binding(7)
var<storage, read_write> links_nodes: array<vec4u>;

const links_NONE = 4294967295u;

const links_MAX_DEPTH = 64u;

struct links_Run {
    first: u32,
    last: u32
}

fn links_size_of(run: links_Run) -> u32 {
    return run.last - run.first + 1u;
}

fn links_run_of_node(node: u32) -> links_Run {
    let end = links_ends[node];
    return links_Run(min(node, end), max(node, end));
}

fn links_size_of_parent(parent: u32) -> u32 {
    if parent == links_NONE {
        return links_NONE;
    }
    return links_size_of(links_run_of_node(parent));
}

const links_SMALL_LEAF = 4u;

const links_LEAF_GROWTH = 4u;

const links_LEAF_SIZES = 3u;

fn links_leaf_size(segment_index: u32, item_count: u32) -> u32 {
    if shape_shape.is_top == 1u {
        return 1u;
    }
    var size = links_SMALL_LEAF;
    for (var k = 0u; k + 1u < links_LEAF_SIZES; k++) {
        if 2u * atomicLoad(&links_tallies[links_LEAF_SIZES * segment_index + k]) > item_count + 1u {
            size *= links_LEAF_GROWTH;
        }
        else {
            break;
        }
    }
    return size;
}

const nodes_LEAF = 2147483648u;

const nodes_COUNT_SHIFT = 25u;

fn nodes_leaf_word(first: u32, count: u32) -> u32 {
    return nodes_LEAF | ((count - 1u) << nodes_COUNT_SHIFT) | first;
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
