//! A data item: what is observed, in which unit, and how its observations are written.
use std::borrow::Cow;

/// Kinds of observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Category {
    Sample,
    Event,
    Condition,
}

impl Category {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Sample => "SAMPLE",
            Self::Event => "EVENT",
            Self::Condition => "CONDITION",
        }
    }

    /// The list in which a component's stream has them.
    pub(crate) const fn list(self) -> &'static str {
        match self {
            Self::Sample => "Samples",
            Self::Event => "Events",
            Self::Condition => "Condition",
        }
    }
}

/// What a data item is, without its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ItemKind {
    pub(crate) category: Category,
    /// The standard's, or ours with its prefix.
    pub(crate) name: &'static str,
    pub(crate) sub: Option<&'static str>,
    pub(crate) units: Option<&'static str>,
    /// `MACHINE`, `WORK`.
    pub(crate) coordinates: Option<&'static str>,
    /// Digits behind the point.
    pub(crate) decimals: u8,
    /// Each observation counts, also one that is as the one before.
    pub(crate) is_discrete: bool,
    pub(crate) is_set: bool,
    /// The one value that it has.
    pub(crate) always: Option<&'static str>,
}

impl ItemKind {
    const fn new(category: Category, name: &'static str) -> Self {
        Self {
            category,
            name,
            sub: None,
            units: None,
            coordinates: None,
            decimals: 0,
            is_discrete: false,
            is_set: false,
            always: None,
        }
    }

    pub(crate) const fn event(name: &'static str) -> Self {
        Self::new(Category::Event, name)
    }

    pub(crate) const fn condition(name: &'static str) -> Self {
        Self::new(Category::Condition, name)
    }

    pub(crate) const fn sample(name: &'static str, units: &'static str, decimals: u8) -> Self {
        let kind = Self::new(Category::Sample, name);
        Self { units: Some(units), decimals, ..kind }
    }

    pub(crate) const fn sub(self, sub: &'static str) -> Self {
        Self { sub: Some(sub), ..self }
    }

    /// An event that is a number.
    pub(crate) const fn in_units(self, units: &'static str, decimals: u8) -> Self {
        Self { units: Some(units), decimals, ..self }
    }

    pub(crate) const fn of(self, coordinates: &'static str) -> Self {
        Self { coordinates: Some(coordinates), ..self }
    }

    pub(crate) const fn discrete(self) -> Self {
        Self { is_discrete: true, ..self }
    }

    pub(crate) const fn set(self) -> Self {
        Self { is_set: true, ..self }
    }

    pub(crate) const fn always(self, value: &'static str) -> Self {
        Self { always: Some(value), ..self }
    }

    /// The element of an observation: `PATH_FEEDRATE` is `PathFeedrate`.
    pub(crate) fn element(&self) -> Cow<'static, str> {
        let (prefix, name) = match self.name.split_once(':') {
            Some((prefix, name)) => (format!("{prefix}:"), name),
            None => (String::new(), self.name),
        };
        let words = name.split('_').flat_map(|word| {
            let (first, rest) = word.split_at(1.min(word.len()));
            [first.to_owned(), rest.to_ascii_lowercase()]
        });
        let set = if self.is_set { "DataSet" } else { "" };
        let element: String = [prefix].into_iter().chain(words).collect();
        Cow::Owned(element + set)
    }
}

/// A data item of a device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Item {
    pub(crate) id: String,
    pub(crate) kind: ItemKind,
    /// The element of its observations.
    pub(crate) element: Cow<'static, str>,
    /// Number of its component.
    pub(crate) component: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_observation_has_the_name_of_its_type() {
        assert_eq!(ItemKind::event("EXECUTION").element(), "Execution");
        assert_eq!(ItemKind::event("PATH_FEEDRATE_OVERRIDE").element(), "PathFeedrateOverride");
        assert_eq!(ItemKind::event("leadscrew:SYNC_ERROR").element(), "leadscrew:SyncError");
        assert_eq!(ItemKind::event("ASSET_COUNT").set().element(), "AssetCountDataSet");
    }
}
