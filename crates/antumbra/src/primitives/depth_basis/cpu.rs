//! CPU references in double precision. A distribution is a list of (depth, weight).

use std::f64::consts::PI;

/// Distribution of depths: (depth, weight).
pub(crate) type Depths<'a> = &'a [(f64, f64)];

/// Mean of the encoded depths.
fn mean<const N: usize>(depths: Depths<'_>, encode: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    depths.iter().fold([0.0; N], |sum, (z, weight)| {
        let encoded = encode(*z);
        std::array::from_fn(|i| sum[i] + weight * encoded[i])
    })
}

/// Result of decoding a texel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decoded {
    pub(crate) visibility: f64,
    pub(crate) blocker_depth: f64,
}

fn chebyshev(mean: f64, variance: f64, t: f64) -> f64 {
    let beyond = t - mean;
    if beyond <= 0.0 || variance + beyond * beyond == 0.0 { 1.0 } else { variance / (variance + beyond * beyond) }
}

/// Upper bound on the lit fraction for depths in [0, 1].
pub(crate) fn bounded(mean: f64, variance: f64, least_variance: f64, t: f64) -> f64 {
    let beyond = t - mean;
    if beyond <= 0.0 {
        return 1.0;
    }
    let turn = mean * beyond;
    let variance = turn.clamp(variance, variance.max(least_variance));
    if variance <= turn {
        chebyshev(mean, variance, t)
    } else {
        (mean + (mean - mean * mean - variance) / t).clamp(0.0, 1.0)
    }
}

fn blocker_depth(mean: f64, lit_sum: f64, t: f64, visibility: f64) -> f64 {
    let blocked = 1.0 - visibility;
    if blocked < 1e-4 { t } else { ((mean - lit_sum) / blocked).clamp(0.0, t) }
}

pub(crate) fn encode_variance(t: f64) -> [f64; 2] {
    let u = 2.0 * t - 1.0;
    [t, u * u]
}

fn mean_variance([first, second]: [f64; 2]) -> (f64, f64) {
    let u = 2.0 * first - 1.0;
    (first, (0.25 * (second - u * u)).max(0.0))
}

/// Minimum variance: half a plane's step per texel and eight storage steps are deviations whose variances add.
pub(crate) fn minimum_variance(t_per_texel: [f64; 2], quantum: f64) -> f64 {
    let step = t_per_texel[0].hypot(t_per_texel[1]);
    (0.5 * step).powi(2) + (8.0 * quantum).powi(2)
}

pub(crate) fn variance(depths: Depths<'_>, t: f64, least_variance: f64) -> Decoded {
    let (mean, variance) = mean_variance(mean(depths, encode_variance));
    let visibility = chebyshev(mean, variance.max(least_variance), t);
    Decoded { visibility, blocker_depth: blocker_depth(mean, visibility * t, t, visibility) }
}

/// Encodes a depth clamped to `[near, far]` by eq. 6 of Lauritzen and McCool 2008.
pub(crate) fn encode_layered(t: f64, near: f64, far: f64) -> [f64; 2] {
    encode_variance(((t - near) / (far - near)).clamp(0.0, 1.0))
}

/// Decodes layers without overlap between `splits`, which start with 0 and end with 1.
pub(crate) fn layered(depths: Depths<'_>, t: f64, splits: &[f64], least_variance: f64) -> Decoded {
    layered_of_step(depths, t, splits, least_variance, 0.0)
}

/// Decodes layers with a storage step of `quantum`.
pub(crate) fn layered_of_step(
    depths: Depths<'_>,
    t: f64,
    splits: &[f64],
    least_variance: f64,
    quantum: f64,
) -> Decoded {
    let own = splits.windows(2).rposition(|s| t >= s[0]).unwrap_or(0);
    let mut visibility = 1.0;
    let mut mean_depth = 0.0;
    for s in splits.windows(2).take(own + 1) {
        let width = s[1] - s[0];
        let (mean, variance) = mean_variance(mean(depths, |z| encode_layered(z, s[0], s[1])));
        let [warped_t, _] = encode_layered(t, s[0], s[1]);
        let least = least_variance / (width * width) + minimum_variance([0.0; 2], quantum);
        visibility = if width == 1.0 {
            chebyshev(mean, variance.max(least), t)
        } else {
            bounded(mean, variance, least, warped_t)
        };
        mean_depth += mean * width;
    }
    Decoded { visibility, blocker_depth: blocker_depth(mean_depth, visibility * t, t, visibility) }
}

/// Visibility of the receiver's layer as published: eq. 3 with the minimum variance of eq. 7.
pub(crate) fn layered_as_published(
    depths: Depths<'_>,
    t: f64,
    splits: &[f64],
    least_variance: f64,
    quantum: f64,
) -> f64 {
    let own = splits.windows(2).rfind(|s| t >= s[0]).unwrap_or(&splits[..2]);
    let width = own[1] - own[0];
    let (mean, variance) = mean_variance(mean(depths, |z| encode_layered(z, own[0], own[1])));
    let [warped_t, _] = encode_layered(t, own[0], own[1]);
    let least = least_variance / (width * width) + minimum_variance([0.0; 2], quantum);
    chebyshev(mean, variance.max(least), warped_t)
}

/// Moments of both warps.
pub(crate) fn encode_exponential_variance(t: f64, c: [f64; 2]) -> [f64; 4] {
    let [a, b] = warp_exponential(t, c);
    [a, a * a, b, b * b]
}

fn warp_exponential(t: f64, [positive, negative]: [f64; 2]) -> [f64; 2] {
    let u = 2.0 * t - 1.0;
    [(positive * u).exp(), -(-negative * u).exp()]
}

/// Decodes two components, then four.
pub(crate) fn exponential_variance(depths: Depths<'_>, t: f64, c: [f64; 2], least_variance: f64) -> [Decoded; 2] {
    let filtered = mean(depths, |z| encode_exponential_variance(z, c));
    let w = warp_exponential(t, c);
    let nearest = warp_exponential(0.0, c);
    let bound = |i: usize| {
        let (first, second) = (filtered[2 * i], filtered[2 * i + 1]);
        let least = 2.0 * c[i] * w[i] * least_variance.sqrt();
        chebyshev(first, (second - first * first).max(least * least), w[i])
    };
    let u_of = |i: usize, visibility: f64| {
        let warped = ((filtered[2 * i] - visibility * w[i]) / (1.0 - visibility)).clamp(nearest[i], w[i]);
        if i == 0 { warped.ln() / c[0] } else { -(-warped).ln() / c[1] }
    };
    let depth = |visibility: f64, u: &dyn Fn() -> f64| {
        if 1.0 - visibility < 1e-4 { t } else { (0.5 * u() + 0.5).clamp(0.0, t) }
    };
    let (two, four) = (bound(0), bound(0).min(bound(1)));
    [
        Decoded { visibility: two, blocker_depth: depth(two, &|| u_of(0, two)) },
        Decoded { visibility: four, blocker_depth: depth(four, &|| 0.5 * (u_of(0, four) + u_of(1, four))) },
    ]
}

pub(crate) fn encode_exponential(t: f64, c: f64) -> f64 {
    (c * (t - 1.0)).exp()
}

pub(crate) fn exponential(depths: Depths<'_>, t: f64, c: f64) -> Decoded {
    let [e, ze, z] = mean(depths, |z| {
        let e = encode_exponential(z, c);
        [e, z * e, z]
    });
    let from_receiver = (c * (1.0 - t)).exp();
    let visibility = (e * from_receiver).clamp(0.0, 1.0);
    Decoded { visibility, blocker_depth: blocker_depth(z, ze * from_receiver, t, visibility) }
}

/// (sin, cos) of term k = 1, 2, …
pub(crate) fn encode_convolution(t: f64, k: u32) -> [f64; 2] {
    let (sin, cos) = ((2.0 * f64::from(k) - 1.0) * PI * t).sin_cos();
    [sin, cos]
}

pub(crate) fn convolution(depths: Depths<'_>, t: f64, term_count: u32) -> Decoded {
    let (mut sum, mut z_sum) = (0.5, 0.0);
    let [mean_depth] = mean(depths, |z| [z]);
    for k in 1..=term_count {
        let c = (2.0 * f64::from(k) - 1.0) * PI;
        let [sin, cos, z_sin, z_cos] = mean(depths, |z| {
            let [sin, cos] = encode_convolution(z, k);
            [sin, cos, z * sin, z * cos]
        });
        sum += 2.0 / c * (sin * (c * t).cos() - cos * (c * t).sin());
        z_sum += 2.0 / c * (z_sin * (c * t).cos() - z_cos * (c * t).sin());
    }
    let visibility = sum.clamp(0.0, 1.0);
    Decoded { visibility, blocker_depth: blocker_depth(mean_depth, 0.5 * mean_depth + z_sum, t, visibility) }
}

pub(crate) fn encode_moments(t: f64) -> [f64; 4] {
    let u = 2.0 * t - 1.0;
    [u, u * u, u * u * u, u * u * u * u]
}

pub(crate) fn quantize_moments(m: [f64; 4]) -> [f64; 4] {
    let root = 3f64.sqrt();
    [
        1.5 * m[0] - 2.0 * m[2] + 0.5,
        4.0 * (m[1] - m[3]),
        0.5 * root * m[0] - 2.0 * root / 9.0 * m[2] + 0.5,
        0.5 * (m[1] + m[3]),
    ]
}

/// Decodes by Hamburger's bound, then by Hausdorff's.
pub(crate) fn moment(depths: Depths<'_>, t: f64, bias: f64) -> [Decoded; 2] {
    let towards = [0.0, 0.375, 0.0, 0.375];
    let m = mean(depths, encode_moments);
    let m: [f64; 4] = std::array::from_fn(|i| m[i] + bias * (towards[i] - m[i]));
    let u = 2.0 * t - 1.0;
    let x = other_points(m, u);
    let whole_line = points_in_front(m, &[u, x[0], x[1]], u);
    let inside = x.iter().all(|x| (-1.0..=1.0).contains(x));
    let interval = if inside {
        whole_line
    } else {
        let y = ((m[3] - u * m[2] - m[1] + u * m[0]) / apart(m[2] - u * m[1] - m[0] + u)).clamp(-1.0, 1.0);
        points_in_front(m, &[u, -1.0, 1.0, y], u)
    };
    [whole_line, interval]
        .map(|(share, mean_u)| Decoded { visibility: 1.0 - share, blocker_depth: (0.5 * mean_u + 0.5).clamp(0.0, t) })
}

fn apart(difference: f64) -> f64 {
    if difference >= 0.0 { difference.max(1e-6) } else { difference.min(-1e-6) }
}

/// Roots of the determinant of the Hankel matrix bordered by (1, u, u²) and (1, x, x²), by Cramer's rule.
fn other_points(m: [f64; 4], u: f64) -> [f64; 2] {
    let b = glam::DMat3::from_cols_array(&[1.0, m[0], m[1], m[0], m[1], m[2], m[1], m[2], m[3]]);
    let c = b.inverse() * glam::DVec3::new(1.0, u, u * u);
    let leading = if c.z >= 0.0 { c.z.max(1e-6) } else { c.z.min(-1e-6) };
    let half = -0.5 * c.y / leading;
    let root = (half * half - c.x / leading).max(0.0).sqrt();
    [half - root, half + root]
}

/// Total weight and mean of the points in front of `u`; each weight is the mean of its Lagrange polynomial.
fn points_in_front(m: [f64; 4], points: &[f64], u: f64) -> (f64, f64) {
    let (mut share, mut sum) = (0.0, 0.0);
    for (i, x) in points.iter().enumerate().filter(|(_, x)| **x < u) {
        // Coefficients of Π (z − x_j), lowest first.
        let mut polynomial = vec![1.0];
        let mut scale = 1.0;
        for (_, other) in points.iter().enumerate().filter(|(j, _)| *j != i) {
            let mut next = vec![0.0; polynomial.len() + 1];
            for (k, coefficient) in polynomial.iter().enumerate() {
                next[k + 1] += coefficient;
                next[k] -= other * coefficient;
            }
            polynomial = next;
            scale *= x - other;
        }
        let moments = [1.0, m[0], m[1], m[2], m[3]];
        let expected: f64 = polynomial.iter().zip(moments).map(|(c, m)| c * m).sum();
        let weight = (expected / apart(scale)).clamp(0.0, 1.0);
        share += weight;
        sum += weight * x;
    }
    (share.clamp(0.0, 1.0), if share > 1e-6 { sum / share } else { u })
}
