//! What an MQTT broker gets: a real server, and a broker that breaks off where the test wants it
//! to.

use crate::common::{How, Served, write_secret};
use serde_json::{Value, json};
use server::{BrokerAddress, BrokerLogin, BrokerTimeouts, PublishOptions, TopicPrefix};
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// What a broker does with a connection.
#[derive(Clone, Copy, Debug)]
enum Conduct {
    /// Take so many messages, acknowledge so many of them, break off.
    BreaksOff { takes: usize, acknowledges: usize },
    /// Refuse it with this code.
    Refuses(u8),
    /// Answer what is no MQTT.
    Talks(&'static [u8]),
    /// Take and acknowledge everything.
    Takes,
}

/// A message as a broker has it.
#[derive(Clone, Debug)]
struct Published {
    topic: String,
    is_kept: bool,
    payload: Vec<u8>,
}

/// What has come: packets of CONNECT, and messages.
#[derive(Default)]
struct Heard {
    connects: Vec<Vec<u8>>,
    published: Vec<Published>,
    /// Kinds of packets that a broker gets of one that publishes alone: CONNECT, PUBLISH, PINGREQ,
    /// DISCONNECT. These are others.
    others: Vec<u8>,
}

/// A broker that conducts itself so, connection after connection; the last conduct is that of all
/// others.
fn broker(conducts: Vec<Conduct>) -> (BrokerAddress, Arc<Mutex<Heard>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let heard = Arc::new(Mutex::new(Heard::default()));
    let hears = Arc::clone(&heard);
    let serve = move || {
        let last = *conducts.last().unwrap();
        let conducts = conducts.into_iter().chain(std::iter::repeat(last));
        for (stream, conduct) in listener.incoming().zip(conducts) {
            // an end of the connection is the end of its conduct
            let _ = attend(stream.unwrap(), conduct, &hears);
        }
    };
    std::thread::Builder::new().name("broker".into()).spawn(serve).unwrap();
    (BrokerAddress::parse(&format!("mqtt://127.0.0.1:{port}")).unwrap(), heard)
}

/// A packet: its first byte and what follows its length (MQTT 5, 2.1).
fn packet(stream: &mut TcpStream) -> std::io::Result<(u8, Vec<u8>)> {
    let mut byte = [0];
    stream.read_exact(&mut byte)?;
    let first = byte[0];
    let (mut length, mut shift) = (0, 0);
    loop {
        stream.read_exact(&mut byte)?;
        length |= usize::from(byte[0] & 0x7f) << shift;
        shift += 7;
        if byte[0] & 0x80 == 0 {
            break;
        }
    }
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((first, body))
}

fn attend(mut stream: TcpStream, conduct: Conduct, heard: &Mutex<Heard>) -> std::io::Result<()> {
    let (_, connect) = packet(&mut stream)?;
    heard.lock().unwrap().connects.push(connect);
    let (takes, acknowledges) = match conduct {
        Conduct::Refuses(code) => return stream.write_all(&[0x20, 3, 0, code, 0]),
        Conduct::Talks(text) => return stream.write_all(text),
        Conduct::Takes => (usize::MAX, usize::MAX),
        Conduct::BreaksOff { takes, acknowledges } => (takes, acknowledges),
    };
    stream.write_all(&[0x20, 3, 0, 0, 0])?;
    let mut taken = 0;
    while taken < takes {
        let (first, body) = packet(&mut stream)?;
        match first >> 4 {
            3 => {
                let length = usize::from(body[0]) << 8 | usize::from(body[1]);
                let topic = String::from_utf8(body[2..2 + length].to_vec()).unwrap();
                let number = [body[2 + length], body[3 + length]];
                assert_eq!((first >> 1 & 3, body[4 + length]), (1, 0), "QoS 1, no properties");
                let payload = body[5 + length..].to_vec();
                let is_kept = first & 1 == 1;
                heard.lock().unwrap().published.push(Published { topic, is_kept, payload });
                if taken < acknowledges {
                    stream.write_all(&[0x40, 2, number[0], number[1]])?;
                }
                taken += 1;
            }
            12 => stream.write_all(&[0xd0, 0])?,
            14 => return Ok(()),
            other => heard.lock().unwrap().others.push(other),
        }
    }
    Ok(())
}

/// Timeouts that are over at once.
fn short() -> BrokerTimeouts {
    BrokerTimeouts {
        retry: Duration::from_millis(5),
        longest_retry: Duration::from_millis(20),
        acknowledgement: Duration::from_secs(2),
    }
}

/// A server that publishes to it, and what it tells.
fn publishing(
    broker: BrokerAddress,
    login: Option<BrokerLogin>,
    timeouts: BrokerTimeouts,
    how: How,
) -> (Served, Arc<Mutex<Vec<String>>>) {
    let told = Arc::new(Mutex::new(Vec::new()));
    let tells = Arc::clone(&told);
    let publish = Some(PublishOptions {
        broker,
        login,
        authorities: None,
        topic: TopicPrefix::parse("shop").unwrap(),
        timeouts,
        told: Box::new(move |sentence| tells.lock().unwrap().push(sentence.to_owned())),
    });
    (Served::of(How { publish, ..how }), told)
}

fn metric(served: &Served, name: &str) -> u64 {
    let (_, text) = served.raw("GET", "/metrics", &[]);
    let name = format!("leadscrew_mqtt_{name} ");
    let line = text.lines().find_map(|line| line.strip_prefix(&name)).unwrap();
    line.parse().unwrap()
}

/// Sequence numbers in the order in which they came: of data items by themselves, and of documents.
fn sequences(published: &[Published]) -> [Vec<u64>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for message in published {
        let read: Value = serde_json::from_slice(&message.payload).unwrap_or_default();
        if message.topic.contains("/Observations/") {
            assert!(message.is_kept && read["instanceId"].as_u64().is_some());
            found[0].push(read["sequence"].as_u64().unwrap());
        } else if message.topic.contains("/Sample/") {
            let mut of_document = Vec::new();
            collect(&read, &mut of_document);
            of_document.sort_unstable();
            found[1].extend(of_document);
        }
    }
    found
}

fn collect(value: &Value, found: &mut Vec<u64>) {
    match value {
        Value::Array(list) => list.iter().for_each(|value| collect(value, found)),
        Value::Object(members) => {
            found.extend(members.get("sequence").and_then(Value::as_u64));
            members.values().for_each(|value| collect(value, found));
        }
        _ => {}
    }
}

/// What is left when numbers that were there before are dropped.
fn once(sequences: &[u64]) -> Vec<u64> {
    let mut known = std::collections::BTreeSet::new();
    sequences.iter().copied().filter(|sequence| known.insert(*sequence)).collect()
}

#[test]
fn a_broker_that_breaks_off_wherever_it_likes_gets_each_observation_in_its_order() {
    let off = |takes, acknowledges| Conduct::BreaksOff { takes, acknowledges };
    let conducts = vec![
        off(1, 0),
        off(7, 3),
        off(60, 60),
        off(90, 40),
        Conduct::Refuses(0x88), // it is not there
        off(63, 0),
        off(200, 120),
        Conduct::Takes,
    ];
    let (address, heard) = broker(conducts);
    let (served, told) = publishing(address, None, short(), How::default());
    served.power_on();
    served.home();
    served.until("all connections", |_| metric(&served, "connections_total") == 7);
    served.accepted(json!({ "request": "single_block", "on": true }));
    let (_, current) = served.raw("GET", "/mtconnect/current", &[]);
    let current = roxmltree::Document::parse(&current).unwrap();
    let header = current.descendants().find(|node| node.has_tag_name("Header")).unwrap();
    let last: u64 = header.attribute("lastSequence").unwrap().parse().unwrap();
    served.until("all of it", |_| metric(&served, "observations_published_total") >= last);
    served.until("its documents", |_| {
        let found = sequences(&heard.lock().unwrap().published);
        found.iter().all(|found| found.last() >= Some(&last))
    });
    let heard = heard.lock().unwrap();
    for found in sequences(&heard.published) {
        let found = once(&found);
        assert_eq!(found, (1..=found.len() as u64).collect::<Vec<_>>());
    }
    assert!(heard.others.is_empty(), "it subscribes to nothing: {:?}", heard.others);
    assert_eq!(metric(&served, "observations_lost_total"), 0);
    assert!(told.lock().unwrap().iter().any(|said| said.contains("broken off")), "{told:?}");
}

#[test]
fn what_is_no_longer_kept_is_said_to_be_lost_and_the_last_values_come_all_the_same() {
    // refused at first: by then more was observed than a buffer of 60 keeps
    let (address, heard) = broker(vec![Conduct::Refuses(0x88), Conduct::Takes]);
    let how = How { mtconnect: Some(60), ..How::default() };
    let (served, told) = publishing(address, None, BrokerTimeouts::default(), how);
    served.until("a connection", |_| metric(&served, "connected") == 1);
    served.until("all of it", |_| metric(&served, "observations_waiting") == 0);
    let lost = metric(&served, "observations_lost_total");
    assert!(lost > 0);
    let sentence = format!("observations 1 to {lost} are lost to the broker: the last 60 are kept");
    assert!(told.lock().unwrap().iter().any(|said| said.contains(&sentence)), "{told:?}");
    let heard = heard.lock().unwrap();
    let [items, documents] = sequences(&heard.published);
    let documents = once(&documents);
    let all: Vec<u64> = (lost + 1..).take(documents.len()).collect();
    assert_eq!(documents, all);
    assert!(items.is_sorted(), "no value is followed by an older one: {items:?}");
    // each data item has had its last value, also those that were observed before what is kept
    let (_, probe) = served.raw("GET", "/mtconnect/probe", &[]);
    let probe = roxmltree::Document::parse(&probe).unwrap();
    for node in probe.descendants().filter(|node| node.has_tag_name("DataItem")) {
        let end = format!("/Observations/{}", node.attribute("id").unwrap());
        assert!(heard.published.iter().any(|message| message.topic.ends_with(&end)), "{end}");
    }
}

#[test]
fn a_last_will_and_a_login_are_in_the_first_packet() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("login");
    write_secret(&file, b"mill-7\nopen sesame\n");
    let (address, heard) = broker(vec![Conduct::Takes]);
    let login = BrokerLogin::read(&file).unwrap();
    let (served, _) = publishing(address, Some(login), short(), How::default());
    served.until("what it observed", |_| metric(&served, "observations_published_total") > 0);
    let heard = heard.lock().unwrap();
    let connect = &heard.connects[0];
    // MQTT 5, 3.1.2: protocol name and version, flags: user, password, will kept with QoS 1, clean
    // start
    assert_eq!(connect[..8], [0, 4, b'M', b'Q', b'T', b'T', 5, 0b1110_1110]);
    let text = String::from_utf8_lossy(connect);
    for part in ["/Availability", "UNAVAILABLE", "mill-7", "open sesame"] {
        assert!(text.contains(part), "{part} in {text:?}");
    }
    let said = heard.published.iter().find(|message| message.topic.ends_with("/Availability"));
    assert!(said.is_some_and(|said| said.is_kept && said.payload == b"AVAILABLE"));
}

#[test]
fn what_is_no_broker_or_refuses_is_one_sentence_and_the_machine_goes_on() {
    let login = || {
        let folder = tempfile::TempDir::new().unwrap();
        write_secret(&folder.path().join("login"), b"a\nb\n");
        BrokerLogin::read(&folder.path().join("login")).ok()
    };
    for (conduct, login, says) in [
        (Conduct::Refuses(0x86), login(), "refuses this user with this password"),
        (Conduct::Refuses(0x87), None, "wants a user and a password: --mqtt-login FILE"),
        (Conduct::Refuses(0x84), None, "does not know MQTT 5"),
        (Conduct::Talks(b"HTTP/1.1 400 Bad Request\r\n\r\n"), None, "does not speak MQTT 5"),
    ] {
        let (address, _) = broker(vec![conduct]);
        let (served, told) = publishing(address, login, short(), How::default());
        served.until(says, |status| {
            assert_eq!(status["execution"], "READY");
            told.lock().unwrap().iter().any(|said| said.contains(says))
        });
        served.power_on();
        assert_eq!(metric(&served, "connected"), 0);
        let told = told.lock().unwrap();
        assert_eq!(told.len(), 1, "the same is not said again and again: {told:?}");
    }
    // a port at which nothing listens
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let address = BrokerAddress::parse(&format!("mqtt://127.0.0.1:{port}")).unwrap();
    let (served, told) = publishing(address, None, short(), How::default());
    served.until("a sentence", |_| {
        told.lock().unwrap().iter().any(|said| said.contains("cannot reach mqtt://127.0.0.1:"))
    });
}
