//! A row as a message in Protocol Buffers, and the descriptor that names its fields.
//!
//! ```text
//!   field of a message   key = number << 3 | kind, then: varint (0), 8 bytes little endian (1), length and bytes (2)
//!   descriptor           FileDescriptorSet { file { name, package, message { name, field { name, number, label, type } }, syntax } }
//! ```
//!
//! After the encoding and `descriptor.proto` of protobuf.dev. What has no value is NaN: readers
//! that draw leave it out, and take a field that is not there for 0. Names of fields have letters,
//! digits and `_` alone: `X.setpoint_mm` is `X_setpoint_mm`.

const VARINT: u32 = 0;
const EIGHT_BYTES: u32 = 1;
const BYTES: u32 = 2;

/// Numbers of types in a descriptor.
const DOUBLE: u64 = 1;
const STRING: u64 = 9;
const UINT32: u64 = 13;
const OPTIONAL: u64 = 1;

/// Fields of a row, and the memory in which one is written.
pub(super) struct PeriodMessage {
    numbers: Vec<String>,
    line: Option<u32>,
    state: Option<u32>,
    bytes: Vec<u8>,
}

impl PeriodMessage {
    /// With these columns.
    pub(super) fn new(numbers: &[String], has_line: bool, has_state: bool) -> Self {
        let line = numbers.len() as u32 + 1;
        Self {
            numbers: numbers.iter().map(|name| field_name(name)).collect(),
            line: has_line.then_some(line),
            state: has_state.then_some(line + 1),
            bytes: Vec::new(),
        }
    }

    /// A message.
    pub(super) fn write(
        &mut self,
        numbers: impl Iterator<Item = f64>,
        line: Option<u32>,
        state: Option<&str>,
    ) -> &[u8] {
        self.bytes.clear();
        for (number, value) in (1..).zip(numbers) {
            key(&mut self.bytes, number, EIGHT_BYTES);
            self.bytes.extend(value.to_le_bytes());
        }
        if let (Some(number), Some(line)) = (self.line, line) {
            key(&mut self.bytes, number, VARINT);
            varint(&mut self.bytes, line.into());
        }
        if let (Some(number), Some(state)) = (self.state, state) {
            bytes(&mut self.bytes, number, state.as_bytes());
        }
        &self.bytes
    }
}

fn field_name(column: &str) -> String {
    let name: String =
        column.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("f{name}") }
}

/// What a reader needs to read such a row: `package.Name` is the message.
pub(super) fn descriptor(message: &str, row: &PeriodMessage) -> Vec<u8> {
    let (package, name) = message.rsplit_once('.').unwrap_or(("", message));
    let mut body = Vec::new();
    bytes(&mut body, 1, name.as_bytes());
    let numbers = (1..).zip(&row.numbers).map(|(number, name)| (number, name.as_str(), DOUBLE));
    let line = row.line.map(|number| (number, "line", UINT32));
    let state = row.state.map(|number| (number, "state", STRING));
    for (number, name, kind) in numbers.chain(line).chain(state) {
        let mut field = Vec::new();
        bytes(&mut field, 1, name.as_bytes());
        for (part, value) in [(3, u64::from(number)), (4, OPTIONAL), (5, kind)] {
            key(&mut field, part, VARINT);
            varint(&mut field, value);
        }
        bytes(&mut body, 2, &field);
    }
    let mut file = Vec::new();
    bytes(&mut file, 1, b"leadscrew.proto");
    bytes(&mut file, 2, package.as_bytes());
    bytes(&mut file, 4, &body);
    bytes(&mut file, 12, b"proto3");
    let mut set = Vec::new();
    bytes(&mut set, 1, &file);
    set
}

fn key(out: &mut Vec<u8>, number: u32, kind: u32) {
    varint(out, u64::from(number << 3 | kind));
}

fn bytes(out: &mut Vec<u8>, number: u32, value: &[u8]) {
    key(out, number, BYTES);
    varint(out, value.len() as u64);
    out.extend(value);
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_what_the_encoding_of_protocol_buffers_says() {
        let mut row = PeriodMessage::new(&["time_s".into(), "X.setpoint_mm".into()], true, true);
        let written = row.write([1.0, -2.5].into_iter(), Some(300), Some("tap-in")).to_vec();
        let mut expected = vec![0x09];
        expected.extend(1.0_f64.to_le_bytes());
        expected.push(0x11);
        expected.extend((-2.5_f64).to_le_bytes());
        expected.extend([0x18, 0xAC, 0x02, 0x22, 6]); // 300 is the example of protobuf.dev, 150 · 2
        expected.extend(b"tap-in");
        assert_eq!(written, expected);
    }

    #[test]
    fn names_of_fields_are_names_in_every_language() {
        assert_eq!(field_name("X.setpoint_mm"), "X_setpoint_mm");
        assert_eq!(field_name("0.a"), "f0_a");
    }
}
