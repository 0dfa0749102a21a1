//! What pictures have in common: the figure around a drawing, and the thread that several show.
use crate::record::TapTrace;
use crate::svg::Tag;
use crate::{Measure, Run};
use verify::Thread;

/// A thread with everything there is to draw of it.
pub(crate) struct ThreadView<'a> {
    /// Unique on the page: `"t12"`.
    pub(crate) id: String,
    /// The run it belongs to.
    pub(crate) run: &'a Run,
    /// How it was driven.
    pub(crate) trace: &'a TapTrace,
    /// The unit in which lengths are written.
    pub(crate) measure: Measure,
    /// How it was judged; `None` if it never became a feature.
    pub(crate) thread: Option<&'a Thread>,
}

/// A picture with its heading and caption. The drawing is finished markup, the rest is text.
pub(crate) fn figure(heading: &str, drawing: &str, caption: &str) -> String {
    let heading = Tag::new("h3").text(heading);
    let caption = Tag::new("figcaption").text(caption);
    Tag::new("figure").around(&(heading + drawing + &caption))
}
