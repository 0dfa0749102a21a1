//! What is in force and is not what the control wrote last: each value by a name that the operator
//! knows, as it was and as it is.
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A value that is in force at a start, and is not, or is not known to be, what the control wrote
/// last.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateChange {
    /// Its name: `G54 X`, `tool 3 length_mm`; or the file, where nothing more is known.
    pub datum: String,
    /// As the control wrote it last.
    pub before: String,
    /// As it is in force.
    pub now: String,
    /// Which copy is in force, from when, and why.
    pub why: String,
}

impl fmt::Display for StateChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { datum, before, now, why } = self;
        write!(f, "{datum} {before} → {now}: {why}")
    }
}

/// The file of numbered parameters.
const PARAMETERS: &str = <crate::parameters::Parameters as super::Datum>::FILE;

/// Said of a value of which nothing shows what it was.
pub(super) const UNKNOWN: &str = "not known";
/// Said of a datum of which nothing is left.
pub(super) const FIRST_DAY: &str = "as on the first day";
/// Changes of one file that are named one by one; and values of one of which nothing shows what
/// they were.
const MOST: usize = 100;
const MOST_UNKNOWN: usize = 12;

/// Values of a file's text, by name.
fn values(file: &str, body: &str) -> BTreeMap<String, String> {
    let mut values = BTreeMap::new();
    if file == PARAMETERS {
        if let Ok(parameters) = crate::parameters::Parameters::parse(body, 0) {
            let named = parameters.iter().filter(|(_, value)| *value != 0.0);
            values.extend(named.map(|(number, value)| (parameter(number), shown(value))));
        }
    } else if let Ok(table) = toml::from_str::<toml::Table>(body) {
        let name = file.split('.').next().unwrap_or(file);
        flatten(name, &toml::Value::Table(table), &mut values);
    }
    values
}

/// A number with three places, or all that it has.
fn shown(value: f64) -> String {
    let three = format!("{value:.3}");
    if three.parse() == Ok(value) { three } else { value.to_string() }
}

/// Name of a parameter.
fn parameter(number: u32) -> String {
    const AXES: [char; 9] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'];
    let axis = |at: u32| AXES.get(at as usize).copied().unwrap_or('?');
    match number {
        5161..=5169 => format!("G28 {}", axis(number - 5161)),
        5181..=5189 => format!("G30 {}", axis(number - 5181)),
        5220 => "work offset in force".into(),
        5221..=5400 => {
            let (system, at) = ((number - 5221) / 20, (number - 5221) % 20);
            let name = match system {
                0..=5 => format!("G{}", 54 + system),
                _ => format!("G59.{}", system - 5),
            };
            match at {
                0..=8 => format!("{name} {}", axis(at)),
                9 => format!("{name} rotation"),
                _ => format!("#{number}"),
            }
        }
        _ => format!("#{number}"),
    }
}

fn flatten(name: &str, value: &toml::Value, into: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let is_list = matches!(value, toml::Value::Array(list) if list.iter().any(toml::Value::is_table));
                let name = if is_list { key.clone() } else { format!("{name} {key}") };
                flatten(&name, value, into);
            }
        }
        toml::Value::Array(list) if list.iter().any(toml::Value::is_table) => {
            for (at, item) in list.iter().enumerate() {
                let id = item.get("number").or_else(|| item.get("axis"));
                let id = id.map_or_else(|| at.to_string(), plain);
                flatten(&format!("{name} {id}"), item, into);
            }
        }
        value => {
            into.insert(name.to_owned(), plain(value));
        }
    }
}

fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) if text.is_empty() => "\"\"".into(),
        toml::Value::String(text) => text.clone(),
        toml::Value::Float(number) => shown(*number),
        other => other.to_string(),
    }
}

/// What differs between the text that was written last and the one in force; `None`: nothing is
/// known, or left, of it.
pub(super) fn between(
    file: &str,
    before: Option<&str>,
    now: Option<&str>,
    why: &str,
) -> Vec<StateChange> {
    let (old, new) = (before.map(|body| values(file, body)), now.map(|body| values(file, body)));
    // a parameter that is not there is 0
    let absent = if file == PARAMETERS { "0.000" } else { "none" };
    let side = |values: &Option<BTreeMap<String, String>>, name: &String, unknown: &str| {
        values.as_ref().map_or_else(
            || unknown.to_owned(),
            |values| values.get(name).cloned().unwrap_or_else(|| absent.into()),
        )
    };
    let mut names: Vec<&String> = old.iter().chain(&new).flat_map(BTreeMap::keys).collect();
    names.sort();
    names.dedup();
    let all = names.into_iter().map(|name| StateChange {
        datum: name.clone(),
        before: side(&old, name, UNKNOWN),
        now: side(&new, name, FIRST_DAY),
        why: why.to_owned(),
    });
    let mut changes: Vec<_> = all.filter(|change| change.before != change.now).collect();
    let most = if before.is_some() { MOST } else { MOST_UNKNOWN };
    let more = changes.len().saturating_sub(most);
    changes.truncate(most);
    if changes.is_empty() || more > 0 {
        let more = if more > 0 { format!("{more} more values of {file}") } else { file.to_owned() };
        let said = |known: bool, else_: &str| if known { "see the file" } else { else_ }.to_owned();
        changes.push(StateChange {
            datum: more,
            before: said(before.is_some(), UNKNOWN),
            now: said(now.is_some(), FIRST_DAY),
            why: why.to_owned(),
        });
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_that_differs_is_named_as_the_operator_knows_it() {
        let before = "5220\t1.000000\n5221\t5.000000\n5382\t0.125500\n31\t2\n";
        let now = "5220\t1.000000\n5382\t0.125500\n31\t3\n";
        let changes = between("parameters.var", Some(before), Some(now), "why");
        let said: Vec<_> = changes.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["#31 2.000 → 3.000: why", "G54 X 5.000 → 0.000: why"]);
        assert_eq!(parameter(5382), "G59.3 Y");
        let tools = |length: f64| format!("[[tool]]\nnumber = 3\nlength_mm = {length:?}\n");
        let changes = between("tools.toml", Some(&tools(80.0)), Some(&tools(81.5)), "why");
        assert_eq!(changes[0].to_string(), "tool 3 length_mm 80.000 → 81.500: why");
        let lost = between("tools.toml", None, None, "why");
        assert_eq!(lost[0].to_string(), "tools.toml not known → as on the first day: why");
    }
}
