//! The static report: one HTML file without scripts, for print and documentation.

use askama::Template;

use super::facts::{Facts, facts};
use super::verdict::{self, PhaseRow, Verdict};
use super::{charts, summary};
use crate::record::RunLog;

/// Data of the template.
#[derive(Template)]
#[template(path = "report/still.html")]
struct Page<'a> {
    facts: Facts,
    verdict: Verdict,
    pressures: Vec<String>,
    deformations: Vec<String>,
    tip_views: Vec<String>,
    phases: Vec<PhaseRow>,
    phase_views: Vec<[String; 2]>,
    has_gripper: bool,
    has_goal: bool,
    has_planned: bool,
    has_achieved: bool,
    error_charts: Vec<String>,
    supply: String,
    scene_text: &'a str,
}

/// A page with the summary and the figures of a run: self-contained, without scripts,
/// for light and dark screens and for paper.
pub fn still_html(log: &RunLog) -> String {
    let summary = summary(log);
    let phases = verdict::phases(log);
    let any = |cell: fn(&PhaseRow) -> &str| phases.iter().any(|phase| !cell(phase).is_empty());
    let page = Page {
        facts: facts(log, &summary),
        verdict: verdict::verdict(log, &summary),
        pressures: charts::pressures(log),
        deformations: charts::deformations(log),
        tip_views: charts::tip_views(log),
        has_gripper: any(|phase| &phase.gripper),
        has_goal: any(|phase| phase.goal),
        has_planned: any(|phase| &phase.planned),
        has_achieved: any(|phase| &phase.achieved),
        phases,
        phase_views: charts::phase_views(log),
        error_charts: charts::errors(log),
        supply: charts::supply(log),
        scene_text: &log.info.scene_text,
    };
    super::rendered(&page)
}
