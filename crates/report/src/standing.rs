//! How a feature stands, for people: good, out of tolerance, not cut, not judged; each with a sign
//! and a word of its own, so that none is told by its colour alone.
use verify::Feature;

/// How a feature stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Standing {
    /// Cut, and out of at least one tolerance.
    Bad,
    /// The tool has not been in the material.
    NotCut,
    /// What it would have to be judged by was not measured.
    NotJudged,
    /// Within every tolerance.
    Good,
}

impl Standing {
    /// All of them, gravest first.
    pub const ALL: [Self; 4] = [Self::Bad, Self::NotCut, Self::NotJudged, Self::Good];

    /// Of a feature.
    pub fn of(feature: &Feature) -> Self {
        match feature.verdict.name() {
            "pass" => Self::Good,
            "not judged" => Self::NotJudged,
            _ if !feature.is_there() => Self::NotCut,
            _ => Self::Bad,
        }
    }

    /// A word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bad => "fail",
            Self::NotCut => "not cut",
            Self::NotJudged => "not judged",
            Self::Good => "pass",
        }
    }

    /// A sign that is told from the others without colours.
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Bad => "✗",
            Self::NotCut => "∅",
            Self::NotJudged => "?",
            Self::Good => "✓",
        }
    }

    /// Sign and word.
    pub fn shown(self) -> String {
        format!("{} {}", self.sign(), self.name())
    }

    /// Its class in the style sheet.
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::Bad | Self::NotCut => "fail",
            Self::NotJudged => "unjudged",
            Self::Good => "pass",
        }
    }

    /// How many of some features stand so.
    pub fn count(self, features: &[Feature]) -> usize {
        features.iter().filter(|feature| Self::of(feature) == self).count()
    }

    /// How features stand that are not good, in words: "2 out of tolerance, 3 not cut"; nothing if
    /// all are good.
    pub fn counts(features: &[Feature]) -> Option<String> {
        let some = [Self::Bad, Self::NotCut, Self::NotJudged].map(|standing| {
            let name = if standing == Self::Bad { "out of tolerance" } else { standing.name() };
            (standing.count(features), name)
        });
        let words: Vec<_> =
            some.iter().filter(|(n, _)| *n > 0).map(|(n, name)| format!("{n} {name}")).collect();
        (!words.is_empty()).then(|| words.join(", "))
    }
}
