//! What the seed makes of tools and work, beside the machine: as they really are, which no table
//! and no set-up says.
//!
//! The judge measures what was cut, so that it goes by the tools as they are. It keeps to the lead
//! that was asked: a tap of another lead cuts a thread of another lead, which its gauge feels over
//! the length of engagement.
use canon::{Tool, ToolKind, ToolLibrary};
use store::machine::MachineFile;
use units::{Length, Spread};

/// Streams of their own: a tool keeps its errors when another one is added.
const OF_DIAMETER: u64 = 0x4449_414D_4554_4552;
const OF_LEAD: u64 = 0x4C45_4144_4F46_5441;
const OF_TORQUE: u64 = 0x544F_5251_5545_4F46;
const OF_ALIGNMENT: u64 = 0x414C_4947_4E4D_454E;
/// From the stream of one to that of the next.
const NEXT: u64 = 0x9E37_79B9_7F4A_7C15;

fn drawn(spread: &Spread, (seed, part): (u64, u32), of: u64, number: u32) -> f64 {
    sim::drawn(spread, seed, of.wrapping_add(NEXT.wrapping_mul(u64::from(number))), part)
}

/// The tools as they really are at a workpiece: their diameters and leads.
pub fn real_tools(machine: &MachineFile, tools: &ToolLibrary, seed: u64, part: u32) -> ToolLibrary {
    let lead = machine.scatter.tool_lead;
    let real = |tool: Tool| {
        let mut tool = with_diameter(tool, machine, (seed, part));
        if let ToolKind::Tap(tap) = &mut tool.kind {
            tap.lead = tap.lead * (1.0 + drawn(&lead, (seed, part), OF_LEAD, tool.number));
        }
        tool
    };
    ToolLibrary::new(tools.iter().cloned().map(real))
}

/// The tools as the judge takes them: with the diameters that they really have.
pub fn judged_tools(
    machine: &MachineFile,
    tools: &ToolLibrary,
    seed: u64,
    part: u32,
) -> ToolLibrary {
    let real = |tool| with_diameter(tool, machine, (seed, part));
    ToolLibrary::new(tools.iter().cloned().map(real))
}

/// By how much the torque constant of a motor is off, as a share; `place` is that of its axis or,
/// after all of these, of its spindle.
pub(super) fn torque_constant(spread: &Spread, seed: u64, place: usize) -> f64 {
    drawn(spread, (seed, 1), OF_TORQUE, place as u32)
}

/// What is really known of tools: of a stand-in nothing, whatever it is planned as.
pub(super) fn known_tools(tools: &ToolLibrary) -> ToolLibrary {
    ToolLibrary::new(tools.iter().cloned().map(known))
}

fn known(tool: Tool) -> Tool {
    if tool.stand_in {
        Tool { kind: ToolKind::Other, diameter: Length::ZERO, ..tool }
    } else {
        tool
    }
}

fn with_diameter(tool: Tool, machine: &MachineFile, of: (u64, u32)) -> Tool {
    let mut tool = known(tool);
    let number = tool.number;
    let off = || Length::mm(drawn(&machine.scatter.tool_diameter, of, OF_DIAMETER, number));
    match &mut tool.kind {
        ToolKind::Drill { .. } => tool.diameter += off(),
        ToolKind::Tap(tap) => tap.oversize += off(),
        ToolKind::SpotDrill { .. }
        | ToolKind::Insert(_)
        | ToolKind::Hob(_)
        | ToolKind::Probe(_)
        | ToolKind::EndMill(_)
        | ToolKind::PolygonCutter(_)
        | ToolKind::Other => {}
    }
    tool
}

/// How far the work is clamped from where the set-up has it, in X, Y and Z.
pub fn alignment(machine: &MachineFile, seed: u64, part: u32) -> [Length; 3] {
    let off = |axis| drawn(&machine.scatter.alignment, (seed, part), OF_ALIGNMENT, axis);
    [0, 1, 2].map(|axis| Length::mm(off(axis)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::TapTool;

    fn machine(text: &str) -> MachineFile {
        let text = format!("extends = \"tapping-center\"\n[scatter]\n{text}\n");
        store::machine::parse(&text, 0).expect("it is in order")
    }

    fn tools() -> ToolLibrary {
        let text = include_str!("../../../../programs/tools.toml");
        store::tools::parse_toml(text, 0).expect("the shop's tools").library
    }

    fn taps(tools: &ToolLibrary) -> Vec<(u32, TapTool)> {
        let tap = |tool: &Tool| match &tool.kind {
            ToolKind::Tap(tap) => Some((tool.number, tap.clone())),
            _ => None,
        };
        tools.iter().filter_map(tap).collect()
    }

    #[test]
    fn tools_are_as_the_table_says_where_nothing_is_declared() {
        let usual = machine("");
        assert_eq!(real_tools(&usual, &tools(), 3, 1), tools());
        assert_eq!(judged_tools(&usual, &tools(), 3, 8), tools());
        assert_eq!(alignment(&usual, 3, 8), [Length::ZERO; 3]);
    }

    #[test]
    fn each_tool_and_each_part_has_its_own_diameter_and_lead_within_what_is_declared() {
        let shop = machine("tool_diameter = { um = 6 }\ntool_lead = { um_per_25_mm = 10 }");
        let (stated, mut seen) = (taps(&tools()), Vec::new());
        for part in 1..=50 {
            for ((number, real), (_, stated)) in
                taps(&real_tools(&shop, &tools(), 7, part)).iter().zip(&stated)
            {
                let wider = (real.oversize - stated.oversize).in_um();
                let rate = real.lead / stated.lead - 1.0;
                assert!(wider.abs() <= 6.0 && rate.abs() <= 4e-4, "{number}: {wider}, {rate}");
                seen.push((*number, wider.to_bits(), rate.to_bits()));
            }
        }
        let all = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), all, "no two are alike");
        let judged = taps(&judged_tools(&shop, &tools(), 7, 4));
        for ((_, judged), (_, stated)) in judged.iter().zip(&stated) {
            assert!(judged.lead == stated.lead && judged.oversize != stated.oversize);
        }
    }
}
