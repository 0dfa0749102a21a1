//! Touch probe: positions at edges of an input or at the index mark, 60B8 to 60BD.
//!
//! ```text
//!   60B8  bit 0 enable, 1 continuous, 2 source (0 input, 1 index), 4 rising, 5 falling; + 8: probe 2
//!   60B9  bit 0 enabled, 1 a rising edge is stored, 2 a falling one; + 8: probe 2
//! ```

/// What passed in a period.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Edges {
    /// Position at which the input rose, and fell.
    pub(crate) input: [Option<i64>; 2],
    /// Position of the index mark, if it passed.
    pub(crate) index: Option<i64>,
}

/// One of the two probes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Probe {
    function: u8,
    stored: [Option<i64>; 2],
}

impl Probe {
    /// Takes its byte of 60B8 and what passed; returns its byte of 60B9.
    pub(crate) fn update(&mut self, function: u8, edges: &Edges) -> u8 {
        if function & 1 == 0 || function != self.function {
            self.stored = [None; 2];
        }
        self.function = function;
        if function & 1 == 0 {
            return 0;
        }
        let is_continuous = function & 2 != 0;
        let seen = if function & 4 == 0 { edges.input } else { [edges.index, None] };
        for (i, place) in self.stored.iter_mut().enumerate() {
            let wanted = function >> (4 + i) & 1 == 1;
            if let (true, Some(position)) = (wanted, seen[i])
                && (is_continuous || place.is_none())
            {
                *place = Some(position);
            }
        }
        1 | u8::from(self.stored[0].is_some()) << 1 | u8::from(self.stored[1].is_some()) << 2
    }

    /// Stored positions: of the rising and of the falling edge.
    pub(crate) fn positions(&self) -> [i64; 2] {
        self.stored.map(Option::unwrap_or_default)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_edge_is_kept_until_the_probe_is_enabled_anew() {
        let mut probe = Probe::default();
        let rise = |at| Edges { input: [Some(at), None], index: None };
        assert_eq!(probe.update(0x11, &Edges::default()), 0x01);
        assert_eq!(probe.update(0x11, &rise(700)), 0x03);
        assert_eq!(probe.update(0x11, &rise(900)), 0x03);
        assert_eq!(probe.positions(), [700, 0]);
        assert_eq!(probe.update(0x10, &rise(901)), 0x00);
        assert_eq!(probe.update(0x11, &rise(902)), 0x03);
        assert_eq!(probe.positions()[0], 902);
    }

    #[test]
    fn a_continuous_probe_keeps_the_newest_index() {
        let mut probe = Probe::default();
        let index = |at| Edges { input: [None; 2], index: Some(at) };
        probe.update(0x17, &index(100));
        assert_eq!(probe.update(0x17, &index(200)), 0x03);
        assert_eq!(probe.positions()[0], 200);
    }
}
