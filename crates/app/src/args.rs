//! What users type.
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// An open numerical control for spindle-synchronised machining.
#[derive(Parser, Debug)]
#[command(name = "leadscrew", version, propagate_version = true, max_term_width = 100)]
#[command(after_help = "Examples:
  leadscrew run programs/plate-12xM6.ngc --out out/plate     prove a program, leave report and certificate
  leadscrew check programs/*.ngc                             everything wrong with them, at once
  leadscrew canon part.ngc --format linuxcnc                 compare with LinuxCNC's rs274 by diff
  leadscrew machine show tapping-center                      the machine's values, with their sources")]
pub(crate) struct Cli {
    /// Say only what went wrong
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// What to do
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Subcommand, Debug)]
pub(crate) enum Command {
    /// Run a program on the simulated machine and judge the workpiece
    #[command(
        after_help = "Exit code: 0 the program ended and every feature is within tolerance; 1 a feature is out of
tolerance; 2 the program or a file was refused, or a tap is in the work and nothing but `leadscrew recover` may
move; 3 an alarm on the machine.

--fault takes power-cut, kill, emergency-stop, drive-fault spindle|AXIS, lost-index, encoder-slip ANGLE, dropout TIME,
stuck AXIS, feedback-jump AXIS LENGTH, late, missed, torque-loss PERCENT; --operator takes hold, resume, abort, retract,
override PERCENT, rapid-override PERCENT, single-block on|off. A MOMENT is a time (1.5s, 250ms), line N, depth 8mm [out]
(of the tip below the work's zero), angle 12rev (turned since the start), random; or between 1s and 2s.

With --iron the sync record, which recovery needs, is kept in the state folder: by default
$XDG_STATE_HOME/leadscrew/MACHINE-NUMBER, or ~/.local/state/leadscrew/MACHINE-NUMBER. Without --iron there is one only
if --state names its folder.

Examples:
  leadscrew run programs/plate-12xM6.ngc
  leadscrew run part.ngc --machine shop.toml --tools shop.tbl --out out/part
  leadscrew run part.ngc --missing-tools stand-in --material 42CrMo4
  leadscrew run part.ngc --fault 'power-cut at depth 8mm' --recover   and the way out along the thread
  leadscrew run part.ngc --operator 'hold at 2.5s; resume at 4s; override 50 at line 30'
  leadscrew run part.ngc --force-ramp 0.12       what a spindle ramp steeper than the power curve does
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
  leadscrew time part.ngc --machine bench-xyz --format json     key motion_time_s: from first to last motion")]
    Time(TimeArgs),
    /// Run the simulated machine, its drives and encoders as a process of its own
    #[command(
        after_help = "A control that connects drives it; when the control dies, the drives stop by themselves and the
encoders keep the truth. In lock-step (the default) time waits for the control.

Examples:
  leadscrew iron --listen /tmp/iron &                      then: leadscrew run part.ngc --iron /tmp/iron
  leadscrew iron --listen /tmp/iron --real-time            time as on the wall
  leadscrew iron --listen /tmp/iron --power-cut-at 7.2     the mains fail after 7.2 s of machine time
  leadscrew iron --status /tmp/iron                        how it is, as JSON
  leadscrew iron --quit /tmp/iron"
    )]
    Iron(IronArgs),
    /// Take a tap out of its hole after the control died, or say why that is not safe
    #[command(
        after_help = "The sync record and the encoders tell where the tap stands off its thread; spindle or feed goes back onto
it, then both come out along it together. Killed on the way, it is begun again in the same way.

Exit code: 0 recovered, or nothing to do; 2 refused, with the reason.

Examples:
  leadscrew recover --iron /tmp/iron --dry-run --picture way.svg   rehearse it
  leadscrew recover --iron /tmp/iron
  leadscrew recover --iron /tmp/iron --format json"
    )]
    Recover(RecoverArgs),
    /// Tap the same holes with a clutch holder and conventionally, on a spindle that scatters
    #[command(after_help = "Examples:
  leadscrew compare --size M6                    100 holes each at S2000
  leadscrew compare --size M6 --depth 10 --speed 2800   the conventional cycle scatters by 0.33 mm, at S1000 by 0.13 mm
  leadscrew compare --size M8 --speed 1500 --samples 400 --out m8.html
  leadscrew compare part.ngc --speed-scatter 2   the taps of a program, in both holders")]
    Compare(CompareArgs),
    /// Find the flattest polygon that a machine can turn, and the block that cuts it
    #[command(after_help = "Examples:
  leadscrew polygon --sides 6 --across-flats 17 --speed 500
  leadscrew polygon --sides 4 --across-flats 30 --speed 500 --flatness 2 --out square.html
  leadscrew polygon --insert-angles 0,90 --across-flats 20 --actuator x --format json
  leadscrew polygon --sides 5 --ratio 2:5 --across-flats 17 --tip-radius 6.8   a pentagon")]
    Polygon(PolygonArgs),
    /// From a cam's lift to the path of the grinding wheel: checks, highest speed, table, G-code, pictures
    #[command(after_help = "Examples:
  leadscrew cam --form automotive --base 34 --lift 9 --half-angle 65       an engine's cam for a flat follower
  leadscrew cam lift.csv --base 18 --follower roller --roller-radius 10    a table of angle and lift, degrees and mm
  leadscrew cam lift.csv --base 18 --wheel-wear 12.5 --format table        C, X and work speed for a worn wheel
  leadscrew cam --form lobes --lift 3 --lobes 3 --out lobes.html           lift, speed, acceleration, curvature drawn")]
    Cam(CamArgs),
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
        after_help = "Findings as you type, what a word does and where the machine stands, the outline of tools and
subprograms, definitions, renaming and formatting. An editor starts it; see docs/editors.md."
    )]
    Lsp(ProgramArgs),
    /// List every G and M code, with what it takes and whether it is executed
    Codes {
        /// How they are printed
        #[arg(long, value_enum, default_value_t = CodesFormat::Text)]
        format: CodesFormat,
    },
    /// The machines Leadscrew knows, and files that describe others
    #[command(subcommand)]
    Machine(MachineCommand),
    /// Write a shell's completion script to standard output
    #[command(
        after_help = "Example: leadscrew completions bash > /etc/bash_completion.d/leadscrew"
    )]
    Completions {
        /// For which shell
        shell: clap_complete::Shell,
    },
}

/// Where programs, machines, tools and parameters come from.
#[derive(Args, Debug, Clone)]
pub(crate) struct ProgramArgs {
    /// The machine: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "tapping-center")]
    pub(crate) machine: String,
    /// Tool table: TOML, or LinuxCNC's .tbl [default: tools.toml or tool.tbl beside the program, else the embedded one]
    #[arg(long, value_name = "FILE")]
    pub(crate) tools: Option<PathBuf>,
    /// Parameter file (.var) with work offsets [default: the machine's set-up]
    #[arg(long, value_name = "FILE")]
    pub(crate) parameters: Option<PathBuf>,
    /// What to do with tools that the table lacks
    #[arg(long, value_enum, default_value_t = MissingTools::Refuse)]
    pub(crate) missing_tools: MissingTools,
    /// How taps are driven that no clutch holder holds [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) tapping: Option<Tapping>,
    /// What to do with a dwell (P) that a clutch holder does not work with
    #[arg(long, value_enum, default_value_t = ClutchDwell::Refuse)]
    pub(crate) clutch_dwell: ClutchDwell,
    /// How programs are read [default: as the machine's file says]
    #[arg(long, value_enum)]
    pub(crate) dialect: Option<Dialect>,
    /// What a number without a decimal point counts in Fanuc's dialects
    #[arg(long, value_enum, default_value_t = DecimalPoint::Increments)]
    pub(crate) decimal_point: DecimalPoint,
    /// Leave out blocks that begin with `/` of these levels (1 is `/` alone), as in --block-skip 1,2
    #[arg(long, value_delimiter = ',', value_name = "LEVEL", value_parser = clap::value_parser!(u8).range(1..=9))]
    pub(crate) block_skip: Vec<u8>,
    /// Folder in which subprogram files are looked for, besides the program's own and those of the machine's file;
    /// may be given more than once
    #[arg(long, value_name = "DIR")]
    pub(crate) subprograms: Vec<PathBuf>,
    /// Cam library (TOML) [default: cams.toml beside the program]
    #[arg(long, value_name = "FILE")]
    pub(crate) cams: Option<PathBuf>,
    /// Table of measured phase errors: read if it is there, written when a program has measured
    #[arg(long, value_name = "FILE")]
    pub(crate) phase_table: Option<PathBuf>,
    /// How a cam is compensated after G50 (G150)
    #[arg(long, value_enum, default_value_t = Compensation::Shift)]
    pub(crate) compensation: Compensation,
    /// Feed-forward of the axes (spindles keep theirs): `off` shows the lag of their loops
    #[arg(long, value_enum)]
    pub(crate) feed_forward: Option<Switch>,
    /// How hard taps are driven [default: the machine's]
    #[arg(long, value_enum, value_name = "PRESET")]
    pub(crate) tapping_preset: Option<TappingPreset>,
}

/// `leadscrew run`.
#[derive(Args, Debug, Clone)]
pub(crate) struct RunArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Folder for report.html, certificate.json and trace.parquet; written whole or not at all
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Seed of the machine's scatter (friction, backlash, material)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Material of the workpiece [default: the machine's set-up]
    #[arg(long, value_name = "NAME")]
    pub(crate) material: Option<String>,
    /// How the summary is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Also say how fast the simulation and the kernel's tick were
    #[arg(long)]
    pub(crate) timings: bool,
    /// Also print what happened, a line an event
    #[arg(long)]
    pub(crate) log: bool,
    /// Control the iron that listens here, instead of simulating one
    #[arg(long, value_name = "PATH")]
    pub(crate) iron: Option<PathBuf>,
    /// Folder of the sync record [default with --iron: see below; else none is kept]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Begin at a line, as in 27, or at a hole, as in "hole 5": tool, spindle and modes as they would be there; never
    /// within a cycle
    #[arg(long, value_name = "LINE|hole N")]
    pub(crate) from: Option<crate::restart::From>,
    /// Let the iron fail: WHAT at MOMENT; several parted by `;`, see below
    #[arg(long, value_name = "WHAT at MOMENT", conflicts_with = "iron")]
    pub(crate) fault: Vec<crate::script::Items<sim::Fault>>,
    /// What the operator orders: WHAT at MOMENT; several parted by `;`, see below
    #[arg(long, value_name = "WHAT at MOMENT", conflicts_with = "iron")]
    pub(crate) operator: Vec<crate::script::Items<kernel::Order>>,
    /// After a stop in a thread: take the tap out along it, and end there, or continue with the remaining holes
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "out", conflicts_with = "iron")]
    pub(crate) recover: Option<AfterStop>,
    /// Force the tapping ramp from rest to full speed into this time, against the power curve
    #[arg(long, value_name = "SECONDS")]
    pub(crate) force_ramp: Option<f64>,
    /// Learn from tap to tap, and keep what was learnt in this file; `off`: do not [default: as the machine's file says]
    #[arg(long, value_name = "FILE|off")]
    pub(crate) learning: Option<PathBuf>,
    /// How the feed is tied to the spindle [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) synchronisation: Option<Synchronisation>,
}

/// `leadscrew iron`.
#[derive(Args, Debug, Clone)]
#[command(group = clap::ArgGroup::new("what").required(true).args(["listen", "status", "power_cut", "quit"]))]
pub(crate) struct IronArgs {
    /// Listen here, a Unix socket, for one control after the other
    #[arg(long, value_name = "PATH")]
    pub(crate) listen: Option<PathBuf>,
    /// Ask the iron that listens here how it is
    #[arg(long, value_name = "PATH")]
    pub(crate) status: Option<PathBuf>,
    /// Cut the power of the iron that listens here, and give it back
    #[arg(long, value_name = "PATH")]
    pub(crate) power_cut: Option<PathBuf>,
    /// End the iron that listens here
    #[arg(long, value_name = "PATH")]
    pub(crate) quit: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Seed of the machine's scatter (friction, backlash, material)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Material of the workpiece [default: the machine's set-up]
    #[arg(long, value_name = "NAME")]
    pub(crate) material: Option<String>,
    /// Let time pass as on the wall, instead of waiting for the control
    #[arg(long)]
    pub(crate) real_time: bool,
    /// The mains fail at this machine time, seconds; several separated by commas. They come back for the next control
    #[arg(long, value_name = "SECONDS", value_delimiter = ',')]
    pub(crate) power_cut_at: Vec<f64>,
    /// Kill the control (SIGKILL) at this machine time, seconds; several separated by commas
    #[arg(long, value_name = "SECONDS", value_delimiter = ',')]
    pub(crate) kill_control_at: Vec<f64>,
    /// What the drives do when the control falls silent [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) on_link_loss: Option<DriveReaction>,
    /// What they do when the mains fail [default: the machine's]
    #[arg(long, value_enum)]
    pub(crate) on_power_loss: Option<DriveReaction>,
    /// The spindle's encoder does not count turns without power [default: the machine's]
    #[arg(long)]
    pub(crate) single_turn: bool,
    /// Number of this very machine
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) serial: u64,
    /// Epoch of its encoders [default: a new one, as for new encoders]
    #[arg(long, value_name = "N")]
    pub(crate) epoch: Option<u64>,
}

/// `leadscrew recover`.
#[derive(Args, Debug, Clone)]
pub(crate) struct RecoverArgs {
    /// The iron
    #[arg(long, value_name = "PATH")]
    pub(crate) iron: PathBuf,
    /// The machine: a name from `leadscrew machine list`, or a file [default: tapping-center]
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) machine: Option<String>,
    /// Folder of the sync record [default: $XDG_STATE_HOME/leadscrew/MACHINE-NUMBER, or below ~/.local/state]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Rehearse: say what would be done, and move nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Draw where the tap stands and the way back
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) picture: Option<PathBuf>,
    /// Who moves back onto the thread
    #[arg(long, value_enum, default_value_t = RecoveryWay::UnloadFirst)]
    pub(crate) way: RecoveryWay,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Forget the record: you have seen that no tool is in the work
    #[arg(long, conflicts_with_all = ["dry_run", "picture"])]
    pub(crate) discard_record: bool,
}

/// `leadscrew check`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CheckArgs {
    /// Programs, or folders of them; `-` reads standard input
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// How findings are printed
    #[arg(long, value_enum, default_value_t = FindingsFormat::Text)]
    pub(crate) format: FindingsFormat,
}

/// `leadscrew time`.
#[derive(Args, Debug, Clone)]
pub(crate) struct TimeArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// How it is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// In JSON: every operation, not only the longest
    #[arg(long)]
    pub(crate) operations: bool,
}

/// `leadscrew fmt`.
#[derive(Args, Debug, Clone)]
pub(crate) struct FormatArgs {
    /// Programs, or folders of them; `-` reads standard input and writes standard output
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    /// Change nothing; say what would change
    #[arg(long)]
    pub(crate) check: bool,
}

/// `leadscrew compare`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CompareArgs {
    /// The program whose taps are compared
    pub(crate) program: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Instead of a program: holes of this thread [default: M6]
    #[arg(long, value_name = "THREAD", conflicts_with = "program")]
    pub(crate) size: Option<String>,
    /// Speed, rev/min: of the holes of a size, and at which the stopping time is taken
    #[arg(long, value_name = "RPM", default_value_t = 2000.0)]
    pub(crate) speed: f64,
    /// Depth of the holes, mm [default: 5 mm and 1.5 diameters]
    #[arg(long, value_name = "MM")]
    pub(crate) depth: Option<f64>,
    /// Holes tapped each way
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(crate) samples: u32,
    /// Seed of the scatter
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Stopping time of the spindle [default: the machine's own ramp]
    #[arg(long, value_name = "SECONDS")]
    pub(crate) stopping_time: Option<f64>,
    /// Scatter of the spindle speed, 1σ
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0)]
    pub(crate) speed_scatter: f64,
    /// Scatter of the stopping time, 1σ
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    pub(crate) stopping_scatter: f64,
    /// Scatter of the relay's delay, 1σ
    #[arg(long, value_name = "MS", default_value_t = 5.0)]
    pub(crate) relay_scatter: f64,
    /// A page with table and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// `leadscrew polygon`.
#[derive(Args, Debug, Clone)]

pub(crate) struct PolygonArgs {
    /// Sides of a regular polygon
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000), conflicts_with_all = ["insert_angles", "inserts"])]
    pub(crate) sides: u32,
    /// Where the inserts stand in the cutter, degrees: rhombi and other forms
    #[arg(long, value_name = "DEG,…", value_delimiter = ',')]
    pub(crate) insert_angles: Vec<f64>,
    /// Equally spaced inserts in the cutter [default: as the sides need]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) inserts: Option<u32>,
    /// Size across flats, mm
    #[arg(long, value_name = "MM")]
    pub(crate) across_flats: f64,
    /// From the tool spindle's axis to the inserts' tips, mm
    #[arg(long, value_name = "MM", default_value_t = 50.0)]
    pub(crate) tip_radius: f64,
    /// Turns of the work and of the tool
    #[arg(long, value_name = "WORK:TOOL", default_value = "1:2", allow_hyphen_values = true)]
    pub(crate) ratio: String,
    /// Diameter of the bar, mm [default: the machine's stock]
    #[arg(long, value_name = "MM")]
    pub(crate) stock: Option<f64>,
    /// Speed of the work, rev/min
    #[arg(long, value_name = "RPM", default_value_t = 500.0)]
    pub(crate) speed: f64,
    /// Flatness wanted, µm: says how fast it can be had
    #[arg(long, value_name = "UM")]
    pub(crate) flatness: Option<f64>,
    /// What may swing
    #[arg(long, value_enum, default_value_t = ActuatorChoice::Auto)]
    pub(crate) actuator: ActuatorChoice,
    /// Harmonics of each oscillation
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=32))]
    pub(crate) harmonics: u32,
    /// Length of the polygon, mm
    #[arg(long, value_name = "MM", default_value_t = 20.0)]
    pub(crate) length: f64,
    /// Feed along Z, mm per turn of the work
    #[arg(long, value_name = "MM", default_value_t = 0.1)]
    pub(crate) feed: f64,
    /// Number of the cutter in the tool table
    #[arg(long, value_name = "N", default_value_t = 21)]
    pub(crate) tool: u32,
    /// Inside a bore instead of outside
    #[arg(long)]
    pub(crate) internal: bool,
    /// The machine: a name from `leadscrew machine list`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "polygon-lathe")]
    pub(crate) machine: String,
    /// How the answer is printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// A page with table and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// What may swing.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ActuatorChoice {
    /// Whatever is flattest
    Auto,
    /// The line of centres
    X,
    /// Across it
    Y,
    /// Both slides
    Xy,
    /// The tool spindle's phase
    Phase,
}

/// `leadscrew cam`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CamArgs {
    /// Lift table: a row each angle, `angle,lift` in degrees and millimetres, over a whole turn
    pub(crate) table: Option<PathBuf>,
    /// Instead of a table: a closed form [default: automotive]
    #[arg(long, value_enum, conflicts_with = "table")]
    pub(crate) form: Option<CamFormName>,
    /// Radius of the base circle (eccentric, lobes: mean radius), mm [default without a table: 25]
    #[arg(long, value_name = "MM")]
    pub(crate) base: Option<f64>,
    /// Lift of a closed form, mm
    #[arg(long, value_name = "MM", default_value_t = 8.0)]
    pub(crate) lift: f64,
    /// Half of the angle over which a valve is open; angle of rise and of fall of a polynomial
    #[arg(long, value_name = "DEG", default_value_t = 65.0)]
    pub(crate) half_angle: f64,
    /// Lobes of a lobed cam
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub(crate) lobes: u32,
    /// What runs on the cam
    #[arg(long, value_enum, default_value_t = CamFollower::Flat)]
    pub(crate) follower: CamFollower,
    /// Radius of a roller follower, mm
    #[arg(long, value_name = "MM")]
    pub(crate) roller_radius: Option<f64>,
    /// Radius of the new wheel, mm
    #[arg(long, value_name = "MM", default_value_t = 200.0)]
    pub(crate) wheel_radius: f64,
    /// What the wheel has lost of its radius, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0)]
    pub(crate) wheel_wear: f64,
    /// Speed of the work, rev/min
    #[arg(long, value_name = "RPM", default_value_t = 60.0)]
    pub(crate) speed: f64,
    /// Steps of a turn of the wheel's table
    #[arg(long, value_name = "N", default_value_t = 720)]
    pub(crate) nodes: usize,
    /// The machine whose limits count
    #[arg(long, value_name = "NAME|FILE", default_value = "cam-grinder")]
    pub(crate) machine: String,
    /// Number of the profile in the G-code
    #[arg(long, value_name = "P", default_value_t = 1)]
    pub(crate) number: u32,
    /// What is printed
    #[arg(long, value_enum, default_value_t = CamOutput::Text)]
    pub(crate) format: CamOutput,
    /// A page with figures and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) out: Option<PathBuf>,
}

/// Closed forms.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamFormName {
    /// A circle off its axis by half the lift
    Eccentric,
    /// A harmonic lift over the whole turn
    Harmonic,
    /// Equal lobes
    Lobes,
    /// Rise and fall by 10u³ − 15u⁴ + 6u⁵
    Polynomial,
    /// L·(1 − u²)³ over ± the half angle
    Automotive,
}

/// Followers.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamFollower {
    /// A flat face
    Flat,
    /// A roller
    Roller,
    /// An edge: the lift is the contour's
    Knife,
}

impl From<CamFollower> for store::cams::FollowerKind {
    fn from(follower: CamFollower) -> Self {
        match follower {
            CamFollower::Flat => Self::Flat,
            CamFollower::Roller => Self::Roller,
            CamFollower::Knife => Self::Knife,
        }
    }
}

/// What `leadscrew cam` prints.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CamOutput {
    /// Figures and the G-code block
    Text,
    /// CSV: C, X, work speed
    Table,
    /// The G-code block alone
    Gcode,
    /// One JSON object
    Json,
}

/// `leadscrew canon`.
#[derive(Args, Debug, Clone)]
pub(crate) struct CanonArgs {
    /// The program; `-` reads standard input
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Which notation
    #[arg(long, value_enum, default_value_t = CanonFormat::Text)]
    pub(crate) format: CanonFormat,
}

/// `leadscrew machine`.
#[derive(Subcommand, Debug)]
pub(crate) enum MachineCommand {
    /// The embedded machines
    List,
    /// Print a machine's file: every value with its unit and source
    Show {
        /// A name from `list`, or a file
        machine: String,
    },
    /// Say everything that is wrong with a machine file
    Check {
        /// A name from `list`, or a file
        machine: String,
    },
}

/// What to do with tools that the table lacks.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MissingTools {
    /// Refuse the program and list them
    Refuse,
    /// Assume a tool of no length that cuts nothing judged, and say so
    StandIn,
}

/// What comes after a tap has been taken out.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AfterStop {
    /// The end
    Out,
    /// The remaining holes
    Continue,
}

/// What drives do that are left alone.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DriveReaction {
    /// Outputs off: brakes clamp, spindles coast
    Coast,
    /// Each brakes by itself
    QuickStop,
    /// Coupled ones brake together
    CoupledStop,
}

impl From<DriveReaction> for store::machine::Reaction {
    fn from(reaction: DriveReaction) -> Self {
        match reaction {
            DriveReaction::Coast => Self::Coast,
            DriveReaction::QuickStop => Self::QuickStop,
            DriveReaction::CoupledStop => Self::CoupledStop,
        }
    }
}

/// Who moves back onto the thread.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RecoveryWay {
    /// In a stiff holder the feed, to where nothing presses; then the axis that overran
    UnloadFirst,
    /// The axis that overran
    Direct,
}

/// How hard taps are driven; the machine's file says what each means.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TappingPreset {
    /// Half the dynamics: for weak work, long tools and first parts
    Gentle,
    /// What the spindle is planned with otherwise
    Standard,
    /// A little of the control's reserve is spent
    Fast,
    /// Nearly all of it: only where the material is known
    Max,
}

/// How taps are driven.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tapping {
    /// The feed follows the spindle, in and out
    Synchronised,
    /// Feed and spindle only run at their speeds; a tension/compression holder takes the difference
    Floating,
}

/// How a cam is compensated.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compensation {
    /// Not at all
    Off,
    /// By the measured phase error in whole addresses of the table
    Address,
    /// By the measured phase error as it is
    Shift,
    /// By the measured phase error with the wrong sign: what a mistake looks like
    Wrong,
    /// By gain and phase of every harmonic that was measured
    Harmonics,
    /// By harmonics, and by what sampled turns with compensation on have taught
    Learn,
}

/// On or off.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Switch {
    /// As the machine's file says
    On,
    /// None
    Off,
}

/// What to do with a dwell that a clutch holder does not work with.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClutchDwell {
    /// Refuse the program and say which dwell works
    Refuse,
    /// Say so, and do it: to see what becomes of the thread
    Warn,
}

/// How programs are read.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// RS-274/NGC as LinuxCNC 2.9 reads it
    Linuxcnc,
    /// Cycles as Brother's tapping centres have them: K repeats, U and E throw chips off
    Brother,
    /// Fanuc's machining centres: custom macro B, least input increments
    Fanuc,
    /// Fanuc's lathes, G code system A
    FanucLatheA,
    /// Fanuc's lathes, G code system B
    FanucLatheB,
    /// The cam grinding words of Toyoda's grinders: G50 to G53, G55, and G01 and G04 in cam mode
    Toyoda,
}

/// What a number without a decimal point counts in Fanuc's dialects.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DecimalPoint {
    /// Least input increments: X10 is 0.010 mm
    Increments,
    /// Whole units, as on a pocket calculator: X10 is 10 mm
    Calculator,
}

/// How a summary is printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// For people
    Text,
    /// For programs: the certificate
    Json,
}

/// How the codes are printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CodesFormat {
    /// A table
    Text,
    /// An array of objects
    Json,
}

/// How findings are printed.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FindingsFormat {
    /// With carets
    Text,
    /// An array of objects
    Json,
    /// SARIF 2.1.0, which code hosts and editors read
    Sarif,
}

/// Which notation.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CanonFormat {
    /// A line an operation
    Text,
    /// A JSON object a line
    Json,
    /// The notation of LinuxCNC's stand-alone interpreter
    Linuxcnc,
}

/// How the feed is tied to the spindle.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Synchronisation {
    /// Spindle and feed obey one planned trajectory
    Command,
    /// The feed follows the observed spindle, predicted to when the command acts
    Encoder,
    /// The feed follows the measured angle with speed feed-forward, not predicted: lags by v·Ts
    EncoderNoPrediction,
    /// The feed follows the measured angle by its position gain alone: lags by v/Kp + v·Ts
    EncoderNoFeedForward,
}
