//! `leadscrew simulator`: the simulated machine with its drives and encoders, as a process of its own.
//!
//! ```text
//!   control ══ Unix socket ══► session: command ─► exchange ─► feedback
//!                  │ ends, is silent, or the power is cut
//!                  ▼
//!              drives left alone: coast, quick stop or coupled stop ─► everything stands ─► next session
//! ```
//!
//! In lock-step time waits for the control: the same inputs give the same outputs. When the control is gone the machine simulator
//! runs down in its own time. With `--real-time` a period lasts as long as on a machine, and a control that is late gets its
//! last command repeated until the drives' watchdog has had enough. Workpiece, tap and encoders live here and
//! outlive every control.
mod machine;
mod retained;
mod serve;

use crate::args::SimulatorArgs;
use crate::say;
use control::Refused;
use control::plant::{connect, gone};
use machine::SimulatorProcess;
use wire::Order;

/// Do it.
pub(crate) fn command(args: &SimulatorArgs) -> Result<(), Refused> {
    let orders = [
        (&args.status, Order::Status),
        (&args.power_cut, Order::PowerCut),
        (&args.quit, Order::Quit),
    ];
    for (path, order) in orders {
        if let Some(path) = path {
            let answer = wire::order(connect(path)?, order).map_err(|e| gone(path, &e))?;
            return say::out(&format!("{answer}\n"));
        }
    }
    let Some(listen) = &args.listen else {
        return Err(Refused::because("leadscrew simulator: expected --listen PATH"));
    };
    serve::serve(SimulatorProcess::new(args)?, listen)
}
