//! `leadscrew run`: prove a program, run it on the simulated machine, judge the workpiece, leave
//! the report files.
use crate::args::{Format, RunArgs};
use crate::lines::Lines;
use crate::log::Log;
use crate::progress::Progress;
use crate::recover::advice;
use crate::render::{self, Source};
use crate::{interrupt, left, say, summary, typed};
use control::job::ProgramOptions;
use control::job::restart::Restart;
use control::{RealTimeOptions, Refused};
use leadscrew::{Ending, Finished, Job, NotReady, Program, Run, RunOptions};
use std::path::Path;
use store::output::{CERTIFICATE, Folder};
use units::Time;

/// Do it.
pub(crate) fn command(args: &RunArgs, quiet: bool) -> Result<Ending, Refused> {
    let program = Program::open(&args.program)?;
    let mut run = prepared(args, program, args.options(), typed::of_this_run())?;
    if !quiet {
        say_chosen(&run.job);
    }
    prove(&mut run, quiet)?;
    let folder = args.out.as_deref().map(begin_folder).transpose()?;
    if folder.is_some() {
        interrupt::watch()?;
    }
    run.trace = folder.as_ref().map(|folder| folder.path("trace.parquet"));
    run.is_interrupted = interrupt::came;
    if args.log {
        let (tools, zero) = (run.job.session.tools.clone(), run.job.session.work_zero());
        let lines = if run.is_real_time() { Lines::beside() } else { Lines::AtOnce };
        run.observers.push(Box::new(Log::new(tools, zero, lines)));
    }
    let ms = |time: Time| (time.value() * 1e3) as u64;
    let progress = Progress::new(ms(run.planned()), "machining (simulated)");
    let mut finished = run.execute(&mut |at| progress.set_position(ms(at)))?;
    drop(progress);
    interrupt::refuse()?;
    for why in &finished.outcome.broke_off {
        say::err(&format!("error: {why}\n"));
    }
    finished.keep()?;
    if let Some(what) = finished.left() {
        left::write(&args.left, what)?;
    }
    write_outputs(args, folder, &mut finished)?;
    told(args, quiet, &finished)?;
    Ok(finished.ending())
}

/// Says how a program is read, on which machine and with which tools, where that was chosen.
pub(crate) fn say_chosen(job: &Job) {
    let (program, drawn) = (&job.program, &job.session.drawn);
    let source = Source { name: &program.name, text: &program.text, drawn };
    say::coloured_err(&render::text(&job.chosen, &source));
}

/// Interpret and plan the program, and say what is known of it.
fn prove(run: &mut Run, quiet: bool) -> Result<(), Refused> {
    let progress = Progress::of_lines(&run.job.program.text, "planning");
    run.prove(&mut |step| progress.reached(step.line))?;
    drop(progress);
    if quiet {
        return Ok(());
    }
    if let Some(restart) = &run.restart {
        say::err(&begins(restart));
    }
    let (program, drawn) = (&run.job.program, &run.job.session.drawn);
    let source = Source { name: &program.name, text: &program.text, drawn };
    say::coloured_err(&render::text(run.findings(), &source));
    Ok(())
}

fn begins(restart: &Restart) -> String {
    let Restart { line, tool, spin, holes, others, .. } = restart;
    let rpm = spin.in_rpm();
    format!(
        "begins at line {line} with tool {tool} and the spindle at {rpm:.0} rpm; {holes} of the program's holes are left out{}; \
         the work is as the part before leaves it, simulated\n",
        others_in_words(others)
    )
}

/// What is left out beside holes and threads that are tapped: ", 2 polygons (lines 8 and 14)".
fn others_in_words(others: &[(&'static str, u32)]) -> String {
    let mut kinds: Vec<(&str, Vec<String>)> = Vec::new();
    for (kind, line) in others {
        match kinds.iter_mut().find(|(known, _)| known == kind) {
            Some((_, lines)) => lines.push(line.to_string()),
            None => kinds.push((kind, vec![line.to_string()])),
        }
    }
    let said = kinds.into_iter().map(|(kind, lines)| match &lines[..] {
        [line] => format!(", and the {kind} of line {line}"),
        [first @ .., last] => {
            format!(", and {} {kind}s of lines {} and {last}", lines.len(), first.join(", "))
        }
        [] => String::new(),
    });
    said.collect()
}

/// Report, certificate and solids: all that was asked for, or nothing.
fn write_outputs(
    args: &RunArgs,
    folder: Option<Folder>,
    finished: &mut Finished,
) -> Result<(), Refused> {
    if folder.is_none() && args.report.is_none() {
        return Ok(());
    }
    let page = finished.report();
    if let Some(path) = &args.report {
        store::output::write_file(path, page.as_bytes())?;
    }
    if let Some(folder) = folder {
        folder.write("report.html", page.as_bytes())?;
        folder.write(CERTIFICATE, finished.certificate().to_json().as_bytes())?;
        finished.write_solids(&folder)?;
        interrupt::refuse()?;
        folder.finish()?;
    }
    Ok(())
}

/// What is said at the end.
fn told(args: &RunArgs, quiet: bool, finished: &Finished) -> Result<(), Refused> {
    let outcome = &finished.outcome;
    match args.format {
        Format::Json => say::out(&format!("{}\n", finished.certificate().to_json()))?,
        Format::Text if quiet => say::out(&summary::wrong(outcome))?,
        Format::Text => say::out(&summary::text(finished, args.out.as_deref()))?,
    }
    for missing in &outcome.not_triggered {
        say::err(&format!("error: {missing}\n"));
    }
    for refused in &outcome.not_granted {
        say::err(&format!("note: {refused}\n"));
    }
    if args.timings {
        say::err(&format!("{}\n", outcome.timings.text(&outcome.ticks)));
        if let Some(least) = outcome.least_ahead {
            let ms = least.value() * 1e3;
            say::err(&format!(
                "planned ahead: at least {ms:.0} ms of motion while more was to come\n"
            ));
        }
        if let Some(figures) = &outcome.real_time {
            say::err(&format!("{figures}\n"));
        }
    }
    Ok(())
}

/// The run that is asked for, of this program, ready to be proved.
pub(crate) fn prepared(
    args: &RunArgs,
    program: Program,
    source: ProgramOptions,
    command: Vec<String>,
) -> Result<Run, Refused> {
    let job = program.on(source)?;
    let options = RunOptions { command, ..options(args) };
    Run::prepare(job, &options).map_err(|why| not_ready(why, args))
}

fn options(args: &RunArgs) -> RunOptions {
    RunOptions {
        seed: args.seed,
        part: args.part,
        material: args.material.clone(),
        units: args.units.map(Into::into),
        synchronisation: args.synchronisation.map(Into::into),
        force_ramp: args.force_ramp.map(Time::s),
        learning: args.learning.clone(),
        from: args.from,
        program_changed: args.program_changed,
        faults: args.fault.clone(),
        operator: args.operator.clone(),
        recover: args.recover.map(Into::into),
        socket: args.simulator.clone(),
        state: args.state.clone(),
        renewed: args.renew_tool.clone(),
        command: Vec::new(),
        timings: args.timings,
        real_time: args.real_time.then(RealTimeOptions::default),
    }
}

/// What is said where a run may not begin, with what to type.
fn not_ready(why: NotReady, args: &RunArgs) -> Refused {
    let (Some(socket), state) = (&args.simulator, args.state.as_deref()) else { return why.into() };
    match why {
        NotReady::Refused(refused) => refused,
        NotReady::InWork(record) => advice::interlock(&record, socket, state),
        NotReady::Unknown(why) => advice::unknown(&why, socket, state),
        NotReady::Untrusted(why) => advice::unsure(&why, socket, state),
        NotReady::Unsettled => advice::settle(socket, state),
    }
}

/// The folder for the report files; the folders above it are made if they are missing.
fn begin_folder(path: &Path) -> Result<Folder, Refused> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(|e| {
            Refused::because(format!("cannot create the folder {}: {e}", parent.display()))
        })?;
    }
    Ok(Folder::begin(path)?)
}
