//! LinuxCNC's HAL: whether it is there, may be in real time, and has the component of this build.
use super::computer::Computer;
use super::finding::{ComputerFinding, Topic};
use super::system::Rights;
use std::os::unix::fs::MetadataExt;

const LOADER: &str = "usr/bin/rtapi_app";
const MODULE: &str = "usr/lib/linuxcnc/modules/leadscrew.so";
/// Bytes of a component, far more than it has.
const MODULE_LIMIT: u64 = 256 << 20;
const INSTALL: &str = "tools/hal install";

/// Nothing where the machine is not led through HAL, and there is none.
pub(super) fn hal(computer: &Computer, rights: Rights, is_wanted: bool) -> Vec<ComputerFinding> {
    let topic = Topic::Hal;
    if !computer.has(LOADER) {
        let missing = ComputerFinding::wrong(
            topic,
            "LinuxCNC is not installed: there is no /usr/bin/rtapi_app",
            "sudo apt install linuxcnc-uspace",
        );
        return if is_wanted { vec![missing] } else { Vec::new() };
    }
    let version = version(computer).unwrap_or_else(|| "of a version that is not known".to_owned());
    let mut found = vec![ComputerFinding::good(topic, format!("LinuxCNC {version}"))];
    found.extend(loader_rights(computer, rights));
    found.push(module(computer));
    found
}

fn version(computer: &Computer) -> Option<String> {
    let status = computer.text("var/lib/dpkg/status")?;
    let package =
        status.split("\n\n").find(|part| part.starts_with("Package: linuxcnc-uspace\n"))?;
    let version = package.lines().find_map(|line| line.strip_prefix("Version: "))?;
    Some(version.to_owned())
}

/// `rtapi_app` leads in real time only as root.
fn loader_rights(computer: &Computer, rights: Rights) -> Option<ComputerFinding> {
    let about = std::fs::metadata(computer.path(LOADER)).ok()?;
    let is_root_for_all = about.uid() == 0 && about.mode() & 0o4000 != 0;
    (!is_root_for_all && !rights.is_root).then(|| {
        ComputerFinding::wrong(
            Topic::Hal,
            "/usr/bin/rtapi_app does not run as root: HAL's threads run as any others then",
            "sudo chown root /usr/bin/rtapi_app; sudo chmod u+s /usr/bin/rtapi_app",
        )
    })
}

fn module(computer: &Computer) -> ComputerFinding {
    let shown = format!("/{MODULE}");
    let Some(bytes) = computer.bytes(MODULE, MODULE_LIMIT) else {
        return ComputerFinding::wrong(
            Topic::Hal,
            format!("the component is not installed: there is no {shown}"),
            INSTALL,
        );
    };
    let words = shm::BUILD_WORDS;
    let mark = bytes.windows(shm::BUILD_MARK.len()).find(|mark| {
        mark.starts_with(&words) && mark[words.len()..].iter().all(u8::is_ascii_hexdigit)
    });
    match mark {
        Some(mark) if mark == shm::BUILD_MARK => {
            ComputerFinding::good(Topic::Hal, format!("{shown} is of this build"))
        }
        Some(_) => ComputerFinding::wrong(
            Topic::Hal,
            format!("{shown} is of another build than this program, which will refuse it"),
            INSTALL,
        ),
        None => ComputerFinding::wrong(
            Topic::Hal,
            format!(
                "{shown} does not say of which build it is: it is older than this program, which will refuse it"
            ),
            INSTALL,
        ),
    }
}
