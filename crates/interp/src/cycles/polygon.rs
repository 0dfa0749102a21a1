//! Polygon turning: G51.2, G51.3, G51.4, G50.2 (in the Fanuc dialects also G251 and G250).
//!
//! ```text
//!   G51.3 L6 A0.81 B-0.02   one harmonic of an oscillation, here of the tool spindle's phase (as many as wanted)
//!   G51.2 P1 Q2 R0          work : tool turns 1 : 2; the tool's angle is R degrees where the work's is zero
//!   …cuts…
//!   G50.2                   the oscillation fades, the tool spindle stops
//! ```
//!
//! L counts the periods in P turns of the work, one as a rule: after them the gear begins anew.
//!
//! G51.2 takes the source's own form as well: I is the parameter a of dx = a·l·(1 − cos Mφ), J that
//! of dy = a·l·sin Mφ, K the amplitude d in degrees of the tool's phase, d·sin Mφ; l is the
//! distance of the axes at the cut, which the cuts that follow say, M = N·Q/P, N the inserts of the
//! cutter in the spindle. D asks the control to choose: D0 the actuator too, D1 X, D2 Y, D3 X and
//! Y, D4 the tool's phase, D5 X and the phase, D6 all three. E1 sends what swings as the kept
//! measurement of this oscillation at this speed has it compensated; G51.4 measures it, in the air,
//! and compensates it there and then.
//!
//! Source: JP7525593B2; words P Q R as on Fanuc's lathes.
use crate::{
    call::{Call, PolygonOrder, Sink, out::Out},
    compensation,
    fault::{Outcome, error, refuse},
    modes::Modes,
    resolve::{Resolver, position},
    state::tools::Tools,
    words::Words,
};
use canon::{Axis, Harmonic, OpKind, Oscillating, Oscillation, Polygon, Ratio, ToolKind};
use diag::{Diagnostic, Span};
use units::Angle;

/// Harmonics of one oscillation.
const MOST_HARMONICS: usize = 400;
/// Highest harmonic: periods in the turns of the work after which the gear begins anew.
const HIGHEST: u32 = 2000;
/// Turns on either side of a ratio.
const MOST_TURNS: f64 = 1_000_000.0;
/// The work spindle, and the tool spindle.
const SPINDLES: [u8; 2] = [0, 1];
/// Looks of a measurement; after a few nothing more is gained.
const MOST_LOOKS: u32 = 50;

/// G51.3: a harmonic for the next G51.2; alone, none.
pub(crate) fn harmonic(words: &Words, modes: &mut Modes) -> Outcome {
    let span = words.place.span;
    let values = [b'X', b'I', b'Y', b'J', b'A', b'B'].map(|letter| words.get(letter));
    let stated = values.iter().any(Option::is_some);
    let Some(per_turn) = words.whole(b'L', HIGHEST)? else {
        if stated {
            let text = "G51.3 needs L, the periods of this harmonic per turn of the work";
            return refuse("I0811", span, text);
        }
        modes.swings.clear();
        return Ok(());
    };
    if !stated {
        let text = "G51.3 needs amplitudes: X I along X, Y J along Y, A B of the tool spindle in degrees; the first is the cosine's, the second the sine's";
        return refuse("I0812", span, text);
    }
    let [x, i, y, j, a, b] = values.map(|value| value.unwrap_or(0.0));
    let swings = [
        (Oscillating::Axis(Axis::X), x, i),
        (Oscillating::Axis(Axis::Y), y, j),
        (Oscillating::ToolPhase, a / 360.0, b / 360.0),
    ];
    for (on, cosine, sine) in swings {
        if cosine == 0.0 && sine == 0.0 {
            continue;
        }
        add(&mut modes.swings, on, Harmonic { per_turn, cosine, sine });
    }
    if modes.swings.iter().any(|swing| swing.harmonics.len() > MOST_HARMONICS) {
        let text = format!("an oscillation has at most {MOST_HARMONICS} harmonics");
        return refuse("I0813", span, text);
    }
    Ok(())
}

/// G51.2.
pub(crate) fn polygon<S: Sink>(
    words: &Words,
    modes: &mut Modes,
    tools: &Tools,
    out: &mut Out<'_, S>,
) -> Outcome {
    if modes.compensating() {
        return compensation::no_compensation(words);
    }
    let span = words.place.span;
    let (Some(p), Some(q)) = (words.get(b'P'), words.get(b'Q')) else {
        let text = "G51.2 needs P and Q, turns of the work and of the tool: P1 Q2 with three inserts cuts a hexagon";
        return refuse("I0804", span, text);
    };
    let ratio =
        Ratio { follower: turns(words, b'Q', q, [p, q])?, master: turns(words, b'P', p, [p, q])? };
    if ratio.master <= 0 || ratio.follower == 0 {
        let text = format!(
            "the turns of G51.2 are whole numbers, P above 0 and Q not 0 (its sign is the tool's sense), found P{p} Q{q}: P1 Q2 works"
        );
        return refuse("I0805", span, text);
    }
    let mut oscillations = core::mem::take(&mut modes.swings);
    let written: Vec<u8> =
        b"IJK".iter().copied().filter(|letter| words.get(*letter).is_some()).collect();
    let auto = actuator(words)?;
    if auto.is_some() && (!written.is_empty() || !oscillations.is_empty()) {
        let text = "D lets the control choose the oscillation, but one is written too: leave out D, or I, J, K and G51.3";
        return refuse("I0806", words.span(b'D'), text);
    }
    let mut by_distance = Vec::new();
    if !written.is_empty() {
        written_form(words, modes, tools, ratio, &mut oscillations, &mut by_distance)?;
    }
    let order = PolygonOrder {
        ratio,
        phase_deg: words.get(b'R').unwrap_or(0.0),
        oscillations,
        by_distance,
        auto,
        compensated: words.whole(b'E', 1)? == Some(1),
    };
    modes.polygon = true;
    out.say(&Call::Polygon(&order));
    Ok(())
}

/// G51.4: what swings is measured in the air, and compensated.
pub(crate) fn polygon_measure<S: Sink>(
    words: &Words,
    modes: &Modes,
    out: &mut Out<'_, S>,
) -> Outcome {
    let span = words.place.span;
    if !modes.polygon {
        let text = "G51.4 measures what G51.2 lets swing: write it after G51.2, while the cutter is clear of the work";
        return refuse("I0814", span, text);
    }
    match words.whole(b'P', MOST_LOOKS)? {
        Some(looks) if looks > 0 => {
            out.say(&Call::PolygonMeasure(looks));
            Ok(())
        }
        _ => {
            let text = "G51.4 needs P, how often it is measured and corrected: P4 works";
            refuse("I0815", span, text)
        }
    }
}

/// G50.2.
pub(crate) fn polygon_end<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    if !modes.polygon {
        let text = "G50.2 ends polygon turning, which is not begun: it has no effect";
        out.remarks.push(Diagnostic::warning("I0807", words.place.span, text));
        return;
    }
    modes.polygon = false;
    out.say(&Call::PolygonEnd);
}

/// a of X and Y, and d of the tool's phase, as the source writes them.
fn written_form(
    words: &Words,
    modes: &Modes,
    tools: &Tools,
    ratio: Ratio,
    oscillations: &mut Vec<Oscillation>,
    by_distance: &mut Vec<Oscillation>,
) -> Outcome {
    let span = words.place.span;
    let tool = tools.library.get(modes.current_tool).map(|tool| &tool.kind);
    let Some(ToolKind::PolygonCutter(cutter)) = tool else {
        let text = "I, J and K of G51.2 count facets by the inserts of the cutter, but no polygon cutter is in the spindle";
        let help = "call one of kind \"polygon-cutter\" with T and M6 before, or write the oscillation with G51.3";
        return Err(error("I0808", span, text).with_help(help).into());
    };
    let inserts = cutter.inserts.len();
    let settled = ratio.settled().unwrap_or(ratio);
    let facets = inserts as f64 * f64::from(settled.follower.unsigned_abs());
    if facets > f64::from(HIGHEST) {
        let text = format!(
            "{inserts} inserts at {}:{} pass the work {facets} times before the gear begins anew; an oscillation counts up to {HIGHEST}",
            ratio.master, ratio.follower
        );
        return refuse("I0809", span, text);
    }
    let per_turn = facets as u32;
    let [a_x, a_y, d] = [b'I', b'J', b'K'].map(|letter| words.get(letter).unwrap_or(0.0));
    if a_x != 0.0 {
        let on = Oscillating::Axis(Axis::X);
        add(by_distance, on, Harmonic { per_turn: 0, cosine: a_x, sine: 0.0 });
        add(by_distance, on, Harmonic { per_turn, cosine: -a_x, sine: 0.0 });
    }
    if a_y != 0.0 {
        let on = Oscillating::Axis(Axis::Y);
        add(by_distance, on, Harmonic { per_turn, cosine: 0.0, sine: a_y });
    }
    if d != 0.0 {
        let sine = d / 360.0;
        add(oscillations, Oscillating::ToolPhase, Harmonic { per_turn, cosine: 0.0, sine });
    }
    Ok(())
}

fn actuator(words: &Words) -> Outcome<Option<canon::Actuator>> {
    use canon::Actuator::{Across, All, Any, Both, CentreLine, CentreLineAndPhase, ToolPhase};
    const BY_NUMBER: [canon::Actuator; 7] =
        [Any, CentreLine, Across, Both, ToolPhase, CentreLineAndPhase, All];
    let choice = words.whole(b'D', BY_NUMBER.len() as u32 - 1)?;
    Ok(choice.map(|d| BY_NUMBER[d as usize]))
}

fn turns(words: &Words, letter: u8, value: f64, both: [f64; 2]) -> Outcome<i32> {
    match crate::codes::number::near_whole(value).filter(|_| value.abs() <= MOST_TURNS) {
        Some(whole) => Ok(whole as i32),
        None => refuse(
            "I0805",
            words.span(letter),
            format!(
                "the turns of G51.2 are whole numbers up to {MOST_TURNS}, found {}{value}: {}",
                letter as char,
                in_whole_turns(both)
            ),
        ),
    }
}

/// The same ratio in whole turns, if a hundred turns have it.
fn in_whole_turns([p, q]: [f64; 2]) -> String {
    use crate::codes::number::near_whole;
    let times = (1..=100).map(f64::from).map(|n| [near_whole(n * p), near_whole(n * q)]);
    let mut small = times.filter_map(|turns| match turns {
        [Some(p), Some(q)] if p > 0 && q != 0 && q.abs() <= MOST_TURNS as i64 => Some((p, q)),
        _ => None,
    });
    small.next().map_or_else(|| "P1 Q2 works".into(), |(p, q)| format!("P{p} Q{q} is that ratio"))
}

fn add(oscillations: &mut Vec<Oscillation>, on: Oscillating, harmonic: Harmonic) {
    match oscillations.iter_mut().find(|oscillation| oscillation.on == on) {
        Some(oscillation) => oscillation.harmonics.push(harmonic),
        None => oscillations.push(Oscillation { on, harmonics: vec![harmonic] }),
    }
}

/// From the program's units to the machine's.
pub(crate) fn operation(resolver: &mut Resolver, order: &PolygonOrder, span: Span) {
    let mm = resolver.mm();
    let resolved = |swing: &Oscillation| {
        let factor = match swing.on {
            Oscillating::Axis(_) => mm,
            Oscillating::ToolPhase => 1.0,
        };
        let scaled = |h: &Harmonic| Harmonic {
            per_turn: h.per_turn,
            cosine: h.cosine * factor,
            sine: h.sine * factor,
        };
        Oscillation { on: swing.on, harmonics: swing.harmonics.iter().map(scaled).collect() }
    };
    let polygon = Polygon {
        work: SPINDLES[0],
        tool: SPINDLES[1],
        ratio: order.ratio,
        phase: Angle::deg(order.phase_deg),
        oscillations: order.oscillations.iter().map(resolved).collect(),
        by_distance: order.by_distance.clone(),
        wanted: Vec::new(),
        auto: order.auto,
        compensated: order.compensated,
        zero: position(&resolver.machine(&[0.0; 9])),
        own_zero: resolver.own_zero(),
    };
    resolver.push(span, OpKind::Polygon(polygon));
}

#[cfg(test)]
mod tests {
    use super::in_whole_turns;

    #[test]
    fn a_ratio_in_parts_of_turns_is_offered_in_whole_ones() {
        assert_eq!(in_whole_turns([1.0, 1.5]), "P2 Q3 is that ratio");
        assert_eq!(in_whole_turns([0.4, -1.0]), "P2 Q-5 is that ratio");
        assert_eq!(in_whole_turns([1.0, std::f64::consts::PI]), "P1 Q2 works");
        assert_eq!(in_whole_turns([1.0, 2e9]), "P1 Q2 works");
    }
}
