//! The front end of RS-274: blocks one after another, O-words, parameters, words as they are.
pub(crate) mod comments;
pub(crate) mod flow;

use crate::{
    call::{Sink, out::Out},
    cycles::{gear_comment::gear_comment, record},
    execute::{self, After, refused},
    fault::{Outcome, error},
    front_end::rs274::flow::Flow,
    program::Program,
};
use gcode::Parameter;

/// What it knows between two blocks.
#[derive(Clone, PartialEq)]
pub(crate) struct Rs274 {
    pub(crate) flow: Flow,
    /// Blocks that begin with `/` are left out.
    block_delete: bool,
    /// Numbers and values of the block's settings, before any is set.
    values: Vec<(Option<f64>, f64)>,
}

impl Rs274 {
    /// At the beginning of a program of so many files.
    pub(crate) fn new(block_delete: bool, files: usize) -> Self {
        Self { flow: Flow::new(files), block_delete, values: Vec::new() }
    }

    /// The same, which reads outlines again when it needs them.
    pub(crate) fn without_outlines(&self) -> Self {
        let (flow, block_delete) = (self.flow.without_outlines(), self.block_delete);
        Self { flow, block_delete, values: Vec::new() }
    }

    /// Execute the block that was read.
    #[inline]
    pub(crate) fn block<S: Sink>(&mut self, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
        if it.block.delete.is_some() && self.block_delete {
            return Ok(());
        }
        if it.block.o.is_some() {
            return self.flow.o_word(it, out);
        }
        if it.block.percent {
            it.percent_sign(out);
            return Ok(());
        }
        let ex = &mut it.executor;
        let read = execute::read(&mut ex.words, &mut ex.modes, &ex.store, &it.block);
        out.place = ex.words.place;
        if it.block.assignments.is_empty() {
            read?;
        } else {
            let assigned = self.assign(it);
            if assigned.is_err() {
                refused::forget_parameters(&mut it.executor.modes);
            }
            read.and(assigned)?;
        }
        if it.executor.recording.is_some() {
            return record::record(&mut it.executor, out);
        }
        if !it.block.comments.is_empty() {
            for comment in &it.block.comments {
                let text = it.block.text(comment.text);
                gear_comment(text, comment.span, &mut it.executor.modes, out.remarks);
            }
            let (ex, text) = (&it.executor, it.sources[it.file]);
            let result = comments::comments(&ex.modes, &ex.store, &it.block, text, out);
            it.ended |= result.is_err();
            result?;
        }
        if it.block.words.is_empty() {
            return Ok(());
        }
        match execute::execute(&mut it.executor, out)? {
            After::Next => Ok(()),
            After::End => {
                it.ended = true;
                Ok(())
            }
            After::Call(number, times) => self.flow.call_program(it, number, times),
            After::Return => self.flow.return_from_program(it, out),
            After::Profile(number) => self.flow.take_down_profile(it, number),
        }
    }

    /// Set the block's parameters: all values are computed before any is set.
    fn assign(&mut self, it: &mut Program<'_>) -> Outcome {
        self.values.clear();
        for assignment in &it.block.assignments {
            let values = it.executor.values();
            let value = values.evaluate(&it.block, assignment.value, assignment.span)?;
            let number = match assignment.target {
                Parameter::Numbered(number) => {
                    Some(values.evaluate(&it.block, number, assignment.span)?)
                }
                Parameter::Named(_) => None,
            };
            self.values.push((number, value));
        }
        for (assignment, (number, value)) in it.block.assignments.iter().zip(&self.values) {
            let (span, value) = (assignment.span, *value);
            match (assignment.target, *number) {
                (Parameter::Numbered(_), Some(number)) => {
                    let number = crate::words::names::number(number, span)?;
                    crate::words::names::assign(&mut it.executor.store, number, value, span)?;
                }
                (Parameter::Named(name), _) => {
                    let written = it.block.text(name);
                    crate::words::names::assignable(&it.executor.modes, written, span)?;
                    if it.executor.store.names() >= it.limits.names {
                        it.ended = true;
                        let text = format!("more than {} named parameters", it.limits.names);
                        return Err(error("I0802", span, text).into());
                    }
                    it.executor.store.set_named(written, value);
                }
                (Parameter::Numbered(_), None) => {}
            }
        }
        Ok(())
    }
}
