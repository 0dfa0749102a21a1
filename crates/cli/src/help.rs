//! Help: the common options, a topic, or all of them; and options that mean nothing to a command.
//!
//! ```text
//!   leadscrew run -h, --help        the common options, examples, the topics
//!   leadscrew run --help tools      the options of a topic
//!   leadscrew run --help all        all options, by topic
//!   leadscrew help run [TOPIC]      the same
//! ```
use crate::args::Cli;
use clap::builder::StyledStr;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, Command, CommandFactory};
use std::ffi::OsString;
use std::io::IsTerminal;

/// A group of options.
struct Topic {
    /// What is typed behind `--help`.
    name: &'static str,
    heading: &'static str,
    options: &'static [&'static str],
}

/// The groups; an option that is in none is a command's own, and always shown.
const TOPICS: [Topic; 7] = [
    Topic {
        name: "program",
        heading: "Program (--help program)",
        options: &[
            "decimal_point",
            "accept",
            "block_skip",
            "subprograms",
            "parameters",
            "from",
            "program_changed",
        ],
    },
    Topic {
        name: "tools",
        heading: "Tools and work (--help tools)",
        options: &["tool_unit", "pre_drilled"],
    },
    Topic {
        name: "tapping",
        heading: "Tapping (--help tapping)",
        options: &[
            "tapping",
            "tapping_preset",
            "clutch_dwell",
            "force_ramp",
            "synchronisation",
            "learning",
        ],
    },
    Topic {
        name: "cams",
        heading: "Cams (--help cams)",
        options: &[
            "cams",
            "phase_table",
            "compensation",
            "estimator",
            "work_speed",
            "feed_forward",
        ],
    },
    Topic {
        name: "simulation",
        heading: "Simulated machine (--help simulation)",
        options: &["plant", "part", "inputs", "real_time", "simulator", "state"],
    },
    Topic {
        name: "stops",
        heading: "Faults, stops, recovery (--help stops)",
        options: &["fault", "operator", "recover"],
    },
    Topic {
        name: "output",
        heading: "Output (--help output)",
        options: &["units", "timings", "write_parameters", "write_tools", "progress"],
    },
];

/// Options that are shown first, in this order.
const COMMON: [&str; 10] = [
    "machine",
    "dialect",
    "tools",
    "missing_tools",
    "material",
    "out",
    "report",
    "format",
    "log",
    "seed",
];

/// Options that are about programs, and mean nothing where a machine alone is led.
const PROGRAMS_ALONE: &[&str] = &[
    "missing_tools",
    "pre_drilled",
    "stock",
    "tapping",
    "clutch_dwell",
    "dialect",
    "decimal_point",
    "accept",
    "block_skip",
    "subprograms",
    "cams",
    "phase_table",
    "compensation",
    "estimator",
    "work_speed",
    "feed_forward",
    "tapping_preset",
];

/// Options that mean nothing to a command, which shares its arguments with others.
const MEANINGLESS: [(&str, &[&str]); 8] = [
    ("drives", PROGRAMS_ALONE),
    ("simulator", PROGRAMS_ALONE),
    ("check", &["inputs", "compensation", "estimator"]),
    ("time", &["inputs", "compensation", "estimator"]),
    ("lsp", &["inputs", "compensation", "estimator", "progress", "quiet"]),
    (
        "canon",
        &[
            "inputs",
            "pre_drilled",
            "tapping",
            "clutch_dwell",
            "phase_table",
            "compensation",
            "estimator",
            "work_speed",
            "feed_forward",
            "tapping_preset",
        ],
    ),
    ("man", &["progress", "quiet"]),
    ("completions", &["progress", "quiet"]),
];

/// Finds what help is asked for: its text, or why there is none of that name; `None`: none is asked
/// for.
pub(crate) fn asked(words: &[OsString]) -> Option<Result<String, String>> {
    let words: Vec<_> = words.iter().skip(1).map(|word| word.to_string_lossy()).collect();
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).take_while(|w| *w != "--").collect();
    let (names, topic) = if words.first() == Some(&"help") {
        (&words[1..], words.last().copied().filter(|word| is_topic(word)))
    } else {
        let is_help = |word: &&str| matches!(*word, "-h" | "--help") || word.starts_with("--help=");
        let at = words.iter().position(is_help)?;
        let joined = words[at].strip_prefix("--help=");
        let next = words.get(at + 1).copied().filter(|word| is_topic(word));
        (&words[..at], joined.or(next))
    };
    let mut command = Cli::command();
    command.build();
    let mut path = vec!["leadscrew".to_owned()];
    for name in names {
        if let Some(inner) = command.find_subcommand(name) {
            path.push(inner.get_name().to_owned());
            command = inner.clone();
        } else if words.first() == Some(&"help") && !is_topic(name) {
            return Some(Err(format!("there is no command {name}; `leadscrew --help` lists them")));
        }
    }
    // its words are another program's
    if path.iter().any(|name| name == "study") {
        return None;
    }
    let is_shown = std::io::stdout().is_terminal();
    let written =
        |text: StyledStr| if is_shown { text.ansi().to_string() } else { text.to_string() };
    Some(of(command, &path, topic).map(written))
}

fn is_topic(word: &str) -> bool {
    word == "all" || TOPICS.iter().any(|topic| topic.name == word)
}

/// Commands that switch a control on before there is a program whose words could choose.
const WITHOUT_PROGRAM: [&str; 2] = ["control", "serve"];
/// Their options that say something else where a program is named.
const ALONE: [(&str, &str); 3] = [
    (
        "machine",
        "The machine: a name from `leadscrew machine list`, or a file [default: tapping-center]",
    ),
    ("dialect", "How programs are read [default: as the machine's file says]"),
    ("missing_tools", "What to do with tools that the table lacks [default: refuse]"),
];

/// The help of a command.
fn of(command: Command, path: &[String], topic: Option<&str>) -> Result<StyledStr, String> {
    let meaningless = meaningless(command.get_name());
    let ids: Vec<String> = command.get_arguments().map(|arg| arg.get_id().to_string()).collect();
    let has = |topic: &Topic| {
        ids.iter()
            .any(|id| topic.options.contains(&id.as_str()) && !meaningless.contains(&id.as_str()))
    };
    let topics: Vec<&Topic> = TOPICS.iter().filter(|topic| has(topic)).collect();
    let called = path.join(" ");
    if let Some(name) =
        topic.filter(|name| *name != "all" && topics.iter().all(|t| t.name != *name))
    {
        let names: Vec<_> = topics.iter().map(|topic| topic.name).collect();
        return Err(format!(
            "{called} has no help on {name}: `{called} --help all` has everything{}",
            if names.is_empty() {
                String::new()
            } else {
                format!("; topics are {}", names.join(", "))
            }
        ));
    }
    let mut shown = command.bin_name(called.clone());
    if topics.len() > 1 {
        shown = shown.mut_arg("help", |arg| arg.help("Print help; --help all has every option"));
    } else {
        shown = shown.mut_arg("help", |arg| arg.help("Print help"));
    }
    let is_without_program = WITHOUT_PROGRAM.contains(&shown.get_name());
    for (id, text) in
        ALONE.iter().filter(|(id, _)| is_without_program && ids.iter().any(|i| i == id))
    {
        shown = shown.mut_arg(id, |arg| arg.help(*text));
    }
    for id in ids.iter().filter(|id| *id != "help" && *id != "version") {
        let group = TOPICS.iter().find(|topic| topic.options.contains(&id.as_str()));
        let is_common = COMMON.iter().position(|common| common == id);
        let hidden = meaningless.contains(&id.as_str())
            || match (topic, group) {
                (None, Some(group)) => topics.len() > 1 || group.name != "output",
                (Some("all") | None, _) => false,
                (Some(name), Some(group)) => group.name != name,
                (Some(_), None) => true,
            };
        shown = shown.mut_arg(id, |arg| {
            let arg = if arg.is_positional() { arg } else { arg.hide(hidden) };
            let arg = match is_common {
                Some(place) if !arg.is_positional() => arg.display_order(place),
                _ => arg,
            };
            match group {
                Some(group) => arg.help_heading(group.heading),
                None => arg,
            }
        });
    }
    if topic.is_some() {
        if let Some(long) = shown.get_after_long_help().cloned() {
            shown = shown.after_help(long);
        }
    } else if !topics.is_empty() && topics.iter().any(|topic| topic.name != "output") {
        let names: Vec<_> = topics.iter().map(|topic| topic.name).collect();
        let more =
            format!("More options: `{called} --help all`, or a topic: --help {}", names.join(", "));
        let own = shown.get_after_help().map(ToString::to_string);
        shown = shown.after_help(own.map_or(more.clone(), |own| format!("{more}\n\n{own}")));
    }
    Ok(shown.render_help())
}

fn meaningless(command: &str) -> &'static [&'static str] {
    MEANINGLESS.iter().find(|(name, _)| *name == command).map_or(&[], |(_, ids)| ids)
}

/// Refuses an option that means nothing to its command.
pub(crate) fn means_something(read: &ArgMatches) -> Result<(), clap::Error> {
    let Some((name, of_command)) = read.subcommand() else { return Ok(()) };
    for id in meaningless(name) {
        let is_typed = of_command.try_contains_id(id).unwrap_or(false)
            && of_command.value_source(id) == Some(ValueSource::CommandLine);
        if is_typed {
            let option = id.replace('_', "-");
            let text = format!("--{option} means nothing to {name}");
            return Err(Cli::command().error(ErrorKind::ArgumentConflict, text));
        }
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test may panic
mod tests {
    use super::*;

    fn help(words: &str) -> String {
        let words: Vec<OsString> = words.split_whitespace().map(Into::into).collect();
        asked(&words).unwrap().unwrap()
    }

    #[test]
    fn help_of_every_command_fits_a_screen_and_all_has_every_option_once() {
        let mut cli = Cli::command();
        cli.build();
        for command in cli.get_subcommands().filter(|c| c.get_name() != "study") {
            let name = command.get_name();
            if command.has_subcommands() {
                continue;
            }
            let short = help(&format!("leadscrew {name} --help"));
            assert_eq!(short, help(&format!("leadscrew {name} -h")), "{name}");
            assert_eq!(short, help(&format!("leadscrew help {name}")), "{name}");
            let lines = short.lines().count();
            // who serves has a network, tokens and a broker to state
            let most = if name == "serve" { 90 } else { 66 };
            assert!(lines <= most, "{name}: {lines} lines\n{short}");
            let all = help(&format!("leadscrew {name} --help all"));
            let nothing = meaningless(name);
            for arg in command.get_arguments().filter(|arg| !arg.is_hide_set()) {
                let Some(long) = arg.get_long() else { continue };
                let begins = |line: &str| {
                    if !(2..=6).contains(&(line.len() - line.trim_start().len())) {
                        return false; // a sentence goes on
                    }
                    let line = line.trim_start();
                    let line = line.strip_prefix("-").map_or(line, |rest| {
                        rest.get(1..).map_or(line, |r| r.strip_prefix(", ").unwrap_or(line))
                    });
                    line.strip_prefix(&format!("--{long}")).is_some_and(|rest| {
                        !rest.starts_with(|c: char| c == '-' || c.is_alphanumeric())
                    })
                };
                let times = all.lines().filter(|line| begins(line)).count();
                let wanted = usize::from(!nothing.contains(&arg.get_id().as_str()));
                assert_eq!(times, wanted, "{name} --{long}\n{all}");
            }
            assert!(all.lines().all(|line| line.chars().count() <= 130), "{name}");
        }
    }

    #[test]
    fn a_control_that_is_switched_on_before_there_is_a_program_has_no_words_of_it() {
        for command in ["control", "serve"] {
            assert!(
                !help(&format!("leadscrew {command} --help")).contains("program's words"),
                "{command}"
            );
        }
        assert!(help("leadscrew run --help").contains("program's words"));
    }

    #[test]
    fn every_topic_and_every_common_option_is_one_of_run() {
        let mut cli = Cli::command();
        cli.build();
        let run = cli.find_subcommand("run").unwrap();
        let ids: Vec<_> = run.get_arguments().map(|arg| arg.get_id().to_string()).collect();
        for id in TOPICS.iter().flat_map(|topic| topic.options).chain(&COMMON) {
            assert!(ids.iter().any(|known| known == id), "{id}");
        }
        assert!(help("leadscrew run --help stops").contains("--fault"));
        assert!(!help("leadscrew run --help stops").contains("--machine <"));
        assert!(
            asked(&["leadscrew".into(), "run".into(), "--help=nothing".into()]).unwrap().is_err()
        );
        assert!(asked(&["leadscrew".into(), "run".into(), "a.ngc".into()]).is_none());
    }

    #[test]
    fn an_option_that_means_nothing_to_a_command_is_refused() {
        let read = |words: &str| {
            let read = Cli::command().try_get_matches_from(words.split_whitespace()).unwrap();
            means_something(&read)
        };
        assert!(read("leadscrew canon a.ngc --tapping floating").is_err());
        assert!(read("leadscrew check a.ngc --inputs x").is_err());
        assert!(read("leadscrew check a.ngc --tapping floating").is_ok());
        assert!(read("leadscrew run a.ngc --inputs x").is_ok());
    }
}
