//! `leadscrew commission`: finds a machine's numbers from what its own drives say.
use crate::args::{CommissionArgs, CommissionOutput, CommissionStep};
use crate::say;
use control::Refused;
use control::config::machine_file::MachineSource;
use leadscrew::Machine;
use leadscrew::commission::{self, AirTaps, Bench, MeasuredValue, Proof, StepResult, StrokeCounts};
use report::{CommissionPage, CommissionPicture, CommissionRow};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Largest factor on what varies.
const MOST_SCATTER: f64 = 4.0;
/// What is commissioned where no step is named.
const ALL: [CommissionStep; 3] =
    [CommissionStep::Axes, CommissionStep::Spindle, CommissionStep::Proof];

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
    let mut results = Vec::new();
    for step in steps {
        match step {
            CommissionStep::Axes => {
                results.push(commission::axes(&bench, StrokeCounts::default())?);
            }
            CommissionStep::Spindle => results.push(commission::spindle(&bench)?),
            CommissionStep::Proof => {}
        }
    }
    let name = &bench.machine.file().name;
    let date = store::state::today();
    let all: Vec<MeasuredValue> =
        results.iter().flat_map(|result| result.findings.iter().cloned()).collect();
    let written = commission::commissioned(&bench.machine, name, &all, &date)?;
    if let Some(path) = &args.write {
        store::output::write_file(path, written.as_bytes())?;
    }
    let proofs = if steps.contains(&CommissionStep::Proof) {
        prove(&bench, &args.machine, written, all.is_empty())?
    } else {
        Vec::new()
    };
    let found = Commissioning { name, seed, date: &date, results: &results, proofs: &proofs };
    if let Some(path) = &args.out {
        let page = report::commission_html(&found.page());
        store::output::write_file(path, page.as_bytes())?;
    }
    say::out(&match args.format {
        CommissionOutput::Text if quiet => String::new(),
        CommissionOutput::Text => found.text(),
        CommissionOutput::Json => format!("{}\n", found.json()),
    })?;
    Ok(found.is_whole())
}

/// Circles and taps before, and after if anything was found.
fn prove(
    bench: &Bench,
    name: &str,
    written: String,
    is_unchanged: bool,
) -> Result<Vec<(&'static str, Proof)>, Refused> {
    let before = bench.prove(&bench.machine)?;
    if is_unchanged {
        return Ok(vec![("as the file is", before)]);
    }
    let source = MachineSource { name: format!("{name}, commissioned"), text: Some(written) };
    let after = bench.prove(&Machine::load(source)?)?;
    Ok(vec![("before", before), ("after", after)])
}

/// Everything that is said.
struct Commissioning<'a> {
    name: &'a str,
    seed: u64,
    date: &'a str,
    results: &'a [StepResult],
    proofs: &'a [(&'static str, Proof)],
}

/// A number with as many digits as its interval is worth.
fn figure(value: f64, half: f64) -> String {
    let digits = 1.0 - half.abs().max(1e-9).log10().floor();
    format!("{value:.*}", digits.clamp(0.0, 7.0) as usize)
}

fn percent(finding: &MeasuredValue) -> String {
    finding.difference().map_or_else(String::new, |share| format!("{:+.1} %", share * 100.0))
}

impl Commissioning<'_> {
    fn is_whole(&self) -> bool {
        self.results.iter().all(StepResult::is_whole)
            && self.proofs.iter().all(|(_, proof)| proof.alarms.is_empty())
    }

    fn text(&self) -> String {
        let Self { name, seed, results, .. } = *self;
        let mut text = format!("{name}, commissioned on the simulator, seed {seed}\n");
        for result in results {
            // writing to a text cannot fail
            let _ = writeln!(text, "\n{}: {:.0} s of machine time", result.step, result.lasts_s);
            let widest =
                result.findings.iter().map(|one| one.name.chars().count()).max().unwrap_or(0);
            for one in &result.findings {
                let (value, half) = (one.value.value, one.value.half);
                let found =
                    format!("{} ± {} {}", figure(value, half), figure(half, half), one.unit);
                let old =
                    one.old.map_or_else(String::new, |old| format!("file {}", figure(old, half)));
                let effect = one.effect_um.map_or_else(String::new, |um| format!("{um:.1} µm"));
                let line = format!(
                    "  {:widest$}  {found:<32} {old:<14} {:>8}  {effect}",
                    one.name,
                    percent(one)
                );
                let _ = writeln!(text, "{}", line.trim_end());
            }
            for moved in &result.moved {
                let _ = writeln!(
                    text,
                    "  {} moved from {:.1} to {:.1} mm (allowed {:.1} to {:.1} mm), \
                     {:.0} % of its peak force at most",
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
        text + &self.proofs.iter().map(|(when, proof)| proof_text(when, proof)).collect::<String>()
    }

    fn json(&self) -> Value {
        let Self { name, seed, results, proofs, .. } = *self;
        let proofs = proofs.iter().map(|(when, proof)| proof_json(when, proof)).collect::<Vec<_>>();
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
            "is_whole": self.is_whole(),
            "proofs": proofs,
            "steps": steps.collect::<Vec<_>>(),
        })
    }

    fn page(&self) -> CommissionPage {
        let Self { name, seed, date, results, proofs } = *self;
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
        let lasts = results.iter().map(|result| result.lasts_s);
        let lasts = lasts.chain(proofs.iter().map(|(_, proof)| proof.lasts_s));
        let minutes = lasts.sum::<f64>() / 60.0;
        let whole = self.is_whole();
        let pictures = results.iter().flat_map(|result| result.pictures.iter().cloned());
        let alarms = proofs.iter().flat_map(|(when, proof)| {
            proof.alarms.iter().map(move |alarm| format!("proof, {when}: {alarm}"))
        });
        CommissionPage {
            title: format!("{name}, commissioned"),
            verdict: (whole, verdict(results, whole)),
            facts: format!(
                "{date}, simulated machine of seed {seed}, {minutes:.1} minutes of machine time. \
                 Intervals are 95 %."
            ),
            rows: rows.collect(),
            notes: results.iter().flat_map(says).chain(alarms).collect(),
            pictures: pictures.chain(circles(proofs)).collect(),
            circles: circle_rows(proofs),
            taps: tap_rows(proofs),
        }
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

fn proof_text(when: &str, proof: &Proof) -> String {
    let mut text = format!("\nproof, {when}: {:.0} s of machine time\n", proof.lasts_s);
    for circle in &proof.circles {
        // writing to a text cannot fail
        let _ = writeln!(
            text,
            "  circle R{:<4} F{:<5} circularity {:>6.1} µm, radial deviation {:+.1} to {:+.1} µm",
            circle.radius_mm,
            circle.feed_mm_per_min,
            circle.circularity_um,
            circle.radial_um[1],
            circle.radial_um[0]
        );
    }
    if let Some(taps) = &proof.taps {
        let _ = writeln!(
            text,
            "  {} taps in air: sync error {:.1} µm at most, {:.1} µm beyond the bottom at most, \
             turning points scatter by {:.2} µm",
            taps.count, taps.sync_error_um, taps.overrun_um, taps.repeats_um
        );
    }
    for alarm in &proof.alarms {
        let _ = writeln!(text, "  ALARM: {alarm}");
    }
    text
}

fn proof_json(when: &str, proof: &Proof) -> Value {
    let circles = proof.circles.iter().map(|circle| {
        json!({
            "radius_mm": circle.radius_mm,
            "feed_mm_per_min": circle.feed_mm_per_min,
            "circularity_um": circle.circularity_um,
            "radial_um": [circle.radial_um[1], circle.radial_um[0]],
        })
    });
    let taps = proof.taps.as_ref().map(|taps| {
        json!({
            "count": taps.count,
            "sync_error_um": taps.sync_error_um,
            "overrun_um": taps.overrun_um,
            "repeats_um": taps.repeats_um,
        })
    });
    json!({
        "when": when,
        "machine_time_s": proof.lasts_s,
        "circles": circles.collect::<Vec<_>>(),
        "taps": taps,
        "alarms": proof.alarms,
    })
}

/// A row a circle: what it is, and its circularity with each file.
fn circle_rows(proofs: &[(&'static str, Proof)]) -> Vec<Vec<String>> {
    let Some((_, first)) = proofs.first() else { return Vec::new() };
    let heads = proofs.iter().map(|(when, _)| format!("circularity {when}, µm"));
    let mut rows = vec![std::iter::once("circle".to_owned()).chain(heads).collect()];
    for (i, circle) in first.circles.iter().enumerate() {
        let what = format!("R{} F{}", circle.radius_mm, circle.feed_mm_per_min);
        let all = proofs.iter().map(|(_, proof)| {
            proof.circles.get(i).map_or_else(String::new, |c| format!("{:.1}", c.circularity_um))
        });
        rows.push(std::iter::once(what).chain(all).collect());
    }
    rows
}

/// What is said of taps, and how it is read.
type TapMeasure = (&'static str, fn(&AirTaps) -> f64);

fn tap_rows(proofs: &[(&'static str, Proof)]) -> Vec<Vec<String>> {
    if proofs.iter().all(|(_, proof)| proof.taps.is_none()) {
        return Vec::new();
    }
    let heads = proofs.iter().map(|(when, _)| format!("{when}, µm"));
    let mut rows = vec![std::iter::once("taps in air".to_owned()).chain(heads).collect()];
    let measures: [TapMeasure; 3] = [
        ("largest sync error", |taps| taps.sync_error_um),
        ("largest way beyond the bottom", |taps| taps.overrun_um),
        ("scatter of the turning points, one deviation", |taps| taps.repeats_um),
    ];
    for (what, of) in measures {
        let all = proofs.iter().map(|(_, proof)| {
            proof.taps.as_ref().map_or_else(String::new, |taps| format!("{:.2}", of(taps)))
        });
        rows.push(std::iter::once(what.to_owned()).chain(all).collect());
    }
    rows
}

/// Circles side by side, magnified: of each radius that of the middle feed.
fn circles(proofs: &[(&'static str, Proof)]) -> Vec<CommissionPicture> {
    let Some((_, first)) = proofs.first() else { return Vec::new() };
    let middle = (0..first.circles.len()).filter(|i| i % 3 == 1);
    let picture = |i: usize| {
        let circle = &first.circles[i];
        CommissionPicture::Circle {
            heading: format!("R{} at F{}", circle.radius_mm, circle.feed_mm_per_min),
            curves: proofs
                .iter()
                .filter_map(|(when, proof)| Some((*when, proof.circles.get(i)?.points.clone())))
                .collect(),
        }
    };
    middle.map(picture).collect()
}
