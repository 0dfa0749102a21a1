//! The arguments of `leadscrew serve`.
use super::ProgramArgs;
use clap::{Args, ValueEnum};
use control::DrivesChoice;
use server::{BrokerAddress, TopicPrefix};
use std::net::IpAddr;
use std::path::PathBuf;
use std::time::Duration;

const MQTT_HELP: &str = "Publish what the MTConnect agent observes to this MQTT broker: mqtt://HOST or mqtt://HOST:PORT, and mqtts:// for TLS";
const LOGIN_HELP: &str = "User and password at the broker, the first two lines of this file, which its owner alone reads (0600) [default: LEADSCREW_MQTT_USER and LEADSCREW_MQTT_PASSWORD]";

/// `leadscrew serve`.
#[derive(Args, Debug, Clone)]
#[allow(clippy::struct_excessive_bools)] // each is a switch of the command line
pub(crate) struct ServeArgs {
    #[command(flatten)]
    pub(crate) source: ProgramArgs,
    /// Address at which clients call; one that other computers reach takes --token-file and a
    /// certificate
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub(crate) listen: IpAddr,
    /// Port at which clients call; 0 takes one that is free
    #[arg(long, value_name = "N", default_value_t = 8383)]
    pub(crate) port: u16,
    /// Folder of programs: clients list, read, write and load the programs in it, and nothing else;
    /// what holds state, tokens or a key is no part of it
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(crate) programs: PathBuf,
    /// Control the machine simulator that listens here, a Unix socket, instead of a machine within
    /// this process: it outlives the control, and a tool that was left in its work is known when
    /// the control begins again
    #[arg(long, value_name = "PATH", requires = "state", conflicts_with_all = ["seed", "clamped"])]
    pub(crate) simulator: Option<PathBuf>,
    /// Lead drives instead of a machine that is simulated in this process: `hal`, those of the
    /// component `leadscrew` in LinuxCNC's HAL that the machine's file names in [hal];
    /// `simulator:PATH`, a machine simulator that listens there
    #[arg(long, value_name = "KIND", conflicts_with_all = ["simulator", "seed", "clamped"])]
    pub(crate) drives: Option<DrivesChoice>,
    /// Seed of the machine that is simulated: what its control does not know
    /// (`machine show NAME --seed N`)
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Keep offsets, tools, alarms and the last program in this folder [default: nothing is kept]
    #[arg(long, value_name = "DIR")]
    pub(crate) state: Option<PathBuf>,
    /// Runs that are kept in the state folder, with report, certificate and trace; the oldest give
    /// way
    #[arg(long, value_name = "N", default_value_t = 200, requires = "state")]
    pub(crate) runs: usize,
    /// Mebibytes that they take on the disk together at most
    #[arg(long, value_name = "N", default_value_t = 2048, requires = "state", value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub(crate) runs_mb: u64,
    /// Clamp the simulated stock this far from where the machine's file says, millimetres, as in
    /// X0.4,Y-0.3,Z1.2
    #[arg(long, value_name = "AXES")]
    pub(crate) clamped: Option<String>,
    /// Kernel and machine in a servo thread of their own, by the clock
    #[arg(long)]
    pub(crate) real_time: bool,
    /// Answer only who has a token of this file, which its owner alone reads (0600); it is read
    /// anew when it has changed
    #[arg(long, value_name = "FILE")]
    pub(crate) token_file: Option<PathBuf>,
    /// Certificate (PEM) with those that vouch for it
    #[arg(long, value_name = "FILE", requires = "key")]
    pub(crate) certificate: Option<PathBuf>,
    /// Its key (PEM), which its owner alone reads (0600)
    #[arg(long, value_name = "FILE", requires = "certificate")]
    pub(crate) key: Option<PathBuf>,
    /// Make a self-signed certificate, and say its fingerprint
    #[arg(long, conflicts_with = "certificate")]
    pub(crate) self_signed: bool,
    /// Name by which clients call this computer; may be given more than once
    #[arg(long, value_name = "NAME")]
    pub(crate) host_name: Vec<String>,
    /// Do not let programs read the machine as an MTConnect 2.4 agent, below /mtconnect
    #[arg(long)]
    pub(crate) no_mtconnect: bool,
    /// Do not let programs read metrics, as Prometheus does, at /metrics
    #[arg(long)]
    pub(crate) no_metrics: bool,
    /// A broker.
    #[arg(long, value_name = "ADDRESS", conflicts_with = "no_mtconnect", help = MQTT_HELP, value_parser = BrokerAddress::parse)]
    pub(crate) mqtt: Option<BrokerAddress>,
    /// With what the topics begin
    #[arg(long, value_name = "PREFIX", requires = "mqtt", default_value = "MTConnect", value_parser = TopicPrefix::parse)]
    pub(crate) mqtt_topic: TopicPrefix,
    /// A file.
    #[arg(long, value_name = "FILE", requires = "mqtt", help = LOGIN_HELP)]
    pub(crate) mqtt_login: Option<PathBuf>,
    /// Certificates (PEM) that vouch for the broker [default: those that this computer trusts]
    #[arg(long, value_name = "FILE", requires = "mqtt")]
    pub(crate) mqtt_ca: Option<PathBuf>,
    /// Make a token, add its hash to this file, say it once and end
    #[arg(long, value_name = "FILE", conflicts_with = "token_file")]
    pub(crate) new_token: Option<PathBuf>,
    /// Take a token out of this file and end: a server that uses the file refuses it, and all that
    /// was opened with it, a second later
    #[arg(long, value_name = "FILE", conflicts_with_all = ["token_file", "new_token"])]
    pub(crate) revoke_token: Option<PathBuf>,
    /// Name of the token that is made, or taken out
    #[arg(long, value_name = "NAME", default_value = "operator")]
    pub(crate) token_name: String,
    /// What the token that is made allows
    #[arg(long, value_enum, requires = "new_token", default_value_t = TokenRole::Operator)]
    pub(crate) token_role: TokenRole,
    /// How long the token that is made is valid: a number with s, h, d or w, at most 520w
    #[arg(long, value_name = "TIME", requires = "new_token", default_value = "30d", value_parser = valid_for)]
    pub(crate) valid_for: Duration,
}

/// Longest time of a token, about ten years.
const LONGEST_VALID: Duration = Duration::from_hours(520 * 7 * 24);

/// A time as it is typed.
fn valid_for(text: &str) -> Result<Duration, String> {
    let wrong = || {
        format!(
            "\"{text}\" is no time: expected a number from 1 with s, h, d or w, at most 520w, as in 30d"
        )
    };
    let unit = text.chars().last().ok_or_else(wrong)?;
    let seconds = match unit {
        's' => 1,
        'h' => 3600,
        'd' => 24 * 3600,
        'w' => 7 * 24 * 3600,
        _ => return Err(wrong()),
    };
    let count: u64 = text[..text.len() - unit.len_utf8()].parse().map_err(|_| wrong())?;
    let time = Duration::from_secs(count.saturating_mul(seconds));
    if time.is_zero() || time > LONGEST_VALID { Err(wrong()) } else { Ok(time) }
}

/// What a token allows.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TokenRole {
    /// To see
    Viewer,
    /// To see and to command
    Operator,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_a_token_has_a_unit_and_a_limit() {
        assert_eq!(valid_for("30d"), Ok(Duration::from_hours(30 * 24)));
        assert_eq!(valid_for("8h"), Ok(Duration::from_hours(8)));
        assert_eq!(valid_for("520w"), Ok(LONGEST_VALID));
        for wrong in
            ["", "d", "30", "0d", "-1d", "521w", "30dd", "99999999999999999999w", "1\u{e9}"]
        {
            assert!(valid_for(wrong).is_err_and(|why| why.contains("30d")), "{wrong}");
        }
    }
}
