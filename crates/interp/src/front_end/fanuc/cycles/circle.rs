//! G12 and G13 of Haas and Mitsubishi: a round pocket from its centre, where the tool stands.
//!
//! ```text
//!        ╭───────╮      half a circle from the centre to +X of the first ring, the ring,
//!      ╭─┼──╮    │      half a circle to −X of the next ring, that ring, …
//!      │ ╰──╯●   │      and half a circle back to the centre, all in one sense of rotation:
//!      ╰────╯    │      G12 clockwise, G13 counter-clockwise
//!          ╰─────╯
//! ```
//!
//! | word | Haas | Mitsubishi |
//! |---|---|---|
//! | `I` | radius of the first ring, of the only one without K | radius of the circle; its sign does not count |
//! | `K`, `Q` | radius of the last ring; how much larger each ring is than the one before | refused |
//! | `D` | offset whose radius is taken away; left out, the last D | offset; a must |
//! | `Z`, `L` | level that is fed to first; under G91 a step that is taken L times, each with all rings | refused |
//!
//! How the tool comes to the circle and back is in Mitsubishi's manual (and in that of the TC-32B,
//! which has the cycle too). Haas' manual draws such a way, and does not say on which side it
//! begins: Leadscrew begins at the same.
//!
//! Source: Mitsubishi Electric, programming manual of M700V, "Circle cutting"; Haas, mill
//! operator's manual, "G12, G13".
use crate::{
    call::{Call, Sink, out::Out},
    codes::{
        number::{near_whole, tenths},
        spelling::short,
    },
    dialect::fanuc::{
        codes::{Meaning, meaning},
        variant::Circles,
    },
    execute,
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        cycles::lengths::word,
        offsets::tool_offsets::{Part, ToolVariable, tool_value},
        state::{Fanuc, Said},
        words::{read::scaled, translate},
    },
    motion,
    program::Program,
    state::executor::Executor,
};
use canon::{Axis, Plane};
use diag::Span;

/// More rings or levels than this are a slip of the pen.
const MOST: u32 = 1000;

/// What a block orders.
struct Pocket {
    /// Radii of the tool's centre, the smallest first.
    rings: Vec<f64>,
    /// Where to feed to first, along the plane's normal.
    depth: Option<f64>,
    levels: u32,
}

/// G12 (true) or G13 of the block at hand.
pub(crate) fn circle_code(fanuc: &Fanuc) -> Option<bool> {
    if fanuc.kind.variant().circles == Circles::None {
        return None;
    }
    fanuc.said.iter().filter(|said| said.letter == b'G').find_map(|said| {
        match meaning(fanuc.kind, tenths(said.value)?) {
            Meaning::Circle(clockwise) => Some(clockwise),
            _ => None,
        }
    })
}

/// Execute it: the block's other words first.
pub(crate) fn circle<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    clockwise: bool,
    out: &mut Out<'_, S>,
) -> Outcome {
    let said = core::mem::take(&mut fanuc.said);
    let code = if clockwise { "G12" } else { "G13" };
    let rings = fanuc.kind.variant().circles == Circles::Pocket;
    let own: &[u8] = if rings { b"IKQDZL" } else { b"ID" };
    let is_code = |word: &Said| word.letter == b'G' && matches!(word.value, 12.0 | 13.0);
    let stray = said.iter().find(|w| !own.contains(&w.letter) && !b"GFSTM".contains(&w.letter));
    if let Some(stray) = stray {
        let text = format!("{} cannot stand beside {code}", stray.letter as char);
        let help = "its centre is where the tool stands: move there in a block before";
        return Err(error("I1063", stray.span, text).with_help(help).into());
    }
    fanuc.said = said.iter().filter(|w| !own.contains(&w.letter) && !is_code(w)).copied().collect();
    let ex = &mut it.executor;
    ex.words.begin(&it.block);
    translate(fanuc, ex)?;
    execute::execute(ex, out)?;
    may_mill(fanuc, ex, code)?;
    let pocket = pocket(fanuc, ex, &said, code)?;
    motion::check_feed(&ex.words, &ex.modes, code)?;
    for _ in 0..pocket.levels {
        mill(ex, &pocket, clockwise, out);
    }
    Ok(())
}

/// What must not be in force.
fn may_mill(fanuc: &Fanuc, ex: &Executor, code: &str) -> Outcome {
    let span = ex.words.place.span;
    let (what, help) = if ex.modes.compensating() {
        ("G41 or G42", "write G40 before it: D takes the tool's radius away")
    } else if fanuc.mapping.changes() || fanuc.mapping.polar.is_some() {
        ("G16, G51, G51.1 or G68", "write G15, G50, G50.1 or G69 before it")
    } else if fanuc.surface.is_some() {
        ("G7.1 or G12.1", "end it before")
    } else if fanuc.kind.variant().circles == Circles::Pocket && ex.modes.plane != Plane::XY {
        ("G18 or G19", "write G17 before it")
    } else {
        return Ok(());
    };
    let text = format!("{code} cannot be used while {what} is in force");
    Err(error("I1063", span, text).with_help(help).into())
}

fn pocket(fanuc: &Fanuc, ex: &Executor, said: &[Said], code: &str) -> Outcome<Pocket> {
    let span = ex.words.place.span;
    let value = |letter| word(said, letter).map(|word| scaled(fanuc, ex, word));
    let Some(first) = value(b'I').map(f64::abs) else {
        let text = format!("{code} needs I, the radius of the circle");
        return refuse("I1063", span, text);
    };
    let tool = radius_of(fanuc, ex, said, code)?;
    let (last, step) = (value(b'K'), value(b'Q'));
    let mut radii = vec![first];
    match (last, step) {
        (None, None) => {}
        (Some(last), Some(step)) if step > 0.0 && last >= first => {
            while radii.len() < MOST as usize && radii[radii.len() - 1] + step < last - 1e-9 {
                radii.push(radii[radii.len() - 1] + step);
            }
            if last > first {
                radii.push(last);
            }
        }
        _ => {
            let text =
                format!("{code} takes K, the last radius, not below I, and Q above 0 together");
            return refuse("I1063", span, text);
        }
    }
    if radii.len() > MOST as usize {
        let text = format!("{code} would make more than {MOST} rings: Q is too small");
        return refuse("I1063", span, text);
    }
    if first - tool <= 1e-9 {
        let text =
            format!("the radius {} is not above that of the tool, {}", short(first), short(tool));
        return refuse("I1063", word(said, b'I').map_or(span, |w| w.span), text);
    }
    let levels = match word(said, b'L') {
        None => 1,
        Some(l) => whole(l)?.filter(|l| (1..=MOST).contains(l)).map_or_else(
            || refuse("I1063", l.span, format!("L is from 1 to {MOST}, found {}", l.value)),
            Ok,
        )?,
    };
    if levels > 1 && !(ex.modes.incremental && value(b'Z').is_some()) {
        let text = "L repeats a step of Z: write G91 before, and Z as the step";
        return refuse("I1063", span, text);
    }
    let rings = radii.into_iter().map(|radius| radius - tool).collect();
    Ok(Pocket { rings, depth: value(b'Z'), levels })
}

/// The radius of the offset D.
fn radius_of(fanuc: &Fanuc, ex: &Executor, said: &[Said], code: &str) -> Outcome<f64> {
    let number = match word(said, b'D') {
        Some(d) => whole(d)?,
        None if fanuc.kind.variant().circles == Circles::Pocket => {
            near_whole(fanuc.kept.last(b'D')).and_then(|n| u32::try_from(n).ok())
        }
        None => None,
    };
    let span = word(said, b'D').map_or(ex.words.place.span, |d: &Said| -> Span { d.span });
    let Some(tool) = number else {
        let text = format!("{code} needs D, the offset with the tool's radius; D0 for its centre");
        return refuse("I1063", span, text);
    };
    if tool == 0 {
        return Ok(0.0);
    }
    let part = |wear| tool_value(fanuc, ex, ToolVariable { tool, part: Part::Radius, wear });
    Ok(part(false) + part(true))
}

fn whole(word: &Said) -> Outcome<Option<u32>> {
    match near_whole(word.value).map(u32::try_from) {
        Some(Ok(number)) => Ok(Some(number)),
        _ => {
            let letter = word.letter as char;
            let text = format!("expected a whole number after {letter}, found {}", word.value);
            refuse("I0108", word.span, text)
        }
    }
}

/// One level.
fn mill<S: Sink>(ex: &mut Executor, pocket: &Pocket, clockwise: bool, out: &mut Out<'_, S>) {
    let plane = ex.modes.plane;
    let [a, b, n] = plane.axes().map(Axis::index);
    if let Some(depth) = pocket.depth {
        ex.modes.at[n] = if ex.modes.incremental { ex.modes.at[n] + depth } else { depth };
        out.say(&Call::Line(ex.modes.at));
    }
    let centre = ex.modes.at;
    let turns = if clockwise { -1 } else { 1 };
    let mut arc = |from: f64, to: f64| {
        let mut end = centre;
        end[a] += to;
        let middle = if from == to { 0.0 } else { f64::midpoint(from, to) };
        out.say(&Call::Arc { plane, to: end, centre: [centre[a] + middle, centre[b]], turns });
    };
    let mut at = 0.0;
    for (count, radius) in pocket.rings.iter().enumerate() {
        let side = if count % 2 == 0 { *radius } else { -radius };
        arc(at, side);
        arc(side, side);
        at = side;
    }
    arc(at, 0.0);
}
