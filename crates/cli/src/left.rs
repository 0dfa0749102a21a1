//! What a program leaves behind: the numbered parameters and the tool table, in LinuxCNC's files.
//!
//! They are what the interpreter holds at the program's end: settings, work offsets (G10 L2, G92),
//! reference points, and the entries of tools that G10 L1, L10 or L11 has changed. Lengths are in
//! mm.
use crate::args::LeftArgs;
use control::Refused;
use control::job::Left;
use control::operation::kept_parameters;
use store::tools::{TableLine, to_tbl};

/// Write what was asked for.
pub(crate) fn write(args: &LeftArgs, left: &Left) -> Result<(), Refused> {
    if let Some(path) = &args.write_parameters {
        kept_parameters(&left.parameters).save(path)?;
    }
    if let Some(path) = &args.write_tools {
        let lines: Vec<_> = left.tools.iter().map(|(tool, entry)| line(tool, entry)).collect();
        store::output::write_file(path, to_tbl(&lines).as_bytes())?;
    }
    Ok(())
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
