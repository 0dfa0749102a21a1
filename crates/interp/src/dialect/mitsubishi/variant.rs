//! What Mitsubishi's machining centres have otherwise than Fanuc's, as the front end asks for it.
use crate::dialect::fanuc::{
    meaning::Meaning,
    variant::{Circles, FANUC, MachinePlace, Variant},
};

/// Where they differ.
pub(crate) const VARIANT: Variant = Variant {
    own,
    begins_calls_by_h: true,
    has_m29: false,
    taps_by_r: true,
    g53_by_increments: MachinePlace::Incremental,
    circles: Circles::One,
    has_more_variables: |number| matches!(number, 400..=499 | 900_000..=907_399),
    ..FANUC
};

/// What a code means there, in tenths, where that is not what Fanuc means.
const fn own(tenths: u16) -> Option<Meaning> {
    use Meaning::{Circle, NotYet, Shared, Smoothing};
    Some(match tenths {
        120 => Circle(true),
        130 => Circle(false),
        611 => Shared(640),
        1201 | 1210 => Smoothing,
        340 => NotYet("holes on a circle"),
        350 => NotYet("holes on a line"),
        360 => NotYet("holes on an arc"),
        371 => NotYet("holes in a grid"),
        380 | 390 => NotYet("vector and corner of cutter compensation"),
        1130 | 1140..=1144 | 1150..=1152 => NotYet("spindles in step"),
        _ => return None,
    })
}
