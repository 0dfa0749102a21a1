//! HAL's C interface as far as the component calls it, for tests on computers without LinuxCNC:
//! pins by name, one function.
use crate::ffi::{Direction, Function};
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_int, c_long, c_void};
use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Where HAL's memory begins, and how much of it is used.
static MEMORY: OnceLock<usize> = OnceLock::new();
static USED: AtomicUsize = AtomicUsize::new(8);
const MEMORY_WORDS: usize = 1 << 20;

fn memory() -> usize {
    *MEMORY.get_or_init(|| vec![0_u64; MEMORY_WORDS].leak().as_mut_ptr() as usize)
}

/// A record in HAL's memory, for good.
fn recorded<T>(record: T) -> *mut T {
    let size = size_of::<T>().next_multiple_of(8);
    let at = USED.fetch_add(size, Relaxed);
    assert!(at + size <= MEMORY_WORDS * 8, "HAL has no memory left");
    let place = (memory() + at) as *mut T;
    // SAFETY: memory of this record alone, aligned for words, as its fields need.
    unsafe { place.write(record) };
    place
}

/// How HAL's records name a place.
fn offset(place: usize) -> i64 {
    place.wrapping_sub(memory()) as i64
}

/// HAL's record of a pin, as `driven.rs` reads it.
#[repr(C)]
struct PinRecord {
    next: i64,
    data_place: i64,
    owner: i64,
    signal: i64,
    value: u64,
    old_name: i64,
    kind: c_int,
    direction: c_int,
    name: [u8; 48],
}

/// HAL's record of a signal.
#[repr(C)]
struct SignalRecord {
    next: i64,
    data: i64,
    kind: c_int,
    readers: c_int,
    writers: c_int,
    both_ways: c_int,
    value: u64,
}

/// What a component has asked HAL for; addresses as numbers, so that threads may share them.
#[derive(Debug, Default)]
pub(crate) struct Asked {
    /// Kind, place of the place of the value, direction.
    pins: BTreeMap<String, (char, usize, c_int)>,
    /// Where the record of the pin is that has its place here.
    records: BTreeMap<usize, usize>,
    function: Option<Function>,
    pub(crate) said: Vec<String>,
}

static ASKED: Mutex<Option<Asked>> = Mutex::new(None);

fn asked() -> MutexGuard<'static, Option<Asked>> {
    ASKED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// HAL has one component of this name at a time: a test that loads it holds this.
pub(crate) fn one_at_a_time() -> MutexGuard<'static, ()> {
    static ONE: Mutex<()> = Mutex::new(());
    ONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the component has asked for.
pub(crate) fn with<T>(look: impl FnOnce(&mut Asked) -> T) -> T {
    look(asked().get_or_insert_default())
}

impl Asked {
    /// Names of the pins.
    pub(crate) fn names(&self) -> Vec<&str> {
        self.pins.keys().map(String::as_str).collect()
    }

    /// Each pin with its type and direction: `leadscrew.x.pos-cmd float out`.
    pub(crate) fn described(&self) -> Vec<String> {
        let described = |(name, (kind, _, direction)): (&String, &(char, usize, c_int))| {
            let kind = match kind {
                'b' => "bit",
                'f' => "float",
                's' => "s32",
                _ => "u32",
            };
            let direction = match *direction {
                d if d == Direction::In as c_int => "in",
                d if d == Direction::Out as c_int => "out",
                _ => "io",
            };
            format!("{name} {kind} {direction}")
        };
        self.pins.iter().map(described).collect()
    }

    fn at<T>(&self, name: &str, kind: char) -> *mut T {
        match self.pins.get(&format!("leadscrew.{name}")) {
            // SAFETY: the place that `hal_malloc` has made, in which HAL has put a value's
            Some((of, at, _)) if *of == kind => unsafe { (*at as *const *mut T).read() },
            other => panic!("{name}: {other:?}"),
        }
    }

    pub(crate) fn float(&self, name: &str) -> f64 {
        // SAFETY: memory that `hal_pin_float_new` has leaked for a number.
        unsafe { self.at::<f64>(name, 'f').read_volatile() }
    }

    pub(crate) fn set_float(&self, name: &str, value: f64) {
        // SAFETY: as for `float`.
        unsafe { self.at::<f64>(name, 'f').write_volatile(value) }
    }

    pub(crate) fn bit(&self, name: &str) -> bool {
        // SAFETY: memory that `hal_pin_bit_new` has leaked for a bit.
        unsafe { self.at::<bool>(name, 'b').read_volatile() }
    }

    pub(crate) fn s32(&self, name: &str) -> i32 {
        // SAFETY: memory that `hal_pin_s32_new` has leaked for a number.
        unsafe { self.at::<i32>(name, 's').read_volatile() }
    }

    pub(crate) fn set_s32(&self, name: &str, value: i32) {
        // SAFETY: as for `s32`.
        unsafe { self.at::<i32>(name, 's').write_volatile(value) }
    }

    pub(crate) fn set_bit(&self, name: &str, value: bool) {
        // SAFETY: as for `bit`.
        unsafe { self.at::<bool>(name, 'b').write_volatile(value) }
    }

    /// A signal with this many writers is on an input, which is false, or 0.
    pub(crate) fn link(&self, name: &str, writers: c_int) {
        let (place, record) = self.record(name);
        let signal = recorded(SignalRecord {
            next: 0,
            data: 0,
            kind: 1,
            readers: 1,
            writers,
            both_ways: 0,
            value: 0,
        });
        // SAFETY: records that were made for this pin and this signal.
        unsafe {
            let data = std::ptr::addr_of_mut!((*signal).value);
            (*signal).data = offset(data as usize);
            (*record).signal = offset(signal as usize);
            place.write_volatile(data.cast());
        }
    }

    /// What has written the signal on a pin is unloaded.
    pub(crate) fn lose_writer(&self, name: &str) {
        let (_, record) = self.record(name);
        // SAFETY: the record that `link` has made.
        unsafe {
            let signal = memory() + (*record).signal as usize;
            (*(signal as *mut SignalRecord)).writers -= 1;
        }
    }

    /// The place of a value, and the record of its pin, which has no signal yet or one of `link`.
    fn record(&self, name: &str) -> (*mut *mut bool, *mut PinRecord) {
        let (_, place, _) = self.pins[&format!("leadscrew.{name}")];
        (place as *mut *mut bool, self.records[&place] as *mut PinRecord)
    }
}

/// HAL's thread calls the function; false: it is not there (any more).
pub(crate) fn call(period: c_long) -> bool {
    let function = with(|asked| asked.function);
    if let Some(function) = function {
        // SAFETY: what was exported, called from one thread at a time.
        unsafe { function(std::ptr::null_mut(), period) };
    }
    function.is_some()
}

unsafe fn pin<T>(kind: char, name: *const c_char, data: *mut *mut T, direction: c_int) -> c_int {
    // SAFETY: a C string, as the component says.
    let name = unsafe { CStr::from_ptr(name) }.to_string_lossy().into_owned();
    let mut record = PinRecord {
        next: 0,
        data_place: offset(data as usize),
        owner: 0,
        signal: 0,
        value: 0,
        old_name: 0,
        kind: if kind == 'b' { 1 } else { 2 },
        direction,
        name: [0; 48],
    };
    record.name[..name.len()].copy_from_slice(name.as_bytes());
    let record = recorded(record);
    // SAFETY: the record of this pin, and memory of `hal_malloc`, as the component says.
    unsafe { data.write(std::ptr::addr_of_mut!((*record).value).cast()) };
    let record = record as usize;
    with(|asked| {
        asked.pins.insert(name, (kind, data as usize, direction));
        asked.records.insert(data as usize, record);
    });
    0
}

#[unsafe(no_mangle)]
extern "C" fn hal_init(_: *const c_char) -> c_int {
    *asked() = Some(Asked::default());
    1
}

#[unsafe(no_mangle)]
extern "C" fn hal_exit(_: c_int) -> c_int {
    with(|asked| asked.function = None);
    0
}

#[unsafe(no_mangle)]
extern "C" fn hal_ready(_: c_int) -> c_int {
    0
}

#[unsafe(no_mangle)]
extern "C" fn hal_malloc(size: c_long) -> *mut c_void {
    let words = (size as usize).div_ceil(8);
    Box::into_raw(vec![0_u64; words].into_boxed_slice()).cast()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hal_pin_bit_new(
    name: *const c_char,
    direction: c_int,
    data: *mut *mut bool,
    _: c_int,
) -> c_int {
    // SAFETY: the caller's.
    unsafe { pin('b', name, data, direction) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hal_pin_float_new(
    name: *const c_char,
    direction: c_int,
    data: *mut *mut f64,
    _: c_int,
) -> c_int {
    // SAFETY: the caller's.
    unsafe { pin('f', name, data, direction) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hal_pin_u32_new(
    name: *const c_char,
    direction: c_int,
    data: *mut *mut u32,
    _: c_int,
) -> c_int {
    // SAFETY: the caller's.
    unsafe { pin('u', name, data, direction) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hal_pin_s32_new(
    name: *const c_char,
    direction: c_int,
    data: *mut *mut i32,
    _: c_int,
) -> c_int {
    // SAFETY: the caller's.
    unsafe { pin('s', name, data, direction) }
}

#[unsafe(no_mangle)]
extern "C" fn hal_export_funct(
    _: *const c_char,
    function: Function,
    _: *mut c_void,
    _: c_int,
    _: c_int,
    _: c_int,
) -> c_int {
    with(|asked| asked.function = Some(function));
    0
}

/// A clock of which a millisecond passes whenever it is looked at, once a period.
#[unsafe(no_mangle)]
extern "C" fn rtapi_get_time() -> i64 {
    static NOW: AtomicI64 = AtomicI64::new(1);
    NOW.fetch_add(1_000_000, Relaxed)
}

/// In C it takes any arguments; the component hands it one string.
#[unsafe(no_mangle)]
unsafe extern "C" fn rtapi_print_msg(_: c_int, _: *const c_char, text: *const c_char) {
    // SAFETY: a C string, as the component says.
    let text = unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned();
    with(|asked| asked.said.push(text));
}
