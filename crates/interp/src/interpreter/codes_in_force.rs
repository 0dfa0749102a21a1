//! The codes in force, one of each group.
use crate::{Corners, codes::spelling, state::executor::Executor, words::names};

/// Codes that are in force or are not, by the parameter that says so.
const SWITCHES: [&str; 13] = [
    "_metric",
    "_incremental",
    "_inverse_time",
    "_units_per_rev",
    "_tool_offset",
    "_retract_r_plane",
    "_ijk_absolute_mode",
    "_lathe_diameter_mode",
    "_spindle_css_mode",
    "_spindle_on",
    "_spindle_cw",
    "_mist",
    "_flood",
];

/// One code of each group, as the interpreter answers programs that ask: small, and quick to
/// compare, as it is for each operation of a long program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CodesInForce {
    /// Motion, plane, work offset and cutter compensation, in tenths.
    numbered: [u16; 4],
    corners: Corners,
    /// Of [`SWITCHES`], a bit each.
    switches: u16,
}

impl CodesInForce {
    pub(crate) fn of(executor: &Executor) -> Self {
        let value = |name: &str| names::system(&executor.modes, name).unwrap_or(0.0);
        let numbered = ["_motion_mode", "_plane", "_coord_system", "_ccomp"];
        let is = |(bit, name): (usize, &&str)| u16::from(value(name) != 0.0) << bit;
        Self {
            numbered: numbered.map(|name| value(name) as u16),
            corners: executor.modes.corners,
            switches: SWITCHES.iter().enumerate().map(is).sum(),
        }
    }

    /// As programs have them, motion first: `G1`, `G17`, `G21`, ….
    pub fn written(&self) -> Vec<String> {
        let is = |name: &str| {
            let bit = SWITCHES.iter().position(|switch| *switch == name);
            bit.is_some_and(|bit| self.switches >> bit & 1 == 1)
        };
        let either = |name: &str, yes: &str, no: &str| (if is(name) { yes } else { no }).to_owned();
        let [motion, plane, system, compensation] =
            self.numbered.map(|tenths| format!("G{}", spelling::written(tenths)));
        let mut codes = vec![
            motion,
            plane,
            either("_metric", "G21", "G20"),
            either("_incremental", "G91", "G90"),
            if is("_inverse_time") {
                "G93".to_owned()
            } else {
                either("_units_per_rev", "G95", "G94")
            },
            system,
            either("_tool_offset", "G43", "G49"),
            compensation,
            match self.corners {
                Corners::ExactPath => "G61".to_owned(),
                Corners::ExactStop => "G61.1".to_owned(),
                Corners::Continuous(0.0) => "G64".to_owned(),
                Corners::Continuous(tolerance) => format!("G64 P{tolerance}"),
            },
            either("_retract_r_plane", "G99", "G98"),
        ];
        let unusual = [
            ("_ijk_absolute_mode", "G90.1"),
            ("_lathe_diameter_mode", "G7"),
            ("_spindle_css_mode", "G96"),
        ];
        codes.extend(
            unusual.iter().filter(|(name, _)| is(name)).map(|(_, code)| (*code).to_owned()),
        );
        codes.push(if is("_spindle_on") {
            either("_spindle_cw", "M3", "M4")
        } else {
            "M5".to_owned()
        });
        let coolant = [("_mist", "M7"), ("_flood", "M8")];
        let on: Vec<_> = coolant.iter().filter(|(name, _)| is(name)).collect();
        codes.extend(on.iter().map(|(_, code)| (*code).to_owned()));
        if on.is_empty() {
            codes.push("M9".to_owned());
        }
        codes
    }
}
