//! What outlives the control is saved when it changes, and in force again when it is switched on.
use super::control::Control;
use super::event::{Alarm, Event};
use super::kept::kept_parameters;
use super::offsets;
use super::ranges;
use super::request::{Accepted, Refusal};
use super::writer::{Key, Ticket};
use crate::clock::unix_ms;
use crate::config;
use crate::job::Left;
use crate::observers::use_up;
use canon::Axis;
use store::state::{
    AlarmRecord, HomedAxis, LastProgram, Settings, State, StateChange, StateFolder, message_log,
};
use units::{Length, Time};

/// References that differ by no more are the same, mm or degrees.
const SAME_REFERENCE: f64 = 1e-6;

impl Control {
    /// What was kept is in force again.
    pub(super) fn take_kept(&mut self, state: State) {
        if let Some(parameters) = state.parameters {
            for (number, value) in parameters.iter() {
                self.data.parameters.set(number as usize, value);
            }
        }
        if let Some(tools) = state.tools {
            self.data.tools = tools;
        }
        self.take_broken_tools();
        self.take_changer(state.changer);
        self.alarms = state.alarms.into_iter().map(remembered).collect();
        self.raise_state_changes(state.changes);
        if let Some(Settings {
            feed_override,
            rapid_override,
            spindle_override,
            single_block,
            optional_stop,
            block_skip,
            ..
        }) = state.settings
        {
            let kernel = &mut self.executor.kernel;
            kernel.order(kernel::Order::FeedOverride(feed_override));
            kernel.order(kernel::Order::RapidOverride(rapid_override));
            kernel.order(kernel::Order::SpindleOverride(spindle_override));
            kernel.order(kernel::Order::SingleBlock(single_block));
            kernel.order(kernel::Order::OptionalStop(optional_stop));
            while kernel.next_event().is_some() {} // of orders from before the control was on
            self.options.program.block_skip = block_skip;
        }
        if let Some(last) = state.last_program {
            self.events.notice(said_of(&last));
            self.last_program = Some(last);
        }
    }

    /// Parameters, work offsets among them, are on the disk.
    pub(super) fn keep_parameters(&mut self) -> Result<(), Refusal> {
        let parameters = kept_parameters(&self.data.parameters);
        self.kept.save(Key::Parameters, move |folder| folder.save_parameters(&parameters))
    }

    /// The tools are on the disk.
    pub(super) fn keep_tools(&mut self) -> Result<(), Refusal> {
        let tools = self.data.tools.clone();
        self.kept.save(Key::Tools, move |folder| folder.save_tools(&tools))
    }

    /// Overrides and switches are on the disk.
    pub(super) fn keep_settings(&mut self) -> Result<(), Refusal> {
        let operator = self.executor.kernel.operator();
        let settings = Settings {
            feed_override: operator.share(false),
            rapid_override: operator.share(true),
            spindle_override: operator.spindle_share(),
            single_block: operator.single_block(),
            optional_stop: operator.optional_stop(),
            block_skip: self.options.program.block_skip.clone(),
            ..Settings::default()
        };
        self.kept.save(Key::Settings, move |folder| folder.save_settings(&settings))
    }

    /// Which program it is, and how far it has come, is on the disk.
    pub(super) fn keep_program(&mut self) -> Result<(), Refusal> {
        let Some(last) = self.last_program.clone() else { return Ok(()) };
        self.kept.save(Key::Program, move |folder| folder.save_last_program(&last))
    }

    /// What a program that is under way has cut is on the disk: how far it is, what its tools have
    /// cut, the workpiece, the run. What could not be kept is said.
    pub(super) fn keep_progress(&mut self) {
        let kept = [self.keep_program(), self.keep_used_tools(), self.keep_workpiece()];
        for why in kept.into_iter().filter_map(Result::err) {
            self.events.notice(why.to_string());
        }
    }

    /// The tools are on the disk, with what the program under way has cut with them so far.
    fn keep_used_tools(&mut self) -> Result<(), Refusal> {
        let Some(under_way) = &self.under_way else { return Ok(()) };
        let mut tools = self.data.tools.clone();
        use_up(&mut tools, &under_way.running.tool_use());
        self.kept.save(Key::Tools, move |folder| folder.save_tools(&tools))
    }

    /// What a program has changed; that it could not be kept is said, for nothing waits for an
    /// answer.
    pub(super) fn keep_all(&mut self) {
        let kept = [self.keep_parameters(), self.keep_tools(), self.keep_program()];
        for why in kept.into_iter().filter_map(Result::err) {
            self.events.notice(why.to_string());
        }
    }

    /// The reference of an axis whose encoder is absolute is on the disk: it holds as long as this
    /// machine's encoder does.
    pub(super) fn keep_homed(&mut self, axis: Axis) {
        if !self.has_absolute_encoder(axis) || self.kept.folder().is_none() {
            return;
        }
        let (letter, epoch) = (axis.letter(), self.epoch());
        let zero = self.executor.kernel.zero(axis).value();
        let mut homed = self.kept.homed.clone();
        homed.axis.retain(|kept| kept.axis != letter);
        homed.axis.push(HomedAxis { axis: letter, zero, epoch });
        let saved = homed.clone();
        match self.kept.save(Key::Homing, move |folder| folder.save_homed(&saved)) {
            Ok(()) => self.kept.homed = homed,
            Err(why) => self.events.notice(why.to_string()),
        }
    }

    /// The drives have come up: axes whose absolute encoders were referenced on this machine know
    /// where they are.
    pub(super) fn take_homed(&mut self) {
        if !self.state_changes.is_empty() {
            return; // they may not be those that were found
        }
        for homing in config::homing(&self.base.machine) {
            let axis = homing.axis;
            let Some(kept) = self.kept.homed.of(axis.letter(), self.epoch()).cloned() else {
                continue;
            };
            if !self.has_absolute_encoder(axis) || self.executor.kernel.is_homed(axis) {
                continue;
            }
            if self.executor.kernel.home(axis, &homing.how).is_err() {
                continue; // it is homed when it is asked for
            }
            let zero = self.executor.kernel.zero(axis).value();
            if (zero - kept.zero).abs() > SAME_REFERENCE {
                self.executor.kernel.forget_home(axis);
                let letter = axis.letter();
                self.events.notice(format!(
                    "{letter} is not homed: the machine file's reference of {letter} has changed by {:+.4} since it was; home {letter}",
                    zero - kept.zero
                ));
            }
        }
    }

    fn has_absolute_encoder(&self, axis: Axis) -> bool {
        let homing = config::homing(&self.base.machine);
        let absolute = |homing: &config::AxisHoming| {
            homing.axis == axis && homing.how.method == kernel::HomingMethod::Absolute
        };
        homing.iter().any(absolute)
    }

    /// What a program has said is in the log, a line of JSON each.
    pub(super) fn keep_message(&mut self, program: &str, line: u32, text: &str) {
        let (program, text) = (program.to_owned(), text.to_owned());
        let (unix_ms, time_s) = (unix_ms(), self.now().value());
        let kept = message_log::LoggedMessage { unix_ms, time_s, program, line, text };
        let write = move |folder: &mut StateFolder| {
            message_log::append(folder.path(), &kept)
                .map_err(|why| format!("a message is not kept: {why}"))
        };
        if let Err(why) = self.kept.write(Key::Message, Box::new(write)) {
            self.events.notice(why);
        }
    }

    pub(super) fn keep_alarm(&mut self, alarm: &Alarm) {
        let kept = AlarmRecord {
            number: u32::from(alarm.number),
            text: alarm.text.clone(),
            remedy: alarm.remedy.clone(),
            unix_ms: unix_ms(),
            program: alarm.program.clone(),
            line: (alarm.line > 0).then_some(alarm.line),
        };
        if let Err(why) = self.kept.save(Key::Alarm, move |folder| folder.save_alarm(kept)) {
            self.events.notice(why.to_string());
        }
    }
}

impl Control {
    /// From now on nothing waits for the disk: what is to be kept is written beside the control,
    /// and answers that depend on it come when it is. `before` is called in the thread that
    /// writes, before each write.
    pub fn keep_beside(&mut self, before: Box<dyn FnMut() + Send>) {
        self.kept.write_beside(before);
    }

    /// What was to be kept last.
    pub(in crate::operation) fn last_kept(&self) -> Option<Ticket> {
        self.kept.last()
    }

    /// Call this when it is on the disk, or cannot be written, and why.
    pub(super) fn when_kept(
        &self,
        ticket: Ticket,
        then: impl FnOnce(Result<(), String>) + Send + 'static,
    ) {
        self.kept.when_written(ticket, then);
    }

    /// What could not be kept is said.
    pub(super) fn say_unkept(&mut self) {
        for why in self.kept.take_failed() {
            self.events.notice(why);
        }
    }
}

/// Number of the alarm that the state in force is not what the control wrote last.
pub(super) const STATE_DIFFERS: u16 = 601;
/// Values that its text names; the status has all.
const MOST_NAMED: usize = 5;

impl Control {
    /// What is in force is not, or is not known to be, what the control wrote last: an alarm, and
    /// nothing that depends on it until it is acknowledged.
    fn raise_state_changes(&mut self, changes: Vec<StateChange>) {
        if changes.is_empty() {
            return;
        }
        let named: Vec<_> = changes.iter().take(MOST_NAMED).map(ToString::to_string).collect();
        let more = match changes.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!("; and {more} more"),
        };
        let alarm = Alarm {
            number: STATE_DIFFERS,
            text: format!(
                "the state in force is not what the control wrote last: {}{more}",
                named.join("; ")
            ),
            remedy: "Compare each value with the work, the tools and the machine, correct it, then acknowledge the state."
                .into(),
            program: None,
            line: 0,
            time: self.now(),
            is_cleared: false,
        };
        for change in &changes {
            self.events.notice(format!("state: {change}"));
        }
        let is_said = |known: &Alarm| known.number == alarm.number && known.text == alarm.text;
        if self.alarms.last().is_some_and(is_said) {
            self.alarms.pop(); // the one of the start before
        } else {
            self.keep_alarm(&alarm);
        }
        self.alarms.push(alarm.clone());
        self.events.push(Event::Alarm(alarm));
        self.state_changes = changes;
    }

    /// The operator has compared what is in force.
    pub(super) fn acknowledge_state(&mut self) -> Result<Accepted, Refusal> {
        if self.state_changes.is_empty() {
            return Err(Refusal::because(
                "nothing is to be acknowledged: what is in force is what the control wrote last",
            ));
        }
        self.kept.save(Key::Acknowledgement, StateFolder::acknowledge)?;
        let changes = std::mem::take(&mut self.state_changes);
        for alarm in self.alarms.iter_mut().filter(|alarm| alarm.number == STATE_DIFFERS) {
            alarm.is_cleared = true;
        }
        if self.executor.kernel.is_ready() && !self.is_tool_left() {
            self.take_homed();
        }
        let values = if changes.len() == 1 { "value" } else { "values" };
        let note = format!("{} {values} of the state acknowledged", changes.len());
        self.events.notice(note.clone());
        Ok(Accepted { notes: vec![note] })
    }

    /// What is in force and is not what the control wrote last, until it is acknowledged.
    pub fn state_changes(&self) -> &[StateChange] {
        &self.state_changes
    }

    /// Alarms that a reset clears are cleared.
    pub(super) fn clear_alarms(&mut self) {
        let stays = !self.state_changes.is_empty();
        for alarm in &mut self.alarms {
            alarm.is_cleared |= !(stays && alarm.number == STATE_DIFFERS);
        }
    }
}

/// An alarm from before the control was switched on.
fn remembered(alarm: AlarmRecord) -> Alarm {
    Alarm {
        number: u16::try_from(alarm.number).unwrap_or(u16::MAX),
        text: alarm.text,
        remedy: alarm.remedy,
        program: alarm.program,
        line: alarm.line.unwrap_or(0),
        time: Time::ZERO,
        is_cleared: true,
    }
}

/// How far the last program came.
fn said_of(last: &LastProgram) -> String {
    let LastProgram { path, line, feature, is_completed, .. } = last;
    if *is_completed || *line == 0 {
        format!("the last program was {path}")
    } else {
        format!("the last program was {path}: it was left at line {line}, in feature {feature}")
    }
}

/// What a program leaves behind, as the control takes it.
pub(super) fn take_left(control: &mut Control, left: Left) {
    let before = core::mem::replace(&mut control.data.parameters, left.parameters);
    control.data.leave(left.rest);
    hold_to_ranges(control, &before);
    let mut wrong = Vec::new();
    for (mut tool, entry) in left.tools {
        // an entry that the program has not changed is the table's: geometry and wear together
        let changed = |is: f64, was: f64| is.is_nan() || (is - was).abs() > 1e-9;
        let number = tool.number;
        let mut takes = |what: &str, is: f64, was: f64, from: f64| {
            let takes = changed(is, was);
            let why = takes.then(|| offsets::check_measure(what, number, is, from)).flatten();
            let is_right = why.is_none();
            wrong.extend(why.map(|why| format!("a program has set it: {why}; it stays at {was}")));
            takes && is_right
        };
        let worn = (tool.worn_length().value(), tool.worn_diameter().value());
        if takes("length", entry.offset[2], worn.0, -offsets::LONGEST) {
            tool.length = Length::mm(entry.offset[2]) - tool.wear.length;
        }
        if takes("diameter", entry.diameter, worn.1, 0.0) {
            tool.diameter = Length::mm(entry.diameter) - tool.wear.radius * 2.0;
        }
        // its life went on meanwhile: it may have broken
        tool.life = control.data.tools.get(tool.number).map_or(tool.life, |own| own.life);
        control.data.tools.insert(tool);
    }
    if !wrong.is_empty() {
        for why in wrong {
            control.events.notice(why);
        }
        control.forget_modes(); // they know the tool that is not taken
    }
}

/// A work offset that no request could have set is not taken from a program, either: the one before
/// stays, and that is said.
fn hold_to_ranges(control: &mut Control, before: &interp::Parameters) {
    let wrong = ranges::out_of_range(&control.data.parameters, &control.base.machine);
    if wrong.is_empty() {
        return;
    }
    for (number, why) in wrong {
        let value = before.get(number).unwrap_or(0.0);
        control.data.parameters.set(number, value);
        control.events.notice(format!("a program has set it: {why}; it stays at {value}"));
    }
    control.forget_modes(); // they know the offset that is not taken
}
