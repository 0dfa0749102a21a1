//! Print the operations of a program, then what was found: `cargo run --example operations FILE`.
use interp::{Ops, Setup};

fn main() -> std::process::ExitCode {
    let Some(file) = std::env::args().nth(1) else {
        eprintln!("usage: operations FILE");
        return 2.into();
    };
    let source = match std::fs::read(&file) {
        Ok(source) => source,
        Err(error) => {
            eprintln!("{file}: {error}");
            return 2.into();
        }
    };
    let setup = Setup::default();
    let mut ops = Ops::new(&source, &setup);
    for op in ops.by_ref() {
        println!("{:5}  {:?}", op.span.line, op.kind);
    }
    for diagnostic in interp::check(&source, &setup) {
        let mark = if diagnostic.is_error() { "error" } else { "warning" };
        eprintln!(
            "{file}:{}: {mark} {}: {}",
            diagnostic.span.line, diagnostic.code, diagnostic.message
        );
    }
    u8::from(ops.has_errors()).into()
}
