//! Metrics of what is published to an MQTT broker.
use super::adding::{Adding, raise};
use crate::mqtt::PublishStatus;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::gauge::Gauge;

/// How publishing goes.
pub(super) struct PublishMetrics {
    connected: Gauge,
    connections: Counter,
    published: Counter,
    waiting: Gauge,
    lost: Counter,
}

impl PublishMetrics {
    pub(super) fn added(add: &mut Adding<'_>) -> Self {
        Self {
            connected: add.one(
                "mqtt_connected",
                "1: there is a connection to the MQTT broker",
                Gauge::default(),
            ),
            connections: add
                .counter("mqtt_connections", "Connections that the broker has accepted"),
            published: add.counter(
                "mqtt_observations_published",
                "Observations that the broker has acknowledged",
            ),
            waiting: add.one(
                "mqtt_observations_waiting",
                "Observations that the broker has not acknowledged yet",
                Gauge::default(),
            ),
            lost: add.counter(
                "mqtt_observations_lost",
                "Observations that were no longer kept when there was a connection again",
            ),
        }
    }

    pub(super) fn set(&self, status: &PublishStatus) {
        self.connected.set(i64::from(status.is_connected));
        self.waiting.set(status.waiting.cast_signed());
        raise(&self.connections, status.connections);
        raise(&self.published, status.published);
        raise(&self.lost, status.lost);
    }
}
