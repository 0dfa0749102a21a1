//! How long a program takes, and with which tool.
//!
//! ```sh
//! cargo run -p leadscrew --example time -- programs/plate-12xM6.ngc
//! ```
use leadscrew::Program;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let program = std::env::args().nth(1).ok_or("expected a program")?;
    let times = Program::open(&program)?.on("tapping-center")?.time()?;
    println!("{:.2} s", times.total().value());
    for (tool, shares) in times.by_tool() {
        println!(
            "  T{tool}: {:.2} s, of which {:.2} s tapping",
            shares.total().value(),
            shares.tap.value()
        );
    }
    Ok(())
}
