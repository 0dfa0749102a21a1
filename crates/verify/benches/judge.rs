//! What the judge costs a servo period: between features, over a hole, in a thread.
//!
//! `cargo bench -p verify`. A simulated period costs well under a microsecond, so between features
//! the judge must cost next to nothing.
#[path = "../tests/common/mod.rs"]
mod common;
use common::{Record, config, drilling, hole_ops, tools};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use verify::Judge;

fn judge(c: &mut Criterion) {
    let record = Record::new(2, 1.0);
    let mut group = c.benchmark_group("judge");

    let between = record.samples(0, |_, _| 0.0);
    group.throughput(Throughput::Elements(between.len() as u64));
    group.bench_function("between features", |b| {
        let mut judge = Judge::new(config(tools()));
        judge.op(1, &record.op(10));
        b.iter(|| between.iter().for_each(|sample| judge.sample(black_box(sample))));
    });

    let drilled = drilling(0, 1, [30.0, 20.0], 12.0);
    group.throughput(Throughput::Elements(drilled.len() as u64));
    group.bench_function("in a hole", |b| {
        let mut judge = Judge::new(config(tools()));
        for (index, op) in hole_ops(7, [30.0, 20.0], 12.0).iter().enumerate() {
            judge.op(index as u32, op);
        }
        b.iter(|| drilled.iter().for_each(|sample| judge.sample(black_box(sample))));
    });

    let tapped = record.samples(0, |depth, _| 0.005 * depth.sin());
    group.throughput(Throughput::Elements(tapped.len() as u64));
    group.bench_function("in a thread", |b| {
        let mut judge = Judge::new(config(tools()));
        judge.op(0, &record.op(10));
        b.iter(|| tapped.iter().for_each(|sample| judge.sample(black_box(sample))));
    });

    group.throughput(Throughput::Elements(1));
    group.bench_function("measure and gauge one thread", |b| {
        b.iter_batched(
            || {
                let mut judge = Judge::new(config(tools()));
                judge.op(0, &record.op(10));
                for sample in &tapped {
                    judge.sample(sample);
                }
                judge
            },
            |judge| black_box(judge.finish()),
            criterion::BatchSize::SmallInput,
        );
    });
    group.finish();
}

criterion_group!(benches, judge);
criterion_main!(benches);
