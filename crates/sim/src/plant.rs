//! A machine as it was built, beside what its file says of it: nothing is as it was specified, and
//! that is not told.
//!
//! ```text
//!   model + scatter, by the seed ──► plant          motor ─► screw ─────────────► table
//!                                                   │ xm     n = xm + s·Δ + a·sin  │ xt
//!        zero of all errors: where the work         ▼                              ▼
//!        was touched off with this machine          encoder: r = xm + e·sin        scale: r = xt − g·(xt − x₀)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | xm, xt | motor and screw, on the table's scale; table | mm |
//! | x₀, Δ | where the errors are zero; xm − x₀ | mm |
//! | s, a | cumulative lead error of the screw; its amplitude once per revolution | 1, mm |
//! | e | amplitude of the motor encoder's error once per revolution, from a disk off its centre | rev |
//! | g | error of the linear scale | 1 |
//!
//! Play, stiffness and friction are what the model says times a factor. What is stated as an error
//! is not drawn.
//!
//! Sources: ISO 3408-3 (ball screws: V300p and v2πp), ISO 230-2 (positioning errors), encoder
//! makers' application notes for the eccentricity: 2·(eccentricity)/(diameter of the graduation) in
//! radians.
use crate::encoder::quantise;
use crate::rng::Rng;
use crate::scatter::Draws;
use crate::{AxisEncoder, AxisModel, Config, SpindleModel};
use core::f64::consts::TAU;
use units::{Angle, Coordinate, Force, Spread, Time};

/// The stream of a plant is another one than that of the process.
const OF_PLANT: u64 = 0x504C_414E_5453_4545;

/// How far a real axis may be from its model, to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisScatter {
    /// Play, as a share: 0.2 is ±20 %.
    pub backlash: Spread,
    /// Stiffness, as a share.
    pub stiffness: Spread,
    /// Friction, as a share.
    pub friction: Spread,
    /// Cumulative lead error of the screw: 20 µm a metre is 2·10⁻⁵.
    pub lead_error: Spread,
    /// Amplitude of the screw's error once per revolution, mm or degrees.
    pub wobble: Spread,
    /// Amplitude of the motor encoder's error once per revolution, rev.
    pub eccentricity: Spread,
    /// Error of the linear scale.
    pub scale_error: Spread,
    /// Growth of the warm screw, as a share.
    pub growth: Spread,
}

/// How a screw grows while it gets warm: by s·(1 − e^(−(r + t)/T)) of the distance from its fixed
/// bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScrewGrowth {
    /// s: of a screw that has become as warm as it will, length over length.
    pub warm: f64,
    /// T.
    pub time_constant: Time,
    /// r: for so long it has run already since the work was touched off.
    pub running: Time,
    /// Where the fixed bearing is, along the axis.
    pub bearing: Coordinate,
}

impl ScrewGrowth {
    /// How much farther than its turns say it reaches, t after the start, length over length.
    fn at(&self, time_s: f64) -> f64 {
        -self.warm * (-(self.running.value() + time_s) / self.time_constant.value()).exp_m1()
    }
}

/// How far a real spindle may be from its model, to either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleScatter {
    /// Friction, as a share.
    pub friction: Spread,
    /// Amplitude of the encoder's error once per revolution, rev.
    pub eccentricity: Spread,
}

/// What is wrong with a real axis. [`None`] in a model: drawn within its scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisErrors {
    /// Cumulative lead error of the screw: so much farther than its turns say.
    pub lead: Option<f64>,
    /// Amplitude of the screw's error once per revolution, and its phase.
    pub wobble: Option<(Coordinate, Angle)>,
    /// Amplitude of the motor encoder's error once per revolution, and its phase.
    pub eccentricity: Option<(Angle, Angle)>,
    /// Error of the linear scale: the axis moves so much farther than it reads.
    pub scale: Option<f64>,
    /// Where all of them are zero.
    pub zero: Coordinate,
}

impl AxisScatter {
    /// As its model says.
    pub const NONE: Self = Self {
        backlash: Spread::NONE,
        stiffness: Spread::NONE,
        friction: Spread::NONE,
        lead_error: Spread::NONE,
        wobble: Spread::NONE,
        eccentricity: Spread::NONE,
        scale_error: Spread::NONE,
        growth: Spread::NONE,
    };

    /// Everything that is wrong with it.
    pub(crate) fn problem(&self) -> Option<String> {
        let shares = [self.backlash, self.stiffness, self.friction, self.growth];
        let rates = [self.lead_error, self.scale_error];
        let sizes = [self.wobble, self.eccentricity];
        let fine = shares.into_iter().all(|x| (0.0..0.9).contains(&x.most()))
            && rates.into_iter().all(|x| (0.0..0.1).contains(&x.most()))
            && sizes.into_iter().all(|x| x.by >= 0.0 && x.by.is_finite());
        (!fine).then(|| {
            "shares from 0 to below 0.9, errors of lead and scale from 0 to below 0.1 and amplitudes of 0 or more are needed".into()
        })
    }
}

impl SpindleScatter {
    /// As its model says.
    pub const NONE: Self = Self { friction: Spread::NONE, eccentricity: Spread::NONE };
}

impl AxisErrors {
    /// Nothing stated: all is drawn.
    pub const DRAWN: Self =
        Self { lead: None, wobble: None, eccentricity: None, scale: None, zero: Coordinate::ZERO };
}

impl AxisModel {
    /// The axis as it was built: every error stated, nothing left to draw.
    fn drawn(&self, draws: &mut Draws) -> Self {
        let scatter = &self.scatter;
        let mut axis = *self;
        axis.backlash = self.backlash * draws.factor(&scatter.backlash);
        axis.stiffness = self.stiffness * draws.factor(&scatter.stiffness);
        let scale = draws.factor(&scatter.friction);
        axis.friction.coulomb = self.friction.coulomb * scale;
        axis.friction.breakaway = self.friction.breakaway * scale;
        axis.friction.viscous_n_s_per_m *= scale;
        let lead = draws.signed(&scatter.lead_error);
        let wobble = Coordinate::new(draws.amplitude(&scatter.wobble));
        let waves = (wobble, Angle::rev(draws.unit()));
        let disk = Angle::rev(draws.amplitude(&scatter.eccentricity));
        let disk = (disk, Angle::rev(draws.unit()));
        let scale = draws.signed(&scatter.scale_error);
        let stated = self.errors;
        axis.errors = AxisErrors {
            lead: stated.lead.or(Some(lead)),
            wobble: stated.wobble.or(Some(waves)),
            eccentricity: stated.eccentricity.or(Some(disk)),
            scale: stated.scale.or(Some(scale)),
            zero: stated.zero,
        };
        let warmer = draws.factor(&scatter.growth);
        axis.growth =
            self.growth.map(|growth| ScrewGrowth { warm: growth.warm * warmer, ..growth });
        axis.scatter = AxisScatter::NONE;
        axis
    }

    /// By how much the motor stands ahead of a table that hangs on its screw, mm.
    pub(crate) fn hang_mm(&self) -> f64 {
        let weight = self.weight().value();
        if weight == 0.0 {
            return 0.0;
        }
        -weight / self.stiffness.value() - weight.signum() * self.backlash.value() / 2.0
    }

    /// What its weight pulls with.
    pub(crate) fn weight(&self) -> Force {
        Force::n(-self.table.value() * crate::axis::GRAVITY * self.weight_share)
    }
}

impl SpindleModel {
    fn drawn(&self, draws: &mut Draws) -> Self {
        let mut spindle = *self;
        let scale = draws.factor(&self.scatter.friction);
        spindle.coulomb = self.coulomb * scale;
        spindle.viscous_n_m_s_per_rad *= scale;
        let disk = Angle::rev(draws.amplitude(&self.scatter.eccentricity));
        let disk = (disk, Angle::rev(draws.unit()));
        if self.scatter.eccentricity.by != 0.0 && self.encoder.eccentricity == Angle::ZERO {
            (spindle.encoder.eccentricity, spindle.encoder.eccentric_at) = disk;
        }
        spindle.scatter = SpindleScatter::NONE;
        spindle
    }
}

impl Config {
    /// Axes and spindles as they were built: drawn from the seed, each from a stream of its own.
    pub fn plant(&self) -> (Vec<(usize, AxisModel)>, Vec<SpindleModel>) {
        let mut rng = Rng::new(self.seed ^ OF_PLANT);
        let mut stream = || Draws::new(rng.branch(), self.part);
        let mut streams: Vec<Draws> = (0..bus::AXES).map(|_| stream()).collect();
        let axes =
            self.axes.iter().map(|(index, model)| (*index, model.drawn(&mut streams[*index])));
        let axes = axes.collect();
        let spindles = self.spindles.iter().map(|model| model.drawn(&mut stream())).collect();
        (axes, spindles)
    }
}

/// An error that comes once per revolution: a·(sin(2πx/lead + φ) − sin(2πx₀/lead + φ)), which is 0
/// at x₀, where all errors are. Metres.
#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    phase: f64,
    per_m: f64,
    /// Its sine at x₀.
    at_zero: f64,
}

impl Wave {
    fn new(amplitude: f64, phase: Angle, per_m: f64, zero: f64) -> Self {
        let phase = phase.in_rad();
        Self { amplitude, phase, per_m, at_zero: (zero * per_m + phase).sin() }
    }

    fn at(&self, motor: f64) -> f64 {
        if self.amplitude == 0.0 {
            return 0.0;
        }
        self.amplitude * ((motor * self.per_m + self.phase).sin() - self.at_zero)
    }

    /// Its derivative.
    fn slope(&self, motor: f64) -> f64 {
        if self.amplitude == 0.0 {
            return 0.0;
        }
        self.amplitude * self.per_m * (motor * self.per_m + self.phase).cos()
    }
}

/// A screw and its encoders, made ready. Metres.
#[derive(Clone, Debug)]
pub(crate) struct Transmission {
    encoder: AxisEncoder,
    lead_mm: f64,
    lead: f64,
    wobble: Wave,
    eccentricity: Wave,
    scale: f64,
    zero: f64,
    growth: Option<ScrewGrowth>,
    /// How far the screw has grown in this period, length over length.
    grown: f64,
    /// Since the start, s, and a period's time.
    time: f64,
    period: f64,
    /// The nut at `ratio`·xm + `offset`, within a period.
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
    /// What the zero was set by, less what the table hangs by: the work was touched off.
    touched_off: f64,
}

impl Transmission {
    /// Of an axis as it was built; `believed` is its model.
    pub(crate) fn new(axis: &AxisModel, believed: &AxisModel, period: f64) -> Self {
        let errors = axis.errors;
        let lead_mm = axis.screw_lead.value();
        let (per_m, zero) = (TAU / (lead_mm * 1e-3), errors.zero.value() * 1e-3);
        let wave = |amplitude: f64, phase: Angle| Wave::new(amplitude, phase, per_m, zero);
        let (wobble, wobble_at) = errors.wobble.unwrap_or_default();
        let (disk, disk_at) = errors.eccentricity.unwrap_or_default();
        let mut made = Self {
            encoder: axis.encoder,
            lead_mm,
            lead: errors.lead.unwrap_or(0.0),
            wobble: wave(wobble.value() * 1e-3, wobble_at),
            eccentricity: wave(disk.value() * lead_mm * 1e-3, disk_at),
            scale: errors.scale.unwrap_or(0.0),
            zero,
            growth: axis.growth,
            grown: 0.0,
            time: 0.0,
            period,
            ratio: 1.0,
            offset: 0.0,
            touched_off: (axis.hang_mm() - believed.hang_mm()) * 1e-3,
        };
        made.straighten(made.zero);
        made
    }

    /// Where the nut stands.
    pub(crate) fn nut(&self, motor: f64) -> f64 {
        let straight = motor + self.lead * (motor - self.zero) + self.wobble.at(motor);
        match self.growth {
            Some(growth) => straight + self.grown * (motor - growth.bearing.value() * 1e-3),
            None => straight,
        }
    }

    /// A period passes.
    pub(crate) fn begin_period(&mut self, motor: f64) {
        self.straighten(motor);
        self.time += self.period;
    }

    /// The screw's error is a straight line for the coming period, its growth a constant.
    fn straighten(&mut self, motor: f64) {
        self.grown = self.growth.map_or(0.0, |growth| growth.at(self.time));
        self.ratio = 1.0 + self.lead + self.wobble.slope(motor) + self.grown;
        self.offset = self.nut(motor) - self.ratio * motor;
    }

    /// Where the encoder that the position is taken from stands, between its counts, and one count,
    /// mm.
    pub(crate) fn seen(&self, motor: f64, table: f64) -> (f64, f64) {
        match self.encoder {
            AxisEncoder::Motor { counts_per_rev } => {
                (self.disk_mm(motor), self.lead_mm / f64::from(counts_per_rev))
            }
            AxisEncoder::Scale { resolution, .. } => {
                let read = table - self.scale * (table - self.zero);
                (read * 1e3, resolution.value())
            }
        }
    }

    /// What the encoder on the motor says, where the position is taken from a scale.
    pub(crate) fn beside(&self, motor: f64) -> Option<Coordinate> {
        let AxisEncoder::Scale { motor_counts_per_rev, .. } = self.encoder else { return None };
        let count = self.lead_mm / f64::from(motor_counts_per_rev?);
        Some(Coordinate::new(quantise(self.disk_mm(motor), count)))
    }

    /// Where the disk of the motor's encoder stands.
    fn disk_mm(&self, motor: f64) -> f64 {
        (motor - self.touched_off + self.eccentricity.at(motor)) * 1e3
    }

    /// Motor and table at a place that the encoder calls `start`, the motor ahead by `hang`.
    pub(crate) fn at(&self, start: f64, hang: f64) -> (f64, f64) {
        match self.encoder {
            AxisEncoder::Motor { counts_per_rev } => {
                // within a count, so that the count is the one of the start
                let within = 0.25 * self.lead_mm * 1e-3 / f64::from(counts_per_rev);
                let motor = start + hang - self.eccentricity.at(start + hang);
                let errs = self.eccentricity.amplitude != 0.0;
                (if errs { motor + within } else { start + hang }, self.nut(motor - hang))
            }
            AxisEncoder::Scale { .. } => {
                let table = self.zero + (start - self.zero) / (1.0 - self.scale);
                (table - (self.nut(table) - table) + hang, table)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{tapping_center, z_axis};

    fn scatter() -> AxisScatter {
        AxisScatter {
            backlash: Spread::uniform(0.2),
            stiffness: Spread::uniform(0.15),
            friction: Spread::uniform(0.2),
            lead_error: Spread::uniform(2e-5),
            wobble: Spread::uniform(3e-3),
            eccentricity: Spread::uniform(2e-5),
            scale_error: Spread::uniform(5e-6),
            growth: Spread::uniform(0.3),
        }
    }

    fn config(seed: u64) -> Config {
        let mut config = Config { seed, ..tapping_center() };
        for (_, axis) in &mut config.axes {
            axis.scatter = scatter();
        }
        config
    }

    #[test]
    fn a_plant_is_drawn_within_its_scatter_and_fills_it() {
        let model = z_axis();
        let mut most = [0.0_f64; 6];
        for seed in 0..200 {
            let (axes, _) = config(seed).plant();
            let z = axes[2].1;
            let of = |value: f64, nominal: f64| value / nominal - 1.0;
            let errors = z.errors;
            let found = [
                of(z.backlash.value(), model.backlash.value()) / 0.2,
                of(z.stiffness.value(), model.stiffness.value()) / 0.15,
                of(z.friction.coulomb.value(), model.friction.coulomb.value()) / 0.2,
                errors.lead.unwrap_or(0.0) / 2e-5,
                errors.wobble.unwrap_or_default().0.of_linear().in_um() / 3.0,
                errors.scale.unwrap_or(0.0) / 5e-6,
            ];
            for (most, found) in most.iter_mut().zip(found) {
                assert!(found.abs() <= 1.0 + 1e-9, "seed {seed}: {found}");
                *most = most.max(found.abs());
            }
        }
        assert!(most.iter().all(|share| *share > 0.9), "{most:?}");
    }

    #[test]
    fn an_axis_keeps_its_errors_when_another_one_is_added() {
        let whole = config(7).plant().0;
        let mut less = config(7);
        less.axes.remove(0);
        assert_eq!(less.plant().0[1], whole[2]);
    }

    #[test]
    fn what_is_stated_is_not_drawn() {
        let mut config = config(3);
        config.axes[2].1.errors.lead = Some(5e-5);
        assert_eq!(config.plant().0[2].1.errors.lead, Some(5e-5));
    }

    #[test]
    fn a_screw_errs_by_its_lead_and_once_per_revolution_and_not_at_all_where_the_work_was_touched_off()
     {
        let mut axis = z_axis();
        axis.errors = AxisErrors {
            lead: Some(3e-5),
            wobble: Some((Coordinate::new(2e-3), Angle::ZERO)),
            eccentricity: None,
            scale: None,
            zero: Coordinate::new(-320.0), // 20 revolutions
        };
        let screw = Transmission::new(&axis, &z_axis(), 250e-6);
        for (mm, um) in
            [(-320.0, 0.0), (-20.0, 9.0 + 2.0 * (-TAU * 1.25).sin()), (-316.0, 0.12 + 2.0)]
        {
            let error = (screw.nut(mm * 1e-3) - mm * 1e-3) * 1e6;
            assert!((error - um).abs() < 1e-6, "{mm} mm: {error} µm, expected {um}");
        }
    }

    #[test]
    fn a_warm_screw_is_longer_by_a_first_order_lag_from_its_fixed_bearing() {
        let mut axis = z_axis();
        axis.errors = AxisErrors { lead: Some(0.0), scale: Some(0.0), ..AxisErrors::DRAWN };
        let minutes = |n: f64| Time::s(n * 60.0);
        axis.growth = Some(ScrewGrowth {
            warm: 50e-6,
            time_constant: minutes(40.0),
            running: minutes(20.0),
            bearing: Coordinate::new(-10.0),
        });
        let mut screw = Transmission::new(&axis, &z_axis(), 0.1);
        for _ in 0..6000 {
            screw.begin_period(-0.3);
        }
        // the last period began 599.9 s after the start, 1799.9 s after the work was touched off
        let grown = 50.0 * (1.0 - (-1799.9_f64 / 2400.0).exp());
        let found = (screw.nut(-0.3) + 0.3) * 1e6;
        assert!((found + grown * 0.29).abs() < 1e-6, "{found} µm, expected {}", -grown * 0.29);
        let line = (screw.ratio * -0.3 + screw.offset - screw.nut(-0.3)).abs();
        assert!(line < 1e-15, "{line} m");
    }

    #[test]
    fn a_part_has_its_own_friction_where_that_is_declared_and_the_machine_its_play() {
        let of = |part| {
            let mut config = Config { part, ..config(11) };
            config.axes[2].1.scatter.friction.per = units::Per::Part;
            config.plant().0[2].1
        };
        let (first, second) = (of(1), of(2));
        assert_eq!(first, config(11).plant().0[2].1, "the first part is the machine's own draw");
        assert_eq!(first.backlash, second.backlash);
        assert!(first.friction.coulomb != second.friction.coulomb);
        assert_eq!(of(2), second);
    }
}
