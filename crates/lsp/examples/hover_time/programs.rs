//! Programs of 100,000 lines, of the kinds that programs of that length are.
use interp::Dialect;

/// Lines of a program.
pub(crate) const LINES: u32 = 100_000;
/// Lines before those that it has by the thousand.
const HEAD: &str = "G21 G90 G94 G17\nT1 M6\nG54 G43 H1\nF1000 S1000 M3\nG0 X0 Y0 Z5\n";
const TAPE_HEAD: &str =
    "%\nO1\nG21 G90 G94 G17\nT1 M6\nG54 G43 H1\nF1000. S1000 M3\nG0 X0 Y0 Z5.\n";

/// A program of some kind.
pub(crate) struct Program {
    pub(crate) name: &'static str,
    pub(crate) dialect: Dialect,
    pub(crate) text: String,
    /// Lines of which it is made, one behind the other: edits come between two of these.
    pub(crate) round: u32,
    /// Its first such line, from 0.
    pub(crate) first: u32,
}

fn made(
    name: &'static str,
    dialect: Dialect,
    (head, tail): (&str, &str),
    round: u32,
    lines: impl Fn(u32) -> String,
) -> Program {
    let first = head.lines().count() as u32;
    let rounds = (LINES - first - tail.lines().count() as u32) / round;
    let body: String = (0..rounds).map(lines).collect();
    let text = format!("{head}{body}{tail}");
    Program { name, dialect, text, round, first }
}

/// Coordinates that do not repeat soon.
fn place(i: u32) -> (u32, u32, u32) {
    (i % 977, i % 613, i % 1000)
}

/// There and back, by tenths.
fn step(i: u32) -> (&'static str, u32) {
    (if (i / 50).is_multiple_of(2) { "" } else { "-" }, i % 50 / 7)
}

pub(crate) fn all() -> Vec<Program> {
    let mut all = of_linuxcnc();
    all.extend(of_fanuc());
    all
}

fn of_linuxcnc() -> Vec<Program> {
    let own = |name, head: &str, tail: &str, round, lines: &dyn Fn(u32) -> String| {
        made(name, Dialect::LinuxCnc, (&format!("{HEAD}{head}"), tail), round, lines)
    };
    vec![
        own("lines", "G1\n", "M2\n", 1, &|i| {
            let (x, y, part) = place(i);
            format!("X{x}.{part:03} Y{y}.5 Z-{}.25\n", i % 7)
        }),
        own("full", "", "M2\n", 1, &|i| {
            let (x, y, part) = place(i);
            format!("N{} G1 X{x}.{part:03} Y{y}.5 Z-{}.25 F{}\n", i + 10, i % 7, 500 + i % 9)
        }),
        own("arcs", "X10\n", "M2\n", 2, &|i| {
            let (a, b) = (10 + i % 80, 10 + (i + 1) % 80);
            let half = f64::from(a + b) / 2.0;
            format!("G2 X-{a} Y0 I-{a} J0\nG3 X{b} Y0 I{half:.1} J0\n")
        }),
        own("holes", "G99 G81 X1 Y1 Z-5 R2\n", "G80\nM2\n", 1, &|i| {
            let (x, y, part) = place(i);
            format!("X{x}.{part:03} Y{y}.5\n")
        }),
        own("holes by steps", "G91 G99 G81 X1 Y1 Z-5 R-2\n", "G80\nM2\n", 1, &|i| {
            let (sign, step) = step(i);
            format!("X{sign}{step}.5 Y{sign}1.25\n")
        }),
        own("steps", "G91 G1\n", "M2\n", 1, &|i| {
            let (sign, step) = step(i);
            format!("X{sign}{step}.5 Y{sign}1.25 Z{sign}0.5\n")
        }),
        own("loops", "#1=1\n#5=0\n", "M2\n", 5, &|i| {
            let (x, y, _) = place(i);
            format!(
                "o{0} if [#5 GT 50]\n#5=0\no{0} endif\n#5=[#5+1]\nG1 X{x}.5 Y[#5+{y}]\n",
                i + 10
            )
        }),
        made(
            "calls",
            Dialect::LinuxCnc,
            (&format!("o1 sub\nG1 X#1 Y#2\nG91\nZ0.1\nG90\nZ5\no1 endsub\n{HEAD}"), "M2\n"),
            1,
            |i| format!("o1 call [{}.5] [{}]\n", i % 977, i % 613),
        ),
    ]
}

fn of_fanuc() -> Vec<Program> {
    let own = |name, head: &str, tail: &str, round, lines: &dyn Fn(u32) -> String| {
        made(name, Dialect::Fanuc, (&format!("{TAPE_HEAD}{head}"), tail), round, lines)
    };
    let sub = "M30\nO7\nG91 X1. Y.5\nG1 Z-1.\nZ1.\nG90\nM99\n%\n";
    vec![
        own("tape full", "", "M30\n%\n", 1, &|i| {
            let (x, y, part) = place(i);
            let (n, z, f) = (10 + i % 9000, i % 7, 500 + i % 9);
            format!("N{n} G1 X{x}.{part:03} Y{y}.5 Z-{z}.25 F{f}.\n")
        }),
        own("tape lines", "G1\n", "M30\n%\n", 1, &|i| {
            let (x, y, part) = place(i);
            format!("X{x}.{part:03} Y{y}.5 Z-{}.25\n", i % 7)
        }),
        own("tape steps", "G91 G1\n", "M30\n%\n", 1, &|i| {
            let (sign, step) = step(i);
            format!("X{sign}{step}.5 Y{sign}1.25 Z{sign}0.5\n")
        }),
        own("tape arcs", "X10.\n", "M30\n%\n", 2, &|i| {
            let (a, b) = (10 + i % 80, 10 + (i + 1) % 80);
            let half = f64::from(a + b) / 2.0;
            format!("G2 X-{a}. Y0. I-{a}. J0.\nG3 X{b}. Y0. I{half:.1} J0.\n")
        }),
        own("tape loops", "#100=0\n#1=0\n", "M30\n%\n", 5, &|i| {
            let (x, y, _) = place(i);
            format!("#1=0\nWHILE [#1 LT 2] DO1\nG1 X{x}.5 Y[{y}+#1]\n#1=#1+1\nEND1\n")
        }),
        own("tape calls", "", sub, 2, &|i| {
            let (x, y, _) = place(i);
            format!("G0 X{x}.5 Y{y}.\nM98 P7\n")
        }),
    ]
}
