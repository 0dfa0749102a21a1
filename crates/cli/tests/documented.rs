//! What README and docs tell a reader to type does what they say: every shipped program is accepted
//! by its machine in its dialect, every fenced block of commands (`sh`, `console`) runs line by
//! line with the exit code that it states, and so does every command in the text that runs a
//! shipped program.
//!
//! A block that takes a network, a release build or minutes begins with a comment that a reader
//! sees too: `# not run by the tests: WHY`. The real command line reads its options all the same
//! (`args/documented.rs`).
use crate::common::{complained, root, said};
use std::{collections::BTreeSet, fs, os::unix::fs::symlink, path::Path, process::Command};

/// What each shipped program has to be run with.
const PROGRAMS: [(&str, &[&str]); 22] = [
    ("plate-12xM6.ngc", &[]),
    ("mill-8xM8.ngc", &[]),
    ("learning-12xM6.ngc", &[]),
    ("bolt-circle.ngc", &[]),
    ("inch-unc.ngc", &[]),
    ("probe-face.ngc", &[]),
    ("probe-bore.ngc", &[]),
    ("probe-boss.ngc", &[]),
    ("probe-calibrate.ngc", &[]),
    ("left-hand.ngc", &[]),
    ("m3-and-m10.ngc", &[]),
    ("plate-macro.nc", &["--dialect", "fanuc"]),
    ("chip-removal.nc", &["--dialect", "brother"]),
    ("scroll.ngc", &["--machine", "mill-5-axis"]),
    ("thread-m20x1.5.ngc", &["--machine", "lathe"]),
    ("feed-screw.nc", &["--machine", "lathe", "--dialect", "fanuc-lathe-a"]),
    ("hexagon-af17.nc", &["--machine", "polygon-lathe"]),
    ("square-af30.nc", &["--machine", "polygon-lathe"]),
    ("cam-measure.nc", CAM),
    ("cam-grind.nc", CAM),
    ("cam-shaft.nc", &["--machine", "cam-grinder"]),
    ("gear-m2-z40.nc", &["--machine", "gear-hobber"]),
];
const CAM: &[&str] =
    &["--machine", "cam-grinder", "--dialect", "toyoda", "--phase-table", "phases.toml"];

/// A folder that has the shipped files, and takes what is written.
fn shop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["programs", "machines"] {
        symlink(root().join(name).canonicalize().unwrap(), folder.path().join(name)).unwrap();
    }
    folder
}

fn typed(folder: &Path, words: &[&str]) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command.args(words).current_dir(folder).env("NO_COLOR", "1").output().unwrap()
}

#[test]
fn every_shipped_program_is_in_order_on_its_machine_in_its_dialect() {
    let folder = shop();
    let mut shipped: Vec<String> = fs::read_dir(root().join("programs"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| matches!(name.rsplit_once('.'), Some((_, "ngc" | "nc"))))
        .collect();
    shipped.sort();
    for (name, options) in PROGRAMS {
        let path = format!("programs/{name}");
        // a cam is ground with the phase error that the program before it has measured
        let verb = if options == CAM { "run" } else { "check" };
        let output = typed(folder.path(), &[&[verb, &path, "-q"], options].concat());
        let text = said(&output) + &complained(&output);
        assert_eq!(output.status.code(), Some(0), "{name}: {text}");
        shipped.retain(|s| s != name);
    }
    assert!(shipped.is_empty(), "not in the table of this test: {shipped:?}");
}

/// README and the pages of `docs/`, by name: their texts.
fn pages() -> Vec<(String, String)> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> =
        docs.filter(|path| path.extension().is_some_and(|e| e == "md")).collect();
    paths.extend(["README.md", "CONTRIBUTING.md"].map(|name| root().join(name)));
    paths.sort();
    let page = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read_to_string(path).unwrap())
    };
    paths.iter().map(page).collect()
}

/// A fenced block of commands.
#[derive(Debug, PartialEq, Eq)]
enum Block {
    /// Each line with the exit code that it states, 0 if none.
    Run(Vec<(String, i32)>),
    /// Why it is not run.
    NotRun(String),
}

/// The blocks of commands in a page; `Err`: what is wrong with one of them.
fn blocks(text: &str) -> Result<Vec<Block>, String> {
    let mut found = Vec::new();
    let mut lines = text.lines();
    while let Some(fence) = lines.next() {
        let Some(language) = fence.trim_start().strip_prefix("```") else { continue };
        let inside: Vec<&str> =
            lines.by_ref().take_while(|line| !line.trim_start().starts_with("```")).collect();
        if matches!(language.trim(), "sh" | "console") {
            found.push(block(language.trim() == "console", &inside)?);
        } else if matches!(language.trim(), "bash" | "shell" | "") {
            return Err(format!("a block is `sh`, `console` or another language: ```{language}"));
        }
    }
    Ok(found)
}

fn block(console: bool, lines: &[&str]) -> Result<Block, String> {
    const MARK: &str = "# not run by the tests:";
    if let Some(why) = lines.first().and_then(|line| line.trim_start().strip_prefix(MARK)) {
        let why = why.trim();
        return if why.len() > 3 { Ok(Block::NotRun(why.into())) } else { Err("no reason".into()) };
    }
    let mut commands = Vec::new();
    for line in lines.iter().map(|line| line.trim()).filter(|line| !line.is_empty()) {
        let prompt = line.strip_prefix("$ ");
        let line = match prompt {
            Some(line) if console => line,
            None if !console => line,
            _ => {
                return Err(format!(
                    "a console's commands begin with `$ `, those of sh do not: {line}"
                ));
            }
        };
        let (command, remark) = line.split_once(" #").unwrap_or((line, ""));
        let code = remark.split_once("exit code ").map_or(Ok(0), |(_, code)| {
            code.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default().parse()
        });
        let code = code.map_err(|_| format!("which exit code? {line}"))?;
        commands.push((command.trim().to_owned(), code));
    }
    if commands.is_empty() { Err("an empty block".into()) } else { Ok(Block::Run(commands)) }
}

/// As a script that stops at the first line with another exit code. A simulator in the background
/// listens before it goes on.
fn script(commands: &[(String, i32)]) -> String {
    let mut script = String::from("trap 'kill $(jobs -p) 2>/dev/null; wait' EXIT\n");
    for (command, code) in commands {
        script += command;
        script += "\n";
        if command.ends_with('&') {
            let words: Vec<&str> = command.split_whitespace().collect();
            let mut pairs = words.windows(2).map(|pair| (pair[0], pair[1]));
            if let Some((_, at)) = pairs.find(|(option, _)| *option == "--listen") {
                script +=
                    &format!("for i in $(seq 200); do [ -S {at} ] && break; sleep 0.05; done\n");
            }
        } else {
            script += &format!(
                "code=$?; [ $code = {code} ] || {{ echo \"exit code $code instead of {code}\"; exit 99; }} >&2\n"
            );
        }
    }
    script
}

/// Run it in the folder, `leadscrew` being the one under test; `Err`: what it printed.
fn shell(folder: &Path, commands: &[(String, i32)]) -> Result<(), String> {
    let tools = tempfile::tempdir().unwrap();
    symlink(env!("CARGO_BIN_EXE_leadscrew"), tools.path().join("leadscrew")).unwrap();
    let path = format!("{}:{}", tools.path().display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("bash");
    command.args(["-c", &script(commands)]).current_dir(folder);
    command.env("PATH", path).env("NO_COLOR", "1").env("XDG_STATE_HOME", folder.join("state-home"));
    let output = command.output().unwrap();
    let text = || said(&output) + &complained(&output);
    if output.status.success() { Ok(()) } else { Err(text()) }
}

/// Commands in the text of a page (`between backticks`) whose program is a shipped one; what is
/// left out with `…` is not run.
fn spans(text: &str) -> Vec<String> {
    let fenced = text.split("\n```").step_by(2).flat_map(str::lines);
    let spans = fenced.flat_map(|line| line.split('`').skip(1).step_by(2));
    let spans = spans.filter(|span| span.starts_with("leadscrew "));
    let concrete = |command: &str| {
        let words: Vec<&str> = command.split_whitespace().skip(1).collect();
        // ten speeds of a polygon, each cut twice; every cam at every speed: they are read as
        // commands only
        let long = command.contains("--simulate") || words.first() == Some(&"compensation");
        !long
            && !command.contains('…')
            && (words.iter().any(|word| word.starts_with("programs/"))
                || words.len() > 1 && matches!(words[0], "polygon" | "cam" | "compare"))
    };
    spans.filter(|command| concrete(command)).map(str::to_owned).collect()
}

#[test]
fn every_command_of_readme_and_docs_does_its_work() {
    let folder = shop();
    // these run in `what_readme_claims_is_what_its_commands_print`
    let claimed = claims(&fs::read_to_string(root().join("README.md")).unwrap());
    let claimed =
        claimed.into_iter().map(|(command, _)| vec![(command.clone(), code_of(&command))]);
    let (mut ran, mut wrong) = (claimed.collect::<BTreeSet<_>>(), Vec::new());
    for (page, text) in pages() {
        let blocks = blocks(&text).unwrap_or_else(|why| panic!("{page}: {why}"));
        let blocks = blocks.into_iter().filter_map(|block| match block {
            Block::Run(commands) => Some(commands),
            Block::NotRun(_) => None,
        });
        let spans = spans(&text).into_iter().map(|command| {
            let code = code_of(&command);
            vec![(command, code)]
        });
        for commands in blocks.chain(spans) {
            if ran.insert(commands.clone())
                && let Err(printed) = shell(folder.path(), &commands)
            {
                wrong.push(format!("{page}: {commands:#?}\n{printed}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(ran.len() >= 10, "the commands were not found: {ran:?}");
}

/// The exit code of a command in the text: a stop that is shown is an alarm.
fn code_of(command: &str) -> i32 {
    if command.contains("--fault") || command.contains("--operator") { 3 } else { 0 }
}

/// The rows of README's first table: the command, and what it is said to print.
fn claims(readme: &str) -> Vec<(String, String)> {
    let rows = readme.lines().filter(|line| line.starts_with("| ") && line.contains("`leadscrew "));
    let code = |cell: &str| cell.split('`').nth(1).unwrap_or_default().to_owned();
    let cells = |row: &str| row.split(" | ").map(str::to_owned).collect::<Vec<_>>();
    rows.map(cells)
        .filter(|cells| cells.len() == 3)
        .map(|cells| (code(&cells[1]), code(&cells[2])))
        .collect()
}

#[test]
fn what_readme_claims_is_what_its_commands_print() {
    let folder = shop();
    let claims = claims(&fs::read_to_string(root().join("README.md")).unwrap());
    assert_eq!(claims.len(), 5, "{claims:?}");
    for (command, printed) in claims {
        let words =
            format!("{} {}", env!("CARGO_BIN_EXE_leadscrew"), &command["leadscrew ".len()..]);
        let mut shell = Command::new("bash");
        shell.args(["-c", &words]).current_dir(folder.path()).env("NO_COLOR", "1");
        let output = shell.output().unwrap();
        let text = said(&output) + &complained(&output);
        assert_eq!(output.status.code(), Some(code_of(&command)), "{command}: {text}");
        assert!(!printed.is_empty() && text.contains(&printed), "{command}: {printed}\n{text}");
    }
}

#[test]
fn a_block_is_run_line_by_line_or_says_why_not() {
    let page = "a\n```sh\nleadscrew run a.ngc   # exit code 3\nb &\n```\n```console\n$ c\n```\n```gcode\nM2\n```\n\
                ```sh\n# not run by the tests: it takes minutes\nd\n```\n";
    let run = |line: &str, code| (line.to_owned(), code);
    assert_eq!(
        blocks(page).unwrap(),
        [
            Block::Run(vec![run("leadscrew run a.ngc", 3), run("b &", 0)]),
            Block::Run(vec![run("c", 0)]),
            Block::NotRun("it takes minutes".into()),
        ]
    );
    for wrong in [
        "```sh\n# not run by the tests:\nd\n```",
        "```console\nd\n```",
        "```sh\n$ d\n```",
        "```bash\nd\n```",
        "```sh\n```",
        "```sh\nd # exit code many\n```",
    ] {
        assert!(blocks(wrong).is_err(), "{wrong}");
    }
    let folder = tempfile::tempdir().unwrap();
    assert!(shell(folder.path(), &[run("false", 1), run("leadscrew codes > codes", 0)]).is_ok());
    assert!(folder.path().join("codes").exists());
    let wrong = shell(folder.path(), &[run("false", 0), run("touch on", 0)]);
    assert!(wrong.unwrap_err().contains("exit code 1 instead of 0"));
    assert!(!folder.path().join("on").exists(), "it went on");
}
