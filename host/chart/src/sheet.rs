//! Several charts as one document that stands by itself, light and dark.

use std::fmt::Write;

use super::Chart;
use super::svg::{escape, text_width};

/// Height of a line of the caption, and of the gap between rows, px.
const LINE: f64 = 18.0;
const GAP: f64 = 12.0;
/// Left edge of the caption, px.
const LEFT: f64 = 62.0;

/// The charts in rows and columns, each in a room of that width, px, below a caption.
pub fn sheet(rows: &[Vec<Chart>], room: f64, caption: &str) -> String {
    let width = room * rows.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let (mut body, mut top) = (String::new(), 6.0);
    for line in wrapped(caption, width - LEFT) {
        top += LINE;
        let _ = writeln!(body, "<text class=\"legend\" x=\"{LEFT}\" y=\"{:.0}\">{}</text>", top - 8.0, escape(&line));
    }
    for charts in rows {
        for (column, chart) in charts.iter().enumerate() {
            let place = format!("<svg x=\"{}\" y=\"{top:.1}\" ", column as f64 * room);
            body.push_str(&chart.svg().replacen("<svg ", &place, 1));
        }
        top += charts.iter().map(Chart::height).fold(0.0, f64::max) + GAP;
    }
    let hatch = if body.contains(" hatched\"") { HATCH } else { "" };
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {top:.0}\" width=\"{width:.0}\" \
         height=\"{top:.0}\">\n<style>{STYLE}</style>\n{hatch}<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n{body}</svg>\n"
    )
}

/// A text in lines that fit the width.
fn wrapped(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line) + text_width(word) < width => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The pattern of hatched cells.
const HATCH: &str = "<defs><pattern id=\"hatch\" width=\"5\" height=\"5\" patternUnits=\"userSpaceOnUse\" \
                     patternTransform=\"rotate(45)\"><path class=\"faint\" d=\"M2.5 0V5\"/></pattern></defs>\n";

const STYLE: &str = "
:root { --page: #ffffff; --ink: #1b1f24; --soft: #57606a; --grid: #d9dee5; --c1: #0072b2; --c2: #cd4318; --c3: #164f43; --c4: #78176d;
  --c5: #997700; }
@media (prefers-color-scheme: dark) { :root { --page: #14171b; --ink: #e6e9ee; --soft: #9aa4af; --grid: #333a44; --c1: #56b4e9;
  --c2: #f7c359; --c3: #c2fef3; --c4: #e73893; --c5: #e0c04c; } }
.page { fill: var(--page); }
text { fill: var(--ink); font: 11.5px system-ui, sans-serif; }
.title { font-size: 13px; font-weight: 600; }
.letter { font-weight: 600; }
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
.dashdotted { stroke-dasharray: 9 4 1 4; }
.ink { stroke: var(--ink); fill: var(--ink); }
.faint { stroke: var(--soft); fill: var(--soft); }
.c1 { stroke: var(--c1); fill: var(--c1); }
.c2 { stroke: var(--c2); fill: var(--c2); }
.c3 { stroke: var(--c3); fill: var(--c3); }
.c4 { stroke: var(--c4); fill: var(--c4); }
.c5 { stroke: var(--c5); fill: var(--c5); }
path.line, .rings { fill: none; }
.cells { stroke: none; }
.hatched { fill: url(#hatch); }
.shade1 { fill-opacity: 0.3; }
.shade2 { fill-opacity: 0.46; }
.shade3 { fill-opacity: 0.63; }
.shade4 { fill-opacity: 0.81; }
.shade5 { fill-opacity: 1; }
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_are_wrapped_between_words_and_escaped() {
        assert_eq!(wrapped("one two  three", 60.0), ["one two", "three"]);
        assert_eq!(wrapped("", 60.0), [""; 0]);
        assert!(sheet(&[], 400.0, "a&b").contains(">a&amp;b<"));
    }
}
