//! What is wrong with a program on a machine, with places and remedies.
//!
//! ```sh
//! cargo run -p leadscrew --example check -- programs/plate-12xM6.ngc tapping-center
//! ```
use leadscrew::Program;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let program = arguments.next().ok_or("expected a program")?;
    let machine = arguments.next().unwrap_or_else(|| "tapping-center".into());
    let mut job = Program::open(&program)?.on(machine.as_str())?;
    for finding in job.check() {
        println!("{program}:{}: {} {}", finding.span.line, finding.code, finding.message);
        if let Some(help) = &finding.help {
            println!("    {help}");
        }
    }
    Ok(())
}
