//! Two pieces of work at once.
use std::thread::Builder;

/// Run two pieces of work to their ends, the first one in a thread of its own if there is one to be
/// had.
pub(super) fn side_by_side(first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    let is_begun = std::thread::scope(|scope| {
        let begun = Builder::new().name("path-shape".into()).spawn_scoped(scope, &mut *first);
        second();
        begun.is_ok()
    });
    if !is_begun {
        first();
    }
}
