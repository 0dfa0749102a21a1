//! Frames between `ethercrab` and the link: sent, awaited, and what has no place is counted and
//! skipped.
//!
//! ```text
//!   future ─poll─► next_sendable_frame ─► link ─► devices ─► link ─► known? ─► receive_frame ─► future
//!                                                                     │ no
//!                                                                     ▼
//!                                     foreign · echo · unexpected (late, repeated): a counter each
//! ```
use crate::clock;
use crate::link::FrameLink;
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use ethercrab::{PduRx, PduTx};

/// Longest Ethernet frame without its checksum.
pub(crate) const MOST_FRAME: usize = 1514;
/// Source address of the master's frames, before the first device has set bit 02.
const SOURCE: [u8; 6] = [0x10; 6];
/// Wait between two polls if nothing happens, ns.
const TICK_NS: u64 = 20_000;
/// Emergencies that are kept; what comes after them is counted alone.
const MOST_EMERGENCIES: usize = 16;
/// Command: read by configured address.
const FPRD: u8 = 4;

/// What a device said unasked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Emergency {
    /// Station address of the device; [`crate::Bus`] counts them from 1000 hex.
    pub station: u16,
    /// Error code.
    pub code: u16,
    /// Error register.
    pub register: u8,
}

/// Frames that were lost, or that came without a request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    /// Frames of another protocol.
    pub foreign: u64,
    /// Own frames with an unchanged source address.
    pub echoes: u64,
    /// Frames that came twice, or too late to be waited for.
    pub unexpected: u64,
    /// Frames that are malformed.
    pub malformed: u64,
    /// Frames that the link did not take.
    pub not_sent: u64,
}

/// Frames on their way.
pub(crate) struct Exchange<'s> {
    tx: PduTx<'s>,
    rx: PduRx<'s>,
    /// Index of the first datagram of each frame on its way, a bit each, and its header.
    in_flight: [u64; 4],
    headers: Box<[[u8; 8]; 256]>,
    buffer: Box<[u8; MOST_FRAME]>,
    pub(crate) losses: Losses,
    emergencies: [Emergency; MOST_EMERGENCIES],
    pub(crate) emergency_count: usize,
    /// Mailbox from which each device is read, by station address from 1000 on.
    pub(crate) mailboxes: Vec<u16>,
}

impl<'s> Exchange<'s> {
    pub(crate) fn new(tx: PduTx<'s>, rx: PduRx<'s>) -> Self {
        Self {
            tx,
            rx,
            in_flight: [0; 4],
            headers: Box::new([[0; 8]; 256]),
            buffer: Box::new([0; MOST_FRAME]),
            losses: Losses::default(),
            emergencies: [Emergency::default(); MOST_EMERGENCIES],
            emergency_count: 0,
            mailboxes: Vec::new(),
        }
    }

    /// Emergencies that are kept, the oldest first.
    pub(crate) fn emergencies(&self) -> &[Emergency] {
        &self.emergencies[..self.emergency_count.min(MOST_EMERGENCIES)]
    }

    /// Polls until a future is ready; `None` if it is not by the time given. Frames that are on
    /// their way then are forgotten: what comes of them later is unexpected.
    pub(crate) fn run<F: Future>(
        &mut self,
        link: &mut impl FrameLink,
        future: F,
        until_ns: u64,
    ) -> Option<F::Output> {
        let mut future = pin!(future);
        let mut context = Context::from_waker(Waker::noop());
        loop {
            let now = link.now_ns();
            clock::set(now);
            if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
                return Some(output);
            }
            if now >= until_ns {
                self.in_flight = [0; 4];
                return None;
            }
            let sent = self.send(link);
            if !self.receive(link) && !sent {
                link.wait(until_ns.min(now + TICK_NS));
            }
        }
    }

    /// Waits until a time. What comes meanwhile has no place.
    pub(crate) fn idle(&mut self, link: &mut impl FrameLink, until_ns: u64) {
        loop {
            self.receive(link);
            if link.now_ns() >= until_ns {
                return;
            }
            link.wait(until_ns);
        }
    }

    fn send(&mut self, link: &mut impl FrameLink) -> bool {
        let mut any = false;
        while let Some(frame) = self.tx.next_sendable_frame() {
            let (in_flight, headers) = (&mut self.in_flight, &mut self.headers);
            let losses = &mut self.losses;
            let sent = frame.send_blocking(|bytes| {
                if let Some((index, header)) = first_datagram(bytes) {
                    in_flight[usize::from(index) / 64] |= 1 << (index % 64);
                    headers[usize::from(index)] = header;
                }
                if !link.send(bytes) {
                    losses.not_sent += 1;
                }
                Ok(bytes.len())
            });
            any |= sent.is_ok();
        }
        any
    }

    fn receive(&mut self, link: &mut impl FrameLink) -> bool {
        let mut any = false;
        while let Some(length) = link.receive(&mut self.buffer[..]) {
            any |= self.take(length.min(MOST_FRAME));
        }
        any
    }

    /// Hands on a frame that somebody waits for; true if somebody did.
    fn take(&mut self, length: usize) -> bool {
        let frame = &mut self.buffer[..length];
        if frame.len() < 16 || frame[12..14] != [0x88, 0xA4] || frame[15] >> 4 != 1 {
            self.losses.foreign += 1;
            return false;
        }
        if frame[6..12] == SOURCE {
            self.losses.echoes += 1;
            return false;
        }
        let Some((index, header)) = first_datagram(frame) else {
            self.losses.malformed += 1;
            return false;
        };
        let (word, bit) = (usize::from(index) / 64, 1_u64 << (index % 64));
        let is_expected =
            self.in_flight[word] & bit != 0 && is_answer(self.headers[usize::from(index)], header);
        if !is_expected {
            self.losses.unexpected += 1;
            return false;
        }
        self.in_flight[word] &= !bit;
        if let Some(emergency) = take_emergency(frame, &self.mailboxes) {
            if let Some(place) = self.emergencies.get_mut(self.emergency_count) {
                *place = emergency;
            }
            self.emergency_count += 1;
        }
        let is_taken = self.rx.receive_frame(frame).is_ok();
        // whoever waited for it has given up
        self.losses.unexpected += u64::from(!is_taken);
        is_taken
    }
}

/// Returns the index of the first datagram and the bytes of its header that a device leaves or
/// counts up: command, address, length.
fn first_datagram(frame: &[u8]) -> Option<(u8, [u8; 8])> {
    let length = usize::from(u16::from_le_bytes([*frame.get(14)?, *frame.get(15)?]) & 0x07FF);
    let datagrams = frame.get(16..16 + length)?;
    let header = datagrams.first_chunk::<10>()?;
    let [command, index, a0, a1, a2, a3, l0, l1, ..] = *header;
    Some((index, [command, 0, a0, a1, a2, a3, l0, l1]))
}

/// Returns whether a header can be what devices made of another: all the same but for a position.
fn is_answer(sent: [u8; 8], received: [u8; 8]) -> bool {
    let counts_up = matches!(sent[0], 1..=3 | 7..=9 | 13);
    let same_device = counts_up || sent[2..4] == received[2..4];
    sent[0] == received[0] && same_device && sent[4..] == received[4..]
}

/// Takes an emergency out of an answer from a mailbox. What is left of it is no CoE service that
/// `ethercrab` knows, so that it gives an error to whoever waits for another answer (0.7.1 ends the
/// program on an emergency in the place of an answer).
fn take_emergency(frame: &mut [u8], mailboxes: &[u16]) -> Option<Emergency> {
    let datagram = frame.get_mut(16..)?;
    let (header, body) = datagram.split_first_chunk_mut::<10>()?;
    let station = u16::from_le_bytes([header[2], header[3]]);
    let address = u16::from_le_bytes([header[4], header[5]]);
    let mailbox = mailboxes.get(usize::from(station.checked_sub(0x1000)?))?;
    if header[0] != FPRD || *mailbox == 0 || address != *mailbox {
        return None;
    }
    let mail = body.first_chunk_mut::<11>()?;
    let is_emergency = mail[5] & 0x0F == 3 && mail[7] >> 4 == 1;
    if !is_emergency {
        return None;
    }
    mail[7] = 0xF0;
    let code = u16::from_le_bytes([mail[8], mail[9]]);
    Some(Emergency { station, code, register: mail[10] })
}
