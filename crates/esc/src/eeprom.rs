//! The EEPROM interface, 0500 to 050F: words of the slave information, read eight bytes at a time.
use crate::memory::Memory;
use crate::registers::{EEPROM_ADDRESS, EEPROM_CONTROL, EEPROM_DATA};

/// Status: eight bytes a read, two address bytes.
const KIND: u16 = 0x00C0;
const WRITE_ENABLE: u16 = 0x0001;
const READ: u16 = 0x0100;
const WRITE: u16 = 0x0200;
const RELOAD: u16 = 0x0400;
/// Any of the three commands.
const COMMANDS: u16 = READ | WRITE | RELOAD;
const COMMAND_ERROR: u16 = 0x2000;

/// The words of an EEPROM.
#[derive(Clone, Debug)]
pub(crate) struct Eeprom {
    words: Vec<u16>,
}

impl Eeprom {
    pub(crate) fn new(words: Vec<u16>) -> Self {
        Self { words }
    }

    fn word(&self, at: u32) -> u16 {
        usize::try_from(at).ok().and_then(|at| self.words.get(at)).copied().unwrap_or(0xFFFF)
    }

    /// Executes what was written to the control register.
    pub(crate) fn execute(&mut self, memory: &mut Memory) {
        let control = memory.u16(EEPROM_CONTROL);
        let at = memory.u32(EEPROM_ADDRESS);
        let mut status = KIND;
        match control & COMMANDS {
            0 => {}
            READ | RELOAD => {
                let words: [u16; 4] = std::array::from_fn(|i| self.word(at.wrapping_add(i as u32)));
                for (i, word) in (0_u16..).zip(words) {
                    memory.set(EEPROM_DATA + 2 * i, &word.to_le_bytes());
                }
            }
            WRITE if control & WRITE_ENABLE != 0 => {
                let word = memory.u16(EEPROM_DATA);
                match usize::try_from(at).ok().and_then(|at| self.words.get_mut(at)) {
                    Some(place) => *place = word,
                    None => status |= COMMAND_ERROR,
                }
            }
            _ => status |= COMMAND_ERROR,
        }
        memory.set(EEPROM_CONTROL, &status.to_le_bytes());
    }
}
