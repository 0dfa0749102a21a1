//! Corners that are written into a block: `,C` cuts one off, `,R` rounds one.
//!
//! ```text
//!   G1 X40. ,R5.      from ──────●         ● t from the corner: R / tan(φ/2), φ between the two ways;
//!   Y30.                          ╲ R        of a chamfer, C along both
//!                                  ●
//!                                  │ next
//! ```
//!
//! The corner lies between two straight feeds of the plane. A lathe's G1 needs no comma before R,
//! and none before C if the machine has no C axis; I and K of its G1 are chamfers too.
//!
//! Source: Fanuc, operator's manual of series 30i, "Optional chamfering and corner R", "Chamfering
//! and corner R".
use crate::{
    call::{Sink, out::Out},
    coordinates::target,
    cycles::record,
    execute::After,
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        act::move_block,
        state::{Corner, Fanuc, Once},
        words::{read::read_words, sense, translate},
    },
    geometry::{
        frame::Point,
        offset_curve::{Flat, length, minus},
    },
    modes::Motion,
    program::Program,
    state::executor::Executor,
};
use diag::Span;
use gcode::{Block, Grammar, Parser};

/// A block with a corner at its end.
pub(crate) fn cornered<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    corner: Corner,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    let ex = &it.executor;
    let code = ex.words.g(crate::codes::GGroup::Motion);
    let motion = code.map_or(sense::in_force(ex), Motion::from_code);
    if motion != Motion::Feed {
        let text = "a corner follows a straight feed: G1";
        return refuse("I1054", corner.span, text);
    }
    let (from, to) = (ex.modes.at, target::destination(&ex.words, &ex.modes, false)?);
    let next = ahead(fanuc, it, &to, corner.span)?;
    let [a, b, _] = it.executor.modes.plane_axes();
    let flat = |point: &Point| [point[a], point[b]];
    let taken = core::mem::take(&mut fanuc.taken);
    let Some(cut) = corner.cut(flat(&from), flat(&to), flat(&next), taken)? else {
        return move_or_record(fanuc, it, out);
    };
    put(&mut it.executor, [a, b], cut.first)?;
    let after = move_or_record(fanuc, it, out)?;
    it.executor.words.begin(&it.block);
    let code = match (corner.round, cut.left) {
        (false, _) => 1.0,
        (true, true) => 3.0,
        (true, false) => 2.0,
    };
    it.executor.words.take_g(code, corner.span)?;
    put(&mut it.executor, [a, b], cut.last)?;
    if corner.round {
        it.executor.words.put(b'R', corner.size, corner.span)?;
    }
    move_or_record(fanuc, it, out)?;
    // what follows counts from the corner; the way from here leads along the same line
    it.executor.modes.at = to;
    it.executor.modes.motion = Motion::Feed;
    if let Some(recording) = &mut it.executor.recording {
        recording.go_on_with(Motion::Feed);
    }
    fanuc.taken = cut.taken;
    Ok(after)
}

fn move_or_record<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    out: &mut Out<'_, S>,
) -> Outcome<After> {
    if it.executor.recording.is_some() {
        return record::record(&mut it.executor, out).map(|()| After::Next);
    }
    move_block(fanuc, &mut it.executor, true, out)
}

/// Where the straight feed that follows leads.
fn ahead(fanuc: &mut Fanuc, it: &mut Program<'_>, corner: &Point, span: Span) -> Outcome<Point> {
    let source = it.sources[it.file];
    let mut parser = Parser::with_grammar(source, it.file as u16, Grammar::Fanuc);
    let (byte, line) = it.parsers[it.file].position();
    parser.seek(byte, line);
    let mut block = Block::new();
    while parser.next(&mut block) {
        it.ahead = block.span.end;
        let skipped = block.delete.is_some_and(|level| fanuc.skip_levels >> level & 1 == 1);
        if skipped || block.is_blank() {
            continue;
        }
        if block.faulty || block.words.is_empty() || !block.assignments.is_empty() {
            break;
        }
        let mut ahead = fanuc.without_tape();
        let mut ex = it.executor.clone();
        ex.modes.at = *corner;
        ex.modes.motion = Motion::Feed;
        ex.recording = None;
        let distance = it.executor.words.g(crate::codes::GGroup::Distance);
        ex.modes.incremental = distance.map_or(ex.modes.incremental, |code| code == 910);
        read_words(&mut ahead, &block, source, &ex)?;
        ex.words.begin(&block);
        ahead.once = Once::default();
        translate(&mut ahead, &mut ex)?;
        let code = ex.words.g(crate::codes::GGroup::Motion);
        let motion = code.map_or(ex.modes.motion, Motion::from_code);
        if motion != Motion::Feed || !ex.words.any(crate::codes::AXES) {
            break;
        }
        return target::destination(&ex.words, &ex.modes, false);
    }
    let fault = error(
        "I1054",
        span,
        "a corner lies between two straight feeds: the next block is no G1 with X, Y or Z",
    );
    Err(fault.with_help("write the corner's own G1, G2 or G3 between other moves").into())
}

/// Where a corner begins and ends.
struct CornerCut {
    first: Flat,
    last: Flat,
    /// It turns to the left.
    left: bool,
    /// How much of the next way it takes.
    taken: f64,
}

impl Corner {
    /// Nothing where the ways lie in one line.
    fn cut(&self, from: Flat, to: Flat, next: Flat, before: f64) -> Outcome<Option<CornerCut>> {
        let (back, on) = (minus(from, to), minus(next, to));
        let (long, far) = (length(back) - before, length(on));
        let cross = back[1] * on[0] - back[0] * on[1];
        let dot = back[0] * on[0] + back[1] * on[1];
        if cross.abs() <= 1e-12 * (length(back) * far).max(1e-12) {
            if dot > 0.0 || far == 0.0 || length(back) == 0.0 {
                let text = "there is no corner here: one of its two ways goes back along the other, or nowhere";
                return refuse("I1054", self.span, text);
            }
            return Ok(None);
        }
        // tan(φ/2) of the angle between the ways
        let half = (cross.abs()).atan2(dot) / 2.0;
        let takes = if self.round { self.size / half.tan() } else { self.size };
        let room = long.min(far);
        if takes > room * (1.0 + 1e-9) {
            let most = if self.round { room * half.tan() } else { room };
            let letter = if self.round { 'R' } else { 'C' };
            let text = format!(
                "{letter}{} does not fit into this corner: its ways leave room for {letter}{most:.3}",
                self.size
            );
            return refuse("I1054", self.span, text);
        }
        let along = |way: Flat| {
            let part = takes / length(way);
            [to[0] + part * way[0], to[1] + part * way[1]]
        };
        Ok(Some(CornerCut { first: along(back), last: along(on), left: cross > 0.0, taken: takes }))
    }
}

/// Two axis words for a place.
fn put(ex: &mut Executor, axes: [usize; 2], place: Flat) -> Outcome {
    for (axis, value) in axes.into_iter().zip(place) {
        let letter = b"XYZ"[axis];
        let value = if ex.modes.incremental { value - ex.modes.at[axis] } else { value };
        let value = if axis == 0 && ex.modes.diameter { 2.0 * value } else { value };
        let span = ex.words.span(letter);
        ex.words.take(letter);
        ex.words.put(letter, value, span)?;
    }
    Ok(())
}
