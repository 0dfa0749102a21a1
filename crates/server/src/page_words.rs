//! What the command line calls by an option, in the words of the page.
//!
//! Findings, refusals and alarms are written for the command line, which has options; the page has
//! none. Whole sentences are replaced first, then each option by what it sets.

/// Whole parts of sentences, and what stands in their place.
const SENTENCES: &[(&str, &str)] = &[
    (
        "--tools FILE names the shop's own; tools.toml or tool.tbl beside the program is found by itself",
        "\"Offsets and tools\" shows the tools that the control has; whoever starts it names the shop's own table",
    ),
    (
        "--tools FILE names the shop's own tools; their table says which one is an insert",
        "whoever starts the control names the shop's own tools; their table says which one is an insert",
    ),
    (
        "--machine and --dialect name others; with --machine the dialect is the one of the machine's file",
        "the machine and its dialect are those that the control was started with",
    ),
    ("read with --decimal-point calculator: ", "numbers without a point are read as whole units: "),
    (
        "; --decimal-point increments reads them so",
        "; decimal_point = \"increments\" under [control.fanuc] of the machine's file reads them so",
    ),
    (
        "say so with --decimal-point calculator.",
        "its file says so: decimal_point = \"calculator\" under [control.fanuc].",
    ),
    (
        "--decimal-point calculator reads them the other way, as decimal_point",
        "they are read the other way where decimal_point",
    ),
    (
        "--decimal-point increments reads them the other way, as decimal_point",
        "they are read the other way where decimal_point",
    ),
    ("of the machine's file does", "stands in the machine's file"),
    ("name the library with --cams;", "whoever starts the control names the library of cams;"),
    (
        "; --accept no-end lets it end with its text",
        "; whoever starts the control may let programs end with their text",
    ),
    (
        "; --parameters FILE brings what the control keeps",
        "; \"Offsets and tools\" shows what the control keeps",
    ),
    ("read it with --dialect ", "read it as one for dialect "),
    ("`--tapping synchronised`", "synchronised tapping"),
    ("a setting of the machine: --tapping floating", "a setting of the machine: floating tapping"),
    ("name a state folder with --state", "whoever starts the control names one"),
    (
        "name another folder with --state",
        "let another folder be named where the control is started",
    ),
];

/// Each option, and what it sets.
const OPTIONS: &[(&str, &str)] = &[
    ("--cams", "the library of cams"),
    ("--decimal-point", "decimal_point"),
    ("--dialect", "dialect"),
    ("--fault", "a simulated fault"),
    ("--learning", "another learning file"),
    ("--listen", "its address"),
    ("--machine", "machine"),
    ("--operator", "orders of the operator"),
    ("--phase-table", "a phase table in the file"),
    ("--real-time", "real time"),
    ("--recover", "recovery"),
    ("--renew-tool", "renew_tool"),
    ("--state", "the state folder"),
    ("--stock", "the stock"),
    ("--tapping", "the method of tapping"),
    ("--tool-unit", "the tool table's unit"),
    ("--tools", "the tool table"),
];

/// Ways of the command line beside one of the page: from here to there they are left out.
const BESIDE: &[[&str; 2]] = &[[", `run --renew-tool ", "`"]];

/// The text in the words of the page.
pub(crate) fn on_page(text: &str) -> String {
    if !text.contains("--") {
        return text.to_owned();
    }
    let mut text =
        SENTENCES.iter().fold(text.to_owned(), |text, (option, page)| text.replace(option, page));
    for [from, to] in BESIDE {
        if let Some((before, rest)) = text.split_once(from)
            && let Some((_, behind)) = rest.split_once(to)
        {
            text = format!("{before}{behind}");
        }
    }
    for (option, page) in OPTIONS {
        text = without(&text, option, page);
    }
    text
}

/// The option by its whole name: `--tool-unit` is not `--tool`, nor is a file's name an option.
fn without(text: &str, option: &str, page: &str) -> String {
    let mut pieces = text.split(option);
    let mut all = pieces.next().unwrap_or_default().to_owned();
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
    for piece in pieces {
        let is_longer = piece.starts_with(|c: char| c.is_ascii_alphanumeric() || "-_".contains(c));
        all += if is_longer || all.ends_with(is_name) { option } else { page };
        all += piece;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Crates whose sentences reach the page.
    const CRATES: [&str; 11] = [
        "canon", "control", "diag", "forms", "gcode", "interp", "kernel", "lsp", "plan", "store",
        "sync",
    ];

    /// Sentences that `leadscrew explain` says, at the command line alone.
    const EXPLAINED: &str = "elsewhere.rs";

    /// Lines of code with an option, of the files below a folder, tests apart.
    fn lines_with_options(folder: &Path, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = entry.file_name().to_string_lossy().into_owned();
            if path.is_dir() {
                if name != "tests" {
                    lines_with_options(&path, found);
                }
            } else if path.extension().is_some_and(|ext| ext == "rs")
                && !name.contains("tests")
                && name != EXPLAINED
            {
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let is_said = |line: &&str| !line.trim_start().starts_with("//");
                let lines = code.lines().filter(is_said).filter(|line| options_of(line) > 0);
                found.extend(lines.map(|line| line.trim().to_owned()));
            }
        }
    }

    fn options_of(line: &str) -> usize {
        let begins = |(at, _): (usize, &str)| {
            let before = line[..at].chars().next_back();
            let after = line[at + 2..].chars().next();
            !before.is_some_and(|c| c == '-' || c.is_alphanumeric())
                && after.is_some_and(|c| c.is_ascii_lowercase())
        };
        line.match_indices("--").filter(|found| begins(*found)).count()
    }

    /// What stands for a value in a sentence of the code.
    fn filled(line: &str) -> Vec<String> {
        let value = |name: &str, value: &str| line.replace(name, value);
        ["calculator", "increments"].map(|one| value("{other}", one)).to_vec()
    }

    #[test]
    fn no_sentence_that_reaches_the_page_names_an_option_there() {
        let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let mut lines = Vec::new();
        for name in CRATES {
            lines_with_options(&crates.join(name).join("src"), &mut lines);
        }
        assert!(lines.len() > 20, "{lines:#?}");
        for line in lines.iter().flat_map(|line| filled(line)) {
            let page = on_page(&line);
            assert_eq!(options_of(&page), 0, "{line}\nbecomes\n{page}");
        }
    }

    #[test]
    fn an_option_is_known_by_its_whole_name() {
        assert_eq!(on_page("a -- b"), "a -- b");
        assert_eq!(on_page("--tool-units x"), "--tool-units x");
        assert_eq!(on_page("a--state.ngc is loaded"), "a--state.ngc is loaded");
        assert_eq!(
            on_page("this machine simulator keeps real time, and so must its control: --real-time"),
            "this machine simulator keeps real time, and so must its control: real time"
        );
        let other = "read it with --dialect haas, or set dialect = \"haas\" under [control] of the machine's file";
        assert!(on_page(other).starts_with("read it as one for dialect haas, or set"));
    }

    #[test]
    fn what_the_page_can_do_itself_is_said_alone() {
        let broken = "say so: \"New tool\" on the page, renew_tool over the network, `run --renew-tool 3`; in a tool table";
        assert_eq!(
            on_page(broken),
            "say so: \"New tool\" on the page, renew_tool over the network; in a tool table"
        );
    }

    #[test]
    fn the_built_in_table_is_spoken_of_as_the_page_has_it() {
        let help = "--tools FILE names the shop's own; tools.toml or tool.tbl beside the program is found by itself";
        assert!(on_page(help).starts_with("\"Offsets and tools\" shows"));
    }
}
