//! What is left of the tolerance that is nearest to its limit, and why, in the program's unit.
use crate::Measure;
use units::Length;
use verify::{Criterion, Feature, FeatureKind, Gauge, Headroom, Thread};

/// What is left, or by how much it is out.
pub fn headroom_text(headroom: &Headroom, measure: Measure) -> String {
    let (name, unit) = (headroom.of.name(), measure.small_symbol());
    let tolerance = headroom.tolerance.in_um();
    // of a small tolerance whole micrometres would say that all of it is left
    let decimals = usize::from(tolerance < 20.0);
    let is_whole = (tolerance - tolerance.round()).abs() < 0.05;
    let whole = measure.small(headroom.tolerance, if is_whole { 0 } else { decimals });
    let left = measure.small(headroom.left.abs(), decimals);
    match headroom.of {
        Criterion::Whole => "not made as ordered".into(),
        _ if headroom.left < Length::ZERO => format!("{name}: {left} {unit} out of {whole} {unit}"),
        _ => format!("{name}: {left} of {whole} {unit} left"),
    }
}

/// Why a feature is as near to its limit as it is: what the motion, the tool and the hole had to do
/// with it.
pub fn why_nearest(feature: &Feature, headroom: &Headroom, measure: Measure) -> Option<String> {
    if headroom.of == Criterion::Whole {
        return feature.verdict.reason().map(str::to_owned);
    }
    let FeatureKind::Thread(thread) = &feature.kind else { return None };
    let small = |length: Length| format!("{} {}", measure.small(length, 1), measure.small_symbol());
    let sync_error = format!(
        "largest {} {} deep, {}",
        measure.coarse(thread.sync_error_depth),
        measure.symbol(),
        place(thread.sync_error_depth, thread)
    );
    Some(match headroom.of {
        Criterion::Depth if thread.depth_error > Length::ZERO => {
            format!("the tap turned back {} beyond the bottom", small(thread.depth_error))
        }
        Criterion::Depth => {
            format!("the tap turned back {} short of the bottom", small(-thread.depth_error))
        }
        Criterion::PitchDiameter(gauge) => {
            let by = match gauge {
                Gauge::Go => format!("lead error of {}", small(thread.lead_error)),
                Gauge::NoGo => format!(
                    "groove {} wider than the tap, {}",
                    small(thread.groove_widening),
                    place(thread.widest_depth, thread)
                ),
            };
            format!("{by}; sync error {}, {sync_error}", small(thread.sync_error_max))
        }
        Criterion::SyncError => format!("sync error {sync_error}"),
        Criterion::MinorDiameter => {
            format!("the bore has {} {}", measure.length(thread.minor_diameter), measure.symbol())
        }
        Criterion::Position => format!("{} off its place", small(thread.position_error)),
        Criterion::Flatness
        | Criterion::AcrossFlats
        | Criterion::Contour
        | Criterion::Pitch
        | Criterion::Helix
        | Criterion::Profile
        | Criterion::Span
        | Criterion::Chip
        | Criterion::Deflection
        | Criterion::Whole => return None, // no thread has one, and the whole was named
    })
}

/// Where in a thread a depth is.
fn place(depth: Length, thread: &Thread) -> &'static str {
    let bottom = thread.tip_depth.value();
    match depth.value() {
        d if d > 0.9 * bottom => "at the reversal",
        d if d < 0.1 * bottom => "at the entry",
        _ => "on the way",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::LengthUnit;

    #[test]
    fn what_is_left_and_what_is_out_is_said_in_the_programs_unit() {
        let inch = Measure { unit: LengthUnit::Inch };
        let of = |left, tolerance| Headroom {
            of: Criterion::PitchDiameter(Gauge::NoGo),
            left: Length::um(left),
            tolerance: Length::um(tolerance),
        };
        for (headroom, metric, imperial) in [
            (
                of(23.4, 150.0),
                "No-go gauge: 23 of 150 µm left",
                "No-go gauge: 921 of 5906 µin left",
            ),
            (
                of(-150.0, 50.0),
                "No-go gauge: 150 µm out of 50 µm",
                "No-go gauge: 5906 µin out of 1969 µin",
            ),
            (of(9.04, 10.0), "No-go gauge: 9.0 of 10 µm left", "No-go gauge: 356 of 394 µin left"),
        ] {
            assert_eq!(headroom_text(&headroom, Measure::METRIC), metric);
            assert_eq!(headroom_text(&headroom, inch), imperial);
        }
        let whole = Headroom { of: Criterion::Whole, ..of(-1.0, 0.0) };
        assert_eq!(headroom_text(&whole, inch), "not made as ordered");
    }
}
