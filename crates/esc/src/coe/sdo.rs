//! Service data objects: reading and writing the dictionary, expedited, normal and in segments.
//!
//! ```text
//!   upload    40 index sub  ─►     4x expedited · 41 size data …                 (60 segment ─► 0x data)*
//!   download  2x index sub data · 21 index sub size data …  ─►  60               (0x data ─► 20)*
//!   complete access (bit 10 of the command): subindex 0 padded to 16 bits, then all entries
//!   80 index sub code: abort, from either side
//! ```
//!
//! ETG.1000.6, 5.6.2. One transfer at a time; a new one takes the place of one that has not ended.
use super::mail::{Service, begin};
use super::{Abort, Dictionary, pdo};
use crate::al::AlState;
use crate::quirks::Quirks;

/// Bytes of an initiating request or response: command, index, subindex, size or data.
const INITIATE: usize = 8;
/// Bytes of mailbox and CoE header.
const HEADERS: usize = 8;
/// Least bytes of the data of a segment.
const LEAST_SEGMENT: usize = 7;
/// Longest value that is taken.
const MOST_BYTES: usize = 4096;
/// Bit of the command: complete access.
const COMPLETE: u8 = 0x10;
/// Bit of the command of a segment.
const TOGGLE: u8 = 0x10;

/// What a request works on.
pub(crate) struct Context<'a> {
    pub(crate) dictionary: &'a mut Dictionary,
    pub(crate) state: AlState,
    pub(crate) quirks: &'a Quirks,
    /// Bytes of the mailbox that the master reads.
    pub(crate) mailbox: usize,
}

/// Where a transfer goes.
#[derive(Clone, Copy, Debug)]
struct Target {
    index: u16,
    sub: u8,
    complete: bool,
}

/// A transfer in segments.
#[derive(Clone, Debug)]
enum Transfer {
    None,
    Upload { target: Target, data: Vec<u8>, sent: usize, toggle: u8 },
    Download { target: Target, data: Vec<u8>, size: usize, toggle: u8 },
}

/// Server of the service data objects of a device.
#[derive(Clone, Debug)]
pub(crate) struct Server {
    transfer: Transfer,
}

impl Server {
    pub(crate) fn new() -> Self {
        Self { transfer: Transfer::None }
    }

    /// Answers a request; true if there is an answer in `out`.
    pub(crate) fn answer(
        &mut self,
        request: &[u8],
        context: &mut Context<'_>,
        out: &mut Vec<u8>,
    ) -> bool {
        let Some(command) = request.first().copied() else { return false };
        let target = Target {
            index: u16::from_le_bytes([byte(request, 1), byte(request, 2)]),
            sub: byte(request, 3),
            complete: command & COMPLETE != 0,
        };
        begin(out, Service::SdoResponse);
        let (result, about) = match command >> 5 {
            0 => self.download_segment(command, request, context, out),
            1 => (self.initiate_download(command, request, target, context, out), target),
            2 => (self.initiate_upload(target, context, out), target),
            3 => self.upload_segment(command, context, out),
            4 => {
                self.transfer = Transfer::None;
                return false;
            }
            _ => (Err(Abort::Command), target),
        };
        if let Err(abort) = result {
            self.transfer = Transfer::None;
            begin(out, Service::SdoRequest);
            initiate(out, 0x80, about, abort as u32);
        }
        true
    }

    fn initiate_upload(
        &mut self,
        target: Target,
        context: &mut Context<'_>,
        out: &mut Vec<u8>,
    ) -> Result<(), Abort> {
        let data = read(target, context)?;
        let complete = if target.complete { COMPLETE } else { 0 };
        if !data.is_empty() && data.len() <= 4 {
            let mut four = [0; 4];
            four[..data.len()].copy_from_slice(&data);
            let unused = (4 - data.len()) as u8;
            initiate(out, 0x43 | unused << 2 | complete, target, u32::from_le_bytes(four));
            return Ok(());
        }
        initiate(out, 0x41 | complete, target, data.len() as u32);
        let room = context.mailbox.saturating_sub(HEADERS + INITIATE);
        let sent = data.len().min(room);
        out.extend_from_slice(&data[..sent]);
        self.transfer = if sent < data.len() {
            Transfer::Upload { target, data, sent, toggle: 0 }
        } else {
            Transfer::None
        };
        Ok(())
    }

    fn upload_segment(
        &mut self,
        command: u8,
        context: &Context<'_>,
        out: &mut Vec<u8>,
    ) -> (Result<(), Abort>, Target) {
        let Transfer::Upload { target, data, sent, toggle } = &mut self.transfer else {
            return (Err(Abort::Command), Target { index: 0, sub: 0, complete: false });
        };
        let target = *target;
        if command & TOGGLE != *toggle {
            return (Err(Abort::Toggle), target);
        }
        let room = context.mailbox.saturating_sub(HEADERS + 1).max(LEAST_SEGMENT);
        let part = &data[*sent..data.len().min(*sent + room)];
        *sent += part.len();
        let is_last = *sent == data.len();
        let unused = LEAST_SEGMENT.saturating_sub(part.len()) as u8;
        out.push(*toggle | unused << 1 | u8::from(is_last));
        out.extend_from_slice(part);
        out.resize(out.len() + usize::from(unused), 0);
        *toggle ^= TOGGLE;
        if is_last {
            self.transfer = Transfer::None;
        }
        (Ok(()), target)
    }

    fn initiate_download(
        &mut self,
        command: u8,
        request: &[u8],
        target: Target,
        context: &mut Context<'_>,
        out: &mut Vec<u8>,
    ) -> Result<(), Abort> {
        let four = request.get(4..INITIATE).ok_or(Abort::Length)?;
        if command & 0x02 != 0 {
            let unused = if command & 1 == 0 { 0 } else { usize::from(command >> 2 & 3) };
            // without a size, the entry's own is meant
            let own = context
                .dictionary
                .entry(target.index, target.sub)
                .map_or(4, |e| e.data_type.bytes());
            let used = if command & 1 == 0 { own.min(4) } else { 4 - unused };
            write(target, &four[..used], context)?;
        } else {
            let size = usize::try_from(u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
            let size = size.ok().filter(|size| *size <= MOST_BYTES).ok_or(Abort::Length)?;
            let data = &request[INITIATE..];
            if data.len() < size {
                // what does not exist is refused before its data are sent
                context.dictionary.entry(target.index, target.sub)?;
                self.transfer = Transfer::Download { target, data: data.to_vec(), size, toggle: 0 };
            } else {
                write(target, &data[..size], context)?;
                self.transfer = Transfer::None;
            }
        }
        initiate(out, 0x60, target, 0);
        Ok(())
    }

    fn download_segment(
        &mut self,
        command: u8,
        request: &[u8],
        context: &mut Context<'_>,
        out: &mut Vec<u8>,
    ) -> (Result<(), Abort>, Target) {
        let Transfer::Download { target, data, size, toggle } = &mut self.transfer else {
            return (Err(Abort::Command), Target { index: 0, sub: 0, complete: false });
        };
        let target = *target;
        if command & TOGGLE != *toggle {
            return (Err(Abort::Toggle), target);
        }
        let part = request.get(1..).unwrap_or_default();
        let unused = if part.len() == LEAST_SEGMENT { usize::from(command >> 1 & 7) } else { 0 };
        data.extend_from_slice(&part[..part.len().saturating_sub(unused)]);
        if data.len() > *size {
            return (Err(Abort::Length), target);
        }
        let answer = 0x20 | *toggle;
        *toggle ^= TOGGLE;
        if command & 1 != 0 {
            let (data, size) = (std::mem::take(data), *size);
            self.transfer = Transfer::None;
            let result =
                if data.len() == size { write(target, &data, context) } else { Err(Abort::Length) };
            if result.is_err() {
                return (result, target);
            }
        }
        out.push(answer);
        out.extend_from_slice(&[0; 7]);
        (Ok(()), target)
    }
}

fn byte(bytes: &[u8], at: usize) -> u8 {
    bytes.get(at).copied().unwrap_or_default()
}

fn initiate(out: &mut Vec<u8>, command: u8, target: Target, four: u32) {
    out.push(command);
    out.extend_from_slice(&target.index.to_le_bytes());
    out.push(target.sub);
    out.extend_from_slice(&four.to_le_bytes());
}

/// Bytes of subindex 0 in a complete access.
fn count_bytes(quirks: &Quirks) -> usize {
    if quirks.unpadded_complete_access { 1 } else { 2 }
}

fn check_complete(target: Target, quirks: &Quirks) -> Result<(), Abort> {
    match target.sub {
        _ if quirks.no_complete_access => Err(Abort::Unsupported),
        0 | 1 => Ok(()),
        _ => Err(Abort::NoSubindex),
    }
}

fn read(target: Target, context: &Context<'_>) -> Result<Vec<u8>, Abort> {
    let mut data = Vec::new();
    if !target.complete {
        context.dictionary.entry(target.index, target.sub)?.append(&mut data);
        return Ok(data);
    }
    check_complete(target, context.quirks)?;
    let object = context.dictionary.object(target.index).ok_or(Abort::NoObject)?;
    let is_single = object.entries.len() == 1;
    for entry in object.entries.iter().filter(|entry| entry.sub >= target.sub) {
        entry.append(&mut data);
        if entry.sub == 0 && !is_single {
            data.resize(count_bytes(context.quirks), 0);
        }
    }
    // what is beyond the count of a list does not exist
    if let (Some(count), false) = (context.dictionary.number(target.index, 0), is_single) {
        let listed = object.entries.iter().filter(|e| e.sub > 0 && i64::from(e.sub) <= count);
        let bytes: usize = listed.map(|entry| entry.bits() / 8).sum();
        data.truncate(bytes + if target.sub == 0 { count_bytes(context.quirks) } else { 0 });
    }
    Ok(data)
}

fn write(target: Target, data: &[u8], context: &mut Context<'_>) -> Result<(), Abort> {
    if !target.complete {
        return write_entry(target.index, target.sub, data, context);
    }
    check_complete(target, context.quirks)?;
    let before = context.dictionary.object(target.index).ok_or(Abort::NoObject)?.clone();
    let result = write_complete(target, data, context);
    if result.is_err()
        && let Some(object) = context.dictionary.object_mut(target.index)
    {
        *object = before;
    }
    result
}

fn write_complete(target: Target, data: &[u8], context: &mut Context<'_>) -> Result<(), Abort> {
    let mut rest = data;
    let mut count = None;
    if target.sub == 0 {
        let (own, after) =
            rest.split_at_checked(count_bytes(context.quirks)).ok_or(Abort::TooShort)?;
        count = own.first().copied();
        rest = after;
        write_entry(target.index, 0, &[0], context)?;
    }
    let object = context.dictionary.object(target.index).ok_or(Abort::NoObject)?;
    let entries: Vec<(u8, usize)> = object
        .entries
        .iter()
        .filter(|entry| entry.sub > 0 && entry.data_type.bytes() > 0)
        .map(|entry| (entry.sub, entry.data_type.bytes()))
        .collect();
    for (sub, bytes) in entries {
        if rest.is_empty() {
            break;
        }
        let (own, after) = rest.split_at_checked(bytes).ok_or(Abort::TooShort)?;
        write_entry(target.index, sub, own, context)?;
        rest = after;
    }
    if !rest.is_empty() {
        return Err(Abort::TooLong);
    }
    count.map_or(Ok(()), |count| write_entry(target.index, 0, &[count], context))
}

fn write_entry(index: u16, sub: u8, data: &[u8], context: &mut Context<'_>) -> Result<(), Abort> {
    let number = context.dictionary.check(index, sub, data, context.state)?;
    pdo::check(context.dictionary, index, sub, number, context.state, context.quirks)?;
    let stays_zero =
        context.quirks.sync_type_reads_zero && matches!((index, sub), (0x1C32 | 0x1C33, 1));
    if !stays_zero {
        context.dictionary.put(index, sub, number);
    }
    Ok(())
}
