//! The lead that F or K means for a tap: the tap's own where a post has rounded it.
use crate::resolve::Resolver;
use canon::ToolKind;
use diag::{Diagnostic, Span};

/// Significant digits that a postprocessor leaves of a feed or a lead, at least.
const POST_DIGITS: i32 = 3;
/// A share by which a lead is rounded that changes a thread of a hundred turns by a micrometre.
const WORTH_SAYING: f64 = 1e-5;

/// The lead that a word means: the tap's own where the word is that of the tap's own lead, rounded
/// to [`POST_DIGITS`] digits or more. `per_mm`: the word's value for a lead of 1 mm.
pub(crate) fn meant_lead(
    resolver: &mut Resolver,
    lead_mm: f64,
    (letter, per_mm): (char, f64),
    span: Span,
) -> f64 {
    let tool = resolver.tools.get(resolver.tool).filter(|tool| !tool.stand_in);
    let Some((tool, ToolKind::Tap(tap))) = tool.map(|tool| (tool, &tool.kind)) else {
        return lead_mm;
    };
    let own_mm = tap.lead.value().abs();
    let (written, exact) = (lead_mm * per_mm, own_mm * per_mm);
    let unit = 10.0_f64.powi(exact.log10().floor() as i32 + 1 - POST_DIGITS);
    let off = (written - exact).abs();
    if off > unit * 0.500_000_1 {
        return lead_mm;
    }
    if off > exact * WORTH_SAYING && resolver.rounding_said != Some((tool.number, span.line)) {
        let text = format!(
            "{letter}{} is rounded from {letter}{}: the lead of T{} ({}) is followed, {} {} per revolution",
            short(written),
            short(exact),
            tool.number,
            tap.designation,
            short(own_mm / resolver.units.in_mm()),
            resolver.units.symbol()
        );
        resolver.rounding_said = Some((tool.number, span.line));
        resolver.report(Diagnostic::note("I0716", span, text));
    }
    own_mm
}

/// A positive number to six digits.
fn short(value: f64) -> f64 {
    let digits = (5 - value.log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}").parse().unwrap_or(value)
}
