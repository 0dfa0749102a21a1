//! How real devices differ from what the standards have: each is a switch.

/// What is different about a device. The default is a device as the standards have it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools)] // each is a switch of its own
pub struct Quirks {
    /// Complete access is refused (abort `0601_0000`).
    pub no_complete_access: bool,
    /// Subindex 0 of a complete access is 8 bits wide and not padded to 16.
    pub unpadded_complete_access: bool,
    /// There is no service for SDO information.
    pub no_sdo_information: bool,
    /// The mapping objects are read-only (abort `0601_0002`).
    pub fixed_mapping: bool,
    /// The assignment objects are read-only (abort `0601_0002`).
    pub fixed_assignment: bool,
    /// A single TxPDO can be assigned, with at most this number of entries.
    pub one_tx_pdo_of: Option<u8>,
    /// Cyclic synchronous velocity is not supported.
    pub no_csv: bool,
    /// Cyclic synchronous torque is not supported.
    pub no_cst: bool,
    /// The actual torque, 6077, is read by SDO only: a mapping of it is refused.
    pub torque_by_sdo_only: bool,
    /// The synchronisation type, 1C32:01, reads as 0 whatever is in force.
    pub sync_type_reads_zero: bool,
    /// The cycle time, 1C32:02, is read-only.
    pub sync_period_read_only: bool,
    /// The positive software limit, 607D:02, does not exist.
    pub no_positive_software_limit: bool,
    /// Nothing is assigned to the TxPDO sync manager, and nothing can be.
    pub rx_pdo_alone: bool,
    /// 1C00 gives the two process data sync managers the wrong way round.
    pub wrong_sync_manager_types: bool,
    /// The bits of 0981 that have to be set (the high byte of `AssignActivate`); 0: 03.
    pub sync_activation: u8,
    /// 0980 is read-only: a write to it is not counted.
    pub no_cyclic_unit_control: bool,
    /// The first device leaves bit 02 of the source address as it was.
    pub source_address_kept: bool,
    /// An emergency is in the mailbox as soon as PRE-OP is reached.
    pub emergency_at_start: bool,
    /// Dynamic synchronisation is not supported: no distributed clock.
    pub no_clock: bool,
}
