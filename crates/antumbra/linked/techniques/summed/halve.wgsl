// Linked from src/techniques/summed/halve.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var previous: texture_2d<f32>;

@group(0) @binding(1)
var level: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn halve_level(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(level);
    if any(id.xy >= size) {
        return;
    }
    let last = textureDimensions(previous);
    let scale = vec2f(last) / vec2f(size);
    let low = vec2f(id.xy) * scale;
    let high = low + scale;
    var sum = vec4f();
    for (var y = u32(low.y); y < min(u32(ceil(high.y)), last.y); y++) {
        let height = min(high.y, f32(y + 1u)) - max(low.y, f32(y));
        for (var x = u32(low.x); x < min(u32(ceil(high.x)), last.x); x++) {
            let width = min(high.x, f32(x + 1u)) - max(low.x, f32(x));
            sum += width * height * textureLoad(previous, vec2u(x, y), 0);
        }
    }
    textureStore(level, id.xy, sum / (scale.x * scale.y));
}
