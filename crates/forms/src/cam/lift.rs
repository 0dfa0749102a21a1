//! The lift table, checked and made a smooth function.
use super::error::{CamError, Problem};
use sync::Periodic;
use units::{Angle, Length};

/// Fewer rows are no cam.
pub(crate) const FEWEST_ROWS: usize = 36;
/// More rows than this are refused: a row each 20 seconds of arc.
pub const MOST_ROWS: usize = 65_536;
/// A step of the angle may differ from the others by this share: tables are printed with few
/// decimals.
const UNEVEN: f64 = 0.02;
/// Lifts of two rows at the same angle agree within this, mm.
const SAME_LIFT: f64 = 1e-4;

/// One row of a lift table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftRow {
    /// Angle of the cam against the follower.
    pub angle: Angle,
    /// Lift above the base circle.
    pub lift: Length,
}

/// What runs on the cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Follower {
    /// A flat face at right angles to its travel.
    Flat,
    /// A roller of this radius; the lift is that of its centre.
    Roller(Length),
    /// An edge: the lift is that of the contour itself.
    Knife,
}

/// A cam: base radius, follower and lift.
#[derive(Clone, Debug, PartialEq)]
pub struct Cam {
    /// Radius of the base circle.
    pub base: Length,
    /// What runs on it.
    pub follower: Follower,
    pub(crate) lift: Periodic,
    pub(crate) largest: f64,
    pub(crate) smallest: f64,
}

impl Cam {
    /// From a table over one turn in equal steps. A last row at the angle of the first one, a turn
    /// later, is allowed.
    ///
    /// # Errors
    /// What is wrong with the table, with its row.
    pub fn from_rows(rows: &[LiftRow], base: Length, follower: Follower) -> Result<Self, CamError> {
        let rows = checked(rows)?;
        let first = rows.first().map_or(0.0, |row| row.angle.value());
        let values: Vec<f64> = rows.iter().map(|row| row.lift.value()).collect();
        Self::from_nodes(&values, first, base, follower)
    }

    /// From lifts in equal steps, the first at an angle of `first` revolutions.
    pub(crate) fn from_nodes(
        values: &[f64],
        first: f64,
        base: Length,
        follower: Follower,
    ) -> Result<Self, CamError> {
        let rows = Problem::Rows { count: values.len() };
        let spline = Periodic::new(values).map_err(|_| CamError::of(rows))?;
        let n = values.len();
        // a table that does not begin at zero is read off at the angles that do
        let turned: Vec<f64> =
            (0..n).map(|i| spline.at(i as f64 / n as f64 - first).value).collect();
        let lift = if first == 0.0 {
            spline
        } else {
            Periodic::new(&turned).map_err(|_| CamError::of(rows))?
        };
        let fold = |start: f64, f: fn(f64, f64) -> f64| values.iter().copied().fold(start, f);
        let (largest, smallest) =
            (fold(f64::NEG_INFINITY, f64::max), fold(f64::INFINITY, f64::min));
        if !(base.is_finite() && base.value() + smallest > 0.0) {
            return Err(CamError::of(Problem::NoRadius { base: Length::mm(-smallest) }));
        }
        if let Follower::Roller(radius) = follower
            && !(radius > Length::ZERO && radius.is_finite())
        {
            return Err(CamError::of(Problem::NotPositive { what: "a roller radius" }));
        }
        Ok(Self { base, follower, lift, largest, smallest })
    }

    /// Rows of the table that it was made from.
    pub const fn rows(&self) -> usize {
        self.lift.len()
    }

    /// Greatest lift.
    pub const fn greatest_lift(&self) -> Length {
        Length::mm(self.largest)
    }

    /// Lift and its first three derivatives by the angle in radians.
    pub fn lift(&self, angle: Angle) -> [f64; 4] {
        let tau = core::f64::consts::TAU;
        let p = self.lift.at(angle.value());
        [p.value, p.slope / tau, p.bend / (tau * tau), p.jolt / (tau * tau * tau)]
    }
}

/// The rows of exactly one turn.
fn checked(rows: &[LiftRow]) -> Result<&[LiftRow], CamError> {
    let count = rows.len();
    if count > MOST_ROWS + 1 {
        return Err(CamError::in_row(MOST_ROWS, Problem::Rows { count }));
    }
    let finite = |row: &LiftRow| row.angle.is_finite() && row.lift.is_finite();
    if let Some(row) = rows.iter().position(|row| !finite(row)) {
        return Err(CamError::in_row(row, Problem::NotFinite));
    }
    for (i, pair) in rows.windows(2).enumerate() {
        let (before, found) = (pair[0].angle, pair[1].angle);
        if found <= before {
            return Err(CamError::in_row(i + 1, Problem::NotRising { before, found }));
        }
    }
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(CamError::of(Problem::Rows { count }));
    };
    if count < FEWEST_ROWS {
        return Err(CamError::in_row(count - 1, Problem::Rows { count }));
    }
    let step = rows[1].angle - first.angle;
    for (i, pair) in rows.windows(2).enumerate() {
        let expected = pair[0].angle + step;
        if (pair[1].angle - expected).abs() > step * UNEVEN {
            return Err(CamError::in_row(i + 1, Problem::Gap { expected, found: pair[1].angle }));
        }
    }
    let whole = last.angle - first.angle;
    let near = |turn: Angle| (turn - Angle::rev(1.0)).abs() < step * 0.5;
    let rows = if near(whole) {
        if (last.lift - first.lift).abs().value() > SAME_LIFT {
            let problem = Problem::NotPeriodic { first: first.lift, last: last.lift };
            return Err(CamError::in_row(count - 1, problem));
        }
        &rows[..count - 1]
    } else if near(whole + step) {
        rows
    } else {
        let problem = Problem::NotAWholeTurn { from: first.angle, to: last.angle };
        return Err(CamError::in_row(count - 1, problem));
    };
    no_jump(rows).map(|()| rows)
}

/// No row differs from the one before it by more than its neighbourhood makes likely.
fn no_jump(rows: &[LiftRow]) -> Result<(), CamError> {
    /// Times the largest change nearby.
    const LIKELY: f64 = 6.0;
    /// And this much, mm, which no table's rounding reaches.
    const ROUNDING: f64 = 0.01;
    let n = rows.len();
    let change = |i: usize| (rows[(i + 1) % n].lift - rows[i % n].lift).abs().value();
    for i in 0..n {
        let mut around = [n - 3, n - 2, n - 1, 1, 2, 3].map(|k| change(i + k));
        around.sort_by(f64::total_cmp);
        // a single row that is off makes two changes, there and back
        let neighbours = around[4];
        if change(i) > LIKELY * neighbours + ROUNDING {
            let problem =
                Problem::Jump { by: Length::mm(change(i)), neighbours: Length::mm(neighbours) };
            // the seam's row is the first one: that is where the table does not go on as it ended
            return Err(CamError::in_row((i + 1) % n, problem));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    fn rows(count: usize, f: impl Fn(f64) -> f64) -> Vec<LiftRow> {
        let row = |i: usize| {
            let turn = i as f64 / count as f64;
            LiftRow { angle: Angle::rev(turn), lift: Length::mm(f(turn)) }
        };
        (0..count).map(row).collect()
    }

    fn eccentric(turn: f64) -> f64 {
        4.0 - 4.0 * (TAU * turn).cos()
    }

    fn refusal(rows: &[LiftRow]) -> CamError {
        Cam::from_rows(rows, Length::mm(20.0), Follower::Flat).unwrap_err()
    }

    #[test]
    fn a_table_with_or_without_its_closing_row_is_the_same_cam() {
        let mut table = rows(720, eccentric);
        let open = Cam::from_rows(&table, Length::mm(20.0), Follower::Flat).unwrap();
        table.push(LiftRow { angle: Angle::rev(1.0), lift: Length::mm(eccentric(1.0)) });
        assert_eq!(Cam::from_rows(&table, Length::mm(20.0), Follower::Flat).unwrap(), open);
    }

    #[test]
    fn a_table_that_begins_at_minus_half_a_turn_is_the_same_cam() {
        let mut table = rows(720, |t| eccentric(t - 0.5));
        for row in &mut table {
            row.angle -= Angle::rev(0.5);
        }
        let cam = Cam::from_rows(&table, Length::mm(20.0), Follower::Flat).unwrap();
        assert!((cam.lift(Angle::rev(0.3))[0] - eccentric(0.3)).abs() < 1e-9);
    }

    #[test]
    fn what_is_wrong_with_a_table_is_said_with_its_row() {
        let good = || rows(720, eccentric);
        let mut t = good();
        t[100].lift = Length::mm(f64::NAN);
        assert_eq!(refusal(&t), CamError { row: Some(100), problem: Problem::NotFinite });
        let mut t = good();
        t.swap(50, 51);
        assert!(matches!(
            refusal(&t),
            CamError { row: Some(51), problem: Problem::NotRising { .. } }
        ));
        let mut t = good();
        t.remove(300);
        assert!(matches!(refusal(&t), CamError { row: Some(300), problem: Problem::Gap { .. } }));
        let mut t = good();
        t[200].lift += Length::mm(0.5);
        assert!(matches!(refusal(&t), CamError { row: Some(200), problem: Problem::Jump { .. } }));
        let mut t = good();
        t.push(LiftRow { angle: Angle::rev(1.0), lift: Length::mm(0.1) });
        assert!(matches!(
            refusal(&t),
            CamError { row: Some(720), problem: Problem::NotPeriodic { .. } }
        ));
        let t = &good()[..500];
        assert!(matches!(
            refusal(t),
            CamError { row: Some(499), problem: Problem::NotAWholeTurn { .. } }
        ));
        let t = rows(720, |turn| 2.0 * turn);
        assert!(matches!(refusal(&t), CamError { row: Some(0), problem: Problem::Jump { .. } }));
        let t = rows(MOST_ROWS + 2, |_| 0.0);
        assert!(matches!(refusal(&t), CamError { row: Some(_), problem: Problem::Rows { .. } }));
        assert!(matches!(refusal(&[]).problem, Problem::Rows { count: 0 }));
        let sunk = rows(720, |t| eccentric(t) - 30.0);
        assert!(matches!(refusal(&sunk).problem, Problem::NoRadius { .. }));
    }
}
