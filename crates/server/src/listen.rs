//! Addresses, connections and their limits.
//!
//! A connection has to send its header in time and to take what it has asked for, or it is closed;
//! there are so many at once, and for one more the one gives way that has been silent for longest;
//! where none is silent it is for stops alone ([`reserved`]).
use crate::app::{App, Watching};
use crate::clock::Clock;
use crate::connections::{AnsweredBody, Connection, Connections};
use crate::folder::Folder;
use crate::metrics::{self, metering::Metering};
use crate::monitoring::Monitoring;
use crate::mqtt::{PublishOptions, Publisher};
use crate::mtconnect;
use crate::page::Page;
use crate::reserved::{self, Reserved};
use crate::runs::{KeptRuns, Recorder, Runs};
use crate::timeouts::ClientTimeouts;
use crate::tls::{Certificate, Tls};
use crate::tokens::Tokens;
use crate::{guard, revoking, routes};
use axum::Router;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::response::IntoResponse;
use control::operation::ControlOptions;
use control::operation::hosted::{HostOptions, Hosted};
use hyper::body::Incoming;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::convert::Infallible;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Runtime;
use tokio::sync::watch;
use tokio_io_timeout::TimeoutStream;
use tokio_rustls::TlsAcceptor;

/// Largest header.
const LARGEST_HEADER: usize = 16 << 10;
/// Threads that answer: they only wait and copy.
const THREADS: usize = 2;
/// One that has waited for a disk is kept for the next time: longer than a control is on.
const KEPT: Duration = Duration::from_hours(20 * 365 * 24);
/// Why nothing is served, in a sentence.
#[derive(Debug)]
pub struct Refused(pub String);

/// How a control is served.
pub struct ServerOptions {
    /// The control.
    pub control: ControlOptions,
    /// Machine time that passes in a second on the wall: 1, but in tests.
    pub pace: f64,
    /// Where clients call.
    pub address: SocketAddr,
    /// The folder of programs.
    pub programs: PathBuf,
    /// File of tokens.
    pub token_file: Option<PathBuf>,
    /// What the server shows of itself; `None`: what is sent is not encrypted.
    pub certificate: Option<Certificate>,
    /// Names by which clients call it, besides this computer's own and the address.
    pub names: Vec<String>,
    /// How many runs are kept in the state folder.
    pub kept_runs: KeptRuns,
    /// An `MTConnect` agent answers below `/mtconnect`, which keeps so many observations; `None`:
    /// there is none.
    pub mtconnect: Option<usize>,
    /// What it observes is published to an MQTT broker; takes `mtconnect`.
    pub publish: Option<PublishOptions>,
    /// Metrics are answered at `/metrics`.
    pub metrics: bool,
    /// How long a client is waited for.
    pub timeouts: ClientTimeouts,
    /// By which sessions and tokens end.
    pub clock: Clock,
}

/// A control that is served, until it is dropped.
pub struct Server {
    address: SocketAddr,
    fingerprint: Option<String>,
    runtime: Option<Runtime>,
    // after the runtime: the last answers come from it
    #[cfg_attr(not(test), allow(dead_code))] // it lives as long as what it is served by
    pub(crate) hosted: Hosted,
    // after the control: it writes what that has given it
    _recorder: Recorder,
}

impl Server {
    /// Switch a control on and serve it.
    ///
    /// # Errors
    /// A clear sentence: what is missing, or what the system has refused.
    pub fn start(options: ServerOptions) -> Result<Self, Refused> {
        let ServerOptions { control, pace, address, programs, token_file, certificate, .. } =
            options;
        may_listen(address.ip(), token_file.is_some(), certificate.is_some())?;
        let names = own_names(address.ip(), options.names);
        let key = match &certificate {
            Some(Certificate::Files(_, key)) => Some(key.clone()),
            _ => None,
        };
        let tls = certificate.map(|certificate| Tls::of(&certificate, &names)).transpose();
        let tls = tls.map_err(Refused)?;
        let login = options.publish.as_ref().and_then(|publish| publish.login.as_ref());
        let login = login.and_then(|login| login.file.as_deref());
        let folder = Folder::open(&programs)
            .and_then(|all| all.without_folder("the state folder", control.state.as_deref()))
            .and_then(|all| all.without_folder_of("the file of tokens", token_file.as_deref()))
            .and_then(|all| all.without_folder_of("the key", key.as_deref()))
            .and_then(|all| all.without_folder_of("the login at the broker", login))
            .map_err(Refused)?;
        let tokens = token_file.as_deref().map(Tokens::read).transpose().map_err(Refused)?;
        let shows = folder.clone();
        let shown = move |text: &str| shows.shown(text);
        let runs =
            Runs::open(control.state.as_deref(), options.kept_runs, &shown).map_err(Refused)?;
        let (recorder, recording) = Recorder::start(&runs, shown).map_err(Refused)?;
        let program = control.program.clone();
        let (told, pictures) = watch::channel(0);
        let published = Box::new(move || told.send_modify(|count| *count += 1));
        let hosted = Hosted::start(
            control,
            HostOptions { pace, published, recording, ..HostOptions::default() },
        )
        .map_err(|refused| Refused(refused.sentence()))?;
        recorder.tell(hosted.client());
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(THREADS)
            .max_blocking_threads(THREADS)
            .thread_keep_alive(KEPT)
            .thread_name("server")
            .enable_all()
            .build()
            .map_err(|e| Refused(format!("cannot start threads: {e}")))?;
        // where the system refuses another thread, what waits for a disk has this one
        let _ = runtime.block_on(runtime.spawn_blocking(|| ()));
        let listener = runtime
            .block_on(TcpListener::bind(address))
            .map_err(|e| Refused(format!("cannot listen on {address}: {e}")))?;
        let address = listener.local_addr().map_err(|e| Refused(e.to_string()))?;
        let hosts = hosts(&names, address.port());
        let scheme = if tls.is_some() { "https" } else { "http" };
        let client = hosted.client();
        let monitoring = options.mtconnect.map(|most| Arc::new(Monitoring::new(&client, most)));
        let publisher = options.publish.zip(monitoring.clone());
        let publisher = publisher
            .map(|(options, monitoring)| Publisher::new(options, monitoring).map(Arc::new));
        let publisher = publisher.transpose().map_err(Refused)?;
        let metering =
            options.metrics.then(|| Arc::new(Metering::new(&client, publisher.is_some())));
        let watching = Watching { monitoring, metering, publisher };
        let open = (tokens, watching);
        let timeouts = options.timeouts;
        let (named, timing) = ((scheme, hosts), (timeouts, options.clock));
        let app = App::new(hosted.client(), (folder, runs, program), open, pictures, named, timing);
        let app = Arc::new(app);
        if let Some(monitoring) = &app.watching.monitoring {
            runtime.spawn(mtconnect::feed(Arc::clone(&app), Arc::clone(monitoring), pace));
        }
        if let Some(metering) = &app.watching.metering {
            runtime.spawn(metrics::feed(Arc::clone(&app), Arc::clone(metering)));
        }
        if let Some(publisher) = &app.watching.publisher {
            runtime.spawn(Arc::clone(publisher).run());
        }
        if let Some(path) = token_file {
            runtime.spawn(revoking::watch(Arc::clone(&app), path));
        }
        let fingerprint = tls.as_ref().map(|tls| tls.fingerprint.clone());
        let acceptor = tls.map(|tls| tls.acceptor);
        runtime.spawn(accept(listener, acceptor, router(app), timeouts));
        Ok(Self { address, fingerprint, runtime: Some(runtime), hosted, _recorder: recorder })
    }

    /// Where it is called.
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// The same, for a browser.
    pub fn url(&self) -> String {
        let scheme = if self.fingerprint.is_some() { "https" } else { "http" };
        format!("{scheme}://{}/", self.address)
    }

    /// SHA-256 of its certificate, if it has one.
    pub fn fingerprint(&self) -> Option<&str> {
        self.fingerprint.as_deref()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// Other computers are answered over TLS only, and only with a token.
fn may_listen(ip: IpAddr, has_tokens: bool, has_certificate: bool) -> Result<(), Refused> {
    let missing = match (has_tokens, has_certificate) {
        _ if ip.is_loopback() => return Ok(()),
        (true, true) => return Ok(()),
        (false, true) => "--token-file FILE (made with --new-token FILE)",
        (true, false) => "--self-signed, or --certificate FILE with --key FILE",
        (false, false) => {
            "--token-file FILE (made with --new-token FILE), and --self-signed or --certificate FILE with --key FILE"
        }
    };
    Err(Refused(format!(
        "{ip} can be reached from other computers: that takes {missing}; 127.0.0.1 takes neither"
    )))
}

/// Names and addresses by which it is called.
fn own_names(ip: IpAddr, names: Vec<String>) -> Vec<String> {
    let own = Some(ip).filter(|ip| !ip.is_unspecified()).map(|ip| ip.to_string());
    let local = ["localhost", "127.0.0.1", "::1"].map(str::to_owned);
    let mut all: Vec<String> = Vec::new();
    for name in local.into_iter().chain(own).chain(names) {
        let name = name.to_ascii_lowercase();
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

/// The same as a browser says them: with the port, and without where it is the scheme's own.
fn hosts(names: &[String], port: u16) -> Vec<String> {
    let is_ip6 = |name: &str| name.parse::<std::net::Ipv6Addr>().is_ok();
    let names =
        names.iter().map(|name| if is_ip6(name) { format!("[{name}]") } else { name.clone() });
    let names: Vec<String> = names.collect();
    let mut hosts: Vec<String> = names.iter().map(|name| format!("{name}:{port}")).collect();
    if matches!(port, 80 | 443) {
        hosts.extend(names);
    }
    hosts
}

fn router(app: Arc<App>) -> Router {
    let page = Arc::new(Page::default());
    let rest = move |request: Request| {
        let page = Arc::clone(&page);
        async move {
            if request.uri().path().starts_with("/api/") {
                let reason = "there is no such address";
                return crate::answer::ApiError::new(StatusCode::NOT_FOUND, reason)
                    .with_remedy("/api/v1/openapi.json lists them")
                    .into_response();
            }
            for (base, what, switch) in [
                (mtconnect::ROOT, "an MTConnect agent", "--no-mtconnect"),
                (metrics::ROOT, "metrics", "--no-metrics"),
            ] {
                if request.uri().path().starts_with(base) {
                    let reason = format!("this control is served without {what}");
                    return crate::answer::ApiError::new(StatusCode::NOT_FOUND, reason)
                        .with_remedy(format!("serve it without {switch}"))
                        .into_response();
                }
            }
            page.answer(&request)
        }
    };
    let guarding = Arc::clone(&app);
    let guard = move |request, next| guard::guard(Arc::clone(&guarding), request, next);
    routes::router(&app).fallback(rest).layer(axum::middleware::from_fn(guard)).with_state(app)
}

/// Connection after connection.
async fn accept(
    listener: TcpListener,
    tls: Option<TlsAcceptor>,
    router: Router,
    timeouts: ClientTimeouts,
) {
    let (all, beside) = (Arc::new(Connections::default()), Arc::new(Connections::default()));
    let (for_stops, mut reserved) = (reserved::router(router.clone()), Reserved::default());
    for number in 0.. {
        let Ok((stream, _)) = listener.accept().await else {
            // as a rule too many files are open: some are closed meanwhile
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let _ = stream.set_nodelay(true); // it is only slower without
        let tls = tls.clone();
        let Some(connection) = all.open(number) else {
            if let Some(connection) = beside.open(number) {
                let router = for_stops.clone();
                let short = ClientTimeouts { header: reserved::HEADER_COMES, ..timeouts };
                let talk = async move { serve(stream, tls, router, &connection, short).await };
                let task = tokio::spawn(tokio::time::timeout(reserved::LASTS, talk));
                reserved.open(task.abort_handle());
            }
            continue;
        };
        let router = router.clone();
        tokio::spawn(async move {
            tokio::select! {
                () = serve(stream, tls, router, &connection, timeouts) => {}
                () = connection.gives_way() => {}
            }
        });
    }
}

async fn serve(
    stream: TcpStream,
    tls: Option<TlsAcceptor>,
    router: Router,
    connection: &Arc<Connection>,
    timeouts: ClientTimeouts,
) {
    match tls {
        None => talk(stream, router, connection, timeouts).await,
        Some(tls) => {
            let agreed = tokio::time::timeout(timeouts.header, tls.accept(stream));
            if let Ok(Ok(stream)) = agreed.await {
                talk(stream, router, connection, timeouts).await;
            }
        }
    }
}

async fn talk(
    stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static,
    router: Router,
    connection: &Arc<Connection>,
    timeouts: ClientTimeouts,
) {
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(timeouts.answer));
    let (router, connection) = (TowerToHyperService::new(router), Arc::clone(connection));
    let answers = service_fn(move |mut request: hyper::Request<Incoming>| {
        let under_way = connection.asks();
        request.extensions_mut().insert(Arc::clone(&connection));
        let answer = router.call(request);
        async move {
            let response = answer.await?;
            Ok::<_, Infallible>(response.map(|body| AnsweredBody::new(body, under_way)))
        }
    });
    let connection = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(timeouts.header)
        .max_buf_size(LARGEST_HEADER)
        .serve_connection(TokioIo::new(Box::pin(stream)), answers)
        .with_upgrades();
    let _ = connection.await; // a client that has broken off needs no answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_other_computers_reach_takes_tokens_and_a_certificate() {
        for open in ["0.0.0.0", "192.168.0.7", "::"] {
            let ip = open.parse().expect("an address");
            let said = |tokens, certificate| may_listen(ip, tokens, certificate).map_err(|e| e.0);
            assert!(said(false, true).expect_err("no tokens").contains("--new-token"));
            assert!(said(true, false).expect_err("no certificate").contains("--self-signed"));
            assert!(said(false, false).is_err());
            assert_eq!(said(true, true), Ok(()));
        }
        for own in ["127.0.0.1", "::1"] {
            assert!(may_listen(own.parse().expect("an address"), false, false).is_ok());
        }
    }

    #[test]
    fn it_is_called_by_its_own_names_with_its_port() {
        let names = own_names("0.0.0.0".parse().expect("an address"), vec!["Shop-1".into()]);
        assert_eq!(names, ["localhost", "127.0.0.1", "::1", "shop-1"]);
        let hosts = hosts(&names, 8383);
        assert_eq!(hosts, ["localhost:8383", "127.0.0.1:8383", "[::1]:8383", "shop-1:8383"]);
    }
}
