//! The report that moves: one page with its data and scripts in it, which needs no network.

mod columns;
mod panels;
mod space;

use askama::Template;
use data_encoding::BASE64;
use serde::Serialize;

use super::causes::TOLERANCE;
use super::facts::{Facts, facts};
use super::verdict::{self, Card, PhaseRow, Verdict};
use super::{Summary, rows, summary};
use crate::record::{FaultRecord, InjectedFault, PhaseInfo, RunLog};
use columns::{Table, packed};
use panels::{Panel, Plots, plots};
use space::{Entry, Space, space};

/// Style of the page.
pub const STYLE: &str = include_str!("page.css");

/// The script that draws a limb in space: positions in m on a canvas.
pub const LIMB_SCRIPT: &str = include_str!("limb.js");

/// plotly.js, compressed by the build from the crate that brings it.
const PLOTLY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/plotly.js.gz"));

/// Data of the template.
#[derive(Template)]
#[template(path = "report/moving/page.html")]
struct Page<'a> {
    facts: Facts,
    verdict: Verdict,
    cards: Vec<Card>,
    key: Vec<Entry>,
    phases: Vec<PhaseRow>,
    /// Whether phases share a name, so that their starts are needed beside it.
    repeats: bool,
    tolerance_percent: String,
    shows: Shows,
    is_corrected: bool,
    has_object: bool,
    is_still: bool,
    style: &'static str,
    limb_script: &'static str,
    columns_script: &'static str,
    plots_script: &'static str,
    page_script: &'static str,
    plotly: String,
    /// Description of the numbers, as JSON that is safe within a script element.
    run: String,
    numbers: String,
    scene_text: &'a str,
}

/// Columns of the table of phases that have something to show.
struct Shows {
    gripper: bool,
    goal: bool,
    error: bool,
    pressure: bool,
    model: bool,
    sag: bool,
    swing: bool,
    swing_planned: bool,
    planned: bool,
    achieved: bool,
}

impl Shows {
    fn of(phases: &[PhaseRow]) -> Self {
        let any = |cell: fn(&PhaseRow) -> &str| phases.iter().any(|phase| !cell(phase).is_empty());
        Self {
            gripper: any(|phase| &phase.gripper),
            goal: any(|phase| phase.goal),
            error: any(|phase| &phase.error),
            pressure: any(|phase| &phase.pressure),
            model: any(|phase| &phase.model),
            sag: any(|phase| &phase.sag),
            swing: any(|phase| &phase.swing),
            swing_planned: any(|phase| &phase.swing_planned),
            planned: any(|phase| &phase.planned),
            achieved: any(|phase| &phase.achieved),
        }
    }

    /// Whether errors are split into their causes.
    fn causes(&self) -> bool {
        self.pressure && self.model
    }
}

/// Description of the numbers of a page.
#[derive(Debug, Serialize)]
struct Run<'a> {
    name: &'a str,
    /// Tables in the order of their bytes.
    tables: [(&'static str, &'a Table); 4],
    panels: &'a [Panel],
    space: Space<'a>,
    phases: Vec<Phase<'a>>,
    marks: Vec<Mark>,
    /// Time that the page opens at, s.
    opens: f64,
    states: [&'static str; 7],
}

/// A phase as the page draws it.
#[derive(Debug, Serialize)]
struct Phase<'a> {
    name: &'a str,
    start: f64,
    end: f64,
    /// When the plan is nearest to an obstacle, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<f64>,
}

/// Something that happened at a time.
#[derive(Debug, Serialize)]
struct Mark {
    time: f64,
    text: String,
    /// Whether the tip lost what it carried.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    lost: bool,
}

/// A page with the summary, the limb in space and the plots of a run.
pub fn html(log: &RunLog) -> String {
    let summary = summary(log);
    let Plots { mut samples, mut bodies, planned, panels } = plots(log);
    let mut lines = Table::new(log.shapes.len());
    let space = space(log, &mut samples, &mut bodies, &mut lines);
    let tables = [("samples", &samples), ("bodies", &bodies), ("planned", &planned), ("lines", &lines)];
    let run = Run {
        name: &log.info.scene_name,
        tables,
        panels: &panels,
        space,
        phases: phases(log),
        marks: marks(log, &summary),
        opens: verdict::telling_s(log).unwrap_or(0.0),
        states: std::array::from_fn(|state| rows::state_name(state as u8)),
    };
    let phase_rows = verdict::phases(log);
    let page = Page {
        facts: facts(log, &summary),
        verdict: verdict::verdict(log, &summary),
        cards: verdict::cards(log, &summary),
        key: space::key(log),
        shows: Shows::of(&phase_rows),
        repeats: repeats(&phase_rows),
        phases: phase_rows,
        tolerance_percent: format!("{:.0}", 1e2 * TOLERANCE),
        is_corrected: log.info.is_corrected(),
        has_object: log.info.simulated && !log.info.carried.is_empty(),
        is_still: log.info.simulated && !log.info.truth.as_deref().is_some_and(|truth| truth.contains("swing")),
        style: STYLE,
        limb_script: LIMB_SCRIPT,
        columns_script: include_str!("columns.js"),
        plots_script: include_str!("plots.js"),
        page_script: include_str!("page.js"),
        plotly: BASE64.encode(PLOTLY),
        run: json(&run),
        numbers: packed(&tables.map(|(_, table)| table)),
        scene_text: &log.info.scene_text,
    };
    super::rendered(&page)
}

fn repeats(phases: &[PhaseRow]) -> bool {
    let mut names = std::collections::BTreeSet::new();
    !phases.iter().all(|phase| names.insert(&phase.name))
}

/// JSON with `<` escaped, so that no text ends the script element.
fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and text become JSON").replace('<', "\\u003c")
}

fn phases(log: &RunLog) -> Vec<Phase<'_>> {
    fn phase(phase: &PhaseInfo) -> Phase<'_> {
        let nearest = phase.nearest.as_ref().map(|nearest| nearest.time_s).filter(|time| time.is_finite());
        Phase { name: &phase.name, start: phase.start_s, end: phase.end_s(), nearest }
    }
    let phases = log.info.phases.iter().map(phase);
    phases.filter(|phase| phase.start.is_finite() && phase.end.is_finite()).collect()
}

fn marks(log: &RunLog, summary: &Summary) -> Vec<Mark> {
    let faults = log.faults.iter().map(|fault| Mark {
        time: fault.time_s,
        text: rows::fault(fault),
        lost: [FaultRecord::DROPPED, FaultRecord::LEFT_BEHIND].contains(&fault.code),
    });
    let on_purpose = |fault: &InjectedFault| Mark {
        time: fault.time_s,
        text: format!("{} (on purpose)", rows::injected(fault)),
        lost: false,
    };
    let marks = faults.chain(summary.injected_faults.iter().map(on_purpose));
    marks.filter(|mark| mark.time.is_finite()).collect()
}
