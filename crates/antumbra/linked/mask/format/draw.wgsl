// Linked from src/mask/format/draw.wesl by `cargo xtask shaders`: edit that, not this.

@group(0) @binding(0)
var wide: texture_2d_array<f32>;

const ALL_LAYERS = 3u;

struct Varyings {
    @builtin(position)
    position: vec4f,
    @location(0)
    pixel: vec2f,
    @location(1) @interpolate(flat)
    layer: u32
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) layer: u32) -> Varyings {
    let uv = vec2f(f32((corner << 1u) & 2u), f32(corner & 2u));
    let pixel = uv * vec2f(textureDimensions(wide));
    return Varyings(vec4f(uv * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), pixel, layer);
}

@fragment
fn draw(varyings: Varyings) -> @location(0) vec4f {
    let pixel = vec2u(varyings.pixel);
    if varyings.layer == ALL_LAYERS {
        return vec4f(textureLoad(wide, pixel, 0u, 0).x, textureLoad(wide, pixel, 1u, 0).x, textureLoad(wide, pixel, 2u, 0).x, 1.0);
    }
    return vec4f(textureLoad(wide, pixel, varyings.layer, 0).x);
}
