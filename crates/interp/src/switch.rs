//! What a block switches: feed and spindle modes, tools, coolant, overrides, dwell.
use crate::{
    call::{Call, Corners, Sense, Sink, Units},
    codes::{GGroup, MGroup},
    execute::Executor,
    fault::{Outcome, error, refuse},
    frame,
    setup::MissingTools,
    state::FeedMode,
};
use canon::{Tool, ToolKind};
use diag::{Diagnostic, Span};
use units::Length;

/// G96 without D: no limit. LinuxCNC says it with this number.
pub(crate) const NO_SPEED_LIMIT: f64 = 1e30;

impl Executor {
    /// G93, G94, G95 and F.
    pub(crate) fn feed_mode<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        if let Some(code) = self.words.g(GGroup::FeedMode) {
            let mode = match code {
                930 => FeedMode::InverseTime,
                950 => FeedMode::PerRevolution,
                _ => FeedMode::PerMinute,
            };
            self.set_feed_mode(mode, sink);
        }
        let Some(feed) = self.words.get(b'F') else { return Ok(()) };
        if feed < 0.0 {
            return refuse(
                "I0402",
                self.words.span(b'F'),
                format!("F must not be negative, found {feed}"),
            );
        }
        if self.state.feed_mode != FeedMode::InverseTime {
            self.say(sink, &Call::FeedRate { rate: feed, duration_s: None });
            let changed = match self.words.g(GGroup::Units) {
                Some(200) => self.state.units != Units::Inch,
                Some(210) => self.state.units != Units::Millimetre,
                _ => false,
            };
            if changed {
                let text = format!(
                    "F{feed} is still read in the units before this block: F comes before G20/G21"
                );
                let help = "write G20 or G21 in a block before";
                self.remarks.push(
                    Diagnostic::warning("I0403", self.words.span(b'F'), text).with_help(help),
                );
            }
        }
        self.state.feed = feed;
        Ok(())
    }

    pub(crate) fn set_feed_mode<S: Sink>(&mut self, mode: FeedMode, sink: &mut S) {
        self.state.feed_mode = mode;
        let note = match mode {
            FeedMode::InverseTime => "feed mode set to inverse time",
            FeedMode::PerMinute => "feed mode set to units per minute",
            FeedMode::PerRevolution => "feed mode set to units per revolution",
        };
        self.say(sink, &Call::Note(note));
        self.say(sink, &Call::FeedMode { per_revolution: mode == FeedMode::PerRevolution });
        if mode != FeedMode::InverseTime {
            self.say(sink, &Call::FeedRate { rate: 0.0, duration_s: None });
            self.state.feed = 0.0; // a number per minute means nothing per revolution
        }
    }

    /// G96, G97 and S.
    pub(crate) fn spindle_speed<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        self.spindle_number()?;
        let speed = self.words.get(b'S');
        match self.words.g(GGroup::SpindleMode) {
            Some(960) => {
                if speed.is_none() {
                    return refuse(
                        "I0601",
                        self.words.place.span,
                        "G96 needs S, the surface speed",
                    );
                }
                let limit = self.words.get(b'D').unwrap_or(NO_SPEED_LIMIT);
                self.say(sink, &Call::SpindleMode(limit.abs()));
                self.state.spindle.constant_surface_speed = true;
                self.state.spindle.limit = limit.abs();
            }
            Some(_) => {
                self.say(sink, &Call::SpindleMode(0.0));
                self.state.spindle.constant_surface_speed = false;
            }
            None => {}
        }
        let Some(speed) = speed else { return Ok(()) };
        if speed < 0.0 {
            let text = format!("S must not be negative, found {speed}; M4 turns the other way");
            return refuse("I0602", self.words.span(b'S'), text);
        }
        self.state.spindle.speed = speed;
        self.say(sink, &Call::SpindleSpeed(speed));
        Ok(())
    }

    /// Where a tool is kept; that of no tool, and of one that the table lacks, is 0.
    pub(crate) fn pocket(&self, number: u32) -> u32 {
        self.tools.get(number).map_or(0, |tool| tool.pocket)
    }

    /// `$`: the only spindle is 0, and −1 means all.
    fn spindle_number(&self) -> Outcome {
        match self.words.get(b'$') {
            None | Some(0.0 | -1.0) => Ok(()),
            Some(other) => {
                let text = format!("expected spindle $0, the only one, found ${other}");
                refuse("I0603", self.words.span(b'$'), text)
            }
        }
    }

    /// T, M6, M61, M3 M4 M5 M19, coolant, overrides, G4.
    pub(crate) fn tools_and_switches<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        if self.words.get(b'T').is_some() {
            let number = self.tool_word(b'T')?;
            self.state.selected_tool = number;
            if number != 0 || !self.stand_alone {
                self.state.selected_pocket = Some(self.pocket(number));
            }
            self.say(sink, &Call::SelectTool(number));
        }
        self.outputs(sink)?;
        match self.words.m(MGroup::Tool) {
            Some(6) => {
                self.say(sink, &Call::StartChange);
                self.state.spindle.turning = None;
                self.say(sink, &Call::SpindleStop);
                self.state.current_tool = self.state.selected_tool;
                self.state.current_pocket = self.state.selected_pocket.unwrap_or(0);
                if !self.stand_alone || self.state.current_tool != 0 {
                    self.state.loaded = self.tool_entry(self.state.current_tool);
                }
                self.say(sink, &Call::ChangeTool(self.state.current_tool));
            }
            Some(_) => {
                if self.words.get(b'Q').is_none() {
                    return refuse(
                        "I0604",
                        self.words.place.span,
                        "M61 needs Q, the number of the tool",
                    );
                }
                self.state.current_tool = self.tool_word(b'Q')?;
                self.state.current_pocket = self.pocket(self.state.current_tool);
                if !self.stand_alone {
                    self.state.loaded = self.tool_entry(self.state.current_tool);
                }
                self.say(sink, &Call::ToolNumber(self.state.current_tool));
            }
            None => {}
        }
        self.spindle(sink)?;
        self.coolant(sink);
        self.overrides(sink);
        self.context(sink)?;
        self.user_code(sink)?;
        self.dwell(sink)
    }

    /// M7, M8, M9.
    pub(crate) fn coolant<S: Sink>(&mut self, sink: &mut S) {
        match self.words.m(MGroup::Coolant) {
            Some(7) => self.mist(true, sink),
            Some(8) => self.flood(true, sink),
            Some(_) => {
                self.mist(false, sink);
                self.flood(false, sink);
            }
            None => {}
        }
    }

    fn mist<S: Sink>(&mut self, on: bool, sink: &mut S) {
        self.state.mist = on;
        self.say(sink, &Call::Mist(on));
    }

    fn flood<S: Sink>(&mut self, on: bool, sink: &mut S) {
        self.state.flood = on;
        self.say(sink, &Call::Flood(on));
    }

    pub(crate) fn spindle<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let sense = match self.words.m(MGroup::Spindle) {
            None => return Ok(()),
            Some(3) => Sense::Clockwise,
            Some(4) => Sense::Counterclockwise,
            Some(19) => return self.orient(sink),
            Some(_) => {
                self.state.spindle.turning = None;
                self.say(sink, &Call::SpindleStop);
                return Ok(());
            }
        };
        self.state.spindle.turning = Some(sense);
        self.say(sink, &Call::SpindleTurn(sense));
        Ok(())
    }

    fn orient<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let span = self.words.place.span;
        let Some(angle) = self.words.get(b'R') else {
            return refuse("I0605", span, "M19 needs R, the angle in degrees");
        };
        if !(0.0..=360.0).contains(&angle) {
            let text = format!("M19 takes R from 0 to 360 degrees, found {angle}");
            return refuse("I0606", self.words.span(b'R'), text);
        }
        let mode = self.words.whole(b'P', 2)?.unwrap_or(0) as u8;
        self.state.spindle.turning = None;
        self.say(sink, &Call::SpindleOrient { angle, mode });
        if let Some(longest) = self.words.get(b'Q') {
            if longest <= 0.0 {
                let text = format!("M19 waits Q seconds at most: more than 0, found {longest}");
                return refuse("I0607", self.words.span(b'Q'), text);
            }
            self.say(sink, &Call::WaitOriented(longest));
        }
        Ok(())
    }

    fn overrides<S: Sink>(&mut self, sink: &mut S) {
        let on = self.words.get(b'P').is_none_or(|p| p != 0.0);
        match self.words.m(MGroup::Overrides) {
            Some(code @ (48 | 49)) => {
                self.state.feed_override = code == 48;
                self.state.speed_override = code == 48;
                self.say(sink, &Call::FeedOverride(code == 48));
                self.say(sink, &Call::SpeedOverride(code == 48));
            }
            Some(50) => {
                self.state.feed_override = on;
                self.say(sink, &Call::FeedOverride(on));
            }
            Some(51) => {
                self.state.speed_override = on;
                self.say(sink, &Call::SpeedOverride(on));
            }
            Some(52) => {
                self.state.adaptive_feed = on;
                self.say(sink, &Call::AdaptiveFeed(on));
            }
            Some(_) => {
                self.state.feed_hold = on;
                self.say(sink, &Call::FeedHold(on));
            }
            None => {}
        }
    }

    fn dwell<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        if self.words.g(GGroup::NonModal) != Some(40) {
            return Ok(());
        }
        match self.words.get(b'P') {
            Some(seconds) if seconds >= 0.0 => {
                self.say(sink, &Call::Dwell(seconds));
                Ok(())
            }
            Some(seconds) => refuse(
                "I0608",
                self.words.span(b'P'),
                format!("G4 waits P seconds, 0 or more, found {seconds}"),
            ),
            None => refuse("I0609", self.words.place.span, "G4 needs P, the seconds to wait"),
        }
    }

    /// G20, G21.
    pub(crate) fn units<S: Sink>(&mut self, sink: &mut S) {
        let Some(code) = self.words.g(GGroup::Units) else { return };
        self.set_units(if code == 200 { Units::Inch } else { Units::Millimetre }, sink);
    }

    pub(crate) fn set_units<S: Sink>(&mut self, units: Units, sink: &mut S) {
        if units != self.state.units {
            let factor = match units {
                Units::Inch => 1.0 / units::MM_PER_INCH,
                Units::Millimetre => units::MM_PER_INCH,
            };
            self.state.frame.scale(factor);
            frame::scale(&mut self.state.at, factor);
            if let Some(beside) = &mut self.state.left_beside {
                frame::scale(beside, factor);
            }
            self.scale_compensation(factor);
            self.state.units = units;
        }
        self.say(sink, &Call::UseUnits(units));
    }

    /// G61, G61.1, G64.
    pub(crate) fn path_control<S: Sink>(&mut self, sink: &mut S) -> Outcome {
        let Some(code) = self.words.g(GGroup::PathControl) else { return Ok(()) };
        let mut merge = None;
        self.state.corners = match code {
            610 => Corners::ExactPath,
            611 => Corners::ExactStop,
            _ => {
                for letter in [b'P', b'Q'] {
                    if let Some(value) = self.words.get(letter).filter(|v| *v < 0.0) {
                        let text = format!(
                            "a tolerance must not be negative, found {}{value}",
                            letter as char
                        );
                        return refuse("I0404", self.words.span(letter), text);
                    }
                }
                let tolerance = self.words.get(b'P').unwrap_or(0.0);
                merge = Some(self.words.get(b'Q').unwrap_or(tolerance));
                Corners::Continuous(tolerance)
            }
        };
        self.state.merge = merge.unwrap_or(self.state.merge);
        self.say(sink, &Call::PathControl { corners: self.state.corners, merge });
        Ok(())
    }

    /// The number after a letter, which must be a tool of the table, or 0.
    pub(crate) fn tool_word(&mut self, letter: u8) -> Outcome<u32> {
        let value = self.words.get(letter).unwrap_or(0.0);
        let span = self.words.span(letter);
        match crate::words::near_whole(value) {
            Some(0) => Ok(0),
            Some(number) if number > 0 => {
                let number = u32::try_from(number).unwrap_or(u32::MAX);
                let offset = letter != b'T' && self.tool_table.has(number);
                if offset || self.tools.get(number).is_some() {
                    return Ok(number);
                }
                match self.missing_tools {
                    MissingTools::Refuse => Err(self.missing_tool(number, span).into()),
                    MissingTools::StandIn => {
                        self.tools.insert(stand_in(number));
                        Ok(number)
                    }
                }
            }
            _ => refuse(
                "I0610",
                span,
                format!(
                    "expected a tool number (0, 1, 2, …) after {}, found {value}",
                    letter as char
                ),
            ),
        }
    }

    fn missing_tool(&self, number: u32, span: Span) -> Diagnostic {
        let known: Vec<_> = self.tools.iter().map(|t| t.number.to_string()).collect();
        let help = match known.len() {
            0 => "the tool table is empty".to_owned(),
            1..=24 => format!("it has {}", known.join(", ")),
            n => format!("it has {} and {} more", known[..24].join(", "), n - 24),
        };
        error("I0611", span, format!("tool {number} is not in the tool table")).with_help(help)
    }
}

/// A tool of no length that makes nothing judged.
fn stand_in(number: u32) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::ZERO,
        diameter: Length::ZERO,
        kind: ToolKind::Other,
        description: "stand-in".into(),
        stand_in: true,
    }
}
