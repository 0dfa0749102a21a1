//! The planned time of steps: how long they will take, one after another, with the spindle ramps
//! that run beside them.
use crate::limits::MachineLimits;
use crate::{SpindleStep, Step, StepKind};
use motion::{ChipThrow, Follow, Move, Profile, Shape, SurfaceSpeed};
use units::{Angle, Length, Spin, Time};

/// Places along a path where its speed by the surface is looked at.
const LOOKS: u8 = 16;

/// Halvings of a move's time until the place is found: 2⁻⁴⁰ of it.
const HALVINGS: u32 = 40;
/// A place so near to a level is on it, mm.
const NOTHING: f64 = 1e-9;

/// Adds up the planned time of steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Planned time of all that was counted, s.
    elapsed: f64,
    /// When the ordered spindle ramp is over, s.
    ready_at: f64,
    /// Speed of spindle 0 that was ordered last, rev/s, without sign.
    speed: f64,
    /// It turns by the place of X.
    surface: Option<SurfaceSpeed>,
    /// Chips that are to be thrown off once a move passes their level.
    throw: Option<ChipThrow>,
}

impl Clock {
    /// Planned time of all that was counted.
    pub const fn elapsed(&self) -> Time {
        Time::s(self.elapsed)
    }

    /// Count a step.
    pub fn count(&mut self, step: &Step, limits: &MachineLimits) {
        match &step.kind {
            StepKind::Move(m) => {
                if let Some((throw, at)) = self.throw.and_then(|t| Some((t, passed_by(&t, m)?))) {
                    let lasts = throw_lasts(&throw, limits);
                    self.ready_at = self.ready_at.max(self.elapsed + at + lasts);
                    self.throw = None;
                }
                self.by_surface(m, limits);
                self.motion(m.profile.duration(), m.per_revolution, m.exact_stop, limits);
            }
            StepKind::Follow(follow) => {
                self.follows_surface(follow);
                self.motion(follow.duration(), follow.per_revolution, follow.exact_stop, limits);
            }
            StepKind::Probe { order, .. } => {
                self.motion(order.profile.duration(), false, true, limits);
            }
            StepKind::Dwell(time) => self.elapsed += time.value(),
            StepKind::Spindle { spindle, order } => match order {
                SpindleStep::Turn { spin, ramp } => {
                    self.ready_at = self.ready_at.max(self.elapsed + ramp_lasts(ramp, limits));
                    if *spindle == 0 {
                        (self.speed, self.surface) = (spin.abs().value(), None);
                    }
                }
                SpindleStep::Surface { surface, ramp } => {
                    self.ready_at = self.ready_at.max(self.elapsed + ramp_lasts(ramp, limits));
                    if *spindle == 0 {
                        (self.speed, self.surface) = (ramp.end().v.abs(), Some(*surface));
                    }
                }
                SpindleStep::AwaitSpeed => self.elapsed = self.elapsed.max(self.ready_at),
                SpindleStep::Orient { .. } => {}
                SpindleStep::Throw(throw) => {
                    self.throw = Some(**throw);
                    self.ready_at = self.ready_at.max(self.elapsed + throw_lasts(throw, limits));
                    if *spindle == 0 {
                        self.surface = None;
                        self.speed = throw.then.abs().value();
                    }
                }
            },
            StepKind::Tap(tap) => {
                let way = |profile: &Profile, spin: Spin| match limits.tapping.own_ramps {
                    Some(own) => own.stroke(spin, Angle::rev(profile.end().s)).value(),
                    None => profile.duration(),
                };
                let strokes = way(&tap.inward, tap.spin) + way(&tap.outward, tap.return_spin);
                self.elapsed += strokes + tap.dwell.value() + limits.settling.value();
            }
            // the spindle comes round to the start angle after half a turn, on average
            StepKind::Thread(stretch) if self.speed > 0.0 => {
                let wait = if stretch.start.is_some() { 0.5 } else { 0.0 };
                let turns = stretch.is_over_at() - stretch.begins() + wait;
                self.elapsed += turns / self.speed;
            }
            StepKind::Revolve { spindle: _, turns } if self.speed > 0.0 => {
                self.elapsed += turns.abs().value() / self.speed;
            }
            StepKind::Superpose(order) if self.speed > 0.0 => {
                self.ready_at =
                    self.ready_at.max(self.elapsed + order.over.abs().value() / self.speed);
            }
            StepKind::AwaitFades => self.elapsed = self.elapsed.max(self.ready_at),
            StepKind::ChangeTool { .. } => self.elapsed += limits.tool_change.time.value(),
            StepKind::Inputs(wait) => self.elapsed += wait.usual.value(),
            StepKind::Count(count) => self.elapsed += count.usual.value(),
            StepKind::Engage(_)
            | StepKind::WayOut(_)
            | StepKind::Release { .. }
            | StepKind::Superpose(_)
            | StepKind::Thread(_)
            | StepKind::Revolve { .. }
            | StepKind::Consult(_)
            | StepKind::Coolant { .. }
            | StepKind::FeedOverride(_)
            | StepKind::SpindleOverride(_)
            | StepKind::Output(_)
            | StepKind::Input(_)
            | StepKind::Guard { .. }
            | StepKind::UserCode(_)
            | StepKind::Pause { .. }
            | StepKind::End => {}
        }
    }

    /// A move changes the speed that the surface asks for: of a rapid the spindle has to come to it
    /// beside the travel, a cut takes the mean of what its turns last.
    fn by_surface(&mut self, order: &Move, limits: &MachineLimits) {
        let Some(surface) = self.surface else { return };
        if order.rapid {
            let spin = surface.at(order.path.to().linear[0]);
            if let Some(drive) = limits.spindles.first() {
                let ramp = drive.ramp(Spin::rev_per_s(self.speed), spin.abs());
                self.ready_at = self.ready_at.max(self.elapsed + ramp_lasts(&ramp, limits));
            }
            self.speed = spin.abs().value();
        } else {
            let curve = order.path.curve();
            self.mean_along(&surface, (0.0, curve.length()), |s| curve.at(s).q[0]);
        }
    }

    fn follows_surface(&mut self, follow: &Follow) {
        let Some(surface) = self.surface else { return };
        let (from, ..) = follow.at(0.0);
        let (to, ..) = follow.at(follow.duration());
        self.mean_along(&surface, (from, to), |s| follow.piece.at(s).q[0]);
    }

    /// The speed at which turns last as long as they do on the mean of a way.
    fn mean_along(
        &mut self,
        surface: &SurfaceSpeed,
        (from, to): (f64, f64),
        x: impl Fn(f64) -> f64,
    ) {
        let looks = (0..LOOKS).map(|k| {
            let share = (f64::from(k) + 0.5) / f64::from(LOOKS);
            1.0 / surface.at(Length::mm(x(from + share * (to - from)))).abs().value()
        });
        self.speed = f64::from(LOOKS) / looks.sum::<f64>();
    }

    fn motion(&mut self, over: f64, per_revolution: bool, stops: bool, limits: &MachineLimits) {
        self.elapsed += over / if per_revolution { self.speed } else { 1.0 };
        if stops {
            self.elapsed += limits.settling.value();
        }
    }
}

/// How long a spindle takes for a ramp, s: a drive that makes its own ramps is told the speed at
/// once.
fn ramp_lasts(ramp: &Profile, limits: &MachineLimits) -> f64 {
    let (from, to) = (Spin::rev_per_s(ramp.at(0.0).v), Spin::rev_per_s(ramp.end().v));
    limits.tapping.own_ramps.map_or(ramp.duration(), |own| own.change(from, to).value())
}

/// How long it takes to throw chips off, s.
fn throw_lasts(throw: &ChipThrow, limits: &MachineLimits) -> f64 {
    ramp_lasts(&throw.against, limits) + ramp_lasts(&throw.back, limits)
}

/// When a move passes the level of a chip removal, s after its start; `None` if it stays before it.
fn passed_by(throw: &ChipThrow, order: &Move) -> Option<f64> {
    let beyond = |t: f64| {
        let at = order.path.motion(order.profile.at(t)).position[throw.axis.index()].of_linear();
        (at - throw.level).value() * if throw.upwards { 1.0 } else { -1.0 } >= -NOTHING
    };
    let (mut low, mut high) = (0.0, order.profile.duration());
    if beyond(low) {
        return Some(low);
    }
    if !beyond(high) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if beyond(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use crate::OwnRamps;
    use units::{Angle, Length, Spin, SpinAccel, Time};

    /// 50 rev/s² up, 100 down, 10 ms late.
    const OWN: OwnRamps = OwnRamps {
        delay: Time::s(0.01),
        accel: SpinAccel::rev_per_s2(50.0),
        decel: SpinAccel::rev_per_s2(100.0),
        uncertainty: 0.0,
        repeats_delay: Time::ZERO,
        repeats: 0.0,
        turns_within: Length::ZERO,
        creep: 0.1,
        orients: false,
    };

    #[test]
    fn a_drive_that_makes_its_own_ramps_takes_its_own_time() {
        for (from, to, seconds) in
            [(0.0, 10.0, 0.21), (5.0, 15.0, 0.21), (15.0, 5.0, 0.11), (20.0, -10.0, 0.41)]
        {
            let lasts = OWN.change(Spin::rev_per_s(from), Spin::rev_per_s(to)).value();
            assert!((lasts - seconds).abs() < 1e-12, "{from} to {to}: {lasts} s");
        }
        // 20 turns at 10 rev/s: 0.2 s up over one turn, 0.1 s down over half a turn, 18.5 turns in
        // between
        let lasts = OWN.stroke(Spin::rev_per_s(10.0), Angle::rev(20.0)).value();
        assert!((lasts - (0.01 + 0.2 + 0.1 + 1.85)).abs() < 1e-12, "{lasts}");
        // 1.5 turns are the two ramps alone
        let lasts = OWN.stroke(Spin::rev_per_s(99.0), Angle::rev(1.5)).value();
        assert!((lasts - 0.31).abs() < 1e-12, "{lasts}");
    }
}
