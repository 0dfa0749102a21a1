//! Machine files: everything that planner, kernel and simulated plant must know of one machine.
//!
//! ```text
//!   [control]      servo period, synchronisation, waits, overrides, dialect      ─► kernel, interp
//!   [axes.x] …     travel, speeds, drive, structure, friction, encoder, loops,
//!                  homing, ends                                                 ─► plan, kernel, sim
//!   [[spindles]]   inertia, torque and power curve, friction, encoder, loops     ─► plan, kernel, sim
//!   [tool_change]  where and how long; its carousel                              ─► plan, sim
//!   [[sequences]]  what a tool change consists of, step by step                   ─► plan
//!   [tapping]      windows of the sync error, ramp, presets, pecks                  ─► plan, kernel
//!   [drives]       what the drives do when the control or the mains fail          ─► sim, app
//!   [hal]          how HAL's drives are led                                      ─► control
//!   [ethercat]     the network of drives: devices, times                         ─► control, leadscrew
//!   [grinding]     a cam grinder's wheel, its wear, what it costs to cut           ─► sim, forms
//!   [setup]        work offset G54, stock                                        ─► interp, verify
//!   [inputs]       which it has, by number and name; [outputs], [probe]         ─► plan
//!   [user_codes]   M codes of its own: what each does                               ─► interp
//!   [simulation]   substep, seed, what differs from all this                      ─► sim
//!   [scatter]      how each value varies: machines, workpieces, holes             ─► sim
//! ```
//!
//! Every key carries its unit in its name, and becomes a quantity of `units` here and nowhere else.
//! Machine coordinates: zero of each axis where the file's travel says; on the embedded machines it
//! is the positive end of the travel, so Z0 is the top.
//!
//! `extends = "NAME"` at the top bases a file on an embedded machine: it then states only what
//! differs. What a base states cannot be taken away, only changed; `[[spindles]]` are paired in
//! their order.
//!
//! Symbols without a quantity of their own, with the unit in the name of the field:
//!
//! | field ends in | unit |
//! |---|---|
//! | `_hz` | bandwidth, 1/s of a full cycle |
//! | `_per_s` | position gain, 1/s |
//! | `_n_s_per_m` | damping, N·s/m |
//! | `_n_m_s_per_rad` | viscous friction of a spindle |
//! | `_n_per_mm2` | specific cutting force kc |
//! | `_share` | a fraction of one; the file has percent |
mod axis;
mod axis_drive;
mod carousel;
mod change;
mod compensation;
mod contradictions;
mod control;
mod deviations;
mod drives;
mod ethercat;
mod ethercat_check;
mod grinding;
mod hal;
mod homing;
mod measured_torque;
mod plant;
pub(crate) mod rotary;
mod scatter;
mod sequence;
mod sequence_check;
mod setup;
mod signals;
mod spindle;
mod tapping;
mod user_code;

pub(crate) use axis::n_per_um;
pub use axis::{Approach, Axis, AxisWindows, Friction, Loops, PositionFrom, Structure, Travel};
pub use axis_drive::{Drive, Motor};
pub use carousel::CarouselModel;
pub use change::{changed, value};
pub use compensation::{COMPENSATION_POINTS, COMPENSATION_SHARE};
pub use control::{
    BoringAside, ChipRemoval, Control, CycleDepth, DIALECTS, Fanuc, Follows, Increments, Learning,
    Overrides, PathControl, PhaseLoss, Prediction, Synchronisation, ToolChange, Waits,
};
pub use deviations::{StatedDeviations, TakesUpPlay};
pub use drives::{DcBus, Drives};
pub use ethercat::{
    DeviceProfile, DriveSlot, EthercatDevice, EthercatNetwork, SlotInputs, SlotMode,
};
pub use grinding::{Grinding, Wheel};
pub use hal::Hal;
pub(crate) use hal::UNANSWERED;
pub use homing::{Ends, Homing, HomingMethod};
pub use measured_torque::MeasuredTorque;
pub use plant::{AxisErrors, Graduations, ScrewGrowth, SpindleErrors, eccentric};
pub use rotary::RAD_PER_M;
pub use scatter::Scatter;
pub use sequence::CarouselFile;
pub use setup::{
    Clamp, Round, Setup, Simulation, SpindleDrive, Stock, StockMaterial, TapMishaps, TapSeat,
    TapWear,
};
pub use signals::{InputModel, InputSource, Names, ProbeInput, Setter, parse_inputs};
pub use spindle::{OwnRamps, Spindle, SpindleFriction, SpindleWindows};
pub use tapping::{Effort, OnOverload, Peck, Preset, Ramp, TapSupervision, Tapping};
pub use user_code::{CallEntry, CodeEntry, CodeEntryAction, OwnCodes};

use crate::{Error, SMALL_FILE_LIMIT, keys, keys::Keys, read_text};
use diag::Diagnostic;
use scatter::StatedBefore;
use sequence::NamedSignals;
use std::path::Path;
use units::Coordinate;

/// A machine, as its file describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineFile {
    /// Its name.
    pub name: String,
    /// What it is, in one sentence.
    pub description: String,
    /// Its first spindle turns the work, a bar.
    pub is_lathe: bool,
    /// The control.
    pub control: Control,
    /// The axes, by `canon::Axis` index: X Y Z A B C U V W.
    pub axes: [Option<Axis>; bus::AXES],
    /// The spindles: the main one first.
    pub spindles: Vec<Spindle>,
    /// The tool changer.
    pub tool_change: ToolChange,
    /// The carousel that the sequences turn; `None`: there is none.
    pub carousel: Option<CarouselFile>,
    /// The sequence of a tool change; `None`: the changer takes the tool's number.
    pub tool_change_sequence: Option<std::sync::Arc<canon::Sequence>>,
    /// The simulated hardware of the carousel.
    pub simulated_carousel: Option<CarouselModel>,
    /// Rigid tapping.
    pub tapping: Tapping,
    /// What the drives do by themselves.
    pub drives: Drives,
    /// How its drives are led through LinuxCNC's HAL; `None`: they are not.
    pub hal: Option<Hal>,
    /// The EtherCAT network of its drives; `None`: they are on none.
    pub ethercat: Option<EthercatNetwork>,
    /// What it grinds cams with; `None`: it grinds none.
    pub grinding: Option<Grinding>,
    /// The workpiece, and where it is clamped.
    pub setup: Setup,
    /// The simulation.
    pub simulation: Simulation,
    /// How the values of the real machine, its tools and its work vary.
    pub scatter: Scatter,
    /// The inputs that it has, beside the probe.
    pub inputs: Names,
    /// The outputs that it has.
    pub outputs: Names,
    /// Its probe input; `None`: it has none.
    pub probe: Option<ProbeInput>,
    /// The machine's own M codes, and what they do.
    pub own_codes: OwnCodes,
}

/// Names of the embedded machines; the first is the default.
pub const EMBEDDED: [&str; 18] = [
    "tapping-center",
    "polygon-lathe",
    "lathe",
    "cam-grinder",
    "cam-grinder-coarse",
    "tapping-center-scale",
    "tapping-center-shop",
    "vfd-mill",
    "gear-hobber",
    "bench-xyz",
    "bench-xyz-jerk20",
    "mill-5-axis",
    "machining-center",
    "router",
    "turning-center",
    "portal-mill",
    "lathe-chuck-zero",
    "umbrella-mill",
];

/// The text of an embedded machine's file.
pub fn embedded(name: &str) -> Option<&'static str> {
    match name {
        "tapping-center" => Some(include_str!("../../../../machines/tapping-center.toml")),
        "polygon-lathe" => Some(include_str!("../../../../machines/polygon-lathe.toml")),
        "lathe" => Some(include_str!("../../../../machines/lathe.toml")),
        "tapping-center-scale" => {
            Some(include_str!("../../../../machines/tapping-center-scale.toml"))
        }
        "tapping-center-shop" => {
            Some(include_str!("../../../../machines/tapping-center-shop.toml"))
        }
        "vfd-mill" => Some(include_str!("../../../../machines/vfd-mill.toml")),
        "machining-center" => Some(include_str!("../../../../machines/machining-center.toml")),
        "router" => Some(include_str!("../../../../machines/router.toml")),
        "turning-center" => Some(include_str!("../../../../machines/turning-center.toml")),
        "cam-grinder" => Some(include_str!("../../../../machines/cam-grinder.toml")),
        "cam-grinder-coarse" => Some(include_str!("../../../../machines/cam-grinder-coarse.toml")),
        "gear-hobber" => Some(include_str!("../../../../machines/gear-hobber.toml")),
        "bench-xyz" => Some(include_str!("../../../../machines/bench-xyz.toml")),
        "bench-xyz-jerk20" => Some(include_str!("../../../../machines/bench-xyz-jerk20.toml")),
        "mill-5-axis" => Some(include_str!("../../../../machines/mill-5-axis.toml")),
        "portal-mill" => Some(include_str!("../../../../machines/portal-mill.toml")),
        "umbrella-mill" => Some(include_str!("../../../../machines/umbrella-mill.toml")),
        "lathe-chuck-zero" => Some(include_str!("../../../../machines/lathe-chuck-zero.toml")),
        _ => None,
    }
}

/// Read a machine from its text; `file` is the number that spans carry.
///
/// # Errors
/// Everything that is wrong with the text, in its order.
pub fn parse(text: &str, file: u16) -> Result<MachineFile, Vec<Diagnostic>> {
    keys::read_over(text, file, "extends", &embedded, MachineFile::read)
}

/// All keys that the reader of machine files asks for, by the built-in machines.
pub fn asked_keys() -> Vec<crate::AskedKey> {
    let mut all: Vec<crate::AskedKey> = Vec::new();
    for text in EMBEDDED.iter().filter_map(|name| embedded(name)) {
        for key in keys::asked(text, "extends", &embedded, MachineFile::read) {
            if !all.iter().any(|one| one.table == key.table && one.key == key.key) {
                all.push(key);
            }
        }
    }
    all
}

/// Read a machine from its file.
///
/// # Errors
/// When the file cannot be read, or [`Error::Refused`] with everything that is wrong with it.
pub fn load(path: &Path) -> Result<MachineFile, Error> {
    let text = read_text(path, "a machine file", SMALL_FILE_LIMIT)?;
    parse(&text, 0).map_err(|findings| Error::refused(path, text, findings))
}

/// The machine that a user means: the name of an embedded one, or the path of a file.
///
/// # Errors
/// As [`load`], and [`Error::NoSuchMachine`] with the nearest name.
pub fn find(name: &str) -> Result<MachineFile, Error> {
    let path = Path::new(name);
    if let Some(text) = embedded(name) {
        return parse(text, 0).map_err(|found| Error::refused(path, text.to_owned(), found));
    }
    if path.exists() || path.extension().is_some() || path.components().count() > 1 {
        return load(path);
    }
    let remedy = match crate::nearest::nearest(name, &EMBEDDED) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected a file or one of {}", EMBEDDED.join(", ")),
    };
    Err(Error::NoSuchMachine { name: name.to_owned(), remedy })
}

impl MachineFile {
    /// A linear axis, if the machine has it.
    pub fn axis(&self, letter: canon::Axis) -> Option<&Axis> {
        self.axes[letter.index()].as_ref()
    }

    /// Radius of the bar that the machine's first spindle turns; `None`: the machine is no lathe.
    /// That it is one is stated by its key `lathe`: the form of a stock does not tell a bar from a
    /// square plate.
    pub fn turned_bar(&self) -> Option<units::Length> {
        self.setup.stock.bar_radius().filter(|_| self.is_lathe)
    }

    fn read(keys: &mut Keys<'_>) -> Self {
        let mut before = StatedBefore::default();
        let inputs = keys.optional_section("inputs", Names::read).unwrap_or_default();
        let outputs = keys.optional_section("outputs", Names::read).unwrap_or_default();
        let signals = NamedSignals { inputs: &inputs, outputs: &outputs };
        let (mut carousel, mut simulated_carousel) = (None, None);
        let file = Self {
            name: keys.text("name"),
            description: keys.text("description"),
            is_lathe: keys.has("lathe") && keys.flag("lathe"),
            control: keys.section("control", Control::read),
            axes: keys.section("axes", read_axes),
            spindles: keys.sections("spindles", bus::SPINDLES, Spindle::read),
            tool_change: keys.section("tool_change", |keys| {
                let file = ToolChange::read(keys);
                let read = |keys: &mut Keys<'_>| CarouselFile::read(keys, signals, file.pockets);
                carousel = keys.optional_section("carousel", read);
                file
            }),
            carousel,
            tool_change_sequence: keys
                .optional_sections("sequences", 1, |keys| sequence::read(keys, signals, carousel))
                .pop()
                .map(std::sync::Arc::new),
            tapping: keys.section("tapping", Tapping::read),
            drives: keys.optional_section("drives", Drives::read).unwrap_or_default(),
            hal: keys.optional_section("hal", Hal::read),
            ethercat: keys.optional_section("ethercat", EthercatNetwork::read),
            grinding: keys.optional_section("grinding", Grinding::read),
            setup: keys.section("setup", Setup::read),
            simulation: keys.section("simulation", |keys| {
                let read = |keys: &mut Keys<'_>| CarouselModel::read(keys, signals);
                simulated_carousel = keys.optional_section("carousel", read);
                Simulation::read(keys, &mut before)
            }),
            simulated_carousel,
            scatter: Scatter::of(keys, &before),
            inputs: inputs.clone(),
            outputs: outputs.clone(),
            probe: keys.optional_section("probe", ProbeInput::read),
            own_codes: keys.optional_section("user_codes", OwnCodes::read).unwrap_or_default(),
        };
        file.refuse_contradictions(keys);
        file
    }

    /// What no section can see alone.
    fn refuse_contradictions(&self, keys: &Keys<'_>) {
        if self.simulation.substep > self.control.period {
            keys.conflict(
                "simulation",
                format!(
                    "`substep_us` is longer than the servo period: expected {} µs at most",
                    self.control.period.value() * 1e6
                ),
            );
        }
        for axis in self.axes.iter().flatten() {
            let offset = self.setup.g54.along(axis.letter);
            if axis.travel.from < axis.travel.to && !axis.travel.contains(offset) {
                let (letter, travel) = (axis.letter.letter(), &axis.travel);
                let message = format!(
                    "work offset G54 {letter}{} lies outside the travel of {} to {}{}",
                    offset.value(),
                    travel.from.value(),
                    travel.to.value(),
                    axis.letter.kind().unit()
                );
                keys.conflict("setup", message);
            }
        }
        let stock = &self.setup.stock;
        if self.is_lathe && stock.bar_radius().is_none() {
            keys.conflict(
                "lathe",
                "the stock of a lathe is a bar: expected x and y of [setup.stock] from −r to r",
            );
        }
        let setup = &self.setup;
        let is_turned =
            setup.chuck.is_some() || setup.tailstock.is_some() || setup.turret.is_some();
        if is_turned && !self.is_lathe {
            keys.conflict(
                "setup",
                "`chuck`, `tailstock` and `turret` are a lathe's: expected `lathe = true`",
            );
        }
        if stock.bore > units::Length::ZERO && !self.is_lathe {
            keys.conflict("setup", "`bore_mm` is for the bar of a lathe: expected `lathe = true`");
        }
        let change = &self.tool_change;
        let at = [
            (canon::Axis::X, "x_mm", change.x),
            (canon::Axis::Y, "y_mm", change.y),
            (canon::Axis::Z, "z_mm", Some(change.z)),
        ];
        for (letter, key, place) in at {
            let (Some(axis), Some(place)) = (self.axis(letter), place) else { continue };
            let travel = &axis.travel;
            if travel.from < travel.to && !travel.contains(Coordinate::linear(place)) {
                let message = format!(
                    "`{key}` of the tool change is {}: outside the travel of {} from {} to {} mm",
                    place.value(),
                    letter.letter(),
                    travel.from.value(),
                    travel.to.value()
                );
                keys.conflict("tool_change", message);
            }
        }
        self.refuse_sequence(keys);
        if let Some(hal) = &self.hal {
            self.refuse_drives_of_hal(keys);
            self.refuse_drives_of_nothing(hal, keys);
        }
        self.refuse_network(keys);
        self.refuse_unseen(keys);
        let names = self.spindles.iter().map(|s| s.name.as_str()).collect::<Vec<_>>();
        if names.len() == 2 && names[0] == names[1] {
            keys.conflict("spindles", format!("two spindles are named \"{}\"", names[0]));
        }
    }
}

impl MachineFile {
    /// Whether the drive of an axis, by its index on the bus, measures its force.
    pub fn measures_force(&self, axis: usize) -> bool {
        let file = self.axes.get(axis).and_then(Option::as_ref);
        file.is_some_and(|file| {
            let input = bus::WatchedInput::AxisForce(axis as u8);
            file.drive.measured_torque.is_some() || self.has_in_hal(input)
        })
    }

    /// Whether the drive of a spindle measures its torque.
    pub fn measures_torque(&self, spindle: usize) -> bool {
        self.spindles.get(spindle).is_some_and(|file| {
            let input = bus::WatchedInput::SpindleTorque(spindle as u8);
            file.measured_torque.is_some() || self.has_in_hal(input)
        })
    }

    fn has_in_hal(&self, input: bus::WatchedInput) -> bool {
        self.hal.as_ref().is_some_and(|hal| hal.watched.has(input))
    }

    /// Drives on the network: of the axes by index, and of the spindles.
    pub fn drive_slots(&self) -> (Vec<(usize, &DriveSlot)>, Vec<&DriveSlot>) {
        let axes = self.axes.iter().enumerate();
        let axes = axes.filter_map(|(at, axis)| Some((at, axis.as_ref()?.ethercat.as_ref()?)));
        (axes.collect(), self.spindles.iter().filter_map(|one| one.ethercat.as_ref()).collect())
    }
}

/// `[axes.x]` … `[axes.w]`, whichever are there.
fn read_axes(keys: &mut Keys<'_>) -> [Option<Axis>; bus::AXES] {
    const LINEAR: [(&str, canon::Axis); 6] = [
        ("x", canon::Axis::X),
        ("y", canon::Axis::Y),
        ("z", canon::Axis::Z),
        ("u", canon::Axis::U),
        ("v", canon::Axis::V),
        ("w", canon::Axis::W),
    ];
    const ROTARY: [(&str, canon::Axis); 3] =
        [("a", canon::Axis::A), ("b", canon::Axis::B), ("c", canon::Axis::C)];
    let mut axes = [const { None }; bus::AXES];
    for (key, letter) in LINEAR {
        axes[letter.index()] =
            keys.optional_section(key, |k| Axis::read(letter, k).with_compensation(k));
    }
    for (key, letter) in ROTARY {
        axes[letter.index()] =
            keys.optional_section(key, |k| rotary::read(letter, k).with_compensation(k));
    }
    axes
}
