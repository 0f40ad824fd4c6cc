// Writes masks and Bevy's own maps as depth, the only format that Bevy's bindings have a place for.

@group(0) @binding(0) var mask: texture_2d<f32>;
@group(0) @binding(1) var maps: texture_depth_2d_array;

struct Cover {
    @builtin(position) position: vec4<f32>,
    // Part to draw: the first pixel of a mask's tile, x in the low 16 bits; or the layer of the maps.
    @location(0) @interpolate(flat) part: u32,
}

@vertex
fn cover(@builtin(vertex_index) i: u32, @builtin(instance_index) part: u32) -> Cover {
    return Cover(vec4<f32>(f32(4u * (i & 1u)) - 1.0, f32(2u * (i & 2u)) - 1.0, 0.0, 1.0), part);
}

@fragment
fn write(in: Cover) -> @builtin(frag_depth) f32 {
    let first = vec2<u32>(in.part & 0xffffu, in.part >> 16u);
    return clamp(textureLoad(mask, first + vec2<u32>(in.position.xy), 0).x, 0.0, 1.0);
}

@fragment
fn copy_map(in: Cover) -> @builtin(frag_depth) f32 {
    return textureLoad(maps, vec2<u32>(in.position.xy), in.part, 0);
}
