// Linked from src/light_map/depth_pyramid/next.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var previous: texture_2d<f32>;

@group(0) @binding(1)
var level: texture_storage_2d<rg32float, write>;

@compute @workgroup_size(8, 8)
fn next(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= textureDimensions(level)) {
        return;
    }
    let last = textureDimensions(previous) - 1u;
    let a = textureLoad(previous, min(2u * id.xy, last), 0).xy;
    let b = textureLoad(previous, min(2u * id.xy + vec2u(1, 0), last), 0).xy;
    let c = textureLoad(previous, min(2u * id.xy + vec2u(0, 1), last), 0).xy;
    let d = textureLoad(previous, min(2u * id.xy + vec2u(1, 1), last), 0).xy;
    let low = min(min(a.x, b.x), min(c.x, d.x));
    let high = max(max(a.y, b.y), max(c.y, d.y));
    textureStore(level, id.xy, vec4f(low, high, 0.0, 0.0));
}
