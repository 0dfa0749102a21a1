//! Pins of a panel beside the machine, and of a door that inhibits the feed.
use crate::dial_pins::DialPins;
use crate::driven::DrivenPin;
use crate::ffi::{Direction, Hal, Pin};
use crate::jog_pins::JogPins;
use crate::new_pin::{input, row};
use crate::parameters::{LETTERS, LoadParameters};
use bus::{AXES, Panel, WatchedInput, WatchedInputs};
use units::CoordinateSpeed;

/// See the module's header.
#[derive(Debug)]
pub(crate) struct PanelPins {
    feed_inhibit: DrivenPin<bool>,
    hold: DrivenPin<bool>,
    stop: DrivenPin<bool>,
    cycle_start: Pin<bool>,
    reset: Pin<bool>,
    power_on: Pin<bool>,
    power_off: Pin<bool>,
    home: Pin<bool>,
    /// Off, on.
    flood: [Pin<bool>; 2],
    mist: [Pin<bool>; 2],
    mdi: Vec<Pin<bool>>,
    single_block: Pin<bool>,
    optional_stop: Pin<bool>,
    block_skip: Pin<bool>,
    /// Feed, rapid, spindle.
    dials: [DialPins; 3],
    axes: [Option<JogPins>; AXES],
    jog_enable: Pin<bool>,
    jog_speed: Pin<f64>,
}

impl PanelPins {
    pub(crate) fn new(hal: &Hal, of: &LoadParameters) -> Result<Self, String> {
        let mut axes = [const { None }; AXES];
        for ((slot, letter), _) in axes.iter_mut().zip(LETTERS).zip(of.axes).filter(|(_, has)| *has)
        {
            *slot = Some(JogPins::new(hal, letter.to_ascii_lowercase())?);
        }
        Ok(Self {
            feed_inhibit: DrivenPin::new(hal, "feed-inhibit")?,
            hold: DrivenPin::new(hal, "hold")?,
            stop: DrivenPin::new(hal, "stop")?,
            cycle_start: input(hal, "cycle-start")?,
            reset: input(hal, "reset")?,
            power_on: input(hal, "power-on")?,
            power_off: input(hal, "power-off")?,
            home: input(hal, "home-all")?,
            flood: [input(hal, "flood-off")?, input(hal, "flood-on")?],
            mist: [input(hal, "mist-off")?, input(hal, "mist-on")?],
            mdi: row(hal, "mdi", of.mdi, Direction::In)?,
            single_block: input(hal, "single-block")?,
            optional_stop: input(hal, "optional-stop")?,
            block_skip: input(hal, "block-skip")?,
            dials: [
                DialPins::new(hal, "feed-override")?,
                DialPins::new(hal, "rapid-override")?,
                DialPins::new(hal, "spindle-override")?,
            ],
            axes,
            jog_enable: input(hal, "jog-enable")?,
            jog_speed: input(hal, "jog-speed")?,
        })
    }

    /// What is pressed or open: what the machine's file relies on counts as such, too, while
    /// nothing drives it.
    pub(crate) fn read(&mut self, watched: WatchedInputs) -> Panel {
        let is_set =
            |pin: &DrivenPin<bool>, input| pin.get() || watched.has(input) && !pin.is_driven();
        let mut panel = Panel {
            feed_inhibit: is_set(&self.feed_inhibit, WatchedInput::FeedInhibit),
            hold: is_set(&self.hold, WatchedInput::Hold),
            stop: is_set(&self.stop, WatchedInput::Stop),
            cycle_start: self.cycle_start.get(),
            reset: self.reset.get(),
            power_on: self.power_on.get(),
            power_off: self.power_off.get(),
            home: self.home.get(),
            flood: self.flood.each_ref().map(Pin::get),
            mist: self.mist.each_ref().map(Pin::get),
            mdi: bits(&self.mdi),
            single_block: self.single_block.get(),
            optional_stop: self.optional_stop.get(),
            block_skip: self.block_skip.get(),
            jog_speed: CoordinateSpeed::new(self.jog_speed.get() / 60.0),
            ..Panel::default()
        };
        for (dial, pins) in panel.overrides.iter_mut().zip(&mut self.dials) {
            *dial = pins.read();
        }
        let keys_count = self.jog_enable.get();
        for (index, pins) in self.axes.iter_mut().enumerate() {
            if let Some(pins) = pins {
                panel.wheel[index] = pins.wheel();
                panel.jog[index] = if keys_count { pins.key() } else { 0 };
            }
        }
        panel
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

/// A bit for each pin that is TRUE.
fn bits(pins: &[Pin<bool>]) -> u32 {
    pins.iter().enumerate().fold(0, |bits, (at, pin)| bits | u32::from(pin.get()) << at)
}
