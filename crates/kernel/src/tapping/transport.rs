//! Readings of the master on their way to the follower.
use crate::spindle::SpindleLoop;
use sync::{MAX_TRANSPORT, Prediction, Rotation, SyncMode};
use units::Time;

/// How the master turns: what the cycle decides by, and what the axis obeys.
#[derive(Clone, Copy, Debug)]
pub(super) struct Master {
    pub(super) seen: Rotation,
    pub(super) followed: Rotation,
}

/// A ring of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transport {
    readings: [Master; MAX_TRANSPORT as usize + 1],
    age: usize,
}

impl Transport {
    /// As if it had always turned like this; readings arrive so many periods later.
    pub(super) fn new(spindle: &SpindleLoop, age: u8) -> Self {
        let first = Master { seen: spindle.now(), followed: spindle.followed() };
        let age = usize::from(age.min(MAX_TRANSPORT));
        Self { readings: [first; MAX_TRANSPORT as usize + 1], age }
    }

    /// The master that an encoder-following axis obeys: the reading that has arrived, or what it
    /// predicts.
    pub(super) fn master(&mut self, mode: SyncMode, spindle: &SpindleLoop, period: Time) -> Master {
        let (seen, followed) = (spindle.now(), spindle.followed());
        match mode {
            SyncMode::CommandSynchronised => Master { seen, followed: seen },
            SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport } => {
                let arrived = self.pass(Master { seen, followed });
                let age = period * f64::from(transport);
                Master { seen: arrived.seen.after(age), followed: arrived.followed.after(age) }
            }
            SyncMode::EncoderFollowing { .. } => {
                let raw = Rotation { angle: spindle.reading(), ..seen };
                self.pass(Master { seen: raw, followed: raw })
            }
        }
    }

    /// Send one off; the one that arrives.
    fn pass(&mut self, reading: Master) -> Master {
        self.readings.rotate_right(1);
        self.readings[0] = reading;
        self.readings[self.age]
    }
}
