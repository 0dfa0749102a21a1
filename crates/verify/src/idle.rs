//! Idle turns of a wheel: the contour that its path would have ground, while it stands clear of the
//! work.
//!
//! ```text
//!   X ordered before the turns: x₀, clear of the profile's top T        the wheel moves along x₀ − T + D(θ)
//!   so the work's axis would stand at x₀ − T, and all figures of a ground cam follow; the last whole turn counts
//! ```
use crate::cam::{CamTrack, OrderedCam, Seen, Selected};
use crate::{Config, GroundCam};
use bus::Sample;
use canon::{CamOrder, Op, OpKind};
use std::collections::VecDeque;
use units::Length;

/// A turn and what the interpolation needs on both sides, rev.
const A_TURN: f64 = 1.02;

/// Turns that an order asks for in the air.
#[derive(Clone, Debug)]
struct Idle {
    op: u32,
    ordered: OrderedCam,
    stands: Length,
    seen: VecDeque<Seen>,
}

/// Who looks at idle turns.
#[derive(Clone, Debug)]
pub struct IdleTurns {
    config: Config,
    selected: Selected,
    stands: Length,
    /// The wheel has gone in since the profile was selected.
    in_work: bool,
    turns: Vec<Idle>,
}

impl IdleTurns {
    /// Of these cams.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            selected: Selected::default(),
            stands: Length::ZERO,
            in_work: false,
            turns: Vec::new(),
        }
    }

    /// What the program orders.
    pub fn op(&mut self, index: u32, op: &Op) {
        match &op.kind {
            OpKind::Rapid { to } | OpKind::Line { to, .. } => self.stands = to.linear[0],
            OpKind::Cam(order) => {
                self.in_work |= self.selected.see(order).is_some();
                match *order {
                    CamOrder::Select { .. } | CamOrder::Deselect => self.in_work = false,
                    CamOrder::SparkOut { spin, .. } if !self.in_work => {
                        if let Some(ordered) = self.selected.turned(spin) {
                            let (stands, seen) = (self.stands, VecDeque::new());
                            self.turns.push(Idle { op: index, ordered, stands, seen });
                        }
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }

    /// One servo period.
    pub fn sample(&mut self, sample: &Sample) {
        let Some(idle) = self.turns.iter_mut().find(|idle| idle.op == sample.report.op) else {
            return;
        };
        let seen = Seen::of(sample, idle.ordered.phase());
        idle.seen.push_back(seen);
        while idle.seen.front().is_some_and(|first| (seen.turn - first.turn).abs() > A_TURN) {
            idle.seen.pop_front();
        }
    }

    /// The contours, in the order of the program; those that were not a whole turn have no errors.
    pub fn finish(self) -> Vec<GroundCam> {
        let of = |idle: &Idle| {
            let mut track = CamTrack::new(&idle.ordered);
            for seen in &idle.seen {
                track.see(*seen);
            }
            track.idle(&idle.ordered, &self.config, idle.stands)
        };
        self.turns.iter().map(of).collect()
    }
}
