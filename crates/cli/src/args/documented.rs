//! Every command that README and docs show is one: what a reader copies is at least understood.
use super::Cli;
use clap::Parser;
use clap::error::ErrorKind;
use std::path::Path;

/// What stands behind `leadscrew` wherever a text shows a command: in `backticks`, or as a line of
/// an indented or fenced block.
fn commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in text.lines() {
        let shown = line.trim_start().trim_start_matches("$ ");
        let program = ["leadscrew ", "cargo run --release -- "];
        for shown in shown.split(" && ") {
            let command = program.iter().find_map(|name| shown.strip_prefix(name));
            found.extend(command.map(|command| {
                let end = command.find(" #").unwrap_or(command.len());
                command[..end].trim().trim_end_matches(" &").to_owned()
            }));
        }
        let spans = line.split('`').skip(1).step_by(2);
        found.extend(spans.filter_map(|s| s.strip_prefix("leadscrew ").map(str::to_owned)));
    }
    found
}

/// As a shell splits it, as far as these go; `…` stands for what is left out.
fn words(command: &str) -> Vec<String> {
    let mut words = vec!["leadscrew".to_owned()];
    for (at, part) in command.split(['\'', '"']).enumerate() {
        if at % 2 == 1 {
            words.push(part.to_owned());
            continue;
        }
        let plain = part.split_whitespace().map(|word| word.trim_end_matches('…'));
        words.extend(plain.filter(|word| !word.is_empty()).map(str::to_owned));
    }
    words
}

/// Why a command is none; `None`: it is one, or one that lacks only what the text leaves to the
/// reader.
fn misread(command: &str) -> Option<String> {
    let words = words(command.split('|').next().unwrap_or(command).trim_end_matches('\\'));
    let parsed = |more: &[&str]| {
        let more = more.iter().map(|word| (*word).to_owned());
        Cli::try_parse_from(words.iter().cloned().chain(more)).err()
    };
    let lacks = |kind| {
        matches!(
            kind,
            ErrorKind::MissingRequiredArgument
                | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
                | ErrorKind::MissingSubcommand
                | ErrorKind::DisplayHelp
                | ErrorKind::DisplayVersion
        )
    };
    let first = parsed(&[]).filter(|wrong| !lacks(wrong.kind()))?;
    Some(first.to_string())
}

#[test]
fn every_command_of_readme_and_docs_is_understood() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = docs.filter(|path| path.extension().is_some_and(|e| e == "md"));
    let mut seen = 0;
    let mut wrong = Vec::new();
    for page in pages.chain([root.join("README.md")]) {
        for command in commands(&std::fs::read_to_string(&page).unwrap()) {
            seen += 1;
            wrong.extend(
                misread(&command)
                    .map(|why| format!("{}: leadscrew {command}: {why}", page.display())),
            );
        }
    }
    assert!(seen > 30, "the commands were not found: {seen}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_command_that_is_none_is_found() {
    let text = "Type `leadscrew run part.ngc --no-such-thing` or\n\n    leadscrew time part.ngc --format json   # so\n\
                tools/setup && cargo run --release -- codes\n";
    let found = commands(text);
    assert_eq!(found, ["run part.ngc --no-such-thing", "time part.ngc --format json", "codes"]);
    assert!(misread(&found[0]).is_some() && misread(&found[1]).is_none());
    assert!(misread("run --fault 'power-cut at depth 8mm' --recover").is_none());
    assert!(misread("rum part.ngc").is_some());
}
