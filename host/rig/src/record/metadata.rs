//! The two metadata records of a log, written and read: what is known before a run
//! and what is known after it.

use super::{ModuleInfo, Observer, RecordError, RunEnd, RunInfo};
use softlimb_chart::WEIGHTLESS;
use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

/// Key of the faults that a run meets on purpose.
const INJECTED: &str = "injected_faults";
/// Key of the simulated limb.
const TRUTH: &str = "true_limb";
/// Keys of what corrected the setpoints.
const FEEDBACK: &str = "feedback";
const OBSERVER: &str = "observer";
const CORRECTIONS: &str = "corrections";
/// Key of the highest true pressures.
const PEAKS: &str = "peak_chamber_pa";
const TARGETS: &str = "targets";
const CONTACTS: &str = "contacts";
/// Key of the clearance that the scene requires.
const CLEARANCE: &str = "clearance_m";

/// A metadata record's content.
pub(super) type Metadata = BTreeMap<String, String>;

/// One entry per field, for people and other tools; the lists as JSON.
pub(super) fn run_metadata(info: &RunInfo) -> Metadata {
    let mut metadata = Metadata::from([
        ("format".into(), super::FORMAT_VERSION.into()),
        ("scene".into(), info.scene_name.clone()),
        ("tool_version".into(), info.tool_version.clone()),
        ("firmware_version".into(), info.firmware_version.clone()),
        ("schema_hash".into(), format!("{:08x}", info.schema_hash)),
        ("config_hash".into(), format!("{:08x}", info.config_hash)),
        ("start_unix_ns".into(), info.start_unix_ns.to_string()),
        ("simulated".into(), info.simulated.to_string()),
        (WEIGHTLESS.into(), info.weightless.to_string()),
        ("modules".into(), to_json(&info.modules)),
        ("phases".into(), to_json(&info.phases)),
    ]);
    if let Some(seed) = info.seed {
        metadata.insert("seed".into(), seed.to_string());
    }
    if let Some(truth) = &info.truth {
        metadata.insert(TRUTH.into(), truth.clone());
    }
    if let Some(observer) = info.feedback {
        metadata.insert(FEEDBACK.into(), true.to_string());
        metadata.insert(OBSERVER.into(), observer.word().into());
    }
    if info.corrections {
        metadata.insert(CORRECTIONS.into(), true.to_string());
    }
    if !info.injected_faults.is_empty() {
        metadata.insert(INJECTED.into(), to_json(&info.injected_faults));
    }
    if !info.solids.is_empty() {
        metadata.insert("solids".into(), to_json(&info.solids));
    }
    if let Some(clearance_m) = info.clearance_m {
        metadata.insert(CLEARANCE.into(), clearance_m.to_string());
    }
    if !info.carried.is_empty() {
        metadata.insert("carried".into(), to_json(&info.carried));
    }
    if let Some(limb) = &info.limb {
        metadata.insert("limb".into(), to_json(limb));
    }
    metadata
}

/// Data known after the run, as JSON.
pub(super) fn end_metadata(end: &RunEnd) -> Metadata {
    let mut metadata = Metadata::from([("link".into(), to_json(&end.link)), ("wall_s".into(), to_json(&end.wall_s))]);
    if !end.peak_chamber_pa.is_empty() {
        metadata.insert(PEAKS.into(), to_json(&end.peak_chamber_pa));
    }
    if !end.targets.is_empty() {
        metadata.insert(TARGETS.into(), to_json(&end.targets));
    }
    if !end.contacts.is_empty() {
        metadata.insert(CONTACTS.into(), to_json(&end.contacts));
    }
    metadata
}

/// JSON of plain data. Numbers and strings cannot fail to become JSON.
fn to_json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Reads what was known before the run.
///
/// # Errors
/// [`RecordError::Version`], [`RecordError::Metadata`].
pub(super) fn read_run(path: &Path, run: &Metadata, scene_text: String) -> Result<RunInfo, RecordError> {
    let fields = Fields { name: super::RUN_METADATA, fields: run };
    let found = fields.text("format")?;
    if found != super::FORMAT_VERSION {
        return Err(RecordError::Version { path: path.to_owned(), found: found.to_owned() });
    }
    // Logs of earlier versions have feedback by a camera alone, and do not name it.
    let observer = match run.get(OBSERVER).map(String::as_str) {
        None | Some("camera") => Observer::Camera,
        Some("imus") => Observer::Imus,
        Some(other) => return Err(fields.wrong(OBSERVER, format!("unknown word `{other}`"))),
    };
    let corrects = run.contains_key(FEEDBACK) && fields.parse(FEEDBACK)?;
    let info = RunInfo {
        scene_name: fields.text("scene")?.to_owned(),
        scene_text,
        tool_version: fields.text("tool_version")?.to_owned(),
        firmware_version: fields.text("firmware_version")?.to_owned(),
        schema_hash: fields.hash("schema_hash")?,
        config_hash: fields.hash("config_hash")?,
        seed: if run.contains_key("seed") { Some(fields.parse("seed")?) } else { None },
        start_unix_ns: fields.parse("start_unix_ns")?,
        modules: fields.json("modules")?,
        phases: fields.json("phases")?,
        solids: if run.contains_key("solids") { fields.json("solids")? } else { Vec::new() },
        clearance_m: if run.contains_key(CLEARANCE) { Some(fields.parse(CLEARANCE)?) } else { None },
        carried: if run.contains_key("carried") { fields.json("carried")? } else { Vec::new() },
        limb: if run.contains_key("limb") { Some(fields.json("limb")?) } else { None },
        simulated: fields.parse("simulated")?,
        // Logs of earlier versions do not say.
        injected_faults: if run.contains_key(INJECTED) { fields.json(INJECTED)? } else { Vec::new() },
        weightless: run.contains_key(WEIGHTLESS) && fields.parse(WEIGHTLESS)?,
        truth: run.get(TRUTH).cloned(),
        feedback: corrects.then_some(observer),
        corrections: run.contains_key(CORRECTIONS) && fields.parse(CORRECTIONS)?,
    };
    check_modules(&info)?;
    Ok(info)
}

/// Reads the data known after the run.
///
/// # Errors
/// [`RecordError::Metadata`].
pub(super) fn read_end(end: &Metadata) -> Result<RunEnd, RecordError> {
    let fields = Fields { name: super::END_METADATA, fields: end };
    let peak_chamber_pa = if end.contains_key(PEAKS) { fields.json(PEAKS)? } else { Vec::new() };
    let targets = if end.contains_key(TARGETS) { fields.json(TARGETS)? } else { Vec::new() };
    let contacts = if end.contains_key(CONTACTS) { fields.json(CONTACTS)? } else { Vec::new() };
    Ok(RunEnd { link: fields.json("link")?, peak_chamber_pa, wall_s: fields.json("wall_s")?, targets, contacts })
}

/// Refuses modules whose channels no device can have: they are numbered by a byte.
///
/// # Errors
/// [`RecordError::Metadata`].
pub(super) fn check_modules(info: &RunInfo) -> Result<(), RecordError> {
    let possible = |module: &ModuleInfo| {
        module.channels.start <= module.channels.end && module.channels.end <= usize::from(u8::MAX)
    };
    match info.modules.iter().find(|module| !possible(module)) {
        Some(ModuleInfo { name, channels, .. }) => Err(RecordError::Metadata {
            name: super::RUN_METADATA,
            reason: format!("module {name:?} has channels {channels:?}; they end at 255 at most"),
        }),
        None => Ok(()),
    }
}

/// A metadata record, read field by field.
struct Fields<'a> {
    name: &'static str,
    fields: &'a Metadata,
}

impl Fields<'_> {
    fn wrong(&self, key: &str, reason: impl std::fmt::Display) -> RecordError {
        RecordError::Metadata { name: self.name, reason: format!("`{key}`: {reason}") }
    }

    fn text(&self, key: &str) -> Result<&str, RecordError> {
        let value = self.fields.get(key).ok_or_else(|| self.wrong(key, "missing"))?;
        Ok(value)
    }

    fn parse<T: FromStr<Err: std::fmt::Display>>(&self, key: &str) -> Result<T, RecordError> {
        self.text(key)?.parse().map_err(|reason| self.wrong(key, reason))
    }

    fn hash(&self, key: &str) -> Result<u32, RecordError> {
        u32::from_str_radix(self.text(key)?, 16).map_err(|reason| self.wrong(key, reason))
    }

    fn json<T: serde::de::DeserializeOwned>(&self, key: &str) -> Result<T, RecordError> {
        serde_json::from_str(self.text(key)?).map_err(|reason| self.wrong(key, reason))
    }
}
