//! A program begins where the machine stands: also on rotary axes, on a machine that another
//! program has left there.

use crate::common::{complained, said};
use crate::simulator::Simulator;

#[test]
fn a_program_begins_where_the_last_one_has_left_a_rotary_axis() {
    let simulator = Simulator::start(&["--machine", "mill-5-axis"]);
    let machine = ["--machine", "mill-5-axis"];
    let run = |text: &str| {
        let output = simulator.run(text, &machine);
        assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    };
    run("G21 G90 G54 G17\nG1 A30 C-400 F9000\nM2\n");
    // other axes move, and A stays where it is; then all of them go on from there
    run("G21 G90 G54 G17\nG0 X5 Y5\nG1 A12.5 C-395 F9000\nM2\n");
    run("G21 G90 G54 G17\nG1 A0 C0 F9000\nM2\n");
}
