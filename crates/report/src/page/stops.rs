//! Stops in a thread and the ways out: what happened, in words, figures and the (θ, z) plane.
use crate::pictures;
use crate::stops::ThreadStop;
use crate::svg::{Tag, fixed};

/// Recoveries shown with pictures.
const MOST: usize = 4;

/// One block for each; nothing if there was none.
pub(super) fn recoveries(all: &[ThreadStop]) -> String {
    let blocks: String = all.iter().take(MOST).enumerate().map(|(i, r)| block(i, r)).collect();
    super::section::section("Stops and recoveries", &blocks)
}

fn block(index: usize, recovery: &ThreadStop) -> String {
    let broken = recovery.broken.map_or_else(String::new, |time| {
        format!(" The tap broke at {} s.", fixed(time.value(), 3))
    });
    let words = format!(
        "Line {}: {} at {} s. Spindle and feed came to rest {} µm from the thread's helix, and were {} µm off it at most in the stop.{broken}",
        recovery.line,
        recovery.cause,
        fixed(recovery.time.value(), 3),
        fixed(recovery.rest_um().abs(), 1),
        fixed(recovery.stop_error.in_um(), 1),
    );
    let head = [
        "way back",
        "who goes back",
        "damage index µm·rev",
        "way out, off the helix",
        "axial force",
        "thread",
    ];
    let head: String = head
        .iter()
        .map(|h| {
            let words = ["way back", "who goes back", "thread"].contains(h);
            if words { Tag::new("th").class("l").text(h) } else { Tag::new("th").text(h) }
        })
        .collect();
    let rows: String = recovery
        .ways
        .iter()
        .map(|way| {
            let name = if way.taken { format!("{} (taken)", way.name) } else { way.name.clone() };
            let cells = [
                fixed(recovery.damage_um_rev(way), 2),
                format!("{} µm", fixed(way.helix_error.in_um(), 1)),
                format!("{} N", fixed(way.force_n, 0)),
            ];
            let words = [name, way.mover.clone()];
            let mut row: String =
                words.iter().map(|cell| Tag::new("td").class("l words").text(cell)).collect();
            row += &cells.iter().map(|cell| Tag::new("td").text(cell)).collect::<String>();
            row += &Tag::new("td").class("l wide").text(&way.class);
            Tag::new("tr").around(&row)
        })
        .collect();
    let table =
        Tag::new("div").class("scroll").with("tabindex", "0").around(&Tag::new("table").around(
            &(Tag::new("thead").around(&Tag::new("tr").around(&head))
                + &Tag::new("tbody").around(&rows)),
        ));
    Tag::new("p").text(&words)
        + &table
        + &super::section::grid(&pictures::recovery_plane(recovery, index))
}
