// Linked from src/primitives/prefix_scan/add.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read_write> items: array<u32>;

@group(0) @binding(1)
var<storage, read_write> block_offsets: array<u32>;

@compute @workgroup_size(256)
fn add(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let offset = block_offsets[group.x];
    let end = min((group.x + 1u) * scan_ITEMS_PER_BLOCK, arrayLength(&items));
    for (var i = group.x * scan_ITEMS_PER_BLOCK + thread; i < end; i += scan_THREADS) {
        items[i] += offset;
    }
}

const scan_THREADS = 256u;

const scan_ITEMS_PER_BLOCK = 2048u;
