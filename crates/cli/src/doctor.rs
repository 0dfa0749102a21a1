//! `leadscrew doctor`: whether this computer can lead a machine.
use crate::args::{DoctorArgs, DoctorOutput};
use crate::{interrupt, progress, say};
use control::Refused;
use control::config::machine_file::load;
use leadscrew::doctor::{
    Computer, ComputerFinding, Examination, ExaminationOptions, Health, Latency, LatencyOptions,
    Rights, examine, measure,
};
use report::{DoctorPage, DoctorRow, LatencyPicture};
use serde_json::{Value, json};
use std::fmt::Write as _;
use units::Time;

/// A measurement is an hour at most.
const LONGEST_S: f64 = 3600.0;
/// Priority of the servo thread where it is not stated.
const PRIORITY: u8 = 80;
/// Steps of the progress bar.
const STEPS: u64 = 1000;

/// Examines the computer; false if a machine is not to be led from it as it is.
pub(crate) fn command(args: &DoctorArgs, quiet: bool) -> Result<bool, Refused> {
    if !(0.0..=LONGEST_S).contains(&args.seconds) {
        return Err(Refused::because(format!(
            "--seconds {}: expected 0 (no measurement) to {LONGEST_S}",
            args.seconds
        )));
    }
    let file = load(&args.machine)?;
    let mut options = ExaminationOptions::of(&file);
    if let Some(interface) = &args.interface {
        options.interface = Some(interface.clone());
    }
    let computer = Computer::default();
    let mut found = examine(&computer, Rights::of_this_process(&computer), &options);
    if args.seconds > 0.0 {
        found = found.with_latency(latency(args, options.period)?);
    }
    if let Some(out) = &args.out {
        let page = report::doctor_html(&page(&file.name, &found));
        store::output::write_file(out, page.as_bytes())?;
    }
    say::out(&match args.format {
        DoctorOutput::Text if quiet => String::new(),
        DoctorOutput::Text => text(&file.name, &found),
        DoctorOutput::Json => format!("{}\n", as_json(&file.name, &found)),
    })?;
    Ok(!found.is_wrong())
}

fn latency(args: &DoctorArgs, period: Time) -> Result<Latency, Refused> {
    interrupt::watch()?;
    let bar = progress::Progress::new(STEPS, "measuring how late periods begin");
    let options = LatencyOptions {
        period,
        lasts: Time::s(args.seconds),
        under_load: args.load,
        priority: PRIORITY,
    };
    measure(&options, interrupt::flag(), &|share| {
        bar.set_position((share * STEPS as f64) as u64);
    })
}

fn verdict(name: &str, found: &Examination) -> String {
    let count = |health| found.findings.iter().filter(|one| one.health == health).count();
    let measured = if found.latency.is_some() { "" } else { "; latency was not measured" };
    match (count(Health::Wrong), count(Health::Improve)) {
        (0, 0) => format!("{name} can be led from this computer{measured}"),
        (0, improve) => {
            format!("{name} can be led from this computer; {improve} to improve{measured}")
        }
        (wrong, improve) => {
            format!(
                "{name} is not to be led from this computer as it is: {wrong} wrong, {improve} to improve{measured}"
            )
        }
    }
}

fn sign(health: Health) -> &'static str {
    match health {
        Health::Good => "good",
        Health::Note => "note",
        Health::Improve => "IMPROVE",
        Health::Wrong => "WRONG",
        Health::Unknown => "not known",
    }
}

fn text(name: &str, found: &Examination) -> String {
    let mut text = String::new();
    for ComputerFinding { topic, health, says, remedy } in &found.findings {
        // writing to a text cannot fail
        let _ = writeln!(text, "{:<16}{:<10}{says}", topic.name(), sign(*health));
        if let Some(remedy) = remedy {
            let _ = writeln!(text, "{:26}to change: {remedy}", "");
        }
    }
    for refused in found.latency.iter().flat_map(|latency| &latency.refused) {
        let _ = writeln!(text, "{:<16}{:<10}{refused}", "measured", "note");
    }
    text + "\n" + &verdict(name, found) + "\n"
}

fn us(time: Time) -> f64 {
    (time.value() * 1e8).round() / 100.0
}

fn as_json(name: &str, found: &Examination) -> Value {
    let findings = found.findings.iter().map(|one| {
        json!({ "topic": one.topic.name(), "health": one.health.name(), "says": one.says, "remedy": one.remedy })
    });
    let latency = found.latency.as_ref().map(|latency| {
        let bins = latency.histogram.iter().enumerate().filter(|(_, count)| **count > 0);
        json!({
            "period_us": us(latency.period),
            "under_load": latency.under_load,
            "core": latency.core,
            "periods": latency.periods,
            "missed": latency.missed,
            "median_us": us(latency.quantile(0.5)),
            "p99_us": us(latency.quantile(0.99)),
            "p999_us": us(latency.quantile(0.999)),
            "worst_us": us(latency.worst),
            "behind_thread_um": found.effect.behind(latency.worst).in_um(),
            "lead_mm": found.effect.lead.value(),
            "speed_rpm": found.effect.speed.in_rpm(),
            "histogram_us": bins.map(|(us, count)| json!([us, count])).collect::<Vec<_>>(),
            "refused": latency.refused,
        })
    });
    json!({
        "machine": name,
        "can_lead": !found.is_wrong(),
        "findings": findings.collect::<Vec<_>>(),
        "latency": latency,
    })
}

fn page(name: &str, found: &Examination) -> DoctorPage {
    let rows = found.findings.iter().map(|one| DoctorRow {
        topic: one.topic.name().to_owned(),
        health: one.health.name(),
        says: one.says.clone().into_owned(),
        remedy: one.remedy.clone().unwrap_or_default().into_owned(),
    });
    DoctorPage {
        title: format!("This computer as the control of {name}"),
        verdict: (!found.is_wrong(), verdict(name, found)),
        rows: rows.collect(),
        latency: found.latency.as_ref().map(|latency| LatencyPicture {
            period_us: us(latency.period),
            histogram: latency.histogram.clone(),
            worst_us: us(latency.worst),
            caption: caption(latency),
        }),
    }
}

fn caption(latency: &Latency) -> String {
    let beside = if latency.under_load { "with every core busy" } else { "beside what ran then" };
    format!(
        "{} periods, {beside}: half began within {:.0} µs, 99 of 100 within {:.0} µs, 999 of 1000 within {:.0} µs, the latest after {:.0} µs.",
        latency.periods,
        us(latency.quantile(0.5)),
        us(latency.quantile(0.99)),
        us(latency.quantile(0.999)),
        us(latency.worst)
    )
}
