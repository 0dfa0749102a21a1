//! What the machine keeps of a tool in its work, whatever becomes of the control and of its files:
//! as the retentive bits of a machine's own logic do.
//!
//! ```text
//!   command: tool 11 is in the work, number 7 ──► kept ──► control dies ──► next control is told: tool 11, number 7
//!   command: no tool                          ──► free                        │ states number 7: recovery, it may move
//!                                                                             └ states anything else: refused
//! ```
//!
//! It is set by the command that lets the tool in and taken back by the control that has brought it
//! out, or by an operator who has looked. Nothing else takes it back: not the end of a connection,
//! and not a control that says nothing of it.
use bus::{EngagedTool, EngagementEvidence, SpindleSense};
use units::Spin;

/// See the module's header.
#[derive(Debug, Default)]
pub(super) struct Retained {
    evidence: EngagementEvidence,
    /// The control has stated what is in the work, so it may take it back.
    stated: bool,
}

impl Retained {
    pub(super) const fn evidence(&self) -> EngagementEvidence {
        self.evidence
    }

    /// Another control: what it knows is not known yet.
    pub(super) const fn begin_session(&mut self) {
        self.stated = false;
    }

    /// What a control says of the tool with its command; whether a tool has gone in.
    ///
    /// # Errors
    /// Why it may move nothing.
    pub(super) fn hear(&mut self, said: Option<EngagedTool>) -> Result<bool, String> {
        let evidence = &mut self.evidence;
        if let Some(kept) = evidence.in_work.filter(|_| !self.stated) {
            match said {
                Some(said) if (said.number, said.tool) == (kept.number, kept.tool) => {}
                Some(_) | None => {
                    return Err(format!(
                        "tool {} is in the work, and nothing but its recovery may move: leadscrew recover",
                        kept.tool
                    ));
                }
            }
        }
        self.stated = true;
        let kept = evidence.in_work.map(|kept| kept.number);
        let begins = said.is_some_and(|said| Some(said.number) != kept);
        if let Some(said) = said.filter(|_| begins) {
            let next = evidence.last + 1;
            if said.number != next {
                return Err(format!(
                    "the control says that tool {} goes into the work as engagement {}, and {next} is this machine's next",
                    said.tool, said.number
                ));
            }
            (evidence.last, evidence.sense) = (next, SpindleSense::Unknown);
        }
        evidence.in_work = said;
        Ok(begins)
    }

    /// The spindle of the coupling turned so fast in the last period.
    pub(super) fn turned(&mut self, spin: Spin) {
        if let (Some(_), Some(sense)) = (self.evidence.in_work, SpindleSense::of(spin)) {
            self.evidence.sense = sense;
        }
    }

    /// The operator has seen that no tool is in the work.
    pub(super) const fn tool_is_free(&mut self) {
        self.evidence.in_work = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[allow(clippy::unnecessary_wraps)] // as it is asked and told
    fn tool(number: u64) -> Option<EngagedTool> {
        Some(EngagedTool { number, tool: 11, ..EngagedTool::default() })
    }

    #[test]
    fn a_control_that_dies_leaves_its_tool_known() {
        let mut retained = Retained::default();
        retained.begin_session();
        assert_eq!(retained.hear(None), Ok(false));
        assert_eq!((retained.hear(tool(1)), retained.hear(tool(1))), (Ok(true), Ok(false)));
        retained.begin_session();
        assert_eq!(retained.evidence().in_work, tool(1));
    }

    #[test]
    fn the_next_control_moves_nothing_before_it_has_stated_that_tool() {
        let mut retained = Retained::default();
        retained.hear(tool(1)).unwrap();
        let other = tool(1).map(|one| EngagedTool { tool: 12, ..one });
        for said in [None, tool(2), other] {
            retained.begin_session();
            let refused = retained.hear(said).unwrap_err();
            assert!(refused.contains("tool 11 is in the work"), "{refused}");
            assert_eq!(retained.evidence().in_work, tool(1), "{said:?} has taken it back");
        }
        retained.begin_session();
        assert_eq!((retained.hear(tool(1)), retained.hear(None)), (Ok(false), Ok(false)));
        assert_eq!(
            retained.evidence(),
            EngagementEvidence { last: 1, ..EngagementEvidence::default() }
        );
    }

    #[test]
    fn an_engagement_that_is_not_the_next_one_is_refused() {
        let mut retained = Retained::default();
        assert!(retained.hear(tool(2)).unwrap_err().contains("1 is this machine's next"));
        retained.hear(tool(1)).unwrap();
        assert_eq!(retained.hear(tool(2)), Ok(true)); // straight on to the next hole
        retained.hear(None).unwrap();
        assert!(retained.hear(tool(2)).unwrap_err().contains("3 is this machine's next"));
    }

    #[test]
    fn the_sense_is_that_of_the_last_turning_not_of_standing() {
        let mut retained = Retained::default();
        retained.turned(Spin::rpm(100.0));
        assert_eq!(retained.evidence().sense, SpindleSense::Unknown);
        retained.hear(tool(1)).unwrap();
        for (rpm, sense) in [
            (500.0, SpindleSense::Positive),
            (1.0, SpindleSense::Positive),
            (-40.0, SpindleSense::Negative),
        ] {
            retained.turned(Spin::rpm(rpm));
            assert_eq!(retained.evidence().sense, sense, "{rpm} rpm");
        }
        retained.hear(tool(2)).unwrap();
        assert_eq!(retained.evidence().sense, SpindleSense::Unknown);
    }
}
