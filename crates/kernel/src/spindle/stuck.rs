//! An encoder whose reading stays while its drive pushes.
//!
//! ```text
//!   torque │              ╭──────  beyond what friction bears: it turns, whatever is read
//!          │         ╭────╯╌╌╌╌╌╌  G
//!          │    ╭────╯             φ = ∬ (min(|M|, |M − M₀|) − G)/J,  stuck: φ > φ₁
//!          │ ───╯ M₀, at the last change of the reading
//!          └────────────────────► time
//! ```
//!
//! A speed loop that reads no motion gives all its torque, and a spindle that is read by a stuck
//! encoder runs up to where its drive ends. Friction bears a change of the torque up to twice
//! itself; what is beyond turns the spindle, as fast as its inertia lets it.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | M, M₀ | torque of the drive, when the reading has changed last | N·m |
//! | G | change of the torque that friction may bear | N·m |
//! | J | inertia | N·m per rev/s² |
//! | φ, φ₁ | angle by which it must have turned, angle at which it is stuck | rev |
//!
//! A work of ten times the inertia turns by a tenth of φ, which is more than the noise of the
//! reading. A tap in its thread may be held by the thread: there G is larger by [`IN_THREAD`]. A
//! spindle that is blocked is found as well. A drive that is commanded a speed or an angle does not
//! run up by what the control reads; it is not watched. Nor is one that shall not turn and is where
//! it shall be.
//!
//! **At rest** nothing needs to move, and a reading that stays is no fault: friction, or a clamp,
//! holds the spindle against a loop that integrates the error of a count. The torque is bounded
//! there, below what would be found above.
//!
//! ```text
//!   held at an angle    M₀ ± 0.95·G for 10 ms, in which a loop overcomes friction; then what friction
//!                       bears, half of it after each tenth of a second, or the load that was borne
//!   commanded to stand  after half a second what friction bears, and half of it after each half
//! ```
use super::{SpindleLoop, Task};
use crate::config::SpindleControl;
use units::Spin;

/// Share of the peak torque by which a thread may hold a tap.
const IN_THREAD: f64 = 0.25;
/// Share of G within which the torque stays while the spindle is held.
const HELD_SHARE: f64 = 0.95;
/// Time in which a loop overcomes friction, s; and in which the bound becomes half.
const SETTLES_S: f64 = 0.01;
const HELD_HALF_S: f64 = 0.1;
/// Time over which the load on a spindle that is held is averaged, s.
const LOAD_S: f64 = 0.5;
/// Time after which a spindle that stands under speed control is bounded, s; and in which the bound
/// becomes half.
const STANDS_S: f64 = 0.5;
/// Torque that friction bears for certain, as a share of its constant part.
const STICTION_SHARE: f64 = 0.4;
/// Torque that friction may bear, over its constant part, and as a share of the peak torque.
const PUSHES: f64 = 3.0;
const LEAST_PUSH: f64 = 0.02;
/// Angle by which it must have turned, rev and counts.
const TURNED: f64 = 0.02;
const TURNED_COUNTS: f64 = 32.0;
/// Change of a reading that is noise, counts.
const NOISE_COUNTS: f64 = 2.0;

/// A reading since its last change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unanswered {
    /// The reading, rev, and the torque at that time, N·m; `None`: it has not been read yet.
    since: Option<(f64, f64)>,
    /// Speed, rev/s, and angle, rev, that the torque has given since, beyond friction.
    spin: f64,
    turned: f64,
}

impl Unanswered {
    pub(super) const NONE: Self = Self { since: None, spin: 0.0, turned: 0.0 };

    /// A servo period; returns true if the encoder is stuck.
    fn advance(
        &mut self,
        (reading, torque): (f64, f64),
        (control, is_tied): (&SpindleControl, bool),
        (inertia, period_s): (f64, f64),
    ) -> bool {
        let count = control.encoder_count.value();
        let unchanged = self.since.filter(|(at, _)| (reading - at).abs() <= NOISE_COUNTS * count);
        let Some((_, before)) = unchanged else {
            *self = Self { since: Some((reading, torque)), ..Self::NONE };
            return false;
        };
        let by_thread = if is_tied { IN_THREAD * control.peak_torque.value() } else { 0.0 };
        // one that has just been braked gives less than at its last change, and one that bears a
        // load as much
        let change = torque.abs().min((torque - before).abs());
        let beyond = change - borne(control) - by_thread;
        if beyond <= 0.0 {
            (self.spin, self.turned) = (0.0, 0.0);
            return false;
        }
        self.spin += beyond / inertia * period_s;
        self.turned += self.spin * period_s;
        self.turned > TURNED.max(TURNED_COUNTS * count)
    }
}

/// G: change of the torque that friction may bear, N·m.
fn borne(control: &SpindleControl) -> f64 {
    let by_friction = PUSHES * control.friction.coulomb.value();
    by_friction.max(LEAST_PUSH * control.peak_torque.value())
}

/// A spindle at rest whose reading has not changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resting {
    reading: f64,
    /// Torque at its last change, N·m, and periods since.
    torque: f64,
    periods: u32,
    /// Mean torque while the reading changed, N·m.
    load: f64,
}

impl Resting {
    pub(super) const NONE: Self = Self { reading: f64::NAN, torque: 0.0, periods: 0, load: 0.0 };

    /// A servo period of a spindle that rests: the least and the most torque of its drive.
    fn advance(
        &mut self,
        (reading, torque): (f64, f64),
        control: &SpindleControl,
        (is_held, period_s): (bool, f64),
    ) -> (f64, f64) {
        if reading != self.reading {
            *self = Self { reading, torque, periods: 0, load: self.load };
        }
        self.periods = self.periods.saturating_add(1);
        let (lasts_s, change) = (f64::from(self.periods) * period_s, borne(control));
        let friction = change / PUSHES;
        let most = match is_held {
            true if lasts_s < SETTLES_S => {
                self.load += (torque - self.load) * period_s / LOAD_S;
                let change = HELD_SHARE * change;
                return (self.torque - change, self.torque + change);
            }
            true => {
                let halves = (lasts_s - SETTLES_S) / HELD_HALF_S;
                (STICTION_SHARE * friction * libm::exp2(-halves)).max(self.load.abs())
            }
            false if lasts_s < STANDS_S => f64::INFINITY,
            false => STICTION_SHARE * friction * libm::exp2(1.0 - lasts_s / STANDS_S),
        };
        (-most, most)
    }
}

impl SpindleLoop {
    /// Returns the least and the most torque that its drive may give in this period; `limit`: what
    /// it can give at its speed, `way`: that of the setpoint, rev.
    pub(super) fn torque_limits(&mut self, way: f64, limit: f64) -> (f64, f64) {
        let is_held = self.position_controlled();
        let stands = matches!(self.order, Task::Held | Task::Slew(0.0)) && way == 0.0;
        let within = !is_held || self.error.abs() <= self.control.windows.oriented.value();
        if !(stands && within && self.ordered.spin == Spin::ZERO) {
            self.resting = Resting::NONE;
            return (-limit, limit);
        }
        let (read, times) = ((self.reading, self.torque), (is_held, self.period_s));
        let (least, most) = self.resting.advance(read, &self.control, times);
        (least.clamp(-limit, limit), most.clamp(-limit, limit))
    }

    /// Takes note of a reading of this period; returns true if its encoder is stuck. `is_tied`: a
    /// tap or a thread ties an axis to the spindle.
    pub(crate) fn notes_stuck(&mut self, reading: f64, is_tied: bool) -> bool {
        let control = &self.control;
        let by_torque = control.own_ramps.is_none() && !control.closes_position;
        let is_off = self.error().abs() > control.windows.oriented.value();
        let shall_turn = self.ordered.spin != Spin::ZERO || is_off;
        let is_watched = by_torque && control.follows_orders && self.sight.is_closed();
        if !(is_watched && shall_turn && reading.is_finite()) {
            let since = Some((reading, self.torque)).filter(|_| is_watched);
            self.unanswered = Unanswered { since, ..Unanswered::NONE };
            return false;
        }
        let times = (self.inertia, self.period_s);
        self.unanswered.advance((reading, self.torque), (control, is_tied), times)
    }
}
