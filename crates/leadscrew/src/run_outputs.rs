//! What a run leaves behind: the certificate for programs, the report for people.
use crate::{Finished, Job, certificate};
use control::Outcome;
use control::services::supervision;
use report::{Alarm, Limits, Note, Run};
use store::certificate::{Certificate, Clamping, Count, Inputs, Measured, Verdict, sha256};
use store::output::Folder;
use store::solid::{Slice, dxf, radii, stl};
use verify::Feature;

/// The certificate of a run.
pub(crate) fn certificate(finished: &Finished) -> Certificate {
    let Finished { job, outcome, .. } = finished;
    let alarms = outcome.faults.iter().map(|fault| store::certificate::Alarm {
        number: u32::from(fault.kind.number()),
        text: fault.to_string(),
        line: (fault.line > 0).then_some(fault.line),
        time_s: Measured::s(fault.time),
    });
    let zero = job.session.work_zero();
    Certificate {
        leadscrew: env!("CARGO_PKG_VERSION").to_owned(),
        program: job.program.name.clone(),
        machine: job.session.machine.name.clone(),
        seed: finished.seed,
        part: (job.part > 1).then_some(job.part),
        cycle_time_s: Measured::s(outcome.cycle_time),
        ended: outcome.ended,
        verdict: verdict(outcome),
        count: count(&outcome.features),
        material: job.material.name().to_owned(),
        tolerances: tolerances(&finished.tolerances),
        frame: Some(frame(job)),
        inputs: Inputs {
            program_sha256: sha256(&job.program.text),
            machine_sha256: job.session.hashes[0].clone(),
            tools_sha256: job.session.hashes[1].clone(),
        },
        alarms: alarms.collect(),
        invariants: store::certificate::Invariants {
            periods: outcome.watch.periods(),
            violations: outcome.watch.violations(),
            breaches: outcome.watch.breaches().iter().map(ToString::to_string).collect(),
        },
        withdrawals: outcome
            .withdrawn
            .iter()
            .map(|w| store::certificate::Withdrawal {
                line: w.line,
                cut: w.cut.to_owned(),
                axis: w.axis.to_string(),
                by_mm: Measured::mm(w.by),
            })
            .collect(),
        features: outcome
            .features
            .iter()
            .map(|f| {
                let zero = outcome.recorder.zero_of(f.op).unwrap_or(zero);
                let mut feature = certificate::feature(f, &zero);
                if let store::certificate::Feature::Thread(thread) = &mut feature {
                    thread.supervision = certificate::supervision(&outcome.supervised, f.op);
                }
                feature
            })
            .collect(),
    }
}

/// Of the whole run, as its exit code says it.
/// Where the set-up has the workpiece.
fn frame(job: &Job) -> Clamping {
    let zero = job.session.work_zero().linear;
    let own = &job.session.machine.setup.stock;
    let from_zero = |corner: [units::Length; 3]| [0, 1, 2].map(|axis| corner[axis] - zero[axis]);
    let corners = job
        .stated_block()
        .map_or([own.from, own.to], |block| [block.from, block.to].map(from_zero));
    Clamping {
        zero_mm: zero.map(Measured::mm),
        stock_mm: corners.map(|corner| corner.map(Measured::mm)),
    }
}

fn verdict(outcome: &Outcome) -> Verdict {
    let open = |f: &Feature| matches!(f.verdict, verify::Verdict::NotJudged { .. });
    let good = |f: &Feature| f.verdict.is_pass();
    if !outcome.ended || outcome.watch.violations() > 0 {
        Verdict::Fail
    } else if outcome.features.iter().all(good) {
        if outcome.features.is_empty() { Verdict::NotJudged } else { Verdict::Pass }
    } else if outcome.features.iter().all(|f| good(f) || open(f)) {
        Verdict::NotJudged
    } else {
        Verdict::Fail
    }
}

fn count(features: &[Feature]) -> Count {
    let mut count = Count::default();
    for feature in features {
        match feature.verdict {
            verify::Verdict::Pass => count.passed += 1,
            verify::Verdict::Fail { .. } => count.failed += 1,
            verify::Verdict::NotJudged { .. } => count.not_judged += 1,
        }
    }
    count
}

fn tolerances(by: &verify::Tolerances) -> store::certificate::Tolerances {
    store::certificate::Tolerances {
        thread_class: verify::ThreadClass::H6.name().to_owned(),
        hole_depth_um: Measured::um(by.hole_depth),
        position_um: Measured::um(by.position),
        thread_depth_um: Measured::um(by.thread_depth),
        thread_overrun_um: Measured::um(by.thread_overrun),
        turned_thread_um: Measured::um(by.turned_thread),
        cam_contour_um: Measured::um(by.cam_contour),
        facet_flatness_um: Measured::um(by.facet_flatness),
        across_flats_um: Measured::um(by.across_flats),
        tooth_thickness_um: Measured::um(by.tooth_thickness),
        tip_diameter_um: Measured::um(by.tip_diameter),
    }
}

/// Each polygon as a solid and as a cross-section: `polygon-1.stl`, `polygon-1.dxf`.
pub(crate) fn write_solids(folder: &Folder, finished: &Finished) -> Result<(), store::Error> {
    /// Directions in which a solid's radius is stated: half a degree.
    const DIRECTIONS: usize = 720;
    let zero = finished.job.session.work_zero().linear[2];
    let polygons = finished.outcome.features.iter().filter_map(|f| match &f.kind {
        verify::FeatureKind::Polygon(polygon) if polygon.sections.len() > 1 => Some(polygon),
        _ => None, // no other feature has an outline
    });
    for (number, polygon) in (1..).zip(polygons) {
        let mut slices: Vec<Slice> = polygon
            .sections
            .iter()
            .filter_map(|s| Some(Slice { z: s.z - zero, radii: radii(&s.outline(), DIRECTIONS)? }))
            .collect();
        slices.sort_by(|a, b| b.z.value().total_cmp(&a.z.value()));
        let ends = [polygon.z_to - zero, polygon.z_from - zero];
        if let [first, second, .., before, last] = &slices[..] {
            let whole = [beyond(first, second, ends[0]), beyond(last, before, ends[1])];
            let [top, bottom] = whole;
            slices.insert(0, top);
            slices.push(bottom);
        }
        folder.write(&format!("polygon-{number}.stl"), &stl(&slices))?;
        let middle = &polygon.sections[polygon.sections.len() / 2];
        folder.write(&format!("polygon-{number}.dxf"), dxf(&middle.outline()).as_bytes())?;
    }
    Ok(())
}

/// The part goes on to its end as it was measured nearest to it.
fn beyond(nearest: &Slice, next: &Slice, z: units::Length) -> Slice {
    let part = (z - nearest.z) / (nearest.z - next.z);
    let on = |(r, inner): (&units::Length, &units::Length)| *r + (*r - *inner) * part;
    Slice { z, radii: nearest.radii.iter().zip(&next.radii).map(on).collect() }
}

/// The page that a process engineer pins to the job.
pub(crate) fn report(finished: &Finished, motion: Option<report::Motion>) -> String {
    let Finished { job, outcome, .. } = finished;
    let machine = &job.session.machine;
    let spindle = machine.spindles.first();
    let torque =
        spindle.map_or_else(Vec::new, |s| Limits::torque_curve(s.peak_torque, s.peak_power, s.max));
    let run = Run {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        program: job.program.name.clone(),
        machine: machine.name.clone(),
        dialect: job.session.dialect.name().to_owned(),
        material: job.material.name().to_owned(),
        seed: finished.seed,
        tools: job.session.tools.clone(),
        origin: outcome.recorder.origin(),
        cycle_time: outcome.cycle_time,
        ended: outcome.ended,
        alarms: outcome.faults.iter().map(alarm).collect(),
        notes: notes(finished),
        tolerances: finished.tolerances,
        limits: Limits {
            torque,
            sync_warn: machine.tapping.sync_warn,
            sync_stop: machine.tapping.sync_stop,
        },
        limiting: outcome.limiting.clone(),
        stops: outcome.stops.clone(),
        motion,
        listing: job.program.text.clone(),
    };
    report::html(&run, &outcome.recorder, &outcome.features)
}

fn alarm(fault: &kernel::Fault) -> Alarm {
    Alarm {
        number: u32::from(fault.kind.number()),
        text: fault.to_string(),
        remedy: Some(fault.kind.remedy().to_owned()),
        line: fault.line,
        time: fault.time,
    }
}

/// What a reader must know to trust the rest.
pub(crate) fn notes(finished: &Finished) -> Vec<Note> {
    let outcome = &finished.outcome;
    let findings = finished.findings().iter().map(|finding| Note {
        warning: finding.severity == diag::Severity::Warning,
        text: finding.message.clone(),
        line: finding.span.line,
    });
    let assumed = (outcome.assumed_holes > 0).then(|| Note {
        warning: false,
        text: format!(
            "{} tapped but not drilled by this program: taken as drilled with the tap drill, deep enough",
            plural(outcome.assumed_holes, "hole")
        ),
        line: 0,
    });
    findings.chain(assumed).chain(by_the_clock(outcome)).chain(supervised(finished)).collect()
}

/// What supervision by torque saw.
fn supervised(finished: &Finished) -> Vec<Note> {
    let Finished { job, outcome, .. } = finished;
    let taps = outcome.features.iter().any(|f| matches!(f.kind, verify::FeatureKind::Thread(_)));
    let text = supervision::text(&outcome.supervised, &job.session.machine, taps);
    let warning = outcome.supervised.iter().any(|stroke| supervision::is_remarkable(&stroke.seen));
    text.lines().map(|line| Note { warning, text: line.to_owned(), line: 0 }).collect()
}

/// How well a run in real time kept its time.
fn by_the_clock(outcome: &Outcome) -> Option<Note> {
    let figures = outcome.real_time?;
    let ahead = outcome.least_ahead.map_or_else(String::new, |least| {
        format!(
            "; at least {:.0} ms of motion were planned ahead while more was to come",
            least.value() * 1e3
        )
    });
    let ticks = format!(
        "tick {:.1} µs in the median, p99.9 {:.1} µs, worst {:.0} µs",
        figures.tick_median_us, figures.tick_p999_us, figures.tick_worst_us
    );
    let warning = figures.unobserved > 0;
    Some(Note { warning, text: format!("{figures}; {ticks}{ahead}"), line: 0 })
}

/// A count and its noun.
fn plural(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
