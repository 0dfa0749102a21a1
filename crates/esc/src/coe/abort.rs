//! Why a service data object was refused (ETG.1000.6, table 41).

/// Abort code of an SDO transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Abort {
    /// The toggle bit has not changed.
    Toggle = 0x0503_0000,
    /// There is no such command.
    Command = 0x0504_0001,
    /// The object cannot be accessed so: no complete access.
    Unsupported = 0x0601_0000,
    /// It cannot be read.
    WriteOnly = 0x0601_0001,
    /// It cannot be written.
    ReadOnly = 0x0601_0002,
    /// A subindex can only be written while subindex 0 is 0.
    SubindexZeroFirst = 0x0601_0003,
    /// There is no such object.
    NoObject = 0x0602_0000,
    /// It cannot be mapped into a PDO.
    NotMappable = 0x0604_0041,
    /// The PDO would be too long.
    PdoTooLong = 0x0604_0042,
    /// The length is another one.
    Length = 0x0607_0010,
    /// The value is too long.
    TooLong = 0x0607_0012,
    /// The value is too short.
    TooShort = 0x0607_0013,
    /// There is no such subindex.
    NoSubindex = 0x0609_0011,
    /// The value is not one of those that can be.
    Range = 0x0609_0030,
    /// It cannot be in this state of the device.
    State = 0x0800_0022,
}
