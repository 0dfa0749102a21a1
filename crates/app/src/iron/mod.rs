//! `leadscrew iron`: the simulated machine with its drives and encoders, as a process of its own.
//!
//! ```text
//!   control ══ Unix socket ══► session: command ─► exchange ─► feedback
//!                  │ ends, is silent, or the power is cut
//!                  ▼
//!              drives left alone: coast, quick stop or coupled stop ─► everything stands ─► next session
//! ```
//!
//! In lock-step time waits for the control: the same inputs give the same outputs. When the control is gone the iron
//! runs down in its own time. With `--real-time` a period lasts as long as on a machine, and a control that is late gets its
//! last command repeated until the drives' watchdog has had enough. Workpiece, tap and encoders live here and
//! outlive every control.
mod machine;
mod retained;
mod serve;

use crate::args::IronArgs;
use crate::refused::Refused;
use crate::say;
use machine::Iron;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;
use wire::Order;

/// How long a control waits for an iron to answer.
const ANSWER: Duration = Duration::from_secs(20);

/// Do it.
pub(crate) fn command(args: &IronArgs) -> Result<(), Refused> {
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
        return Err(Refused::because("leadscrew iron: expected --listen PATH"));
    };
    serve::serve(Iron::new(args)?, listen)
}

/// A connection to the iron that listens there.
pub(crate) fn connect(path: &Path) -> Result<UnixStream, Refused> {
    let failed = |e| {
        let path = path.display();
        Refused::because(format!(
            "no iron listens at {path}: {e}; start one with: leadscrew iron --machine NAME --listen {path}"
        ))
    };
    let stream = UnixStream::connect(path).map_err(failed)?;
    stream.set_read_timeout(Some(ANSWER)).map_err(failed)?;
    Ok(stream)
}

/// What is said of an iron that does not answer as it should.
pub(crate) fn gone(path: &Path, error: &wire::Error) -> Refused {
    Refused::because(format!("the iron at {}: {error}", path.display()))
}
