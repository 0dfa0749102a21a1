//! How fast programs are read: `cargo bench -p gcode`. Prints the median of 15 readings, in
//! megabytes and blocks per second of processor time, where Linux counts it; else of the wall's.
#![allow(clippy::disallowed_methods)] // a bench measures: it has a clock

use std::fmt::Write;
use std::hint::black_box;
use std::sync::LazyLock;
use std::time::Instant;

/// What CAM systems write for a finishing pass: X, Y, Z with three or four places.
fn finishing_pass(lines: usize) -> String {
    let mut text = String::from("%\nG21 G90 G17\nG1 F1200\n");
    for i in 0..lines {
        let t = i as f64 * 0.001;
        let (x, y, z) = (50.0 * t.cos(), 50.0 * t.sin(), -0.5 * (7.0 * t).sin());
        let _ = writeln!(text, "G1 X{x:.4} Y{y:.4} Z{z:.3}");
    }
    text + "M2\n%\n"
}

/// The same with a line number, a feed and a comment in every line.
fn talkative_pass(lines: usize) -> String {
    let mut text = String::new();
    for i in 0..lines {
        let t = i as f64 * 0.001;
        let (x, y) = (50.0 * t.cos(), 50.0 * t.sin());
        let _ = writeln!(text, "N{i} g1 x {x:.3} y{y:.3} F{} (pass 1)", 800 + i % 400);
    }
    text
}

/// Parameters and expressions in every line.
fn macro_pass(lines: usize) -> String {
    let mut text = String::new();
    for i in 0..lines {
        let _ = writeln!(text, "#1=[#1+{}*SIN[#2/2]] #<depth>=-#3", i % 90);
        let _ = writeln!(text, "G1 X[#1*COS[{i}]] Y#<depth> Z-1.5");
    }
    text
}

/// Seconds that this thread has computed, or that have passed.
fn now() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let counted = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = counted.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

fn measure(name: &str, program: &str) {
    let mut block = gcode::Block::new();
    let mut seconds = Vec::new();
    let (mut blocks, mut words) = (0usize, 0usize);
    for _ in 0..15 {
        let start = now();
        let mut parser = gcode::Parser::new(black_box(program.as_bytes()), 0);
        (blocks, words) = (0, 0);
        while parser.next(&mut block) {
            blocks += 1;
            words += black_box(&block).words.len();
        }
        seconds.push(now() - start);
        assert!(parser.take_diagnostics().is_empty(), "the program has a mistake");
    }
    seconds.sort_by(f64::total_cmp);
    let median = seconds[seconds.len() / 2];
    println!(
        "{name:<16} {:>6.1} MB {blocks:>8} blocks {words:>8} words  {:>6.0} MB/s  {:>6.2} M blocks/s",
        program.len() as f64 / 1e6,
        program.len() as f64 / 1e6 / median,
        blocks as f64 / 1e6 / median,
    );
}

fn main() {
    measure("finishing pass", &finishing_pass(500_000));
    measure("talkative pass", &talkative_pass(300_000));
    measure("macro pass", &macro_pass(150_000));
}
