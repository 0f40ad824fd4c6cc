//! The last few: timed in turns, looked at in motion where that is asked for, and one of them chosen.

use antumbra::TechniqueKind;
use antumbra::contract::ParamValue;
use serde_json::{Map, Value};

use super::bench::FULL;
use super::search::Search;
use super::words::reasons;
use super::{Advice, Budget, Candidate, Config, Measured, Prefer, Spent};
use crate::color_maps::signed_error_map;
use crate::device::LabDevice;
use crate::error::LabError;
use crate::motion::{Motion, MotionOptions, MovingScene};
use crate::report::{AdapterInfo, utc_now};
use crate::technique_run::create;

/// So many of those that may keep the budget are timed in turns at once.
const FINALISTS: usize = 5;
/// Group after group until one does: of what took up to such parts of the budget when it was timed once.
const WITHIN: [f64; 5] = [1.15, 1.15, 1.0, 0.7, 0.45];
/// Turns, and frames in each.
const TURNS: usize = 5;
const FRAMES: u32 = 9;
/// What kept the budget in every turn is taken before what did in most, where it errs by no more than so many times as much.
const SURE: f64 = 1.05;
/// A step up errs less by so much.
const STEP_UP: f64 = 0.95;
/// Frames and metres a frame of the camera's motion, and light points of its truth.
const MOTION_FRAMES: u32 = 8;
const MOTION_STEP_M: f32 = 0.05;
const MOTION_SAMPLES: u32 = 256;

/// Chooses among what a search has measured at the full size.
pub(super) fn choose(lab: &LabDevice, search: &mut Search<'_, '_>, left_out: usize) -> Result<Advice, LabError> {
    let request = search.bench.request;
    look_above(search)?;
    let mut candidates: Vec<Candidate> = Vec::new();
    for config in search.tried[FULL].clone() {
        if let Some(measured) = search.known(&config, FULL) {
            candidates.push(candidate(&config, measured, &search.budget_ms));
        }
    }
    // pcf is the measure of budgets, and a candidate only where it was asked for.
    let is_asked = |one: &Candidate| request.kinds.contains(&one.config.kind);
    candidates.retain(is_asked);
    if candidates.is_empty() {
        let why = "none of these techniques runs here; `antumbra doctor` says what each lacks";
        return Err(LabError::Request(why.into()));
    }
    candidates.sort_by(|a, b| a.rmse.total_cmp(&b.rmse));
    plainer(search, &mut candidates)?;
    let has_room = |one: &Candidate| request.memory_bytes.is_none_or(|most| one.memory_bytes <= most);

    // By error: whatever errs less than the recommendation was timed in turns and found too slow.
    let mut finalists: Vec<Candidate> = Vec::new();
    let (mut pcf_ms, mut budget_ms) = (Vec::new(), search.budget_ms.clone());
    for within in WITHIN {
        let is_left = |one: &&Candidate| {
            has_room(one) && one.load <= within && finalists.iter().all(|other| other.config != one.config)
        };
        let mut group: Vec<Candidate> = candidates.iter().filter(is_left).take(FINALISTS).cloned().collect();
        if group.is_empty() {
            continue;
        }
        (pcf_ms, budget_ms) = time_in_turns(search, &mut group)?;
        let is_found = group.iter().any(|one| one.load <= 1.0);
        finalists.extend(group);
        if is_found {
            break;
        }
    }
    if finalists.is_empty() {
        let excess = |one: &Candidate| {
            one.load * request.memory_bytes.map_or(1.0, |most| (one.memory_bytes as f64 / most as f64).max(1.0))
        };
        finalists.extend(candidates.iter().min_by(|a, b| excess(a).total_cmp(&excess(b))).cloned());
        (pcf_ms, budget_ms) = time_in_turns(search, &mut finalists)?;
    }
    if request.prefer == Prefer::Motion {
        look_in_motion(lab, search, &mut finalists)?;
    }
    let keeps = |one: &Candidate| one.load <= 1.0 && has_room(one);
    let best = surest(&finalists.iter().filter(|one| keeps(one)).collect::<Vec<_>>());
    let keeps_budget = best.is_some();
    let best = best.or_else(|| finalists.iter().min_by(|a, b| a.load.total_cmp(&b.load))).expect("there are finalists");
    let best = best.clone();
    let is_too_noisy_to_tell = keeps_budget && best.highest_load > 1.0;

    for timed in &finalists {
        candidates.iter_mut().filter(|one| one.config == timed.config).for_each(|one| *one = timed.clone());
    }
    let mut runners_up: Vec<Candidate> = Vec::new();
    for one in finalists.iter().chain(&candidates) {
        let is_new =
            one.config.kind != best.config.kind && runners_up.iter().all(|other| other.config.kind != one.config.kind);
        if is_new && keeps(one) && one.objective() >= best.objective() {
            runners_up.push(one.clone());
        }
    }
    runners_up.sort_by(|a, b| a.objective().total_cmp(&b.objective()));
    runners_up.truncate(4);
    let next_step = candidates
        .iter()
        .filter(|one| one.load > 1.0 && has_room(one) && one.rmse < STEP_UP * best.rmse)
        .min_by(|a, b| a.load.total_cmp(&b.load))
        .cloned();

    let facts = search.bench.facts()?;
    let settings = what_settings_do(search, &best)?;
    let (true_picture, picture, error_picture) = pictures(search, &best.config)?;
    let spent = Spent {
        measurements: search.store.rows().count(),
        seconds: search.store.rows().map(|row| row.spent_s).sum(),
        left_out,
    };
    let facts: Vec<_> = facts.into_iter().map(|(_, facts)| facts).collect();
    let mut advice = Advice {
        scene: request.spec.to_owned(),
        views: request.views.iter().map(|view| view.name.clone()).collect(),
        command: request.command.clone(),
        adapter: AdapterInfo::of(&lab.adapter),
        commit: request.commit.to_owned(),
        date: utc_now(),
        size: request.size_px.to_array(),
        samples: request.samples,
        budget_ms,
        pcf_ms,
        memory_limit_bytes: request.memory_bytes,
        prefer: request.prefer,
        facts,
        best,
        keeps_budget,
        is_too_noisy_to_tell,
        reasons: Vec::new(),
        runners_up,
        next_step,
        front: front(candidates),
        spent,
        true_picture,
        picture,
        error_picture,
    };
    advice.reasons = reasons(&advice, &settings);
    Ok(advice)
}

/// Of what keeps the budget, what errs least; what surely keeps it, where that is nearly as good.
fn surest<'c>(fitting: &[&'c Candidate]) -> Option<&'c Candidate> {
    let least = |among: &[&'c Candidate]| among.iter().copied().min_by(|a, b| a.objective().total_cmp(&b.objective()));
    let first = least(fitting)?;
    let sure: Vec<&Candidate> = fitting.iter().copied().filter(|one| one.highest_load <= 1.0).collect();
    Some(least(&sure).filter(|one| one.objective() <= SURE * first.objective()).unwrap_or(first))
}

/// Measures at the full size the cheapest of what, on smaller pictures, errs clearly less than what keeps the budget.
fn look_above(search: &mut Search<'_, '_>) -> Result<(), LabError> {
    for rung in (0..FULL).rev() {
        let known: Vec<(Config, f64, f64)> = search.tried[rung]
            .iter()
            .filter_map(|config| {
                let measured = search.known(config, rung)?;
                Some((config.clone(), measured.error(), search.load(config.kind, rung, measured)))
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

/// Of the best that keeps the budget, takes back the settings that neither error nor time gains from, and has the rest among the
/// candidates.
fn plainer(search: &mut Search<'_, '_>, candidates: &mut Vec<Candidate>) -> Result<(), LabError> {
    let Some(best) = candidates.iter().find(|one| one.load <= 1.0).cloned() else { return Ok(()) };
    let settings = what_settings_do(search, &best)?;
    let idle = settings.iter().filter(|setting| setting.error > 0.995 && setting.time > 0.92);
    let plain = idle.fold(best.config.clone(), |config, setting| config.with(setting.key, &setting.default));
    let measured = search.measure(&plain, FULL)?;
    let is_new = candidates.iter().all(|one| one.config != plain);
    if is_new && measured.refused.is_none() && measured.error() < 1.005 * best.rmse {
        candidates.retain(|one| one.config != best.config);
        candidates.insert(0, candidate(&plain, &measured, &search.budget_ms));
    }
    Ok(())
}

fn candidate(config: &Config, measured: &Measured, budget_ms: &[f64]) -> Candidate {
    let choice = config.choice();
    let parameters: Map<String, Value> = choice
        .settings
        .iter()
        .map(|(key, value)| {
            let spec = config.kind.param_specs().iter().find(|spec| spec.key == key);
            let is_text = spec.is_none_or(|spec| matches!(spec.default, ParamValue::Choice(_) | ParamValue::List(_)));
            let number = serde_json::from_str(value).ok().filter(|_| !is_text);
            (key.clone(), number.unwrap_or_else(|| Value::String(value.clone())))
        })
        .collect();
    Candidate {
        name: config.to_string(),
        technique: config.kind.name(),
        parameters,
        rmse: measured.error(),
        rmse_of_views: measured.rmse.clone(),
        ms: measured.ms.clone(),
        spread_ms: measured.spread_ms.clone(),
        load: measured.load(budget_ms),
        highest_load: measured.load(budget_ms),
        memory_bytes: measured.memory_bytes,
        flicker: None,
        config: config.clone(),
    }
}

/// Times finalists and `pcf` one after the other, several times over. Gives `pcf`'s times and the budget, by view.
fn time_in_turns(search: &mut Search<'_, '_>, finalists: &mut [Candidate]) -> Result<(Vec<f64>, Vec<f64>), LabError> {
    let pcf = Config::default_of(TechniqueKind::Pcf);
    let configs: Vec<Config> = std::iter::once(&pcf).chain(finalists.iter().map(|one| &one.config)).cloned().collect();
    let mut turns: Vec<Vec<Vec<f64>>> = vec![Vec::new(); configs.len()];
    search.progress.begin("timing the last few in turns", (TURNS * configs.len()) as u64);
    for turn in 0..TURNS {
        for (i, config) in configs.iter().enumerate() {
            turns[i].push(search.bench.measure_frames(config, FULL, FRAMES)?.ms);
            search.progress.reach((turn * configs.len() + i + 1) as u64);
        }
    }
    search.progress.end();
    let views = search.bench.request.views.len();
    let of_view = |times: &[Vec<f64>], view: usize| {
        let mut times: Vec<f64> = times.iter().filter_map(|turn| turn.get(view).copied()).collect();
        times.sort_by(f64::total_cmp);
        times
    };
    let median = |times: &[f64]| times.get(times.len() / 2).copied().unwrap_or(0.0);
    let pcf_ms: Vec<f64> = (0..views).map(|view| median(&of_view(&turns[0], view))).collect();
    let budget_ms = match search.bench.request.budget {
        Budget::Ms(ms) => vec![ms; views],
        Budget::TimesPcf(times) => pcf_ms.iter().map(|ms| times * ms).collect(),
    };
    for (one, times) in finalists.iter_mut().zip(&turns[1..]) {
        for view in 0..views {
            let times = of_view(times, view);
            if let (Some(first), Some(last)) = (times.first(), times.last()) {
                (one.ms[view], one.spread_ms[view]) = (median(&times), [*first, *last]);
            }
        }
        // Turn by turn, where the budget is counted in `pcf`'s time: both were taken when the machine was as fast.
        let load_in = |turn: usize, view: usize| {
            let budget = match search.bench.request.budget {
                Budget::Ms(ms) => ms,
                Budget::TimesPcf(times_pcf) => times_pcf * turns[0][turn].get(view).copied().unwrap_or(f64::INFINITY),
            };
            times[turn].get(view).map_or(f64::INFINITY, |ms| ms / budget)
        };
        let of_view = |view: usize| {
            let mut loads: Vec<f64> = (0..TURNS).map(|turn| load_in(turn, view)).collect();
            loads.sort_by(f64::total_cmp);
            (median(&loads), loads[TURNS - 1])
        };
        one.load = (0..views).map(|view| of_view(view).0).fold(0.0, f64::max);
        one.highest_load = (0..views).map(|view| of_view(view).1).fold(0.0, f64::max);
    }
    Ok((pcf_ms, budget_ms))
}

/// Holds finalists against the truth while the camera moves, on every view.
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
        search.progress.begin("the last few in motion", finalists.len() as u64);
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

/// What each setting of the recommendation does here: key, value, default, and error and time against the default's.
pub(super) struct Setting {
    pub(super) key: &'static str,
    pub(super) value: String,
    pub(super) default: String,
    /// The recommendation's error over that with the default.
    pub(super) error: f64,
    /// And its time.
    pub(super) time: f64,
}

fn what_settings_do(search: &mut Search<'_, '_>, best: &Candidate) -> Result<Vec<Setting>, LabError> {
    let here = search.measure(&best.config, FULL)?;
    let mut settings = Vec::new();
    for (key, value) in &best.config.settings {
        let Some(spec) = best.config.kind.param_specs().iter().find(|spec| spec.key == *key) else { continue };
        let default = spec.default.to_string();
        let other = search.measure(&best.config.with(key, &default), FULL)?;
        if other.refused.is_none() {
            let sum = |measured: &Measured| measured.ms.iter().sum::<f64>();
            let (error, time) = (here.error() / other.error().max(1e-9), sum(&here) / sum(&other).max(1e-9));
            settings.push(Setting { key, value: value.clone(), default, error, time });
        }
    }
    Ok(settings)
}

/// The first view by truth and by the recommendation, and the error.
fn pictures(
    search: &Search<'_, '_>,
    config: &Config,
) -> Result<(image::RgbImage, image::RgbImage, image::RgbImage), LabError> {
    let (truth, mask) = search.bench.masks(config, 0)?;
    let error = signed_error_map(&truth.visibility, &mask, &truth.judged);
    Ok((search.bench.shade(&truth.visibility, 0)?, search.bench.shade(&mask, 0)?, error))
}

/// Those that none beats in both error and time, the cheapest first.
fn front(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| a.worst_ms().total_cmp(&b.worst_ms()).then(a.rmse.total_cmp(&b.rmse)));
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
    use super::*;

    fn timed(rmse: f64, highest_load: f64) -> Candidate {
        let measured = Measured { rmse: vec![rmse], ms: vec![1.0], spread_ms: vec![[1.0; 2]], ..Measured::default() };
        let one = candidate(&Config::default_of(TechniqueKind::Hard), &measured, &[2.0]);
        Candidate { highest_load, ..one }
    }

    /// What keeps the budget in every turn goes before what does in most, but not at any price.
    #[test]
    fn what_surely_fits_is_taken_where_it_is_nearly_as_good() {
        let (noisy, near, far) = (timed(0.100, 1.1), timed(0.104, 0.9), timed(0.2, 0.5));
        let chosen = |among: &[&Candidate]| surest(among).map(|one| one.rmse);
        assert_eq!(chosen(&[&noisy, &near, &far]), Some(0.104));
        assert_eq!(chosen(&[&noisy, &far]), Some(0.1));
        assert_eq!(chosen(&[&far, &near]), Some(0.104));
        assert_eq!(chosen(&[]), None);
    }
}
