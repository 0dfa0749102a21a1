//! A document as a tree of elements, and its text: XML, or JSON as agents of the standard write it.
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// What an attribute or an element has: JSON writes numbers as numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    Text(Cow<'static, str>),
    Number(String),
}

impl Content {
    fn text(&self) -> &str {
        match self {
            Self::Text(text) => text,
            Self::Number(number) => number,
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::Text(text) => Value::from(text.as_ref()),
            Self::Number(number) => {
                serde_json::from_str(number).unwrap_or_else(|_| Value::from(number.as_str()))
            }
        }
    }
}

impl From<&'static str> for Content {
    fn from(text: &'static str) -> Self {
        Self::Text(Cow::Borrowed(text))
    }
}

impl From<String> for Content {
    fn from(text: String) -> Self {
        Self::Text(Cow::Owned(text))
    }
}

impl From<u64> for Content {
    fn from(number: u64) -> Self {
        Self::Number(number.to_string())
    }
}

/// An element: its attributes, its text, and what is in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    pub(crate) name: Cow<'static, str>,
    pub(crate) attributes: Vec<(&'static str, Content)>,
    pub(crate) content: Option<Content>,
    pub(crate) children: Vec<Self>,
}

/// Elements whose children JSON writes as a list, each with its name.
const LISTS: [&str; 13] = [
    "Devices",
    "Components",
    "DataItems",
    "Streams",
    "ComponentStreams",
    "Samples",
    "Events",
    "Condition",
    "Assets",
    "Measurements",
    "Errors",
    "Constraints",
    "CutterStatus",
];

impl Element {
    pub(crate) fn new(name: impl Into<Cow<'static, str>>) -> Self {
        Self { name: name.into(), attributes: Vec::new(), content: None, children: Vec::new() }
    }

    pub(crate) fn with(mut self, name: &'static str, value: impl Into<Content>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    pub(crate) fn holding(mut self, content: impl Into<Content>) -> Self {
        self.content = Some(content.into());
        self
    }

    pub(crate) fn containing(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.children.extend(children);
        self
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| *known == name).map(|(_, value)| value.text())
    }

    /// As an XML document.
    pub fn xml(&self) -> Vec<u8> {
        let mut writer = Writer::new(Vec::new());
        // a vector takes everything: nothing here can fail
        let _ = writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        self.write(&mut writer);
        writer.into_inner()
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) {
        let mut start = BytesStart::new(self.name.as_ref());
        for (name, value) in &self.attributes {
            start.push_attribute((*name, clean(value.text()).as_ref()));
        }
        if self.content.is_none() && self.children.is_empty() {
            let _ = writer.write_event(Event::Empty(start));
            return;
        }
        let _ = writer.write_event(Event::Start(start));
        if let Some(content) = &self.content {
            let _ = writer.write_event(Event::Text(BytesText::new(&clean(content.text()))));
        }
        for child in &self.children {
            child.write(writer);
        }
        let _ = writer.write_event(Event::End(BytesEnd::new(self.name.as_ref())));
    }

    /// As a JSON document in one line: an attribute is a member, text is `value`, lists keep their order and the names in them.
    pub fn json(&self) -> Vec<u8> {
        let document = json!({ self.name.as_ref(): self.value() });
        serde_json::to_vec(&document).unwrap_or_default() // strings, numbers and names alone
    }

    fn value(&self) -> Value {
        if LISTS.contains(&self.name.as_ref()) {
            let list =
                self.children.iter().map(|child| json!({ child.name.as_ref(): child.value() }));
            return Value::Array(list.collect());
        }
        if self.attributes.is_empty() && self.children.is_empty() {
            return self.content.as_ref().map_or_else(|| json!({}), Content::json);
        }
        let mut members = Map::new();
        for (name, value) in &self.attributes {
            if !name.starts_with("xmlns") && !name.starts_with("xsi:") {
                members.insert((*name).to_owned(), value.json());
            }
        }
        if let Some(content) = &self.content {
            members.insert("value".to_owned(), content.json());
        }
        for child in &self.children {
            let name = child.name.as_ref();
            // the streams of a device's components have no element around them in XML
            if name == "ComponentStream" {
                let list = members.entry("ComponentStreams").or_insert_with(|| json!([]));
                if let Value::Array(list) = list {
                    list.push(json!({ name: child.value() }));
                }
            } else {
                members.insert(name.to_owned(), child.value());
            }
        }
        Value::Object(members)
    }
}

/// Without what XML cannot have: control characters of a program's comment, for one.
fn clean(text: &str) -> Cow<'_, str> {
    let is_allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
    if text.chars().all(is_allowed) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if is_allowed(c) { c } else { char::REPLACEMENT_CHARACTER };
    Cow::Owned(text.chars().map(shown).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Element {
        let block =
            Element::new("Block").with("sequence", 7).holding("G1 (a<b & \"c\" \u{7})".to_owned());
        Element::new("ComponentStream")
            .with("componentId", "path")
            .containing([Element::new("Events").containing([block])])
    }

    #[test]
    fn whatever_a_program_has_in_its_text_the_document_is_xml() {
        let text = String::from_utf8(sample().xml()).expect("text");
        let read = roxmltree::Document::parse(&text).expect("XML");
        let block =
            read.descendants().find(|node| node.has_tag_name("Block")).expect("it is there");
        assert_eq!(block.text(), Some("G1 (a<b & \"c\" \u{fffd})"));
        assert_eq!(block.attribute("sequence"), Some("7"));
    }

    #[test]
    fn json_has_lists_of_named_observations_and_numbers() {
        let read: Value = serde_json::from_slice(&sample().json()).expect("JSON");
        let block = &read["ComponentStream"]["Events"][0]["Block"];
        assert_eq!(block["sequence"], 7);
        assert_eq!(block["value"], "G1 (a<b & \"c\" \u{7})");
    }
}
