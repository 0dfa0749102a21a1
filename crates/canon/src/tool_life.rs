//! What becomes of a tool with use: how far it has worn, how much it has cut, and how much it may.
//!
//! ```text
//!   in force = geometry + wear      length: G43      radius: G41, G42
//!   used:    uses, time, length cut   ──►  limit of each  ──►  at M6: a remark, or a refusal
//! ```
use crate::{Op, OpKind, Tool};
use alloc::{format, string::String};
use units::{Length, Time};

/// What is added to a tool's geometry since it was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolWear {
    /// To the length; negative for a tool that has become shorter.
    pub length: Length,
    /// To the radius; negative for a tool that has become thinner.
    pub radius: Length,
}

/// How much a tool has been used, how much it may be, and what happens then.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolLife {
    /// So far.
    pub used: ToolUse,
    /// At most.
    pub limit: ToolLimit,
    /// What M6 does with a tool that is at its limit.
    pub at_limit: AtLimit,
    /// It broke, and no one has said that a new one is in its place.
    pub is_broken: bool,
}

/// How much a tool has been used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolUse {
    /// Holes drilled or tapped; whatever else it cuts between two tool changes is one use together.
    pub uses: u32,
    /// Time in cutting moves.
    pub time: Time,
    /// Length of the cutting moves.
    pub length: Length,
}

/// How much a tool may be used; `None`: that does not count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolLimit {
    /// Uses.
    pub uses: Option<u32>,
    /// Time in cutting moves.
    pub time: Option<Time>,
    /// Length of the cutting moves.
    pub length: Option<Length>,
}

/// What M6 does with a tool that is at its limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AtLimit {
    /// It is said.
    #[default]
    Remark,
    /// The program is refused.
    Refuse,
}

impl ToolUse {
    /// So much more.
    pub fn add(&mut self, more: &Self) {
        self.uses = self.uses.saturating_add(more.uses);
        self.time += more.time;
        self.length += more.length;
    }
}

impl ToolLife {
    /// A new tool is in its place.
    pub const fn begin_anew(&mut self) {
        (self.used, self.is_broken) =
            (ToolUse { uses: 0, time: Time::ZERO, length: Length::ZERO }, false);
    }

    /// Which limit is reached, in words, if one is: `500 of 500 uses`.
    pub fn reached(&self) -> Option<String> {
        let Self { used, limit, .. } = self;
        if let Some(most) = limit.uses.filter(|most| used.uses >= *most) {
            return Some(format!("{} of {most} uses", used.uses));
        }
        if let Some(most) = limit.time.filter(|most| used.time >= *most) {
            let (used, most) = (used.time.value(), most.value());
            return Some(format!("{used:.0} of {most:.0} s of cutting"));
        }
        let most = limit.length.filter(|most| used.length >= *most)?;
        let (used, most) = (used.length.value(), most.value());
        Some(format!("{used:.0} of {most:.0} mm cut"))
    }
}

impl Tool {
    /// Length with wear: what G43 puts into force, and where the tip really is.
    pub fn worn_length(&self) -> Length {
        self.length + self.wear.length
    }

    /// Diameter with wear: what G41 and G42 keep away from.
    pub fn worn_diameter(&self) -> Length {
        self.diameter + self.wear.radius * 2.0
    }
}

/// Counts the uses of the tools in a program's operations, in their order.
///
/// A hole or a tap is a use of the tool in the spindle; of other cuts the first one after a tool
/// change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UseCount {
    tool: u32,
    /// A cut beside holes has been counted since the tool came.
    has_cut: bool,
    /// The block of the hole whose moves follow.
    hole: Option<crate::Span>,
}

impl UseCount {
    /// With this tool in the spindle.
    pub const fn with(tool: u32) -> Self {
        Self { tool, has_cut: false, hole: None }
    }

    /// The tool that an operation uses once, if it does.
    pub fn counts(&mut self, op: &Op) -> Option<u32> {
        if self.hole.is_some_and(|span| span != op.span) {
            self.hole = None;
        }
        let is_used = match &op.kind {
            OpKind::ChangeTool { number } => {
                *self = Self::with(*number);
                false
            }
            OpKind::Hole(_) => {
                self.hole = Some(op.span);
                true
            }
            OpKind::Tap(_) => true,
            OpKind::Line { .. }
            | OpKind::Arc { .. }
            | OpKind::Spline { .. }
            | OpKind::Threading(_)
            | OpKind::Polygon(_)
            | OpKind::Hob(_)
            | OpKind::Cam(_) => self.hole.is_none() && !core::mem::replace(&mut self.has_cut, true),
            _ => false,
        };
        (is_used && self.tool != 0).then_some(self.tool)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn used(uses: u32) -> ToolLife {
        let used = ToolUse { uses, ..ToolUse::default() };
        let limit = ToolLimit { uses: Some(500), ..ToolLimit::default() };
        ToolLife { used, limit, at_limit: AtLimit::Refuse, is_broken: false }
    }

    #[test]
    fn a_tool_is_at_its_limit_when_the_last_use_is_used_up() {
        assert_eq!(used(499).reached(), None);
        assert_eq!(used(500).reached().as_deref(), Some("500 of 500 uses"));
        assert_eq!(ToolLife::default().reached(), None);
    }

    #[test]
    fn a_limit_of_time_and_one_of_length_count_for_themselves() {
        let limit = ToolLimit {
            uses: None,
            time: Some(Time::s(3600.0)),
            length: Some(Length::mm(90_000.0)),
        };
        let of = |time, length| {
            let used = ToolUse { uses: 9999, time: Time::s(time), length: Length::mm(length) };
            ToolLife { used, limit, at_limit: AtLimit::Remark, is_broken: false }.reached()
        };
        assert_eq!(of(3599.0, 89_999.0), None);
        assert_eq!(of(3600.0, 0.0).as_deref(), Some("3600 of 3600 s of cutting"));
        assert_eq!(of(0.0, 90_001.0).as_deref(), Some("90001 of 90000 mm cut"));
    }

    #[test]
    fn a_holes_own_moves_are_no_use_of_their_own_and_a_contour_is_one_use() {
        let at = |line| crate::Span { line, start: line, ..crate::Span::default() };
        let op = |line, kind| Op { span: at(line), kind };
        let line = || OpKind::Line {
            to: crate::Position::default(),
            feed: crate::Feed::PerTime(units::Speed::mm_per_s(5.0)),
        };
        let hole = || {
            OpKind::Hole(crate::Hole {
                axis: crate::Axis::Z,
                at: crate::Position::default(),
                bottom: Length::mm(-10.0),
                surface: Length::ZERO,
                zero: Length::ZERO,
                own_zero: None,
            })
        };
        let ops = [
            op(1, line()), // no tool in the spindle
            op(2, OpKind::ChangeTool { number: 7 }),
            op(3, hole()),
            op(3, line()),
            op(3, line()),
            op(4, hole()),
            op(4, line()),
            op(5, line()),
            op(6, line()),
            op(7, OpKind::ChangeTool { number: 8 }),
            op(8, line()),
        ];
        let mut count = UseCount::default();
        let used: alloc::vec::Vec<_> = ops.iter().map(|op| count.counts(op)).collect();
        let (none, seven) = (None, Some(7));
        let wanted = [none, none, seven, none, none, seven, none, seven, none, none, Some(8)];
        assert_eq!(used, wanted);
    }
}
