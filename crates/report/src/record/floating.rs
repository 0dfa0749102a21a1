//! The first tap of a run that is tied to nothing: where the feed held it, and where its holder let
//! it go.
//!
//! ```text
//!   z │╲      ╱      feed          a clutch holder lets the tap pull itself in while the feed stands; a holder with
//!     │ ╲____╱                     tension and compression gives while the feed stops and the spindle still turns
//!     │  ╲╌╌╱        tap
//!     └────────► t
//! ```
use bus::{Sample, State};
use canon::Tap;

/// Rows kept: beyond them every other one is dropped, and from there on only every other one is
/// taken.
const MOST: usize = 4096;

/// A moment of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// Since the machine was started, s.
    pub(crate) time: f64,
    /// Height over the surface at which the feed holds the tip, mm.
    pub(crate) feed: f64,
    /// Height of the tip itself, mm.
    pub(crate) tip: f64,
    /// Speed of the spindle.
    pub(crate) rpm: f64,
}

/// The first tap that is tied to nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Floating {
    tap: Option<(u32, Tap)>,
    moments: Vec<Moment>,
    stride: usize,
    seen: usize,
}

impl Floating {
    /// A period in which `tap` is what the machine works on.
    pub(crate) fn sample(&mut self, tap: &Tap, sample: &Sample) {
        let op = sample.report.op;
        let Some(truth) = &sample.truth else { return };
        let cuts = matches!(sample.report.state, State::Feed | State::Dwell);
        if self.tap.is_none() && cuts {
            self.tap = Some((op, *tap));
            self.stride = 1;
        }
        if self.tap.is_none_or(|(of, _)| of != op) {
            return;
        }
        self.seen += 1;
        if !self.seen.is_multiple_of(self.stride) {
            return;
        }
        // a tap's coordinates are those of its axis: the tool's length is in both
        let held = truth.axes[tap.axis.index()].of_linear() - tap.surface;
        self.moments.push(Moment {
            time: sample.feedback.time.value(),
            feed: held.value(),
            tip: (held + truth.tool_deflection).value(),
            rpm: truth.spins[0].in_rpm(),
        });
        if self.moments.len() > MOST {
            let mut odd = false;
            self.moments.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
    }

    /// The tap and what became of it; `None`: there was none.
    pub(crate) fn seen(&self) -> Option<(&Tap, &[Moment])> {
        let (_, tap) = self.tap.as_ref()?;
        (self.moments.len() > 1).then_some((tap, self.moments.as_slice()))
    }
}
