//! What `loadrt leadscrew` is told: `axes=XYZ spindles=1 din=8 dout=8 ain=0 aout=0 mdi=0
//! name=mill`.
use bus::{ANALOGUE, AXES, DIGITAL, MDI_KEYS, SPINDLES};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI32, AtomicPtr, Ordering::Relaxed};

/// Letters of the axes, in the order of their numbers.
pub(crate) const LETTERS: [char; AXES] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'];

/// What is meant where `loadrt` does not say it: axes, name; spindles, digital inputs and outputs,
/// analogue ones, keys of blocks.
const AXES_USUAL: &str = "XYZ";
const NAME_USUAL: &str = "default";
const COUNTS_USUAL: [(&str, c_int); 6] =
    [("spindles", 1), ("din", 4), ("dout", 4), ("ain", 0), ("aout", 0), ("mdi", 0)];

/// As they were told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LoadParameters {
    /// Which axes it has.
    pub(crate) axes: [bool; AXES],
    /// Spindles.
    pub(crate) spindles: usize,
    /// Digital inputs and outputs.
    pub(crate) digital: (usize, usize),
    /// Analogue inputs and outputs.
    pub(crate) analogue: (usize, usize),
    /// Keys of blocks.
    pub(crate) mdi: usize,
    /// Name of the shared memory.
    pub(crate) name: String,
}

/// A pointer that rtapi looks up by its symbol.
#[repr(transparent)]
struct Symbol<T>(*const T);
// SAFETY: what they point to are constants, or atomics that rtapi writes before it calls
// `rtapi_app_main`.
unsafe impl<T> Sync for Symbol<T> {}

/// What rtapi looks for of a parameter: where it is, of which type (`s`, `i`), what it means.
macro_rules! parameter {
    ($variable:ident: $type:ty = $default:expr, $letter:literal, $means:literal, $address:ident, $kind:ident, $description:ident) => {
        pub(super) static $variable: $type = <$type>::new($default);
        #[used]
        #[unsafe(no_mangle)]
        static $address: Symbol<c_void> = Symbol(std::ptr::addr_of!($variable).cast());
        #[used]
        #[unsafe(no_mangle)]
        static $kind: Symbol<c_char> = Symbol($letter.as_ptr());
        #[used]
        #[unsafe(no_mangle)]
        static $description: Symbol<c_char> = Symbol($means.as_ptr());
    };
}

#[allow(non_upper_case_globals)] // the names are rtapi's
mod told {
    use super::{AtomicI32, AtomicPtr, COUNTS_USUAL, Symbol, c_char, c_void, null_mut};
    parameter!(AXES: AtomicPtr<c_char> = null_mut(), c"s", c"letters of the axes, as in XYZ",
        rtapi_info_address_axes, rtapi_info_type_axes, rtapi_info_description_axes);
    parameter!(NAME: AtomicPtr<c_char> = null_mut(), c"s", c"name by which a control finds it",
        rtapi_info_address_name, rtapi_info_type_name, rtapi_info_description_name);
    parameter!(SPINDLES: AtomicI32 = COUNTS_USUAL[0].1, c"i", c"number of spindles",
        rtapi_info_address_spindles, rtapi_info_type_spindles, rtapi_info_description_spindles);
    parameter!(DIN: AtomicI32 = COUNTS_USUAL[1].1, c"i", c"number of digital inputs",
        rtapi_info_address_din, rtapi_info_type_din, rtapi_info_description_din);
    parameter!(DOUT: AtomicI32 = COUNTS_USUAL[2].1, c"i", c"number of digital outputs",
        rtapi_info_address_dout, rtapi_info_type_dout, rtapi_info_description_dout);
    parameter!(AIN: AtomicI32 = COUNTS_USUAL[3].1, c"i", c"number of analogue inputs",
        rtapi_info_address_ain, rtapi_info_type_ain, rtapi_info_description_ain);
    parameter!(AOUT: AtomicI32 = COUNTS_USUAL[4].1, c"i", c"number of analogue outputs",
        rtapi_info_address_aout, rtapi_info_type_aout, rtapi_info_description_aout);
    parameter!(MDI: AtomicI32 = COUNTS_USUAL[5].1, c"i", c"number of keys that run blocks",
        rtapi_info_address_mdi, rtapi_info_type_mdi, rtapi_info_description_mdi);

    /// The licence that rtapi is told: MIT and Apache-2.0 go with the GPL of what loads this
    /// module.
    #[used]
    #[unsafe(no_mangle)]
    static rtapi_info_license: Symbol<c_char> = Symbol(c"GPL".as_ptr());
    /// The symbols that rtapi may look up stand in this section.
    #[used]
    #[unsafe(link_section = ".rtapi_export")]
    static EXPORTED: [u8; 30] = *b"rtapi_app_main\0rtapi_app_exit\0";
}

/// The parameters of this load.
///
/// # Errors
/// What is wrong with one of them.
pub(crate) fn read() -> Result<LoadParameters, String> {
    let count = |value: &AtomicI32| value.load(Relaxed);
    parsed(
        text(&told::AXES).as_deref().unwrap_or(AXES_USUAL),
        text(&told::NAME).as_deref().unwrap_or(NAME_USUAL),
        count(&told::SPINDLES),
        (count(&told::DIN), count(&told::DOUT)),
        (count(&told::AIN), count(&told::AOUT)),
        count(&told::MDI),
    )
}

/// `axes=XYZ` and so on, in the order of the manual page.
#[cfg(test)]
pub(crate) fn defaults() -> Vec<String> {
    let counts = COUNTS_USUAL.iter().map(|(name, count)| format!("{name}={count}"));
    let axes = std::iter::once(format!("axes={AXES_USUAL}"));
    axes.chain(counts).chain(std::iter::once(format!("name={NAME_USUAL}"))).collect()
}

fn text(of: &AtomicPtr<c_char>) -> Option<String> {
    let at = of.load(Relaxed);
    if at.is_null() {
        return None;
    }
    // SAFETY: rtapi stores what strdup has answered there, a C string that is never freed.
    Some(unsafe { CStr::from_ptr(at) }.to_string_lossy().into_owned())
}

fn parsed(
    axes: &str,
    name: &str,
    spindles: c_int,
    digital: (c_int, c_int),
    analogue: (c_int, c_int),
    mdi: c_int,
) -> Result<LoadParameters, String> {
    let mut has = [false; AXES];
    for letter in axes.chars() {
        let index = LETTERS.iter().position(|known| *known == letter.to_ascii_uppercase());
        let index = index
            .ok_or(format!("axes={axes}: {letter} is no axis: expected letters of XYZABCUVW"))?;
        has[index] = true;
    }
    if name.is_empty()
        || name.len() > 32
        || !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-')
    {
        return Err(format!("name={name}: expected at most 32 letters, digits and hyphens"));
    }
    let within = |what: &str, count: c_int, most: usize| match usize::try_from(count) {
        Ok(count) if count <= most => Ok(count),
        _ => Err(format!("{what}={count}: expected 0 to {most}")),
    };
    Ok(LoadParameters {
        axes: has,
        spindles: within("spindles", spindles, SPINDLES)?,
        digital: (within("din", digital.0, DIGITAL)?, within("dout", digital.1, DIGITAL)?),
        analogue: (within("ain", analogue.0, ANALOGUE)?, within("aout", analogue.1, ANALOGUE)?),
        mdi: within("mdi", mdi, MDI_KEYS)?,
        name: name.to_owned(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_taken_as_told_and_what_is_wrong_is_said_with_what_would_work() {
        let read = parsed("xzW", "mill-1", 2, (64, 0), (0, 16), 3).unwrap();
        assert_eq!(read.axes, [true, false, true, false, false, false, false, false, true]);
        assert_eq!((read.spindles, read.digital, read.analogue), (2, (64, 0), (0, 16)));
        let wrong = |axes, name, spindles, din| {
            parsed(axes, name, spindles, (din, 0), (0, 0), 0).unwrap_err()
        };
        assert_eq!(wrong("XQ", "a", 1, 0), "axes=XQ: Q is no axis: expected letters of XYZABCUVW");
        assert_eq!(
            wrong("X", "../x", 1, 0),
            "name=../x: expected at most 32 letters, digits and hyphens"
        );
        assert_eq!(wrong("X", "a", 3, 0), "spindles=3: expected 0 to 2");
        assert_eq!(wrong("X", "a", 1, -1), "din=-1: expected 0 to 64");
    }
}
