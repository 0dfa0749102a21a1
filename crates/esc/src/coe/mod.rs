//! CANopen over EtherCAT: the object dictionary, and the services by which a mailbox reads and
//! writes it.

mod abort;
mod communication;
mod dictionary;
mod information;
mod mail;
mod pdo;
mod sdo;

pub use abort::Abort;
pub(crate) use communication::{DeviceProfile, Pdo, communication_objects};
pub use dictionary::{
    Access, Allowed, DataType, Dictionary, Handle, Object, ObjectEntry, ObjectKind, ObjectValue,
};
pub(crate) use information::answer as inform;
pub use mail::Emergency;
pub(crate) use mail::{COE, Service, error_reply, finish, parse};
pub(crate) use pdo::{Mapping, RX_ASSIGNMENT, TX_ASSIGNMENT};
pub(crate) use sdo::{Context, Server};
