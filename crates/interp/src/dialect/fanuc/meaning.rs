//! What a G code of these controls can be.

/// What a G code is in the shared language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// This code, in tenths.
    Shared(u16),
    /// G15, G16, G50, G51, G50.1, G51.1, G68, G69 of machining centres.
    Mapping(u16),
    /// It ends something that Leadscrew does not begin: nothing is to be done.
    Off,
    /// G5 P, G5.1 Q, G8 P: how far the control looks ahead, which this one always does.
    Smoothing,
    /// G9.
    ExactBlock,
    /// G29.
    Back,
    /// G27: are the axes at the reference point?
    Check,
    /// G22 (true), G23: stored stroke check.
    StrokeCheck(bool),
    /// G7.1.
    Cylinder,
    /// G12.1 (true), G13.1.
    Face(bool),
    /// G45 to G48: how many offsets longer the way is.
    Longer(i8),
    /// G31: a feed that the probe's signal would end; here it comes at the programmed end.
    Skip,
    /// G33, G32.
    Thread,
    /// G77, G78, G79 of lathes (A: G90, G92, G94): a cycle of four moves.
    Box(u16),
    /// G34, G70 to G76 of lathes.
    Multiple(u16),
    /// G12 (true), G13 of Haas and Mitsubishi: a circle is milled from its centre, clockwise or
    /// counter-clockwise.
    Circle(bool),
    /// G110 to G129 of Haas: the work offset with this number beyond the sixth.
    WorkOffset(u8),
    /// G187 of Haas: how corners are taken.
    Smoothness,
    /// Known, and not executed.
    NotYet(&'static str),
    /// No code.
    Unknown,
}
