//! Threads whose lead grows or shrinks: G34.
//!
//! ```text
//!   G34 X Z F(lead) K(growth)      after n turns z = F·n + K·n²/2, along the axis that goes farther
//!                                  its lead is then F + K·n, and √(F² + 2·K·z) at z: it has to stay above zero
//! ```
//!
//! G34 is modal, as G32 is: `Z` and `X` alone in the blocks after it turn on, with the F in force.
//! A K that is left out is zero, so that the lead stays as it is.
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "Variable lead threading".
use crate::{
    call::{Call, GrowingThread, Sink, out::Out},
    codes::{number::tenths, spelling::short},
    dialect::fanuc::codes::{Meaning, meaning},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        cycles::{
            lengths::{corner_of, word},
            threading::{angle, turning},
        },
        state::{Fanuc, Said},
        words::{
            self,
            read::{start_angle, thread_lead},
        },
    },
    modes::Motion,
    motion::threads::along_path,
    program::Program,
};
use diag::Span;

/// More turns than this are a slip of the pen.
const MOST: f64 = 10_000.0;

/// Whether the block at hand goes on with the G34 before it.
pub(crate) fn grows_on(fanuc: &Fanuc) -> bool {
    let moves = |said: &Said| b"XZUW".contains(&said.letter);
    let takes = |said: &Said| match (said.letter, tenths(said.value)) {
        (b'G', Some(code)) => takes_axes(fanuc, code),
        _ => false,
    };
    let on = fanuc.growing && fanuc.surface.is_none();
    on && fanuc.said.iter().any(moves) && !fanuc.said.iter().any(takes)
}

/// Whether a code says what the axis words of its block are.
fn takes_axes(fanuc: &Fanuc, tenths: u16) -> bool {
    match meaning(fanuc.kind, tenths) {
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
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    said: &[Said],
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = it.block.span;
    let lead = word(said, b'F').map(|f| thread_lead(fanuc, f)).or(fanuc.lead);
    let Some(lead) = lead else { return Err(words::no_lead(span).into()) };
    if lead <= 0.0 {
        let span = word(said, b'F').map_or(span, |f| f.span);
        let text = format!("F is the lead where the thread begins, above 0, found {}", short(lead));
        return refuse("I0426", span, text);
    }
    (fanuc.lead, fanuc.growing) = (Some(lead), true);
    it.executor.modes.motion = Motion::Thread;
    let growth = word(said, b'K').map_or(0.0, |k| thread_lead(fanuc, k));
    turning(&it.executor, span)?;
    let from = it.executor.modes.at;
    let [z, x] = corner_of(fanuc, it, said);
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
    angle(start_angle(fanuc, said), out);
    ex.modes.at = to;
    out.say(&Call::GrowingThread(thread));
    Ok(())
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
