//! What users type.
mod cam;
mod commission;
mod common;
mod compare;
mod compensation;
mod control;
mod doctor;
#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test may panic
mod documented;
mod drives;
mod lists;
mod options;
mod polygon;
mod run;
mod serve;
mod simulator;
mod text;
mod trace;

use crate::progress::Shown;
pub(crate) use cam::{CamArgs, CamFormName, CamOutput};
use clap::{Parser, Subcommand};
pub(crate) use commission::{CommissionArgs, CommissionOutput, CommissionStep};
pub(crate) use common::{DialectChoice, Format, ProgramArgs, Switch, WorkSpeedChoice};
pub(crate) use compare::CompareArgs;
pub(crate) use compensation::{CompensationArgs, CompensationOutput};
pub(crate) use control::ControlArgs;
pub(crate) use doctor::{DoctorArgs, DoctorOutput};
pub(crate) use drives::DrivesArgs;
pub(crate) use lists::{CodesArgs, CodesFormat, ExplainArgs, MachineCommand};
pub(crate) use polygon::PolygonArgs;
pub(crate) use run::RunArgs;
pub(crate) use serve::{ServeArgs, TokenRole};
pub(crate) use simulator::{RecoverArgs, SimulatorArgs};
pub(crate) use text::{
    CanonArgs, CanonFormat, CheckArgs, FindingsFormat, FormatArgs, LeftArgs, TimeArgs,
};
pub(crate) use trace::{TraceCommand, TraceFormat};

/// An open numerical control for spindle-synchronised machining.
#[derive(Parser, Debug)]
#[command(name = "leadscrew", version = env!("LEADSCREW_VERSION"), propagate_version = true, max_term_width = 100)]
#[command(after_help = "Examples:
  leadscrew run programs/plate-12xM6.ngc --out out/plate   prove a program, leave report and certificate
  leadscrew check programs/*.ngc                             everything wrong with them, at once
  leadscrew canon part.ngc --format linuxcnc                 compare with LinuxCNC's rs274 by diff
  leadscrew machine show tapping-center   the machine's values, with their sources")]
pub(crate) struct Cli {
    /// Say only what went wrong: no answer for people, no remarks, no progress; the exit code
    /// tells. Data that is asked for (--format json, canon, --log, --out) comes all the same
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// How progress is shown
    #[arg(long, global = true, value_enum, default_value_t = Shown::Auto, value_name = "HOW")]
    pub(crate) progress: Shown,
    /// What to do
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Run a program on the simulated machine and judge the workpiece
    #[command(
        after_help = "Exit code: 0 every feature is within tolerance; 1 one is not; 2 refused; 3 an alarm.

Examples:
  leadscrew run programs/plate-12xM6.ngc
  leadscrew run part.ngc --machine shop.toml --tools shop.tbl --out out/part
  leadscrew run part.ngc --missing-tools stand-in --material 42CrMo4",
        after_long_help = "Exit code: 0 the program ended and every feature is within tolerance (of a program that only taps: if its \
holes are there, which is said first; --pre-drilled states it); 1 a feature is out of \
tolerance; 2 the program or a file was refused, or a tap is in the work and nothing but `leadscrew recover` may \
move; 3 an alarm on the machine.

--fault takes power-cut, kill, emergency-stop, drive-fault spindle [N]|AXIS, lost-index, encoder-slip ANGLE, \
dropout TIME, feedback-lost TIME, stuck spindle [N]|AXIS, feedback-jump AXIS LENGTH, scale-error AXIS PPM (from where the axis \
stands then), eccentricity ANGLE [spindle N] (of an encoder), late, missed, torque-loss PERCENT [spindle N]; spindles count from 0.
--operator takes hold, resume, confirm (M0, M1, a tool that is changed by hand), abort, retract, override PERCENT, \
rapid-override PERCENT, spindle-override PERCENT, single-block on|off, emergency-stop. Where no confirm has a moment, \
everything is confirmed at once ('confirm always'), and the summary says so.
A MOMENT is a time (1.5s, 250ms), line N, depth 8mm [out] \
(of the tip below the work's zero), angle 12rev (turned since the start), random; or between 1s and 2s.

With --simulator the sync record, which recovery needs, is kept in the state folder: by default \
$XDG_STATE_HOME/leadscrew/MACHINE-NUMBER, or ~/.local/state/leadscrew/MACHINE-NUMBER. Without --simulator there is one only \
if --state names its folder.

Examples:
  leadscrew run programs/plate-12xM6.ngc
  leadscrew run part.ngc --machine shop.toml --tools shop.tbl --out out/part
  leadscrew run part.ngc --missing-tools stand-in --material 42CrMo4
  leadscrew run part.ngc --fault 'power-cut at depth 8mm' --recover   and the way out along the thread
  leadscrew run part.ngc --operator 'hold at 2.5s; resume at 4s; override 50 at line 30'
  leadscrew run part.ngc --force-ramp 0.12   what a spindle ramp steeper than the power curve does
  leadscrew run part.ngc --synchronisation encoder-no-prediction   what a lagging feed does to a thread
  generator | leadscrew run - --format json"
    )]
    Run(RunArgs),
    /// Say everything that is wrong with programs, without moving anything
    #[command(after_help = "Examples:
  leadscrew check part.ngc
  leadscrew check programs/ --format json")]
    Check(CheckArgs),
    /// Say how long a program takes, by the planner that would run it
    #[command(after_help = "Examples:
  leadscrew time part.ngc
  leadscrew time long.ngc --fast   within 2 %, from a sample
  leadscrew time part.ngc --machine bench-xyz --format json   key motion_time_s")]
    Time(TimeArgs),
    /// Switch a control on and lead it: home, jog, touch off, load, start, hold, by a script or
    /// from the terminal
    #[command(
        after_help = "A request a line; `help` lists them; a line that begins with # is a remark. In a script machine \
time runs only while a line waits, so it is the same each time; from the terminal it runs as on the wall. The machine \
is simulated.

Exit code: 0 every request was accepted and every wait was met; 1 a wait was not met, or the script left something \
moving; 2 a request was refused, or a line is none. The first line that fails ends the script, and all comes to rest.

Examples:
  leadscrew control                                    from the terminal
  leadscrew control --machine lathe --script morning.txt
  printf 'power on\nwait ready\nmdi G0 X-10\nwait completed\nstatus\n' | leadscrew control"
    )]
    Control(ControlArgs),
    /// Serve a control that stays on over HTTP and WebSocket, with its page
    #[command(
        after_help = "It says its address, and runs until Ctrl-C; the machine is simulated, and its time runs as on the wall. \
docs/api.md says what can be asked, docs/security.md who may ask it. Only this computer is answered; others take \
tokens and a certificate. Keep state, tokens and keys apart from the programs.

Examples:
  leadscrew serve --programs programs                  then open the address that it says
  leadscrew serve --machine lathe --programs programs --port 0 --state out/lathe
  leadscrew serve --new-token out/tokens.toml --token-name wall --token-role viewer
  leadscrew serve --revoke-token out/tokens.toml --token-name wall
  leadscrew serve --programs programs --listen 0.0.0.0 --token-file out/tokens.toml --self-signed"
    )]
    Serve(ServeArgs),
    /// Run the simulated machine, its drives and encoders as a process of its own
    #[command(
        alias = "iron",
        after_help = "A control that connects drives it; when the control dies, the drives stop by themselves and the \
encoders keep the truth. In lock-step (the default) time waits for the control.

Examples:
  leadscrew simulator --listen /tmp/machine &   then: leadscrew run part.ngc --simulator /tmp/machine
  leadscrew simulator --listen /tmp/machine --real-time            time as on the wall
  leadscrew simulator --listen /tmp/machine --power-cut-at 7.2   the mains fail after 7.2 s of machine time
  leadscrew simulator --ethercat veth1 --machine mill.toml   as its drives on a network
  leadscrew simulator --status /tmp/machine                        how it is, as JSON
  leadscrew simulator --quit /tmp/machine"
    )]
    Simulator(SimulatorArgs),
    /// Lead drives in a process of its own, for a control that may end at any moment
    #[command(
        after_help = "The kernel runs here, in a servo thread by the clock, and a control leads it over shared memory. When the \
control ends, axes and spindles come to rest, coupled ones on their coupling, and the next control knows a tool that was left in \
the work. A machine file with [ethercat] has its drives on that network; else they are simulated. Ctrl-C brings them to rest and \
ends it.

Examples:
  leadscrew drives --machine tapping-center &   then: leadscrew serve --machine tapping-center --drives process:default
  leadscrew drives --machine shop.toml --name shop
  leadscrew drives --machine machines/ethercat/mill.toml --interface eth1"
    )]
    Drives(DrivesArgs),
    /// Say whether this computer can lead a machine, and what to change
    #[command(
        after_help = "Kernel, rights, cores, interrupts, idle states, clock, network card and HAL are looked at; then a servo thread \
that leads nothing shows how late its periods begin, and what that means at the tap. Nothing is changed.

Exit code: 0 a machine can be led; 1 something is wrong, and is said with the command that changes it; 2 refused.

Examples:
  leadscrew doctor                                   a minute
  leadscrew doctor --machine machines/hal/mill.toml --load   beside a busy computer
  leadscrew doctor --machine machines/ethercat/mill.toml --interface eth1 --out doctor.html
  leadscrew doctor --seconds 0 --format json         without the measurement"
    )]
    Doctor(DoctorArgs),
    /// Find a machine's numbers from what its own drives say, with intervals, and write its file
    #[command(
        after_help = "What moves: one axis at a time, over a good half of its travel from the end at which it stands, with no more \
than 30 % of its drive's peak force. Force and torque are measured by the drives, positions by their encoders; nothing else is \
looked at. The machine is simulated: its seed and --scatter, or --plant, make it another one than its file says.

Exit code: 0 every value was found; 1 something could not be judged, or an alarm ended a step; 2 refused.

Examples:
  leadscrew commission --machine tapping-center --seed 7
  leadscrew commission axes --machine shop.toml --write shop-commissioned.toml --out commission.html
  leadscrew commission axes --seed 7 --format json"
    )]
    Commission(CommissionArgs),
    /// Take a tap out of its hole after the control died, or say why that is not safe
    #[command(
        after_help = "The sync record and the encoders tell where the tap stands off its thread; spindle or feed goes back onto \
it, then both come out along it together. Killed on the way, it is begun again in the same way.

Without the record of just the tool that the machine keeps in its work nothing moves. Exit code: 0 recovered, or nothing to \
do; 2 refused, with the reason, or out and not known to be whole.

Examples:
  leadscrew recover --simulator /tmp/machine --dry-run --picture way.svg   rehearse it
  leadscrew recover --simulator /tmp/machine
  leadscrew recover --simulator /tmp/machine --format json"
    )]
    Recover(RecoverArgs),
    /// Tap the same holes with a clutch holder and conventionally, on a spindle that scatters
    #[command(after_help = "Examples:
  leadscrew compare --size M6                    100 holes each at S2000
  leadscrew compare --size M6 --depth 10 --speed 2800   the usual cycle scatters by 0.33 mm
  leadscrew compare --size M8 --speed 1500 --samples 400 --out m8.html
  leadscrew compare part.ngc --speed-scatter 2   the taps of a program, in both holders")]
    Compare(CompareArgs),
    /// Compare the ways of compensating a cam's phase error: contour errors over cams and speeds
    #[command(
        after_help = "Each cam is measured in idle turns at each speed, then turned with what is sent compensated by each method; \
the judge looks at the last turn. Nothing is kept.

Examples:
  leadscrew compensation programs/cams.toml
  leadscrew compensation programs/cams.toml --machine cam-grinder-coarse   1 µm table pulses, 0.01° counts
  leadscrew compensation programs/cams.toml --cams 1237 --speeds 60 --format json
  leadscrew compensation programs/cams.toml --out compensation.html"
    )]
    Compensation(CompensationArgs),
    /// Find the flattest polygon that a machine can turn, and the block that cuts it
    #[command(after_help = "Examples:
  leadscrew polygon --sides 6 --across-flats 17 --speed 500
  leadscrew polygon --sides 4 --across-flats 30 --speed 500 --flatness 2 --out square.html
  leadscrew polygon --sides 4 --across-flats 30 --simulate   cut at each speed, compensated and not
  leadscrew polygon --insert-angles 0,90 --across-flats 20 --actuator x --format json
  leadscrew polygon --sides 5 --ratio 2:5 --across-flats 17 --tip-radius 6.8   a pentagon")]
    Polygon(PolygonArgs),
    /// From a cam's lift to the path of the grinding wheel: checks, highest speed, table, G-code,
    /// pictures
    #[command(after_help = "Examples:
  leadscrew cam --form automotive --base 34 --lift 9 --half-angle 65   an engine's cam for a flat follower
  leadscrew cam lift.csv --base 18 --follower roller --roller-radius 10   a table, degrees and mm
  leadscrew cam lift.csv --base 18 --wheel-wear 12.5 --format table   C, X and work speed for a worn wheel
  leadscrew cam --form lobes --lift 3 --lobes 3 --out lobes.html   drawn")]
    Cam(CamArgs),
    /// Run a program over many cases and say how capable the process is: in Python,
    /// `pip install 'leadscrew[dask]'`
    #[command(after_help = "docs/python.md says what a study's file has.

Example: leadscrew study plate.toml")]
    Study {
        /// The study: TOML
        #[arg(
            required = true,
            trailing_var_arg = true,
            allow_hyphen_values = true,
            value_name = "FILE"
        )]
        words: Vec<String>,
    },
    /// Print the operations that a program means
    #[command(after_help = "Examples:
  leadscrew canon part.ngc                       operations in machine coordinates, mm
  leadscrew canon part.ngc --format json         one JSON object a line
  leadscrew canon part.ngc --format linuxcnc     the notation of LinuxCNC's rs274 -g")]
    Canon(CanonArgs),
    /// Write programs in canonical spacing; what they mean, and their comments, stay
    #[command(after_help = "Examples:
  leadscrew fmt part.ngc
  leadscrew fmt --check programs/    exit code 2 if something is not in canonical spacing
  leadscrew fmt - < part.ngc         standard input to standard output")]
    Fmt(FormatArgs),
    /// Serve an editor: the language server, on standard input and output
    #[command(
        after_help = "Findings as you type, what a word does and where the machine stands, the outline of tools and \
subprograms, definitions, renaming and formatting. An editor starts it; see docs/editors.md."
    )]
    Lsp(ProgramArgs),
    /// List every G and M code, with what it takes and whether it is executed; or those that
    /// programs use
    #[command(after_help = "Examples:
  leadscrew codes                                         what is known, by code
  leadscrew codes --of programs/ --machine mine.toml   what is used, how often, and is it known?")]
    Codes(CodesArgs),
    /// Say what a finding's code or an alarm's number means, with a program that causes it
    #[command(after_help = "Examples:
  leadscrew explain I0501 M0360   what these findings mean, and what works instead
  leadscrew explain 105           an alarm: its cause, and what to do
  leadscrew explain               every finding, as a page in Markdown")]
    Explain(ExplainArgs),
    /// The machines Leadscrew knows, and files that describe others
    #[command(subcommand)]
    Machine(MachineCommand),
    /// What a run or the page's scope has recorded: a summary, and other formats
    #[command(subcommand)]
    Trace(TraceCommand),
    /// Write a shell's completion script to standard output
    #[command(
        after_help = "Example: leadscrew completions bash > /etc/bash_completion.d/leadscrew"
    )]
    Completions {
        /// For which shell
        shell: clap_complete::Shell,
    },
    /// Write the manual page of leadscrew, or of one command, to standard output
    #[command(after_help = "Examples:
  leadscrew man > leadscrew.1
  leadscrew man run | man -l -")]
    Man {
        /// Of which command; without it, of leadscrew itself
        #[arg(value_name = "COMMAND")]
        of: Option<String>,
    },
}

impl Command {
    /// Whether the caller reads JSON: then a refusal is JSON, too.
    pub(crate) fn answers_in_json(&self) -> bool {
        match self {
            Self::Run(args) => args.format == Format::Json,
            Self::Recover(args) => args.format == Format::Json,
            Self::Time(args) => args.format == Format::Json,
            Self::Polygon(args) => args.format == Format::Json,
            Self::Check(args) => args.format == FindingsFormat::Json,
            Self::Canon(args) => args.format == CanonFormat::Json,
            Self::Cam(args) => args.format == CamOutput::Json,
            Self::Compensation(args) => args.format == CompensationOutput::Json,
            Self::Codes(args) => args.format == CodesFormat::Json,
            Self::Doctor(args) => args.format == DoctorOutput::Json,
            Self::Commission(args) => args.format == CommissionOutput::Json,
            Self::Drives(_)
            | Self::Explain(_)
            | Self::Simulator(_)
            | Self::Control(_)
            | Self::Serve(_)
            | Self::Compare(_)
            | Self::Fmt(_)
            | Self::Study { .. }
            | Self::Lsp(_)
            | Self::Machine(_)
            | Self::Trace(_)
            | Self::Completions { .. }
            | Self::Man { .. } => false,
        }
    }
}

/// Whether a command line that could not be read asks for JSON.
pub(crate) fn asks_for_json(words: impl Iterator<Item = String>) -> bool {
    let words: Vec<String> = words.collect();
    words.iter().any(|word| word == "--format=json")
        || words.windows(2).any(|pair| pair[0] == "--format" && pair[1] == "json")
}
