//! Keys whose value is a list.
use super::Keys;
use crate::asked_key::span;
use std::ops::RangeInclusive;

impl<'d> Keys<'d> {
    /// A list of tables, at most so many; empty where it is not stated.
    pub(crate) fn optional_sections<T>(
        &mut self,
        key: &'static str,
        most: usize,
        mut read: impl FnMut(&mut Keys<'_>) -> T,
    ) -> Vec<T> {
        self.record(key, false, || format!("list of tables, {most} at most"));
        if self.ask(key).is_none() {
            self.record_heading(key, |keys| _ = read(keys));
            return Vec::new();
        }
        self.sections(key, most, read)
    }

    /// A list of numbers within bounds, if it is stated.
    pub(crate) fn optional_numbers(
        &mut self,
        key: &'static str,
        bounds: RangeInclusive<f64>,
    ) -> Option<Vec<f64>> {
        self.record(key, false, || format!("list of numbers, each {}", span(&bounds)));
        let value = self.ask(key)?;
        let Some(list) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "a list of numbers");
            return None;
        };
        list.iter().map(|item| self.checked(key, item, &bounds)).collect()
    }

    /// A list of texts; empty where it is not stated.
    pub(crate) fn optional_texts(&mut self, key: &'static str) -> Vec<String> {
        self.record(key, false, || "list of texts".into());
        let Some(value) = self.ask(key) else { return Vec::new() };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong_type(key, value, "a list of texts");
            return Vec::new();
        };
        list.iter().filter_map(|item| self.checked_text(key, item)).collect()
    }

    /// All entries of this table and of those that it is based on as yes or no, in their order.
    pub(crate) fn flags(&mut self) -> Vec<(String, bool)> {
        let mut found = Vec::new();
        for table in std::iter::once(self.table).chain(self.bases.clone()) {
            for (key, value) in table {
                let name: &'d str = key.get_ref();
                if self.asked.contains(&name) {
                    continue;
                }
                self.asked.push(name);
                match value.get_ref().as_bool() {
                    Some(on) => found.push((name.to_owned(), on)),
                    None => self.wrong_type(name, value, "true or false"),
                }
            }
        }
        found
    }
}
