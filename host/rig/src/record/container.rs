//! The container of a log: how it is written, and what opens it.

use super::RunInfo;
use super::metadata::run_metadata;
use std::path::{Path, PathBuf};

/// Chunks are held back until they are whole, so that the file is at every moment
/// the beginning of a valid one: no lengths to be filled in later. They are closed by
/// time and never by size, so that a sample is never torn between two of them.
pub(super) fn options() -> mcap::WriteOptions {
    mcap::WriteOptions::new()
        .profile("ros2")
        .library(concat!("softlimb ", env!("CARGO_PKG_VERSION")))
        .disable_seeking(true)
        .chunk_size(None)
}

/// Writes what is known before the run.
pub(super) fn write_opening<W: std::io::Write + std::io::Seek>(
    mcap: &mut mcap::Writer<W>,
    info: &RunInfo,
) -> mcap::McapResult<()> {
    mcap.write_metadata(&mcap::records::Metadata { name: super::RUN_METADATA.into(), metadata: run_metadata(info) })?;
    mcap.attach(&mcap::Attachment {
        log_time: info.start_unix_ns,
        create_time: info.start_unix_ns,
        name: super::SCENE_ATTACHMENT.into(),
        media_type: "application/toml".into(),
        data: info.scene_text.as_bytes().into(),
    })?;
    mcap.flush()
}

/// Name of a log that is not finished.
pub(super) fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}
