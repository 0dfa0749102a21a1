//! What the judge does with a servo period: what stands on the work looks on, and the feature under
//! way is followed.
use crate::feature::milled;
use crate::judge::{Judge, Track, What};
use crate::turned;
use crate::undone::Undone;
use bus::Sample;

impl Judge {
    /// What happened: every servo period, in order.
    pub fn sample(&mut self, sample: &Sample) {
        self.now = sample.feedback.time;
        let op = sample.report.op;
        if let Some(feature) = self.removals.sample(sample) {
            match self.features.iter_mut().rfind(|f| f.op == feature) {
                Some(judged) => judged.chips_were_thrown(),
                None => self.thrown.push(feature),
            }
        }
        while self.orders.front().is_some_and(|order| order.end.is_some_and(|end| op >= end)) {
            self.close();
        }
        let under_way = self.orders.front().filter(|order| op >= order.first);
        let feature = under_way.filter(|order| order.is_along_its_tool()).map(|order| order.first);
        self.work.sample(sample, &self.config, feature);
        self.look_on(sample);
        let taken_out = self.milling.sample(sample, &self.config, &self.work);
        self.features.extend(taken_out.map(milled));
        if self.work.has_undone() {
            self.take_back();
        }
        let (turning, undone) = self.turn(sample);
        self.follow(sample, turning);
        self.take_back_of(undone);
    }

    /// What turns with the work sees what is done to it, and by which line.
    fn look_on(&mut self, sample: &Sample) {
        let line = sample.report.line;
        if let Some(bar) = &mut self.bar {
            if bar.line() != line {
                self.polygons.look(bar);
            }
            bar.cut_by(line);
        }
        let under_way = self.orders.front().filter(|order| sample.report.op >= order.first);
        match under_way.map(|order| &order.what) {
            Some(What::Gear(_)) => {}
            Some(What::Cam(_)) => self.gears.sample(sample, &self.config),
            _ => {
                self.gears.sample(sample, &self.config);
                let allowed = self.config.tolerances.cam_contour;
                self.ground.sample(sample, self.config.wheel_width, allowed);
            }
        }
    }

    /// The bar is turned; of a thread, where its point has passed.
    fn turn(&mut self, sample: &Sample) -> (Option<Vec<crate::bar::Crossing>>, Vec<Undone>) {
        let op = sample.report.op;
        let order = self.orders.front().filter(|order| op >= order.first);
        let is_thread = order.is_some_and(|order| matches!(order.what, What::Turned(_)));
        let config = &self.config;
        let tool = sample.feedback.tool.and_then(|number| config.tools.get(number));
        let Some(bar) = &mut self.bar else { return (None, Vec::new()) };
        if is_thread {
            return (Some(bar.follow(sample, tool)), Vec::new());
        }
        bar.sample(sample, tool);
        let Some(place) = bar.cut_off(tool) else { return (None, Vec::new()) };
        self.threads.come_off(place, bar, config);
        let undone = self.polygons.come_off(place, bar);
        bar.come_off(place);
        (None, undone)
    }

    /// The feature under way sees a sample.
    fn follow(&mut self, sample: &Sample, crossings: Option<Vec<crate::bar::Crossing>>) {
        let op = sample.report.op;
        let Some(order) = self.orders.front().filter(|order| op >= order.first) else { return };
        let (config, known) = (&self.config, (&self.work, &self.milling));
        let track = self.track.get_or_insert_with(|| {
            Track::new(order, sample.feedback.tool.or(order.tool), config, known)
        });
        match track {
            Track::Hole { track, .. } => track.sample(sample),
            Track::Thread(track) => track.sample(sample),
            Track::Polygon(track) => track.sample(sample),
            Track::Gear(track) => track.sample(sample),
            Track::Cam(track) => track.sample(sample),
            Track::Turned(track) => {
                let turning: Option<turned::Turning<'_>> = self.bar.as_ref().zip(crossings);
                if let What::Turned(ordered) = &order.what {
                    track.sample(sample, ordered, turning.as_ref(), config.work_axis);
                }
            }
        }
    }
}
