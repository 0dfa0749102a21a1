//! Compensation of axes and of spindles' encoders: the one place at which what an encoder says
//! becomes a position, and a commanded position what its drive takes.
//!
//! ```text
//!   encoder ─► + zero ─► d ─► x = d + ε(d, w) ─► kernel: everything is where the slide is
//!   drive  ◄── − zero ◄─ d ◄─ solve for d     ◄─ commanded x, and its speed
//! ```
//!
//! **Flank.** w is 1 after a motion towards plus, 0 after one towards minus. It is known once the
//! axis has been commanded a way longer than s since the kernel was made; until then w is ½, and
//! half of the play is not known. A slide that turns back first relaxes what its guideway has given
//! (s = friction over stiffness of the contact), with the nut on the same flank: only then does the
//! play open. w goes to its other end so that half of its way is over when the commanded position
//! has gone back by s, by what the axis does at present (but not before 0.3·s), as a motion of
//! limited speed, acceleration and jerk: the setpoint has no jump, and the play b takes T ≈
//! 2·√(b/a) at the acceleration a that compensation may take.
//!
//! Where inertia and weight push the slide harder than friction, they decide on which flank the nut
//! stands: an axis that brakes hard is held by the other one, one that hangs on its screw never
//! changes it.
//!
//! **Homing.** The points count from machine zero: an axis that is not homed is not compensated.
//! When it is homed its positions get other names by ε, and nothing moves.
//!
//! **Spindles.** An encoder's error per turn counts from its index mark, at which it is taken as
//! zero: θ = φ + ε(φ) − ε(0). It fades in once the mark has passed.
use crate::config::{AxisControl, Config};
use crate::homing::Homing;
use alloc::boxed::Box;
use bus::{AXES, AxisCommand, AxisFeedback, Command, Feedback, SPINDLES, SpindleCommand};
use bus::{Coupled, SpindleFeedback};
use motion::{Goal, OnlineLimits, OnlineState};
use sync::{Deviation, DeviationTable};
use units::{Angle, Coordinate, CoordinateAccel, CoordinateSpeed, Force, Length, Mass, Spin};

/// Time in which the acceleration of a change of flank is built up, s.
const RISE_S: f64 = 0.004;
/// Share of the acceleration that it is planned with: arrival takes the rest.
const PLANNED: f64 = 0.85;
/// Share of the way back that must be over before the flank changes, however fast the axis goes.
const GONE_BACK: f64 = 0.3;
/// Time in which a spindle's correction fades in, s.
const FADE_S: f64 = 0.25;
/// Steps to the encoder's angle from the true one: each leaves a thousandth or less.
const STEPS: u32 = 5;

/// What the control takes off of the readings of one axis.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisCompensation {
    /// Measured errors.
    pub table: DeviationTable,
    /// Speed and acceleration that a change of flank may take.
    pub reversal: (CoordinateSpeed, CoordinateAccel),
    /// Way back from the farthest setpoint at which the flank changes.
    pub turns_after: Coordinate,
}

/// What the control takes off of the readings of one spindle.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpindleCompensation {
    /// Errors per turn, rev.
    pub table: DeviationTable,
    /// The encoder's zero is its index mark; otherwise the whole turns that it counts.
    pub from_index: bool,
}

/// What the control takes off of all readings.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeviationTables {
    /// By axis, X first.
    pub axes: [Option<AxisCompensation>; AXES],
    /// By spindle.
    pub spindles: [Option<SpindleCompensation>; SPINDLES],
}

/// Compensation at work; `None`: the machine has none.
#[derive(Clone, Debug)]
pub(crate) struct Compensating(Option<Box<Compensated>>);

#[derive(Clone, Debug)]
struct Compensated {
    axes: [Option<AxisRun>; AXES],
    spindles: [Option<SpindleRun>; SPINDLES],
}

/// Sense of the commanded motion, and the farthest setpoint in it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sense {
    Unmoved,
    Unknown(f64),
    Up(f64),
    Down(f64),
}

impl Sense {
    /// After a setpoint that will have gone on by so much when half of a change of flank is over.
    fn next(self, setpoint: f64, ahead: f64, turns_after: f64) -> Self {
        let most_ahead = (1.0 - GONE_BACK) * turns_after;
        let is_over = |way: f64, ahead: f64| way + ahead.clamp(0.0, most_ahead) > turns_after;
        match self {
            Self::Unmoved => Self::Unknown(setpoint),
            Self::Unknown(from) if is_over(setpoint - from, ahead) => Self::Up(setpoint),
            Self::Unknown(from) if is_over(from - setpoint, -ahead) => Self::Down(setpoint),
            Self::Up(most) if is_over(most - setpoint, -ahead) => Self::Down(setpoint),
            Self::Down(least) if is_over(setpoint - least, ahead) => Self::Up(setpoint),
            Self::Unknown(from) => Self::Unknown(from),
            Self::Up(most) => Self::Up(most.max(setpoint)),
            Self::Down(least) => Self::Down(least.min(setpoint)),
        }
    }

    /// The flank that it leads to.
    const fn flank(self) -> f64 {
        match self {
            Self::Unmoved | Self::Unknown(_) => 0.5,
            Self::Up(_) => 1.0,
            Self::Down(_) => 0.0,
        }
    }
}

/// What compensation must know of an axis beside its command.
pub(crate) struct AxisInMotion {
    /// By how much its positions have got other names, in all, without any motion.
    pub(crate) renamed: f64,
    /// Commanded acceleration.
    pub(crate) accel: f64,
    /// What the nut gives the slide beside friction: for acceleration and against weight, N.
    pub(crate) push: f64,
    /// Friction of sliding and of breaking away, N.
    pub(crate) friction: (f64, f64),
    /// Motor and screw.
    pub(crate) motor: Mass,
}

/// Time that a change of flank takes from rest to rest, s.
fn duration_s(limits: &OnlineLimits, period_s: f64) -> f64 {
    const LONGEST_S: f64 = 10.0;
    let goal = Goal::Position(1.0);
    let (mut flank, mut time_s) = (OnlineState::at_rest(0.0), 0.0);
    while !flank.has_reached(goal) && time_s < LONGEST_S {
        flank = flank.next(goal, limits, (0.0, 1.0), period_s);
        time_s += period_s;
    }
    time_s
}

#[derive(Clone, Debug)]
struct AxisRun {
    deviation: Deviation,
    /// It is homed.
    counts: bool,
    sense: Sense,
    turns_after: f64,
    /// More than friction pushes the slide onto a flank.
    is_pushed: bool,
    /// Half of the time that a change of flank takes, s.
    half_s: f64,
    /// The flank and how it changes, and the one by which the last readings were taken.
    flank: OnlineState,
    read_flank: f64,
    limits: Option<OnlineLimits>,
    /// Deviation at the last reading.
    read: f64,
    /// How much faster the drive is commanded than the slide, and what that needed of force.
    faster: f64,
    force: f64,
}

impl AxisRun {
    fn new(axis: &AxisCompensation, control: Option<&AxisControl>, period_s: f64) -> Self {
        // one that hangs on its screw stands on the flank that bears it
        let hangs = control.filter(|of| of.weight.abs() > of.friction.breakaway);
        let flank = hangs.map_or(0.5, |of| if of.weight.value() < 0.0 { 1.0 } else { 0.0 });
        let deviation = Deviation::new(&axis.table);
        let height = deviation.reversal();
        let (speed, accel) = (axis.reversal.0.value(), axis.reversal.1.value());
        let limits = (height > 0.0).then(|| OnlineLimits {
            speed: speed / height,
            accel: PLANNED * accel / height,
            jerk: PLANNED * accel / height / RISE_S,
        });
        Self {
            deviation,
            counts: true,
            sense: Sense::Unmoved,
            turns_after: axis.turns_after.value(),
            half_s: limits.map_or(0.0, |limits| duration_s(&limits, period_s) / 2.0),
            is_pushed: hangs.is_some(),
            flank: OnlineState::at_rest(flank),
            read_flank: flank,
            limits,
            read: 0.0,
            faster: 0.0,
            force: 0.0,
        }
    }

    fn slide(&self, position: Coordinate) -> Coordinate {
        let position = position.value();
        Coordinate::new(position + self.deviation.at(position, self.read_flank).value)
    }

    fn take(&mut self, said: &mut AxisFeedback) {
        self.read_flank = self.flank.position;
        if self.counts {
            let position = said.position;
            said.position = self.slide(position);
            said.index = said.index.map(|at| self.slide(at));
            self.read = (said.position - position).value();
        }
    }

    /// The flank follows where the setpoint is half a change of flank later.
    fn follow(&mut self, command: &AxisCommand, moved: &AxisInMotion, period_s: f64) {
        let t = self.half_s;
        let ahead = t * (command.speed.value() + t * moved.accel / 2.0);
        let setpoint = command.position.value() - moved.renamed;
        self.sense = self.sense.next(setpoint, ahead, self.turns_after);
        let least = if self.is_pushed { moved.friction.0 } else { moved.friction.1 };
        self.is_pushed = moved.push.abs() > least;
        let flank = match self.is_pushed {
            true if moved.push > 0.0 => 1.0,
            true => 0.0,
            false => self.sense.flank(),
        };
        let goal = Goal::Position(flank);
        if let Some(limits) = self.limits.filter(|_| !self.flank.has_reached(goal)) {
            self.flank = self.flank.next(goal, &limits, (0.0, 1.0), period_s);
        }
    }

    /// The drive's command for what is wanted of the slide.
    fn give(&mut self, command: &mut AxisCommand, mass: Mass, period_s: f64) {
        let slide = command.position.value();
        let flank = self.flank.position;
        let position = self.deviation.encoder_position(slide, flank);
        let here = self.deviation.at(position, flank);
        let across = self.deviation.across(position) * self.flank.speed;
        let speed = command.speed.value();
        let faster = (speed - across) / (1.0 + here.slope) - speed;
        // the motor alone is accelerated by what the slide does not do
        self.force = mass.value() * 1e-3 * (faster - self.faster) / period_s;
        self.faster = faster;
        command.position = Coordinate::new(position);
        command.speed = CoordinateSpeed::new(speed + faster);
        command.force += Force::n(self.force);
    }

    /// What [`Self::give`] has made of it, as it was.
    fn take_back(&self, command: &mut AxisCommand) {
        let position = command.position.value();
        let value = self.deviation.at(position, self.flank.position).value;
        command.position = Coordinate::new(position + value);
        command.speed = CoordinateSpeed::new(command.speed.value() - self.faster);
        command.force -= Force::n(self.force);
    }
}

#[derive(Clone, Debug)]
struct SpindleRun {
    deviation: Deviation,
    from_index: bool,
    at_mark: f64,
    mark: Option<f64>,
    /// Share of the fade that has passed.
    faded: f64,
    /// Correction of the last reading.
    read: f64,
}

impl SpindleRun {
    fn new(spindle: &SpindleCompensation) -> Self {
        let deviation = Deviation::new(&spindle.table);
        let at_mark = deviation.at(0.0, 1.0).value;
        let (mark, faded) = if spindle.from_index { (None, 0.0) } else { (Some(0.0), 1.0) };
        Self { deviation, from_index: spindle.from_index, at_mark, mark, faded, read: 0.0 }
    }

    /// Correction at an angle by the encoder, and its slope.
    fn at(&self, angle: f64) -> (f64, f64) {
        let Some(mark) = self.mark else { return (0.0, 0.0) };
        let share = self.faded * self.faded * (3.0 - 2.0 * self.faded);
        let here = self.deviation.at(angle - mark, 1.0);
        (share * (here.value - self.at_mark), share * here.slope)
    }

    fn take(&mut self, said: &mut SpindleFeedback, period_s: f64) {
        if let Some(index) = said.index.filter(|_| self.from_index) {
            self.mark = Some(index.value());
        }
        if self.mark.is_some() && self.faded < 1.0 {
            self.faded = (self.faded + period_s / FADE_S).min(1.0);
        }
        self.read = self.at(said.angle.value()).0;
        said.angle += Angle::rev(self.read);
    }

    fn encoder_angle(&self, angle: Angle) -> Angle {
        let wanted = angle.value();
        let mut found = wanted;
        for _ in 0..STEPS {
            found = wanted - self.at(found).0;
        }
        Angle::rev(found)
    }

    fn give(&self, command: &mut SpindleCommand) {
        command.angle = self.encoder_angle(command.angle);
        command.spin =
            Spin::rev_per_s(command.spin.value() / (1.0 + self.at(command.angle.value()).1));
    }

    fn take_back(&self, command: &mut SpindleCommand) {
        let (correction, slope) = self.at(command.angle.value());
        command.angle += Angle::rev(correction);
        command.spin = Spin::rev_per_s(command.spin.value() * (1.0 + slope));
    }
}

impl Compensating {
    pub(crate) fn new(config: &Config) -> Self {
        let DeviationTables { axes, spindles } = &config.compensation;
        let period_s = config.period.value();
        let of_axis = |index: usize| {
            Some(AxisRun::new(axes[index].as_ref()?, config.axes[index].as_ref(), period_s))
        };
        let any = axes.iter().any(Option::is_some) || spindles.iter().any(Option::is_some);
        Self(any.then(|| {
            Box::new(Compensated {
                axes: core::array::from_fn(of_axis),
                spindles: spindles.each_ref().map(|one| one.as_ref().map(SpindleRun::new)),
            })
        }))
    }

    /// Nothing is compensated.
    pub(crate) const fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// What is added to a position by the encoder near the last one.
    pub(crate) fn correction(&self, axis: usize) -> f64 {
        let run = self.0.as_ref().and_then(|running| running.axes[axis].as_ref());
        run.filter(|run| run.counts).map_or(0.0, |run| run.read)
    }

    /// What is added to an angle by the encoder near the last one, rev.
    pub(crate) fn correction_of_spindle(&self, spindle: usize) -> f64 {
        let run = self.0.as_ref().and_then(|running| running.spindles.get(spindle)?.as_ref());
        run.map_or(0.0, |run| run.read)
    }

    /// An axis counts if it is homed. By how much its positions get other names, where that has
    /// changed; `position` is where it is commanded to be, by the names of before.
    pub(crate) fn count_homed(
        &mut self,
        homing: &Homing,
        axis: usize,
        position: f64,
    ) -> Option<f64> {
        let run = self.0.as_mut()?.axes[axis].as_mut()?;
        let is_homed = homing.is_homed(axis);
        if run.counts == is_homed {
            return None;
        }
        run.counts = is_homed;
        let flank = run.flank.position;
        let encoder =
            if is_homed { position } else { run.deviation.encoder_position(position, flank) };
        let deviation = run.deviation.at(encoder, flank).value;
        (run.faster, run.force) = (0.0, 0.0);
        run.read = if is_homed { deviation } else { 0.0 };
        Some(if is_homed { deviation } else { -deviation })
    }

    /// A period's readings become positions of the slides and angles of the spindles.
    pub(crate) fn take(&mut self, feedback: &mut Feedback, period_s: f64) {
        let Some(running) = &mut self.0 else { return };
        for (run, said) in running.axes.iter_mut().zip(&mut feedback.axes) {
            if let Some(run) = run {
                run.take(said);
            }
        }
        for (run, said) in running.spindles.iter_mut().zip(&mut feedback.spindles) {
            if let Some(run) = run {
                run.take(said, period_s);
            }
        }
    }

    /// The same of readings that have been taken already.
    pub(crate) fn taken(&self, feedback: &mut Feedback) {
        let Some(running) = &self.0 else { return };
        for (run, said) in running.axes.iter().zip(&mut feedback.axes) {
            if let Some(run) = run.as_ref().filter(|run| run.counts) {
                said.position = run.slide(said.position);
                said.index = said.index.map(|at| run.slide(at));
            }
        }
        for (run, said) in running.spindles.iter().zip(&mut feedback.spindles) {
            if let Some(run) = run {
                said.angle += Angle::rev(run.at(said.angle.value()).0);
            }
        }
    }

    /// What is wanted of the slides becomes what is wanted of the drives.
    pub(crate) fn give(
        &mut self,
        command: &mut Command,
        period_s: f64,
        moved: impl Fn(usize) -> Option<AxisInMotion>,
    ) {
        let Some(running) = &mut self.0 else { return };
        if let Some(coupled) = &mut command.coupled {
            running.tie(coupled, command.axes[usize::from(coupled.axis)].position);
        }
        for (index, (run, wanted)) in running.axes.iter_mut().zip(&mut command.axes).enumerate() {
            let (Some(run), Some(moved)) = (run, moved(index)) else { continue };
            if !wanted.enable {
                (run.faster, run.force) = (0.0, 0.0);
                continue;
            }
            run.follow(wanted, &moved, period_s);
            if run.counts {
                run.give(wanted, moved.motor, period_s);
            }
        }
        for (run, wanted) in running.spindles.iter().zip(&mut command.spindles) {
            if let Some(run) = run {
                run.give(wanted);
            }
        }
    }

    /// What [`Self::give`] has made of it, as it was.
    pub(crate) fn take_back(&self, command: &mut Command) {
        let Some(running) = &self.0 else { return };
        for (run, wanted) in running.axes.iter().zip(&mut command.axes) {
            if let Some(run) = run.as_ref().filter(|run| run.counts && wanted.enable) {
                run.take_back(wanted);
            }
        }
        for (run, wanted) in running.spindles.iter().zip(&mut command.spindles) {
            if let Some(run) = run {
                run.take_back(wanted);
            }
        }
        if let Some(coupled) = &mut command.coupled {
            running.untie(coupled);
        }
    }
}

impl Compensated {
    /// A line on which drives stop by themselves goes through where the axis is, by the encoders.
    fn tie(&self, coupled: &mut Coupled, at: Coordinate) {
        if coupled.lead.value() == 0.0 {
            return;
        }
        let turned = (at.of_linear() - coupled.place) / coupled.lead;
        (coupled.place, coupled.angle) = (at.of_linear(), coupled.angle + turned);
        if let Some(run) = self.axes[usize::from(coupled.axis)].as_ref().filter(|run| run.counts) {
            let place = run.deviation.encoder_position(coupled.place.value(), run.flank.position);
            coupled.place = Length::mm(place);
        }
        if let Some(Some(run)) = self.spindles.get(usize::from(coupled.spindle)) {
            coupled.angle = run.encoder_angle(coupled.angle);
        }
    }

    fn untie(&self, coupled: &mut Coupled) {
        if let Some(run) = self.axes[usize::from(coupled.axis)].as_ref().filter(|run| run.counts) {
            let place = coupled.place.value();
            coupled.place += Length::mm(run.deviation.at(place, run.flank.position).value);
        }
        if let Some(Some(run)) = self.spindles.get(usize::from(coupled.spindle)) {
            coupled.angle += Angle::rev(run.at(coupled.angle.value()).0);
        }
    }
}
