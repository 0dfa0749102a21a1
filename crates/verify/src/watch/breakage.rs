//! What is said of a tool that broke: which, by what against what it withstands, and where its tip
//! was.
use crate::config::Config;
use bus::{Sample, ToolBreak};
use canon::{Tool, ToolKind};
use units::Length;

/// One sentence, without the line, which the breach carries.
pub(super) fn text(sample: &Sample, config: &Config) -> String {
    let tool = sample.feedback.tool.and_then(|number| config.tools.get(number));
    let name = match (tool, sample.feedback.tool) {
        (Some(tool), _) => name(tool),
        (None, Some(number)) => format!("T{number}"),
        (None, None) => "a tool".into(),
    };
    let by = sample.truth.as_ref().and_then(|truth| truth.broken_by);
    let why = by.map(|by| format!(", {}", why(by))).unwrap_or_default();
    format!("the tool is broken: {name}{why}, at {}", place(sample, tool, config))
}

fn name(tool: &Tool) -> String {
    let what = match &tool.kind {
        ToolKind::Tap(tap) => format!("tap {}", tap.designation),
        ToolKind::Drill { .. } => format!("drill {} mm", tool.diameter.value()),
        ToolKind::SpotDrill { .. } => format!("spot drill {} mm", tool.diameter.value()),
        ToolKind::EndMill(_) => format!("end mill {} mm", tool.diameter.value()),
        ToolKind::Probe(_) => "touch probe".to_owned(),
        ToolKind::Insert(_) | ToolKind::PolygonCutter(_) | ToolKind::Hob(_) | ToolKind::Other => {
            tool.description.clone()
        }
    };
    format!("T{} {what}", tool.number).trim_end().to_owned()
}

fn why(by: ToolBreak) -> String {
    match by {
        ToolBreak::Sideways { by, most } => {
            format!(
                "moved {:.2} mm sideways in the work of {:.2} mm it withstands",
                by.value(),
                most.value()
            )
        }
        ToolBreak::Stress { torque, force, most_torque, most_force } => {
            let shares = [torque.value() / most_torque.value(), force.value() / most_force.value()];
            let [twisted, pulled] = [
                format!(
                    "torque {:.1} N·m of {:.1} N·m it withstands",
                    torque.value(),
                    most_torque.value()
                ),
                format!(
                    "axial force {:.0} N of {:.0} N it withstands",
                    force.value(),
                    most_force.value()
                ),
            ];
            // below a fifth the other one's part in the stress is below 2 %
            match shares {
                [torque, force] if force < 0.2 * torque => twisted,
                [torque, force] if torque < 0.2 * force => pulled,
                _ => format!("{twisted} together with {pulled}"),
            }
        }
    }
}

/// Where the tip was, in G54 if the stock, and with it the zero of G54, is known.
fn place(sample: &Sample, tool: Option<&Tool>, config: &Config) -> String {
    let zero = config.stock.map_or([Length::ZERO; 3], |stock| stock.zero);
    let length = tool.map_or(Length::ZERO, canon::Tool::worn_length);
    let [x, y, z] = [0, 1, 2].map(|i| (sample.axis(i).of_linear() - zero[i]).value());
    let frame = if config.stock.is_some() { "of G54" } else { "of the machine" };
    let number = |value: f64| {
        let text = format!("{value:.2}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    };
    format!("X{} Y{} Z{} {frame}", number(x), number(y), number(z - length.value()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stock;
    use bus::Truth;
    use canon::ToolLibrary;
    use units::Coordinate;
    use units::{Angle, Force, Torque};

    #[test]
    fn a_broken_tool_is_named_with_what_broke_it_and_where() {
        let drill = Tool {
            number: 2,
            pocket: 2,
            length: Length::mm(118.5),
            diameter: Length::mm(5.0),
            kind: ToolKind::Drill { point_angle: Angle::deg(118.0) },
            description: String::new(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        };
        let mut config = Config::new(ToolLibrary::new([drill]));
        let zero = [-60.0, -40.0, -200.0].map(Length::mm);
        config.stock = Some(Stock { from: zero, to: zero, zero });
        let mut sample = Sample::default();
        sample.feedback.tool = Some(2);
        let mut truth = Truth { tool_broken: true, ..Truth::default() };
        truth.axes = [-48.0, -28.0, -200.0 + 118.5 - 14.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
            .map(Coordinate::new);
        let stress = |torque: f64, force: f64| ToolBreak::Stress {
            torque: Torque::n_m(torque),
            force: Force::n(force),
            most_torque: Torque::n_m(5.3),
            most_force: Force::n(12_000.0),
        };
        let mut said = |by: ToolBreak| {
            truth.broken_by = Some(by);
            sample.truth = Some(truth);
            text(&sample, &config)
        };
        assert_eq!(
            said(stress(5.5, 300.0)),
            "the tool is broken: T2 drill 5 mm, torque 5.5 N·m of 5.3 N·m it withstands, at X12 Y12 Z-14.2 of G54"
        );
        assert!(
            said(stress(4.0, 9000.0))
                .contains("it withstands together with axial force 9000 N of 12000 N")
        );
        let sideways = ToolBreak::Sideways { by: Length::mm(1.3), most: Length::mm(1.25) };
        assert!(
            said(sideways).contains("moved 1.30 mm sideways in the work of 1.25 mm it withstands")
        );
    }
}
