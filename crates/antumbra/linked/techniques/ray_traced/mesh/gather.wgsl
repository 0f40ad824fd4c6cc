// Linked from src/techniques/ray_traced/mesh/gather.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = source_item_of_thread(id, workgroups);
    if item >= source_source_range.end_item {
        return;
    }
    let segment = shape_segment_of_item(item);
    let box = source_box_of(source_corners_of(segment, item - segment.first_item));
    source_items[2u * item] = vec4f(box.low, 0.0);
    source_items[2u * item + 1u] = vec4f(box.high, 0.0);
}

const finite_EXPONENT_BITS = 2139095040u;

fn finite_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & finite_EXPONENT_BITS) != finite_EXPONENT_BITS;
}

@group(0) @binding(2)
var<storage, read_write> source_items: array<vec4f>;

struct source_SourceRange {
    first_item: u32,
    end_item: u32,
    padding_0: u32,
    padding_1: u32
}

@group(1) @binding(0)
var<uniform> source_source_range: source_SourceRange;

@group(1) @binding(1)
var<storage, read> source_mesh_positions: array<f32>;

@group(1) @binding(2)
var<storage, read> source_mesh_indices: array<u32>;

struct source_Corners {
    vertices: vec3u,
    a: vec3f,
    b: vec3f,
    c: vec3f
}

fn source_position_of(vertex: u32) -> vec3f {
    return vec3f(source_mesh_positions[3u * vertex], source_mesh_positions[3u * vertex + 1u], source_mesh_positions[3u * vertex + 2u]);
}

fn source_corners_of(segment: shape_Segment, triangle: u32) -> source_Corners {
    let first = 3u * (segment.source_triangle + triangle);
    let vertices = vec3u(source_mesh_indices[first], source_mesh_indices[first + 1u], source_mesh_indices[first + 2u]);
    return source_Corners(vertices, source_position_of(vertices.x), source_position_of(vertices.y), source_position_of(vertices.z));
}

fn source_box_of(corners: source_Corners) -> nodes_Box {
    let low = min(corners.a, min(corners.b, corners.c));
    let high = max(corners.a, max(corners.b, corners.c));
    let sums = abs(corners.a) + abs(corners.b) + abs(corners.c);
    let sum = sums.x + sums.y + sums.z;
    if sum >= nodes_NOTHING || !finite_is_finite(sum) {
        return nodes_empty_box();
    }
    return nodes_Box(low, high);
}

fn source_item_of_thread(id: vec3u, group_counts: vec3u) -> u32 {
    return source_source_range.first_item + shape_thread_index(id, group_counts);
}

struct nodes_Box {
    low: vec3f,
    high: vec3f
}

const nodes_NOTHING = 3e38;

fn nodes_empty_box() -> nodes_Box {
    return nodes_Box(vec3f(nodes_NOTHING), vec3f(-nodes_NOTHING));
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
