// Linked from src/light_map/caster_triangles/map.wesl by `cargo xtask shaders`: edit that, not this.

struct TriangleMap {
    size_texels: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32
}

@group(2) @binding(0)
var<uniform> triangle_map: TriangleMap;

@group(2) @binding(1)
var<storage, read> triangles: array<vec4u>;

struct Varyings {
    @builtin(position)
    pos_in_clip: vec4f,
    @location(0) @interpolate(flat, either)
    id: u32
}

const MIN_TEXELS = 1.0;

const MAX_MITRE = 2.0;

fn clip_of_corner(i: u32) -> vec4f {
    return opaque_caster_view.clip_from_world * vec4f(triangles_corner_of(triangles[i]), 1.0);
}

fn widened(here: vec4f, ahead: vec4f, behind: vec4f) -> vec4f {
    if min(here.w, min(ahead.w, behind.w)) <= 0.0 {
        return here;
    }
    let texels = 0.5 * triangle_map.size_texels;
    let pos = texels * here.xy / here.w;
    let to_ahead = texels * ahead.xy / ahead.w - pos;
    let to_behind = texels * behind.xy / behind.w - pos;
    let area = to_ahead.x * to_behind.y - to_ahead.y * to_behind.x;
    let lengths = vec3f(length(to_ahead), length(to_behind), length(to_ahead - to_behind));
    let longest = max(lengths.x, max(lengths.y, lengths.z));
    let out_by = 0.5 * (MIN_TEXELS - abs(area) / max(longest, 1e-6));
    if out_by <= 0.0 || longest < MIN_TEXELS || min(lengths.x, lengths.y) < 1e-6 {
        return here;
    }
    let along_ahead = to_ahead / lengths.x;
    let along_behind = to_behind / lengths.y;
    let turn = select(-1.0, 1.0, area >= 0.0);
    let outward = turn * (vec2f(along_ahead.y, -along_ahead.x) + vec2f(-along_behind.y, along_behind.x));
    var mitre = outward * (2.0 / max(dot(outward, outward), 1e-12));
    if dot(mitre, mitre) > MAX_MITRE * MAX_MITRE {
        let onward = -along_ahead - along_behind;
        mitre = MAX_MITRE * onward * inverseSqrt(max(dot(onward, onward), 1e-12));
    }
    return vec4f(here.xy + mitre * (out_by / texels * here.w), here.zw);
}

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Varyings {
    let triangle = i / 3u;
    let ahead = 3u * triangle + (i + 1u) % 3u;
    let behind = 3u * triangle + (i + 2u) % 3u;
    return Varyings(widened(clip_of_corner(i), clip_of_corner(ahead), clip_of_corner(behind)), triangle + 1u);
}

@fragment
fn fragment(varyings: Varyings) -> @location(0) u32 {
    return varyings.id;
}

struct opaque_CasterView {
    clip_from_world: mat4x4f,
    anchor_in_world: vec3f,
    light_point: u32,
    color_weights: vec3f,
    padding: u32
}

@group(0) @binding(0)
var<uniform> opaque_caster_view: opaque_CasterView;

fn triangles_corner_of(word: vec4u) -> vec3f {
    return bitcast<vec3f>(word.xyz);
}
