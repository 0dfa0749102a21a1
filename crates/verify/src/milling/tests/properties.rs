//! What holds of every mill and every way.
use super::*;
use proptest::prelude::*;

fn forms() -> impl Strategy<Value = MillForm> {
    prop_oneof![
        Just(MillForm::FLAT),
        Just(MillForm::Ball),
        Just(MillForm::Cylindrical { corner: Length::mm(1.0) }),
        Just(MillForm::Conical { angle: Angle::deg(60.0), tip: Length::mm(1.0) }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(test_support::size::of(24, 480)))]
    /// What is removed only grows, is never more than the block has, and never more than what the
    /// mill has swept.
    #[test]
    fn removal_grows_and_is_within_what_was_swept(
        form in forms(),
        diameter in 2.0..12.0,
        places in prop::collection::vec((-10.0..110.0, -10.0..70.0, -22.0..3.0), 1..6),
    ) {
        let mut mover = Mover::new(form, diameter, [-10.0, -10.0, 3.0]);
        let (mut before, mut swept) = (0.0, 0.0);
        for (x, y, z) in places {
            let from = mover.at;
            mover.line(State::Feed, 100.0, [x, y, z]);
            let removed = mover.milling.at.as_ref().map_or(0.0, |at| at.found.volume());
            prop_assert!(removed >= before);
            before = removed;
            // the hull of a cylinder that is as high as the stock is deep, along the way
            let way = (x - from[0]).hypot(y - from[1]);
            let deep = (-z.min(from[2])).clamp(0.0, 20.0);
            let r = diameter / 2.0 + 0.5 * diameter / 40.0 * 2.0_f64.sqrt();
            swept += (2.0 * r * way + PI * r * r) * deep;
            prop_assert!(removed <= swept + 1e-6, "{removed} of {swept}");
        }
        prop_assert!(before <= 100.0 * 60.0 * 20.0 * 1.02);
    }
}
