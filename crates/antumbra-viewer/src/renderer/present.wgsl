// The window's image: each pixel shows its side of the divider, in the selected view.

struct Present {
    // Diverging colour map over ±error_range, from the most negative error to the most positive; sRGB.
    ramp: array<vec4f, 11>,
    // Colour of pixels that are not judged.
    not_judged: vec4f,
    // First column of the right side.
    divider_px: u32,
    show: u32,
    // Bit 0: the left side's mask is tinted; bit 1: the right side's.
    tinted: u32,
    error_range: f32,
}

const SHADED = 0u;
const VISIBILITY = 1u;
const ERROR = 2u;
const TRUTH = 3u;

@group(0) @binding(0) var<uniform> present: Present;
@group(0) @binding(1) var left_picture: texture_2d<f32>;
@group(0) @binding(2) var right_picture: texture_2d<f32>;
@group(0) @binding(3) var left_mask: texture_2d<f32>;
@group(0) @binding(4) var right_mask: texture_2d<f32>;
// Traced visibility; below zero where pixels are not judged.
@group(0) @binding(5) var truth: texture_2d<f32>;

@vertex
fn vertex_screen(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Converts linear values to sRGB (IEC 61966-2-1).
fn srgb_from_linear(linear: vec3f) -> vec3f {
    let v = saturate(linear);
    return select(1.055 * pow(v, vec3f(1.0 / 2.4)) - 0.055, 12.92 * v, v <= vec3f(0.0031308));
}

fn load(image: texture_2d<f32>, pixel: vec2u) -> vec4f {
    return textureLoad(image, min(pixel, textureDimensions(image) - 1u), 0);
}

fn error_color(error: f32) -> vec3f {
    let place = saturate(0.5 + 0.5 * error / present.error_range) * 10.0;
    let below = min(u32(place), 9u);
    return mix(present.ramp[below].rgb, present.ramp[below + 1u].rgb, place - f32(below));
}

@fragment
fn fragment_present(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let is_right = pixel.x >= present.divider_px;
    var picture = load(left_picture, pixel);
    var visibility = load(left_mask, pixel).rgb;
    if is_right {
        picture = load(right_picture, pixel);
        visibility = load(right_mask, pixel).rgb;
    }
    let is_tinted = ((present.tinted >> u32(is_right)) & 1u) == 1u;
    visibility = select(visibility.rrr, visibility, is_tinted);
    let traced = load(truth, pixel).r;
    switch present.show {
        // Values are linear grey levels: visibility 0.5 is half of white.
        case VISIBILITY: {
            return vec4f(visibility, 1.0);
        }
        case ERROR: {
            let error = dot(visibility, vec3f(1.0 / 3.0)) - traced;
            return select(vec4f(error_color(error), 1.0), present.not_judged, traced < 0.0);
        }
        case TRUTH: {
            return select(vec4f(vec3f(traced), 1.0), present.not_judged, traced < 0.0);
        }
        default: {
            return vec4f(srgb_from_linear(picture.rgb), 1.0);
        }
    }
}
