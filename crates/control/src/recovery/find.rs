//! Where a tap stands, how certainly, and the way it is taken out.
use super::bound::unseen;
use super::{LONGEST, OUT, RecoveryWay};
use crate::Drives;
use crate::config;
use bus::{EngagedTool, RunDownKind, SpindleSense};
use kernel::{EventKind, Kernel, RecoveryFigures, RecoveryPlan};
use std::f64::consts::TAU;
use store::machine::{MachineFile, Spindle};
use store::sync_record::{Stage, Stroke};
use sync::Coupling;
use sync::leaving::{Leaving, Setting};
use sync::recovery::{Direction, Point, Projection, Seat, Stored, Way};
use units::{Angle, Force, Length};
use wire::Welcome;

/// A tap that the control never had in the work.
const NO_THREAD: &str = "the tap came into the work only after the control had been lost, spindle and feed apart, so it is not in the thread of the record";

/// One that was in its thread, and cannot be.
const BEYOND: &str =
    "spindle and feed ran down so far apart that the tap is not where the record has its thread";

/// One that is in no thread now, after drives that were off.
const APART: &str =
    "spindle and feed ran down apart, and the tap is not in the thread of the record";

/// One that stands over the work, of which only the angle within a turn is known.
const IN_AIR: &str = "the tap stands over the work, where nothing ties it to its thread, and the turn of its spindle is not known";

/// One that stands where it may be whole, and stood elsewhere before.
const FOUND_BEFORE: &str = "a recovery before this one, which was stopped, found the tap so deep or so far off its thread that it may be broken";

/// A spindle may turn more easily than its file has it.
const LESS_FRICTION: f64 = 0.8;

/// What is found out.
pub struct Findings {
    /// The thread, as it was written down.
    pub stored: Stored,
    /// Where spindle and feed stand.
    pub at: Point,
    /// Whole turns between the spindle's reading now and then.
    pub turn: Angle,
    /// What the distance from the thread is certain to, and by what; or why the thread is not where
    /// the record has it.
    pub bound: Result<(Length, String), &'static str>,
    /// The way back onto the thread that is taken.
    pub projection: Projection,
    /// The one by the axis that overran alone.
    pub direct: Projection,
    /// Who moves first.
    pub way: Way,
    /// How far the tap has gone beyond where its stroke was to end.
    pub overrun: Length,
    /// Why it may be broken.
    pub not_known_whole: Option<String>,
    /// How far off the coupling its thread may have been cut.
    helix: Length,
}

impl Findings {
    /// What the machine is to keep of the tool from before it is moved.
    pub(super) fn mark(&self, kept: Option<EngagedTool>) -> Option<EngagedTool> {
        let may_be_broken = self.not_known_whole.is_some();
        kept.map(|kept| EngagedTool {
            may_be_broken: kept.may_be_broken || may_be_broken,
            // where the tap stands later does not show that any more
            sync_error: self.helix.max(kept.sync_error),
            ..kept
        })
    }
}

/// A tap that also turns bears this share of the pull that tears it: √(1 − τ²) with two thirds of
/// its torque.
const WHOLE: f64 = 0.75;

/// Why a tap that stands so may be broken: beyond the end of its stroke by more than a lead, which
/// a hole has in reserve; or so far off its thread that its holder may have torn it.
fn not_known_whole(
    stroke: &Stroke,
    overrun: Length,
    error: Length,
    bears: Length,
) -> Option<String> {
    let lead = Length::mm(stroke.lead.value().abs());
    if overrun > lead {
        return Some(format!(
            "the tap ran {:.3} mm deeper than programmed: where its hole ended before, it is broken",
            overrun.value()
        ));
    }
    (error > bears * WHOLE).then(|| {
        format!(
            "the axis may stand {:.3} mm off the thread, and in this holder a tap tears at {:.3} mm, or before where it also turns",
            error.value(),
            bears.value()
        )
    })
}

/// Where the tap stands, and the way back onto its coupling; or why that cannot be known.
pub(super) fn find(
    stroke: &Stroke,
    stage: Stage,
    welcome: &Welcome,
    file: &MachineFile,
    way: RecoveryWay,
) -> Result<Findings, String> {
    let coupling = Coupling::line(stroke.lead, stroke.theta0, stroke.z0);
    let angle = |z: Length| stroke.theta0 + (z - stroke.z0) / stroke.lead;
    let direction = direction(stroke, stage, welcome);
    let stored = Stored::on(coupling, angle(stroke.start), angle(stroke.bottom), direction);
    let feedback = &welcome.observed.feedback;
    let reading = feedback.spindles[usize::from(stroke.spindle)].angle;
    let Some(spindle) = file.spindles.get(usize::from(stroke.spindle)) else {
        return Err(format!("the machine's file has no spindle {}", stroke.spindle));
    };
    let Some(axis) = file.axis(canon::Axis::ALL[usize::from(stroke.axis)]) else {
        return Err(format!("the machine's file has no axis {}", stroke.axis));
    };
    let place = super::stands(file, feedback, stroke.axis);
    let depth = (place - stroke.surface) * sense_in(stroke);
    let setting = Setting {
        surface: stroke.surface,
        holder: stroke.stiffness,
        travel: stroke.travel,
        diameter: stroke.diameter,
    };
    // nothing ties a tap in the air to its thread: no turn is to be shown
    let is_in_air = setting.is_in_air(depth);
    let (turned, how, is_turn_known) =
        turn(&stored, stroke, spindle, welcome, (file, place, is_in_air))?;
    if stroke.thread_length > Length::ZERO && depth > stroke.thread_length {
        return Err(format!(
            "the tap stands {:.3} mm deep, and its thread is {:.3} mm long: its shank has jammed in the hole, and the tap is taken to be \
             broken",
            depth.value(),
            stroke.thread_length.value()
        ));
    }
    let at = Point { angle: turned, place };
    let seat = Seat { play: Length::ZERO, is_stiff: setting.is_stiff() };
    let way = match (stored.leaving(at, &setting).map_err(|e| e.to_string())?, way) {
        (Leaving::Straight, _) => Way::Straight,
        (Leaving::Along, RecoveryWay::Direct) => Way::Direct,
        (Leaving::Along, RecoveryWay::UnloadFirst) => Way::UnloadFirst(seat),
    };
    let kept = welcome.evidence.in_work.unwrap_or_default();
    let apart = matches!(welcome.stop, RunDownKind::Coasted | RunDownKind::None);
    let error = if is_turn_known { stored.error(at).abs() } else { Length::ZERO };
    // a tap that touched the work while the drives ran down by their ramps did so anywhere in
    // between
    let helix = if kept.touches { kept.sync_error } else { error.max(kept.sync_error) };
    let stored = if kept.touches || apart {
        stored
    } else {
        // so along the middle it is off its own thread by half of that at most; a recovery that was
        // stopped may stand there already
        let middle = helix.min(error * 2.0) / 2.0 * stored.error(at).value().signum();
        let coupling = Coupling::line(stroke.lead, stroke.theta0, stroke.z0 + middle);
        Stored::on(coupling, angle(stroke.start), angle(stroke.bottom), direction)
    };
    let overrun = (place - stroke.bottom) * sense_in(stroke);
    let lead = Length::mm(stroke.lead.value().abs());
    // what it may press on the ground with: its core bears no more
    let core = Force::n(setting.bears().value() * stroke.stiffness.value());
    let ground = if overrun > lead { core } else { Force::ZERO };
    // near the surface it may have left its thread and come back into another of its turns
    let beyond =
        error > setting.bears() || way != Way::Straight && depth <= lead && error > lead / 2.0;
    let (way, bound) = if apart && (!kept.touches || beyond) {
        let why = if kept.touches { BEYOND } else { NO_THREAD };
        // so near the surface few teeth hold it, and the thread gives way; deeper they do
        if depth > lead {
            return Err(format!(
                "{why}: it stands {:.3} mm deep, and up to {:.3} mm, one lead, it could be pulled out straight",
                depth.value(),
                lead.value()
            ));
        }
        (Way::Straight, Err(why))
    } else {
        let unseen = unseen(stroke, axis, spindle, stored.error(at), helix, ground);
        let is_beside = apart && way == Way::Straight;
        let known = (unseen.total, format!("{how}; {}", unseen.why));
        let bound = if is_beside { Err(APART) } else { Ok(known) };
        (way, if is_turn_known { bound } else { Err(IN_AIR) })
    };
    let certain = bound.as_ref().map_or(Length::ZERO, |(bound, _)| stored.error(at).abs() + *bound);
    Ok(Findings {
        overrun,
        not_known_whole: if apart && way == Way::Straight {
            Some(format!("{APART}: what it met meanwhile is not known"))
        } else {
            not_known_whole(stroke, overrun, certain, setting.bears())
                .or_else(|| kept.may_be_broken.then(|| FOUND_BEFORE.to_owned()))
        },
        projection: stored.project(at, way),
        direct: stored.project(at, Way::Direct),
        stored,
        at,
        turn: turned - reading,
        bound,
        way,
        helix,
    })
}

/// Where the spindle stands, on what that rests, and whether its turn is known: of a tap in the air
/// it need not be.
fn turn(
    stored: &Stored,
    stroke: &Stroke,
    spindle: &Spindle,
    welcome: &Welcome,
    (file, place, is_in_air): (&MachineFile, Length, bool),
) -> Result<(Angle, String, bool), String> {
    let reading = welcome.observed.feedback.spindles[usize::from(stroke.spindle)].angle;
    if !welcome.turns_lost[usize::from(stroke.spindle)] {
        return Ok((reading, "multi-turn encoder".to_owned(), true));
    }
    let (bound, why) = shown(stroke, spindle, file.tapping.sync_stop, welcome.stop);
    match stored.turn(reading, place, bound) {
        Ok(turned) => {
            Ok((turned, format!("single-turn encoder, turn from the axis ({why})"), true))
        }
        Err(_) if is_in_air => Ok((reading, "the tap stands over the work".to_owned(), false)),
        Err(e) => Err(format!(
            "the spindle's encoder has lost count of its turns, and the turn cannot be shown from the axis: {e} ({why})"
        )),
    }
}

/// +1 where the way in is along the axis' positive sense, else −1.
fn sense_in(stroke: &Stroke) -> f64 {
    if stroke.bottom > stroke.start { 1.0 } else { -1.0 }
}

/// The sense in which the tap went when the stop began. The machine keeps how the spindle turned
/// last; where it had not turned, the record says whether the tap was about to turn back.
fn direction(stroke: &Stroke, stage: Stage, welcome: &Welcome) -> Direction {
    let inward_is_positive = stroke.spin.value() >= 0.0;
    let turned = match welcome.evidence.sense {
        SpindleSense::Positive => Some(true),
        SpindleSense::Negative => Some(false),
        SpindleSense::Unknown => None,
    };
    let inward = turned.map_or(stage != Stage::Outward, |positive| positive == inward_is_positive);
    if inward { Direction::Inward } else { Direction::Outward }
}

/// What the distance from the coupling is shown not to exceed: the monitor's window while
/// everything was driven, and the turns that the spindle ran down alone.
fn shown(
    stroke: &Stroke,
    spindle: &Spindle,
    window: Length,
    stop: RunDownKind,
) -> (Length, String) {
    let omega = stroke.spin.in_rad_per_s().abs();
    let inertia = spindle.inertia.value();
    let (turns, how) = match stop {
        RunDownKind::Coupled => (0.0, "the drives stopped together"),
        RunDownKind::QuickStop if spindle.own_ramps.is_some() => {
            // on the drive's own ramp, which may be a quarter longer than set
            let turns = spindle.own_ramps.map_or(0.0, |own| {
                let rev_per_s = stroke.spin.value().abs();
                rev_per_s * (own.delay.value() + rev_per_s / (1.5 * own.deceleration.value()))
            });
            (turns, "the spindle braked on its drive's own ramp")
        }
        RunDownKind::QuickStop => {
            let torque =
                0.9 * spindle.peak_torque.value().min(spindle.peak_power.value() / omega.max(1e-9));
            (inertia * omega * omega / 2.0 / torque / TAU, "the spindle braked by itself")
        }
        RunDownKind::Coasted | RunDownKind::None => {
            // J·ω·dω/dθ = −(c₀ + c₁ω), from ω to 0
            let c0 = LESS_FRICTION * spindle.friction.coulomb.value().max(1e-9);
            let c1 = LESS_FRICTION * spindle.friction.viscous_n_m_s_per_rad.max(1e-12);
            let turns = inertia / c1 * (omega - c0 / c1 * (1.0 + c1 * omega / c0).ln()) / TAU;
            (turns, "the spindle may have coasted")
        }
    };
    let bound = window + Length::mm(stroke.lead.value().abs() * turns);
    (bound, format!("{how}: {:.3} mm from the thread at most", bound.value()))
}

/// The way out, as a kernel takes it whose axes have the encoders' own zeros.
pub(super) fn plan(
    file: &MachineFile,
    stroke: &Stroke,
    findings: &Findings,
) -> Result<RecoveryPlan, String> {
    let letter = canon::Axis::ALL[usize::from(stroke.axis)];
    let Some(axis) = file.axis(letter) else {
        return Err(format!("the machine's file has no axis {}", letter.letter()));
    };
    Ok(RecoveryPlan {
        axis: letter,
        spindle: stroke.spindle,
        stored: findings.stored,
        turn: findings.turn,
        way: findings.way,
        spin: OUT,
        feed: (axis.approach.speed.of_linear() / 10.0, axis.approach.acceleration.of_linear()),
    })
}

/// Take it out.
pub(super) fn drive_out(
    plant: &mut dyn Drives,
    file: &MachineFile,
    stroke: &Stroke,
    findings: &Findings,
) -> Result<RecoveryFigures, String> {
    let mut kernel = Kernel::new(config::unreferenced(file));
    kernel.recover(plan(file, stroke, findings)?);
    let mut figures = None;
    super::obey(&mut kernel, plant, &mut |event| {
        if let EventKind::RecoveryEnded(ended) = event {
            figures = Some(*ended);
        }
    })?;
    figures.ok_or_else(|| format!("it is not out after {LONGEST}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::in_work::tests::welcome;
    use crate::recovery::no_tool;
    use store::sync_record::Identity;
    use units::{Lead, Spin, Stiffness};

    /// Of an M8 from Z-100 to Z-125 into work that begins at Z-105: drives that stopped so, a place
    /// over the work, so many turns off its thread, and what the machine keeps.
    fn found(stop: RunDownKind, over: Length, turns: f64, kept: EngagedTool) -> Findings {
        let (stroke, welcome) = standing(stop, over, turns, kept);
        let file = config::machine_file::load("tapping-center").expect("a built-in machine");
        find(&stroke, Stage::Outward, &welcome, &file, RecoveryWay::UnloadFirst).expect("a way")
    }

    fn standing(
        stop: RunDownKind,
        over: Length,
        turns: f64,
        kept: EngagedTool,
    ) -> (Stroke, Welcome) {
        let identity = Identity { machine: "m".into(), serial: 1, epoch: 1 };
        let stroke = Stroke {
            axis: 2,
            tool: 11,
            diameter: Length::mm(8.0),
            z0: Length::mm(-100.0),
            lead: Lead::mm_per_rev(-1.25),
            start: Length::mm(-100.0),
            bottom: Length::mm(-125.0),
            surface: Length::mm(-105.0),
            spin: Spin::rpm(1000.0),
            stiffness: Stiffness::n_per_mm(20_000.0),
            thread_length: Length::mm(30.0),
            ..no_tool(&identity).stroke
        };
        let mut welcome = welcome(1, Some(1), stroke.surface + over);
        welcome.stop = stop;
        let into = (5.0 - over.value()) / 1.25;
        welcome.observed.feedback.spindles[0].angle = Angle::rev(into + turns);
        welcome.evidence.in_work = Some(kept);
        (stroke, welcome)
    }

    /// A recovery before this one, stopped over the work, may have left the spindle anywhere; and
    /// where power was gone meanwhile, an encoder without turns does not say where. Nothing of that
    /// matters to a tap in the air: it is taken up straight.
    #[test]
    fn no_tap_that_stands_in_the_air_is_refused_whatever_became_of_spindle_and_encoder() {
        let file = config::machine_file::load("tapping-center").expect("a built-in machine");
        let mut random = 0x9e37_79b9_7f4a_7c15_u64;
        let mut chance = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1_u64 << 53) as f64
        };
        for case in 0..test_support::size::of(500, 50_000) {
            let stop = [
                RunDownKind::None,
                RunDownKind::Coasted,
                RunDownKind::QuickStop,
                RunDownKind::Coupled,
            ][(chance() * 4.0) as usize];
            // beyond what a tap stands out of its holder, and the weight stretches the screw
            let over = Length::mm(0.15 + chance() * 0.85);
            let kept = EngagedTool {
                touches: chance() < 0.5,
                sync_error: Length::mm(chance() * 0.2),
                may_be_broken: chance() < 0.3,
                ..touching()
            };
            let (stroke, mut welcome) = standing(stop, over, chance() * 40.0 - 20.0, kept);
            welcome.turns_lost[0] = chance() < 0.5;
            if welcome.turns_lost[0] {
                let angle = welcome.observed.feedback.spindles[0].angle.value();
                welcome.observed.feedback.spindles[0].angle = Angle::rev(angle.rem_euclid(1.0));
            }
            welcome.evidence.sense =
                [SpindleSense::Unknown, SpindleSense::Positive, SpindleSense::Negative]
                    [(chance() * 3.0) as usize];
            let stage = if chance() < 0.5 { Stage::Inward } else { Stage::Outward };
            let way = find(&stroke, stage, &welcome, &file, RecoveryWay::UnloadFirst);
            let what = format!("case {case}: {stop:?}, {over} over the work");
            let way = way.map(|found| found.way).map_err(|why| format!("{what}: {why}"));
            assert_eq!(way, Ok(Way::Straight), "{what}");
        }
    }

    fn touching() -> EngagedTool {
        EngagedTool { number: 1, tool: 11, touches: true, ..EngagedTool::default() }
    }

    fn bound(found: &Findings) -> Length {
        found.bound.as_ref().expect("it is known how far off it is").0
    }

    /// Drives that were off may have screwed it through its first turns: no encoder shows how far
    /// it is off that thread now.
    #[test]
    fn a_tap_that_left_its_thread_while_the_drives_were_off_is_not_said_to_be_so_far_off_it() {
        let over_the_work = |stop| found(stop, Length::mm(0.5), 1.0, touching());
        let found = over_the_work(RunDownKind::Coasted);
        assert_eq!((found.way, found.bound), (Way::Straight, Err(APART)));
        assert!(found.not_known_whole.is_some_and(|why| why.contains("ran down apart")));
        let driven = over_the_work(RunDownKind::Coupled);
        assert!(driven.way == Way::Straight && driven.bound.is_ok());
    }
    /// 0.75 mm off: it would hold that, but more than half a lead off, its tip near the surface, it
    /// may be in the next turn.
    #[test]
    fn a_tap_that_may_have_come_back_into_another_turn_is_not_said_to_be_off_this_one() {
        let at_the_surface = |stop| found(stop, Length::mm(-0.05), 0.6, touching());
        let apart = at_the_surface(RunDownKind::Coasted);
        assert_eq!((apart.way, apart.bound), (Way::Straight, Err(BEYOND)));
        assert!(at_the_surface(RunDownKind::Coupled).bound.is_ok());
    }

    /// It touched the work while the drives braked and went off its coupling; its thread may be off
    /// as far. In the middle it is off its thread by half of that at most.
    #[test]
    fn a_tap_that_touched_the_work_while_the_drives_braked_is_led_out_along_the_middle() {
        let kept = EngagedTool { touches: false, ..touching() };
        let depth = Length::mm(-1.0);
        let first = found(RunDownKind::QuickStop, depth, 0.06 / 1.25, kept);
        let never = found(RunDownKind::QuickStop, depth, 0.06 / 1.25, touching());
        let record = never.stored.error(never.at);
        assert!(record.abs() > Length::um(30.0), "the weight on the screw takes some: {record}");
        let halved = first.stored.error(first.at) - record / 2.0;
        assert!(halved.abs() < Length::um(0.1), "{halved}");
        // a recovery that was stopped there goes on along the same, and its thread may be off as
        // far as before
        let kept = first.mark(Some(kept)).expect("it is kept");
        let turned_back = first.stored.phase_difference(first.at).value().abs();
        let again = found(RunDownKind::QuickStop, depth, 0.06 / 1.25 - turned_back, kept);
        let aside = again.stored.start().place - first.stored.start().place;
        assert!(aside.abs() < Length::um(0.1), "{aside}");
        let on_it = again.stored.error(again.at);
        assert!(on_it.abs() < Length::um(0.1), "{on_it}");
        let wider = bound(&again)
            - bound(&found(
                RunDownKind::QuickStop,
                depth,
                0.06 / 1.25 - 2.0 * turned_back,
                touching(),
            ));
        assert!((wider - record.abs()).abs() < Length::um(0.1), "{wider}, {record}");
    }
}
