//! The calls in the notation of LinuxCNC's stand-alone interpreter (`rs274 -g`), for `diff`.
//!
//! ```text
//!     9 N5     STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)
//!   └─┬─┘└──┬──┘
//!   count  N word
//! ```
//!
//! What LinuxCNC prints is printed, odd as it may be: its G84 in the planes ZX and YZ names the
//! coordinates of the feed moves in a rotated order, and so does this listing (the operations that
//! Leadscrew machines from do not pass through here).
pub(crate) mod decimal;

use crate::{
    auxiliary::switch::NO_SPEED_LIMIT,
    call::{Call, Corners, CycleTap, GrowingThread, HobOrder, Place, Sense, Sink, Units},
    geometry::frame::Point,
    listing::decimal::{push_fixed, push_fixed4, push_left, push_right, push_whole},
};
use canon::Plane;
use std::io::{self, Write};

/// Bytes gathered before they are written.
const CHUNK: usize = 1 << 16;

/// Prints calls.
pub struct Listing<W: Write> {
    out: W,
    buffer: Vec<u8>,
    count: u64,
    failed: Option<io::Error>,
    /// A call came by which the machine moves or waits.
    time_passed: bool,
}

impl<W: Write> Listing<W> {
    /// To a writer; no buffering is needed in it.
    pub fn new(out: W) -> Self {
        Self {
            out,
            buffer: Vec::with_capacity(CHUNK + 4096),
            count: 0,
            failed: None,
            time_passed: false,
        }
    }

    /// The end of the listing; the first error of the writer, if there was one.
    ///
    /// # Errors
    /// Whatever the writer said.
    pub fn finish(mut self) -> io::Result<W> {
        self.call(&Place::default(), &Call::Reset);
        self.call(&Place::default(), &Call::Reset);
        self.flush();
        match self.failed {
            Some(error) => Err(error),
            None => Ok(self.out),
        }
    }

    /// Whether writing has failed: nothing more will come out.
    pub const fn has_failed(&self) -> bool {
        self.failed.is_some()
    }

    #[cold]
    fn flush(&mut self) {
        if self.failed.is_none() {
            self.failed = self.out.write_all(&self.buffer).and_then(|()| self.out.flush()).err();
        }
        self.buffer.clear();
    }

    /// Count and N word.
    #[inline]
    fn begin(&mut self, place: &Place) {
        self.count += 1;
        push_right(&mut self.buffer, self.count);
        match place.number {
            None => self.buffer.extend_from_slice(b" N..... "),
            Some(number) => {
                self.buffer.extend_from_slice(b" N");
                push_left(&mut self.buffer, number);
            }
        }
    }

    #[inline]
    fn end(&mut self) {
        if self.buffer.len() >= CHUNK {
            self.flush();
        }
    }

    /// A call with numbers of four decimals.
    #[inline]
    fn numbers(&mut self, place: &Place, name: &[u8], values: &[f64]) {
        self.begin(place);
        self.buffer.extend_from_slice(name);
        self.buffer.push(b'(');
        for (i, value) in values.iter().enumerate() {
            if i > 0 {
                self.buffer.extend_from_slice(b", ");
            }
            push_fixed4(&mut self.buffer, *value);
        }
        self.buffer.extend_from_slice(b")\n");
        self.end();
    }

    /// A call whose text is written out.
    fn text(&mut self, place: &Place, text: &str) {
        self.pieces(place, [text, "\n"]);
    }

    /// The same in pieces, with the end of the line.
    fn pieces<const COUNT: usize>(&mut self, place: &Place, pieces: [&str; COUNT]) {
        self.begin(place);
        for piece in pieces {
            self.buffer.extend_from_slice(piece.as_bytes());
        }
        self.end();
    }

    #[inline]
    fn point(&mut self, place: &Place, name: &[u8], p: &Point) {
        self.numbers(place, name, &[p[0], p[1], p[2], p[3], p[4], p[5]]);
    }

    fn work_offset(&mut self, place: &Place, system: u8, p: &Point) {
        let numbers = p[..6].iter().map(|v| format!("{v:.4}")).collect::<Vec<_>>().join(", ");
        self.text(place, &format!("SET_G5X_OFFSET({system}, {numbers})"));
    }

    fn path_control(&mut self, place: &Place, corners: Corners, merge: Option<f64>) {
        match corners {
            Corners::ExactPath => self.text(place, "SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"),
            Corners::ExactStop => self.text(place, "SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)"),
            Corners::Continuous(tolerance) => {
                self.begin(place);
                self.buffer.extend_from_slice(b"SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, ");
                push_fixed(&mut self.buffer, tolerance, 6);
                self.buffer.extend_from_slice(b")\n");
            }
        }
        if let Some(merge) = merge {
            self.numbers(place, b"SET_NAIVECAM_TOLERANCE", &[merge]);
        }
    }

    fn turn(&mut self, place: &Place, sense: Sense) {
        self.text(
            place,
            match sense {
                Sense::Clockwise => "START_SPINDLE_CLOCKWISE(0)",
                Sense::Counterclockwise => "START_SPINDLE_COUNTERCLOCKWISE(0)",
            },
        );
    }

    fn feed_override(&mut self, place: &Place, on: bool) {
        self.text(place, if on { "ENABLE_FEED_OVERRIDE()" } else { "DISABLE_FEED_OVERRIDE()" });
    }

    fn speed_override(&mut self, place: &Place, on: bool) {
        self.text(place, if on { "ENABLE_SPEED_OVERRIDE(0)" } else { "DISABLE_SPEED_OVERRIDE(0)" });
    }

    /// G84, G74 as LinuxCNC has them: in, reverse, wait, out.
    fn tap(&mut self, place: &Place, tap: &CycleTap) {
        let &CycleTap { hole, sense, dwell_s, overrides, .. } = tap;
        let [a, b, _] = hole.plane.axes().map(canon::Axis::index);
        let (x, y) = (hole.at[a], hole.at[b]);
        let level = |value: f64| match hole.plane {
            Plane::XY => [x, y, value, hole.at[3], hole.at[4], hole.at[5]],
            Plane::ZX => [value, x, y, hole.at[3], hole.at[4], hole.at[5]],
            Plane::YZ => [y, value, x, hole.at[3], hole.at[4], hole.at[5]],
        };
        self.feed_override(place, false);
        self.speed_override(place, false);
        self.numbers(place, b"STRAIGHT_FEED", &level(hole.bottom));
        self.text(place, "STOP_SPINDLE_TURNING(0)");
        self.turn(place, sense.reversed());
        self.numbers(place, b"DWELL", &[dwell_s]);
        self.numbers(place, b"STRAIGHT_FEED", &level(hole.clear));
        self.text(place, "STOP_SPINDLE_TURNING(0)");
        self.turn(place, sense);
        if overrides.0 {
            self.feed_override(place, true);
        }
        if overrides.1 {
            self.speed_override(place, true);
        }
    }

    fn output(&mut self, place: &Place, output: &canon::Output) {
        let kind = if output.with_motion { "MOTION" } else { "AUX" };
        let number = output.number;
        let text = match output.signal {
            canon::Signal::Digital { on: true } => format!("SET_{kind}_OUTPUT_BIT({number})"),
            canon::Signal::Digital { on: false } => format!("CLEAR_{kind}_OUTPUT_BIT({number})"),
            canon::Signal::Analogue { value } => {
                format!("SET_{kind}_OUTPUT_VALUE({number},{value:.6})")
            }
        };
        self.text(place, &text);
    }

    fn arc(&mut self, place: &Place, plane: Plane, to: &Point, centre: [f64; 2], turns: i32) {
        let [a, b, n] = plane.axes().map(canon::Axis::index);
        self.begin(place);
        self.buffer.extend_from_slice(b"ARC_FEED(");
        for value in [to[a], to[b], centre[0], centre[1]] {
            push_fixed4(&mut self.buffer, value);
            self.buffer.extend_from_slice(b", ");
        }
        if turns < 0 {
            self.buffer.push(b'-');
        }
        push_whole(&mut self.buffer, u64::from(turns.unsigned_abs()));
        for value in [to[n], to[3], to[4], to[5]] {
            self.buffer.extend_from_slice(b", ");
            push_fixed4(&mut self.buffer, value);
        }
        self.buffer.extend_from_slice(b")\n");
        self.end();
    }

    /// In inches, which LinuxCNC's table has where no machine is configured.
    fn tool_entry(&mut self, place: &Place, rank: u32, entry: &crate::ToolEntry) {
        let mut offset = entry.offset;
        crate::geometry::frame::scale(&mut offset, 1.0 / units::MM_PER_INCH);
        let offset = offset.map(|v| format!("{v:.4}")).join(" ");
        self.text(
            place,
            &format!(
                "SET_TOOL_TABLE_ENTRY({rank}, {}, {offset}, {:.4}, {:.4}, {})",
                entry.number, entry.front_angle, entry.back_angle, entry.orientation
            ),
        );
    }

    fn tool_offset(&mut self, place: &Place, p: &Point) {
        let triple = |i: usize| format!("{:.4} {:.4} {:.4}", p[i], p[i + 1], p[i + 2]);
        self.text(
            place,
            &format!("USE_TOOL_LENGTH_OFFSET({}, {}, {})", triple(0), triple(3), triple(6)),
        );
    }
}

impl<W: Write> Sink for Listing<W> {
    fn take_time_passed(&mut self) -> bool {
        core::mem::take(&mut self.time_passed)
    }

    #[inline]
    fn call(&mut self, place: &Place, call: &Call<'_>) {
        self.time_passed |= takes_time(call);
        match call {
            Call::Line(to) => self.point(place, b"STRAIGHT_FEED", to),
            Call::Rapid(to) => self.point(place, b"STRAIGHT_TRAVERSE", to),
            Call::Arc { plane, to, centre, turns } => self.arc(place, *plane, to, *centre, *turns),
            Call::FeedRate { rate, .. } => self.numbers(place, b"SET_FEED_RATE", &[*rate]),
            other => self.seldom(place, other),
        }
    }
}

/// Returns true if a machine may move or waits by a call.
const fn takes_time(call: &Call<'_>) -> bool {
    match call {
        Call::Dwell(seconds) => *seconds > 0.0,
        _ => matches!(
            call,
            Call::Line(_)
                | Call::Rapid(_)
                | Call::Arc { .. }
                | Call::Spline { .. }
                | Call::Probe { .. }
                | Call::Tap(_)
                | Call::RigidTap { .. }
                | Call::GrowingThread(_)
                | Call::Cam(_)
        ),
    }
}

impl<W: Write> Listing<W> {
    /// LinuxCNC has no call for it.
    fn throw_chips(&mut self, place: &Place, hole: &crate::call::CycleHole) {
        if let Some(rpm) = hole.throw_rpm {
            self.text(place, &format!("COMMENT(\"throw chips off at {rpm} rpm\")"));
        }
    }

    /// LinuxCNC has no call for it: turn by turn, each with its mean lead.
    fn growing_thread(&mut self, place: &Place, thread: &GrowingThread) {
        for (lead, to) in thread.turns() {
            self.text(place, &format!("START_SPEED_FEED_SYNC({lead:.6},0)"));
            self.point(place, b"STRAIGHT_FEED", &to);
        }
        self.text(place, "STOP_SPEED_FEED_SYNCH()");
    }

    /// What is not on the fast path.
    fn seldom(&mut self, place: &Place, call: &Call<'_>) {
        match call {
            Call::Line(_)
            | Call::Rapid(_)
            | Call::Arc { .. }
            | Call::FeedRate { .. }
            | Call::Hole(_)
            | Call::OutByHand(_)
            | Call::Input(_)
            | Call::ThreadAngle(_) => {}
            Call::GrowingThread(thread) => self.growing_thread(place, thread),
            Call::WorkOffset(system, offset) => self.work_offset(place, *system, offset),
            Call::AddedOffset(offset) => self.point(place, b"SET_G92_OFFSET", offset),
            Call::Rotation(degrees) => self.numbers(place, b"SET_XY_ROTATION", &[*degrees]),
            Call::ToolOffset(offset) => self.tool_offset(place, offset),
            Call::PathControl { corners, merge } => self.path_control(place, *corners, *merge),
            Call::Tap(tap) => {
                self.tap(place, tap);
                self.throw_chips(place, &tap.hole);
            }
            Call::RigidTap { to, lead, .. } => {
                self.text(place, &format!("START_SPEED_FEED_SYNC({lead:.6},0)"));
                self.numbers(place, b"RIGID_TAP", &to[..3]);
                self.text(place, "STOP_SPEED_FEED_SYNCH()");
            }
            Call::SyncStart(lead) => {
                self.text(place, &format!("START_SPEED_FEED_SYNC({lead:.6},0)"));
            }
            Call::ThrowChips(hole) => self.throw_chips(place, hole),
            Call::Cam(order) => self.text(place, &format!("CAM({order:?})")),
            Call::Dwell(seconds) => self.numbers(place, b"DWELL", &[*seconds]),
            Call::SpindleSpeed(speed) => {
                self.text(place, &format!("SET_SPINDLE_SPEED(0, {speed:.4})"));
            }
            Call::SpindleMode(limit) => {
                let limit = limit.min(NO_SPEED_LIMIT);
                self.text(place, &format!("SET_SPINDLE_MODE(0 {limit:.4})"));
            }
            Call::SpindleTurn(sense) => self.turn(place, *sense),
            Call::SpindleOrient { angle, mode, longest, .. } => {
                self.text(place, &format!("ORIENT_SPINDLE(0, {angle:.4}, {mode})"));
                if let Some(longest) = longest {
                    self.text(place, &format!("SPINDLE.0.WAIT_ORIENT_COMPLETE({longest:.4})"));
                }
            }
            Call::SelectTool(number) => self.text(place, &format!("SELECT_TOOL({number})")),
            Call::ChangeTool(number) => self.text(place, &format!("CHANGE_TOOL({number})")),
            Call::ToolNumber(number) => self.text(place, &format!("CHANGE_TOOL_NUMBER({number})")),
            Call::Spline { points, .. } => {
                self.text(place, &format!("NURBS_FEED({}, ...)", points.len()));
            }
            Call::Probe { to, .. } => {
                self.text(place, "TURN_PROBE_ON()");
                self.point(place, b"STRAIGHT_PROBE", to);
                self.text(place, "TURN_PROBE_OFF()");
            }
            Call::Polygon(order) => self.text(
                place,
                &format!(
                    "COMMENT(\"polygon turning {}:{} at {:.4} degrees\")",
                    order.ratio.master, order.ratio.follower, order.phase_deg
                ),
            ),
            Call::PolygonMeasure(looks) => {
                self.text(place, &format!("COMMENT(\"measure the oscillation, {looks} looks\")"));
            }
            Call::PolygonEnd => self.text(place, "COMMENT(\"end of polygon turning\")"),
            Call::Hob(order) => {
                let HobOrder { teeth, starts, .. } = order;
                self.text(place, &format!("COMMENT(\"hobbing {starts}:{teeth}\")"));
            }
            Call::HobEnd => self.text(place, "COMMENT(\"end of hobbing\")"),
            Call::StrokeCheck(zone) => {
                let on = if zone.is_some() { "on" } else { "off" };
                self.text(place, &format!("COMMENT(\"stored stroke check {on}\")"));
            }
            Call::ToolTableEntry { rank, entry } => self.tool_entry(place, *rank, entry),
            Call::Output(output) => self.output(place, output),
            Call::User { number, p, q, .. } => {
                let [p, q] = [*p, *q].map(|value| value.unwrap_or(-1.0));
                self.text(place, &format!("USER_DEFINED_FUNCTION({number}, {p:.4}, {q:.4})"));
            }
            Call::FeedOverride(on) => self.feed_override(place, *on),
            Call::SpeedOverride(on) => self.speed_override(place, *on),
            Call::Comment(text) => self.pieces(place, ["COMMENT(\"", text, "\")\n"]),
            Call::Note(text) => self.pieces(place, ["COMMENT(\"interpreter: ", text, "\")\n"]),
            Call::Message(text) => self.text(place, &format!("MESSAGE(\"{text}\")")),
            Call::Print(text) => {
                self.buffer.extend_from_slice(text.as_bytes());
                self.buffer.push(b'\n');
            }
            Call::LogOpen(file) => self.text(place, &format!("LOGOPEN(\"{file}\")")),
            Call::Log(text) => self.text(place, &format!("LOG(\"{text}\")")),
            plain => self.text(place, Self::plain(plain)),
        }
    }

    /// Calls without numbers.
    const fn plain(call: &Call<'_>) -> &'static str {
        match call {
            Call::Reset => "ON_RESET()",
            Call::FeedReference => "SET_FEED_REFERENCE(CANON_XYZ)",
            Call::UseUnits(Units::Inch) => "USE_LENGTH_UNITS(CANON_UNITS_INCHES)",
            Call::UseUnits(Units::Millimetre) => "USE_LENGTH_UNITS(CANON_UNITS_MM)",
            Call::SelectPlane(Plane::XY) => "SELECT_PLANE(CANON_PLANE_XY)",
            Call::SelectPlane(Plane::ZX) => "SELECT_PLANE(CANON_PLANE_XZ)",
            Call::SelectPlane(Plane::YZ) => "SELECT_PLANE(CANON_PLANE_YZ)",
            Call::FeedMode { per_revolution: false } => "SET_FEED_MODE(0, 0)",
            Call::FeedMode { per_revolution: true } => "SET_FEED_MODE(0, 1)",
            Call::SyncStop => "STOP_SPEED_FEED_SYNCH()",
            Call::SpindleStop => "STOP_SPINDLE_TURNING(0)",
            Call::StartChange => "START_CHANGE()",
            Call::ReloadTools => "RELOAD_TOOLDATA()",
            Call::Mist(true) => "MIST_ON()",
            Call::Mist(false) => "MIST_OFF()",
            Call::Flood(true) => "FLOOD_ON()",
            Call::Flood(false) => "FLOOD_OFF()",
            Call::AdaptiveFeed(true) => "ENABLE_ADAPTIVE_FEED()",
            Call::AdaptiveFeed(false) => "DISABLE_ADAPTIVE_FEED()",
            Call::FeedHold(true) => "ENABLE_FEED_HOLD()",
            Call::FeedHold(false) => "DISABLE_FEED_HOLD()",
            Call::Stop => "PROGRAM_STOP()",
            Call::OptionalStop => "OPTIONAL_PROGRAM_STOP()",
            Call::PalletShuttle => "PALLET_SHUTTLE()",
            Call::End => "PROGRAM_END()",
            Call::Finish => "FINISH()",
            Call::LogClose => "LOGCLOSE()",
            _ => "",
        }
    }
}
