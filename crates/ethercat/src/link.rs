//! What a master sends its frames by.

/// A network card, or what stands for one.
pub trait FrameLink {
    /// Nanoseconds from a beginning of its own; never goes back.
    fn now_ns(&mut self) -> u64;

    /// Sends a frame; true if it is on its way.
    fn send(&mut self, frame: &[u8]) -> bool;

    /// Takes a frame that has come: its bytes are at the beginning of `into`.
    fn receive(&mut self, into: &mut [u8]) -> Option<usize>;

    /// Waits until a frame has come, or until a time.
    fn wait(&mut self, until_ns: u64);
}
