//! What is to be said of the tool table while a program is read.
use crate::job::Session;
use crate::job::described::is_same;
use canon::{Op, OpKind, Tool};
use diag::Diagnostic;
use std::collections::{BTreeMap, BTreeSet};

/// What is to be said of the tool table, where a program calls a tool: that it is the built-in one,
/// what was not understood in a tool's row, and that a tool is at the end of its life.
#[derive(Default)]
pub struct TableNotes {
    called: BTreeSet<u32>,
    found: Vec<Diagnostic>,
    uses: canon::UseCount,
    /// Uses in this program so far, by the tool's number.
    used: BTreeMap<u32, u32>,
    at_limit: BTreeSet<u32>,
    broken: BTreeSet<u32>,
    has_begun: bool,
}

impl TableNotes {
    /// An operation of the program.
    pub fn see(&mut self, session: &Session, op: &Op) {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.uses = canon::UseCount::with(session.tool());
        }
        if let Some(tool) = self.uses.counts(op) {
            *self.used.entry(tool).or_default() += 1;
            self.is_whole(session, tool, op.span);
        }
        let OpKind::ChangeTool { number: number @ 1.. } = op.kind else { return };
        let Some(tool) = session.tools.get(number) else { return };
        self.is_whole(session, number, op.span);
        let used = self.used.get(&number).copied().unwrap_or(0);
        if let Some(finding) = end_of_life(tool, used, op.span)
            && self.at_limit.insert(number)
        {
            self.found.push(finding);
        }
        if !self.called.insert(number) || tool.stand_in {
            return;
        }
        let described = session.described.iter().find(|described| described.number == number);
        if let Some(described) = described.filter(|described| !is_same(tool, described)) {
            self.found.push(differs(tool, described, session, op.span));
        }
        match &session.table {
            None if self.called.len() == 1 => self.found.push(built_in(tool, op.span)),
            None => {}
            Some(table) => {
                let from = &session.tools_from;
                self.found.extend(table.remarks_of(number).map(|remark| {
                    let line = remark.span.line;
                    let text = format!("T{number} in {from}, line {line}: {}", remark.message);
                    Diagnostic {
                        code: "A0104",
                        severity: remark.severity,
                        ..Diagnostic::warning("A0104", op.span, text)
                    }
                }));
            }
        }
    }

    /// A tool that is broken is neither called nor used.
    fn is_whole(&mut self, session: &Session, number: u32, span: diag::Span) {
        let tool = session.tools.get(number).filter(|tool| tool.life.is_broken);
        if tool.is_some() && self.broken.insert(number) {
            let text =
                format!("T{number} is broken: it is not used before a new one is in its place");
            self.found.push(Diagnostic::error("A0112", span, text).with_help(format!(
                "put in a new one and say so: \"New tool\" on the page, `tool {number} renew` at the console, renew_tool over the network, `run --renew-tool {number}`; in a tool table take `broken` out of its life"
            )));
        }
    }

    /// What was found since the last time.
    pub fn take(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.found)
    }
}

/// A tool is called that has been used as much as it may be, with its uses in this program before.
fn end_of_life(tool: &Tool, used_here: u32, span: diag::Span) -> Option<Diagnostic> {
    let mut life = tool.life;
    life.used.uses = life.used.uses.saturating_add(used_here);
    let reached = life.reached()?;
    let text = format!("T{} is at the end of its life: {reached}", tool.number);
    let finding = match life.at_limit {
        canon::AtLimit::Refuse => Diagnostic::error("A0105", span, text),
        canon::AtLimit::Remark => Diagnostic::warning("A0105", span, text),
    };
    Some(finding.with_help(
        "put in a new one and set its `life` back in the tool table, or raise its limit there",
    ))
}

/// A comment of the program describes another tool than the table has.
fn differs(tool: &Tool, described: &Tool, session: &Session, span: diag::Span) -> Diagnostic {
    let unit = session.unit;
    let text = format!(
        "T{} is \"{}\" of {} {} in {}, and the program's comment describes \"{}\": the table's is used",
        tool.number,
        tool.description,
        unit.number(tool.diameter.value() / unit.in_mm()),
        unit.symbol(),
        session.tools_from,
        described.description
    );
    Diagnostic::warning("A0115", span, text)
        .with_help("put the tool of the comment into the table, or correct the comment")
}

fn built_in(tool: &Tool, span: diag::Span) -> Diagnostic {
    let text = format!(
        "T{} is \"{}\" of the built-in tool table: no table is named, and none lies beside the program",
        tool.number, tool.description
    );
    Diagnostic::note("A0103", span, text)
        .with_help("--tools FILE names the shop's own; tools.toml or tool.tbl beside the program is found by itself")
}
