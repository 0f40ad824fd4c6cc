//! Merging of the shards' results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::plan::{Plan, Shard};
use super::{JobResult, PLAN_NAME, results_in};
use crate::error::LabError;

/// Merged results of a plan.
#[derive(Clone, Debug)]
pub struct Merged {
    /// Results as JSON, in the plan's order.
    pub json: Value,
    /// Number of results.
    pub jobs: usize,
    /// Number of jobs that could not run.
    pub skipped: usize,
}

/// Merges the results of a sweep's folder, or of its copies on several machines.
///
/// # Errors
/// If plans, commits, adapters or sizes differ, a job has two different results, or one has none.
pub fn merge(dirs: &[PathBuf]) -> Result<Merged, LabError> {
    let (plan, fingerprint) = Plan::read(&dirs[0])?;
    let mut results: BTreeMap<usize, (JobResult, &Path)> = BTreeMap::new();
    for dir in dirs {
        let (_, other) = Plan::read(dir)?;
        if other != fingerprint {
            return Err(refuse(&dir.join(PLAN_NAME), "it is a different plan", &dirs[0]));
        }
        for result in results_in(dir)? {
            let path = result.job.result_path(dir);
            check(&plan, &fingerprint, &result).map_err(|why| refuse(&path, &why, &dirs[0]))?;
            if let Some((first, of)) = results.values().next()
                && let Some((what, there, here)) = first.origin.difference(&result.origin)
            {
                return Err(refuse(&path, &format!("its {what} is {there}, but that of others is {here}"), of));
            }
            match results.get(&result.job.id) {
                Some((known, of)) if known.metrics != result.metrics => {
                    return Err(refuse(&path, "another result of the same job has different errors", of));
                }
                Some(_) => {}
                None => {
                    results.insert(result.job.id, (result, dir));
                }
            }
        }
    }
    let missing: Vec<usize> = (0..plan.jobs.len()).filter(|id| !results.contains_key(id)).collect();
    if let Some(first) = missing.first() {
        return Err(LabError::Request(format!(
            "{}: {} of {} jobs have no result, the first of them {first}; run `antumbra sweep run {}` or its shards again",
            dirs[0].display(),
            missing.len(),
            plan.jobs.len(),
            dirs[0].display()
        )));
    }
    let origin = results.values().next().map(|(result, _)| json!(result.origin)).unwrap_or_default();
    let rows: Vec<Value> = results.values().map(|(result, _)| row(&plan, result)).collect();
    Ok(Merged {
        jobs: rows.len(),
        skipped: results.values().filter(|(result, _)| result.skipped.is_some()).count(),
        json: json!({
            "format": "antumbra-sweep-results",
            "version": super::VERSION,
            "origin": origin,
            "command": plan.command,
            "samples": plan.samples,
            "scenes": plan.scenes,
            "rows": rows,
        }),
    })
}

/// Checks that a result belongs to the plan's job. The error is the reason.
fn check(plan: &Plan, fingerprint: &str, result: &JobResult) -> Result<(), String> {
    if result.plan != fingerprint {
        return Err("it belongs to another plan".into());
    }
    let planned = plan.jobs.get(result.job.id).ok_or_else(|| "the plan has no job with its number".to_owned())?;
    if planned.size != result.job.size {
        return Err(format!("its size is {:?}, but the plan has {:?}", result.job.size, planned.size));
    }
    if *planned != result.job {
        return Err("the plan's job with this number is different".into());
    }
    if result.origin.commit != plan.commit {
        return Err(format!("its commit is {}, but the plan has {}", result.origin.commit, plan.commit));
    }
    Ok(())
}

fn refuse(path: &Path, why: &str, beside: &Path) -> LabError {
    LabError::Request(format!(
        "cannot merge {}: {why}; omit it, or run it again in the same way as {}",
        path.display(),
        beside.display()
    ))
}

fn row(plan: &Plan, result: &JobResult) -> Value {
    let JobResult { job, skipped, parameters, metrics, timings, memory_bytes, auto_map_sizes, .. } = result;
    json!({
        "scene": plan.scenes[job.scene].scene,
        "size": job.size,
        "technique": job.technique,
        "settings": job.settings.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>(),
        "skipped": skipped,
        "parameters": parameters,
        "metrics": metrics,
        "timings": timings,
        "memory_bytes": memory_bytes,
        "auto_map_sizes": auto_map_sizes,
    })
}

impl Shard {
    /// Returns the shard, out of `of`, that contains a job.
    pub fn of_job(job: usize, jobs: usize, of: usize) -> Self {
        let index = (1..=of).find(|index| Self { index: *index, of }.range(jobs).contains(&job)).unwrap_or(1);
        Self { index, of }
    }
}
