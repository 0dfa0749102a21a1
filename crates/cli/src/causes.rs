//! `leadscrew check --summary`: a folder of programs as a table, and what they are refused for.
use crate::args::FindingsFormat;
use crate::check::plural;
use crate::say;
use comfy_table::{Table, presets};
use control::Refused;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// What was found in each program, and in how many.
#[derive(Default)]
pub(crate) struct Causes {
    programs: Vec<Checked>,
    /// By the code of a finding: how many programs have it, and the first of them.
    by_code: BTreeMap<&'static str, (usize, usize)>,
}

struct Checked {
    name: String,
    /// Dialect and machine.
    read_as: Option<(&'static str, String)>,
    /// The first error: code, line, sentence.
    first: Option<(&'static str, u32, String)>,
    errors: usize,
}

impl Causes {
    pub(crate) fn add(
        &mut self,
        name: &str,
        read_as: Option<(&'static str, String)>,
        first: Option<(&'static str, u32, String)>,
        errors: usize,
        codes: &[&'static str],
    ) {
        let index = self.programs.len();
        for code in codes {
            self.by_code.entry(code).or_insert((0, index)).0 += 1;
        }
        self.programs.push(Checked { name: name.to_owned(), read_as, first, errors });
    }

    pub(crate) fn say(&self, format: FindingsFormat) -> Result<(), Refused> {
        match format {
            FindingsFormat::Text => say::out(&self.text()),
            _ => say::out(&format!("{:#}\n", self.json())),
        }
    }

    fn text(&self) -> String {
        let mut table = new_table(["program", "verdict", "read as", "first"]);
        for checked in &self.programs {
            let as_text =
                checked.read_as.as_ref().map(|(dialect, on)| format!("{dialect} on {on}"));
            let first = checked.first.as_ref().map_or(String::new(), placed);
            let verdict = match checked.errors {
                0 => "ok".to_owned(),
                errors => plural(errors, "error"),
            };
            table.add_row([checked.name.clone(), verdict, as_text.unwrap_or_default(), first]);
        }
        let ok = self.programs.iter().filter(|checked| checked.errors == 0).count();
        let all = self.programs.len();
        let mut text = format!("{table}\n");
        if !self.by_code.is_empty() {
            let mut causes = new_table(["finding", "programs", "first in"]);
            let mut counted: Vec<_> = self.by_code.iter().collect();
            counted.sort_by_key(|(code, (count, _))| (core::cmp::Reverse(*count), **code));
            for (code, (count, first)) in counted {
                let name = self.programs[*first].name.clone();
                causes.add_row([(*code).to_owned(), count.to_string(), name]);
            }
            text += &format!("{causes}\n");
        }
        text + &format!("{ok} of {} can be executed\n", plural(all, "program"))
    }

    fn json(&self) -> Value {
        let program = |checked: &Checked| {
            let (dialect, machine) = match &checked.read_as {
                Some((dialect, machine)) => (Some(*dialect), Some(machine.as_str())),
                None => (None, None),
            };
            let first = checked.first.as_ref();
            json!({
                "program": checked.name, "errors": checked.errors, "dialect": dialect, "machine": machine,
                "first": first.map(|(code, line, text)| json!({ "code": code, "line": line, "message": text })),
            })
        };
        let causes: serde_json::Map<_, _> = self
            .by_code
            .iter()
            .map(|(code, (count, _))| ((*code).to_owned(), json!(count)))
            .collect();
        json!({ "programs": self.programs.iter().map(program).collect::<Vec<_>>(), "causes": causes })
    }
}

fn placed((code, line, text): &(&str, u32, String)) -> String {
    match line {
        0 => text.clone(),
        line => format!("line {line}: {code} {text}"),
    }
}

fn new_table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY);
    crate::tables::fit(&mut table);
    table.set_header(header);
    table
}
