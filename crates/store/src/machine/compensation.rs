//! Compensation in a machine file: `[axes.x.compensation]`, `[spindles.encoder]`.
//!
//! A deviation is that of ISO 230-2, where the slide is less where its encoder puts it: at 100 mm
//! the slide is 12 µm too far, at 100.012 mm, so `up_um = 12`. Positions are machine coordinates.
//!
//! ```text
//!   share of speed          s = |ε′|                       e = v²·|ε″| / a + |ε′|: share of acceleration
//!   v, a: rapid speed and acceleration of the axis         both: 5 % at most; 4 % where it turns back by more than 0
//! ```
use super::axis::{Axis, PositionFrom};
use super::axis_drive::Motor;
use super::deviations::{StatedDeviations, TakesUpPlay};
use crate::keys::Keys;
use std::fmt::Write as _;
use sync::{Deviation, DeviationPoint, DeviationTable, DeviationWave};
use units::{Angle, AxisKind, Coordinate, CoordinateAccel, CoordinateSpeed};

/// Share of an axis' speed and acceleration that compensation may take.
pub const COMPENSATION_SHARE: f64 = 0.05;
/// Part of that share that is left for turning back.
const REVERSAL_SHARE: f64 = 0.01;
/// Most points of a table.
pub const COMPENSATION_POINTS: usize = 512;
/// Most errors per turn.
const MOST_WAVES: usize = 16;
/// Highest order of an error per turn.
const HIGHEST_ORDER: u32 = 1000;
/// Largest deviation: 10 mm, or 10°.
const FARTHEST: f64 = 10.0;
/// Degrees after which the points of a rotary axis repeat.
const TURN_DEG: f64 = 360.0;

/// Units in which the file has one kind of axis.
struct Units {
    kind: AxisKind,
    at: &'static str,
    up: &'static str,
    down: &'static str,
    size: &'static str,
    backlash: &'static str,
    turns_after: &'static str,
    /// Of what is small, in a unit of the axis.
    per_unit: f64,
}

const LINEAR: Units = Units {
    kind: AxisKind::Linear,
    at: "at_mm",
    up: "up_um",
    down: "down_um",
    size: "um",
    backlash: "backlash_um",
    turns_after: "turns_after_um",
    per_unit: 1e3,
};
const ROTARY: Units = Units {
    kind: AxisKind::Rotary,
    at: "at_deg",
    up: "up_arcsec",
    down: "down_arcsec",
    size: "arcsec",
    backlash: "backlash_arcsec",
    turns_after: "turns_after_arcsec",
    per_unit: 3600.0,
};

impl Units {
    const fn of(kind: AxisKind) -> &'static Self {
        match kind {
            AxisKind::Linear => &LINEAR,
            AxisKind::Rotary => &ROTARY,
        }
    }

    /// A small size as the file has it.
    fn small(&self, size: f64) -> String {
        let unit = if self.size == "um" { "µm" } else { "″" };
        let size = size * self.per_unit;
        format!("{} {unit}", (size * 100.0).round() / 100.0)
    }

    fn point(&self, keys: &mut Keys<'_>) -> DeviationPoint {
        let farthest = FARTHEST * self.per_unit;
        let far = match self.kind {
            AxisKind::Linear => super::axis::FARTHEST_MM,
            AxisKind::Rotary => TURN_DEG,
        };
        let at = keys.number(self.at, -far..=far);
        let up = keys.number(self.up, -farthest..=farthest) / self.per_unit;
        let down = keys.optional(self.down, -farthest..=farthest);
        DeviationPoint { at, up, down: down.map_or(up, |down| down / self.per_unit) }
    }
}

/// `{ order, um, phase_deg }`, the size in units of the axis.
fn wave(keys: &mut Keys<'_>, size: &'static str, per_unit: f64) -> DeviationWave {
    let order = keys.whole("order", 1..=HIGHEST_ORDER);
    let amplitude = keys.number(size, 0.0..=FARTHEST * per_unit) / per_unit;
    let phase = Angle::deg(keys.optional("phase_deg", -360.0..=360.0).unwrap_or(0.0));
    DeviationWave { order, amplitude, phase_rev: phase.value() }
}

impl StatedDeviations {
    /// `[axes.x.compensation]`.
    pub(super) fn read(axis: &Axis, keys: &mut Keys<'_>) -> Self {
        let units = Units::of(axis.letter.kind());
        let points = keys.optional_sections("table", COMPENSATION_POINTS, |k| units.point(k));
        let waves =
            keys.optional_sections("per_turn", MOST_WAVES, |k| wave(k, units.size, units.per_unit));
        let backlash =
            keys.optional(units.backlash, 0.0..=10.0 * units.per_unit).map(|b| b / units.per_unit);
        let kinds = [("control", TakesUpPlay::Control), ("drive", TakesUpPlay::Drive)];
        let stated = keys.optional_choice("backlash", &kinds);
        let turn = match axis.drive.motor {
            Motor::BallScrew { lead, .. } => lead.value(),
            Motor::Linear { .. } => 0.0,
        };
        let table = DeviationTable {
            points,
            repeats: (units.kind == AxisKind::Rotary).then_some(TURN_DEG),
            waves,
            turn,
            backlash: backlash.unwrap_or(0.0),
        };
        let takes_up = backlash.map(|_| stated.unwrap_or(TakesUpPlay::Control));
        let friction = &axis.friction;
        let gives = friction.coulomb.value() / friction.bristle_stiffness.value();
        let turns_after = keys.optional(units.turns_after, 0.0..=units.per_unit);
        let turns_after = turns_after.map_or(gives, |way| way / units.per_unit);
        let turns_after = Coordinate::new(turns_after);
        let mut read = Self { table, takes_up, reversal: axis.reach(), turns_after };
        if stated.is_some() && backlash.is_none() {
            keys.conflict(
                "backlash",
                format!(
                    "`backlash` says who takes the play up: expected `{}` as well",
                    units.backlash
                ),
            );
        }
        if turn <= 0.0 && !read.table.waves.is_empty() {
            keys.conflict(
                "per_turn",
                "a linear motor has no turns: expected `table` with points close to one another",
            );
        }
        if read.check_points(axis, units, keys) && turn > 0.0 {
            read.check_share(axis, units, keys);
        }
        read.leave_for_reversal(axis);
        read
    }

    /// What the control takes off: without the play that the drive takes up.
    pub fn of_control(&self) -> DeviationTable {
        let of_drive = self.takes_up == Some(TakesUpPlay::Drive);
        let backlash = if of_drive { 0.0 } else { self.table.backlash };
        DeviationTable { backlash, ..self.table.clone() }
    }

    /// True where no motor's encoder is: it says nothing that a scale at the table does not see.
    pub fn is_of_motor(&self) -> bool {
        self.takes_up.is_some() || !self.table.waves.is_empty()
    }

    /// Whether the points can be a table; what is wrong is said.
    fn check_points(&self, axis: &Axis, units: &Units, keys: &Keys<'_>) -> bool {
        let (unit, letter, mut fine) = (units.kind.unit(), axis.letter.letter(), true);
        let points = &self.table.points;
        if points.len() == 1 {
            fine = false;
            keys.conflict("table", "`table` has one row: expected two at least");
        }
        for (index, point) in points.iter().enumerate() {
            let (row, at) = (index + 1, point.at);
            if let Some(before) = index.checked_sub(1).map(|before| points[before].at)
                && at <= before
            {
                fine = false;
                keys.conflict(
                    "table",
                    format!("`table` row {row} is at {at}{unit}: expected more than {before}{unit}, where the row before it is"),
                );
            }
            let travel = &axis.travel;
            if units.kind == AxisKind::Linear && !travel.contains(Coordinate::new(at)) {
                fine = false;
                let (from, to) = (travel.from.value(), travel.to.value());
                keys.conflict(
                    "table",
                    format!("`table` row {row} is at {at}{unit}: expected {from} to {to}{unit}, the travel of {letter}"),
                );
            }
        }
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return fine };
        if units.kind == AxisKind::Rotary {
            let turn = last.at - first.at;
            let closes = (first.up, first.down) == (last.up, last.down);
            if turn > TURN_DEG || turn >= TURN_DEG && !closes {
                fine = false;
                keys.conflict(
                    "table",
                    format!("`table` of {letter} repeats after a turn, and its rows span {turn}°: expected less than 360, or a last row equal to the first"),
                );
            }
        }
        fine
    }

    /// Shares of speed and of acceleration that a curve takes.
    fn shares(axis: &Axis, (slope, curvature): (f64, f64)) -> (f64, f64) {
        let (speed, accel) = axis.reach();
        let (v, a) = (speed.value(), accel.value());
        (slope, v * v * curvature / a + slope)
    }

    /// What points and waves take of speed and acceleration, at most.
    fn share(&self, axis: &Axis) -> (f64, f64) {
        let curve = Deviation::new(&self.table);
        let points = Self::shares(axis, curve.bounds_of_points());
        let waves = Self::shares(axis, curve.bounds_of_waves());
        (points.0 + waves.0, points.1 + waves.1)
    }

    fn turns_back(&self) -> bool {
        Deviation::new(&self.of_control()).reversal() > 0.0
    }

    /// Whether it takes no more than its share; what is wrong is said, with what would do.
    fn check_share(&self, axis: &Axis, units: &Units, keys: &Keys<'_>) {
        let curve = Deviation::new(&self.table);
        let points = Self::shares(axis, curve.bounds_of_points());
        let waves = Self::shares(axis, curve.bounds_of_waves());
        let left = if self.turns_back() { REVERSAL_SHARE } else { 0.0 };
        let most = COMPENSATION_SHARE - left;
        let (speed, accel) = axis.reach();
        let of = |points: f64, waves: f64, what: &str| {
            if points + waves <= most {
                return;
            }
            let factor = most / (points + waves);
            let key = if waves > points { "per_turn" } else { "table" };
            let mut text = format!(
                "`{key}` of {}: its corrections take {:.1} % of {what}: expected {:.0} % at most; {} times these values would do",
                axis.letter.letter(),
                100.0 * (points + waves),
                100.0 * most,
                three_digits(factor)
            );
            if let ([wave], true) = (self.table.waves.as_slice(), waves > points) {
                let works = (wave.amplitude * factor * units.per_unit * 100.0).floor() / 100.0;
                let _ = write!(text, ", {} of it", units.small(works / units.per_unit));
            }
            keys.conflict(key, text);
        };
        let unit = units.kind.unit();
        of(points.0, waves.0, &format!("its speed of {:.0}{unit}/min", speed.value() * 60.0));
        of(points.1, waves.1, &format!("its acceleration of {:.0}{unit}/s²", accel.value()));
    }

    /// A change of flank takes what points and waves leave of the share.
    fn leave_for_reversal(&mut self, axis: &Axis) {
        let (of_speed, of_accel) = self.share(axis);
        let left = |taken: f64| (COMPENSATION_SHARE - taken).max(REVERSAL_SHARE);
        let (speed, accel) = axis.reach();
        let accel = accel.value() * left(of_accel);
        let accel = Deviation::new(&self.of_control()).reversal_acceleration(accel, speed.value());
        self.reversal = (speed * left(of_speed), CoordinateAccel::new(accel));
    }
}

impl Axis {
    /// Fastest speed and largest acceleration; where that is not stated, what the drive gives.
    fn reach(&self) -> (CoordinateSpeed, CoordinateAccel) {
        let mass = self.moving_mass + self.drive.motor_mass();
        let given = self.drive.peak_force().value() / (mass.value() * 1e-3).max(f64::MIN_POSITIVE);
        let accel = self.acceleration.value().min(given);
        (self.rapid.max(self.feed_most), CoordinateAccel::new(accel))
    }

    /// The axis with what its file says of compensation, which has to do with all the rest of it.
    pub(super) fn with_compensation(self, keys: &mut Keys<'_>) -> Self {
        let compensation =
            keys.optional_section("compensation", |k| StatedDeviations::read(&self, k));
        Self { compensation, ..self }
    }

    /// A scale at the table sees play and screw: there is nothing of them to be taken off.
    pub(super) fn compensates_unseen(&self) -> Option<String> {
        let stated = self.compensation.as_ref().filter(|stated| stated.is_of_motor())?;
        matches!(self.position_from, PositionFrom::Scale { .. }).then(|| {
            let key = if stated.takes_up.is_some() { "backlash" } else { "per_turn" };
            format!(
                "`{key}` of {}'s compensation: its scale sees play and screw already: expected `table` alone, or `position_from = \"motor\"`",
                self.letter.letter()
            )
        })
    }
}

/// A number below one with three digits, rounded down.
fn three_digits(factor: f64) -> String {
    let places = (2 - factor.log10().floor() as i32).clamp(3, 12);
    let scale = 10_f64.powi(places);
    format!("{}", (factor * scale).floor() / scale)
}

/// Errors per turn of a spindle's encoder, rev: `[spindles.encoder]`.
pub(super) fn spindle_encoder(keys: &mut Keys<'_>) -> DeviationTable {
    let waves =
        keys.optional_sections("per_turn", MOST_WAVES, |k| wave(k, "arcsec", ROTARY.per_unit));
    // the sizes were read as degrees
    let waves = waves.into_iter().map(|w| DeviationWave { amplitude: w.amplitude / 360.0, ..w });
    let table = DeviationTable { waves: waves.collect(), turn: 1.0, ..DeviationTable::default() };
    let (slope, _) = Deviation::new(&table).bounds_of_waves();
    if slope > COMPENSATION_SHARE {
        let factor = (1000.0 * COMPENSATION_SHARE / slope).floor() / 1000.0;
        keys.conflict(
            "per_turn",
            format!(
                "`per_turn` of the encoder changes the speed by {:.1} %: expected 5 % at most; {factor} times these values would do",
                100.0 * slope
            ),
        );
    }
    table
}

#[cfg(test)]
#[path = "compensation_tests.rs"]
mod tests;
