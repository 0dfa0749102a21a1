//! The engine by the clock: the same setpoints as in lock-step, no memory taken, late periods
//! noticed and harmless.
#![allow(clippy::unwrap_used)] // a test may panic
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use bus::Sample;
use control::observers::Observer;
use control::{RealTimeFigures, RealTimeOptions};
use kernel::Event;
use leadscrew::{Ending, Program, Run, RunOptions};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

#[global_allocator]
static WATCHED: AllocDisabler = AllocDisabler;

/// A hole is drilled and tapped, a slot with rounded corners is milled under G64.
const PROGRAM: &str = "G21 G90 G54 G17 G94 G64 P0.01\nT3 M6\nG43 H3\nS2000 M3\nG0 X10 Y10 Z20\nG99 G84 X10 Y10 Z-6 R2 F2000\nG80\n\
    G1 X30 F6000\nX32 Y12\nX31 Y14.5\nX28 Y15\nG3 X20 Y15 R4\nG1 X10.2\nX10 Y10.5\nG0 Z50\nM2\n";

/// Every command and every reading, to the bit.
struct Heard(Arc<Mutex<Vec<Sample>>>);

impl Observer for Heard {
    fn sample(&mut self, sample: &Sample) {
        self.0.lock().unwrap().push(*sample);
    }

    fn event(&mut self, _: &Event) {}
}

fn run(real_time: Option<RealTimeOptions>) -> (Vec<Sample>, Option<RealTimeFigures>) {
    let job = Program::of("part", PROGRAM).on("tapping-center").unwrap();
    let options = RunOptions { real_time, ..RunOptions::default() };
    let mut run = Run::prepare(job, &options).map_err(|_| "not ready").unwrap();
    run.prove(&mut |_| {}).unwrap();
    let heard = Arc::new(Mutex::new(Vec::new()));
    run.observers.push(Box::new(Heard(Arc::clone(&heard))));
    let finished = run.execute(&mut |_| {}).unwrap();
    let figures = finished.outcome.real_time;
    if figures.is_none_or(|figures| figures.unobserved == 0) {
        // the tap goes into the full material
        assert_ne!(finished.ending(), Ending::Alarm, "{:?}", finished.outcome.faults);
    }
    drop(finished);
    (Arc::into_inner(heard).unwrap().into_inner().unwrap(), figures)
}

/// The same, in real time; a computer that had no time for the observers for a whole second shows
/// nothing, and is asked again.
fn run_by_the_clock(options: RealTimeOptions) -> (Vec<Sample>, RealTimeFigures) {
    for _ in 0..5 {
        let (heard, figures) = run(Some(options));
        let figures = figures.unwrap();
        if figures.unobserved == 0 {
            return (heard, figures);
        }
    }
    panic!("this computer has no time for observers");
}

#[test]
fn lock_step_and_real_time_command_the_same_to_the_last_bit_and_the_control_takes_no_memory_by_the_clock()
 {
    let (expected, none) = run(None);
    assert!(none.is_none() && expected.len() > 4000);
    let around: fn(&mut dyn FnMut()) = |part| assert_no_alloc(part);
    let (heard, figures) =
        run_by_the_clock(RealTimeOptions { around, ..RealTimeOptions::default() });
    assert!(figures.periods >= heard.len() as u64);
    assert_eq!(heard.len(), expected.len());
    for (heard, expected) in heard.iter().zip(&expected) {
        assert_eq!(heard, expected);
    }
}

#[test]
fn a_period_that_begins_late_is_counted_and_bends_no_synchronised_cut() {
    static PERIOD: AtomicU32 = AtomicU32::new(0);
    let (expected, _) = run(None);
    let around: fn(&mut dyn FnMut()) = |part| {
        // now and then the computer has something else to do for five milliseconds
        if PERIOD.fetch_add(1, Ordering::Relaxed) % 2000 == 1500 {
            std::thread::sleep(Duration::from_millis(5));
        }
        part();
    };
    let (heard, figures) =
        run_by_the_clock(RealTimeOptions { around, ..RealTimeOptions::default() });
    assert!(figures.late >= 2 && figures.worst_late_us > 4000.0, "{figures:?}");
    assert!(heard == expected);
}
