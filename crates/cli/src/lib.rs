//! The `leadscrew` program: arguments in, tables and pages out. What it does is done by the library
//! `leadscrew`; what it answers in JSON, [`answers`] hands to other programs that are built on it.
//!
//! ```text
//!   args ─► run           leadscrew::Run ─► report files, summary
//!        ├► check         control::job::preflight ─► render
//!        ├► time          leadscrew::time ─► tables
//!        ├► compare       leadscrew::compare        holders, on a spindle that scatters
//!        ├► compensation  leadscrew::compensation   cams, in every way
//!        ├► commission    leadscrew::commission     a machine's numbers from its own drives
//!        ├► polygon       leadscrew::polygon        from a form to the block that cuts it
//!        ├► recover       control::recovery         what is known of a tool in the work, and the way out
//!        ├► control       control::Control         a control that stays on, by script or from the terminal
//!        ├► serve         server::Server           the same over the network, with its page
//!        ├► simulator     leadscrew::simulator      the simulated machine as a process of its own
//!        ├► cam           forms::cam, printed and drawn
//!        ├► canon, codes, fmt, lsp    interp, gcode, lsp
//!        ├► machine       store
//!        ├► study         told where it is: the Python package has it
//!        └► man           args, as a manual page
//! ```
#![forbid(unsafe_code)]

pub mod answers;
mod args;
mod cam;
mod canonical;
mod causes;
mod check;
mod coasting;
mod codes;
mod codes_of;
mod commission;
mod compare;
mod compensation;
mod compensation_chart;
mod console;
mod doctor;
mod drives;
mod explain;
mod format;
mod help;
mod interrupt;
mod left;
mod lines;
mod log;
mod lsp;
mod machine;
mod man;
mod measures;
mod pieces;
mod plant_table;
mod polygon;
mod progress;
mod recover;
mod refusal;
mod render;
mod run;
mod say;
mod serve;
mod simulator;
mod summary;
mod tables;
mod time;
mod trace;
mod typed;
mod worst;

use args::{Cli, Command};
use clap::{CommandFactory, FromArgMatches};
use control::Refused;
use leadscrew::Ending;
use std::ffi::OsString;

/// What was asked for is done, and good.
const SUCCESS: u8 = 0;
/// A feature is out of tolerance.
const OUT_OF_TOLERANCE: u8 = 1;
/// The program or a file was refused.
const REFUSED: u8 = 2;
/// Ctrl-C: 128 and the number of the signal, as shells have it.
const INTERRUPTED: u8 = 130;
/// An alarm on the machine.
const ALARM: u8 = 3;

/// Do what these words say, the first of which is the program's own name; the exit code.
pub fn main(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    if let Some(help) = help::asked(&words) {
        return said(help);
    }
    typed::keep(words.iter().map(|word| word.to_string_lossy().into_owned()).collect());
    let read = Cli::command().try_get_matches_from(words).and_then(|read| {
        help::means_something(&read)?;
        Cli::from_arg_matches(&read)
    });
    let cli = match read {
        Ok(cli) => cli,
        Err(wrong) => return misread(&wrong),
    };
    progress::ask(if cli.quiet { progress::Shown::Off } else { cli.progress });
    match execute(&cli) {
        Ok(code) => code,
        Err(refused) => {
            refusal::say(&refused);
            if cli.command.answers_in_json() {
                let _ = say::out(&refusal::json(&refused)); // standard error has it as well
            }
            if interrupt::came() { INTERRUPTED } else { REFUSED }
        }
    }
}

/// Prints help, or why there is none of that name.
fn said(help: Result<String, String>) -> u8 {
    match help {
        Ok(text) => match say::coloured_out(&text) {
            Ok(()) => SUCCESS,
            Err(_) => REFUSED, // standard output is closed
        },
        Err(why) => {
            say::err(&format!("error: {why}\n"));
            REFUSED
        }
    }
}

/// A command line that is none, or that asks for help: as clap has it, and in JSON where that is
/// asked for.
fn misread(wrong: &clap::Error) -> u8 {
    let plain = wrong.render().to_string();
    if say::shown(&plain) == plain {
        let _ = wrong.print(); // standard error is closed
    } else {
        say::err(&plain); // what was typed has control characters
    }
    let refused = wrong.use_stderr();
    if refused && args::asks_for_json(typed::all().iter().cloned()) {
        let text = wrong.render().to_string();
        let sentence = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
        let _ = say::out(&refusal::json(&Refused::because(sentence)));
    }
    if refused { REFUSED } else { SUCCESS }
}

fn execute(cli: &Cli) -> Result<u8, Refused> {
    let accepted = |good| if good { SUCCESS } else { REFUSED };
    match &cli.command {
        Command::Run(args) => Ok(match run::command(args, cli.quiet)? {
            Ending::Good => SUCCESS,
            Ending::OutOfTolerance => OUT_OF_TOLERANCE,
            Ending::Alarm => ALARM,
        }),
        Command::Control(args) => Ok(match console::command(args, cli.quiet)? {
            console::Ending::Good => SUCCESS,
            console::Ending::NotMet => OUT_OF_TOLERANCE,
            console::Ending::Refused => REFUSED,
        }),
        Command::Serve(args) => serve::command(args).map(|()| SUCCESS),
        Command::Explain(args) => explain::command(args).map(|()| SUCCESS),
        Command::Drives(args) => drives::command(args).map(|()| SUCCESS),
        Command::Doctor(args) => {
            Ok(if doctor::command(args, cli.quiet)? { SUCCESS } else { OUT_OF_TOLERANCE })
        }
        Command::Commission(args) => {
            Ok(if commission::command(args, cli.quiet)? { SUCCESS } else { OUT_OF_TOLERANCE })
        }
        Command::Simulator(args) => simulator::command(args).map(|()| SUCCESS),
        Command::Recover(args) => Ok(accepted(recover::command(args)?)),
        Command::Compare(args) => {
            Ok(if compare::command(args, cli.quiet)? { SUCCESS } else { OUT_OF_TOLERANCE })
        }
        Command::Compensation(args) => compensation::command(args, cli.quiet).map(|()| SUCCESS),
        Command::Time(args) => Ok(accepted(time::command(args, cli.quiet)?)),
        Command::Polygon(args) => polygon::command(args, cli.quiet).map(|()| SUCCESS),
        Command::Cam(args) => cam::command(args).map(|()| SUCCESS),
        Command::Check(args) => Ok(accepted(check::command(args, cli.quiet)?)),
        Command::Canon(args) => Ok(accepted(canonical::command(args)?)),
        Command::Fmt(args) => Ok(accepted(format::command(args, cli.quiet)?)),
        Command::Lsp(source) => Ok(accepted(lsp::command(source.options())?)),
        Command::Study { .. } => Err(Refused::because(
            "studies run in Python: `pip install 'leadscrew[dask]'` brings this command with them",
        )),
        Command::Codes(args) if !args.of.is_empty() => codes_of::command(args).map(|()| SUCCESS),
        Command::Codes(args) => codes::command(args.format).map(|()| SUCCESS),
        Command::Machine(order) => machine::command(order).map(|()| SUCCESS),
        Command::Trace(order) => trace::command(order, cli.quiet).map(|()| SUCCESS),
        Command::Man { of } => man::command(of.as_deref()).map(|()| SUCCESS),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "leadscrew", &mut script);
            say::coloured_out(&String::from_utf8_lossy(&script))?;
            Ok(SUCCESS)
        }
    }
}
