//! What Haas' machining centres have otherwise than Fanuc's, as the front end asks for it.
use crate::dialect::fanuc::{
    meaning::Meaning,
    variant::{Circles, FANUC, MachinePlace, Variant},
};

/// Where they differ.
pub(crate) const VARIANT: Variant = Variant {
    own,
    calls_by_m97: true,
    has_m29: false,
    orients_by_p: true,
    waits_in_seconds: true,
    cycles_without_r: true,
    g53_by_increments: MachinePlace::Absolute,
    more_offsets: ("G154", 99),
    circles: Circles::Pocket,
    has_tool_timers: true,
    ..FANUC
};

/// The same of its lathes.
pub(crate) const LATHE: Variant = Variant {
    own: lathe,
    cycles_without_r: false,
    levels_are_places: true,
    circles: Circles::None,
    ..VARIANT
};

/// What a code means on its lathes, in tenths, where that is not what Fanuc means.
const fn lathe(tenths: u16) -> Option<Meaning> {
    use Meaning::{NotYet, Shared, Smoothing, Smoothness, WorkOffset};
    Some(match tenths {
        810 | 820 | 860 | 890 => Shared(tenths),
        870 | 880 => NotYet("boring that the operator ends by hand"),
        1840 => Shared(740),
        1540 => Shared(541),
        1120 | 1130 => return None,
        1030 => Smoothing,
        1000 | 1010 => NotYet("mirror image"),
        1050 => NotYet("bar feeding"),
        1100..=1290 if tenths.is_multiple_of(10) => WorkOffset((tenths / 10 - 109) as u8),
        1870 => Smoothness,
        50 => NotYet("fine control of the spindle"),
        140 | 150 => NotYet("the second spindle"),
        950 | 1860 | 1950 | 1960 => NotYet("rigid tapping with a driven tool"),
        1980 | 1990 => NotYet("spindles in step"),
        2000 => NotYet("tool change on the way"),
        2410..=2490 => NotYet("drilling, tapping and boring with a driven tool along X"),
        _ => return None,
    })
}

/// What a code means there, in tenths, where that is not what Fanuc means.
const fn own(tenths: u16) -> Option<Meaning> {
    use Meaning::{Circle, NotYet, Shared, Smoothing, Smoothness, Unknown, WorkOffset};
    Some(match tenths {
        120 => Circle(true),
        130 => Circle(false),
        1030 => Smoothing,
        1120 | 1130 => {
            NotYet("ways on a face, or the third and fourth work offset of old controls")
        }
        1100..=1290 if tenths.is_multiple_of(10) => WorkOffset((tenths / 10 - 109) as u8),
        1540 => Shared(541),
        1870 => Smoothness,
        350..=370 if tenths.is_multiple_of(10) => NotYet("automatic measurement of offsets"),
        1360 => NotYet("automatic measurement of a work offset's centre"),
        470 => NotYet("text engraving"),
        450 | 460 | 480 => Unknown,
        700 => NotYet("holes on a circle"),
        710 => NotYet("holes on an arc"),
        720 => NotYet("holes on a line"),
        770 => NotYet("back boring"),
        870 => NotYet("boring that the operator ends by hand"),
        1000 | 1010 => NotYet("mirror image"),
        1020 => NotYet("output over a serial line"),
        1070 => NotYet("mapping onto a cylinder"),
        1410 => NotYet("three-dimensional cutter compensation"),
        1430 => NotYet("tool length on five axes"),
        1500 => NotYet("pocket of any shape"),
        1530 | 1550 | 1610 | 1620 | 1630 | 1640 | 1650 | 1660 | 1690 => {
            NotYet("cycle on five axes")
        }
        1740 | 1840 => NotYet("rigid tapping off the vertical"),
        1880 => NotYet("a program by the pallet"),
        2340 | 2350 => NotYet("tool centre point control"),
        2530 | 2540 | 2550 | 2680 | 2690 => NotYet("tilted or turned work coordinates"),
        _ => return None,
    })
}
