//! The kernel and all that it uses, linked without an operating system and its library.
//!
//! The panic handler below is the only one: if any of these crates, or one that they use, brought `std` with it, there would be
//! two and the build would fail. So it cannot pass by accident, not even on a target that has `std`. The feature `uses-std`
//! shows that it fails.
#![no_std]

#[cfg(feature = "uses-std")]
extern crate std;

use core::alloc::{GlobalAlloc, Layout};
use core::panic::PanicInfo;
use kernel::Kernel;

/// Memory of a machine that has none: what is checked is that nothing else asks for it.
struct Nothing;

// SAFETY: a null pointer says that there is no memory, and nothing that was never given is given back.
unsafe impl GlobalAlloc for Nothing {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        core::ptr::null_mut()
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

#[global_allocator]
static MEMORY: Nothing = Nothing;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}

/// One servo period, as an interrupt would call it.
///
/// # Safety
/// All three pointers are valid, and nothing else uses what they point to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn leadscrew_tick(
    kernel: *mut Kernel,
    feedback: *const bus::Feedback,
    command: *mut bus::Command,
) {
    // SAFETY: as the caller promises
    unsafe { *command = (*kernel).tick(&*feedback) };
}
