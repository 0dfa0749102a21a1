//! Print a program as LinuxCNC's stand-alone interpreter would:
//! `cargo run --example listing FILE [TOOLS]`.
//!
//! TOOLS, if given, is a list of `number:length_mm` pairs separated by commas.
use canon::{Tool, ToolKind, ToolLibrary};
use interp::{Interpreter, Listing, Progress, Setup};
use units::Length;

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else {
        eprintln!("usage: listing FILE [number:length_mm,…]");
        return 2.into();
    };
    let source = match std::fs::read(&file) {
        Ok(source) => source,
        Err(error) => {
            eprintln!("{file}: {error}");
            return 2.into();
        }
    };
    let tools = arguments.next().unwrap_or_default();
    let tools = ToolLibrary::new(tools.split(',').filter_map(tool));
    let setup = Setup { tools, stand_alone: true, ..Setup::default() };
    let mut interpreter = Interpreter::new(&source, &setup);
    let mut listing = Listing::new(std::io::stdout().lock());
    // Stop at the first error, as rs274 does.
    while interpreter.step(&mut listing) == Progress::More && !interpreter.has_errors() {}
    for diagnostic in interpreter.diagnostics() {
        eprintln!("{}:{}: {} {}", file, diagnostic.span.line, diagnostic.code, diagnostic.message);
    }
    match listing.finish() {
        Ok(_) => u8::from(interpreter.has_errors()).into(),
        Err(_) => 2.into(),
    }
}

fn tool(text: &str) -> Option<Tool> {
    let (number, length) = text.split_once(':')?;
    Some(Tool {
        number: number.trim().parse().ok()?,
        pocket: 1,
        length: Length::mm(length.trim().parse().ok()?),
        diameter: Length::mm(3.0),
        kind: ToolKind::Other,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    })
}
