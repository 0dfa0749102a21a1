//! The same program on ten machines of one model, each with what its control does not know: how
//! many are good?
//!
//! ```sh
//! cargo run --release -p leadscrew --example run -- programs/plate-12xM6.ngc
//! ```
use leadscrew::{Ending, Program, RunOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let program = Program::open(std::env::args().nth(1).ok_or("expected a program")?)?;
    let mut good = 0;
    for seed in 1..=10 {
        let job = program.clone().on("tapping-center")?;
        let finished = job.run(&RunOptions { seed: Some(seed), ..RunOptions::default() })?;
        let certificate = finished.certificate();
        println!("seed {seed}: {:?}, {} passed", finished.ending(), certificate.count.passed);
        good += usize::from(finished.ending() == Ending::Good);
    }
    println!("{good} of 10 good");
    Ok(())
}
