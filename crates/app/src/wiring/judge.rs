//! What the judge goes by.
use canon::{Position, ToolLibrary};
use store::machine::{MachineFile, Material};
use verify::Config;

/// Class 6H, the shop's usual tolerances, and the stock clamped at the workpiece's zero.
pub(crate) fn judge(
    machine: &MachineFile,
    tools: &ToolLibrary,
    material: Material,
    zero: &Position,
) -> Config {
    Config {
        material: known(material),
        stock_top: Some(zero.linear[2] + machine.setup.stock.to[2]),
        work_axis: [zero.linear[0], zero.linear[1]],
        stock_radius: Some(machine.setup.stock.to[0]), // a bar, where it is turned
        ..Config::new(tools.clone())
    }
}

fn known(material: Material) -> Option<verify::Material> {
    match material.name {
        "C45" => Some(verify::Material::CarbonSteel),
        "42CrMo4" => Some(verify::Material::AlloySteel),
        "stainless" => Some(verify::Material::Stainless),
        "GG25" => Some(verify::Material::CastIron),
        "AlSi" => Some(verify::Material::Aluminium),
        "brass" => Some(verify::Material::Brass),
        _ => None,
    }
}
