//! One hole of a cycle: in, what is done at the bottom, and out again.
use crate::{
    call::{Call, CycleHole, CycleTap, Sink, Units},
    cycles::Pattern,
    execute::Executor,
    frame::Point,
    state::Cycle,
};

/// How far above the last depth the rapid back into the hole ends, and how far G73 backs off: 0.010 inch.
const CLEARANCE_INCH: f64 = 0.010;
/// Cycles that begin where the bore ends.
pub(crate) const fn bores_upwards(cycle: Cycle) -> bool {
    matches!(cycle, Cycle::BoreUpwards)
}

impl Executor {
    /// One hole, at the place where the plane's two axes are to stand.
    pub(crate) fn hole<S: Sink>(
        &mut self,
        pattern: &Pattern,
        throw_rpm: Option<f64>,
        sink: &mut S,
    ) {
        let [_, _, n] = self.state.plane_axes();
        let mut at = self.state.at;
        at[n] = pattern.r;
        let hole = CycleHole {
            plane: self.state.plane,
            at,
            bottom: pattern.bottom,
            clear: pattern.clear,
            throw_rpm,
        };
        let tap = pattern.cycle.tap_sense();
        let upwards = bores_upwards(pattern.cycle);
        if tap.is_none() && pattern.shift.is_none() && !upwards {
            self.say(sink, &Call::Hole(hole));
        }
        self.say(sink, &Call::Rapid(self.state.at));
        if self.state.at[n] != pattern.r {
            self.say(sink, &Call::Rapid(at));
        }
        if upwards {
            let levels = [pattern.bottom, pattern.counterbore];
            self.bore_upwards(&at, levels, (pattern.peck, pattern.dwell), sink);
        } else if let Some(shift) = pattern.shift {
            let levels = [pattern.bottom, pattern.counterbore, pattern.clear];
            self.back_bore(&at, levels, shift, sink);
        } else if let Some(sense) = tap {
            let overrides = (self.state.feed_override, self.state.speed_override);
            let call = pattern.tap.call(hole, sense, pattern.dwell, overrides);
            let feed_stated = self.words.get(b'F').is_some();
            self.say(sink, &Call::Tap(CycleTap { feed_stated, ..call }));
        } else {
            self.down_and_out(pattern, &hole, n, sink);
        }
        self.state.at[n] = pattern.clear;
    }

    fn down_and_out<S: Sink>(
        &mut self,
        pattern: &Pattern,
        hole: &CycleHole,
        n: usize,
        sink: &mut S,
    ) {
        let level = |value: f64| -> Point {
            let mut point = hole.at;
            point[n] = value;
            point
        };
        if matches!(pattern.cycle, Cycle::ChipBreak | Cycle::Peck) {
            self.peck(pattern, level, sink);
        }
        self.say(sink, &Call::Line(level(pattern.bottom)));
        let out = level(pattern.clear);
        match pattern.cycle {
            Cycle::Drill | Cycle::DrillDwell => {
                if pattern.cycle == Cycle::DrillDwell || pattern.dwell > 0.0 {
                    self.say(sink, &Call::Dwell(pattern.dwell));
                }
                if hole.throw_rpm.is_some() {
                    self.say(sink, &Call::ThrowChips(*hole));
                }
                self.say(sink, &Call::Rapid(out));
            }
            Cycle::BoreFeedOut => {
                self.say(sink, &Call::Line(level(pattern.r)));
                self.say(sink, &Call::Rapid(out));
            }
            Cycle::BoreDwellFeedOut => {
                self.say(sink, &Call::Dwell(pattern.dwell));
                self.say(sink, &Call::Line(out));
            }
            Cycle::BoreStopOut => {
                self.say(sink, &Call::Dwell(pattern.dwell));
                self.say(sink, &Call::SpindleStop);
                self.say(sink, &Call::Rapid(out));
                self.turn_again(sink);
            }
            Cycle::FineBore => {
                if pattern.dwell > 0.0 {
                    self.say(sink, &Call::Dwell(pattern.dwell));
                }
                self.fine_bore_out(&level(pattern.bottom), &out, pattern.peck, sink);
            }
            Cycle::BoreManualOut => {
                self.say(sink, &Call::Dwell(pattern.dwell));
                self.say(sink, &Call::SpindleStop);
                self.say(sink, &Call::Stop);
                self.say(sink, &Call::OutByHand(out));
                self.turn_again(sink);
            }
            Cycle::ChipBreak
            | Cycle::Peck
            | Cycle::BackBore
            | Cycle::BoreUpwards
            | Cycle::TapLeft
            | Cycle::TapRight
            | Cycle::RigidLeft
            | Cycle::RigidRight
            | Cycle::SynchroLeft
            | Cycle::SynchroRight => self.say(sink, &Call::Rapid(out)),
        }
    }

    /// All pecks but the last.
    fn peck<S: Sink>(&self, pattern: &Pattern, level: impl Fn(f64) -> Point, sink: &mut S) {
        let clearance = match self.state.units {
            Units::Inch => CLEARANCE_INCH,
            Units::Millimetre => CLEARANCE_INCH * units::MM_PER_INCH,
        };
        let mut depth = pattern.r - pattern.peck;
        while depth > pattern.bottom {
            self.say(sink, &Call::Line(level(depth)));
            if pattern.cycle == Cycle::Peck {
                self.say(sink, &Call::Rapid(level(pattern.r)));
            }
            self.say(sink, &Call::Rapid(level(depth + clearance)));
            depth -= pattern.peck;
        }
    }
}
