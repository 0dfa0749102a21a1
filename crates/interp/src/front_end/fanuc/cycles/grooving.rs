//! The lathe's pecking cycles, in two lines: G74 along Z, G75 along X.
//!
//! ```text
//!   G74 R(back)                                 G75: X and Z, P and Q exchanged
//!   G74 X Z P(step across) Q(peck) R(relief) F
//!
//!   start ●─ ─►┐ next column, P further             peck by Q, back by R, … down to Z;
//!         │◄─┐ ▼                                    aside by the relief, rapid out
//!         ▼peck
//! ```
//!
//! The older form has one line: G74 X Z I(step along X) K(step along Z) D(relief) F.
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "End face peck drilling", "Outer
//! diameter drilling".
use crate::{
    call::{Sink, out::Out},
    cycles::turning,
    fault::{Outcome, refuse},
    front_end::fanuc::{
        cycles::lengths::{corner_of, long},
        state::{Fanuc, Said},
    },
    geometry::offset_curve::Flat,
    motion,
    profile::shape::ProfileMove,
    program::Program,
};

/// More pecks than this are a slip of the pen.
const MAX_PECKS: f64 = 10_000.0;

pub(crate) fn pecking<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    code: u16,
    said: &[Said],
    out: &mut Out<'_, S>,
) -> Outcome {
    let has = |letters: &[u8]| said.iter().any(|said| letters.contains(&said.letter));
    let span = it.block.span;
    if !has(b"XZUW") {
        return match long(fanuc, it, said, b'R') {
            Some(back) if back >= 0.0 => {
                fanuc.first_lines.back = back;
                Ok(())
            }
            _ => {
                let text = format!(
                    "the first line of G{} is R alone: how far a peck goes back, 0 or more",
                    fanuc.kind.own(code)
                );
                refuse("I1031", span, text)
            }
        };
    }
    let own = fanuc.kind.own(code);
    motion::check_cycle_feed(&it.executor.words, &it.executor.modes, own)?;
    let at = it.executor.modes.at;
    let start = [at[2], at[0]];
    let end = corner_of(fanuc, it, said);
    let length = |letter: u8| long(fanuc, it, said, letter);
    // in the older form I lies along X and K along Z
    let p = length(b'P').or_else(|| length(b'I')).map(f64::abs);
    let q = length(b'Q').or_else(|| length(b'K')).map(f64::abs);
    let relief = length(b'R').or_else(|| length(b'D')).unwrap_or(0.0);
    // deep: along Z for G74; across: along X
    let [deep, across] = if code == 74 { [0, 1] } else { [1, 0] };
    let (peck, step) = if code == 74 { (q, p) } else { (p, q) };
    let depth = (end[deep] - start[deep]).abs();
    let width = (end[across] - start[across]).abs();
    let peck = peck.filter(|peck| *peck > 0.0).unwrap_or(depth);
    let step = step.filter(|step| *step > 0.0).unwrap_or(width);
    let count = |way: f64, by: f64| if by > 0.0 { (way / by).max(1.0) } else { 1.0 };
    if count(depth, peck) * count(width, step) > MAX_PECKS {
        let text = format!("P and Q would make more than {MAX_PECKS} pecks of G{own}");
        return refuse("I1031", span, text);
    }
    let pecks =
        Pecks { start, end, deep, across, peck, step, relief, back: fanuc.first_lines.back };
    for stroke in pecks.strokes() {
        turning::cut(
            &it.executor.words,
            &mut it.executor.modes,
            &it.executor.settings,
            stroke,
            out,
        )?;
    }
    Ok(())
}

struct Pecks {
    start: Flat,
    end: Flat,
    deep: usize,
    across: usize,
    peck: f64,
    step: f64,
    relief: f64,
    back: f64,
}

impl Pecks {
    fn strokes(&self) -> Vec<ProfileMove> {
        let (deep, across) = (self.deep, self.across);
        let inwards = (self.end[deep] - self.start[deep]).signum();
        let aside = (self.end[across] - self.start[across]).signum();
        let depth = (self.end[deep] - self.start[deep]).abs();
        let width = (self.end[across] - self.start[across]).abs();
        let at = |down: f64, over: f64| -> Flat {
            let mut to = self.start;
            to[deep] += inwards * down;
            to[across] += aside * over;
            to
        };
        let mut strokes = Vec::new();
        let mut over: f64 = 0.0;
        loop {
            let mut down: f64 = 0.0;
            while down < depth {
                down = (down + self.peck).min(depth);
                strokes.push(ProfileMove::Line(at(down, over)));
                if down < depth {
                    strokes.push(ProfileMove::Rapid(at((down - self.back).max(0.0), over)));
                }
            }
            let out = over - self.relief;
            if self.relief != 0.0 {
                strokes.push(ProfileMove::Rapid(at(depth, out)));
            }
            strokes.push(ProfileMove::Rapid(at(0.0, out)));
            if over >= width {
                break;
            }
            over = (over + self.step).min(width);
            strokes.push(ProfileMove::Rapid(at(0.0, over)));
        }
        strokes.push(ProfileMove::Rapid(self.start));
        strokes
    }
}
