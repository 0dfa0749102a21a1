//! The folder of programs.
use serde::Serialize;

/// A file of the folder of programs.
#[derive(Clone, Debug, PartialEq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct FileBody {
    /// Below the folder, with `/`.
    pub path: String,
    /// Its size.
    #[ts(type = "number")]
    pub bytes: u64,
    /// When it was changed, seconds since 1970.
    #[ts(type = "number")]
    pub modified_s: u64,
}

/// The folder of programs.
#[derive(Clone, Debug, PartialEq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct FolderBody {
    /// In the order of their paths.
    pub programs: Vec<FileBody>,
    /// There are more than are listed.
    pub is_shortened: bool,
}
