//! O-words executed: subprograms, branches, loops; M98 and M99.
use crate::{
    Sink, context,
    fault::{Outcome, error, refuse},
    interpreter::Interpreter,
    number::near_whole,
    out::Out,
    outline::{self, At, Mark, Outline},
    profile::cycle,
};
use gcode::{Keyword, Label, Value};
use std::sync::LazyLock;

/// Arguments of one call.
const MOST_ARGUMENTS: usize = 30;

/// A call that has not returned yet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Where to go on: file and place.
    pub(crate) file: usize,
    pub(crate) back: At,
    /// Loops of the caller that count.
    pub(crate) repeats: Vec<(u32, u64)>,
    /// Of M98: where the subprogram begins, and how often it is still to be executed after this.
    pub(crate) again: Option<(At, u32)>,
}

impl Interpreter<'_> {
    /// Execute the O-word of the block at hand.
    pub(crate) fn o_word<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        let Some(word) = self.block.o else { return Ok(()) };
        if word.keyword == Keyword::Program {
            return Ok(()); // the program's own number, or the begin of one that M98 calls
        }
        self.make_outline(self.file)?;
        let ends = matches!(word.keyword, Keyword::EndSub | Keyword::Return);
        let depth = self.executor.recording.as_ref().map(|recording| recording.depth);
        if ends && depth == Some(self.frames.len()) {
            return self.end_of_profile(out);
        }
        match word.keyword {
            Keyword::Call => return self.call(word.label),
            Keyword::EndSub | Keyword::Return => return self.give_back(out),
            _ => {}
        }
        let Some(i) = self.outline().at(self.block.span.start) else { return Ok(()) };
        let Mark { partner, end, closes_do, .. } = self.outline().marks[i];
        match word.keyword {
            Keyword::Sub => self.jump_after(partner),
            Keyword::If => {
                if self.argument()? == 0.0 {
                    self.next_clause(partner);
                }
            }
            Keyword::ElseIf if self.choosing => {
                self.choosing = false;
                if self.argument()? == 0.0 {
                    self.next_clause(partner);
                }
            }
            Keyword::ElseIf | Keyword::Else => self.jump_after(end),
            Keyword::While if closes_do => {
                if self.argument()? != 0.0 {
                    self.jump_after(partner);
                }
            }
            Keyword::While => {
                if self.argument()? == 0.0 {
                    self.jump_after(partner);
                }
            }
            Keyword::EndWhile => self.jump_to(partner),
            Keyword::Repeat => self.repeat(i, partner)?,
            Keyword::EndRepeat => self.end_repeat(partner),
            Keyword::Break => {
                self.forget_repeats(partner);
                self.jump_after(self.outline().marks[partner].partner);
            }
            Keyword::Continue => {
                self.forget_repeats(partner + 1);
                self.jump_to(self.outline().marks[partner].partner);
            }
            Keyword::EndIf
            | Keyword::Do
            | Keyword::Program
            | Keyword::Call
            | Keyword::EndSub
            | Keyword::Return => {}
        }
        Ok(())
    }

    fn outline(&self) -> &Outline {
        // Made before any O-word of the file is executed.
        static NONE: LazyLock<Outline> = LazyLock::new(Outline::default);
        self.outlines[self.file].as_ref().unwrap_or(&NONE)
    }

    /// Read a file's O-words; if they do not fit together, nothing of it can be executed.
    fn make_outline(&mut self, file: usize) -> Outcome {
        self.steered = true;
        if self.outlines[file].is_some() {
            return Ok(());
        }
        let (outline, faults) = Outline::of(self.sources[file], file as u16);
        self.outlines[file] = Some(outline);
        let mut faults = faults.into_iter();
        let Some(first) = faults.next() else { return Ok(()) };
        self.contents_are_faulty = true;
        self.report_all(faults);
        self.ended = true;
        Err(first.into())
    }

    pub(crate) fn jump(&mut self, at: At) {
        self.parsers[self.file].seek(at.0, at.1);
    }

    fn jump_after(&mut self, mark: usize) {
        if let Some(at) = self.outline().marks.get(mark).map(|m| m.after) {
            self.jump(at);
        }
    }

    fn jump_to(&mut self, mark: usize) {
        if let Some(at) = self.outline().marks.get(mark).map(|m| m.at) {
            self.jump(at);
        }
    }

    /// The condition was false: on to `elseif` (which is then asked), or behind `else` or `endif`.
    fn next_clause(&mut self, mark: usize) {
        let Some(keyword) = self.outline().marks.get(mark).map(|m| m.keyword) else { return };
        if keyword == Keyword::ElseIf {
            self.choosing = true;
            self.jump_to(mark);
        } else {
            self.jump_after(mark);
        }
    }

    /// The first argument of the O-word. A fault here leaves no way to go on.
    fn argument(&mut self) -> Outcome<f64> {
        let span = self.block.o.map_or(self.block.span, |o| o.span);
        let value = self.block.arguments.first().copied().unwrap_or(Value::Number(0.0));
        self.executor.modes.line = self.block.span.line;
        let result = self.executor.values().evaluate(&self.block, value, span);
        self.ended |= result.is_err();
        result
    }

    fn repeat(&mut self, begin: usize, end: usize) -> Outcome {
        let count = self.argument()?.round();
        if count < 1.0 {
            self.jump_after(end);
        } else {
            self.repeats.push((self.outline().marks[begin].at.0, count as u64));
        }
        Ok(())
    }

    fn end_repeat(&mut self, begin: usize) {
        let Some(at) = self.outline().marks.get(begin).map(|mark| mark.at.0) else { return };
        match self.repeats.last_mut() {
            Some((mark, left)) if *mark == at && *left > 1 => {
                *left -= 1;
                self.jump_after(begin);
            }
            Some((mark, _)) if *mark == at => _ = self.repeats.pop(),
            _ => {}
        }
    }

    /// Loops begun at or after a mark are over.
    fn forget_repeats(&mut self, mark: usize) {
        let from = self.outline().marks.get(mark).map_or(u32::MAX, |mark| mark.at.0);
        while self.repeats.last().is_some_and(|(begin, _)| *begin >= from) {
            self.repeats.pop();
        }
    }

    fn call(&mut self, label: Label) -> Outcome {
        let span = self.block.o.map_or(self.block.span, |o| o.span);
        self.executor.modes.line = self.block.span.line;
        let (file, mark) = self.called(label, span)?;
        let count = self.block.arguments.len();
        let mut arguments = [0.0; MOST_ARGUMENTS];
        if count > MOST_ARGUMENTS {
            let text = format!(
                "a call takes {MOST_ARGUMENTS} arguments at most (#1 to #{MOST_ARGUMENTS}), found {count}"
            );
            return refuse("I0309", span, text);
        }
        for (argument, value) in arguments.iter_mut().zip(&self.block.arguments) {
            *argument = self.executor.values().evaluate(&self.block, *value, span)?;
        }
        self.enter(file, mark, None, span)?;
        self.executor.store.enter(&arguments[..count]);
        Ok(())
    }

    /// The subprogram that a label names.
    fn called(&mut self, label: Label, span: diag::Span) -> Outcome<(usize, usize)> {
        if let Label::Number(number) = label {
            // made before any O-word of the file is executed
            if let Some(mark) = self.outline().numbered(number) {
                return Ok((self.file, mark));
            }
        }
        let key = match outline::key(&self.block, label) {
            Some(key) => key,
            None => self.computed_key(label, span)?,
        };
        self.find_sub(&key, span)
    }

    fn computed_key(&self, label: Label, span: diag::Span) -> Outcome<Box<str>> {
        let Label::Computed(value) = label else { return Ok("".into()) };
        let number = self.executor.values().evaluate(&self.block, value, span)?;
        match near_whole(number).filter(|n| *n >= 0) {
            Some(number) => Ok(number.to_string().into()),
            None => refuse("I0310", span, format!("O takes a whole number, found {number}")),
        }
    }

    /// A subprogram: in this file, in the program, or in a file of its name.
    fn find_sub(&mut self, key: &str, span: diag::Span) -> Outcome<(usize, usize)> {
        let name = key.trim_start_matches('<').trim_end_matches('>');
        let named = self.names.iter().position(|n| n == name);
        for file in [Some(self.file), Some(0), named].into_iter().flatten() {
            self.make_outline(file)?;
            let found = self.outlines[file].as_ref().and_then(|o| o.find(key, Keyword::Sub));
            if let Some(mark) = found {
                return Ok((file, mark));
            }
        }
        let known = self.outlines.iter().flatten().flat_map(|o| &o.marks);
        let subs = known
            .filter(|m| m.keyword == Keyword::Sub)
            .map(|m| &*m.key)
            .chain(self.names.iter().map(String::as_str));
        let near = subs.filter(|k| !k.is_empty()).min_by_key(|k| crate::names::distance(k, key));
        let mut fault = error("I0311", span, format!("there is no subprogram o{key}"));
        if let Some(near) = near.filter(|k| crate::names::distance(k, key) <= 2) {
            fault = fault.with_help(format!("did you mean o{near}?"));
        } else if key.starts_with('<') {
            fault = fault.with_help(format!(
                "define it with `o{key} sub`, or in a file {name}.ngc beside the program"
            ));
        }
        Err(fault.into())
    }

    fn enter(&mut self, file: usize, mark: usize, again: Option<u32>, span: diag::Span) -> Outcome {
        if self.frames.len() >= self.limits.calls {
            self.ended = true;
            let text =
                format!("subprograms call each other more than {} levels deep", self.limits.calls);
            return refuse("I0801", span, text);
        }
        let Some(start) =
            self.outlines[file].as_ref().and_then(|o| o.marks.get(mark)).map(|m| m.after)
        else {
            return Ok(());
        };
        let back = self.parsers[self.file].position();
        let repeats = core::mem::take(&mut self.repeats);
        let again = again.map(|times| (start, times));
        self.frames.push(Frame { file: self.file, back, repeats, again });
        self.file = file;
        self.executor.modes.call_level = self.frames.len();
        context::enter_context(&mut self.executor);
        self.jump(start);
        Ok(())
    }

    /// `endsub`, `return`: with the value, if one is given.
    fn give_back<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        let value = if self.block.arguments.is_empty() { None } else { Some(self.argument()?) };
        self.executor.modes.returned = value;
        self.executor.modes.value = value.unwrap_or(0.0);
        if self.frames.is_empty() {
            let span = self.block.o.map_or(self.block.span, |o| o.span);
            return refuse("I0312", span, "no subprogram is being executed here");
        }
        self.executor.store.leave();
        self.leave(out)
    }

    fn leave<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        if let Some(frame) = self.frames.pop() {
            self.file = frame.file;
            self.repeats = frame.repeats;
            self.executor.modes.call_level = self.frames.len();
            self.jump(frame.back);
            return context::leave_context(&mut self.executor, out);
        }
        Ok(())
    }

    /// G70 to G72: the blocks of this subprogram are the profile.
    pub(crate) fn take_down_profile(&mut self, number: u32) -> Outcome {
        let span = self.block.span;
        let entered = match self.find_sub(&number.to_string(), span) {
            Ok((file, mark)) => self.enter(file, mark, None, span),
            Err(fault) => Err(fault),
        };
        match &mut self.executor.recording {
            Some(recording) if entered.is_ok() => {
                (recording.faults, recording.depth) = (self.faults, self.frames.len());
            }
            recording => *recording = None,
        }
        entered
    }

    /// Its subprogram is over: cut it.
    fn end_of_profile<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        let recording = self.executor.recording.take();
        self.leave(out)?;
        match recording.filter(|recording| recording.faults == self.faults) {
            Some(recording) => cycle::cut_profile(
                &mut self.executor.words,
                &mut self.executor.modes,
                &self.executor.settings,
                &recording,
                out,
            ),
            None => Ok(()),
        }
    }

    /// M98.
    pub(crate) fn call_program(&mut self, number: u32, times: u32) -> Outcome {
        let span = self.block.span;
        self.make_outline(self.file)?;
        let key = number.to_string();
        let Some(mark) = self.outline().find(&key, Keyword::Program) else {
            let fault = error("I0313", span, format!("there is no program O{number} in this file"));
            return Err(fault
                .with_help(format!(
                    "write O{number} alone on a line, its blocks after it, and M99 at its end"
                ))
                .into());
        };
        if times == 0 { Ok(()) } else { self.enter(self.file, mark, Some(times - 1), span) }
    }

    /// M99.
    pub(crate) fn return_from_program<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        let Some(frame) = self.frames.last_mut() else {
            self.ended = true;
            let text = "M99 in the main program would repeat it for ever";
            return Err(error("I0314", self.block.span, text).with_help("end it with M30").into());
        };
        match &mut frame.again {
            Some((start, left)) if *left > 0 => {
                *left -= 1;
                let start = *start;
                self.jump(start);
                Ok(())
            }
            Some(_) => self.leave(out),
            None => refuse(
                "I0315",
                self.block.span,
                "M99 ends what M98 called; o… call is ended by endsub or return",
            ),
        }
    }
}
