// Linked from src/primitives/prefix_scan/scan.wesl by `cargo xtask shaders`: edit that, not this.

const THREADS = 256u;

const ITEMS_PER_BLOCK = 2048u;

const ITEMS_PER_THREAD = ITEMS_PER_BLOCK / THREADS;

@group(0) @binding(0)
var<storage, read_write> items: array<u32>;

@group(0) @binding(1)
var<storage, read_write> block_sums: array<u32>;

var<workgroup> block: array<u32, ITEMS_PER_BLOCK>;

var<workgroup> thread_sums: array<u32, THREADS>;

@compute @workgroup_size(256)
fn scan(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let first = group.x * ITEMS_PER_BLOCK;
    for (var i = thread; i < ITEMS_PER_BLOCK; i += THREADS) {
        var item = 0u;
        if first + i < arrayLength(&items) {
            item = items[first + i];
        }
        block[i] = item;
    }
    workgroupBarrier();
    var sum = 0u;
    for (var i = 0u; i < ITEMS_PER_THREAD; i++) {
        let item = block[thread * ITEMS_PER_THREAD + i];
        block[thread * ITEMS_PER_THREAD + i] = sum;
        sum += item;
    }
    thread_sums[thread] = sum;
    workgroupBarrier();
    for (var reach = 1u; reach < THREADS; reach *= 2u) {
        var below = 0u;
        if thread >= reach {
            below = thread_sums[thread - reach];
        }
        workgroupBarrier();
        thread_sums[thread] += below;
        workgroupBarrier();
    }
    if thread == 0u {
        block_sums[group.x] = thread_sums[THREADS - 1u];
    }
    for (var i = thread; i < ITEMS_PER_BLOCK; i += THREADS) {
        let owner = i / ITEMS_PER_THREAD;
        if first + i < arrayLength(&items) {
            items[first + i] = block[i] + select(0u, thread_sums[max(owner, 1u) - 1u], owner > 0u);
        }
    }
}
