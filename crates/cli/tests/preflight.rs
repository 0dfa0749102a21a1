//! One preflight behind check, time, run and the editor; and what it calls clean breaks nothing
//! when it is run.
use crate::common::{complained, leadscrew, root, said};
use crate::editor::Editor;
use serde_json::{Value, json};
use std::path::Path;
use test_support::size;

/// Code, line and message of a finding.
type Finding = (String, u64, String);

fn checked(program: &Path, arguments: &[&str]) -> Vec<Finding> {
    let mut all = vec!["check", program.to_str().unwrap(), "--format", "json"];
    all.extend(arguments);
    let output = leadscrew(&all);
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}{}", said(&output), complained(&output)));
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let here = program.to_str().unwrap();
    let own =
        found.as_array().unwrap().iter().filter(|f| f["file"] == here || f["place"].is_null());
    // the editor has no line 0: what has no place is shown at the top
    own.map(|f| {
        let line = f["place"]["line"].as_u64().unwrap_or(0).max(1);
        (text(&f["code"]), line, text(&f["message"]))
    })
    .collect()
}

/// The codes of findings as they are printed with carets, in their order.
fn printed(text: &str) -> Vec<String> {
    let kinds = ["error[", "warning[", "note["];
    let code = |line: &str| {
        let rest = kinds.iter().find_map(|kind| line.strip_prefix(kind))?;
        Some(rest.split_once("]: ")?.0.to_owned())
    };
    text.lines().filter_map(code).collect()
}

impl Editor {
    fn opened(&mut self, program: &Path, text: &str) -> Vec<Finding> {
        self.open(&uri(program), text);
        self.shown()
    }

    fn edited(&mut self, program: &Path, text: &str) -> Vec<Finding> {
        self.change(&uri(program), json!({ "text": text }));
        self.shown()
    }

    fn shown(&mut self) -> Vec<Finding> {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let of = |f: &Value| {
            let message = text(&f["message"]);
            let message = message.lines().next().unwrap_or_default().to_owned();
            (text(&f["code"]), f["range"]["start"]["line"].as_u64().unwrap() + 1, message)
        };
        self.findings().iter().map(of).collect()
    }
}

fn uri(program: &Path) -> String {
    format!("file://{}", program.display())
}

/// The machine and dialect for a shipped program.
fn arguments(program: &str) -> &'static [&'static str] {
    match program {
        "cam-grind.nc" | "cam-measure.nc" => &["--machine", "cam-grinder", "--dialect", "toyoda"],
        "cam-shaft.nc" => &["--machine", "cam-grinder"],
        "scroll.ngc" => &["--machine", "mill-5-axis"],
        "thread-m20x1.5.ngc" => &["--machine", "lathe"],
        "feed-screw.nc" => &["--machine", "lathe", "--dialect", "fanuc-lathe-a"],
        "mill-8xM8.ngc" => &["--machine", "vfd-mill"],
        "gear-m2-z40.nc" => &["--machine", "gear-hobber"],
        "hexagon-af17.nc" | "square-af30.nc" => &["--machine", "polygon-lathe"],
        "plate-macro.nc" => &["--dialect", "fanuc"],
        "chip-removal.nc" => &["--dialect", "brother"],
        _ => &[],
    }
}

fn shipped() -> Vec<std::path::PathBuf> {
    let folder = root().join("programs");
    let mut all: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    all.retain(|path| path.extension().is_some_and(|end| end == "ngc" || end == "nc"));
    all.sort();
    all
}

/// The programs of a spec page with what they are checked with.
fn of_spec_pages() -> Vec<(String, Vec<String>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(root().join("spec")).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let mut rest = &*text;
        while let Some(at) = rest.find("```gcode") {
            let block = &rest[at + 8..];
            let (head, body) = block.split_once('\n').unwrap();
            let (body, after) = body.split_once("```").unwrap();
            let words: Vec<String> = head.split_whitespace().map(str::to_owned).collect();
            all.push((body.to_owned(), words));
            rest = after;
        }
    }
    all
}

#[test]
fn check_time_run_and_editor_say_the_same_of_every_shipped_program() {
    for program in shipped() {
        let name = program.file_name().unwrap().to_str().unwrap().to_owned();
        let arguments = arguments(&name);
        let found = checked(&program, arguments);
        let text = std::fs::read_to_string(&program).unwrap();
        let mut editor = Editor::start(arguments);
        let shown = editor.opened(&program, &text);
        editor.leave();
        assert_eq!(shown, found, "{name}");
        let mut time = vec!["time", program.to_str().unwrap()];
        time.extend(arguments);
        let codes: Vec<_> = found.iter().map(|(code, ..)| code.clone()).collect();
        assert_eq!(printed(&complained(&leadscrew(&time))), codes, "time {name}");
    }
}

#[test]
fn check_time_run_and_editor_say_the_same_of_programs_on_spec_pages_and_of_random_edits_of_them() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(root().join("programs/tools.toml"), folder.path().join("tools.toml")).unwrap();
    let program = folder.path().join("part.ngc");
    let mut random = Random(11);
    let mut editor = Editor::start(&[]);
    let mut is_open = false;
    let mut seen = std::collections::BTreeSet::new();
    for (text, words) in of_spec_pages().into_iter().filter(|(_, words)| words.is_empty()).take(16)
    {
        assert!(words.is_empty());
        for edit in 0..3 {
            let text = if edit == 0 { text.clone() } else { edited(&text, &mut random) };
            std::fs::write(&program, &text).unwrap();
            let shown = if is_open {
                editor.edited(&program, &text)
            } else {
                editor.opened(&program, &text)
            };
            is_open = true;
            let found = checked(&program, &[]);
            assert_eq!(shown, found, "{text}");
            seen.extend(found.iter().map(|(code, ..)| code.clone()));
            if edit == 1 {
                let codes: Vec<_> = found.iter().map(|(code, ..)| code.clone()).collect();
                let output = leadscrew(&["time", program.to_str().unwrap()]);
                assert_eq!(printed(&complained(&output)), codes, "time of\n{text}");
                if output.status.code() == Some(2) {
                    let output = leadscrew(&["run", program.to_str().unwrap()]);
                    assert_eq!(printed(&complained(&output)), codes, "run of\n{text}");
                }
            }
        }
    }
    editor.leave();
    assert!(seen.len() >= 8 && seen.iter().any(|code| code.starts_with('M')), "{seen:?}");
}

/// A program with one number changed, or one line left out.
fn edited(text: &str, random: &mut Random) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let with_number: Vec<_> =
        (0..lines.len()).filter(|i| lines[*i].contains(|c: char| c.is_ascii_digit())).collect();
    let Some(line) = with_number.get(random.below(with_number.len().max(1))).copied() else {
        return text.to_owned();
    };
    if random.below(4) == 0 {
        lines.remove(line);
    } else {
        let at = lines[line].find(|c: char| "ZRFSH".contains(c)).map_or(0, |at| at + 1);
        let digit = lines[line][at..].find(|c: char| c.is_ascii_digit()).map(|n| n + at);
        if let Some(digit) = digit {
            let by = random.below(10).to_string();
            lines[line].replace_range(digit..=digit, &by);
        }
    }
    lines.join("\n") + "\n"
}

/// Small numbers from a seed.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % most.max(1)
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

/// Drill and tap one hole, with lengths, offsets, feeds and moves that may be wrong.
fn shifted(random: &mut Random) -> String {
    let offset = |random: &mut Random, tool: u32| match random.below(12) {
        0 => String::new(),
        1 => format!("G43 H{}\n", random.pick(&[1, 2, 3, 10, 11])),
        2 => format!("G43.1 Z{}\n", 105.25 + random.pick(&[-40.0, -12.0, -1.0, 0.5, 6.0])),
        _ => format!("G43 H{tool}\n"),
    };
    let depth = random.pick(&[12.0, 18.0, 24.0]);
    let x = random.pick(&[10.0, 40.0, 80.0, 199.0, 205.0]);
    let tap_depth = depth - random.pick(&[6.0, 6.0, 4.0, 2.0, 0.0]);
    let shift = match random.below(10) {
        0 => format!("G92 Z{}\n", random.pick(&[40.0, 28.0, 33.0])),
        1 => format!("G10 L2 P1 Z{}\n", -300.0 + random.pick(&[-5.0, 3.0, 20.0])),
        _ => String::new(),
    };
    let mut text = "G21 G17 G40 G49 G80 G90 G94 G54\n".to_owned();
    text += "T2 M6\n";
    text += &offset(random, 2);
    text += &format!(
        "S6000 {}\nG0 X{x} Y10 Z30\n",
        random.pick(&["M3", "M3", "M3", "M3", "M3", "M3", "M4", "M5"])
    );
    text += &shift;
    let r = random.pick(&[2.0, 2.0, 2.0, 2.0, 0.5, -3.0]);
    let feed = random.pick(&[600.0, 900.0, 900.0, 900.0, 2000.0, 5000.0]);
    text += &format!("G99 G81 X{x} Y10 Z-{depth} R{r} F{feed}\nG80\n");
    match random.below(10) {
        0 => text += &format!("G0 X{}\n", x + random.pick(&[0.5, 30.0])),
        1 => text += &format!("G0 Z-{}\n", random.pick(&[3.0, 30.0])),
        2 => text += "G1 Z-4 F600\nG1 X60\n",
        _ => {}
    }
    text += "G0 Z40\nT3 M6\n";
    text += &offset(random, 3);
    text += &format!(
        "S1500 M3\nG0 X{x} Y10 Z30\nG99 G84 X{x} Y10 Z-{tap_depth} R5 F1500\nG80\nG0 Z40\nM2\n"
    );
    text
}

#[test]
fn a_program_that_check_calls_clean_breaks_no_tool_when_it_is_run() {
    let trials = size::of(40, 120);
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(root().join("programs/tools.toml"), folder.path().join("tools.toml")).unwrap();
    let program = folder.path().join("part.ngc");
    let mut random = Random(5);
    let (mut clean, mut warned, mut refused, mut broke) = (0, 0, 0, 0);
    for _ in 0..trials {
        let text = shifted(&mut random);
        std::fs::write(&program, &text).unwrap();
        let output = leadscrew(&["run", program.to_str().unwrap()]);
        let (out, told) = (said(&output), complained(&output));
        let found = checked(&program, &[]);
        let codes: Vec<_> = found.iter().map(|(code, ..)| code.clone()).collect();
        assert_eq!(printed(&told), codes, "run and check differ of\n{text}");
        // a hole that is not drilled here, or without pecks, is a note, and no cause of anything
        let is_clean = codes.iter().all(|code| code == "M0324" || code == "M0374");
        let breaks = out.contains("safety check violated");
        match output.status.code() {
            Some(2) => refused += 1,
            Some(0) if is_clean => clean += 1,
            _ => warned += 1,
        }
        broke += usize::from(breaks);
        assert!(!(is_clean && breaks), "check is clean and run breaks:\n{text}{out}{told}");
        assert!(
            !is_clean || output.status.code() == Some(0),
            "check is clean and run is not good:\n{text}{out}{told}"
        );
    }
    println!(
        "{clean} clean and good, {warned} warned, {refused} refused, {broke} broke with a warning"
    );
    assert!(
        clean >= size::of(1, 5) && 8 * refused >= trials,
        "{clean} clean, {warned} warned, {refused} refused"
    );
}
