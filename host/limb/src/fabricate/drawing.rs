//! Drawings with dimensions: an actuator along its axis with the winding, and across; the mold of its first cast along the axis.

use std::fmt::Write;

use fra_model::Motion;

use super::mold::{
    CAP_M, FIT_M, HOLD_M, NIPPLE_M, RECESS_M, SPIGOT_M, base_radius_m, cap_profile, nipple_m, port_profile,
    shell_radius_m,
};
use super::piece::Piece;
use super::{Hand, Settings, Winding, path};

/// Width of the drawing and longest picture of the actuator, px.
const WIDTH: f64 = 660.0;
const LONGEST: f64 = 560.0;
/// Largest height of the actuator seen from the side, and diameter of the cross-section, px.
const HIGHEST: f64 = 150.0;
const ACROSS: f64 = 150.0;
/// Left edge and room above, px.
const LEFT: f64 = 60.0;
const TOP: f64 = 34.0;
/// Height of the mold's dimensions in text, px.
const LINES: f64 = 146.0;
/// Gap between the two caps, px: holds the words at the air port.
const GAP: f64 = 70.0;
/// Chords of the drawn thread, as a share of its radius.
const CHORD: f64 = 0.02;
/// Half the drawn width of a strain-limiting layer across, rad: the model takes it as a line.
const LAYER_RAD: f64 = 0.12;

/// The drawing of a piece as an SVG element.
pub(super) fn drawing(piece: &Piece) -> String {
    let parameters = &piece.parameters;
    let (length_m, outer_m, inner_m) = (parameters.length_m, parameters.outer_radius_m, parameters.inner_radius_m);
    let scale = (LONGEST / length_m).min(HIGHEST / (2.0 * outer_m));
    let (long, half) = (length_m * scale, outer_m * scale);
    let axis = TOP + half;
    let across_scale = ACROSS / (2.0 * outer_m);
    let (middle_x, middle_y) = (LEFT + ACROSS / 2.0, axis + half + 70.0 + ACROSS / 2.0);
    let height = middle_y + ACROSS / 2.0 + 24.0;
    // Writing to a string cannot fail.
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" aria-label=\"Drawing of {}: along its axis, and across\">\n",
        piece.name
    );
    let _ = writeln!(
        svg,
        "<rect class=\"wall\" x=\"{LEFT}\" y=\"{:.2}\" width=\"{long:.2}\" height=\"{:.2}\"/>",
        axis - half,
        2.0 * half
    );
    for (winding, hand) in
        piece.windings().flat_map(|(_, winding)| winding.hands.iter().map(move |hand| (winding, hand)))
    {
        let class = if *hand == Hand::Left { "thread left" } else { "thread" };
        let _ = writeln!(svg, "<path class=\"{class}\" d=\"{}\"/>", front(winding, *hand, axis, scale));
    }
    let chamber = inner_m * scale;
    let _ = writeln!(
        svg,
        "<path class=\"hidden\" d=\"M{LEFT} {:.2}h{long:.2}M{LEFT} {:.2}h{long:.2}\"/><path class=\"center\" d=\"M{:.1} {axis:.2}h{:.1}\"/>",
        axis - chamber,
        axis + chamber,
        LEFT - 14.0,
        long + 28.0
    );
    let below = axis + half + 22.0;
    let _ = writeln!(
        svg,
        "<path class=\"dimension\" d=\"M{LEFT} {:.2}v30M{:.2} {:.2}v30M{LEFT} {below:.2}h{long:.2}\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\">length at rest {} mm</text>",
        axis + half + 2.0,
        LEFT + long,
        axis + half + 2.0,
        LEFT + long / 2.0,
        below - 5.0,
        mm(length_m)
    );
    let winding = &piece.winding;
    let angle = format!(
        "winding {:.1} deg from the hoop, {} thread{} in {}, at radius {} mm",
        winding.angle_rad.to_degrees(),
        winding.threads(),
        if winding.threads() == 1 { "" } else { "s" },
        // Only the front is drawn: the threads of two hands cross there.
        if winding.hands.len() == 1 { "1 hand" } else { "2 hands (right blue, left brown)" },
        mm(winding.radius_m)
    );
    let _ = writeln!(svg, "<text class=\"start\" x=\"{LEFT}\" y=\"16\">{angle}</text>");

    for (class, radius_m) in [("wall", outer_m), ("chamber", inner_m)] {
        let radius = radius_m * across_scale;
        let _ =
            writeln!(svg, "<circle class=\"{class}\" cx=\"{middle_x:.2}\" cy=\"{middle_y:.2}\" r=\"{radius:.2}\"/>");
    }
    let _ = writeln!(
        svg,
        "<circle class=\"hidden\" cx=\"{middle_x:.2}\" cy=\"{middle_y:.2}\" r=\"{:.2}\"/>",
        winding.radius_m * across_scale
    );
    let label_x = middle_x + ACROSS / 2.0 + 30.0;
    if parameters.motion == Motion::Bending {
        let (sin, cos) = f64::sin_cos(LAYER_RAD);
        let (radius, top) = (ACROSS / 2.0, middle_y - ACROSS / 2.0);
        let _ = writeln!(
            svg,
            "<path class=\"layer\" d=\"M{LEFT} {:.2}h{long:.2}\"/>\
             <path class=\"layer\" d=\"M{:.2} {:.2}A{radius:.2} {radius:.2} 0 0 1 {:.2} {:.2}\"/>\
             <path class=\"dimension\" d=\"M{middle_x:.2} {top:.2}H{label_x:.2}\"/>\
             <text class=\"start\" x=\"{:.1}\" y=\"{:.1}\">strain-limiting layer, on the side to which the actuator bends</text>",
            axis - half,
            middle_x - radius * sin,
            middle_y - radius * cos,
            middle_x + radius * sin,
            middle_y - radius * cos,
            label_x + 5.0,
            top + 4.0
        );
    }
    let notes = [
        (outer_m, -0.7, format!("outer diameter {} mm", mm(2.0 * outer_m))),
        (winding.radius_m, -0.1, format!("thread on diameter {} mm", mm(2.0 * winding.radius_m))),
        (inner_m, 0.5, format!("chamber diameter {} mm; wall {} mm", mm(2.0 * inner_m), mm(outer_m - inner_m))),
    ];
    for (radius_m, lean, text) in notes {
        let (sin, cos) = f64::sin_cos(lean);
        let (x, y) = (middle_x + radius_m * across_scale * cos, middle_y + radius_m * across_scale * sin);
        let (end, label) = (label_x, middle_y + ACROSS / 2.0 * sin);
        let _ = writeln!(
            svg,
            "<path class=\"dimension\" d=\"M{x:.2} {y:.2}L{end:.2} {label:.2}\"/><text class=\"start\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
            end + 5.0,
            label + 4.0
        );
    }
    svg + "</svg>"
}

/// The drawing of the mold of a piece as an SVG element: a section along the axis, with the caps that close the actuator below it.
pub(super) fn mold_drawing(piece: &Piece, settings: &Settings) -> String {
    let (length_m, inner_m) = (piece.parameters.length_m, piece.parameters.inner_radius_m);
    let (bore_m, outer_m) = (piece.cast_radius_m, piece.parameters.outer_radius_m);
    let (shell_m, base_m) = (shell_radius_m(bore_m), base_radius_m(bore_m));
    let whole_m = length_m + 2.0 * HOLD_M;
    let scale = (LONGEST / whole_m).min(HIGHEST / (2.0 * base_m));
    let half = base_m * scale;
    let (axis, begin) = (TOP + half, LEFT + HOLD_M * scale);
    let (long, end) = (length_m * scale, LEFT + whole_m * scale);
    let cap_top = axis + half + 106.0;
    let cap_scale = (0.5 * ACROSS / outer_m).min(ACROSS / (NIPPLE_M + CAP_M + SPIGOT_M));
    let cap_axis = cap_top + outer_m * cap_scale;
    let height = (cap_axis + outer_m * cap_scale).max(cap_top + LINES) + 16.0;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" aria-label=\"Drawing of the mold of {}: a section along its axis\">\n\
         <text class=\"start\" x=\"{LEFT}\" y=\"16\">mold of the first cast, cut along its axis; the base holds core and shells in line</text>\n",
        piece.name
    );
    // Writing to a string cannot fail.
    let mut band = |class: &str, [left, width]: [f64; 2], [low_m, high_m]: [f64; 2]| {
        let tall = (high_m - low_m) * scale;
        for top in [axis - high_m * scale, axis + low_m * scale] {
            let _ = writeln!(
                svg,
                "<rect class=\"{class}\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{tall:.2}\"/>"
            );
        }
    };
    band("part", [LEFT, HOLD_M * scale], [inner_m + FIT_M, base_m]);
    band("part", [begin, RECESS_M * scale], [shell_m + FIT_M, base_m]);
    band("part", [begin, long], [bore_m, shell_m]);
    band("wall", [begin, long], [inner_m, bore_m]);
    band("core", [LEFT, whole_m * scale], [0.0, inner_m]);
    let _ = writeln!(svg, "<path class=\"center\" d=\"M{:.1} {axis:.2}H{:.1}\"/>", LEFT - 14.0, end + 14.0);
    let below = axis + half;
    let core = match piece.segment {
        None => format!("core {} mm", mm(whole_m)),
        Some(segment) => format!("one core of {} mm through all segments", mm(segment.tube_m + 2.0 * HOLD_M)),
    };
    for (row, (from, to, text)) in
        [(begin, begin + long, format!("shells {} mm", mm(length_m))), (LEFT, end, core)].into_iter().enumerate()
    {
        let line = below + 22.0 + 26.0 * row as f64;
        let _ = writeln!(
            svg,
            "<path class=\"dimension\" d=\"M{from:.2} {:.2}V{:.2}M{to:.2} {:.2}V{:.2}M{from:.2} {line:.2}H{to:.2}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
            below + 2.0,
            line + 6.0,
            below + 2.0,
            line + 6.0,
            0.5 * (from + to),
            line - 5.0
        );
    }
    let _ = writeln!(
        svg,
        "<text class=\"start\" x=\"{LEFT}\" y=\"{:.1}\">caps, cut along their axes: of the far end, and of the near end with its air port</text>",
        cap_top - 12.0
    );
    cap_section(&mut svg, &cap_profile(piece), [LEFT, cap_axis], cap_scale);
    let port_left = LEFT + (CAP_M + SPIGOT_M) * cap_scale + GAP;
    let [hose_m, barb_m, port_m] = nipple_m(piece, settings);
    cap_section(&mut svg, &port_profile(piece, settings), [port_left, cap_axis], cap_scale);
    air_port(&mut svg, [barb_m, port_m], [port_left, cap_axis], cap_scale);
    let lines = [
        format!("core: diameter {} mm", mm(2.0 * inner_m)),
        format!("shells: bore {} mm, outer diameter {} mm", mm(2.0 * bore_m), mm(2.0 * shell_m)),
        format!("base: outer diameter {} mm, length {} mm", mm(2.0 * base_m), mm(HOLD_M + RECESS_M)),
        format!("base: bore {} mm for the core", mm(2.0 * (inner_m + FIT_M))),
        format!("base: recess {} mm by {} mm deep for the shells", mm(2.0 * (shell_m + FIT_M)), mm(RECESS_M)),
        format!("caps: disk {} mm by {} mm", mm(2.0 * outer_m), mm(CAP_M)),
        format!("caps: spigot {} mm by {} mm long", mm(2.0 * inner_m), mm(SPIGOT_M)),
        format!("air port: bore {} mm, through the cap", mm(2.0 * port_m)),
        format!("air port: nipple {} mm by {} mm long", mm(2.0 * hose_m), mm(NIPPLE_M)),
    ];
    let lines_left = port_left + (NIPPLE_M + CAP_M + SPIGOT_M) * cap_scale + 20.0;
    for (index, text) in lines.iter().enumerate() {
        let (x, y) = (lines_left, cap_top + 12.0 + 16.0 * index as f64);
        let _ = writeln!(svg, "<text class=\"start\" x=\"{x:.1}\" y=\"{y:.1}\">{text}</text>");
    }
    svg + "</svg>"
}

/// A cap along its axis, from its corners: radius and height, m. A bore is open.
fn cap_section(svg: &mut String, profile: &[[f64; 2]], [left, axis]: [f64; 2], scale: f64) {
    let low_m = profile.iter().map(|corner| corner[1]).fold(f64::INFINITY, f64::min);
    let high_m = profile.iter().map(|corner| corner[1]).fold(f64::NEG_INFINITY, f64::max);
    let bore = profile.iter().map(|corner| corner[0]).fold(f64::INFINITY, f64::min) * scale;
    let long = (high_m - low_m) * scale;
    let upper = profile.iter().copied();
    let lower = profile.iter().rev().map(|[radius_m, height_m]| [-radius_m, *height_m]);
    let mut outline = String::new();
    for (index, [radius_m, height_m]) in upper.chain(lower).enumerate() {
        let (x, y) = (left + (height_m - low_m) * scale, axis - radius_m * scale);
        let _ = write!(outline, "{}{x:.2} {y:.2}", if index == 0 { 'M' } else { 'L' });
    }
    let _ = writeln!(svg, "<path class=\"part\" d=\"{outline}z\"/>");
    if bore > 0.0 {
        let (top, tall) = (axis - bore, 2.0 * bore);
        let _ = writeln!(
            svg,
            "<rect class=\"chamber\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{long:.2}\" height=\"{tall:.2}\"/>"
        );
    }
    let _ = writeln!(svg, "<path class=\"center\" d=\"M{:.1} {axis:.2}h{:.1}\"/>", left - 14.0, long + 28.0);
}

/// Words at the air port, above and below its nipple, with lines to the bore and the barb.
fn air_port(svg: &mut String, [barb_m, bore_m]: [f64; 2], [left, axis]: [f64; 2], scale: f64) {
    let (end, far) = (left + NIPPLE_M * scale - 6.0, barb_m * scale + 14.0);
    let at = left + 0.2 * NIPPLE_M * scale;
    let words = [("bore", bore_m, -1.0, 0.0), ("barb", barb_m, 1.0, 11.0)];
    for (name, radius_m, side, drop) in words {
        let (from, to) = (axis + side * radius_m * scale, axis + side * far);
        let _ = writeln!(
            svg,
            "<path class=\"dimension\" d=\"M{at:.2} {from:.2}V{to:.2}\"/>\
             <text class=\"end\" x=\"{end:.1}\" y=\"{:.1}\">{name} {} mm</text>",
            to + 3.0 * side + drop,
            mm(2.0 * radius_m)
        );
    }
}

/// The visible half of the threads of a hand, seen with the bending direction up.
fn front(winding: &Winding, hand: Hand, axis: f64, scale: f64) -> String {
    let mut line = String::new();
    let mut last = None;
    for point in path::points(winding, hand, CHORD * winding.radius_m) {
        let [up_m, towards_m, along_m] = point.place_m;
        let is_seen = towards_m >= 0.0;
        let continues = last == Some((point.start, true));
        if is_seen {
            let step = if continues { 'L' } else { 'M' };
            let _ = write!(line, "{step}{:.1} {:.1}", LEFT + along_m * scale, axis - up_m * scale);
        }
        last = Some((point.start, is_seen));
    }
    line
}

fn mm(length_m: f64) -> String {
    // To a hundredth, without zeros at the end.
    let text = format!("{:.2}", 1e3 * length_m);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
