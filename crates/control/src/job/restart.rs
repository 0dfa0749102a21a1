//! Beginning in the middle of a program: at a line, or at a hole.
//!
//! ```text
//!   ops   … Tap │ Rapid  Rapid  Tap  Rapid │ Rapid  Rapid  Tap …        asked for: somewhere in here
//!               ▲ snaps to here              ▲────────────────┘
//!   before it: lift, tool, spindle, coolant, path mode, over the place
//! ```
//!
//! The program is interpreted from its beginning, so every modal state is what it would be; only
//! what it orders is left out. It begins at a rapid, never within a cut or a synchronised cycle:
//! where the line or hole asked for lies within one, at the rapids that lead to it. A turned thread
//! is begun at its first pass, as it is judged whole.
use canon::{Axis, CamOrder, Op, OpKind, Position, SpindleOrder, Threading};
use diag::Span;
use units::{Angle, Coordinate, Lead, Length, Spin};

/// Where to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// At this line of the program.
    Line(u32),
    /// At this hole or thread, counted from 1 in the order in which they are cut.
    Hole(u32),
    /// Where this tool is used first.
    Tool(u32),
}

impl std::str::FromStr for From {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let kinds =
            [("hole", Self::Hole as fn(u32) -> Self), ("tool", Self::Tool), ("line", Self::Line)];
        let kind = kinds.iter().find_map(|(name, of)| Some((text.strip_prefix(name)?, *of)));
        let (number, of) = kind.unwrap_or((text, Self::Line));
        match number.trim().parse() {
            Ok(number) if number > 0 => Ok(of(number)),
            _ => Err("expected a line, as in \"27\", a hole, as in \"hole 5\", or a tool, as in \"tool 3\"".into()),
        }
    }
}

/// How a program is begun in its middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Operations that are left out.
    pub skip: usize,
    /// What is ordered instead.
    pub prelude: Vec<Op>,
    /// Line at which it begins.
    pub line: u32,
    /// Holes and threads that are left out.
    pub holes: u32,
    /// What else is left out: what it is, and its line.
    pub others: Vec<(&'static str, u32)>,
    /// The tool.
    pub tool: u32,
    /// The spindle.
    pub spin: Spin,
}

/// What is in force at some point of a program.
#[derive(Clone, Default)]
struct InForce {
    tool: u32,
    spindles: Vec<(u8, SpindleOrder, Span)>,
    coolant: Option<OpKind>,
    mode: Option<OpKind>,
    /// The cam that is selected, and what is to be done about it.
    cam: Vec<OpKind>,
    holes: u32,
    others: Vec<(&'static str, u32)>,
}

impl InForce {
    fn after(&mut self, op: &Op) {
        match &op.kind {
            OpKind::ChangeTool { number } => {
                self.tool = *number;
                self.spindles.clear(); // a change of tools stops them
            }
            OpKind::Spindle { spindle, order } => match order {
                SpindleOrder::Stop
                | SpindleOrder::Turn(_)
                | SpindleOrder::ConstantSurfaceSpeed { .. } => {
                    self.spindles.retain(|(which, ..)| which != spindle);
                    self.spindles.push((*spindle, *order, op.span));
                }
                SpindleOrder::Orient { .. } | SpindleOrder::ThrowChips(_) => {}
            },
            OpKind::Coolant { .. } => self.coolant = Some(op.kind.clone()),
            OpKind::PathMode(_) | OpKind::Overrides { .. } => self.mode = Some(op.kind.clone()),
            OpKind::Tap(_) | OpKind::Hole(_) => self.holes += 1,
            OpKind::Polygon(_) => self.others.push(("polygon", op.span.line)),
            OpKind::Hob(_) => self.others.push(("gear", op.span.line)),
            OpKind::Cam(CamOrder::Grind { .. }) => {
                self.others.push(("ground cam", op.span.line));
            }
            OpKind::Cam(CamOrder::Select { .. }) => self.cam = vec![op.kind.clone()],
            OpKind::Cam(CamOrder::Compensate) => self.cam.push(op.kind.clone()),
            OpKind::Cam(CamOrder::Deselect) => self.cam.clear(),
            _ => {}
        }
    }
}

/// A turned thread whose passes come one after the other.
struct Passes {
    /// Where its first one is begun.
    begin: (usize, Op, InForce),
    /// Where that goes from and to.
    ends: [Position; 2],
    lead: Lead,
    /// The operation before belongs to it.
    goes_on: bool,
}

impl Passes {
    /// Whether a pass is one of this thread: of its lead, and along the same way, less than a turn
    /// beside it.
    fn has(&self, from: &Position, order: &Threading) -> bool {
        let near = |a: &Position, b: &Position| {
            (a.along(order.axis) - b.along(order.axis)).abs().of_linear()
                < order.lead.abs() * Angle::rev(1.0)
        };
        let same = (self.lead - order.lead).abs() < Lead::mm_per_rev(1e-6);
        same && near(&self.ends[0], from) && near(&self.ends[1], &order.to)
    }
}

/// What may stand between the passes of a thread.
const fn is_between_passes(kind: &OpKind) -> bool {
    matches!(
        kind,
        OpKind::Rapid { .. }
            | OpKind::Dwell { .. }
            | OpKind::Spindle { .. }
            | OpKind::Coolant { .. }
            | OpKind::Overrides { .. }
            | OpKind::PathMode(_)
            | OpKind::Output(_)
            | OpKind::Message(_)
    )
}

/// Where a program's operations are begun for this wish, with Z lifted to `top` first and the
/// machine standing at `at`.
///
/// # Errors
/// A place that the program does not have, or where it cannot be begun.
pub fn find(ops: &[Op], from: From, at: &Position, top: Length) -> Result<Restart, String> {
    let mut in_force = InForce::default();
    // where the program may be begun: at a drilled hole, or at the first of a row of rapids
    let mut begin: Option<(usize, Op, InForce)> = None;
    let mut travels = false;
    let mut lines = 0;
    // moves of a drilled hole, and of a polygon, belong to it
    let mut hole = None;
    let mut in_polygon = false;
    let (mut here, mut passes) = (*at, None::<Passes>);
    for (index, op) in ops.iter().enumerate() {
        lines = lines.max(op.span.line);
        let is_drilled = matches!(op.kind, OpKind::Hole(_));
        in_polygon |= matches!(op.kind, OpKind::Polygon(_) | OpKind::Hob(_));
        in_polygon &= !matches!(op.kind, OpKind::PolygonEnd | OpKind::HobEnd);
        hole = if is_drilled { Some(op.span) } else { hole.filter(|span| *span == op.span) };
        let is_rapid = matches!(op.kind, OpKind::Rapid { .. }) && hole.is_none() && !in_polygon;
        if is_drilled || is_rapid && !travels {
            begin = Some((index, op.clone(), in_force.clone()));
        }
        travels = is_rapid;
        let is_feature = matches!(op.kind, OpKind::Tap(_) | OpKind::Hole(_));
        let cuts = matches!(
            op.kind,
            OpKind::Line { .. }
                | OpKind::Arc { .. }
                | OpKind::Spline { .. }
                | OpKind::Threading(_)
                | OpKind::Cam(CamOrder::Grind { .. } | CamOrder::SparkOut { .. })
        );
        let moves = is_rapid || is_feature || cuts;
        let found = match from {
            From::Hole(number) => is_feature && in_force.holes + 1 == number,
            From::Line(line) => moves && op.span.line >= line,
            From::Tool(number) => moves && in_force.tool == number,
        };
        if let OpKind::Threading(order) = &op.kind {
            // the stretches of a chain go on where the last one ended
            let is_next = passes.as_ref().is_some_and(|all| all.goes_on || all.has(&here, order));
            if !is_next {
                in_force.others.push(("turned thread", op.span.line));
            }
            passes = passes.filter(|_| is_next).or_else(|| {
                let (begin, ends) = (begin.clone()?, [here, order.to]);
                Some(Passes { begin, ends, lead: order.lead, goes_on: true })
            });
            begin = passes.as_ref().map(|all| all.begin.clone()).or(begin);
        }
        if let Some(all) = &mut passes {
            all.goes_on = matches!(op.kind, OpKind::Threading(_));
        }
        passes = passes.filter(|all| all.goes_on || is_between_passes(&op.kind));
        here = end_of(&op.kind).unwrap_or(here);
        let leads_to_a_pass = passes.as_ref().is_some_and(|all| leads_to(all, here, &ops[index..]));
        if is_rapid
            && found
            && !leads_to_a_pass
            && let From::Line(_) = from
        {
            // the line begins here, whatever rapid led to the place before
            begin = Some((index, op.clone(), in_force.clone()));
        } else if leads_to_a_pass && found {
            begin = passes.as_ref().map(|all| all.begin.clone()).or(begin);
        }
        if found {
            let (skip, op, in_force) = begin.ok_or_else(|| {
                format!(
                    "line {} cuts before anything has been approached: begin at its start",
                    op.span.line
                )
            })?;
            return Ok(restart(skip, &op, &in_force, at, top));
        }
        in_force.after(op);
    }
    Err(match from {
        From::Hole(number) => {
            format!("there is no hole {number}: the program makes {}", in_force.holes)
        }
        From::Tool(number) => format!("the program does not use tool {number}"),
        From::Line(line) => {
            format!("nothing moves at line {line} or after it: the last line is {lines}")
        }
    })
}

/// Where a move ends.
const fn end_of(kind: &OpKind) -> Option<Position> {
    match kind {
        OpKind::Rapid { to }
        | OpKind::Line { to, .. }
        | OpKind::Arc { to, .. }
        | OpKind::Spline { to, .. } => Some(*to),
        OpKind::Threading(order) => Some(order.to),
        _ => None,
    }
}

/// Whether the next pass after these operations is one of a thread.
fn leads_to(passes: &Passes, here: Position, ops: &[Op]) -> bool {
    let mut at = here;
    for op in ops {
        match &op.kind {
            OpKind::Threading(order) => return passes.has(&at, order),
            kind if is_between_passes(kind) => at = end_of(kind).unwrap_or(at),
            _ => return false,
        }
    }
    false
}

fn restart(skip: usize, first: &Op, in_force: &InForce, at: &Position, top: Length) -> Restart {
    let span = first.span;
    let over = match &first.kind {
        OpKind::Rapid { to } => to.with(Axis::Z, Coordinate::linear(top)),
        OpKind::Hole(hole) => hole.at.with(Axis::Z, Coordinate::linear(top)),
        _ => at.with(Axis::Z, Coordinate::linear(top)),
    };
    let mut prelude = vec![
        OpKind::Rapid { to: at.with(Axis::Z, Coordinate::linear(top)) },
        OpKind::ChangeTool { number: in_force.tool },
    ];
    prelude.extend(in_force.mode.clone());
    let orders = in_force.spindles.iter();
    prelude.extend(
        orders.map(|(spindle, order, _)| OpKind::Spindle { spindle: *spindle, order: *order }),
    );
    prelude.extend(in_force.coolant.clone());
    prelude.push(OpKind::Rapid { to: over });
    prelude.extend(in_force.cam.clone());
    let spin = in_force.spindles.iter().find_map(|(spindle, order, _)| match order {
        SpindleOrder::Turn(spin) if *spindle == 0 => Some(*spin),
        _ => None,
    });
    Restart {
        skip,
        prelude: prelude.into_iter().map(|kind| Op { span, kind }).collect(),
        line: span.line,
        holes: in_force.holes,
        others: in_force.others.clone(),
        tool: in_force.tool,
        spin: spin.unwrap_or(Spin::ZERO),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGRAM: &str = "\
G21 G90 G54 G17
T2 M6
S2000 M3
G0 X0 Y0
G43 H2 Z20
G99 G81 X10 Y10 Z-20 R5 F200
X20
G80
T3 M6
S1000 M3
M8
G0 X10 Y10
G43 H3 Z20
G99 G84 X10 Y10 Z-15 R5 F1000
X20
G80
G0 Z50
M2
";

    fn at(from: From) -> Result<Restart, String> {
        let tools =
            store::tools::parse_toml(include_str!("../../../../programs/tools.toml"), 0).unwrap();
        let setup = interp::Setup { tools: tools.library, ..interp::Setup::default() };
        let ops: Vec<Op> = interp::Ops::new(PROGRAM.as_bytes(), &setup).collect();
        find(&ops, from, &Position::default(), Length::mm(300.0))
    }

    fn tool_and_line(from: From) -> (u32, u32, u32) {
        let restart = at(from).unwrap();
        (restart.tool, restart.line, restart.holes)
    }

    #[test]
    fn a_hole_is_begun_at_the_rapids_that_lead_to_it() {
        assert_eq!(tool_and_line(From::Hole(1)), (2, 6, 0));
        assert_eq!(tool_and_line(From::Hole(2)), (2, 7, 1));
        assert_eq!(tool_and_line(From::Hole(4)), (3, 15, 3));
    }

    #[test]
    fn a_tool_is_begun_where_it_is_used_first() {
        assert_eq!(tool_and_line(From::Tool(3)), (3, 12, 2));
        assert_eq!(at(From::Tool(9)).unwrap_err(), "the program does not use tool 9");
    }

    #[test]
    fn a_line_within_a_cycle_is_begun_at_the_cycle() {
        assert_eq!(tool_and_line(From::Line(15)), (3, 15, 3));
        assert_eq!(tool_and_line(From::Line(7)), (2, 7, 1));
    }

    #[test]
    fn tool_spindle_and_coolant_are_what_they_would_be() {
        let restart = at(From::Hole(4)).unwrap();
        let kinds: Vec<_> = restart.prelude.into_iter().map(|op| op.kind).collect();
        assert!(kinds.contains(&OpKind::ChangeTool { number: 3 }), "{kinds:?}");
        let turns = SpindleOrder::Turn(Spin::rpm(1000.0));
        assert!(kinds.contains(&OpKind::Spindle { spindle: 0, order: turns }), "{kinds:?}");
        assert!(kinds.contains(&OpKind::Coolant { mist: false, flood: true }), "{kinds:?}");
        let [OpKind::Rapid { to: lifted }, .., OpKind::Rapid { to: over }] = &kinds[..] else {
            panic!("it neither lifts nor approaches: {kinds:?}")
        };
        assert_eq!([lifted.linear[2], over.linear[2]], [Length::mm(300.0); 2]);
    }

    #[test]
    fn a_cam_that_is_ground_again_is_selected_first() {
        let select = OpKind::Cam(CamOrder::Select {
            profile: 7,
            phase: units::Angle::ZERO,
            centre: Length::ZERO,
            zero: Length::ZERO,
        });
        let compensate = OpKind::Cam(CamOrder::Compensate);
        let grind = OpKind::Cam(CamOrder::Grind {
            stock: Length::mm(0.1),
            per_turn: Length::mm(0.1),
            rate: units::Lead::mm_per_rev(0.1),
            spin: Spin::rpm(60.0),
        });
        let rapid = |z| OpKind::Rapid { to: Position::xyz(248.0, 0.0, z) };
        let kinds =
            [rapid(-20.0), select.clone(), compensate.clone(), grind.clone(), rapid(-100.0), grind];
        let op = |(line, kind)| Op { span: Span { line, ..Span::default() }, kind };
        let ops: Vec<Op> = (1..).zip(kinds).map(op).collect();
        let top = Length::mm(0.0);
        let second = find(&ops, From::Line(6), &Position::default(), top).unwrap();
        assert_eq!((second.line, second.skip), (5, 4));
        let end: Vec<_> = second.prelude.into_iter().map(|op| op.kind).rev().take(2).collect();
        assert_eq!(end, [compensate, select]);
        // the first one is begun before it is selected
        let first = find(&ops, From::Line(4), &Position::default(), top).unwrap();
        assert_eq!((first.line, first.skip), (1, 0));
        assert!(!first.prelude.iter().any(|op| matches!(op.kind, OpKind::Cam(_))));
    }

    #[test]
    fn a_turned_thread_is_begun_at_its_first_pass_and_the_next_thread_at_its_own() {
        let rapid = |x, z| OpKind::Rapid { to: Position::xyz(x, 0.0, z) };
        let pass = |x, z| {
            OpKind::Threading(Threading {
                to: Position::xyz(x, 0.0, z),
                lead: Lead::mm_per_rev(1.5),
                growth: units::LeadGrowth::ZERO,
                start_angle: Angle::ZERO,
                axis: Axis::Z,
                surface: Length::ZERO,
            })
        };
        let thread = |z: f64| {
            let one = move |x: f64| [rapid(x, z + 6.0), pass(x, z - 20.0), rapid(12.0, z - 20.0)];
            [9.8, 9.5, 9.2].into_iter().flat_map(one)
        };
        let kinds = thread(0.0).chain(thread(-40.0));
        let op = |(line, kind)| Op { span: Span { line, ..Span::default() }, kind };
        let ops: Vec<Op> = (1..).zip(kinds).map(op).collect();
        let begun = |line| {
            let top = Length::mm(50.0);
            find(&ops, From::Line(line), &Position::default(), top).unwrap().line
        };
        assert_eq!([1, 2, 5, 7, 8].map(begun), [1; 5]);
        assert_eq!([11, 14, 17].map(begun), [9; 3]);
    }

    #[test]
    fn what_is_not_there_is_answered_with_what_is() {
        assert_eq!(at(From::Hole(5)).unwrap_err(), "there is no hole 5: the program makes 4");
        let beyond = at(From::Line(40)).unwrap_err();
        assert!(beyond.starts_with("nothing moves at line 40"), "{beyond}");
    }

    #[test]
    fn lines_and_holes_are_told_apart() {
        assert_eq!("27".parse(), Ok(From::Line(27)));
        assert_eq!("hole 5".parse(), Ok(From::Hole(5)));
        assert_eq!("line 3".parse(), Ok(From::Line(3)));
        assert_eq!("tool 3".parse(), Ok(From::Tool(3)));
        assert!("0".parse::<From>().is_err() && "hole".parse::<From>().is_err());
    }
}
