//! What comes of an oscillation on the machine itself, over the speeds: run with all its physics, once as computed, then
//! with what an air cut has shown of its loops.
//!
//! ```text
//!   speed ─► computed ─► run: cut, retreat, G51.4 in the air ─► flatness as sent
//!                                       └─ answers of the loops ─► computed again ─► run: cut ─► compensated
//! ```
use super::claim::Claim;
use super::{CANDIDATES, Design, Way, best, flattest};
use canon::{PolygonCutter, Tool, ToolKind};
use control::Refused;
use control::config;
use control::job::Session;
use control::job::options::ProgramOptions;
use control::job::preflight::preflight;
use control::plant::{self, Plant};
use control::{Loaded, ProgramRun};
use forms::polygon::Detail;
use std::path::Path;
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
pub(super) struct Proof {
    pub(super) spin: Spin,
    /// Who swings.
    pub(super) name: &'static str,
    /// What the block is claimed to cut.
    pub(super) claim: Claim,
    pub(super) sent: Cut,
    pub(super) compensated: Cut,
    pub(super) binding: Option<String>,
}

/// What was cut.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    pub(super) flatness: Length,
    pub(super) tilt: Angle,
    /// Across flats less what was wanted.
    pub(super) size: Length,
}

/// All speeds that the spindles reach.
pub(super) fn proofs(design: &Design, machine: &str) -> Result<Vec<Proof>, Refused> {
    let most = design.fastest_turning();
    let progress = crate::progress::Progress::new(SPEEDS.len() as u64, "cutting (simulated)");
    let speeds = SPEEDS.into_iter().map(Spin::rpm).filter(|spin| *spin <= most);
    speeds.map(|spin| proof(design, machine, spin)).inspect(|_| progress.inc(1)).collect()
}

fn proof(design: &Design, machine: &str, spin: Spin) -> Result<Proof, Refused> {
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

impl Way {
    pub(super) fn who(&self) -> &'static [forms::polygon::Actuator] {
        CANDIDATES.iter().find(|c| c.0 == self.name).map_or(&[], |c| c.1)
    }
}

impl Design {
    /// The first of the candidates that is as flat as the flattest.
    fn flattest(&self, spin: Spin, phases: &Phases) -> Option<Way> {
        if self.harmonics.is_some() {
            let ways: Vec<Way> = self
                .candidates()
                .filter_map(|(n, who)| self.solve(n, who, spin, phases, Detail::Full))
                .collect();
            let best = best(&ways)?.name;
            return ways.into_iter().find(|way| way.name == best);
        }
        let problems = self
            .candidates()
            .filter_map(|(name, who)| Some((name, self.problem(who, spin, phases)?)));
        flattest(problems).map(|(name, solution)| Way { name, solution })
    }
}

/// Cut a piece on the simulated machine; with `looks`, measure in the air afterwards.
fn run(
    design: &Design,
    machine: &str,
    spin: Spin,
    way: &Way,
    looks: Option<u32>,
) -> Result<(Cut, Phases), Refused> {
    let text = design.program(&way.solution, spin, Length::mm(LENGTH_MM), looks) + "M2\n";
    let mut session = session(design, machine, &text)?;
    let material = session.machine.setup.stock.material;
    let options = session.plan_options(material);
    let known = preflight(&mut session, text.as_bytes(), options);
    if known.is_refused() {
        let name = "the program for this polygon".into();
        return Err(Refused::program(name, text.into(), session.drawn, known.findings));
    }
    let setup = session.interp_setup();
    let zero = session.work_zero();
    let seed = u64::from(session.machine.simulation.seed);
    let iron = config::simulator(&session.machine, &session.tools, material, seed, &zero);
    let iron = plant::simulated(&session.machine, iron)?;
    let judge = config::judge(&session.machine, &session.tools, material, &zero);
    let loaded = Loaded {
        session: &session,
        text: text.as_bytes(),
        setup: &setup,
        options,
        planned: known.planned,
    };
    let run = ProgramRun::new(&loaded, Plant::simulated_with_seed(iron, seed), judge);
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

/// A session for a program that cuts a design with its cutter.
pub(super) fn session(design: &Design, machine: &str, text: &str) -> Result<Session, Refused> {
    let options =
        ProgramOptions { dialect: Some(interp::Dialect::LinuxCnc), ..ProgramOptions::on(machine) };
    let mut session = Session::load(&options, Path::new("-"), text.as_bytes())?;
    session.tools.insert(cutter(design));
    // from the bar that the design is for
    let (stock, radius) = (&mut session.machine.setup.stock, design.form.stock_radius);
    for side in 0..2 {
        (stock.from[side], stock.to[side]) = (-radius, radius);
    }
    Ok(session)
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
        stand_in: false,
    }
}
