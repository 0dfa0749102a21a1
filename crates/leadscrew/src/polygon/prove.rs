//! What comes of an oscillation on the machine itself, over the speeds: run with all its physics,
//! once as computed, then with what an air cut has shown of its loops.
//!
//! ```text
//!   speed ─► computed ─► run: cut, retreat, G51.4 in the air ─► flatness as sent
//!                                       └─ answers of the loops ─► computed again ─► run: cut ─► compensated
//! ```
use super::claim::Claim;
use super::{CANDIDATES, Design, Progress, SolvedMotion, best, flattest};
use crate::{Job, Program};
use canon::{PolygonCutter, Tool, ToolKind};
use control::Refused;
use control::config::machine_file::MachineSource;
use control::drives::simulated;
use control::job::ProgramOptions;
use forms::polygon::Detail;
use store::phases::Phases;
use units::{Angle, Length, Spin};
use verify::FeatureKind;

/// Speeds that are run, rev/min.
const SPEEDS: [f64; 10] = [100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0];
/// How long a piece is cut, mm.
const LENGTH_MM: f64 = 2.0;
/// Looks at the oscillation in the air.
const LOOKS: u32 = 2;
/// Nose radius of the inserts, mm.
const NOSE_MM: f64 = 0.8;
/// Length of the cutter from the spindle's gauge line, mm.
const CUTTER_MM: f64 = 60.0;

/// One speed, run.
pub struct Proof {
    /// Speed of the work.
    pub spin: Spin,
    /// Who swings.
    pub name: &'static str,
    /// What the block is claimed to cut.
    pub claim: Claim,
    /// What was cut as computed.
    pub sent: Cut,
    /// What was cut with what an air cut has shown.
    pub compensated: Cut,
    /// The limit that binds.
    pub binding: Option<String>,
}

/// What was cut.
#[derive(Clone, Copy)]
pub struct Cut {
    /// Of the least flat facet.
    pub flatness: Length,
    /// Of all facets.
    pub tilt: Angle,
    /// Across flats less what was wanted.
    pub size: Length,
}

/// All speeds that the spindles reach.
pub(super) fn proofs(
    design: &Design,
    machine: &MachineSource,
    hear: &mut dyn FnMut(Progress),
) -> Result<Vec<Proof>, Refused> {
    let most = design.fastest_turning();
    hear(Progress::Runs(SPEEDS.len() as u64));
    let speeds = SPEEDS.into_iter().map(Spin::rpm).filter(|spin| *spin <= most);
    speeds.map(|spin| proof(design, machine, spin)).inspect(|_| hear(Progress::Run)).collect()
}

fn proof(design: &Design, machine: &MachineSource, spin: Spin) -> Result<Proof, Refused> {
    let none = Phases::new("", 0);
    let Some(way) = design.flattest(spin, &none) else {
        return Err(Refused::because(format!("nothing can swing at {:.0} rpm", spin.in_rpm())));
    };
    let block = design.program(&way.solution, spin, Length::mm(LENGTH_MM), None);
    let claim = design.claim(&block, machine, spin)?.map_err(|why| {
        Refused::because(format!("the block for {:.0} rpm cannot be run: {why}", spin.in_rpm()))
    })?;
    let (sent, measured) = run(design, machine, spin, &way, Some(LOOKS))?;
    let again = design.solve(way.name, way.who(), spin, &measured, Detail::Full);
    let (compensated, _) = run(design, machine, spin, again.as_ref().unwrap_or(&way), None)?;
    // who measures keeps what cuts flatter
    let compensated = if compensated.flatness < sent.flatness { compensated } else { sent };
    Ok(Proof { spin, name: way.name, claim, sent, compensated, binding: way.solution.binding })
}

impl SolvedMotion {
    /// The actuators that swing.
    pub fn who(&self) -> &'static [forms::polygon::Actuator] {
        CANDIDATES.iter().find(|c| c.0 == self.name).map_or(&[], |c| c.1)
    }
}

impl Design {
    /// The first of the candidates that is as flat as the flattest.
    fn flattest(&self, spin: Spin, phases: &Phases) -> Option<SolvedMotion> {
        if self.harmonics.is_some() {
            let ways: Vec<SolvedMotion> = self
                .candidates()
                .filter_map(|(n, who)| self.solve(n, who, spin, phases, Detail::Full))
                .collect();
            let best = best(&ways)?;
            return ways.into_iter().nth(best);
        }
        let problems = self
            .candidates()
            .filter_map(|(name, who)| Some((name, self.problem(who, spin, phases)?)));
        flattest(problems).map(|(name, solution)| SolvedMotion { name, solution })
    }
}

/// Cut a piece on the simulated machine; with `looks`, measure in the air afterwards.
fn run(
    design: &Design,
    machine: &MachineSource,
    spin: Spin,
    way: &SolvedMotion,
    looks: Option<u32>,
) -> Result<(Cut, Phases), Refused> {
    let text = design.program(&way.solution, spin, Length::mm(LENGTH_MM), looks) + "M2\n";
    let mut job = job(design, machine, text)?;
    let seed = u64::from(job.session.machine.simulation.seed);
    let plant = simulated::drives(job.machine(seed)?, seed);
    let judge = job.judge();
    let run = job.start(plant, judge)?;
    let outcome = run.run(&mut |_| {})?;
    if let Some(fault) = outcome.faults.first() {
        return Err(Refused::because(format!("at {:.0} rpm: {fault}", spin.in_rpm())));
    }
    let cut = outcome.features.iter().find_map(|feature| match &feature.kind {
        FeatureKind::Polygon(cut) if !cut.sections.is_empty() => Some(Cut {
            flatness: cut.flatness,
            tilt: cut.tilt,
            size: cut.across_flats - design.form.across_flats,
        }),
        _ => None,
    });
    let phases = outcome.cams.phases().clone();
    cut.map(|cut| (cut, phases)).ok_or_else(|| {
        Refused::because(format!("at {:.0} rpm not every facet was cut", spin.in_rpm()))
    })
}

/// A program that cuts a design, with its cutter.
pub(super) fn job(design: &Design, machine: &MachineSource, text: String) -> Result<Job, Refused> {
    let options =
        ProgramOptions { dialect: Some(interp::Dialect::LinuxCnc), ..ProgramOptions::on(machine) };
    let mut job = Program::of("the program for this polygon", text).on(options)?;
    job.session.tools.insert(cutter(design));
    // from the bar that the design is for
    let (stock, radius) = (&mut job.session.machine.setup.stock, design.form.stock_radius);
    for side in 0..2 {
        (stock.from[side], stock.to[side]) = (-radius, radius);
    }
    Ok(job)
}

/// The cutter of the design under its number, whatever the table has there.
fn cutter(design: &Design) -> Tool {
    Tool {
        number: design.tool,
        pocket: 0,
        length: Length::mm(CUTTER_MM),
        diameter: design.form.tip_radius * 2.0,
        kind: ToolKind::PolygonCutter(PolygonCutter {
            radius: design.form.tip_radius,
            inserts: design.form.inserts.clone(),
            nose_radius: Length::mm(NOSE_MM),
        }),
        description: "the design's cutter".into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}
