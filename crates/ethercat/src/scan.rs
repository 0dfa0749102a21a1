//! From an unknown wire to devices in SAFE-OP that are who they have to be.
use crate::clock;
use crate::error::StartError;
use crate::network::{DeviceIdentity, Network, Sync};
use crate::pdo::{Configured, Images};
use core::time::Duration;
use ethercrab::subdevice_group::{DcConfiguration, HasDc, NoDc, PreOp, SafeOp};
use ethercrab::{Command, DcSync, DefaultLock, MainDevice, RegisterAddress, SubDeviceGroup};

/// Most devices on a wire.
pub(crate) const MOST_DEVICES: usize = 32;
/// Most bytes of the process image.
pub(crate) const MOST_IMAGE: usize = 1024;
/// Station address of the first device.
pub(crate) const FIRST_STATION: u16 = 0x1000;
/// EEPROM word: where the device puts its mail.
const SII_MAILBOX: u16 = 0x001A;
/// EEPROM word: what its mailbox is for.
const SII_PROTOCOLS: u16 = 0x001C;
/// Bit of the protocols: an object dictionary.
const COE: u16 = 0x0004;
/// From the configuration of SYNC0 to its first pulse, ns.
const SYNC_DELAY: Duration = Duration::from_millis(100);

/// Devices in a state.
pub(crate) type Group<S, D> = SubDeviceGroup<MOST_DEVICES, MOST_IMAGE, DefaultLock, S, D>;

/// What a scan has found.
pub(crate) struct Scanned {
    pub(crate) group: Group<PreOp, NoDc>,
    /// Mailboxes by position; 0 where there is none.
    pub(crate) mailboxes: Vec<u16>,
    /// There is an object dictionary, by position.
    has_dictionary: Vec<bool>,
}

/// Finds the devices, gives them addresses, and compares them with those that are expected.
pub(crate) async fn scan(main: &MainDevice<'_>, network: &Network) -> Result<Scanned, StartError> {
    let count = match Command::brd(RegisterAddress::Type.into()).receive::<u8>(main).await {
        Ok(_) => 1,
        Err(ethercrab::error::Error::WorkingCounter { received, .. }) => received,
        Err(_) => 0,
    };
    if count == 0 {
        return Err(StartError::NoAnswer);
    }
    let group = Box::pin(main.init_single_group::<MOST_DEVICES, MOST_IMAGE>(clock::now_ns))
        .await
        .map_err(failed("while the devices were found"))?;
    let (found, wanted) = (group.len(), network.devices.len());
    if found != wanted {
        return Err(StartError::Count { found, wanted });
    }
    let mut mailboxes = Vec::with_capacity(found);
    let mut has_dictionary = Vec::with_capacity(found);
    for (position, (device, config)) in group.iter(main).zip(&network.devices).enumerate() {
        let own = device.identity();
        let found = DeviceIdentity { vendor: own.vendor_id, product: own.product_id };
        if let Some(wanted) = config.identity.filter(|wanted| *wanted != found) {
            let name = config.name.clone();
            return Err(StartError::Identity { position, name, found, wanted });
        }
        if config.sync != Sync::Free && !device.dc_support().any() {
            return Err(StartError::NoClock { name: config.name.clone() });
        }
        let read = failed("while an EEPROM was read");
        let protocols: u16 = device.eeprom_read(main, SII_PROTOCOLS).await.map_err(&read)?;
        let mailbox: u16 = device.eeprom_read(main, SII_MAILBOX).await.map_err(&read)?;
        has_dictionary.push(protocols & COE != 0);
        mailboxes.push(if protocols == 0 { 0 } else { mailbox });
    }
    Ok(Scanned { group, mailboxes, has_dictionary })
}

/// Devices that are configured.
pub(crate) struct Prepared {
    pub(crate) group: Group<SafeOp, HasDc>,
    pub(crate) images: Vec<Images>,
}

/// Configures the devices and brings them to SAFE-OP.
pub(crate) async fn prepare(
    main: &MainDevice<'_>,
    scanned: Scanned,
    network: &Network,
) -> Result<Prepared, StartError> {
    let Scanned { mut group, has_dictionary, .. } = scanned;
    let mut images = Vec::new();
    let devices = group.iter(main).zip(&network.devices).zip(has_dictionary);
    for ((remote, config), has_dictionary) in devices {
        let configured = Configured { remote: &remote, config };
        let image =
            if has_dictionary { configured.configure(network).await? } else { Images::default() };
        images.push(image);
    }
    for (mut device, config) in group.iter_mut(main).zip(&network.devices) {
        device.set_dc_sync(match config.sync {
            Sync::Free => DcSync::Disabled,
            Sync::Sync0 => DcSync::Sync0,
            Sync::Sync01 { after_ns } => {
                DcSync::Sync01 { sync1_period: Duration::from_nanos(u64::from(after_ns)) }
            }
        });
    }
    let group =
        Box::pin(group.into_pre_op_pdi(main)).await.map_err(failed("while the image was made"))?;
    let clock = DcConfiguration {
        start_delay: SYNC_DELAY,
        sync0_period: Duration::from_nanos(u64::from(network.cycle_ns)),
        sync0_shift: Duration::ZERO,
    };
    let group =
        Box::pin(group.configure_dc_sync(main, clock)).await.map_err(|error| match error {
            ethercrab::error::Error::DistributedClock(_) => StartError::NoReference,
            other => failed("while SYNC0 was set up")(other),
        })?;
    let group =
        Box::pin(group.into_safe_op(main)).await.map_err(failed("on the way to SAFE-OP"))?;
    Ok(Prepared { group, images })
}

/// Returns which device has refused a state, if one has.
pub(crate) async fn find_refusal(main: &MainDevice<'_>, network: &Network) -> Option<StartError> {
    for (station, device) in (FIRST_STATION..).zip(&network.devices) {
        let status: u16 = read(main, station, RegisterAddress::AlStatus).await?;
        if status & 0x10 == 0 {
            continue;
        }
        let code: u16 = read(main, station, RegisterAddress::AlStatusCode).await?;
        let state = match status & 0x0F {
            1 => "INIT",
            2 => "PRE-OP",
            4 => "SAFE-OP",
            8 => "OP",
            _ => "an unknown state",
        };
        let text = ethercrab::AlStatusCode::from(code).to_string();
        return Some(StartError::Refused { name: device.name.clone(), state, code, text });
    }
    None
}

async fn read(main: &MainDevice<'_>, station: u16, register: RegisterAddress) -> Option<u16> {
    Command::fprd(station, register.into()).receive(main).await.ok()
}

pub(crate) fn failed(when: &'static str) -> impl Fn(ethercrab::error::Error) -> StartError {
    move |error| StartError::Library(format!("{error}, {when}"))
}
