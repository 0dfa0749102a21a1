//! The beginning of a pass in which its axis comes from rest to the thread's speed, by what was
//! recorded.
//!
//! ```text
//!   r = way of the axis / way of the helix                 1 ┤        ╭──────────
//!       over a tenth of a turn                               │      ╱   rises no more: the run-in is over,
//!                                                            │    ╱     and what follows is judged
//!   an axis that keeps another lead rises to another r     0 ┼──╱───────────────► turns
//! ```
//!
//! Where a bar is known, the thread begins at its end, and a run-in in it is a bad thread. Without
//! one nothing says where the thread begins: the run-in is left out, and it is said how long it is.
//! The plan is not asked: an axis that runs at another lead, or changes it later, is found.

/// Turns over which the speed is looked at, and over which it rises.
const SPEED: f64 = 0.1;
const RISE: f64 = 0.25;
/// Less than this in [`RISE`] is no rise: what is left of the way is 0.5 µm.
const NO_RISE: f64 = 0.005;
/// Below this share of the helix' speed it has only begun.
const BEGUN: f64 = 0.5;

/// How many of the points (depth and distance from the helix, positive deeper, mm) belong to the
/// run-in of a thread of this lead, mm.
pub(super) fn points(at: &[[f64; 2]], lead: f64) -> usize {
    // how far the helix is; the distance from it is known but for whole leads
    let mut helix = Vec::with_capacity(at.len());
    for [depth, error] in at {
        let place = depth - error;
        let last = *helix.last().unwrap_or(&place);
        helix.push(place - lead * ((place - last) / lead).round());
    }
    let (Some(first), Some(last)) = (helix.first(), helix.last()) else { return 0 };
    let turns = (last - first) / lead;
    if turns <= 2.0 * (SPEED + RISE) {
        return 0; // too short to tell
    }
    let per_turn = at.len() as f64 / turns;
    let [speed, rise] = [SPEED, RISE].map(|turns| (turns * per_turn).ceil().max(2.0) as usize);
    let share = |k: usize| {
        let way = helix[k + speed] - helix[k];
        if way > 0.0 { (at[k + speed][0] - at[k][0]) / way } else { 0.0 }
    };
    let ends = (0..at.len().saturating_sub(speed + rise))
        .find(|k| share(*k) > BEGUN && share(k + rise) - share(*k) < NO_RISE);
    match ends {
        Some(k) if k > 0 => k + speed,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAD: f64 = 1.0;
    /// Turns of the helix until the axis has its speed.
    const RAMP: f64 = 1.488;

    /// An axis that comes to `speed` times the helix' at constant acceleration, by turns.
    fn ramped(speed: f64) -> impl Fn(f64) -> f64 {
        move |turn| {
            if turn < RAMP {
                speed * turn * turn / (2.0 * RAMP)
            } else {
                speed * (turn - RAMP / 2.0)
            }
        }
    }

    /// Twelve turns in steps of 1/160, seen with the helix shifted so that a full speed is on it.
    fn seen(axis: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let point = |k: u32| {
            let turn = f64::from(k) / 160.0;
            let depth = axis(turn);
            let error = depth - (turn - RAMP / 2.0) * LEAD;
            [depth, error - LEAD * (error / LEAD).round()]
        };
        (0..12 * 160).map(point).collect()
    }

    #[test]
    fn a_ramp_is_left_out_to_its_end_and_no_farther() {
        let at = seen(ramped(1.0));
        let left_out = points(&at, LEAD);
        let turn = left_out as f64 / 160.0;
        assert!((RAMP - 0.1..RAMP + 0.2).contains(&turn), "{turn} turns of {RAMP}");
        assert!(at[left_out..].iter().all(|[_, error]| error.abs() < 1e-3), "{:?}", at[left_out]);
    }

    #[test]
    fn an_axis_at_speed_has_no_run_in() {
        assert_eq!(points(&seen(|turn| turn - RAMP / 2.0), LEAD), 0);
        assert_eq!(points(&seen(|turn| 0.97 * turn), LEAD), 0);
        assert_eq!(points(&[], LEAD), 0);
    }

    #[test]
    fn another_lead_is_no_run_in_wherever_it_begins() {
        for speed in [0.9, 1.1, 0.6] {
            let at = seen(ramped(speed));
            let left_out = points(&at, LEAD);
            assert!((left_out as f64) < 2.0 * 160.0, "{speed}: {left_out}");
        }
        // five turns at nine tenths of the lead, and then right
        let late = |turn: f64| if turn < 5.0 { 0.9 * turn } else { turn - 0.5 };
        assert_eq!(points(&seen(late), LEAD), 0);
        // an axis that stays slow for ever has only begun
        assert_eq!(points(&seen(ramped(0.3)), LEAD), 0);
    }
}
