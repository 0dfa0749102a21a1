//! `cargo xtask real-time`: the plate by the clock, again and again, and how well the servo thread
//! kept its time on this computer.
use control::{RealTimeFigures, RealTimeOptions};
use leadscrew::{Ending, Program, RunOptions};
use std::time::Duration;

/// What is cut.
const PROGRAM: &str = "programs/plate-12xM6.ngc";

/// For so long, as whole plates; a table of them.
///
/// # Errors
/// The program cannot be run.
pub(crate) fn run(lasts: Duration) -> Result<bool, String> {
    println!(
        "{PROGRAM} on tapping-center, 4 kHz; times are this computer's and no promise of hard real time"
    );
    println!(
        "plate  verdict  periods  late  latest µs  clock set anew  unobserved  tick median  p99.9  worst µs  ahead ms"
    );
    let began = control::clock::now();
    let (mut plates, mut all, mut are_good) = (0, RealTimeFigures::default(), true);
    while control::clock::now() - began < lasts {
        let options =
            RunOptions { real_time: Some(RealTimeOptions::default()), ..RunOptions::default() };
        let job = Program::open(PROGRAM).map_err(|e| e.to_string())?;
        let job = job.on("tapping-center").map_err(|e| e.to_string())?;
        let finished = job.run(&options).map_err(|e| e.to_string())?;
        for refused in finished.outcome.not_granted.iter().filter(|_| plates == 0) {
            println!("note: {refused}");
        }
        let figures = finished.outcome.real_time.ok_or("it did not run in real time")?;
        let is_good = finished.ending() == Ending::Good;
        (plates, are_good) = (plates + 1, are_good && is_good);
        let verdict = if is_good { "PASS" } else { "FAIL" };
        let ahead = finished.outcome.least_ahead;
        let ahead = ahead.map_or("-".into(), |least| format!("{:.0}", least.value() * 1e3));
        println!("{plates:5}  {verdict:7}  {}  {ahead:>8}", row(&figures));
        all = sum(&all, &figures);
    }
    println!("  all  {plates:7}  {}", row(&all));
    Ok(are_good)
}

fn row(figures: &RealTimeFigures) -> String {
    let RealTimeFigures {
        periods,
        late,
        worst_late_us,
        set_anew,
        unobserved,
        tick_median_us,
        tick_p999_us,
        tick_worst_us,
    } = figures;
    format!(
        "{periods:7}  {late:4}  {worst_late_us:9.0}  {set_anew:14}  {unobserved:10}  {tick_median_us:11.2}  {tick_p999_us:5.1}  {tick_worst_us:8.0}"
    )
}

/// Counts add up; of times the longest stays.
fn sum(a: &RealTimeFigures, b: &RealTimeFigures) -> RealTimeFigures {
    RealTimeFigures {
        periods: a.periods + b.periods,
        late: a.late + b.late,
        worst_late_us: a.worst_late_us.max(b.worst_late_us),
        set_anew: a.set_anew + b.set_anew,
        unobserved: a.unobserved + b.unobserved,
        tick_median_us: a.tick_median_us.max(b.tick_median_us),
        tick_p999_us: a.tick_p999_us.max(b.tick_p999_us),
        tick_worst_us: a.tick_worst_us.max(b.tick_worst_us),
    }
}
