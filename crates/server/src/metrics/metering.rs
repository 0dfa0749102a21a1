//! The metrics of a control, and the last text that was made of them.
use super::registry::ControlMetrics;
use super::text;
use crate::mqtt::Publisher;
use axum::body::Bytes;
use control::operation::hosted::{Client, Journaled, Picture};
use std::sync::{Mutex, PoisonError};

/// The metrics of a control, and the last text that was made of them.
pub(crate) struct Metering {
    metrics: Mutex<ControlMetrics>,
    /// Number of the picture of which they were made, and both forms.
    made: Mutex<(u64, MetricTexts)>,
}

/// What is served.
#[derive(Clone, Debug, Default)]
pub(crate) struct MetricTexts {
    pub(crate) open: Bytes,
    pub(crate) plain: Bytes,
}

impl Metering {
    /// Of a control.
    pub(crate) fn new(client: &Client, is_published: bool) -> Self {
        let status = &client.latest().status;
        let metrics = ControlMetrics::of(client.machine(), status, is_published);
        Self { metrics: Mutex::new(metrics), made: Mutex::default() }
    }

    /// These have happened, while a program of this name ran.
    pub(crate) fn count(&self, events: &[Journaled], program: &str) {
        let mut metrics = self.metrics.lock().unwrap_or_else(PoisonError::into_inner);
        for event in events {
            metrics.count(event, program);
        }
    }

    /// As they are now, with what has become of publishing.
    pub(crate) fn texts(&self, picture: &Picture, publisher: Option<&Publisher>) -> MetricTexts {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if made.0 != picture.number {
            let metrics = self.metrics.lock().unwrap_or_else(PoisonError::into_inner);
            let published = publisher.map(Publisher::status);
            let open = metrics.text(&picture.status, published.as_ref());
            drop(metrics);
            let plain = text::plain(&open);
            *made = (picture.number, MetricTexts { open: open.into(), plain: plain.into() });
        }
        made.1.clone()
    }
}
