//! How many programmed moves a second are joined and timed:
//! `cargo bench -p path --bench cam [PART OF A NAME]`.
mod paths;
use motion::{AXES, Bounds, Limits, Piece};
use path::geometry::Joiner;
use path::law::{Config, Law};

/// Tolerance, mm.
const P: f64 = 0.01;

fn main() {
    let wanted = std::env::args().nth(1).filter(|word| !word.starts_with('-'));
    println!(
        "{:<20} {:>7} {:>9} {:>10} {:>9} {:>8}",
        "path, P 0.01 mm", "m/s³", "moves/s", "joined s", "timed s", "motion s"
    );
    for (name, segments) in paths::all(P) {
        if wanted.as_ref().is_some_and(|wanted| !name.contains(wanted.as_str())) {
            continue;
        }
        for jerk in [f64::INFINITY, 50.0, 20.0] {
            let bounds =
                Bounds { speed: [200.0; AXES], accel: [1000.0; AXES], jerk: [jerk * 1e3; AXES] };
            let limits = Limits { feed: bounds, rapid: bounds };
            let begin = processor_time();
            let mut pieces: Vec<Piece> = Vec::new();
            let mut joiner = Joiner::new(&limits);
            for one in &segments {
                joiner.push(*one, &mut |piece| pieces.push(piece));
            }
            joiner.finish(&mut |piece| pieces.push(piece));
            let joined = processor_time();
            let mut law = Law::new(Config { limits, period: 1e-3 });
            let mut motion = 0.0;
            for piece in &pieces {
                law.push(*piece).expect("a path that can be followed");
                motion +=
                    std::iter::from_fn(|| law.next()).map(|one| one.phase.duration).sum::<f64>();
            }
            law.close();
            motion += std::iter::from_fn(|| law.next()).map(|one| one.phase.duration).sum::<f64>();
            let timed = processor_time();
            let speed = segments.len() as f64 / (timed - begin);
            println!(
                "{name:<20} {jerk:>7} {speed:>9.0} {:>10.2} {:>9.2} {motion:>8.2}",
                joined - begin,
                timed - joined
            );
        }
    }
}

/// Processor time of this thread, s.
fn processor_time() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux says it");
    text.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).expect("a number") / 1e9
}
