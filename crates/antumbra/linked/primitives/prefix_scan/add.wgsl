// Linked from src/primitives/prefix_scan/add.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read_write> items: array<u32>;

@group(0) @binding(1)
var<storage, read_write> block_offsets: array<u32>;

@compute @workgroup_size(256)
fn add(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let offset = block_offsets[group.x];
    let end = min((group.x + 1u) * package_primitives__1prefix_scan_scan__2ITEMS_PER_BLOCK, arrayLength(&items));
    for (var i = group.x * package_primitives__1prefix_scan_scan__2ITEMS_PER_BLOCK + thread; i < end; i += package_primitives__1prefix_scan_scan_THREADS) {
        items[i] += offset;
    }
}

const package_primitives__1prefix_scan_scan_THREADS = 256u;

const package_primitives__1prefix_scan_scan__2ITEMS_PER_BLOCK = 2048u;
