//! Faults and orders as they are typed, and when they come.
use super::*;

fn both(faults: &str, orders: &str) -> Result<Told, String> {
    let machine = store::machine::find("tapping-center").unwrap();
    let list = |text: &str| vec![text.to_owned()];
    let orders = if orders.is_empty() { Vec::new() } else { list(orders) };
    told(&list(faults), &orders, &machine)
}

fn faults(text: &str) -> Result<Vec<(Fault, Moment)>, String> {
    let told = both(text, "")?;
    Ok(told.faults.iter().map(|item| (item.what, item.moment)).collect())
}

fn orders(text: &str) -> Vec<Item<Order>> {
    both("late at 1s", text).unwrap().orders
}

#[test]
fn faults_and_their_moments_are_read_as_they_are_typed() {
    let items = faults("power-cut at 1.234s; feedback-jump Z 50um at depth 8mm out;kill at random")
        .unwrap();
    assert_eq!(items[0], (Fault::PowerCut, Moment::Time(Time::s(1.234))));
    let jump = Fault::Jump(2, Coordinate::linear(Length::um(50.0)));
    assert_eq!(items[1], (jump, Moment::Depth { below: Length::mm(8.0), out: true }));
    assert_eq!(items[2].1, Moment::Random(None));
    let tool = faults("torque-loss 90% spindle 0 at 6s; drive-fault spindle 0 at 7s").unwrap();
    assert!(matches!(tool[0].0, Fault::TorqueLoss(0, share) if (share - 0.1).abs() < 1e-12));
    assert_eq!(tool[1].0, Fault::SpindleDrive(0));
}

#[test]
fn the_reading_of_a_rotary_axis_jumps_by_an_angle_and_that_of_a_linear_one_by_a_length() {
    let machine = store::machine::find("mill-5-axis").unwrap();
    let jump = |text: &str| told(&[text.to_owned()], &[], &machine).map(|told| told.faults[0].what);
    let expected = Fault::Jump(3, Coordinate::rotary(Angle::deg(0.5)));
    assert_eq!(jump("feedback-jump A 0.5deg at 1s"), Ok(expected));
    assert!(jump("feedback-jump A 0.5mm at 1s").is_err());
    assert!(jump("feedback-jump X 0.5deg at 1s").is_err());
}

#[test]
fn orders_are_read_likewise() {
    let items = orders("hold at 2.5s; resume at 4000ms; override 50% at line 30");
    assert_eq!((items[1].what, items[1].moment), (Order::Resume, Moment::Time(Time::s(4.0))));
    assert_eq!((items[2].what, items[2].moment), (Order::FeedOverride(0.5), Moment::Line(30)));
}

#[test]
fn an_emergency_stop_is_the_operators_too() {
    let told = both("late at 1s", "hold at 1s; emergency-stop at angle 12rev").unwrap();
    assert_eq!(told.faults[1].what, Fault::EmergencyStop);
    assert_eq!(told.faults[1].moment, Moment::Turned(Angle::rev(12.0)));
    assert_eq!(told.orders.len(), 1);
}

#[test]
fn what_cannot_be_meant_is_said_with_what_would_do() {
    for (text, expected) in [
        ("power-cut", "as in \"power-cut at 1.5s\""),
        (
            "power-cut at noon",
            "expected a number with its unit (ms, us, s), as in 1.5s, found \"noon\"",
        ),
        ("power-cut at depth", "expected a moment such as at 1.5s"),
        ("power-cat at 1s", "expected one of power-cut, kill"),
        ("drive-fault at 1s", "expected drive-fault spindle [N]|AXIS; found \"drive-fault\""),
        ("stuck Q at 1s", "expected an axis such as Z, found \"Q\""),
        ("stuck A at 1s", "tapping-center has no axis A, only XYZ"),
        ("drive-fault spindle 1 at 1s", "tapping-center has no spindle 1: its last one is 0"),
        ("torque-loss 150% at 1s", "expected a loss from 0 to 100%, found \"150%\""),
        ("kill at line 0", "expected a program line from 1 on"),
        ("kill between 2s and 1s", "the earlier one first"),
        ("", "expected something and its moment"),
    ] {
        let why = faults(text).unwrap_err();
        assert!(why.contains(expected), "{text}: {why}");
    }
}

#[test]
fn everything_wrong_is_said_at_once() {
    let why = both("stuck A at 1s; explode at 2s", "hold at 9x").unwrap_err();
    for expected in ["no axis A", "found \"explode\"", "--operator: \"hold at 9x\""] {
        assert!(why.contains(expected), "{why}");
    }
    assert_eq!(why.lines().count(), 3, "{why}");
}

#[test]
fn a_depth_is_passed_once_inwards_and_once_outwards() {
    let items = orders("hold at depth 5mm; retract at depth 5mm out; resume at 1000s");
    let mut script = Script::new(items, 1, Time::s(1.0));
    let mut seen = Vec::new();
    for depth in [0.0, 4.9, 5.1, 8.0, 5.2, 4.8, 0.0] {
        seen.extend(
            script.due(&Sample::default(), Length::mm(depth)).into_iter().map(|o| (o, depth)),
        );
    }
    assert_eq!(seen, [(Order::FeedHold, 5.1), (Order::Retract, 4.8)]);
    assert_eq!(script.left().collect::<Vec<_>>(), ["resume at 1000s"]);
}
