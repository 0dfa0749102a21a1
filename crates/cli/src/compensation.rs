//! `leadscrew compensation`: what each way of compensating a cam's phase error leaves of the
//! contour error.
use crate::args::{CompensationArgs, CompensationOutput, Switch};
use crate::{progress, say, tables};
use control::Refused;
use leadscrew::compensation::{CompensationOptions, Progress, compensation};
use report::{CompensationPage, CompensationRow};
use serde_json::json;

/// Do it.
pub(crate) fn command(args: &CompensationArgs, quiet: bool) -> Result<(), Refused> {
    let bar = progress::Progress::new(1, "turning cams (simulated)");
    let page = compensation(&options(args), &|told| match told {
        Progress::Runs(runs) => bar.set_length(runs.max(1)),
        Progress::Row(name) => bar.set_message(name.to_owned()),
        Progress::Run => bar.inc(1),
    })?;
    drop(bar);
    if let Some(out) = &args.out {
        store::output::write_file(out, report::compensation_html(&page).as_bytes())?;
    }
    say::out(&match args.format {
        CompensationOutput::Text if quiet => String::new(),
        CompensationOutput::Text => text(&page),
        CompensationOutput::Json => format!("{}\n", as_json(&page)),
    })
}

fn options(args: &CompensationArgs) -> CompensationOptions {
    CompensationOptions {
        library: args.library.clone(),
        machine: args.machine.clone(),
        speeds: args.speeds.clone(),
        cams: args.cams.clone(),
        learn: args.learn,
        feed_forward: args.feed_forward == Switch::On,
        work_speed: args.work_speed.map(Into::into),
    }
}

/// Two tables: a screen has no room for phase errors and what the ways leave beside one another.
fn text(page: &CompensationPage) -> String {
    let named = |row: &CompensationRow| vec![row.name.clone(), row.rpm.to_string()];
    let rows: Vec<_> = page
        .rows
        .iter()
        .map(|row| {
            let shifts = row.shifts_deg.iter().map(|deg| format!("{deg:.4}"));
            named(row).into_iter().chain(shifts).collect()
        })
        .collect();
    let heads = ["cam", "rpm", "least squares", "by the flanks", "by the maximum"];
    let phases = tables::figures(&heads, &rows);
    let rows: Vec<_> = page
        .rows
        .iter()
        .map(|row| {
            let errors = row.ways.iter().map(|way| report::um_figure(way.contour_um));
            named(row).into_iter().chain(errors).collect()
        })
        .collect();
    let heads = ["cam", "rpm"].map(str::to_owned).into_iter();
    // a word a line: the columns are as narrow as their figures
    let heads: Vec<_> = heads.chain(page.ways.iter().map(|way| way.replace(' ', "\n"))).collect();
    let errors = tables::figures(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
    let notes = page.notes.join("\n");
    format!("phase error, °\n{phases}\n\ncontour error, µm\n{errors}\n{notes}\n")
}

fn as_json(page: &CompensationPage) -> serde_json::Value {
    let rows = page.rows.iter().map(|row| {
        let ways = row.ways.iter().zip(&page.ways).map(|(way, name)| {
            json!({ "way": name, "contour_error_max_um": way.contour_um, "contour_error_rms_um": way.rms_um })
        });
        json!({
            "profile": row.profile,
            "name": row.name,
            "rpm": row.rpm,
            "phase_error_deg": row.shifts_deg[0],
            "by_flanks_deg": row.shifts_deg[1],
            "by_maximum_deg": row.shifts_deg[2],
            "removal_rate_peak": row.removal_peak,
            "ways": ways.collect::<Vec<_>>(),
        })
    });
    json!({ "title": page.title, "rows": rows.collect::<Vec<_>>() })
}
