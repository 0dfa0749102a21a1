//! Pins by their names within the component, each with nothing on it.
use crate::ffi::{Direction, Hal, Pin, PinKind};

pub(crate) fn named<T: PinKind>(
    hal: &Hal,
    name: &str,
    direction: Direction,
) -> Result<Pin<T>, String> {
    let pin = hal.pin(&format!("leadscrew.{name}"), direction)?;
    pin.set(T::default());
    Ok(pin)
}

pub(crate) fn input<T: PinKind>(hal: &Hal, name: &str) -> Result<Pin<T>, String> {
    named(hal, name, Direction::In)
}

pub(crate) fn output<T: PinKind>(hal: &Hal, name: &str) -> Result<Pin<T>, String> {
    named(hal, name, Direction::Out)
}

pub(crate) fn row<T: PinKind>(
    hal: &Hal,
    name: &str,
    count: usize,
    direction: Direction,
) -> Result<Vec<Pin<T>>, String> {
    (0..count).map(|number| named(hal, &format!("{name}-{number:02}"), direction)).collect()
}
