//! O-words executed: subprograms, branches, loops; M98 and M99.
use crate::{
    Sink,
    auxiliary::context,
    call::out::Out,
    codes::number::near_whole,
    cycles::turning,
    fault::{Outcome, error, refuse},
    program::{
        Program,
        outline::{self, At, Mark, Outline},
    },
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

/// Where O-words have led.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct Flow {
    /// Of each file, if it was needed.
    pub(crate) outlines: Vec<Option<Outline>>,
    frames: Vec<Frame>,
    /// Counting loops of this level: the byte where they begin, rounds left.
    repeats: Vec<(u32, u64)>,
    /// The `elseif` ahead is to be asked.
    choosing: bool,
}

impl Flow {
    /// At the beginning of a program of so many files.
    pub(crate) fn new(files: usize) -> Self {
        Self { outlines: vec![None; files], ..Self::default() }
    }

    /// The same, which reads outlines again when it needs them.
    pub(crate) fn without_outlines(&self) -> Self {
        Self {
            outlines: vec![None; self.outlines.len()],
            frames: self.frames.clone(),
            repeats: self.repeats.clone(),
            choosing: self.choosing,
        }
    }

    /// Execute the O-word of the block at hand.
    pub(crate) fn o_word<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        out: &mut Out<'_, S>,
    ) -> Outcome {
        let Some(word) = it.block.o else { return Ok(()) };
        if word.keyword == Keyword::Program {
            return Ok(()); // the program's own number, or the begin of one that M98 calls
        }
        self.make_outline(it, it.file)?;
        let ends = matches!(word.keyword, Keyword::EndSub | Keyword::Return);
        let depth = it.executor.recording.as_ref().map(|recording| recording.depth);
        if ends && depth == Some(self.frames.len()) {
            return self.end_of_profile(it, out);
        }
        match word.keyword {
            Keyword::Call => return self.call(it, word.label),
            Keyword::EndSub | Keyword::Return => return self.give_back(it, out),
            _ => {}
        }
        let Some(i) = self.outline(it).at(it.block.span.start) else { return Ok(()) };
        let Mark { partner, end, closes_do, .. } = self.outline(it).marks[i];
        match word.keyword {
            Keyword::Sub => self.jump_after(it, partner),
            Keyword::If => {
                if Self::argument(it)? == 0.0 {
                    self.next_clause(it, partner);
                }
            }
            Keyword::ElseIf if self.choosing => {
                self.choosing = false;
                if Self::argument(it)? == 0.0 {
                    self.next_clause(it, partner);
                }
            }
            Keyword::ElseIf | Keyword::Else => self.jump_after(it, end),
            Keyword::While if closes_do => {
                if Self::argument(it)? != 0.0 {
                    self.jump_after(it, partner);
                }
            }
            Keyword::While => {
                if Self::argument(it)? == 0.0 {
                    self.jump_after(it, partner);
                }
            }
            Keyword::EndWhile => self.jump_to(it, partner),
            Keyword::Repeat => self.repeat(it, i, partner)?,
            Keyword::EndRepeat => self.end_repeat(it, partner),
            Keyword::Break => {
                self.forget_repeats(it, partner);
                let end = self.outline(it).marks[partner].partner;
                self.jump_after(it, end);
            }
            Keyword::Continue => {
                self.forget_repeats(it, partner + 1);
                let end = self.outline(it).marks[partner].partner;
                self.jump_to(it, end);
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

    fn outline(&self, it: &Program<'_>) -> &Outline {
        // Made before any O-word of the file is executed.
        static NONE: LazyLock<Outline> = LazyLock::new(Outline::default);
        self.outlines[it.file].as_ref().unwrap_or(&NONE)
    }

    /// Read a file's O-words; if they do not fit together, nothing of it can be executed.
    fn make_outline(&mut self, it: &mut Program<'_>, file: usize) -> Outcome {
        it.steered = true;
        if self.outlines[file].is_some() {
            return Ok(());
        }
        let (outline, faults) = Outline::of(it.sources[file], file as u16);
        self.outlines[file] = Some(outline);
        let mut faults = faults.into_iter();
        let Some(first) = faults.next() else { return Ok(()) };
        it.contents_are_faulty = true;
        it.report_all(faults);
        it.ended = true;
        Err(first.into())
    }

    fn jump_after(&mut self, it: &mut Program<'_>, mark: usize) {
        if let Some(at) = self.outline(it).marks.get(mark).map(|m| m.after) {
            it.jump(at);
        }
    }

    fn jump_to(&mut self, it: &mut Program<'_>, mark: usize) {
        if let Some(at) = self.outline(it).marks.get(mark).map(|m| m.at) {
            it.jump(at);
        }
    }

    /// The condition was false: on to `elseif` (which is then asked), or behind `else` or `endif`.
    fn next_clause(&mut self, it: &mut Program<'_>, mark: usize) {
        let Some(keyword) = self.outline(it).marks.get(mark).map(|m| m.keyword) else { return };
        if keyword == Keyword::ElseIf {
            self.choosing = true;
            self.jump_to(it, mark);
        } else {
            self.jump_after(it, mark);
        }
    }

    /// The first argument of the O-word. A fault here leaves no way to go on.
    fn argument(it: &mut Program<'_>) -> Outcome<f64> {
        let span = it.block.o.map_or(it.block.span, |o| o.span);
        let value = it.block.arguments.first().copied().unwrap_or(Value::Number(0.0));
        it.executor.modes.line = it.block.span.line;
        let result = it.executor.values().evaluate(&it.block, value, span);
        it.ended |= result.is_err();
        result
    }

    fn repeat(&mut self, it: &mut Program<'_>, begin: usize, end: usize) -> Outcome {
        let count = Self::argument(it)?.round();
        if count < 1.0 {
            self.jump_after(it, end);
        } else {
            self.repeats.push((self.outline(it).marks[begin].at.0, count as u64));
        }
        Ok(())
    }

    fn end_repeat(&mut self, it: &mut Program<'_>, begin: usize) {
        let Some(at) = self.outline(it).marks.get(begin).map(|mark| mark.at.0) else { return };
        match self.repeats.last_mut() {
            Some((mark, left)) if *mark == at && *left > 1 => {
                *left -= 1;
                self.jump_after(it, begin);
            }
            Some((mark, _)) if *mark == at => _ = self.repeats.pop(),
            _ => {}
        }
    }

    /// Loops begun at or after a mark are over.
    fn forget_repeats(&mut self, it: &mut Program<'_>, mark: usize) {
        let from = self.outline(it).marks.get(mark).map_or(u32::MAX, |mark| mark.at.0);
        while self.repeats.last().is_some_and(|(begin, _)| *begin >= from) {
            self.repeats.pop();
        }
    }

    fn call(&mut self, it: &mut Program<'_>, label: Label) -> Outcome {
        let span = it.block.o.map_or(it.block.span, |o| o.span);
        it.executor.modes.line = it.block.span.line;
        let (file, mark) = self.called(it, label, span)?;
        let count = it.block.arguments.len();
        let mut arguments = [0.0; MOST_ARGUMENTS];
        if count > MOST_ARGUMENTS {
            let text = format!(
                "a call takes {MOST_ARGUMENTS} arguments at most (#1 to #{MOST_ARGUMENTS}), found {count}"
            );
            return refuse("I0309", span, text);
        }
        for (argument, value) in arguments.iter_mut().zip(&it.block.arguments) {
            *argument = it.executor.values().evaluate(&it.block, *value, span)?;
        }
        self.enter(it, file, mark, None, span)?;
        it.executor.store.enter(&arguments[..count]);
        Ok(())
    }

    /// The subprogram that a label names.
    fn called(
        &mut self,
        it: &mut Program<'_>,
        label: Label,
        span: diag::Span,
    ) -> Outcome<(usize, usize)> {
        if let Label::Number(number) = label {
            // made before any O-word of the file is executed
            if let Some(mark) = self.outline(it).numbered(number) {
                return Ok((it.file, mark));
            }
        }
        let key = match outline::key(&it.block, label) {
            Some(key) => key,
            None => Self::computed_key(it, label, span)?,
        };
        self.find_sub(it, &key, span)
    }

    fn computed_key(it: &Program<'_>, label: Label, span: diag::Span) -> Outcome<Box<str>> {
        let Label::Computed(value) = label else { return Ok("".into()) };
        let number = it.executor.values().evaluate(&it.block, value, span)?;
        match near_whole(number).filter(|n| *n >= 0) {
            Some(number) => Ok(number.to_string().into()),
            None => refuse("I0310", span, format!("O takes a whole number, found {number}")),
        }
    }

    /// A subprogram: in this file, in the program, or in a file of its name.
    fn find_sub(
        &mut self,
        it: &mut Program<'_>,
        key: &str,
        span: diag::Span,
    ) -> Outcome<(usize, usize)> {
        let name = key.trim_start_matches('<').trim_end_matches('>');
        let named = it.names.iter().position(|n| n == name);
        for file in [Some(it.file), Some(0), named].into_iter().flatten() {
            self.make_outline(it, file)?;
            let found = self.outlines[file].as_ref().and_then(|o| o.find(key, Keyword::Sub));
            if let Some(mark) = found {
                return Ok((file, mark));
            }
        }
        let known = self.outlines.iter().flatten().flat_map(|o| &o.marks);
        let subs = known
            .filter(|m| m.keyword == Keyword::Sub)
            .map(|m| &*m.key)
            .chain(it.names.iter().map(String::as_str));
        let near =
            subs.filter(|k| !k.is_empty()).min_by_key(|k| crate::words::names::distance(k, key));
        let mut fault = error("I0311", span, format!("there is no subprogram o{key}"));
        if let Some(near) = near.filter(|k| crate::words::names::distance(k, key) <= 2) {
            fault = fault.with_help(format!("did you mean o{near}?"));
        } else if key.starts_with('<') {
            fault = fault.with_help(format!(
                "define it with `o{key} sub`, or in a file {name}.ngc beside the program"
            ));
        }
        Err(fault.into())
    }

    fn enter(
        &mut self,
        it: &mut Program<'_>,
        file: usize,
        mark: usize,
        again: Option<u32>,
        span: diag::Span,
    ) -> Outcome {
        if self.frames.len() >= it.limits.calls {
            it.ended = true;
            let text =
                format!("subprograms call each other more than {} levels deep", it.limits.calls);
            return refuse("I0801", span, text);
        }
        let Some(start) =
            self.outlines[file].as_ref().and_then(|o| o.marks.get(mark)).map(|m| m.after)
        else {
            return Ok(());
        };
        let back = it.parsers[it.file].position();
        let repeats = core::mem::take(&mut self.repeats);
        let again = again.map(|times| (start, times));
        self.frames.push(Frame { file: it.file, back, repeats, again });
        it.file = file;
        it.executor.modes.call_level = self.frames.len();
        context::enter_context(&mut it.executor);
        it.jump(start);
        Ok(())
    }

    /// `endsub`, `return`: with the value, if one is given.
    fn give_back<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        let value = if it.block.arguments.is_empty() { None } else { Some(Self::argument(it)?) };
        it.executor.modes.returned = value;
        it.executor.modes.value = value.unwrap_or(0.0);
        if self.frames.is_empty() {
            let span = it.block.o.map_or(it.block.span, |o| o.span);
            return refuse("I0312", span, "no subprogram is being executed here");
        }
        it.executor.store.leave();
        self.leave(it, out)
    }

    fn leave<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        if let Some(frame) = self.frames.pop() {
            it.file = frame.file;
            self.repeats = frame.repeats;
            it.executor.modes.call_level = self.frames.len();
            it.jump(frame.back);
            return context::leave_context(&mut it.executor, out);
        }
        Ok(())
    }

    /// G70 to G72: the blocks of this subprogram are the profile.
    pub(crate) fn take_down_profile(&mut self, it: &mut Program<'_>, number: u32) -> Outcome {
        let span = it.block.span;
        let entered = match self.find_sub(it, &number.to_string(), span) {
            Ok((file, mark)) => self.enter(it, file, mark, None, span),
            Err(fault) => Err(fault),
        };
        match &mut it.executor.recording {
            Some(recording) if entered.is_ok() => {
                (recording.faults, recording.depth) = (it.faults, self.frames.len());
            }
            recording => *recording = None,
        }
        entered
    }

    /// Its subprogram is over: cut it.
    fn end_of_profile<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        let recording = it.executor.recording.take();
        self.leave(it, out)?;
        match recording.filter(|recording| recording.faults == it.faults) {
            Some(recording) => turning::cut_profile(
                &mut it.executor.words,
                &mut it.executor.modes,
                (&it.executor.settings, &mut it.executor.tools),
                &recording,
                out,
            ),
            None => Ok(()),
        }
    }

    /// M98.
    pub(crate) fn call_program(
        &mut self,
        it: &mut Program<'_>,
        number: u32,
        times: u32,
    ) -> Outcome {
        let span = it.block.span;
        self.make_outline(it, it.file)?;
        let key = number.to_string();
        let Some(mark) = self.outline(it).find(&key, Keyword::Program) else {
            let fault = error("I0313", span, format!("there is no program O{number} in this file"));
            return Err(fault
                .with_help(format!(
                    "write O{number} alone on a line, its blocks after it, and M99 at its end"
                ))
                .into());
        };
        if times == 0 { Ok(()) } else { self.enter(it, it.file, mark, Some(times - 1), span) }
    }

    /// M99.
    pub(crate) fn return_from_program<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        out: &mut Out<'_, S>,
    ) -> Outcome {
        let Some(frame) = self.frames.last_mut() else {
            it.ended = true;
            let text = "M99 in the main program would repeat it for ever";
            return Err(error("I0314", it.block.span, text).with_help("end it with M30").into());
        };
        match &mut frame.again {
            Some((start, left)) if *left > 0 => {
                *left -= 1;
                let start = *start;
                it.jump(start);
                Ok(())
            }
            Some(_) => self.leave(it, out),
            None => refuse(
                "I0315",
                it.block.span,
                "M99 ends what M98 called; o… call is ended by endsub or return",
            ),
        }
    }
}
