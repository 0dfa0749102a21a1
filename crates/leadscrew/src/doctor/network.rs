//! The network card of EtherCAT drives.
use super::computer::Computer;
use super::finding::{ComputerFinding, Topic};
use super::system::Rights;

/// Drivers of cards that real-time networks are commonly led from.
const GOOD_DRIVERS: [&str; 6] = ["igb", "igc", "e1000e", "r8169", "macb", "stmmac"];
/// Drivers of cards that send in packs, by way of USB or of a host.
const SLOW_DRIVERS: [&str; 7] =
    ["r8152", "ax88179_178a", "asix", "cdc_ether", "cdc_ncm", "virtio_net", "hv_netvsc"];

/// Everything about an interface.
pub(super) fn network(
    computer: &Computer,
    interface: &str,
    rights: Rights,
) -> Vec<ComputerFinding> {
    let folder = format!("sys/class/net/{interface}");
    let topic = Topic::Network;
    if interface.is_empty() || interface.contains('/') || !computer.has(&folder) {
        let others = computer.names("sys/class/net").into_iter().filter(|name| name != "lo");
        let others = others.collect::<Vec<_>>().join(", ");
        return vec![ComputerFinding::wrong(
            topic,
            format!("there is no network interface {interface}"),
            format!("name one of this computer's: {others}"),
        )];
    }
    let mut found = vec![driver(computer, interface, &folder)];
    found.extend(line(computer, interface, &folder));
    found.extend(shared(computer, interface));
    if !rights.sends_raw {
        found.push(ComputerFinding::wrong(
            topic,
            "this user may not send raw frames (CAP_NET_RAW)",
            "sudo setcap cap_net_raw,cap_sys_nice,cap_ipc_lock+ep \"$(command -v leadscrew)\"",
        ));
    }
    found
}

fn driver(computer: &Computer, interface: &str, folder: &str) -> ComputerFinding {
    let topic = Topic::Network;
    let Some(driver) = computer.link(&format!("{folder}/device/driver")) else {
        let says = format!(
            "{interface} is no card: there is no device behind it. For a trial without drives this is right; drives take a card's interface"
        );
        return ComputerFinding::note(topic, says);
    };
    if GOOD_DRIVERS.contains(&driver.as_str()) {
        return ComputerFinding::good(topic, format!("{interface} is led by {driver}"));
    }
    if SLOW_DRIVERS.contains(&driver.as_str()) {
        return ComputerFinding::improve(
            topic,
            format!(
                "{interface} is led by {driver}: its frames wait for a bus or for a host, some 100 µs and more"
            ),
            "a card on PCI Express, such as one with Intel's I210 or I225",
        );
    }
    ComputerFinding::unknown(
        topic,
        format!("{interface} is led by {driver}, of which nothing is known here"),
    )
}

fn line(computer: &Computer, interface: &str, folder: &str) -> Option<ComputerFinding> {
    let topic = Topic::Network;
    if computer.text(&format!("{folder}/carrier")).as_deref() != Some("1") {
        return Some(ComputerFinding::wrong(
            topic,
            format!("{interface} has no link: no cable, no drive with power, or it is down"),
            format!("sudo ip link set {interface} up, and look at the lamps of both plugs"),
        ));
    }
    let speed = computer.number(&format!("{folder}/speed")).filter(|speed| *speed > 0.0)?;
    Some(if speed == 100.0 {
        ComputerFinding::good(topic, "100 Mbit/s, as EtherCAT is")
    } else {
        ComputerFinding::wrong(
            topic,
            format!(
                "the link runs at {speed} Mbit/s, and EtherCAT at 100: the other end is no EtherCAT device"
            ),
            "plug the first device straight into this card, without a switch between",
        )
    })
}

/// Whether the operating system sends on the interface as well.
fn shared(computer: &Computer, interface: &str) -> Option<ComputerFinding> {
    let is_first = |line: &str| line.split_whitespace().next() == Some(interface);
    let is_last = |line: &str| line.split_whitespace().last() == Some(interface);
    let routes = computer.text("proc/net/route").unwrap_or_default();
    let addresses = computer.text("proc/net/if_inet6").unwrap_or_default();
    (routes.lines().any(is_first) || addresses.lines().any(is_last)).then(|| {
        ComputerFinding::improve(
            Topic::Network,
            format!("the operating system uses {interface} as well: its frames go between those of the drives"),
            format!("sudo nmcli device set {interface} managed no; sudo ip addr flush dev {interface}; sudo sysctl net.ipv6.conf.{interface}.disable_ipv6=1"),
        )
    })
}
