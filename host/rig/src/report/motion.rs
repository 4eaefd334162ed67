//! The animated picture of a run: an SVG without scripts, for pages that allow none.

use std::fmt::Write as _;

use softlimb_chart::labelled;

use super::projection::{Projection, depth, flatness};
use crate::record::{Body, CarriedInfo, FaultRecord, RunLog, SolidInfo, SolidShape};

/// Size, px: of the picture, and of the room above and below the limb.
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 470.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 52.0;
/// Room beside the limb, px.
const MARGIN: f64 = 16.0;
/// Frames, and how long they take, s.
const FRAMES: usize = 90;
const LASTS_S: f64 = 12.0;
/// Points of a part of the limb at most.
const POINTS: usize = 7;
/// Points nearer than this are one, m: a new part begins there.
const SAME_M: f64 = 1e-6;
/// A body with a number from here on is none, m.
const FAR_M: f64 = 1e3;
/// Points of the path of the tip at most.
const TIPS: usize = 300;
/// Width of the plate at the base over that of the limb there.
const PLATE: f64 = 1.5;
/// Shares of a tube's width that are drawn over it, for its round look, and their class.
const ROUND: [(f64, &str); 3] = [(1.0, "edge"), (0.8, "core"), (0.3, "light")];

/// The run as an animated SVG: the limb as a solid, obstacles, carried objects, the path of the tip, and a bar of time with the phases, from start to
/// end in 12 s, and again. `None` where the log has no solid of the limb: in logs of earlier versions, and without an observer.
pub fn motion_svg(log: &RunLog) -> Option<String> {
    let count = log.bodies.first()?.line_m.len();
    let is_shown = |body: &&Body| {
        let mut numbers = body.line_m.iter().flatten().chain(&body.radius_m);
        body.line_m.len() == count
            && count > 1
            && body.radius_m.len() == count
            && numbers.all(|number| number.abs() < FAR_M)
    };
    let bodies: Vec<&Body> = log.bodies.iter().filter(is_shown).collect();
    let (first, last) = (bodies.first()?, bodies.last()?);
    let [begin_s, end_s] = [first.time_s, last.time_s];
    let time_s = |frame: usize| begin_s + (end_s - begin_s) * frame as f64 / (FRAMES - 1) as f64;
    let frames: Vec<&Body> =
        (0..FRAMES).filter_map(|frame| bodies.get(row_at(&bodies, time_s(frame)))).copied().collect();
    let objects: Vec<(&CarriedInfo, Vec<Option<[f64; 3]>>)> =
        objects(log).into_iter().map(|name| carried(log, &bodies, name, time_s)).collect();
    let area = [WIDTH - 2.0 * MARGIN, HEIGHT - TOP - BOTTOM - 2.0 * MARGIN];
    let seen = frames.iter().flat_map(|body| body.line_m.iter().zip(&body.radius_m).map(|(at, radius)| (*at, *radius)));
    let solids = log.info.solids.iter().flat_map(|solid| solid.lines_m.iter().flatten().map(|at| (*at, 0.0)));
    let held = objects.iter().flat_map(|(object, places)| {
        places.iter().flatten().flat_map(|at| {
            [(raised(at, object.above_m), object.radius_m), (raised(at, -object.below_m), object.radius_m)]
        })
    });
    let view = Projection::fitted(seen.chain(solids).chain(held), [MARGIN, TOP + MARGIN], area);

    let title = labelled(&log.info.scene_name, log.info.weightless);
    let title = escaped(&title);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" \
         aria-label=\"{title}: the limb moves through its phases\">\n<style>{STYLE}</style>\n<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n\
         <text class=\"title\" x=\"{MARGIN}\" y=\"22\">{title}</text>\n\
         <text class=\"soft\" x=\"{:.0}\" y=\"22\" text-anchor=\"end\">{:.0} s in {LASTS_S:.0} s</text>\n",
        WIDTH - MARGIN,
        end_s - begin_s
    );
    let middle = depth(&mean(frames.iter().flat_map(|body| &body.line_m)));
    let (near, far): (Vec<_>, Vec<_>) =
        log.info.solids.iter().partition(|solid| !solid.region && depth(&center(solid)) < middle);
    draw_solids(&mut svg, &view, far, "far");
    for (object, places) in &objects {
        draw_object(&mut svg, &view, object, places);
    }
    draw_base(&mut svg, &view, first);
    draw_limb(&mut svg, &view, &frames);
    draw_trail(&mut svg, &view, &bodies, time_s);
    draw_solids(&mut svg, &view, near, "near");
    draw_time(&mut svg, log, [begin_s, end_s]);
    svg.push_str("</svg>\n");
    Some(svg)
}

/// The last body at or before a time.
fn row_at(bodies: &[&Body], time_s: f64) -> usize {
    bodies.partition_point(|body| body.time_s <= time_s + 1e-9).max(1) - 1
}

fn raised(at: &[f64; 3], by_m: f64) -> [f64; 3] {
    [at[0], at[1], at[2] + by_m]
}

fn mean<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for point in points {
        (0..3).for_each(|axis| sum[axis] += point[axis]);
        count += 1.0;
    }
    sum.map(|sum| sum / f64::max(count, 1.0))
}

fn center(solid: &SolidInfo) -> [f64; 3] {
    mean(solid.lines_m.iter().flatten())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// Names of carried objects, each once.
fn objects(log: &RunLog) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for object in &log.info.carried {
        if !names.contains(&object.name.as_str()) {
            names.push(&object.name);
        }
    }
    names
}

/// An object, and where the tip has it at each frame: it stands where it is taken before, and where it is put behind; nowhere once it is lost.
fn carried<'a>(
    log: &'a RunLog,
    bodies: &[&Body],
    name: &str,
    time_s: impl Fn(usize) -> f64,
) -> (&'a CarriedInfo, Vec<Option<[f64; 3]>>) {
    let entries: Vec<&CarriedInfo> = log.info.carried.iter().filter(|object| object.name == name).collect();
    let lost = |from_s: f64, to_s: f64| {
        let is_loss = |code| [FaultRecord::DROPPED, FaultRecord::LEFT_BEHIND].contains(&code);
        log.faults.iter().any(|fault| is_loss(fault.code) && (from_s..=to_s).contains(&fault.time_s))
    };
    let place = |frame: usize| {
        let time_s = time_s(frame);
        let object = entries.iter().rev().find(|object| object.from_s <= time_s).unwrap_or(&entries[0]);
        let held_s = time_s.min(object.to_s.unwrap_or(f64::INFINITY)).max(object.from_s);
        let tip_m = bodies[row_at(bodies, held_s)].line_m.last().copied();
        tip_m.filter(|_| !lost(object.from_s, held_s))
    };
    (entries[0], (0..FRAMES).map(place).collect())
}

/// An attribute that has these values, frame by frame.
fn animated(attribute: &str, values: &str) -> String {
    format!(
        "<animate attributeName=\"{attribute}\" dur=\"{LASTS_S}s\" repeatCount=\"indefinite\" values=\"{values}\"/>"
    )
}

/// The parts between places where two points coincide, which keep their radius: each a line that moves, drawn three times.
fn draw_limb(svg: &mut String, view: &Projection, frames: &[&Body]) {
    let Some(first) = frames.first() else { return };
    let near = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_M);
    let mut starts = vec![0];
    starts.extend((1..first.line_m.len()).filter(|index| near(&first.line_m[index - 1], &first.line_m[*index])));
    starts.push(first.line_m.len());
    let parts = starts.windows(2).filter(|ends| ends[1] - ends[0] > 1).enumerate();
    for (index, ends) in parts {
        let count = (ends[1] - ends[0]).min(POINTS);
        let rows: Vec<usize> =
            (0..count).map(|point| ends[0] + point * (ends[1] - ends[0] - 1) / (count - 1)).collect();
        let line = |body: &Body| rows.iter().map(|row| view.text(&body.line_m[*row])).collect::<Vec<_>>().join(" ");
        let values = frames.iter().map(|body| line(body)).collect::<Vec<_>>().join(";");
        let _ = writeln!(
            svg,
            "<defs><polyline id=\"part{index}\" points=\"{}\">{}</polyline></defs>",
            line(first),
            animated("points", &values)
        );
        let kind = if ends[1] - ends[0] == 2 { "rigid" } else { "tube" };
        let width = 2.0 * view.length(rows.iter().map(|row| first.radius_m[*row]).sum::<f64>() / count as f64);
        for (share, class) in ROUND {
            let _ = writeln!(
                svg,
                "<use href=\"#part{index}\" class=\"{kind} {class}\" stroke-width=\"{:.1}\"/>",
                share * width
            );
        }
    }
}

/// The path of the tip as far as it has come.
fn draw_trail(svg: &mut String, view: &Projection, bodies: &[&Body], time_s: impl Fn(usize) -> f64) {
    let shown: Vec<&Body> = bodies.iter().step_by(bodies.len().div_ceil(TIPS)).chain(bodies.last()).copied().collect();
    let tips: Vec<[f64; 2]> = shown.iter().filter_map(|body| Some(view.at(body.line_m.last()?))).collect();
    let mut lengths = vec![0.0];
    for pair in tips.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
    }
    let whole = lengths.last().copied().unwrap_or(0.0).max(1e-9);
    let hidden = |frame: usize| format!("{:.4}", 1.0 - lengths[row_at(&shown, time_s(frame))] / whole);
    let hidden = (0..FRAMES).map(hidden).collect::<Vec<_>>().join(";");
    let line = tips.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ");
    let _ = writeln!(
        svg,
        "<polyline class=\"trail\" pathLength=\"1\" stroke-dasharray=\"1\" points=\"{line}\">{}</polyline>",
        animated("stroke-dashoffset", &hidden)
    );
}

/// The plate that the limb is mounted on, across its first piece.
fn draw_base(svg: &mut String, view: &Projection, body: &Body) {
    let ([x, y], [to_x, to_y]) = (view.at(&body.line_m[0]), view.at(&body.line_m[1]));
    let long = (to_x - x).hypot(to_y - y).max(1e-9);
    let half = PLATE * view.length(body.radius_m[0]) / long;
    let (across_x, across_y) = (-(to_y - y) * half, (to_x - x) * half);
    let [a_x, a_y, b_x, b_y] = [x - across_x, y - across_y, x + across_x, y + across_y];
    let _ = writeln!(svg, "<path class=\"base\" d=\"M{a_x:.1} {a_y:.1}L{b_x:.1} {b_y:.1}\"/>");
}

/// An upright cylinder, moved with the tip.
fn draw_object(svg: &mut String, view: &Projection, object: &CarriedInfo, places: &[Option<[f64; 3]>]) {
    let Some(known) = places.iter().flatten().next() else { return };
    let [x, y] = view.at(known);
    let [top, base] = [object.above_m, -object.below_m].map(|by_m| view.at(&raised(known, by_m))[1] - y);
    let (width, height) = (view.length(object.radius_m), view.length(object.radius_m) * flatness());
    let way = |place: &Option<[f64; 3]>| place.map_or([x, y], |place| view.at(&place));
    let moves =
        places.iter().map(|place| way(place).map(|at| format!("{at:.1}")).join(",")).collect::<Vec<_>>().join(";");
    let seen = places.iter().map(|place| if place.is_some() { "1" } else { "0" }).collect::<Vec<_>>().join(";");
    let _ = writeln!(
        svg,
        "<g class=\"object\" transform=\"translate({x:.1},{y:.1})\"><animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{LASTS_S}s\" \
         repeatCount=\"indefinite\" values=\"{moves}\"/>{}<path d=\"M{:.1} {top:.1}V{base:.1}A{width:.1} {height:.1} 0 0 0 {width:.1} {base:.1}V{top:.1}Z\"/>\
         <ellipse class=\"top\" cy=\"{top:.1}\" rx=\"{width:.1}\" ry=\"{height:.1}\"/></g>",
        animated("opacity", &seen),
        -width
    );
}

/// Solids of one layer, the farthest first.
fn draw_solids(svg: &mut String, view: &Projection, mut solids: Vec<&SolidInfo>, class: &str) {
    solids.sort_by(|a, b| depth(&center(b)).total_cmp(&depth(&center(a))));
    let _ = writeln!(svg, "<g class=\"{class}\">");
    solids.iter().for_each(|solid| draw_solid(svg, view, solid));
    svg.push_str("</g>\n");
}

fn draw_solid(svg: &mut String, view: &Projection, solid: &SolidInfo) {
    let class = if solid.region { "region" } else { "obstacle" };
    match &solid.shape {
        Some(SolidShape::Sphere { center_m, radius_m }) => {
            let [x, y] = view.at(center_m);
            let _ = writeln!(
                svg,
                "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>",
                view.length(*radius_m)
            );
        }
        Some(SolidShape::Capsule { from_m, to_m, radius_m }) => {
            let line = format!("{} {}", view.text(from_m), view.text(to_m));
            let width = 2.0 * view.length(*radius_m);
            let _ = writeln!(
                svg,
                "<polyline class=\"rod edge\" stroke-width=\"{:.1}\" points=\"{line}\"/>\
                 <polyline class=\"rod\" stroke-width=\"{width:.1}\" points=\"{line}\"/>",
                width + 2.0
            );
        }
        Some(SolidShape::Box { center_m, half_axes_m }) => {
            for (axis, half_m) in half_axes_m.iter().enumerate() {
                let side = if depth(half_m) < 0.0 { 1.0 } else { -1.0 };
                let [u, v] = [half_axes_m[(axis + 1) % 3], half_axes_m[(axis + 2) % 3]];
                let corner = |(a, b): (f64, f64)| {
                    let at: [f64; 3] = std::array::from_fn(|k| center_m[k] + side * half_m[k] + a * u[k] + b * v[k]);
                    view.text(&at)
                };
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).join(" ");
                let _ = writeln!(svg, "<polygon class=\"{class} face{axis}\" points=\"{corners}\"/>");
            }
        }
        // Logs of earlier versions have lines alone.
        None => {
            for line in &solid.lines_m {
                let line = line.iter().map(|at| view.text(at)).collect::<Vec<_>>().join(" ");
                let _ = writeln!(svg, "<polyline class=\"region\" points=\"{line}\"/>");
            }
        }
    }
}

/// The bar of time: moves thin, pauses thick, and the names of the phases where there is room.
fn draw_time(svg: &mut String, log: &RunLog, [begin_s, end_s]: [f64; 2]) {
    let (left, right, y) = (MARGIN, WIDTH - MARGIN, HEIGHT - 32.0);
    let x = |time_s: f64| left + (right - left) * ((time_s - begin_s) / (end_s - begin_s).max(1e-9)).clamp(0.0, 1.0);
    let _ = writeln!(svg, "<path class=\"bar\" d=\"M{left} {y}H{right}\"/>");
    let mut free = left;
    let known = log.info.phases.iter().filter(|phase| !(phase.start_s + phase.move_s + phase.hold_s).is_nan());
    for phase in known {
        let [start, held, end] =
            [phase.start_s, phase.start_s + phase.move_s, phase.start_s + phase.move_s + phase.hold_s].map(x);
        let _ = writeln!(svg, "<path class=\"hold\" d=\"M{held:.1} {y}H{end:.1}\"/>");
        let width = 6.6 * phase.name.chars().count() as f64;
        let at = (0.5 * (start + end)).clamp(left + 0.5 * width, (right - 0.5 * width).max(left + 0.5 * width));
        if at - 0.5 * width >= free {
            let _ = writeln!(
                svg,
                "<text class=\"soft\" x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                y + 20.0,
                escaped(&phase.name)
            );
            free = at + 0.5 * width + 6.0;
        }
    }
    let _ = writeln!(
        svg,
        "<circle class=\"now\" cy=\"{y}\" r=\"6\" cx=\"{left}\">{}</circle>",
        animated("cx", &format!("{left};{right}"))
    );
}

const STYLE: &str = "
:root { --page: #ffffff; --ink: #1b1f24; --soft: #57606a; --rule: #d9dee5; --trail: #cd4318; --limb: #569cc8; --dark: #2f6f9c; --light: #a9d0ea; --rigid: #8b949e;
  --rigid-dark: #57606a; --rigid-light: #c9d1d9; --region: #164f43; --obstacle: #cd8769; --object: #965f96; --object-top: #c9a3c9; }
@media (prefers-color-scheme: dark) { :root { --page: #14171b; --ink: #e6e9ee; --soft: #9aa4af; --rule: #333a44; --trail: #f7c359; --limb: #468cbe;
  --dark: #235a85; --light: #8cc1e4; --rigid: #6e7781; --rigid-dark: #424a53; --rigid-light: #afb8c1; --region: #c2fef3; --obstacle: #be785a;
  --object: #be78be; --object-top: #e3bde3; } }
.page { fill: var(--page); }
text { fill: var(--ink); font: 12px system-ui, sans-serif; }
.title { font-size: 14px; font-weight: 600; }
text.soft { fill: var(--soft); }
polyline { fill: none; stroke-linejoin: round; }
use { fill: none; stroke-linejoin: round; }
.tube.edge { stroke: var(--dark); } .tube.core { stroke: var(--limb); } .tube.light { stroke: var(--light); }
.rigid.edge { stroke: var(--rigid-dark); } .rigid.core { stroke: var(--rigid); } .rigid.light { stroke: var(--rigid-light); }
.obstacle { fill: var(--obstacle); stroke: var(--page); stroke-width: 0.5; }
.face0 { filter: brightness(0.92); } .face1 { filter: brightness(0.8); } .face2 { filter: brightness(1.08); }
.rod { stroke: var(--obstacle); stroke-linecap: round; filter: brightness(0.8); }
.rod.edge { stroke: var(--page); filter: none; }
.region { fill: none; stroke: var(--region); stroke-dasharray: 4 3; filter: none; }
.near { opacity: 0.6; }
.object { fill: var(--object); } .top { fill: var(--object-top); }
.trail { stroke: var(--trail); stroke-width: 2; }
.base { stroke: var(--soft); stroke-width: 6; }
.bar { stroke: var(--rule); stroke-width: 3; }
.hold { stroke: var(--soft); stroke-width: 5; }
.now { fill: var(--trail); }
";
