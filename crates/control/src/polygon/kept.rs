//! What was measured of an oscillation, kept in the table of phase errors, and used again.
//!
//! ```text
//!   G51.4 ─► sent, response ─► phase table ─► E1: sent as it was learnt (same oscillation, same speed),
//!                                                 or each harmonic by the answer at its frequency
//! ```
use canon::{Harmonic, Oscillating, Oscillation};
use store::phases::{Phases, Swung, form_mark};
use sync::{Complex, Response};
use units::Spin;

/// Two speeds are the same within this share.
const SAME_SPEED: f64 = 1e-6;

/// How the table calls what swings.
pub fn name(on: Oscillating) -> String {
    match on {
        Oscillating::Axis(axis) => axis.letter().to_string(),
        Oscillating::ToolPhase => "tool phase".to_owned(),
    }
}

/// The mark of an oscillation as ordered, to a nanometre and a millionth of a turn.
pub fn mark(harmonics: &[Harmonic]) -> String {
    let numbers = harmonics.iter().flat_map(|h| [f64::from(h.per_turn), h.cosine, h.sine]);
    form_mark(&numbers.collect::<Vec<_>>())
}

/// The harmonics to send so that `ordered`, which repeats after so many turns, comes out at a
/// speed; `None`: that was not measured.
pub fn sent(
    phases: &Phases,
    ordered: &Oscillation,
    work: Spin,
    turns: f64,
) -> Option<Vec<Harmonic>> {
    let (on, form) = (name(ordered.on), mark(&ordered.harmonics));
    let of_it = || phases.swung.iter().filter(|s| s.on == on);
    let same =
        |s: &&Swung| s.form == form && (s.rpm - work.abs().in_rpm()).abs() <= SAME_SPEED * s.rpm;
    if let Some(known) = of_it().find(same) {
        let harmonic = |[m, cosine, sine]: &[f64; 3]| Harmonic {
            per_turn: *m as u32,
            cosine: *cosine,
            sine: *sine,
        };
        return Some(known.sent.iter().map(harmonic).collect());
    }
    of_it().find_map(|s| {
        let points = s.response.iter().map(|[hz, gain, delay]| (*hz, *gain, *delay));
        let response = Response::from_points(points);
        ordered.harmonics.iter().map(|h| through(&response, h, work / turns)).collect()
    })
}

/// What the machine made of each harmonic of a base frequency, as far as that was measured,
/// `harmonics` at most.
pub fn answers(
    phases: &Phases,
    on: Oscillating,
    base: f64,
    work: Spin,
    harmonics: usize,
) -> Vec<[f64; 2]> {
    let on = name(on);
    let of_it = phases.swung.iter().filter(|s| s.on == on).map(|s| {
        let points = s.response.iter().map(|[hz, gain, delay]| (*hz, *gain, *delay));
        let response = Response::from_points(points);
        let at = |h: usize| response.at(base * h as f64 * work.abs().value());
        (1..=harmonics).map_while(at).map(|c| [c.re, c.im]).collect::<Vec<_>>()
    });
    // whatever reaches farthest; of equals the slowest, measured nearest to these frequencies
    of_it.fold(Vec::new(), |best, new| if new.len() > best.len() { new } else { best })
}

/// A harmonic divided by the answer at its frequency.
fn through(response: &Response, h: &Harmonic, repeats: Spin) -> Option<Harmonic> {
    if h.per_turn == 0 {
        return Some(*h);
    }
    let answer = response.at(f64::from(h.per_turn) * repeats.abs().value())?;
    let sent = Complex { re: h.cosine, im: -h.sine } / answer;
    Some(Harmonic { cosine: sent.re, sine: -sent.im, ..*h })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Phases {
        let mut table = Phases::new("lathe", 1);
        table.keep_swung(Swung {
            on: "tool phase".into(),
            form: mark(&ordered().harmonics),
            rpm: 600.0,
            sent: vec![[6.0, 0.001, 0.002]],
            // half as large and an eighth of a turn late at 60 Hz
            response: vec![[60.0, 0.5, 0.125]],
        });
        table
    }

    fn ordered() -> Oscillation {
        let harmonics = vec![Harmonic { per_turn: 6, cosine: 0.0, sine: 0.002 }];
        Oscillation { on: Oscillating::ToolPhase, harmonics }
    }

    #[test]
    fn the_same_oscillation_at_the_same_speed_is_sent_as_it_was_learnt() {
        let sent = sent(&table(), &ordered(), Spin::rpm(600.0), 1.0).expect("it was measured");
        assert_eq!(sent, [Harmonic { per_turn: 6, cosine: 0.001, sine: 0.002 }]);
    }

    #[test]
    fn another_one_is_sent_larger_and_earlier_by_the_answer_at_its_frequency() {
        let mut other = ordered();
        other.harmonics[0].sine = 0.004;
        let sent =
            sent(&table(), &other, Spin::rpm(600.0), 1.0).expect("its frequency was measured");
        // sine twice as large, 45° earlier: sin(x + 45°)·0.008
        let part = 0.008 * core::f64::consts::FRAC_1_SQRT_2;
        assert!((sent[0].sine - part).abs() < 1e-12 && (sent[0].cosine - part).abs() < 1e-12);
    }

    #[test]
    fn beyond_what_was_measured_nothing_is_known() {
        assert_eq!(sent(&table(), &ordered(), Spin::rpm(700.0), 1.0), None);
        let mut on_x = ordered();
        on_x.on = Oscillating::Axis(canon::Axis::X);
        assert_eq!(sent(&table(), &on_x, Spin::rpm(600.0), 1.0), None);
    }
}
