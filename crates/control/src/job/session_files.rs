//! The files that a session reads: a program's text, tools, inputs, parameters, the machine that is
//! simulated.
use crate::Refused;
use crate::config::machine_file::MachineSource;
use crate::job::program_files;
use canon::ToolLibrary;
use std::{
    io::Read,
    path::{Path, PathBuf},
};
use store::machine::MachineFile;
use store::tools::{TableUnit, ToolTable};

/// The table that is used when none is named and none lies beside the program.
const EMBEDDED_TOOLS: &str = include_str!("../../../../programs/tools.toml");
/// Tool tables looked for beside a program, in this order.
const TOOLS_BESIDE: [&str; 2] = ["tools.toml", "tool.tbl"];

/// Number of the parameter that holds X of the work offset G54.
pub(super) const G54: usize = 5221;
/// How far the numbers of one work offset are from those of the next.
const OFFSETS_APART: usize = 20;

/// The inserts of a table.
pub(super) fn inserts(tools: &ToolLibrary) -> ToolLibrary {
    let mut inserts = ToolLibrary::default();
    let kept = tools.iter().filter(|tool| matches!(tool.kind, canon::ToolKind::Insert(_)));
    kept.for_each(|tool| inserts.insert(tool.clone()));
    inserts
}

/// A program's bytes; `-` is standard input.
///
/// # Errors
/// A file that cannot be read, or is too large.
pub fn read_program(path: &Path) -> Result<Vec<u8>, Refused> {
    if path != Path::new("-") {
        let mut text = store::read_bytes(path, "a program in memory", store::PROGRAM_LIMIT)?;
        let path = path.display();
        program_files::not_foreign(&text)
            .map_err(|why| Refused::because(format!("{path} is no program: {why}")))?;
        gcode::end_lines_with_lf(&mut text);
        return Ok(text);
    }
    let mut text = Vec::new();
    let read = std::io::stdin().take(store::PROGRAM_LIMIT + 1).read_to_end(&mut text);
    read.map_err(|e| Refused::because(format!("cannot read standard input: {e}")))?;
    if text.len() as u64 > store::PROGRAM_LIMIT {
        let limit = store::PROGRAM_LIMIT;
        return Err(Refused::because(format!(
            "standard input is larger than the {limit} bytes that a program may have"
        )));
    }
    gcode::end_lines_with_lf(&mut text);
    Ok(text)
}

/// The tools, where they came from, their table if it is not the built-in one, and the bytes of it.
///
/// # Errors
/// A table that cannot be read.
pub fn tools(
    named: Option<&Path>,
    unit: TableUnit,
    program: &Path,
) -> Result<(ToolLibrary, String, Option<ToolTable>, Vec<u8>), Refused> {
    let beside = || -> Option<PathBuf> {
        let folder = program.parent()?;
        TOOLS_BESIDE.iter().map(|name| folder.join(name)).find(|path| path.is_file())
    };
    let is_stdin = program == Path::new("-");
    let found = named.map(Path::to_owned).or_else(|| if is_stdin { None } else { beside() });
    let Some(path) = found else {
        let table = store::tools::parse_toml(EMBEDDED_TOOLS, 0).map_err(|findings| {
            Refused::text("the embedded tools".into(), EMBEDDED_TOOLS, findings)
        })?;
        return Ok((table.library, "the embedded table".into(), None, EMBEDDED_TOOLS.into()));
    };
    let table = store::tools::load(&path, unit)?;
    let bytes = store::read_bytes(&path, "a tool table", store::SMALL_FILE_LIMIT)?;
    Ok((table.library.clone(), path.display().to_string(), Some(table), bytes))
}

/// Whether a file is one of subprograms, which ends without M2: it has the name of one that it
/// defines.
pub(super) fn is_subprogram(path: &Path, text: &[u8]) -> bool {
    let name = path.file_stem().map(|stem| stem.to_string_lossy().to_lowercase());
    name.is_some_and(|name| interp::defined_subprograms(text).contains(&name))
}

/// What a file says of inputs counts for more than what the machine's file says of them.
pub(super) fn load_inputs(path: &Path, machine: &mut MachineFile) -> Result<(), Refused> {
    let text = store::read_text(path, "a file of inputs", store::SMALL_FILE_LIMIT)?;
    let models = store::machine::parse_inputs(&text).map_err(|wrong| {
        let of_file = |why: &String| format!("{}: {why}", path.display());
        Refused::because(wrong.iter().map(of_file).collect::<Vec<_>>().join("\nerror: "))
    })?;
    let inputs = &mut machine.simulation.inputs;
    inputs.retain(|own| {
        models.iter().all(|model| (model.digital, model.number) != (own.digital, own.number))
    });
    inputs.extend(models);
    Ok(())
}

/// From a `.var` file, or from the machine's set-up.
pub(super) fn parameters(
    named: Option<&Path>,
    machine: &MachineFile,
) -> Result<interp::Parameters, Refused> {
    let mut parameters = interp::Parameters::default();
    if let Some(path) = named {
        for (number, value) in store::parameters::Parameters::load(path)?.iter() {
            if !parameters.set(number as usize, value) {
                let most = interp::MAX_PARAMETER;
                let path = path.display();
                return Err(Refused::because(format!(
                    "{path}: there is no parameter #{number}: they go from 1 to {most}"
                )));
            }
        }
        return Ok(parameters);
    }
    let setup = &machine.setup;
    let zeros = std::iter::once(Some(&setup.g54)).chain(setup.more.iter().map(Option::as_ref));
    for (at, zero) in zeros.enumerate() {
        let Some(zero) = zero else { continue };
        for axis in [canon::Axis::X, canon::Axis::Y, canon::Axis::Z] {
            let number = G54 + OFFSETS_APART * at + axis.index();
            parameters.set(number, zero.along(axis).value());
        }
    }
    Ok(parameters)
}

/// The machine that is simulated, where its control believes another one: what stands on its inputs
/// is the same.
pub(super) fn plant_of(
    source: &MachineSource,
    believed: &MachineFile,
) -> Result<MachineFile, Refused> {
    let mut plant = crate::config::machine_file::load(source)?;
    crate::config::machine_file::fits(&plant, believed)?;
    plant.simulation.inputs.clone_from(&believed.simulation.inputs);
    Ok(plant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_tools_are_in_order() {
        let table = store::tools::parse_toml(EMBEDDED_TOOLS, 0).unwrap();
        assert!(table.library.get(3).is_some());
    }

    #[test]
    fn every_embedded_machine_is_in_order() {
        for name in store::machine::EMBEDDED {
            assert!(crate::config::machine_file::load(name).is_ok(), "{name}");
        }
    }
}
