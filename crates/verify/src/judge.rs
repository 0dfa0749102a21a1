//! The judge: takes ops and recorded samples in order, gives features.
//!
//! ```text
//!   op(i)      ─► queue of what will be cut: ops first .. end, line, tool ordered
//!   sample     ─► report.op before `first` of the queue's front: nothing is cut, return at once
//!                 within first .. end: the front's track follows the edges
//!                 at or past `end`: measure, judge, next
//!   finish     ─► what is left in the queue was not cut to its end
//! ```
//!
//! A sample between features costs a comparison; within one, memory is bounded by the bins of its
//! depth.
use crate::Config;
use crate::bar::TurnedBar;
use crate::cam::{self, CamTrack};
use crate::chips::Removals;
use crate::feature::{Feature, FeatureKind, milled};
use crate::gear::{self, GearTrack};
use crate::hole::HoleTrack;
use crate::milling::Milling;
use crate::polygon::{OrderedPolygon, PolygonTrack};
use crate::standing_polygons::StandingPolygons;
use crate::stroke::Stroke;
use crate::taken_back::TakenBack;
use crate::thread::ThreadTrack;
use crate::turned::{self, TurnedTrack};
use crate::undone::{Undone, of_before};
use crate::workpiece::Workpiece;
use canon::{
    CamLibrary, CamOrder, Hole, Op, OpKind, Position, ProgramFrame, Span, SpindleOrder, Tap, Tool,
};
use std::collections::VecDeque;
use units::Time;

/// Judges a workpiece from recorded motion.
#[derive(Clone, Debug)]
pub struct Judge {
    pub(crate) config: Config,
    /// Ordered and not yet judged, in order; the front is being cut once `track` is there.
    pub(crate) orders: VecDeque<OrderedFeature>,
    pub(crate) track: Option<Track>,
    /// The tool that the ops so far have put into the spindle.
    tool_ordered: Option<u32>,
    /// What was drilled, tapped and milled of the block.
    pub(crate) work: Workpiece,
    pub(crate) taken_back: TakenBack,
    pub(crate) polygons: StandingPolygons,
    /// The bar as it has been turned so far, and the threads on it.
    pub(crate) bar: Option<TurnedBar>,
    pub(crate) threads: turned::Places,
    pub(crate) milling: Milling,
    pub(crate) gears: gear::Cuts,
    pub(crate) ground: cam::Cams,
    pub(crate) features: Vec<Feature>,
    /// What a program before has cut: listed once it is destroyed.
    pub(crate) before: Vec<Feature>,
    pub(crate) removals: Removals,
    /// Where the ops so far have brought the axes.
    at: Position,
    came_from: turned::CameFrom,
    /// The cam's profile in force.
    selected: cam::Selected,
    /// Features not yet judged after which chips were thrown off, by their first op.
    pub(crate) thrown: Vec<u32>,
    /// First op of the feature ordered last.
    last_ordered: Option<u32>,
    pub(crate) now: Time,
}

/// What has been cut of the work, as far as a judge knows: what comes later is judged against it.
#[derive(Clone, Debug, Default)]
pub struct Work {
    block: Workpiece,
    polygons: StandingPolygons,
    bar: Option<TurnedBar>,
    threads: turned::Places,
    milling: Milling,
    gears: gear::Cuts,
    ground: cam::Cams,
    features: Vec<Feature>,
}

/// One feature that the program orders.
#[derive(Clone, Debug)]
pub(crate) struct OrderedFeature {
    pub(crate) first: u32,
    /// First op that is no longer part of it; `None` while that is not known.
    pub(crate) end: Option<u32>,
    span: Span,
    pub(crate) tool: Option<u32>,
    pub(crate) what: What,
}

#[derive(Clone, Debug)]
pub(crate) enum What {
    Hole(Hole),
    Tap(Tap),
    Polygon(Box<OrderedPolygon>),
    Cam(Box<cam::OrderedCam>),
    Turned(turned::OrderedThread),
    Gear(Box<gear::OrderedGear>),
}

#[derive(Clone, Debug)]
pub(crate) enum Track {
    Hole { track: Box<HoleTrack>, tool: Option<u32> },
    Thread(Box<ThreadTrack>),
    Polygon(Box<PolygonTrack>),
    Cam(CamTrack),
    Turned(TurnedTrack),
    Gear(Box<GearTrack>),
}

impl Judge {
    /// A judge who has seen nothing yet.
    pub fn new(config: Config) -> Self {
        Self {
            bar: config.bar.map(|bar| TurnedBar::new(bar, config.work_axis)),
            config,
            orders: VecDeque::new(),
            track: None,
            tool_ordered: None,
            work: Workpiece::default(),
            taken_back: TakenBack::default(),
            polygons: StandingPolygons::default(),
            threads: turned::Places::default(),
            milling: Milling::default(),
            gears: gear::Cuts::default(),
            ground: cam::Cams::default(),
            features: Vec::new(),
            before: Vec::new(),
            removals: Removals::default(),
            at: Position::default(),
            came_from: turned::CameFrom::default(),
            selected: cam::Selected::default(),
            thrown: Vec::new(),
            last_ordered: None,
            now: Time::ZERO,
        }
    }

    /// The same judge, who knows what was cut before.
    #[must_use]
    pub fn on(mut self, work: Work) -> Self {
        self.work = work.block.at_rest();
        self.polygons = work.polygons.at_rest();
        self.milling = work.milling.at_rest();
        self.gears = work.gears.at_rest();
        self.ground = work.ground.at_rest();
        self.before = work.features;
        if let (Some(bar), Some(own)) = (work.bar, &mut self.bar) {
            *own = bar.at_rest();
            self.threads = work.threads.at_rest();
        }
        self
    }

    /// A program begins that may grind these cams.
    pub fn may_grind(&mut self, cams: CamLibrary) {
        self.config.cams = cams;
    }

    /// A program begins that states its stock, which is clamped as this has it; a bar of another
    /// size is another one, on which nothing was turned.
    pub fn is_clamped(&mut self, stated: &Config) {
        let Config { stock, mill_stock, gear_blank, stock_radius, bar, .. } = *stated;
        if bar != self.config.bar {
            self.bar = bar.map(|bar| TurnedBar::new(bar, self.config.work_axis));
            (self.threads, self.polygons) = Default::default();
        }
        if mill_stock != self.config.mill_stock {
            self.milling = Milling::default();
        }
        self.config =
            Config { stock, mill_stock, gear_blank, stock_radius, bar, ..self.config.clone() };
    }

    /// What is left of the work.
    pub fn into_work(mut self) -> Work {
        while !self.orders.is_empty() {
            self.close();
        }
        self.settle_turned();
        let numbered = |feature: Feature| Feature { op: of_before(feature.op), ..feature };
        let features = self.features.into_iter().map(numbered).collect();
        let Self { work: block, polygons, bar, threads, milling, gears, ground, .. } = self;
        Work { block, polygons, bar, threads, milling, gears, ground, features }
    }

    /// What the program orders: each op once, in order, before its samples arrive.
    pub fn op(&mut self, index: u32, op: &Op) {
        let from = self.at;
        match &op.kind {
            OpKind::Rapid { to } => {
                self.came_from.rapid(&from, to);
                self.at = *to;
            }
            OpKind::Line { to, .. } | OpKind::Arc { to, .. } | OpKind::Spline { to, .. } => {
                self.at = *to;
            }
            OpKind::Threading(order) => self.at = order.to,
            OpKind::Spindle { spindle: 0, order } => self.came_from.spindle(order),
            _ => {}
        }
        self.milling.op(index, op);
        self.order(index, op, &from);
    }

    /// How the program has written the op that was told last: places are said in its words.
    pub fn frame(&mut self, index: u32, frame: ProgramFrame) {
        self.milling.frame(index, frame);
    }

    fn order(&mut self, index: u32, op: &Op, from: &Position) {
        let mut thread = turned::OrderedThread::default();
        if let Some(open) = self.orders.back_mut().filter(|order| order.end.is_none()) {
            if let What::Polygon(ordered) = &mut open.what {
                ordered.see(&op.kind);
                if matches!(op.kind, OpKind::PolygonEnd | OpKind::End) {
                    open.end = Some(index);
                }
                return;
            }
            if let What::Gear(_) = &open.what {
                if matches!(op.kind, OpKind::HobEnd | OpKind::End) {
                    open.end = Some(index);
                }
                return;
            }
            if let What::Turned(ordered) = &mut open.what {
                if ordered.see(index, from, &self.came_from, &op.kind) {
                    return;
                }
                if ordered.is_left_by(index, from, &self.came_from, &op.kind) {
                    thread = turned::OrderedThread::after(ordered, &self.came_from);
                }
                open.end = Some(index);
            }
            if let What::Cam(_) = open.what {
                // spark-out belongs to the grinding before it, and sampling moves nothing
                let goes_on = match &op.kind {
                    OpKind::Cam(order) => !matches!(
                        order,
                        CamOrder::Select { .. } | CamOrder::Deselect | CamOrder::Grind { .. }
                    ),
                    kind => matches!(kind, OpKind::Coolant { .. } | OpKind::Message(_)),
                };
                if goes_on {
                    return;
                }
                open.end = Some(index);
            }
            let starts_another =
                matches!(op.kind, OpKind::Hole(_) | OpKind::Tap(_) | OpKind::ChangeTool { .. });
            if open.end.is_none() && (starts_another || op.span != open.span) {
                open.end = Some(index);
            }
        }
        let (what, end) = match &op.kind {
            OpKind::Hole(hole) => {
                self.will_drill();
                (What::Hole(*hole), None)
            }
            OpKind::Tap(tap) => (What::Tap(*tap), Some(index + 1)),
            OpKind::Cam(order) => match self.selected.see(order) {
                Some(ordered) => (What::Cam(Box::new(ordered)), None),
                None => return,
            },
            OpKind::Threading(_) => {
                thread.see(index, from, &self.came_from, &op.kind);
                (What::Turned(thread), None)
            }
            OpKind::Hob(hob) => (What::Gear(Box::new(gear::OrderedGear { hob: *hob })), None),
            OpKind::Polygon(polygon) => {
                (What::Polygon(Box::new(OrderedPolygon::new(polygon))), None)
            }
            OpKind::Spindle { order: SpindleOrder::ThrowChips(chips), .. } => {
                if let Some(feature) = self.last_ordered {
                    self.removals.order(index, feature, chips.throw);
                }
                return;
            }
            OpKind::ChangeTool { number } => {
                self.tool_ordered = (*number != 0).then_some(*number);
                return;
            }
            _ => return,
        };
        self.last_ordered = Some(index);
        self.orders.push_back(OrderedFeature {
            first: index,
            end,
            span: op.span,
            tool: self.tool_ordered,
            what,
        });
    }

    /// The program was given up at this op: what was ordered after it will not be cut, and is no
    /// feature.
    pub fn give_up(&mut self, op: u32) {
        self.orders.retain(|order| order.first <= op);
        if let Some(open) = self.orders.back_mut() {
            open.end.get_or_insert(op + 1);
        }
    }

    /// Nothing more is done to what was ordered before this op, unless a coupling still holds: it
    /// is judged.
    pub fn settle(&mut self, next_op: u32) {
        for order in &mut self.orders {
            if matches!(order.what, What::Hole(_) | What::Turned(_)) {
                order.end.get_or_insert(next_op);
            }
        }
        while self.orders.front().is_some_and(|order| order.end.is_some()) {
            self.close();
        }
        self.features.extend(self.milling.close(&self.config).map(milled));
        self.work.settle();
        self.take_back();
        self.settle_turned();
    }

    /// The features judged so far, for a progress display.
    pub fn features(&self) -> &[Feature] {
        &self.features
    }

    /// The features judged so far, which the judge forgets.
    pub fn take_features(&mut self) -> Vec<Feature> {
        self.thrown.clear();
        self.taken_back.changed.clear();
        self.threads.taken();
        std::mem::take(&mut self.features)
    }

    /// Nothing is ordered that was not judged yet: what is there is all that [`Self::finish`] would
    /// say.
    pub fn is_settled(&self) -> bool {
        self.orders.is_empty()
            && !self.milling.is_under_way()
            && self.threads.is_settled(self.bar.as_ref())
            && self.polygons.is_settled(self.bar.as_ref())
            && self.gears.is_settled()
            && self.ground.is_settled()
    }

    /// The features, in the order cut. What was ordered and never cut is there too, failed.
    #[must_use]
    pub fn finish(mut self) -> Vec<Feature> {
        while !self.orders.is_empty() {
            self.close();
        }
        self.features.extend(self.milling.close(&self.config).map(milled));
        self.work.settle();
        self.take_back();
        self.settle_turned();
        if self.bar.is_some() {
            self.features.sort_by_key(|feature| feature.op);
        }
        self.features
    }

    /// Judge the front of the queue.
    pub(crate) fn close(&mut self) {
        let Some(order) = self.orders.pop_front() else { return };
        if order.is_along_its_tool() {
            self.work.end_plunge();
        }
        let (work, milling) = (&self.work, &self.milling);
        let track = self
            .track
            .take()
            .unwrap_or_else(|| Track::new(&order, order.tool, &self.config, (work, milling)));
        let (op, line, now) = (order.first, order.span.line, self.now);
        let config = &self.config;
        let mut undone = Vec::new();
        let feature = match (track, &order.what) {
            (Track::Thread(track), _) => {
                let mut found = track.finish((op, line), now, config, (work, milling));
                if let Some(place) = track.place((op, line), &found.kind, config.class) {
                    self.work.tapped(place).into_iter().for_each(|why| found.fails(why));
                }
                Some(found.map(Box::new).map(FeatureKind::Thread))
            }
            (Track::Polygon(track), What::Polygon(ordered)) => {
                let mut found = track.finish(op, line, ordered, config, now);
                let before = TakenBack::known(&self.features);
                let on = (config.stock_radius, self.bar.as_mut());
                undone = self.polygons.add(&mut found, &mut self.features, on);
                self.taken_back.compare(&before, &self.features);
                if let (Some(bar), Some(new)) = (&self.bar, self.polygons.facets().last()) {
                    self.threads.are_faceted(&new, bar);
                }
                Some(found.map(Box::new).map(FeatureKind::Polygon))
            }
            (Track::Cam(track), What::Cam(ordered)) => {
                let before = TakenBack::known(&self.features);
                let on = (&mut self.ground, &mut self.features[..]);
                let found;
                (found, undone) = track.finish((op, line), ordered, config, on, now);
                self.taken_back.compare(&before, &self.features);
                Some(found.map(Box::new).map(FeatureKind::Cam))
            }
            (Track::Gear(track), What::Gear(ordered)) => {
                let place = (op, line, order.tool);
                let (found, earlier) = track.finish(place, ordered, (config, &mut self.gears), now);
                let absorbed = self.taken_back.absorb(&earlier.absorbed, &mut self.features);
                let gone = |op: &u32| !absorbed.contains(op);
                let again = |op: u32| {
                    let reason = found.verdict.reason()?;
                    Some(Undone {
                        op,
                        line,
                        how: format!("hobbed again: {reason}"),
                        is_known: true,
                    })
                };
                undone.extend(earlier.absorbed.into_iter().filter(gone).filter_map(again));
                let over = earlier.destroyed.into_iter();
                undone.extend(over.map(|(op, how)| Undone { op, line, how, is_known: true }));
                Some(found.map(Box::new).map(FeatureKind::Gear))
            }
            (Track::Turned(track), What::Turned(ordered)) => {
                let work = (config, self.bar.as_mut(), &mut self.threads);
                let found = track.finish(op, line, ordered, work, now);
                if let (Some(bar), None) = (&self.bar, &found) {
                    self.threads.is_on_facets(self.polygons.facets(), bar);
                }
                found.map(|found| found.map(Box::new).map(FeatureKind::Turned))
            }
            (Track::Hole { track, tool }, _) => {
                let with = (tool, tool.and_then(|number| config.tools.get(number)));
                let found = track.finish((op, line), with, now, config, work);
                found.map(|found| found.map(FeatureKind::Hole))
            }
            // a track is made of what was ordered
            _ => None,
        };
        self.take_back_of(undone);
        self.features.extend(feature);
        self.take_back();
        if let Some(place) = self.thrown.iter().position(|feature| *feature == op) {
            self.thrown.swap_remove(place);
            if let Some(feature) = self.features.last_mut().filter(|f| f.op == op) {
                feature.chips_were_thrown();
            }
        }
    }
}

impl Track {
    pub(crate) fn new(
        order: &OrderedFeature,
        number: Option<u32>,
        config: &Config,
        (work, milling): (&Workpiece, &Milling),
    ) -> Self {
        let tool: Option<&Tool> = number.and_then(|number| config.tools.get(number));
        let stroke = match &order.what {
            What::Hole(hole) => Stroke::of_hole(hole),
            What::Tap(tap) => Stroke::of_tap(tap),
            What::Cam(ordered) => return Self::Cam(CamTrack::new(ordered)),
            What::Turned(_) => return Self::Turned(TurnedTrack::default()),
            What::Gear(ordered) => {
                return Self::Gear(Box::new(GearTrack::new(ordered, (number, tool), config)));
            }
            What::Polygon(ordered) => {
                return Self::Polygon(Box::new(PolygonTrack::new(ordered, number, tool, config)));
            }
        };
        let stock = config.stock.as_ref();
        let surface = stock
            .zip(order.under(tool, config))
            .map(|(stock, (at, under))| work.surface(stock.top().value(), at, under, milling));
        let stroke = stroke.in_stock((stock, surface), tool, &config.tools);
        match &order.what {
            What::Tap(tap) => Self::Thread(Box::new(ThreadTrack::new(tap, number, tool, stroke))),
            What::Hole(_) | What::Cam(_) | What::Turned(_) | What::Polygon(_) | What::Gear(_) => {
                Self::Hole { track: Box::new(HoleTrack::new(stroke)), tool: number }
            }
        }
    }
}
