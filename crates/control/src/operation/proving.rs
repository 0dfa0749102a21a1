//! Texts are interpreted and planned before anything moves, which takes long for long ones: apart
//! from the control, so that it may be done in another thread while the control goes on.
//!
//! ```text
//!   Control::begin ──► Begun::Answered
//!                  └─► Begun::Proving ── prove (anywhere, seconds) ──► Proven ──► Control::complete ──► answer
//! ```
//!
//! A request that is completed is asked for its needs again, and what it was proved for must still
//! be so.
use super::control::Control;
use super::request::{Accepted, Refusal, Request};
use super::timeline::Timeline;
use crate::job::preflight::{self, Proved};
use crate::job::{Before, ProgramOptions, Session, read_program};
use crate::{Refused, config};
use canon::{Position, ToolLibrary};
use interp::Parameters;
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
    pub(super) text: Vec<u8>,
    before: Before,
    basis: Basis,
}

/// What a text is proved for.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    position: Position,
    mounted: u32,
    parameters: Parameters,
    tools: ToolLibrary,
}

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
        let Self { basis: Basis { position, mounted, parameters, tools }, before, stands } = self;
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
    basis: Basis,
    result: Result<Fit, Refusal>,
}

/// A text that may be executed.
pub(super) struct Fit {
    pub(super) path: PathBuf,
    pub(super) name: String,
    pub(super) text: Vec<u8>,
    pub(super) session: Session,
    pub(super) proved: Proved,
    pub(super) timeline: Timeline,
}

impl Proving {
    /// Interpret and plan it.
    pub fn prove(self) -> Proven {
        let Self { request, options, path, name, text, before, basis } = self;
        let proved = (|| {
            let mut session = Session::load(&options, &path, &text)?;
            let Basis { position, mounted, parameters, tools } = basis.clone();
            session.on_control((position, mounted), parameters, tools, before);
            let plan = session.plan_options(session.machine.setup.stock.material);
            let limits = config::planner(&session.machine);
            let (mut clock, mut timeline) = (plan::Clock::default(), Timeline::default());
            let proved = preflight::prove(&mut session, &text, plan, &mut |step| {
                clock.count(&step, &limits);
                timeline.note(step.op, clock.elapsed());
            });
            if proved.known.is_refused() {
                let (drawn, findings) = (session.drawn.clone(), proved.known.findings);
                return Err(Refused::program(name.clone(), text.clone(), drawn, findings).into());
            }
            Ok((session, proved, timeline))
        })();
        let result = proved.map(|(session, proved, timeline)| Fit {
            path,
            name,
            text,
            session,
            proved,
            timeline,
        });
        Proven { request, basis, result }
    }
}

impl Control {
    /// Ask for something; what takes long is left to be proved, and then to be completed. Until
    /// then nothing has changed.
    pub fn begin(&mut self, request: &Request) -> Begun {
        for need in request.needs() {
            if let Err(need) = self.meets(need) {
                return Begun::Answered(Err(Refusal::State(need)));
            }
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
        let Proven { request, basis, result } = proven;
        for need in request.needs() {
            self.meets(need).map_err(Refusal::State)?;
        }
        let fit = result?;
        // a program that is loaded is proved again when it is started
        if !matches!(request, Request::Load(_)) && basis != self.basis() {
            return Err(Refusal::because(
                "offsets, tools or positions have changed while it was read: ask again",
            ));
        }
        self.execute_fit(&request, fit)
    }

    /// The text of a request that has one.
    pub(super) fn proving(&self, request: &Request) -> Result<Option<Proving>, Refusal> {
        let (path, name, text) = match request {
            Request::Load(path) => (path.clone(), path.display().to_string(), read_program(path)?),
            Request::Search(_) | Request::Start => {
                let Some(loaded) = &self.loaded else { return Ok(None) };
                (loaded.path.clone(), loaded.name.clone(), loaded.text.clone())
            }
            Request::ManualDataInput(text) => {
                (Path::new("-").to_owned(), "MDI".into(), text.as_bytes().to_vec())
            }
            _ => return Ok(None),
        };
        let is_typed = matches!(request, Request::ManualDataInput(_));
        Ok(Some(Proving {
            request: request.clone(),
            options: self.options.program.clone(),
            path,
            name,
            text,
            before: Before { rest: self.data.rest.clone(), is_typed },
            basis: self.basis(),
        }))
    }

    /// What a program would meet that is read now.
    pub fn found(&self) -> Found {
        let before = Before { rest: self.data.rest.clone(), is_typed: false };
        let stands = self.is_homed_all() && self.under_way.is_none();
        Found { basis: self.basis(), before, stands }
    }

    fn basis(&self) -> Basis {
        Basis {
            position: self.position(),
            mounted: self.mounted(),
            parameters: self.data.parameters.clone(),
            tools: self.data.tools.clone(),
        }
    }
}
