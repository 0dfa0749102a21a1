//! Leadscrew as a component of LinuxCNC's HAL: `loadrt leadscrew axes=XYZ`,
//! `addf leadscrew.update servo-thread`.
//!
//! ```text
//!   leadscrew control --drives hal     shared memory            rtapi_app
//!   interpreter, planner, observers ◄────────────────────────►  attendant: makes kernels    ┐ beside the
//!                                                                                           │ servo thread
//!                                          pins ─► Feedback ─► kernel::tick ─► Command ─► pins   in it
//! ```
//!
//! HAL's servo thread calls [`ServoProcess::update`] once a period: it reads the pins, lets the
//! kernel tick, and writes the pins. It takes no memory, no lock and calls no system. Who leads
//! the kernel is another process, which may end at any moment: the kernel then stops the machine,
//! coupled axes on their coupling, and holds it.
#![allow(unsafe_code)] // this crate is called by HAL and calls it: the reason stands beside each
mod axis_pins;
#[cfg(test)]
mod bench;
mod dial_pins;
mod driven;
#[cfg(test)]
mod fake;
mod ffi;
#[cfg(test)]
mod guarded_tests;
mod index;
mod jog_pins;
#[cfg(test)]
mod man;
mod new_pin;
mod panel_pins;
mod parameters;
mod pins;
mod spindle_pins;
#[cfg(test)]
mod tests;

use ffi::{Hal, Member};
use pins::Pins;
use shm::{ServoProcess, ServoProcessOptions};
use std::ffi::{c_int, c_long, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, Ordering::SeqCst};
use std::time::Duration;

/// What `loadrt` has loaded.
struct Component {
    process: ServoProcess<Pins>,
    hal: Member,
}

/// The component, between load and unload.
static LOADED: AtomicPtr<Component> = AtomicPtr::new(null_mut());
/// HAL's thread is within [`update`].
static IS_WITHIN: AtomicBool = AtomicBool::new(false);

/// It is to be unloaded: what moves comes to rest before its pins are gone.
static IS_LEAVING: AtomicBool = AtomicBool::new(false);
/// Nothing is commanded any more.
static IS_OFF: AtomicBool = AtomicBool::new(true);
/// How often HAL's thread has called.
static CALLS: AtomicU64 = AtomicU64::new(0);

/// Coming to rest may take so long before the component is unloaded.
const COMES_TO_REST: Duration = Duration::from_secs(30);
/// A thread that has not called for so long does not run.
const THREAD_STANDS: Duration = Duration::from_secs(2);
/// Between two looks at it.
const LOOK: Duration = Duration::from_millis(1);

/// Called by rtapi when the module is loaded; 0, or what is negative where it cannot be.
#[unsafe(no_mangle)]
pub extern "C" fn rtapi_app_main() -> c_int {
    match catch_unwind(load) {
        Ok(Ok(())) => 0,
        Ok(Err(why)) => {
            ffi::say(&format!("leadscrew: {why}"));
            -22 // EINVAL
        }
        Err(_) => -22,
    }
}

fn load() -> Result<(), String> {
    std::hint::black_box(&shm::BUILD_MARK); // `leadscrew doctor` reads it in the module's file
    let parameters = parameters::read()?;
    let hal = Hal::begin("leadscrew")?;
    let pins = Pins::new(&hal, &parameters)?;
    let process = ServoProcess::new(
        pins,
        ServoProcessOptions {
            name: parameters.name,
            machine: None,
            axes: parameters.axes,
            spindles: parameters.spindles,
            not_called: "no thread calls leadscrew.update: addf leadscrew.update servo-thread, and start",
            axis_missing: |letter| format!("the component was loaded without it: axes=…{letter}"),
            undriven: |names| {
                format!(
                    "nothing drives {names} of leadscrew in HAL, and the machine's file relies on it: net a signal with a writer to each (estop-ok is TRUE while the chain is closed; estop = \"none\" under [hal] says that there is no chain)"
                )
            },
        },
    )?;
    let component = Component { process, hal: hal.member() };
    IS_LEAVING.store(false, SeqCst);
    IS_OFF.store(true, SeqCst);
    // from here on it may be called at any time; it does nothing yet
    hal.export(c"leadscrew.update", update)?;
    hal.ready()?;
    LOADED.store(Box::into_raw(Box::new(component)), SeqCst);
    hal.stay();
    Ok(())
}

/// A signal keeps the value of a pin that is gone: what moves comes to rest before, coupled axes on
/// their coupling, as long as HAL's thread calls.
fn come_to_rest() {
    IS_LEAVING.store(true, SeqCst);
    let looks = |time: Duration| time.as_millis() / LOOK.as_millis();
    let (mut calls, mut idle) = (CALLS.load(SeqCst), 0);
    for _ in 0..looks(COMES_TO_REST) {
        if IS_OFF.load(SeqCst) || idle > looks(THREAD_STANDS) {
            return;
        }
        std::thread::sleep(LOOK);
        let now = CALLS.load(SeqCst);
        idle = if now == calls { idle + 1 } else { 0 };
        calls = now;
    }
}

/// Called by rtapi when the module is unloaded; HAL's threads may run on meanwhile.
#[unsafe(no_mangle)]
pub extern "C" fn rtapi_app_exit() {
    come_to_rest();
    let component = LOADED.swap(null_mut(), SeqCst);
    while IS_WITHIN.load(SeqCst) {
        std::thread::sleep(Duration::from_micros(100));
    }
    if component.is_null() {
        return;
    }
    // SAFETY: from `Box::into_raw` in `load`, and taken out of `LOADED` once. `update` says that it
    // is within before it looks at `LOADED`, and is not: whenever it is called again, it finds
    // null. (Both orders are sequentially consistent.)
    let component = unsafe { Box::from_raw(component) };
    let hal = component.hal;
    drop(component);
    ffi::leave(hal); // its pins are not used any more
}

/// Called by HAL's servo thread, with the period in ns.
unsafe extern "C" fn update(_: *mut c_void, period: c_long) {
    IS_WITHIN.store(true, SeqCst);
    // SAFETY: what `load` has put there, until `rtapi_app_exit` takes it out and waits for
    // `IS_WITHIN`; HAL calls the function in one thread at a time (it is not exported as
    // reentrant), so that nothing else refers to it meanwhile.
    if let Some(component) = unsafe { LOADED.load(SeqCst).as_mut() } {
        let period = u64::try_from(period).unwrap_or(0);
        if IS_LEAVING.load(SeqCst) {
            component.process.leave();
        }
        if catch_unwind(AssertUnwindSafe(|| component.process.update(period))).is_err() {
            component.process.break_down();
        }
        IS_OFF.store(component.process.is_off(), SeqCst);
        CALLS.fetch_add(1, SeqCst);
    }
    IS_WITHIN.store(false, SeqCst);
}
