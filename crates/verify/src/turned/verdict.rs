//! What is wrong with a turned thread, gravest first, and what cannot be judged of it.
use super::feature::TurnedThread;
use super::inspection::Inspected;
use super::law::Law;
use super::size::TurnedLimits;
use super::sizes::TurnedSizes;
use crate::Config;
use crate::insert::Side;
use crate::verdict::Verdict;
use canon::Axis;
use units::Length;

/// Ordered length that may be left uncut or not be full, in pitches: the threads that bar's end and
/// run-out cut.
pub(super) const UNCUT_PITCHES: f64 = 1.5;
/// Turns that a full thread needs to be measured: one, and one at each end that is left out.
const FEWEST_TURNS: f64 = 3.0;
/// The diameter of a limit is met to this: the sections' grid.
const NEAR: Length = Length::um(1.0);
/// Width of the Go gauge's crest, in pitches: outside, and inside (ISO 1502, basic profile of ISO
/// 68-1).
const GO_CREST: [f64; 2] = [0.25, 0.125];

/// Everything that is wrong; else what makes the thread one that cannot be judged.
pub(super) fn of(
    found: &TurnedThread,
    law: Option<&Law<'_>>,
    inspected: Option<&Inspected>,
    config: &Config,
) -> Verdict {
    let complete = found.passes >= found.passes_ordered;
    if let Some(reason) = law.and_then(Law::has_no_geometry) {
        return Verdict::NotJudged { reason };
    }
    let contact = inspected
        .filter(|_| law.is_some_and(|law| law.axis() == Axis::Z))
        .and_then(|bar| contact(found, bar));
    let mut findings: Vec<String> = contact.iter().cloned().collect();
    if !complete {
        findings.push(format!(
            "{} of {} passes were cut to their end",
            found.passes, found.passes_ordered
        ));
    }
    findings.extend(helix(found, config));
    if complete
        && contact.is_none()
        && let Some(bar) = inspected
    {
        findings.extend(bar.overlap.clone());
        findings.extend(place(found, bar));
        findings.extend(form(found, bar));
    }
    let is_its_own = law.is_some_and(Law::varies) && inspected.is_some();
    let unjudged = Some(&found.not_judged).filter(|why| !why.is_empty() && !is_its_own);
    match (findings.is_empty(), unjudged) {
        (true, Some(reason)) => {
            let run_in = left_out(found).map_or_else(String::new, |said| format!("; {said}"));
            Verdict::NotJudged { reason: format!("{reason}{run_in}") }
        }
        _ => Verdict::from_findings(&findings),
    }
}

/// Why its sizes are not judged; `None`: they are.
pub(super) fn not_judged(law: Option<&Law<'_>>, inspected: Option<&Inspected>) -> Option<String> {
    let Some(law) = law else { return Some("nothing was ordered".into()) };
    if law.axis() != Axis::Z {
        return Some("not judged: a thread in a face has no limits of size".into());
    }
    let Some(bar) = inspected else {
        return Some("not judged: the stock of the machine file is no bar about the spindle's axis (x and y from −r to r), or the record is too long".into());
    };
    let lead = law.main().lead().abs();
    let pitch = lead / f64::from(bar.starts);
    if law.varies() {
        return Some("sizes not judged: no standard has limits for a lead that is not the same everywhere; contact, lead and infeed are judged".into());
    }
    if !law.is_straight() {
        return Some("not judged: a taper; limits are known of straight threads".into());
    }
    if !bar.form.has_60_degrees() {
        return Some(format!(
            "not judged: the insert has {:.0}°, limits are known of threads of 60°",
            bar.form.half_angle().in_deg() * 2.0
        ));
    }
    if bar.standard.is_none() {
        let what = if bar.side == Side::External { "bar" } else { "bore" };
        return Some(format!(
            "not judged: ISO 261 and ASME B1.1 have no thread with a pitch of {pitch:.3} mm for a {what} of ⌀{:.3} mm",
            bar.before.value()
        ));
    }
    bar.sizes.is_none().then(|| "not judged: less than two turns of full thread".into())
}

/// Nothing or not everything was cut.
fn contact(found: &TurnedThread, bar: &Inspected) -> Option<String> {
    let (deepest, before) = (bar.contact.deepest, bar.before.value());
    let what = if bar.side == Side::External { "bar" } else { "bore" };
    if bar.contact.touched == 0 {
        return Some(if deepest.is_finite() {
            format!(
                "not cut: the insert passed the {what} of ⌀{before:.3} mm at a distance of {:.3} mm",
                (-deepest).max(0.0)
            )
        } else {
            format!("not cut: the insert never was where the {what} of ⌀{before:.3} mm is")
        });
    }
    // in a relief groove it is in the air by intent
    let relief = bar.relief[0] + bar.relief[1];
    let uncut = (1.0 - bar.contact.share()) * (bar.expected.value() + relief) - relief;
    (uncut > UNCUT_PITCHES * found.lead.value()).then(|| {
        format!(
            "not cut in {uncut:.2} of {:.2} mm: there the insert was in the air",
            bar.expected.value()
        )
    })
}

fn helix(found: &TurnedThread, config: &Config) -> Vec<String> {
    let mut findings = Vec::new();
    let tolerances = &config.tolerances;
    let mut off = |what: &str, has: Length, may: Length| {
        if has > may {
            findings.push(format!("{what} {:.1} µm, {:.1} allowed", has.in_um(), may.in_um()));
        }
    };
    off("distance from the helix", found.sync_error_max, tolerances.turned_thread);
    off("lead error over the thread's length", found.lead_error.abs(), tolerances.turned_thread);
    off("passes beside one another by", found.pass_spread, tolerances.turned_thread);
    off("infeed error", found.infeed_error, tolerances.position);
    if !findings.is_empty() {
        findings.extend(left_out(found));
    }
    findings
}

/// The run-in that does not count, in a sentence.
fn left_out(found: &TurnedThread) -> Option<String> {
    (found.run_in > Length::ZERO).then(|| {
        format!(
            "the first {:.3} mm, in which {} comes to its speed, are left out",
            found.run_in.value(),
            found.axis.letter()
        )
    })
}

/// What is there of the thread is not where it was ordered, or next to nothing is.
fn place(found: &TurnedThread, bar: &Inspected) -> Option<String> {
    let uncut = Length::mm(UNCUT_PITCHES * found.lead.value());
    if bar.overrun > uncut {
        return Some(format!("cut {:.2} mm beyond the end of its last block", bar.overrun.value()));
    }
    let turns = bar.expected / Length::mm(found.lead.value());
    (bar.standard.is_some() && bar.sizes.is_none() && turns > FEWEST_TURNS + UNCUT_PITCHES).then(
        || {
            format!(
                "less than two turns of full thread over {:.2} mm ordered",
                bar.expected.value()
            )
        },
    )
}

/// Diameters, flanks and lengths against the limits.
fn form(found: &TurnedThread, bar: &Inspected) -> Vec<String> {
    let (Some(sizes), Some(limits)) = (&found.sizes, &found.limits) else {
        return Vec::new();
    };
    let name = found.class_and_size();
    let mut findings = Vec::new();
    findings.extend(pitch_diameter(sizes, limits, &name, bar.side));
    let others = [("major", sizes.major, limits.major), ("minor", sizes.minor, limits.minor)];
    for (what, has, may) in others {
        let crest = (what == "major") == (bar.side == Side::External);
        findings.extend(outside(what, has, may, crest, &name, bar.side));
    }
    let pitch = found.lead / f64::from(found.starts);
    let wide = GO_CREST[usize::from(bar.side == Side::Internal)] * pitch.value();
    if sizes.width_at_go + NEAR * 2.0 < Length::mm(wide) && findings.is_empty() {
        findings.push(format!(
            "the root is too round for the Go gauge of {name}: the groove is {:.3} mm wide where the gauge's crest needs {wide:.3}",
            sizes.width_at_go.value()
        ));
    }
    let flank = (limits.pitch[1] - limits.pitch[0]) / (2.0 * 3.0_f64.sqrt());
    if sizes.flank_error > flank {
        findings.push(format!(
            "flanks {:.0} µm off their straight form, {:.0} allowed",
            sizes.flank_error.in_um(),
            flank.in_um()
        ));
    }
    let uncut = Length::mm(UNCUT_PITCHES * pitch.value());
    if sizes.full_length < bar.expected - uncut {
        findings.push(format!(
            "full thread over {:.2} mm, {:.2} ordered",
            sizes.full_length.value(),
            bar.expected.value()
        ));
    } else if sizes.run_in > uncut {
        findings.push(format!(
            "the full thread begins {:.2} mm behind the end of the bar",
            sizes.run_in.value()
        ));
    }
    findings
}

fn pitch_diameter(
    sizes: &TurnedSizes,
    limits: &TurnedLimits,
    name: &str,
    side: Side,
) -> Option<String> {
    let [least, most] = limits.pitch;
    // Go: the virtual diameter; No-go: the simple one
    let (tight, loose) = match side {
        Side::External => (sizes.virtual_pitch - most, least - sizes.pitch[0]),
        Side::Internal => (least - sizes.virtual_pitch, sizes.pitch[1] - most),
    };
    let range = format!("{:.3} to {:.3} mm in {name}", least.value(), most.value());
    if tight > NEAR {
        return Some(format!(
            "pitch diameter {:.3} mm, {range}: the groove is at least {:.3} mm too shallow",
            sizes.virtual_pitch.value(),
            tight.value() / 2.0
        ));
    }
    (loose > NEAR).then(|| {
        let found = if side == Side::External { sizes.pitch[0] } else { sizes.pitch[1] };
        format!(
            "pitch diameter {:.3} mm, {range}: the groove is at least {:.3} mm too deep",
            found.value(),
            loose.value() / 2.0
        )
    })
}

/// A diameter beyond its limits; `crest`: it is that of bar or bore.
fn outside(
    what: &str,
    has: [Length; 2],
    may: [Length; 2],
    crest: bool,
    name: &str,
    side: Side,
) -> Option<String> {
    let below = may[0] - has[0] > NEAR;
    if !below && has[1] - may[1] <= NEAR {
        return None;
    }
    let found = if below { has[0] } else { has[1] };
    let range = if may[1].value().is_finite() {
        format!("{:.3} to {:.3} mm", may[0].value(), may[1].value())
    } else {
        format!("{:.3} mm or more", may[0].value())
    };
    let advice = match (crest, side, below) {
        (true, Side::External, false) => ": turn the bar to it before, or cut with a full profile",
        (true, Side::Internal, true) => ": bore it to it before",
        _ => "",
    };
    Some(format!("{what} diameter {:.3} mm, {range} in {name}{advice}", found.value()))
}
