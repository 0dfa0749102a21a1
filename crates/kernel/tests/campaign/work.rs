//! What is tapped: sizes, speeds, holders, and the tap as program and judge know it.
use crate::common::*;
use canon::{Flute, Op, OpKind, Span, TapTool, Tool, ToolKind};
use sync::recovery::{Seat, Way};
use units::{Angle, Lead, Length, Spin, Stiffness};

/// What is tapped.
#[derive(Clone, Copy)]
pub struct Work {
    pub size: &'static str,
    pub diameter_mm: f64,
    pub order: TapOrder,
    pub holder: sim::Holder,
}

/// A rigid holder.
pub const RIGID: sim::Holder =
    sim::Holder { stiffness: Stiffness::n_per_mm(20_000.0), travel: None };

/// Flutes of every tap here; its holes are as deep as these reach.
pub const FLUTES_MM: f64 = 40.0;

/// M8×1.25, 20 mm deep at 1000 rpm, from 2 mm above.
pub const M8: Work = Work {
    size: "M8x1.25",
    diameter_mm: 8.0,
    order: TapOrder {
        lead_mm: 1.25,
        rpm: 1000.0,
        from_mm: -100.0,
        surface_mm: -102.0,
        to_mm: -122.0,
        room_mm: FLUTES_MM - 20.0,
        dwell_s: 0.05,
        ramp_s: None,
        start_angle: Some(Angle::ZERO),
        left: false,
        cut_n_m: 0.0,
    },
    holder: RIGID,
};

/// Unload first, where it is worth it.
pub fn unload(work: &Work) -> Way {
    Way::UnloadFirst(Seat { play: Length::um(0.5), is_stiff: work.holder.travel.is_none() })
}

pub(super) fn tool(work: &Work) -> Tool {
    let hand = if work.order.left { -1.0 } else { 1.0 };
    Tool {
        number: 1,
        pocket: 1,
        length: Length::mm(100.0),
        diameter: Length::mm(work.diameter_mm),
        kind: ToolKind::Tap(TapTool {
            designation: work.size.to_owned(),
            lead: Lead::mm_per_rev(hand * work.order.lead_mm),
            chamfer_pitches: 2.5,
            thread_length: Length::mm(60.0),
            flute: Flute::SpiralFlute,
            oversize: Length::um(30.0),
            holder: canon::Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
            max_torque: None,
        }),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

pub(super) fn op(order: &TapOrder) -> Op {
    let plan = order.plan();
    let hand = if order.left { -1.0 } else { 1.0 };
    Op {
        span: Span { line: 1, ..Span::default() },
        kind: OpKind::Tap(canon::Tap {
            axis: canon::Axis::Z,
            start: plan.start,
            bottom: plan.bottom,
            surface: plan.surface,
            zero: plan.surface,
            own_zero: None,
            lead: Lead::mm_per_rev(hand * order.lead_mm),
            spin: Spin::rpm(order.rpm),
            return_spin: Spin::rpm(order.rpm),
            return_acceleration: canon::ReturnAcceleration::AsSet,
            dwell: plan.dwell,
            start_angle: None,
            peck: None,
        }),
    }
}
