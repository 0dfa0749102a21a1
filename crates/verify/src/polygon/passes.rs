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
/// Points that are kept at most: about 40 minutes of cutting a hexagon. Beyond it the part's end is
/// not judged.
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
    /// Square of its distance there.
    closest: f64,
}

impl Pass {
    /// Its least distance from the work's axis.
    pub(super) fn closest_mm(&self) -> f64 {
        self.closest.sqrt()
    }

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
    /// Cosine and sine of where each stands in the cutter.
    inserts: Vec<[f64; 2]>,
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
pub(super) struct PassSetUp {
    pub(super) axis: [f64; 2],
    pub(super) stock_radius: f64,
    pub(super) stock_top: f64,
    pub(super) stock_bottom: f64,
    /// Z of the work's zero.
    pub(super) zero: f64,
    pub(super) tool_length: f64,
    /// Work, tool.
    pub(super) spindles: [usize; 2],
}

impl Passes {
    pub(super) fn new(cutter: &PolygonCutter, place: PassSetUp) -> Self {
        Self {
            radius_mm: cutter.radius.value(),
            inserts: cutter
                .inserts
                .iter()
                .map(|a| fraction_rad(a.value()).sin_cos())
                .map(|(sine, cosine)| [cosine, sine])
                .collect(),
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
        let reach = self.stock_radius + 0.15 * self.radius_mm;
        let ends = [before, after].map(|state| self.tool(&state));
        let near: Vec<usize> = (0..self.inserts.len())
            .filter(|i| ends.iter().any(|tool| square(self.tip(tool, *i)) < reach * reach))
            .collect();
        for insert in (0..self.inserts.len()).filter(|insert| !near.contains(insert)) {
            self.done.extend(self.open[insert].take());
        }
        if near.is_empty() {
            return;
        }
        for step in 0..STEPS {
            self.draw(&cubic(&all, f64::from(step) / f64::from(STEPS)), &near);
        }
    }

    /// Where the inserts that are near leave a point.
    fn draw(&mut self, state: &State, near: &[usize]) {
        let tool = self.tool(state);
        let (sine, cosine) = fraction_rad(state.0[3]).sin_cos();
        for insert in near.iter().copied() {
            let [px, py] = self.tip(&tool, insert);
            let distance = square([px, py]);
            if distance > self.stock_radius * self.stock_radius {
                self.done.extend(self.open[insert].take());
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
            pass.points.push([px * cosine + py * sine, py * cosine - px * sine]);
            self.points += 1;
        }
    }

    fn close_all(&mut self) {
        for open in &mut self.open {
            self.done.extend(open.take());
        }
    }

    /// The tool spindle from the work's axis: x, y, and cosine and sine of where its first insert
    /// points.
    fn tool(&self, state: &State) -> [f64; 4] {
        let (sine, cosine) = fraction_rad(0.5 + state.0[4]).sin_cos();
        [state.0[0] - self.axis[0], state.0[1] - self.axis[1], cosine, sine]
    }

    /// An insert's tip from the work's axis, in the machine's directions.
    fn tip(&self, tool: &[f64; 4], insert: usize) -> [f64; 2] {
        let [x, y, cosine, sine] = *tool;
        let [ci, si] = self.inserts[insert];
        [
            x + self.radius_mm * (cosine * ci - sine * si),
            y + self.radius_mm * (sine * ci + cosine * si),
        ]
    }
}

/// Of a distance.
fn square([x, y]: [f64; 2]) -> f64 {
    x * x + y * y
}

/// A turn's fraction in radians: whole turns are taken off before, or their digits would be missing
/// behind.
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
