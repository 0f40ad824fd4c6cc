// Antialiasing of an image whose masks have one sample per pixel. It finds the source of visibility of each pixel shifted by a
// subpixel offset, and sums the shifted images. It works as in the laboratory, whose NORMALS_COUNT and ALIKE precede this text.

struct Samples {
    // Inverse projection of the image at the pixels' centres.
    view_from_clip: mat4x4f,
    // Inverse projection of the shifted image.
    shifted_view_from_clip: mat4x4f,
    world_from_view: mat4x4f,
    eye_in_world: vec3f,
    // Size of a pixel at a distance of one metre, metres.
    pixel_at_1_m: f32,
    offset_px: vec2f,
    // Weight of the image in the sum.
    weight: f32,
    padding: f32,
}

// Storage instead of uniform buffers: software drivers specialise shaders for uniform values, here for every offset.
@group(0) @binding(0) var<storage, read> samples: Samples;
@group(0) @binding(1) var depth_image: texture_depth_2d;
@group(0) @binding(2) var normal_image: texture_2d<f32>;
@group(0) @binding(3) var shifted_depth_image: texture_depth_2d;
@group(0) @binding(4) var shifted_normal_image: texture_2d<f32>;

// A mask; or the image at the pixels' centres and the shifted image.
@group(1) @binding(0) var values_image: texture_2d<f32>;
@group(1) @binding(1) var shifted_values_image: texture_2d<f32>;

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn position_in_world(view_from_clip: mat4x4f, pixel: vec2i, depth: f32) -> vec3f {
    let size = vec2f(textureDimensions(depth_image));
    let ndc = (vec2f(pixel) + 0.5) / size * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
    let pos_in_view = view_from_clip * vec4f(ndc, depth, 1.0);
    return (samples.world_from_view * vec4f(pos_in_view.xyz / pos_in_view.w, 1.0)).xyz;
}

struct Shown {
    pos_in_world: vec3f,
    normal: vec3f,
    pixel_m: f32,
}

// Returns the distance in pixels between the sample at a pixel and the plane of the shown surface, plus a normal penalty.
fn unlike(shown: Shown, pixel: vec2i, depth: f32) -> f32 {
    let pos_in_world = position_in_world(samples.view_from_clip, pixel, depth);
    let off_plane = abs(dot(pos_in_world - shown.pos_in_world, shown.normal)) / shown.pixel_m;
    return off_plane + NORMALS_COUNT * (1.0 - dot(textureLoad(normal_image, pixel, 0).xyz, shown.normal));
}

struct Source {
    pixel: vec2i,
    // Whether the surface is the one at the pixel's centre.
    is_own: bool,
}

fn source_of(pixel: vec2i) -> Source {
    let own_depth = textureLoad(depth_image, pixel, 0);
    let depth = textureLoad(shifted_depth_image, pixel, 0);
    if depth == 0.0 {
        // Background has no visibility, so any sample is valid.
        return Source(pixel, own_depth == 0.0);
    }
    let pos_in_world = position_in_world(samples.shifted_view_from_clip, pixel, depth);
    let pixel_m = samples.pixel_at_1_m * distance(pos_in_world, samples.eye_in_world);
    let shown = Shown(pos_in_world, textureLoad(shifted_normal_image, pixel, 0).xyz, pixel_m);
    if own_depth > 0.0 && unlike(shown, pixel, own_depth) < ALIKE {
        return Source(pixel, true);
    }
    var best = Source(pixel, false);
    var least = 1e30;
    for (var i = 0; i < 9; i++) {
        let step = vec2i(i % 3 - 1, i / 3 - 1);
        let beside = pixel + step;
        if any(beside < vec2i()) || any(beside >= vec2i(textureDimensions(depth_image))) {
            continue;
        }
        let depth_beside = textureLoad(depth_image, beside, 0);
        if depth_beside == 0.0 {
            continue;
        }
        let off = vec2f(step) - samples.offset_px;
        let cost = dot(off, off) + unlike(shown, beside, depth_beside);
        if cost < least {
            least = cost;
            best.pixel = beside;
        }
    }
    return best;
}

// Returns a mask's values for the shifted image; zero where the centre's colour is used, which skips shading there.
@fragment
fn fragment_gather(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let source = source_of(vec2i(position.xy));
    return select(textureLoad(values_image, source.pixel, 0), vec4f(), source.is_own);
}

// Adds one image to the sum: the centre's colour, noise included, where the surface is the same; else the shifted image's.
@fragment
fn fragment_add(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let centred = textureLoad(values_image, pixel, 0);
    let shifted = textureLoad(shifted_values_image, pixel, 0);
    return samples.weight * select(shifted, centred, source_of(pixel).is_own);
}
