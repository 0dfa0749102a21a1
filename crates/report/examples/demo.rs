//! Writes a report of a made-up plate, to look at: `cargo run -p report --example demo -- FOLDER`.
//! `good.html` has twelve good M6 threads, `bad.html` one that fails, `fault.html` stops in a hole,
//! `many.html` has five hundred features, `empty.html` none.
use std::path::PathBuf;

#[path = "../tests/support/mod.rs"]
mod support;
use support::{Mishap, plate, run};

fn main() -> std::io::Result<()> {
    let folder =
        PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "target/report-demo".into()));
    std::fs::create_dir_all(&folder)?;
    for (name, columns, rows, mishap) in [
        ("good", 4, 3, Mishap::None),
        ("bad", 4, 3, Mishap::Saturated(6)),
        ("fault", 4, 3, Mishap::Faulted(2)),
        ("many", 25, 10, Mishap::Saturated(77)),
    ] {
        let world = plate(columns, rows, mishap);
        let page = report::html(&world.run, &world.recorder, &world.features);
        std::fs::write(folder.join(format!("{name}.html")), &page)?;
        println!("{name}.html: {} kB, {} features", page.len() / 1000, world.features.len());
    }
    let page = report::html(&run("empty.ngc"), &report::Recorder::default(), &[]);
    std::fs::write(folder.join("empty.html"), page)
}
