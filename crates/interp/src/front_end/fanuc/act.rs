//! What a block's words do, once they are in the shared language: cycles of a lathe, all else as
//! everywhere.
use crate::{
    call::{Call, Corners, Sink, out::Out},
    coordinates::target,
    execute::{self, After},
    fault::Outcome,
    front_end::fanuc::{
        cycles::{
            self,
            lathe::{drill, drills, lathe_move},
        },
        reference::{self, at_reference, back_from_reference},
        state::Fanuc,
    },
    modes::Motion,
    state::executor::Executor,
};

/// A work offset beyond G59 that was never set: it lies at the machine's zero.
fn remark_on_unset(fanuc: &Fanuc, ex: &mut Executor, system: u8) {
    if ex.settings.stand_alone || ex.modes.frame.origin.iter().any(|value| *value != 0.0) {
        return;
    }
    let (code, _) = fanuc.kind.variant().more_offsets;
    let number = system.saturating_sub(9);
    let text = format!("{code} P{number} is not set: its zero is the machine's");
    let help = format!(
        "G10 L20 P{number} with X, Y and Z sets it in a program; --parameters FILE brings what the control keeps"
    );
    let span = ex.words.place.span;
    ex.remarks.push(diag::Diagnostic::warning("I1070", span, text).with_help(help));
}

/// What the block's words do.
pub(crate) fn move_block<S: Sink>(
    fanuc: &mut Fanuc,
    ex: &mut Executor,
    moves: bool,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    if let Some(system) = fanuc.once.system {
        crate::coordinates::offsets::change_system(
            &mut ex.modes,
            &mut ex.store,
            &ex.settings,
            system,
            out,
        );
        remark_on_unset(fanuc, ex, system);
    }
    if let Some(system) = fanuc.once.changed {
        crate::coordinates::offsets::offset_changed(
            &mut ex.modes,
            &mut ex.store,
            &ex.settings,
            system,
            out,
        );
    }
    if fanuc.once.stroke_check {
        out.say(&Call::StrokeCheck(fanuc.zone.in_force()));
    }
    let plain = !(fanuc.once.check || fanuc.once.skip);
    let cycle = fanuc.lathe_cycle.filter(|_| moves && plain);
    if moves {
        cycles::threading::angle(fanuc.thread_angle.take(), out);
    }
    if let Some(code) = ex.words.g(crate::codes::GGroup::ToolLength) {
        fanuc.length_mode = f64::from(code % crate::codes::OWN) / 10.0;
    }
    let (motion, corners) = (ex.modes.motion, ex.modes.corners);
    let exact = fanuc.once.exact && moves && corners != Corners::ExactStop;
    if exact {
        out.say(&Call::PathControl { corners: Corners::ExactStop, merge: None });
    }
    let checked = fanuc.once.check.then(|| reference::named(ex));
    let reference = matches!(ex.words.g(crate::codes::GGroup::NonModal), Some(280 | 300));
    let by = reference.then(|| target::destination(&ex.words, &ex.modes, false)).transpose()?;
    let by = by.map(|by| ex.modes.frame.to_machine(&by));
    let after = match cycle {
        _ if fanuc.once.back => back_from_reference(fanuc, ex, out)?,
        Some(code) => lathe_move(fanuc, ex, code, out)?,
        None if fanuc.is_lathe() && drills(ex) => drill(fanuc, ex, out)?,
        None => execute::execute(ex, out)?,
    };
    fanuc.by = by.or(fanuc.by);
    if exact {
        out.say(&Call::PathControl { corners, merge: Some(ex.modes.merge) });
    }
    if fanuc.once.skip {
        let at = ex.modes.at;
        ex.store.numbered.set_point(5061, &at);
    }
    if !plain {
        ex.modes.motion = motion;
    }
    if let Some(arc) = fanuc.once.straight {
        ex.modes.motion = arc;
    }
    if let Some(checked) = checked {
        at_reference(fanuc, ex, checked)?;
    }
    group_one(fanuc, &mut ex.modes.motion);
    Ok(after)
}

/// G80 ends a cycle, and the motion that was in force before it is in force again.
#[inline]
pub(crate) fn group_one(fanuc: &mut Fanuc, motion: &mut Motion) {
    match *motion {
        Motion::None if fanuc.lathe_cycle.is_none() => *motion = fanuc.before_cycle,
        Motion::None | Motion::Cycle(_) => {}
        other => fanuc.before_cycle = other,
    }
}
