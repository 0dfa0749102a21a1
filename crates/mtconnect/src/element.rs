//! A document as a tree of elements, and its text: XML, or JSON as the standard's own agent writes
//! it.
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

/// How JSON writes lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JsonForm {
    /// Version 1: in their order, each with its name: `[{"Block": …}, {"Line": …}, {"Block": …}]`.
    Listed,
    /// Version 2: by name, each name once: `{"Block": [ … ], "Line": [ … ]}`.
    Grouped,
}

/// Elements that are lists of others.
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

    /// As a JSON document in one line: an attribute is a member, text is `value`.
    pub fn json(&self, form: JsonForm) -> Vec<u8> {
        let mut value = self.value(form);
        if form == JsonForm::Grouped && self.name.starts_with("MTConnect") {
            let is_header = |child: &&Self| child.name == "Header";
            let version = self.children.iter().find(is_header).and_then(|h| h.attribute("version"));
            value["jsonVersion"] = 2.into();
            value["schemaVersion"] = version.into();
            value["Header"]["schemaVersion"] = version.into();
        }
        let document = json!({ self.name.as_ref(): value });
        serde_json::to_vec(&document).unwrap_or_default() // strings, numbers and names alone
    }

    fn value(&self, form: JsonForm) -> Value {
        if LISTS.contains(&self.name.as_ref()) {
            return self.list(form);
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
            match (name, form) {
                // the streams of a device's components have no element around them in XML
                ("ComponentStream", JsonForm::Listed) => {
                    append(&mut members, "ComponentStreams", json!({ name: child.value(form) }));
                }
                ("ComponentStream" | "ToolLife", _) => {
                    append(&mut members, name, child.value(form));
                }
                ("Entry", _) => {
                    let key = child.attribute("key").unwrap_or_default();
                    let content = child.content.as_ref().map_or(Value::Null, Content::json);
                    members.entry("value").or_insert_with(|| json!({}))[key] = content;
                }
                _ => {
                    members.insert(name.to_owned(), child.value(form));
                }
            }
        }
        Value::Object(members)
    }

    fn list(&self, form: JsonForm) -> Value {
        // one of a list is an object, also where it is a text alone
        let member = |child: &Self| match child.value(form) {
            value @ Value::Object(_) => value,
            value => json!({ "value": value }),
        };
        if form == JsonForm::Listed {
            let named = |child: &Self| json!({ child.name.as_ref(): member(child) });
            return Value::Array(self.children.iter().map(named).collect());
        }
        let mut groups = Map::new();
        for child in &self.children {
            append(&mut groups, &child.name, member(child));
        }
        Value::Object(groups)
    }
}

/// One more of a list that is a member.
fn append(members: &mut Map<String, Value>, name: &str, value: Value) {
    if let Value::Array(list) = members.entry(name).or_insert_with(|| json!([])) {
        list.push(value);
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
        let read: Value = serde_json::from_slice(&sample().json(JsonForm::Listed)).expect("JSON");
        let block = &read["ComponentStream"]["Events"][0]["Block"];
        assert_eq!(block["sequence"], 7);
        assert_eq!(block["value"], "G1 (a<b & \"c\" \u{7})");
    }

    #[test]
    fn json_of_version_2_has_each_name_once() {
        let event = |name, sequence: u64| Element::new(name).with("sequence", sequence);
        let count = Element::new("AssetCountDataSet")
            .containing([Element::new("Entry").with("key", "CuttingTool").holding(3)]);
        let events = [event("Block", 1), event("Line", 2), event("Block", 3), count];
        let stream =
            Element::new("ComponentStream").containing([Element::new("Events").containing(events)]);
        let header = Element::new("Header").with("version", "2.4");
        let device = Element::new("DeviceStream").containing([stream]);
        let streams = Element::new("Streams").containing([device]);
        let document = Element::new("MTConnectStreams").containing([header, streams]);
        let read: Value = serde_json::from_slice(&document.json(JsonForm::Grouped)).expect("JSON");
        let read = &read["MTConnectStreams"];
        assert_eq!((&read["jsonVersion"], &read["schemaVersion"]), (&json!(2), &json!("2.4")));
        assert_eq!(read["Header"], json!({ "version": "2.4", "schemaVersion": "2.4" }));
        let events = &read["Streams"]["DeviceStream"][0]["ComponentStream"][0]["Events"];
        assert_eq!(events["Block"], json!([{ "sequence": 1 }, { "sequence": 3 }]));
        assert_eq!(events["Line"], json!([{ "sequence": 2 }]));
        assert_eq!(events["AssetCountDataSet"], json!([{ "value": { "CuttingTool": 3 } }]));
    }
}
