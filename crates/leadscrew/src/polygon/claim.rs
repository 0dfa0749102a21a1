//! What a block is claimed to cut: its text read again, and the exact kinematics of what it says.
//!
//! ```text
//!   block, as printed ─► interpreter, preflight ─► what swings, where X cuts ─► through the loops ─► every insert's path
//!        └─ refused? then nothing is claimed                                                              └─► Cut
//! ```
use super::prove;
use super::servo_error::{ServoError, Swung};
use super::{Design, FINE_HARMONICS, drives, kept};
use canon::{OpKind, Oscillating, Oscillation, Polygon};
use control::Refused;
use control::config::machine_file::MachineSource;
use control::config::tolerances;
use control::polygon::cuts;
use forms::polygon::{Actuator, Cut, Form, Series, Swings, Term};
use units::{Length, Spin};

/// What comes of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// If every axis went where it is told.
    pub as_ordered: Cut,
    /// As the loops answer.
    pub cut: Cut,
    /// By how much a machine may differ from that.
    pub servo: ServoError,
}

impl Design {
    /// What a block of this design is claimed to cut, or why it cannot be run.
    pub(super) fn claim(
        &self,
        block: &str,
        machine: &MachineSource,
        work: Spin,
    ) -> Result<Result<Claim, String>, Refused> {
        let text = format!("{block}M2\n");
        let mut job = prove::job(self, machine, text)?;
        job.session.cams.phases = self.phases.clone();
        let errors: Vec<String> = job
            .check()
            .iter()
            .filter(|finding| finding.is_error())
            .map(|finding| finding.message.clone())
            .collect();
        if !errors.is_empty() {
            return Ok(Err(errors.join("; ")));
        }
        let operations = job.operations();
        let ops = operations.all();
        let begun = ops.iter().enumerate().find_map(|(at, op)| match &op.kind {
            OpKind::Polygon(polygon) => Some((at, polygon)),
            _ => None,
        });
        let place =
            begun.and_then(|(at, polygon)| Some((polygon, cuts::cut(ops[at + 1..].iter())?)));
        let Some((polygon, place)) = place else {
            return Ok(Err("nothing is cut".to_owned()));
        };
        let distance = place.at[0] - job.session.work_zero().linear[0];
        let across_flats = (distance - self.form.tip_radius) * 2.0;
        let form = Form { across_flats, ..self.form.clone() };
        Ok(self.claim_of(&form, polygon, work).ok_or_else(|| "not every facet is cut".to_owned()))
    }

    fn claim_of(&self, form: &Form, polygon: &Polygon, work: Spin) -> Option<Claim> {
        let ordered = ordered(polygon);
        let measured = |series: &Series| {
            let on = drives::on(series.actuator);
            kept::answers(&self.phases, on, form.base(), work, FINE_HARMONICS)
        };
        let measured = ordered.0.iter().map(measured).collect();
        let swung = Swung { machine: &self.machine, form, work, ordered: &ordered, measured };
        let as_ordered = form.cut(&ordered)?;
        let cut = form.cut(&swung.expected()?)?;
        Some(Claim { as_ordered, cut, servo: swung.error()? })
    }
}

impl Claim {
    /// The least flat that it may come out.
    pub fn flatness_at_most(&self) -> Length {
        self.cut.flatness + self.servo.flatness
    }

    /// For people.
    pub fn words(&self) -> String {
        let allowed = tolerances(false).facet_flatness;
        let verdict = if self.cut.flatness > allowed {
            format!(": more than the {:.0} µm allowed (ISO 2768-2 H)", allowed.in_um())
        } else if self.flatness_at_most() > allowed {
            format!(
                ": {:.0} µm are allowed (ISO 2768-2 H), so look at the first one",
                allowed.in_um()
            )
        } else {
            String::new()
        };
        format!(
            "the block below, by the exact path of every insert: flat to {:.3} µm, {:.4} mm across flats; servo error up to {:.2} µm and {:.1} µm, so it may be cut flat to {:.2} µm{verdict}",
            self.cut.flatness.in_um(),
            self.cut.across_flats.value(),
            self.servo.flatness.in_um(),
            self.servo.across_flats.in_um(),
            self.flatness_at_most().in_um(),
        )
    }
}

/// What swings, over one turn of the work.
fn ordered(polygon: &Polygon) -> Swings {
    let turns = polygon.period();
    let series = |o: &Oscillation| Series {
        actuator: match o.on {
            Oscillating::ToolPhase => Actuator::ToolPhase,
            Oscillating::Axis(canon::Axis::Y) => Actuator::Across,
            Oscillating::Axis(_) => Actuator::CentreLine,
        },
        terms: o
            .harmonics
            .iter()
            .map(|h| Term {
                per_turn: f64::from(h.per_turn) / turns,
                cosine: h.cosine,
                sine: h.sine,
            })
            .collect(),
    };
    Swings(polygon.oscillations.iter().map(series).collect())
}
