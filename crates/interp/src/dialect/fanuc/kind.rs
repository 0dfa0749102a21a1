//! Whose G codes: a machining centre's, or a lathe's in one of three systems.
//!
//! | what | A | B | C |
//! |---|---|---|---|
//! | a cycle of four moves: turning, threading, facing | G90 G92 G94 | G77 G78 G79 | G20 G21 G24 |
//! | thread | G32 | G33 | G33 |
//! | finishing, roughing, … threading in passes | G70 – G76 | G70 – G76 | G72 – G78 |
//! | inches, millimetres | G20 G21 | G20 G21 | G70 G71 |
//! | position, highest speed | G50 | G92 | G92 |
//! | feed per minute, per revolution | G98 G99 | G94 G95 | G94 G95 |
//! | absolute, incremental | X Z, U W | G90 G91 | G90 G91 |
//!
//! Source: Fanuc, operator's manual of series 30i for lathes, "G code list".
use crate::dialect::{
    fanuc::variant::{FANUC, Variant},
    haas::variant::{LATHE as HAAS_LATHE, VARIANT as HAAS},
    mitsubishi::variant::VARIANT as MITSUBISHI,
};

/// Whose G codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Machining centres.
    Mill,
    /// Haas' machining centres: [`haas`](crate::dialect::haas) says what differs.
    Haas,
    /// Haas' lathes: system A, and what [`haas`](crate::dialect::haas) says of them.
    HaasLathe,
    /// Mitsubishi's machining centres: [`mitsubishi`](crate::dialect::mitsubishi) says what
    /// differs.
    Mitsubishi,
    /// Lathes, system A: G90, G92, G94 are cycles, U and W are increments.
    LatheA,
    /// Lathes, system B: G77, G78, G79 are those cycles, G91 makes increments.
    LatheB,
    /// Lathes, system C: G20, G21, G24 are those cycles, G70 and G71 the units.
    LatheC,
}

impl Kind {
    pub(crate) const fn is_lathe(self) -> bool {
        !self.is_mill()
    }

    pub(crate) const fn is_mill(self) -> bool {
        matches!(self, Self::Mill | Self::Haas | Self::Mitsubishi)
    }

    /// What it has otherwise than Fanuc's own.
    pub(crate) const fn variant(self) -> &'static Variant {
        match self {
            Self::Haas => &HAAS,
            Self::HaasLathe => &HAAS_LATHE,
            Self::Mitsubishi => &MITSUBISHI,
            Self::Mill | Self::LatheA | Self::LatheB | Self::LatheC => &FANUC,
        }
    }

    /// Whose numbers of codes it has.
    const fn system(self) -> Self {
        match self {
            Self::HaasLathe => Self::LatheA,
            other => other,
        }
    }

    /// A code in tenths as machining centres and system B write it; none if this system has no such
    /// code.
    pub(crate) const fn common(self, tenths: u16) -> Option<u16> {
        let system = self.system();
        Some(match (system, tenths) {
            (Self::LatheA, 330 | 770 | 780 | 790 | 910 | 950) | (Self::LatheC, 790) => return None,
            (Self::LatheA, 320) => 330,
            (Self::LatheA, 500) => 920,
            (Self::LatheA, 900) => 770,
            (Self::LatheA, 920) => 780,
            (Self::LatheA, 940) => 790,
            (Self::LatheA, 980) => 940,
            (Self::LatheA, 990) => 950,
            (Self::LatheC, 200) => 770,
            (Self::LatheC, 210) => 780,
            (Self::LatheC, 240) => 790,
            (Self::LatheC, 700) => 200,
            (Self::LatheC, 710) => 210,
            (Self::LatheC, 720..=780) if tenths.is_multiple_of(10) => tenths - 20,
            (_, other) => other,
        })
    }

    /// How this system writes a whole code of machining centres and system B.
    pub(crate) const fn own(self, code: u16) -> u16 {
        match (self.system(), code) {
            (Self::LatheA, 33) => 32,
            (Self::LatheA, 77) => 90,
            (Self::LatheA, 78) => 92,
            (Self::LatheA, 79) => 94,
            (Self::LatheA, 94) => 98,
            (Self::LatheA, 95) => 99,
            (Self::LatheC, 20 | 21) => code + 50,
            (Self::LatheC, 70..=76) => code + 2,
            (Self::LatheC, 77) => 20,
            (Self::LatheC, 78) => 21,
            (Self::LatheC, 79) => 24,
            _ => code,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_writes_what_it_reads() {
        let lathes = [Kind::HaasLathe, Kind::LatheA, Kind::LatheB, Kind::LatheC];
        for kind in [Kind::Mill, Kind::Haas, Kind::Mitsubishi].into_iter().chain(lathes) {
            let codes = [20, 21, 33, 70, 73, 76, 77, 78, 79, 83, 94, 95];
            for code in codes {
                assert_eq!(kind.common(10 * kind.own(code)), Some(10 * code), "{kind:?} G{code}");
            }
        }
        assert_eq!((Kind::LatheA.common(770), Kind::LatheC.common(790)), (None, None));
    }
}
