//! How coordinates are meant: G17 to G19, G7 and G8, G90 and G91, G98 and G99.

use crate::{
    call::{Call, Sink, out::Out},
    codes::GGroup,
    modes::Modes,
    words::Words,
};
use canon::Plane;
/// G17, G18, G19.
pub(crate) fn plane<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    if let Some(code) = words.g(GGroup::Plane) {
        modes.plane = match code {
            180 => Plane::ZX,
            190 => Plane::YZ,
            _ => Plane::XY,
        };
        out.say(&Call::SelectPlane(modes.plane));
    }
}

/// G7, G8.
pub(crate) fn diameter<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    let diameter = words.g(GGroup::Diameter).map(|code| code == 70);
    if let Some(diameter) = diameter.filter(|d| *d != modes.diameter) {
        set_diameter(modes, diameter, out);
    }
}

/// G90 G91, G90.1 G91.1, G98 G99.
pub(crate) fn distances<S: Sink>(words: &Words, modes: &mut Modes, out: &mut Out<'_, S>) {
    let incremental = words.g(GGroup::Distance).map_or(modes.incremental, |c| c == 910);
    let absolute_centres =
        words.g(GGroup::ArcDistance).map_or(modes.absolute_centres, |c| c == 901);
    let retract = words.g(GGroup::Retract);
    set_distances(modes, incremental, absolute_centres, out);
    if let Some(code) = retract {
        set_retract(modes, code == 980, out);
    }
}

/// Where they differ from what is in force.
pub(crate) fn set_distances<S: Sink>(
    modes: &mut Modes,
    incremental: bool,
    absolute_centres: bool,
    out: &mut Out<'_, S>,
) {
    if incremental != modes.incremental {
        modes.incremental = incremental;
        let note = if incremental {
            "distance mode changed to incremental"
        } else {
            "distance mode changed to absolute"
        };
        out.say(&Call::Note(note));
    }
    if absolute_centres != modes.absolute_centres {
        modes.absolute_centres = absolute_centres;
        let note = if absolute_centres {
            "IJK distance mode changed to absolute"
        } else {
            "IJK distance mode changed to incremental"
        };
        out.say(&Call::Note(note));
    }
}

/// G7 (true), G8.
pub(crate) fn set_diameter<S: Sink>(modes: &mut Modes, diameter: bool, out: &mut Out<'_, S>) {
    modes.diameter = diameter;
    let note = if diameter {
        "Lathe diameter mode changed to diameter"
    } else {
        "Lathe diameter mode changed to radius"
    };
    out.say(&Call::Note(note));
}

/// G98 (true), G99.
pub(crate) fn set_retract<S: Sink>(modes: &mut Modes, to_initial: bool, out: &mut Out<'_, S>) {
    modes.retract_to_initial = to_initial;
    let note = if to_initial { "retract mode set to old_z" } else { "retract mode set to r_plane" };
    out.say(&Call::Note(note));
}
