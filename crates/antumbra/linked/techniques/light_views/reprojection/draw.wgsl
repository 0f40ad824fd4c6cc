// Linked from src/techniques/light_views/reprojection/draw.wesl by `cargo xtask shaders`: edit that, not this.

struct DrawMaps {
    view_size: u32,
    row_texels: u32,
    padding_0: u32,
    padding_1: u32
}

@group(0) @binding(0)
var<uniform> draw_maps: DrawMaps;

@group(0) @binding(1)
var<storage, read> stored: array<u32>;

struct Varyings {
    @builtin(position)
    position: vec4f,
    @location(0) @interpolate(flat)
    map: u32
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) map: u32) -> Varyings {
    let pos = vec2f(f32((corner << 1u) & 2u), f32(corner & 2u)) * 2.0 - 1.0;
    return Varyings(vec4f(pos, 0.0, 1.0), map);
}

@fragment
fn draw(varyings: Varyings) -> @builtin(frag_depth) f32 {
    let texel = vec2u(varyings.position.xy);
    return bitcast<f32>(stored[(varyings.map * draw_maps.view_size + texel.y) * draw_maps.row_texels + texel.x]);
}
