//! `leadscrew serve`: a control that stays on, over the network, until Ctrl-C.
use crate::args::{ServeArgs, TokenRole};
use crate::{console, interrupt, say};
use control::operation::ControlOptions;
use control::{DrivesChoice, RealTimeOptions, Refused};
use server::{
    BrokerLogin, BrokerTimeouts, Certificate, ClientTimeouts, Clock, KeptRuns, PublishOptions,
    Role, Server, ServerOptions, Tokens,
};
use std::net::SocketAddr;
use std::time::Duration;

/// Ctrl-C is looked for so often.
const LOOK: Duration = Duration::from_millis(100);

/// Serve a control, make a token, or take one out.
pub(crate) fn command(args: &ServeArgs) -> Result<(), Refused> {
    if let Some(file) = &args.new_token {
        let role = match args.token_role {
            TokenRole::Viewer => Role::Viewer,
            TokenRole::Operator => Role::Operator,
        };
        let made =
            Tokens::add(file, &args.token_name, role, args.valid_for).map_err(Refused::because)?;
        return say::out(&format!("{}\n", made.token));
    }
    if let Some(file) = &args.revoke_token {
        Tokens::revoke(file, &args.token_name).map_err(Refused::because)?;
        say::err(&format!("{} is revoked\n", args.token_name));
        return Ok(());
    }
    let control = ControlOptions {
        program: args.source.on_a_machine(),
        seed: args.seed,
        state: args.state.clone(),
        drives: match (&args.drives, &args.simulator) {
            (Some(drives), _) => drives.clone(),
            (None, Some(socket)) => DrivesChoice::simulator(socket.clone()),
            (None, None) => DrivesChoice::default(),
        },
        clamped: args.clamped.as_deref().map(console::clamped).transpose()?.unwrap_or_default(),
        real_time: args.real_time.then(RealTimeOptions::default),
    };
    interrupt::watch()?;
    let server = Server::start(ServerOptions {
        control,
        pace: 1.0,
        address: SocketAddr::new(args.listen, args.port),
        programs: args.programs.clone(),
        token_file: args.token_file.clone(),
        certificate: match (&args.certificate, &args.key) {
            (Some(certificate), Some(key)) => {
                Some(Certificate::Files(certificate.clone(), key.clone()))
            }
            _ => args.self_signed.then_some(Certificate::SelfSigned),
        },
        names: args.host_name.clone(),
        kept_runs: KeptRuns { most: args.runs.max(1), most_bytes: args.runs_mb << 20 },
        metrics: !args.no_metrics,
        publish: publish(args)?,
        mtconnect: (!args.no_mtconnect).then_some(server::MOST_OBSERVATIONS),
        timeouts: ClientTimeouts::default(),
        clock: Clock::default(),
    })
    .map_err(|refused| Refused::because(refused.0))?;
    say::out(&format!("{}\n", server.url()))?;
    if let Some(fingerprint) = server.fingerprint() {
        say::out(&format!("certificate SHA-256 {fingerprint}\n"))?;
    }
    while !interrupt::came() {
        std::thread::sleep(LOOK);
    }
    drop(server); // what moves comes to rest
    Ok(())
}

/// What is published to a broker, and as whom.
fn publish(args: &ServeArgs) -> Result<Option<PublishOptions>, Refused> {
    let Some(broker) = args.mqtt.clone() else { return Ok(None) };
    let login = match &args.mqtt_login {
        Some(file) => Some(BrokerLogin::read(file)),
        None => BrokerLogin::of_environment(),
    };
    let told = Box::new(|sentence: &str| say::err(&format!("{sentence}\n")));
    Ok(Some(PublishOptions {
        broker,
        login: login.transpose().map_err(Refused::because)?,
        authorities: args.mqtt_ca.clone(),
        topic: args.mqtt_topic.clone(),
        timeouts: BrokerTimeouts::default(),
        told,
    }))
}
