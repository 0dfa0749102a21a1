//! `G51.2 … D`: the control computes the oscillation for the cut that follows, on this machine.
use super::{AS_FLAT, CANDIDATES, drives};
use canon::{
    Axis, Harmonic, OpKind, Oscillating, Oscillation, Polygon, SpindleOrder, ToolKind, ToolLibrary,
};
use diag::{Diagnostic, Span};
use forms::polygon::{Actuator, Form, Problem, Series, Solution};
use store::machine::MachineFile;
use units::{Length, Spin};

/// Harmonics of each oscillation.
const HARMONICS: usize = 4;

/// Follows the program as far as an oscillation depends on it.
pub(crate) struct Auto<'a> {
    machine: &'a MachineFile,
    tools: &'a ToolLibrary,
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
        axis: Length,
    ) -> Self {
        Self { machine, tools, axis, tool: 0, work: Spin::ZERO, findings: Vec::new() }
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
    pub(crate) fn fill(&mut self, polygon: &mut Polygon, cut: Option<Length>, span: Span) {
        match self.solve(polygon, cut) {
            Ok(solution) => {
                polygon.oscillations = solution.command.0.iter().map(oscillation).collect();
            }
            Err(text) => self.findings.push(Diagnostic::error("A0401", span, text)),
        }
    }

    fn solve(&self, polygon: &Polygon, cut: Option<Length>) -> Result<Solution, String> {
        let tool = self.tools.get(self.tool).map(|tool| &tool.kind);
        let Some(ToolKind::PolygonCutter(cutter)) = tool else {
            return Err("D lets the control compute the oscillation, but no polygon cutter is in the spindle: call one with T and M6 before G51.2".to_owned());
        };
        let Some(cut) = cut else {
            return Err("D lets the control compute the oscillation, but no cut follows that says the distance of the axes: write the G1 after G51.2, or G51.3 instead of D".to_owned());
        };
        let form = Form {
            inserts: cutter.inserts.clone(),
            turns: [polygon.ratio.follower, polygon.ratio.master],
            across_flats: (cut - self.axis - cutter.radius) * 2.0,
            tip_radius: cutter.radius,
            stock_radius: self.machine.setup.stock.to[0],
        };
        form.check().map_err(|all| {
            all.into_iter().map(|refusal| refusal.0).collect::<Vec<_>>().join("; ")
        })?;
        if (form.base() - form.base().round()).abs() > 1e-9 {
            return Err(format!(
                "the inserts pass {} times a turn: an oscillation repeats with the turn, so that number must be whole; leave out D",
                form.base()
            ));
        }
        let mut best: Option<Solution> = None;
        for (_, who) in CANDIDATES.into_iter().filter(|c| may(polygon.auto, c.1)) {
            let drives = who
                .iter()
                .map(|a| drives::drive(self.machine, *a, &form, self.work, HARMONICS))
                .collect::<Option<Vec<_>>>();
            let Some(drives) = drives else { continue };
            let problem = Problem { form: &form, spin: self.work, drives, harmonics: HARMONICS };
            let Some(found) = problem.solve() else { continue };
            let better = |b: &Solution| found.flatness + AS_FLAT < b.flatness;
            if best.as_ref().is_none_or(better) {
                best = Some(found);
            }
        }
        best.ok_or_else(|| {
            "the machine lacks what D asks to swing: D0 takes what is there".to_owned()
        })
    }
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

fn oscillation(series: &Series) -> Oscillation {
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
                per_turn: t.per_turn.round() as u32,
                cosine: t.cosine,
                sine: t.sine,
            })
            .collect(),
    }
}
