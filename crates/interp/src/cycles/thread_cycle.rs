//! G76: a thread cut on a lathe in several passes, each deeper than the one before.
//!
//! ```text
//!        drive line   x0 ─●───────────────────────────●─  clear of pass n: K − dₙ away from the drive line
//!                         │            I              ╱│
//!        peak of thread ──●╲─────────────────────────●─   (tapers over E if L is 1, 2, 3)
//!                           ╲──────────●────────────╱     dₙ = min(K, J·n^(1/R)) below the peak
//!                         z0 − dₙ·tan Q          ze + (K − dₙ)·tan Q
//! ```
//!
//! `P` lead · `I` from the drive line to the peak (negative: external) · `J` depth of the first
//! pass, `K` of the whole thread · `R` degression (1: equal depths; 2: equal areas) · `Q` angle of
//! the compound slide · `H` spring passes · `E` length of a taper, `L` where: 0 none, 1 entry, 2
//! exit, 3 both.
//!
//! Source: LinuxCNC 2.9 manual, "G76 Threading Cycle".
use crate::{
    call::{Call, Sink, out::Out},
    codes::spelling::short,
    coordinates::target,
    fault::{Outcome, error, refuse},
    geometry::frame::Point,
    modes::Modes,
    words::Words,
};
use canon::Plane;

/// More passes than this are a slip of the pen.
const MAX_PASSES: u32 = 1_000;
/// A compound slide stands at 30° or so; from here on the passes would walk off.
const MAX_SLIDE_ANGLE: f64 = 80.0;

/// The cycle with its words read and checked; lengths are radii.
struct Threading {
    lead: f64,
    peak: f64,
    first: f64,
    full: f64,
    degression: f64,
    /// Slope of the compound slide, signed against the cut.
    slide_tan: f64,
    springs: u32,
    /// Length of a taper along the thread, signed as the cut goes.
    taper: f64,
    entry: bool,
    exit: bool,
    /// X and Z of the start, Z of the end.
    x: f64,
    from: f64,
    to: f64,
}

/// G76.
pub(crate) fn thread_cycle<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let thread = threading(words, modes)?;
    let passes = thread.passes();
    if passes > MAX_PASSES {
        let text = format!("J would make more than {MAX_PASSES} passes");
        return refuse("I0521", words.span(b'J'), text);
    }
    for pass in 1..=passes + thread.springs {
        cut_pass(modes, &thread, thread.depth(pass), out);
    }
    modes.at[0] = thread.x;
    modes.at[2] = thread.to;
    out.say(&Call::Rapid(modes.at));
    Ok(())
}

fn threading(words: &Words, modes: &Modes) -> Outcome<Threading> {
    let block = words.place.span;
    if modes.plane != Plane::ZX {
        return refuse(
            "I0522",
            block,
            "G76 cuts a thread along Z with X across it: write G18 before",
        );
    }
    if modes.spindle.turning.is_none() {
        return refuse(
            "I0523",
            block,
            "G76 needs a turning spindle: write M3 or M4, and S, before it",
        );
    }
    let [lead, peak, first, full] = profile(words, modes)?;
    if target::axis_word(words, modes, 2).is_none() {
        return refuse("I0526", block, "G76 needs Z, the end of the thread");
    }
    let degression = words.get(b'R').unwrap_or(1.0);
    if degression < 1.0 {
        let text = format!(
            "R tells how the passes get thinner: 1 (all alike) or more, found {degression}"
        );
        return refuse("I0527", words.span(b'R'), text);
    }
    let slide = words.get(b'Q').unwrap_or(0.0);
    if !(0.0..=MAX_SLIDE_ANGLE).contains(&slide) {
        let text = format!(
            "Q is the angle of the compound slide, 0 to {MAX_SLIDE_ANGLE} degrees, found {slide}"
        );
        return refuse("I0528", words.span(b'Q'), text);
    }
    let tapers = words.whole(b'L', 3)?.unwrap_or(0);
    let (from, to) = (modes.at[2], target::destination(words, modes, false)?[2]);
    let thread = Threading {
        lead,
        peak,
        first,
        full,
        degression,
        slide_tan: slide.to_radians().tan() * (from - to).signum(),
        springs: words.whole(b'H', MAX_PASSES)?.unwrap_or(0),
        taper: words.get(b'E').unwrap_or(0.0),
        entry: tapers & 1 != 0,
        exit: tapers & 2 != 0,
        x: modes.at[0],
        from,
        to,
    };
    with_taper(words, thread, tapers)
}

/// P, I, J, K: lead, and as radii the peak, the first depth and the full depth.
fn profile(words: &Words, modes: &Modes) -> Outcome<[f64; 4]> {
    let across = if modes.diameter { 0.5 } else { 1.0 };
    let [lead, peak, first, full] = [b'P', b'I', b'J', b'K'].map(|letter| words.get(letter));
    let lead = positive(words, b'P', lead, "the lead")?;
    let first = positive(words, b'J', first, "the depth of the first pass")? * across;
    let full = positive(words, b'K', full, "the full depth")? * across;
    let peak = match peak {
        Some(peak) if peak != 0.0 => peak * across,
        _ => {
            let text = "G76 needs I, from here to the thread's peak: negative for an external thread, not 0";
            return refuse("I0524", words.span(b'I'), text);
        }
    };
    if first >= full {
        let text =
            format!("the first pass (J) must be less deep than the thread (K): {first} and {full}");
        return refuse("I0525", words.span(b'J'), text);
    }
    Ok([lead, peak, first, full])
}

fn positive(words: &Words, letter: u8, value: Option<f64>, what: &str) -> Outcome<f64> {
    match value {
        Some(value) if value > 0.0 => Ok(value),
        Some(value) => {
            let text = format!("{} is {what}, above 0, found {value}", letter as char);
            refuse("I0529", words.span(letter), text)
        }
        None => refuse("I0530", words.place.span, format!("G76 needs {}, {what}", letter as char)),
    }
}

/// Check the tapers against the thread's length and turn them the way of the cut.
fn with_taper(words: &Words, mut thread: Threading, tapers: u32) -> Outcome<Threading> {
    if tapers == 0 {
        return Ok(thread);
    }
    let room = (thread.to - thread.from).abs() / f64::from(tapers.count_ones());
    if !(thread.taper > 0.0 && thread.taper < room) {
        let (room, found) = (short(room), short(thread.taper));
        let text = if room > 0.0 {
            format!("E, the length of a taper, must be above 0 and below {room}, found {found}")
        } else {
            "a taper needs a thread of some length: Z is where the tool stands".to_owned()
        };
        let fault = error("I0531", words.span(b'E'), text);
        return Err(fault.with_help("L0 leaves the tapers out").into());
    }
    thread.taper *= (thread.to - thread.from).signum();
    Ok(thread)
}

fn cut_pass<S: Sink>(modes: &Modes, thread: &Threading, depth: f64, out: &mut Out<'_, S>) {
    let outwards = -thread.peak.signum();
    let left = thread.full - depth;
    let clear = thread.x + outwards * left;
    let peak = clear + thread.peak;
    let cut = thread.x + thread.peak - outwards * depth;
    let from = thread.from - depth * thread.slide_tan;
    let to = thread.to + left * thread.slide_tan;
    let at = |x: f64, z: f64| -> Point {
        let mut point = modes.at;
        (point[0], point[2]) = (x, z);
        point
    };
    let tapered = thread.lead * (thread.full / thread.taper).hypot(1.0);
    out.say(&Call::Rapid(at(clear, from)));
    if thread.entry {
        out.say(&Call::FeedOverride(false));
        out.say(&Call::SyncStart(tapered));
        out.say(&Call::Line(at(peak, from)));
        out.say(&Call::Line(at(cut, from + thread.taper)));
    } else {
        out.say(&Call::Rapid(at(cut, from)));
        out.say(&Call::FeedOverride(false));
    }
    out.say(&Call::SyncStart(thread.lead));
    if thread.exit {
        out.say(&Call::Line(at(cut, to - thread.taper)));
        out.say(&Call::SyncStart(tapered));
        out.say(&Call::Line(at(peak, to)));
    } else {
        out.say(&Call::Line(at(cut, to)));
    }
    out.say(&Call::SyncStop);
    out.say(&Call::Rapid(at(clear, to)));
    out.say(&Call::FeedOverride(true));
}

impl Threading {
    /// Depth below the peak of a pass, counted from 1.
    fn depth(&self, pass: u32) -> f64 {
        (self.first * f64::from(pass).powf(1.0 / self.degression)).min(self.full)
    }

    /// Passes until the full depth is reached: the least n with J·n^(1/R) ≥ K.
    fn passes(&self) -> u32 {
        let (mut low, mut high) = (1, MAX_PASSES + 1);
        while low < high {
            let middle = u32::midpoint(low, high);
            if self.depth(middle) >= self.full { high = middle } else { low = middle + 1 }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use crate::{Interpreter, Listing, Setup};

    fn cuts(program: &str) -> Vec<f64> {
        let program = format!("G18 G21\nS500 M3\nG0 X20 Z5\n{program}\nM2\n");
        let setup = Setup::default();
        let mut interpreter = Interpreter::new(program.as_bytes(), &setup);
        let mut listing = Listing::new(Vec::new());
        interpreter.run(&mut listing);
        let text = String::from_utf8(listing.finish().unwrap()).unwrap();
        let feeds = text.lines().filter_map(|l| l.split("STRAIGHT_FEED(").nth(1));
        feeds.map(|l| l.split(',').next().unwrap().parse().unwrap()).collect()
    }

    #[test]
    fn equal_areas_of_chip_need_passes_at_the_square_roots() {
        let wanted: Vec<f64> =
            (1..=9).map(|n| 18.5 - 0.3 * f64::from(n).sqrt()).chain([17.58]).collect();
        let found = cuts("G76 P1.5 Z-25 I-1.5 J0.3 K0.92 R2");
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).abs() <= 0.5e-4 + 1e-12, "{found} {wanted}");
        }
    }
}
