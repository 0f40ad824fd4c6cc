// Writes a mask as depth, which is what Bevy's bindings have a place for.

@group(0) @binding(0) var mask: texture_2d<f32>;

@vertex
fn cover(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(4u * (i & 1u)) - 1.0, f32(2u * (i & 2u)) - 1.0, 0.0, 1.0);
}

@fragment
fn write(@builtin(position) position: vec4<f32>) -> @builtin(frag_depth) f32 {
    return clamp(textureLoad(mask, vec2<i32>(position.xy), 0).x, 0.0, 1.0);
}
