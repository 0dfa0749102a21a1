//! `leadscrew man`: the command line as a manual page (roff), from the same texts as `--help`.
use crate::args::Cli;
use crate::say;
use clap::{Command, CommandFactory};
use control::Refused;

/// Write the page of `of`, or of the program itself, to standard output.
pub(crate) fn command(of: Option<&str>) -> Result<(), Refused> {
    say::out(&page(of)?)
}

fn page(of: Option<&str>) -> Result<String, Refused> {
    let mut whole = Cli::command();
    whole.build(); // gives subcommands their full names and the global options
    let shown = match of {
        None => whole,
        Some(name) => named(&whole, name)?,
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(shown)
        .render(&mut text)
        .map_err(|why| Refused::because(format!("the manual page cannot be written: {why}")))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The subcommand of this name.
fn named(whole: &Command, name: &str) -> Result<Command, Refused> {
    let known = |c: &Command| c.get_name() != "help" && !c.is_hide_set();
    if let Some(found) = whole.get_subcommands().find(|c| known(c) && c.get_name() == name) {
        return Ok(found.clone()); // `build` has given it the display name leadscrew-NAME
    }
    let names: Vec<&str> =
        whole.get_subcommands().filter(|c| known(c)).map(Command::get_name).collect();
    Err(Refused::because(format!("no command {name}: there are {}", names.join(", "))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_manual_page_with_its_options_and_examples() {
        let whole = page(None).unwrap();
        assert!(whole.contains(".TH") && whole.contains("leadscrew"), "{whole}");
        let run = page(Some("run")).unwrap();
        for part in [".TH leadscrew-run", "\\-\\-machine", "\\-\\-out", "Exit code"] {
            assert!(run.contains(part), "{part}: {run}");
        }
        for command in Cli::command().get_subcommands() {
            assert!(page(Some(command.get_name())).is_ok(), "{}", command.get_name());
        }
    }

    #[test]
    fn an_unknown_command_is_refused_with_the_ones_that_there_are() {
        let wrong = page(Some("rum")).err().map(|why| why.sentence()).unwrap_or_default();
        assert!(wrong.contains("no command rum") && wrong.contains("compare"), "{wrong}");
    }
}
