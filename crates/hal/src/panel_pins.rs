//! Pins of a panel beside the machine, and of a door that inhibits the feed.
use crate::driven::DrivenPin;
use crate::ffi::{Hal, Pin};
use crate::new_pin::input;
use bus::{Panel, WatchedInput, WatchedInputs};

/// See the module's header.
#[derive(Debug)]
pub(crate) struct PanelPins {
    feed_inhibit: DrivenPin,
    hold: DrivenPin,
    stop: DrivenPin,
    cycle_start: Pin<bool>,
    reset: Pin<bool>,
    single_block: Pin<bool>,
}

impl PanelPins {
    pub(crate) fn new(hal: &Hal) -> Result<Self, String> {
        Ok(Self {
            feed_inhibit: DrivenPin::new(hal, "feed-inhibit")?,
            hold: DrivenPin::new(hal, "hold")?,
            stop: DrivenPin::new(hal, "stop")?,
            cycle_start: input(hal, "cycle-start")?,
            reset: input(hal, "reset")?,
            single_block: input(hal, "single-block")?,
        })
    }

    /// What is pressed or open: what the machine's file relies on counts as such, too, while
    /// nothing drives it.
    pub(crate) fn read(&self, watched: WatchedInputs) -> Panel {
        let is_set = |pin: &DrivenPin, input| pin.get() || watched.has(input) && !pin.is_driven();
        Panel {
            feed_inhibit: is_set(&self.feed_inhibit, WatchedInput::FeedInhibit),
            hold: is_set(&self.hold, WatchedInput::Hold),
            stop: is_set(&self.stop, WatchedInput::Stop),
            cycle_start: self.cycle_start.get(),
            reset: self.reset.get(),
            single_block: self.single_block.get(),
            ..Panel::default()
        }
    }

    pub(crate) fn driven(&self) -> WatchedInputs {
        let pins = [
            (&self.feed_inhibit, WatchedInput::FeedInhibit),
            (&self.hold, WatchedInput::Hold),
            (&self.stop, WatchedInput::Stop),
        ];
        let driven = pins.into_iter().filter(|(pin, _)| pin.is_driven());
        driven.fold(WatchedInputs::default(), |all, (_, input)| all.with(input))
    }
}
