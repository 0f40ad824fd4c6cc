// Linked from src/techniques/ray_traced/tree/number.wesl by `cargo xtask shaders`: edit that, not this.

@compute @workgroup_size(64)
fn number(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let item = shape_thread_index(id, workgroups);
    if item < shape_shape.item_count {
        boxes_order[item] = item;
    }
}

@group(0) @binding(3)
var<storage, read_write> boxes_order: array<u32>;

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
