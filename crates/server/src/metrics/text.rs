//! From `OpenMetrics` to the older text format of Prometheus (0.0.4), for clients that read no
//! other.
//!
//! Both have the same series. There a counter is called by the name of its series, `…_total`; it
//! knows neither `info` nor units, and has no end mark.
use std::collections::HashMap;

/// The same series in the older format.
pub(super) fn plain(open: &str) -> String {
    let kinds: HashMap<&str, &str> =
        open.lines().filter_map(|line| line.strip_prefix("# TYPE ")?.split_once(' ')).collect();
    let mut text = String::with_capacity(open.len());
    for line in open.lines() {
        let about = ["# HELP ", "# TYPE "].into_iter().find(|about| line.starts_with(about));
        match about.and_then(|about| Some((about, line[about.len()..].split_once(' ')?))) {
            Some((about, (name, rest))) => {
                let (suffix, kind) = match kinds.get(name).copied() {
                    Some("counter") => ("_total", "counter"),
                    Some("info") => ("_info", "gauge"),
                    kind => ("", kind.unwrap_or("untyped")),
                };
                let rest = if about == "# TYPE " { kind } else { rest };
                text.extend([about, name, suffix, " ", rest, "\n"]);
            }
            None if line.starts_with("# ") => {} // a unit, or the end
            None => text.extend([line, "\n"]),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_and_facts_are_called_by_the_names_of_their_series() {
        let open = "# HELP a_seconds How long.\n# TYPE a_seconds counter\n# UNIT a_seconds seconds\na_seconds_total 1.5\n\
            # HELP b What it is.\n# TYPE b info\nb_info{x=\"# y\"} 1\n# HELP c How much.\n# TYPE c gauge\nc 2\n# EOF\n";
        let expected = "# HELP a_seconds_total How long.\n# TYPE a_seconds_total counter\na_seconds_total 1.5\n\
            # HELP b_info What it is.\n# TYPE b_info gauge\nb_info{x=\"# y\"} 1\n# HELP c How much.\n# TYPE c gauge\nc 2\n";
        assert_eq!(plain(open), expected);
    }
}
