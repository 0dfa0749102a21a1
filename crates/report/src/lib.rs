//! The report of a run: one page that a process engineer can pin to the job.
//!
//! ```text
//!   canon::Op ───┐
//!   bus::Sample ─┴─► Recorder ─┐
//!   verify::Feature ───────────┼─► html() ─► report.html   (self-contained; light, dark, print, phone)
//!   Run (names, limits) ───────┘
//! ```
//!
//! The [`Recorder`] listens while the machine runs and keeps, in a room that does not grow, what
//! pictures need: every peak of the taps that matter, the path, where the time went. [`html`]
//! writes the page: the verdict first, then figures, then pictures, each with the sentence that
//! says what to look for. The pictures are drawn by this crate's own writer of SVG.

mod measure;
mod nearest;
mod page;
mod pictures;
mod record;
mod recovery;
mod run;
mod standing;
mod stops;
mod svg;
mod thin;

pub use measure::Measure;
pub use nearest::{headroom_text, why_nearest};
pub use page::{
    CamPage, CommissionPage, CommissionPicture, CommissionRow, Comparison, CompensationPage,
    CompensationRow, DoctorPage, DoctorRow, LatencyPicture, Named, PolygonPlan, Side,
    TappingMethod, WayOfCompensation, cam_html, commission_html, comparison_html,
    compensation_html, doctor_html, feature_name, html, polygon_html, um_figure,
};
pub use record::{AxisLimits, Recorder, WORST_KEPT};
pub use recovery::{Recovery, recovery_svg};
pub use run::{Alarm, Limits, Motion, Note, Origin, Run};
pub use standing::Standing;
pub use stops::{PlanePoint, ThreadStop, WayBack};
