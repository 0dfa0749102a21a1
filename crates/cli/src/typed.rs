//! What was typed behind `leadscrew run`, kept so that the recovery can print the whole command
//! that goes on.
//!
//! Where the machine simulator is, where its state is kept, where to begin and what the operator
//! ordered belong to one run; everything else (machine, tools, dialect, cams, parameters, learning,
//! report files) belongs to the job.

use std::sync::OnceLock;

/// Options that belong to one run, each with a value.
const OF_ONE_RUN: [&str; 5] = ["--simulator", "--iron", "--state", "--from", "--operator"];

/// What only says how much is printed.
const SAYS: [&str; 4] = ["-q", "--quiet", "--log", "--timings"];

/// The words of this process, the first of which is its name.
static ALL: OnceLock<Vec<String>> = OnceLock::new();

/// Keep the words that were typed: once, at the beginning.
pub(crate) fn keep(words: Vec<String>) {
    let _ = ALL.set(words); // what was typed first counts
}

/// They.
pub(crate) fn all() -> &'static [String] {
    ALL.get().map_or(&[], Vec::as_slice)
}

/// Those of a run that belong to its job.
pub(crate) fn of_this_run() -> Vec<String> {
    of_job(all().iter().cloned())
}

pub(crate) fn of_job(typed: impl Iterator<Item = String>) -> Vec<String> {
    let mut words = typed.skip_while(|word| word != "run").skip(1);
    let mut kept = Vec::new();
    while let Some(word) = words.next() {
        if OF_ONE_RUN.contains(&word.as_str()) {
            words.next();
        } else if !SAYS.contains(&word.as_str())
            && !OF_ONE_RUN.iter().any(|option| is_with_value(&word, option))
        {
            kept.push(word);
        }
    }
    kept
}

/// `--option=value`
fn is_with_value(word: &str, option: &str) -> bool {
    word.strip_prefix(option).is_some_and(|rest| rest.starts_with('='))
}

/// The value of an option.
pub(crate) fn value<'a>(words: &'a [String], option: &str) -> Option<&'a str> {
    let at = words.iter().position(|word| word == option || is_with_value(word, option))?;
    match words[at].strip_prefix(option)?.strip_prefix('=') {
        Some(value) => Some(value),
        None => words.get(at + 1).map(String::as_str),
    }
}

/// Words as a shell reads them.
pub(crate) fn joined(words: &[String]) -> String {
    let words: Vec<_> = words.iter().map(|word| quoted(word)).collect();
    words.join(" ")
}

/// A word as a shell reads it.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn what_belongs_to_the_job_is_kept_in_order() {
        let typed = "leadscrew -q run part.nc --log --simulator /tmp/i --cams cams.toml --state=/tmp/s --from 12 --machine=a.toml";
        let kept = of_job(words(typed).into_iter());
        assert_eq!(kept, words("part.nc --cams cams.toml --machine=a.toml"));
        assert_eq!(value(&kept, "--machine"), Some("a.toml"));
        assert_eq!((value(&kept, "--cams"), value(&kept, "--tools")), (Some("cams.toml"), None));
    }

    #[test]
    fn a_shell_reads_words_as_they_were() {
        let odd = ["my part.ngc", "it's", "", "--size=M6", "$HOME"].map(str::to_owned);
        assert_eq!(joined(&odd), r"'my part.ngc' 'it'\''s' '' --size=M6 '$HOME'");
    }
}
