//! A lathe made up for tests: what a program orders, and the motion that carries it out exactly.
use bus::{Sample, Truth};
use canon::{
    Axis, Feed, Insert, InsertOrientation, InsertPoint, Op, OpKind, PolygonCutter, Position, Ratio,
    Span, Threading, Tool, ToolKind, ToolLibrary,
};
use units::{Angle, Coordinate, Lead, LeadGrowth, Length, Time};
use verify::{Bar, Config, Feature, FeatureKind, Judge, Stock, Verdict};

const TOOL_LENGTH: f64 = 60.0;
/// Samples of a turn.
const SAMPLES: f64 = 30.0;

pub const TURN: u32 = 33;
pub const FULL: u32 = 32;
pub const PARTIAL: u32 = 31;
pub const GROOVE: u32 = 35;
/// 35° between the edges, square to the axis.
pub const NEUTRAL: u32 = 36;
/// Points to the free end.
pub const BACK: u32 = 37;
pub const BORE: u32 = 38;
pub const DRILL_8: u32 = 40;
pub const DRILL_19: u32 = 41;
/// Three inserts, 50 mm from its axis.
pub const CUTTER: u32 = 21;

fn tool(number: u32, kind: ToolKind, diameter: f64) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::mm(TOOL_LENGTH),
        diameter: Length::mm(diameter),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

fn tools() -> ToolLibrary {
    let v = |nose: f64, crest: Option<f64>| {
        let point = Some(InsertPoint::Nose(Length::mm(nose)));
        Insert::threading(Angle::deg(60.0), point, crest.map(Length::mm))
    };
    let turning = |degrees: f64| Insert::turning(Angle::deg(degrees), Length::mm(0.4));
    let stands = |number: u8, insert: Insert| Insert {
        orientation: InsertOrientation::new(number),
        ..insert
    };
    let approach = canon::InsertEdges::Corner { approach: Angle::deg(72.5), length: Insert::EDGE };
    let drill = ToolKind::Drill { point_angle: Angle::deg(118.0) };
    let inserts = [
        (PARTIAL, v(0.2, None)),
        (FULL, v(0.2, Some(0.92))),
        (TURN, turning(80.0)),
        (GROOVE, Insert::grooving(Length::mm(3.0))),
        (NEUTRAL, Insert { edges: approach, ..stands(8, turning(35.0)) }),
        (BACK, stands(4, turning(80.0))),
        (BORE, stands(2, turning(80.0))),
    ];
    let mut tools: Vec<Tool> =
        inserts.into_iter().map(|(n, i)| tool(n, ToolKind::Insert(i), 0.0)).collect();
    tools.push(tool(DRILL_8, drill.clone(), 8.0));
    tools.push(tool(DRILL_19, drill, 19.0));
    let cutter = PolygonCutter {
        radius: Length::mm(50.0),
        inserts: [0.0, 1.0 / 3.0, 2.0 / 3.0].map(Angle::rev).to_vec(),
        nose_radius: Length::mm(0.8),
    };
    tools.push(tool(CUTTER, ToolKind::PolygonCutter(cutter), 100.0));
    ToolLibrary::new(tools)
}

/// A program under way on a bar.
pub struct Lathe {
    judge: Judge,
    op: u32,
    line: u32,
    time: f64,
    turn: f64,
    /// +1: M3, −1: M4.
    sense: f64,
    tool: u32,
    at: [f64; 2],
}

/// A bar of 20 mm from Z0 to Z−60, with a bore of this radius.
fn config(bore: f64) -> Config {
    let [radius, bore, face, rear] = [10.0, bore, 0.0, -60.0].map(Length::mm);
    let bar = Some(Bar { radius, bore, face, rear });
    let mm = |v: [f64; 3]| v.map(Length::mm);
    let (from, to) = (mm([-10.0, -10.0, -60.0]), mm([10.0, 10.0, 0.0]));
    let stock = Some(Stock { from, to, zero: mm([0.0; 3]) });
    Config { bar, stock, stock_radius: Some(radius), ..Config::new(tools()) }
}

fn place([x, z]: [f64; 2]) -> Position {
    let linear = [x, 0.0, z + TOOL_LENGTH].map(Length::mm);
    Position { linear, ..Position::default() }
}

impl Lathe {
    pub fn new() -> Self {
        Self::of(Judge::new(config(0.0)))
    }

    pub fn bored(radius: f64) -> Self {
        Self::of(Judge::new(config(radius)))
    }

    fn of(judge: Judge) -> Self {
        let (at, tool) = ([30.0, 50.0], FULL);
        Self { judge, op: 0, line: 0, time: 0.0, turn: 0.0, sense: 1.0, tool, at }
    }

    /// What a control does that counts features by program: it has taken those so far, and gets
    /// told what happens to them.
    pub fn counted(mut self) -> (Self, Vec<Feature>) {
        self.order(OpKind::Dwell { time: Time::s(0.1) });
        self.see(self.at, self.turn);
        self.judge.settle(self.op);
        let features = self.judge.take_features();
        (self, features)
    }

    /// Lines that have destroyed features which were taken, and how.
    pub fn undone(mut self) -> Vec<(u32, String)> {
        self.order(OpKind::Dwell { time: Time::s(0.1) });
        self.see(self.at, self.turn);
        self.judge.settle(self.op);
        self.judge.take_undone().into_iter().map(|undone| (undone.line, undone.how)).collect()
    }

    /// The next program on the same work.
    pub fn next_program(self) -> Self {
        Self::of(Judge::new(config(0.0)).on(self.judge.into_work()))
    }

    pub fn with(mut self, tool: u32) -> Self {
        self.order(OpKind::ChangeTool { number: tool });
        self.tool = tool;
        self
    }

    pub fn backwards(mut self) -> Self {
        self.sense = -1.0;
        self
    }

    /// A block of the program.
    pub fn line(mut self, line: u32) -> Self {
        self.line = line;
        self
    }

    fn order(&mut self, kind: OpKind) {
        let span = Span { line: self.line, ..Span::default() };
        self.judge.op(self.op, &Op { span, kind });
        self.op += 1;
    }

    fn see(&mut self, at: [f64; 2], turn: f64) {
        self.see_geared(at, turn, 0.0);
    }

    fn see_geared(&mut self, [x, z]: [f64; 2], turn: f64, cutter: f64) {
        let mut sample = Sample::default();
        (sample.report.op, sample.report.line) = (self.op - 1, self.line);
        sample.feedback.time = Time::s(self.time);
        sample.feedback.tool = Some(self.tool);
        let mut truth = Truth::default();
        truth.axes[0] = Coordinate::new(x);
        truth.axes[2] = Coordinate::new(z + TOOL_LENGTH);
        truth.spindles = [self.sense * turn, cutter].map(Angle::rev);
        sample.truth = Some(truth);
        self.judge.sample(&sample);
        (self.at, self.turn) = ([x, z], turn);
        self.time += 250e-6;
    }

    fn go(&mut self, to: [f64; 2], turns: f64) {
        let (from, began) = (self.at, self.turn);
        let count = (turns * SAMPLES).ceil().max(4.0);
        for k in 1..=count as u32 {
            let share = f64::from(k) / count;
            let at = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            self.see(at, began + share * turns);
        }
        self.at = to;
    }

    pub fn rapid(mut self, x: f64, z: f64) -> Self {
        self.order(OpKind::Rapid { to: place([x, z]) });
        let way = (x - self.at[0]).hypot(z - self.at[1]);
        self.go([x, z], way / 5.0); // 5 m/min at 1000 rpm
        self
    }

    /// Fed 0.1 mm a turn; in the air faster.
    pub fn feed(mut self, x: f64, z: f64) -> Self {
        self.order(OpKind::Line {
            to: place([x, z]),
            feed: Feed::PerRevolution(Lead::mm_per_rev(0.1)),
        });
        let way = (x - self.at[0]).hypot(z - self.at[1]);
        self.go([x, z], way / 0.1);
        self
    }

    /// Along a path of X and Z.
    pub fn feeds(self, places: &[[f64; 2]]) -> Self {
        places.iter().fold(self, |lathe, [x, z]| lathe.feed(*x, *z))
    }

    /// One threading block, with the spindle at `start` turns where it begins.
    pub fn stretch(mut self, to: [f64; 2], lead: f64, start: f64, axis: Axis) -> Self {
        self.order(OpKind::Threading(Threading {
            to: place(to),
            lead: Lead::mm_per_rev(lead),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::rev(start),
            axis,
            // the bar's end, or where a thread begins in it
            surface: match axis {
                Axis::Z => Length::mm(TOOL_LENGTH + self.at[1].min(0.0)),
                _ => Length::mm(self.at[0]),
            },
        }));
        let way = (to[0] - self.at[0]).hypot(to[1] - self.at[1]);
        self.go(to, way / lead);
        self
    }

    /// A pass from outside at this radius, along the thread and out.
    pub fn pass(mut self, x: f64, [from, to]: [f64; 2], lead: f64, start: f64) -> Self {
        self = self.rapid(12.0, from).rapid(x, from);
        let begin = self.turn.ceil() + 1.0 + self.sense * start;
        let wait = begin - self.turn;
        self.order(OpKind::Dwell { time: Time::s(0.1) });
        self.go([x, from], wait);
        self.stretch([x, to], lead, start, Axis::Z).rapid(12.0, to)
    }

    /// Until the spindle has come to its start angle.
    pub fn waits(mut self) -> Self {
        let (at, wait) = (self.at, self.turn.ceil() + 1.0 - self.turn);
        self.order(OpKind::Dwell { time: Time::s(0.1) });
        self.go(at, wait);
        self
    }

    /// A pass within a bore, in which the tool stands at its depth already.
    pub fn inside(self, x: f64, to: f64) -> Self {
        self.waits().stretch([x, to], 1.5, 0.0, Axis::Z).rapid(8.0, to)
    }

    /// M20x1.5 with these roots, from 6 mm before the face.
    pub fn passes(self, roots: &[f64], to: f64) -> Self {
        roots.iter().fold(self, |lathe, root| lathe.pass(*root, [6.0, to], 1.5, 0.0))
    }

    /// M20x1.5, 25 mm long, with the full profile.
    pub fn m20(self) -> Self {
        self.with(FULL).passes(&[9.6, 9.25, 9.015], -25.0)
    }

    /// A hexagon of 17 mm across flats, turned by an angle of the cutter, fed 0.25 mm a turn.
    pub fn hexagon(mut self, [from, to]: [f64; 2], phase_deg: f64) -> Self {
        const STEPS: f64 = 120.0;
        self = self.with(CUTTER).rapid(75.0, from);
        let (work, tool) = (0, 1);
        let phase = Angle::deg(phase_deg);
        let kind = OpKind::Polygon(canon::Polygon {
            work,
            tool,
            ratio: Ratio { follower: 2, master: 1 },
            phase,
            oscillations: Vec::new(),
            auto: None,
            by_distance: Vec::new(),
            wanted: Vec::new(),
            compensated: false,
            zero: place([0.0, 0.0]),
            own_zero: None,
        });
        self.order(kind);
        let feed = Feed::PerRevolution(Lead::mm_per_rev(0.25));
        self.order(OpKind::Line { to: place([58.5, to]), feed });
        let (began, way) = (self.turn, from - to);
        let count = (way / 0.25 * STEPS).ceil();
        for k in 0..=count as u32 {
            let share = f64::from(k) / count;
            let turn = began + share * way / 0.25;
            self.see_geared([58.5, from - share * way], turn, 2.0 * turn + phase.value());
        }
        self.at = [58.5, to];
        self.order(OpKind::PolygonEnd);
        self.rapid(75.0, to).rapid(75.0, 50.0).rapid(30.0, 50.0)
    }

    /// Turned along Z from before the face, or from the place given, and out.
    pub fn turned(self, tool: u32, radius: f64, [from, to]: [f64; 2]) -> Self {
        self.with(tool)
            .rapid(12.0, from)
            .feed(radius, from)
            .feed(radius, to)
            .feed(12.0, to)
            .rapid(30.0, 50.0)
    }

    /// Plunged at a place to a radius.
    pub fn groove(self, tool: u32, z: f64, radius: f64) -> Self {
        self.with(tool).rapid(12.0, z).feed(radius, z).feed(12.0, z).rapid(30.0, 50.0)
    }

    pub fn chamfer(self, size: f64) -> Self {
        self.with(TURN)
            .rapid(30.0, 50.0)
            .rapid(10.0 - size, 2.0)
            .feeds(&[[10.0 - size, 0.0], [10.0, -size], [11.0, -size]])
            .rapid(30.0, 50.0)
    }

    pub fn faced(self, z: f64) -> Self {
        self.with(TURN).rapid(11.0, z).feed(-0.4, z).rapid(0.0, 50.0).rapid(30.0, 50.0)
    }

    pub fn drilled(self, tool: u32, to: f64) -> Self {
        self.with(tool)
            .rapid(30.0, 50.0)
            .rapid(0.0, 2.0)
            .feed(0.0, to)
            .feed(0.0, 2.0)
            .rapid(0.0, 50.0)
    }

    pub fn features(mut self) -> Vec<Feature> {
        self.order(OpKind::End);
        self.see(self.at, self.turn + 0.1);
        self.judge.finish()
    }

    /// What is not good: kind, line, why.
    pub fn wrong(self) -> Vec<String> {
        let of = |f: &Feature| {
            f.verdict.reason().map(|why| format!("{} of line {}: {why}", f.kind_name(), f.line))
        };
        self.features().iter().filter_map(of).collect()
    }

    /// The verdicts' names of all turned threads.
    pub fn verdicts(self) -> Vec<(u32, &'static str, String)> {
        let of = |f: &Feature| {
            matches!(f.kind, FeatureKind::Turned(_)).then(|| {
                let reason = f.verdict.reason().unwrap_or_default().to_owned();
                (f.line, f.verdict.name(), reason)
            })
        };
        self.features().iter().filter_map(of).collect()
    }

    /// Whether all is good.
    pub fn all_good(self) -> bool {
        self.features().iter().all(|f| f.verdict == Verdict::Pass)
    }
}
