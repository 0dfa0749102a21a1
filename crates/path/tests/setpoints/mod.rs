//! What a machine would get, and what it asks of the axes.
use motion::{AXES, Bounds, Piece, Shape};
use path::law::Timed;

/// Servo period of the checks, s.
pub(crate) const PERIOD: f64 = 1e-3;

/// Positions of the axes at each period; at rest before and after.
pub(crate) fn setpoints(pieces: &[Piece], phases: &[Timed]) -> Vec<[f64; AXES]> {
    let mut points = vec![pieces[0].at(0.0).q; 4];
    let mut t = 0.0;
    for Timed { piece, phase } in phases {
        while t < phase.duration {
            points.push(pieces[*piece as usize].at(phase.at(t).s).q);
            t += PERIOD;
        }
        t -= phase.duration;
    }
    let last = pieces[pieces.len() - 1];
    points.extend([last.at(last.length()).q; 4]);
    points
}

/// Largest |speed|, |acceleration|, |jerk| of any axis over its limit, by differences.
pub(crate) fn loads(points: &[[f64; AXES]], b: &Bounds) -> [f64; 3] {
    let mut most = [0.0_f64; 3];
    for k in 0..AXES {
        for w in points.windows(4) {
            let d1 = (w[1][k] - w[0][k]) / PERIOD;
            let d2 = (w[2][k] - 2.0 * w[1][k] + w[0][k]) / PERIOD.powi(2);
            let d3 = (w[3][k] - 3.0 * w[2][k] + 3.0 * w[1][k] - w[0][k]) / PERIOD.powi(3);
            for (m, x) in most.iter_mut().zip([d1 / b.speed[k], d2 / b.accel[k], d3 / b.jerk[k]]) {
                *m = m.max(x.abs());
            }
        }
    }
    most
}

/// Largest |speed|, |acceleration|, |jerk| of any axis over its limit, at nine places of every
/// phase.
pub(crate) fn inside(pieces: &[Piece], phases: &[Timed], b: &Bounds) -> [f64; 3] {
    let mut most = [0.0_f64; 3];
    for Timed { piece, phase } in phases {
        for n in 0..=8 {
            let motion::Instant { s, v, a } = phase.at(phase.duration * f64::from(n) / 8.0);
            let d = pieces[*piece as usize].at(s);
            for k in 0..AXES {
                let speed = d.q1[k] * v / b.speed[k];
                let accel = (d.q1[k] * a + d.q2[k] * v * v) / b.accel[k];
                let jerk = d.q1[k] * phase.j + 3.0 * d.q2[k] * v * a + d.q3[k] * v * v * v;
                for (m, x) in most.iter_mut().zip([speed, accel, jerk / b.jerk[k]]) {
                    *m = m.max(x.abs());
                }
            }
        }
    }
    most
}

/// Speed and place go on from phase to phase.
pub(crate) fn joined(pieces: &[Piece], phases: &[Timed]) {
    for w in phases.windows(2) {
        let (a, b) = (&w[0], &w[1]);
        let motion::Instant { s, v, .. } = a.phase.end();
        assert!((v - b.phase.v).abs() < 1e-6 * (1.0 + v), "speed jumps: {a:?} {b:?}");
        if a.piece == b.piece {
            assert!((s - b.phase.s).abs() < 1e-9 * (1.0 + s), "place jumps: {a:?} {b:?}");
        } else {
            let left = pieces[a.piece as usize].length() - s;
            assert!(left.abs() < 1e-9 * (1.0 + s), "{left} mm are left: {a:?} {b:?}");
            assert!(b.phase.s.abs() < 1e-9, "{b:?} begins late");
        }
    }
}
