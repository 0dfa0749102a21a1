//! Programs at random whose tool, zero or place is shifted off the work, run as a user runs them:
//! none of them passes.
//!
//! ```text
//!   hole or thread, units, dialect, place ─┬─ as it should be ──────────────► PASS, exit 0
//!                                          └─ H, G43, G54, G92, G52, X Y off ► never exit 0
//! ```
use proptest::prelude::*;
use std::process::Command;
use test_support::size;

/// What is made: cycle, tool, speed, feed of a turn in mm, depth in mm.
#[derive(Clone, Copy, Debug)]
enum Work {
    Drilled,
    PeckDrilled,
    Tapped,
    PeckTapped,
}

/// What is wrong.
#[derive(Clone, Copy, Debug)]
enum Shift {
    /// Another tool's length is in force.
    OtherLength,
    /// None is: the drill's is cancelled before the tap is called.
    NoLength,
    /// The work offset is off by so many mm along Z.
    WorkOffset(f64),
    /// G92 says that the tool stands elsewhere.
    G92(f64),
    /// G52 moves the zero.
    G52(f64),
    /// The control's table has the tool longer than it is.
    Table(f64),
    /// Beside the stock, whose sides are 150 mm from zero along Y.
    Beside,
}

#[derive(Clone, Copy, Debug)]
struct Case {
    work: Work,
    inch: bool,
    fanuc: bool,
    x: f64,
    y: f64,
    depth: f64,
}

impl Case {
    fn mm(&self, value: f64) -> String {
        format!("{:.5}", if self.inch { value / 25.4 } else { value })
    }

    /// The tool's number, its neighbour of another length, and the lines of the cycle.
    fn cycle(&self, y: f64) -> (u32, u32, String) {
        let at = format!("X{} Y{}", self.mm(self.x), self.mm(y));
        let (z, r) = (self.mm(-self.depth), self.mm(4.0));
        match self.work {
            Work::Drilled => {
                (2, 3, format!("S3000 M3\nG98 G81 {at} Z{z} R{r} F{}\n", self.mm(300.0)))
            }
            Work::PeckDrilled => {
                let peck = self.mm(self.depth / 3.0);
                (2, 3, format!("S3000 M3\nG98 G83 {at} Z{z} R{r} Q{peck} F{}\n", self.mm(300.0)))
            }
            Work::Tapped => {
                (3, 2, format!("S1000 M3\nG98 G84 {at} Z{z} R{r} F{}\n", self.mm(1000.0)))
            }
            Work::PeckTapped => {
                let peck = self.mm(self.depth / 2.0);
                (3, 2, format!("S1000 M3\nG98 G84 {at} Z{z} R{r} Q{peck} F{}\n", self.mm(1000.0)))
            }
        }
    }

    fn program(&self, shift: Option<Shift>) -> String {
        let y = if matches!(shift, Some(Shift::Beside)) { 160.0 } else { self.y };
        let (tool, other, cycle) = self.cycle(y);
        let units = if self.inch { "G20" } else { "G21" };
        let head = if self.fanuc { "O0001\n" } else { "" };
        // the machine's own zero along Z is −300 mm
        let before = match shift {
            Some(Shift::WorkOffset(by)) => format!("G10 L2 P1 Z{}\n", self.mm(-300.0 + by)),
            _ => String::new(),
        };
        let length = match shift {
            Some(Shift::OtherLength) => format!("G43 H{other}\n"),
            Some(Shift::NoLength) => "G49\n".to_owned(),
            _ => format!("G43 H{tool}\n"),
        };
        let after = match shift {
            Some(Shift::G92(by)) => {
                format!("G0 Z{}\nG92 Z{}\n", self.mm(60.0), self.mm(60.0 - by))
            }
            Some(Shift::Table(by)) if !self.fanuc => {
                let length = if tool == 2 { 118.5 } else { 105.25 };
                format!("G10 L1 P{tool} Z{}\nG43 H{tool}\n", self.mm(length + by))
            }
            Some(Shift::G52(by) | Shift::Table(by)) => format!("G52 Z{}\n", self.mm(by)),
            _ => String::new(),
        };
        format!(
            "{head}{units} G17 G40 G49 G80 G90 G94 G54\n{before}T{tool} M6\n{length}{after}G0 X{} Y{}\n{cycle}G80\nM30\n",
            self.mm(self.x),
            self.mm(y)
        )
    }

    /// Exit code and what was said.
    fn run(&self, shift: Option<Shift>) -> (i32, String) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.nc");
        let program = self.program(shift);
        std::fs::write(&path, &program).unwrap();
        let tools = concat!(env!("CARGO_MANIFEST_DIR"), "/../../programs/tools.toml");
        let dialect = if self.fanuc { "fanuc" } else { "linuxcnc" };
        let output = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
            .args(["run", path.to_str().unwrap(), "--tools", tools, "--dialect", dialect])
            .output()
            .unwrap();
        let said = [output.stdout, output.stderr].concat();
        let said = format!("{program}\n{}", String::from_utf8_lossy(&said));
        (output.status.code().unwrap_or(-1), said)
    }
}

fn case() -> impl Strategy<Value = Case> {
    let work = prop_oneof![
        Just(Work::Drilled),
        Just(Work::PeckDrilled),
        Just(Work::Tapped),
        Just(Work::PeckTapped)
    ];
    (work, any::<bool>(), any::<bool>(), -150.0..150.0, -100.0..100.0, 8.0..15.0)
        .prop_map(|(work, inch, fanuc, x, y, depth)| Case { work, inch, fanuc, x, y, depth })
}

fn shift() -> impl Strategy<Value = Shift> {
    let by = prop_oneof![-12.0..-0.3, 0.3..25.0];
    prop_oneof![
        Just(Shift::OtherLength),
        Just(Shift::NoLength),
        by.clone().prop_map(Shift::WorkOffset),
        by.clone().prop_map(Shift::G92),
        by.clone().prop_map(Shift::G52),
        by.prop_map(Shift::Table),
        Just(Shift::Beside),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 6, ..ProptestConfig::with_cases(size::of(10, 300)) })]

    #[test]
    fn what_is_shifted_off_the_work_never_passes(case in case(), shift in shift()) {
        let (code, said) = case.run(Some(shift));
        prop_assert!(code != 0 && !said.contains("PASS"), "{shift:?}\n{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 6, ..ProptestConfig::with_cases(size::of(5, 100)) })]

    #[test]
    fn the_same_programs_where_they_belong_pass(case in case()) {
        let (code, said) = case.run(None);
        prop_assert!(code == 0 && said.contains("PASS"), "{said}");
    }
}
