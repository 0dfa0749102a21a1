//! Ways on a surface that a linear axis and a turning one make together: round a cylinder (G7.1),
//! and on a face (G12.1).
//!
//! ```text
//!   G7.1 C20.   the cylinder of radius 20 is unrolled: C counts degrees, a length of π/180·20 mm each. Lines, arcs by R and
//!               G41, G42 lie in the plane of the unrolled length and the axis that C turns about. G7.1 C0 ends it.
//!
//!   G12.1       X (a diameter on lathes) and C (a length, a radius) are a flat's two axes, the axis of C its zero:
//!                    X = √(x² + y²)      C = atan2(y, x)            G13.1 ends it.
//! ```
//!
//! The block is executed in the flat: its place and its words are those of a plane, so that arcs
//! and compensation are the shared ones. What it says is then bent onto the machine's axes
//! ([`Bent`]). A line round the cylinder is one line of the axes. All else becomes lines so short
//! that they are nowhere farther than [`NEAR_MM`] from the curve, each as long in time as F says on
//! the surface.
//!
//! Source: Fanuc, operator's manual of series 30i, "Cylindrical interpolation", "Polar coordinate
//! interpolation".
use crate::{
    call::{Call, Place, Sink},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        state::{Fanuc, Form, Said, Surface},
        words::read::scaled,
    },
    geometry::frame::Point,
    modes::{FeedMode, Motion},
    state::executor::Executor,
};
use canon::Axis;
use diag::{Diagnostic, Span};

/// How far the axes may be beside an arc, or a line of a face, mm.
const NEAR_MM: f64 = 0.000_5;
/// Nearer to its axis C cannot follow a face, mm.
const TOO_NEAR_MM: f64 = 0.001;
/// Halvings of one line of a face.
const MOST_HALVINGS: u32 = 24;
const C: usize = 5;
pub(crate) const LETTERS: [u8; 9] = *b"XYZABCUVW";

impl Surface {
    fn new(form: Form, ex: &Executor) -> Self {
        let modes = &ex.modes;
        let mut new = Self {
            form,
            at: modes.at,
            tool: modes.at,
            axes: modes.at,
            rate: modes.feed,
            per_revolution: modes.feed_mode == FeedMode::PerRevolution,
            speed: modes.spindle.speed,
            in_mm: modes.units.in_mm(),
        };
        match form {
            Form::Cylinder { rotary, radius, place } => {
                new.at[6 + place] = modes.at[place];
                new.at[place] = modes.at[rotary].to_radians() * radius;
            }
            Form::Face => (new.at[1], new.at[C]) = (0.0, 0.0), // C stands at 0
        }
        new.tool = new.at;
        new
    }

    pub(crate) const fn name(&self) -> &'static str {
        match self.form {
            Form::Cylinder { .. } => "G7.1",
            Form::Face => "G12.1",
        }
    }

    /// Where the axes stand for a point of the flat, C as near as can be to where it was.
    pub(crate) fn on_axes(&self, flat: &Point) -> Point {
        let mut axes = *flat;
        match self.form {
            Form::Cylinder { rotary, radius, place } => {
                axes[rotary] = (flat[place] / radius).to_degrees();
                axes[place] = flat[6 + place];
                axes[6 + place] = self.axes[6 + place];
            }
            Form::Face => {
                axes[0] = flat[0].hypot(flat[1]);
                axes[1] = self.axes[1];
                let angle = flat[1].atan2(flat[0]).to_degrees();
                axes[C] = angle + ((self.axes[C] - angle) / 360.0).round() * 360.0;
            }
        }
        axes
    }

    /// Where an axis stands from which a word counts.
    pub(crate) fn stands(&self, axis: usize) -> f64 {
        match self.form {
            Form::Cylinder { place, .. } if place == axis => self.at[6 + place],
            Form::Cylinder { rotary, radius, place } if rotary == axis => {
                (self.at[place] / radius).to_degrees()
            }
            Form::Face if axis == C => self.at[1],
            _ => self.at[axis],
        }
    }

    /// Whether C counts lengths.
    pub(crate) fn is_face(&self) -> bool {
        self.form == Form::Face
    }
}

/// Who listens to a block that is executed in the flat.
pub(crate) struct Bent<'a, S> {
    pub(crate) sink: &'a mut S,
    pub(crate) surface: &'a mut Surface,
    pub(crate) found: &'a mut Vec<Diagnostic>,
}

impl<S: Sink> Bent<'_, S> {
    /// A straight way of the flat.
    fn line(&mut self, place: &Place, to: &Point) {
        let from = self.surface.tool;
        match self.surface.form {
            Form::Cylinder { .. } => self.move_to(place, to),
            Form::Face => {
                let nearest = nearest(&from, to) * self.surface.in_mm;
                if nearest < TOO_NEAR_MM {
                    let text = format!(
                        "this way passes the axis of C at {nearest:.4} mm, where C would have to turn at once: keep {TOO_NEAR_MM} mm away from it"
                    );
                    self.found.push(error("I1061", place.span, text));
                    return;
                }
                self.halve(place, to, MOST_HALVINGS);
            }
        }
    }

    /// Of a line on a face: halves until X and C, which move evenly together, stay near enough.
    fn halve(&mut self, place: &Place, to: &Point, left: u32) {
        let from = self.surface.tool;
        let middle: Point = core::array::from_fn(|i| f64::midpoint(from[i], to[i]));
        let [a, b] = [&from, to].map(|flat| self.surface.on_axes(flat));
        let turn = (b[C] - a[C]) - ((b[C] - a[C]) / 360.0).round() * 360.0;
        let (radius, angle) = (f64::midpoint(a[0], b[0]), (a[C] + turn / 2.0).to_radians());
        let beside = (radius * angle.cos() - middle[0]).hypot(radius * angle.sin() - middle[1]);
        if left > 0 && beside * self.surface.in_mm > NEAR_MM / 2.0 {
            self.halve(place, &middle, left - 1);
            self.halve(place, to, left - 1);
        } else {
            self.move_to(place, to);
        }
    }

    /// Lines along an arc of the flat, in the plane of the axes `a` and `b`.
    fn arc(&mut self, place: &Place, [a, b]: [usize; 2], to: &Point, centre: [f64; 2], turns: i32) {
        let from = self.surface.tool;
        let sweep = crate::geometry::offset_curve::sweep_rad(
            [from[a], from[b]],
            [to[a], to[b]],
            centre,
            turns,
        );
        let (x, y) = (from[a] - centre[0], from[b] - centre[1]);
        let (radius, first) = (x.hypot(y), y.atan2(x));
        let sagitta = (NEAR_MM / 2.0 / self.surface.in_mm / radius).min(1.0);
        let step = 2.0 * (1.0 - sagitta).acos();
        let count = (sweep.abs() / step).ceil().max(1.0) as u32;
        for i in 1..=count {
            let part = f64::from(i) / f64::from(count);
            let mut point: Point = core::array::from_fn(|k| from[k] + part * (to[k] - from[k]));
            if i < count {
                let (sin, cos) = (first + part * sweep).sin_cos();
                (point[a], point[b]) = (centre[0] + radius * cos, centre[1] + radius * sin);
            }
            self.line(place, &point);
        }
    }

    /// One line of the axes, in the time that F gives it on the surface.
    fn move_to(&mut self, place: &Place, to: &Point) {
        let surface = &mut *self.surface;
        let flat: &[usize] = match surface.form {
            Form::Cylinder { .. } => &[0, 1, 2, 6, 7, 8],
            Form::Face => &[0, 1, 2],
        };
        let square = |i: &usize| (to[*i] - surface.tool[*i]).powi(2);
        let length = flat.iter().map(square).sum::<f64>().sqrt();
        let speed = if surface.per_revolution { surface.speed } else { 1.0 };
        surface.tool = *to;
        surface.axes = surface.on_axes(to);
        if length == 0.0 {
            return;
        }
        let seconds = 60.0 * length / (surface.rate * speed);
        let (rate, axes) = (surface.rate, surface.axes);
        self.sink.call(place, &Call::FeedRate { rate, duration_s: Some(seconds) });
        self.sink.call(place, &Call::Line(axes));
    }
}

impl<S: Sink> Sink for Bent<'_, S> {
    fn suppress(&mut self, unknown: crate::Unknown) {
        self.sink.suppress(unknown);
    }

    fn take_time_passed(&mut self) -> bool {
        self.sink.take_time_passed()
    }

    fn missed(&self) -> crate::Unknown {
        self.sink.missed()
    }

    fn call(&mut self, place: &Place, call: &Call<'_>) {
        match call {
            Call::Line(to) => return self.line(place, to),
            Call::Arc { plane, to, centre, turns } => {
                let [a, b, _] = plane.axes().map(Axis::index);
                return self.arc(place, [a, b], to, *centre, *turns);
            }
            Call::FeedRate { rate, .. } => self.surface.rate = *rate,
            Call::FeedMode { per_revolution } => self.surface.per_revolution = *per_revolution,
            Call::SpindleSpeed(speed) => self.surface.speed = *speed,
            _ => {}
        }
        self.sink.call(place, call);
    }
}

/// How near a line comes to the zero of X and Y.
fn nearest(from: &Point, to: &Point) -> f64 {
    let (x, y) = (to[0] - from[0], to[1] - from[1]);
    let square = x * x + y * y;
    let part = if square > 0.0 { -(from[0] * x + from[1] * y) / square } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    (from[0] + part * x).hypot(from[1] + part * y)
}

/// Where an axis stands from which a word counts.
pub(crate) fn stands(fanuc: &Fanuc, ex: &Executor, axis: usize) -> f64 {
    fanuc.surface.map_or(ex.modes.at[axis], |surface| surface.stands(axis))
}

/// G7.1 C: its radius, or its end. The word is taken away.
pub(crate) fn unroll(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said]) -> Outcome {
    let span = ex.words.place.span;
    let word = said.iter().find(|said| b"ABC".contains(&said.letter));
    let Some(word) = word.filter(|_| said.len() == 2) else {
        let text = "G7.1 stands alone with a turning axis and the radius of its cylinder, G7.1 C20., or with 0, which ends it";
        return refuse("I1059", span, text);
    };
    ex.words.take(word.letter);
    let radius = scaled(fanuc, ex, &Said { letter: b'R', ..*word });
    let rotary = 3 + usize::from(word.letter - b'A');
    if radius == 0.0 {
        return leave_surface(fanuc, ex);
    }
    may_begin(fanuc, ex, "G7.1")?;
    has_axis(fanuc, rotary, span)?;
    let (along, planes) =
        [("X", "G17 or G18"), ("Y", "G17 or G19"), ("Z", "G18 or G19")][rotary - 3];
    let [a, b, _] = ex.modes.plane_axes();
    let place = match [a, b].iter().position(|axis| axis + 3 == rotary) {
        Some(0) => b,
        Some(_) => a,
        None => {
            let text = format!(
                "{} turns about {along}, which lies in no unrolled plane of this one: write {planes} before it",
                word.letter as char
            );
            return refuse("I1059", span, text);
        }
    };
    if radius < 0.0 {
        let text = format!("the cylinder's radius is above 0, found {radius}");
        return refuse("I1059", word.span, text);
    }
    fanuc.surface = Some(Surface::new(Form::Cylinder { rotary, radius, place }, ex));
    Ok(())
}

/// G12.1 (`on`) or G13.1.
pub(crate) fn face(fanuc: &mut Fanuc, ex: &mut Executor, said: &[Said], on: bool) -> Outcome {
    let span = ex.words.place.span;
    if !on {
        return leave_surface(fanuc, ex);
    }
    if said.len() != 1 {
        return refuse("I1059", span, "G12.1 stands alone in its block");
    }
    may_begin(fanuc, ex, "G12.1")?;
    has_axis(fanuc, C, span)?;
    let (x, c) = (ex.modes.at[0], ex.modes.at[C]);
    if c.abs() > 1e-6 || x * ex.modes.units.in_mm() < TOO_NEAR_MM {
        let (x, c) = (fanuc.shown(0, x), crate::codes::spelling::short(c));
        let text = format!(
            "G12.1 begins with C at 0 and X beside the axis of C, on its positive side; found X{x} C{c}"
        );
        let fault = error("I1059", span, text);
        return Err(fault.with_help("write G0 X50. C0 before it, or what X it shall be").into());
    }
    fanuc.surface = Some(Surface::new(Form::Face, ex));
    Ok(())
}

fn has_axis(fanuc: &Fanuc, rotary: usize, span: Span) -> Outcome {
    if rotary == C && fanuc.c_is_a_chamfer {
        let text = "the machine has no C axis, which this surface turns about";
        return refuse("I1059", span, text);
    }
    Ok(())
}

fn may_begin(fanuc: &Fanuc, ex: &Executor, name: &str) -> Outcome {
    let span = ex.words.place.span;
    let what = match &fanuc.surface {
        Some(surface) => surface.name(),
        None if ex.modes.compensating() => "G41 or G42",
        None if fanuc.mapping.changes() || fanuc.mapping.polar.is_some() => {
            "G16, G51, G51.1 or G68"
        }
        None if matches!(ex.modes.motion, Motion::Cycle(_)) => "a cycle",
        None if ex.modes.feed_mode == FeedMode::InverseTime => "G93",
        None if fanuc.lathe_cycle.is_some() => "a cycle",
        None => return Ok(()),
    };
    refuse("I1059", span, format!("{name} cannot begin while {what} is in force"))
}

fn leave_surface(fanuc: &mut Fanuc, ex: &mut Executor) -> Outcome {
    let Some(surface) = fanuc.surface else { return Ok(()) };
    if ex.modes.compensating() {
        let span = ex.words.place.span;
        let text = format!("{} cannot end while G41 or G42 is in force", surface.name());
        return Err(error("I1059", span, text).with_help("write G40 before it").into());
    }
    ex.modes.left_beside = None;
    fanuc.surface = None;
    Ok(())
}

/// The block's places in the flat.
pub(crate) fn words_on_surface(fanuc: &Fanuc, ex: &mut Executor) -> Outcome {
    let Some(surface) = &fanuc.surface else { return Ok(()) };
    match surface.form {
        Form::Cylinder { rotary, radius, place } => {
            // X of a lathe is a diameter, the axes beside it are none
            let factor = if place == 0 && ex.modes.diameter { 2.0 } else { 1.0 };
            rename(ex, LETTERS[place], LETTERS[6 + place], |value| value / factor)?;
            rename(ex, LETTERS[rotary], LETTERS[place], |degrees| {
                factor * degrees.to_radians() * radius
            })
        }
        Form::Face => rename(ex, b'C', b'Y', |value| value),
    }
}

/// A word by another letter.
fn rename(ex: &mut Executor, from: u8, to: u8, value: impl Fn(f64) -> f64) -> Outcome {
    let span = ex.words.span(from);
    match ex.words.take(from) {
        Some(word) => ex.words.put(to, value(word), span),
        None => Ok(()),
    }
}
