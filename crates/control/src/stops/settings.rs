//! What taking a tap out has to know of machine and tools, and the plan that is made from it.
use crate::job::Session;
use crate::recovery;
use bus::Feedback;
use canon::{Axis, ToolKind};
use kernel::RecoveryPlan;
use sync::leaving::{Leaving, Setting};
use sync::recovery::{Point, Seat, Stored, Way};
use units::{Accel, Angle, Length, Speed};

/// Of a machine and its tools.
#[derive(Clone, Debug)]
pub struct RecoverySettings {
    play: Length,
    taps: Vec<(u32, Setting)>,
    /// Most speed and acceleration of an axis that moves alone.
    pub feed: (Speed, Accel),
}

impl RecoverySettings {
    /// Of the session's.
    pub fn new(session: &Session) -> Self {
        let taps = session.tools.iter().filter_map(|tool| match &tool.kind {
            ToolKind::Tap(tap) => Some((
                tool.number,
                Setting {
                    surface: Length::ZERO, // known when it is in the work
                    holder: tap.holder.stiffness(),
                    travel: tap.holder.travel().unwrap_or_default(),
                    diameter: tool.diameter,
                },
            )),
            _ => None,
        });
        let approach = session.machine.axis(Axis::Z).map(|z| z.approach);
        let slow = Speed::mm_per_s(2.0);
        Self {
            play: session.machine.simulation.tap_seat.flank_clearance,
            taps: taps.collect(),
            feed: approach.map_or((slow, Accel::mm_per_s2(100.0)), |approach| {
                (approach.speed.of_linear().min(slow), approach.acceleration.of_linear() * 0.1)
            }),
        }
    }

    /// Nothing is known.
    pub(super) const fn none() -> Self {
        Self { play: Length::ZERO, taps: Vec::new(), feed: (Speed::ZERO, Accel::ZERO) }
    }

    /// How a tap that stands in its thread is taken out.
    ///
    /// # Errors
    /// Why that is not safe.
    pub fn plan(
        &self,
        stored: Stored,
        surface: Length,
        now: &Feedback,
    ) -> Result<RecoveryPlan, String> {
        let tool = now.tool.unwrap_or(0);
        let setting = self.taps.iter().find(|(number, _)| *number == tool);
        let setting = setting.map(|(_, setting)| Setting { surface, ..*setting });
        let way = match setting {
            None => Way::Direct,
            Some(setting) => {
                let at =
                    Point { angle: now.spindles[0].angle, place: now.axes[2].position.of_linear() };
                match stored.leaving(at, &setting).map_err(|why| why.to_string())? {
                    Leaving::Straight => Way::Straight,
                    Leaving::Along => {
                        Way::UnloadFirst(Seat { play: self.play, is_stiff: setting.is_stiff() })
                    }
                }
            }
        };
        Ok(RecoveryPlan {
            axis: Axis::Z,
            spindle: 0,
            stored,
            turn: Angle::ZERO,
            way,
            spin: recovery::OUT,
            feed: self.feed,
        })
    }
}
