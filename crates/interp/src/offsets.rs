//! Offsets: G10, G43, G49, G52, G54 … G59.3, G92, and the reference points of G28 and G30.
//!
//! Setting an offset moves nothing: the axes stand where they stand, and the program's name for that
//! place changes ([`State::reframe`](crate::state::State::reframe)). Offsets are kept in the program's
//! units and in the numbered parameters (mm), as LinuxCNC does, so that `#5221` reads G54's X.
use crate::{
    call::{Call, Sink},
    codes::{GGroup, NON_STOP_CHANGE},
    execute::Executor,
    fault::{Outcome, error, refuse},
    frame::{self, Frame, Point},
    setup::Parameters,
};

/// First parameter of the G92 offset, and the one that says whether it is on.
const ADDED: usize = 5211;
const ADDED_ON: usize = 5210;
/// Work offset in force.
const SYSTEM: usize = 5220;

impl Executor {
    /// Offsets as the parameters have them, at the beginning.
    pub(crate) fn load_offsets(&mut self) {
        let system = self.store.numbered.at(SYSTEM);
        let most = if self.has_external_offset() { 57.0 } else { 9.0 };
        let system = if (1.0..=most).contains(&system) { system as u8 } else { 1 };
        if self.store.numbered.at(ADDED_ON) != 0.0 {
            self.state.frame.added = self.read_point(ADDED);
        }
        self.select_system(system);
    }

    /// Make a work offset the one in force.
    pub(crate) fn select_system(&mut self, system: u8) {
        let (mut origin, rotation) = self.system(usize::from(system));
        self.add_external(&mut origin);
        self.state.system = system;
        self.store.numbered.set(SYSTEM, f64::from(system));
        self.state.reframe(|frame| {
            frame.origin = origin;
            frame.rotate(rotation);
        });
    }

    fn has_external_offset(&self) -> bool {
        self.rules.external_offset
    }

    /// Fanuc's external work offset lies under all others.
    fn add_external(&self, origin: &mut Point) {
        if self.has_external_offset() {
            let external = self.read_point(Parameters::work_offset(0));
            for axis in 0..6 {
                origin[axis] += external[axis];
            }
        }
    }

    /// A work offset (0 is the external one) has other values now.
    pub(crate) fn offset_changed<S: Sink>(&mut self, system: usize, sink: &mut S) {
        if system == usize::from(self.state.system) || system == 0 {
            self.select_system(self.state.system);
            let origin = self.state.frame.origin;
            self.say(sink, &Call::WorkOffset(self.state.system, origin));
        }
    }

    /// Offset (program units) and rotation (degrees) of a work offset.
    pub(crate) fn system(&self, system: usize) -> (Point, f64) {
        let first = Parameters::work_offset(system);
        (self.read_point(first), self.store.numbered.at(first + 9))
    }

    /// Nine parameters, lengths in program units.
    fn read_point(&self, first: usize) -> Point {
        let mut point = self.store.numbered.point(first);
        frame::scale(&mut point, 1.0 / self.state.units.in_mm());
        point
    }

    fn write_point(&mut self, first: usize, mut point: Point) {
        frame::scale(&mut point, self.state.units.in_mm());
        self.store.numbered.set_point(first, &point);
    }

    /// A word of an axis; diameters become radii.
    #[inline]
    pub(crate) fn axis_word(&self, axis: usize) -> Option<f64> {
        let value = self.words.get(b"XYZABCUVW"[axis])?;
        Some(if axis == 0 && self.state.diameter { value / 2.0 } else { value })
    }

    /// A point with the block's axis words put in.
    pub(crate) fn with_words(&self, mut point: Point) -> Point {
        for (axis, slot) in point.iter_mut().enumerate() {
            if let Some(value) = self.axis_word(axis) {
                *slot = value;
            }
        }
        point
    }

    /// G43, G43.1, G43.2, G49.
    pub(crate) fn tool_length<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let Some(code) = self.words.g(GGroup::ToolLength) else { return Ok(()) };
        let mut tool = [0.0; 9];
        match code {
            430 => {
                let number = if self.words.get(b'H').is_some() {
                    self.tool_word(b'H')?
                } else {
                    self.state.current_tool
                };
                tool = self.length_offset(number);
            }
            crate::codes::LENGTH_BACK => {
                let number = self.tool_word(b'H')?;
                tool = self.length_offset(number).map(|offset| -offset);
            }
            432 => {
                let more = self.additional_offset()?;
                for (sum, (kept, more)) in
                    tool.iter_mut().zip(self.state.frame.tool.iter().zip(more))
                {
                    *sum = kept + more;
                }
            }
            431 => tool = self.with_words(self.state.frame.tool),
            _ => {}
        }
        self.state.reframe(|frame| frame.tool = tool);
        self.say(sink, &Call::ToolOffset(tool));
        Ok(())
    }

    /// What the table says of a tool, in program units.
    fn length_offset(&self, number: u32) -> Point {
        let mut tool = self.tool_entry(number).offset;
        frame::scale(&mut tool, 1.0 / self.state.units.in_mm());
        tool
    }

    /// G43.2: of a tool, or of the axis words.
    fn additional_offset(&mut self) -> Outcome<Point> {
        let by_words = self.words.any(crate::codes::AXES);
        match (self.words.get(b'H').is_some(), by_words) {
            (true, false) => {
                let number = self.tool_word(b'H')?;
                Ok(self.length_offset(number))
            }
            (false, true) => Ok(self.with_words([0.0; 9])),
            (both, _) => {
                let found = if both { "both" } else { "neither" };
                let text = format!(
                    "G43.2 needs H, the number of a tool, or axis words with the offset itself; found {found}"
                );
                refuse("I0612", self.words.place.span, text)
            }
        }
    }

    /// Number of a work offset by its code: 540 is 1.
    pub(crate) const fn system_of(code: u16) -> u8 {
        match code {
            591..=593 => (code - 584) as u8,
            _ => ((code - 530) / 10) as u8,
        }
    }

    /// G54 … G59.3.
    pub(crate) fn work_offset<S: Sink>(&mut self, sink: &mut S) {
        let Some(code) = self.words.g(GGroup::WorkOffset) else { return };
        let system = Self::system_of(code);
        if system == self.state.system {
            self.say(sink, &Call::Note("continuing to use same coordinate system"));
            return;
        }
        self.change_system(system, sink);
    }

    /// Another work offset, and say so.
    pub(crate) fn change_system<S: Sink>(&mut self, system: u8, sink: &mut S) {
        self.select_system(system);
        let frame = self.state.frame;
        self.say(sink, &Call::WorkOffset(system, frame.origin));
        self.say(sink, &Call::AddedOffset(frame.added));
        self.say(sink, &Call::Rotation(frame.rotation()));
    }

    /// G10, G28, G30, G52, G92 and their kin.
    pub(crate) fn non_modal<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        match self.words.g(GGroup::NonModal) {
            Some(100) => self.set_offset(sink),
            Some(280) => self.go_to_reference(5161, sink),
            Some(300) => self.go_to_reference(5181, sink),
            Some(281) => {
                self.set_reference(5161);
                Ok(())
            }
            Some(301) => {
                self.set_reference(5181);
                Ok(())
            }
            Some(520) if !self.words.any(crate::codes::AXES) => {
                refuse("I0619", self.words.place.span, "G52 needs axis words: the offset to add")
            }
            Some(520) => {
                let added = self.with_words(self.state.frame.added);
                self.set_added(added, sink);
                Ok(())
            }
            Some(920) => self.set_position(sink),
            Some(921) => {
                self.write_point(ADDED, [0.0; 9]);
                self.suspend_added(sink);
                Ok(())
            }
            Some(922) => {
                self.suspend_added(sink);
                Ok(())
            }
            Some(923) => {
                let added = self.read_point(ADDED);
                self.set_added(added, sink);
                Ok(())
            }
            Some(NON_STOP_CHANGE) => self.non_stop_move(sink),
            Some(502) => {
                self.polygon_end(sink);
                Ok(())
            }
            Some(512) => self.polygon(sink),
            Some(513) => self.harmonic(),
            Some(514) => self.polygon_measure(sink),
            Some(530) if self.words.g(GGroup::Motion).is_none() => self.lonely_g53(),
            _ => Ok(()),
        }
    }

    fn lonely_g53(&self) -> Outcome {
        let moves =
            matches!(self.state.motion, crate::state::Motion::Rapid | crate::state::Motion::Feed);
        if moves && self.words.any(crate::codes::AXES) {
            return Ok(());
        }
        refuse(
            "I0405",
            self.words.place.span,
            "G53 needs G0 or G1 and axis words: it is good for its own block only",
        )
    }

    /// G92: this place shall be called what the words say.
    fn set_position<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        if !self.words.any(crate::codes::AXES) {
            return refuse(
                "I0613",
                self.words.place.span,
                "G92 needs axis words: what this place shall be called",
            );
        }
        let wanted = self.with_words(self.state.at);
        let mut added = self.state.frame.added;
        for i in 0..9 {
            added[i] += self.state.at[i] - wanted[i];
        }
        self.set_added(added, sink);
        Ok(())
    }

    pub(crate) fn set_added<S: Sink>(&mut self, added: Point, sink: &mut S) {
        self.write_point(ADDED, added);
        self.store.numbered.set(ADDED_ON, 1.0);
        self.state.reframe(|frame| frame.added = added);
        self.say(sink, &Call::AddedOffset(added));
    }

    fn suspend_added<S: Sink>(&mut self, sink: &mut S) {
        self.store.numbered.set(ADDED_ON, 0.0);
        self.state.reframe(|frame| frame.added = [0.0; 9]);
        self.say(sink, &Call::AddedOffset([0.0; 9]));
    }

    /// G10 L2 (the offset itself) and L20 (this place shall be called what the words say).
    fn set_offset<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let span = self.words.place.span;
        let kind = match self.words.whole(b'L', 9999)? {
            Some(kind @ (2 | 20)) => kind,
            Some(kind @ (0 | 1 | 10 | 11)) => return self.set_tool(kind, sink),
            Some(kind) => self.unknown_g10(kind)?,
            None => {
                return refuse(
                    "I0616",
                    span,
                    "G10 needs L: 1, 10, 11 (tool table), 2 or 20 (work offset)",
                );
            }
        };
        let Some(p) = self.words.whole(b'P', 9)? else {
            return refuse(
                "I0617",
                span,
                "G10 needs P: 1 to 9 for G54 to G59.3, 0 for the one in force",
            );
        };
        let system = if p == 0 { self.state.system } else { p as u8 };
        if self.compensating && system == self.state.system {
            let text =
                "the work offset in force cannot be changed while cutter radius compensation is on";
            return Err(error("I0544", span, text).with_help("write G40 before").into());
        }
        let (mut origin, mut rotation) = self.system(usize::from(system));
        if kind == 2 {
            origin = self.with_words(origin);
            rotation = self.words.get(b'R').unwrap_or(rotation);
        } else {
            if self.words.get(b'R').is_some() {
                let fault = error("I0618", self.words.span(b'R'), "R has no effect with G10 L20");
                return Err(fault.with_help("G10 L2 R sets the rotation").into());
            }
            origin = self.origin_by_position(origin, rotation);
        }
        let first = Parameters::work_offset(usize::from(system));
        self.write_point(first, origin);
        self.store.numbered.set(first + 9, rotation);
        self.add_external(&mut origin);
        if system == self.state.system {
            self.state.reframe(|frame| {
                frame.origin = origin;
                frame.rotate(rotation);
            });
            self.say(sink, &Call::WorkOffset(system, origin));
            self.say(sink, &Call::Rotation(rotation));
        } else {
            self.say(sink, &Call::Note("setting coordinate system origin"));
        }
        Ok(())
    }

    /// The origin that a work offset must have for this place to be called what the words say.
    fn origin_by_position(&self, origin: Point, rotation: f64) -> Point {
        let machine = self.state.frame.to_machine(&self.state.at);
        let mut frame: Frame = self.state.frame;
        frame.origin = origin;
        frame.rotate(rotation);
        let wanted = self.with_words(frame.to_program(&machine));
        frame.origin = [0.0; 9];
        let without = frame.to_machine(&wanted);
        core::array::from_fn(|i| machine[i] - without[i])
    }

    /// G28, G30: by the point of the words (or from where it stands) to the reference point.
    fn go_to_reference<S: Sink>(&mut self, first: usize, sink: &mut S) -> Outcome {
        let by = self.destination(false)?;
        self.say(sink, &Call::Rapid(by));
        let reference = self.state.frame.to_program(&self.read_point(first));
        let mut to = by;
        let all = !self.words.any(crate::codes::AXES);
        for axis in 0..9 {
            if all || self.axis_word(axis).is_some() {
                to[axis] = reference[axis];
            }
        }
        self.state.at = to;
        self.say(sink, &Call::Rapid(to));
        Ok(())
    }

    /// G28.1, G30.1: this place is the reference point from now on.
    fn set_reference(&mut self, first: usize) {
        let machine = self.state.frame.to_machine(&self.state.at);
        self.write_point(first, machine);
    }
}
