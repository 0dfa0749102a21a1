//! What the kernel and the program say becomes what the operator hears: notices, messages, alarms.
use super::control::Control;
use super::event::{Alarm, Event};
use super::message::MessageStatus;
use crate::messages::Message;
use crate::services::supervision;

/// Alarms that are remembered.
const MOST_ALARMS: usize = 200;

impl Control {
    /// What the kernel says becomes what the operator hears.
    pub(super) fn hear(&mut self, heard: &[kernel::Event]) {
        use kernel::EventKind;
        for event in heard {
            match &event.kind {
                EventKind::Operator(notice) => self.events.notice(notice.to_string()),
                EventKind::FollowingWarning { axis, error } => {
                    let (letter, by) = (axis.letter(), axis.reading(*error));
                    let cause = format!("following {letter}");
                    self.events.notice_of(&cause, format!("{letter}: following error {by:.4}"));
                }
                EventKind::SyncWarning { error } => {
                    let cause = format!("sync error {}", event.op);
                    let text = format!("line {}: sync error {error}", event.line);
                    self.events.notice_of(&cause, text);
                }
                EventKind::TapSupervised(seen) if supervision::is_remarkable(seen) => {
                    let (line, tool) = (event.line, seen.tool);
                    let cause = format!("supervision {}", event.op);
                    let text = format!("line {line}, T{tool}: {}", supervision::sentence(seen));
                    self.events.notice_of(&cause, text);
                }
                EventKind::Homed { axis, deviation } => {
                    self.keep_homed(*axis);
                    let (letter, deviation) = (axis.letter(), deviation.map(|by| axis.reading(by)));
                    self.events.notice(match deviation {
                        None => format!("{letter} is homed"),
                        Some(by) => format!("{letter} is homed, {by:+.4} from before"),
                    });
                }
                EventKind::HomingStopped { axis } => {
                    self.events
                        .notice(format!("{} was stopped before it was homed", axis.letter()));
                }
                EventKind::StoppedBySwitch { axis } => {
                    let letter = axis.letter();
                    self.events.notice(format!(
                        "{letter} stands on its limit switch: jog it the other way, then home it"
                    ));
                }
                EventKind::ToolChanged { tool } => {
                    self.events.notice(format!("tool {tool} is in the spindle"));
                }
                _ => {}
            }
        }
    }

    /// What the program says reaches the operator, and the log.
    pub(super) fn hear_program(&mut self, is_over: bool) {
        let op = self.executor.kernel.report().op;
        let Some(under_way) = &mut self.under_way else { return };
        let mut said = Vec::new();
        while let Some(message) = under_way.running.next_message(op, is_over) {
            said.push((under_way.name.clone(), message));
        }
        for (program, Message { line, text }) in said {
            self.keep_message(&program, line, &text);
            let time_s = self.now().value();
            self.events.message(format!("line {line}: {}", text.trim()));
            self.message = Some(MessageStatus { text: text.trim().into(), line, time_s });
        }
    }

    /// Faults of the kernel become alarms, each once.
    pub(super) fn take_alarms(&mut self) {
        let faults = self.executor.kernel.faults();
        self.told_faults = self.told_faults.min(faults.len());
        let new: Vec<_> = faults[self.told_faults..].to_vec();
        self.told_faults = faults.len();
        if !new.is_empty() && self.under_way.is_none() {
            self.everything_was_stopped(); // a spindle that turned on from what was typed
        }
        for fault in new {
            let program = self.under_way.as_ref().map(|under_way| under_way.name.clone());
            let alarm = Alarm::of(&fault, program);
            if self.alarms.len() == MOST_ALARMS {
                self.alarms.remove(0);
            }
            self.keep_alarm(&alarm);
            self.alarms.push(alarm.clone());
            self.events.push(Event::Alarm(alarm));
        }
    }
}
