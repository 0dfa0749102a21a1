//! Where a program begins: what is in force, and what is said of it.
use crate::{
    call::{
        Call, Sink,
        out::{Held, Out},
    },
    coordinates::offsets,
    modes::{Modes, Motion},
    setup::Setup,
    state::{
        executor::{Context, Executor, Settings},
        tools::{ToolTable, Tools},
    },
    words::{OwnCodes, Words, names::Store},
};
use std::collections::BTreeSet;

/// Where a program begins.
pub(crate) fn new(setup: &Setup) -> Executor {
    let mut new = Executor {
        modes: Modes::new(),
        store: Store::new(setup.parameters.clone()),
        words: Words::new(setup.dialect.rules(), OwnCodes::of(setup)),
        tools: Tools {
            library: setup.tools.clone(),
            missing: setup.missing_tools,
            are_examples: setup.has_example_tools,
            wear: setup.wear_offsets.clone(),
            reported: BTreeSet::default(),
            written: ToolTable::default(),
        },
        contexts: vec![Context::default()],
        held: Held::default(),
        settings: Settings {
            rules: setup.dialect.rules(),
            stand_alone: setup.stand_alone,
            fastest_rpm: setup.fastest_spindle.map_or(f64::INFINITY, units::Spin::in_rpm),
            user_codes: setup.user_codes.clone(),
            macro_calls: setup.macro_calls.clone(),
            leaves: setup.leaves,
            cycles: setup.cycles,
        },
        recording: None,
        idle_told: 0,
        lack_told: 0,
        codes_told: BTreeSet::new(),
        remarks: Vec::new(),
    };
    // where none was called yet LinuxCNC's stand-alone interpreter believes in the first pocket
    new.modes.current_pocket = u32::from(setup.stand_alone);
    new.modes.retract_to_initial = new.settings.rules.starts_at_initial_level;
    offsets::load_offsets(&mut new.modes, &mut new.store, &new.settings);
    if new.settings.rules.begins_rapidly {
        new.modes.motion = Motion::Rapid;
    }
    let machine = crate::geometry::frame::machine_point(&setup.start);
    new.modes.at = new.modes.frame.to_program(&machine);
    new
}

/// What is said before the first block.
pub(crate) fn begin<S: Sink>(modes: &Modes, out: &mut Out<'_, S>) {
    let frame = &modes.frame;
    out.say(&Call::UseUnits(modes.units));
    out.say(&Call::WorkOffset(modes.system, frame.origin));
    out.say(&Call::AddedOffset(frame.added));
    out.say(&Call::Rotation(frame.rotation()));
    out.say(&Call::FeedReference);
    out.say(&Call::Reset);
}
