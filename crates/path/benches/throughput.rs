//! How many segments a second the law of time plans, and how much memory it needs:
//! `cargo bench -p path`.
use motion::Line;
use motion::{AXES, Bounds, Curve, Entry, Limits, Piece, Shape};
use path::law::{Config, Law};

#[allow(clippy::disallowed_methods)] // a bench measures
fn main() {
    let count = 2_000_000_u32;
    println!("{count} lines of 0.1 mm, feed changing from 60 to 120 mm/s each 40 of them");
    for (name, jerk) in [("none", f64::INFINITY), ("50 m/s³", 50e3), ("20 m/s³", 20e3)] {
        let b = Bounds { speed: [200.0; AXES], accel: [1000.0; AXES], jerk: [jerk; AXES] };
        let mut law = Law::new(Config { limits: Limits { feed: b, rapid: b }, period: 1e-3 });
        let begin = std::time::Instant::now();
        let (mut phases, mut time) = (0_u64, 0.0);
        for k in 0..count {
            law.push(piece(k)).expect("lines that can be followed");
            while let Some(timed) = law.next() {
                phases += 1;
                time += timed.phase.duration;
            }
        }
        law.close();
        while let Some(timed) = law.next() {
            phases += 1;
            time += timed.phase.duration;
        }
        let took = begin.elapsed().as_secs_f64();
        println!(
            "jerk {name:>8}: {:>9.0} segments/s, {:.0} times faster than the motion of {time:.2} s, {:.2} phases a segment, peak memory {} kB",
            f64::from(count) / took,
            time / took,
            phases as f64 / f64::from(count),
            peak_memory().unwrap_or(0),
        );
    }
}

fn piece(k: u32) -> Piece {
    let at = |k: u32| {
        core::array::from_fn(|i| [0.06, 0.08, 0.0].get(i).map_or(0.0, |d| d * f64::from(k)))
    };
    let curve = Curve::Line(Line { from: at(k), to: at(k + 1), length: 0.1 });
    let feed = if (k / 40).is_multiple_of(2) { 60.0 } else { 120.0 };
    Piece {
        curve,
        begin: 0.0,
        length: curve.length(),
        feed,
        rapid: false,
        entry: Entry::Smooth,
        op: 0,
        line: k,
    }
}

/// Most memory this process had at once, kB.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
