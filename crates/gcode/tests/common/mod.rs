//! What tests of reading and printing compare.
use gcode::Block;

/// All that a block says, and not where it stands: its data without their spans, each expression
/// and each text where it belongs. In which order a block keeps them depends on the order in which
/// words and settings were written.
pub(crate) fn content(block: &Block) -> String {
    let said = without_spans(&format!("{block:?}"));
    let Some((head, tail)) = said.split_once(", nodes: [") else { return said };
    let Some((nodes, texts)) = tail.split_once("], texts: \"") else { return said };
    let texts = unescaped(texts.strip_suffix("\" }").unwrap_or(texts));
    let nodes: Vec<&str> =
        nodes.split("Node { expr: ").skip(1).map(|node| node.trim_end_matches(", ")).collect();
    let mut content = String::new();
    in_place(head, &nodes, texts.as_bytes(), &mut content);
    content
}

fn without_spans(said: &str) -> String {
    let (mut rest, mut bare) = (said, String::new());
    while let Some((before, behind)) = rest.split_once("Span {") {
        bare.push_str(before);
        rest = behind.split_once('}').map_or("", |(_, behind)| behind);
    }
    bare + rest
}

/// What is named by its number is put where it is named.
fn in_place(mut said: &str, nodes: &[&str], texts: &[u8], content: &mut String) {
    while let Some(at) =
        [said.find("ExprId("), said.find("Text { start: ")].into_iter().flatten().min()
    {
        content.push_str(&said[..at]);
        let named = &said[at..];
        let end = named.find([')', '}']).map_or(named.len(), |end| end + 1);
        let numbers: Vec<usize> = named[..end]
            .split(|c: char| !c.is_ascii_digit())
            .filter_map(|n| n.parse().ok())
            .collect();
        match numbers[..] {
            [node] => in_place(nodes.get(node).unwrap_or(&"no node"), nodes, texts, content),
            [from, to] => {
                let text = texts.get(from..to).unwrap_or(b"no text");
                content.push_str(&format!("{:?}", String::from_utf8_lossy(text)));
            }
            _ => content.push_str(&named[..end]),
        }
        said = &named[end..];
    }
    content.push_str(said);
}

/// A text as it was before `{:?}`.
fn unescaped(text: &str) -> String {
    let (mut plain, mut chars) = (String::new(), text.chars());
    while let Some(c) = chars.next() {
        if c != '\\' {
            plain.push(c);
            continue;
        }
        plain.push(match chars.next().unwrap_or(c) {
            'n' => '\n',
            'r' => '\r',
            't' => '\t',
            '0' => '\0',
            'u' => {
                let code: String = chars.by_ref().skip(1).take_while(|c| *c != '}').collect();
                u32::from_str_radix(&code, 16).ok().and_then(char::from_u32).unwrap_or('?')
            }
            c => c,
        });
    }
    plain
}
