//! Supervision of taps by the torque that the drive of their spindle measures.
//!
//! ```text
//!   angle      ──► α, n about the time t − D ──► g·J·α + f·friction ─┐
//!   torque     ──► what was given at t − D ──────────────────────────┴─► − ─► cutting torque c
//!
//!      c ─► bins over depth ─► at the end: diagnosis, band
//!      c ─► sums above band and limit, below band ─► in the same period: alarm
//!
//!   α = (θ(t−D+w) − 2·θ(t−D) + θ(t−D−w))/w²      D the drive's delay and w; the torque is the mean
//!                                                with the same weights, (w − |i|)/w²
//! ```
//!
//! The torque of a spindle that reverses is twenty times that of an M6 in steel, so the spindle's
//! own must be known to some per cent, also where its drive is at its limit: its acceleration is
//! that of the encoder, over as long a span w as its counts ask for. By how much inertia, torque
//! constant and friction are not as the machine's file says is learnt above the work, in the same
//! stroke and in those before ([`sync::supervision::own`]). What is left of it, and half a period's
//! change of it, are added to each bound.
//!
//! Bands are kept for [`BANDS`] kinds of stroke; of more, the one longest unused makes room.
//! Source of the test: [`sync::supervision::detector`].
use crate::config::{OverloadReaction, SpindleControl, Subject, SupervisionControl, TorqueReading};
use crate::fault::FaultKind;
use crate::friction::spindle_friction;
use crate::supervised::{Crossing, Supervised, TorqueBound};
use alloc::vec::Vec;
use core::f64::consts::TAU;
use motion::TapPlan;
use sync::Phase;
use sync::supervision::band::{BandKey, StrokeBand};
use sync::supervision::depth::{DepthSums, StrokeWay, bin_of};
use sync::supervision::detector::Detector;
use sync::supervision::diagnosis::{Diagnosed, Diagnosis, diagnose, diagnose_alone, diagnose_gone};
use units::{Angle, Length, Spin, Time, Torque};

/// Kinds of stroke whose bands are kept at once.
pub const BANDS: usize = 16;
/// Longest delay of a drive's reading, in periods; a longer one cannot be supervised.
const MOST_DELAY: usize = 128;
/// Least and largest w, in periods.
const SPAN: (usize, usize) = (2, 32);
/// Readings that are looked back on.
const READINGS: usize = MOST_DELAY + 2 * SPAN.1 + 1;
/// Standard deviation of a second difference of readings that are rounded to counts: √(6/12).
const SECOND_DIFFERENCE: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// Share of the noise of the torque that the encoder's counts may add.
const COUNTS_SHARE: f64 = 0.5;
/// Share of what a tap takes, by which its cut is uneven: noise is taken to be this at least.
const UNEVEN_SHARE: f64 = 0.1;
/// Standard deviations of the spindle's inertia by which its torque may be off.
const GAIN_ERRORS: f64 = 3.0;
/// Share of its speed below which a spindle is about to turn back: there the torque of the cut
/// changes its sign, and what it was in other holes says little.
const TURNS_SHARE: f64 = 0.1;
/// Share of what the tap makers' formula expects, below which a hole was none.
const NOTHING_SHARE: f64 = 0.25;
/// Share of the noise of one reading, below which a mean over a hole says nothing.
const READ_SHARE: f64 = 0.3;
/// Share of what is expected of a bin, from which on something is cut there.
const CUTS_SHARE: f64 = 0.5;
/// Turns after the surface in which a tap cuts with its chamfer alone, at most.
const EARLY_TURNS: f64 = 5.0;

/// An alarm: kind, on what, value, limit.
type TorqueAlarm = (FaultKind, Subject, f64, f64);

/// What was read in one period.
#[derive(Clone, Copy, Debug)]
struct TorqueSample {
    /// Share of the depth; negative above the surface.
    share: f64,
    way: StrokeWay,
    /// rev.
    angle: f64,
    /// N·m.
    torque: f64,
}

/// How the spindle turned at one moment, and what its drive gave.
#[derive(Clone, Copy, Debug)]
struct TorqueMoment {
    share: f64,
    way: StrokeWay,
    /// Torque of the drive, N·m.
    torque: f64,
    /// Torque of acceleration, N·m.
    inertial: f64,
    /// Torque of friction, N·m.
    friction: f64,
    /// It turns fast enough for friction and cut to have their sign.
    turns: bool,
}

/// A stroke under way.
#[derive(Clone, Debug)]
struct WatchedStroke {
    spindle: u8,
    reading: TorqueReading,
    key: BandKey,
    limit: Option<f64>,
    expected: f64,
    lead: f64,
    period: Time,
    /// Readings, the newest before `next`, and how many there are.
    readings: [TorqueSample; READINGS],
    next: usize,
    count: usize,
    /// The drive's delay, w and D, in periods.
    delay: usize,
    span: usize,
    back: usize,
    /// Torque of acceleration over N·m per rev/s².
    inertia: f64,
    /// Noise of the cutting torque.
    noise: f64,
    inertial_before: f64,
    sums: DepthSums,
    detectors: [Detector; 3],
    crossing: Option<Crossing>,
    is_interrupted: bool,
    /// The stroke has shown the torque of a cut.
    has_cut: bool,
}

/// All bands, and the stroke under way, whose band stands last.
#[derive(Clone, Debug)]
pub(crate) struct Supervision {
    control: Option<SupervisionControl>,
    bands: Vec<StrokeBand>,
    watched: WatchedStroke,
    is_on: bool,
    is_to_retract: bool,
}

impl Supervision {
    /// With room for all that will ever be kept.
    pub(crate) fn new(control: Option<SupervisionControl>) -> Self {
        let room = if control.is_some() { BANDS } else { 0 };
        let watched = WatchedStroke {
            spindle: 0,
            reading: TorqueReading { delay: Time::ZERO, noise: Torque::ZERO },
            key: BandKey::default(),
            limit: None,
            expected: 0.0,
            lead: 1.0,
            period: Time::ZERO,
            readings: [TorqueSample { share: -1.0, way: StrokeWay::In, angle: 0.0, torque: 0.0 };
                READINGS],
            next: 0,
            count: 0,
            delay: 0,
            span: SPAN.0,
            back: SPAN.0,
            inertia: 0.0,
            noise: 0.0,
            inertial_before: 0.0,
            sums: DepthSums::NONE,
            detectors: [Detector::NEW; 3],
            crossing: None,
            is_interrupted: false,
            has_cut: false,
        };
        let bands = Vec::with_capacity(room);
        Self { control, bands, watched, is_on: false, is_to_retract: false }
    }

    /// What is known of good holes.
    pub(crate) fn bands(&self) -> &[StrokeBand] {
        &self.bands
    }

    /// What was known before; bands beyond the room are left out.
    pub(crate) fn recall(&mut self, bands: Vec<StrokeBand>) {
        if self.control.is_some() {
            self.bands.clear();
            self.bands.extend(bands.into_iter().take(BANDS));
        }
    }

    /// A tool is new: what was learnt of its predecessor is forgotten.
    pub(crate) fn forget(&mut self, tool: u32) {
        self.is_on &= self.watched.key.tool != tool;
        self.bands.retain(|band| band.key.tool != tool);
    }

    /// A tap that was stopped comes out along its thread, where overloads are to be answered so.
    pub(crate) fn ask_to_retract(&mut self) {
        let retracts = |control: SupervisionControl| control.reaction == OverloadReaction::Retract;
        self.is_to_retract = self.control.is_some_and(retracts);
    }

    /// A tap that was stopped is to come out.
    pub(crate) const fn is_to_retract(&self) -> bool {
        self.is_to_retract
    }

    /// It comes out now, or not any more.
    pub(crate) const fn forget_retract(&mut self) {
        self.is_to_retract = false;
    }

    /// A tap begins.
    pub(crate) fn begin(
        &mut self,
        tool: u32,
        plan: &TapPlan,
        (spindle, period): (&SpindleControl, Time),
    ) {
        self.is_on = false;
        let Some(control) = self.control else { return };
        let Some(reading) = control.readings.get(usize::from(plan.spindle)).copied().flatten()
        else {
            return;
        };
        let delay = libm::round(reading.delay.value() / period.value());
        if delay > MOST_DELAY as f64 {
            return;
        }
        let start = plan.start.along(plan.axis).of_linear();
        let key = BandKey {
            tool,
            lead: plan.lead,
            spin: plan.spin,
            return_spin: plan.return_spin,
            run_in: (plan.surface - start).abs(),
            depth: (plan.bottom - plan.surface).abs(),
        };
        self.take_band(key);
        let watched = &mut self.watched;
        (watched.reading, watched.key, watched.period) = (reading, key, period);
        watched.spindle = plan.spindle;
        watched.limit = plan.torque_limit.map(Torque::value);
        watched.expected = plan.torque_expected.value();
        watched.lead = plan.lead.value().abs();
        (watched.next, watched.count, watched.inertial_before) = (0, 0, 0.0);
        (watched.delay, watched.inertia) = (delay as usize, spindle.inertia.value() * TAU);
        watched.look_back(spindle.encoder_count.value());
        watched.sums = DepthSums::NONE;
        watched.detectors = [Detector::NEW; 3];
        (watched.crossing, watched.is_interrupted, watched.has_cut) = (None, false, false);
        (self.is_on, self.is_to_retract) = (key.depth > Length::ZERO, false);
        if let Some(band) = self.bands.last_mut() {
            band.own.fade();
        }
    }

    /// The band of a kind of stroke comes last.
    fn take_band(&mut self, key: BandKey) {
        match self.bands.iter().position(|band| band.key.is_like(&key)) {
            Some(index) => self.bands[index..].rotate_left(1),
            None if self.bands.len() < BANDS => self.bands.push(StrokeBand::new(key)),
            None => {
                self.bands.rotate_left(1);
                if let Some(band) = self.bands.last_mut() {
                    *band = StrokeBand::new(key);
                }
            }
        }
    }

    /// Something else than the torque stops the stroke on its way.
    pub(crate) const fn interrupt(&mut self) {
        self.watched.is_interrupted = true;
    }

    /// Takes this period's readings; an alarm where the torque leaves a bound. `at`: depth of the
    /// tip below the surface, and the spindle's angle.
    pub(crate) fn observe(
        &mut self,
        phase: Phase,
        at: (Length, Angle),
        spindle: &SpindleControl,
        measured: Option<Torque>,
    ) -> Option<(TorqueAlarm, Supervised)> {
        let control = self.control.filter(|_| self.is_on)?;
        let way = match phase {
            Phase::In | Phase::Bottom => StrokeWay::In,
            Phase::Out => StrokeWay::Out,
            Phase::Prepare | Phase::Done => return None,
        };
        let Some(torque) = measured.map(Torque::value).filter(|torque| torque.is_finite()) else {
            self.is_on = false; // silent: nothing is said of this stroke
            return None;
        };
        let (moment, slew) = self.watched.moment(way, at, torque, spindle)?;
        let TorqueMoment { share, way, inertial, friction, .. } = moment;
        let noise = self.watched.noise;
        let band = self.bands.last_mut()?;
        if share < 0.0 {
            band.own.add((inertial, friction), moment.torque, noise);
            return None;
        }
        let (gain, rubs) = band.own.factors();
        let own = gain * inertial + rubs * friction;
        let cut = (moment.torque - own) * self.watched.sense(way);
        self.watched.sums.add(way, share, cut);
        let reports = control.reaction == OverloadReaction::Report;
        if reports || self.watched.crossing.is_some() || self.watched.is_interrupted {
            return None;
        }
        let unsure = GAIN_ERRORS * band.own.gain_error() * inertial.abs() + slew;
        let band = Some(&*band).filter(|_| moment.turns);
        let crossing = self.watched.judge(band, control.share, (way, share, cut), unsure)?;
        self.watched.crossing = Some(crossing);
        let kind = match crossing.bound {
            TorqueBound::Limit | TorqueBound::Upper => FaultKind::TapOverload,
            TorqueBound::Lower => FaultKind::TapCutsNothing,
        };
        let of = Subject::Spindle(self.watched.spindle);
        let finding = (kind, of, crossing.torque.value(), crossing.limit.value());
        Some((finding, self.supervised(control.share)))
    }

    /// The stroke has ended: what it was, and what is learnt of it.
    pub(crate) fn finish(&mut self) -> Option<Supervised> {
        let control = self.control.filter(|_| self.is_on)?;
        self.is_on = false;
        if self.watched.crossing.is_some() {
            return None; // said
        }
        let supervised = self.supervised(control.share);
        let learns = supervised.diagnosed.is_good();
        let band = self.bands.last_mut()?;
        if learns {
            band.learn(&supervised.torque);
        }
        let slope = band.trend.slope().map(|slope| (slope.per_hole, slope.error));
        Some(Supervised { level: band.level, slope, ..supervised })
    }

    fn supervised(&self, share: f64) -> Supervised {
        let (watched, torque) = (&self.watched, self.watched.sums.means());
        let band = self.bands.last().copied().unwrap_or_default();
        let diagnosed = match watched.crossing {
            None if watched.is_interrupted => {
                Diagnosed { what: Diagnosis::Interrupted, is_sure: true }
            }
            Some(crossing) if crossing.bound == TorqueBound::Lower => {
                diagnose_gone(&torque, &band, crossing.depth / watched.key.depth)
            }
            Some(crossing) if !band.is_known() => {
                let early = crossing.depth.value() < EARLY_TURNS * watched.lead;
                diagnose_alone(&torque, early)
            }
            Some(_) | None => diagnose(&torque, &band, share, watched.least()),
        };
        Supervised {
            tool: watched.key.tool,
            depth: watched.key.depth,
            torque,
            diagnosed,
            crossing: watched.crossing,
            level: band.level,
            slope: band.trend.slope().map(|slope| (slope.per_hole, slope.error)),
        }
    }
}

impl WatchedStroke {
    /// Choose w, so that the encoder's counts add little to the noise of the torque, and D.
    fn look_back(&mut self, count: f64) {
        let noise = self.reading.noise.value().max(UNEVEN_SHARE * self.expected);
        let per_period =
            self.inertia * count * SECOND_DIFFERENCE / (self.period.value() * self.period.value());
        let of_counts = |span: usize| per_period / (span * span) as f64;
        let mut span = self.delay.clamp(SPAN.0, SPAN.1);
        while span < SPAN.1 && of_counts(span) > COUNTS_SHARE * noise {
            span += 1;
        }
        (self.span, self.back) = (span, span + self.delay);
        self.noise = libm::hypot(noise, of_counts(span));
    }

    /// Mean torque on the way in below which nothing is cut, or nothing that can be read.
    fn least(&self) -> f64 {
        (NOTHING_SHARE * self.expected).max(READ_SHARE * self.reading.noise.value())
    }

    /// Sense in which the spindle turns, +1 or −1.
    fn sense(&self, way: StrokeWay) -> f64 {
        let inward = libm::copysign(1.0, self.key.spin.value());
        if way == StrokeWay::In { inward } else { -inward }
    }

    /// The reading this many periods back.
    const fn ago(&self, periods: usize) -> &TorqueSample {
        &self.readings[(self.next + 2 * READINGS - 1 - periods) % READINGS]
    }

    /// Takes a reading; how the spindle turned at the moment that can be judged by now, and by how
    /// much its own torque may be off because its acceleration changes.
    fn moment(
        &mut self,
        way: StrokeWay,
        (depth, angle): (Length, Angle),
        torque: f64,
        spindle: &SpindleControl,
    ) -> Option<(TorqueMoment, f64)> {
        let share = depth / self.key.depth;
        self.readings[self.next] = TorqueSample { share, way, angle: angle.value(), torque };
        self.next = (self.next + 1) % READINGS;
        self.count = (self.count + 1).min(READINGS);
        if self.count <= self.back + self.span {
            return None;
        }
        let then = self.ago(self.back);
        let (before, after) =
            (self.ago(self.back + self.span).angle, self.ago(self.back - self.span).angle);
        let time = self.period.value() * self.span as f64;
        let spin = Spin::rev_per_s((after - before) / (2.0 * time));
        let moment = TorqueMoment {
            share: then.share,
            way: then.way,
            torque: self.mean_torque(),
            inertial: self.inertia * (after - 2.0 * then.angle + before) / (time * time),
            friction: spindle_friction(&spindle.friction, spin).value(),
            turns: spin.abs() > self.key.spin.abs() * TURNS_SHARE,
        };
        // the drive gives its torque within a period, and half of one may be missed
        let change = (moment.inertial - self.inertial_before).abs();
        self.inertial_before = moment.inertial;
        Some((moment, change / 2.0))
    }

    /// Torque about the moment that can be judged by now, weighted as a second difference weights
    /// the acceleration: (w − |i|)/w².
    fn mean_torque(&self) -> f64 {
        let (span, newest) = (self.span, self.back - self.delay);
        let weighted = (1..2 * span).map(|i| {
            let weight = i.min(2 * span - i) as f64;
            weight * self.ago(newest + span - i).torque
        });
        weighted.sum::<f64>() / (span * span) as f64
    }

    /// The bin before this one has shown what a cut takes, where half of it was to be seen.
    fn cut_before(&self, band: &StrokeBand, way: StrokeWay, bin: usize) -> bool {
        let before = bin.checked_sub(1).filter(|_| way == StrokeWay::In);
        before.is_some_and(|before| {
            let expected = band.expected(StrokeWay::In, before);
            let shows = expected >= CUTS_SHARE * band.level * band.plateau();
            shows && self.sums.mean(StrokeWay::In, before) >= Some(CUTS_SHARE * expected)
        })
    }

    /// The bound that this reading leaves; `unsure`: by how much the spindle's own torque may be
    /// off.
    fn judge(
        &mut self,
        band: Option<&StrokeBand>,
        share_off: f64,
        (way, share, cut): (StrokeWay, f64, f64),
        unsure: f64,
    ) -> Option<Crossing> {
        let noise = self.noise;
        let bin = bin_of(share);
        let limit = self.limit.map(|limit| {
            let bound = limit + unsure;
            (TorqueBound::Limit, bound, bound - self.expected.min(limit / 2.0))
        });
        let upper = band.filter(|band| band.is_known()).map(|band| {
            let (bound, distance) = band.upper(way, bin, share_off);
            (TorqueBound::Upper, bound + unsure, distance)
        });
        self.has_cut |= band.is_some_and(|band| self.cut_before(band, way, bin));
        // one that has cut nothing from the first thread on is said when the hole is done
        let goes_in = way == StrokeWay::In && self.has_cut;
        let lower = band.filter(|band| goes_in && band.has_lower()).and_then(|band| {
            let (bound, distance) = band.lower(bin)?;
            Some((TorqueBound::Lower, bound - unsure, distance))
        });
        let detectors = &mut self.detectors;
        for (detector, bounds) in detectors.iter_mut().zip([limit, upper, lower]) {
            let Some((bound, value, distance)) = bounds else {
                detector.reset();
                continue;
            };
            let excess = if bound == TorqueBound::Lower { value - cut } else { cut - value };
            if detector.exceeds(excess, distance, noise) {
                let mean =
                    if bound == TorqueBound::Lower { -detector.mean() } else { detector.mean() };
                return Some(Crossing {
                    bound,
                    torque: Torque::n_m(value + mean),
                    limit: Torque::n_m(value),
                    depth: self.key.depth * share,
                    took: self.period * f64::from(detector.readings().saturating_sub(1)),
                });
            }
        }
        None
    }
}
