//! What was found of a mill: its largest engagement and where, its rapids through the stock.
use super::StockSource;
use super::engagement::{ToolEngagement, deflection};
use super::field::Field;
use super::verdict::{force_basis, verdict};
use crate::feature::{Feature, FeatureKind};
use crate::{Config, Contact, Stock};
use canon::{MillForm, MillLimits, Tool, ToolKind};
use units::{Angle, Force, Length, Spin, Time};

/// Rapids and other findings of one mill that are kept.
const MOST: usize = 50;
/// Cells of a picture, each way.
const PIXELS: usize = 160;

/// A place in the program and in the work offset G54.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MillingPlace {
    /// Program line.
    pub line: u32,
    /// Of the tool's tip.
    pub at: [Length; 3],
}

/// The largest of something, and where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest<T> {
    /// How large.
    pub value: T,
    /// Where.
    pub place: MillingPlace,
}

/// A rapid that went through what was left of the stock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidCut {
    /// Height of what stood in its way.
    pub depth: Length,
    /// Where that was largest.
    pub place: MillingPlace,
}

/// The stock as a mill has left it, from above.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// The block, and its zero.
    pub block: Stock,
    /// How deep it is gone, mm, in rows from small Y to large.
    pub depths: Vec<Vec<f64>>,
}

/// What a mill has done, from when it came into the spindle until it was taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Milled {
    /// Diameter of the mill.
    pub diameter: Length,
    /// Its form, if that is known.
    pub form: Option<MillForm>,
    /// What the tool table says that it may have.
    pub limits: MillLimits,
    /// What it removed, mm³, to the grid's error.
    pub removed_mm3: f64,
    /// Where its stock is known from; `None`: none is known.
    pub source: Option<StockSource>,
    /// Side of a cell of the grid.
    pub cell: Option<Length>,
    /// Memory of the grid, bytes.
    pub grid_bytes: usize,
    /// Axial depth ap.
    pub depth: Option<Largest<Length>>,
    /// Radial width ae.
    pub width: Option<Largest<Length>>,
    /// Angle of engagement.
    pub angle: Option<Largest<Angle>>,
    /// Removal rate, mm³/s.
    pub removal_mm3_per_s: Option<Largest<f64>>,
    /// Feed a tooth; `None` where its teeth are not known.
    pub feed_per_tooth: Option<Largest<Length>>,
    /// Thickness of the chip, thinned below 90° of engagement.
    pub chip: Option<Largest<Length>>,
    /// Tangential force, estimated; `None` where teeth or material are not known.
    pub force: Option<Largest<Force>>,
    /// Deflection of the tip by it; `None` where the body or its length is not known.
    pub deflection: Option<Largest<Length>>,
    /// Fastest speed of the spindle in the cut (magnitude).
    pub spin_max: Spin,
    /// Rapids through the stock, the first ones.
    pub rapids: Vec<RapidCut>,
    /// All of them.
    pub rapid_count: usize,
    /// The stock afterwards.
    pub map: Option<Box<HeightMap>>,
}

impl Milled {
    /// Such as "ball mill".
    pub fn form_name(&self) -> &'static str {
        match self.form {
            Some(MillForm::Ball) => "ball mill",
            Some(MillForm::Cylindrical { corner }) if corner > Length::ZERO => "bull-nose mill",
            Some(MillForm::Cylindrical { .. }) => "flat mill",
            Some(MillForm::Conical { .. }) => "conical mill",
            None => "mill",
        }
    }
}

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
    /// First place of a cut with the spindle at rest, and turning backwards.
    pub(super) still: Option<MillingPlace>,
    pub(super) backwards: Option<MillingPlace>,
    pub(super) turned: bool,
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
            self.still.get_or_insert(place);
        } else if engaged.spin < 0.0 {
            self.backwards.get_or_insert(place);
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
    ) -> Option<Feature> {
        let ToolKind::EndMill(mill) = &tool.kind else { return None };
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
        let is_known = config.mill_stock.is_some() && mill.form.is_some() && !self.turned;
        let passed = milled.rapids.first().map(|rapid| rapid.depth);
        let reach = milled.depth.map(|most| most.value).or(passed);
        let reach = is_known.then(|| reach.unwrap_or(Length::ZERO));
        Some(Feature {
            op,
            line,
            tool: Some(tool.number),
            time: from,
            duration: to - from,
            verdict: verdict(&self, &milled, tool, config),
            contact: Contact { reach, ..Contact::default() },
            kind: FeatureKind::Milled(Box::new(milled)),
        })
    }
}

fn length(of: Most) -> Option<Largest<Length>> {
    of.map(|(value, place)| Largest { value: Length::mm(value), place })
}
