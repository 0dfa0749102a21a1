//! Texts are interpreted and judged before anything moves, short ones planned as well, which takes
//! seconds: apart from the control, so that it may be done in another thread while the control goes
//! on. How long a long one takes is planned later (`timing`).
//!
//! ```text
//!   Control::begin ──► Begun::Answered
//!                  └─► Begun::Proving ── prove (anywhere, seconds) ──► Proven ──► Control::complete ──► answer
//! ```
//!
//! A request that is completed is asked for its needs again, and what it was proved for must still
//! be so.
use super::control::Control;
use super::proof::{Basis, Fit, Proof, ProofMark};
use super::request::{Accepted, Refusal, Request};
use super::timeline::Noting;
use super::under_way::Loaded;
use crate::job::preflight;
use crate::job::{Before, Interruption, ProgramOptions, Session, read_program};
use crate::{Refused, config};
use std::path::{Path, PathBuf};

/// How a request has begun.
pub enum Begun {
    /// It is answered.
    Answered(Result<Accepted, Refusal>),
    /// A text is to be proved first.
    Proving(Box<Proving>),
}

/// A text that is to be interpreted and planned, and what for.
pub struct Proving {
    request: Request,
    options: ProgramOptions,
    pub(super) path: PathBuf,
    pub(super) name: String,
    /// `None`: it is read when it is proved.
    pub(super) text: Option<Vec<u8>>,
    before: Before,
    basis: Basis,
    /// A tool change is led on.
    resume: Option<canon::Resume>,
    interruption: Interruption,
    /// A program of up to so many operations is planned, a longer one is judged alone.
    planned_up_to: usize,
}

/// Planned while people wait: three seconds at most, where all of them are arcs under a limit of
/// jerk.
const PLANNED_AT_ONCE: usize = 1000;

/// What a program would meet that is read now: an editor shows what it makes of one that is
/// written.
pub struct Found {
    basis: Basis,
    before: Before,
    /// The axes are where they say, and nothing is under way that moves them.
    stands: bool,
}

impl Found {
    /// In a session that was loaded from files.
    pub fn put_into(self, session: &mut Session) {
        let Self { basis, before, stands } = self;
        let Basis { position, mounted, magazine, parameters, tools, stock, .. } = basis;
        session.changer = magazine.map(|magazine| (magazine, None));
        session.finds_clamped(stock);
        if stands {
            session.on_control((position, mounted), parameters, tools, before);
        } else {
            (session.parameters, session.tools) = (parameters, tools);
        }
    }
}

/// A text that was interpreted and planned: fit to be executed, or refused.
pub struct Proven {
    request: Request,
    path: PathBuf,
    basis: Basis,
    result: Result<Fit, Refusal>,
}

impl Proving {
    /// Which text is proved, and for what.
    pub fn mark(&self) -> ProofMark {
        ProofMark { path: self.path.clone(), basis: self.basis.clone() }
    }

    /// The program's name; `MDI` of what was typed.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// It is not wanted any more when this says so.
    #[must_use]
    pub fn unless(self, interruption: Interruption) -> Self {
        Self { interruption, ..self }
    }

    /// It is planned as well, however long it is.
    #[must_use]
    pub fn planned(self) -> Self {
        Self { planned_up_to: usize::MAX, ..self }
    }

    /// Interpret and judge it, and plan it if it is short or that was asked for.
    pub fn prove(self) -> Proven {
        let Self { request, options, path, name, text, before, basis, .. } = self;
        let (interruption, resume) = (self.interruption, self.resume);
        let most = self.planned_up_to;
        let of = path.clone();
        let proved = (|| {
            if interruption.came() {
                return Err(Refusal::because("it was broken off before it was read"));
            }
            // here, and not where it was asked for: a control waits for no disk
            let text = text.map_or_else(|| read_program(&path), Ok)?;
            let mut session = Session::load(&options, &path, &text)?;
            let Basis { position, mounted, magazine, parameters, tools, stock, .. } = basis.clone();
            session.finds_clamped(stock);
            session.on_control((position, mounted), parameters, tools, before);
            session.changer = magazine.map(|magazine| (magazine, resume));
            session.interruption = interruption;
            let plan = session.plan_options(session.machine.setup.stock.material);
            let limits = config::planner(&session.machine);
            let mut noting = Noting::new(limits);
            let proved = preflight::prove_up_to(&mut session, (&text, most), plan, &mut |step| {
                noting.step(&step);
            });
            if proved.known.is_refused() {
                let (drawn, findings) = (session.drawn.clone(), proved.known.findings);
                return Err(Refused::program(name.clone(), text.clone(), drawn, findings).into());
            }
            let timeline = proved.known.planned.map(|_| noting.timeline);
            Ok((session, text, proved, timeline))
        })();
        let result = proved.map(|(session, text, proved, timeline)| Fit {
            path,
            name,
            text,
            session,
            proved,
            timeline,
        });
        Proven { request, path: of, basis, result }
    }
}

impl Control {
    /// Ask for something; what takes long is left to be proved, and then to be completed. Until
    /// then nothing has changed.
    pub fn begin(&mut self, request: &Request) -> Begun {
        if let Err(why) = self.admits(request) {
            return Begun::Answered(Err(why));
        }
        if let Some(fit) = self.proved_already(request) {
            return Begun::Answered(self.execute_fit(request, fit));
        }
        match self.proving(request) {
            Ok(Some(proving)) => Begun::Proving(Box::new(proving)),
            Ok(None) => Begun::Answered(self.request(request)),
            Err(why) => Begun::Answered(Err(why)),
        }
    }

    /// What was asked for, with the text proved.
    ///
    /// # Errors
    /// The text is refused, a need is no longer met, or what it was proved for is no longer so.
    pub fn complete(&mut self, proven: Proven) -> Result<Accepted, Refusal> {
        let Proven { request, basis, result, .. } = proven;
        for need in request.needs() {
            self.meets(need).map_err(Refusal::State)?;
        }
        let fit = result?;
        // one that is loaded need not be begun from here
        if matches!(request, Request::Load(_) | Request::LoadAs(..)) {
            return self.load(fit, basis);
        }
        if basis != self.basis() {
            return Err(Refusal::because(
                "offsets, tools or positions have changed while it was read: ask again",
            ));
        }
        self.execute_fit(&request, fit)
    }

    /// The text of a request that has one.
    pub(super) fn proving(&self, request: &Request) -> Result<Option<Proving>, Refusal> {
        let mut options = self.options.program.clone();
        let mut resume = None;
        let (path, name, text) = match request {
            Request::Sequence(order) => {
                let (text, led_on) = self.resumed(*order)?;
                resume = Some(led_on);
                (Path::new("-").to_owned(), "sequence".into(), Some(text.into_bytes()))
            }
            Request::Load(path) => (path.clone(), path.display().to_string(), None),
            Request::LoadAs(path, dialect) => {
                options.dialect = Some(*dialect);
                (path.clone(), path.display().to_string(), None)
            }
            Request::Search(..) | Request::Start => {
                let Some(loaded) = &self.loaded else { return Ok(None) };
                options.dialect = Some(loaded.dialect);
                (loaded.path.clone(), loaded.name.clone(), Some(loaded.shown.text.clone()))
            }
            Request::ManualDataInput(text) => {
                (Path::new("-").to_owned(), "MDI".into(), Some(text.as_bytes().to_vec()))
            }
            _ => return Ok(None),
        };
        let is_typed = matches!(request, Request::ManualDataInput(_) | Request::Sequence(_));
        Ok(Some(Proving {
            request: request.clone(),
            options,
            path,
            name,
            text,
            before: self.before(is_typed),
            basis: self.basis(),
            resume,
            interruption: Interruption::default(),
            planned_up_to: PLANNED_AT_ONCE,
        }))
    }

    /// The program that is loaded, if a request needs it and it is proved for what is so now.
    fn proved_already(&mut self, request: &Request) -> Option<Fit> {
        if !matches!(request, Request::Search(..) | Request::Start) {
            return None;
        }
        let basis = self.basis();
        self.loaded.as_mut()?.proof.take()?.fit_on(&basis)
    }

    /// The program that is loaded, where it is not proved for what is so now: proved while nothing
    /// else is to be done, it begins to move at once when it is started.
    pub fn renewal(&self) -> Option<Proving> {
        let loaded = self.loaded.as_ref()?;
        // where it could not be started, as with the drives off, positions follow the encoders
        let could_start = Request::Start.needs().iter().all(|need| self.meets(need).is_ok());
        let is_proved = || loaded.proof.as_ref().is_some_and(|proof| proof.is_on(&self.basis()));
        if loaded.reads_files || !could_start || !self.is_at_standstill() || is_proved() {
            return None;
        }
        self.proving(&Request::Start).ok().flatten()
    }

    /// What came of a renewal is kept, as long as the same program is loaded.
    pub fn renew(&mut self, proven: Proven) {
        let Proven { path, basis, result, .. } = proven;
        let fit = result.ok();
        let is_of = |loaded: &&mut Loaded| {
            let is_text = |fit: &Fit| fit.text == loaded.shown.text;
            loaded.path == path && fit.as_ref().is_none_or(is_text)
        };
        if let Some(loaded) = self.loaded.as_mut().filter(is_of) {
            if let Some(planned) = fit.as_ref().and_then(|fit| fit.proved.known.planned) {
                loaded.planned = Some(planned);
            }
            loaded.proof = Some(Proof::of(basis, fit));
        }
    }

    /// What a program would meet that is read now.
    pub fn found(&self) -> Found {
        let before = self.before(false);
        let stands = self.is_homed_all() && self.under_way.is_none();
        Found { basis: self.basis(), before, stands }
    }

    /// What a text finds in force that begins now.
    fn before(&self, is_typed: bool) -> Before {
        let kernel = &self.executor.kernel;
        let share = kernel.operator().spindle_share();
        let turning = std::array::from_fn(|spindle| kernel.ordered_spin(spindle) / share);
        Before { rest: self.data.rest.clone(), is_typed, turning }
    }

    pub(super) fn basis(&self) -> Basis {
        Basis {
            position: self.position(),
            mounted: self.mounted(),
            magazine: self.planned_magazine(),
            parameters: self.data.parameters.clone(),
            tools: self.data.tools.clone(),
            rest_number: self.data.rest_number,
            block_skip: self.options.program.block_skip.clone(),
            stock: self.stock_of_next(),
        }
    }
}
