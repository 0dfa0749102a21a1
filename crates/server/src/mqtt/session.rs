//! A connection to the broker, from its first byte to the reason of its end.
use super::outbox::Outbox;
use super::topics::Carries;
use super::{Publisher, sentence};
use control::clock::{now, unix_ms};
use rumqttc::mqttbytes::QoS;
use rumqttc::mqttbytes::v5::{LastWill, Packet};
use rumqttc::{
    AsyncClient, Broker, ClientError, ConnectionError, Event, EventLoop, MqttOptions,
    PublishNotice, PublishNoticeError, PublishOptions,
};
use std::collections::VecDeque;
use std::future::pending;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;
use tokio::sync::watch;
use tokio::task::JoinHandle;

/// Observations are collected for so long: each has its own time all the same.
const COLLECTED: Duration = Duration::from_millis(100);
/// Messages on their way: the broker has not acknowledged them.
const MOST_ON_THEIR_WAY: usize = 64;
/// An end that is noticed is explained within so long.
const SAYS_WHY: Duration = Duration::from_secs(1);
/// A connection that says nothing for so long is asked whether it is there, s.
const KEEP_ALIVE_S: u16 = 10;

type Acknowledged = Pin<Box<dyn Future<Output = Result<(), PublishNoticeError>> + Send>>;

/// The task that reads and writes; it ends with its owner.
struct Polling(JoinHandle<ConnectionError>);

impl Drop for Polling {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// Publish until the connection ends; why it has ended.
pub(super) async fn run(publisher: &Publisher) -> String {
    let (client, events) =
        AsyncClient::builder(options(publisher)).capacity(MOST_ON_THEIR_WAY).build();
    let (accepted, is_accepted) = watch::channel(false);
    let mut accepts = is_accepted.clone();
    let mut polling = Polling(tokio::spawn(poll(events, accepted)));
    tokio::select! {
        why = &mut polling.0 => return ended(publisher, *is_accepted.borrow(), why),
        Ok(_) = accepts.wait_for(|is_so| *is_so) => {}
    }
    publisher.is_connected();
    let acknowledged =
        (publisher.figures.document.load(Relaxed), publisher.figures.item.load(Relaxed));
    let topics = publisher.topics.clone();
    let outbox = Outbox::begin(topics, &publisher.monitoring.agent(), acknowledged, now());
    let mut sending = Sending { client, outbox, on_their_way: VecDeque::new() };
    let mut tick = tokio::time::interval(COLLECTED);
    let mut acknowledged_at = now();
    loop {
        if let Err(why) = sending.send() {
            // as a rule because the connection has ended, which says itself why
            return match tokio::time::timeout(SAYS_WHY, &mut polling.0).await {
                Ok(why) => ended(publisher, true, why),
                Err(_) => {
                    format!("{} does not take what is published: {why}", publisher.link.address)
                }
            };
        }
        if sending.on_their_way.is_empty() {
            acknowledged_at = now();
        }
        tokio::select! {
            why = &mut polling.0 => return ended(publisher, true, why),
            acknowledged = sending.acknowledged() => {
                if let Err(why) = acknowledged {
                    return match why {
                        // the connection has ended, and says itself why
                        PublishNoticeError::Recv => ended(publisher, true, (&mut polling.0).await),
                        why => sentence::not_taken(&publisher.link.address, &why),
                    };
                }
                acknowledged_at = now();
                if let Some((carries, _)) = sending.on_their_way.pop_front() {
                    publisher.figures.acknowledged(carries);
                }
                if sending.outbox.is_empty() && sending.on_their_way.len() < MOST_ON_THEIR_WAY / 2 {
                    fill(publisher, &mut sending.outbox, true);
                }
            }
            _ = tick.tick() => {
                if now() - acknowledged_at > publisher.timeouts.acknowledgement {
                    return format!(
                        "{} has acknowledged nothing for {} s",
                        publisher.link.address,
                        publisher.timeouts.acknowledgement.as_secs_f64()
                    );
                }
                fill(publisher, &mut sending.outbox, false);
            }
        }
    }
}

/// Take from the agent what there is; a backlog at once, and not with the next tick.
fn fill(publisher: &Publisher, outbox: &mut Outbox, only_a_backlog: bool) {
    let agent = publisher.monitoring.agent();
    if only_a_backlog && agent.next() < outbox.next_item() + 50 {
        return;
    }
    let lost = outbox.fill(&agent, (now(), unix_ms()));
    drop(agent);
    if let Some(lost) = lost {
        publisher.has_lost(lost);
    }
}

fn ended(
    publisher: &Publisher,
    was_accepted: bool,
    why: Result<ConnectionError, tokio::task::JoinError>,
) -> String {
    let address = &publisher.link.address;
    match why {
        Ok(error) => {
            let has_login = publisher.login.is_some();
            sentence::of(sentence::Of { address, has_login, was_accepted }, &error)
        }
        Err(error) => format!("{address}: {error}"),
    }
}

/// Bytes are read and written in a task of their own, so that nothing that is awaited beside it
/// cuts a message in two.
async fn poll(mut events: EventLoop, accepted: watch::Sender<bool>) -> ConnectionError {
    loop {
        match events.poll().await {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                accepted.send_replace(true);
            }
            Ok(_) => {}
            Err(error) => return error,
        }
    }
}

fn options(publisher: &Publisher) -> MqttOptions {
    let address = &publisher.link.address;
    let broker = Broker::tcp(address.host.clone(), address.port);
    let mut options = MqttOptions::new(publisher.client_id.clone(), broker);
    let will =
        LastWill::new(publisher.topics.availability(), "UNAVAILABLE", QoS::AtLeastOnce, true, None);
    options.set_keep_alive(KEEP_ALIVE_S).set_clean_start(true).set_last_will(will);
    if let Some(login) = &publisher.login {
        options.set_credentials(login.user.clone(), login.password.clone());
    }
    let link = publisher.link.clone();
    let link = Arc::new(link);
    options.set_socket_connector(move |_, _| {
        let link = Arc::clone(&link);
        async move { link.open().await }
    });
    options
}

/// Messages that are to be sent, and those that the broker has not acknowledged.
struct Sending {
    client: AsyncClient,
    outbox: Outbox,
    on_their_way: VecDeque<(Carries, Acknowledged)>,
}

impl Sending {
    /// Send as many as may be on their way.
    fn send(&mut self) -> Result<(), ClientError> {
        while self.on_their_way.len() < MOST_ON_THEIR_WAY
            && let Some(message) = self.outbox.pop()
        {
            let options = PublishOptions::new(QoS::AtLeastOnce).retain(message.is_kept);
            let notice: PublishNotice =
                self.client.try_publish_tracked(message.topic, message.payload, options)?;
            self.on_their_way
                .push_back((message.carries, Box::pin(notice.wait_completion_async())));
        }
        Ok(())
    }

    /// What has become of the oldest one.
    async fn acknowledged(&mut self) -> Result<(), PublishNoticeError> {
        match self.on_their_way.front_mut() {
            Some((_, acknowledged)) => acknowledged.await,
            None => pending().await,
        }
    }
}
