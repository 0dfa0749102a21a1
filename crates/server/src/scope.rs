//! Binary frames of signals: every row of the servo rate, as columns of 32-bit floats.
//!
//! ```text
//!  0        4                4+n           4+n+4·rows
//!  │ n: u32 │ header, n bytes │ signal 0    │ signal 1 … │     little endian
//! ```
use control::operation::hosted::{Client, Recorded, SignalRows};
use serde_json::json;
use std::sync::Arc;

/// Signals of a client.
const MOST_SIGNALS: usize = 16;

/// What a client has asked to see.
pub(crate) struct Scope {
    recorded: Recorded,
    names: Vec<String>,
    columns: Vec<usize>,
    /// The next row; `None`: whichever comes first.
    next: Option<u64>,
    period_s: f64,
}

impl Scope {
    /// Of signals by their names; `None`: of none.
    ///
    /// # Errors
    /// There is no such signal, or there are too many.
    pub(crate) fn of(client: &Client, names: Vec<String>) -> Result<Option<Self>, String> {
        if names.len() > MOST_SIGNALS {
            return Err(format!(
                "a scope shows {MOST_SIGNALS} signals at most, found {}",
                names.len()
            ));
        }
        let all = client.signals().names();
        let columns: Option<Vec<_>> =
            names.iter().map(|name| all.iter().position(|known| known == name)).collect();
        let columns = columns.ok_or_else(|| {
            let unknown = names.iter().find(|name| !all.contains(name));
            let unknown: String = unknown.map(|n| n.chars().take(40).collect()).unwrap_or_default();
            format!("there is no signal \"{unknown}\": GET machine lists them")
        })?;
        if columns.is_empty() {
            return Ok(None);
        }
        let period_s = client.machine().control.period.value();
        Ok(Some(Self { recorded: client.record(), names, columns, next: None, period_s }))
    }

    /// A frame of the rows that are new; `None`: there are none.
    pub(crate) fn frame(&mut self) -> Option<Vec<u8>> {
        let blocks = self.recorded.rows_from(self.next.unwrap_or(0));
        let first = blocks.first()?;
        let lost = self.next.map_or(0, |next| first.first.saturating_sub(next));
        // rows that do not follow one another are not shown as if they did
        let mut end = first.first;
        let follow: Vec<&Arc<SignalRows>> = blocks
            .iter()
            .take_while(|rows| {
                let is_next = rows.first == end;
                end = if is_next { rows.first + rows.count() as u64 } else { end };
                is_next
            })
            .collect();
        self.next = Some(end);
        Some(frame(&follow, &self.names, &self.columns, self.period_s, lost))
    }
}

fn frame(
    blocks: &[&Arc<SignalRows>],
    names: &[String],
    columns: &[usize],
    period_s: f64,
    lost: u64,
) -> Vec<u8> {
    let rows: usize = blocks.iter().map(|block| block.count()).sum();
    let start_s = blocks.first().map_or(0.0, |block| block.start_s);
    let mut header = json!({
        "rows": rows, "start_s": start_s, "period_s": period_s, "signals": names, "lost_rows": lost,
    })
    .to_string();
    while !header.len().is_multiple_of(4) {
        header.push(' ');
    }
    let mut bytes = Vec::with_capacity(4 + header.len() + 4 * rows * columns.len());
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.as_bytes());
    for column in columns {
        for block in blocks {
            for row in block.values.chunks_exact(block.width.max(1)) {
                bytes.extend(row.get(*column).copied().unwrap_or(f32::NAN).to_le_bytes());
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_the_columns_that_were_asked_for_in_their_order() {
        let block = |first, values: &[f32]| {
            Arc::new(SignalRows { first, start_s: 2.0, values: values.to_vec(), width: 3 })
        };
        let (a, b) = (block(7, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), block(9, &[7.0, 8.0, 9.0]));
        let names = ["c".to_owned(), "a".to_owned()];
        let bytes = frame(&[&a, &b], &names, &[2, 0], 0.001, 4);
        let n = u32::from_le_bytes(bytes[..4].try_into().expect("four")) as usize;
        assert!(n.is_multiple_of(4));
        let header: serde_json::Value = serde_json::from_slice(&bytes[4..4 + n]).expect("JSON");
        assert_eq!(header["rows"], 3);
        assert_eq!(header["lost_rows"], 4);
        let values: Vec<f32> = bytes[4 + n..]
            .chunks_exact(4)
            .map(|four| f32::from_le_bytes(four.try_into().expect("four")))
            .collect();
        assert_eq!(values, [3.0, 6.0, 9.0, 1.0, 4.0, 7.0]);
    }
}
