//! From what the judge found to the certificate that other programs rely on. What was not cut has
//! no measures: they are `null`, as the report leaves their cells empty.
use canon::Position;
use control::services::supervision::{self, SupervisedStroke};
use store::certificate::{self as file, Common, Measured};
use sync::supervision::depth::{BINS, StrokeWay};
use units::Length;
use verify::{
    Feature, FeatureKind, Gear, GroundCam, Hand, Hole, Largest, Milled, Polygon, Thread,
    TurnedLimits, TurnedSizes, TurnedThread, Verdict,
};

/// One feature, in the certificate's keys and units; places in the frame of the workpiece, whose
/// zero is there.
pub(crate) fn feature(found: &Feature, zero: &Position) -> file::Feature {
    let common = Common {
        line: found.line,
        verdict: match found.verdict {
            Verdict::Pass => file::Verdict::Pass,
            Verdict::Fail { .. } => file::Verdict::Fail,
            Verdict::NotJudged { .. } => file::Verdict::NotJudged,
        },
        reason: found.verdict.reason().map(str::to_owned),
        time_s: Measured::s(found.time),
        contact: contact(&found.contact),
    };
    let there = found.is_there();
    match &found.kind {
        FeatureKind::Hole(found) => file::Feature::Hole(hole(common, found, zero, there)),
        FeatureKind::Thread(found) => {
            file::Feature::Thread(Box::new(thread(common, found, zero, there)))
        }
        FeatureKind::Cam(found) => file::Feature::Cam(cam(common, found, there)),
        FeatureKind::Turned(found) => {
            file::Feature::Turned(Box::new(turned(common, found, zero, there)))
        }
        FeatureKind::Gear(found) => file::Feature::Gear(gear(common, found, zero, there)),
        FeatureKind::Milled(milled) => {
            file::Feature::Milling(Box::new(milling(common, found.tool, milled)))
        }
        FeatureKind::Polygon(found) => file::Feature::Polygon(polygon(common, found, zero, there)),
    }
}

fn contact(found: &verify::Contact) -> file::Contact {
    let known = |value: Option<f64>| value.map_or(Measured::UNKNOWN, Measured::number);
    file::Contact {
        cut: found.is_cut(),
        reach_mm: known(found.reach.map(Length::value)),
        torque_max_n_m: torque(found.torque),
        torque_expected_n_m: torque(found.torque_expected),
        force_max_n: known(found.force.map(units::Force::value)),
    }
}

/// The value where it was measured, else unknown.
const fn known_if(measured: bool, value: Measured) -> Measured {
    if measured { value } else { Measured::UNKNOWN }
}

fn cam(common: Common, found: &GroundCam, there: bool) -> file::Cam {
    let measured = |value| known_if(there && !found.errors.is_empty(), value);
    file::Cam {
        common,
        profile: found.name.clone(),
        rpm: Measured::rpm(found.spin),
        phase_error_deg: measured(Measured::deg(found.phase_error)),
        contour_error_max_um: measured(Measured::um(found.contour_error_max)),
        contour_error_rms_um: measured(Measured::um(found.contour_error_rms)),
        revolutions: Measured::number(found.turns.value()),
        run_out_um: measured(found.run_out.map_or(Measured::UNKNOWN, Measured::um)),
        speed_error_um_per_deg: measured(Measured::um(found.speed_error_per_deg)),
        waviness_um: measured(Measured::um(found.waviness.0)),
        waves_per_rev: measured(Measured::number(found.waviness.1 as f64)),
        removal_rate_peak: measured(Measured::number(found.removal_peak)),
        removal_rate_peak_even: measured(Measured::number(found.removal_peak_even)),
    }
}

fn turned(
    common: Common,
    found: &TurnedThread,
    zero: &Position,
    there: bool,
) -> file::TurnedThread {
    let measured = |value| known_if(there && found.passes > 0, value);
    let um = |value| measured(Measured::um(value));
    let zero = zero.along(found.axis).of_linear();
    file::TurnedThread {
        common,
        hand: match found.hand {
            Hand::Right => file::Hand::Right,
            Hand::Left => file::Hand::Left,
        },
        lead_mm: Measured::lead(found.lead),
        lead_growth_mm: Measured::number(found.growth.value()),
        leads_mm: found
            .leads
            .iter()
            .map(|turn| {
                [Measured::mm(turn.depth), Measured::lead(turn.ordered), Measured::lead(turn.cut)]
            })
            .collect(),
        start_angle_deg: measured(Measured::deg(found.start_angle)),
        axis: found.axis.letter().to_string(),
        from_mm: Measured::mm(found.surface - zero),
        to_mm: Measured::mm(found.end - zero),
        passes: found.passes,
        passes_ordered: found.passes_ordered,
        rpm_max: measured(Measured::rpm(found.spin_max)),
        sync_error_max_um: um(found.sync_error_max),
        sync_error_rms_um: um(found.sync_error_rms),
        lead_error_um: um(found.lead_error),
        pass_spread_um: um(found.pass_spread),
        infeed_error_um: um(found.infeed_error),
        internal: found.internal,
        starts: found.starts,
        size: found.size.clone(),
        class: found.class.to_owned(),
        insert: found.insert.clone(),
        before_mm: found.before.map_or(Measured::UNKNOWN, Measured::mm),
        contact_percent: found
            .contact
            .map_or(Measured::UNKNOWN, |share| Measured::number(share * 100.0)),
        groove_depth_mm: found.groove_depth.map_or(Measured::UNKNOWN, Measured::mm),
        not_judged: Some(found.not_judged.clone()).filter(|why| !why.is_empty()),
        sizes: found.sizes.as_ref().map(|sizes| turned_sizes(sizes, found)),
        force_max_n: found.force_max.map_or(Measured::UNKNOWN, |f| Measured::number(f.value())),
        torque_max_n_m: torque(found.torque_max),
    }
}

fn turned_sizes(sizes: &TurnedSizes, found: &TurnedThread) -> file::TurnedSizes {
    let mm = |lengths: [Length; 2]| lengths.map(Measured::mm);
    let limits = |of: fn(&TurnedLimits) -> [Length; 2]| {
        found.limits.as_ref().map(|limits| {
            // a diameter without a largest has no number there
            of(limits)
                .map(|d| if d.value().is_finite() { Measured::mm(d) } else { Measured::UNKNOWN })
        })
    };
    file::TurnedSizes {
        major_mm: mm(sizes.major),
        major_limits_mm: limits(|l| l.major),
        pitch_mm: mm(sizes.pitch),
        virtual_pitch_mm: Measured::mm(sizes.virtual_pitch),
        pitch_limits_mm: limits(|l| l.pitch),
        minor_mm: mm(sizes.minor),
        minor_limits_mm: limits(|l| l.minor),
        pitch_error_um: Measured::um(sizes.pitch_error),
        flank_error_um: Measured::um(sizes.flank_error),
        flank_contact_percent: Measured::number(sizes.flank_contact * 100.0),
        full_length_mm: Measured::mm(sizes.full_length),
        run_in_mm: Measured::mm(sizes.run_in),
        run_out_mm: Measured::mm(sizes.run_out),
    }
}

fn gear(common: Common, found: &Gear, zero: &Position, there: bool) -> file::Gear {
    let measured = |value| known_if(there && !found.places.is_empty(), value);
    file::Gear {
        common,
        teeth: found.teeth,
        module_mm: Measured::mm(found.module),
        helix_deg: Measured::deg(found.helix),
        lead_mm: found.lead.map_or(Measured::UNKNOWN, Measured::mm),
        lead_ordered_mm: found.lead_ordered.map_or(Measured::UNKNOWN, Measured::mm),
        pitch_deviation_um: measured(Measured::um(found.pitch_deviation)),
        pitch_total_um: measured(Measured::um(found.pitch_total)),
        helix_deviation_um: measured(Measured::um(found.helix_deviation)),
        profile_deviation_um: measured(Measured::um(found.profile_deviation)),
        profile_slope_um: measured(Measured::um(found.profile_slope)),
        profile_form_um: measured(Measured::um(found.profile_form)),
        feed_mark_um: measured(Measured::um(found.feed_mark)),
        grade: found.grade,
        z_from_mm: measured(Measured::mm(found.z_from - zero.linear[2])),
        z_to_mm: measured(Measured::mm(found.z_to - zero.linear[2])),
        rpm: Measured::rpm(found.spin),
        size: found.size.filter(|_| there).map(|size| tooth_size(&size)),
    }
}

fn tooth_size(size: &verify::ToothSize) -> file::ToothSize {
    let known = |value: Option<Length>| value.map_or(Measured::UNKNOWN, Measured::mm);
    let [least, most] = size.span_allowed;
    file::ToothSize {
        distance_mm: Measured::mm(size.distance),
        distance_asked_mm: Measured::mm(size.distance_asked),
        shift: Measured::number(size.shift),
        spanned: size.spanned,
        span_mm: Measured::mm(size.span),
        span_least_mm: Measured::mm(least),
        span_most_mm: Measured::mm(most),
        ball_mm: Measured::mm(size.ball),
        over_balls_mm: known(size.over_balls),
        over_balls_asked_mm: known(size.over_balls_asked),
        root_diameter_mm: Measured::mm(size.root_diameter),
        tip_diameter_mm: known(size.tip_diameter),
        tip_diameter_asked_mm: Measured::mm(size.tip_diameter_asked),
    }
}

fn milling(common: Common, tool: Option<u32>, found: &Milled) -> file::Milling {
    let place = |value: Measured, place: &verify::MillingPlace| file::At {
        value,
        line: Some(place.line),
        at_mm: Some(place.at.map(Measured::mm)),
    };
    let mm = |of: &Option<Largest<Length>>| {
        of.as_ref().map_or_else(Default::default, |m| place(Measured::mm(m.value), &m.place))
    };
    let number = |of: Option<(f64, verify::MillingPlace)>| {
        of.map_or_else(Default::default, |(v, at)| place(Measured::number(v), &at))
    };
    file::Milling {
        common,
        tool,
        form: found.form_name().to_owned(),
        diameter_mm: Measured::mm(found.diameter),
        stock: found.source.map(|source| source.name().to_owned()),
        cell_mm: found.cell.map_or(Measured::UNKNOWN, Measured::mm),
        removed_mm3: Measured::number(found.removed_mm3),
        depth_mm: mm(&found.depth),
        width_mm: mm(&found.width),
        engagement_deg: number(found.angle.map(|m| (m.value.in_deg(), m.place))),
        removal_mm3_per_s: number(found.removal_mm3_per_s.map(|m| (m.value, m.place))),
        feed_per_tooth_mm: mm(&found.feed_per_tooth),
        chip_mm: mm(&found.chip),
        force_n: number(found.force.map(|m| (m.value.value(), m.place))),
        deflection_mm: mm(&found.deflection),
        rpm_max: Measured::rpm(found.spin_max),
        rapids: found.rapid_count,
        rapids_mm: found.rapids.iter().map(|r| place(Measured::mm(r.depth), &r.place)).collect(),
    }
}

fn polygon(common: Common, found: &Polygon, zero: &Position, there: bool) -> file::Polygon {
    let measured = |value| known_if(there && !found.sections.is_empty(), value);
    file::Polygon {
        common,
        sides: found.sides,
        across_flats_mm: measured(Measured::mm(found.across_flats)),
        flatness_um: measured(Measured::um(found.flatness)),
        tilt_deg: measured(Measured::deg(found.tilt)),
        corner_angle_deg: measured(Measured::deg(found.corner_angle)),
        z_from_mm: Measured::mm(found.z_from - zero.linear[2]),
        z_to_mm: Measured::mm(found.z_to - zero.linear[2]),
        rpm: Measured::rpm(found.spin),
        across_flats_error_um: measured(Measured::um(
            found.across_flats - found.across_flats_ordered,
        )),
        facet_difference_um: measured(Measured::um(found.facet_difference)),
        lay_um: measured(Measured::um(found.lay)),
        taper_um_per_mm: measured(Measured::um(found.along.across_flats)),
        taper_error_um_per_mm: measured(Measured::um(
            found.along.across_flats - found.along_ordered.across_flats,
        )),
        twist_deg_per_mm: measured(Measured::deg(found.along.turn)),
        twist_error_deg_per_mm: measured(Measured::deg(
            found.along.turn - found.along_ordered.turn,
        )),
        broken_off: found.broken_off,
    }
}

fn hole(common: Common, found: &Hole, zero: &Position, there: bool) -> file::Hole {
    let measured = |value| known_if(there && found.depth > Length::ZERO, value);
    file::Hole {
        common,
        x_mm: Measured::mm(found.x - zero.linear[0]),
        y_mm: Measured::mm(found.y - zero.linear[1]),
        depth_mm: measured(Measured::mm(found.depth)),
        diameter_mm: measured(Measured::mm(found.diameter)),
        chip_removal: found.chip_removal,
    }
}

fn thread(common: Common, found: &Thread, zero: &Position, there: bool) -> file::Thread {
    let is_cut = there && found.tip_depth > Length::ZERO;
    let measured = |value| known_if(is_cut, value);
    let gauged = |length| known_if(is_cut && found.is_gauged(), length);
    let torque_of_cut = |known| measured(torque(known));
    file::Thread {
        common,
        x_mm: Some(Measured::mm(found.x - zero.linear[0])),
        y_mm: Some(Measured::mm(found.y - zero.linear[1])),
        z_mm: None,
        size: found.size.clone(),
        hand: match found.hand {
            Hand::Right => file::Hand::Right,
            Hand::Left => file::Hand::Left,
        },
        lead_mm: Measured::lead(found.lead),
        depth_mm: measured(Measured::mm(found.depth)),
        depth_error_um: measured(Measured::um(found.depth_error)),
        rpm_max: measured(Measured::rpm(found.spin_max)),
        sync_error_max_um: measured(Measured::um(found.sync_error_max)),
        sync_error_rms_um: measured(Measured::um(found.sync_error_rms)),
        lead_error_um: gauged(Measured::um(found.lead_error)),
        groove_widening_um: gauged(Measured::um(found.groove_widening)),
        pitch_diameter_mm: gauged(Measured::mm(found.pitch_diameter)),
        class: found.class_name().to_owned(),
        margin_um: gauged(Measured::um(found.margin)),
        torque_max_n_m: torque_of_cut(found.torque_max),
        torque_in_n_m: torque_of_cut(found.torque_in),
        torque_out_n_m: torque_of_cut(found.torque_out),
        torque_model_n_m: torque(found.torque_expected),
        torque_model_band_percent: if found.torque_expected.is_some() {
            Measured::number(Thread::TORQUE_BAND * 100.0)
        } else {
            Measured::UNKNOWN
        },
        torque_expected: found.torque_is_expected().filter(|_| is_cut),
        axial_force_max_n: measured(
            found.axial_force_max.map_or(Measured::UNKNOWN, |f| Measured::number(f.value())),
        ),
        start_angle_deg: measured(found.start_angle.map_or(Measured::UNKNOWN, Measured::deg)),
        chip_removal: found.chip_removal,
        recovered: found.recovered,
        supervision: Vec::new(),
    }
}

/// What supervision by torque saw of the strokes of an operation.
pub(crate) fn supervision(strokes: &[SupervisedStroke], op: u32) -> Vec<file::Supervision> {
    let of_op = strokes.iter().filter(|stroke| stroke.op == op);
    of_op.map(|stroke| one_stroke(&stroke.seen)).collect()
}

fn one_stroke(seen: &kernel::Supervised) -> file::Supervision {
    let course = |way: StrokeWay| {
        let bins = (0..BINS).map(|bin| {
            let hundredths = seen.torque.at(way, bin).map(|value| (value * 100.0).round() / 100.0);
            hundredths.map_or(Measured::UNKNOWN, Measured::number)
        });
        bins.collect()
    };
    file::Supervision {
        says: supervision::sentence(seen),
        sure: seen.diagnosed.is_sure,
        bin_mm: Measured::mm(seen.depth / BINS as f64),
        torque_in_n_m: course(StrokeWay::In),
        torque_out_n_m: course(StrokeWay::Out),
        level_percent: Measured::number(seen.level * 100.0),
        stopped: seen.crossing.map(|crossing| file::SupervisionStop {
            torque_n_m: Measured::n_m(crossing.torque),
            limit_n_m: Measured::n_m(crossing.limit),
            depth_mm: Measured::mm(crossing.depth),
            alarm_after_s: Measured::s(crossing.took),
        }),
    }
}

fn torque(known: Option<units::Torque>) -> Measured {
    known.map_or(Measured::UNKNOWN, |t| Measured::number(t.value()))
}
