//! What tests of reading and printing compare.
use gcode::Block;

/// All that a block says, and not where it stands: its data without their spans.
pub(crate) fn content(block: &Block) -> String {
    let mut rest = &*format!("{block:?}");
    let mut content = String::new();
    while let Some((before, behind)) = rest.split_once("Span {") {
        content.push_str(before);
        rest = behind.split_once('}').map_or("", |(_, behind)| behind);
    }
    content + rest
}
