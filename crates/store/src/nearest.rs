//! "Did you mean": the known name that is spelled most like a wrong one.

/// The name spelled most like `word`, if a third of its letters or fewer differ.
pub(crate) fn nearest<'n>(word: &str, names: &[&'n str]) -> Option<&'n str> {
    let rated = names.iter().map(|name| (edits(word, name), *name));
    let (distance, name) = rated.min_by_key(|(distance, _)| *distance)?;
    (distance * 3 <= word.chars().count().max(name.chars().count())).then_some(name)
}

/// Letters to insert, delete or replace to make one word of the other (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b = b.chars().take(64).collect::<Vec<_>>();
    let mut row = (0..=b.len()).collect::<Vec<_>>();
    for (i, from) in a.chars().take(64).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_letter_too_few_is_one_edit() {
        assert_eq!(edits("inerta_kg_m2", "inertia_kg_m2"), 1);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("kitten", "sitting"), 3);
    }

    #[test]
    fn a_word_unlike_all_others_has_no_neighbour() {
        assert_eq!(nearest("colour", &["rapid_mm_per_min", "backlash_um"]), None);
        assert_eq!(
            nearest("backlash_mm", &["rapid_mm_per_min", "backlash_um"]),
            Some("backlash_um")
        );
    }
}
