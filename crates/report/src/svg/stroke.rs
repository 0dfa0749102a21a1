//! The kinds of lines of a chart, and the classes of the style sheet that draw them.

/// How a line looks; the style sheet says what that is in light, dark and print.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// On the way in.
    In,
    /// On the way out.
    Out,
    /// What should be.
    Ideal,
    /// What was commanded or is the main quantity.
    Main,
    /// A second quantity beside the main one.
    Second,
    /// What the machine can.
    Capability,
    /// A limit that warns.
    Warn,
    /// A limit that stops.
    Stop,
    /// A share of the tolerance.
    Share,
    /// A rapid move.
    Rapid,
    /// A cutting move.
    Feed,
    /// Where a quantity is zero.
    Zero,
    /// A direction of the machine.
    Axis,
}

impl Stroke {
    /// Its class in the style sheet.
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::In => "line in",
            Self::Out => "line out",
            Self::Ideal => "line ideal",
            Self::Main => "line main",
            Self::Second => "line second",
            Self::Capability => "line capability",
            Self::Warn => "line warn",
            Self::Stop => "line stop",
            Self::Share => "line share",
            Self::Rapid => "line rapid",
            Self::Feed => "line feed",
            Self::Zero => "line zero",
            Self::Axis => "line axes",
        }
    }
}
