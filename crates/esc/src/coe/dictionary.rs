//! The object dictionary as a table: objects in the order of their index, entries in the order of
//! their subindex.
use super::Abort;
use crate::al::AlState;

/// Kind of a value (ETG.1000.6, table 64).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names are their meaning
pub enum DataType {
    I8,
    I16,
    I32,
    U8,
    U16,
    U32,
    Text,
}

impl DataType {
    /// Code of the type in the services for SDO information.
    pub fn code(self) -> u16 {
        match self {
            Self::I8 => 0x02,
            Self::I16 => 0x03,
            Self::I32 => 0x04,
            Self::U8 => 0x05,
            Self::U16 => 0x06,
            Self::U32 => 0x07,
            Self::Text => 0x09,
        }
    }

    /// Bytes of a value; 0 for a text, whose own length it is.
    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 => 4,
            Self::Text => 0,
        }
    }

    fn is_signed(self) -> bool {
        matches!(self, Self::I8 | Self::I16 | Self::I32)
    }

    /// Returns the number that little-endian bytes are.
    pub(crate) fn number(self, bytes: &[u8]) -> i64 {
        let mut whole = [0; 8];
        let used = bytes.len().min(8);
        whole[..used].copy_from_slice(&bytes[..used]);
        let raw = i64::from_le_bytes(whole);
        match bytes.last() {
            Some(last) if self.is_signed() && last & 0x80 != 0 && used < 8 => {
                raw - (1 << (8 * used))
            }
            _ => raw,
        }
    }
}

/// Who may do what with an entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// It can be written in this state and below; `None` never.
    pub write_up_to: Option<AlState>,
    /// It can be mapped into an RxPDO, which the master sends.
    pub rx: bool,
    /// It can be mapped into a TxPDO, which the device sends.
    pub tx: bool,
}

impl Access {
    /// Read-only.
    pub const READ: Self = Self { write_up_to: None, rx: false, tx: false };
    /// Read and written in every state.
    pub const WRITE: Self = Self { write_up_to: Some(AlState::Op), rx: false, tx: false };
    /// Read, and written in PRE-OP.
    pub const CONFIGURE: Self = Self { write_up_to: Some(AlState::PreOp), rx: false, tx: false };
    /// A setpoint: written, and received.
    pub const SETPOINT: Self = Self { write_up_to: Some(AlState::Op), rx: true, tx: false };
    /// A measured value: read, and sent.
    pub const ACTUAL: Self = Self { write_up_to: None, rx: false, tx: true };

    fn can_write_in(self, state: AlState) -> bool {
        self.write_up_to.is_some_and(|most| state <= most)
    }

    /// Bits of the entry description: read and write in the three states, mappable (ETG.1000.6,
    /// table 45).
    pub(crate) fn bits(self) -> u16 {
        let write = |state, bit: u16| if self.can_write_in(state) { bit } else { 0 };
        0x0007
            | write(AlState::PreOp, 0x08)
            | write(AlState::SafeOp, 0x10)
            | write(AlState::Op, 0x20)
            | u16::from(self.rx) << 6
            | u16::from(self.tx) << 7
    }
}

/// Values that an entry takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// All of its type.
    Any,
    /// From one to another, both of them too.
    Between(i64, i64),
    /// These alone.
    OneOf(&'static [i64]),
}

impl Allowed {
    fn has(self, value: i64) -> bool {
        match self {
            Self::Any => true,
            Self::Between(least, most) => (least..=most).contains(&value),
            Self::OneOf(values) => values.contains(&value),
        }
    }
}

/// A value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ObjectValue {
    /// A number, as wide as its type.
    Number(i64),
    /// A text.
    Text(&'static str),
}

/// An entry of an object.
#[derive(Clone, Debug)]
pub struct ObjectEntry {
    /// Its subindex within the object.
    pub sub: u8,
    /// Name, for SDO information.
    pub name: &'static str,
    /// Type of its value.
    pub data_type: DataType,
    /// Who may do what with it.
    pub access: Access,
    /// Values that it takes.
    pub allowed: Allowed,
    /// Its value.
    pub value: ObjectValue,
}

impl ObjectEntry {
    /// An entry for a number.
    pub fn number(
        sub: u8,
        name: &'static str,
        data_type: DataType,
        access: Access,
        value: i64,
    ) -> Self {
        Self {
            sub,
            name,
            data_type,
            access,
            allowed: Allowed::Any,
            value: ObjectValue::Number(value),
        }
    }

    /// The same for these values alone.
    #[must_use]
    pub fn allowing(self, allowed: Allowed) -> Self {
        Self { allowed, ..self }
    }

    /// Bits of its value.
    pub fn bits(&self) -> usize {
        match &self.value {
            ObjectValue::Text(text) => text.len() * 8,
            ObjectValue::Number(_) => self.data_type.bytes() * 8,
        }
    }

    /// Appends its value, little endian.
    pub(crate) fn append(&self, into: &mut Vec<u8>) {
        match &self.value {
            ObjectValue::Text(text) => into.extend(text.bytes()),
            ObjectValue::Number(number) => {
                into.extend_from_slice(&number.to_le_bytes()[..self.data_type.bytes()]);
            }
        }
    }
}

/// Kind of an object (ETG.1000.6, table 65).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum ObjectKind {
    /// A single value.
    Variable = 7,
    /// Entries of the same type after a count.
    Array = 8,
    /// Entries of several types after a count.
    Record = 9,
}

/// An object.
#[derive(Clone, Debug)]
pub struct Object {
    /// Index.
    pub index: u16,
    /// Kind.
    pub kind: ObjectKind,
    /// Name, for SDO information.
    pub name: &'static str,
    /// Entries, in the order of their subindex.
    pub entries: Vec<ObjectEntry>,
}

impl Object {
    /// A single number.
    pub fn variable(
        index: u16,
        name: &'static str,
        data_type: DataType,
        access: Access,
        value: i64,
    ) -> Self {
        let entries = vec![ObjectEntry::number(0, name, data_type, access, value)];
        Self { index, kind: ObjectKind::Variable, name, entries }
    }

    /// A text.
    pub fn text(index: u16, name: &'static str, text: &'static str) -> Self {
        let value = ObjectValue::Text(text);
        let (data_type, access, allowed) = (DataType::Text, Access::READ, Allowed::Any);
        let entries = vec![ObjectEntry { sub: 0, name, data_type, access, allowed, value }];
        Self { index, kind: ObjectKind::Variable, name, entries }
    }

    /// A record, whose subindex 0 is the number of its entries.
    pub fn record(index: u16, name: &'static str, entries: Vec<ObjectEntry>) -> Self {
        let last = entries.last().map_or(0, |entry| i64::from(entry.sub));
        Self::counted(index, ObjectKind::Record, name, last, Access::READ, entries)
    }

    /// An object with its count at subindex 0.
    pub fn counted(
        index: u16,
        kind: ObjectKind,
        name: &'static str,
        count: i64,
        access: Access,
        entries: Vec<ObjectEntry>,
    ) -> Self {
        let count = ObjectEntry::number(0, "Number of entries", DataType::U8, access, count);
        Self { index, kind, name, entries: [vec![count], entries].concat() }
    }

    /// Restricts the values of a single number.
    #[must_use]
    pub fn allowing(mut self, allowed: Allowed) -> Self {
        for entry in &mut self.entries {
            entry.allowed = allowed;
        }
        self
    }

    /// The entry of a subindex.
    pub fn entry(&self, sub: u8) -> Option<&ObjectEntry> {
        self.entries.iter().find(|entry| entry.sub == sub)
    }
}

/// Place of an entry in a dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handle {
    object: u16,
    entry: u16,
}

/// The objects of a device.
#[derive(Clone, Debug, Default)]
pub struct Dictionary {
    objects: Vec<Object>,
}

impl Dictionary {
    /// Makes a dictionary of objects in any order; of two with one index, the later one counts.
    pub fn new(objects: impl IntoIterator<Item = Object>) -> Self {
        let mut sorted: Vec<Object> = Vec::new();
        for object in objects {
            match sorted.binary_search_by_key(&object.index, |o| o.index) {
                Ok(at) => sorted[at] = object,
                Err(at) => sorted.insert(at, object),
            }
        }
        Self { objects: sorted }
    }

    /// All objects, in order.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The object of an index.
    pub fn object(&self, index: u16) -> Option<&Object> {
        let at = self.objects.binary_search_by_key(&index, |object| object.index).ok()?;
        self.objects.get(at)
    }

    pub(crate) fn object_mut(&mut self, index: u16) -> Option<&mut Object> {
        let at = self.objects.binary_search_by_key(&index, |object| object.index).ok()?;
        self.objects.get_mut(at)
    }

    /// Place of an entry.
    pub fn find(&self, index: u16, sub: u8) -> Option<Handle> {
        let object = self.objects.binary_search_by_key(&index, |object| object.index).ok()?;
        let entry = self.objects[object].entries.iter().position(|entry| entry.sub == sub)?;
        Some(Handle { object: u16::try_from(object).ok()?, entry: u16::try_from(entry).ok()? })
    }

    /// The entry at a place.
    pub fn at(&self, handle: Handle) -> Option<&ObjectEntry> {
        self.objects.get(usize::from(handle.object))?.entries.get(usize::from(handle.entry))
    }

    /// Number at a place; 0 where there is none.
    pub fn get(&self, handle: Handle) -> i64 {
        match self.at(handle).map(|entry| &entry.value) {
            Some(ObjectValue::Number(number)) => *number,
            _ => 0,
        }
    }

    /// Sets the number at a place, whatever its access says: the device's own way.
    pub fn set(&mut self, handle: Handle, number: i64) {
        let object = self.objects.get_mut(usize::from(handle.object));
        let entry = object.and_then(|object| object.entries.get_mut(usize::from(handle.entry)));
        if let Some(ObjectEntry { value: ObjectValue::Number(place), .. }) = entry {
            *place = number;
        }
    }

    /// Number of an entry; `None` where there is none.
    pub fn number(&self, index: u16, sub: u8) -> Option<i64> {
        self.find(index, sub).map(|handle| self.get(handle))
    }

    /// Sets the number of an entry, where there is one.
    pub fn put(&mut self, index: u16, sub: u8, number: i64) {
        if let Some(handle) = self.find(index, sub) {
            self.set(handle, number);
        }
    }

    /// Returns the entry of an index and subindex, or which of the two there is not.
    pub(crate) fn entry(&self, index: u16, sub: u8) -> Result<&ObjectEntry, Abort> {
        self.object(index).ok_or(Abort::NoObject)?.entry(sub).ok_or(Abort::NoSubindex)
    }

    /// Checks what is written to an entry, and returns its number.
    pub(crate) fn check(
        &self,
        index: u16,
        sub: u8,
        data: &[u8],
        state: AlState,
    ) -> Result<i64, Abort> {
        let entry = self.entry(index, sub)?;
        match entry.access.write_up_to {
            None => return Err(Abort::ReadOnly),
            Some(most) if state > most => return Err(Abort::State),
            Some(_) => {}
        }
        match data.len().cmp(&entry.data_type.bytes()) {
            std::cmp::Ordering::Greater => return Err(Abort::TooLong),
            std::cmp::Ordering::Less => return Err(Abort::TooShort),
            std::cmp::Ordering::Equal => {}
        }
        let number = entry.data_type.number(data);
        if entry.allowed.has(number) { Ok(number) } else { Err(Abort::Range) }
    }
}
