//! A tool that broke is broken until a person says that a new one is in its place.
//!
//! ```text
//!   machine: broken ─► life of the tool (kept on the disk) ─► programs that use it are refused
//!                              ▲ renew_tool: a person has put in a new one
//! ```
use super::control::Control;
use super::request::{Accepted, Refusal};
use canon::ToolWear;
use store::state::broken_tools;

impl Control {
    /// The machine says whether the tool in its spindle is broken; that is kept at once.
    pub(super) fn follow_broken_tool(&mut self) {
        let is_broken = self.executor.machine.truth().is_some_and(|truth| truth.tool_broken);
        let number = self.mounted();
        let now = is_broken.then_some(number).filter(|number| *number != 0);
        let before = std::mem::replace(&mut self.broken_in_spindle, now);
        let Some(number) = now.filter(|_| now != before) else { return };
        let Some(tool) = self.data.tools.get(number).filter(|tool| !tool.life.is_broken) else {
            return;
        };
        let mut tool = tool.clone();
        tool.life.is_broken = true;
        self.data.tools.insert(tool);
        self.events.notice(format!(
            "T{number} is broken: no program uses it before a new one is in its place (tool {number} renew)"
        ));
        if let Err(why) = self.keep_tools() {
            self.events.notice(why.to_string());
        }
    }

    /// A new tool is in its place: its life begins anew, it has no wear, and it is whole.
    pub(super) fn renew_tool(&mut self, number: u32) -> Result<Accepted, Refusal> {
        let accepted = self.change_tool(number, |tool| {
            tool.life.begin_anew();
            tool.wear = ToolWear::default();
        })?;
        self.executor.machine.renew_tool(number);
        self.executor.kernel.forget_bands(number);
        let path = self.kept.folder().map(|folder| folder.path().to_owned());
        if let Some(why) = path.and_then(|folder| broken_tools::is_renewed(&folder, number).err()) {
            self.events.notice(why);
        }
        Ok(accepted)
    }

    /// Tools that broke in a run with this state folder are broken here, too.
    pub(super) fn take_broken_tools(&mut self) {
        let Some(folder) = self.kept.folder().map(|folder| folder.path().to_owned()) else {
            return;
        };
        for number in broken_tools::of_runs(&folder) {
            if let Some(tool) = self.data.tools.get(number) {
                let mut tool = tool.clone();
                tool.life.is_broken = true;
                self.data.tools.insert(tool);
            }
        }
    }
}
