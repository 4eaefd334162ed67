//! Several charts as one document that stands by itself, light and dark.

use super::Chart;

/// Height of the caption above the charts, px.
const CAPTION: f64 = 24.0;

/// The charts in rows and columns, each in a room of the given width and height, px, below a caption.
pub fn sheet(rows: &[Vec<Chart>], room: [f64; 2], caption: &str) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let [width, height] = [columns as f64 * room[0], rows.len() as f64 * room[1] + CAPTION];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\">\n<style>{STYLE}</style>\n<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n\
         <text class=\"legend\" x=\"62\" y=\"16\">{caption}</text>\n"
    );
    for (row, charts) in rows.iter().enumerate() {
        for (column, chart) in charts.iter().enumerate() {
            let place = format!("<svg x=\"{}\" y=\"{}\" ", column as f64 * room[0], row as f64 * room[1] + CAPTION);
            svg.push_str(&chart.svg().replacen("<svg ", &place, 1));
        }
    }
    svg + "</svg>\n"
}

const STYLE: &str = "
:root { --page: #ffffff; --ink: #1b1f24; --soft: #57606a; --grid: #d9dee5; --c1: #0072b2; --c2: #cd4318; --c3: #164f43; --c4: #78176d;
  --c5: #997700; }
@media (prefers-color-scheme: dark) { :root { --page: #14171b; --ink: #e6e9ee; --soft: #9aa4af; --grid: #333a44; --c1: #56b4e9;
  --c2: #f7c359; --c3: #c2fef3; --c4: #e73893; --c5: #e0c04c; } }
.page { fill: var(--page); }
text { fill: var(--ink); font: 11.5px system-ui, sans-serif; }
.title { font-size: 13px; font-weight: 600; }
.label, .tick-x { text-anchor: middle; }
.tick-y { text-anchor: end; }
.tick-x, .tick-y { fill: var(--soft); }
.note { font-size: 11px; paint-order: stroke; stroke: var(--page); stroke-width: 2.5px; }
path { fill: none; }
.axis { stroke: var(--soft); }
.grid { stroke: var(--grid); }
.line { stroke-width: 1.4; stroke-linejoin: round; stroke-linecap: round; }
.dashed { stroke-dasharray: 5 4; }
.dotted { stroke-dasharray: 1 4; }
.ink { stroke: var(--ink); fill: var(--ink); }
.faint { stroke: var(--soft); fill: var(--soft); }
.c1 { stroke: var(--c1); fill: var(--c1); }
.c2 { stroke: var(--c2); fill: var(--c2); }
.c3 { stroke: var(--c3); fill: var(--c3); }
.c4 { stroke: var(--c4); fill: var(--c4); }
.c5 { stroke: var(--c5); fill: var(--c5); }
path.line, .rings { fill: none; }
.cells { stroke: none; }
.shade1 { fill-opacity: 0.2; }
.shade2 { fill-opacity: 0.36; }
.shade3 { fill-opacity: 0.54; }
.shade4 { fill-opacity: 0.74; }
.shade5 { fill-opacity: 1; }
";
