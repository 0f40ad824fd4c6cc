//! CPU reference in double precision.

use super::{BIN_COUNT, Relaxation, Teleport};

/// Updates `means` and returns the targets of the splits. `moved_first` advances from call to call.
pub(crate) fn relax(histogram: &[u32], means: &mut [f64], moved_first: u32, how: &Relaxation) -> Vec<f64> {
    let count = means.len();
    let value = |bin: usize| (bin as f64 + 0.5) / f64::from(BIN_COUNT);
    for iteration in 0..how.iterations {
        let sums: Vec<[f64; 3]> = (0..count)
            .map(|i| {
                let low = if i > 0 { 0.5 * (means[i - 1] + means[i]) } else { 0.0 };
                let high = if i + 1 < count { 0.5 * (means[i] + means[i + 1]) } else { 2.0 };
                let own = histogram.iter().enumerate().filter(|(bin, _)| (low..high).contains(&value(*bin)));
                own.fold([0.0; 3], |[w, wx, wxx], (bin, weight)| {
                    let (weight, x) = (f64::from(*weight), value(bin) - 0.5);
                    [w + weight, wx + weight * x, wxx + weight * x * x]
                })
            })
            .collect();
        for (i, [w, wx, _]) in sums.iter().enumerate() {
            let begin = (moved_first + iteration * how.moved_count) as usize % count;
            if *w > 0.0 && (i + count - begin) % count < how.moved_count as usize {
                means[i] = wx / w + 0.5;
            }
        }
        match how.teleport {
            Teleport::Inertia => teleport(means, &sums, f64::from(how.min_gap)),
            Teleport::Weight => teleport_by_weight(means, &sums),
        }
    }
    let gap = f64::from(how.min_gap).min(1.0 / (count as f64 + 1.0));
    let mut least = gap;
    means
        .iter()
        .enumerate()
        .map(|(i, mean)| {
            let split = (mean + f64::from(how.shift)).max(least).min(1.0 - gap * (count - i) as f64);
            least = split + gap;
            split
        })
        .collect()
}

fn inertia([w, wx, wxx]: [f64; 3]) -> f64 {
    if w > 0.0 { (wxx - wx * wx / w).max(0.0) } else { 0.0 }
}

fn teleport_by_weight(means: &mut [f64], sums: &[[f64; 3]]) {
    let heaviest = (0..means.len()).fold(0, |best, i| if sums[i][0] > sums[best][0] { i } else { best });
    let Some(empty) = sums.iter().position(|sum| sum[0] <= 0.0) else { return };
    if sums[heaviest][0] <= 0.0 {
        return;
    }
    let deviation = (inertia(sums[heaviest]) / sums[heaviest][0]).sqrt();
    let center = means[heaviest];
    (means[heaviest], means[empty]) = (center - deviation, center + deviation);
    means.sort_by(f64::total_cmp);
}

fn teleport(means: &mut [f64], sums: &[[f64; 3]], min_gap: f64) {
    let cost = |i: usize| {
        let with = |j: usize| {
            let both = sums[i][0] + sums[j][0];
            if both > 0.0 { sums[i][0] * sums[j][0] / both * (means[i] - means[j]).powi(2) } else { 0.0 }
        };
        let before = if i > 0 { with(i - 1) } else { f64::INFINITY };
        let after = if i + 1 < means.len() { with(i + 1) } else { f64::INFINITY };
        before.min(after)
    };
    let heaviest = (0..means.len()).fold(0, |best, i| if inertia(sums[i]) > inertia(sums[best]) { i } else { best });
    let others = (0..means.len()).filter(|i| *i != heaviest);
    let Some(cheapest) = others.reduce(|best, i| if cost(i) < cost(best) { i } else { best }) else { return };
    let gain = inertia(sums[heaviest]);
    let deviation = (gain / sums[heaviest][0].max(1.0)).sqrt();
    if 0.75 * gain <= 2.0 * cost(cheapest) || 2.0 * deviation < min_gap {
        return;
    }
    let center = means[heaviest];
    (means[heaviest], means[cheapest]) = (center - deviation, center + deviation);
    means.sort_by(f64::total_cmp);
}
