//! A sample of a path stands for the whole of it.
use crate::common::{OPTIONS, line, machine, mm, program, rapid, tools, turn};
use canon::{OpKind, PathMode};
use plan::{Clock, FeedAndRapid, MachineLimits, Planner, Sample, Start, StepKind};
use test_support::size;
use units::Time;

fn blended(p: f64) -> OpKind {
    OpKind::PathMode(PathMode::Blend { tolerance: Some(mm(p)), merge: None })
}

/// Rows of short chords over a wavy surface.
fn surface(count: usize) -> Vec<OpKind> {
    let row = |k: usize| {
        let (row, at) = (k / 400, k % 400);
        let x = 0.2 * if row.is_multiple_of(2) { at as f64 } else { 400.0 - at as f64 };
        line(x, 0.3 * row as f64 % 150.0, -20.0 + 2.0 * (x / 7.0).sin(), 5000.0)
    };
    (0..count).map(row).collect()
}

/// Long and short lines with corners of all angles, and a rapid now and then.
fn corners(count: usize) -> Vec<OpKind> {
    let (mut x, mut y) = (0.0_f64, 0.0_f64);
    let one = |k: usize| {
        let turned = 2.4 * (k as f64).powf(1.1);
        let length = 0.1 + 4.0 * (0.37 * k as f64).sin().powi(2);
        x = (x + length * turned.cos()).clamp(-100.0, 100.0);
        y = (y + length * turned.sin()).clamp(-100.0, 100.0);
        if k % 17 == 3 {
            rapid(x, y, -10.0)
        } else {
            line(x, y, -10.0, 2000.0 + 40.0 * turned % 4000.0)
        }
    };
    (0..count).map(one).collect()
}

/// A machine that is slow to start, so that leads are long.
fn slow() -> MachineLimits {
    let mut limits = machine();
    for axis in limits.axes.iter_mut().flatten() {
        axis.accel = axis.accel * 0.1;
        axis.feed_jerk = units::CoordinateJerk::new(2e4);
        axis.rapid_jerk = units::CoordinateJerk::new(2e4);
    }
    limits
}

fn planner(limits: &MachineLimits) -> Planner {
    Planner::new(limits.clone(), tools(), OPTIONS, Start::default())
}

fn whole(limits: &MachineLimits, kinds: &[OpKind]) -> FeedAndRapid {
    let (mut clock, mut times) = (Clock::default(), FeedAndRapid::default());
    let mut planner = planner(limits);
    let mut count = |step: plan::Step| {
        let before = clock.elapsed();
        clock.count(&step, limits);
        let lasts = clock.elapsed() - before;
        match &step.kind {
            StepKind::Follow(follow) if follow.piece.rapid => times.rapid += lasts,
            StepKind::Follow(_) => times.feed += lasts,
            _ => {}
        }
    };
    for (index, op) in (0..).zip(&program(kinds.iter().cloned())) {
        planner.push(index, op, &mut count);
    }
    planner.finish(&mut count);
    times
}

fn sampled(limits: &MachineLimits, kinds: &[OpKind]) -> Sample {
    let mut planner = planner(limits).sampling();
    for (index, op) in (0..).zip(&program(kinds.iter().cloned())) {
        planner.push(index, op, &mut |step| {
            assert!(!matches!(step.kind, StepKind::Follow(_)), "line {}: planned", step.line);
        });
    }
    planner.finish(&mut |_| ());
    planner.take_sample().expect("it samples")
}

#[test]
fn stretches_planned_by_themselves_take_as_long_as_in_the_whole_path() {
    for (name, path) in [("surface", surface(1600)), ("corners", corners(1600))] {
        let machines = [(machine(), 0.01), (slow(), 0.1), (slow(), 0.01)];
        for (limits, p) in size::first_of(2, &machines) {
            let kinds =
                [vec![turn(3000.0), rapid(0.0, 0.0, -10.0), blended(*p)], path.clone()].concat();
            let sample = sampled(limits, &kinds);
            assert!(sample.stretches >= 8 && sample.kept.len() == sample.stretches, "{name}");
            let mut sum = FeedAndRapid::default();
            for stretch in &sample.kept {
                let time = stretch.plan(limits);
                sum.feed += time.feed;
                sum.rapid += time.rapid;
            }
            let whole = whole(limits, &kinds);
            let total = whole.total();
            for (sum, whole) in [(sum.feed, whole.feed), (sum.rapid, whole.rapid)] {
                let off = (sum - whole).abs();
                assert!(off <= total * 0.002, "{name}, P {p}: {sum:?} of {whole:?}");
            }
        }
    }
}

#[test]
fn of_a_long_path_a_sample_is_kept_that_lies_all_over_it() {
    let kinds =
        [vec![turn(3000.0), rapid(0.0, 0.0, -10.0), blended(0.01)], surface(240_000)].concat();
    let sample = sampled(&machine(), &kinds);
    assert!(sample.stretches > 1100, "{}", sample.stretches);
    assert!(
        (256..=512).contains(&sample.kept.len()),
        "{} of {}",
        sample.kept.len(),
        sample.stretches
    );
    // one in each step of rough time, but where a stretch lies over two of them
    let steps = sample.rough / sample.step;
    assert!(sample.kept.len() as f64 > 0.9 * steps - 1.0, "{} in {steps} steps", sample.kept.len());
    let on = |step: Time| sample.kept.iter().filter(|stretch| stretch.lies_on(step)).count();
    assert_eq!(on(sample.step), sample.kept.len());
    let half = on(sample.step * 2.0) as f64 / sample.kept.len() as f64;
    assert!((0.4..0.6).contains(&half), "{half}");
}

#[test]
fn a_move_that_stays_alone_is_planned() {
    let kinds = [turn(3000.0), rapid(0.0, 0.0, -10.0), line(50.0, 0.0, -10.0, 1000.0)];
    assert_eq!(sampled(&machine(), &kinds).stretches, 0);
}
