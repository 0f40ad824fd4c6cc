// Linked from src/primitives/lloyd/update.wesl by `cargo xtask shaders`: edit that, not this.

struct LloydUniform {
    cluster_count: u32,
    iterations: u32,
    moved_count: u32,
    moved_first: u32,
    begins: u32,
    shift: f32,
    min_gap: f32,
    glide: f32
}

override BY_WEIGHT: bool = false;

const BIN_COUNT = 4096u;

const CHUNK = 16u;

@group(0) @binding(0)
var<uniform> lloyd: LloydUniform;

@group(0) @binding(1)
var<storage, read> histogram: array<u32>;

@group(0) @binding(2)
var<storage, read_write> means: array<f32>;

@group(0) @binding(3)
var<storage, read_write> splits: array<f32>;

var<workgroup> chunks: array<vec3f, 256>;

var<workgroup> mean: array<f32, 15>;

var<workgroup> sums: array<vec3f, 15>;

fn value_of(bin: u32) -> f32 {
    return (f32(bin) + 0.5) / f32(BIN_COUNT);
}

fn sums_of(bin: u32) -> vec3f {
    let weight = f32(histogram[bin]);
    let x = value_of(bin) - 0.5;
    return vec3f(weight, weight * x, weight * x * x);
}

fn first_bin(value: f32) -> u32 {
    return u32(clamp(ceil(value * f32(BIN_COUNT) - 0.5), 0.0, f32(BIN_COUNT)));
}

fn sums_between(first: u32, end: u32) -> vec3f {
    var total = vec3f();
    var bin = first;
    for (; bin < end && bin % CHUNK != 0u; bin++) {
        total += sums_of(bin);
    }
    for (; bin + CHUNK <= end; bin += CHUNK) {
        total += chunks[bin / CHUNK];
    }
    for (; bin < end; bin++) {
        total += sums_of(bin);
    }
    return total;
}

fn inertia_of(s: vec3f) -> f32 {
    return select(0.0, max(s.z - s.y * s.y / s.x, 0.0), s.x > 0.0);
}

fn merge_cost(i: u32) -> f32 {
    var cost = 3.4e38;
    for (var k = 0u; k < 2u; k++) {
        let j = select(i + 1u, i - 1u, k == 0u);
        if (k == 0u && i > 0u) || (k == 1u && i + 1u < lloyd.cluster_count) {
            let both = sums[i].x + sums[j].x;
            let distance = mean[i] - mean[j];
            cost = min(cost, select(0.0, sums[i].x * sums[j].x / both * distance * distance, both > 0.0));
        }
    }
    return cost;
}

fn put_in_order() {
    for (var i = 1u; i < lloyd.cluster_count; i++) {
        for (var j = i; j > 0u; j--) {
            let low = min(mean[j - 1u], mean[j]);
            let high = max(mean[j - 1u], mean[j]);
            mean[j - 1u] = low;
            mean[j] = high;
        }
    }
}

fn teleport_by_weight() {
    var heaviest = 0u;
    var empty = lloyd.cluster_count;
    for (var i = 0u; i < lloyd.cluster_count; i++) {
        heaviest = select(heaviest, i, sums[i].x > sums[heaviest].x);
        empty = select(empty, i, sums[i].x <= 0.0 && empty == lloyd.cluster_count);
    }
    if empty == lloyd.cluster_count || sums[heaviest].x <= 0.0 {
        return;
    }
    let deviation = sqrt(inertia_of(sums[heaviest]) / sums[heaviest].x);
    let center = mean[heaviest];
    mean[heaviest] = center - deviation;
    mean[empty] = center + deviation;
    put_in_order();
}

fn teleport() {
    let count = lloyd.cluster_count;
    if count < 2u {
        return;
    }
    var heaviest = 0u;
    for (var i = 1u; i < count; i++) {
        heaviest = select(heaviest, i, inertia_of(sums[i]) > inertia_of(sums[heaviest]));
    }
    var cheapest = select(0u, 1u, heaviest == 0u);
    for (var i = cheapest + 1u; i < count; i++) {
        cheapest = select(cheapest, i, i != heaviest && merge_cost(i) < merge_cost(cheapest));
    }
    let inertia = inertia_of(sums[heaviest]);
    let deviation = sqrt(inertia / max(sums[heaviest].x, 1.0));
    if 0.75 * inertia <= 2.0 * merge_cost(cheapest) || 2.0 * deviation < lloyd.min_gap {
        return;
    }
    let center = mean[heaviest];
    mean[heaviest] = center - deviation;
    mean[cheapest] = center + deviation;
    put_in_order();
}

@compute @workgroup_size(256)
fn relax(@builtin(local_invocation_index) id: u32) {
    var chunk = vec3f();
    for (var i = 0u; i < CHUNK; i++) {
        chunk += sums_of(id * CHUNK + i);
    }
    chunks[id] = chunk;
    let count = lloyd.cluster_count;
    if id < count {
        mean[id] = select(means[id], (f32(id) + 1.0) / f32(count + 1u), lloyd.begins == 1u);
    }
    workgroupBarrier();
    for (var iteration = 0u; iteration < lloyd.iterations; iteration++) {
        var own = vec3f();
        if id < count {
            var low = 0.0;
            var high = 2.0;
            if id > 0u {
                low = 0.5 * (mean[id - 1u] + mean[id]);
            }
            if id + 1u < count {
                high = 0.5 * (mean[id] + mean[id + 1u]);
            }
            own = sums_between(first_bin(low), first_bin(high));
            sums[id] = own;
        }
        workgroupBarrier();
        if id < count {
            let turn = (id + count - (lloyd.moved_first + iteration * lloyd.moved_count) % count) % count;
            if own.x > 0.0 && turn < lloyd.moved_count {
                mean[id] = own.y / own.x + 0.5;
            }
        }
        workgroupBarrier();
        if id == 0u {
            if BY_WEIGHT {
                teleport_by_weight();
            }
            else {
                teleport();
            }
        }
        workgroupBarrier();
    }
    if id < count {
        means[id] = mean[id];
    }
    workgroupBarrier();
    if id == 0u {
        let gap = min(lloyd.min_gap, 1.0 / f32(count + 1u));
        for (var i = 0u; i < count; i++) {
            let least = select(gap, mean[max(i, 1u) - 1u] + gap, i > 0u);
            mean[i] = clamp(mean[i] + lloyd.shift, least, 1.0 - gap * f32(count - i));
            splits[i] = select(mix(splits[i], mean[i], lloyd.glide), mean[i], lloyd.begins == 1u);
        }
    }
}
