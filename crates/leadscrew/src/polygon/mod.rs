//! From the form wanted to the block that cuts it, on this machine.
//!
//! ```text
//!   form, cutter ─► refusals ─► every actuator: flattest within its limits ─► the best one ─► table, page, G-code
//! ```
mod block;
mod claim;
mod prove;
mod servo_error;

pub use claim::Claim;
pub use prove::{Cut, Proof};
pub use servo_error::ServoError;

use control::Refused;
use control::config::machine_file::MachineSource;
use control::polygon::{
    AS_FLAT, CANDIDATES, FINE_HARMONICS, HARMONICS, SLOWEST_RPM, drives, fastest, flattest, kept,
    may_swing, problem, refuse,
};
use forms::polygon::{Actuator, Detail, Form, Problem, Solution, insert_phases};
use std::path::{Path, PathBuf};
use store::machine::MachineFile;
use store::phases::Phases;
use units::{Angle, Length, Spin};

/// How much faster it may be had by a swing in full detail than by one that is drawn.
const ROUGHLY: f64 = 1.04;

/// Everything that was asked, checked.
pub struct Design {
    /// The machine.
    pub machine: MachineFile,
    /// The form, and the cutter.
    pub form: Form,
    /// Speed of the work.
    pub work: Spin,
    /// As many as the user asks for; else as many as it takes.
    pub harmonics: Option<usize>,
    /// What air cuts have shown.
    pub phases: Phases,
    /// What may swing.
    pub chosen: canon::Actuator,
    /// Flatness that is wanted.
    pub wanted: Option<Length>,
    /// Length of the polygon.
    pub length: Length,
    /// Feed along Z for a turn of the work.
    pub feed_per_rev: Length,
    /// Number of the cutter.
    pub tool: u32,
    /// What is to be known of the tool table, if the cutter is not in it.
    pub to_enter: Option<String>,
}

/// A flatness for which the fastest speed is looked for.
pub struct Aim {
    /// The flatness.
    pub flatness: Length,
    /// Where it comes from.
    pub whose: &'static str,
}

/// One way, solved.
pub struct SolvedMotion {
    /// Who swings.
    pub name: &'static str,
    /// What comes of it.
    pub solution: Solution,
}

/// What is wanted.
#[derive(Debug, Clone)]
pub struct PolygonOptions {
    /// The machine: an embedded name, or a file.
    pub machine: MachineSource,
    /// Sides of a regular polygon.
    pub sides: u32,
    /// Where the inserts stand in the cutter, degrees; empty: equally spaced.
    pub insert_angles: Vec<f64>,
    /// Equally spaced inserts; `None` is as the sides need.
    pub inserts: Option<u32>,
    /// Size across flats, mm.
    pub across_flats: f64,
    /// From the tool spindle's axis to the inserts' tips, mm.
    pub tip_radius: f64,
    /// Turns of work and tool, as in `1:2`.
    pub ratio: String,
    /// Diameter of the bar, mm; `None` is the machine's stock.
    pub stock: Option<f64>,
    /// Speed of the work, rev/min.
    pub speed: f64,
    /// Flatness wanted, µm: how fast it can be had is found.
    pub flatness: Option<f64>,
    /// What may swing.
    pub actuator: canon::Actuator,
    /// Harmonics of each oscillation; `None` is as many as it takes.
    pub harmonics: Option<u32>,
    /// Table of what air cuts have shown.
    pub phase_table: Option<PathBuf>,
    /// Length of the polygon, mm.
    pub length: f64,
    /// Feed along Z, mm per turn of the work.
    pub feed: f64,
    /// Number of the cutter in the tool table; `None` finds one.
    pub tool: Option<u32>,
    /// The tool table; `None` is the built-in one.
    pub tools: Option<PathBuf>,
    /// Inside a bore.
    pub internal: bool,
    /// Cut it on the simulated machine, over the speeds.
    pub simulate: bool,
}

/// What came of it.
pub struct Designed {
    /// What was asked.
    pub design: Design,
    /// Every way that this machine has.
    pub ways: Vec<SolvedMotion>,
    /// Which of them is taken.
    pub best: usize,
    /// A flatness that is aimed at, and the fastest speed with it, if there is one.
    pub aim: Option<(Option<Spin>, Aim)>,
    /// What the block is claimed to cut, or why it cannot be run.
    pub claim: Result<Claim, String>,
    /// What came of it on the machine, over the speeds, if that was asked.
    pub proofs: Vec<Proof>,
}

/// What is told of a design under way.
#[derive(Debug, Clone, Copy)]
pub enum Progress {
    /// So many runs are to come.
    Runs(u64),
    /// One is done.
    Run,
}

/// From the form wanted to the block that cuts it.
///
/// # Errors
/// A number is out of its range, the form cannot be cut so, or this machine has nothing that may
/// swing.
pub fn design(
    options: &PolygonOptions,
    hear: &mut dyn FnMut(Progress),
) -> Result<Designed, Refused> {
    let design = Design::of(options)?;
    let way = |(name, who)| design.solve(name, who, design.work, &design.phases, Detail::Full);
    let ways: Vec<SolvedMotion> = design.candidates().filter_map(way).collect();
    let Some(best) = best(&ways) else {
        return Err(Refused::because(format!(
            "{} has none of the actuators asked: --actuator auto takes what is there",
            design.machine.name
        )));
    };
    let taken = &ways[best];
    let allowed = control::config::tolerances(false).facet_flatness;
    let aim = match design.wanted {
        Some(wanted) => Some(Aim { flatness: wanted, whose: "wanted" }),
        None if taken.solution.flatness > allowed => {
            Some(Aim { flatness: allowed, whose: "all that is allowed of a facet (ISO 2768-2 H)" })
        }
        None => None,
    };
    let aim = aim.map(|aim| (design.fastest(taken, aim.flatness), aim));
    let machine = &options.machine;
    let proofs = if options.simulate { prove::proofs(&design, machine, hear)? } else { Vec::new() };
    let claim = design.claim(&design.gcode(taken), machine, design.work)?;
    Ok(Designed { design, ways, best, aim, claim, proofs })
}

/// The first that is as flat as the flattest, by its place.
fn best(ways: &[SolvedMotion]) -> Option<usize> {
    let flattest = ways.iter().map(|w| w.solution.flatness.value()).fold(f64::INFINITY, f64::min);
    ways.iter().position(|w| w.solution.flatness.value() <= flattest + AS_FLAT.value())
}

impl Design {
    fn of(args: &PolygonOptions) -> Result<Self, Refused> {
        let machine = control::config::machine_file::load(&args.machine)?;
        let mut wrong = Vec::new();
        if args.internal {
            wrong.push(
                "internal polygons cannot be turned so: the tip circle would have to fit into the corner, and a tip that comes from outside never reaches a wall that is behind it; broach them or slot them"
                    .to_owned(),
            );
        }
        let numbers = [
            ("--across-flats", args.across_flats, 0.01, 1000.0),
            ("--tip-radius", args.tip_radius, 0.1, 1000.0),
            ("--speed", args.speed, 1.0, 100_000.0),
            ("--length", args.length, 0.01, 10_000.0),
            ("--feed", args.feed, 0.0001, 10.0),
        ];
        for (name, value, low, high) in numbers {
            if !(low..=high).contains(&value) {
                wrong.push(format!("{name} {value}: expected a number from {low} to {high}"));
            }
        }
        let turns = turns(&args.ratio, &mut wrong);
        let inserts = inserts(args, turns, &mut wrong);
        if !wrong.is_empty() {
            return Err(Refused::because(wrong.join("; ")));
        }
        let stock = args.stock.map_or(machine.setup.stock.to[0], |d| Length::mm(d / 2.0));
        let form = Form {
            inserts,
            turns,
            across_flats: Length::mm(args.across_flats),
            tip_radius: Length::mm(args.tip_radius),
            stock_radius: stock,
        };
        let (tool, to_enter) = called(args, &form)?;
        let design = Self {
            to_enter,
            work: Spin::rpm(args.speed),
            harmonics: args.harmonics.map(|n| n as usize),
            phases: phases(args.phase_table.as_deref(), &machine)?,
            chosen: args.actuator,
            wanted: args.flatness.map(Length::um),
            length: Length::mm(args.length),
            feed_per_rev: Length::mm(args.feed),
            tool,
            machine,
            form,
        };
        design.check()?;
        Ok(design)
    }

    fn check(&self) -> Result<(), Refused> {
        let mut wrong: Vec<String> = match self.form.check() {
            Ok(()) => Vec::new(),
            Err(found) => found.into_iter().map(|r| r.0).collect(),
        };
        if wrong.is_empty() {
            self.check_machine(&mut wrong);
        }
        if wrong.is_empty() { Ok(()) } else { Err(Refused::because(wrong.join("; "))) }
    }

    fn check_machine(&self, wrong: &mut Vec<String>) {
        let name = &self.machine.name;
        let [Some(work), Some(tool)] = [0, 1].map(|i| self.machine.spindles.get(i)) else {
            wrong.push(format!(
                "{name} has {} spindle, polygon turning needs a work spindle and a tool spindle: --machine polygon-lathe has both",
                self.machine.spindles.len()
            ));
            return;
        };
        let ratio = self.form.ratio();
        let most = work.max.value().min(tool.max.value() / ratio);
        if self.work.value() > most {
            wrong.push(format!(
                "{:.0} rpm of the work are {:.0} rpm of the tool; the spindles go to {:.0} and {:.0} rpm: --speed {:.0} works",
                self.work.in_rpm(),
                self.work.in_rpm() * ratio,
                work.max.in_rpm(),
                tool.max.in_rpm(),
                (most * 60.0).floor()
            ));
        }
        let zero = self.machine.setup.g54.along(canon::Axis::X).of_linear();
        wrong.extend(refuse::cutter(&self.machine, &self.form, zero));
    }

    /// Who may swing.
    fn candidates(&self) -> impl Iterator<Item = (&'static str, &'static [Actuator])> {
        CANDIDATES.into_iter().filter(|c| may_swing(self.chosen, c.1))
    }

    /// What these make of it at a speed, with what air cuts have shown.
    pub fn solve(
        &self,
        name: &'static str,
        who: &[Actuator],
        work: Spin,
        phases: &Phases,
        detail: Detail,
    ) -> Option<SolvedMotion> {
        let problem = self.problem(who, work, phases)?;
        // as many harmonics as asked, else as many as it takes
        let solution = match self.harmonics {
            Some(_) => problem.solve()?,
            None => problem.solve_well(detail)?,
        };
        Some(SolvedMotion { name, solution })
    }

    fn problem(&self, who: &[Actuator], work: Spin, phases: &Phases) -> Option<Problem<'_>> {
        let count = self.harmonics.unwrap_or(FINE_HARMONICS);
        let answers: Vec<_> = who
            .iter()
            .map(|a| kept::answers(phases, drives::on(*a), self.form.base(), work, count))
            .collect();
        let harmonics = self.harmonics.unwrap_or(HARMONICS);
        problem(&self.machine, &self.form, work, who, &answers, harmonics)
    }

    /// The fastest that both spindles turn.
    fn fastest_turning(&self) -> Spin {
        let [work, tool] =
            [0, 1].map(|i| self.machine.spindles.get(i).map_or(0.0, |s| s.max.value()));
        Spin::rev_per_s(work.min(tool / self.form.ratio()))
    }

    /// The fastest work spindle at which it is as flat as wanted, if any is.
    fn fastest(&self, way: &SolvedMotion, wanted: Length) -> Option<Spin> {
        let who = CANDIDATES.iter().find(|c| c.0 == way.name)?.1;
        let flat = |rpm: f64, detail| {
            let way = self.solve(way.name, who, Spin::rpm(rpm), &self.phases, detail);
            way.is_some_and(|way| way.solution.flatness <= wanted)
        };
        let high = self.fastest_turning().in_rpm();
        if flat(high, Detail::Full) {
            return Some(Spin::rpm(high));
        }
        // roughly at first, then between there and a little faster
        let about = fastest([SLOWEST_RPM, high], 1.0, |rpm| flat(rpm, Detail::Drawn))?;
        let near = [about, (about * ROUGHLY).min(high)];
        let spin = fastest(near, 1.0, |rpm| flat(rpm, Detail::Full)).unwrap_or(about);
        Some(Spin::rpm(spin.floor()))
    }
}

/// The number of the cutter that a form needs, and what is wrong with the table if that has another
/// one or none.
fn called(args: &PolygonOptions, form: &Form) -> Result<(u32, Option<String>), Refused> {
    /// Lowest number of a cutter that the table lacks.
    const FIRST_FREE: u32 = 21;
    /// Highest one.
    const LAST: u32 = 9999;
    let mm = store::tools::TableUnit::Millimetre;
    let (library, from, ..) = control::job::tools(args.tools.as_deref(), mm, Path::new("-"))?;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let is_it = |tool: &canon::Tool| match &tool.kind {
        canon::ToolKind::PolygonCutter(cutter) => {
            let (has, needs) = (&cutter.inserts, &form.inserts);
            let mut pairs = has.iter().zip(needs);
            near(cutter.radius.value(), form.tip_radius.value())
                && has.len() == needs.len()
                && pairs.all(|(a, b)| near(a.value(), b.value()))
        }
        _ => false,
    };
    let free = || (FIRST_FREE..=LAST).find(|number| library.get(*number).is_none());
    let known = library.iter().find(|tool| is_it(tool)).map(|tool| tool.number);
    let number = args.tool.or(known).or_else(free).unwrap_or(FIRST_FREE);
    Ok(match library.get(number) {
        Some(tool) if is_it(tool) => (number, None),
        Some(_) => (number, Some(format!("T{number} of {from} is another tool: enter this one"))),
        None => (number, Some(format!("T{number} is not in the tool table, {from}: enter it"))),
    })
}

/// What air cuts have shown of this machine, as far as a table says it.
fn phases(path: Option<&Path>, machine: &MachineFile) -> Result<Phases, Refused> {
    let mark = control::job::cams::mark(machine);
    let kept = path.map(|path| Phases::load(path, &machine.name, mark)).transpose()?.flatten();
    Ok(kept.unwrap_or_else(|| Phases::new(&machine.name, mark)))
}

/// Work and tool, as in "1:2".
fn turns(text: &str, wrong: &mut Vec<String>) -> [i32; 2] {
    let parsed = text.split_once(':').and_then(|(work, tool)| {
        Some([tool.trim().parse::<i32>().ok()?, work.trim().parse::<i32>().ok()?])
    });
    let small = parsed.filter(|turns| turns.iter().all(|t| (-1000..=1000).contains(t)));
    small.unwrap_or_else(|| {
        wrong.push(format!(
            "--ratio {text}: expected whole turns of work and tool up to 1000, such as 1:2"
        ));
        [2, 1]
    })
}

/// By their angles, their number, or the sides wanted.
fn inserts(args: &PolygonOptions, [tool, work]: [i32; 2], wrong: &mut Vec<String>) -> Vec<Angle> {
    if !args.insert_angles.is_empty() {
        let angles = &args.insert_angles;
        let rising = angles.windows(2).all(|p| p[0] < p[1]);
        if angles[0] != 0.0 || !rising || angles.iter().any(|a| !(0.0..360.0).contains(a)) {
            wrong.push("--insert-angles: expected rising angles from 0 to below 360, the first of them 0, such as 0,90".to_owned());
        }
        return angles.iter().map(|a| Angle::deg(*a)).collect();
    }
    if let Some(count) = args.inserts {
        return insert_phases(count);
    }
    let sides = args.sides;
    let turns = tool.unsigned_abs().max(1);
    if !sides.is_multiple_of(turns) || sides == 0 {
        let works = (sides / turns + 1) * turns;
        wrong.push(format!(
            "{sides} sides cannot be cut at {work}:{tool}: the tool makes {tool} passes with each insert, so {works} sides work, or --ratio 2:{sides} with one insert"
        ));
    }
    insert_phases((sides / turns).max(1))
}
