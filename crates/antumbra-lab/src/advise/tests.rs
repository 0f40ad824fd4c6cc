//! Tests of the whole search on small images.

use antumbra_scene::{LoadOptions, load};

use super::bench::FULL;
use super::*;
use crate::progress::Silent;
use crate::test_support::lab_or_skip;

pub(super) fn request<'a>(scene: &'a str, kinds: &'a [TechniqueKind], budget: Budget) -> AdviseRequest<'a> {
    let loaded = load(scene, &LoadOptions::default()).unwrap();
    let setup = Setup::for_scene(&loaded);
    AdviseRequest {
        spec: scene,
        scenes: vec![loaded],
        views: vec![AdviseView { name: "this view".into(), scene: 0, setup, light: 0 }],
        size_px: UVec2::new(64, 36),
        samples: 64,
        kinds,
        budget,
        limits: Limits::default(),
        prefer: Prefer::Still,
        exhaustive: false,
        command: "antumbra advise".into(),
        scene_arguments: scene.into(),
        commit: "abc",
    }
}

#[test]
fn limits_are_kept_where_nothing_exceeds_its_own() {
    let limits = Limits { memory_bytes: Some(100), roughness: Some(0.01) };
    assert!(limits.keep(100, 0.01) && !limits.keep(101, 0.0) && !limits.keep(0, 0.011));
    assert_eq!((limits.excess(300, 0.02), limits.excess(100, 0.05)), (3.0, 5.0));
    assert!(Limits::default().keep(u64::MAX, 1.0));
}

/// Checks that an advice is consistent: times, budget and loads agree, and its figures support its reasons.
#[track_caller]
fn holds_together(advice: &Advice) {
    let all = std::iter::once(&advice.best).chain(&advice.runners_up).chain(&advice.next_step).chain(&advice.front);
    for one in all.clone() {
        let loads = |ms: &mut dyn Iterator<Item = f64>| {
            ms.zip(&advice.budget_ms).map(|(ms, budget)| ms / budget).fold(0.0, f64::max)
        };
        assert_eq!(one.load, loads(&mut one.ms.iter().copied()), "{one:?}");
        assert_eq!(one.load, one.worst_ms() / advice.budget_ms[one.heaviest_view], "{one:?}");
        assert_eq!(one.highest_load, loads(&mut one.spread_ms.iter().map(|[_, most]| *most)), "{one:?}");
        let [low, high] = one.worst_spread_ms();
        assert!(low <= one.worst_ms() && one.worst_ms() <= high, "{one:?}");
        // Times exclude warm-up frames, and each states its number of frames.
        assert!(one.turns >= 1 && one.count.frames >= 1 && one.count.warm_up >= 1, "{one:?}");
        assert!(one.counted().contains(&one.count.frames.to_string()) || one.count.frames == 1, "{}", one.counted());
        // Name and parameters match the configuration.
        assert_eq!((&one.name, one.parameters.len()), (&one.config.to_string(), one.config.settings.len()));
    }
    let best = &advice.best;
    assert!(best.turns > 1, "a recommendation rests on times that were taken in turns: {best:?}");
    assert!(!advice.keeps_budget || best.load <= 1.0, "{best:?}");
    assert!(advice.next_step.as_ref().is_none_or(|step| step.load > 1.0 && step.turns > 1 && step.rmse < best.rmse));
    assert!(advice.runners_up.iter().all(|one| one.load <= 1.0));
    for reason in &advice.reasons {
        let is_borne_out = match reason {
            Reason::OverBudget => !advice.keeps_budget,
            Reason::TooNoisyToTell { low_ms, high_ms } => {
                [*low_ms, *high_ms] == best.worst_spread_ms() && best.highest_load > 1.0
            }
            Reason::NextBest { name, errs, best_errs } => {
                let next = &advice.runners_up[0];
                (name, *errs, *best_errs) == (&next.name, next.objective(), best.objective()) && errs > best_errs
            }
            Reason::Pays { key, value, default, error, time } => {
                let is_set = best.config.settings.iter().any(|(set, to)| set == key && to == value);
                is_set && value != default && (error.is_some() || time.is_some())
            }
            _ => advice.facts.iter().any(|facts| facts.penumbra.is_some()),
        };
        assert!(is_borne_out, "{reason:?} of {best:?}");
    }
}

#[test]
fn the_least_error_within_the_budget_wins_and_work_goes_on_from_its_file() {
    let Some(lab) = lab_or_skip() else { return };
    let dir = tempfile::tempdir().unwrap();
    let kinds = [TechniqueKind::Hard, TechniqueKind::Pcf];
    let request = request("builtin:leaning-plank", &kinds, Budget::TimesPcf(4.0));
    let advice = advise(lab, &request, Some(dir.path()), &Silent).unwrap();
    assert!(advice.runners_up.iter().all(|one| one.rmse >= advice.best.rmse && one.technique != advice.best.technique));
    holds_together(&advice);
    assert!(advice.reasons.iter().any(|reason| reason.to_string().contains("penumbra")), "{:?}", advice.reasons);
    assert!(advice.spent.measurements > 10 && advice.facts[0].penumbra.is_some());

    // Known measurements are not repeated.
    let mut store = Store::open(Some(dir.path()), about(lab, &request)).unwrap();
    assert_eq!(store.rows().count(), advice.spent.measurements);
    let bench = Bench::new(lab, &request, &Silent).unwrap();
    let mut search = Search::new(&bench, &mut store, &Silent, vec![f64::INFINITY], Limits::default());
    let known = search.measure(&advice.best.config, FULL).unwrap();
    assert_eq!((search.store.fresh(), known.error()), (0, advice.best.rmse));
    // Repeated measurements have the same errors.
    assert_eq!(bench.measure(&advice.best.config, FULL).unwrap().error(), advice.best.rmse);

    let other = AdviseRequest { samples: 32, ..request };
    let why = advise(lab, &other, Some(dir.path()), &Silent).unwrap_err().to_string();
    assert!(why.contains("its samples is 64, but this run has 32; name another folder"), "{why}");

    let page_dir = tempfile::tempdir().unwrap();
    let preset = crate::report::write_advice(page_dir.path(), &advice).unwrap();
    assert_eq!(crate::preset::read_preset(&preset).unwrap().kind, advice.best.config.kind);
    let html = std::fs::read_to_string(page_dir.path().join("index.html")).unwrap();
    let program = format!("let mut shadow = TechniqueKind::{:?}.create(&amp;gpu)?;", advice.best.config.kind);
    for part in ["class=\"scatter\"", "images/advice.png", "penumbra: ", "technique = &quot;", &program] {
        assert!(html.contains(part), "{part}");
    }
}

/// If nothing keeps a budget of a thousandth of a millisecond, the nearest is named, with the fact that it exceeds the budget.
#[test]
fn an_impossible_budget_is_reported() {
    let Some(lab) = lab_or_skip() else { return };
    let kinds = [TechniqueKind::Hard];
    let advice = advise(lab, &request("builtin:overlap", &kinds, Budget::Ms(1e-3)), None, &Silent).unwrap();
    holds_together(&advice);
    assert!(!advice.keeps_budget && advice.reasons[0] == Reason::OverBudget, "{:?}", advice.reasons);
}

/// A technique beyond the roughness limit is not recommended, whatever its error and time.
#[test]
fn what_is_too_rough_is_not_taken() {
    let Some(lab) = lab_or_skip() else { return };
    let kinds = [TechniqueKind::Hard, TechniqueKind::Pcf];
    let request = request("builtin:overlap", &kinds, Budget::Ms(1e4));
    let free = advise(lab, &request, None, &Silent).unwrap();
    let limited = |roughness| {
        let limits = Limits { roughness: Some(roughness), ..Limits::default() };
        advise(lab, &AdviseRequest { limits, ..request.clone() }, None, &Silent).unwrap()
    };
    assert!(free.keeps_budget && free.best.roughness > 0.0);
    let smoother = limited(0.9 * free.best.roughness);
    assert_eq!(smoother.keeps_budget, smoother.best.roughness <= 0.9 * free.best.roughness, "{:?}", smoother.best);
    let none = limited(1e-9);
    assert!(!none.keeps_budget && none.reasons[0] == Reason::OverBudget, "{:?}", none.reasons);
}

/// With ample time, the search is about as good as a grid.
#[test]
fn the_search_keeps_up_with_a_grid() {
    let Some(lab) = lab_or_skip() else { return };
    let kinds = [TechniqueKind::Hard];
    let searched = request("builtin:overlap", &kinds, Budget::Ms(1e3));
    let grid = AdviseRequest { exhaustive: true, ..request("builtin:overlap", &kinds, Budget::Ms(1e3)) };
    let [searched, grid] = [searched, grid].map(|request| advise(lab, &request, None, &Silent).unwrap());
    assert!(searched.best.rmse <= 1.1 * grid.best.rmse, "{} against {}", searched.best.rmse, grid.best.rmse);
}

#[test]
fn an_advice_for_two_views_holds_for_both() {
    let Some(lab) = lab_or_skip() else { return };
    let kinds = [TechniqueKind::Hard];
    let mut request = request("builtin:overlap", &kinds, Budget::TimesPcf(1.5));
    let mut second = request.views[0].clone();
    second.setup.camera.eye.x += 1.0;
    request.views.push(second);
    request.prefer = Prefer::Motion;
    let advice = advise(lab, &request, None, &Silent).unwrap();
    holds_together(&advice);
    assert_eq!((advice.best.ms.len(), advice.best.rmse_of_views.len(), advice.facts.len()), (2, 2, 2));
    let flicker = advice.best.flicker.unwrap();
    assert!(flicker > 0.0 && advice.best.objective() > advice.best.rmse);
}
