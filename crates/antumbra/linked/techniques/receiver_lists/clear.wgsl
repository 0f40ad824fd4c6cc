// Linked from src/techniques/receiver_lists/clear.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read_write> items: array<u32>;

@compute @workgroup_size(256)
fn clear(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u) {
    for (var i = id.x; i < arrayLength(&items); i += 256u * group_counts.x) {
        items[i] = 0u;
    }
}
