//! The mailbox protocol: six bytes before what a service says.
//!
//! ```text
//!   length 2 · address 2 · channel 1 · kind (4 bits), counter (3 bits) · body
//!   CoE body:  number (9 bits), service (4 bits) · …
//! ```

/// Bytes before the body.
const HEADER: usize = 6;
/// Kind of mail: an error of the mailbox itself.
const ERROR: u8 = 0;
/// Kind of mail: CANopen.
pub(crate) const COE: u8 = 3;

/// A CoE service (ETG.1000.6, table 29).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Service {
    Emergency = 1,
    SdoRequest = 2,
    SdoResponse = 3,
    SdoInformation = 8,
}

/// Mail, taken apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mail<'a> {
    pub(crate) kind: u8,
    pub(crate) body: &'a [u8],
}

/// Takes mail apart; `None` where it is shorter than it says.
pub(crate) fn parse(bytes: &[u8]) -> Option<Mail<'_>> {
    let (header, rest) = bytes.split_at_checked(HEADER)?;
    let length = usize::from(u16::from_le_bytes([header[0], header[1]]));
    let body = rest.get(..length)?;
    Some(Mail { kind: header[5] & 0x0F, body })
}

/// Begins a reply of a CoE service in a buffer.
pub(crate) fn begin(into: &mut Vec<u8>, service: Service) {
    into.clear();
    into.extend_from_slice(&[0, 0, 0, 0, 0, COE, 0, (service as u8) << 4]);
}

/// Writes the length and the counter of a reply.
pub(crate) fn finish(mail: &mut [u8], counter: u8) {
    let length = mail.len().saturating_sub(HEADER) as u16;
    if let Some(header) = mail.first_chunk_mut::<HEADER>() {
        header[..2].copy_from_slice(&length.to_le_bytes());
        header[5] = header[5] & 0x0F | counter << 4;
    }
}

/// Writes the reply to mail of a kind that there is not, or that is malformed.
pub(crate) fn error_reply(into: &mut Vec<u8>, detail: u16) {
    into.clear();
    into.extend_from_slice(&[0, 0, 0, 0, 0, ERROR, 1, 0]);
    into.extend_from_slice(&detail.to_le_bytes());
}

/// What a device says unasked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Emergency {
    /// Error code (6040 and following: CiA 402).
    pub code: u16,
    /// Error register, 1001.
    pub register: u8,
    /// What the manufacturer says.
    pub data: [u8; 5],
}

impl Emergency {
    pub(crate) fn write(self, into: &mut Vec<u8>) {
        begin(into, Service::Emergency);
        into.extend_from_slice(&self.code.to_le_bytes());
        into.push(self.register);
        into.extend_from_slice(&self.data);
    }
}
