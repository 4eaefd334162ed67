//! What the page draws in space: the limb, its setpoint, what it carries, and what it keeps clear of.

use serde::Serialize;

use super::columns::Table;
use crate::record::{CarriedInfo, RunLog, Sample, SolidInfo};

/// Distance of two coordinates in the page, m.
const STEP_M: f64 = 1e-4;
/// The same of times, s.
const STEP_S: f64 = 1e-4;
/// Most points of a planned center line in the page.
const POINTS_MAX: usize = 40;

/// What stands in space and does not change.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Space<'a> {
    solids: &'a [SolidInfo],
    carried: &'a [CarriedInfo],
    /// Points of the limb as a solid; 0 where the log has none.
    body_points: usize,
    /// Points of the line of its setpoint, and of that which was seen; 0 where the log has none.
    line_points: [usize; 2],
}

/// A line of the key to the view in space.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) name: &'static str,
    /// `solid`, `line`, `dashed`, `dotted` or `ring`.
    pub(super) style: &'static str,
    pub(super) color: &'static str,
}

/// The key to what a run shows in space.
pub(super) fn key(log: &RunLog) -> Vec<Entry> {
    let entry = |name, style, color| Entry { name, style, color };
    let seen = log.samples.iter().any(|sample| sample.tip_achieved_m.is_some());
    let has = |region: bool| log.info.solids.iter().any(|solid| solid.region == region);
    let entries = [
        (!log.bodies.is_empty(), entry("limb", "solid", "limb")),
        (log.bodies.is_empty() && seen, entry("limb", "line", "limb")),
        (!log.shapes.is_empty(), entry("setpoint", "dashed", "ink")),
        (!log.shapes.is_empty(), entry("start pose", "dotted", "soft")),
        (seen, entry("path of the tip", "line", "trail")),
        (!seen, entry("path of the tip by its setpoints", "line", "trail")),
        (seen, entry("its setpoints", "dashed", "soft")),
        (!log.info.phases.is_empty(), entry("ends of phases", "ring", "ink")),
        (has(false), entry("obstacle", "solid", "obstacle")),
        (has(true), entry("region", "dashed", "region")),
        (!log.info.carried.is_empty(), entry("object", "solid", "object")),
    ];
    entries.into_iter().filter_map(|(is_shown, entry)| is_shown.then_some(entry)).collect()
}

/// Adds what moves to the tables, and says how many points it has.
pub(super) fn space<'a>(log: &'a RunLog, samples: &mut Table, bodies: &mut Table, lines: &mut Table) -> Space<'a> {
    add_points(samples, "tip_set", log.samples.iter().map(|sample| Some(sample.tip_setpoint_m)));
    let achieved = |sample: &Sample| sample.tip_achieved_m;
    add_points(samples, "tip", log.samples.iter().map(achieved));
    samples.add("state", 1.0, log.samples.iter().map(|sample| f64::from(sample.state)));
    let body_points = common(log.bodies.iter().map(|body| body.line_m.len()));
    for point in 0..body_points {
        let at =
            |body: &crate::record::Body| body.line_m.get(point).copied().filter(|_| body.line_m.len() == body_points);
        add_points(bodies, &format!("body_{point}"), log.bodies.iter().map(at));
        let radius = |body: &crate::record::Body| body.radius_m.get(point).copied().unwrap_or(f64::NAN);
        bodies.add(format!("radius_{point}"), STEP_M, log.bodies.iter().map(radius));
    }
    lines.add("t", STEP_S, log.shapes.iter().map(|shape| shape.time_s));
    let line_points = [
        add_lines(lines, "set", &log.shapes.iter().map(|shape| Some(&shape.setpoint)).collect::<Vec<_>>()),
        // A log without solids of the limb shows its line.
        match body_points {
            0 => add_lines(lines, "seen", &log.shapes.iter().map(|shape| shape.achieved.as_ref()).collect::<Vec<_>>()),
            _ => 0,
        },
    ];
    Space { solids: &log.info.solids, carried: &log.info.carried, body_points, line_points }
}

/// Adds lines thinned to a number of points, which is the result.
fn add_lines(table: &mut Table, name: &str, lines: &[Option<&Vec<[f64; 3]>>]) -> usize {
    let all = common(lines.iter().flatten().map(|line| line.len()));
    let points = all.min(POINTS_MAX);
    for point in 0..points {
        let index = if points < 2 { 0 } else { point * (all - 1) / (points - 1) };
        let at = |line: &Option<&Vec<[f64; 3]>>| line.filter(|line| line.len() == all)?.get(index).copied();
        add_points(table, &format!("{name}_{point}"), lines.iter().map(at));
    }
    points
}

/// The number that most have; lines of other lengths are not drawn.
fn common(counts: impl Iterator<Item = usize>) -> usize {
    let mut found = std::collections::BTreeMap::<usize, usize>::new();
    counts.for_each(|count| *found.entry(count).or_default() += 1);
    found.into_iter().max_by_key(|(_, times)| *times).map_or(0, |(count, _)| count)
}

fn add_points(table: &mut Table, name: &str, points: impl Iterator<Item = Option<[f64; 3]>>) {
    let points: Vec<_> = points.map(|point| point.unwrap_or([f64::NAN; 3])).collect();
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        table.add(format!("{name}_{letter}"), STEP_M, points.iter().map(|point| point[axis]));
    }
}
