//! What is clamped, and how the machine is simulated.
use super::axis::{FARTHEST_MM, n_per_um};
use super::plant::{Graduations, ScrewGrowth};
use super::scatter::StatedBefore;
use super::signals::InputModel;
use crate::keys::Keys;
use canon::{Material, Position};
use std::ops::RangeInclusive;
use units::{Length, Stiffness, Time};

/// A fraction of one, stated in percent.
pub(super) fn percent(keys: &mut Keys<'_>, key: &'static str, bounds: RangeInclusive<f64>) -> f64 {
    keys.number(key, bounds) / 100.0
}

/// The workpiece, and where it is clamped.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Work offset G54 that is in force when a program begins, in machine coordinates.
    pub g54: Position,
    /// Those of G55 to G59, which are zero where they are not stated.
    pub more: [Option<Position>; 5],
    /// The workpiece.
    pub stock: Stock,
    /// Holes that it has already, from its surface.
    pub holes: Vec<Round>,
    /// Cylinders that stand on its surface.
    pub bosses: Vec<Round>,
    /// The chuck of a lathe with its jaws: it reaches from there towards −Z.
    pub chuck: Option<Clamp>,
    /// The tailstock of a lathe with its centre: it reaches from there towards +Z.
    pub tailstock: Option<Clamp>,
    /// The turret of a lathe.
    pub turret: Option<Turret>,
    /// Diameter of the spindle's nose, which stands above a mill's tool.
    pub nose: Option<Length>,
}

/// The turret of a lathe: its tools stand side by side, each in the station of its pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turret {
    /// Its stations, at equal angles.
    pub stations: u32,
    /// From its axis to the tips of its tools.
    pub radius: Length,
}

impl Turret {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            stations: keys.whole("stations", 2..=64),
            radius: Length::mm(keys.number("radius_mm", 1.0..=FARTHEST_MM)),
        }
    }
}

/// What holds the work on a lathe: a cylinder about its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamp {
    /// Its diameter, as it turns.
    pub diameter: Length,
    /// Z of the end that the tools meet, in G54.
    pub face: Length,
}

impl Clamp {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            diameter: Length::mm(keys.number("diameter_mm", 0.1..=FARTHEST_MM)),
            face: Length::mm(keys.number("z_mm", -FARTHEST_MM..=FARTHEST_MM)),
        }
    }
}

/// Something round about an axis along Z, in coordinates of G54.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Its axis.
    pub at: [Length; 2],
    /// Its diameter.
    pub diameter: Length,
    /// How deep it is, or how high, from the surface.
    pub height: Length,
}

impl Round {
    /// The most of each that a set-up may state.
    const MOST: usize = 64;

    fn read(keys: &mut Keys<'_>, height: &'static str) -> Self {
        let mut at = |key| Length::mm(keys.number(key, -FARTHEST_MM..=FARTHEST_MM));
        let at = [at("x_mm"), at("y_mm")];
        let mut size = |key| Length::mm(keys.number(key, 0.001..=FARTHEST_MM));
        Self { at, diameter: size("diameter_mm"), height: size(height) }
    }
}

/// A block of material, in coordinates of G54.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// What it is made of.
    pub material: StockMaterial,
    /// Corner at the negative ends.
    pub from: [Length; 3],
    /// Corner at the positive ends; its Z is the surface.
    pub to: [Length; 3],
    /// Diameter of a bore along Z through its middle; zero: it is solid.
    pub bore: Length,
}

/// What a part is made of on this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StockMaterial {
    /// Its name.
    pub material: Material,
    /// Specific cutting force kc in tapping, N/mm².
    pub cutting_force_n_per_mm2: f64,
}

/// The simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Integration step.
    pub substep: Time,
    /// Seed of everything that scatters.
    pub seed: u32,
    /// The graduations of its encoders.
    pub graduations: Graduations,
    /// How screws grow while they get warm; `None`: they do not.
    pub screw_growth: Option<ScrewGrowth>,
    /// How a tap sits in the thread that it cuts.
    pub tap_seat: TapSeat,
    /// How taps wear; `None`: they do not.
    pub tap_wear: Option<TapWear>,
    /// What goes wrong with taps by chance; `None`: nothing.
    pub tap_mishaps: Option<TapMishaps>,
    /// How far the work really is from where the set-up has it, in X, Y and Z: what probing is
    /// there to find.
    pub work_shift: [Length; 3],
    /// What stands on the inputs.
    pub inputs: Vec<InputModel>,
    /// What the spindle's own drive really does, where that differs from what `[spindles.drive]`
    /// says.
    pub spindle_drive: SpindleDrive,
}

/// How taps wear: torque rises with the thread cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapWear {
    /// Length of thread in the life of a tap.
    pub life: Length,
    /// By how much its torque has risen by then.
    pub rise_share: f64,
    /// How much the lives of taps differ.
    pub scatter_share: f64,
}

impl TapWear {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            life: Length::mm(keys.number("life_m", 0.01..=1e6) * 1e3),
            rise_share: percent(keys, "torque_rise_percent", 0.0..=1000.0),
            scatter_share: percent(keys, "scatter_percent", 0.0..=90.0),
        }
    }
}

/// What goes wrong with taps by chance, hole by hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapMishaps {
    /// Chance that chips pack in a hole.
    pub packing: f64,
    /// From how many diameters of depth on, at the least and at the most.
    pub packed_from: (f64, f64),
    /// Torque of packed chips one diameter below that, over that of the cut, at the most.
    pub packed_rise: f64,
    /// Chance that a tap's core is cracked when it comes to a hole.
    pub crack: f64,
    /// Share of its strength that a cracked core has.
    pub cracked_strength: f64,
}

impl TapMishaps {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            packing: percent(keys, "packing_percent", 0.0..=100.0),
            packed_from: (
                keys.number("packed_from_diameters", 0.0..=100.0),
                keys.number("packed_to_diameters", 0.0..=100.0),
            ),
            packed_rise: percent(keys, "packed_rise_percent", 0.0..=10_000.0),
            crack: percent(keys, "crack_percent", 0.0..=100.0),
            cracked_strength: percent(keys, "cracked_strength_percent", 1.0..=100.0),
        }
    }
}

/// What a spindle drive that makes its own ramps really does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleDrive {
    /// Its deceleration, as a share of what the file says.
    pub deceleration_share: f64,
    /// 1σ of its delay.
    pub delay_scatter: Time,
    /// 1σ of the time that its ramps take, as a share.
    pub ramp_scatter_share: f64,
    /// 1σ of its speed, as a share.
    pub speed_scatter_share: f64,
}

impl SpindleDrive {
    /// One that does what the file says.
    const EXACT: Self = Self {
        deceleration_share: 1.0,
        delay_scatter: Time::ZERO,
        ramp_scatter_share: 0.0,
        speed_scatter_share: 0.0,
    };

    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            deceleration_share: percent(keys, "deceleration_percent", 10.0..=1000.0),
            delay_scatter: Time::s(keys.number("delay_scatter_ms", 0.0..=1000.0) * 1e-3),
            ramp_scatter_share: percent(keys, "ramp_scatter_percent", 0.0..=50.0),
            speed_scatter_share: percent(keys, "speed_scatter_percent", 0.0..=50.0),
        }
    }
}

/// How a tap sits in the thread that it cuts: free within the clearance, then on an elastic flank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapSeat {
    /// Axial play between flanks.
    pub flank_clearance: Length,
    /// Axial stiffness of flank on flank.
    pub flank_stiffness: Stiffness,
}

impl StockMaterial {
    /// A material as it usually is. kc of tapping: typical values of tool makers' tables.
    pub const fn usual(material: Material) -> Self {
        let cutting_force_n_per_mm2 = match material {
            Material::CarbonSteel => 3900.0,
            Material::AlloySteel => 3600.0,
            Material::Stainless => 4200.0,
            Material::CastIron => 2900.0,
            Material::Aluminium => 1300.0,
            Material::Brass => 2300.0,
        };
        Self { material, cutting_force_n_per_mm2 }
    }

    /// The material of that name, in any case of letters, as it usually is.
    pub fn named(name: &str) -> Option<Self> {
        Material::named(name).map(Self::usual)
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.material.name()
    }

    fn read(keys: &mut Keys<'_>) -> Self {
        let known = Material::ALL.map(|material| (material.name(), Self::usual(material)));
        let mut material = keys.choice("material", &known);
        if let Some(kc) = keys.optional("cutting_force_n_per_mm2", 1.0..=20_000.0) {
            material.cutting_force_n_per_mm2 = kc;
        }
        material
    }
}

impl Setup {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            g54: keys.section("g54", zero),
            more: ["g55", "g56", "g57", "g58", "g59"].map(|key| keys.optional_section(key, zero)),
            stock: keys.section("stock", Stock::read),
            holes: rounds(keys, "holes", "depth_mm"),
            bosses: rounds(keys, "bosses", "height_mm"),
            chuck: keys.optional_section("chuck", Clamp::read),
            tailstock: keys.optional_section("tailstock", Clamp::read),
            turret: keys.optional_section("turret", Turret::read),
            nose: keys.optional("spindle_nose_mm", 0.0..=FARTHEST_MM).map(Length::mm),
        }
    }
}

/// A work offset.
fn zero(keys: &mut Keys<'_>) -> Position {
    let mut at = |key| keys.number(key, -FARTHEST_MM..=FARTHEST_MM);
    Position::xyz(at("x_mm"), at("y_mm"), at("z_mm"))
}

/// `[[setup.holes]]` and `[[setup.bosses]]`, if there are any.
fn rounds(keys: &mut Keys<'_>, key: &'static str, height: &'static str) -> Vec<Round> {
    if !keys.has(key) {
        return Vec::new();
    }
    keys.sections(key, Round::MOST, |k| Round::read(k, height))
}

impl Stock {
    fn read(keys: &mut Keys<'_>) -> Self {
        let mut at = |key| Length::mm(keys.number(key, -FARTHEST_MM..=FARTHEST_MM));
        let from = [at("x_from_mm"), at("y_from_mm"), at("z_from_mm")];
        let to = [at("x_to_mm"), at("y_to_mm"), at("z_to_mm")];
        let keys_from = ["x_from_mm", "y_from_mm", "z_from_mm"];
        for (i, key) in keys_from.into_iter().enumerate() {
            if keys.has(key) && from[i] >= to[i] {
                let most = to[i].value();
                keys.conflict(key, format!("`{key}` is not below its other end at {most}"));
            }
        }
        let bore = Length::mm(keys.optional("bore_mm", 0.0..=FARTHEST_MM).unwrap_or(0.0));
        let stock = Self { material: StockMaterial::read(keys), from, to, bore };
        if bore > Length::ZERO && stock.bar_radius().is_none_or(|radius| bore >= radius * 2.0) {
            keys.conflict(
                "bore_mm",
                "a bore is for a bar, x and y from −r to r, and smaller than that",
            );
        }
        stock
    }

    /// Radius of a bar about Z: X and Y from −r to r.
    pub fn bar_radius(&self) -> Option<Length> {
        let radius = self.to[0];
        let same = |end: Length| (end - radius).abs() < Length::um(1.0);
        let is_bar = same(-self.from[0]) && same(self.to[1]) && same(-self.from[1]);
        (is_bar && radius > Length::ZERO).then_some(radius)
    }
}

impl Simulation {
    /// And how it scatters, as far as the version before stated it here.
    pub(super) fn read(keys: &mut Keys<'_>, before: &mut StatedBefore) -> Self {
        before.cutting_force = keys.optional("scatter_percent", 0.0..=50.0);
        Self {
            substep: Time::s(keys.number("substep_us", 1.0..=1000.0) * 1e-6),
            seed: keys.whole("seed", 0..=u32::MAX),
            graduations: keys
                .optional_section("plant", |k| Graduations::read(k, before))
                .unwrap_or(Graduations::TYPICAL),
            screw_growth: keys.optional_section("screw_growth", ScrewGrowth::read),
            tap_seat: keys.section("tap_seat", |k| TapSeat {
                flank_clearance: Length::um(k.number("flank_clearance_um", 0.0..=1000.0)),
                flank_stiffness: n_per_um(k.number("flank_stiffness_n_per_um", 0.1..=1e5)),
            }),
            tap_wear: keys.optional_section("tap_wear", TapWear::read),
            tap_mishaps: keys.optional_section("tap_mishaps", TapMishaps::read),
            work_shift: keys
                .optional_section("work_shift", |k| {
                    ["x_mm", "y_mm", "z_mm"].map(|key| {
                        Length::mm(k.optional(key, -FARTHEST_MM..=FARTHEST_MM).unwrap_or(0.0))
                    })
                })
                .unwrap_or_default(),
            inputs: keys
                .optional_section("inputs", super::signals::read_models)
                .unwrap_or_default(),
            spindle_drive: keys
                .optional_section("spindle_drive", SpindleDrive::read)
                .unwrap_or(SpindleDrive::EXACT),
        }
    }
}
