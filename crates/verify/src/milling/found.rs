//! What was found of a mill: its largest engagement and where, its rapids through the stock.
use super::engagement::{ToolEngagement, deflection};
use super::field::Field;
use super::milled::{HeightMap, Largest, Milled, MillingPlace, RapidCut};
use super::verdict::{Noticed, force_basis, verdict};
use crate::judged::Judged;
use crate::{Config, Contact};
use canon::{Mill, Tool, ToolKind};
use units::{Angle, Force, Length, Spin, Time};

/// Rapids and other findings of one mill that are kept.
const MOST: usize = 50;
/// A tool of unknown form that has removed less has removed nothing: the rounding of cells, mm³.
const TRACE_MM3: f64 = 0.01;
/// Cells of a picture, each way.
const PIXELS: usize = 160;

/// The largest so far.
type Most = Option<(f64, MillingPlace)>;

/// What is gathered while the mill is in the spindle.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// Op, line and time of the first feed, and of the last.
    begun: Option<(u32, u32, Time, Time)>,
    here: MillingPlace,
    all: Vec<(ToolEngagement, MillingPlace)>,
    /// mm³.
    removed: f64,
    depth: Most,
    width: Most,
    angle: Most,
    removal: Most,
    spin_max: f64,
    pub(super) rapids: Vec<RapidCut>,
    pub(super) rapid_count: usize,
    pub(super) seen: Noticed,
}

fn most(of: &mut Most, value: f64, place: MillingPlace) {
    if of.is_none_or(|(known, _)| value > known) {
        *of = Some((value, place));
    }
}

impl Found {
    /// It was fed, or was in the way of something.
    pub(super) const fn is_begun(&self) -> bool {
        self.begun.is_some() || self.rapid_count > 0
    }

    pub(super) fn fed(&mut self, op: u32, line: u32, time: Time) {
        let begun = self.begun.get_or_insert((op, line, time, time));
        begun.3 = time;
    }

    /// What it has removed, mm³.
    #[cfg(test)]
    pub(super) const fn volume(&self) -> f64 {
        self.removed
    }

    /// It has removed so much, mm³, to here.
    pub(super) fn removed(&mut self, volume: f64, place: MillingPlace) {
        self.removed += volume;
        self.here = place;
    }

    pub(super) fn rapid(&mut self, depth: f64, place: MillingPlace) {
        self.rapid_count += 1;
        if self.rapids.len() < MOST {
            self.rapids.push(RapidCut { depth: Length::mm(depth), place });
        }
    }

    /// The mill was so engaged, to here.
    pub(super) fn engaged(&mut self, engagement: Option<ToolEngagement>) {
        let Some(engaged) = engagement else { return };
        let place = self.here;
        most(&mut self.depth, engaged.depth, place);
        most(&mut self.removal, engaged.removal, place);
        if let (Some(width), Some(angle)) = (engaged.width, engaged.angle) {
            most(&mut self.width, width, place);
            most(&mut self.angle, angle, place);
        }
        self.spin_max = self.spin_max.max(engaged.spin.abs());
        if engaged.per_turn.is_none() {
            self.seen.still.get_or_insert(place);
        } else if engaged.spin < 0.0 {
            self.seen.backwards.get_or_insert(place);
        }
        self.keep(engaged, place);
    }

    /// Those that no other one exceeds in all that chip and force come from.
    fn keep(&mut self, new: ToolEngagement, place: MillingPlace) {
        let weight =
            |e: &ToolEngagement| [e.per_turn.unwrap_or(0.0), e.depth, e.angle.unwrap_or(0.0)];
        let exceeds = |a: &ToolEngagement, b: &ToolEngagement| {
            weight(a).iter().zip(weight(b)).all(|(a, b)| *a >= b)
        };
        if self.all.iter().any(|(known, _)| exceeds(known, &new)) {
            return;
        }
        self.all.retain(|(known, _)| !exceeds(&new, known));
        self.all.push((new, place));
    }

    /// The feature; `None`: it was neither fed nor in the way of anything.
    pub(super) fn finish(
        self,
        tool: &Tool,
        field: Option<&Field>,
        config: &Config,
    ) -> Option<Judged<Milled>> {
        let mill = match &tool.kind {
            ToolKind::EndMill(mill) => *mill,
            // one that has touched nothing has made nothing
            _ if self.removed < TRACE_MM3 && self.rapid_count == 0 => return None,
            _ => Mill::default(),
        };
        let (op, line, from, to) = match (self.begun, self.rapids.first()) {
            (Some(begun), _) => begun,
            (None, Some(rapid)) => (0, rapid.place.line, Time::ZERO, Time::ZERO),
            (None, None) => return None,
        };
        let diameter = tool.diameter + tool.wear.radius * 2.0;
        let largest = |of: &dyn Fn(&ToolEngagement) -> Option<f64>| {
            let mut found = None;
            for (engaged, place) in &self.all {
                if let Some(value) = of(engaged) {
                    most(&mut found, value, *place);
                }
            }
            found
        };
        let per_tooth = largest(&|e| Some(e.chip(mill.teeth?)?.0));
        let chip = largest(&|e| Some(e.chip(mill.teeth?)?.1));
        let force = largest(&|e| e.force(mill.teeth?, force_basis(config)?));
        let bends = |force: f64| {
            let length = tool.body.stick_out?.value();
            let modulus = mill.body?.modulus_n_per_mm2();
            Some(deflection(force, length, diameter.value(), modulus))
        };
        let bent = force.and_then(|(force, place)| Some((bends(force)?, place)));
        let known = field.filter(|_| config.mill_stock.is_some() && mill.form.is_some());
        let milled = Milled {
            diameter,
            form: mill.form,
            limits: mill.limits,
            removed_mm3: self.removed,
            source: config.mill_stock.map(|stock| stock.source),
            cell: known.map(|field| Length::mm(field.cell())),
            grid_bytes: known.map_or(0, Field::bytes),
            depth: length(self.depth),
            width: length(self.width),
            angle: self
                .angle
                .map(|(value, place)| Largest { value: Angle::deg(value.to_degrees()), place }),
            removal_mm3_per_s: self.removal.map(|(value, place)| Largest { value, place }),
            feed_per_tooth: length(per_tooth),
            chip: length(chip),
            force: force.map(|(value, place)| Largest { value: Force::n(value), place }),
            deflection: length(bent),
            spin_max: Spin::rev_per_s(self.spin_max),
            rapids: self.rapids.clone(),
            rapid_count: self.rapid_count,
            map: known.map(|field| {
                Box::new(HeightMap { block: *field.stock(), depths: field.picture(PIXELS) })
            }),
        };
        let is_known = config.mill_stock.is_some() && mill.form.is_some() && !self.seen.turned;
        let passed = milled.rapids.first().map(|rapid| rapid.depth);
        let reach = milled.depth.map(|most| most.value).or(passed);
        let reach = is_known.then(|| reach.unwrap_or(Length::ZERO));
        Some(Judged {
            op,
            line,
            tool: Some(tool.number),
            time: from,
            duration: to - from,
            verdict: verdict(&self.seen, &milled, tool, config),
            contact: Contact { reach, ..Contact::default() },
            kind: milled,
        })
    }
}

fn length(of: Most) -> Option<Largest<Length>> {
    of.map(|(value, place)| Largest { value: Length::mm(value), place })
}
