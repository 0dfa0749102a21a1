//! Axes and spindles by hand: jog, handwheel, spindle.
use super::control::Control;
use super::request::{Accepted, Jog, Refusal};
use super::state::Mode;
use canon::Axis;
use kernel::{ManualOrder, ManualRefusal};
use motion::{Goal, OnlineLimits};
use store::machine::Axis as AxisFile;
use units::{Angle, Coordinate, CoordinateSpeed, Spin};

/// How far an axis is jogged at once that does not know where it is, mm or °.
const MOST_NOT_HOMED: Coordinate = Coordinate::new(10.0);

impl Control {
    /// The axis in the machine's file.
    pub(super) fn axis_file(&self, axis: Axis) -> Result<&AxisFile, Refusal> {
        let machine = &self.base.machine;
        machine.axis(axis).ok_or_else(|| {
            let has: String =
                machine.axes.iter().flatten().map(|axis| axis.letter.letter()).collect();
            Refusal::because(format!("{} has no axis {}, only {has}", machine.name, axis.letter()))
        })
    }

    pub(super) fn jog(&mut self, axis: Axis, jog: Jog) -> Result<Accepted, Refusal> {
        if self.is_referencing() {
            return Err(Refusal::because("axes are being homed: wait, or stop the jog"));
        }
        let file = self.axis_file(axis)?;
        let at = self.executor.kernel.setpoint(axis).unwrap_or(Coordinate::ZERO);
        let is_homed = self.is_homed(axis);
        let ends = match jog {
            _ if is_homed => (file.travel.from, file.travel.to),
            Jog::Continuous(_) => {
                (Coordinate::new(f64::NEG_INFINITY), Coordinate::new(f64::INFINITY))
            }
            Jog::Increment(_) | Jog::Handwheel(_) | Jog::To(_) => {
                (at - MOST_NOT_HOMED, at + MOST_NOT_HOMED)
            }
        };
        let (approach, most) = if is_homed {
            (file.approach.speed, file.rapid)
        } else {
            // its switches stop it before its end; one without comes to its end slowly
            let homing = &file.homing;
            let search = if file.ends.is_some() { homing.fast } else { homing.slow };
            let slow = file.approach.speed.min(search);
            (slow, slow)
        };
        let to = |to: Coordinate| (Goal::Position(to.value()), approach, None);
        let mut sent_to = None;
        let (goal, speed, lease) = match jog {
            Jog::Continuous(speed) => (Goal::Speed(speed.value()), speed.abs(), Some(Jog::LEASE)),
            Jog::Increment(by) => to(at + by),
            Jog::To(place) => to(place),
            Jog::Handwheel(by) => {
                let sent = self.handwheel[axis.index()]
                    .filter(|_| self.executor.kernel.is_moving_manually())
                    .unwrap_or(at);
                let place = (sent + by).max(ends.0).min(ends.1);
                sent_to = Some(place);
                to(place)
            }
        };
        let (Goal::Speed(value) | Goal::Position(value)) = goal;
        if !value.is_finite() {
            return Err(Refusal::because("a jog needs a number"));
        }
        if let (Goal::Position(to), Jog::Increment(_) | Jog::To(_)) = (goal, jog)
            && let to = Coordinate::new(to)
            && (to < ends.0 || to > ends.1)
        {
            let (end, left) =
                if to < ends.0 { (ends.0, at - ends.0) } else { (ends.1, ends.1 - at) };
            let [to, end, left] =
                [to, end, left.max(Coordinate::ZERO)].map(|place| axis.reading(place));
            if !is_homed {
                let (letter, unit) = (axis.letter(), axis.kind().unit());
                let most = MOST_NOT_HOMED.value();
                return Err(Refusal::because(format!(
                    "{letter} is not homed: it is jogged by {most:.0}{unit} at most until it is"
                )));
            }
            return Err(Refusal::because(format!(
                "{} would go to {to}: its travel ends at {end}, {left} from here",
                axis.letter()
            )));
        }
        if speed > most {
            let (letter, unit) = (axis.letter(), axis.kind().unit());
            let why = if is_homed { ", its rapid" } else { " until it is homed" };
            return Err(Refusal::because(format!(
                "{letter} is jogged at {:.0}{unit}/min at most{why}",
                most.in_per_min()
            )));
        }
        let limits = OnlineLimits {
            speed: if speed > CoordinateSpeed::ZERO { speed } else { approach }.value(),
            accel: file.acceleration.value(),
            jerk: file.jerk_feed.value(),
        };
        let lease = lease.map(|lasts| self.now() + lasts);
        let ends = (ends.0.value(), ends.1.value());
        let order = ManualOrder { goal, limits, ends, lease };
        self.executor
            .kernel
            .move_manually(axis, order)
            .map_err(|why| refused_by_kernel(why, axis))?;
        self.handwheel[axis.index()] = sent_to;
        self.enter(Mode::Manual);
        Ok(Accepted::default())
    }

    /// All that is moved by hand comes to rest, each axis as hard as it may brake.
    pub(super) fn stop_jog(&mut self) -> Result<Accepted, Refusal> {
        if self.is_referencing() {
            // homing ends where the axes come to rest
            self.to_home.clear();
            self.executor.kernel.order(kernel::Order::FeedHold);
            self.is_resetting = true;
        }
        self.executor.kernel.rest_manually();
        Ok(Accepted::default())
    }

    pub(super) fn turn_spindle(&mut self, spindle: usize, spin: Spin) -> Result<Accepted, Refusal> {
        let file = self.spindle_file(spindle)?;
        if !spin.is_finite() || spin.abs() > file.max {
            let most = file.max.in_rpm();
            return Err(Refusal::because(format!(
                "spindle {spindle} turns at {most:.0} rev/min at most"
            )));
        }
        let until = self.now() + Jog::LEASE;
        let turned = self.executor.kernel.turn_manually(spindle, spin, until);
        self.after_spindle(turned)
    }

    pub(super) fn orient_spindle(
        &mut self,
        spindle: usize,
        angle: Angle,
    ) -> Result<Accepted, Refusal> {
        self.spindle_file(spindle)?;
        let oriented = self.executor.kernel.orient_manually(spindle, angle);
        self.after_spindle(oriented)
    }

    fn after_spindle(&mut self, done: Result<(), ManualRefusal>) -> Result<Accepted, Refusal> {
        done.map_err(|why| refused_by_kernel(why, Axis::Z))?;
        self.data.stop_spindles();
        self.enter(Mode::Manual);
        Ok(Accepted::default())
    }

    fn spindle_file(&self, spindle: usize) -> Result<&store::machine::Spindle, Refusal> {
        let machine = &self.base.machine;
        machine.spindles.get(spindle).ok_or_else(|| {
            let count = machine.spindles.len();
            Refusal::because(format!(
                "{} has no spindle {spindle}: it has {count}, counted from 0",
                machine.name
            ))
        })
    }
}

/// Of what the kernel refuses, for people.
pub(super) fn refused_by_kernel(why: ManualRefusal, axis: Axis) -> Refusal {
    let letter = axis.letter();
    Refusal::because(match why {
        ManualRefusal::NoAxis => format!("there is no axis {letter}"),
        ManualRefusal::NotReady => "the drives are not ready: power on, and wait".into(),
        ManualRefusal::Busy => "a program is executed: wait for its end, or stop it".into(),
        ManualRefusal::Inhibited => "a door or another interlock is open: close it first".into(),
        ManualRefusal::NotANumber => "a jog needs a number".into(),
    })
}
