// Linked from src/primitives/stochastic/probe.wesl by `cargo xtask shaders`: edit that, not this.

struct StochasticInput {
    point: u32,
    seed: u32,
    x: f32,
    y: f32
}

@group(0) @binding(0)
var<storage, read> inputs: array<StochasticInput>;

@group(0) @binding(1)
var<storage, read_write> outputs: array<f32>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&inputs) {
        return;
    }
    let input = inputs[id.x];
    let seed = thresholds_hash_of_position(input.seed, vec3f(input.x, input.y, 1.0));
    outputs[id.x] = thresholds_stochastic_threshold(input.point, seed);
}

fn thresholds_hash_combine(seed: u32, value: u32) -> u32 {
    return seed ^ (value + (seed << 6u) + (seed >> 2u));
}

fn thresholds_hash(value: u32) -> u32 {
    var x = value;
    x ^= x >> 16u;
    x *= 2146121005u;
    x ^= x >> 15u;
    x *= 2221713035u;
    return x ^ (x >> 16u);
}

fn thresholds_hash_of_position(seed: u32, position: vec3f) -> u32 {
    let bits = bitcast<vec3u>(position);
    return thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(thresholds_hash(thresholds_hash_combine(seed, bits.x)), bits.y)), bits.z));
}

fn thresholds_laine_karras_permutation(value: u32, seed: u32) -> u32 {
    var x = value + seed;
    x ^= x * 1817228412u;
    x ^= x * 3090095698u;
    x ^= x * 3350193720u;
    return x ^ (x * 2367878886u);
}

fn thresholds_stochastic_threshold(point: u32, seed: u32) -> f32 {
    let shuffled = reverseBits(thresholds_laine_karras_permutation(reverseBits(point), thresholds_hash(seed)));
    let scrambled = reverseBits(thresholds_laine_karras_permutation(shuffled, thresholds_hash(seed ^ 2654435769u)));
    return (f32(scrambled >> 8u) + 0.5) / 16777216.0;
}
