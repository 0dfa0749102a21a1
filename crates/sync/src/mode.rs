//! Which master a follower obeys.
//!
//! ```text
//!   command-synchronised            encoder-following
//!
//!      planned θ(t)                 planned speed ─► spindle ─► encoder θ
//!       │        │                                               │  n periods on their way
//!       ▼        ▼ g                                  prediction ▼ g
//!    spindle    axis                                           axis
//! ```
//!
//! *Command-synchronised*: the spindle is position-controlled too; both obey one planned trajectory
//! and their loops are matched, so that what is left is disturbance. *Encoder-following*: the
//! spindle is only speed-controlled and the axis runs after what the encoder says. A reading is
//! `transport` periods old when the axis' loop uses it (one where setpoints travel to the drives
//! once a period). At the speed v of the follower the axis therefore lags by
//!
//! ```text
//!   v/Kp + v·Ts    position loop alone            Kp position gain, 1/s
//!          v·Ts    with velocity feed-forward     Ts age of the reading, s
//!            ~0    with a prediction by Ts
//! ```
use units::{Length, Speed, Time};

/// Oldest reading, in periods, that a follower may have to live with.
pub const MAX_TRANSPORT: u8 = 4;

/// Which master the follower obeys. A property of the machine: programs do not change.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SyncMode {
    /// Spindle and axis obey one planned trajectory.
    CommandSynchronised,
    /// The axis obeys the measured angle of a speed-controlled spindle.
    EncoderFollowing {
        /// What is made of the readings.
        prediction: Prediction,
        /// Age of a reading, in periods, when the axis' loop uses it; [`MAX_TRANSPORT`] at most.
        transport: u8,
    },
}

/// What an encoder-following axis makes of the readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Prediction {
    /// Position loop alone on the old angle.
    None,
    /// Velocity feed-forward on the old angle.
    Speed,
    /// Angle, speed and acceleration predicted by an observer for the moment the loop acts; all
    /// feed-forwards.
    Observer,
}

impl Prediction {
    /// The follower's steady lag behind the coupling at a speed: the closed forms above.
    pub fn lag(self, speed: Speed, position_gain: f64, age: Time) -> Length {
        let loop_lag = Length::mm(speed.value() / position_gain);
        match self {
            Self::None => loop_lag + speed * age,
            Self::Speed => speed * age,
            Self::Observer => Length::ZERO,
        }
    }
}
