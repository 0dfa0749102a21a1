//! Threads of a lathe that take more than one line: G76.
//!
//! ```text
//!   G76 P(m r a) Q(least) R(left)         m finishing passes, r pull-off in tenths of the lead, a angle of the tool
//!   G76 X Z R(taper) P(height) Q(first) F(lead)
//!   G76 X Z I(taper) K(height) D(first) F A(angle)      the older form, in one line
//!
//!   depth of pass n: first·√n, each at least `least` deeper than the one before, to height − left; then m at the full height.
//!   The passes go in along the thread's flank: each begins depth·tan(a/2) further on.
//! ```
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "Multiple threading cycle".
use crate::{
    call::{Call, Sink, out::Out},
    fault::{Outcome, refuse},
    front_end::fanuc::{
        cycles::lengths::{corner_of, long, word},
        state::{Fanuc, Said},
        words::{self, read::thread_lead},
    },
    geometry::{
        frame::Point,
        offset_curve::{Flat, length, minus},
    },
    motion::threads::along_path,
    program::Program,
    state::executor::Executor,
};

/// More passes than this are a slip of the pen.
const MOST: f64 = 10_000.0;

/// G76 with its words read; lengths are radii.
struct Thread {
    start: Flat,
    /// The thread's root at its end.
    end: Flat,
    height: f64,
    first: f64,
    least: f64,
    left: f64,
    finishing: u32,
    /// Tangent of half the tool's angle.
    slant: f64,
    pull_off: f64,
    taper: f64,
    lead: f64,
}

pub(crate) fn thread_passes<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    said: &[Said],
    out: &mut Out<'_, S>,
) -> Outcome {
    if !said.iter().any(|said| b"XZUW".contains(&said.letter)) {
        return thread_first_line(fanuc, it, said);
    }
    let thread = thread_words(fanuc, it, said)?;
    turning(&it.executor, it.block.span)?;
    for depth in thread.depths() {
        thread.pass(&mut it.executor, depth, out);
    }
    Ok(())
}

/// P, Q, R of the first line.
fn thread_first_line(fanuc: &mut Fanuc, it: &Program<'_>, said: &[Said]) -> Outcome {
    let [finishing, pull_off, angle, least, left] =
        fanuc.first_lines.thread.unwrap_or([1.0, 0.0, 60.0, 0.0, 0.0]);
    let digits = word(said, b'P').map(|said| (said.value, said.span));
    let [finishing, pull_off, angle] = match digits {
        None => [finishing, pull_off, angle],
        Some((value, span)) => {
            let whole = value.round();
            let known = (10_000.0..=999_999.0).contains(&whole) && whole == value;
            let angle = whole % 100.0;
            if !known || ![0.0, 29.0, 30.0, 55.0, 60.0, 80.0].contains(&angle) {
                let code = fanuc.kind.own(76);
                let text = format!(
                    "P of G{code}'s first line is six digits: passes (01 to 99), pull-off in tenths of the lead, angle (80, 60, 55, 30, 29 or 00); found {value}"
                );
                return refuse("I1031", span, text);
            }
            [(whole / 10_000.0).floor(), (whole / 100.0).floor() % 100.0, angle]
        }
    };
    let least = long(fanuc, it, said, b'Q').unwrap_or(least);
    let left = long(fanuc, it, said, b'R').unwrap_or(left);
    fanuc.first_lines.thread = Some([finishing, pull_off, angle, least.abs(), left.abs()]);
    Ok(())
}

fn thread_words(fanuc: &mut Fanuc, it: &Program<'_>, said: &[Said]) -> Outcome<Thread> {
    let (span, code) = (it.block.span, fanuc.kind.own(76));
    let older = word(said, b'D').is_some() || word(said, b'K').is_some();
    let own = if older { Some(one_line(fanuc, said)?) } else { fanuc.first_lines.thread };
    let Some([finishing, pull_off, angle, least, left]) = own else {
        let text = format!(
            "G{code} does not know its passes: write a line such as G{code} P010060 Q100 R0.05 before it"
        );
        return refuse("I1031", span, text);
    };
    let at = it.executor.modes.at;
    let lead = word(said, b'F').map(|f| thread_lead(fanuc, f)).or(fanuc.lead);
    let Some(lead) = lead.filter(|lead| *lead > 0.0) else {
        return Err(words::no_lead(span).into());
    };
    fanuc.lead = Some(lead);
    let letters = if older { [b'K', b'D'] } else { [b'P', b'Q'] };
    let [height, first] = letters.map(|letter| long(fanuc, it, said, letter));
    let (Some(height), Some(first)) = (height.filter(|h| *h > 0.0), first.filter(|q| *q > 0.0))
    else {
        let [height, first] = letters.map(char::from);
        let text = format!(
            "G{code} needs {height}, the thread's height, and {first}, the depth of the first pass, both above 0"
        );
        return refuse("I1031", span, text);
    };
    let thread = Thread {
        start: [at[2], at[0]],
        end: corner_of(fanuc, it, said),
        height,
        first,
        least,
        left: left.min(height),
        finishing: finishing as u32,
        slant: (angle / 2.0).to_radians().tan(),
        pull_off: pull_off / 10.0 * lead,
        taper: long(fanuc, it, said, if older { b'I' } else { b'R' }).unwrap_or(0.0),
        lead,
    };
    if thread.start[1] == thread.end[1] || thread.start[0] == thread.end[0] {
        let text = format!(
            "G{code} begins beside the thread's end: its start must differ from X and from Z"
        );
        return refuse("I1031", span, text);
    }
    if thread.depths().len() as f64 > MOST {
        let text = format!("Q would make more than {MOST} passes of G{code}");
        return refuse("I1031", span, text);
    }
    Ok(thread)
}

/// What the older form leaves to what was said before: one finishing pass, no pull-off; A is the
/// tool's angle.
fn one_line(fanuc: &Fanuc, said: &[Said]) -> Outcome<[f64; 5]> {
    if let Some(way) = word(said, b'P').filter(|way| way.value != 1.0) {
        let text =
            format!("P{} is another way of going in: P1, along one flank, is known", way.value);
        return refuse("I1031", way.span, text);
    }
    let mut thread = fanuc.first_lines.thread.unwrap_or([1.0, 0.0, 60.0, 0.0, 0.0]);
    if let Some(angle) = word(said, b'A') {
        if !(0.0..=120.0).contains(&angle.value) {
            let found = angle.value;
            let text =
                format!("A is the angle of the thread's tool, 0 to 120 degrees, found {found}");
            return refuse("I1031", angle.span, text);
        }
        thread[2] = angle.value;
    }
    Ok(thread)
}

/// Say where in the spindle's turn the thread that follows begins, if it is said.
pub(crate) fn angle<S: Sink>(degrees: Option<f64>, out: &mut Out<'_, S>) {
    if let Some(degrees) = degrees {
        out.say(&Call::ThreadAngle(degrees));
    }
}

pub(crate) fn turning(ex: &Executor, span: diag::Span) -> Outcome {
    match ex.modes.spindle.turning {
        Some(_) => Ok(()),
        None => refuse(
            "I0427",
            span,
            "a thread needs a turning spindle: write M3 or M4, and S, before it",
        ),
    }
}

impl Thread {
    /// Depth of each pass.
    fn depths(&self) -> Vec<f64> {
        let rough = self.height - self.left;
        let (mut depths, mut depth) = (Vec::new(), 0.0);
        let mut n = 0.0;
        while depth < rough && (depths.len() as f64) <= MOST {
            n += 1.0;
            depth = (self.first * f64::sqrt(n)).max(depth + self.least).min(rough);
            depths.push(depth);
        }
        depths.extend(std::iter::repeat_n(self.height, self.finishing as usize));
        depths
    }

    fn pass<S: Sink>(&self, ex: &mut Executor, depth: f64, out: &mut Out<'_, S>) {
        let outwards = (self.start[1] - self.end[1]).signum();
        let onwards = (self.end[0] - self.start[0]).signum();
        let point = |[z, x]: Flat| -> Point {
            let mut to = ex.modes.at;
            (to[0], to[2]) = (x, z);
            to
        };
        let begin = self.start[0] + onwards * depth * self.slant;
        let floor = self.end[1] + outwards * (self.height - depth);
        let first = [begin, floor + self.taper];
        let last = [self.end[0], floor];
        out.say(&Call::Rapid(point([begin, self.start[1]])));
        out.say(&Call::Rapid(point(first)));
        let mut cut = |from: Flat, to: Flat| {
            let [from, to] = [point(from), point(to)];
            out.say(&Call::SyncStart(along_path(self.lead, &from, &to)));
            out.say(&Call::Line(to));
        };
        let pull = self.pull_off.min(length(minus(last, first)));
        if pull > 0.0 {
            let part = 1.0 - pull / (last[0] - first[0]).abs().max(pull);
            let leave =
                [first[0] + part * (last[0] - first[0]), first[1] + part * (last[1] - first[1])];
            cut(first, leave);
            cut(leave, [last[0], last[1] + outwards * pull]);
        } else {
            cut(first, last);
        }
        out.say(&Call::SyncStop);
        out.say(&Call::Rapid(point([self.end[0], self.start[1]])));
        out.say(&Call::Rapid(point(self.start)));
    }
}
