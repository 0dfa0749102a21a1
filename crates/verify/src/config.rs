//! What the judge is told beforehand: the tools, what was asked of the workpiece, the material.
use crate::{Bar, MillStock, Stock, ThreadClass};
use canon::{CamLibrary, Flute, Material, Tool, ToolLibrary};
use units::{Angle, Length, Torque};

/// What to judge by.
#[derive(Clone, Debug)]
pub struct Config {
    /// The tools a program may call.
    pub tools: ToolLibrary,
    /// The cams a program may grind.
    pub cams: CamLibrary,
    /// Class asked of threads, such as 6H; of inch threads the corresponding one is asked.
    pub class: ThreadClass,
    /// What may be off.
    pub tolerances: Tolerances,
    /// What is cut, for the torque a sharp tap would need; `None`: no expectation.
    pub material: Option<Material>,
    /// The stock as it is clamped. Depths count from it, by the length of the tool that is really
    /// in the spindle; without it what was cut is not known, and holes and threads are not judged.
    /// Its zero is that of the work offset G54, in which messages give places.
    pub stock: Option<Stock>,
    /// Mills that only the program's comments describe: what they cut is followed, and never found
    /// good.
    pub described_mills: ToolLibrary,
    /// The stock that is milled; `None`: what mills cut is not judged.
    pub mill_stock: Option<MillStock>,
    /// Width of the grinding wheel; `None`: cams at one place along the work lie over one another
    /// alone.
    pub wheel_width: Option<Length>,
    /// The blank that gears are hobbed of, as a program states it; `None`: the stock is it.
    pub gear_blank: Option<Stock>,
    /// Machine coordinates, X and Y, of the axis about which the work turns.
    pub work_axis: [Length; 2],
    /// Radius of the bar that is turned; `None`: nothing limits what is cut.
    pub stock_radius: Option<Length>,
    /// The bar that threads are turned on; `None`: the work is no bar about the spindle's axis.
    pub bar: Option<Bar>,
    /// Axial play, flank to flank, of the tap's *following* teeth in the groove that its leading
    /// teeth have cut: back taper and relief make them thinner. The leading teeth have none.
    pub flank_clearance: Length,
    /// fα: what the tap's flank angle error takes from the virtual pitch diameter.
    pub flank_angle_allowance: Length,
    /// Taps were synchronised with the spindle, so that it can be asked where their threads start.
    pub synchronised: bool,
    /// Holes that no one has seen drilled are there: the program or its operator states it.
    pub pre_drilled: bool,
}

impl Config {
    /// The tool by its number, for milling: as the table has it, or as the program's comments
    /// describe it.
    pub(crate) fn mill(&self, number: u32) -> Option<&Tool> {
        self.described_mills.get(number).or_else(|| self.tools.get(number))
    }

    /// Class 6H, default tolerances, no material, no stock, a tap whose
    /// following teeth are as thick as its leading ones (the strictest assumption).
    pub fn new(tools: ToolLibrary) -> Self {
        Self {
            tools,
            cams: CamLibrary::default(),
            class: ThreadClass::H6,
            tolerances: Tolerances::default(),
            material: None,
            stock: None,
            described_mills: ToolLibrary::default(),
            mill_stock: None,
            wheel_width: None,
            gear_blank: None,
            work_axis: [Length::ZERO; 2],
            stock_radius: None,
            bar: None,
            flank_clearance: Length::ZERO,
            flank_angle_allowance: Length::ZERO,
            synchronised: true,
            pre_drilled: false,
        }
    }
}

/// What may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Depth of a hole, each way.
    pub hole_depth: Length,
    /// Position of a hole or thread across the tool.
    pub position: Length,
    /// Depth of a thread, each way.
    pub thread_depth: Length,
    /// How far a tap may run beyond the programmed bottom: less than `thread_depth`, because below
    /// a blind hole's thread there is its bottom.
    pub thread_overrun: Length,
    /// Largest sync error in the material; `None`: only its effect on the thread counts.
    pub sync_error: Option<Length>,
    /// Of a turned thread: distance from its helix, error of the lead over its length, and passes
    /// beside one another.
    pub turned_thread: Length,
    /// Contour of a ground cam, each way.
    pub cam_contour: Length,
    /// Where a thread starts, if the program asks for an angle.
    pub start_angle: Angle,
    /// Flatness of a polygon's facets, minimum zone.
    pub facet_flatness: Length,
    /// Tilt of a facet, each way.
    pub facet_tilt: Angle,
    /// Size across flats, each way.
    pub across_flats: Length,
    /// Thickness of hobbed teeth, each way: what the depth of the cut makes of it.
    pub tooth_thickness: Length,
    /// Diameter over the tips of hobbed teeth, each way.
    pub tip_diameter: Length,
}

impl Default for Tolerances {
    /// Usual shop practice for drilled and tapped holes: ±0.05 mm, threads ±0.1 mm. Polygons: ISO
    /// 2768-1 f for 6 to 30 mm, ISO 2768-2 H for facets up to 10 mm. Teeth: DIN 3967, series 26, 50
    /// to 125 mm; over their tips IT 11 (ISO 286-1), 80 to 120 mm. Turned threads: what lathe
    /// builders promise of their leads, typical.
    fn default() -> Self {
        Self {
            hole_depth: Length::mm(0.05),
            position: Length::mm(0.05),
            thread_depth: Length::mm(0.1),
            thread_overrun: Length::mm(0.02),
            sync_error: None,
            turned_thread: Length::um(10.0),
            cam_contour: Length::um(10.0),
            start_angle: Angle::deg(5.0),
            facet_flatness: Length::mm(0.02),
            facet_tilt: Angle::deg(0.5),
            across_flats: Length::mm(0.1),
            tooth_thickness: Length::um(60.0),
            tip_diameter: Length::mm(0.22),
        }
    }
}

/// Specific cutting force kc of tapping, N/mm².
pub(crate) const fn cutting_force_n_per_mm2(material: Material) -> f64 {
    match material {
        Material::CarbonSteel => 3900.0,
        Material::AlloySteel => 3600.0,
        Material::Stainless => 4200.0,
        Material::CastIron => 2900.0,
        Material::Aluminium => 1300.0,
        Material::Brass => 2300.0,
    }
}

/// Torque of a sharp tap with all chamfer teeth engaged, from the area of the thread's section and
/// its lever arm: M = tan 30° · kc · K · (D − D₀)² · (D + 2·D₀) / 24000, with M in N·m, kc in
/// N/mm², the nominal diameter D and the bored diameter D₀ in mm, K for the flute form.
pub(crate) fn tapping_torque(
    material: Material,
    nominal: Length,
    bored: Length,
    flute: Flute,
) -> Torque {
    let (d, d0) = (nominal.value(), bored.value());
    let k = match flute {
        Flute::SpiralFlute if matches!(material, Material::Aluminium) => 1.05,
        Flute::SpiralFlute => 1.15,
        Flute::SpiralPoint => 0.95,
        Flute::Straight => 1.35,
    };
    let tan30 = 1.0 / 3.0_f64.sqrt();
    let kc = cutting_force_n_per_mm2(material);
    Torque::n_m(tan30 * kc * k * (d - d0).powi(2) * (d + 2.0 * d0) / 24_000.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_m6_spiral_flute_tap_in_c45_takes_1_73_newton_metres() {
        let torque = tapping_torque(
            Material::CarbonSteel,
            Length::mm(6.0),
            Length::mm(5.0),
            Flute::SpiralFlute,
        );
        assert!((torque.value() - 1.73).abs() < 0.01, "{torque}");
    }
}
