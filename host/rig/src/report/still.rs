//! The static report: one HTML file without scripts, for print and documentation.

use askama::Template;

use super::facts::{Facts, facts};
use super::{charts, summary};
use crate::record::{RunInfo, RunLog};

/// Data of the template.
#[derive(Template)]
#[template(path = "report/still.html")]
struct Page<'a> {
    facts: Facts,
    pressures: Vec<String>,
    deformations: Vec<String>,
    tip_views: Vec<String>,
    phases: Vec<PhaseRow>,
    phase_views: Vec<[String; 2]>,
    has_gripper: bool,
    has_clearance: bool,
    error_charts: Vec<String>,
    supply: String,
    scene_text: &'a str,
}

/// One phase, ready to be printed.
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
pub fn still_html(log: &RunLog) -> String {
    let page = Page {
        facts: facts(log, &summary(log)),
        pressures: charts::pressures(log),
        deformations: charts::deformations(log),
        tip_views: charts::tip_views(log),
        phases: phases(&log.info),
        phase_views: charts::phase_views(log),
        has_gripper: log.info.phases.iter().any(|phase| phase.gripper.is_some()),
        has_clearance: log.info.phases.iter().any(|phase| phase.nearest.is_some()),
        error_charts: charts::errors(log),
        supply: charts::supply(log),
        scene_text: &log.info.scene_text,
    };
    super::rendered(&page)
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
