//! `cargo xtask parity`: does Leadscrew's interpreter say what LinuxCNC's says?
//!
//! Recorded: on the programs of `crates/interp/tests/parity`, beside which lies what LinuxCNC 2.9
//! printed or said. Live: on any folder of programs, with the `rs274` that is installed.

use crate::listing::{Outcome, first_difference, ours, positive_zeros, tools};
use crate::rs274::Rs274;
use canon::ToolLibrary;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// How many programs there are of each kind.
#[derive(Default)]
struct Count {
    agree: usize,
    differ: usize,
    refused_by_us: usize,
    refused_by_both: usize,
    accepted_by_us: usize,
    endless: usize,
    known: usize,
    new: usize,
    differences: BTreeSet<(String, &'static str)>,
}

impl Count {
    /// With the differences that docs/linuxcnc-differences.md names.
    fn new() -> Result<Self, String> {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/linuxcnc-differences.md");
        Ok(Self { differences: named(&read_text(&page)?), ..Self::default() })
    }

    /// Whether this is one of the named differences; counts it, and says which it is.
    fn mark(&mut self, name: &str, how: &'static str) -> &'static str {
        if self.differences.contains(&(stem(Path::new(name)), how)) {
            self.known += 1;
            "known"
        } else {
            self.new += 1;
            "NEW"
        }
    }

    /// Compares one program and prints where the two do not agree.
    fn compare(&mut self, name: &str, theirs: &Outcome, ours: &Outcome) {
        match (theirs, ours) {
            (Outcome::Accepted(theirs), Outcome::Accepted(ours)) => {
                let Some((line, a, b)) = first_difference(theirs, ours) else {
                    self.agree += 1;
                    return;
                };
                self.differ += 1;
                let mark = self.mark(name, "differs");
                println!(
                    "{mark:<5} differs  {name}, call {line}:\n         LinuxCNC  {a}\n         Leadscrew {b}"
                );
            }
            (Outcome::Accepted(_), Outcome::Refused(why)) => {
                self.refused_by_us += 1;
                let mark = self.mark(name, "refused");
                println!("{mark:<5} refused  {name}: {why}");
            }
            (Outcome::Refused(_), Outcome::Refused(_)) => self.refused_by_both += 1,
            (Outcome::Refused(why), Outcome::Accepted(_)) => {
                self.accepted_by_us += 1;
                let mark = self.mark(name, "accepted");
                println!("{mark:<5} accepted {name}, which LinuxCNC refuses: {why}");
            }
        }
    }

    fn print(&self) {
        let accepted = self.agree + self.differ + self.refused_by_us;
        let refused = self.refused_by_both + self.accepted_by_us;
        println!(
            "\nLinuxCNC accepts {accepted}: {} agree, {} differ, {} refused by Leadscrew (not implemented, or \
             refused on purpose).\nLinuxCNC refuses {refused}: {} refused by both, {} accepted by Leadscrew.",
            self.agree, self.differ, self.refused_by_us, self.refused_by_both, self.accepted_by_us
        );
        println!(
            "{:.1} % of what LinuxCNC accepts agree; {} known differences, {} new ones.",
            100.0 * self.agree as f64 / accepted.max(1) as f64,
            self.known,
            self.new
        );
        if self.endless > 0 {
            println!("LinuxCNC does not end within its time limit on {}.", self.endless);
        }
    }
}

/// Compares with what was recorded. False if a difference is found that is not a known one.
pub(crate) fn recorded() -> Result<bool, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/interp/tests/parity");
    let mut count = Count::new()?;
    for program in programs(&root.join("good"))? {
        let listing = read_text(&program.with_extension("canon"))?;
        let theirs = Outcome::Accepted(listing.lines().map(positive_zeros).collect());
        count.compare(&stem(&program), &theirs, &ours(&read(&program)?, ToolLibrary::default()));
    }
    for program in programs(&root.join("bad"))? {
        let said = read_text(&program.with_extension("err"))?;
        let theirs = Outcome::Refused(said.lines().next().unwrap_or_default().to_owned());
        count.compare(&stem(&program), &theirs, &ours(&read(&program)?, ToolLibrary::default()));
    }
    count.print();
    Ok(count.new == 0)
}

/// Compares with the installed `rs274` on all programs under the paths.
pub(crate) fn live(paths: &[&str]) -> Result<bool, String> {
    let (rs274, tools, mut count) = (Rs274::new()?, tools(), Count::new()?);
    for path in paths {
        for program in programs(Path::new(path))? {
            let program = fs::canonicalize(&program).map_err(|e| format!("{path}: {e}"))?;
            match rs274.list(&program)? {
                None => count.endless += 1,
                Some(theirs) => {
                    let ours = ours(&read(&program)?, tools.clone());
                    count.compare(&program.display().to_string(), &theirs, &ours);
                }
            }
        }
    }
    count.print();
    Ok(count.new == 0)
}

/// The programs and the ways in which they differ, of the page's table.
fn named(page: &str) -> BTreeSet<(String, &'static str)> {
    let row = |line: &str| {
        let mut cells = line.split('|').map(str::trim).skip(1);
        let program = cells.next()?.strip_prefix('`')?.strip_suffix('`')?.to_owned();
        let found = cells.next()?;
        let how = ["differs", "refused", "accepted"].into_iter().find(|how| *how == found)?;
        Some((program, how))
    };
    page.lines().filter_map(row).collect()
}

/// All `.ngc` files under a folder, or the one file, in alphabetical order.
fn programs(path: &Path) -> Result<Vec<PathBuf>, String> {
    if path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = Vec::new();
    let entries = fs::read_dir(path).map_err(|e| format!("{}: {e}", path.display()))?;
    for entry in entries {
        let entry = entry.map_err(|e| format!("{}: {e}", path.display()))?;
        // a link may lead in a circle: folders are followed, links to folders are not
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            found.extend(programs(&entry.path())?);
        } else if entry.path().extension().is_some_and(|e| e.eq_ignore_ascii_case("ngc"))
            && entry.path().is_file()
        {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn read_text(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_difference_is_known_by_its_program_and_its_kind() {
        let known =
            super::named("| program | how |\n| `a` | differs | so |\n| `b` | unlike | so |\n");
        assert_eq!(known.into_iter().collect::<Vec<_>>(), [("a".to_owned(), "differs")]);
    }

    #[test]
    fn what_leadscrew_accepts_of_the_recorded_programs_it_lists_as_linuxcnc_does() {
        assert_eq!(super::recorded(), Ok(true));
    }
}
