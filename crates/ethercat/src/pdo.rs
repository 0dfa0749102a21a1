//! Configuration of a device by its mailbox: values, PDOs with read back, synchronisation, mode.
//!
//! ```text
//!   1C12:0 = 0 ─► 1600:0 = 0, 1600:1…n, 1600:0 = n ─► 1C12:1…, 1C12:0 ─► all of it read back
//!   0601_0002 (read-only): the device has fixed PDOs; what is read back has to have what is needed
//! ```
use crate::error::StartError;
use crate::image::Image;
use crate::network::{Device, Network, Pdo, PdoEntry, Sdo, Sync};
use core::ops::Deref;
use ethercrab::error::{Error, MailboxError};
use ethercrab::{EtherCrabWireReadSized, SubDevice, SubDeviceRef};

/// Abort: it cannot be written.
const READ_ONLY: u32 = 0x0601_0002;
/// Tries of a transfer that failed for another reason than an abort.
const TRIES: usize = 4;
/// Most PDOs that are read of an assignment, and entries of a PDO.
const MOST: u8 = 32;
/// Assignments of outputs and of inputs.
const ASSIGNMENTS: [u16; 2] = [0x1C12, 0x1C13];

/// A transfer that failed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Failure {
    /// The device refused it.
    Abort(u32),
    /// Anything else.
    Other(Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Mailbox(MailboxError::Aborted { code, .. }) => Self::Abort(code.into()),
            other => Self::Other(other),
        }
    }
}

/// What a device receives and sends.
#[derive(Clone, Debug, Default)]
pub(crate) struct Images {
    pub(crate) outputs: Image,
    pub(crate) inputs: Image,
}

/// A device whose mailbox is used.
pub(crate) struct Configured<'a, 'm, S> {
    pub(crate) remote: &'a SubDeviceRef<'m, S>,
    pub(crate) config: &'a Device,
}

impl<S: Deref<Target = SubDevice>> Configured<'_, '_, S> {
    async fn read<T: EtherCrabWireReadSized>(&self, index: u16, sub: u8) -> Result<T, Failure> {
        let mut tried = 0;
        loop {
            tried += 1;
            match self.remote.sdo_read(index, sub).await.map_err(Failure::from) {
                Err(Failure::Other(_)) if tried < TRIES => {}
                result => return result,
            }
        }
    }

    async fn write(&self, entry: PdoEntry, value: u32) -> Result<(), Failure> {
        let PdoEntry { index, sub, bits } = entry;
        let mut tried = 0;
        loop {
            tried += 1;
            let result = match bits {
                0..=8 => self.remote.sdo_write(index, sub, value as u8).await,
                9..=16 => self.remote.sdo_write(index, sub, value as u16).await,
                _ => self.remote.sdo_write(index, sub, value).await,
            };
            match result.map_err(Failure::from) {
                Err(Failure::Other(_)) if tried < TRIES => {}
                result => return result,
            }
        }
    }

    fn refused(&self, object: u16, sub: u8) -> impl Fn(Failure) -> StartError {
        let name = self.config.name.clone();
        move |failure| match failure {
            Failure::Abort(abort) => StartError::Sdo { name: name.clone(), object, sub, abort },
            Failure::Other(error) => library(&name, object, error),
        }
    }

    /// Configures the device, and says what it receives and sends.
    pub(crate) async fn configure(&self, network: &Network) -> Result<Images, StartError> {
        self.check_modes().await?;
        for Sdo { entry, value } in &self.config.sdos {
            self.write(*entry, *value).await.map_err(self.refused(entry.index, entry.sub))?;
        }
        let is_rx = |pdo: &&Pdo| pdo.index < 0x1A00;
        let (rx, tx): (Vec<&Pdo>, Vec<&Pdo>) = self.config.pdos.iter().partition(is_rx);
        for (assignment, pdos) in ASSIGNMENTS.into_iter().zip([&rx, &tx]) {
            if !pdos.is_empty() {
                self.assign(assignment, pdos).await?;
            }
        }
        if self.config.sync != Sync::Free {
            self.synchronise(network.cycle_ns).await?;
        }
        let mut images = Images::default();
        if !self.config.pdos.is_empty() || !self.config.slots.is_empty() {
            images.outputs = self.read_image(ASSIGNMENTS[0]).await?;
            images.inputs = self.read_image(ASSIGNMENTS[1]).await?;
        }
        self.check_images(&images).await?;
        Ok(images)
    }

    async fn check_modes(&self) -> Result<(), StartError> {
        for slot in &self.config.slots {
            let object = 0x6502 + 0x800 * u16::from(slot.number);
            let supported: u32 = self.read(object, 0).await.map_err(self.refused(object, 0))?;
            if supported & slot.mode.bit() == 0 {
                let (name, mode) = (self.config.name.clone(), slot.mode.name());
                return Err(StartError::Mode { name, mode, supported });
            }
        }
        Ok(())
    }

    async fn assign(&self, assignment: u16, pdos: &[&Pdo]) -> Result<(), StartError> {
        let count = |index| PdoEntry { index, sub: 0, bits: 8 };
        let assigns = match self.write(count(assignment), 0).await {
            Err(Failure::Abort(READ_ONLY)) => false,
            result => result.map(|()| true).map_err(self.refused(assignment, 0))?,
        };
        for pdo in pdos {
            match self.write(count(pdo.index), 0).await {
                Err(Failure::Abort(READ_ONLY)) => continue,
                result => result.map_err(self.refused(pdo.index, 0))?,
            }
            for (sub, entry) in (1..).zip(&pdo.entries) {
                let place = PdoEntry { index: pdo.index, sub, bits: 32 };
                self.write(place, entry.word())
                    .await
                    .map_err(self.unmappable(pdo.index, *entry))?;
            }
            let last = pdo.entries.last().copied().unwrap_or(PdoEntry::of(pdo.index, 0));
            let entries = pdo.entries.len() as u32;
            self.write(count(pdo.index), entries)
                .await
                .map_err(self.unmappable(pdo.index, last))?;
            self.check_read_back(pdo).await?;
        }
        if assigns {
            for (sub, pdo) in (1..).zip(pdos) {
                let place = PdoEntry { index: assignment, sub, bits: 16 };
                let refused = self.refused(assignment, sub);
                self.write(place, u32::from(pdo.index)).await.map_err(refused)?;
            }
            let refused = self.refused(assignment, 0);
            self.write(count(assignment), pdos.len() as u32).await.map_err(refused)?;
        }
        Ok(())
    }

    fn unmappable(&self, pdo: u16, entry: PdoEntry) -> impl Fn(Failure) -> StartError {
        let name = self.config.name.clone();
        move |failure| match failure {
            Failure::Abort(abort) => {
                let (name, object, sub) = (name.clone(), entry.index, entry.sub);
                StartError::Mapping { name, pdo, object, sub, abort }
            }
            Failure::Other(error) => library(&name, pdo, error),
        }
    }

    async fn check_read_back(&self, pdo: &Pdo) -> Result<(), StartError> {
        let found = self.read_entries(pdo.index).await?;
        if found == pdo.entries {
            return Ok(());
        }
        let (found, wanted) = (found.len(), pdo.entries.len());
        Err(StartError::ReadBack { name: self.config.name.clone(), pdo: pdo.index, found, wanted })
    }

    async fn read_entries(&self, pdo: u16) -> Result<Vec<PdoEntry>, StartError> {
        let count: u8 = self.read(pdo, 0).await.map_err(self.refused(pdo, 0))?;
        let mut entries = Vec::new();
        for sub in 1..=count.min(MOST) {
            let word: u32 = self.read(pdo, sub).await.map_err(self.refused(pdo, sub))?;
            entries.push(PdoEntry::of_word(word));
        }
        Ok(entries)
    }

    async fn read_image(&self, assignment: u16) -> Result<Image, StartError> {
        let count: u8 = self.read(assignment, 0).await.map_err(self.refused(assignment, 0))?;
        let mut image = Image::default();
        for sub in 1..=count.min(MOST) {
            let pdo: u16 =
                self.read(assignment, sub).await.map_err(self.refused(assignment, sub))?;
            for entry in self.read_entries(pdo).await? {
                image.push(entry);
            }
        }
        Ok(image)
    }

    /// Asks for synchronisation by SYNC0. The registers decide: drives that leave 1C32:01 at 0 or
    /// have 1C32:02 read-only are synchronised all the same.
    async fn synchronise(&self, cycle_ns: u32) -> Result<(), StartError> {
        for object in [0x1C32, 0x1C33] {
            for (sub, bits, value) in [(1, 16, 2), (2, 32, cycle_ns)] {
                match self.write(PdoEntry { index: object, sub, bits }, value).await {
                    Ok(()) | Err(Failure::Abort(_)) => {}
                    Err(failure) => return Err(self.refused(object, sub)(failure)),
                }
            }
        }
        Ok(())
    }

    /// Checks that what each axis needs is exchanged, and orders its mode where no PDO does.
    async fn check_images(&self, images: &Images) -> Result<(), StartError> {
        for slot in &self.config.slots {
            let offset = 0x800 * u16::from(slot.number);
            let needed_out = [0x6040, slot.mode.target()].map(|object| (&images.outputs, object));
            let needed_in = [(&images.inputs, 0x6041), (&images.inputs, 0x6064)];
            for (image, object) in needed_out.into_iter().chain(needed_in) {
                if image.find(object + offset, 0).is_none() {
                    let name = self.config.name.clone();
                    return Err(StartError::Missing { name, object: object + offset });
                }
            }
            let mode = PdoEntry::of(0x6060 + offset, 8);
            let refused = self.refused(mode.index, 0);
            self.write(mode, u32::from((slot.mode as i8).cast_unsigned()))
                .await
                .map_err(refused)?;
        }
        Ok(())
    }
}

fn library(name: &str, object: u16, error: Error) -> StartError {
    StartError::Library(format!("{name}, {object:04X}: {error}"))
}
