//! What the control fills in of G51.2: with D the oscillation for the cut that follows, on this
//! machine; with E1 what is sent of it, by what was measured before.
use super::cuts::PolygonDepths;
use super::{
    CANDIDATES, FINE_HARMONICS, HARMONICS, SLOWEST_RPM, drives, fastest, flattest, kept, may_swing,
    problem, refuse,
};
use crate::config::tolerances;
use canon::{
    Axis, Harmonic, OpKind, Oscillating, Oscillation, Polygon, SpindleOrder, ToolKind, ToolLibrary,
};
use diag::{Diagnostic, Span};
use forms::polygon::{Actuator, Detail, Form, Problem, Series, Solution, Swings};
use store::machine::MachineFile;
use store::phases::Phases;
use units::{Length, Spin};

/// Where X does not swing, it need not be moved by less than this for the size, mm.
pub const NOT_WORTH_MM: f64 = 2e-4;
/// Share of the flatness allowed that the swing may take; the machine takes the rest.
const LEFT_TO_THE_CUT: f64 = 0.85;
/// How near to the fastest speed that works the one is that is said, as a share of the one ordered.
const NEAR_SHARE: f64 = 0.005;

/// All that an oscillation depends on beside the machine and what was measured of it.
#[derive(Clone, PartialEq)]
struct Asked {
    form: Form,
    work: Spin,
    who: Option<canon::Actuator>,
    compensated: bool,
}

/// Follows the program as far as an oscillation depends on it.
pub struct Auto<'a> {
    machine: &'a MachineFile,
    tools: &'a ToolLibrary,
    phases: &'a Phases,
    /// What was asked before, and what came of it: a bar of many pieces asks the same for each.
    answers: Vec<(Asked, Result<Solution, NotFlat>)>,
    /// Machine X of the work's axis.
    axis: Length,
    tool: u32,
    work: Spin,
    findings: Vec<Diagnostic>,
}

impl<'a> Auto<'a> {
    /// At a program's beginning.
    pub const fn new(
        machine: &'a MachineFile,
        tools: &'a ToolLibrary,
        phases: &'a Phases,
        axis: Length,
    ) -> Self {
        let work = Spin::ZERO;
        Self {
            machine,
            tools,
            phases,
            answers: Vec::new(),
            axis,
            tool: 0,
            work,
            findings: Vec::new(),
        }
    }

    /// What was found.
    pub fn findings(&self) -> &[Diagnostic] {
        &self.findings
    }

    /// An operation.
    pub fn see(&mut self, kind: &OpKind) {
        match kind {
            OpKind::ChangeTool { number } => self.tool = *number,
            OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(spin) } => self.work = *spin,
            OpKind::Spindle { spindle: 0, order: SpindleOrder::Stop } => self.work = Spin::ZERO,
            _ => {} // nothing else changes what an oscillation depends on
        }
    }

    /// Fill in what swings; where that is impossible, say why.
    pub fn fill(&mut self, polygon: &mut Polygon, cut: Option<PolygonDepths>, span: Span) {
        let finished = cut.and_then(|cut| self.form(polygon, cut.finished));
        let wrong =
            finished.map_or_else(Vec::new, |form| refuse::form(self.machine, &form, self.axis));
        let is_refused = !wrong.is_empty();
        let finding = |text| Diagnostic::error("A0403", span, text);
        self.findings.extend(wrong.into_iter().map(finding));
        if is_refused {
            return;
        }
        if let Err(text) = self.scale(polygon, cut) {
            return self.findings.push(finding(text));
        }
        if polygon.auto.is_some() {
            match self.solve(polygon, cut) {
                Ok(solution) => {
                    let turns = settled(polygon).master;
                    polygon.oscillations = oscillations(&solution.command, turns);
                    polygon.wanted = oscillations(&solution.actual, turns);
                }
                Err((code, text)) => {
                    return self.findings.push(Diagnostic::error(code, span, text));
                }
            }
        } else if polygon.compensated {
            self.compensate(polygon, span);
        }
        let Some(cut) = cut else { return };
        let wrong = refuse::swings(self.machine, polygon, self.work, cut.at);
        self.findings.extend(wrong.into_iter().map(finding));
    }

    /// The form that the cutter in the spindle cuts with the axes at this machine X; `None`: it is
    /// no polygon cutter.
    fn form(&self, polygon: &Polygon, x: Length) -> Option<Form> {
        let ToolKind::PolygonCutter(cutter) = &self.tools.get(self.tool)?.kind else { return None };
        Some(Form {
            inserts: cutter.inserts.clone(),
            turns: [settled(polygon).follower, settled(polygon).master],
            across_flats: (x - self.axis - cutter.radius) * 2.0,
            tip_radius: cutter.radius,
            stock_radius: self.machine.setup.stock.to[0],
        })
    }

    /// What is written as a share of the distance of the axes, at the distance at which it cuts.
    fn scale(&self, polygon: &mut Polygon, cut: Option<PolygonDepths>) -> Result<(), String> {
        let shares = core::mem::take(&mut polygon.by_distance);
        if shares.is_empty() {
            return Ok(());
        }
        let Some(cut) = cut else {
            return Err("I and J count in the distance of the axes at the cut, and no cut follows that says it: write the G1 after G51.2, or G51.3 instead of I and J".to_owned());
        };
        let distance = (cut.at[0] - self.axis).value();
        for share in shares {
            let scaled = share.harmonics.iter().map(|h| Harmonic {
                cosine: h.cosine * distance,
                sine: h.sine * distance,
                ..*h
            });
            if let Some(known) = polygon.oscillations.iter_mut().find(|o| o.on == share.on) {
                known.harmonics.extend(scaled);
            } else {
                let harmonics = scaled.collect();
                polygon.oscillations.push(Oscillation { on: share.on, harmonics });
            }
        }
        Ok(())
    }

    /// What is sent instead of what was ordered.
    fn compensate(&mut self, polygon: &mut Polygon, span: Span) {
        let turns = polygon.period();
        polygon.wanted.clone_from(&polygon.oscillations);
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

    fn solve(
        &mut self,
        polygon: &Polygon,
        cut: Option<PolygonDepths>,
    ) -> Result<Solution, NotFlat> {
        let is_cutter = self
            .tools
            .get(self.tool)
            .is_some_and(|tool| matches!(tool.kind, ToolKind::PolygonCutter(_)));
        if !is_cutter {
            return refused("D lets the control compute the oscillation, but no polygon cutter is in the spindle: call one with T and M6 before G51.2".to_owned());
        }
        let Some(form) = cut.and_then(|cut| self.form(polygon, cut.at[0])) else {
            return refused("D lets the control compute the oscillation, but no cut follows that says the distance of the axes: write the G1 after G51.2, or G51.3 instead of D".to_owned());
        };
        form.check_roughing().map_err(|all| {
            ("A0401", all.into_iter().map(|refusal| refusal.0).collect::<Vec<_>>().join("; "))
        })?;
        let who = polygon.auto;
        let asked = Asked { form, work: self.work, who, compensated: polygon.compensated };
        let known = self.answers.iter().find(|a| a.0 == asked).map(|a| a.1.clone());
        known.unwrap_or_else(|| {
            let answer = self.flat_enough(&asked);
            self.answers.push((asked, answer.clone()));
            answer
        })
    }

    /// The optimum, if it is within what is allowed of a facet; else the speed at which it would
    /// be.
    fn flat_enough(&self, asked: &Asked) -> Result<Solution, NotFlat> {
        let best = self.optimum(asked)?;
        let allowed = tolerances(false).facet_flatness;
        if best.flatness <= allowed {
            return Ok(best);
        }
        let swinging = best.command.0.iter().filter(|series| series.swings());
        let who: Vec<Actuator> = swinging.map(|series| series.actuator).collect();
        let flat = |rpm: f64| {
            self.problem(asked, Spin::rpm(rpm), &who)
                .and_then(|problem| problem.solve_well(Detail::Drawn))
                .is_some_and(|found| found.flatness <= allowed * LEFT_TO_THE_CUT)
        };
        let rpm = asked.work.abs().in_rpm();
        let works = fastest([SLOWEST_RPM.min(rpm / 2.0), rpm], rpm * NEAR_SHARE, flat).map_or_else(
            || {
                "no speed of this machine works: a larger tip radius may, or another ratio"
                    .to_owned()
            },
            |works| format!("S{:.0} works", works.floor()),
        );
        Err((
            "A0404",
            format!(
                "at S{rpm:.0} the facets come out flat to {:.1} µm at best, {:.0} µm are allowed: {} binds; {works}",
                best.flatness.in_um(),
                allowed.in_um(),
                best.binding.as_deref().unwrap_or("no limit")
            ),
        ))
    }

    /// What air cuts have shown of an actuator's loop; empty: nothing, or it is not asked for.
    fn answers(&self, asked: &Asked, work: Spin, who: Actuator) -> Vec<[f64; 2]> {
        if !asked.compensated {
            return Vec::new();
        }
        kept::answers(self.phases, drives::on(who), asked.form.base(), work, FINE_HARMONICS)
    }

    fn problem<'f>(&self, asked: &'f Asked, work: Spin, who: &[Actuator]) -> Option<Problem<'f>> {
        let answers: Vec<_> = who.iter().map(|a| self.answers(asked, work, *a)).collect();
        problem(self.machine, &asked.form, work, who, &answers, HARMONICS)
    }

    fn optimum(&self, asked: &Asked) -> Result<Solution, NotFlat> {
        let Asked { form, work, who, compensated } = asked;
        let base = form.base();
        let mut unmeasured = false;
        let candidates =
            CANDIDATES.into_iter().filter(|c| who.is_some_and(|order| may_swing(order, c.1)));
        let problems = candidates.filter_map(|(_, who)| {
            let known =
                !compensated || who.iter().all(|a| !self.answers(asked, *work, *a).is_empty());
            unmeasured |= !known;
            Some(((), self.problem(asked, *work, who)?)).filter(|_| known)
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
type NotFlat = (&'static str, String);

/// The gear about which it winds, if it winds.
fn settled(polygon: &Polygon) -> canon::Ratio {
    polygon.ratio.settled().unwrap_or(polygon.ratio)
}

const fn refused<T>(text: String) -> Result<T, NotFlat> {
    Err(("A0401", text))
}

/// What swings, and where X stands meanwhile.
fn oscillations(swings: &Swings, turns: i32) -> Vec<Oscillation> {
    let all = swings.0.iter().map(|series| oscillation(series, f64::from(turns)));
    let stands_only = |o: &Oscillation| o.harmonics.iter().all(|h| h.per_turn == 0);
    let worth_it = |o: &Oscillation| o.harmonics.iter().any(|h| h.cosine.abs() > NOT_WORTH_MM);
    all.filter(|o| !stands_only(o) || worth_it(o)).collect()
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
