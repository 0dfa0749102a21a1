//! Documents that extend one another: on which others one is based.
use std::ops::Range;
use toml::de::DeTable;

/// The documents that one is based on, the nearest first.
pub(crate) fn bases(
    root: &DeTable<'_>,
    extends: &str,
    base_of: &dyn Fn(&str) -> Option<&'static str>,
) -> Result<Vec<DeTable<'static>>, (Range<usize>, String)> {
    /// Bases of bases.
    const MOST: usize = 8;
    let named = |table: &DeTable<'_>| {
        table.get(extends).map(|v| (v.span(), v.get_ref().as_str().map(str::to_owned)))
    };
    let mut found: Vec<DeTable<'static>> = Vec::new();
    let Some((at, mut name)) = named(root) else { return Ok(found) };
    while found.len() < MOST {
        let Some(text) = name.as_deref().and_then(base_of) else {
            let name = name.unwrap_or_default();
            return Err((at, format!("`{extends}`: there is no machine \"{name}\" to extend")));
        };
        found.push(DeTable::parse_recoverable(text).0.into_inner());
        match found.last().and_then(named) {
            Some((_, next)) => name = next,
            None => return Ok(found),
        }
    }
    Err((at, format!("`{extends}`: more than {MOST} machines extend one another")))
}
