//! Threads whose lead grows or shrinks: G34.
//!
//! ```text
//!   G34 X Z F(lead) K(growth)      after n turns z = F·n + K·n²/2, along the axis that goes farther
//!                                  its lead is then F + K·n, and √(F² + 2·K·z) at z: it has to stay above zero
//! ```
//!
//! G34 is modal, as G32 is: `Z` and `X` alone in the blocks after it turn on, with the F in force. A K that is left out is zero, so
//! that the lead stays as it is.
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "Variable lead threading".
use crate::{
    call::{Call, GrowingThread, Sink, out::Out},
    codes::{number::tenths, spelling::short},
    dialect::fanuc::codes::{Meaning, meaning},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        cycles::{
            threading::{angle, turning},
            turning::word,
        },
        state::{Fanuc, Said},
        words,
    },
    modes::Motion,
    motion::threads::along_path,
    program::Program,
};
use diag::Span;

/// More turns than this are a slip of the pen.
const MOST: f64 = 10_000.0;

impl Fanuc {
    /// Whether the block at hand goes on with the G34 before it.
    pub(crate) fn grows_on(&self) -> bool {
        let moves = |said: &Said| b"XZUW".contains(&said.letter);
        let takes = |said: &Said| match (said.letter, tenths(said.value)) {
            (b'G', Some(code)) => self.takes_axes(code),
            _ => false,
        };
        let on = self.growing && self.surface.is_none();
        on && self.said.iter().any(moves) && !self.said.iter().any(takes)
    }

    /// Whether a code says what the axis words of its block are.
    fn takes_axes(&self, tenths: u16) -> bool {
        match meaning(self.kind, tenths) {
            Meaning::Shared(code) => {
                matches!(code, 0..=40 | 100 | 280 | 300 | 520 | 530 | 730..=890 | 920)
                    || code >= crate::codes::OWN
            }
            Meaning::Thread | Meaning::Box(_) | Meaning::Multiple(_) => true,
            Meaning::Back | Meaning::Skip | Meaning::Check | Meaning::Longer(_) => true,
            Meaning::Mapping(_) | Meaning::StrokeCheck(_) => true,
            Meaning::Cylinder | Meaning::Face(_) => true,
            Meaning::NotYet(_) | Meaning::Unknown | Meaning::Circle(_) => true,
            Meaning::WorkOffset(_) | Meaning::Smoothness => false,
            Meaning::Smoothing | Meaning::ExactBlock | Meaning::Off => false,
        }
    }

    /// G34.
    pub(crate) fn growing_thread<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        said: &[Said],
        out: &mut Out<'_, S>,
    ) -> Outcome {
        let span = it.block.span;
        let lead = word(said, b'F').map(|f| self.thread_lead(f)).or(self.lead);
        let Some(lead) = lead else { return Err(words::no_lead(span).into()) };
        if lead <= 0.0 {
            let span = word(said, b'F').map_or(span, |f| f.span);
            let text =
                format!("F is the lead where the thread begins, above 0, found {}", short(lead));
            return refuse("I0426", span, text);
        }
        (self.lead, self.growing) = (Some(lead), true);
        it.executor.modes.motion = Motion::Thread;
        let growth = word(said, b'K').map_or(0.0, |k| self.thread_lead(k));
        turning(&it.executor, span)?;
        let from = it.executor.modes.at;
        let [z, x] = self.corner_of(it, said);
        let mut to = from;
        (to[0], to[2]) = (x, z);
        let far = (to[0] - from[0]).abs().max((to[2] - from[2]).abs());
        if far == 0.0 {
            let text = "G34 needs an end, in X or Z, that is not where it begins";
            return refuse("I0423", span, text);
        }
        let inch = it.executor.modes.units == crate::Units::Inch;
        lasts(lead, growth, far, inch, word(said, b'K').map_or(span, |k| k.span))?;
        let [path_lead, path_growth] = [lead, growth].map(|lead| along_path(lead, &from, &to));
        let thread = GrowingThread { from, to, lead: path_lead, growth: path_growth };
        if thread.count() > MOST {
            let text = format!(
                "G34 would make {} turns, and {MOST} are as many as a thread has",
                thread.count().ceil()
            );
            return refuse("I1034", span, text);
        }
        let ex = &mut it.executor;
        angle(self.start_angle(said), out);
        ex.modes.at = to;
        out.say(&Call::GrowingThread(thread));
        Ok(())
    }
}

/// Whether the lead stays above zero as far as the thread goes.
fn lasts(lead: f64, growth: f64, far: f64, inch: bool, span: Span) -> Outcome {
    if growth >= 0.0 || lead * lead > -2.0 * growth * far {
        return Ok(());
    }
    // towards zero, so that it works as it is written
    let digits = if inch { 1e6 } else { 1e4 };
    let works = (lead * lead / (2.0 * far) * digits - 0.5).floor().max(0.0) / digits;
    let text = format!(
        "the lead of {} shrinks to nothing after {} of {}: K takes {} from it in each turn",
        short(lead),
        short(lead * lead / (-2.0 * growth)),
        short(far),
        short(-growth)
    );
    Err(error("I1034", span, text).with_help(format!("K-{works} works")).into())
}
