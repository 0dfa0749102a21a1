//! Whether the tool was in the material: without contact there is no feature, whatever path the
//! axes took.
//!
//! ```text
//!                  ▼ tool: axis less the length of the tool that is really in the spindle
//!      to.z ─ ┌────╫────────┐ ─ ─ ─ ─ ─ ─ ─       reach   the way of the edges within the stock
//!             │    ║ reach  │                       torque  what the cut took, where it can be known
//!             │    ▼        │                       open    how far a tool's circle stands over a side
//!    from.z ─ └─────────────┘
//!        from.x, y       to.x, y
//! ```
//!
//! The stock's place is the set-up's, in machine coordinates; offsets that the program sets move
//! the program, not the stock.
use units::{Force, Length, Torque};

/// A tool in the material that nothing resists cuts nothing: a sharp tap takes the formula's torque
/// within ±25 %, flanks in a thread that is there already 10 to 30 % of it.
const LEAST_TORQUE_SHARE: f64 = 0.05;
/// Less is the noise of arithmetic.
const LEAST_TORQUE: Torque = Torque::n_m(1e-6);

/// A block of material as it is clamped, in machine coordinates of a tool's tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Corner at the negative ends.
    pub from: [Length; 3],
    /// Corner at the positive ends; its Z is the top.
    pub to: [Length; 3],
    /// Zero of the workpiece: where a program's zero belongs.
    pub zero: [Length; 3],
}

impl Stock {
    /// Coordinate of its top.
    pub const fn top(&self) -> Length {
        self.to[2]
    }

    /// Its height.
    pub fn thickness(&self) -> Length {
        self.to[2] - self.from[2]
    }

    /// How far a circle of a radius about a place in X and Y reaches over the nearest side;
    /// negative: by so much it is inside.
    pub(crate) fn over_side(&self, at_mm: [f64; 2], radius_mm: f64) -> f64 {
        (0..2).fold(f64::NEG_INFINITY, |most, i| {
            let low = self.from[i].value() - (at_mm[i] - radius_mm);
            let high = at_mm[i] + radius_mm - self.to[i].value();
            most.max(low).max(high)
        })
    }
}

/// The configuration does not state where the stock is.
pub(crate) const NO_STOCK: &str =
    "where the material is was not known: state [setup.stock] in the machine's file";

/// The program's zero, as the tip in the spindle would touch it, is not the work's: one sentence an
/// axis.
pub(crate) fn shifted(
    zero: [Length; 3],
    stock: &Stock,
    most: Length,
) -> impl Iterator<Item = String> + use<> {
    let off = [0, 1, 2].map(|i| zero[i] - stock.zero[i]);
    ['X', 'Y', 'Z'].into_iter().zip(off).filter(move |(_, off)| off.abs() > most).map(
        |(axis, off)| {
            let off = off.value();
            format!("the program's zero stood {off:+.3} mm off the work's along {axis}: look at offsets and tool length")
        },
    )
}

/// Why nothing can be judged, where no stock is known.
pub(crate) fn unknown(stock: Option<&Stock>) -> Option<String> {
    stock.is_none().then(|| NO_STOCK.to_owned())
}

/// What says that a tool was in the material, or was not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Way of the edges within the stock, along the depth of the cut; `None`: where the stock is
    /// was not known.
    pub reach: Option<Length>,
    /// Largest torque of the cut, where it can be known.
    pub torque: Option<Torque>,
    /// Largest force of the cut (magnitude), where it can be known.
    pub force: Option<Force>,
    /// Torque that a sharp tool would have taken, where that is known.
    pub torque_expected: Option<Torque>,
}

impl Contact {
    /// The edges were in the stock and something resisted them, where that can be known.
    pub fn is_cut(&self) -> bool {
        self.reach.is_some_and(|reach| reach > Length::ZERO) && !self.is_unresisted()
    }

    /// A torque is known, and it is none.
    pub(crate) fn is_unresisted(&self) -> bool {
        let expected = self.torque_expected.unwrap_or(Torque::ZERO);
        let least = (expected * LEAST_TORQUE_SHARE).max(LEAST_TORQUE);
        self.torque.is_some_and(|torque| torque < least)
    }

    /// What is wrong with a feature that nothing resisted.
    pub(crate) fn unresisted(&self) -> Option<String> {
        let torque = self.torque.filter(|_| self.is_unresisted())?;
        let reach = self.reach.unwrap_or(Length::ZERO);
        let expected = self.torque_expected.map_or(String::new(), |expected| {
            format!(", a sharp tool takes {:.2} N·m", expected.value())
        });
        Some(format!(
            "not cut: {:.2} mm deep in the stock nothing resisted the tool ({:.2} N·m{expected})",
            reach.value(),
            torque.value()
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_reaches_over_the_side_that_is_nearest() {
        let mm = |v: [f64; 3]| v.map(Length::mm);
        let stock =
            Stock { from: mm([-10.0, -20.0, -5.0]), to: mm([10.0, 20.0, 0.0]), zero: mm([0.0; 3]) };
        assert!((stock.over_side([0.0, 0.0], 3.0) + 7.0).abs() < 1e-12);
        assert!((stock.over_side([8.0, 0.0], 3.0) - 1.0).abs() < 1e-12);
        assert!((stock.over_side([0.0, -25.0], 3.0) - 8.0).abs() < 1e-12);
        assert!((stock.thickness().value() - 5.0).abs() < 1e-12);
    }

    #[test]
    fn contact_needs_both_reach_and_resistance_where_it_is_known() {
        let in_stock = Contact { reach: Some(Length::mm(10.0)), ..Contact::default() };
        assert!(in_stock.is_cut(), "on a real machine geometry alone speaks");
        assert!(!Contact::default().is_cut());
        assert!(!Contact { torque: Some(Torque::ZERO), ..in_stock }.is_cut());
        let tap = |torque: f64| Contact {
            torque: Some(Torque::n_m(torque)),
            torque_expected: Some(Torque::n_m(1.73)),
            ..in_stock
        };
        // a thread that is there already rubs with a fifth of the formula
        assert!(tap(0.35).is_cut() && !tap(0.01).is_cut());
    }
}
