//! What became of a case, and of many.
use super::HELIX_UM;
use std::collections::BTreeMap;

/// How a case ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// The tap was taken out of the work along its helix.
    Recovered,
    /// The tap went on to its end, or stood outside the work: nothing was to be done.
    Nothing,
    /// Taking it out was refused, with this reason.
    Refused(String),
    /// It broke while spindle and feed ran down.
    BrokenByStop,
    /// It broke on the way out.
    BrokenOnTheWay,
    /// It should have come out, and did not.
    Lost(String),
}

/// What became of one case.
#[derive(Clone, Debug)]
pub struct Fate {
    pub end: End,
    /// Distance from the helix at rest, and the largest on the way out in the work, µm.
    pub off_um: f64,
    pub helix_um: f64,
    /// The thread was in class when everything stood, and was no more when the tap was out.
    pub class_at_stop: bool,
    pub class_lost: bool,
}

impl Fate {
    pub fn of(end: End) -> Self {
        Self { end, off_um: 0.0, helix_um: 0.0, class_at_stop: false, class_lost: false }
    }

    fn is_good(&self) -> bool {
        let ended = match self.end {
            End::Recovered | End::Nothing | End::Refused(_) => true,
            End::BrokenByStop | End::BrokenOnTheWay | End::Lost(_) => false,
        };
        ended && self.helix_um <= HELIX_UM && !self.class_lost
    }
}

/// Many of them.
#[derive(Default)]
pub struct Tally {
    pub cases: u32,
    pub recovered: u32,
    pub nothing: u32,
    pub refused: u32,
    pub broken_by_stop: u32,
    pub broken_on_the_way: u32,
    pub lost: u32,
    pub off_helix: u32,
    pub class_lost: u32,
    pub class_at_stop: u32,
    pub off_um: f64,
    pub helix_um: f64,
    pub reasons: BTreeMap<String, u32>,
    pub failures: Vec<String>,
}

impl Tally {
    pub fn add(&mut self, fate: &Fate, what: &str) {
        self.cases += 1;
        self.off_um = self.off_um.max(fate.off_um);
        self.helix_um = self.helix_um.max(fate.helix_um);
        self.off_helix += u32::from(fate.helix_um > HELIX_UM);
        self.class_at_stop += u32::from(fate.class_at_stop);
        self.class_lost += u32::from(fate.class_lost);
        match &fate.end {
            End::Recovered => self.recovered += 1,
            End::Nothing => self.nothing += 1,
            End::Refused(reason) => {
                self.refused += 1;
                *self.reasons.entry(without_numbers(reason)).or_default() += 1;
            }
            End::BrokenByStop => self.broken_by_stop += 1,
            End::BrokenOnTheWay => self.broken_on_the_way += 1,
            End::Lost(_) => self.lost += 1,
        }
        if !fate.is_good() {
            self.failures.push(format!("{what}: {fate:?}"));
        }
    }

    /// Both together.
    pub fn absorb(&mut self, other: Self) {
        self.cases += other.cases;
        self.recovered += other.recovered;
        self.nothing += other.nothing;
        self.refused += other.refused;
        self.broken_by_stop += other.broken_by_stop;
        self.broken_on_the_way += other.broken_on_the_way;
        self.lost += other.lost;
        self.off_helix += other.off_helix;
        self.class_lost += other.class_lost;
        self.class_at_stop += other.class_at_stop;
        self.off_um = self.off_um.max(other.off_um);
        self.helix_um = self.helix_um.max(other.helix_um);
        for (reason, count) in other.reasons {
            *self.reasons.entry(reason).or_default() += count;
        }
        self.failures.extend(other.failures);
    }

    pub fn row(&self, name: &str) -> String {
        format!(
            "{name:<48} {:>6} {:>9} {:>7} {:>7} {:>9} {:>9} {:>5} {:>9.1} {:>10.2} {:>6}/{}",
            self.cases,
            self.recovered,
            self.nothing,
            self.refused,
            self.broken_by_stop,
            self.broken_on_the_way,
            self.lost,
            self.off_um,
            self.helix_um,
            self.class_lost,
            self.class_at_stop
        )
    }

    pub fn head() -> String {
        format!(
            "{:<48} {:>6} {:>9} {:>7} {:>7} {:>9} {:>9} {:>5} {:>9} {:>10} {:>6}",
            "",
            "cases",
            "recovered",
            "nothing",
            "refused",
            "broken by",
            "broken on",
            "lost",
            "stop µm",
            "way out µm",
            "class lost/at stop"
        ) + &format!(
            "\n{:<48} {:>6} {:>9} {:>7} {:>7} {:>9} {:>9}",
            "", "", "", "to do", "", "the stop", "the way"
        )
    }

    /// The same for adding campaigns up.
    pub fn sum(&self, title: &str) -> String {
        let broken = self.failures.len();
        let counts = [self.cases, self.recovered, self.nothing, self.refused].map(|n| n as usize);
        let [cases, recovered, nothing, refused] = counts;
        sum(title, [cases, recovered, nothing, refused, broken], [self.off_um, self.helix_um])
    }

    /// Whatever did not end well, and why something was refused.
    pub fn remarks(&self) -> String {
        let refused =
            self.reasons.iter().map(|(why, count)| format!("  refused {count}×: {why}\n"));
        let failed = self.failures.iter().map(|why| format!("  {why}\n"));
        refused.chain(failed).collect()
    }

    /// Every case ended well.
    pub fn is_good(&self) -> bool {
        self.failures.is_empty()
    }
}

/// A line of a campaign: cases, recovered, nothing to do, refused, not as promised; off the thread
/// at rest, and on the way out, µm.
pub fn sum(title: &str, counts: [usize; 5], [stop_um, out_um]: [f64; 2]) -> String {
    let [cases, recovered, nothing, refused, broken] = counts;
    format!("SUM|{title}|{cases}|{recovered}|{nothing}|{refused}|{broken}|{stop_um:.2}|{out_um:.2}")
}

/// A reason as it is for all of its cases.
fn without_numbers(reason: &str) -> String {
    reason.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).collect()
}
