//! The tables that both pages have.

use super::Summary;
use super::rows::{self, ErrorRow, Fact, ModuleRow, TargetRow};
use super::table::origin;
use crate::record::{RunInfo, RunLog};

/// Words and numbers of a run, ready for a template.
pub(super) struct Facts {
    pub(super) scene: String,
    pub(super) origin: String,
    pub(super) time: String,
    pub(super) incomplete: Option<String>,
    pub(super) module_value: &'static str,
    pub(super) modules: Vec<ModuleRow>,
    pub(super) errors: Vec<ErrorRow>,
    pub(super) faults: Vec<String>,
    pub(super) injected: Vec<String>,
    pub(super) targets: Vec<TargetRow>,
    pub(super) peak: Option<String>,
    pub(super) contacts: Vec<String>,
    pub(super) states: Vec<String>,
    pub(super) gripper: Vec<String>,
    pub(super) link: Vec<Fact>,
    pub(super) provenance: Vec<Fact>,
}

/// The words and numbers of a run.
pub(super) fn facts(log: &RunLog, summary: &Summary) -> Facts {
    Facts {
        scene: summary.scene.clone(),
        origin: origin(summary),
        time: rows::time(summary),
        incomplete: summary.incomplete.clone(),
        module_value: rows::module_value(summary),
        modules: rows::modules(summary),
        errors: rows::errors(summary),
        faults: summary.faults.iter().map(rows::fault).collect(),
        injected: summary.injected_faults.iter().map(rows::injected).collect(),
        targets: rows::targets(log),
        peak: rows::peak(summary),
        contacts: summary.contacts.iter().map(rows::contact).collect(),
        states: rows::states(log),
        gripper: rows::gripper(log),
        link: rows::link(summary),
        provenance: provenance(&log.info, summary),
    }
}

fn provenance(info: &RunInfo, summary: &Summary) -> Vec<Fact> {
    let start = match info.start_unix_ns {
        0 => "not recorded: a simulated run is the same at any time".to_owned(),
        ns => format!("{}.{:09} s after 1970-01-01 UTC", ns / 1_000_000_000, ns % 1_000_000_000),
    };
    let fact = |name, value: String| Fact { name, value };
    vec![
        fact("softlimb", info.tool_version.clone()),
        fact("firmware", info.firmware_version.clone()),
        fact("interface hash", format!("{:08x}", info.schema_hash)),
        fact("configuration hash", format!("{:08x}", info.config_hash)),
        fact("source", origin(summary)),
        fact("start", start),
    ]
}
