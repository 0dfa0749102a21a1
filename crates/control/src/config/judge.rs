//! What the judge goes by.
use super::scatter::known_tools;
use canon::{Position, ToolLibrary};
use store::machine::{Follows, MachineFile, StockMaterial};
use units::Length;
use verify::{Bar, Config, Tolerances};

/// Class 6H, the shop's usual tolerances on such a machine, and the stock clamped at the
/// workpiece's zero.
pub fn judge(
    machine: &MachineFile,
    tools: &ToolLibrary,
    material: StockMaterial,
    zero: &Position,
) -> Config {
    Config {
        material: Some(material.material),
        tolerances: tolerances(machine.control.synchronisation.follows == Follows::Encoder),
        stock: Some(verify::Stock {
            from: [0, 1, 2].map(|i| zero.linear[i] + machine.setup.stock.from[i]),
            to: [0, 1, 2].map(|i| zero.linear[i] + machine.setup.stock.to[i]),
            zero: zero.linear,
        }),
        work_axis: [zero.linear[0], zero.linear[1]],
        wheel_width: machine.grinding.as_ref().map(|grinding| grinding.wheel.width),
        stock_radius: Some(machine.setup.stock.to[0]), // a bar, where it is turned
        bar: bar(machine, zero),
        ..Config::new(known_tools(tools))
    }
}

/// The stock, if the machine's first spindle turns it.
fn bar(machine: &MachineFile, zero: &Position) -> Option<Bar> {
    let radius = machine.turned_bar()?;
    let stock = &machine.setup.stock;
    Some(Bar {
        radius,
        bore: stock.bore / 2.0,
        face: zero.linear[2] + stock.to[2],
        rear: zero.linear[2] + stock.from[2],
    })
}

/// The shop's usual tolerances. Where the spindle turns back by itself and the feed only follows
/// it, a thread may run as much beyond its bottom as such a spindle repeats its stop.
pub fn tolerances(follows_encoder: bool) -> Tolerances {
    const TURNS_BACK_WITHIN: Length = Length::mm(0.05);
    let usual = Tolerances::default();
    Tolerances {
        thread_overrun: if follows_encoder { TURNS_BACK_WITHIN } else { usual.thread_overrun },
        ..usual
    }
}
