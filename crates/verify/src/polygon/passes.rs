//! Passes: what each insert drew through the stock each time it came by.
//!
//! ```text
//!   records  ●────●────●────●      cubic between the middle two, sixteen steps
//!                  ┄┄┄┄┄           tip in the work's frame → pass of that insert, while inside the stock
//! ```
use bus::Sample;
use canon::PolygonCutter;
use std::collections::VecDeque;

/// Steps between two records.
const STEPS: u32 = 16;
/// Points that are kept at most: about 40 minutes of cutting a hexagon. Beyond it the part's end is not judged.
const MOST_POINTS: usize = 12_000_000;

/// One coming-by of one insert. mm, in the work's frame; z is the tip's machine coordinate.
#[derive(Clone, Debug, Default)]
pub(super) struct Pass {
    /// x, y.
    pub(super) points: Vec<[f64; 2]>,
    pub(super) z_first: f64,
    pub(super) z_last: f64,
    /// Where the work stood at its innermost point, rev.
    pub(super) turn: f64,
    closest: f64,
}

impl Pass {
    pub(super) fn z(&self) -> f64 {
        f64::midpoint(self.z_first, self.z_last)
    }
}

/// Where everything was at one record: X, Y, Z mm, work and tool rev.
#[derive(Clone, Copy, Debug)]
struct State([f64; 5]);

/// Collects passes.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    radius_mm: f64,
    inserts: Vec<f64>,
    /// The work's axis, the stock's radius and its front face, mm.
    axis: [f64; 2],
    stock_radius: f64,
    stock_top: f64,
    tool_length: f64,
    spindles: [usize; 2],
    recent: VecDeque<State>,
    open: Vec<Option<Pass>>,
    done: Vec<Pass>,
    points: usize,
}

/// What is to know of the set-up. mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) axis: [f64; 2],
    pub(super) stock_radius: f64,
    pub(super) stock_top: f64,
    pub(super) tool_length: f64,
    /// Work, tool.
    pub(super) spindles: [usize; 2],
}

impl Passes {
    pub(super) fn new(cutter: &PolygonCutter, place: Place) -> Self {
        Self {
            radius_mm: cutter.radius.value(),
            inserts: cutter.inserts.iter().map(|a| a.value()).collect(),
            axis: place.axis,
            stock_radius: place.stock_radius,
            stock_top: place.stock_top,
            tool_length: place.tool_length,
            spindles: place.spindles,
            recent: VecDeque::new(),
            open: vec![None; cutter.inserts.len()],
            done: Vec::new(),
            points: 0,
        }
    }

    pub(super) fn sample(&mut self, sample: &Sample) {
        if self.recent.len() == 4 {
            self.recent.pop_front();
        }
        let axis = |i| sample.axis(i).value();
        let spindle = |i: usize| sample.spindle(self.spindles[i]).value();
        self.recent.push_back(State([axis(0), axis(1), axis(2), spindle(0), spindle(1)]));
        if self.recent.len() == 4 && self.points < MOST_POINTS {
            self.between();
        }
    }

    /// All passes, in the order of their end.
    pub(super) fn finish(mut self) -> Vec<Pass> {
        let rest: Vec<Pass> = self.open.iter_mut().filter_map(Option::take).collect();
        self.done.extend(rest);
        self.done.retain(|pass| pass.points.len() > 2);
        self.done
    }

    /// From the second to the third of the last four records.
    fn between(&mut self) {
        let all = [self.recent[0], self.recent[1], self.recent[2], self.recent[3]];
        let [before, after] = [all[1], all[2]];
        if before.0[2].min(after.0[2]) - self.tool_length > self.stock_top + 1.0 {
            return self.close_all();
        }
        for insert in 0..self.inserts.len() {
            let near = [before, after].iter().any(|state| {
                let [x, y] = self.tip(state, insert);
                x.hypot(y) < self.stock_radius + 0.15 * self.radius_mm
            });
            if near {
                self.draw(&all, insert);
            } else if let Some(pass) = self.open[insert].take() {
                self.done.push(pass);
            }
        }
    }

    fn draw(&mut self, all: &[State; 4], insert: usize) {
        for step in 0..STEPS {
            let state = cubic(all, f64::from(step) / f64::from(STEPS));
            let [x, y] = self.tip(&state, insert);
            let distance = x.hypot(y);
            if distance > self.stock_radius {
                if let Some(pass) = self.open[insert].take() {
                    self.done.push(pass);
                }
                continue;
            }
            let z = state.0[2] - self.tool_length;
            let pass = self.open[insert].get_or_insert_with(|| Pass {
                z_first: z,
                closest: f64::INFINITY,
                ..Pass::default()
            });
            if distance < pass.closest {
                pass.closest = distance;
                pass.turn = state.0[3];
            }
            pass.z_last = z;
            pass.points.push([x, y]);
            self.points += 1;
        }
    }

    fn close_all(&mut self) {
        for open in &mut self.open {
            self.done.extend(open.take());
        }
    }

    /// An insert's tip in the work's frame.
    fn tip(&self, state: &State, insert: usize) -> [f64; 2] {
        let [x, y, _, work, tool] = state.0;
        let psi = fraction_rad(0.5 + tool + self.inserts[insert]);
        let (px, py) = (
            x - self.axis[0] + self.radius_mm * psi.cos(),
            y - self.axis[1] + self.radius_mm * psi.sin(),
        );
        let (sine, cosine) = fraction_rad(work).sin_cos();
        [px * cosine + py * sine, py * cosine - px * sine]
    }
}

/// A turn's fraction in radians: whole turns are taken off before, or their digits would be missing behind.
fn fraction_rad(turns: f64) -> f64 {
    (turns - turns.round()) * core::f64::consts::TAU
}

/// Between the middle two of four equally spaced records.
fn cubic(all: &[State; 4], t: f64) -> State {
    let mut at = [0.0; 5];
    for (i, value) in at.iter_mut().enumerate() {
        // Lagrange through all four, counted from the second
        let [a, b, c, d] = [all[0].0[i], all[1].0[i], all[2].0[i], all[3].0[i]];
        let (ab, bc, cd) = (b - a, c - b, d - c);
        let (second, third) = (bc - ab, cd - 2.0 * bc + ab);
        *value =
            b + t * bc + t * (t - 1.0) / 2.0 * second + (t + 1.0) * t * (t - 1.0) / 6.0 * third;
    }
    State(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_goes_through_a_cubic() {
        let of = |t: f64| State([1.0 + t * (2.0 + t * (3.0 + 4.0 * t)), t * t, 0.0, 1e6 + t, 0.0]);
        let all = [of(-1.0), of(0.0), of(1.0), of(2.0)];
        for t in [0.0, 0.3, 0.9, 1.0] {
            for (found, expected) in cubic(&all, t).0.iter().zip(of(t).0) {
                assert!((found - expected).abs() < 1e-9, "{t}: {found} {expected}");
            }
        }
    }
}
