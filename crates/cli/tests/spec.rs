//! The pages in `spec/` run: what they show is what the program does.
//!
//! `UPDATE_SPEC=1 cargo test -p cli --test all spec::` writes the pages anew, and the pictures of
//! the steps: a page that shows `../docs/pictures/spec-NAME.svg` gets it from its own first log.
use crate::spec_pictures;
use std::{
    fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};
use test_support::Relay;

#[test]
fn every_page_shows_what_the_program_does() {
    let mut wrong = Vec::new();
    let mut blocks = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let (anew, checked) = rewritten(&text);
        // a page of rules is run by `interp/tests/fanuc_behaviours.rs`
        let has_rules = text.contains("\n```means\n");
        assert!(checked > 0 || has_rules, "{} shows no program", page.display());
        wrong.extend(picture_of(&page, &anew));
        blocks += checked;
        if anew == text {
            continue;
        }
        if std::env::var_os("UPDATE_SPEC").is_some() {
            fs::write(&page, &anew).unwrap();
        } else {
            wrong.push(format!("{}\n{}", page.display(), difference(&text, &anew)));
        }
    }
    assert!(blocks >= 4, "the pages were not found");
    let hint = "UPDATE_SPEC=1 cargo test -p cli --test all spec::";
    assert!(wrong.is_empty(), "{}\nIf this is as it should be: {hint}", wrong.join("\n\n"));
}

/// The page with every output block as the program prints it now, and how many there are.
fn rewritten(page: &str) -> (String, usize) {
    let mut out = String::new();
    let mut program = String::new();
    let mut options = Vec::new();
    let mut folder = None;
    let mut checked = 0;
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        out.push_str(line);
        out.push('\n');
        let Some(kind) = line.strip_prefix("```").filter(|kind| !kind.is_empty()) else { continue };
        let body: Vec<_> = lines.by_ref().take_while(|l| *l != "```").collect();
        match kind {
            gcode if gcode == "gcode" || gcode.starts_with("gcode ") => {
                program = body.join("\n") + "\n";
                options = gcode.split(' ').skip(1).filter(|word| *word != "refused").collect();
            }
            "log" => {
                let arguments = [&["run", "-", "--log"], &options[..]].concat();
                out.push_str(&without_names(&run(&arguments, &program, 0)));
                out.push_str("```\n");
                checked += 1;
                continue;
            }
            "session" => {
                out.push_str(&session(&body, &program));
                out.push_str("```\n");
                checked += 1;
                continue;
            }
            console if console == "console" || console.starts_with("console ") => {
                let options: Vec<_> = console.split(' ').skip(1).collect();
                out.push_str(&led(desk(&mut folder, &program), &options, &body));
                out.push_str("```\n");
                checked += 1;
                continue;
            }
            "diagnostics" => {
                out.push_str(&run(&[&["check", "-"], &options[..]].concat(), &program, 2));
                out.push_str("```\n");
                checked += 1;
                continue;
            }
            _ => {}
        }
        for line in body {
            out.push_str(line);
            out.push('\n');
        }
        out.push_str("```\n");
    }
    (out, checked)
}

/// The folder in which a page's control is led: with its program as `part.ngc`, and the shipped
/// programs.
fn desk<'a>(folder: &'a mut Option<tempfile::TempDir>, program: &str) -> &'a Path {
    let folder = folder.get_or_insert_with(|| {
        let folder = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(root().join("programs"), folder.path().join("programs"))
            .unwrap();
        folder
    });
    fs::write(folder.path().join("part.ngc"), program).unwrap();
    folder.path()
}

/// What a control prints that is led by the lines behind `> `; each must be accepted, each wait
/// met.
fn led(folder: &Path, options: &[&str], body: &[&str]) -> String {
    let typed = body.iter().filter_map(|line| line.strip_prefix("> "));
    let script: String = typed.map(|line| line.to_owned() + "\n").collect();
    let tools = ["--tools", "programs/tools.toml", "--subprograms", "programs"];
    let arguments = [&["control", "--script", "-"], &tools[..], options].concat();
    run_in(folder, &arguments, &script, 0)
}

/// Without the lines that name program and tools: the page has told of both.
fn without_names(text: &str) -> String {
    let names = |line: &&str| !line.starts_with("- on ") && !line.starts_with("tools from ");
    text.lines().filter(names).map(|line| line.to_owned() + "\n").collect()
}

/// The picture of the steps, which must be that of the page's first log; what is wrong with it.
fn picture_of(page: &Path, text: &str) -> Option<String> {
    let name = page.file_stem().unwrap().to_str().unwrap();
    let file = format!("docs/pictures/spec-{name}.svg");
    if !text.contains(&format!("../{file}")) {
        return None;
    }
    let log = text.split("```log\n").nth(1).and_then(|rest| rest.split("```").next());
    let anew = spec_pictures::picture(name, log.unwrap_or_default()).expect("a log with steps");
    let path = root().join(&file);
    if fs::read_to_string(&path).is_ok_and(|old| old == anew) {
        return None;
    }
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(&path, &anew).unwrap();
        return None;
    }
    Some(format!("{file} is not the picture of the page's log"))
}

/// What the program prints for a G-code program on its standard input.
fn run(arguments: &[&str], program: &str, exit_code: i32) -> String {
    let arguments = [arguments, &["--tools", "programs/tools.toml"]].concat();
    run_in(&root(), &arguments, program, exit_code)
}

fn run_in(folder: &Path, arguments: &[&str], program: &str, exit_code: i32) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(program.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let erred = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(exit_code), "{program}\n{said}\n{erred}");
    let text = said + &erred;
    text.lines().map(|line| line.trim_end().to_owned() + "\n").collect::<String>()
}

/// A session in a folder that holds the program as `part.ngc`: each line that begins with `$` is
/// typed, and what it prints stands below it. What ends in `&` goes on until the session is over;
/// `# killed at 2.5 s` behind a control: at that machine time, by SIGKILL.
fn session(lines: &[&str], program: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.ngc"), program).unwrap();
    fs::copy(root().join("programs/tools.toml"), folder.path().join("tools.toml")).unwrap();
    let (mut behind, mut relay) = (Vec::new(), None);
    let mut out = String::new();
    for line in lines.iter().filter_map(|line| line.strip_prefix("$ leadscrew ")) {
        out.push_str(&format!("$ leadscrew {line}\n"));
        let (line, killed) = line.split_once(" # killed at ").unwrap_or((line, ""));
        let (typed, stays) = line.strip_suffix(" &").map_or((line, false), |typed| (typed, true));
        let quoted = typed.split('"').enumerate();
        let words = quoted.flat_map(|(at, part)| match at % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect::<Vec<_>>(),
            _ => vec![part.to_owned()],
        });
        let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
        command.args(words).current_dir(folder.path()).env("NO_COLOR", "1");
        if stays {
            let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
            let mut first = String::new();
            BufReader::new(process.stdout.take().unwrap()).read_line(&mut first).unwrap();
            out.push_str(&first);
            behind.push(process);
            continue;
        }
        if let Some(at) = killed.strip_suffix(" s") {
            let socket = folder.path().join("machine");
            relay = Some(Relay::in_place_of(&socket, &[at.parse().unwrap()]).unwrap());
        }
        let output = match &relay {
            Some(relay) => relay.output(&mut command).unwrap(),
            None => command.output().unwrap(),
        };
        let said = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        out.extend(said.concat().lines().map(|line| line.trim_end().to_owned() + "\n"));
        match output.status.code() {
            Some(0) => {}
            Some(code) => out.push_str(&format!("exit code {code}\n")),
            None => out.push_str("killed\n"),
        }
    }
    for mut process in behind {
        process.kill().unwrap();
        process.wait().unwrap();
    }
    out
}

fn pages() -> Vec<PathBuf> {
    let mut pages: Vec<_> = fs::read_dir(root().join("spec"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .filter(|p| p.file_name().is_some_and(|n| n != "README.md" && n != "codes.md"))
        .collect();
    pages.sort();
    pages
}

fn difference(old: &str, new: &str) -> String {
    let changed = old.lines().zip(new.lines()).filter(|(a, b)| a != b).take(12);
    let mut text = changed.map(|(a, b)| format!("- {a}\n+ {b}")).collect::<Vec<_>>().join("\n");
    let (a, b) = (old.lines().count(), new.lines().count());
    text.push_str(&format!("\n{a} lines before, {b} now"));
    text
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
