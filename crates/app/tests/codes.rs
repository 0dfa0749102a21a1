//! `spec/codes.md` has every G and M code with a program of its own, and what that program means.
//!
//! `UPDATE_SPEC=1 cargo test -p leadscrew --test codes` writes the page anew; the programs in its fourth column are
//! written by hand and kept.
#![allow(clippy::unwrap_used)] // a test may panic
use std::{collections::HashMap, fs, path::Path};

/// What every program begins with; not shown.
const BEFORE: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nT1 M6\nS600 M3\nF300\nG0 X0 Y0 Z5\n";
/// First line of the table.
const HEAD: &str = "| code | what it does | takes | program | what it means |";

#[test]
fn every_code_has_a_program_that_does_what_the_page_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/codes.md");
    let page = fs::read_to_string(&path).unwrap();
    let (prose, table) = page.split_once(HEAD).unwrap();
    let programs: HashMap<_, _> = table.lines().filter_map(row).collect();
    let mut anew = format!("{prose}{HEAD}\n|---|---|---|---|---|\n");
    let mut mistaken = Vec::new();
    for code in interp::codes() {
        let program = programs.get(&code.code).unwrap_or(&code.code);
        let meaning = meaning(program);
        let executed = !meaning.starts_with("refused");
        if executed != code.executed {
            mistaken.push(format!("{}: `{program}` gives {meaning}", code.code));
        }
        anew += &format!(
            "| {} | {} | {} | `{program}` | {meaning} |\n",
            code.code, code.name, code.letters
        );
    }
    assert!(mistaken.is_empty(), "not as `leadscrew codes` says: {mistaken:#?}");
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(&path, &anew).unwrap();
    }
    let wrong: Vec<_> = anew.lines().filter(|line| !page.contains(*line)).collect();
    let hint = "UPDATE_SPEC=1 cargo test -p leadscrew --test codes";
    assert!(
        anew == page || wrong.is_empty() && anew.len() == page.len(),
        "{}\nIf this is as it should be: {hint}",
        wrong.join("\n")
    );
}

/// Code and program of a row.
fn row(line: &str) -> Option<(String, String)> {
    let mut cells = line.split('|').skip(1).map(str::trim);
    let code = cells.next()?.to_owned();
    let program = cells.nth(2)?.strip_prefix('`')?.strip_suffix('`')?;
    Some((code, program.to_owned()))
}

/// The calls that a program adds to those of the beginning, or why it is refused.
fn meaning(program: &str) -> String {
    let blocks = program.replace(" / ", "\n");
    let ends = blocks.split_whitespace().any(|word| matches!(word, "M2" | "M30"));
    let rest = if ends { "" } else { "(end)\nM2\n" };
    let (calls, refused) = listing(&format!("{BEFORE}(begin)\n{blocks}\n{rest}"));
    if let Some(code) = refused {
        return format!("refused: {code}");
    }
    let begin = calls.iter().position(|call| call.contains("\"begin\"")).unwrap() + 1;
    let end = calls.iter().position(|call| call.contains("\"end\"")).unwrap_or(calls.len());
    let new = &calls[begin..end];
    if new.is_empty() { "—".to_owned() } else { new.join("; ").replace('|', "\\|") }
}

/// The calls in LinuxCNC's notation without their numbers, and the code of the first error.
fn listing(program: &str) -> (Vec<String>, Option<&'static str>) {
    let clamp = interp::UserCode { number: 101, name: "clamp the vice".into() };
    let setup = interp::Setup {
        missing_tools: interp::MissingTools::StandIn,
        user_codes: vec![clamp],
        ..Default::default()
    };
    let mut interpreter = interp::Interpreter::new(program.as_bytes(), &setup);
    let mut listing = interp::Listing::new(Vec::new());
    interpreter.run(&mut listing);
    let text = String::from_utf8(listing.finish().unwrap()).unwrap();
    let call = |line: &str| {
        let words: Vec<_> = line.split_whitespace().collect();
        let from = words.iter().position(|w| w.contains('('))?;
        Some(words[from..].join(" "))
    };
    let first = interpreter.diagnostics().iter().find(|d| d.is_error());
    (text.lines().filter_map(call).collect(), first.map(|d| d.code))
}
