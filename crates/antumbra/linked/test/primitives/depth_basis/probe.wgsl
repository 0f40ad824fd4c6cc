// Linked from src/primitives/depth_basis/probe.wesl by `cargo xtask shaders`: edit that, not this.

const MAX_TERMS = 16u;

struct ProbeInput {
    z: vec4f,
    weights: vec4f,
    t: f32,
    least_variance: f32,
    exponent: f32,
    split: f32,
    moment_bias: f32,
    term_count: u32,
    t_per_texel: vec2f,
    quantum: f32,
    padding_x: f32,
    padding_y: f32,
    padding_z: f32
}

@group(0) @binding(0)
var<storage, read> inputs: array<ProbeInput>;

@group(0) @binding(1)
var<storage, read_write> outputs: array<array<vec2f, 9>>;

@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&inputs) {
        return;
    }
    let input = inputs[id.x];
    let t = input.t;
    let c = vec2f(input.exponent, 0.5 * input.exponent);
    let near = layered_DepthLayer(0.0, input.split);
    let far = layered_DepthLayer(input.split, 1.0);
    let is_far = t >= input.split;
    var variance = vec2f();
    var layer_near = vec2f();
    var layer_far = vec2f();
    var exponential_variance = vec4f();
    var exponential = vec3f();
    var moments = vec4f();
    for (var i = 0u; i < 4u; i++) {
        let z = input.z[i];
        let w = input.weights[i];
        variance += w * variance_encode_variance(z);
        layer_near += w * layered_encode_layered(near, z);
        layer_far += w * layered_encode_layered(far, z);
        exponential_variance += w * exponential_variance_encode_exponential_variance(z, c);
        exponential += w * exponential_encode_exponential_z(z, input.exponent);
        moments += w * moment_quantize_moments(moment_encode_moments(z));
    }
    let variance_v = variance_variance_visibility(variance, t, input.least_variance);
    outputs[id.x][0] = vec2f(variance_v, variance_mean_blocker_depth(variance_mean_variance(variance).mean, t, variance_v));
    var layered_v = layered_layered_visibility(layer_near, near, t, input.least_variance, input.quantum);
    var printed_v = layered_layered_visibility_as_published(layer_near, near, t, input.least_variance, input.quantum);
    var layered_mean = layered_layer_mean_share(layer_near.x, input.split);
    if is_far {
        printed_v = layered_layered_visibility_as_published(layer_far, far, t, input.least_variance, input.quantum);
        layered_v = layered_layered_visibility(layer_far, far, t, input.least_variance, input.quantum);
        layered_mean += layered_layer_mean_share(layer_far.x, 1.0 - input.split);
    }
    outputs[id.x][1] = vec2f(layered_v, variance_mean_blocker_depth(layered_mean, t, layered_v));
    let two_v = exponential_variance_exponential_variance_visibility_2(exponential_variance.xy, t, c.x, input.least_variance);
    outputs[id.x][2] = vec2f(two_v, exponential_variance_exponential_variance_blocker_depth_2(exponential_variance.xy, t, c.x, two_v));
    let four_v = exponential_variance_exponential_variance_visibility_4(exponential_variance, t, c, input.least_variance);
    outputs[id.x][3] = vec2f(four_v, exponential_variance_exponential_variance_blocker_depth(exponential_variance, t, c, four_v));
    outputs[id.x][4] = vec2f(exponential_exponential_visibility(exponential.x, t, input.exponent), exponential_exponential_blocker_depth(exponential, t, input.exponent));
    var term_sum = 0.0;
    var z_term_sum = 0.0;
    for (var k = 1u; k <= min(input.term_count, MAX_TERMS); k++) {
        var term = vec2f();
        var z_term = vec2f();
        for (var i = 0u; i < 4u; i++) {
            let encoded = input.weights[i] * convolution_encode_convolution(input.z[i], k);
            term += encoded;
            z_term += input.z[i] * encoded;
        }
        term_sum += convolution_convolution_term(term, t, k);
        z_term_sum += convolution_convolution_term(z_term, t, k);
    }
    let convolution_v = convolution_convolution_visibility(term_sum);
    outputs[id.x][5] = vec2f(convolution_v, convolution_convolution_blocker_depth(exponential.z, z_term_sum, t, convolution_v));
    let biased = moment_bias_moments(moment_dequantize_moments(moments), input.moment_bias);
    let unbounded = moment_hamburger(biased, 2.0 * t - 1.0);
    outputs[id.x][6] = vec2f(1.0 - unbounded.share, moment_moment_blocker_depth(unbounded, t));
    let bounded = moment_hausdorff(biased, 2.0 * t - 1.0);
    outputs[id.x][7] = vec2f(1.0 - bounded.share, moment_moment_blocker_depth(bounded, t));
    outputs[id.x][8] = vec2f(variance_minimum_variance(input.t_per_texel, input.quantum), printed_v);
}

const convolution_PI = 3.141592653589793;

fn convolution_convolution_frequency(k: u32) -> f32 {
    return (2.0 * f32(k) - 1.0) * convolution_PI;
}

fn convolution_encode_convolution(z: f32, k: u32) -> vec2f {
    let angle = convolution_convolution_frequency(k) * z;
    return vec2f(sin(angle), cos(angle));
}

fn convolution_convolution_term(filtered: vec2f, t: f32, k: u32) -> f32 {
    let c = convolution_convolution_frequency(k);
    return 2.0 / c * (filtered.x * cos(c * t) - filtered.y * sin(c * t));
}

fn convolution_convolution_visibility(term_sum: f32) -> f32 {
    return saturate(0.5 + term_sum);
}

fn convolution_convolution_blocker_depth(mean: f32, z_term_sum: f32, t: f32, visibility: f32) -> f32 {
    return variance_blocker_depth_of_sums(mean, 0.5 * mean + z_term_sum, t, visibility);
}

fn exponential_encode_exponential(z: f32, c: f32) -> f32 {
    return exp(c * (z - 1.0));
}

fn exponential_encode_exponential_z(z: f32, c: f32) -> vec3f {
    let e = exponential_encode_exponential(z, c);
    return vec3f(e, z * e, z);
}

fn exponential_exponential_visibility(filtered: f32, t: f32, c: f32) -> f32 {
    return saturate(filtered * exp(c * (1.0 - t)));
}

fn exponential_exponential_blocker_depth(filtered: vec3f, t: f32, c: f32) -> f32 {
    let from_receiver = exp(c * (1.0 - t));
    let visibility = saturate(filtered.x * from_receiver);
    return variance_blocker_depth_of_sums(filtered.z, filtered.y * from_receiver, t, visibility);
}

fn exponential_variance_warp_exponential(t: f32, c: vec2f) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(exp(c.x * u), -exp(-c.y * u));
}

fn exponential_variance_encode_exponential_variance(t: f32, c: vec2f) -> vec4f {
    let w = exponential_variance_warp_exponential(t, c);
    return vec4f(w.x, w.x * w.x, w.y, w.y * w.y);
}

fn exponential_variance_exponential_bound(moments: vec2f, warped_t: f32, c: f32, least_deviation: f32) -> f32 {
    let least = 2.0 * c * warped_t * least_deviation;
    let variance = max(moments.y - moments.x * moments.x, least * least);
    return variance_chebyshev(moments.x, variance, warped_t);
}

fn exponential_variance_exponential_variance_visibility_2(filtered: vec2f, t: f32, c: f32, least_variance: f32) -> f32 {
    return exponential_variance_exponential_bound(filtered, exponential_variance_warp_exponential(t, vec2f(c, 1.0)).x, c, sqrt(least_variance));
}

fn exponential_variance_exponential_variance_visibility_4(filtered: vec4f, t: f32, c: vec2f, least_variance: f32) -> f32 {
    let w = exponential_variance_warp_exponential(t, c);
    let deviation = sqrt(least_variance);
    return min(exponential_variance_exponential_bound(filtered.xy, w.x, c.x, deviation), exponential_variance_exponential_bound(filtered.zw, w.y, c.y, deviation));
}

fn exponential_variance_exponential_variance_blocker_depth(filtered: vec4f, t: f32, c: vec2f, visibility: f32) -> f32 {
    let blocked = 1.0 - visibility;
    if blocked < 0.0001 {
        return t;
    }
    let w = exponential_variance_warp_exponential(t, c);
    let nearest = exponential_variance_warp_exponential(0.0, c);
    let positive = clamp((filtered.x - visibility * w.x) / blocked, nearest.x, w.x);
    let negative = clamp((filtered.z - visibility * w.y) / blocked, nearest.y, w.y);
    let u = vec2f(log(positive), -log(-negative)) / c;
    return clamp(0.25 * (u.x + u.y) + 0.5, 0.0, t);
}

fn exponential_variance_exponential_variance_blocker_depth_2(filtered: vec2f, t: f32, c: f32, visibility: f32) -> f32 {
    let blocked = 1.0 - visibility;
    if blocked < 0.0001 {
        return t;
    }
    let w = exponential_variance_warp_exponential(t, vec2f(c, 1.0)).x;
    let nearest = exp(-c);
    let positive = clamp((filtered.x - visibility * w) / blocked, nearest, w);
    return clamp(0.5 * log(positive) / c + 0.5, 0.0, t);
}

struct layered_DepthLayer {
    near: f32,
    far: f32
}

fn layered_warp_to_layer(layer: layered_DepthLayer, t: f32) -> f32 {
    return saturate((t - layer.near) / (layer.far - layer.near));
}

fn layered_encode_layered(layer: layered_DepthLayer, t: f32) -> vec2f {
    return variance_encode_variance(layered_warp_to_layer(layer, t));
}

fn layered_layered_visibility(filtered: vec2f, layer: layered_DepthLayer, t: f32, least_variance: f32, quantum: f32) -> f32 {
    let width = layer.far - layer.near;
    let spread = 8.0 * quantum;
    let least = least_variance / (width * width) + spread * spread;
    if width >= 1.0 {
        return variance_variance_visibility(filtered, t, least);
    }
    return variance_bounded_visibility(filtered, layered_warp_to_layer(layer, t), least);
}

fn layered_layered_visibility_as_published(filtered: vec2f, layer: layered_DepthLayer, t: f32, least_variance: f32, quantum: f32) -> f32 {
    let width = layer.far - layer.near;
    let spread = 8.0 * quantum;
    return variance_variance_visibility(filtered, layered_warp_to_layer(layer, t), least_variance / (width * width) + spread * spread);
}

fn layered_layer_mean_share(filtered_mean: f32, width: f32) -> f32 {
    return filtered_mean * width;
}

fn moment_encode_moments(t: f32) -> vec4f {
    let u = 2.0 * t - 1.0;
    let u2 = u * u;
    return vec4f(u, u2, u * u2, u2 * u2);
}

fn moment_quantize_moments(m: vec4f) -> vec4f {
    return vec4f(1.5 * m.x - 2.0 * m.z + 0.5, 4.0 * (m.y - m.w), 0.8660254 * m.x - 0.3849002 * m.z + 0.5, 0.5 * (m.y + m.w));
}

fn moment_dequantize_moments(q: vec4f) -> vec4f {
    let odd = q.xz - 0.5;
    return vec4f(-0.3333333 * odd.x + 1.7320508 * odd.y, 0.125 * q.y + q.w, -0.75 * odd.x + 1.2990381 * odd.y, q.w - 0.125 * q.y);
}

fn moment_bias_moments(m: vec4f, amount: f32) -> vec4f {
    return mix(m, vec4f(0.0, 0.375, 0.0, 0.375), amount);
}

struct moment_Blocked {
    share: f32,
    mean_u: f32
}

fn moment_other_points(m: vec4f, u: f32) -> vec2f {
    let d22 = max(m.y - m.x * m.x, 1e-9);
    let l32_d22 = m.z - m.x * m.y;
    let l32 = l32_d22 / d22;
    let d33 = max(m.w - m.y * m.y - l32 * l32_d22, 1e-9);
    var c = vec3f(1.0, u, u * u);
    c.y -= m.x;
    c.z -= m.y + l32 * c.y;
    c.y /= d22;
    c.z /= d33;
    c.y -= l32 * c.z;
    c.x -= m.x * c.y + m.y * c.z;
    let leading = select(min(c.z, -1e-6), max(c.z, 1e-6), c.z >= 0.0);
    let half = -0.5 * c.y / leading;
    let root = sqrt(max(half * half - c.x / leading, 0.0));
    return vec2f(half - root, half + root);
}

fn moment_product_2(m: vec4f, a: f32, b: f32) -> f32 {
    return m.y - (a + b) * m.x + a * b;
}

fn moment_product_3(m: vec4f, a: f32, b: f32, c: f32) -> f32 {
    return m.z - (a + b + c) * m.y + (a * b + a * c + b * c) * m.x - a * b * c;
}

fn moment_apart(difference: f32) -> f32 {
    return select(min(difference, -1e-6), max(difference, 1e-6), difference >= 0.0);
}

fn moment_hamburger(m: vec4f, u: f32) -> moment_Blocked {
    let x = moment_other_points(m, u);
    var share = 0.0;
    var sum = 0.0;
    if x.x < u {
        let weight = saturate(moment_product_2(m, u, x.y) / moment_apart((x.x - u) * (x.x - x.y)));
        share += weight;
        sum += weight * x.x;
    }
    if x.y < u {
        let weight = saturate(moment_product_2(m, u, x.x) / moment_apart((x.y - u) * (x.y - x.x)));
        share += weight;
        sum += weight * x.y;
    }
    return moment_Blocked(saturate(share), select(u, sum / max(share, 1e-6), share > 1e-6));
}

fn moment_hausdorff(m: vec4f, u: f32) -> moment_Blocked {
    let x = moment_other_points(m, u);
    if all(x >= vec2f(-1.0)) && all(x <= vec2f(1.0)) {
        return moment_hamburger(m, u);
    }
    let numerator = m.w - u * m.z - m.y + u * m.x;
    let y = clamp(numerator / moment_apart(m.z - u * m.y - m.x + u), -1.0, 1.0);
    var share = 0.0;
    var sum = 0.0;
    if u > -1.0 {
        let weight = saturate(moment_product_3(m, 1.0, u, y) / moment_apart(-2.0 * (-1.0 - u) * (-1.0 - y)));
        share += weight;
        sum -= weight;
    }
    if y < u {
        let weight = saturate(moment_product_3(m, -1.0, 1.0, u) / moment_apart((y + 1.0) * (y - 1.0) * (y - u)));
        share += weight;
        sum += weight * y;
    }
    return moment_Blocked(saturate(share), select(u, sum / max(share, 1e-6), share > 1e-6));
}

fn moment_moment_blocker_depth(blocked: moment_Blocked, t: f32) -> f32 {
    return clamp(0.5 * blocked.mean_u + 0.5, 0.0, t);
}

fn variance_encode_variance(t: f32) -> vec2f {
    let u = 2.0 * t - 1.0;
    return vec2f(t, u * u);
}

struct variance_MeanVariance {
    mean: f32,
    variance: f32
}

fn variance_mean_variance(filtered: vec2f) -> variance_MeanVariance {
    let u = 2.0 * filtered.x - 1.0;
    return variance_MeanVariance(filtered.x, max(0.25 * (filtered.y - u * u), 0.0));
}

fn variance_minimum_variance(t_per_texel: vec2f, quantum: f32) -> f32 {
    let spread = 8.0 * quantum;
    return 0.25 * dot(t_per_texel, t_per_texel) + spread * spread;
}

fn variance_chebyshev(mean: f32, variance: f32, t: f32) -> f32 {
    let beyond = t - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    return select(variance / (variance + beyond * beyond), 1.0, variance + beyond * beyond == 0.0);
}

fn variance_variance_visibility(filtered: vec2f, t: f32, least_variance: f32) -> f32 {
    let distribution = variance_mean_variance(filtered);
    return variance_chebyshev(distribution.mean, max(distribution.variance, least_variance), t);
}

fn variance_bounded_visibility(filtered: vec2f, t: f32, least_variance: f32) -> f32 {
    let distribution = variance_mean_variance(filtered);
    let mean = distribution.mean;
    let beyond = t - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    let turn = mean * beyond;
    let variance = clamp(turn, distribution.variance, max(distribution.variance, least_variance));
    if variance <= turn {
        return variance_chebyshev(mean, variance, t);
    }
    return saturate(mean + (mean - mean * mean - variance) / t);
}

fn variance_mean_blocker_depth(mean: f32, t: f32, visibility: f32) -> f32 {
    return variance_blocker_depth_of_sums(mean, visibility * t, t, visibility);
}

fn variance_blocker_depth_of_sums(mean: f32, lit_sum: f32, t: f32, visibility: f32) -> f32 {
    let blocked = 1.0 - visibility;
    if blocked < 0.0001 {
        return t;
    }
    return clamp((mean - lit_sum) / blocked, 0.0, t);
}
