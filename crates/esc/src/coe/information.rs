//! SDO information: which objects there are, and what each entry is (ETG.1000.6, 5.6.3).
//!
//! ```text
//!   01 list ─► 02 list, in fragments      03 object ─► 04 description      05 entry ─► 06 description
//!   07 error: abort code
//! ```
use super::mail::{Service, begin};
use super::{Abort, Dictionary, Object};

/// Bytes of mailbox, CoE and information header.
const HEADERS: usize = 12;

/// Answers a request with one mail or, where a list is long, several.
pub(crate) fn answer(request: &[u8], dictionary: &Dictionary, mailbox: usize) -> Vec<Vec<u8>> {
    let operation = request.first().map_or(0, |byte| byte & 0x7F);
    let data = request.get(4..).unwrap_or_default();
    let word = |at: usize| data.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
    let body = match (operation, word(0)) {
        (1, Some(kind)) => list(kind, dictionary).map(|body| (2, body)),
        (3, Some(index)) => object(index, dictionary).map(|body| (4, body)),
        (5, Some(index)) => {
            let sub = data.get(2).copied().unwrap_or_default();
            entry(index, sub, dictionary).map(|body| (6, body))
        }
        _ => Err(Abort::Command),
    };
    let (operation, body) = body.unwrap_or_else(|abort| (7, (abort as u32).to_le_bytes().to_vec()));
    let room = mailbox.saturating_sub(HEADERS).max(2) & !1;
    let parts: Vec<&[u8]> = body.chunks(room).collect();
    let mails = parts.iter().enumerate().map(|(i, part)| {
        let left = parts.len() - 1 - i;
        let mut mail = Vec::new();
        begin(&mut mail, Service::SdoInformation);
        mail.extend([operation | u8::from(left > 0) << 7, 0]);
        mail.extend((left as u16).to_le_bytes());
        mail.extend_from_slice(part);
        mail
    });
    mails.collect()
}

fn list(kind: u16, dictionary: &Dictionary) -> Result<Vec<u8>, Abort> {
    let belongs = |object: &&Object, kind: u16| match kind {
        1 => true,
        2 => object.entries.iter().any(|entry| entry.access.rx),
        3 => object.entries.iter().any(|entry| entry.access.tx),
        _ => false,
    };
    let mut body = kind.to_le_bytes().to_vec();
    match kind {
        0 => {
            for kind in 1..=5 {
                let count = dictionary.objects().iter().filter(|o| belongs(o, kind)).count();
                body.extend((count as u16).to_le_bytes());
            }
        }
        1..=5 => {
            let objects = dictionary.objects().iter().filter(|o| belongs(o, kind));
            body.extend(objects.flat_map(|object| object.index.to_le_bytes()));
        }
        _ => return Err(Abort::Range),
    }
    Ok(body)
}

fn object(index: u16, dictionary: &Dictionary) -> Result<Vec<u8>, Abort> {
    let object = dictionary.object(index).ok_or(Abort::NoObject)?;
    let last = object.entries.last();
    let mut body = index.to_le_bytes().to_vec();
    body.extend(last.map_or(0, |entry| entry.data_type.code()).to_le_bytes());
    body.extend([last.map_or(0, |entry| entry.sub), object.kind as u8]);
    body.extend(object.name.bytes());
    Ok(body)
}

fn entry(index: u16, sub: u8, dictionary: &Dictionary) -> Result<Vec<u8>, Abort> {
    let entry = dictionary.entry(index, sub)?;
    let mut body = index.to_le_bytes().to_vec();
    body.extend([sub, 0]);
    for word in [entry.data_type.code(), entry.bits() as u16, entry.access.bits()] {
        body.extend(word.to_le_bytes());
    }
    body.extend(entry.name.bytes());
    Ok(body)
}
