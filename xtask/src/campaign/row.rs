//! What became of the cases of one row of the table, and whether what was said of each is true.
use serde_json::Value;

/// Furthest off the thread that was cut, on the way out of a tap that is said to be recovered, µm;
/// after drives that were just switched off nothing is guaranteed.
const OFF_THREAD_UM: f64 = 20.0;

/// Counts of a feature and a reaction of the drives.
#[derive(Default)]
pub(super) struct Row {
    /// The drives keep a tap near its thread when they are left alone.
    is_guarded: bool,
    pub(super) cases: u32,
    recovered: u32,
    to_be_looked_at: u32,
    nothing: u32,
    refused: u32,
    /// Recoveries that were stopped themselves.
    pub(super) stopped_again: u32,
    torn_before: u32,
    torn_after: u32,
    not_true: u32,
    /// Largest distance of what was said from the truth over the bound that was said, and the
    /// largest bound, µm.
    of_bound: f64,
    bound_um: f64,
    /// Furthest off its thread of a tap on its way out, µm.
    way_out_um: f64,
    pub(super) problems: Vec<String>,
}

pub(super) const HEAD: &str = "\
| what, and what the drives do | cases | recoveries stopped again | recovered | out, to be looked at | nothing to do | refused | torn before anything could act | torn after | false | truth within the bound | way out |
|---|---|---|---|---|---|---|---|---|---|---|---|";

impl Row {
    /// None yet, of drives that `reaction` says.
    pub(super) fn of(reaction: &str) -> Self {
        Self { is_guarded: reaction != "off", ..Self::default() }
    }

    pub(super) fn text(&self, title: &str) -> String {
        let measured = |um: f64, text: String| if um > 0.0 { text } else { "—".into() };
        format!(
            "| {title} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            self.cases,
            self.stopped_again,
            self.recovered,
            self.to_be_looked_at,
            self.nothing,
            self.refused,
            self.torn_before,
            self.torn_after,
            self.not_true,
            measured(
                self.bound_um,
                format!("{:.0} % of {:.0} µm", 100.0 * self.of_bound, self.bound_um)
            ),
            measured(self.way_out_um, format!("{:.1} µm", self.way_out_um)),
        )
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.cases += other.cases;
        self.recovered += other.recovered;
        self.to_be_looked_at += other.to_be_looked_at;
        self.nothing += other.nothing;
        self.refused += other.refused;
        self.stopped_again += other.stopped_again;
        self.torn_before += other.torn_before;
        self.torn_after += other.torn_after;
        self.not_true += other.not_true;
        self.of_bound = self.of_bound.max(other.of_bound);
        self.bound_um = self.bound_um.max(other.bound_um);
        self.way_out_um = self.way_out_um.max(other.way_out_um);
    }

    pub(super) const fn is_good(&self) -> bool {
        self.torn_after == 0 && self.not_true == 0 && self.problems.is_empty()
    }

    /// A recovery that has ended: what the machine simulator knew before it and knows after it, and
    /// what it answered. `torn` is whether the tool was broken when the drives came to rest after
    /// the first stop, when no control was there to act.
    pub(super) fn judge(
        &mut self,
        torn: bool,
        [before, after]: [&Value; 2],
        answer: &Value,
    ) -> Result<(), String> {
        self.torn_before += u32::from(torn);
        let mut problems = Vec::new();
        if !torn && after["tool_broken"] == true {
            self.torn_after += 1;
            problems.push("torn after the drives had come to rest".to_owned());
        }
        let is_said_false = match answer["outcome"].as_str() {
            Some("recovered") => {
                self.recovered += u32::from(!torn);
                if torn {
                    Some("a broken tool is said to be out of the work")
                } else if after["tap_in_thread"] == true || !after["tool_in_work"].is_null() {
                    Some("a tool that is in the work is said to be out of it")
                } else {
                    problems.extend(self.way_out(after));
                    None
                }
            }
            Some("not-known-whole") => {
                self.to_be_looked_at += u32::from(!torn);
                None
            }
            Some("nothing-to-do") => {
                self.nothing += u32::from(!torn);
                let is_in = before["tap_in_thread"] == true;
                is_in.then_some("a tap that is in its thread is said not to be")
            }
            Some("refused") => {
                self.refused += u32::from(!torn);
                None
            }
            _ => Some("no answer"),
        };
        problems.extend(is_said_false.map(|why| self.is_false(why.into())));
        problems.extend(self.bound(before, answer));
        if problems.is_empty() { Ok(()) } else { Err(format!("{}: {answer}", problems.join("; "))) }
    }

    fn is_false(&mut self, why: String) -> String {
        self.not_true += 1;
        why
    }

    /// How far off its thread a tap came out.
    fn way_out(&mut self, after: &Value) -> Option<String> {
        let um = after["off_helix_while_coupled_max_um"].as_f64()?;
        self.way_out_um = self.way_out_um.max(um);
        (self.is_guarded && um > OFF_THREAD_UM)
            .then(|| format!("{um:.1} µm off its thread on the way out"))
    }

    /// Where a tap was said to stand, against where it stood.
    pub(super) fn bound(&mut self, before: &Value, answer: &Value) -> Option<String> {
        let said = answer["phase_error_before_um"].as_f64()?;
        let bound = answer["phase_error_bound_um"].as_f64()?;
        let truth = before["off_helix_um"].as_f64()?;
        let off = (said - truth).abs();
        (self.of_bound, self.bound_um) = (self.of_bound.max(off / bound), self.bound_um.max(bound));
        let why = format!("{said:.1} µm are said within {bound:.1}, and it is {truth:.1}");
        (off > bound).then(|| self.is_false(why))
    }
}
