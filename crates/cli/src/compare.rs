//! `leadscrew compare`: the same holes with a clutch holder and without, on a spindle that
//! scatters.
use crate::args::CompareArgs;
use crate::progress::Progress;
use crate::{say, tables};
use control::Refused;
use leadscrew::compare::{CompareOptions, Compared, WAYS, compare};
use report::TappingMethod;

/// Do it; whether every hole was cut.
pub(crate) fn command(args: &CompareArgs, quiet: bool) -> Result<bool, Refused> {
    let progress = Progress::new(u64::from(args.samples * WAYS), "tapping (simulated)");
    let Compared { comparison, closed_form } = compare(&options(args), &mut || progress.inc(1))?;
    drop(progress);
    let mut said = summary(&comparison.ways);
    for way in &comparison.ways {
        said += &not_good(way);
    }
    said += &closed_form.unwrap_or_default();
    said += &format!("{}\n", comparison.scatter);
    if let Some(out) = &args.out {
        let page = report::comparison_html(&comparison);
        store::output::write_file(out, page.as_bytes())?;
        said += &format!("report: {}\n", out.display());
    }
    if !quiet {
        say::out(&said)?;
    }
    Ok(comparison.ways.iter().all(|way| way.not_cut == 0))
}

fn options(args: &CompareArgs) -> CompareOptions {
    CompareOptions {
        source: args.source.options(),
        program: args.program.clone(),
        size: args.size.clone(),
        speed: args.speed,
        depth: args.depth,
        samples: args.samples,
        seed: args.seed,
        stopping_time: args.stopping_time,
        speed_scatter: args.speed_scatter,
        stopping_scatter: args.stopping_scatter,
        relay_scatter: args.relay_scatter,
    }
}

/// How many holes of a cycle are not good, and why the first of them is not.
fn not_good(way: &TappingMethod) -> String {
    let cut = way.depth_errors_mm.len();
    let say = |count: usize, all: usize, what: &str, why: &Option<String>| {
        let why = why.as_ref().filter(|_| count > 0);
        why.map_or_else(String::new, |why| {
            format!("{}: {count} of {all} holes {what}; {why}\n", way.name)
        })
    };
    say(way.failed, cut, "are out of tolerance", &way.why_failed)
        + &say(way.not_cut, way.not_cut + cut, "were not cut and are in no figure", &way.why_not)
}

fn summary(ways: &[TappingMethod]) -> String {
    let heads = [
        "cycle",
        "holes\ncut",
        "depth error\nmm",
        "1σ\nµm",
        "least\nmm",
        "largest\nmm",
        "out of\ntolerance",
        "not\ncut",
    ];
    let row = |way: &TappingMethod| {
        let of = |f: fn(f64, f64) -> f64, from| way.depth_errors_mm.iter().copied().fold(from, f);
        let known =
            |text: String| if way.depth_errors_mm.is_empty() { "–".to_owned() } else { text };
        vec![
            way.name.clone(),
            way.depth_errors_mm.len().to_string(),
            known(format!("{:+.3}", way.mean_mm())),
            known(format!("{:.2}", way.sigma_mm() * 1e3)),
            known(format!("{:+.3}", of(f64::min, f64::INFINITY))),
            known(format!("{:+.3}", of(f64::max, f64::NEG_INFINITY))),
            way.failed.to_string(),
            way.not_cut.to_string(),
        ]
    };
    let rows: Vec<_> = ways.iter().map(row).collect();
    format!("{}\n", tables::figures(&heads, &rows))
}
