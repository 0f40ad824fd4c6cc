// Linked from src/techniques/ray_traced/mesh/recall.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn recall(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = shape_thread_index(id, workgroups);
    if place >= shape_shape.item_count {
        return;
    }
    let segment = shape_segment_of_item(place);
    let at = segment.first_triangle + segment.triangle_stride * (place - segment.first_item);
    source_order[place] = segment.first_item + source_triangles[at].w;
}

@group(0) @binding(3)
var<storage, read_write> source_order: array<u32>;

@group(0) @binding(4)
var<storage, read_write> source_triangles: array<vec4u>;

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
