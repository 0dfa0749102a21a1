//! Inputs of which HAL says whether anything drives them: a signal with a writer is on the pin.
//!
//! HAL tells `halcmd show` so by its own records in its shared memory (`hal_priv.h`), in bytes:
//!
//! ```text
//!   pin      8 place of the data   24 signal   32 own value   48 type   52 direction   56 name
//!   signal   8 data                24 writers  28 pins that both read and write
//! ```
//!
//! Places are offsets from where the memory begins. Whether the records are as they are read here
//! is seen when the pin is made, and, of a signal, each time it is asked: one that is otherwise
//! drives nothing.
use crate::ffi::{Direction, Hal, Pin, PinKind};
use std::ffi::c_int;

const DATA_PLACE: usize = 8;
const SIGNAL: usize = 24;
const OWN_VALUE: usize = 32;
const KIND: usize = 48;
const DIRECTION: usize = 52;
const NAME: usize = 56;
const SIGNAL_DATA: usize = 8;
const WRITERS: usize = 24;
const BOTH_WAYS: usize = 28;
/// HAL's memory is smaller than this.
const LARGEST: i64 = 1 << 28;

/// An input.
#[derive(Debug)]
pub(crate) struct DrivenPin<T> {
    pin: Pin<T>,
    /// Where its record is, and where HAL's memory begins.
    record: usize,
    base: usize,
}

impl<T: PinKind> DrivenPin<T> {
    /// An input of this name, which begins false, or at 0.
    ///
    /// # Errors
    /// HAL refuses it, or keeps other records of its pins.
    pub(crate) fn new(hal: &Hal, name: &str) -> Result<Self, String> {
        let full = format!("leadscrew.{name}");
        let pin = hal.pin::<T>(&full, Direction::In)?;
        pin.set(T::default());
        // a pin without a signal has its value in its record
        let record = (pin.data() as usize).wrapping_sub(OWN_VALUE);
        let base = (pin.place() as usize).wrapping_sub(word(record, DATA_PLACE) as usize);
        let is_named = full.bytes().chain(std::iter::once(0)).enumerate().all(|(at, byte)| {
            // SAFETY: as for `word`; the name stands in the record.
            byte == unsafe { ((record + NAME + at) as *const u8).read_volatile() }
        });
        let is_input = number(record, KIND) == T::KIND
            && number(record, DIRECTION) == Direction::In as c_int
            && word(record, SIGNAL) == 0;
        if !(is_named && is_input) {
            return Err(format!(
                "this version of HAL keeps other records of its pins, and whether anything drives {full} cannot be seen: LinuxCNC 2.9 works"
            ));
        }
        Ok(Self { pin, record, base })
    }

    /// Its value.
    pub(crate) fn get(&self) -> T {
        self.pin.get()
    }

    /// True while a signal with a writer is on it.
    pub(crate) fn is_driven(&self) -> bool {
        let at = word(self.record, SIGNAL);
        if at <= 0 || at >= LARGEST || at % 8 != 0 {
            return false;
        }
        let signal = self.base + at as usize;
        let data = self.base.wrapping_add(word(signal, SIGNAL_DATA) as usize);
        let writes = number(signal, WRITERS) > 0 || number(signal, BOTH_WAYS) > 0;
        writes && data == self.pin.data() as usize
    }

    /// Its value where something drives it: what is not driven says nothing.
    pub(crate) fn said(&self) -> Option<T> {
        self.is_driven().then(|| self.get())
    }
}

impl DrivenPin<bool> {
    /// True where something says so.
    pub(crate) fn says(&self) -> bool {
        self.get() && self.is_driven()
    }
}

/// A word of a record.
fn word(record: usize, at: usize) -> i64 {
    // SAFETY: `record` is that of a pin, `OWN_VALUE` before the value that HAL has made for it, or
    // of the signal that HAL has put on it: both lie in HAL's memory, aligned for a word, which is
    // mapped as long as the component is a member, and which HAL does not give back. Others write
    // there; a value is read at once, and nothing is assumed of what it is.
    unsafe { ((record + at) as *const i64).read_volatile() }
}

fn number(record: usize, at: usize) -> c_int {
    // SAFETY: as for `word`.
    unsafe { ((record + at) as *const c_int).read_volatile() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::fake;

    #[test]
    fn a_pin_is_driven_while_a_signal_with_a_writer_is_on_it() {
        let _one = fake::one_at_a_time();
        let hal = Hal::begin("leadscrew").unwrap();
        let pin = DrivenPin::<bool>::new(&hal, "estop-ok").unwrap();
        assert!(!pin.get() && !pin.is_driven(), "false at load");
        fake::with(|hal| hal.set_bit("estop-ok", true)); // setp
        assert!(pin.get() && !pin.says(), "a value that was set by hand is nobody's word");
        fake::with(|hal| hal.link("estop-ok", 0));
        fake::with(|hal| hal.set_bit("estop-ok", true)); // sets
        assert!(pin.get() && !pin.says(), "a signal that nothing writes");
        fake::with(|hal| hal.link("estop-ok", 1));
        fake::with(|hal| hal.set_bit("estop-ok", true));
        assert!(pin.says());
        fake::with(|hal| hal.lose_writer("estop-ok"));
        assert!(pin.get() && !pin.says(), "a signal keeps the value of a writer that is gone");
    }
}
