//! A control that is served on a free port, and a client of it.
#![allow(dead_code, unreachable_pub, clippy::needless_pass_by_value, clippy::unwrap_used)] // each test takes what it needs

use control::job::ProgramOptions;
use control::operation::ControlOptions;
use control::{DrivesChoice, RealTimeOptions};
use serde_json::{Value, json};
use server::{Certificate, ClientTimeouts, Clock, KeptRuns, PublishOptions, Server, ServerOptions};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// What is waited for comes within so long on the wall, or not at all.
const COMES: Duration = Duration::from_mins(4);

pub struct Served {
    pub server: Server,
    pub folder: TempDir,
    agent: ureq::Agent,
    pace: f64,
}

/// The programs of the shop.
pub fn shop(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs").join(name)
}

/// A file that its owner alone reads.
pub fn write_secret(path: &Path, text: &[u8]) {
    use std::os::unix::fs::OpenOptionsExt as _;
    let mut options = std::fs::OpenOptions::new();
    let mut file = options.write(true).create(true).truncate(true).mode(0o600).open(path).unwrap();
    file.write_all(text).unwrap();
}

/// How it is served; what is usual stands in it.
pub struct How {
    pub machine: &'static str,
    /// Machine time that passes in a second on the wall.
    pub pace: f64,
    pub address: &'static str,
    pub token_file: Option<PathBuf>,
    pub certificate: Option<Certificate>,
    pub state: Option<PathBuf>,
    pub kept: KeptRuns,
    pub simulator: Option<PathBuf>,
    pub real_time: Option<RealTimeOptions>,
    pub mtconnect: Option<usize>,
    pub metrics: bool,
    pub publish: Option<PublishOptions>,
    pub timeouts: ClientTimeouts,
    pub clock: Clock,
}

impl Default for How {
    fn default() -> Self {
        Self {
            machine: "tapping-center",
            pace: 1.0,
            address: "127.0.0.1:0",
            token_file: None,
            certificate: None,
            state: None,
            kept: KeptRuns::default(),
            simulator: None,
            real_time: None,
            mtconnect: Some(server::MOST_OBSERVATIONS),
            metrics: true,
            publish: None,
            timeouts: ClientTimeouts::default(),
            clock: Clock::default(),
        }
    }
}

impl Served {
    /// Machine time passes so much faster than on the wall.
    pub fn at_pace(pace: f64) -> Self {
        Self::with(pace, None)
    }

    pub fn with(pace: f64, token_file: Option<PathBuf>) -> Self {
        Self::of(How { pace, token_file, ..How::default() })
    }

    /// With a state folder, in which so many runs are kept.
    pub fn keeping(pace: f64, state: &Path, most: usize) -> Self {
        let kept = KeptRuns { most, ..KeptRuns::default() };
        Self::of(How { pace, state: Some(state.to_owned()), kept, ..How::default() })
    }

    pub fn secured(certificate: Certificate) -> Self {
        Self::of(How { certificate: Some(certificate), ..How::default() })
    }

    /// Another machine than the tapping center.
    pub fn on(machine: &'static str, pace: f64) -> Self {
        Self::of(How { machine, pace, ..How::default() })
    }

    /// Of a machine simulator that listens at this socket.
    pub fn outside(pace: f64, state: &Path, simulator: &Path) -> Self {
        let (state, simulator) = (Some(state.to_owned()), Some(simulator.to_owned()));
        Self::of(How { pace, state, simulator, ..How::default() })
    }

    pub fn of(how: How) -> Self {
        let (folder, pace) = (TempDir::new().unwrap(), how.pace);
        std::fs::copy(shop("plate-12xM6.ngc"), folder.path().join("plate.ngc")).unwrap();
        let control = ControlOptions {
            state: how.state,
            drives: how.simulator.map_or_else(DrivesChoice::default, DrivesChoice::simulator),
            real_time: how.real_time,
            ..ControlOptions::simulated(ProgramOptions::on(how.machine))
        };
        let server = Server::start(ServerOptions {
            control,
            pace: how.pace,
            address: how.address.parse().unwrap(),
            programs: folder.path().to_owned(),
            token_file: how.token_file,
            certificate: how.certificate,
            names: Vec::new(),
            kept_runs: how.kept,
            mtconnect: how.mtconnect,
            metrics: how.metrics,
            publish: how.publish,
            timeouts: how.timeouts,
            clock: how.clock,
        });
        let server = server.unwrap_or_else(|refused| panic!("{}", refused.0));
        let config = ureq::Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(Duration::from_mins(1)))
            .build();
        Self { server, folder, agent: config.into(), pace }
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://{}/api/v1{path}", self.server.address())
    }

    fn read(answer: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> (u16, Value) {
        let mut answer = answer.unwrap();
        let status = answer.status().as_u16();
        let text = answer.body_mut().with_config().limit(64 << 20).read_to_string().unwrap();
        (status, serde_json::from_str(&text).unwrap_or(Value::String(text)))
    }

    pub fn get(&self, path: &str) -> (u16, Value) {
        Self::read(self.agent.get(self.url(path)).call())
    }

    /// With more headers.
    pub fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> (u16, Value) {
        let mut request = self.agent.get(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        Self::read(request.call())
    }

    /// Waits for a client no longer than this for anything.
    pub fn waiting_at_most(longest: Duration) -> Self {
        let timeouts = ClientTimeouts { header: longest, body: longest, answer: longest };
        Self::of(How { timeouts, ..How::default() })
    }

    /// A request as it is written, outside the API.
    pub fn raw(&self, method: &str, path: &str, headers: &[(&str, &str)]) -> (u16, String) {
        let address = self.server.address();
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(COMES)).unwrap();
        let mut head = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
        if !headers.iter().any(|(name, _)| *name == "host") {
            head += &format!("Host: {address}\r\n");
        }
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
    }

    pub fn post_with(&self, path: &str, body: &[u8], headers: &[(&str, &str)]) -> (u16, Value) {
        let mut request = self.agent.post(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        Self::read(request.send(body))
    }

    pub fn put(&self, path: &str, body: &[u8]) -> (u16, Value) {
        Self::read(self.agent.put(self.url(path)).send(body))
    }

    pub fn put_with(&self, path: &str, body: &[u8], headers: &[(&str, &str)]) -> (u16, Value) {
        let mut request = self.agent.put(self.url(path));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        Self::read(request.send(body))
    }

    pub fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        self.post_with(path, body.to_string().as_bytes(), &[])
    }

    /// A request as any client sends it.
    pub fn request(&self, body: &Value) -> (u16, Value) {
        self.post("/request", body)
    }

    /// One that has to be accepted.
    pub fn accepted(&self, body: Value) -> Value {
        let (status, answer) = self.request(&body);
        assert_eq!((status, &answer["accepted"]), (200, &json!(true)), "{body}: {answer}");
        answer
    }

    pub fn status(&self) -> Value {
        self.get("/status").1
    }

    /// Until the status is so: asked for every 25 ms of machine time, and no more often than each 5
    /// ms on the wall.
    pub fn until(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let start = control::clock::now();
        let pause = Duration::from_secs_f64((0.025 / self.pace).max(0.005));
        loop {
            let status = self.status();
            if is_so(&status) {
                return status;
            }
            assert!(control::clock::now() - start < COMES, "{what} does not come: {status}");
            std::thread::sleep(pause);
        }
    }

    /// Asks until it is accepted; what hinders it for too long is in the message.
    pub fn until_accepted(&self, body: Value) -> Value {
        let start = control::clock::now();
        loop {
            let (status, answer) = self.request(&body);
            if status == 200 {
                return answer;
            }
            assert!(control::clock::now() - start < COMES, "{body}: {answer}: {}", self.status());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// A program of the folder, from the start to the end.
    pub fn execute(&self, program: &str) {
        self.accepted(json!({ "request": "load", "program": program }));
        self.accepted(json!({ "request": "start" }));
        self.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");
    }

    pub fn power_on(&self) {
        self.accepted(json!({ "request": "power", "on": true }));
        self.until("ready", |status| status["is_ready"] == true);
    }

    pub fn home(&self) {
        self.accepted(json!({ "request": "home" }));
        self.until("homed", |status| {
            let axes = status["axes"].as_array().unwrap();
            axes.iter().all(|axis| axis["is_homed"] == true)
        });
    }

    pub fn socket(&self, query: &str) -> Socket {
        self.socket_at("/ws", query)
    }

    pub fn socket_at(&self, path: &str, query: &str) -> Socket {
        let url = format!("ws://{}/api/v1{path}{query}", self.server.address());
        let stream = TcpStream::connect(self.server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
        let (socket, _) = tungstenite::client(url, MaybeTlsStream::Plain(stream)).unwrap();
        Socket { socket }
    }
}

pub struct Socket {
    pub socket: WebSocket<MaybeTlsStream<TcpStream>>,
}

impl Socket {
    pub fn send(&mut self, message: &Value) {
        self.socket.send(Message::text(message.to_string())).unwrap();
    }

    /// The next message of a type; others are passed over.
    pub fn next(&mut self, kind: &str) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().unwrap() {
                let message: Value = serde_json::from_str(&text).unwrap();
                if message["type"] == kind {
                    return message;
                }
            }
        }
    }

    /// The next binary frame: its header, and its columns.
    pub fn next_frame(&mut self) -> (Value, Vec<Vec<f32>>) {
        loop {
            if let Message::Binary(bytes) = self.socket.read().unwrap() {
                let n = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
                let header: Value = serde_json::from_slice(&bytes[4..4 + n]).unwrap();
                let rows = header["rows"].as_u64().unwrap() as usize;
                let values: Vec<f32> = bytes[4 + n..]
                    .chunks_exact(4)
                    .map(|four| f32::from_le_bytes(four.try_into().unwrap()))
                    .collect();
                return (header, values.chunks(rows).map(<[f32]>::to_vec).collect());
            }
        }
    }
}

/// Machine coordinate of an axis.
pub fn machine(status: &Value, letter: &str) -> f64 {
    let axes = status["axes"].as_array().unwrap();
    let axis = axes.iter().find(|axis| axis["letter"] == letter).unwrap();
    axis["machine"].as_f64().unwrap()
}
