//! Tests: shards equal a single process, also if one is killed; results of different origins are not merged.

use std::fs;
use std::path::PathBuf;

use antumbra::{Quality, TechniqueKind};
use antumbra_scene::{LoadOptions, Setup, load};
use glam::UVec2;

use super::*;
use crate::progress::Silent;
use crate::technique_run::TechniqueChoice;
use crate::test_support::lab_or_skip;

fn plan_in(dir: &Path, samples: u32) -> Plan {
    let scenes = ["overlap", "leaning-plank"].map(|name| {
        let spec = format!("builtin:{name}");
        let scene = load(&spec, &LoadOptions::default()).unwrap();
        PlannedScene::new(&spec, 0.0, false, &scene, &Setup::for_scene(&scene), 0)
    });
    let settings = vec![("map_size".to_owned(), "512".to_owned())];
    let choices = [
        TechniqueChoice::default_of(TechniqueKind::Hard),
        TechniqueChoice::of_quality(TechniqueKind::Pcf, Quality::Fast),
        TechniqueChoice::with_settings(TechniqueKind::Pcss, settings),
    ];
    let plan = Plan::new(scenes.to_vec(), &[UVec2::new(64, 36)], &choices, samples, 1, "sweep".into(), "abc");
    plan.write(dir).unwrap();
    plan
}

/// Returns the errors of all rows, which do not depend on time.
fn errors(merged: &Merged) -> Vec<(Value, Value, Value)> {
    let rows = merged.json["rows"].as_array().unwrap();
    rows.iter().map(|row| (row["scene"].clone(), row["technique"].clone(), row["metrics"].clone())).collect()
}

#[test]
fn shards_merged_are_one_process_to_the_last_digit() {
    let Some(lab) = lab_or_skip() else { return };
    let [whole, first, second] = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let dirs = [whole.path(), first.path(), second.path()];
    let plan = dirs.map(|dir| plan_in(dir, 16))[0].clone();
    assert_eq!(plan.jobs.len(), 6);
    assert_eq!(run_shard(lab, dirs[0], Shard::WHOLE, "abc", &Silent).unwrap(), Done { ran: 6, had: 0 });
    let at_once = merge(&[dirs[0].to_path_buf()]).unwrap();
    assert!(errors(&at_once).iter().all(|(.., metrics)| metrics["rmse"].as_f64().is_some_and(|rmse| rmse > 0.0)));

    let shard = |index| Shard { index, of: 2 };
    run_shard(lab, dirs[1], shard(1), "abc", &Silent).unwrap();
    run_shard(lab, dirs[2], shard(2), "abc", &Silent).unwrap();
    // The second shard was killed: a result is lost, and another is unfinished.
    fs::remove_file(plan.jobs[4].result_path(dirs[2])).unwrap();
    fs::write(dirs[2].join("results/.00004.json.1-0.unfinished"), "{").unwrap();
    let both: Vec<PathBuf> = dirs[1..].iter().map(|dir| dir.to_path_buf()).collect();
    let why = merge(&both).unwrap_err().to_string();
    assert!(why.contains("1 of 6 jobs have no result, the first of them 4"), "{why}");
    assert_eq!(Shard::of_job(4, 6, 2), shard(2));
    assert_eq!(run_shard(lab, dirs[2], shard(2), "abc", &Silent).unwrap(), Done { ran: 1, had: 2 });
    let merged = merge(&both).unwrap();
    assert_eq!((merged.jobs, merged.skipped), (6, 0));
    assert_eq!(errors(&merged), errors(&at_once));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let Some(lab) = lab_or_skip() else { return };
    let [dir, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let plan = plan_in(dir.path(), 4);
    let why = run_shard(lab, dir.path(), Shard::WHOLE, "def", &Silent).unwrap_err().to_string();
    assert!(why.contains("its commit is abc, but this run has def; create a new plan"), "{why}");
    run_shard(lab, dir.path(), Shard::WHOLE, "abc", &Silent).unwrap();

    plan_in(other.path(), 8);
    let both = [dir.path().to_path_buf(), other.path().to_path_buf()];
    let why = merge(&both).unwrap_err().to_string();
    assert!(why.contains("it is a different plan"), "{why}");

    let path = plan.jobs[3].result_path(dir.path());
    let whole = fs::read_to_string(&path).unwrap();
    let refused = |from: &str, to: &str| {
        assert!(whole.contains(from), "{from}: {whole}");
        fs::write(&path, whole.replacen(from, to, 1)).unwrap();
        let why = merge(&both[..1]).unwrap_err().to_string();
        assert!(!why.contains('\n'), "{why}");
        why
    };
    assert!(refused("\"commit\": \"abc\"", "\"commit\": \"def\"").contains("its commit is def"));
    let adapter = format!("\"adapter\": \"{}\"", lab.adapter.name);
    assert!(refused(&adapter, "\"adapter\": \"another\"").contains("its adapter is another"));
    let why = run_shard(lab, dir.path(), Shard::WHOLE, "abc", &Silent).unwrap_err().to_string();
    assert!(why.contains("its results' adapter is another"), "{why}");
    assert!(refused("\n      36\n", "\n      72\n").contains("its size is [64, 72]"));
    assert!(refused("{", "").contains("remove the file"));
}

#[test]
fn folders_without_a_plan_are_told() {
    let dir = tempfile::tempdir().unwrap();
    assert!(merge(&[dir.path().to_path_buf()]).unwrap_err().to_string().contains("no such file"));
    fs::write(dir.path().join(PLAN_NAME), "{}").unwrap();
    assert!(merge(&[dir.path().to_path_buf()]).unwrap_err().to_string().contains("`antumbra sweep plan` wrote"));
}
