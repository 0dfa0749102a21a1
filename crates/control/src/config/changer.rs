//! A changer that a sequence works: where the tools are, and its simulated hardware.
use canon::{Magazine, ToolLibrary};
use store::machine::MachineFile;

/// Where the tools are that the tool table names: in their pockets. Those without one, or whose
/// pocket is taken, are in the free pockets, in rising order. Nothing is in the spindle.
pub fn magazine(machine: &MachineFile, tools: &ToolLibrary) -> Option<Magazine> {
    machine.tool_change_sequence.as_ref()?;
    let count = machine.carousel.map_or(0, |file| file.carousel.pockets as usize);
    let mut pockets = vec![0; count];
    let mut without = Vec::new();
    for tool in tools.iter().filter(|tool| tool.number != 0) {
        let stated = (tool.pocket as usize).checked_sub(1).and_then(|at| pockets.get_mut(at));
        match stated.filter(|held| **held == 0) {
            Some(held) => *held = tool.number,
            None => without.push(tool.number),
        }
    }
    without.sort_unstable();
    for (held, tool) in pockets.iter_mut().filter(|held| **held == 0).zip(without) {
        *held = tool;
    }
    Some(Magazine { pockets, spindle: 0, home: 0, at: (count > 0).then_some(1) })
}

/// The hardware of the carousel, with the tools where the table has them.
pub(super) fn carousel(
    machine: &MachineFile,
    tools: &ToolLibrary,
    seed: u64,
) -> Option<sim::CarouselModel> {
    let file = machine.simulated_carousel?;
    Some(sim::CarouselModel {
        pockets: magazine(machine, tools)?.pockets,
        change_z: file.change_z,
        clear_z: file.clear_z,
        outputs: file.outputs,
        inputs: file.inputs,
        swing: file.swing,
        drawbar: file.drawbar,
        pocket: file.pocket,
        delay: file.delay,
        bounce: file.bounce,
        seed,
    })
}
