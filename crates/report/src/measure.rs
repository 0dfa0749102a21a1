//! Lengths as the program writes them: millimetres with three decimals and micrometres, or inches
//! with four decimals and microinches.
use crate::svg::fixed;
use canon::LengthUnit;
use units::{Length, MM_PER_INCH};

/// How lengths are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measure {
    /// Of places and sizes.
    pub unit: LengthUnit,
}

impl Measure {
    /// Millimetres, whatever the program writes.
    pub const METRIC: Self = Self { unit: LengthUnit::Millimetre };

    const fn is_inch(self) -> bool {
        matches!(self.unit, LengthUnit::Inch)
    }

    /// Symbol of the unit of places and sizes.
    pub const fn symbol(self) -> &'static str {
        if self.is_inch() { "in" } else { "mm" }
    }

    /// Symbol of the unit of errors.
    pub const fn small_symbol(self) -> &'static str {
        if self.is_inch() { "µin" } else { "µm" }
    }

    /// Decimals of places and sizes.
    pub const fn decimals(self) -> usize {
        if self.is_inch() { 4 } else { 3 }
    }

    /// A place or a size, without its unit.
    pub fn length(self, length: Length) -> String {
        fixed(self.number(length), self.decimals())
    }

    /// A place or a size to a tenth of a millimetre, or a hundredth of an inch, without its unit.
    pub fn coarse(self, length: Length) -> String {
        fixed(self.number(length), self.decimals() - 2)
    }

    /// A place or a size in its unit.
    pub fn number(self, length: Length) -> f64 {
        length.value() / self.unit.in_mm()
    }

    /// Decimals of an error that has `decimals` in micrometres.
    pub const fn small_decimals(self, decimals: usize) -> usize {
        if self.is_inch() { 0 } else { decimals }
    }

    /// An error, without its unit; `decimals` of a micrometre, a microinch is small enough to have
    /// none.
    pub fn small(self, error: Length, decimals: usize) -> String {
        fixed(self.small_number(error), self.small_decimals(decimals))
    }

    /// An error in its unit.
    pub fn small_number(self, error: Length) -> f64 {
        if self.is_inch() { error.value() / MM_PER_INCH * 1e6 } else { error.in_um() }
    }

    /// The same as [`Measure::small`], with its sign.
    pub fn signed(self, error: Length, decimals: usize) -> String {
        let text = self.small(error, decimals);
        let sign = if text.starts_with(['-', '–']) { "" } else { "+" };
        format!("{sign}{text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_in_inches_is_told_in_inches_with_four_decimals_and_errors_in_microinches() {
        let inch = Measure { unit: LengthUnit::Inch };
        assert_eq!((inch.length(Length::mm(19.05)), inch.symbol()), ("0.7500".into(), "in"));
        assert_eq!((inch.signed(Length::um(0.8), 1), inch.small_symbol()), ("+31".into(), "µin"));
        let metric = Measure::METRIC;
        assert_eq!(metric.length(Length::mm(19.05)), "19.050");
        assert_eq!(metric.signed(Length::um(-0.84), 1), "-0.8");
        assert_eq!(metric.signed(Length::um(f64::NAN), 1), "–");
    }
}
