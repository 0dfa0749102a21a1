//! What a program leaves behind: the numbered parameters and the tool table, in LinuxCNC's files.
//!
//! They are what the interpreter holds at the program's end: settings, work offsets (G10 L2, G92), reference points,
//! and the entries of tools that G10 L1, L10 or L11 has changed. Lengths are in mm.
use crate::args::LeftArgs;
use control::Refused;
use control::job::Left;
use store::parameters::Parameters;
use store::tools::{TableLine, to_tbl};

/// The first parameter that outlives a subprogram's call.
const FIRST_KEPT: u32 = 31;

/// Write what was asked for.
pub(crate) fn write(args: &LeftArgs, left: &Left) -> Result<(), Refused> {
    if let Some(path) = &args.write_parameters {
        parameters(&left.parameters).save(path)?;
    }
    if let Some(path) = &args.write_tools {
        let lines: Vec<_> = left.tools.iter().map(|(tool, entry)| line(tool, entry)).collect();
        store::output::write_file(path, to_tbl(&lines).as_bytes())?;
    }
    Ok(())
}

/// Those that are not zero, and those that LinuxCNC wants to find in its file.
fn parameters(left: &interp::Parameters) -> Parameters {
    let mut kept = Parameters::default();
    let systems = (5221..=5381).step_by(20).flat_map(|first| first..first + 10);
    let wanted = (5161..=5169).chain(5181..=5189).chain(5210..=5220).chain(systems);
    let set = left.iter().map(|(number, _)| number as u32).filter(|number| *number >= FIRST_KEPT);
    for number in wanted.chain(set) {
        let value = left.get(number as usize).unwrap_or(0.0);
        let _ = kept.set(number, value); // its numbers are in order
    }
    kept
}

fn line(tool: &canon::Tool, entry: &interp::ToolEntry) -> TableLine {
    TableLine {
        number: tool.number,
        pocket: tool.pocket,
        offset: entry.offset,
        diameter_mm: entry.diameter,
        angles_deg: [entry.front_angle, entry.back_angle],
        orientation: entry.orientation,
        remark: match &tool.kind {
            canon::ToolKind::Tap(tap) if !tool.description.contains(&tap.designation) => {
                format!("{} tap, {}", tap.designation, tool.description)
            }
            _ => tool.description.clone(),
        },
    }
}
