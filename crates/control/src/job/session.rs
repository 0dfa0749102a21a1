//! What a program meets: its text, the machine, the tools, the parameters; loaded once, from
//! wherever they are.
use crate::Refused;
use crate::job::cams::CamSetup;
use crate::job::clamped::ClampedStock;
use crate::job::dialect;
use crate::job::drawn::Drawn;
use crate::job::interruption::Interruption;
use crate::job::operations::Before;
use crate::job::options::{DecimalPoint, ProgramOptions};
use crate::job::session_files::{G54, inserts, is_subprogram, load_inputs, parameters, plant_of};
pub use crate::job::session_files::{read_program, tools};
use canon::ToolLibrary;
use std::path::Path;
use store::machine::{MachineFile, Ramp, StockMaterial};
use store::tools::ToolTable;
use units::{Coordinate, Length};

/// A mill that the program's comments describe, and no table has.
const fn is_described(tool: &canon::Tool) -> bool {
    tool.stand_in && matches!(tool.kind, canon::ToolKind::EndMill(_))
}

/// Share of the following error's limit that the lag of a rapid may take without feed-forward.
const LAG_SHARE: f64 = 0.8;

/// Everything that is loaded before a program is read.
#[allow(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct Session {
    /// The machine.
    pub machine: MachineFile,
    /// The machine that is simulated; `None` is the one that the control believes.
    plant: Option<MachineFile>,
    /// The tools.
    pub tools: ToolLibrary,
    /// Where the tools came from, for people.
    pub tools_from: String,
    /// The tools' table: `None` is the built-in one.
    pub table: Option<ToolTable>,
    /// The program is a file of one subprogram, which ends without M2.
    pub is_subprogram: bool,
    /// SHA-256 of the machine's file and of the tool table, for the certificate.
    pub hashes: [String; 2],
    /// Values of the numbered parameters when a program begins.
    pub parameters: interp::Parameters,
    /// What to do with tools that the table lacks.
    pub missing_tools: interp::MissingTools,
    /// The unit that the program says first.
    pub unit: canon::LengthUnit,
    /// The tools that the program's comments describe.
    pub(super) described: Vec<canon::Tool>,
    /// Offsets that hold wear alone, as the program's comments say.
    wear_offsets: interp::WearOffsets,
    /// Holes that the program taps and does not drill are there: it states it, or its operator.
    pub pre_drilled: bool,
    /// The stock that is stated for it.
    pub(super) stock: ClampedStock,
    /// How taps are driven that are not tied to the spindle.
    pub taps: plan::Unsynchronised,
    /// How the program is read.
    pub dialect: interp::Dialect,
    /// The cams that the program may grind.
    pub cams: CamSetup,
    /// The axes are driven without their feed-forward.
    without_feed_forward: bool,
    decimal_point: Option<DecimalPoint>,
    leaves: interp::Leaves,
    block_skip: Vec<u8>,
    has_parameter_file: bool,
    /// Where the machine stands and which tool it holds, if it was not switched on just now.
    standing: Option<(canon::Position, u32)>,
    /// Where the tools are, and how a sequence that was left half way goes on; `None`: as the tool
    /// table has them, and none was.
    pub changer: Option<(canon::Magazine, Option<canon::Resume>)>,
    /// Files that the program draws in, in the order of their file numbers.
    pub drawn: Vec<Drawn>,
    /// What the program finds in force.
    pub before: Before,
    /// Whether what is planned is still wanted.
    pub interruption: Interruption,
}

impl Session {
    /// What the machine's file says of planning, for a work of this material.
    pub const fn plan_options(&self, material: StockMaterial) -> plan::Options {
        plan::Options {
            force_ramp: match self.machine.tapping.ramp {
                Ramp::PowerCurve => None,
                Ramp::Linear(time) => Some(time),
            },
            cutting_pressure_n_per_mm2: material.cutting_force_n_per_mm2,
            taps: self.taps,
        }
    }

    /// Load what the options name, for a program at `program` with this text.
    ///
    /// # Errors
    /// All that is wrong with the options, the machine, the tools and the program's text.
    pub fn load(options: &ProgramOptions, program: &Path, text: &[u8]) -> Result<Self, Refused> {
        let mut machine = crate::config::machine_file::load(&options.machine)?;
        if let Some(asked) = options.tapping_preset {
            machine.tapping.preset = asked;
        }
        if let Some(path) = &options.inputs {
            load_inputs(path, &mut machine)?;
        }
        let plant = options.plant.as_ref().map(|plant| plant_of(plant, &machine)).transpose()?;
        let dialect = dialect::of(options.dialect, &machine);
        let (mut tools, mut tools_from, table, bytes) =
            tools(options.tools.as_deref(), options.tool_unit, program)?;
        let mut missing_tools = options.missing_tools;
        // the built-in table is one of a mill, but for its inserts
        let is_foreign = dialect == interp::Dialect::Grbl || dialect.has_turret();
        let without_table = options.without_table || is_foreign && !options.keeps_table;
        if table.is_none() && without_table {
            tools = if dialect.has_turret() { inserts(&tools) } else { ToolLibrary::default() };
            tools_from = "the program".into();
            missing_tools = interp::MissingTools::StandIn;
        }
        let described = super::described::tools(text);
        // the shop's own table has the radius by which its control leads the tool
        let is_free = table.is_none();
        let wear_offsets = is_free.then(|| super::wear_comments::wear_offsets(text));
        if missing_tools == interp::MissingTools::StandIn {
            // the built-in table is an example: what the program says of its tools is nearer
            let lacks = |tool: &&canon::Tool| table.is_none() || tools.get(tool.number).is_none();
            let taken: Vec<_> = described.iter().filter(lacks).cloned().collect();
            if !taken.is_empty() && table.is_none() && tools.iter().next().is_some() {
                tools_from = "the program's comments and the embedded table".into();
            }
            for tool in taken {
                tools.insert(tool);
            }
        }
        let machine_text = crate::config::machine_file::text(&options.machine)?;
        let hashes = [machine_text.as_bytes(), &bytes].map(store::certificate::sha256);
        let cams = CamSetup::load(options, program, &machine)?;
        let mut session = Self {
            cams,
            without_feed_forward: options.without_feed_forward,
            parameters: parameters(options.parameters.as_deref(), &machine)?,
            has_parameter_file: options.parameters.is_some(),
            drawn: crate::job::subprograms::find(
                options,
                &machine,
                program,
                text,
                dialect.grammar(),
            )?,
            pre_drilled: options.pre_drilled || super::stock_comments::states_pre_drilled(text),
            stock: ClampedStock::of(options.stock.as_deref(), text)?,
            taps: taps(options, &machine),
            machine,
            plant,
            tools,
            tools_from,
            table,
            is_subprogram: is_subprogram(program, text),
            hashes,
            missing_tools,
            described,
            wear_offsets: wear_offsets.unwrap_or_default(),
            unit: super::described::unit(text),
            standing: None,
            changer: None,
            before: Before::default(),
            interruption: Interruption::default(),
            dialect,
            decimal_point: options.decimal_point,
            leaves: options.leaves,
            block_skip: options.block_skip.clone(),
        };
        session.clamp_stock();
        session.cams.recall(&session.machine)?;
        if !session.depends_on_program() {
            session.prepare(&[]);
        }
        Ok(session)
    }

    /// The beginning of a program that is read in pieces states its stock.
    pub fn is_stated_by(&mut self, head: &[u8]) {
        if self.stock.stated.is_none()
            && let Ok(stock) = ClampedStock::of(None, head)
        {
            self.stock = stock;
            self.clamp_stock();
        }
    }

    /// What the program states of its stock, or finds clamped.
    pub(crate) const fn clamped(&self) -> ClampedStock {
        self.stock
    }

    /// A program that states no stock goes on with the one that is clamped.
    pub(crate) fn finds_clamped(&mut self, stock: ClampedStock) {
        if self.stock.stated.is_none() && stock.stated.is_some() {
            self.stock = stock.standing();
            self.clamp_stock();
        }
    }

    fn clamp_stock(&mut self) {
        self.stock.clamp(&mut self.machine);
        if let Some(plant) = &mut self.plant {
            self.stock.clamp(plant);
        }
    }

    /// A stock is stated for this program, that the machine clamps.
    pub fn has_stated_stock(&self) -> bool {
        self.stock.is_stated()
    }

    /// The machine that is simulated.
    pub fn plant(&self) -> &MachineFile {
        self.plant.as_ref().unwrap_or(&self.machine)
    }

    /// What a program does must be known before it is planned: which cams it grinds, and which
    /// tools it lacks.
    pub fn depends_on_program(&self) -> bool {
        self.missing_tools == interp::MissingTools::StandIn || !self.cams.library.is_empty()
    }

    /// The program does this: the machine is prepared for it.
    pub fn prepare(&mut self, ops: &[canon::Op]) {
        self.cams.look_ahead(ops);
        if std::mem::take(&mut self.without_feed_forward) {
            self.take_feed_forward();
        }
        self.cams.assume(&self.machine);
    }

    /// The axes lag as their loops alone make them: where cams are ground X, which follows the
    /// work, else all.
    fn take_feed_forward(&mut self) {
        let of_all = !self.cams.is_wanted();
        let lags = |axis: &&mut store::machine::Axis| of_all || axis.letter == canon::Axis::X;
        for axis in self.machine.axes.iter_mut().flatten().filter(lags) {
            // an axis lags by its speed over its gain: no rapid may take it out of its window
            let most = axis.windows.following_error_stop.value() * axis.loops.position_gain_per_s;
            axis.rapid = axis.rapid.min(units::CoordinateSpeed::new(LAG_SHARE * most));
            axis.loops.velocity_feed_forward_share = 0.0;
            axis.loops.acceleration_feed_forward_share = 0.0;
            axis.loops.friction_feed_forward_share = 0.0;
        }
    }

    /// The machine stands where its encoders say. An axis that hangs at the end of its travel reads
    /// beyond it by what its screw gives: the kernel smooths as much away.
    pub fn stands(&mut self, feedback: &bus::Feedback) {
        const GIVES: Coordinate = Coordinate::new(0.05);
        let mut place = canon::Position::default();
        for axis in self.machine.axes.iter().flatten() {
            let reading = feedback.axes[axis.letter.index()].position;
            let within = reading.max(axis.travel.from).min(axis.travel.to);
            let stands = if (reading - within).abs() <= GIVES { within } else { reading };
            place = place.with(axis.letter, stands);
        }
        self.standing = Some((place, feedback.tool.unwrap_or(0)));
    }

    /// On a control that is on: where the axes are told to be and the tool in the spindle, offsets
    /// and tools as they are by now, and what is in force.
    pub fn on_control(
        &mut self,
        (place, tool): (canon::Position, u32),
        parameters: interp::Parameters,
        tools: ToolLibrary,
        before: Before,
    ) {
        self.standing = Some((place, tool));
        (self.parameters, self.tools) = (parameters, tools);
        let Before { rest, is_typed, turning } = before;
        let setup = self.interp_setup();
        let rest = rest.map(|rest| rest.for_next_text(&setup, tool));
        self.before = Before { rest, is_typed, turning };
    }

    /// The tool in the spindle when a program begins.
    pub fn tool(&self) -> u32 {
        self.standing.map_or(0, |(_, tool)| tool)
    }

    /// The changer of its machine, where a sequence works it.
    pub(super) fn planned_changer(&self) -> Option<plan::Changer> {
        let sequence = self.machine.tool_change_sequence.clone()?;
        let (magazine, resume) = match &self.changer {
            Some(known) => known.clone(),
            None => (crate::config::magazine(&self.machine, &self.tools)?, None),
        };
        Some(plan::Changer { sequence, magazine, resume })
    }

    /// What the interpreter is told before it begins.
    pub fn interp_setup(&self) -> interp::Setup {
        let mut start = canon::Position::default();
        for axis in self.machine.axes.iter().flatten() {
            start = start.with(axis.letter, crate::config::start(axis));
        }
        if let Some((place, _)) = self.standing {
            start = place;
        }
        let interruption = self.interruption.clone();
        interp::Setup {
            break_off: interp::BreakOff::by(move || interruption.came()),
            dialect: self.dialect,
            block_delete: self.block_skip.contains(&1),
            block_delete_levels: self.block_skip.iter().fold(0, |mask, level| mask | 1 << level),
            whole_units_without_point: match (self.decimal_point, self.machine.control.fanuc) {
                (Some(asked), _) => asked == DecimalPoint::Calculator,
                (None, fanuc) => fanuc.is_some_and(|fanuc| fanuc.calculator),
            },
            stroke_check_outside: self
                .machine
                .control
                .fanuc
                .is_some_and(|f| f.stroke_check_outside),
            fastest_spindle: self.machine.spindles.first().map(|spindle| spindle.max),
            increments: dialect::increments(&self.machine.control),
            c_is_a_chamfer: self.machine.axis(canon::Axis::C).is_none(),
            cycles: dialect::cycles(self.dialect, &self.machine.control),
            tools: self.tools.clone(),
            missing_tools: self.missing_tools,
            wear_offsets: self.wear_offsets.clone(),
            // a control that is on has its own
            has_example_tools: self.table.is_none() && self.standing.is_none(),
            parameters: self.parameters.clone(),
            subprograms: self.drawn.iter().map(|drawn| drawn.sub.clone()).collect(),
            user_codes: dialect::user_codes(&self.machine.own_codes.codes),
            macro_calls: dialect::macro_calls(&self.machine.own_codes.calls),
            leaves: dialect::leaves(self.leaves, &self.machine.control),
            start,
            ..interp::Setup::default()
        }
    }

    /// Zero of the workpiece in machine coordinates: the work offset G54 that is in force when the
    /// program begins. The stock is clamped there.
    pub fn work_zero(&self) -> canon::Position {
        let mut zero = canon::Position::default();
        for axis in [canon::Axis::X, canon::Axis::Y, canon::Axis::Z] {
            let value = self.parameters.get(G54 + axis.index()).unwrap_or(0.0);
            zero = zero.with(axis, units::Coordinate::new(value));
        }
        zero
    }

    /// What the workpiece is judged by that is clamped at this zero. Tools are as the table has
    /// them.
    pub fn judge(&self, material: StockMaterial, zero: &canon::Position) -> verify::Config {
        verify::Config {
            synchronised: self.taps.method == plan::TapMethod::Synchronised,
            pre_drilled: self.pre_drilled,
            cams: self.cams.library.clone(),
            described_mills: ToolLibrary::new(
                self.tools.iter().filter(|tool| is_described(tool)).cloned(),
            ),
            mill_stock: super::mill_stock::machine_stock(self),
            ..crate::config::judge(&self.machine, &self.tools, material, zero)
        }
    }

    /// The workpiece before it is cut, in machine coordinates of a tool's tip.
    pub fn stock(&self) -> plan::Stock {
        let (zero, stock) = (self.work_zero().linear, self.machine.setup.stock);
        plan::Stock {
            from: [0, 1, 2].map(|i| zero[i] + stock.from[i]),
            to: [0, 1, 2].map(|i| zero[i] + stock.to[i]),
            zero: zero[2],
            bar: self
                .machine
                .turned_bar()
                .map(|radius| plan::Bar { radius, bore: stock.bore / 2.0 }),
        }
    }

    /// Bodies of the machine that tools can meet, in machine coordinates of a tool's tip.
    pub fn bodies(&self) -> plan::Bodies {
        let (zero, setup) = (self.work_zero().linear[2], &self.machine.setup);
        let face = |end: store::machine::Clamp| zero + end.face;
        let far = Length::mm(1e4);
        plan::Bodies {
            nose: setup.nose,
            wheel: self.machine.grinding.as_ref().map(|grinding| grinding.wheel.diameter / 2.0),
            tools_by_hand: self.dialect.has_tools_by_hand(),
            chuck: setup.chuck.map(|chuck| plan::Cylinder {
                radius: chuck.diameter / 2.0,
                from: zero - far,
                to: face(chuck),
            }),
            tailstock: setup.tailstock.map(|tailstock| plan::Cylinder {
                radius: tailstock.diameter / 2.0,
                from: face(tailstock),
                to: zero + far,
            }),
            turret: setup
                .turret
                .map(|turret| plan::Turret { stations: turret.stations, radius: turret.radius }),
        }
    }

    /// Holes that the work has before the program begins: where, how wide and how deep, mm.
    pub fn holes(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
        let zero = self.work_zero().linear;
        self.machine.setup.holes.iter().map(move |hole| {
            let at = [0, 1].map(|i| (zero[i] + hole.at[i]).value());
            (at, [hole.diameter.value(), hole.height.value()])
        })
    }

    /// Who computes the oscillations that a program leaves to the control.
    pub fn auto(&self) -> crate::polygon::oscillation::Auto<'_> {
        let axis = self.work_zero().linear[0];
        let phases = &self.cams.phases;
        crate::polygon::oscillation::Auto::new(&self.machine, &self.tools, phases, axis)
    }

    /// The same as a stand-alone interpreter has it: no machine, so no work offsets but those of a
    /// parameter file, and the axes at zero.
    pub fn bare_setup(&self) -> interp::Setup {
        let mut setup = self.interp_setup();
        setup.start = canon::Position::default();
        setup.stand_alone = true;
        if !self.has_parameter_file {
            setup.parameters = interp::Parameters::default();
        }
        setup
    }
}

/// As the machine's file has it, unless the user says otherwise.
fn taps(options: &ProgramOptions, machine: &MachineFile) -> plan::Unsynchronised {
    let usual = if machine.tapping.floating {
        plan::TapMethod::Floating
    } else {
        plan::TapMethod::Synchronised
    };
    plan::Unsynchronised {
        method: options.tapping.unwrap_or(usual),
        dwell: options.clutch_dwell,
        drive: machine.spindles.first().and_then(|spindle| spindle.own_ramps).map(|own| {
            plan::PlainDrive { delay: own.delay, accel: own.acceleration.min(own.deceleration) }
        }),
    }
}
