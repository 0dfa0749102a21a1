//! The joined path of a program as a grid of derivatives, and how long the law of time takes along
//! it: for `tools/optimum`.
//!
//! `grid PROGRAM P JERK STEP`: a program of G0 and G1 in mm, X Y Z at 200 mm/s and 1000 mm/s², P in
//! mm, jerk in m/s³ or `inf`. The first line is the time in s; each other one a stretch of the path
//! of about STEP mm: its length, its feed, and q′, q″, q‴ of X, Y and Z at its beginning, in its
//! middle, and at its end.
use motion::Line;
use motion::{AXES, Bounds, Curve, Limits, Piece, Shape};
use path::geometry::{Joiner, Segment};
use path::law::{Config, Law};
use std::error::Error;

/// Share of P that merging collinear moves takes where Q is not stated.
const MERGED: f64 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [program, tolerance, jerk, step] = words.as_slice() else {
        return Err("grid PROGRAM P JERK STEP".into());
    };
    let jerk = jerk.parse::<f64>()? * 1e3;
    let bounds = Bounds { speed: [200.0; AXES], accel: [1000.0; AXES], jerk: [jerk; AXES] };
    let limits = Limits { feed: bounds, rapid: bounds };
    let pieces = joined(&std::fs::read_to_string(program)?, tolerance.parse()?, &limits)?;
    println!("{}", duration(&pieces, &limits)?);
    let step: f64 = step.parse()?;
    for piece in &pieces {
        let count = (piece.length() / step).ceil().max(3.0);
        let h = piece.length() / count;
        for k in 0..count as u32 {
            let begin = h * f64::from(k);
            print!("{h} {}", piece.feed.min(1e6));
            for place in [begin, begin + h / 2.0, begin + h] {
                let d = piece.at(place);
                (0..3).for_each(|axis| print!(" {} {} {}", d.q1[axis], d.q2[axis], d.q3[axis]));
            }
            println!();
        }
    }
    Ok(())
}

/// The moves of a program, joined.
fn joined(program: &str, p: f64, limits: &Limits) -> Result<Vec<Piece>, Box<dyn Error>> {
    let (mut pieces, mut joiner) = (Vec::new(), Joiner::new(limits));
    let (mut at, mut feed, mut rapid) = ([0.0; AXES], 0.0, false);
    for (line, text) in (1_u32..).zip(program.lines()) {
        let mut to = at;
        for word in text.split_whitespace() {
            let (letter, number) = word.split_at(1);
            match letter {
                "X" | "Y" | "Z" => to["XYZ".find(letter).unwrap_or(0)] = number.parse()?,
                "F" => feed = number.parse::<f64>()? / 60.0,
                "G" if number == "0" || number == "1" => rapid = number == "0",
                _ => {}
            }
        }
        let length = (0..3).map(|k| (to[k] - at[k]) * (to[k] - at[k])).sum::<f64>().sqrt();
        if length > 0.0 {
            let curve = Curve::Line(Line { from: at, to, length });
            let feed = if rapid { f64::INFINITY } else { feed };
            let (tolerance, merge) = ((1.0 - MERGED) * p, MERGED * p);
            let move_ = Segment { curve, feed, rapid, tolerance, merge, op: line, line };
            joiner.push(move_, &mut |piece| pieces.push(piece));
        }
        at = to;
    }
    joiner.finish(&mut |piece| pieces.push(piece));
    Ok(pieces)
}

/// How long the law of time takes, s.
fn duration(pieces: &[Piece], limits: &Limits) -> Result<f64, Box<dyn Error>> {
    let mut law = Law::new(Config { limits: *limits, period: 1e-3 });
    let mut time = 0.0;
    for piece in pieces {
        law.push(*piece).map_err(|why| format!("{why:?}"))?;
        time += std::iter::from_fn(|| law.next()).map(|timed| timed.phase.duration).sum::<f64>();
    }
    law.close();
    Ok(time + std::iter::from_fn(|| law.next()).map(|timed| timed.phase.duration).sum::<f64>())
}
