//! What of HAL and rtapi is called: their C interface, declared here, resolved when LinuxCNC loads
//! the module.
use std::ffi::{CStr, CString, c_char, c_int, c_long, c_void};
use std::ptr::{NonNull, null_mut};

/// `HAL_IN`, `HAL_OUT`, `HAL_IO`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Direction {
    /// The component reads it.
    In = 16,
    /// The component writes it.
    Out = 32,
    /// Both ends write it.
    Io = 48,
}

/// What HAL calls once a period.
pub(crate) type Function = unsafe extern "C" fn(*mut c_void, c_long);

unsafe extern "C" {
    fn hal_init(name: *const c_char) -> c_int;
    fn hal_exit(component: c_int) -> c_int;
    fn hal_ready(component: c_int) -> c_int;
    fn hal_malloc(size: c_long) -> *mut c_void;
    fn hal_pin_bit_new(
        name: *const c_char,
        direction: c_int,
        data: *mut *mut bool,
        component: c_int,
    ) -> c_int;
    fn hal_pin_float_new(
        name: *const c_char,
        direction: c_int,
        data: *mut *mut f64,
        component: c_int,
    ) -> c_int;
    fn hal_pin_u32_new(
        name: *const c_char,
        direction: c_int,
        data: *mut *mut u32,
        component: c_int,
    ) -> c_int;
    fn hal_pin_s32_new(
        name: *const c_char,
        direction: c_int,
        data: *mut *mut i32,
        component: c_int,
    ) -> c_int;
    fn hal_export_funct(
        name: *const c_char,
        function: Function,
        argument: *mut c_void,
        uses_fp: c_int,
        reentrant: c_int,
        component: c_int,
    ) -> c_int;
    fn rtapi_get_time() -> i64;
    fn rtapi_print_msg(level: c_int, format: *const c_char, ...);
}

/// `RTAPI_MSG_ERR`.
const ERROR: c_int = 1;

/// rtapi's clock, ns: it reads the time that the system shows in memory, and does not call it.
pub(crate) fn now_ns() -> i64 {
    // SAFETY: takes nothing, answers a number.
    unsafe { rtapi_get_time() }
}

/// A line where rtapi's errors go; not in the servo thread.
pub(crate) fn say(text: &str) {
    let Ok(text) = CString::new(text) else { return };
    // SAFETY: a format with one string, and that string.
    unsafe { rtapi_print_msg(ERROR, c"%s\n".as_ptr(), text.as_ptr()) };
}

/// A membership in HAL, until it is dropped, or [`leave`].
#[derive(Debug)]
pub(crate) struct Hal(c_int);

/// The number of a membership that goes on until [`leave`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member(c_int);

/// The end of a membership: HAL takes its function out of the threads, and its pins.
pub(crate) fn leave(member: Member) {
    drop(Hal(member.0));
}

/// A type of pin.
pub(crate) trait PinKind: Copy + Default {
    /// `HAL_BIT`, `HAL_FLOAT`, `HAL_S32`, `HAL_U32`.
    const KIND: c_int;

    /// `hal_pin_…_new`.
    ///
    /// # Safety
    /// `name` is a C string; `data` lies in HAL's memory.
    unsafe fn new_pin(
        name: *const c_char,
        direction: c_int,
        data: *mut *mut Self,
        component: c_int,
    ) -> c_int;
}

macro_rules! kind {
    ($type:ty, $new:ident, $kind:literal) => {
        impl PinKind for $type {
            const KIND: c_int = $kind;

            unsafe fn new_pin(
                name: *const c_char,
                direction: c_int,
                data: *mut *mut Self,
                component: c_int,
            ) -> c_int {
                // SAFETY: the caller's.
                unsafe { $new(name, direction, data, component) }
            }
        }
    };
}

kind!(bool, hal_pin_bit_new, 1);
kind!(f64, hal_pin_float_new, 2);
kind!(u32, hal_pin_u32_new, 4);
kind!(i32, hal_pin_s32_new, 3);

/// A pin: HAL's memory holds where its value is now, which changes when it is linked to a signal.
#[derive(Debug)]
pub(crate) struct Pin<T>(NonNull<*mut T>);

impl<T: PinKind> Pin<T> {
    /// Its value.
    pub(crate) fn get(&self) -> T {
        // SAFETY: `Hal::pin` has put it into HAL's memory, which is mapped as long as the component
        // is a member, and HAL keeps a valid place in it; other components write a value of this
        // type at once, and nothing is assumed of what it is: volatile.
        unsafe { self.0.as_ptr().read_volatile().read_volatile() }
    }

    /// Where its value is now.
    pub(crate) fn data(&self) -> *const T {
        // SAFETY: as for `get`; the place alone is read.
        unsafe { self.0.as_ptr().read_volatile() }
    }

    /// Where HAL keeps where its value is.
    pub(crate) const fn place(&self) -> *const *mut T {
        self.0.as_ptr()
    }

    /// It has this value from now on.
    pub(crate) fn set(&self, value: T) {
        // SAFETY: as for `get`.
        unsafe { self.0.as_ptr().read_volatile().write_volatile(value) }
    }
}

impl Hal {
    /// Become a component.
    ///
    /// # Errors
    /// HAL refuses.
    pub(crate) fn begin(name: &str) -> Result<Self, String> {
        let name = c_string(name)?;
        // SAFETY: a C string.
        match unsafe { hal_init(name.as_ptr()) } {
            id if id > 0 => Ok(Self(id)),
            error => Err(format!("hal_init answers {error}")),
        }
    }

    /// A pin of this name.
    ///
    /// # Errors
    /// HAL refuses.
    pub(crate) fn pin<T: PinKind>(
        &self,
        name: &str,
        direction: Direction,
    ) -> Result<Pin<T>, String> {
        let c_name = c_string(name)?;
        // SAFETY: any size; HAL answers null where it has none left.
        let at = unsafe { hal_malloc(size_of::<*mut T>() as c_long) }.cast::<*mut T>();
        let at =
            NonNull::new(at).ok_or_else(|| format!("HAL has no memory left for the pin {name}"))?;
        // SAFETY: HAL's own memory, as large as a pointer, and aligned for one.
        unsafe { at.as_ptr().write(null_mut()) };
        // SAFETY: a C string; `at` lies in HAL's memory.
        let error = unsafe { T::new_pin(c_name.as_ptr(), direction as c_int, at.as_ptr(), self.0) };
        // SAFETY: as above.
        if error != 0 || unsafe { at.as_ptr().read() }.is_null() {
            return Err(format!("HAL refuses the pin {name}: {error}"));
        }
        Ok(Pin(at))
    }

    /// A function that threads call, with nothing as its argument.
    ///
    /// # Errors
    /// HAL refuses.
    pub(crate) fn export(&self, name: &CStr, function: Function) -> Result<(), String> {
        // SAFETY: a C string, and a function of HAL's type that makes nothing of its argument.
        match unsafe { hal_export_funct(name.as_ptr(), function, null_mut(), 1, 0, self.0) } {
            0 => Ok(()),
            error => Err(format!("HAL refuses the function: {error}")),
        }
    }

    /// Its number.
    pub(crate) const fn member(&self) -> Member {
        Member(self.0)
    }

    /// It goes on until [`leave`].
    pub(crate) fn stay(self) {
        std::mem::forget(self);
    }

    /// Everything is there.
    ///
    /// # Errors
    /// HAL refuses.
    pub(crate) fn ready(&self) -> Result<(), String> {
        // SAFETY: a component that has begun.
        match unsafe { hal_ready(self.0) } {
            0 => Ok(()),
            error => Err(format!("hal_ready answers {error}")),
        }
    }
}

impl Drop for Hal {
    fn drop(&mut self) {
        // SAFETY: a component that has begun; its pins are not used any more.
        let _ = unsafe { hal_exit(self.0) };
    }
}

fn c_string(text: &str) -> Result<CString, String> {
    CString::new(text).map_err(|_| format!("the name {text:?} has a zero in it"))
}
