//! A machine file with values changed: the text goes through the same reader afterwards, which
//! checks key, unit and bounds.
//!
//! A key is named by its tables, `axes.z.structure.backlash_um`; spindles by their number or their
//! name, `spindles.0.inertia_kg_m2`, `spindles.spindle.inertia_kg_m2`.
use super::embedded;
use serde_json::Value as Json;
use toml::{Table, Value};

/// Machines that extend one another, at most.
const MOST_BASES: usize = 8;

/// The text of a machine file with one value changed, or added where it stands in none. Comments
/// are not kept.
///
/// # Errors
/// A text that is no TOML, a key that leads through something that is no table, and a value that
/// TOML has no form for.
pub fn changed(text: &str, key: &str, value: &Json) -> Result<String, String> {
    let mut root: Table = text.parse().map_err(|e: toml::de::Error| e.message().to_owned())?;
    let spindles = spindle_names(&root);
    let value = Value::try_from(value).map_err(|e| format!("{key}: {e}"))?;
    let (path, last) = key.rsplit_once('.').unwrap_or(("", key));
    let mut at = &mut root;
    let mut steps = path.split('.').filter(|step| !step.is_empty());
    while let Some(step) = steps.next() {
        let through = || format!("{key}: {step} is no table");
        at = if step == "spindles" {
            let which =
                steps.next().ok_or_else(|| format!("{key}: expected spindles.0 or a name"))?;
            let named = || spindles.iter().position(|name| name == which);
            let index = which.parse().ok().or_else(named).filter(|index| *index < bus::SPINDLES);
            let index = index.ok_or_else(|| {
                format!("{key}: there is no spindle {which}: expected {}", spindles.join(" or "))
            })?;
            let empty = Value::Array(Vec::new());
            let list = at.entry(step).or_insert(empty).as_array_mut().ok_or_else(through)?;
            while list.len() <= index {
                list.push(Value::Table(Table::new()));
            }
            list[index].as_table_mut().ok_or_else(through)?
        } else {
            let empty = Value::Table(Table::new());
            at.entry(step).or_insert(empty).as_table_mut().ok_or_else(through)?
        };
    }
    at.insert(last.to_owned(), value);
    toml::to_string(&root).map_err(|e| format!("{key}: {e}"))
}

/// What a key is, here or in a machine that this one extends; `None`: it is stated nowhere. Tables
/// come as they stand here.
pub fn value(text: &str, key: &str) -> Option<Json> {
    let mut text = text.to_owned();
    for _ in 0..=MOST_BASES {
        let root: Table = text.parse().ok()?;
        if let Some(found) = find(&root, key) {
            return serde_json::to_value(found).ok();
        }
        embedded(root.get("extends")?.as_str()?)?.clone_into(&mut text);
    }
    None
}

fn find<'v>(root: &'v Table, key: &str) -> Option<&'v Value> {
    let names = spindle_names(root);
    let (mut steps, mut at) = (key.split('.'), None);
    while let Some(step) = steps.next() {
        let table = at.map_or(Some(root), Value::as_table)?;
        at = Some(if step == "spindles" {
            let which = steps.next()?;
            let named = || names.iter().position(|name| name == which);
            let index = which.parse().ok().or_else(named)?;
            table.get(step)?.as_array()?.get(index)?
        } else {
            table.get(step)?
        });
    }
    at
}

/// Names of the spindles, here or in a machine that this one extends.
fn spindle_names(root: &Table) -> Vec<String> {
    let name = |spindle: &Value| Some(spindle.get("name")?.as_str()?.to_owned());
    let mut root = root.clone();
    for _ in 0..=MOST_BASES {
        let list = root.get("spindles").and_then(Value::as_array);
        let names: Vec<String> = list.into_iter().flatten().filter_map(name).collect();
        let base = root.get("extends").and_then(Value::as_str).and_then(embedded);
        match (names.is_empty(), base.and_then(|base| base.parse().ok())) {
            (true, Some(base)) => root = base,
            _ => return names,
        }
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::parse;
    use serde_json::json;

    const EXTENDS: &str = "extends = \"tapping-center\"\n";

    fn refused(key: &str, value: &Json) -> String {
        let text = changed(EXTENDS, key, value).unwrap();
        parse(&text, 0).unwrap_err().remove(0).message
    }

    #[test]
    fn a_changed_value_is_what_the_reader_reads() {
        let text = changed(EXTENDS, "axes.z.structure.backlash_um", &json!(7.5)).unwrap();
        let text = changed(&text, "spindles.spindle.inertia_kg_m2", &json!(0.02)).unwrap();
        let machine = parse(&text, 0).unwrap();
        let z = machine.axis(canon::Axis::Z).unwrap();
        assert_eq!(z.structure.backlash.of_linear().in_um(), 7.5);
        assert_eq!(machine.spindles[0].inertia.value(), 0.02);
        assert_eq!(value(&text, "axes.z.structure.backlash_um"), Some(json!(7.5)));
        assert_eq!(value(&text, "axes.x.structure.backlash_um"), Some(json!(1)));
        assert_eq!(value(&text, "spindles.0.inertia_kg_m2"), Some(json!(0.02)));
        assert_eq!(value(&text, "axes.z.structure.play_um"), None);
    }

    #[test]
    fn a_key_with_another_unit_is_unknown_and_the_right_one_is_named() {
        let said = refused("axes.z.structure.backlash_mm", &json!(0.01));
        assert!(
            said.contains("unknown key `backlash_mm`") && said.contains("`backlash_um`"),
            "{said}"
        );
    }

    #[test]
    fn a_value_out_of_bounds_or_of_another_type_is_refused_by_the_reader() {
        let said = refused("axes.z.structure.backlash_um", &json!(-1));
        assert!(said.contains("expected a number from 0"), "{said}");
        let said = refused("axes.z.structure.backlash_um", &json!("7 um"));
        assert!(said.contains("is text: expected a number"), "{said}");
    }

    #[test]
    fn a_key_that_leads_nowhere_is_refused() {
        let said = changed(EXTENDS, "name.x", &json!(1)).map(|text| parse(&text, 0).is_ok());
        assert_eq!(said, Ok(false));
        let said = changed("name = \"m\"\n", "name.x", &json!(1)).unwrap_err();
        assert_eq!(said, "name.x: name is no table");
        let said = changed(EXTENDS, "spindles.live.inertia_kg_m2", &json!(1)).unwrap_err();
        assert!(said.contains("there is no spindle live: expected spindle"), "{said}");
    }
}
