//! A curve of any length in a fixed room, with its peaks.
//!
//! ```text
//!   samples   ·:·.·'·:·.·:'··.·:·       bin = so many samples in a row, of which it keeps
//!             └─bin─┘└─bin─┘└─bin─┘     the lowest and the highest, in their order
//!   full?     └─── bin ────┘└── bin ─   two neighbours become one, bins take twice as many
//! ```
//!
//! No sample is ever forgotten that was the extreme of its stretch, so a spike of one servo period
//! in an hour is still on the picture.

/// Bins a series holds at most; it shows two points of each, and two more where the curve rests.
const BINS: usize = 256;

#[derive(Clone, Copy, Debug)]
struct Bin {
    low: (f64, f64),
    high: (f64, f64),
    low_came_first: bool,
    /// The longest time at zero between two moves that ends in it: a line straight through would
    /// show what never was.
    rest: Option<(f64, f64)>,
}

impl Bin {
    const fn of(point: (f64, f64)) -> Self {
        Self { low: point, high: point, low_came_first: true, rest: None }
    }

    fn take(&mut self, point: (f64, f64)) {
        if point.1 < self.low.1 {
            self.low = point;
            self.low_came_first = false;
        } else if point.1 > self.high.1 {
            self.high = point;
            self.low_came_first = true;
        }
    }

    fn rests(&mut self, rest: (f64, f64)) {
        let length = |(from, to): (f64, f64)| to - from;
        if self.rest.is_none_or(|before| length(rest) > length(before)) {
            self.rest = Some(rest);
        }
    }

    /// What is shown of it, in order.
    fn points(&self) -> Vec<(f64, f64)> {
        let pair = if self.low_came_first { [self.low, self.high] } else { [self.high, self.low] };
        let rest = self.rest.into_iter().flat_map(|(from, to)| [(from, 0.0), (to, 0.0)]);
        let mut points: Vec<_> = pair.into_iter().chain(rest).collect();
        if self.rest.is_some() {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        points
    }

    fn followed_by(self, next: Self) -> Self {
        let low_is_mine = self.low.1 <= next.low.1;
        let high_is_mine = self.high.1 >= next.high.1;
        let mut both = Self {
            rest: self.rest,
            low: if low_is_mine { self.low } else { next.low },
            high: if high_is_mine { self.high } else { next.high },
            low_came_first: match (low_is_mine, high_is_mine) {
                (true, true) => self.low_came_first,
                (false, false) => next.low_came_first,
                (low_is_mine, _) => low_is_mine,
            },
        };
        if let Some(rest) = next.rest {
            both.rests(rest);
        }
        both
    }
}

/// A curve, recorded sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    bins: Vec<Bin>,
    /// The bin being filled; it counts only if there is something `in_open`.
    open: Bin,
    in_open: u32,
    per_bin: u32,
    first: (f64, f64),
    last: (f64, f64),
}

impl Default for Series {
    fn default() -> Self {
        let nowhere = (0.0, 0.0);
        Self {
            bins: Vec::new(),
            open: Bin::of(nowhere),
            in_open: 0,
            per_bin: 1,
            first: nowhere,
            last: nowhere,
        }
    }
}

impl Series {
    /// Record a sample. One that is no number is left out.
    pub(crate) fn push(&mut self, x: f64, y: f64) {
        if !(x + y).is_finite() {
            return; // what is no number or infinite keeps that in a sum
        }
        let point = (x, y);
        self.last = point;
        if self.in_open == 0 {
            if self.bins.is_empty() {
                self.first = point;
            }
            self.open = Bin::of(point);
        } else {
            self.open.take(point);
        }
        self.in_open += 1;
        if self.in_open >= self.per_bin {
            self.close();
        }
    }

    /// It has lain at zero since its last sample, which is one, and rises from here.
    pub(crate) fn rest_until(&mut self, x: f64) {
        let (from, y) = self.last;
        let bin = if self.in_open > 0 { Some(&mut self.open) } else { self.bins.last_mut() };
        if let Some(bin) = bin.filter(|_| y == 0.0) {
            bin.rests((from, x));
        }
        self.push(x, 0.0);
    }

    fn close(&mut self) {
        self.bins.push(self.open);
        self.in_open = 0;
        if self.bins.len() >= BINS {
            let halved = self.bins.chunks(2).map(|pair| match pair {
                [a, b] => a.followed_by(*b),
                rest => rest[0], // a last bin without a neighbour: BINS is even, so there is none
            });
            self.bins = halved.collect();
            self.per_bin = self.per_bin.saturating_mul(2);
        }
    }

    /// The curve's points in the order recorded: its ends, and the extremes of each stretch
    /// between.
    pub(crate) fn points(&self) -> Vec<(f64, f64)> {
        let open = (self.in_open > 0).then_some(&self.open);
        if self.bins.is_empty() && open.is_none() {
            return Vec::new();
        }
        let mut points = vec![self.first];
        for bin in self.bins.iter().chain(open) {
            points.extend(bin.points());
        }
        points.push(self.last);
        points.dedup();
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_curve_is_kept_as_it_is() {
        let mut series = Series::default();
        let curve: Vec<_> = (0..100).map(|i| (f64::from(i), f64::from(i % 7))).collect();
        for &(x, y) in &curve {
            series.push(x, y);
        }
        assert_eq!(series.points(), curve);
    }

    #[test]
    fn a_spike_of_one_sample_in_a_million_survives_and_the_room_is_bounded() {
        let mut series = Series::default();
        for i in 0..1_000_000 {
            let spike = if i == 777_777 { -93.0 } else { 0.0 };
            series.push(f64::from(i), (f64::from(i) * 0.01).sin() + spike);
        }
        let points = series.points();
        assert!(points.len() <= 2 * BINS + 2, "{}", points.len());
        let lowest = points.iter().min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are points");
        assert_eq!(lowest.0, 777_777.0);
        assert_eq!((points[0].0, points[points.len() - 1].0), (0.0, 999_999.0));
        assert!(points.windows(2).all(|pair| pair[0].0 <= pair[1].0), "in the order recorded");
    }

    #[test]
    fn what_is_no_number_leaves_no_point() {
        let mut series = Series::default();
        series.push(f64::NAN, 1.0);
        series.push(1.0, f64::INFINITY);
        assert_eq!(series.points(), []);
    }
}
