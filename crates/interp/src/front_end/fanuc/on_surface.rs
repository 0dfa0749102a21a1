//! A block while a surface is in force ([`surface`](crate::front_end::fanuc::mapping::surface)):
//! what it may say, and how it is executed.
use crate::{
    call::{Sink, out::Out},
    codes::number::tenths,
    execute::After,
    fault::{Outcome, error},
    front_end::fanuc::{
        mapping::surface::{Bent, LETTERS},
        obey::obey,
        state::{Fanuc, Form, Said, Surface, Then},
    },
    modes::Motion,
    program::Program,
    state::executor::Executor,
};
use canon::Plane;

/// Codes that lie on a surface, and those that end it, in tenths.
const ALLOWED: [u16; 15] = [10, 20, 30, 40, 71, 131, 400, 410, 420, 900, 910, 940, 950, 1070, 1130];

/// Only feeds, arcs, waits and compensation lie on a surface.
pub(crate) fn check_surface(fanuc: &Fanuc, ex: &Executor) -> Outcome {
    let Some(surface) = &fanuc.surface else { return Ok(()) };
    let code = |said: &Said| match said.letter {
        b'G' => fanuc.kind.common(tenths(said.value)?),
        _ => None,
    };
    let has = |codes: &[u16]| fanuc.said.iter().filter_map(code).any(|c| codes.contains(&c));
    let stray = fanuc.said.iter().find(|said| match said.letter {
        b'G' => !code(said).is_some_and(|code| ALLOWED.contains(&code)),
        b'T' | b'c' | b'r' => true,
        b'I' | b'J' | b'K' => !surface.is_face(),
        b'Y' | b'V' => surface.is_face(),
        _ => false,
    });
    let motion = ex.modes.motion;
    let along = matches!(motion, Motion::Feed | Motion::ArcClockwise | Motion::ArcCounterclockwise);
    let places = fanuc.said.iter().any(|said| b"XYZABCUVWH".contains(&said.letter));
    let rapid = places && !along && !has(&[10, 20, 30, 40, 71, 1070]);
    let (what, span) = match stray {
        Some(said) if said.letter == b'G' => (format!("G{}", said.value), said.span),
        Some(said) if said.letter.is_ascii_lowercase() => {
            (format!(",{}", said.letter.to_ascii_uppercase() as char), said.span)
        }
        Some(said) => ((said.letter as char).to_string(), said.span),
        None if rapid => ("a rapid move".to_owned(), ex.words.place.span),
        None => return Ok(()),
    };
    let text = format!("{what} cannot be used while {} is in force", surface.name());
    let (arcs, end) = match surface.form {
        Form::Cylinder { rotary, .. } => ("by R", format!("G7.1 {}0", LETTERS[rotary] as char)),
        Form::Face => ("by R or I and J", "G13.1".to_owned()),
    };
    let help = format!("it has G1, G2 and G3 {arcs}, G4, G40 to G42 and macros; {end} ends it");
    Err(error("I1060", span, text).with_help(help).into())
}

/// A block while a surface is in force: in the flat, and from there onto the axes.
pub(crate) fn on_surface<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    mut surface: Surface,
    out: &mut Out<'_, S>,
) -> Outcome<(Then, After)> {
    let plane = it.executor.modes.plane;
    it.executor.modes.at = surface.at;
    if surface.is_face() {
        it.executor.modes.plane = Plane::XY;
    }
    let mut found = Vec::new();
    let Out { sink, held, remarks, place } = out;
    let mut bent = Bent { sink: &mut **sink, surface: &mut surface, found: &mut found };
    let mut bent = Out { sink: &mut bent, held, remarks, place: *place };
    let result = obey(fanuc, it, &mut bent);
    surface.at = it.executor.modes.at;
    it.executor.modes.plane = plane;
    it.report_all(found);
    it.executor.modes.at = match fanuc.surface {
        None => surface.axes, // it has ended: where the tool is
        Some(_) => surface.on_axes(&surface.at),
    };
    fanuc.surface = fanuc.surface.map(|_| surface);
    result
}
