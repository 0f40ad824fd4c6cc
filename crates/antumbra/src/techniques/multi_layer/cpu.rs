//! CPU reference of the filter, for one channel.

use super::levels::Level;
use crate::light_map::texel_lists::cpu::ReferenceFragment;
use crate::light_map::texel_lists::options::DepthTolerance;

/// Returns one level's lists, merged from the lists `before`. Opacities in one list are accumulated by their overlap; depths
/// are averaged by opacity or by count.
pub(crate) fn filter(
    before: &Level,
    lists: &[Vec<ReferenceFragment>],
    level: &Level,
    epsilon: DepthTolerance,
    by_count: bool,
) -> Vec<Vec<ReferenceFragment>> {
    let step = level.step.expect("not the base");
    let child = |x: u32, y: u32, k: usize| -> &[ReferenceFragment] {
        let place = |texel: u32, far: bool, size: u32| {
            let at = i64::from(step.stride * texel) + i64::from(if far { step.far } else { step.near });
            u32::try_from(at).ok().filter(|at| *at < size)
        };
        match (place(x, k & 1 == 1, before.size.x), place(y, k & 2 == 2, before.size.y)) {
            (Some(x), Some(y)) => &lists[(y * before.size.x + x) as usize],
            _ => &[],
        }
    };
    (0..level.size.y)
        .flat_map(|y| (0..level.size.x).map(move |x| (x, y)))
        .map(|(x, y)| {
            if step.subsample {
                child(x, y, (((x ^ y) & 1) + 2 * (y & 1)) as usize).to_vec()
            } else {
                merge([0, 1, 2, 3].map(|k| child(x, y, k)), epsilon, level.z_limit_m, by_count)
            }
        })
        .collect()
}

/// Returns the combined opacity of two fragments; `overlap` is the farther one's.
pub(crate) fn accumulated(nearer: f32, farther: f32, overlap: f32) -> f32 {
    // Rounding may put the lower bound above the upper one.
    let common = (overlap * nearer * farther).max(nearer + farther - 1.0).max(0.0);
    nearer + farther - common.min(nearer).min(farther)
}

/// Merges four lists as in figure 3, up to the depth limit of lookups.
pub(crate) fn merge(
    mut lists: [&[ReferenceFragment]; 4],
    epsilon: DepthTolerance,
    z_limit_m: f32,
    by_count: bool,
) -> Vec<ReferenceFragment> {
    let mut merged = Vec::new();
    let mut transmittances = [1.0_f32; 4];
    while let Some(nearest) =
        lists.iter().filter_map(|list| list.first()).map(|fragment| fragment.z_m).min_by(f32::total_cmp)
    {
        if nearest >= z_limit_m {
            break;
        }
        let limit = nearest + epsilon.slope * nearest + epsilon.m;
        let (mut z_sum, mut weight, mut opacity) = (0.0, 0.0, 0.0);
        let before = 0.25 * transmittances.iter().sum::<f32>();
        for (list, transmittance) in lists.iter_mut().zip(&mut transmittances) {
            let mut taken = 0.0_f32;
            while let Some((first, rest)) = list.split_first().filter(|(first, _)| first.z_m <= limit) {
                taken = accumulated(taken, first.opacity, first.overlap);
                let unhidden = (1.0 - first.overlap * (1.0 - *transmittance)).clamp(0.0, 1.0);
                *transmittance = (*transmittance - first.opacity * unhidden).max(0.0);
                let share = if by_count { 1.0 } else { first.opacity };
                z_sum += share * first.z_m;
                weight += share;
                *list = rest;
            }
            opacity += 0.25 * taken;
        }
        let after = 0.25 * transmittances.iter().sum::<f32>();
        let behind = 1.0 - ((before - after) / opacity).clamp(0.0, 1.0);
        let overlap = if before < 1.0 { behind / (1.0 - before) } else { 1.0 };
        merged.push(ReferenceFragment { z_m: z_sum / weight, opacity, overlap });
    }
    merged
}
