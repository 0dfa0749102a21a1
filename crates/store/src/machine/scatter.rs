//! `[scatter]`: how each value of a real machine, its tools and its work varies about what the file
//! says, by the seed.
//!
//! ```toml
//! [scatter]
//! backlash = { percent = 20, distribution = "uniform", per = "machine" }
//! ```
//!
//! The simulated plant alone reads it; the control is never told. A value that the section does not
//! name varies as [`Scatter::TYPICAL`] says. The number is the farthest to either side, of a normal
//! distribution one standard deviation.
//!
//! | value | unit | per | what it is |
//! |---|---|---|---|
//! | `backlash`, `stiffness`, `friction` | percent | machine, part | of each axis; friction of spindles as well |
//! | `screw_lead` | um_per_300_mm | machine | cumulative lead error, as ISO 3408-3 has it (half of V300p, to either side) |
//! | `screw_wobble` | um | machine | amplitude of the screw's error once per revolution (half of v2πp) |
//! | `gear_wobble` | arcsec | machine | the same of a rotary axis' gear, at the table |
//! | `encoder_eccentricity` | um | machine | a graduation off its centre by e reads 2·e/diameter rad wrong, once per revolution |
//! | `scale_error` | um_per_m | machine | error of a linear scale, growing with the length |
//! | `screw_growth` | percent | machine, part | of `[simulation.screw_growth]` |
//! | `torque_constant` | percent | machine | of each motor whose drive measures its torque |
//! | `cutting_force` | percent | machine, part, hole | of drills and taps; of bars and blanks as a whole |
//! | `material_strength` | percent | machine, part | factor on all forces of the cut |
//! | `tool_diameter` | um | machine, part | of drills, and of the pitch diameter of taps |
//! | `tool_lead` | um_per_25_mm | machine, part | of taps |
//! | `alignment` | um | machine, part | how far the work is clamped from where the set-up has it, in X, Y and Z |
use crate::keys::Keys;
use std::ops::RangeInclusive;
use toml::de::DeTable;
use units::{Distribution, FARTHEST_DEVIATIONS, Per, Spread};

/// A value that is as the file says, where `[scatter]` does not name it.
const fn none(per: Per) -> Spread {
    Spread { by: 0.0, distribution: Distribution::Normal, per }
}

/// How the values of a plant vary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Play, as a share.
    pub backlash: Spread,
    /// Stiffness between motor and table, as a share.
    pub stiffness: Spread,
    /// Friction of guideways and spindles, as a share.
    pub friction: Spread,
    /// Cumulative lead error of ball screws, length over length.
    pub screw_lead: Spread,
    /// Amplitude of their error once per revolution, mm.
    pub screw_wobble: Spread,
    /// The same of a rotary axis' gear, degrees.
    pub gear_wobble: Spread,
    /// How far an encoder's graduation is off its centre, mm.
    pub encoder_eccentricity: Spread,
    /// Error of linear scales, length over length.
    pub scale_error: Spread,
    /// Growth of warm screws, as a share.
    pub screw_growth: Spread,
    /// Torque constant of motors, by which drives measure torque, as a share.
    pub torque_constant: Spread,
    /// Force of the cut, as a share.
    pub cutting_force: Spread,
    /// Strength of the material, as a share.
    pub material_strength: Spread,
    /// Diameter of drills and pitch diameter of taps, mm.
    pub tool_diameter: Spread,
    /// Lead of taps, length over length.
    pub tool_lead: Spread,
    /// Where the work is clamped, mm.
    pub alignment: Spread,
}

/// What the version before stated elsewhere: in `[simulation.plant]`, and as `scatter_percent` in
/// `[simulation]`. In the units of the keys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StatedBefore {
    pub(super) backlash: Option<f64>,
    pub(super) stiffness: Option<f64>,
    pub(super) friction: Option<f64>,
    pub(super) screw_lead: Option<f64>,
    pub(super) screw_wobble: Option<f64>,
    pub(super) gear_wobble: Option<f64>,
    pub(super) encoder_eccentricity: Option<f64>,
    pub(super) scale_error: Option<f64>,
    pub(super) cutting_force: Option<f64>,
}

/// One value of the section.
struct Value {
    name: &'static str,
    unit: &'static str,
    /// Bounds in that unit.
    bounds: RangeInclusive<f64>,
    /// Of the unit, in the value's own.
    scale: f64,
    per: &'static [(&'static str, Per)],
    before: Option<f64>,
    usual: Spread,
}

const MACHINE: &[(&str, Per)] = &[("machine", Per::Machine)];
const PART: &[(&str, Per)] = &[("machine", Per::Machine), ("part", Per::Part)];
const HOLE: &[(&str, Per)] = &[("machine", Per::Machine), ("part", Per::Part), ("hole", Per::Hole)];

/// Most of a share, in percent: what varies by it stays above nothing.
const SHARE: RangeInclusive<f64> = 0.0..=80.0;
/// The same of the force of a cut.
const FORCE_SHARE: RangeInclusive<f64> = 0.0..=49.0;

impl Value {
    /// A share of the value.
    fn share(name: &'static str, per: &'static [(&'static str, Per)], usual: Spread) -> Self {
        Self { name, unit: "percent", bounds: SHARE, scale: 0.01, per, before: None, usual }
    }

    /// A share of the force of a cut.
    fn force(name: &'static str, per: &'static [(&'static str, Per)], usual: Spread) -> Self {
        Self { bounds: FORCE_SHARE, ..Self::share(name, per, usual) }
    }

    fn before(mut self, before: Option<f64>) -> Self {
        self.before = before;
        self
    }

    fn read(self, keys: &mut Keys<'_>) -> Spread {
        let Self { name, unit, bounds, scale, per, before, usual } = self;
        let stated = keys.optional_section(name, |k| {
            let by = k.number(unit, bounds.clone());
            let spreads = [
                ("uniform", Distribution::Uniform),
                ("triangular", Distribution::Triangular),
                ("normal", Distribution::Normal),
            ];
            let distribution =
                k.optional_choice("distribution", &spreads).unwrap_or(Distribution::Uniform);
            let most = *bounds.end() / FARTHEST_DEVIATIONS;
            if distribution == Distribution::Normal && by > most {
                let message = format!(
                    "`{unit}` is {by}, one standard deviation of a normal distribution: expected {most:.4} at most"
                );
                k.conflict(unit, message);
            }
            let per = k.optional_choice("per", per).unwrap_or(usual.per);
            Spread { by: by * scale, distribution, per }
        });
        match before {
            None => stated.unwrap_or(usual),
            Some(before) => {
                if keys.states(name) {
                    let message = format!(
                        "`{name}` is stated in [simulation] as well: expected here alone, where {before} {unit} would be the same"
                    );
                    keys.conflict(name, message);
                }
                Spread { by: before * scale, distribution: Distribution::Uniform, ..usual }
            }
        }
    }
}

impl Scatter {
    /// Of a machine whose file does not say it.
    pub const TYPICAL: Self = Self {
        backlash: Spread::uniform(0.2),
        stiffness: Spread::uniform(0.15),
        friction: Spread::uniform(0.2),
        screw_lead: Spread::uniform(6e-3 / 300.0),
        screw_wobble: Spread::uniform(3e-3),
        gear_wobble: Spread::uniform(5.0 / 3600.0),
        encoder_eccentricity: Spread::uniform(3e-3),
        scale_error: Spread::uniform(3e-6),
        screw_growth: none(Per::Machine),
        torque_constant: Spread::uniform(0.03),
        cutting_force: Spread { by: 0.05, distribution: Distribution::Uniform, per: Per::Hole },
        material_strength: none(Per::Part),
        tool_diameter: none(Per::Part),
        tool_lead: none(Per::Part),
        alignment: none(Per::Part),
    };

    /// The machine's `[scatter]`.
    pub(super) fn of(keys: &mut Keys<'_>, before: &StatedBefore) -> Self {
        let stated = keys.optional_section("scatter", |k| Self::read(k, before));
        stated.unwrap_or_else(|| Self::read(&mut Keys::missing(&DeTable::new()), before))
    }

    fn read(keys: &mut Keys<'_>, before: &StatedBefore) -> Self {
        let usual = Self::TYPICAL;
        let um = |name, per, usual| Value {
            name,
            unit: "um",
            bounds: 0.0..=1000.0,
            scale: 1e-3,
            per,
            before: None,
            usual,
        };
        let growing = |name, unit, most, scale, per, usual| Value {
            name,
            unit,
            bounds: 0.0..=most,
            scale,
            per,
            before: None,
            usual,
        };
        let per_300 = ("um_per_300_mm", 3000.0, 1e-3 / 300.0);
        Self {
            backlash: Value::share("backlash", PART, usual.backlash)
                .before(before.backlash)
                .read(keys),
            stiffness: Value::share("stiffness", PART, usual.stiffness)
                .before(before.stiffness)
                .read(keys),
            friction: Value::share("friction", PART, usual.friction)
                .before(before.friction)
                .read(keys),
            screw_lead: growing(
                "screw_lead",
                per_300.0,
                per_300.1,
                per_300.2,
                MACHINE,
                usual.screw_lead,
            )
            .before(before.screw_lead)
            .read(keys),
            screw_wobble: um("screw_wobble", MACHINE, usual.screw_wobble)
                .before(before.screw_wobble)
                .read(keys),
            gear_wobble: growing(
                "gear_wobble",
                "arcsec",
                3600.0,
                1.0 / 3600.0,
                MACHINE,
                usual.gear_wobble,
            )
            .before(before.gear_wobble)
            .read(keys),
            encoder_eccentricity: um("encoder_eccentricity", MACHINE, usual.encoder_eccentricity)
                .before(before.encoder_eccentricity)
                .read(keys),
            scale_error: growing(
                "scale_error",
                "um_per_m",
                10_000.0,
                1e-6,
                MACHINE,
                usual.scale_error,
            )
            .before(before.scale_error)
            .read(keys),
            screw_growth: Value::share("screw_growth", PART, usual.screw_growth).read(keys),
            torque_constant: Value::share("torque_constant", MACHINE, usual.torque_constant)
                .read(keys),
            cutting_force: Value::force("cutting_force", HOLE, usual.cutting_force)
                .before(before.cutting_force)
                .read(keys),
            material_strength: Value::force("material_strength", PART, usual.material_strength)
                .read(keys),
            tool_diameter: um("tool_diameter", PART, usual.tool_diameter).read(keys),
            tool_lead: growing(
                "tool_lead",
                "um_per_25_mm",
                250.0,
                1e-3 / 25.0,
                PART,
                usual.tool_lead,
            )
            .read(keys),
            alignment: um("alignment", PART, usual.alignment).read(keys),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{MachineFile, parse};

    fn machine(text: &str) -> MachineFile {
        parse(&format!("extends = \"tapping-center\"\n{text}"), 0).unwrap()
    }

    fn refused(text: &str) -> String {
        let text = format!("extends = \"tapping-center\"\n{text}");
        let found = parse(&text, 0).unwrap_err();
        found.iter().map(|found| found.message.as_str()).collect::<Vec<_>>().join("; ")
    }

    #[test]
    fn a_value_is_declared_with_unit_distribution_and_what_it_is_of() {
        let scatter = machine(
            "[scatter]\nbacklash = { percent = 8, distribution = \"normal\", per = \"part\" }\n\
             screw_lead = { um_per_300_mm = 12 }\ntool_lead = { um_per_25_mm = 10, per = \"machine\" }\n",
        )
        .scatter;
        let normal = Spread { by: 0.08, distribution: Distribution::Normal, per: Per::Part };
        assert_eq!(scatter.backlash, normal);
        assert_eq!(scatter.screw_lead, Spread::uniform(12.0 * (1e-3 / 300.0)));
        assert_eq!(scatter.tool_lead, Spread::uniform(10.0 * (1e-3 / 25.0)));
        assert_eq!(
            scatter.friction,
            machine("").scatter.friction,
            "what is not named is as before"
        );
    }

    #[test]
    fn a_value_that_is_changed_alone_keeps_the_rest_of_its_base() {
        let changed = machine("[scatter.cutting_force]\npercent = 9\n").scatter.cutting_force;
        assert_eq!((changed.by, changed.per), (0.09, Per::Hole));
    }

    #[test]
    fn unknown_keys_other_units_and_what_the_plant_has_not_are_refused() {
        for (text, says) in [
            (
                "backlahs = { percent = 8 }",
                "unknown key `backlahs` in [scatter]: did you mean `backlash`?",
            ),
            ("tool_diameter = { percent = 8 }", "unknown key `percent` in [scatter.tool_diameter]"),
            ("tool_diameter = { percent = 8 }", "[scatter.tool_diameter] lacks the key `um`"),
            ("screw_lead = { um_per_300_mm = 6, per = \"hole\" }", "\"hole\""),
            ("backlash = { percent = 20, distribution = \"gauss\" }", "\"gauss\""),
            ("backlash = { percent = 90 }", "`percent` is 90: expected a number from 0 to 80"),
            ("backlash = { percent = 40, distribution = \"normal\" }", "expected 26.6667 at most"),
            ("backlash = 20", "a table"),
        ] {
            let found = refused(&format!("[scatter]\n{text}\n"));
            assert!(found.contains(says), "{text}: {found}");
        }
    }

    #[test]
    fn what_the_version_before_stated_elsewhere_still_holds_and_never_both() {
        let before = "[simulation]\nscatter_percent = 20\n[simulation.plant]\nbacklash_scatter_percent = 30\n";
        let scatter = machine(before).scatter;
        assert_eq!(scatter.backlash, Spread::uniform(0.3));
        assert_eq!((scatter.cutting_force.by, scatter.cutting_force.per), (0.2, Per::Hole));
        let both = refused(&format!("{before}[scatter]\nbacklash = {{ percent = 20 }}\n"));
        assert!(both.contains("`backlash` is stated in [simulation] as well"), "{both}");
    }
}
