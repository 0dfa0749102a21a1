//! Whether a mill's use is good: what is known to be wrong, and what could not be judged.
use super::milled::{Largest, Milled, MillingPlace};
use super::stock::StockSource;
use crate::config::cutting_force_n_per_mm2;
use crate::verdict::Verdict;
use crate::{Config, Stock};
use canon::{Mill, RapidIntoStock, Tool, ToolKind};
use units::Length;

/// Rapids that are named one by one.
const NAMED: usize = 3;

/// What was noticed of the use of a mill, whatever it has removed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noticed {
    /// First place of a cut with the spindle at rest.
    pub(super) still: Option<MillingPlace>,
    /// First place of a cut with the spindle turning backwards.
    pub(super) backwards: Option<MillingPlace>,
    /// A rotary axis has moved.
    pub(super) turned: bool,
}

/// Specific cutting force, N/mm²: the material's one of tapping, whose chips are thin; thicker ones
/// take less.
pub(super) fn force_basis(config: &Config) -> Option<f64> {
    config.material.map(cutting_force_n_per_mm2)
}

/// A number of millimetres as people write it.
pub(super) fn mm(value: Length) -> String {
    let text = format!("{:.3}", value.value());
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

impl core::fmt::Display for MillingPlace {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "line {} at {}", self.line, self.written)
    }
}

/// The corners of a block, in G54.
pub(super) fn extent(block: &Stock) -> String {
    let axis = |i: usize| {
        let [from, to] = [block.from[i], block.to[i]].map(|at| mm(at - block.zero[i]));
        format!("{} {from} to {to}", ['X', 'Y', 'Z'][i])
    };
    format!("{}, {}, {}", axis(0), axis(1), axis(2))
}

pub(super) fn verdict(seen: &Noticed, milled: &Milled, tool: &Tool, config: &Config) -> Verdict {
    let ToolKind::EndMill(mill) = &tool.kind else {
        return Verdict::NotJudged { reason: unknown_form(milled, tool) };
    };
    let assumed = milled.source.is_some_and(StockSource::is_assumed) || tool.stand_in;
    let mut wrong = Vec::new();
    let rapids = rapids(milled, tool);
    if !assumed {
        wrong.extend(rapids.clone());
        wrong.extend(still(seen));
    }
    wrong.extend(exceeded(milled, mill, tool, assumed));
    let mut unknown = Vec::new();
    match config.mill_stock {
        None => unknown.push(crate::contact::NO_STOCK.to_owned()),
        Some(stock) => {
            let how = match stock.source {
                StockSource::MachineFile | StockSource::Comment => None,
                StockSource::Size => Some("where the stock lies is assumed, its size a comment's"),
                StockSource::Extent => {
                    Some("the stock is assumed, as large as the program's extent")
                }
            };
            unknown.extend(how.map(|how| format!("{how}: {} mm of G54", extent(&stock.block))));
        }
    }
    if tool.stand_in {
        unknown.push("the mill is assumed, by the program's comment".into());
    }
    if assumed {
        unknown.extend(rapids.into_iter().chain(still(seen)).map(|said| format!("if so, {said}")));
    }
    if mill.form.is_none() {
        unknown.push("the form of the mill is not known: state `form` in the tool table".into());
    } else if milled.diameter <= Length::ZERO {
        unknown.push("the diameter of the mill is not known: state it in the tool table".into());
    }
    if seen.turned {
        unknown.push("a rotary axis has moved, and only X, Y and Z are looked at".into());
    }
    if let Some(stock) =
        config.mill_stock.filter(|_| mill.form.is_some() && milled.diameter > Length::ZERO)
        && milled.depth.is_none()
        && milled.rapid_count == 0
        && !seen.turned
    {
        let where_it_is = extent(&stock.block);
        unknown.push(format!("it met no stock, which reaches over {where_it_is} mm of G54"));
    }
    unknown.extend(unlimited(milled, mill));
    Verdict::unless(&wrong, (!unknown.is_empty()).then(|| unknown.join("; ")))
}

/// What a tool has done of which the table does not say what its edges leave.
fn unknown_form(milled: &Milled, tool: &Tool) -> String {
    let deep =
        milled.depth.map(|deepest| format!(", {} mm deep: {}", mm(deepest.value), deepest.place));
    let through = rapids(milled, tool).map(|rapids| format!("; if it is as wide there, {rapids}"));
    format!(
        "the form of {} is not known, and it was in the stock{}{}; the kind that it has in the tool table, such as \"end-mill\" with its `form`, says what it leaves",
        tool.name(),
        deep.unwrap_or_default(),
        through.unwrap_or_default(),
    )
}

/// Rapids through the stock, the first ones by name: as they are said before motion.
fn rapids(milled: &Milled, tool: &Tool) -> Option<String> {
    let named = milled.rapids.iter().take(NAMED).map(|cut| {
        let MillingPlace { line, written, .. } = cut.place;
        let rapid = RapidIntoStock { place: written, line: Some(line), tool, depth: cut.depth };
        rapid.to_string()
    });
    let mut said: Vec<String> = named.collect();
    let more = milled.rapid_count.saturating_sub(said.len());
    if more > 0 {
        said.push(format!("and {more} more"));
    }
    (!said.is_empty()).then(|| said.join("; "))
}

fn still(seen: &Noticed) -> Vec<String> {
    let at_rest = seen.still.map(|at| format!("it cuts with the spindle at rest: {at}"));
    let backwards =
        seen.backwards.map(|at| format!("it cuts with the spindle turning backwards: {at}"));
    at_rest.into_iter().chain(backwards).collect()
}

/// What is over a limit that the tool table states. In a stock that is only assumed, what depends
/// on how much was there is not known.
fn exceeded(milled: &Milled, mill: &Mill, tool: &Tool, assumed: bool) -> Vec<String> {
    let over = |what: &str, largest: Option<Largest<Length>>, most: Option<Length>| {
        let (largest, most) = largest.zip(most)?;
        (largest.value > most).then(|| {
            let (is, may) = (mm(largest.value), mm(most));
            format!("{what} is {is} mm, of {may} mm that the tool may have: {}", largest.place)
        })
    };
    if assumed {
        return Vec::new();
    }
    let limits = mill.limits;
    [
        over("the chip of a tooth", milled.chip, limits.chip),
        over("the axial depth of the cut", milled.depth, limits.depth),
        over("the axial depth of the cut", milled.depth, tool.body.flutes),
        over("the deflection of the tip", milled.deflection, limits.deflection),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// What has no limit, or no value to hold against it.
fn unlimited(milled: &Milled, mill: &Mill) -> Vec<String> {
    let limits = mill.limits;
    let mut all = Vec::new();
    if limits.chip.is_none() && limits.depth.is_none() && limits.deflection.is_none() {
        all.push(
            "the tool table states no limit of this mill (max_chip_mm, max_depth_mm, max_deflection_mm)"
                .to_owned(),
        );
    }
    if limits.chip.is_some() && milled.chip.is_none() && milled.depth.is_some() {
        all.push("its chip is not known: state `teeth` in the tool table".into());
    }
    if limits.deflection.is_some() && milled.deflection.is_none() && milled.depth.is_some() {
        all.push(
            "its deflection is not known: state teeth, stick_out_mm and body_material in the tool table, and a known material of the stock"
                .into(),
        );
    }
    all
}
