//! What differs among the machining centres that speak Fanuc's language, as data.
//!
//! Each one's folder has a [`Variant`]; what it does not say is [`FANUC`]'s.
use crate::dialect::fanuc::meaning::Meaning;

/// What one has otherwise than Fanuc's own.
#[allow(clippy::struct_excessive_bools)] // conventions that have nothing to do with one another
pub(crate) struct Variant {
    /// G codes in tenths that mean something else there, or are not there.
    pub(crate) own: fn(u16) -> Option<Meaning>,
    /// M97 calls blocks of the program at hand.
    pub(crate) calls_by_m97: bool,
    /// H of M98 names the block with which the subprogram begins.
    pub(crate) begins_calls_by_h: bool,
    /// M29 announces a rigid tap; else it is the builder's.
    pub(crate) has_m29: bool,
    /// `,R1` makes a tap rigid.
    pub(crate) taps_by_r: bool,
    /// P of M19 is the angle of the spindle, degrees.
    pub(crate) orients_by_p: bool,
    /// Times with a point are seconds.
    pub(crate) waits_in_seconds: bool,
    /// A cycle without R feeds from where the tool stands.
    pub(crate) cycles_without_r: bool,
    /// R of a lathe's drilling and tapping cycles is a place, and no way from the initial level.
    pub(crate) levels_are_places: bool,
    /// What G53 does where words are increments.
    pub(crate) g53_by_increments: MachinePlace,
    /// How work offsets beyond the sixth are called, and how many there are.
    pub(crate) more_offsets: (&'static str, u32),
    /// What G12 and G13 mill.
    pub(crate) circles: Circles,
    /// System variables count the lives of tools.
    pub(crate) has_tool_timers: bool,
    /// Whether this is a common variable that Fanuc's controls do not have.
    pub(crate) has_more_variables: fn(usize) -> bool,
}

/// What G53 does under G91.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MachinePlace {
    /// Nothing.
    Ignored,
    /// It goes to that place of the machine.
    Absolute,
    /// It moves by the increments.
    Incremental,
}

/// What G12 and G13 mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Circles {
    /// They are no such codes.
    None,
    /// One circle from its centre and back.
    One,
    /// A round pocket, in rings, level by level.
    Pocket,
}

/// Fanuc's own.
pub(crate) const FANUC: Variant = Variant {
    own: |_| None,
    calls_by_m97: false,
    begins_calls_by_h: false,
    has_m29: true,
    taps_by_r: false,
    orients_by_p: false,
    waits_in_seconds: false,
    cycles_without_r: false,
    levels_are_places: false,
    g53_by_increments: MachinePlace::Ignored,
    more_offsets: ("G54.1", 48),
    circles: Circles::None,
    has_tool_timers: false,
    has_more_variables: |_| false,
};
