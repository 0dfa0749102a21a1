//! How late a servo thread begins its periods on this computer, measured with its own clock,
//! priority and core while nothing is led.
use control::clock::PeriodClock;
use control::{Refused, run_by_deadline, servo_core};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::Duration;
use units::Time;

/// Bins of the histogram, 1 µs each; the last one holds everything longer.
const BINS: usize = 20_001;
/// How often progress is said.
const SAID: Duration = Duration::from_millis(100);
/// Memory that each thread of the load goes through, bytes.
const LOAD_BYTES: usize = 16 << 20;

/// Length and conditions of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct LatencyOptions {
    /// Servo period.
    pub period: Time,
    /// For how long.
    pub lasts: Time,
    /// Beside threads that keep each core busy.
    pub under_load: bool,
    /// Priority under `SCHED_FIFO`.
    pub priority: u8,
}

/// How late periods began.
#[derive(Clone, Debug, PartialEq)]
pub struct Latency {
    /// Servo period.
    pub period: Time,
    /// Whether each core was kept busy meanwhile.
    pub under_load: bool,
    /// The core that it ran on; `None`: any.
    pub core: Option<usize>,
    /// Periods that began.
    pub periods: u64,
    /// Periods that began more than a period late.
    pub missed: u64,
    /// Largest lateness.
    pub worst: Time,
    /// Periods that began late by 0 to 1 µs, 1 to 2 µs, …; the last bin has no upper end.
    pub histogram: Vec<u64>,
    /// What the operating system has refused, in sentences.
    pub refused: Vec<String>,
}

impl Latency {
    /// Lateness that this share of the periods stays below: the upper end of its bin.
    pub fn quantile(&self, share: f64) -> Time {
        let mut rest = (self.periods as f64 * share) as u64;
        for (us, count) in (1_u32..).zip(&self.histogram[..BINS - 1]) {
            if *count > rest {
                return Time::s(f64::from(us) * 1e-6);
            }
            rest -= count;
        }
        self.worst
    }
}

/// Measures until the time is over or `stop` is set, and says progress from 0 to 1.
///
/// # Errors
/// A thread cannot be started, or not a single period was measured.
pub fn measure(
    options: &LatencyOptions,
    stop: &AtomicBool,
    progress: &dyn Fn(f64),
) -> Result<Latency, Refused> {
    let wanted = (options.lasts.value() / options.period.value()).ceil().max(1.0) as u64;
    let (begun, is_over) = (AtomicU64::new(0), AtomicBool::new(false));
    let threads = if options.under_load { cores() } else { 0 };
    let measured = std::thread::scope(|scope| {
        for _ in 0..threads {
            let is_over = &is_over;
            spawn(scope, "load", move || keep_busy(is_over))?;
        }
        let (begun, is_ended) = (&begun, &is_over);
        let servo = spawn(scope, "servo", move || periods(options, wanted, (begun, is_ended)))?;
        while !servo.is_finished() {
            if stop.load(Relaxed) {
                is_over.store(true, Relaxed);
            }
            progress(begun.load(Relaxed) as f64 / wanted as f64);
            std::thread::sleep(SAID);
        }
        is_over.store(true, Relaxed);
        servo.join().map_err(|_| Refused::because("the measuring thread has broken down"))
    });
    is_over.store(true, Relaxed);
    let latency = measured?;
    if latency.periods == 0 {
        return Err(Refused::because("interrupted before the first period: nothing was measured"));
    }
    Ok(Latency { under_load: options.under_load, ..latency })
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

fn spawn<'scope, 'env, T: Send + 'scope>(
    scope: &'scope std::thread::Scope<'scope, 'env>,
    name: &str,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<std::thread::ScopedJoinHandle<'scope, T>, Refused> {
    let thread = std::thread::Builder::new().name(name.to_owned());
    let started = thread.spawn_scoped(scope, work);
    started.map_err(|why| Refused::because(format!("cannot start a thread: {why}")))
}

/// The thread that is measured.
fn periods(
    options: &LatencyOptions,
    wanted: u64,
    (begun, is_over): (&AtomicU64, &AtomicBool),
) -> Latency {
    let mut histogram = vec![0_u64; BINS];
    let refused = run_by_deadline(options.priority);
    let period = Duration::from_secs_f64(options.period.value());
    let (mut worst, mut missed, mut count) = (Duration::ZERO, 0, 0);
    let mut clock = PeriodClock::new(period);
    while count < wanted && !is_over.load(Relaxed) {
        let late = clock.wait().late;
        let us = usize::try_from(late.as_micros()).unwrap_or(BINS - 1).min(BINS - 1);
        histogram[us] += 1;
        worst = worst.max(late);
        missed += u64::from(late > period);
        count += 1;
        begun.store(count, Relaxed);
    }
    Latency {
        period: options.period,
        under_load: false,
        core: servo_core(),
        periods: count,
        missed,
        worst: Time::s(worst.as_secs_f64()),
        histogram,
        refused,
    }
}

/// Takes a core and its memory bus for itself, as building, a page or a slicer does.
fn keep_busy(is_over: &AtomicBool) {
    let mut memory = vec![1_u64; LOAD_BYTES / size_of::<u64>()];
    let mut sum = 0_u64;
    while !is_over.load(Relaxed) {
        for chunk in memory.chunks_mut(1 << 16) {
            for word in chunk {
                sum = sum.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(*word);
                *word ^= sum;
            }
            if is_over.load(Relaxed) {
                break;
            }
        }
    }
    std::hint::black_box(sum);
}
