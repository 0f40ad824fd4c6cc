// Linked from src/techniques/single_map/micro_patches/probe.wesl by `cargo xtask shaders`: edit that, not this.

struct ProbedSquare {
    low: vec2f,
    high: vec2f,
    below: vec3f,
    scale: f32,
    above: vec3f,
    padding: f32,
    beside: vec2f,
    ends: vec2f
}

struct ProbedPatches {
    alone: patch_Patch,
    joined: patch_Patch,
    innermost: patch_Patch
}

@group(0) @binding(0)
var<storage, read> inputs: array<ProbedSquare>;

@group(0) @binding(1)
var<storage, read_write> outputs: array<ProbedPatches>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&inputs) {
        return;
    }
    let square = inputs[id.x];
    outputs[id.x] = ProbedPatches(patch_patch_of(square.low, square.high, square.scale), patch_joined(square.low, square.high, square.scale, patch_Neighbours(square.below, square.beside, square.above)), patch_innermost_of(square.low, square.high, square.ends));
}

struct patch_Patch {
    low: vec2f,
    high: vec2f
}

fn patch_patch_of(low: vec2f, high: vec2f, scale: f32) -> patch_Patch {
    return patch_Patch(low * scale, high * scale);
}

struct patch_Neighbours {
    below: vec3f,
    beside: vec2f,
    above: vec3f
}

fn patch_reach_of(edge: f32, own: f32, neighbours: vec3f) -> vec2f {
    let places = edge * select(vec3f(own), neighbours, neighbours > vec3f());
    let least = min(min(places.x, places.y), places.z);
    let most = max(max(places.x, places.y), places.z);
    return vec2f(min(least, edge * own), max(most, edge * own));
}

fn patch_joined(low: vec2f, high: vec2f, own: f32, around: patch_Neighbours) -> patch_Patch {
    let left = vec3f(around.below.x, around.beside.x, around.above.x);
    let right = vec3f(around.below.z, around.beside.y, around.above.z);
    return patch_Patch(vec2f(patch_reach_of(low.x, own, left).x, patch_reach_of(low.y, own, around.below).x), vec2f(patch_reach_of(high.x, own, right).y, patch_reach_of(high.y, own, around.above).y));
}

fn patch_innermost_of(low: vec2f, high: vec2f, scales: vec2f) -> patch_Patch {
    return patch_Patch(max(low * scales.x, low * scales.y), min(high * scales.x, high * scales.y));
}
