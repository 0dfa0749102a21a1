//! What the recorder costs per servo period, and the page per report. `cargo bench -p report`: the
//! recorder's figure is per *run* of the plate; the number of periods is printed first.
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

#[path = "../tests/support/mod.rs"]
mod support;
use support::{Mishap, plate, samples};

fn recorder(criterion: &mut Criterion) {
    let (ops, samples) = samples(4, 3);
    println!("{} servo periods", samples.len());
    criterion.bench_function("record the plate", |bencher| {
        bencher.iter(|| {
            let mut recorder = report::Recorder::new(&support::tools());
            for (index, op) in &ops {
                recorder.op(*index, op);
            }
            for sample in &samples {
                recorder.sample(black_box(sample));
            }
            recorder
        });
    });
    let world = plate(25, 10, Mishap::Saturated(77));
    criterion.bench_function("write the page of 500 features", |bencher| {
        bencher.iter(|| report::html(&world.run, &world.recorder, &world.features).len());
    });
}

criterion_group!(benches, recorder);
criterion_main!(benches);
