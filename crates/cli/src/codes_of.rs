//! `leadscrew codes --of`: which codes programs use, how often, and whether they are known.
use crate::args::{CodesArgs, CodesFormat};
use crate::check::{plural, programs};
use crate::say;
use control::Refused;
use control::config::machine_file;
use control::job::{dialect, read_program};
use gcode::{Block, Parser, Value};
use interp::Dialect;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;
use store::machine::OwnCodes;

const TOOL: &str = "T";
const CORNER: &str = ",C and ,R";
const FLOW: &str = "IF, GOTO, WHILE";
const OUTPUT: &str = "DPRNT";
const O_WORDS: &str = "O-words";
const SET: &str = "variables that are set";

/// What is counted beside G and M: words of macros and of flow.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum CountedWord {
    /// G or M and tenths of its number.
    Code(char, i64),
    /// By what it is.
    Other(&'static str),
}

/// One code in one dialect.
struct Used {
    times: usize,
    programs: usize,
    /// The program in which it was counted last.
    last: usize,
    first: (String, u32),
}

type Uses = BTreeMap<(CountedWord, &'static str), (Dialect, Used)>;

/// Print them.
pub(crate) fn command(args: &CodesArgs) -> Result<(), Refused> {
    let machine = args.machine.as_deref().map(machine_file::load).transpose()?;
    let own = machine.as_ref().map(|machine| machine.own_codes.clone()).unwrap_or_default();
    let files = programs(&args.of)?;
    let mut uses = Uses::new();
    for (index, path) in files.iter().enumerate() {
        let text = read_program(path)?;
        let asked = args.dialect.map(Into::into);
        let named = machine.as_ref().map(|machine| dialect::of(asked, machine)).or(asked);
        let dialect = named.unwrap_or_else(|| {
            interp::looks_like(&text, Dialect::LinuxCnc).unwrap_or(Dialect::LinuxCnc)
        });
        count(&mut uses, index, path, &text, dialect);
    }
    match args.format {
        CodesFormat::Text => {
            let mut text = format!("{}\n", table(&uses, &own));
            let unknown = uses
                .iter()
                .filter(|((what, _), (dialect, _))| known(*what, *dialect, &own).0 == "unknown");
            let (all, unknown) = (plural(uses.len(), "code"), unknown.count());
            text += &format!("{}: {all}, {unknown} unknown\n", plural(files.len(), "program"));
            say::out(&text)
        }
        CodesFormat::Json => {
            let all: Vec<_> = uses.iter().map(|(key, used)| object(*key, used, &own)).collect();
            say::out(&format!("{:#}\n", serde_json::Value::Array(all)))
        }
    }
}

/// Count those of one program.
fn count(uses: &mut Uses, index: usize, path: &Path, text: &[u8], dialect: Dialect) {
    let mut parser = Parser::with_grammar(text, 0, dialect.grammar());
    let mut block = Block::new();
    while parser.next(&mut block) {
        let line = block.span.line;
        let mut add = |what| {
            let first = || (path.display().to_string(), line);
            let new = || Used { times: 0, programs: 0, last: usize::MAX, first: first() };
            let (_, used) = uses.entry((what, dialect.name())).or_insert_with(|| (dialect, new()));
            used.times += 1;
            used.programs += usize::from(used.last != index);
            used.last = index;
        };
        for word in &block.words {
            match (word.letter, word.value) {
                (letter @ (b'G' | b'M'), Value::Number(number)) => {
                    add(CountedWord::Code(letter.into(), (number * 10.0).round() as i64));
                }
                (b'G' | b'M', Value::Expression(_)) => {
                    add(CountedWord::Other("G or M of a variable"));
                }
                (b'T', _) => add(CountedWord::Other(TOOL)),
                (b'c' | b'r', _) => add(CountedWord::Other(CORNER)),
                _ => {}
            }
        }
        if block.control.is_some() {
            add(CountedWord::Other(FLOW));
        }
        if block.output.is_some() {
            add(CountedWord::Other(OUTPUT));
        }
        if block.o.is_some_and(|o| o.keyword != gcode::Keyword::Program) {
            add(CountedWord::Other(O_WORDS));
        }
        if !block.assignments.is_empty() {
            add(CountedWord::Other(SET));
        }
    }
}

/// One word for whether it is executed, and what it means.
fn known(what: CountedWord, dialect: Dialect, own: &OwnCodes) -> (&'static str, String) {
    let (letter, tenths) = match what {
        CountedWord::Code(letter, tenths) => (letter, tenths),
        CountedWord::Other(word) => return ("executed", meaning(word, dialect).to_owned()),
    };
    let number = u16::try_from(tenths / 10).ok().filter(|_| tenths % 10 == 0);
    let call = own.calls.iter().find(|call| call.letter == letter && call.number == number);
    if let Some(call) = call.filter(|_| number.is_some()) {
        return ("machine's", format!("calls O{}", call.program));
    }
    if let Some(code) = own.codes.iter().find(|code| letter == 'M' && Some(code.number) == number) {
        return ("machine's", code.name.clone());
    }
    match interp::describe_in(dialect, letter as u8, tenths as f64 / 10.0) {
        Some(info) if info.code.contains('–') => ("unknown", "the machine builder's".to_owned()),
        Some(info) if info.executed => ("executed", info.name.to_owned()),
        Some(info) => ("refused", info.name.to_owned()),
        None if letter == 'M' => ("unknown", "the machine builder's".to_owned()),
        None => ("unknown", "no code of this dialect".to_owned()),
    }
}

/// What a word does that is neither a G nor an M code.
fn meaning(word: &str, dialect: Dialect) -> &'static str {
    match word {
        TOOL if dialect.has_turret() => "turns the turret to a tool, with its offset",
        TOOL => "selects the tool that M6 puts into the spindle",
        CORNER => "chamfer or radius between two moves",
        FLOW => "jumps, branches and loops of a custom macro",
        OUTPUT => "writes a line of text to a file",
        O_WORDS => "subprograms, branches and loops",
        SET => "variables and parameters are given values",
        _ => "the code is computed while the program runs",
    }
}

fn written(what: CountedWord) -> String {
    match what {
        CountedWord::Code(letter, tenths) if tenths % 10 == 0 => format!("{letter}{}", tenths / 10),
        CountedWord::Code(letter, tenths) => {
            format!("{letter}{}.{}", tenths / 10, (tenths % 10).abs())
        }
        CountedWord::Other(what) => what.to_owned(),
    }
}

fn table(uses: &Uses, own: &OwnCodes) -> comfy_table::Table {
    let head = ["code", "times", "programs", "dialect", "status", "what it does", "first"];
    let mut table = crate::tables::table(head);
    for ((what, name), (dialect, used)) in uses {
        let (status, meaning) = known(*what, *dialect, own);
        let first = format!("{}:{}", used.first.0, used.first.1);
        let [times, programs] = [used.times, used.programs].map(|count| count.to_string());
        table.add_row([&written(*what), &times, &programs, *name, status, &meaning, &first]);
    }
    table
}

fn object(
    (what, name): (CountedWord, &'static str),
    (dialect, used): &(Dialect, Used),
    own: &OwnCodes,
) -> serde_json::Value {
    let (status, meaning) = known(what, *dialect, own);
    json!({
        "code": written(what),
        "times": used.times,
        "programs": used.programs,
        "dialect": name,
        "status": status,
        "name": meaning,
        "first": { "program": used.first.0, "line": used.first.1 },
    })
}
