//! Random sequences of requests to a control on its simulated machine, held to what must never happen.
//!
//! ```text
//!   seed ─► power, home, jog, load, start, hold, resume, stop, reset, overrides, MDI, emergency stop, … ─► Control
//!                 └ between two of them 0 to 300 ms of machine time
//!   every period ─► setpoints within travel, speed and acceleration · a jog ends with its lease · no tap breaks
//!   every answer ─► a refused request changes nothing; the state moves along the table of transitions
//! ```
use canon::{Axis, ToolKind};
use control::job::{ProgramOptions, restart};
use control::operation::{
    Control, ControlOptions, Event, Execution, ExecutionEvent, Jog, Power, Request, ToolField,
    said_of,
};
use std::collections::VecDeque;
use std::path::Path;
use units::{Angle, Coordinate, CoordinateSpeed, Spin, Time};

/// A program with everything that a request can meet: cuts, a drilled hole, taps, stops, blocks that may be skipped.
pub const PROGRAM: &str = "\
G21 G17 G90 G54 G64 P0.02
T2 M6
G43 H2
S6000 M3
G0 X12 Y12 Z30
G99 G81 X12 Y12 Z-24 R2 F900
/G0 X20 Y20
M1
X44
G80 G0 Z50
M0
G0 X0 Y0
G1 X5 Y0 F2000
G1 X5 Y5
G0 Z60
T3 M6
G43 H3
S2000 M3
G0 X12 Y12 Z30
G99 G84 X12 Y12 Z-15 R5 F2000
X44
G80 G0 Z80
M30
";

/// What came of many sequences.
#[derive(Debug, Default)]
pub struct Tally {
    /// Sequences.
    pub sequences: u64,
    /// Requests that were accepted.
    pub accepted: u64,
    /// Requests that were refused.
    pub refused: u64,
    /// Machine time, s.
    pub machine_s: f64,
    /// Alarms.
    pub alarms: u64,
    /// Features that were cut and judged.
    pub features: u64,
}

/// Requests and events that are shown of a sequence that broke a rule.
const STORY: usize = 60;
/// Requests in a sequence.
const LONGEST: u64 = 40;
/// What a numeric derivative of a setpoint may be beyond its limit: the kernel's own margin for unplanned motion.
const ROUNDED: f64 = 1.02;
/// The drill of the program bears its feed per turn so many times.
const DRILL_BEARS: f64 = 1.5;
/// Nearer than this to the end of its travel an axis may be beyond it, mm.
const AT_END_MM: f64 = 1e-3;

/// One sequence, by its seed.
///
/// # Errors
/// What must never happen, and did, with the seed.
pub fn sequence(seed: u64, program: &Path, tally: &mut Tally) -> Result<(), String> {
    let mut chance = Chance(seed);
    let options = ControlOptions {
        seed: Some(seed),
        ..ControlOptions::simulated(ProgramOptions::on("tapping-center"))
    };
    let control = Control::new(options).map_err(|why| why.to_string())?;
    let mut bench = Bench::new(control);
    let done = sequence_of(program, &mut chance, (&mut bench, tally));
    done.map_err(|why| {
        format!("seed {seed}: {why}\n{}", Vec::from(bench.story.clone()).join("\n"))
    })?;
    tally.sequences += 1;
    tally.machine_s += bench.control.now().value();
    tally.alarms += bench.control.alarms().len() as u64;
    tally.features += bench.control.features().len() as u64;
    Ok(())
}

fn sequence_of(
    program: &Path,
    chance: &mut Chance,
    (bench, tally): (&mut Bench, &mut Tally),
) -> Result<(), String> {
    let count = 10 + chance.below(LONGEST - 10);
    // most sequences begin as a shop's morning does: else nothing but refusals would be seen
    let mut morning = chance.below(8) > 0;
    for at in 0..count {
        let request = match (morning, at) {
            (true, 0) => Request::Power(true),
            (true, 1) => Request::Home(None),
            (true, 2) => Request::Load(program.to_owned()),
            (true, 3) => Request::Start,
            _ => any(chance, program),
        };
        if morning && at == 2 {
            bench.until(Time::s(60.0), Control::is_homed_all)?;
        }
        morning &= at < 3;
        bench.ask(&request, tally)?;
        let waits = if at < 2 { 0.1 } else { chance.share() * chance.share() * 1.2 };
        bench.pass(Time::s(waits))?;
    }
    bench.pass(Time::s(1.0))
}

/// Any request.
fn any(chance: &mut Chance, program: &Path) -> Request {
    let on = chance.below(2) == 0;
    let axis = [Axis::X, Axis::Y, Axis::Z, Axis::B][chance.below(4) as usize % 4];
    // a tool is not driven into the work by hand
    let upward = axis == Axis::Z;
    let signed = |chance: &mut Chance, most: f64| {
        let value = (chance.share() * 2.0 - 1.0) * most;
        if upward { value.abs() } else { value }
    };
    match chance.below(30) {
        0 => Request::Power(on),
        1 if chance.below(4) == 0 => Request::EmergencyStop(true),
        1 | 2 => Request::EmergencyStop(false),
        3 => Request::Home(on.then_some(axis)),
        4 | 5 => Request::Jog(axis, Jog::Continuous(CoordinateSpeed::new(signed(chance, 900.0)))),
        6 => Request::Jog(axis, Jog::Increment(Coordinate::new(signed(chance, 60.0)))),
        7 => Request::Jog(axis, Jog::Handwheel(Coordinate::new(signed(chance, 1.0)))),
        8 => Request::JogStop,
        9 => Request::TurnSpindle(chance.below(2) as usize, Spin::rpm(signed(chance, 12_000.0))),
        10 => Request::OrientSpindle(0, Angle::rev(chance.share())),
        11 => Request::Load(program.to_owned()),
        12 => Request::Search(restart::From::Hole(1 + chance.below(6) as u32), false),
        13 => Request::Start,
        14 => Request::ManualDataInput("G91 G0 Z1\nG90".into()),
        15 => Request::FeedHold,
        16 | 17 => Request::Resume,
        18 | 19 => Request::Confirm,
        20 => Request::Stop,
        21 => Request::Retract,
        22 => Request::Recover,
        23 => Request::Reset,
        24 => Request::SingleBlock(on),
        25 => Request::OptionalStop(on),
        26 => Request::BlockSkip(1, on),
        27 => Request::FeedOverride(chance.share() * 2.2),
        28 if on => Request::RapidOverride(chance.share()),
        28 => Request::SpindleOverride(chance.share() * 1.5),
        29 if on => Request::SetWorkOffset(2, Axis::X, Coordinate::new(signed(chance, 100.0))),
        _ => Request::EditTool(5, ToolField::Diameter, chance.share()),
    }
}

/// A control, and what its axes did in the last two periods.
struct Bench {
    control: Control,
    before: Vec<[f64; 2]>,
    /// Feed override and spindle override.
    overrides: [f64; 2],
    /// The operator has wanted more feed per turn than the drill bears.
    overloads: bool,
    /// The drill has broken of that, or the operator has left a hole half drilled: a tap finds no hole.
    no_hole: bool,
    /// Where the axes stood when their drives were last off.
    stood: Vec<f64>,
    /// Periods for which setpoints are not compared: drives come up where the axes stand.
    settling: u32,
    execution: Execution,
    lease: Option<Time>,
    said_breaches: usize,
    /// What was asked and what happened, the last of it.
    story: VecDeque<String>,
}

impl Bench {
    fn new(control: Control) -> Self {
        let execution = control.execution();
        Self {
            control,
            before: Vec::new(),
            overrides: [1.0; 2],
            overloads: false,
            no_hole: false,
            stood: Vec::new(),
            settling: 3,
            execution,
            lease: None,
            said_breaches: 0,
            story: VecDeque::new(),
        }
    }

    fn ask(&mut self, request: &Request, tally: &mut Tally) -> Result<(), String> {
        let before = self.control.states();
        let asked = self.control.request(request);
        let answer = asked.as_ref().map_or_else(ToString::to_string, |_| "accepted".into());
        self.tell(&format!("{request:?}: {answer}"));
        match asked {
            Ok(_) => {
                tally.accepted += 1;
                match request {
                    Request::Jog(_, Jog::Continuous(_)) => {
                        self.lease = Some(self.control.now() + Jog::LEASE);
                    }
                    // after an alarm the axes are told to be where they are
                    Request::Reset => self.settling = self.settling.max(4),
                    Request::FeedOverride(share) => self.overrides[0] = share.clamp(0.0, 2.0),
                    Request::SpindleOverride(share) => self.overrides[1] = share.clamp(0.5, 1.2),
                    _ => {}
                }
                self.overloads |= self.overrides[0] / self.overrides[1] > DRILL_BEARS;
            }
            Err(refusal) => {
                tally.refused += 1;
                if refusal.to_string().is_empty() {
                    return Err(format!("{request:?} is refused without a reason"));
                }
                if self.control.states() != before {
                    return Err(format!("{request:?} is refused and changes the state"));
                }
            }
        }
        self.transitions()
    }

    fn tell(&mut self, what: &str) {
        if self.story.len() == STORY {
            self.story.pop_front();
        }
        self.story.push_back(format!("  {:9.4} s  {what}", self.control.now().value()));
    }

    fn pass(&mut self, time: Time) -> Result<(), String> {
        let end = self.control.now() + time;
        while self.control.now() < end {
            self.period()?;
        }
        Ok(())
    }

    fn until(&mut self, most: Time, holds: impl Fn(&Control) -> bool) -> Result<(), String> {
        let end = self.control.now() + most;
        while self.control.now() < end && !holds(&self.control) {
            self.period()?;
        }
        Ok(())
    }

    /// A period, and what may not happen in it.
    fn period(&mut self) -> Result<(), String> {
        self.control.period();
        self.transitions()?;
        self.setpoints()?;
        self.leases()?;
        // no control forbids an overload of the drill
        let broken = self.control.broken_tool().map(|tool| &tool.kind);
        self.no_hole |= self.overloads && matches!(broken, Some(ToolKind::Drill { .. }));
        if matches!(broken, Some(ToolKind::Tap(_))) && !self.no_hole {
            return Err(format!("the tap broke at {}", self.control.now()));
        }
        // an operator may drive a drill against the hole in which it was left: a tap's control does not let him
        let breaches = self.control.breach_count();
        if breaches > std::mem::replace(&mut self.said_breaches, breaches)
            && let Some(breach) = self.control.breaches().last()
            && !breach.contains("sideways")
        {
            if self.no_hole {
                return Ok(());
            }
            return Err(format!("safety check violated: {breach}"));
        }
        Ok(())
    }

    /// The program's state moved along the table.
    fn transitions(&mut self) -> Result<(), String> {
        while let Some(event) = self.control.next_event() {
            let Event::Execution(now) = event else {
                let text = match &event {
                    Event::Feature(feature) => said_of(feature),
                    event => format!("{event:?}"),
                };
                self.no_hole |= text.contains("hole: ") && !text.contains("hole: good");
                self.tell(&text);
                continue;
            };
            self.tell(&format!("{now:?}"));
            let from = self.execution;
            let is_in_table =
                ExecutionEvent::ALL.iter().any(|event| from.after(*event) == Some(now));
            if !is_in_table {
                return Err(format!("{from:?} became {now:?}"));
            }
            self.execution = now;
        }
        let (execution, ..) = self.control.states();
        if execution != self.execution {
            return Err(format!("{:?} became {execution:?} without a word", self.execution));
        }
        Ok(())
    }

    /// Setpoints are within travel, speed and acceleration of their axes.
    fn setpoints(&mut self) -> Result<(), String> {
        let (_, _, power, _) = self.control.states();
        let now: Vec<f64> = self.control.setpoints().map(|(_, at)| at.value()).collect();
        if power == Power::Off || !self.control.is_up() || self.control.is_referencing() {
            self.settling = 3;
        }
        let was = |i: usize, at: f64| self.before.get(i).map_or(at, |was| was[0]);
        let next = now.iter().enumerate().map(|(i, at)| [*at, was(i, *at)]).collect();
        let before = std::mem::replace(&mut self.before, next);
        if self.settling > 0 {
            self.settling -= 1;
            self.stood.clone_from(&now);
            return Ok(());
        }
        let period = self.control.period_time().value();
        let axes = self.control.machine().axes.iter().flatten();
        let stood = self.stood.clone();
        for (((axis, at), was), stood) in axes.zip(now).zip(before).zip(stood) {
            let (speed, accel) =
                ((at - was[0]) / period, (at - 2.0 * was[0] + was[1]) / (period * period));
            let (from, to) = (axis.travel.from.value(), axis.travel.to.value());
            let letter = axis.letter.letter();
            let is_homed = self.control.is_homed(axis.letter);
            // one that has been left beyond its end without power is held where it stands, and goes no further
            let (least, most) = (from.min(stood) - AT_END_MM, to.max(stood) + AT_END_MM);
            if is_homed && (at < least || at > most) {
                return Err(format!(
                    "{letter} is told to be at {at} mm, its travel is {from} to {to}"
                ));
            }
            if speed.abs() > axis.rapid.value() * ROUNDED {
                return Err(format!("{letter} is told to go at {speed} mm/s"));
            }
            if accel.abs() > axis.acceleration.value() * ROUNDED + 1.0 {
                let (now, most) = (self.control.now(), axis.acceleration.value());
                return Err(format!(
                    "{letter} is accelerated by {accel} mm/s² at {now}, its limit is {most}; {:?}, {:?}",
                    self.control.activity(),
                    self.control.execution()
                ));
            }
        }
        Ok(())
    }

    /// A continuous jog is over when its lease and the time to brake are.
    fn leases(&mut self) -> Result<(), String> {
        let Some(end) = self.lease else { return Ok(()) };
        // 900 mm/s with 10 m/s² and 800 m/s³
        let brakes = Time::s(0.9 / 10.0 + 10.0 / 800.0 + 0.01);
        if self.control.now() < end + brakes {
            return Ok(());
        }
        self.lease = None;
        if self.control.is_jogging_on_lease() {
            let now = self.control.now();
            return Err(format!("an axis still jogs at {now}, its lease ended at {end}"));
        }
        Ok(())
    }
}

/// `SplitMix64` (Steele, Lea, Flood 2014).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}
