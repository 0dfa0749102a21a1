//! The page as a whole: well formed, harmless, self-contained, the same every time, and small.
use canon::{LengthUnit, Position, ProgramFrame};
use report::{Alarm, Limits, Note, Recorder, Run};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::BTreeSet;
use units::{Coordinate, Length, Spin, Time, Torque};
use verify::{Feature, FeatureKind, Verdict};

mod support;
use support::{Mishap, World, plate, run};

fn page(world: &World) -> String {
    report::html(&world.run, &world.recorder, &world.features)
}

/// The page is written so that it is XML as well: every tag is closed, every attribute quoted.
fn parsed(page: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(page, options).expect("the page is well formed")
}

fn words(document: &Document) -> String {
    let text = document.descendants().filter(roxmltree::Node::is_text);
    text.filter(|n| {
        !n.parent().is_some_and(|p| p.has_tag_name("style") || p.has_tag_name("script"))
    })
    .filter_map(|n| n.text())
    .collect::<Vec<_>>()
    .join("\n")
}

fn charts<'a>(document: &'a Document) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|n| n.attribute("class") == Some("chart")).collect()
}

/// What must hold for every page, whatever the run was.
fn check(page: &str) -> Document<'_> {
    let document = parsed(page);
    let mut ids = BTreeSet::new();
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            assert!(ids.insert(id), "the identifier {id} stands twice");
        }
        for attribute in node.attributes() {
            let value = attribute.value();
            let drawn = ["d", "x", "y", "cx", "cy", "r", "width", "height", "viewBox", "transform"];
            if drawn.contains(&attribute.name()) && !node.has_tag_name("meta") {
                let broken = value.contains("NaN") || value.contains("inf") || value.contains('–');
                assert!(!broken, "{}={value}", attribute.name());
            }
            assert!(!["src", "onclick", "onload"].contains(&attribute.name()), "{attribute:?}");
            let leaves = attribute.name() == "href" && !value.starts_with('#');
            assert!(!leaves, "{value} leads off the page");
        }
    }
    for chart in charts(&document) {
        let named = chart.attribute("aria-labelledby").expect("each picture is named");
        assert!(named.split(' ').all(|id| ids.contains(id)), "{named}");
        for part in ["title", "desc"] {
            let has = chart
                .children()
                .any(|n| n.has_tag_name(part) && n.text().is_some_and(|t| !t.is_empty()));
            assert!(has, "each picture has a {part}");
        }
    }
    for outside in ["http://", "https://", "url(", "@import", "<iframe", "<img"] {
        assert!(!page.contains(outside), "{outside}");
    }
    document
}

#[test]
fn a_good_plate_is_called_good_in_words_and_by_sign() {
    let world = plate(4, 3, Mishap::None);
    let page = page(&world);
    let document = check(&page);
    let words = words(&document);
    assert!(
        words.contains("✓\nPASS\nAll 24 features that were cut are within tolerance."),
        "{words}"
    );
    assert!(words.contains("Threads within tolerance\n12 of 12\n✓ all"));
    // map, time, four pictures of a tap of which two have two panels, two paths, the run; the
    // worst thread is the first, the runners-up are folded away
    assert!(charts(&document).len() >= 2 + 6 + 3, "{}", charts(&document).len());
}

#[test]
fn a_bad_thread_comes_first_with_its_reason() {
    let world = plate(4, 3, Mishap::Saturated(6));
    let page = page(&world);
    let document = check(&page);
    let words = words(&document);
    assert!(
        words.contains(
            "✗\nFAIL: OUT OF TOLERANCE\nOf 24 features: 1 out of tolerance. Worst: line 36"
        ),
        "{words}"
    );
    assert!(words.contains("Worst thread: M6x1, No. 19, line 36"));
    assert!(words.contains("First thread: M6x1, No. 13, line 30"));
    let rows: Vec<_> = document
        .descendants()
        .filter(|n| n.has_tag_name("tr"))
        .filter_map(|n| n.attribute("class"))
        .collect();
    assert_eq!(rows[0], "fail");
    assert_eq!(rows.iter().filter(|class| **class == "pass").count(), 23);
    let crossed = document
        .descendants()
        .filter(|n| n.attribute("class") == Some("mark fail") && n.has_tag_name("g"));
    assert_eq!(crossed.count(), 1, "one crossed square on the map");
    assert!(words.contains("⚠ In 1 tap the spindle's drive was at its limit, for up to"));
    assert!(
        words.contains("⚠ In 1 thread the sync error passed the warning limit of 25 µm: No. 19.")
    );
}

#[test]
fn a_run_that_faulted_says_so_before_anything_else() {
    let world = plate(4, 3, Mishap::Faulted(2));
    let page = page(&world);
    let document = check(&page);
    let words = words(&document);
    assert!(
        words.contains("✗\nSTOPPED BY AN ALARM\nAlarm 301 in line 32: The tap left its coupling"),
        "{words}"
    );
    assert!(words.contains("✗ The tap of line 32 did not come out of its hole in step."));
    assert!(words.contains("Worst thread: M6x1, No. 15, line 32"));
}

#[test]
fn a_program_that_did_not_end_is_not_good_though_every_feature_is() {
    let mut world = plate(2, 1, Mishap::None);
    world.run.ended = false;
    assert!(words(&check(&page(&world))).contains("✗\nSTOPPED"));
}

#[test]
fn an_empty_run_is_a_page_that_says_there_is_nothing() {
    let page = report::html(&run("empty.ngc"), &Recorder::default(), &[]);
    let document = check(&page);
    assert!(words(&document).contains("○\nNOTHING TO JUDGE"));
    assert!(charts(&document).is_empty());
}

#[test]
fn no_text_of_a_program_or_file_becomes_markup() {
    let evil = "</title></script><script>alert(1)</script><img src=x onerror=alert(1)>\"'&\u{0}";
    let mut world = plate(2, 1, Mishap::Saturated(1));
    let run = &mut world.run;
    for text in
        [&mut run.program, &mut run.machine, &mut run.dialect, &mut run.material, &mut run.version]
    {
        *text = evil.into();
    }
    run.alarms.push(Alarm {
        number: 1,
        text: evil.into(),
        remedy: Some(evil.into()),
        line: 1,
        time: Time::ZERO,
    });
    run.notes.push(Note { warning: true, text: evil.into(), line: 3 });
    run.limiting.insert(3, evil.into());
    run.origin.as_mut().expect("there is one").name = evil.into();
    let mut tool = run.tools.get(3).expect("there is one").clone();
    tool.description = evil.into();
    run.tools.insert(tool);
    for feature in &mut world.features {
        feature.verdict = Verdict::Fail { reason: evil.into() };
        if let FeatureKind::Thread(thread) = &mut feature.kind {
            thread.size = evil.into();
        }
    }
    let page = page(&world);
    let document = check(&page);
    let scripts = document.descendants().filter(|n| n.has_tag_name("script")).count();
    assert_eq!(scripts, 1, "the page's own and no other");
    assert!(!document.descendants().any(|n| n.has_tag_name("img")));
    // 1 title, verdict, key figures, alarms, notes, map, table, threads, time, path: all say it
    // literally
    let said = words(&document).matches("<script>alert(1)</script>").count();
    assert!(said > 20, "{said}");
}

#[test]
fn figures_that_are_no_numbers_spoil_no_picture() {
    let mut world = plate(2, 1, Mishap::None);
    for feature in &mut world.features {
        let nan = Length::mm(f64::NAN);
        match &mut feature.kind {
            FeatureKind::Hole(hole) => (hole.x, hole.diameter, hole.depth_error) = (nan, nan, nan),
            FeatureKind::Polygon(_)
            | FeatureKind::Cam(_)
            | FeatureKind::Turned(_)
            | FeatureKind::Milled(_)
            | FeatureKind::Gear(_) => {}
            FeatureKind::Thread(thread) => {
                (thread.margin, thread.sync_error_max, thread.pitch_diameter_tolerance) =
                    (nan, nan, nan);
                thread.profile[3].inward = Some([nan, Length::mm(f64::INFINITY)]);
            }
        }
    }
    world.run.cycle_time = Time::s(f64::INFINITY);
    world.run.limits = Limits {
        torque: vec![(Spin::ZERO, Torque::n_m(f64::NAN))],
        sync_warn: Length::mm(f64::NAN),
        sync_stop: Length::mm(f64::INFINITY),
    };
    check(&page(&world));
}

#[test]
fn equal_runs_give_equal_pages_byte_for_byte() {
    let pages = [(); 2].map(|()| page(&plate(3, 2, Mishap::Saturated(4))));
    assert!(pages[0] == pages[1]);
}

#[test]
fn five_hundred_bad_features_stay_under_a_megabyte_and_a_half_and_a_thousand_are_well_formed() {
    let mut world = plate(25, 10, Mishap::None);
    let reason = "the groove is 20 µm wider than 6H allows: the No-go gauge enters; the thread is 0.12 mm too deep";
    let fail = |feature: &Feature| Feature {
        verdict: Verdict::Fail { reason: reason.into() },
        ..feature.clone()
    };
    world.features = world.features.iter().map(fail).collect();
    let size = page(&world).len();
    assert!(size < 1_500_000, "{size}");
    let shifted = world.features.clone().into_iter().map(|mut feature| {
        if let FeatureKind::Thread(thread) = &mut feature.kind {
            thread.x += Length::mm(0.7);
        }
        feature
    });
    world.features.extend(shifted.collect::<Vec<_>>());
    assert_eq!(world.features.len(), 1000);
    let page = page(&world);
    let document = check(&page);
    let rows = document
        .descendants()
        .filter(|n| n.has_tag_name("tr") && n.attribute("class") == Some("fail"));
    assert_eq!(rows.count(), 1000);
}

#[test]
fn a_run_without_a_torque_curve_or_work_offset_is_drawn_in_machine_coordinates() {
    let world = plate(2, 1, Mishap::None);
    let limits = Limits { torque: Vec::new(), ..world.run.limits.clone() };
    let run = Run { origin: None, limits, ..world.run };
    let page = report::html(&run, &world.recorder, &world.features);
    let words = words(&check(&page));
    assert!(words.contains("X in machine coordinates / mm"));
    assert!(words.contains("its curve is not known"));
}

/// Contrast of two colours by WCAG 2.1: (L₁ + 0.05)/(L₂ + 0.05), L the relative luminance.
fn contrast(a: &str, b: &str) -> f64 {
    let luminance = |colour: &str| {
        let digits: Vec<char> = colour.trim_start_matches('#').chars().collect();
        let each = digits.len() / 3;
        let part = |i: usize| {
            let text: String = digits[i * each..(i + 1) * each].iter().cycle().take(2).collect();
            let c = f64::from(u8::from_str_radix(&text, 16).expect("a hexadecimal colour")) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * part(0) + 0.7152 * part(1) + 0.0722 * part(2)
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn text_and_lines_stand_out_from_their_ground_in_light_and_dark() {
    let style = include_str!("../src/page/style.css");
    let schemes: Vec<_> = style.split("@media (prefers-color-scheme:dark)").collect();
    for scheme in &schemes[..2] {
        let colour = |name: &str| {
            let at =
                scheme.find(&format!("--{name}:")).unwrap_or_else(|| panic!("no colour {name}"));
            let rest = &scheme[at + name.len() + 3..];
            rest[..rest.find([';', '}']).expect("it ends")].to_owned()
        };
        for (front, ground, least) in [
            ("ink", "paper", 7.0),
            ("ink", "card", 7.0),
            ("ink", "fail-bg", 7.0),
            ("ink", "pass-bg", 7.0),
            ("soft", "card", 4.5),
            ("pass", "pass-bg", 4.5),
            ("fail", "fail-bg", 4.5),
            ("none", "none-bg", 4.5),
            ("in", "card", 3.0),
            ("out", "card", 3.0),
            ("second", "card", 3.0),
            ("warn", "card", 3.0),
            ("stop", "card", 3.0),
            ("share", "card", 3.0),
        ] {
            let found = contrast(&colour(front), &colour(ground));
            assert!(found >= least, "{front} on {ground}: {found:.2}, at least {least}");
        }
    }
}

#[test]
fn an_engraving_that_never_is_straight_still_gives_a_small_page() {
    let mut recorder = Recorder::default();
    for k in 0..300_000u32 {
        let t = f64::from(k) * 0.7;
        let mut sample = bus::Sample::default();
        sample.feedback.time = Time::s(f64::from(k) * 250e-6);
        sample.feedback.tool = Some(1);
        sample.report.state = if k % 5 == 0 { bus::State::Rapid } else { bus::State::Feed };
        let at = [100.0 * t.sin(), 60.0 * (1.3 * t).cos(), 5.0 * (0.1 * t).sin()];
        for (axis, value) in sample.feedback.axes.iter_mut().zip(at) {
            axis.position = Coordinate::new(value);
        }
        recorder.sample(&sample);
    }
    let page = report::html(&run("engraving.ngc"), &recorder, &[]);
    check(&page);
    assert!(page.len() < 1_500_000, "{}", page.len());
}

/// A frame whose zero lies there.
fn frame(work_offset: u8, x: f64, unit: LengthUnit) -> ProgramFrame {
    ProgramFrame { unit, work_offset, origin: Position::xyz(x, 100.0, 0.0), ..Default::default() }
}

/// The cells of a row of a feature's table.
fn row_of(document: &Document<'_>, number: usize) -> Vec<String> {
    let id = format!("F{number}");
    let row = document.descendants().find(|n| n.attribute("id") == Some(&id)).expect("its row");
    let text = |cell: Node<'_, '_>| {
        cell.descendants().filter(Node::is_text).filter_map(|n| n.text()).collect::<String>()
    };
    row.children().filter(Node::is_element).map(text).collect()
}

#[test]
fn each_feature_is_told_in_the_work_offset_in_which_it_was_programmed() {
    let mut world = plate(2, 1, Mishap::None);
    for feature in &world.features {
        let [number, zero] = if feature.op <= 2 { [1.0, 150.0] } else { [2.0, 170.0] };
        world.recorder.frame(feature.op, frame(number as u8, zero, LengthUnit::Millimetre));
    }
    let page = page(&world);
    let document = check(&page);
    // both are at X165 of the machine
    let (first, last) = (row_of(&document, 1), row_of(&document, 3));
    assert!(first.contains(&"G54".into()) && first.contains(&"15.000".into()), "{first:?}");
    assert!(last.contains(&"G55".into()) && last.contains(&"-5.000".into()), "{last:?}");
    assert!(words(&document).contains("X in machine coordinates / mm"), "the map has both");
}

#[test]
fn what_was_not_cut_is_not_cut_and_has_no_depth_that_is_out_of_tolerance() {
    let mut world = plate(2, 1, Mishap::None);
    let feature = &mut world.features[3];
    let reason = "not cut: the program ended before it".to_owned();
    feature.verdict = Verdict::Fail { reason };
    feature.contact.reach = Some(Length::ZERO);
    if let FeatureKind::Thread(thread) = &mut feature.kind {
        thread.tip_depth = Length::ZERO;
        thread.depth_error = Length::mm(-20.0);
    }
    let page = page(&world);
    let document = check(&page);
    let words = words(&document);
    assert!(words.contains("✗\nFAIL: NOT CUT"), "{words}");
    assert!(words.contains("Of 4 features: 1 not cut."), "{words}");
    assert!(words.contains("∅ 1 not cut") && !words.contains("-20000"), "{words}");
    let row = row_of(&document, 4);
    assert!(row.contains(&"∅ not cut".into()), "{row:?}");
    assert!(document.descendants().any(|n| n.attribute("class") == Some("mark uncut")));
}

#[test]
fn a_program_in_inches_has_its_places_in_inches_and_millimetres_behind_them() {
    let mut world = plate(2, 1, Mishap::None);
    world.recorder = world.recorder.shown_in(Some(LengthUnit::Inch));
    let page = page(&world);
    let document = check(&page);
    let row = row_of(&document, 1);
    // 15 mm, 19.003 mm, 3 µm
    for text in ["0.5906", "0.7481", "118"] {
        assert!(row.contains(&text.into()), "{text}: {row:?}");
    }
    assert!(document.descendants().any(|n| n.attribute("title") == Some("15.000 mm")));
}

#[test]
fn the_pictures_of_a_program_in_inches_are_in_inches() {
    let mut world = plate(3, 2, Mishap::None);
    let texts_of_charts = |world: &World| -> Vec<String> {
        let page = page(world);
        let document = check(&page);
        let charts = document.descendants().filter(|n| n.has_tag_name("svg"));
        charts
            .flat_map(|svg| svg.descendants().filter(Node::is_text))
            .filter_map(|n| n.text().map(str::to_owned))
            .collect()
    };
    let has = |texts: &[String], part: &str| texts.iter().any(|text| text.contains(part));
    let metric = texts_of_charts(&world);
    assert!(has(&metric, "sync error / µm") && has(&metric, "z over the surface / mm"));
    world.recorder = world.recorder.shown_in(Some(LengthUnit::Inch));
    let inch = texts_of_charts(&world);
    for title in [
        "sync error / µin",
        "depth of the tip below the surface / in",
        "z over the surface / in",
        "off the line / µin",
    ] {
        assert!(has(&inch, title), "{title}: {inch:?}");
    }
    for unit in ["µm", "/ mm", " mm "] {
        let left: Vec<_> = inch.iter().filter(|text| text.contains(unit)).collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

#[test]
fn every_link_of_a_page_leads_somewhere_and_a_line_to_what_it_cut() {
    for lines in [40, 5000] {
        let mut world = plate(4, 3, Mishap::Saturated(6));
        let line = |n: u32| format!("N{n} G84 <b>X{n}\n");
        world.run.listing = (1..=lines).map(line).collect::<String>().into_bytes();
        let page = page(&world);
        let document = check(&page);
        let all = || document.descendants().filter(Node::is_element);
        let ids: BTreeSet<&str> = all().filter_map(|n| n.attribute("id")).collect();
        let links: Vec<&str> = all().filter_map(|n| n.attribute("href")).collect();
        for link in &links {
            let target = link.strip_prefix('#').expect("it stays on the page");
            assert!(ids.contains(target), "{link} leads nowhere");
        }
        // a thread's line, and back; a drilled hole's path, and back
        for link in ["#L36", "#F19", "#P12", "#L12"] {
            assert!(links.contains(&link), "{link} of {lines} lines");
        }
        let shown = ids.iter().filter(|id| id.starts_with('L')).count();
        assert!(shown <= 200, "{shown} of {lines} lines are shown");
    }
}

#[test]
fn a_thread_that_was_not_cut_has_no_sync_error_on_the_page() {
    let mut world = plate(4, 1, Mishap::None);
    for feature in &mut world.features[4..] {
        let reason = "not cut: the tip came no nearer than 3.000 mm to the stock".to_owned();
        feature.verdict = Verdict::Fail { reason };
        feature.contact.reach = Some(Length::ZERO);
        if let FeatureKind::Thread(thread) = &mut feature.kind {
            thread.tip_depth = Length::ZERO;
            thread.sync_error_max = Length::ZERO;
        }
    }
    let words = words(&check(&page(&world)));
    assert!(words.contains("Thread not cut"), "{words}");
    assert!(words.contains("no contact with the material"), "{words}");
    assert!(!words.contains("in the last."), "no course from hole to hole: {words}");
    assert!(!words.contains("Sync error 0.0") && !words.contains("sync error 0.0"), "{words}");
}
