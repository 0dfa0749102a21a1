//! Tools that broke and were not renewed since: what a run leaves in a state folder for the next
//! one, beside the tools of a control.
//!
//! ```text
//!   broken-tools.toml   tools = [3, 5]                       of runs
//!   tools.toml          life = { …, broken = true }          of a control
//! ```
use crate::output::write_file;
use crate::text::read_text;
use std::collections::BTreeSet;
use std::path::Path;

const FILE: &str = "broken-tools.toml";
/// The tools of a control.
const CONTROLS_TOOLS: &str = "tools.toml";
/// A file that is longer is none of these.
const LONGEST: u64 = 1 << 26;

/// A file that is not there, or is none of these, says nothing.
fn read(folder: &Path, file: &str) -> String {
    read_text(&folder.join(file), "state", LONGEST).unwrap_or_default()
}

/// Tools that broke in runs.
pub fn of_runs(folder: &Path) -> BTreeSet<u32> {
    let text = read(folder, FILE);
    let list = text.split_once('[').and_then(|(_, rest)| rest.split_once(']'));
    let numbers = list.map_or("", |(numbers, _)| numbers).split(',');
    numbers.filter_map(|number| number.trim().parse().ok()).collect()
}

/// Tools that broke in runs, and under a control.
pub fn of_all(folder: &Path) -> BTreeSet<u32> {
    let text = read(folder, CONTROLS_TOOLS);
    let tools = crate::tools::parse_controls_toml(&text).unwrap_or_default();
    let broken = tools.iter().filter(|tool| tool.life.is_broken).map(|tool| tool.number);
    broken.chain(of_runs(folder)).collect()
}

/// Keeps the tools that are broken after a run.
///
/// # Errors
/// The folder cannot be written.
pub fn keep(folder: &Path, broken: &BTreeSet<u32>) -> Result<(), String> {
    if *broken == of_runs(folder) {
        return Ok(());
    }
    let list: Vec<String> = broken.iter().map(u32::to_string).collect();
    let text = format!(
        "# Tools that broke in runs, and in whose place no new one is: --renew-tool N of `run`, or `tool N renew` of a control.\ntools = [{}]\n",
        list.join(", ")
    );
    let path = folder.join(FILE);
    std::fs::create_dir_all(folder).map_err(|why| format!("{}: {why}", folder.display()))?;
    write_file(&path, text.as_bytes())
        .map_err(|why| format!("which tools are broken is not kept: {why}"))
}

/// A new one is in the place of a tool.
///
/// # Errors
/// The folder cannot be written.
pub fn is_renewed(folder: &Path, number: u32) -> Result<(), String> {
    let mut broken = of_runs(folder);
    if broken.remove(&number) { keep(folder, &broken) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tools_are_broken_until_they_are_renewed() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("state");
        assert!(of_all(&folder).is_empty());
        keep(&folder, &BTreeSet::from([3, 5])).unwrap();
        assert_eq!(of_all(&folder), BTreeSet::from([3, 5]));
        is_renewed(&folder, 3).unwrap();
        assert_eq!(of_all(&folder), BTreeSet::from([5]));
        let table = include_str!("../../../../programs/tools.toml");
        let mut tools = crate::tools::parse_toml(table, 0).unwrap().library;
        let mut broken = tools.get(7).unwrap().clone();
        broken.life.is_broken = true;
        tools.insert(broken);
        std::fs::write(folder.join("tools.toml"), crate::tools::to_toml(&tools)).unwrap();
        assert_eq!(of_all(&folder), BTreeSet::from([5, 7]));
    }
}
