//! Final selection: times the finalists in turns, measures their flicker on request, and chooses one.

use super::bench::FULL;
use super::candidate::candidate;
use super::reasons::reasons;
use super::search::Search;
use super::simplify::{simplest_candidate, simplified};
use super::turns::in_turns;
use super::{Advice, Candidate, Config, Prefer, SearchCost};
use crate::adapter_info::AdapterInfo;
use crate::color_maps::signed_error_map;
use crate::date::utc_now;
use crate::device::LabDevice;
use crate::error::LabError;
use crate::motion::{Motion, MotionOptions, MovingScene};
use crate::technique_run::create;

/// Number of finalists timed in turns at once.
const FINALISTS: usize = 5;
/// Maximum loads of the groups of finalists, in order, by the first timing. Groups are timed until one keeps the budget.
const WITHIN: [f64; 5] = [1.15, 1.15, 1.0, 0.7, 0.45];
/// Maximum error ratio at which a candidate that keeps the budget in every turn is preferred to one that keeps it in most.
const SURE: f64 = 1.05;
/// Error ratio below which a more expensive candidate is a step up.
const STEP_UP: f64 = 0.95;
/// Maximum number of steps up that are timed. One that keeps the budget becomes a finalist, and the next is looked for.
const STEPS_UP: usize = 3;
/// Number of runners-up.
const RUNNERS_UP: usize = 4;
/// Camera motion: frames, metres per frame, and light samples of its ground truth.
const MOTION_FRAMES: u32 = 8;
const MOTION_STEP_M: f32 = 0.05;
const MOTION_SAMPLES: u32 = 256;

/// Chooses among the configurations measured at full size. `pcf_ms` is the first time of `pcf`, by view.
pub(super) fn choose(
    lab: &LabDevice,
    search: &mut Search<'_, '_>,
    pcf_ms: Vec<f64>,
    left_out: usize,
) -> Result<Advice, LabError> {
    let request = search.bench.request;
    look_above(search)?;
    let mut candidates = candidates(search)?;
    let mut finalists = time_finalists(search, &candidates)?;
    time_steps_up(search, &candidates, &mut finalists)?;
    if request.prefer == Prefer::Motion {
        look_in_motion(lab, search, &mut finalists)?;
    }
    let mut best = best_of(search, &finalists);
    let next_step = step_up(search, finalists.iter(), &best);
    let keeps_budget = best.load <= 1.0 && is_within_limits(search, &best);
    let settings = simplified(search, &mut best)?;

    // Finalists carry their latest times, so they replace their earlier entries.
    candidates.retain(|one| finalists.iter().all(|other| other.config != one.config));
    let others: Vec<Candidate> = finalists.iter().chain(&candidates).cloned().collect();
    let runners_up = runners_up(search, &best, &others)?;
    let front = plain_front(search, &best, others)?;
    let (true_picture, picture, error_picture) = pictures(search, &best.config)?;
    let facts = search.bench.facts()?.into_iter().map(|(_, facts)| facts).collect();
    let spent = SearchCost {
        measurements: search.store.rows().count(),
        seconds: search.store.rows().map(|row| row.spent_s).sum(),
        left_out,
    };
    let is_too_noisy_to_tell = keeps_budget && best.highest_load > 1.0;
    let mut advice = Advice {
        scene: request.spec.to_owned(),
        views: request.views.iter().map(|view| view.name.clone()).collect(),
        command: request.command.clone(),
        adapter: AdapterInfo::of(&lab.adapter),
        commit: request.commit.to_owned(),
        date: utc_now(),
        size: request.size_px.to_array(),
        samples: request.samples,
        budget_ms: search.budget_ms.clone(),
        pcf_ms,
        memory_limit_bytes: request.limits.memory_bytes,
        roughness_limit: request.limits.roughness,
        prefer: request.prefer,
        facts,
        best,
        keeps_budget,
        is_too_noisy_to_tell,
        reasons: Vec::new(),
        runners_up,
        next_step,
        front,
        spent,
        true_picture,
        picture,
        error_picture,
    };
    advice.reasons = reasons(&advice, &settings);
    Ok(advice)
}

/// Returns all requested candidates measured at full size, by increasing error.
fn candidates(search: &Search<'_, '_>) -> Result<Vec<Candidate>, LabError> {
    let of = |config: &Config| Some(candidate(config, search.known(config, FULL)?, &search.budget_ms));
    let mut candidates: Vec<Candidate> = search.tried[FULL].iter().filter_map(of).collect();
    // `pcf` is measured for the budget; it is a candidate only if it was requested.
    candidates.retain(|one| search.bench.request.kinds.contains(&one.config.kind));
    if candidates.is_empty() {
        let why = "none of these techniques runs on this adapter; `antumbra doctor` lists what each needs";
        return Err(LabError::Request(why.into()));
    }
    candidates.sort_by(|a, b| a.rmse.total_cmp(&b.rmse));
    Ok(candidates)
}

fn is_within_limits(search: &Search<'_, '_>, one: &Candidate) -> bool {
    search.limits.keep(one.memory_bytes, one.roughness)
}

/// Times candidates in turns, group after group, until one keeps the budget. Groups are in order of error, so every
/// candidate that errs less than the recommendation was timed in turns and found too slow. If no candidate is within any
/// group's load, the nearest one is timed.
fn time_finalists(search: &mut Search<'_, '_>, candidates: &[Candidate]) -> Result<Vec<Candidate>, LabError> {
    let mut finalists: Vec<Candidate> = Vec::new();
    let mut looked_at: Vec<Config> = Vec::new();
    for within in WITHIN {
        let mut group: Vec<Candidate> = Vec::new();
        for one in candidates {
            if group.len() == FINALISTS {
                break;
            }
            if one.load > within || !is_within_limits(search, one) || looked_at.contains(&one.config) {
                continue;
            }
            looked_at.push(one.config.clone());
            let plain = simplest_candidate(search, one)?;
            if finalists.iter().chain(&group).all(|other| other.config != plain.config) {
                group.push(plain);
            }
        }
        if group.is_empty() {
            continue;
        }
        time(search, &mut group)?;
        let is_found = group.iter().any(|one| one.load <= 1.0);
        finalists.extend(group);
        if is_found {
            break;
        }
    }
    if finalists.is_empty() {
        let limits = search.limits;
        let excess = |one: &Candidate| one.load.max(1.0) * limits.excess(one.memory_bytes, one.roughness).max(1.0);
        let nearest = candidates.iter().min_by(|a, b| excess(a).total_cmp(&excess(b))).expect("there are candidates");
        finalists.push(simplest_candidate(search, nearest)?);
        time(search, &mut finalists)?;
    }
    Ok(finalists)
}

/// Times candidates that err clearly less than the best finalist and cost more, also in turns. One that keeps the budget becomes a
/// finalist; otherwise it is the step up.
fn time_steps_up(
    search: &mut Search<'_, '_>,
    candidates: &[Candidate],
    finalists: &mut Vec<Candidate>,
) -> Result<(), LabError> {
    let mut looked_at: Vec<Config> = Vec::new();
    for _ in 0..STEPS_UP {
        let best = best_of(search, finalists);
        let untimed = candidates
            .iter()
            .filter(|one| !looked_at.contains(&one.config) && finalists.iter().all(|other| other.config != one.config));
        let Some(step) = step_up(search, finalists.iter().chain(untimed), &best) else { return Ok(()) };
        if finalists.iter().any(|one| one.config == step.config) {
            return Ok(());
        }
        looked_at.push(step.config.clone());
        let mut timed = [simplest_candidate(search, &step)?];
        if finalists.iter().all(|other| other.config != timed[0].config) {
            time(search, &mut timed)?;
            finalists.extend(timed);
        }
    }
    Ok(())
}

/// Returns the best finalist that keeps the budget, or else the one nearest to it.
fn best_of(search: &Search<'_, '_>, finalists: &[Candidate]) -> Candidate {
    let fitting: Vec<&Candidate> =
        finalists.iter().filter(|one| one.load <= 1.0 && is_within_limits(search, one)).collect();
    let nearest = || finalists.iter().min_by(|a, b| a.load.total_cmp(&b.load));
    surest(&fitting).or_else(nearest).expect("there are finalists").clone()
}

/// Returns the cheapest candidate that errs clearly less than `best` and exceeds the budget.
fn step_up<'c>(
    search: &Search<'_, '_>,
    among: impl Iterator<Item = &'c Candidate>,
    best: &Candidate,
) -> Option<Candidate> {
    let is_step = |one: &&Candidate| {
        one.load > best.load.max(1.0) && is_within_limits(search, one) && one.rmse < STEP_UP * best.rmse
    };
    among.filter(is_step).min_by(|a, b| a.load.total_cmp(&b.load)).cloned()
}

/// Times candidates in turns and stores the times in them.
fn time(search: &Search<'_, '_>, candidates: &mut [Candidate]) -> Result<(), LabError> {
    let configs: Vec<Config> = candidates.iter().map(|one| one.config.clone()).collect();
    let times = in_turns(search, &configs.iter().collect::<Vec<_>>())?;
    for (one, times) in candidates.iter_mut().zip(times) {
        times.give(one, &search.budget_ms);
    }
    Ok(())
}

/// Returns the best candidate of each other technique that keeps the budget.
fn runners_up(search: &mut Search<'_, '_>, best: &Candidate, others: &[Candidate]) -> Result<Vec<Candidate>, LabError> {
    let mut runners_up: Vec<Candidate> = Vec::new();
    for one in others.iter().filter(|one| one.load <= 1.0 && is_within_limits(search, one)) {
        let is_new =
            one.config.kind != best.config.kind && runners_up.iter().all(|other| other.config.kind != one.config.kind);
        if is_new && one.objective() >= best.objective() {
            runners_up.push(one.clone());
        }
    }
    runners_up.sort_by(|a, b| a.objective().total_cmp(&b.objective()));
    runners_up.truncate(RUNNERS_UP);
    // Candidates that were no finalists still have the settings that the search gave them.
    runners_up.iter().map(|one| simplest_candidate(search, one)).collect()
}

/// Returns the Pareto front of error and time, without idle settings, cheapest first.
fn plain_front(
    search: &mut Search<'_, '_>,
    best: &Candidate,
    mut others: Vec<Candidate>,
) -> Result<Vec<Candidate>, LabError> {
    others.push(best.clone());
    let mut plain: Vec<Candidate> = Vec::new();
    for one in front(others) {
        let one = simplest_candidate(search, &one)?;
        if plain.iter().all(|other| other.config != one.config) {
            plain.push(one);
        }
    }
    Ok(front(plain))
}

/// Returns the candidate with the least error, or one nearly as good that keeps the budget in every turn.
fn surest<'c>(fitting: &[&'c Candidate]) -> Option<&'c Candidate> {
    let least = |among: &[&'c Candidate]| among.iter().copied().min_by(|a, b| a.objective().total_cmp(&b.objective()));
    let first = least(fitting)?;
    let sure: Vec<&Candidate> = fitting.iter().copied().filter(|one| one.highest_load <= 1.0).collect();
    Some(least(&sure).filter(|one| one.objective() <= SURE * first.objective()).unwrap_or(first))
}

/// Measures at full size the cheapest configuration that, on smaller images, errs clearly less than those within the budget.
fn look_above(search: &mut Search<'_, '_>) -> Result<(), LabError> {
    for size_index in (0..FULL).rev() {
        let known: Vec<(Config, f64, f64)> = search.tried[size_index]
            .iter()
            .filter_map(|config| {
                let measured = search.known(config, size_index)?;
                Some((config.clone(), measured.error(), search.load(config.kind, size_index, measured)))
            })
            .collect();
        let within = known.iter().filter(|one| one.2 <= 1.0).map(|one| one.1).fold(f64::INFINITY, f64::min);
        let above = |one: &&(Config, f64, f64)| one.2 > 1.05 && one.2 < 4.0 && one.1 < STEP_UP * within;
        if let Some((config, ..)) = known.iter().filter(above).min_by(|a, b| a.2.total_cmp(&b.2)) {
            search.measure(config, FULL)?;
            return Ok(());
        }
    }
    Ok(())
}

/// Measures the finalists' flicker against the ground truth while the camera moves, on every view.
fn look_in_motion(lab: &LabDevice, search: &Search<'_, '_>, finalists: &mut [Candidate]) -> Result<(), LabError> {
    let request = search.bench.request;
    let options = MotionOptions {
        motions: vec![Motion::Camera],
        frames: MOTION_FRAMES,
        step_m: MOTION_STEP_M,
        caster: None,
        path: Vec::new(),
    };
    let mut squares = vec![0.0; finalists.len()];
    for view in &request.views {
        let scene = &request.scenes[view.scene];
        let size_px = search.bench.size_px(FULL - 1);
        let mut moving = MovingScene::new(lab, scene, &view.setup, view.light, size_px, &options)?;
        let truth = moving.trace(Motion::Camera, MOTION_SAMPLES.min(request.samples), search.progress)?;
        search.progress.begin("finalists in motion", finalists.len() as u64);
        for (done, (one, square)) in (1..).zip(finalists.iter().zip(&mut squares)) {
            let figures = moving.run(&truth, &mut create(&lab.gpu(), &one.config.choice())?)?;
            *square += figures.flicker.unwrap_or(0.0).powi(2);
            search.progress.reach(done);
        }
        search.progress.end();
    }
    for (one, square) in finalists.iter_mut().zip(squares) {
        one.flicker = Some((square / request.views.len() as f64).sqrt());
    }
    Ok(())
}

/// Returns the first view shaded with the ground truth and with the recommendation, and its error map.
fn pictures(
    search: &Search<'_, '_>,
    config: &Config,
) -> Result<(image::RgbImage, image::RgbImage, image::RgbImage), LabError> {
    let (truth, mask) = search.bench.masks(config, 0)?;
    let error = signed_error_map(&truth.visibility, &mask, &truth.judged);
    Ok((search.bench.shade(&truth.visibility, 0)?, search.bench.shade(&mask, 0)?, error))
}

/// Returns the Pareto front of error and time, cheapest first.
fn front(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| a.load.total_cmp(&b.load).then(a.rmse.total_cmp(&b.rmse)));
    let mut least = f64::INFINITY;
    candidates.retain(|one| {
        let is_front = one.rmse < least;
        least = least.min(one.rmse);
        is_front
    });
    candidates
}

#[cfg(test)]
mod tests {
    use antumbra::TechniqueKind;

    use super::super::Measured;
    use super::*;

    fn timed(rmse: f64, highest_load: f64) -> Candidate {
        let measured = Measured { rmse: vec![rmse], ms: vec![1.0], spread_ms: vec![[1.0; 2]], ..Measured::default() };
        let one = candidate(&Config::default_of(TechniqueKind::Hard), &measured, &[2.0]);
        Candidate { highest_load, ..one }
    }

    /// A candidate that keeps the budget in every turn is preferred unless its error is much larger.
    #[test]
    fn a_sure_candidate_is_preferred_at_similar_error() {
        let (noisy, near, far) = (timed(0.100, 1.1), timed(0.104, 0.9), timed(0.2, 0.5));
        let chosen = |among: &[&Candidate]| surest(among).map(|one| one.rmse);
        assert_eq!(chosen(&[&noisy, &near, &far]), Some(0.104));
        assert_eq!(chosen(&[&noisy, &far]), Some(0.1));
        assert_eq!(chosen(&[&far, &near]), Some(0.104));
        assert_eq!(chosen(&[]), None);
    }
}
