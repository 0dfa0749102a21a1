//! Ctrl-C while Python's lock is released. Python's own handler only notes the signal, for the main
//! thread to look at: so a run in the main thread looks now and then, and ends when it has come. A
//! run in another thread has nothing to look at.
use pyo3::prelude::*;
use std::cell::{Cell, RefCell};

/// Servo periods between two looks: some hundredths of a second of simulation.
const EVERY: u32 = 4096;

thread_local! {
    static IS_MAIN: Cell<bool> = const { Cell::new(false) };
    static PERIODS: Cell<u32> = const { Cell::new(0) };
    static HAS_RAISED: Cell<bool> = const { Cell::new(false) };
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// From now on signals are looked for in this thread.
pub(crate) fn watch(py: Python<'_>) -> PyResult<()> {
    let threading = py.import("threading")?;
    let main = threading.call_method0("main_thread")?;
    IS_MAIN.set(threading.call_method0("current_thread")?.is(&main));
    HAS_RAISED.set(false);
    PERIODS.set(0);
    RAISED.take();
    Ok(())
}

/// The exception that has ended the work since then, if there was one.
pub(crate) fn raised() -> PyResult<()> {
    HAS_RAISED.set(false);
    RAISED.take().map_or(Ok(()), Err)
}

/// Something was raised while Leadscrew worked: it is to end.
pub(crate) fn raise(error: PyErr) {
    HAS_RAISED.set(true);
    RAISED.set(Some(error));
}

/// Whether the work is to end: asked every servo period.
pub(crate) fn came() -> bool {
    let periods = PERIODS.get().wrapping_add(1);
    PERIODS.set(periods);
    if HAS_RAISED.get() {
        return true;
    }
    periods.is_multiple_of(EVERY) && came_now()
}

/// The same, with a look at the signals at once.
#[allow(clippy::redundant_closure_for_method_calls)] // the method itself is not general enough in its lifetime
pub(crate) fn came_now() -> bool {
    if IS_MAIN.get()
        && !HAS_RAISED.get()
        && let Err(error) = Python::attach(|py| py.check_signals())
    {
        raise(error);
    }
    HAS_RAISED.get()
}
