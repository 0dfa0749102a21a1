//! What the server asks of the program it runs in: everything that is not in the text.
use diag::Diagnostic;

/// What the server asks of the program it runs in: what a G-code program meets outside its text.
pub trait Host {
    /// Tools, offsets, start and subprogram files for the program at this URI.
    ///
    /// # Errors
    /// With a sentence, if they cannot be had.
    fn setup(&self, uri: &str, text: &[u8]) -> Result<interp::Setup, String>;
    /// The URI of the file that `o<name> call` opens from this program, if it exists.
    fn subprogram(&self, uri: &str, name: &str) -> Option<String>;
    /// Reads the program at this URI as one for another dialect from here on; `None`: as the
    /// machine's file says.
    fn read_as(&self, uri: &str, dialect: Option<interp::Dialect>) {
        let _ = (uri, dialect);
    }
    /// Begin to find out everything that is wrong with a program, with what it meets: machine,
    /// tools and workpiece too.
    fn preflight(&self, uri: &str, text: &[u8]) -> Box<dyn Preflight>;
}

/// What is being found out about a text. Who drops it does not want to know any more.
pub trait Preflight {
    /// All findings, in their order, once they are known; or why they cannot be had.
    fn take(&mut self) -> Option<Result<Vec<Diagnostic>, String>>;
    /// Once the findings are taken: the time that the program takes, s, once it is known; `None` of
    /// it where it is refused.
    fn planned(&mut self) -> Option<Option<f64>>;
}
