//! Numbers, names and gears as bytes, little-endian.
use super::{Geared, LONGEST_COMMAND, MOST_WORDS};
use units::{Angle, Lead, Length};

/// Appends.
#[derive(Debug, Default)]
pub(super) struct Writer(Vec<u8>);

impl Writer {
    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    pub(super) fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub(super) fn u16(&mut self, value: u16) {
        self.bytes(&value.to_le_bytes());
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    pub(super) fn u64(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.bytes(&value.to_le_bytes());
    }

    /// Cut to so many bytes, between two characters.
    pub(super) fn name(&mut self, name: &str, longest: usize) {
        let cut = (0..=name.len().min(longest)).rev().find(|at| name.is_char_boundary(*at));
        let name = &name[..cut.unwrap_or(0)];
        self.u16(name.len() as u16);
        self.bytes(name.as_bytes());
    }

    /// None of them, where they are too many to be kept.
    pub(super) fn words(&mut self, words: &[String]) {
        let fits = words.len() <= MOST_WORDS
            && words.iter().map(String::len).sum::<usize>() <= LONGEST_COMMAND
            && words.iter().all(|word| word.len() <= super::LONGEST_NAME);
        let words = if fits { words } else { &[] };
        self.u8(words.len() as u8);
        for word in words {
            self.name(word, super::LONGEST_NAME);
        }
    }

    pub(super) fn geared(&mut self, geared: Option<&Geared>) {
        self.u8(u8::from(geared.is_some()));
        let Some(geared) = geared else { return };
        self.u8(geared.follower);
        self.bytes(&geared.turns.to_le_bytes());
        self.bytes(&geared.master_turns.to_le_bytes());
        self.f64(geared.phase.value());
        let (axis, lead) = geared.axis.unwrap_or((u8::MAX, Lead::ZERO));
        self.u8(axis);
        self.f64(lead.value());
        self.f64(geared.radius.value());
        self.f64(geared.swing_turns);
        let terms = &geared.swing[..geared.swing.len().min(Geared::MOST_TERMS)];
        self.u8(terms.len() as u8);
        for (period, cosine, sine) in terms {
            self.u32(*period);
            self.f64(*cosine);
            self.f64(*sine);
        }
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }
}

/// Takes off the front; `None` once there is too little.
#[derive(Debug)]
pub(super) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn i32(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    pub(super) fn words(&mut self) -> Option<Vec<String>> {
        let count = usize::from(self.u8()?);
        if count > MOST_WORDS {
            return None;
        }
        (0..count).map(|_| self.name()).collect()
    }

    /// `None`: no gear can be read; that there is none is something else.
    #[allow(clippy::option_option)] // as said
    pub(super) fn geared(&mut self) -> Option<Option<Geared>> {
        match self.u8()? {
            0 => return Some(None),
            1 => {}
            _ => return None,
        }
        let (follower, turns, master_turns) = (self.u8()?, self.i32()?, self.i32()?);
        let phase = Angle::rev(self.f64()?);
        let (axis, lead) = (self.u8()?, Lead::mm_per_rev(self.f64()?));
        let (radius, swing_turns) = (Length::mm(self.f64()?), self.f64()?);
        let count = usize::from(self.u8()?);
        if count > Geared::MOST_TERMS {
            return None;
        }
        let swing = (0..count).map(|_| Some((self.u32()?, self.f64()?, self.f64()?)));
        let swing = swing.collect::<Option<Vec<_>>>()?;
        let axis = (axis != u8::MAX).then_some((axis, lead));
        Some(Some(Geared {
            follower,
            turns,
            master_turns,
            phase,
            axis,
            radius,
            swing,
            swing_turns,
        }))
    }

    pub(super) fn name(&mut self) -> Option<String> {
        let length = usize::from(self.u16()?);
        if length > super::LONGEST_NAME {
            return None;
        }
        let (name, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        String::from_utf8(name.to_vec()).ok()
    }
}
