//! A coupler, so many drives and an I/O terminal that get frames on their standard input and give
//! them back on their standard output, each with its length in two bytes before it.
//!
//! `tools/ethercat-masters` puts a network card in between, so that masters of others meet the
//! emulated devices.
use esc::{DriveModel, NetworkSegment, Passed, coupler, digital_io, drive};
use std::io::{Read, Write, stdin, stdout};
use std::time::Instant;

#[allow(clippy::disallowed_methods)] // the time of a real wire is the computer's
fn main() -> std::io::Result<()> {
    let drives = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(6);
    let drives = (1..=drives).map(|serial| {
        drive(&DriveModel { drift_ppb: 5_000 * i64::from(serial), ..DriveModel::new(serial) })
    });
    let mut segment =
        NetworkSegment::new([coupler(0)].into_iter().chain(drives).chain([digital_io()]));
    let started = Instant::now();
    let (mut input, mut output) = (stdin().lock(), stdout().lock());
    let mut length = [0; 2];
    let mut frame = vec![0; usize::from(u16::MAX)];
    while input.read_exact(&mut length).is_ok() {
        let frame = &mut frame[..usize::from(u16::from_le_bytes(length))];
        input.read_exact(frame)?;
        let now = u64::try_from(started.elapsed().as_nanos()).unwrap_or(u64::MAX);
        if let Passed::Back(_) = segment.pass(frame, now) {
            output.write_all(&length)?;
            output.write_all(frame)?;
            output.flush()?;
        }
    }
    Ok(())
}
