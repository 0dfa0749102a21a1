//! `leadscrew commission`: finds a machine's numbers from what its own drives say.
use crate::args::{CommissionArgs, CommissionOutput, CommissionStep};
use crate::say;
use control::Refused;
use leadscrew::Machine;
use leadscrew::commission::{self, Bench, Effort, Finding, Picture, StepResult};
use report::{CommissionPage, CommissionPicture, CommissionRow};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Largest factor on what varies.
const MOST_SCATTER: f64 = 4.0;
/// What is commissioned where no step is named.
const ALL: [CommissionStep; 2] = [CommissionStep::Axes, CommissionStep::Spindle];

/// Commissions a machine; false: something could not be judged, or an alarm ended a step.
pub(crate) fn command(args: &CommissionArgs, quiet: bool) -> Result<bool, Refused> {
    if !(0.0..=MOST_SCATTER).contains(&args.scatter) {
        return Err(Refused::because(format!(
            "--scatter {}: expected 0 to {MOST_SCATTER}",
            args.scatter
        )));
    }
    let machine = Machine::load(&args.machine)?;
    let seed = args.seed.unwrap_or(u64::from(machine.file().simulation.seed));
    let plant = args.plant.as_ref().map(Into::into);
    let bench = Bench { machine, plant, scatter: args.scatter, seed };
    let steps = if args.steps.is_empty() { &ALL[..] } else { &args.steps[..] };
    let results = steps.iter().map(|step| match step {
        CommissionStep::Axes => commission::axes(&bench, Effort::default()),
        CommissionStep::Spindle => commission::spindle(&bench),
    });
    let results = results.collect::<Result<Vec<_>, _>>()?;
    let name = &bench.machine.file().name;
    let date = store::state::today();
    if let Some(path) = &args.write {
        let all: Vec<Finding> =
            results.iter().flat_map(|result| result.findings.iter().cloned()).collect();
        let text = commission::commissioned(&bench.machine, name, &all, &date)?;
        store::output::write_file(path, text.as_bytes())?;
    }
    if let Some(path) = &args.out {
        let page = report::commission_html(&page(name, seed, &date, &results));
        store::output::write_file(path, page.as_bytes())?;
    }
    say::out(&match args.format {
        CommissionOutput::Text if quiet => String::new(),
        CommissionOutput::Text => text(name, seed, &results),
        CommissionOutput::Json => format!("{}\n", as_json(name, seed, &results)),
    })?;
    Ok(results.iter().all(StepResult::is_whole))
}

/// A number with as many digits as its interval is worth.
fn figure(value: f64, half: f64) -> String {
    let digits = 1.0 - half.abs().max(1e-9).log10().floor();
    format!("{value:.*}", digits.clamp(0.0, 7.0) as usize)
}

fn percent(finding: &Finding) -> String {
    finding.difference().map_or_else(String::new, |share| format!("{:+.1} %", share * 100.0))
}

fn text(name: &str, seed: u64, results: &[StepResult]) -> String {
    let mut text = format!("{name}, commissioned on the simulator, seed {seed}\n");
    for result in results {
        // writing to a text cannot fail
        let _ = writeln!(text, "\n{}: {:.0} s of machine time", result.step, result.lasts_s);
        let widest = result.findings.iter().map(|one| one.name.chars().count()).max().unwrap_or(0);
        for one in &result.findings {
            let (value, half) = (one.value.value, one.value.half);
            let found = format!("{} ± {} {}", figure(value, half), figure(half, half), one.unit);
            let old = one.old.map_or_else(String::new, |old| format!("file {old:.5}"));
            let effect = one.effect_um.map_or_else(String::new, |um| format!("{um:.1} µm"));
            let line = format!(
                "  {:widest$}  {found:<26}{old:<16}{:>9}  {effect}",
                one.name,
                percent(one)
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
        for moved in &result.moved {
            let _ = writeln!(
                text,
                "  {} moved from {:.1} to {:.1} mm (allowed {:.1} to {:.1} mm), {:.0} % of its peak force at most",
                moved.letter,
                moved.from_mm,
                moved.to_mm,
                moved.window.from,
                moved.window.to,
                moved.force_share * 100.0
            );
        }
        for says in &result.not_judged {
            let _ = writeln!(text, "  not judged: {says}");
        }
        for says in &result.alarms {
            let _ = writeln!(text, "  ALARM: {says}");
        }
    }
    text
}

fn as_json(name: &str, seed: u64, results: &[StepResult]) -> Value {
    let steps = results.iter().map(|result| {
        let findings = result.findings.iter().map(|one| {
            json!({
                "name": one.name,
                "key": if one.key.is_empty() { Value::Null } else { json!(one.key) },
                "value": one.value.value,
                "half_95": one.value.half,
                "unit": one.unit,
                "old": one.old,
                "effect_um": one.effect_um,
                "effect_of": one.effect_of,
                "by": one.by,
            })
        });
        let moved = result.moved.iter().map(|moved| {
            json!({
                "axis": moved.letter.to_string(),
                "from_mm": moved.from_mm,
                "to_mm": moved.to_mm,
                "window_mm": [moved.window.from, moved.window.to],
                "force_share": moved.force_share,
                "following_error_um": moved.following_um,
            })
        });
        json!({
            "step": result.step,
            "machine_time_s": result.lasts_s,
            "findings": findings.collect::<Vec<_>>(),
            "moved": moved.collect::<Vec<_>>(),
            "not_judged": result.not_judged,
            "alarms": result.alarms,
        })
    });
    json!({
        "machine": name,
        "seed": seed,
        "is_whole": results.iter().all(StepResult::is_whole),
        "steps": steps.collect::<Vec<_>>(),
    })
}

fn page(name: &str, seed: u64, date: &str, results: &[StepResult]) -> CommissionPage {
    let rows = results.iter().flat_map(|result| &result.findings).map(|one| CommissionRow {
        name: one.name.clone(),
        key: one.key.clone(),
        value: format!(
            "{} ± {}",
            figure(one.value.value, one.value.half),
            figure(one.value.half, one.value.half)
        ),
        unit: one.unit,
        old: one.old.map_or_else(String::new, |old| figure(old, one.value.half)),
        difference: percent(one),
        effect: one.effect_um.map_or_else(String::new, |um| format!("{um:.1}")),
        effect_of: one.effect_of,
    });
    let says = |result: &StepResult| {
        let judged = result.not_judged.iter().map(|says| format!("not judged: {says}"));
        let alarms = result.alarms.iter().map(|says| format!("alarm: {says}"));
        judged.chain(alarms).collect::<Vec<_>>()
    };
    let minutes = results.iter().map(|result| result.lasts_s).sum::<f64>() / 60.0;
    let whole = results.iter().all(StepResult::is_whole);
    CommissionPage {
        title: format!("{name}, commissioned"),
        verdict: (whole, verdict(results, whole)),
        facts: format!(
            "{date}, simulated machine of seed {seed}, {minutes:.1} minutes of machine time. Intervals are 95 %."
        ),
        rows: rows.collect(),
        notes: results.iter().flat_map(says).collect(),
        pictures: results.iter().flat_map(|result| &result.pictures).map(picture).collect(),
    }
}

/// What differs most.
fn verdict(results: &[StepResult], whole: bool) -> String {
    let all = results.iter().flat_map(|result| &result.findings);
    let largest = all
        .filter_map(|one| Some((one.effect_um?, one)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(um, one)| {
            format!(
                "; what the file was wrong in most: {}, {um:.1} µm ({})",
                one.name, one.effect_of
            )
        });
    let what = if whole { "every value was found" } else { "not all could be judged" };
    format!("{what}{}", largest.unwrap_or_default())
}

fn picture(picture: &Picture) -> CommissionPicture {
    match picture {
        Picture::Friction { letter, measured, fitted, file } => CommissionPicture::Friction {
            letter: *letter,
            measured: measured.clone(),
            fitted: fitted.clone(),
            file: file.clone(),
        },
        Picture::Ramp { name, speed, commanded } => CommissionPicture::Ramp {
            name: name.clone(),
            speed: speed.clone(),
            commanded: commanded.clone(),
        },
    }
}
