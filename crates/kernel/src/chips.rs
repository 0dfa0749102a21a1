//! Chip removal under way, and the watch over what it must never do: a cut with the spindle wrong.
//!
//! ```text
//!   Armed ── the axis passes the R plane ──► Against ── −U is reached ──► Back ── `then` is reached ──► (none)
//!     told nothing yet                        told −U                      told +S, or to stop
//! ```
//!
//! It runs beside the steps: the axes rise, move and come down meanwhile. A step that waits for the
//! spindle ([`motion::SpindleStep::AwaitSpeed`]) waits until there is none left, so the cut waits
//! at R if it must.
//!
//! **The watch.** While a cutting move goes on the spindle must turn in the sense that is in force,
//! within the window `in_cut` of its speed, with no chip removal open. It is checked every period,
//! and a breach is alarm 204.
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::event::EventKind;
use crate::fault::FaultKind;
use motion::ChipThrow;
use units::Spin;

/// How far a chip removal is.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // one a spindle, and a box would be freed in the servo thread
enum RemovalStage {
    /// The axis has not passed the level.
    Armed,
    /// Told to run against the cut.
    Against,
    /// Told to run as it shall before the next cut.
    Back,
}

/// One spindle's chip removal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Removal {
    order: ChipThrow,
    stage: RemovalStage,
}

impl Removal {
    pub(crate) const fn new(order: &ChipThrow) -> Self {
        Self { order: *order, stage: RemovalStage::Armed }
    }
}

impl Drives {
    /// Carry a spindle's chip removal on by one period; what has happened.
    pub(crate) fn throw_chips(&mut self, index: usize) -> Option<EventKind> {
        let mut removal = self.removals[index]?;
        let (order, spindle) = (&removal.order, index as u8);
        let passed = self.has_passed(order);
        let control = self.spindles[index].as_mut()?;
        let event = match removal.stage {
            RemovalStage::Armed if passed => {
                control.turn(order.throw, &order.against);
                removal.stage = RemovalStage::Against;
                EventKind::ChipRemovalBegun { spindle, spin: order.throw }
            }
            RemovalStage::Against if control.at_speed().is_some() => {
                control.turn(order.then, &order.back);
                removal.stage = RemovalStage::Back;
                EventKind::ChipsThrown { spindle, spin: order.throw }
            }
            RemovalStage::Back if control.at_speed().is_some() => {
                self.removals[index] = None;
                return Some(EventKind::ChipRemovalEnded { spindle, spin: order.then });
            }
            RemovalStage::Armed | RemovalStage::Against | RemovalStage::Back => return None,
        };
        self.removals[index] = Some(removal);
        Some(event)
    }

    /// The axis is beyond the level, by its encoder, as nearly as "in position" asks.
    fn has_passed(&self, order: &ChipThrow) -> bool {
        let Some(axis) = &self.axes[order.axis.index()] else { return true };
        let beyond = axis.position() - order.level.value();
        let beyond = if order.upwards { beyond } else { -beyond };
        beyond >= -axis.control.windows.in_position.value()
    }

    /// The watch: called in every period of a cutting move.
    pub(crate) fn check_cut(&self) -> Result<(), Finding> {
        for (index, spindle) in self.spindles.iter().enumerate() {
            let Some(spindle) = spindle else { continue };
            let swings = Spin::rev_per_s(spindle.swing.0.rate);
            let wanted = spindle.by_surface().unwrap_or(self.in_force[index] * spindle.share());
            let has = spindle.now().spin - swings;
            let astray = wanted != Spin::ZERO
                && !spindle.is_changing()
                && (has - wanted).abs() > wanted.abs() * spindle.control.windows.in_cut;
            if astray || self.removals[index].is_some() {
                let of = Subject::Spindle(index as u8);
                return Err((FaultKind::WrongSpinInCut, of, has.value(), wanted.value()));
            }
        }
        Ok(())
    }
}
