//! Long programs of six kinds, for the bench: what machines are fed, and what costs an interpreter
//! most.

use std::fmt::Write;

/// A kind of program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// `G1 X Y Z` in every line, as CAM systems write a finishing pass.
    Lines,
    /// N, G1, six axes and F in every line.
    FullWords,
    /// A drilling cycle in every line, with all of its words.
    Cycles,
    /// One O-word loop: a condition, three settings with expressions, a move.
    Loops,
    /// A subprogram call with three arguments in every line.
    Calls,
    /// Arcs with I and J, every fourth a helix.
    Arcs,
}

impl Kind {
    pub(crate) const ALL: [Self; 6] =
        [Self::Lines, Self::FullWords, Self::Cycles, Self::Loops, Self::Calls, Self::Arcs];

    /// For people.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Lines => "G1 lines",
            Self::FullWords => "full-word G1 lines",
            Self::Cycles => "canned cycles",
            Self::Loops => "O-word loops",
            Self::Calls => "subprogram calls",
            Self::Arcs => "arcs",
        }
    }

    /// Executed lines for so many lines of the bench: LinuxCNC takes ten times as long for a cycle
    /// as for a move.
    pub(crate) const fn lines(self, lines: usize) -> usize {
        match self {
            Self::Lines | Self::FullWords | Self::Loops | Self::Arcs => lines,
            Self::Cycles | Self::Calls => lines / 4,
        }
    }

    /// A program of about so many executed lines.
    pub(crate) fn program(self, lines: usize) -> String {
        let mut text = String::from("G21 G90 G17 G94 G54\nT1 M6\nS1000 M3\nF1200\nG0 X0 Y0 Z5\n");
        match self {
            Self::Lines => per_line(&mut text, lines, |text, i, [x, y, z]| {
                let _ = i;
                writeln!(text, "G1 X{x:.4} Y{y:.4} Z{z:.3}")
            }),
            Self::FullWords => per_line(&mut text, lines, |text, i, [x, y, z]| {
                let n = i % 99_999 + 1;
                writeln!(
                    text,
                    "N{n} G1 X{x:.4} Y{y:.4} Z{z:.4} A{:.3} B{:.3} C{:.3} F{:.1}",
                    x * 0.1,
                    y * 0.1,
                    z * 10.0,
                    900.0 + y
                )
            }),
            Self::Cycles => per_line(&mut text, lines, |text, _, [x, y, z]| {
                writeln!(text, "G99 G81 X{x:.3} Y{y:.3} Z{:.3} R2 F300", z - 5.0)
            }),
            Self::Loops => {
                let rounds = lines / 6;
                let _ = write!(
                    text,
                    "#1=0\no100 while [#1 LT {rounds}]\n#2=[50*COS[#1*0.05]]\n\
                     #3=[50*SIN[#1*0.05]-[#1 MOD 7]/100]\n#1=[#1+1]\nG1 X#2 Y[#3+0.5] Z[-#1/100000]\n\
                     o100 endwhile\n"
                );
            }
            Self::Calls => {
                text += "o200 sub\nG1 X[#1+0.5] Y[#2*2] Z#3\no200 endsub\n";
                per_line(&mut text, lines / 3, |text, _, [x, y, z]| {
                    writeln!(text, "o200 call [{x:.3}] [{y:.3}] [{z:.3}]")
                });
            }
            Self::Arcs => {
                text += "G1 X0 Y0\n";
                for i in 0..lines {
                    let x = if i % 2 == 0 { 10 } else { 0 };
                    let (code, j) = if i % 3 == 0 { (2, 0.0) } else { (3, 0.0) };
                    let i_word = if x == 10 { 5 } else { -5 };
                    let _ = match i % 4 {
                        0 => writeln!(text, "G{code} X{x} Y0 I{i_word} J{j:.1} Z{}", i % 5),
                        _ => writeln!(text, "G{code} X{x} Y0 I{i_word} J{j:.1}"),
                    };
                }
            }
        }
        text + "M2\n"
    }
}

/// A line for each point of a wavy pass.
fn per_line(
    text: &mut String,
    lines: usize,
    write: impl Fn(&mut String, usize, [f64; 3]) -> std::fmt::Result,
) {
    for i in 0..lines {
        let t = i as f64 * 0.001;
        let point = [50.0 * t.cos(), 50.0 * t.sin(), -0.5 * (7.0 * t).sin()];
        let _ = write(text, i, point); // a String takes everything
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::listing::{Outcome, ours, tools};

    #[test]
    fn every_kind_of_program_is_accepted() {
        for kind in Kind::ALL {
            let outcome = ours(kind.program(60).as_bytes(), tools());
            assert!(matches!(outcome, Outcome::Accepted(calls) if calls.len() > 30), "{kind:?}");
        }
    }
}
