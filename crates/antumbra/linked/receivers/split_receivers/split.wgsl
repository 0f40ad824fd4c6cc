// Linked from src/receivers/split_receivers/split.wesl by `cargo xtask shaders`: edit that, not this.

struct Split {
    view_from_clip: mat4x4f,
    world_from_view: mat4x4f,
    origin_px: vec2u,
    size_px: vec2u,
    background_depth: f32,
    has_normals: u32,
    padding_0: u32,
    padding_1: u32
}

@group(0) @binding(0)
var<uniform> split: Split;

@group(0) @binding(1)
var depths: texture_multisampled_2d<f32>;

@group(0) @binding(2)
var normals: texture_multisampled_2d<f32>;

const SAMPLES = 4u;

const SAMPLE_OFFSETS = array<vec2f, 4>(vec2f(-0.125, -0.375), vec2f(0.375, -0.125), vec2f(-0.375, 0.125), vec2f(0.125, 0.375));

const BEND = 0.05;

const BEND_AT_EDGES = 0.25;

const ROUNDING = 4.7683716e-7;

const SIDES = 4u;

const NEIGHBOURS = array<vec2i, 8>(vec2i(1, 0), vec2i(-1, 0), vec2i(0, 1), vec2i(0, -1), vec2i(1, 1), vec2i(-1, 1), vec2i(1, -1), vec2i(-1, -1));

fn is_in_picture(pixel: vec2i) -> bool {
    return all(pixel >= vec2i(0)) && all(pixel < vec2i(split.size_px));
}

fn depths_of(pixel: vec2i) -> vec4f {
    let at = split.origin_px + vec2u(pixel);
    return vec4f(textureLoad(depths, at, 0).x, textureLoad(depths, at, 1).x, textureLoad(depths, at, 2).x, textureLoad(depths, at, 3).x);
}

struct Plane {
    depth: f32,
    gradient: vec2f,
    is_one: bool
}

fn rise(gradient: vec2f) -> f32 {
    return abs(gradient.x) + abs(gradient.y);
}

fn plane_of(pixel: vec2i) -> Plane {
    if !is_in_picture(pixel) {
        return Plane(0.0, vec2f(), false);
    }
    let d = depths_of(pixel);
    if any(d == vec4f(split.background_depth)) {
        return Plane(0.0, vec2f(), false);
    }
    let gradient = ((d.w - d.x) * vec2f(0.25, 0.75) + (d.y - d.z) * vec2f(0.75, -0.25)) / 0.625;
    let depth = 0.25 * (d.x + d.y + d.z + d.w);
    let is_one = abs(d.x + d.w - d.y - d.z) <= BEND * rise(gradient) + 4.0 * ROUNDING * depth;
    return Plane(depth, gradient, is_one);
}

fn goes_on(plane: Plane, pixel: vec2i) -> bool {
    var neighbours = NEIGHBOURS;
    var offsets = SAMPLE_OFFSETS;
    let most = BEND * rise(plane.gradient) + 4.0 * ROUNDING * plane.depth;
    for (var i = 0u; i < SIDES; i++) {
        let step = neighbours[i];
        if !is_in_picture(pixel + step) {
            continue;
        }
        let d = depths_of(pixel + step);
        var on_plane = 0u;
        for (var sample = 0u; sample < SAMPLES; sample++) {
            let expected = plane.depth + dot(plane.gradient, vec2f(step) + offsets[sample]);
            on_plane += select(0u, 1u, abs(expected - d[sample]) <= most && d[sample] != split.background_depth);
        }
        if on_plane >= 2u {
            return true;
        }
    }
    return false;
}

struct Surface {
    depth: f32,
    gradient: vec2f,
    sample: u32,
    is_background: bool
}

fn gradients_of(pixel: vec2i, d: vec4f) -> array<vec2f, 4> {
    var neighbours = NEIGHBOURS;
    var offsets = SAMPLE_OFFSETS;
    var gradients = array<vec2f, 4>();
    var least = vec4f(1e20);
    for (var i = 0u; i < 8u; i++) {
        let step = neighbours[i];
        let beside = plane_of(pixel + step);
        if !beside.is_one || !goes_on(beside, pixel + step) {
            continue;
        }
        for (var sample = 0u; sample < SAMPLES; sample++) {
            let miss = abs(beside.depth + dot(beside.gradient, offsets[sample] - vec2f(step)) - d[sample]);
            if miss < least[sample] && miss <= BEND_AT_EDGES * rise(beside.gradient) + 4.0 * ROUNDING * d[sample] {
                least[sample] = miss;
                gradients[sample] = beside.gradient;
            }
        }
    }
    return gradients;
}

fn surface_of(sample: u32, depth: f32, gradient: vec2f) -> Surface {
    if depth == split.background_depth {
        return Surface(depth, vec2f(), sample, true);
    }
    var offsets = SAMPLE_OFFSETS;
    let at_center = depth - dot(gradient, offsets[sample]);
    let is_within = at_center > 0.0 && at_center < 1.0;
    return Surface(select(depth, at_center, is_within), gradient, sample, false);
}

fn is_nearer(a: Surface, b: Surface) -> bool {
    let gap = select(a.depth - b.depth, b.depth - a.depth, split.background_depth > 0.0);
    return !a.is_background && (b.is_background || gap > 0.0);
}

fn are_one(a: Surface, b: Surface) -> bool {
    let bend = BEND_AT_EDGES * min(rise(a.gradient), rise(b.gradient));
    return abs(a.depth - b.depth) <= bend + ROUNDING * max(a.depth, b.depth);
}

fn position_in_world(pixel: vec2f, depth: f32) -> vec3f {
    let ndc = (pixel + 0.5) / vec2f(split.size_px) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = split.view_from_clip * vec4f(ndc, depth, 1.0);
    return (split.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

fn normal_of(surface: Surface, pixel: vec2i) -> vec4f {
    if split.has_normals == 1u {
        return textureLoad(normals, split.origin_px + vec2u(pixel), surface.sample);
    }
    let center = vec2f(pixel);
    let pos = position_in_world(center, surface.depth);
    let right = position_in_world(center + vec2f(0.5, 0.0), surface.depth + 0.5 * surface.gradient.x) - pos;
    let down = position_in_world(center + vec2f(0.0, 0.5), surface.depth + 0.5 * surface.gradient.y) - pos;
    let normal = cross(right, down);
    return vec4f(normal / max(length(normal), 1e-30), 0.0);
}

struct Varyings {
    @builtin(position)
    position: vec4f,
    @location(0) @interpolate(flat)
    is_back: u32
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) is_back: u32) -> Varyings {
    let pos = vec2f(f32((corner << 1u) & 2u), f32(corner & 2u)) * 2.0 - 1.0;
    return Varyings(vec4f(pos, 0.0, 1.0), is_back);
}

struct Picture {
    @location(0)
    depth: f32,
    @location(1)
    normal: vec4f
}

fn background() -> Surface {
    return Surface(split.background_depth, vec2f(), 0u, true);
}

fn shown(pixel: vec2i, is_back: bool) -> Surface {
    let plane = plane_of(pixel);
    if plane.is_one && goes_on(plane, pixel) {
        if is_back {
            return background();
        }
        return Surface(plane.depth, plane.gradient, 0u, false);
    }
    let d = depths_of(pixel);
    var gradients = gradients_of(pixel, d);
    var front = background();
    var back = background();
    for (var sample = 0u; sample < SAMPLES; sample++) {
        let surface = surface_of(sample, d[sample], gradients[sample]);
        if is_nearer(surface, front) {
            front = surface;
        }
        if !surface.is_background && (back.is_background || is_nearer(back, surface)) {
            back = surface;
        }
    }
    if !is_back {
        return front;
    }
    if front.is_background || are_one(front, back) {
        return background();
    }
    return back;
}

@fragment
fn draw(varyings: Varyings) -> Picture {
    let pixel = vec2i(varyings.position.xy);
    let surface = shown(pixel, varyings.is_back == 1u);
    return Picture(surface.depth, normal_of(surface, pixel));
}
