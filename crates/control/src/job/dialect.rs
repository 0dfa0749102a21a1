//! How a program is read: by the command line, else by the machine's file; and what the machine has
//! set for cycles.
use store::machine::{self, BoringAside, Control, CycleDepth, MachineFile};

/// The dialect asked for, or the machine's own.
pub fn of(asked: Option<interp::Dialect>, machine: &MachineFile) -> interp::Dialect {
    let own = || interp::Dialect::named(machine.control.dialect);
    asked.or_else(own).unwrap_or_default()
}

/// The dialect of this name.
///
/// # Errors
/// With a sentence that has the names, if there is none.
pub fn named(name: &str) -> Result<interp::Dialect, String> {
    interp::Dialect::named(name).ok_or_else(|| {
        let names = interp::Dialect::ALL.map(interp::Dialect::name).join(", ");
        format!("there is no dialect {name}: there are {names}")
    })
}

/// Fanuc's increment system, as the machine's file has it.
pub fn increments(control: &Control) -> interp::Increments {
    match control.fanuc.map(|fanuc| fanuc.increments) {
        Some(machine::Increments::A) => interp::Increments::A,
        Some(machine::Increments::C) => interp::Increments::C,
        Some(machine::Increments::B) | None => interp::Increments::B,
    }
}

/// What programs may leave to the machine: asked for, or as its file has it.
pub fn leaves(asked: interp::Leaves, control: &Control) -> interp::Leaves {
    let programs = control.programs;
    interp::Leaves {
        unknown_codes: asked.unknown_codes || programs.ignores_unknown_codes,
        end: asked.end || programs.end_with_text,
        feed: asked.feed.or(programs.feed),
    }
}

/// The machine's own M codes.
pub fn user_codes(codes: &[machine::CodeEntry]) -> Vec<interp::MachineCode> {
    let code = |code: &machine::CodeEntry| interp::MachineCode {
        number: code.number,
        name: code.name.clone(),
        action: match code.action {
            machine::CodeEntryAction::None => interp::CodeAction::None,
            machine::CodeEntryAction::Output(number, on) => {
                interp::CodeAction::Output { number, on }
            }
            machine::CodeEntryAction::Wait(time) => interp::CodeAction::Wait(time),
        },
    };
    codes.iter().map(code).collect()
}

/// Words of the machine's own that call programs.
pub fn macro_calls(calls: &[machine::CallEntry]) -> Vec<interp::MacroCall> {
    let call = |call: &machine::CallEntry| interp::MacroCall {
        letter: call.letter,
        number: call.number,
        program: call.program,
        takes_arguments: call.takes_arguments,
    };
    calls.iter().map(call).collect()
}

/// What `[control.canned]` sets; where it is silent, the dialect decides.
pub fn cycles(dialect: interp::Dialect, control: &Control) -> interp::Cycles {
    interp::Cycles {
        depth_from: match control.cycle_depth {
            Some(CycleDepth::FromRPlane) => interp::DepthFrom::RPlane,
            Some(CycleDepth::FromInitialLevel) => interp::DepthFrom::InitialLevel,
            None => dialect.depth_from(),
        },
        chip_removal: control
            .chip_removal
            .map(|chips| interp::Chips { rpm: chips.spin.in_rpm(), every: chips.every }),
        aside: interp::Aside {
            second: matches!(control.boring_aside, Some(BoringAside::PlusY | BoringAside::MinusY)),
            back: matches!(control.boring_aside, Some(BoringAside::MinusX | BoringAside::MinusY)),
        },
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn machine_files_know_the_interpreters_dialects_by_their_names() {
        let mut known = interp::Dialect::ALL.map(interp::Dialect::name);
        let mut named = store::machine::DIALECTS;
        known.sort_unstable();
        named.sort_unstable();
        assert_eq!(named, known);
    }
}
