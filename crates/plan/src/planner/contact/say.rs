//! What is said of a tool that would break: the tool, what it would do, the number that works, and
//! why it stands there.
use super::{BREAKS, Contact, MAY_BREAK, Planner, Point, SLIDES, Sweep, WEAR, Wrong};
use crate::findings::{Cause, number};
use crate::words::{
    Rounding, advice, bare_length, feed, feed_that_works, floor_in_unit, length, place, word,
};
use alloc::{format, string::String};
use canon::{Axis, Feed, Holder, RapidIntoStock, Tool, ToolKind};
use diag::{Diagnostic, Severity, Span};
use units::Length;

/// How far above the stock a rapid is clear of it, mm.
const CLEAR: f64 = 2.0;

impl Sweep {
    /// True if the feed is one per revolution.
    pub(super) const fn is_by_turn(self) -> bool {
        matches!(self, Self::Feed(Feed::PerRevolution(_)) | Self::Thread(Feed::PerRevolution(_)))
    }
}

impl Planner {
    /// Severity of what surely breaks the tool, if the stock lies where it was clamped.
    pub(super) const fn sure(is_tilted: bool) -> Severity {
        if is_tilted { Severity::Warning } else { Severity::Error }
    }

    pub(super) fn say_wrong(&mut self, span: Span, wrong: Wrong, at: Point, is_tilted: bool) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let sure = Self::sure(is_tilted);
        let (code, by, severity, said, help) = match wrong {
            Wrong::RapidIn { over, open, milled } => {
                let is_mill = matches!(tool.kind, ToolKind::EndMill(_));
                let severity = if milled || is_mill { Severity::Warning } else { sure };
                let help = match (milled, is_mill) {
                    (true, _) => Some(MILLED),
                    (_, true) => Some(SMALLER),
                    _ => None,
                };
                ("M0360", over, severity, self.rapid_in(tool, contact, at, [over, open]), help)
            }
            Wrong::Sideways { off, depth, milled } => {
                let slides = milled || depth < SLIDES;
                let severity = if slides { Severity::Warning } else { sure };
                let wrong = format!(
                    "{} moves {} sideways, {} deep in the stock, and cuts along its axis only",
                    tool.name(),
                    length(&self.frame, off),
                    length(&self.frame, depth),
                );
                let works = format!(
                    ": {} or higher is clear of the stock; an end mill cuts sideways",
                    self.clear_of(tool, contact)
                );
                ("M0361", off, severity, [wrong, works], milled.then_some(MILLED))
            }
            Wrong::Still { over, load } => {
                let backwards = self.spindles.first().is_some_and(|s| s.ordered.value() < 0.0);
                let how = if backwards { "turning backwards (M4)" } else { "at rest" };
                let wrong = format!(
                    "{} is fed {} into the stock with the spindle {how}",
                    tool.name(),
                    length(&self.frame, over),
                );
                let severity = if load > BREAKS { sure } else { Severity::Warning };
                ("M0362", over, severity, [wrong, ": M3 with an S above zero works".into()], None)
            }
            Wrong::TooFast { per_turn, load, by_turn } => {
                let severity = if load > BREAKS { sure } else { Severity::Warning };
                ("M0363", load, severity, self.too_fast(tool, per_turn, load, by_turn), None)
            }
            Wrong::TapFed { over, is_led } => {
                let gives = match &tool.kind {
                    ToolKind::Tap(tap) => matches!(
                        tap.holder,
                        Holder::TensionCompression { .. } | Holder::Clutch { .. }
                    ),
                    _ => false,
                };
                let severity = if gives { Severity::Warning } else { sure };
                let (how, why) = if is_led {
                    ("led", "G33, at whose end the spindle goes on turning")
                } else {
                    ("fed", "G1, which does not tie it to the spindle")
                };
                let deep = length(&self.frame, over);
                let wrong = format!("{} is {how} {deep} into the work by {why}", tool.name());
                ("M0364", over, severity, [wrong, ": G84 or G33.1 works".into()], None)
            }
        };
        let cause = Cause { code, which: [contact.mounted, severity as u32, 0] };
        let offset = self.offset_cause();
        let is_offset = offset.is_some() && !matches!(wrong, Wrong::TooFast { .. });
        if is_offset && contact.blamed.is_some_and(|blamed| blamed != code) {
            return;
        }
        let help = offset.filter(|_| is_offset).or_else(|| help.map(String::from));
        self.findings.merge(cause, by, || {
            let mut finding = match severity {
                Severity::Error => Diagnostic::error(code, span, ""),
                _ => Diagnostic::warning(code, span, ""),
            };
            finding.help = help;
            (finding, said)
        });
        if let Some(contact) = self.contact.as_mut().filter(|_| is_offset) {
            contact.offset_said = true;
            contact.blamed = Some(code);
        }
    }

    fn rapid_in(&self, tool: &Tool, contact: &Contact, at: Point, by: [f64; 2]) -> [String; 2] {
        let [over, open] = by;
        let frame = &self.frame;
        let axis = |tip: f64| tip + tool.worn_length().value();
        let rapid = RapidIntoStock {
            place: frame.place([at[0], at[1], axis(at[2])].map(Length::mm)),
            line: None,
            tool,
            depth: Length::mm(over),
        };
        let top = contact.stock.top();
        if open > 0.0 {
            return [
                format!("{rapid}, deeper than what is open there"),
                format!(
                    ": {} is the deepest that works, or a feed (G1)",
                    advice(frame, Axis::Z, axis(top - open), Rounding::Up)
                ),
            ];
        }
        [
            format!("{rapid}, whose top it touches at {}", word(frame, Axis::Z, axis(top))),
            format!(": {} or higher works, or a feed (G1)", self.clear_of(tool, contact)),
        ]
    }

    fn clear_of(&self, tool: &Tool, contact: &Contact) -> String {
        let unit = self.frame.unit.in_mm();
        let clear = if unit == 1.0 { CLEAR } else { 0.1 * unit };
        let clear = contact.stock.top() + clear + tool.worn_length().value();
        advice(&self.frame, Axis::Z, clear, Rounding::Up)
    }

    fn too_fast(&self, tool: &Tool, per_turn: f64, load: f64, by_turn: bool) -> [String; 2] {
        let frame = &self.frame;
        let rpm = self.spindles.first().map_or(0.0, |state| state.ordered.in_rpm());
        let bears = floor_in_unit(frame, per_turn / load);
        let written = |per_turn: f64| {
            if by_turn {
                bare_length(frame, per_turn)
            } else {
                feed_that_works(frame, per_turn * rpm)
            }
        };
        let how = if load <= 1.0 { "nearly all that" } else { "more than" };
        let works = written(floor_in_unit(frame, bears * MAY_BREAK));
        let most = if by_turn { String::new() } else { format!(" (F{})", written(bears)) };
        [
            format!(
                "a feed of {} at S{}, {} per turn, is {how} {} of {} bears in this material, {} per turn{most}",
                feed(frame, per_turn * rpm),
                number(rpm),
                length(frame, per_turn),
                tool.name(),
                length(frame, tool.diameter.value()),
                bare_length(frame, bears),
            ),
            format!(": F{works} works, a tenth below it"),
        ]
    }

    /// Why the tip is not where the program says, in one sentence; `None`: it is.
    pub(super) fn offset_cause(&self) -> Option<String> {
        let (tool, contact) = (self.tools.get(self.tool)?, self.contact.as_ref()?);
        let frame = &self.frame;
        if frame.work_offset == 0 {
            return None; // what the program says is not known
        }
        let (real, applied) = (tool.worn_length().value(), frame.tool.linear[2].value());
        let off = applied - real;
        // a work offset that carries the tool's length puts the tip right without G43
        let zero = frame.origin.linear[2].value() - contact.stock.top();
        if off.abs() <= WEAR || (zero + off).abs() < zero.abs() {
            return None;
        }
        let way = if off > 0.0 { "above" } else { "below" };
        let is = format!("T{} is {} long", tool.number, length(frame, real));
        let so = format!("its tip is {} {way} where the program has it", length(frame, off.abs()));
        let n = tool.number;
        Some(if applied == 0.0 {
            format!(
                "{is} and no length offset is in force, so {so}: G43 H{n} before this move works"
            )
        } else {
            let same = |t: &&Tool| (t.worn_length().value() - applied).abs() < 1e-6;
            let whose = match self.tools.iter().find(same) {
                Some(other) => format!("H{} applies {}", other.number, length(frame, applied)),
                None => format!("the length offset in force is {}", length(frame, applied)),
            };
            format!("{is} and {whose}, so {so}: G43 H{n} works")
        })
    }

    pub(super) fn say_offset(&mut self, span: Span, cause: &str) {
        self.findings.add(Diagnostic::warning("M0365", span, cause));
        if let Some(contact) = &mut self.contact {
            contact.offset_said = true;
        }
    }

    pub(super) fn say_air(&mut self, span: Span, at: [Length; 2], bottom: Length, is_over: bool) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let (frame, stock) = (&self.frame, &contact.stock);
        let which = [contact.mounted, u32::from(is_over), 0];
        let top = stock.top() + tool.worn_length().value();
        let by = if is_over { (bottom.value() - top).max(0.0) } else { 0.0 };
        let offset = self.offset_cause().filter(|_| is_over);
        let said = if is_over {
            [
                format!(
                    "{} goes down to {} and never reaches the stock, whose top it touches at {}",
                    tool.name(),
                    place(frame, Axis::Z, bottom.value()),
                    word(frame, Axis::Z, top),
                ),
                ": nothing is cut here".into(),
            ]
        } else {
            let ends = |axis: Axis| {
                let i = axis.index();
                let [from, to] = [stock.from[i], stock.to[i]].map(Length::value);
                format!("{} to {}", word(frame, axis, from), place(frame, axis, to))
            };
            [
                format!(
                    "{} {} lies beside the stock, which reaches from {} and from {}",
                    word(frame, Axis::X, at[0].value()),
                    word(frame, Axis::Y, at[1].value()),
                    ends(Axis::X),
                    ends(Axis::Y),
                ),
                ": nothing is cut here".into(),
            ]
        };
        let is_offset = offset.is_some();
        let usual =
            "[setup.stock] in the machine's file says how large the work is and where it lies";
        let help = offset.or_else(|| (!is_over).then(|| usual.into()));
        self.findings.merge(Cause { code: "M0366", which }, by, || {
            let mut finding = Diagnostic::warning("M0366", span, "");
            finding.help = help;
            (finding, said)
        });
        if let Some(contact) = self.contact.as_mut().filter(|_| is_offset) {
            contact.offset_said = true;
        }
    }

    /// What comes of a zero that is not the workpiece's, once a tool.
    pub(super) fn say_zero(&mut self, span: Span, off: Length) {
        let Some(contact) = &self.contact else { return };
        let which = [contact.mounted, 0, 0];
        let way = if off > Length::ZERO { ("above", "shallow") } else { ("below", "deep") };
        let by = length(&self.frame, off.value().abs());
        let said = [
            format!("the program's zero stands {by} {} that of the workpiece", way.0),
            format!(": what is cut is {by} too {}", way.1),
        ];
        self.findings.merge(Cause { code: "M0369", which }, off.value().abs(), || {
            let help = "look at G92, G52 and G10 L2, and at where the workpiece lies in the machine's file ([setup])";
            (Diagnostic::warning("M0369", span, "").with_help(help), said)
        });
    }

    /// A hole or thread that is partly in the air.
    pub(super) fn say_side(&mut self, span: Span, at: [Length; 2], over: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let said = [
            format!(
                "{} at {} and {} breaks through a side of the stock: {} of it are in the air",
                tool.name(),
                word(frame, Axis::X, at[0].value()),
                word(frame, Axis::Y, at[1].value()),
                length(frame, over),
            ),
            ": it is not whole".into(),
        ];
        let which = [contact.mounted, 2, 0];
        self.findings.merge(Cause { code: "M0366", which }, over, || {
            let help =
                "[setup.stock] in the machine's file says how large the work is and where it lies";
            (Diagnostic::warning("M0366", span, "").with_help(help), said)
        });
    }

    pub(super) fn say_chamfer(&mut self, span: Span, depth: f64, chamfer: f64) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let wrong = format!(
            "{} goes {} deep into the stock, and its chamfer is {} long",
            tool.name(),
            length(frame, depth),
            length(frame, chamfer),
        );
        let which = [contact.mounted, 0, 0];
        self.findings.merge(Cause { code: "M0368", which }, -depth, || {
            let finding = Diagnostic::warning("M0368", span, "");
            (finding, [wrong, ": no full thread is cut".into()])
        });
    }

    pub(super) fn say_reach(&mut self, span: Span, depth: f64, most: f64, why: &str) {
        let Some((tool, contact)) = self.tools.get(self.tool).zip(self.contact.as_ref()) else {
            return;
        };
        let frame = &self.frame;
        let deepest = contact.stock.top() - most + tool.worn_length().value();
        let said = [
            format!(
                "{} goes {} deep into the stock, and {why} {} above its tip",
                tool.name(),
                length(frame, depth),
                length(frame, most),
            ),
            format!(
                ": {} is the deepest that works",
                advice(frame, Axis::Z, deepest, Rounding::Up)
            ),
        ];
        let cause = Cause { code: "M0367", which: [contact.mounted, 0, 0] };
        let is_doubtful = contact.doubtful;
        let offset = self.offset_cause();
        let is_offset = offset.is_some();
        if is_offset && contact.blamed.is_some() {
            return; // what the length offset causes was said
        }
        self.findings.merge(cause, depth, || {
            let mut finding = if is_doubtful {
                Diagnostic::warning("M0367", span, "")
            } else {
                Diagnostic::error("M0367", span, "")
            };
            finding.help = offset;
            (finding, said)
        });
        if let Some(contact) = self.contact.as_mut().filter(|_| is_offset) {
            contact.offset_said = true;
        }
    }
}

/// Of a place over whose middle a mill has passed.
const MILLED: &str = "a mill has passed here: see that it has opened all the width of this tool";
/// Of a mill's rapid.
const SMALLER: &str = "[setup.stock] in the machine's file says how large the work is: if the real one is smaller, write its size there";
