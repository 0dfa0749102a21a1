//! What Prometheus may rely on: a real server, a machine that is simulated, and a lint of what is
//! served.

use crate::common::{How, Served};
use control::RealTimeOptions;
use serde_json::{Value, json};
use server::{BrokerAddress, BrokerTimeouts, PublishOptions, Role, Tokens, TopicPrefix};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::Duration;

const OPEN: (&str, &str) = ("accept", "application/openmetrics-text; version=1.0.0");

fn scrape(served: &Served) -> String {
    let (status, text) = served.raw("GET", "/metrics", &[OPEN]);
    assert_eq!(status, 200, "{text}");
    text
}

type Labels = Vec<(String, String)>;

/// A series: name, labels, value.
fn series(line: &str) -> Result<(String, Labels, f64), String> {
    let (series, value) = line.rsplit_once(' ').ok_or("no value")?;
    let value = value.parse().map_err(|_| format!("`{value}` is no number"))?;
    let Some((name, rest)) = series.split_once('{') else {
        return Ok((series.to_owned(), Vec::new(), value));
    };
    let mut rest = rest.strip_suffix('}').ok_or("labels do not end")?;
    let mut labels = Vec::new();
    while let Some((label, quoted)) = rest.split_once("=\"") {
        let mut end = 0;
        let bytes = quoted.as_bytes();
        while end < bytes.len() && bytes[end] != b'"' {
            end += if bytes[end] == b'\\' { 2 } else { 1 };
        }
        let text = quoted.get(..end).ok_or("a label does not end")?;
        labels.push((label.to_owned(), text.to_owned()));
        rest = quoted.get(end + 1..).ok_or("a label does not end")?.trim_start_matches(',');
    }
    if rest.is_empty() { Ok((name.to_owned(), labels, value)) } else { Err("labels".into()) }
}

fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(allowed)
}

/// What is wrong with a text in `OpenMetrics`, and with its names by the conventions of Prometheus.
fn lint(text: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut families = BTreeMap::<String, (String, String)>::new();
    let (mut family, mut unit) = (String::new(), String::new());
    let mut seen = BTreeSet::new();
    let mut bins: Option<(String, f64, f64)> = None;
    let Some(body) = text.strip_suffix("# EOF\n") else {
        return vec!["it does not end with `# EOF`".into()];
    };
    for line in body.lines() {
        let mut say = |what: &str| wrong.push(format!("{what}: {line}"));
        if let Some(about) = line.strip_prefix("# ") {
            let mut words = about.splitn(3, ' ');
            let (what, name, rest) = (words.next(), words.next(), words.next());
            let (name, rest) = (name.unwrap_or_default(), rest.unwrap_or_default());
            match what {
                Some("HELP") => {
                    if families.insert(name.into(), (String::new(), String::new())).is_some() {
                        say("a family stands twice");
                    }
                    if rest.trim().is_empty() || !is_name(name) {
                        say("no help, or no name");
                    }
                    (family, unit) = (name.to_owned(), String::new());
                }
                Some("TYPE") if name == family => {
                    if !["counter", "gauge", "histogram", "info"].contains(&rest) {
                        say("a type that is not used");
                    }
                    families.insert(family.clone(), (rest.to_owned(), unit.clone()));
                }
                Some("UNIT") if name == family => {
                    if !name.ends_with(&format!("_{rest}")) {
                        say("the name does not end with its unit");
                    }
                    rest.clone_into(&mut unit);
                }
                _ => say("a line that belongs to no family"),
            }
            continue;
        }
        let (name, labels, value) = match series(line) {
            Ok(series) => series,
            Err(why) => {
                say(&why);
                continue;
            }
        };
        let kind = families.get(&family).map_or("", |(kind, _)| kind.as_str());
        let suffix = name.strip_prefix(&family).unwrap_or("?");
        let fits = match kind {
            "counter" => suffix == "_total",
            "gauge" => suffix.is_empty() && !name.ends_with("_total"),
            "histogram" => ["_bucket", "_sum", "_count"].contains(&suffix),
            "info" => suffix == "_info",
            _ => false,
        };
        if !fits || labels.iter().any(|(label, _)| !is_name(label)) {
            say("the series is not one of its family");
        }
        if !seen.insert(line.rsplit_once(' ').unwrap().0.to_owned()) {
            say("a series stands twice");
        }
        if value.is_nan() || kind != "gauge" && value < 0.0 {
            say("a value that cannot be");
        }
        let not_base =
            ["_ms", "_us", "_mm", "_minutes", "_percent", "_rpm", "_milliseconds", "_count_total"];
        if not_base.iter().any(|end| family.ends_with(end)) {
            say("no base unit");
        }
        if suffix == "_bucket" {
            let rest: Vec<_> = labels.iter().filter(|(label, _)| label != "le").collect();
            let le = labels.iter().find(|(label, _)| label == "le").map(|(_, le)| le.as_str());
            let le = le.and_then(|le| le.parse::<f64>().ok());
            let of = format!("{family}{rest:?}");
            let Some(le) = le else {
                say("a bin without an end");
                continue;
            };
            if let Some((before, end, count)) = &bins
                && *before == of
                && (le <= *end || value < *count)
            {
                say("bins do not grow");
            }
            bins = Some((of, le, value));
        }
    }
    wrong
}

/// Names of series with their values, labels and all.
fn values(text: &str) -> BTreeMap<String, f64> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let value = |line: &str| {
        let (name, value) = line.rsplit_once(' ').unwrap();
        (name.to_owned(), value.parse().unwrap())
    };
    lines.map(value).collect()
}

#[test]
fn a_lint_finds_what_is_wrong() {
    let good = "# HELP a_seconds How long.\n# TYPE a_seconds counter\n# UNIT a_seconds seconds\na_seconds_total{x=\"\\\"\"} 1\n# EOF\n";
    assert_eq!(lint(good), Vec::<String>::new());
    for (from, to) in [
        ("# EOF\n", ""),
        ("a_seconds_total", "a_seconds"),
        ("UNIT a_seconds seconds", "UNIT a_seconds bytes"),
        ("counter", "sum"),
        ("\"} 1", "\"} -1"),
        ("\"} 1", "\"} one"),
        ("x=", "X="),
        ("How long.", ""),
        ("# EOF\n", "a_seconds_total{x=\"\\\"\"} 2\n# EOF\n"),
        ("# EOF\n", "# HELP a_seconds Again.\n# EOF\n"),
        ("# EOF\n", "b 2\n# EOF\n"),
    ] {
        assert!(!lint(&good.replace(from, to)).is_empty(), "{from} {to}");
    }
    let bins = "# HELP b B.\n# TYPE b histogram\nb_sum 1\nb_count 2\nb_bucket{le=\"1.0\"} 1\nb_bucket{le=\"+Inf\"} 2\n# EOF\n";
    assert_eq!(lint(bins), Vec::<String>::new());
    assert!(!lint(&bins.replace("\"+Inf\"} 2", "\"+Inf\"} 0")).is_empty());
}

#[test]
fn what_was_done_is_counted_and_served_as_the_standard_has_it() {
    let served = Served::at_pace(40.0);
    served.power_on();
    served.home();
    served.execute("plate.ngc");
    let features = served.get("/features").1;
    let features = features.as_array().unwrap();
    let count = |kind: &str| features.iter().filter(|f| f["kind"] == kind).count() as f64;
    let whole = "leadscrew_cycle_time_seconds_count{program=\"plate.ngc\"}";
    served.until("it is counted", |_| values(&scrape(&served)).contains_key(whole));
    let text = scrape(&served);
    assert_eq!(lint(&text), Vec::<String>::new(), "{text}");
    let found = values(&text);
    let of = |name: &str| found.get(name).copied().unwrap_or_else(|| panic!("{name}: {text}"));
    assert_eq!(of(whole), 1.0);
    assert_eq!(of("leadscrew_programs_total{end=\"completed\"}"), 1.0);
    assert_eq!(of("leadscrew_execution{state=\"PROGRAM_COMPLETED\"}"), 1.0);
    assert_eq!(of("leadscrew_execution{state=\"ACTIVE\"}"), 0.0);
    assert!(count("thread") >= 12.0, "{features:?}");
    for kind in ["thread", "hole"] {
        let counted = of(&format!("leadscrew_features_total{{kind=\"{kind}\",verdict=\"good\"}}"));
        assert_eq!(counted, count(kind), "{text}");
    }
    assert_eq!(of("leadscrew_sync_error_max_meters_count{kind=\"thread\"}"), count("thread"));
    let errors = features.iter().filter_map(|f| f["sync_error_max_um"].as_f64());
    let sum: f64 = errors.map(|um| um / 1e6).sum();
    let served_sum = of("leadscrew_sync_error_max_meters_sum{kind=\"thread\"}");
    assert!((served_sum - sum).abs() < 1e-9, "{served_sum} {sum}");
    assert!(of("leadscrew_cycle_time_seconds_sum{program=\"plate.ngc\"}") > 10.0);
    assert!(of("process_resident_memory_bytes") > 1e6);
    assert!(of("process_cpu_seconds_total") > 0.0);

    served.accepted(json!({ "request": "emergency_stop", "on": true }));
    served.until("an alarm", |status| status["alarms"] != json!([]));
    served.until("it is counted", |_| {
        let found = values(&scrape(&served));
        found
            .iter()
            .any(|(name, count)| name.starts_with("leadscrew_alarms_total{") && *count == 1.0)
    });
    let text = scrape(&served);
    assert_eq!(values(&text)["leadscrew_alarms_active"], 1.0);
    assert_eq!(values(&text)["leadscrew_emergency_stop_triggered"], 1.0);
    assert_eq!(values(&text)["leadscrew_ready"], 0.0);

    // the older format has the same series
    let (status, plain) = served.raw("GET", "/metrics", &[]);
    assert_eq!((status, plain.contains("EOF")), (200, false));
    let names = |text: &str| values(text).into_keys().collect::<Vec<_>>();
    assert_eq!(names(&plain), names(&text));
    for line in plain.lines().filter(|line| line.starts_with("# TYPE")) {
        let (name, kind) = line["# TYPE ".len()..].split_once(' ').unwrap();
        assert_eq!(kind == "counter", name.ends_with("_total"), "{line}");
    }
}

#[test]
fn metrics_are_read_by_whom_may_watch_and_nothing_else_is_done_this_way() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("tokens.toml");
    let token = Tokens::add(&file, "wall", Role::Viewer, Duration::from_hours(1)).unwrap().token;
    let served = Served::with(1.0, Some(file));
    let (status, text) = served.raw("GET", "/metrics", &[]);
    assert_eq!(status, 401, "{text}");
    assert!(text.contains("a token is needed"), "{text}");
    let bearer = format!("Bearer {token}");
    let bearer = ("authorization", bearer.as_str());
    assert_eq!(served.raw("GET", "/metrics", &[bearer]).0, 200);
    for method in ["POST", "PUT", "DELETE"] {
        let (status, text) = served.raw(method, "/metrics", &[bearer]);
        assert_eq!(status, 405, "{text}");
        assert!(text.contains("it takes GET and HEAD"), "{text}");
    }
    assert_eq!(served.raw("GET", "/metrics", &[bearer, ("host", "elsewhere")]).0, 403);
    let without = Served::of(How { metrics: false, ..How::default() });
    let (status, text) = without.raw("GET", "/metrics", &[]);
    assert_eq!((status, text.contains("--no-metrics")), (404, true), "{text}");
}

/// Names of metrics in an expression.
fn named(expression: &str) -> Vec<String> {
    let words = expression.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
    let is_metric = |word: &&str| word.starts_with("leadscrew_") || word.starts_with("process_");
    words.filter(is_metric).map(str::to_owned).collect()
}

/// Each family has a series: a thread was cut, a program is over, an alarm has come.
fn after_a_program_and_an_alarm() -> String {
    let served = Served::at_pace(40.0);
    served.power_on();
    served.home();
    let program = "G21 G54 G90 T3 M6\nG0 X12 Y12 G43 H3 Z5\nM3 S1000\nG99 G84 X12 Y12 Z-5 R5 F1000\nG80 M30\n";
    assert_eq!(served.put("/programs/one.ngc", program.as_bytes()).0, 200);
    served.execute("one.ngc");
    served.accepted(json!({ "request": "emergency_stop", "on": true }));
    served.until("it is counted", |_| scrape(&served).contains("leadscrew_alarms_total{"));
    scrape(&served)
}

#[test]
fn every_metric_of_the_dashboard_is_served() {
    let publish = Some(PublishOptions {
        broker: BrokerAddress::parse("mqtt://127.0.0.1:9").unwrap(), // nothing answers there
        login: None,
        authorities: None,
        topic: TopicPrefix::parse("shop").unwrap(),
        timeouts: BrokerTimeouts::default(),
        told: Box::new(|_| {}),
    });
    let real_time = Some(RealTimeOptions::default());
    let served = Served::of(How { real_time, publish, ..How::default() });
    let text = scrape(&served);
    assert_eq!(lint(&text), Vec::<String>::new(), "{text}");
    let lock_step = after_a_program_and_an_alarm();
    // what cannot be without a servo thread of its own is not served without
    assert!(!lock_step.contains("leadscrew_servo_"), "{lock_step}");
    assert!(text.contains("leadscrew_servo_tick_p999_seconds "), "{text}");
    let mut names = BTreeSet::new();
    for line in
        text.lines().chain(lock_step.lines()).filter_map(|line| line.strip_prefix("# TYPE "))
    {
        let (name, kind) = line.split_once(' ').unwrap();
        let suffixes: &[&str] = match kind {
            "counter" => &["_total"],
            "info" => &["_info"],
            "histogram" => &["_bucket", "_sum", "_count"],
            _ => &[""],
        };
        names.extend(suffixes.iter().map(|suffix| format!("{name}{suffix}")));
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/monitoring/grafana.json");
    let dashboard: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    assert!(dashboard["title"].is_string() && dashboard["schemaVersion"].is_u64());
    let mut used = BTreeSet::new();
    let mut ids = BTreeSet::new();
    for panel in dashboard["panels"].as_array().unwrap() {
        assert!(ids.insert(panel["id"].as_u64().unwrap()), "two panels have one id: {panel}");
        assert!(
            panel["gridPos"]["w"].as_u64().unwrap() + panel["gridPos"]["x"].as_u64().unwrap() <= 24
        );
        assert_eq!(panel["datasource"]["uid"], "${source}", "{panel}");
        assert!(panel["title"].is_string() && panel["type"].is_string());
        for target in panel["targets"].as_array().unwrap() {
            let found = named(target["expr"].as_str().unwrap());
            assert!(!found.is_empty(), "{target}");
            used.extend(found);
        }
    }
    let missing: Vec<_> = used.difference(&names).collect();
    assert!(missing.is_empty(), "{missing:?}: {names:?}");
    assert!(used.len() > 15, "{used:?}");
    assert_eq!(dashboard["templating"]["list"][0]["query"], "prometheus");
}
