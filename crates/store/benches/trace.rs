//! What a row of the trace costs: time on the writer's thread, and bytes on the disk.
//!
//! The samples are those of a tapping stroke with encoder steps and a few tenths of a micrometre of
//! vibration, so that they are no easier to compress than a real run's.
use bus::{Sample, State, Truth};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::{f64::consts::TAU, hint::black_box};
use store::trace::{Columns, GROUP_ROWS, MeasuredDrives, Writer};
use units::{Angle, Coordinate, Force, Length, Spin, Time, Torque};

const ROWS: usize = 4 * GROUP_ROWS;

/// A stroke of 30 rev a second with 1 mm lead; vibration from a linear congruential generator.
fn samples() -> Vec<Sample> {
    let mut noise = 1_u64;
    let mut next = move || {
        noise =
            noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let row = |n: usize| {
        let t = n as f64 * 250e-6;
        let angle = 15.0 * (1.0 - (TAU * t).cos());
        let mut sample = Sample::default();
        let mut truth = Truth::default();
        sample.feedback.time = Time::s(t);
        for axis in 0..3 {
            let wanted = if axis == 2 { -100.0 - angle } else { -250.0 + axis as f64 };
            let real = wanted + 3e-4 * next();
            sample.command.axes[axis].position = Coordinate::new(wanted);
            sample.feedback.axes[axis].position =
                Coordinate::new((real * 65_536.0).floor() / 65_536.0);
            truth.axes[axis] = Coordinate::new(real);
            truth.axis_forces[axis] = Force::n(150.0 + 20.0 * next());
        }
        let real = angle + 1e-5 * next();
        sample.command.spindles[0].angle = Angle::rev(angle);
        sample.feedback.spindles[0].angle = Angle::rev((real * 1_048_576.0).floor() / 1_048_576.0);
        truth.spindles[0] = Angle::rev(real);
        truth.spins[0] = Spin::rev_per_s(15.0 * TAU * (TAU * t).sin() + 0.01 * next());
        truth.spindle_torques[0] = Torque::n_m(5.0 * (TAU * t).cos() + 0.1 * next());
        sample.report.line = 17;
        sample.report.state = if angle < 15.0 { State::TapIn } else { State::TapOut };
        sample.report.sync_error = (angle > 1.0).then(|| Length::um(3.0 * next()));
        sample.truth = Some(truth);
        sample
    };
    (0..ROWS).map(row).collect()
}

fn write(c: &mut Criterion) {
    let samples = samples();
    let home = tempfile::tempdir().expect("a folder for temporary files");
    let path = home.path().join("trace.parquet");
    let columns = Columns {
        axes: vec![(0, "x".into()), (1, "y".into()), (2, "z".into())],
        spindles: vec!["spindle".into()],
        measured: MeasuredDrives::default(),
    };
    let mut group = c.benchmark_group("trace");
    group.throughput(Throughput::Elements(ROWS as u64)).sample_size(10);
    group.bench_function("push 262,144 samples of 3 axes and a spindle", |b| {
        b.iter(|| {
            let mut writer = Writer::create(&path, columns.clone(), &[]).expect("a file");
            for sample in &samples {
                writer.push(black_box(sample)).expect("space on the disk");
            }
            writer.finish().expect("space on the disk");
        });
    });
    group.finish();
    let bytes = std::fs::metadata(&path).map_or(0, |m| m.len());
    println!("bytes per row: {:.1}", bytes as f64 / ROWS as f64);
}

criterion_group!(benches, write);
criterion_main!(benches);
