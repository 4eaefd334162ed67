//! The report as one HTML file that needs nothing beside it.

use super::rows::{self, ErrorRow, Fact, ModuleRow};
use super::table::origin;
use super::{Summary, charts, summary};
use crate::record::{RunInfo, RunLog};
use serde::Serialize;

/// Data of the template.
#[derive(Debug, Serialize)]
struct Page {
    scene: String,
    origin: String,
    time: String,
    incomplete: Option<String>,
    module_value: &'static str,
    modules: Vec<ModuleRow>,
    errors: Vec<ErrorRow>,
    pressures: Vec<String>,
    deformations: Vec<String>,
    tip_views: Vec<String>,
    phases: Vec<PhaseRow>,
    phase_views: Vec<[String; 2]>,
    has_gripper: bool,
    has_clearance: bool,
    error_charts: Vec<String>,
    supply: String,
    faults: Vec<String>,
    injected: Vec<String>,
    peak: Option<String>,
    states: Vec<String>,
    gripper: Vec<String>,
    link: Vec<Fact>,
    provenance: Vec<Fact>,
    scene_text: String,
}

/// One phase, ready to be printed.
#[derive(Debug, Serialize)]
struct PhaseRow {
    name: String,
    start: String,
    motion: String,
    hold: String,
    gripper: String,
    clearance: String,
}

/// A page with the summary and the figures of a run: self-contained, without scripts,
/// for light and dark screens and for paper.
pub fn html(log: &RunLog) -> String {
    let templates = minijinja::Environment::new();
    // The name ends in .html: everything but the drawings is escaped.
    templates
        .render_named_str("report.html", include_str!("report.html"), minijinja::value::Serde(page(log)))
        .expect("the template is part of the program and every test renders it")
}

fn page(log: &RunLog) -> Page {
    let summary = summary(log);
    Page {
        scene: summary.scene.clone(),
        origin: origin(&summary),
        time: rows::time(&summary),
        incomplete: summary.incomplete.clone(),
        module_value: rows::module_value(&summary),
        modules: rows::modules(&summary),
        errors: rows::errors(&summary),
        pressures: charts::pressures(log),
        deformations: charts::deformations(log),
        tip_views: charts::tip_views(log),
        phases: phases(&log.info),
        phase_views: charts::phase_views(log),
        has_gripper: log.info.phases.iter().any(|phase| phase.gripper.is_some()),
        has_clearance: log.info.phases.iter().any(|phase| phase.nearest.is_some()),
        error_charts: charts::errors(log),
        supply: charts::supply(log),
        faults: summary.faults.iter().map(rows::fault).collect(),
        injected: summary.injected_faults.iter().map(rows::injected).collect(),
        peak: rows::peak(&summary),
        states: rows::states(log),
        gripper: rows::gripper(log),
        link: rows::link(&summary),
        provenance: provenance(&log.info, &summary),
        scene_text: log.info.scene_text.clone(),
    }
}

fn phases(info: &RunInfo) -> Vec<PhaseRow> {
    let row = |phase: &crate::record::PhaseInfo| PhaseRow {
        name: phase.name.clone(),
        start: format!("{:.2}", phase.start_s),
        motion: format!("{:.2}", phase.move_s),
        hold: format!("{:.2}", phase.hold_s),
        gripper: phase.gripper.clone().unwrap_or_default(),
        clearance: phase.nearest.as_ref().map_or(String::new(), |nearest| {
            format!("{:.1} mm from {} at {:.2} s", nearest.distance_m * 1e3, nearest.obstacle, nearest.time_s)
        }),
    };
    info.phases.iter().map(row).collect()
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
