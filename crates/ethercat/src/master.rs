//! The master: storage for its frames, and the start of a network.
use crate::bus::Bus;
use crate::error::StartError;
use crate::exchange::Exchange;
use crate::link::FrameLink;
use crate::network::Network;
use crate::scan::{MOST_IMAGE, failed, find_refusal, prepare, scan};
use core::future::Future;
use core::time::Duration;
use ethercrab::{MainDevice, MainDeviceConfig, PduStorage, RetryBehaviour, Timeouts};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Frames that can be on their way at once.
const FRAMES: usize = 16;
/// Bytes of the datagrams of a frame.
const FRAME_BYTES: usize = 1486;
/// How long a start may take in all, ns.
const MOST_START_NS: u64 = 60_000_000_000;
/// Times that the cycle may have, ns.
const CYCLES_NS: core::ops::RangeInclusive<u32> = 62_500..=10_000_000;

/// Storage for frames; of one master, for as long as that lives.
pub struct Storage(PduStorage<FRAMES, { PduStorage::element_size(FRAME_BYTES) }>);

impl Storage {
    /// Makes storage for 16 frames.
    pub fn new() -> Self {
        Self(PduStorage::new())
    }
}

impl Default for Storage {
    fn default() -> Self {
        Self::new()
    }
}

/// A master.
pub struct Master<'s> {
    main: MainDevice<'s>,
    exchange: Exchange<'s>,
    network: &'s Network,
}

impl<'s> Master<'s> {
    /// Makes a master of a network; `None` if the storage is another one's already.
    pub fn new(storage: &'s Storage, network: &'s Network) -> Option<Self> {
        let (tx, rx, pdus) = storage.0.try_split().ok()?;
        let timeouts = Timeouts {
            state_transition: Duration::from_secs(2),
            pdu: Duration::from_millis(20),
            eeprom: Duration::from_millis(50),
            wait_loop_delay: Duration::from_micros(200),
            mailbox_echo: Duration::from_millis(200),
            mailbox_response: Duration::from_secs(1),
        };
        let config = MainDeviceConfig {
            dc_static_sync_iterations: network.clock_frames,
            retry_behaviour: RetryBehaviour::Count(3),
        };
        let main = MainDevice::new(pdus, timeouts, config);
        Some(Self { main, exchange: Exchange::new(tx, rx), network })
    }

    /// Brings the network from whatever state it is in to OP.
    ///
    /// # Errors
    /// If it is not the network that is expected, or a device refuses what is wanted of it.
    pub fn start(&mut self, link: &mut impl FrameLink) -> Result<Bus<'_, 's>, StartError> {
        let Self { main, exchange, network } = self;
        let network: &Network = network;
        let Network { cycle_ns, lead_ns, .. } = *network;
        if !CYCLES_NS.contains(&cycle_ns) || lead_ns >= cycle_ns {
            return Err(StartError::Times { cycle_ns, lead_ns });
        }
        let until_ns = link.now_ns() + MOST_START_NS;
        exchange.mailboxes.clear();
        let (echoes, emergencies) = (exchange.losses.echoes, exchange.emergency_count);
        let scanned = guarded(exchange, link, scan(main, network), until_ns).map_err(|error| {
            let echoes = exchange.losses.echoes - echoes;
            if error == StartError::NoAnswer && echoes > 0 {
                StartError::Echoes { echoes }
            } else {
                error
            }
        })?;
        exchange.mailboxes.clone_from(&scanned.mailboxes);
        let prepared = guarded(exchange, link, prepare(main, scanned, network), until_ns);
        let prepared = match prepared {
            Ok(prepared) => prepared,
            Err(StartError::Library(text)) => {
                let refusal = guarded(
                    exchange,
                    link,
                    async { Ok(find_refusal(main, network).await) },
                    until_ns,
                );
                if let Ok(Some(refusal)) = refusal {
                    return Err(refusal);
                }
                let unasked = exchange.emergencies().get(emergencies).copied();
                return Err(unasked.map_or(StartError::Library(text), |emergency| {
                    let at = usize::from(emergency.station.wrapping_sub(0x1000));
                    let name = network.devices.get(at).map(|device| device.name.clone());
                    StartError::Emergency {
                        name: name.unwrap_or_default(),
                        code: emergency.code,
                        register: emergency.register,
                    }
                }));
            }
            Err(error) => return Err(error),
        };
        let bytes = prepared.images.iter().map(|i| i.outputs.bytes() + i.inputs.bytes()).sum();
        if bytes > MOST_IMAGE {
            return Err(StartError::Image { bytes, most: MOST_IMAGE });
        }
        let request = async {
            let requested = Box::pin(prepared.group.request_into_op(main)).await;
            requested.map_err(failed("on the way to OP"))
        };
        let group = guarded(exchange, link, request, until_ns)?;
        let mut bus = Bus::new(main, exchange, group, &prepared.images, network, link.now_ns());
        bus.reach_op(link, network)?;
        Ok(bus)
    }
}

/// Runs a part of the start. `ethercrab` 0.7.1 has assertions that devices can violate (a topology
/// that cannot be, an EEPROM whose categories overflow); at the start, where nothing moves, such an
/// end is an error like any other.
fn guarded<T>(
    exchange: &mut Exchange<'_>,
    link: &mut impl FrameLink,
    part: impl Future<Output = Result<T, StartError>>,
    until_ns: u64,
) -> Result<T, StartError> {
    let run = AssertUnwindSafe(|| exchange.run(link, part, until_ns));
    match catch_unwind(run) {
        Ok(Some(result)) => result,
        Ok(None) => {
            Err(StartError::Library(format!("no end after {} s", MOST_START_NS / 1_000_000_000)))
        }
        Err(payload) => {
            let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
            let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
            Err(StartError::Library(text.unwrap_or_else(|| "an assertion".to_owned())))
        }
    }
}
