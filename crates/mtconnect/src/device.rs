//! The device model of a machine: its components and data items, made from the machine file.
//!
//! ```text
//!   Device ── Controller ── Path              mode, execution, program, line, overrides, tool, what was cut last
//!     │           └ emergency stop, alarms, messages
//!     └ Axes ── Linear X, Y, Z … Rotary A …   position of the machine and in the work, homed
//!         └──── Rotary S1 …                   spindles: speed, load, override
//! ```
use crate::element::Element;
use crate::items::{Category, Item, ItemKind};
use store::machine::MachineFile;
use units::AxisKind;

/// Version of the standard.
pub(crate) const VERSION: &str = "2.4";

/// Who a device is, and since when this agent watches it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Device {
    pub(crate) name: String,
    pub(crate) uuid: String,
    pub(crate) components: Vec<Component>,
    pub(crate) items: Vec<Item>,
    pub(crate) at: Places,
}

impl Eq for Item {}

/// A component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Component {
    pub(crate) id: String,
    /// Its element: `Controller`, `Linear`, …
    pub(crate) element: &'static str,
    pub(crate) name: String,
    parent: Option<usize>,
    description: Option<String>,
}

/// Numbers of the data items, by what they are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Places {
    pub(crate) availability: usize,
    pub(crate) asset_changed: usize,
    pub(crate) asset_removed: usize,
    pub(crate) asset_count: usize,
    pub(crate) emergency_stop: usize,
    pub(crate) alarms: usize,
    pub(crate) message: usize,
    pub(crate) power: usize,
    pub(crate) mode: usize,
    pub(crate) execution: usize,
    pub(crate) single_block: usize,
    pub(crate) optional_stop: usize,
    pub(crate) program: usize,
    pub(crate) line: usize,
    pub(crate) block: usize,
    pub(crate) part_count: usize,
    pub(crate) feedrate: usize,
    pub(crate) feed_override: usize,
    pub(crate) rapid_override: usize,
    pub(crate) tool: usize,
    pub(crate) tool_asset: usize,
    pub(crate) work_offset: usize,
    pub(crate) activity: usize,
    pub(crate) waiting_for: usize,
    pub(crate) recovery: usize,
    pub(crate) feature: usize,
    pub(crate) verdict: usize,
    pub(crate) class: usize,
    pub(crate) sync_error: usize,
    pub(crate) depth_error: usize,
    pub(crate) axes: Vec<AxisPlaces>,
    pub(crate) spindles: Vec<SpindlePlaces>,
}

/// Of an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AxisPlaces {
    pub(crate) machine: usize,
    pub(crate) work: usize,
    pub(crate) homed: usize,
    /// Of a drive that measures it.
    pub(crate) load: Option<usize>,
}

/// Of a spindle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SpindlePlaces {
    pub(crate) ordered: usize,
    pub(crate) measured: usize,
    pub(crate) load: usize,
    pub(crate) torque: usize,
    pub(crate) speed_override: usize,
}

/// What is built.
#[derive(Default)]
struct Parts {
    components: Vec<Component>,
    items: Vec<Item>,
}

impl Parts {
    fn component(
        &mut self,
        parent: Option<usize>,
        element: &'static str,
        id: &str,
        name: &str,
    ) -> usize {
        let (id, name) = (id.to_owned(), name.to_owned());
        self.components.push(Component { id, element, name, parent, description: None });
        self.components.len() - 1
    }

    fn item(&mut self, component: usize, id: &str, kind: ItemKind) -> usize {
        let id = match self.components[component].parent {
            None => id.to_owned(),
            Some(_) => format!("{}_{id}", self.components[component].id),
        };
        self.items.push(Item { id, kind, element: kind.element(), component });
        self.items.len() - 1
    }
}

impl Device {
    /// Of a machine.
    pub(crate) fn of(machine: &MachineFile, uuid: &str) -> Self {
        let mut parts = Parts::default();
        let device = parts.component(None, "Device", "d", &machine.name);
        parts.components[device].description = Some(machine.description.clone());
        let mut at = Places {
            availability: parts.item(device, "avail", ItemKind::event("AVAILABILITY")),
            asset_changed: parts.item(
                device,
                "asset_chg",
                ItemKind::event("ASSET_CHANGED").discrete(),
            ),
            asset_removed: parts.item(
                device,
                "asset_rem",
                ItemKind::event("ASSET_REMOVED").discrete(),
            ),
            asset_count: parts.item(device, "asset_count", ItemKind::event("ASSET_COUNT").set()),
            ..Places::default()
        };
        controller(&mut parts, device, &mut at);
        axes(&mut parts, device, machine, &mut at);
        let (name, uuid) = (machine.name.clone(), uuid.to_owned());
        Self { name, uuid, components: parts.components, items: parts.items, at }
    }

    /// Its part of a Devices document.
    pub(crate) fn element(&self) -> Element {
        self.component(0).with("uuid", self.uuid.clone()).with("mtconnectVersion", VERSION)
    }

    fn component(&self, number: usize) -> Element {
        let component = &self.components[number];
        let mut element = Element::new(component.element)
            .with("id", component.id.clone())
            .with("name", component.name.clone());
        if let Some(description) = &component.description {
            let description = Element::new("Description").holding(description.clone());
            element = element.containing([description.with("manufacturer", "Leadscrew")]);
        }
        let items: Vec<_> =
            self.items.iter().filter(|item| item.component == number).map(data_item).collect();
        if !items.is_empty() {
            element = element.containing([Element::new("DataItems").containing(items)]);
        }
        let below =
            (0..self.components.len()).filter(|n| self.components[*n].parent == Some(number));
        let below: Vec<_> = below.map(|number| self.component(number)).collect();
        if !below.is_empty() {
            element = element.containing([Element::new("Components").containing(below)]);
        }
        element
    }

    /// Number of a data item.
    pub(crate) fn number(&self, id: &str) -> Option<usize> {
        self.items.iter().position(|item| item.id == id)
    }
}

fn controller(parts: &mut Parts, device: usize, at: &mut Places) {
    let controller = parts.component(Some(device), "Controller", "cont", "controller");
    at.emergency_stop = parts.item(controller, "estop", ItemKind::event("EMERGENCY_STOP"));
    at.alarms = parts.item(controller, "alarms", ItemKind::condition("SYSTEM"));
    at.message = parts.item(controller, "message", ItemKind::event("MESSAGE").discrete());
    let path = parts.component(Some(controller), "Path", "path", "path");
    let mut of = |id: &str, kind: ItemKind| parts.item(path, id, kind);
    at.mode = of("mode", ItemKind::event("CONTROLLER_MODE"));
    at.execution = of("execution", ItemKind::event("EXECUTION"));
    let switch = ItemKind::event("CONTROLLER_MODE_OVERRIDE");
    at.single_block = of("single_block", switch.sub("SINGLE_BLOCK"));
    at.optional_stop = of("optional_stop", switch.sub("OPTIONAL_STOP"));
    at.program = of("program", ItemKind::event("PROGRAM"));
    at.line = of("line", ItemKind::event("LINE_NUMBER").sub("ABSOLUTE"));
    at.block = of("block", ItemKind::event("BLOCK"));
    at.part_count = of("part_count", ItemKind::event("PART_COUNT").sub("ALL"));
    at.feedrate =
        of("feedrate", ItemKind::sample("PATH_FEEDRATE", "MILLIMETER/SECOND", 2).sub("ACTUAL"));
    let percent = ItemKind::event("PATH_FEEDRATE_OVERRIDE").in_units("PERCENT", 1);
    at.feed_override = of("feed_override", percent.sub("PROGRAMMED"));
    at.rapid_override = of("rapid_override", percent.sub("RAPID"));
    at.tool = of("tool", ItemKind::event("TOOL_NUMBER"));
    at.tool_asset = of("tool_asset", ItemKind::event("TOOL_ASSET_ID"));
    at.work_offset = of("work_offset", ItemKind::event("WORK_OFFSET"));
    at.activity = of("activity", ItemKind::event("leadscrew:ACTIVITY"));
    at.waiting_for = of("waiting_for", ItemKind::event("leadscrew:WAITING_FOR"));
    at.recovery = of("recovery", ItemKind::event("leadscrew:RECOVERY_STATE"));
    at.feature = of("feature", ItemKind::event("leadscrew:FEATURE").discrete());
    at.verdict = of("verdict", ItemKind::event("leadscrew:VERDICT").discrete());
    at.class = of("class", ItemKind::event("leadscrew:THREAD_CLASS").discrete());
    let error = |name| ItemKind::sample(name, "MILLIMETER", 5).discrete();
    at.sync_error = of("sync_error", error("leadscrew:SYNC_ERROR").sub("MAXIMUM"));
    at.depth_error = of("depth_error", error("leadscrew:DEPTH_ERROR"));
}

fn axes(parts: &mut Parts, device: usize, machine: &MachineFile, at: &mut Places) {
    let axes = parts.component(Some(device), "Axes", "axes", "axes");
    at.power = parts.item(axes, "power", ItemKind::event("POWER_STATE").sub("CONTROL"));
    for axis in machine.axes.iter().flatten() {
        let name = axis.letter.letter().to_string();
        let (element, position) = match axis.letter.kind() {
            AxisKind::Linear => ("Linear", ItemKind::sample("POSITION", "MILLIMETER", 4)),
            AxisKind::Rotary => ("Rotary", ItemKind::sample("ANGLE", "DEGREE", 4)),
        };
        let id = name.to_ascii_lowercase();
        let component = parts.component(Some(axes), element, &id, &name);
        let position = position.sub("COMMANDED");
        at.axes.push(AxisPlaces {
            machine: parts.item(component, "machine", position.of("MACHINE")),
            work: parts.item(component, "work", position.of("WORK")),
            homed: parts.item(component, "homed", ItemKind::event("leadscrew:HOMED")),
            load: axis
                .drive
                .measured_torque
                .map(|_| parts.item(component, "load", ItemKind::sample("LOAD", "PERCENT", 0))),
        });
    }
    for number in 1..=machine.spindles.len() {
        let (id, name) = (format!("s{number}"), format!("S{number}"));
        let component = parts.component(Some(axes), "Rotary", &id, &name);
        let name = machine.spindles[number - 1].name.clone();
        parts.components[component].description = Some(name);
        let speed = ItemKind::sample("ROTARY_VELOCITY", "REVOLUTION/MINUTE", 1);
        let percent = ItemKind::event("ROTARY_VELOCITY_OVERRIDE").in_units("PERCENT", 1);
        parts.item(component, "mode", ItemKind::event("ROTARY_MODE").always("SPINDLE"));
        at.spindles.push(SpindlePlaces {
            ordered: parts.item(component, "ordered", speed.sub("COMMANDED")),
            measured: parts.item(component, "measured", speed.sub("ACTUAL")),
            load: parts.item(component, "load", ItemKind::sample("LOAD", "PERCENT", 0)),
            torque: parts.item(component, "torque", ItemKind::sample("TORQUE", "NEWTON_METER", 2)),
            speed_override: parts.item(component, "override", percent),
        });
    }
}

fn data_item(item: &Item) -> Element {
    let kind = &item.kind;
    let mut element = Element::new("DataItem")
        .with("id", item.id.clone())
        .with("category", kind.category.name())
        .with("type", kind.name);
    let attributes = [
        ("subType", kind.sub),
        ("units", kind.units),
        ("nativeUnits", kind.units),
        ("coordinateSystem", kind.coordinates),
        ("representation", kind.is_set.then_some("DATA_SET")),
        ("discrete", (kind.is_discrete && kind.category == Category::Event).then_some("true")),
    ];
    for (name, value) in attributes {
        if let Some(value) = value {
            element = element.with(name, value);
        }
    }
    if let Some(value) = kind.always {
        let value = Element::new("Value").holding(value);
        element = element.containing([Element::new("Constraints").containing([value])]);
    }
    element
}
