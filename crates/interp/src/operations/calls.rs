//! Each call of the interpreter, turned into operations: the one place that knows who does it.
//!
//! Moves are the [`Resolver`]'s own; the operations of a cycle are made in its file; orders that
//! move no axis in [`orders`].
use crate::{
    call::{Call, Place, Sink},
    cycles::{
        cam, hobbing,
        holes::{chip_removal, hole, tap},
        polygon,
    },
    fault::unknown::Unknown,
    motion::{probe, spline_pieces, threads},
    operations::orders,
    resolve::Resolver,
};
use canon::OpKind;
use units::{Angle, Time};

impl Sink for Resolver {
    fn suppress(&mut self, unknown: Unknown) {
        self.unknown = unknown;
    }

    fn take_time_passed(&mut self) -> bool {
        core::mem::take(&mut self.time_passed)
    }

    fn missed(&self) -> Unknown {
        self.missed
    }

    #[inline]
    fn call(&mut self, place: &Place, call: &Call<'_>) {
        let span = place.span;
        if self.missed != Unknown::default() {
            known_again(&mut self.missed, call);
        }
        match call {
            Call::Rapid(to) | Call::OutByHand(to) => {
                let to = self.machine(to);
                self.rapid(&to, span);
            }
            Call::Line(to) => self.line(to, span),
            Call::Spline { order, points } => spline_pieces::operation(self, *order, points, span),
            Call::Probe { to, until_contact, required } => {
                probe::operation(self, to, (*until_contact, *required), span);
            }
            Call::Arc { plane, to, centre, turns } => self.arc(*plane, to, *centre, *turns, span),
            Call::Hole(hole) => hole::operation(self, hole, span),
            Call::ThrowChips(hole) => chip_removal::throw_chips_after_drilling(self, hole, span),
            Call::Tap(tap) => tap::operation(self, tap, span),
            Call::RigidTap { to, lead, return_factor, sense } => {
                threads::tap_operation(self, to, *lead, *return_factor, *sense, span);
            }
            Call::ThreadAngle(degrees) => self.thread_angle = Angle::deg(*degrees),
            Call::GrowingThread(thread) => {
                self.threading = Some((thread.lead * self.mm(), thread.growth * self.mm()));
                self.line(&thread.to, span);
                (self.threading, self.thread_angle) = (None, Angle::ZERO);
            }
            Call::SyncStart(lead) => self.threading = Some((lead * self.mm(), 0.0)),
            Call::SyncStop => (self.threading, self.thread_angle) = (None, Angle::ZERO),
            Call::Polygon(order) => polygon::operation(self, order, span),
            Call::PolygonMeasure(looks) => {
                self.push(span, OpKind::PolygonMeasure { looks: *looks });
            }
            Call::PolygonEnd => self.push(span, OpKind::PolygonEnd),
            Call::Hob(order) => hobbing::operation(self, order, span),
            Call::HobEnd => self.push(span, OpKind::HobEnd),
            Call::Cam(order) => cam::operation(self, *order, span),
            Call::StrokeCheck(zone) => self.zone = *zone,
            Call::Dwell(seconds) => self.push(span, OpKind::Dwell { time: Time::s(*seconds) }),
            other => orders::order_or_mode(self, other, span),
        }
    }
}

/// What a call says is known again.
fn known_again(missed: &mut Unknown, call: &Call<'_>) {
    match call {
        Call::SpindleSpeed(_) | Call::SpindleMode(_) => missed.clear(Unknown::SPEED),
        Call::SpindleTurn(_) | Call::SpindleStop => missed.clear(Unknown::SENSE),
        Call::SelectPlane(_) | Call::Rotation(_) => missed.clear(Unknown::PLANE),
        _ => {}
    }
}
