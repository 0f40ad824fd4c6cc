//! Schedule of a frame: which lights with masks of an earlier frame are redrawn.
//!
//! A light's rank is the product of the fraction of the image that it may reach, a weight for what has changed, and the number of
//! frames that it has waited. A light for which the first two make twice as much is redrawn about twice as often. Lights that have
//! waited for too long go first, the longest wait before others, so that none waits for ever.

/// Change since a light's mask was drawn; later variants weigh more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// Camera, receivers or settings: the mask's visibility is still correct on the same surfaces.
    View,
    /// The light, or casters in its range.
    Shadows,
    /// There is no mask of the light in this view.
    All,
}

impl Change {
    /// Weight in the rank. Mostly the order of weights matters, because waiting outweighs each in turn.
    fn weight(self) -> f32 {
        match self {
            Self::View => 0.5,
            Self::Shadows => 1.0,
            Self::All => 16.0,
        }
    }
}

/// A light that would be redrawn if there were no budget.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Fraction of the image that the light may reach, 0 to 1.
    pub(super) area: f32,
    pub(super) change: Change,
    /// Number of frames for which the mask was out of date, this one included.
    pub(super) waits: u32,
    /// Part of the budget that redrawing the light takes.
    pub(super) cost: u64,
}

/// Minimum area in the rank, as a fraction of the image, so that small lights are redrawn some time, too.
const MIN_AREA: f32 = 0.01;

/// Number of rounds after which a waiting candidate goes first. A round is the number of frames in which all candidates could be
/// redrawn once.
const MAX_ROUNDS: u64 = 4;

impl Candidate {
    fn rank(&self) -> f32 {
        // The area is NaN if the camera's matrices are; the comparison is then false.
        let area = if self.area > MIN_AREA { self.area } else { MIN_AREA };
        self.change.weight() * area * self.waits as f32
    }
}

/// Returns the indices of the candidates to redraw, in order of priority: at least one, and each further one that fits the budget.
pub(super) fn chosen(candidates: &[Candidate], budget: u64) -> Vec<usize> {
    let all = candidates.iter().fold(0u64, |sum, candidate| sum.saturating_add(candidate.cost));
    let rounds = all.div_ceil(budget.max(1));
    let overdue = |candidate: &Candidate| {
        if u64::from(candidate.waits) > MAX_ROUNDS.saturating_mul(rounds) { candidate.waits } else { 0 }
    };
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|a, b| {
        let [a, b] = [a, b].map(|i| &candidates[*i]);
        overdue(b).cmp(&overdue(a)).then(b.rank().total_cmp(&a.rank()))
    });
    let mut spent = 0u64;
    let mut chosen = Vec::new();
    for i in order {
        let with_this = spent.saturating_add(candidates[i].cost);
        if chosen.is_empty() || with_this <= budget {
            spent = with_this;
            chosen.push(i);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(area: f32, change: Change, waits: u32) -> Candidate {
        Candidate { area, change, waits, cost: 1 }
    }

    #[test]
    fn large_changed_and_waiting_lights_come_first() {
        let small = candidate(0.1, Change::Shadows, 1);
        for first in
            [candidate(0.2, Change::Shadows, 1), candidate(0.1, Change::All, 1), candidate(0.1, Change::Shadows, 2)]
        {
            assert_eq!(chosen(&[small, first, candidate(0.1, Change::View, 1)], 1), [1], "{first:?}");
        }
        assert_eq!(chosen(&[small, candidate(f32::NAN, Change::View, 1)], u64::MAX), [0, 1]);
        assert_eq!(chosen(&[], 3), [0; 0]);
    }

    #[test]
    fn costs_keep_within_the_budget_and_one_light_is_always_drawn() {
        let of = |costs: [u64; 4]| costs.map(|cost| Candidate { cost, ..candidate(0.5, Change::Shadows, 1) });
        assert_eq!(chosen(&of([5, 1, 9, 2]), 8), [0, 1, 3]);
        assert_eq!(chosen(&of([50, 1, 9, 2]), 8), [0]);
        assert_eq!(chosen(&of([u64::MAX, 1, u64::MAX, 2]), u64::MAX - 1), [0]);
        assert_eq!(chosen(&of([u64::MAX, 1, u64::MAX, 2]), u64::MAX), [0, 1, 2, 3]);
    }

    /// Lights that change in every frame are all redrawn again and again, for any areas and costs: after [`MAX_ROUNDS`] rounds
    /// they are overdue, and each frame draws at least the overdue light that has waited longest.
    #[test]
    fn every_changed_light_is_redrawn_eventually() {
        for (count, budget, max_cost) in [(16, 1, 1), (16, 5, 1), (64, 4, 1), (64, 1, 1), (24, 30, 20), (24, 7, 20)] {
            let area = |i: usize| if i == 0 { 1.0 } else { 0.9 / (i * i) as f32 };
            let cost = |i: usize| 1 + i as u64 % max_cost;
            let mut waits = vec![0; count];
            let mut drawn = vec![0; count];
            let all: u64 = (0..count).map(cost).sum();
            let most = (MAX_ROUNDS * all.div_ceil(budget)) as u32 + count as u32;
            for _ in 0..20 * most {
                waits.iter_mut().for_each(|waits| *waits += 1);
                let of = |i: usize| Candidate { cost: cost(i), ..candidate(area(i), Change::Shadows, waits[i]) };
                let chosen = chosen(&(0..count).map(of).collect::<Vec<_>>(), budget);
                let spent: u64 = chosen.iter().map(|i| cost(*i)).sum();
                assert!(spent <= budget || chosen.len() == 1, "{spent} of {budget}");
                for i in chosen {
                    (waits[i], drawn[i]) = (0, drawn[i] + 1);
                }
                assert!(waits.iter().all(|waits| *waits <= most), "{count} lights, {budget}: {waits:?}");
            }
            assert!(drawn.iter().all(|times| *times >= 15), "{count} lights, {budget}: {drawn:?}");
            assert!(drawn[0] >= drawn[count - 1], "{drawn:?}");
        }
    }
}
