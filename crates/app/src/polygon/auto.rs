//! What the control fills in of G51.2: with D the oscillation for the cut that follows, on this machine; with E1 what is
//! sent of it, by what was measured before.
use super::{CANDIDATES, FINE_HARMONICS, HARMONICS, drives, flattest, kept, problem, refuse};
use canon::{
    Axis, Harmonic, OpKind, Oscillating, Oscillation, Polygon, SpindleOrder, ToolKind, ToolLibrary,
};
use diag::{Diagnostic, Span};
use forms::polygon::{Actuator, Form, Series, Solution};
use std::cell::RefCell;
use store::machine::MachineFile;
use store::phases::Phases;
use units::{Length, Spin};

/// An offset of the facets that X need not be moved for, mm.
const NOT_WORTH_MM: f64 = 2e-4;

/// What was asked before, and what came of it: a program is planned before it runs, and asks the same twice.
#[derive(Default)]
pub(crate) struct Answers(RefCell<Vec<(Asked, Result<Solution, Refusal>)>>);

/// All that an oscillation depends on beside the machine and what was measured of it.
#[derive(Clone, PartialEq)]
struct Asked {
    form: Form,
    work: Spin,
    who: Option<canon::Actuator>,
    compensated: bool,
}

/// Follows the program as far as an oscillation depends on it.
pub(crate) struct Auto<'a> {
    machine: &'a MachineFile,
    tools: &'a ToolLibrary,
    phases: &'a Phases,
    answers: &'a Answers,
    /// Machine X of the work's axis.
    axis: Length,
    tool: u32,
    work: Spin,
    findings: Vec<Diagnostic>,
}

impl<'a> Auto<'a> {
    /// At a program's beginning.
    pub(crate) const fn new(
        machine: &'a MachineFile,
        tools: &'a ToolLibrary,
        phases: &'a Phases,
        answers: &'a Answers,
        axis: Length,
    ) -> Self {
        let work = Spin::ZERO;
        Self { machine, tools, phases, answers, axis, tool: 0, work, findings: Vec::new() }
    }

    /// What was found.
    pub(crate) fn findings(&self) -> &[Diagnostic] {
        &self.findings
    }

    /// An operation.
    pub(crate) fn see(&mut self, kind: &OpKind) {
        match kind {
            OpKind::ChangeTool { number } => self.tool = *number,
            OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(spin) } => self.work = *spin,
            OpKind::Spindle { spindle: 0, order: SpindleOrder::Stop } => self.work = Spin::ZERO,
            _ => {} // nothing else changes what an oscillation depends on
        }
    }

    /// Fill in what swings; where that is impossible, say why.
    pub(crate) fn fill(&mut self, polygon: &mut Polygon, cut: Option<[Length; 2]>, span: Span) {
        if polygon.auto.is_some() {
            match self.solve(polygon, cut) {
                Ok(solution) => {
                    polygon.oscillations = oscillations(&solution, settled(polygon).master);
                }
                Err((code, text)) => {
                    return self.findings.push(Diagnostic::error(code, span, text));
                }
            }
        } else if polygon.compensated {
            self.compensate(polygon, span);
        }
        let Some(cut) = cut else { return };
        let form = self.form(polygon, cut[0]);
        let wrong = refuse::wrong(self.machine, polygon, form.as_ref(), self.work, cut);
        let finding = |text| Diagnostic::error("A0403", span, text);
        self.findings.extend(wrong.into_iter().map(finding));
    }

    /// The form that the cutter in the spindle cuts there; `None`: it is no polygon cutter.
    fn form(&self, polygon: &Polygon, cut: Length) -> Option<Form> {
        let ToolKind::PolygonCutter(cutter) = &self.tools.get(self.tool)?.kind else { return None };
        Some(Form {
            inserts: cutter.inserts.clone(),
            turns: [settled(polygon).follower, settled(polygon).master],
            across_flats: (cut - self.axis - cutter.radius) * 2.0,
            tip_radius: cutter.radius,
            stock_radius: self.machine.setup.stock.to[0],
        })
    }

    /// What is sent instead of what was ordered.
    fn compensate(&mut self, polygon: &mut Polygon, span: Span) {
        let turns = polygon.period();
        for oscillation in &mut polygon.oscillations {
            if let Some(sent) = kept::sent(self.phases, oscillation, self.work, turns) {
                oscillation.harmonics = sent;
                continue;
            }
            let text = format!(
                "E1 sends what swings as it was measured, but the oscillation of {} has not been measured up to its frequency at S{:.0}",
                kept::name(oscillation.on),
                self.work.in_rpm()
            );
            let help = "measure it in the air: G51.4 P6 after G51.2, with --phase-table FILE, at this speed or a faster one";
            self.findings.push(Diagnostic::error("A0402", span, text).with_help(help));
        }
    }

    fn solve(&self, polygon: &Polygon, cut: Option<[Length; 2]>) -> Result<Solution, Refusal> {
        let is_cutter = self
            .tools
            .get(self.tool)
            .is_some_and(|tool| matches!(tool.kind, ToolKind::PolygonCutter(_)));
        if !is_cutter {
            return refused("D lets the control compute the oscillation, but no polygon cutter is in the spindle: call one with T and M6 before G51.2".to_owned());
        }
        let Some(form) = cut.and_then(|cut| self.form(polygon, cut[0])) else {
            return refused("D lets the control compute the oscillation, but no cut follows that says the distance of the axes: write the G1 after G51.2, or G51.3 instead of D".to_owned());
        };
        form.check().map_err(|all| {
            ("A0401", all.into_iter().map(|refusal| refusal.0).collect::<Vec<_>>().join("; "))
        })?;
        let who = polygon.auto;
        let asked = Asked { form, work: self.work, who, compensated: polygon.compensated };
        let known = self.answers.0.borrow().iter().find(|a| a.0 == asked).map(|a| a.1.clone());
        known.unwrap_or_else(|| {
            let answer = self.optimum(&asked);
            self.answers.0.borrow_mut().push((asked, answer.clone()));
            answer
        })
    }

    fn optimum(&self, asked: &Asked) -> Result<Solution, Refusal> {
        let Asked { form, work, who, compensated } = asked;
        let base = form.base();
        let mut unmeasured = false;
        let problems = CANDIDATES.into_iter().filter(|c| may(*who, c.1)).filter_map(|(_, who)| {
            let answers: Vec<_> = if *compensated {
                let answers = |a: &Actuator| {
                    kept::answers(self.phases, drives::on(*a), base, *work, FINE_HARMONICS)
                };
                who.iter().map(answers).collect()
            } else {
                vec![Vec::new(); who.len()]
            };
            if *compensated && answers.iter().any(Vec::is_empty) {
                unmeasured = true;
                return None;
            }
            Some(((), problem(self.machine, form, *work, who, &answers, HARMONICS)?))
        });
        let best = flattest(problems).map(|((), solution)| solution);
        if best.is_none() && unmeasured {
            return Err((
                "A0402",
                format!(
                    "E1 takes account of what an air cut has shown of what swings, and nothing of that has been measured up to {:.0} Hz, the frequency at S{:.0}: measure it with G51.4 P6 after G51.2 D0, and --phase-table FILE",
                    base * work.abs().value(),
                    work.in_rpm()
                ),
            ));
        }
        best.ok_or_else(|| {
            ("A0401", "the machine lacks what D asks to swing: D0 takes what is there".to_owned())
        })
    }
}

/// A code and a sentence.
type Refusal = (&'static str, String);

/// The gear about which it winds, if it winds.
fn settled(polygon: &Polygon) -> canon::Ratio {
    polygon.ratio.settled().unwrap_or(polygon.ratio)
}

const fn refused<T>(text: String) -> Result<T, Refusal> {
    Err(("A0401", text))
}

fn may(asked: Option<canon::Actuator>, who: &[Actuator]) -> bool {
    match asked {
        None => false,
        Some(canon::Actuator::Any) => true,
        Some(canon::Actuator::CentreLine) => who == [Actuator::CentreLine],
        Some(canon::Actuator::Across) => who == [Actuator::Across],
        Some(canon::Actuator::Both) => who.len() == 2,
        Some(canon::Actuator::ToolPhase) => who == [Actuator::ToolPhase],
    }
}

/// What swings, with X so much nearer as the swing leaves the facets farther out.
fn oscillations(solution: &Solution, turns: i32) -> Vec<Oscillation> {
    let of = |series| oscillation(series, f64::from(turns));
    let mut all: Vec<Oscillation> = solution.command.0.iter().map(of).collect();
    let nearer = Harmonic { per_turn: 0, cosine: -solution.offset.value(), sine: 0.0 };
    let on = Oscillating::Axis(Axis::X);
    match all.iter_mut().find(|o| o.on == on) {
        Some(x) => x.harmonics.push(nearer),
        None if nearer.cosine.abs() > NOT_WORTH_MM => {
            all.push(Oscillation { on, harmonics: vec![nearer] });
        }
        None => {}
    }
    all
}

fn oscillation(series: &Series, turns: f64) -> Oscillation {
    Oscillation {
        on: match series.actuator {
            Actuator::CentreLine => Oscillating::Axis(Axis::X),
            Actuator::Across => Oscillating::Axis(Axis::Y),
            Actuator::ToolPhase => Oscillating::ToolPhase,
        },
        harmonics: series
            .terms
            .iter()
            .map(|t| Harmonic {
                per_turn: (t.per_turn * turns).round() as u32,
                cosine: t.cosine,
                sine: t.sine,
            })
            .collect(),
    }
}
