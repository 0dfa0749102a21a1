//! `spec/fanuc-behaviours.md`: a rule each, a program, and what it means, worked out by hand.
use canon::{Feed, OpKind, Position};
use interp::{Dialect, MissingTools, Ops, Setup};
use std::{fmt::Write, fs, path::Path};

/// A number as the page writes it: three decimals at most.
fn number(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn place(to: &Position) -> String {
    to.linear.map(|coordinate| number(coordinate.value())).join(" ")
}

fn feed(feed: Feed) -> String {
    match feed {
        Feed::PerTime(speed) => format!("F{}", number(speed.in_mm_per_min())),
        Feed::PerRevolution(lead) => format!("F{}/rev", number(lead.value())),
        Feed::Duration(time) => format!("{} s", number(time.value())),
    }
}

/// What a program means, line by line; findings come last.
fn meaning(program: &str, dialect: Dialect, holes_alone: bool) -> String {
    let whole = if program.starts_with("O1\n") {
        program.to_owned()
    } else {
        format!("O1\n{program}M30\n")
    };
    let setup = Setup { dialect, missing_tools: MissingTools::StandIn, ..Setup::default() };
    let mut ops = Ops::new(whole.as_bytes(), &setup);
    let mut said = String::new();
    for op in ops.by_ref() {
        let line = match &op.kind {
            OpKind::Hole(hole) => {
                let [x, y, z] = hole.at.linear.map(|coordinate| number(coordinate.value()));
                format!("hole {x} {y} from {z} to {}", number(hole.bottom.value()))
            }
            OpKind::Tap(tap) => {
                let [x, y, z] = tap.start.linear.map(|coordinate| number(coordinate.value()));
                let (bottom, lead) = (number(tap.bottom.value()), number(tap.lead.value()));
                format!("tap {x} {y} from {z} to {bottom} lead {lead}")
            }
            _ if holes_alone => continue,
            OpKind::Rapid { to } => format!("rapid {}", place(to)),
            OpKind::Line { to, feed: rate } => format!("line {} {}", place(to), feed(*rate)),
            OpKind::Arc { to, arc, .. } => {
                format!("arc {} {}", place(to), if arc.sweep.value() < 0.0 { "cw" } else { "ccw" })
            }
            OpKind::Threading(thread) => {
                format!("thread {} lead {}", place(&thread.to), number(thread.lead.value()))
            }
            OpKind::Dwell { time } => format!("dwell {}", number(time.value())),
            OpKind::Message(text) => format!("message {text}"),
            OpKind::Pause { .. } => "pause".to_owned(),
            _ => continue,
        };
        let _ = writeln!(said, "{line}");
    }
    let mut codes = Vec::new();
    for finding in ops.diagnostics() {
        let line =
            format!("{} {}", if finding.is_error() { "error" } else { "warning" }, finding.code);
        if !codes.contains(&line) {
            let _ = writeln!(said, "{line}");
            codes.push(line);
        }
    }
    said
}

/// Runs the rules of a page of `spec`, and says how many it has.
fn hold(page: &str) -> usize {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec").join(page);
    let page = fs::read_to_string(path).unwrap();
    let (mut rules, mut wrong) = (0, Vec::new());
    let is_program =
        |part: &&str| ["fanuc", "haas", "mitsubishi"].iter().any(|d| part.starts_with(d));
    for part in page.split("```").filter(is_program) {
        let begin = part.as_ptr() as usize - page.as_ptr() as usize;
        let (options, rest) = page[begin..].split_once('\n').unwrap();
        let (program, rest) = rest.split_once("```\n").unwrap();
        let expected = rest.strip_prefix("```means\n").and_then(|rest| rest.split_once("```"));
        let expected = expected.unwrap_or_else(|| panic!("no meaning behind {program}")).0;
        let dialect = match options.split_whitespace().next() {
            Some("haas") => Dialect::Haas,
            Some("haas-lathe") => Dialect::HaasLathe,
            Some("mitsubishi") => Dialect::Mitsubishi,
            Some("fanuc-lathe") => Dialect::FanucLatheA,
            _ => Dialect::Fanuc,
        };
        let found = meaning(program, dialect, options.contains("holes"));
        if found != expected {
            wrong.push(format!("{program}means\n{found}and is expected to mean\n{expected}"));
        }
        rules += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    rules
}

#[test]
fn every_rule_of_the_page_holds() {
    assert!(hold("fanuc-behaviours.md") >= 60);
}

#[test]
fn haas_and_mitsubishi_differ_from_fanuc_as_their_page_says() {
    assert!(hold("haas-mitsubishi.md") >= 20);
}
