//! A network interface of this computer: Ethernet frames by a raw socket.
use control::Refused;
use control::clock::now;
use ethercat::FrameLink;
use nix::errno::Errno;
use nix::ifaddrs::getifaddrs;
use nix::sys::socket::{
    AddressFamily, MsgFlags, SockFlag, SockProtocol, SockType, bind, recv, send, socket,
};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use std::os::fd::{AsRawFd, OwnedFd};
use std::time::Instant;

/// An open interface.
#[derive(Debug)]
pub struct NetworkInterface {
    socket: OwnedFd,
    began: Instant,
}

impl NetworkInterface {
    /// Opens an interface by its name.
    ///
    /// # Errors
    /// There is no such interface, or this user may not send raw frames.
    pub fn open(name: &str) -> Result<Self, Refused> {
        let failed = |what: &str, why: Errno| {
            Refused::because(match why {
                Errno::EPERM | Errno::EACCES => format!(
                    "the network interface {name} needs the right CAP_NET_RAW: run as root, or setcap cap_net_raw,cap_sys_nice+ep on the program"
                ),
                why => format!("{what} {name}: {why}"),
            })
        };
        let all = getifaddrs().map_err(|why| failed("the network interfaces beside", why))?;
        let all: Vec<_> = all.collect();
        let link = all.iter().find_map(|interface| {
            let address = interface.address.filter(|_| interface.interface_name == name)?;
            address.as_link_addr().copied()
        });
        let Some(link) = link else {
            let mut names: Vec<_> = all.into_iter().map(|one| one.interface_name).collect();
            names.sort();
            names.dedup();
            return Err(Refused::because(format!(
                "there is no network interface {name}: this computer has {}",
                names.join(", ")
            )));
        };
        let flags = SockFlag::SOCK_NONBLOCK | SockFlag::SOCK_CLOEXEC;
        let socket = socket(AddressFamily::Packet, SockType::Raw, flags, SockProtocol::EthAll)
            .map_err(|why| failed("a raw socket on", why))?;
        bind(socket.as_raw_fd(), &link).map_err(|why| failed("the network interface", why))?;
        Ok(Self { socket, began: now() })
    }

    /// Time since it was opened, ns.
    pub fn time_ns(&self) -> u64 {
        u64::try_from((now() - self.began).as_nanos()).unwrap_or(u64::MAX)
    }

    /// Sends a frame; false if the interface does not take it.
    pub fn send_frame(&self, frame: &[u8]) -> bool {
        send(self.socket.as_raw_fd(), frame, MsgFlags::empty())
            .is_ok_and(|sent| sent == frame.len())
    }

    /// Takes a frame that has come.
    pub fn receive_frame(&self, into: &mut [u8]) -> Option<usize> {
        recv(self.socket.as_raw_fd(), into, MsgFlags::empty()).ok()
    }

    /// Waits until a frame has come, or until a time.
    pub fn wait_until(&self, until_ns: u64) {
        let left = until_ns.saturating_sub(self.time_ns());
        if left == 0 {
            return;
        }
        let timeout = Timespec {
            tv_sec: (left / 1_000_000_000).cast_signed(),
            tv_nsec: (left % 1_000_000_000).cast_signed(),
        };
        // whatever ends the wait, the time is looked at anew
        let _ = poll(&mut [PollFd::new(&self.socket, PollFlags::IN)], Some(&timeout));
    }
}

impl FrameLink for NetworkInterface {
    fn now_ns(&mut self) -> u64 {
        self.time_ns()
    }

    fn send(&mut self, frame: &[u8]) -> bool {
        self.send_frame(frame)
    }

    fn receive(&mut self, into: &mut [u8]) -> Option<usize> {
        self.receive_frame(into)
    }

    fn wait(&mut self, until_ns: u64) {
        self.wait_until(until_ns);
    }
}
