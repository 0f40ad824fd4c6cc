// Linked from src/mask/accumulation/fingerprint.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var<storage, read> words: array<u32>;

@group(0) @binding(1)
var<storage, read_write> state: array<atomic<u32>>;

const THREADS = 256u;

var<workgroup> group_sum: atomic<u32>;

fn hash(x: u32) -> u32 {
    let mixed = x * 747796405u + 2891336453u;
    let word = ((mixed >> ((mixed >> 28u) + 4u)) ^ mixed) * 277803737u;
    return (word >> 22u) ^ word;
}

@compute @workgroup_size(256)
fn fingerprint(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) group_counts: vec3u, @builtin(local_invocation_index) thread: u32) {
    var sum = 0u;
    for (var i = id.x; i < arrayLength(&words); i += THREADS * group_counts.x) {
        sum += hash(words[i] ^ hash(i));
    }
    atomicAdd(&group_sum, sum);
    workgroupBarrier();
    if thread == 0u {
        atomicAdd(&state[0], atomicLoad(&group_sum));
    }
}
