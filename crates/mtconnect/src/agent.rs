//! What is answered: documents of a device and of what was observed of it.
use crate::buffer::{Buffer, Observation};
use crate::device::Device;
use crate::documents::{self, CUTTING_TOOL, Header, Subject};
use crate::element::Element;
use crate::feed::{Feed, Observable};
use crate::path::Path;
use crate::query::{AssetQuery, CurrentQuery, ErrorCode, QueryError, SampleQuery};
use store::machine::MachineFile;

/// Which agent this is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Of the device; no other one has it.
    pub uuid: String,
    /// Of this agent's buffer: sequence numbers begin anew with another one.
    pub instance: u64,
    /// When it has begun, ms since 1970.
    pub unix_ms: u64,
}

/// An agent.
#[derive(Debug)]
pub struct Agent {
    pub(crate) device: Device,
    pub(crate) identity: Identity,
    pub(crate) buffer: Buffer,
    pub(crate) feed: Feed,
    /// The Devices document without its header: what paths choose from.
    devices: Element,
}

/// A Streams document, and where the next one begins.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// The document.
    pub document: Element,
    /// The next observation that it does not look at.
    pub next: u64,
    /// Nothing that was asked for was observed.
    pub is_empty: bool,
    /// There is more than it may have.
    pub is_full: bool,
}

impl Agent {
    /// Of a machine, keeping so many observations; there are none yet.
    pub fn new(machine: &MachineFile, identity: Identity, most: usize) -> Self {
        let device = Device::of(machine, &identity.uuid);
        let buffer = Buffer::new(device.items.len(), most.max(1));
        let devices = Element::new("Devices").containing([device.element()]);
        let devices = Element::new("MTConnectDevices").containing([devices]);
        Self { device, identity, buffer, feed: Feed::default(), devices }
    }

    /// What there is to observe.
    pub fn observe(&mut self, seen: &Observable<'_>) {
        self.feed.take(seen, &self.device, &mut self.buffer);
    }

    /// The next sequence number.
    pub const fn next(&self) -> u64 {
        self.buffer.next()
    }

    /// Whether a request of this device means this agent's.
    ///
    /// # Errors
    /// It does not.
    pub fn is_device(&self, name: &str) -> Result<(), QueryError> {
        if name == self.device.name || name == self.device.uuid {
            return Ok(());
        }
        let shown: String = name.chars().take(80).collect();
        let text = format!("there is no device \"{shown}\": this one is {}", self.device.name);
        Err(QueryError::new(ErrorCode::NoDevice, text))
    }

    fn header(&self, subject: Subject, now_ms: u64) -> Header {
        let buffer = ("bufferSize", self.buffer.most() as u64);
        let assets = self.feed.assets.iter().filter(|asset| !asset.is_removed).count() as u64;
        let assets = [("assetBufferSize", crate::MOST_COUNT), ("assetCount", assets)];
        let more = match subject {
            Subject::Devices => [[buffer].as_slice(), &assets].concat(),
            Subject::Streams => {
                let (first, next) = (self.buffer.first(), self.buffer.next());
                let last = next.saturating_sub(1).max(1);
                let sequences = [("firstSequence", first), ("lastSequence", last)];
                [[buffer].as_slice(), &sequences].concat()
            }
            Subject::Assets => assets.to_vec(),
            Subject::Error => vec![buffer],
        };
        let Identity { instance, unix_ms: model_ms, .. } = self.identity;
        Header { subject, instance, made_ms: now_ms, model_ms, more }
    }

    /// What the device is made of.
    pub fn probe(&self, now_ms: u64) -> Element {
        let devices = Element::new("Devices").containing([self.device.element()]);
        self.header(Subject::Devices, now_ms).over(devices)
    }

    /// What is true now, or was.
    ///
    /// # Errors
    /// The standard's.
    pub fn current(&self, query: &CurrentQuery, now_ms: u64) -> Result<Element, QueryError> {
        let chosen = self.chosen(query.path.as_ref())?;
        let at =
            query.at.map(|at| self.buffer.at(at).ok_or_else(|| self.out_of_range("at", at, 1)));
        let then = at.transpose()?;
        let state = then.as_ref().unwrap_or_else(|| self.buffer.latest());
        let observations = state.all().filter(|observation| chosen[observation.item]);
        let next = query.at.map_or_else(|| self.buffer.next(), |at| at + 1);
        Ok(self.streams(observations, next, now_ms))
    }

    /// What was observed.
    ///
    /// # Errors
    /// The standard's.
    pub fn sample(&self, query: &SampleQuery, now_ms: u64) -> Result<Chunk, QueryError> {
        let chosen = self.chosen(query.path.as_ref())?;
        let (first, next) = (self.buffer.first(), self.buffer.next());
        let is_backwards = query.count < 0;
        let from = query.from.unwrap_or(if is_backwards { next } else { first });
        if !(first..=next).contains(&from) {
            return Err(self.out_of_range("from", from, 0));
        }
        if let Some(to) = query.to.filter(|to| !(first..next).contains(to)) {
            return Err(self.out_of_range("to", to, 1));
        }
        let count = usize::try_from(query.count.unsigned_abs()).unwrap_or(usize::MAX);
        let is_chosen = |observation: &&Observation| chosen[observation.item];
        let last = query.to.unwrap_or(next);
        let (found, looked): (Vec<_>, u64) = if is_backwards {
            let before = self.buffer.from(first).take_while(|seen| seen.sequence <= from);
            let mut found: Vec<_> = before.filter(is_chosen).collect();
            found.drain(..found.len().saturating_sub(count));
            (found, from.saturating_add(1).min(next))
        } else {
            let mut ahead = self.buffer.from(from).take_while(|seen| seen.sequence <= last);
            let found: Vec<_> = ahead.by_ref().filter(is_chosen).take(count).collect();
            let looked = match found.last() {
                Some(last) if found.len() == count => last.sequence + 1,
                _ => last.saturating_add(1).min(next),
            };
            (found, looked)
        };
        let (is_empty, is_full) = (found.is_empty(), found.len() == count && looked < next);
        let document = self.streams(found.into_iter(), looked, now_ms);
        Ok(Chunk { document, next: looked, is_empty, is_full })
    }

    fn streams<'a>(
        &self,
        observations: impl Iterator<Item = &'a Observation>,
        next: u64,
        now_ms: u64,
    ) -> Element {
        let mut header = self.header(Subject::Streams, now_ms);
        header.more.push(("nextSequence", next));
        header.over(documents::streams(&self.device, observations))
    }

    /// Cutting tools.
    ///
    /// # Errors
    /// The standard's.
    pub fn assets(&self, query: &AssetQuery, now_ms: u64) -> Result<Element, QueryError> {
        let all = &self.feed.assets;
        if let Some(id) = query.ids.iter().find(|id| !all.iter().any(|asset| asset.id == **id)) {
            let shown: String = id.chars().take(80).collect();
            let text = format!("there is no asset \"{shown}\"");
            return Err(QueryError::new(ErrorCode::AssetNotFound, text));
        }
        let is_kind = query.kind.as_deref().is_none_or(|kind| kind == CUTTING_TOOL);
        let found = all.iter().filter(|asset| {
            let is_named = query.ids.contains(&asset.id);
            let is_there = !asset.is_removed || query.with_removed || is_named;
            is_kind && is_there && (query.ids.is_empty() || is_named)
        });
        let found = found.take(query.count).map(|asset| asset.element(&self.device.uuid));
        let assets = Element::new("Assets").containing(found);
        Ok(self.header(Subject::Assets, now_ms).over(assets))
    }

    /// Why a request is not answered.
    pub fn error(&self, error: &QueryError, now_ms: u64) -> Element {
        self.header(Subject::Error, now_ms).over(documents::errors(std::slice::from_ref(error)))
    }

    /// Of each data item, whether the path chooses it.
    fn chosen(&self, path: Option<&Path>) -> Result<Vec<bool>, QueryError> {
        let Some(path) = path else { return Ok(vec![true; self.device.items.len()]) };
        let mut chosen = vec![false; self.device.items.len()];
        for id in path.choose(&self.devices)? {
            if let Some(number) = self.device.number(id) {
                chosen[number] = true;
            }
        }
        Ok(chosen)
    }

    fn out_of_range(&self, name: &str, value: u64, less: u64) -> QueryError {
        let (first, next) = (self.buffer.first(), self.buffer.next());
        let most = next.saturating_sub(less);
        let text = format!("{name}={value}: what is kept goes from {first} to {most}");
        QueryError::new(ErrorCode::OutOfRange, text)
    }
}
