//! A program, and what it meets on a machine.
use crate::time::{Added, Estimate, Times, WithoutJerk, estimate};
use crate::{Finished, RunOptions};
use canon::Axis;
use control::Drives;
use control::drives::simulated;
use control::job::choice::{self, Choice};
use control::job::mill_stock::MilledStock;
use control::job::preflight::{self, Preflight, Proved};
use control::job::{Cursor, Operations, ProgramOptions, Session, Source, read_program};
use control::{Loaded, ProgramRun, Refused, config};
use diag::Diagnostic;
use sim::SimulatedMachine;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use store::machine::StockMaterial;

/// The text of a program.
#[derive(Debug, Clone)]
pub struct Program {
    /// Its name, for people.
    pub name: String,
    /// Where it lies: tables and subprograms are looked for beside it.
    pub path: PathBuf,
    /// Its bytes.
    pub text: Vec<u8>,
}

impl Program {
    /// Read a file; `-` is standard input.
    ///
    /// # Errors
    /// It cannot be read, or is larger than a program may be.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Refused> {
        let path = path.as_ref();
        let text = read_program(path)?;
        Ok(Self { name: path.display().to_string(), path: path.to_owned(), text })
    }

    /// A text that lies in no file.
    pub fn of(name: impl Into<String>, text: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), path: "-".into(), text: text.into() }
    }

    /// Bring it to a machine: a name from `leadscrew machine list`, a machine file, or everything
    /// in [`ProgramOptions`].
    ///
    /// # Errors
    /// The machine, the tools, or another file that the options name cannot be read or is wrong.
    pub fn on(self, options: impl Into<ProgramOptions>) -> Result<Job, Refused> {
        let options = options.into();
        let (session, chosen) = if options.chooses {
            let Choice { options, notes, .. } = choice::choose(&options, &self.path, &self.text)?;
            (Session::load(&options, &self.path, &self.text)?, notes)
        } else {
            (Session::load(&options, &self.path, &self.text)?, Vec::new())
        };
        let material = session.machine.setup.stock.material;
        let plan = session.plan_options(material);
        Ok(Job { program: self, session, chosen, material, plan, part: 1, proved: None })
    }
}

/// A program with the machine, the tools and the work that it meets. It is interpreted once: what
/// is found in it, how long it takes and the run share its operations.
pub struct Job {
    /// The program.
    pub program: Program,
    /// Machine, tools, parameters, cams.
    pub session: Session,
    /// How it is read, on which machine and with which tools, and why, where that was chosen by the
    /// program's words.
    pub chosen: Vec<Diagnostic>,
    /// What the workpiece is made of.
    pub material: StockMaterial,
    /// What the planner is told.
    pub plan: plan::Options,
    /// Number of the workpiece on the simulated machine, from 1.
    pub part: u32,
    pub(crate) proved: Option<Proved>,
}

impl Job {
    /// Everything that is wrong with the program, and what is likely to hurt, in the order of its
    /// text.
    pub fn check(&mut self) -> &[Diagnostic] {
        &self.proved(&mut |_| ()).known.findings
    }

    /// How long it takes, by the planner that would run it.
    ///
    /// # Errors
    /// It is refused.
    pub fn time(&mut self) -> Result<Times, Refused> {
        self.prove(&mut |_| ())?;
        let mut free = WithoutJerk::of(&mut self.session, self.plan);
        let mut times = Times::new(&self.session, None);
        let mut planner = preflight::ahead(&self.session, self.plan);
        let mut source = self.cursor();
        while let Some((index, op)) = source.next() {
            let frame = source.frame();
            if let Some(free) = &mut free {
                free.op(index, &op, frame);
            }
            planner.written_in(frame);
            planner.push(index, &op, &mut |step| times.step(&step));
        }
        planner.finish(&mut |step| times.step(&step));
        times.without_jerk = free.map(WithoutJerk::motion);
        Ok(times)
    }

    /// How long it takes, from a sample that is planned: a share `within` of the total is how far
    /// it may be off. `None`: it is too short or too uneven for that, and [`time`](Self::time) is
    /// to be asked. What only planning finds in moves that were not planned is not found.
    ///
    /// # Errors
    /// It is refused.
    pub fn estimate(
        &mut self,
        within: f64,
        look: &mut impl FnMut(&plan::Step),
    ) -> Result<(Option<Estimate>, Preflight), Refused> {
        let Self { program, session, plan, .. } = self;
        let limits = config::planner(&session.machine);
        let mut other = Added::new(limits.clone());
        let mut count = |step: plan::Step| {
            look(&step);
            other.step(&step);
        };
        let (known, sample) =
            preflight::preflight_sampled(session, &program.text, *plan, &mut count);
        if known.is_refused() {
            return Err(self.refused(known.findings));
        }
        Ok((estimate(&sample, other.shares, &limits, within), known))
    }

    /// Run it on the simulated machine, and judge the workpiece.
    ///
    /// # Errors
    /// It is refused; a file that the options name cannot be read or is wrong. An alarm on the
    /// machine and a workpiece out of tolerance are no errors: [`Finished::ending`] says them.
    pub fn run(self, options: &RunOptions) -> Result<Finished, Refused> {
        let mut run = crate::Run::prepare(self, options)?;
        run.prove(&mut |_| ())?;
        run.execute(&mut |_| {})
    }

    /// Interpret and plan it, if that has not been done; a look at every step.
    pub(crate) fn proved(&mut self, look: &mut impl FnMut(plan::Step)) -> &Proved {
        let Self { program, session, plan, proved, .. } = self;
        proved.get_or_insert_with(|| preflight::prove(session, &program.text, *plan, look))
    }

    /// The same; what is wrong with it is a refusal.
    pub(crate) fn prove(&mut self, look: &mut impl FnMut(plan::Step)) -> Result<&Proved, Refused> {
        if self.proved(look).known.is_refused() {
            let findings = self.proved(look).known.findings.clone();
            return Err(self.refused(findings));
        }
        Ok(self.proved(look))
    }

    /// Machine or planning have changed: what is known of the program is known no more.
    pub(crate) fn forget(&mut self) {
        self.proved = None;
    }

    /// The program is refused for this.
    pub fn refused(&self, findings: Vec<Diagnostic>) -> Refused {
        let Self { program, session, .. } = self;
        let drawn = session.drawn.clone();
        Refused::program(program.name.clone(), program.text.clone(), drawn, findings)
    }

    /// Its operations; none before it is checked.
    pub fn operations(&self) -> Arc<Operations> {
        self.proved.as_ref().map(|proved| Arc::clone(&proved.operations)).unwrap_or_default()
    }

    /// The same, from the first on.
    pub(crate) fn cursor(&self) -> Cursor {
        Cursor::new(self.operations(), None)
    }

    /// The machine, simulated, with what its control does not know by this seed.
    pub(crate) fn machine(&self, seed: u64) -> Result<SimulatedMachine, Refused> {
        simulated::build(self.session.plant(), self.simulator(seed))
    }

    /// The numbers of that machine.
    pub(crate) fn simulator(&self, seed: u64) -> sim::Config {
        let zero = self.session.work_zero();
        let (plant, tools) = (self.session.plant(), &self.session.tools);
        let mut simulated =
            config::simulator_of_part(plant, tools, self.material, (seed, self.part), &zero);
        // as the machine that is controlled stands, if it was not switched on just now
        let start = self.session.interp_setup().start;
        for (index, axis) in &mut simulated.axes {
            axis.start = start.along(Axis::ALL[*index]);
        }
        simulated.tool = self.session.tool();
        simulated
    }

    /// What the workpiece is judged by.
    pub(crate) fn judge(&self) -> verify::Config {
        let config = self.session.judge(self.material, &self.session.work_zero());
        let gear_blank = self.stated_block();
        let config = verify::Config { stock: gear_blank.or(config.stock), gear_blank, ..config };
        let Some(proved) = &self.proved else { return config };
        let milled = MilledStock::of(&self.program.text, &self.session, proved.operations.all());
        verify::Config { mill_stock: milled.found(&self.session), ..config }
    }

    /// The block that the program's comments state, machine coordinates.
    pub(crate) fn stated_block(&self) -> Option<verify::Stock> {
        MilledStock::stated_in(&self.program.text, &self.session)
    }

    /// The tools that the judge takes, as they really are on the simulated machine of this seed.
    pub(crate) fn judged_tools(&self, seed: u64) -> canon::ToolLibrary {
        config::judged_tools(self.session.plant(), &self.session.tools, seed, self.part)
    }

    /// Prove it, and make it ready to run on this machine, judged by this. Nothing stops it,
    /// nothing is kept.
    pub(crate) fn start(
        &mut self,
        machine: Box<dyn Drives>,
        judge: verify::Config,
    ) -> Result<ProgramRun, Refused> {
        self.prove(&mut |_| ())?;
        let Self { session, plan, .. } = self;
        let Some(Proved { operations, known }) = &self.proved else {
            return Err(Refused::because("the program was not interpreted"));
        };
        let planned = known.planned;
        let loaded = Loaded { session, operations, restart: None, options: *plan, planned };
        Ok(ProgramRun::new(&loaded, machine, judge))
    }
}
