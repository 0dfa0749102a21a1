//! `spec/codes.md` has every G and M code with a program of its own, and what that program means.
//!
//! `UPDATE_SPEC=1 cargo test -p cli --test all codes::` writes the page anew; the programs in its
//! fourth column are written by hand and kept.
use std::{collections::HashMap, fs, path::Path};

/// What every program begins with; not shown.
const BEFORE: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nT1 M6\nS600 M3\nF300\nG0 X0 Y0 Z5\n";
/// Codes that say nothing to a machine: what they prepare is told with the code that takes it.
const WITHOUT_CALLS: [&str; 1] = ["G51.3"];
/// What every program of another dialect begins with.
const BEFORE_OTHERS: &str = "G21\nT1\nS600 M3\nG0 X0. Z5.\n";
/// First line of the table.
const HEAD: &str = "| code | what it does | takes | program | what it means |";
/// First line of the table of what the dialects have beside it or in another meaning.
const OTHERS: &str = "| code | dialects | what it does | takes | program | what it means |";

#[test]
fn every_code_has_a_program_that_does_what_the_page_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/codes.md");
    let page = fs::read_to_string(&path).unwrap();
    let (prose, tables) = page.split_once(HEAD).unwrap();
    let (table, others) = tables.split_once(OTHERS).unwrap();
    let (between, others) = (table.split_once("\n\n").unwrap().1, kept(others, 2));
    let programs = kept(table, 1);
    let mut anew = format!("{prose}{HEAD}\n|---|---|---|---|---|\n");
    let mut mistaken = Vec::new();
    for code in interp::codes() {
        let program = programs.get(&code.code).unwrap_or(&code.code);
        let meaning = meaning(program, BEFORE, interp::Dialect::LinuxCnc);
        mistaken.extend(mistake(&code, program, &meaning));
        let (name, letters) = (code.name, &code.letters);
        anew += &format!("| {} | {name} | {letters} | `{program}` | {meaning} |\n", code.code);
    }
    anew += &format!("\n{between}{OTHERS}\n|---|---|---|---|---|---|\n");
    for code in interp::dialect_codes() {
        let dialects: Vec<_> = code.dialects.iter().map(|dialect| dialect.name()).collect();
        let key = format!("{} {}", code.code, dialects.join(", "));
        let program = others.get(&key).unwrap_or(&code.code);
        let meaning = meaning(program, BEFORE_OTHERS, code.dialects[0]);
        mistaken.extend(mistake(&code, program, &meaning));
        let (name, letters) = (code.name, &code.letters);
        let dialects = dialects.join(", ");
        anew += &format!(
            "| {} | {dialects} | {name} | {letters} | `{program}` | {meaning} |\n",
            code.code
        );
    }
    assert!(mistaken.is_empty(), "not as `leadscrew codes` says:\n{}", mistaken.join("\n"));
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(&path, &anew).unwrap();
    }
    let wrong: Vec<_> = anew.lines().filter(|line| !page.contains(*line)).collect();
    let hint = "UPDATE_SPEC=1 cargo test -p cli --test all codes::";
    assert!(
        anew == page || wrong.is_empty() && anew.len() == page.len(),
        "{}\nIf this is as it should be: {hint}",
        wrong.join("\n")
    );
}

/// What is wrong with a row: its program shows nothing, has not its code, or is refused where the
/// list says executed.
fn mistake(code: &interp::CodeInfo, program: &str, meaning: &str) -> Option<String> {
    let executed = !meaning.starts_with("refused");
    let named = code.code.contains('–') || program.split([' ', '/']).any(|word| word == code.code);
    let shown = meaning != "—" || WITHOUT_CALLS.contains(&&*code.code);
    (executed != code.executed || !named || !shown)
        .then(|| format!("{} {:?}: `{program}` gives {meaning}", code.code, code.dialects))
}

/// Programs of a table's rows by what stands in the first cells.
fn kept(table: &str, cells: usize) -> HashMap<String, String> {
    table.lines().filter_map(|line| row(line, cells)).collect()
}

/// The first cells and the program of a row.
fn row(line: &str, count: usize) -> Option<(String, String)> {
    let cells: Vec<_> = line.split('|').map(str::trim).collect();
    let key = cells.get(1..=count)?.join(" ");
    let program = cells.get(count + 3)?.strip_prefix('`')?.strip_suffix('`')?;
    Some((key, program.to_owned()))
}

/// The calls that a program adds to those of the beginning, or why it is refused.
fn meaning(program: &str, before: &str, dialect: interp::Dialect) -> String {
    let blocks = program.replace(" / ", "\n");
    let ends = blocks.split_whitespace().any(|word| matches!(word, "M2" | "M30"));
    let rest = if ends { "" } else { "(end)\nM2\n" };
    let (calls, refused) = listing(&format!("{before}(begin)\n{blocks}\n{rest}"), dialect);
    if let Some(code) = refused {
        return format!("refused: {code}");
    }
    let begin = calls.iter().position(|call| call.contains("\"begin\"")).unwrap() + 1;
    let end = calls.iter().position(|call| call.contains("\"end\"")).unwrap_or(calls.len());
    let new = &calls[begin..end];
    if new.is_empty() { "—".to_owned() } else { new.join("; ").replace('|', "\\|") }
}

/// The calls in LinuxCNC's notation without their numbers, and the code of the first error.
fn listing(program: &str, dialect: interp::Dialect) -> (Vec<String>, Option<&'static str>) {
    let clamp = interp::MachineCode {
        number: 101,
        name: "clamp the vice".into(),
        action: interp::CodeAction::None,
    };
    let file = interp::Subprogram { name: "8".into(), source: b"G0 X2.\nM99\n".to_vec() };
    // a mill of which its diameter is known: G41 and G42 need that
    let mill = canon::Tool {
        number: 1,
        pocket: 1,
        length: units::Length::ZERO,
        diameter: units::Length::mm(10.0),
        kind: canon::ToolKind::Other,
        description: "stand-in".into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: true,
    };
    let setup = interp::Setup {
        dialect,
        tools: canon::ToolLibrary::new([mill]),
        missing_tools: interp::MissingTools::StandIn,
        user_codes: vec![clamp],
        subprograms: vec![file],
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
