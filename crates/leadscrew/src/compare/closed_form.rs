//! By what the depth of the conventional cycle must scatter.
//!
//! ```text
//!   σ² = (H·n·σd)²  +  (H·n·σs·t/2)²  +  (σn·w)²
//!         relay         stopping time     speed
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | H, n | lead, spindle speed | mm/rev, rev/s |
//! | σd | scatter of the relay's delay | s |
//! | t, σs | stopping time n/a, its scatter as a share | s, 1 |
//! | σn | scatter of the speed as a share: a tap that turns faster cuts deeper by that share of its way | 1 |
//! | w | way in the work: depth and H·n·(delay + t/2), by which the tap coasts | mm |
//!
//! Everything grows with n: a speed belongs to any figure of it.
use canon::ThreadSize;
use units::{Length, Spin, Time};

/// The band in which published figures of the conventional cycle lie, 1σ.
const BAND: [Length; 2] = [Length::um(130.0), Length::um(330.0)];
/// Speeds that are tried for the band are so far apart.
const STEP: Spin = Spin::rpm(10.0);

/// By how much the conventional cycle runs beyond its bottom: H·n·(delay + t/2).
pub(super) fn overrun(thread: &ThreadSize, spin: Spin, drive: &sim::PlainDrive) -> Length {
    thread.lead().abs() * (spin * (drive.delay + spin / drive.decel / 2.0))
}

/// How far its holder is pulled out on the way back: by what the spindle has run on, and as much
/// again that it misses while it runs up and the feed goes at once.
pub(super) fn pulled_out(thread: &ThreadSize, spin: Spin, drive: &sim::PlainDrive) -> Length {
    overrun(thread, spin, drive) * 2.0
}

/// A thread, and the spindle that scatters.
pub(super) struct Scatter {
    pub(super) thread: ThreadSize,
    /// Of the holes.
    pub(super) depth: Length,
    pub(super) drive: sim::PlainDrive,
}

impl Scatter {
    /// One standard deviation of the depth at a speed.
    fn sigma(&self, spin: Spin) -> Length {
        let stopping = spin / self.drive.accel;
        let way = |time: Time| self.thread.lead().abs() * (spin * time);
        let in_work = self.depth + way(self.drive.delay + stopping / 2.0);
        let causes = [
            way(self.drive.delay_scatter),
            way(stopping * (self.drive.ramp_scatter / 2.0)),
            in_work * self.drive.speed_scatter,
        ];
        Length::mm(causes.iter().map(|cause| cause.value().powi(2)).sum::<f64>().sqrt())
    }

    /// Lowest and highest speed, up to `fastest`, at which it lies within the band.
    fn speeds_in_band(&self, fastest: Spin) -> Option<[Spin; 2]> {
        let speeds = (1..).map(|k| STEP * f64::from(k)).take_while(|spin| *spin <= fastest);
        let mut within = speeds.filter(|spin| (BAND[0]..=BAND[1]).contains(&self.sigma(*spin)));
        let first = within.next()?;
        Some([first, within.last().unwrap_or(first)])
    }

    /// For people: 1σ at this speed, and where it lies in the band.
    pub(super) fn text(&self, spin: Spin, fastest: Spin) -> String {
        let (name, depth) = (&self.thread.designation, self.depth.value());
        let band = match self.speeds_in_band(fastest) {
            Some([from, to]) => format!("from S{:.0} to S{:.0}", from.in_rpm(), to.in_rpm()),
            None => "at no speed that this spindle taps with".to_owned(),
        };
        format!(
            "conventional cycle by the closed form: {name}, {depth} mm deep, S{:.0}: {:.2} mm too deep = H·n·(delay + t/2), \
             1σ {:.0} µm\n  \
             = √((H·n·σd)² + (H·n·σs·t/2)² + (σn·way in the work)²); with this drive it lies between {:.2} and {:.2} mm \
             {band}\n",
            spin.in_rpm(),
            overrun(&self.thread, spin, &self.drive).value(),
            self.sigma(spin).in_um(),
            BAND[0].value(),
            BAND[1].value(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M6, 14 mm deep, S2000 with a stopping time of 60 ms and a relay of 20 ± 5 ms: by hand.
    #[test]
    fn the_causes_add_up_as_squares() {
        let n = Spin::rpm(2000.0);
        let accel = n / Time::s(0.06);
        let drive = sim::PlainDrive {
            delay: Time::s(0.02),
            delay_scatter: Time::s(0.005),
            accel,
            decel: accel,
            ramp_scatter: 0.1,
            speed_scatter: 0.01,
            orients: None,
        };
        let thread: ThreadSize = "M6".parse().expect("a size of ISO 261");
        let scatter = Scatter { thread, depth: Length::mm(14.0), drive };
        // 33.33·5 µm·10³ = 166.7; 33.33·0.1·30 ms = 100.0; 1 % of 14 mm + 33.33·50 ms = 156.7
        let by_hand = (166.667_f64.powi(2) + 100.0_f64.powi(2) + 156.667_f64.powi(2)).sqrt();
        assert!((scatter.sigma(n).in_um() - by_hand).abs() < 0.01, "{}", scatter.sigma(n));
        let [from, to] = scatter.speeds_in_band(Spin::rpm(6000.0)).expect("some speeds");
        // 1 % of 14 mm are 140 µm at any speed: within the band from the first speed on
        assert!(from == STEP && scatter.sigma(from) >= BAND[0]);
        assert!(scatter.sigma(to) <= BAND[1] && scatter.sigma(to + STEP) > BAND[1]);
    }
}
