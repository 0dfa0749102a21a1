//! Documents of the standard: Devices, Streams, Assets, Error.
use crate::buffer::{Observation, Value};
use crate::device::{Device, VERSION};
use crate::element::{Content, Element};
use crate::items::{Category, Item};
use crate::query::QueryError;
use canon::Tool;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// What a document is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subject {
    Devices,
    Streams,
    Assets,
    Error,
}

impl Subject {
    /// The root with its namespaces, empty.
    fn root(self) -> Element {
        let [name, space, location] = match self {
            Self::Devices => [
                "MTConnectDevices",
                "urn:mtconnect.org:MTConnectDevices:2.4",
                "urn:mtconnect.org:MTConnectDevices:2.4 http://schemas.mtconnect.org/schemas/MTConnectDevices_2.4.xsd",
            ],
            Self::Streams => [
                "MTConnectStreams",
                "urn:mtconnect.org:MTConnectStreams:2.4",
                "urn:mtconnect.org:MTConnectStreams:2.4 http://schemas.mtconnect.org/schemas/MTConnectStreams_2.4.xsd \
                 urn:leadscrew:streams:1.0 /mtconnect/schemas/leadscrew-streams-1.0.xsd",
            ],
            Self::Assets => [
                "MTConnectAssets",
                "urn:mtconnect.org:MTConnectAssets:2.4",
                "urn:mtconnect.org:MTConnectAssets:2.4 http://schemas.mtconnect.org/schemas/MTConnectAssets_2.4.xsd",
            ],
            Self::Error => [
                "MTConnectError",
                "urn:mtconnect.org:MTConnectError:2.4",
                "urn:mtconnect.org:MTConnectError:2.4 http://schemas.mtconnect.org/schemas/MTConnectError_2.4.xsd",
            ],
        };
        let root = Element::new(name).with("xmlns", space);
        let root = match self {
            Self::Streams => root.with("xmlns:leadscrew", "urn:leadscrew:streams:1.0"),
            Self::Devices | Self::Assets | Self::Error => root,
        };
        root.with("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance")
            .with("xsi:schemaLocation", location)
    }
}

/// What every header says.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    pub(crate) subject: Subject,
    pub(crate) instance: u64,
    pub(crate) made_ms: u64,
    pub(crate) model_ms: u64,
    /// What only this kind of document says.
    pub(crate) more: Vec<(&'static str, u64)>,
}

impl Header {
    /// The document.
    pub(crate) fn over(self, body: Element) -> Element {
        let mut header = Element::new("Header")
            .with("version", VERSION)
            .with("creationTime", date(self.made_ms))
            .with("instanceId", self.instance)
            .with("sender", "leadscrew");
        if self.subject != Subject::Error {
            header = header.with("deviceModelChangeTime", date(self.model_ms));
        }
        for (name, value) in self.more {
            header = header.with(name, value);
        }
        self.subject.root().containing([header, body])
    }
}

/// A date as the standard writes it, UTC.
pub(crate) fn date(unix_ms: u64) -> String {
    let date = OffsetDateTime::from_unix_timestamp_nanos(i128::from(unix_ms) * 1_000_000);
    // a clock that is set to a year of five digits is none
    let text = date.ok().and_then(|date| date.format(&Rfc3339).ok());
    text.unwrap_or_else(|| "1970-01-01T00:00:00Z".to_owned())
}

/// The observations of a device, by component and category; each list keeps its order.
pub(crate) fn streams<'a>(
    device: &Device,
    observations: impl Iterator<Item = &'a Observation>,
) -> Element {
    let mut by_component: Vec<[Vec<Element>; 3]> = Vec::new();
    by_component.resize_with(device.components.len(), Default::default);
    for seen in observations {
        let item = &device.items[seen.item];
        by_component[item.component][item.kind.category as usize].push(observation(item, seen));
    }
    let mut stream = Element::new("DeviceStream")
        .with("name", device.name.clone())
        .with("uuid", device.uuid.clone());
    for (component, lists) in device.components.iter().zip(by_component) {
        let categories = [Category::Sample, Category::Event, Category::Condition];
        let lists = categories.into_iter().zip(lists).filter(|(_, list)| !list.is_empty());
        let lists: Vec<_> =
            lists.map(|(category, list)| Element::new(category.list()).containing(list)).collect();
        if !lists.is_empty() {
            stream.children.push(
                Element::new("ComponentStream")
                    .with("component", component.element)
                    .with("name", component.name.clone())
                    .with("componentId", component.id.clone())
                    .containing(lists),
            );
        }
    }
    Element::new("Streams").containing([stream])
}

fn observation(item: &Item, seen: &Observation) -> Element {
    let kind = &item.kind;
    let name = match &seen.value {
        Value::Normal => "Normal".into(),
        Value::Fault(_) => "Fault".into(),
        Value::Unavailable if kind.category == Category::Condition => "Unavailable".into(),
        _ => item.element.clone(),
    };
    let mut element = Element::new(name)
        .with("dataItemId", item.id.clone())
        .with("timestamp", date(seen.unix_ms))
        .with("sequence", seen.sequence);
    if let Some(sub) = kind.sub {
        element = element.with("subType", sub);
    }
    if kind.category == Category::Condition {
        element = element.with("type", kind.name);
    }
    if matches!(kind.name, "ASSET_CHANGED" | "ASSET_REMOVED") {
        element = element.with("assetType", "CuttingTool");
    }
    match &seen.value {
        Value::Normal => element,
        Value::Unavailable if kind.is_set => element.with("count", 0).holding("UNAVAILABLE"),
        Value::Unavailable if kind.category == Category::Condition => element,
        Value::Unavailable => element.holding("UNAVAILABLE"),
        Value::Word(word) => element.holding(*word),
        Value::Text(text) => element.holding(text.to_string()),
        Value::Count(count) => element.holding(*count),
        Value::Number(value) => {
            let digits = usize::from(kind.decimals);
            element.holding(Content::Number(format!("{value:.digits$}")))
        }
        Value::Assets(count) => {
            let entry = Element::new("Entry").with("key", "CuttingTool").holding(*count);
            element.with("count", 1).containing([entry])
        }
        Value::Fault(fault) => element
            .with("conditionId", fault.id.clone())
            .with("nativeCode", fault.native_code.clone())
            .with("nativeSeverity", "stops the machine")
            .holding(fault.text.clone()),
    }
}

/// A tool of the control's table, when it was changed last, and whether it is gone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Asset {
    pub(crate) id: String,
    pub(crate) unix_ms: u64,
    pub(crate) is_removed: bool,
    pub(crate) tool: Tool,
}

/// What all cutting tools are.
pub(crate) const CUTTING_TOOL: &str = "CuttingTool";

impl Asset {
    pub(crate) fn element(&self, uuid: &str) -> Element {
        let tool = &self.tool;
        let mut element = Element::new(CUTTING_TOOL)
            .with("assetId", self.id.clone())
            .with("timestamp", date(self.unix_ms))
            .with("deviceUuid", uuid.to_owned())
            .with("serialNumber", self.id.clone())
            .with("toolId", format!("T{}", tool.number));
        if self.is_removed {
            element = element.with("removed", "true");
        }
        if !tool.description.is_empty() {
            let text = tool.description.clone();
            element = element.containing([Element::new("Description").holding(text)]);
        }
        let status = if tool.life.reached().is_some() { "EXPIRED" } else { "AVAILABLE" };
        let status = Element::new("Status").holding(status);
        let mut life = Element::new("CuttingToolLifeCycle")
            .containing([Element::new("CutterStatus").containing([status])]);
        let uses = tool.life.limit.uses.map(|most| (u64::from(tool.life.used.uses), most));
        if let Some((used, most)) = uses {
            life.children.push(
                Element::new("ToolLife")
                    .with("type", "PART_COUNT")
                    .with("countDirection", "UP")
                    .with("limit", u64::from(most))
                    .holding(used),
            );
        }
        let minutes = tool.life.limit.time.map(|most| (tool.life.used.time, most));
        if let Some((used, most)) = minutes {
            let minutes =
                |time: units::Time| Content::Number(format!("{:.2}", time.value() / 60.0));
            life.children.push(
                Element::new("ToolLife")
                    .with("type", "MINUTES")
                    .with("countDirection", "UP")
                    .with("limit", minutes(most))
                    .holding(minutes(used)),
            );
        }
        life.children.push(Element::new("ProgramToolNumber").holding(u64::from(tool.number)));
        let location = Element::new("Location").with("type", "POT");
        life.children.push(location.holding(u64::from(tool.pocket)));
        let measures = [
            ("FunctionalLength", "LF", tool.length + tool.wear.length),
            ("CuttingDiameterMax", "DC", tool.diameter + tool.wear.radius * 2.0),
        ];
        let measures: Vec<_> = measures
            .into_iter()
            .filter(|(_, _, value)| value.value().is_finite())
            .map(|(name, code, value)| {
                Element::new(name)
                    .with("code", code)
                    .with("units", "MILLIMETER")
                    .holding(Content::Number(format!("{:.4}", value.value())))
            })
            .collect();
        if !measures.is_empty() {
            life.children.push(Element::new("Measurements").containing(measures));
        }
        element.containing([life])
    }
}

/// What is wrong with a request.
pub(crate) fn errors(errors: &[QueryError]) -> Element {
    let errors = errors.iter().map(|error| {
        Element::new("Error").with("errorCode", error.code.name()).holding(error.text.clone())
    });
    Element::new("Errors").containing(errors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_utc() {
        assert_eq!(date(0), "1970-01-01T00:00:00Z");
        assert_eq!(date(1_795_603_012_345), "2026-11-25T10:36:52.345Z");
    }
}
