//! Draws a chart.

use super::scale::Scale;
use super::thin::thin;
use super::{Axis, Band, Chart, Note, Series, Stroke, Ticks};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Room left of the area for tick labels and the axis label, px.
const LEFT: f64 = 62.0;
/// Room right of the area, px.
const RIGHT: f64 = 14.0;
/// Room below the area, px.
const BOTTOM: f64 = 40.0;
/// Height of the heading, of one row of the legend, and of the band names, px.
const ROW: f64 = 18.0;
/// Width of the uppermost line of several on each other, and their difference in width, px.
const NESTED: [f64; 2] = [1.5, 2.0];
/// Largest difference in width of nested lines, px.
const NESTED_MOST: f64 = 6.0;
/// Width of a letter at the size of the legend, px: a generous guess, as no font is
/// measured.
const LETTER: f64 = 6.8;
/// Length of the stroke in the legend with its margins, px.
const SAMPLE: f64 = 40.0;
/// Distances of a note from its point, the preferred one first, px.
const ASIDE: [f64; 5] = [5.0, 9.0, 16.0, 26.0, 40.0];
/// Distance from which on a note has a line to its point, px.
const LED: f64 = 16.0;
/// Directions of a note from its point: across and down.
const SIDES: [[f64; 2]; 8] =
    [[1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

/// The first of them for letters: right of the point.
const BESIDE: usize = 4;
/// Room of a letter of the key with its margins, and left edge of the key, px.
const KEY: f64 = 26.0;
const KEY_LEFT: f64 = 13.0;

impl Chart {
    /// The chart as an `svg` element of its own width that a page can stretch.
    pub fn svg(&self) -> String {
        let legend = legend_rows(&self.series, self.area[0]);
        let key = self.key();
        let (left, top) = (self.left(), self.top(legend.len()));
        let [width, height] = [left + self.area[0] + RIGHT, self.height()];
        let title = escape(&self.title);
        let mut svg = format!(
            "<svg viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" role=\"img\" \
             aria-label=\"{title}\">\n<text class=\"title\" x=\"{left:.1}\" y=\"13\">{title}</text>\n",
        );
        draw_legend(&mut svg, &legend, left);
        let frame = Frame {
            x: Scale::new(self.x.range, [left, left + self.area[0]]),
            y: Scale::new(self.y.range, [top + self.area[1], top]),
            left,
            right: left + self.area[0],
            top,
            bottom: top + self.area[1],
        };
        self.bands.iter().for_each(|band| frame.draw_band(&mut svg, band));
        frame.draw_axes(&mut svg, &self.x, &self.y);
        self.marks.iter().for_each(|&mark| frame.draw_line_across(&mut svg, mark));
        self.series.iter().for_each(|series| frame.draw_series(&mut svg, series));
        self.draw_notes(&mut svg, &frame);
        self.draw_key(&mut svg, &key, frame.bottom + BOTTOM);
        svg.push_str("</svg>\n");
        svg
    }

    /// Height of the chart with its frame, px.
    pub(super) fn height(&self) -> f64 {
        let key = self.key_columns(&self.key()).1 as f64 * ROW;
        self.top(legend_rows(&self.series, self.area[0]).len()) + self.area[1] + BOTTOM + key
    }

    /// The notes that stand for longer words, each once, by letter.
    fn key(&self) -> Vec<&Note> {
        let mut key: Vec<&Note> = Vec::new();
        for note in self.notes.iter().filter(|note| !note.meaning.is_empty()) {
            if key.iter().all(|other| other.text != note.text) {
                key.push(note);
            }
        }
        key.sort_by(|a, b| a.text.cmp(&b.text));
        key
    }

    /// Width of a column of the key, px, and number of its rows.
    fn key_columns(&self, key: &[&Note]) -> (f64, usize) {
        let widths = key.iter().map(|note| KEY + text_width(&note.meaning));
        let width = widths.fold(1.0, f64::max);
        let columns = ((self.left() + self.area[0]) / width).max(1.0) as usize;
        (width, key.len().div_ceil(columns))
    }

    /// The meanings of notes, in columns below the chart.
    fn draw_key(&self, svg: &mut String, key: &[&Note], top: f64) {
        let (width, rows) = self.key_columns(key);
        for (index, note) in key.iter().enumerate() {
            let (x, y) = (KEY_LEFT + width * (index / rows) as f64, top + ROW * (index % rows) as f64 + 13.0);
            let _ = writeln!(
                svg,
                "<text class=\"letter\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>\
                 <text class=\"legend\" x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
                escape(&note.text),
                x + 16.0,
                escape(&note.meaning)
            );
        }
    }

    /// Room above the area, px.
    fn top(&self, legend_rows: usize) -> f64 {
        let named = self.bands.iter().any(|band| !band.label.is_empty());
        ROW * (1.0 + legend_rows as f64 + f64::from(u8::from(named))) + 6.0
    }

    /// The notes, each beside its point: at the nearest place that covers neither a mark nor another note.
    fn draw_notes(&self, svg: &mut String, frame: &Frame) {
        let is_finite = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
        let marks = self.series.iter().filter(|series| is_mark(series.stroke));
        let marks =
            marks.flat_map(|series| series.points.iter().map(|&point| (frame.pixel(point), half(series.stroke))));
        let marks: Vec<([f64; 2], f64)> = marks.filter(|(at, _)| is_finite(at)).collect();
        let mut taken: Vec<Place> = Vec::new();
        for (note, at) in self.notes.iter().map(|note| (note, frame.pixel(note.at))) {
            if !is_finite(&at) {
                continue;
            }
            // A letter beside its mark is at the height of no other.
            let first = if note.meaning.is_empty() { 0 } else { BESIDE };
            let sides = || SIDES.into_iter().cycle().skip(first).take(SIDES.len());
            let places =
                ASIDE.into_iter().flat_map(|far| sides().map(move |side| Place::new(at, side, far, &note.text)));
            let cost = |place: &Place| {
                let Place { left, right, top, bottom, far, .. } = *place;
                let is_outside =
                    left < frame.left || right > frame.right + RIGHT || top < frame.top - 14.0 || bottom > frame.bottom;
                let notes = taken.iter().filter(|other| place.is_over(other)).count();
                let covered = marks.iter().filter(|(at, half)| place.covers(*at, *half)).count();
                let crossed = marks.iter().filter(|(mark, half)| place.leads_over(at, *mark, *half)).count();
                1e6 * f64::from(u8::from(is_outside)) + 1e4 * (notes + covered) as f64 + 1e3 * crossed as f64 + far
            };
            let Some(place) = places.min_by(|a, b| cost(a).total_cmp(&cost(b))) else { continue };
            place.draw(svg, at, &note.text);
            taken.push(place);
        }
    }

    /// Room left of the area, px: more where the vertical axis has names.
    fn left(&self) -> f64 {
        let Ticks::Names(names) = &self.y.ticks else { return LEFT };
        let label = if self.y.label.is_empty() { 0.0 } else { ROW };
        names.iter().map(|name| text_width(name) + 12.0 + label).fold(LEFT, f64::max)
    }
}

/// A place of a note, px.
struct Place {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    /// Direction from the point, across.
    across: f64,
    /// Distance from the point.
    far: f64,
}

impl Place {
    fn new([x, y]: [f64; 2], [across, down]: [f64; 2], far: f64, text: &str) -> Self {
        let width = text_width(text);
        let left = x + across * far - 0.5 * (1.0 - across) * width;
        let top = y - 5.5 + down * (far + 4.0);
        Self { left, right: left + width, top, bottom: top + 11.0, across, far }
    }

    fn is_over(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    /// Whether it covers a part of a mark.
    fn covers(&self, [x, y]: [f64; 2], half: f64) -> bool {
        self.left < x + half && x - half < self.right && self.top < y + half && y - half < self.bottom
    }

    /// The end of the line to its point: there is none nearby.
    fn led(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        (self.far >= LED).then(|| [x.clamp(self.left, self.right), y.clamp(self.top, self.bottom)])
    }

    /// Whether the line to its point crosses another mark.
    fn leads_over(&self, from: [f64; 2], mark: [f64; 2], half: f64) -> bool {
        let Some(to) = self.led(from) else { return false };
        let [along, aside] = [[to[0] - from[0], to[1] - from[1]], [mark[0] - from[0], mark[1] - from[1]]];
        let share = (along[0] * aside[0] + along[1] * aside[1]) / (along[0].powi(2) + along[1].powi(2)).max(1e-9);
        let share = share.clamp(0.0, 1.0);
        let is_other = aside[0].hypot(aside[1]) > 1.0;
        is_other && (aside[0] - share * along[0]).hypot(aside[1] - share * along[1]) < half
    }

    fn draw(&self, svg: &mut String, at: [f64; 2], text: &str) {
        if let Some([x, y]) = self.led(at) {
            let _ = writeln!(svg, "<path class=\"axis\" d=\"M{:.1} {:.1}L{x:.1} {y:.1}\"/>", at[0], at[1]);
        }
        let (x, anchor) = match self.across {
            1.0 => (self.left, ""),
            -1.0 => (self.right, " text-anchor=\"end\""),
            _ => (0.5 * (self.left + self.right), " text-anchor=\"middle\""),
        };
        let y = self.bottom - 2.0;
        let _ = writeln!(svg, "<text class=\"note\" x=\"{x:.1}\" y=\"{y:.1}\"{anchor}>{}</text>", escape(text));
    }
}

/// The area between the axes, px.
struct Frame {
    x: Scale,
    y: Scale,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame {
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.pixel(x), self.y.pixel(y)]
    }

    /// The part of an interval of the horizontal axis that is inside, px.
    fn inside(&self, range: [f64; 2]) -> Option<[f64; 2]> {
        let [from, to] = range.map(|x| self.x.pixel(x).clamp(self.left, self.right));
        (to > from).then_some([from, to])
    }

    fn draw_band(&self, svg: &mut String, band: &Band) {
        let Some([from, to]) = self.inside(band.range) else { return };
        let (top, height, width) = (self.top, self.bottom - self.top, to - from);
        if band.shaded {
            let _ = writeln!(
                svg,
                "<rect class=\"band\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
            );
        }
        if text_width(&band.label) <= width {
            let middle = (from + to) / 2.0;
            let _ = writeln!(
                svg,
                "<text class=\"band-name\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>",
                top - 5.0,
                escape(&band.label)
            );
        }
    }

    fn draw_axes(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let Self { left, right, top, bottom, .. } = *self;
        let spacing = ((right - left) / 8.0).clamp(48.0, 90.0);
        for (value, label) in self.x.marks(&x.ticks, [spacing; 2]) {
            let (at, label) = (self.x.pixel(value), tick(&x.ticks, &label));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/>\
                 <text class=\"tick-x\" x=\"{at:.1}\" y=\"{:.1}\">{label}</text>",
                bottom + if x.ticks == Ticks::Powers { 18.0 } else { 14.0 }
            );
        }
        for (value, label) in self.y.marks(&y.ticks, [38.0, 30.0]) {
            let (at, label) = (self.y.pixel(value), tick(&y.ticks, &label));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{right:.1}\"/>\
                 <text class=\"tick-y\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
                left - 6.0,
                at + 3.6
            );
        }
        let (middle, height) = ((left + right) / 2.0, (top + bottom) / 2.0);
        let [has_x, has_y] = [x, y].map(|axis| axis.ticks != Ticks::Names(Vec::new()));
        if has_x || has_y {
            let down = if has_y { format!("V{bottom:.1}") } else { format!("M{left:.1} {bottom:.1}") };
            let along = if has_x { format!("H{right:.1}") } else { String::new() };
            let _ = writeln!(svg, "<path class=\"axis\" d=\"M{left:.1} {top:.1}{down}{along}\"/>");
        }
        let _ = writeln!(
            svg,
            "<text class=\"label\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>\n\
             <text class=\"label\" transform=\"translate(13 {height:.1}) rotate(-90)\">{}</text>",
            bottom + 32.0,
            escape(&x.label),
            escape(&y.label)
        );
    }

    fn draw_line_across(&self, svg: &mut String, value: f64) {
        let at = self.x.pixel(value);
        if at >= self.left && at <= self.right {
            let _ = writeln!(svg, "<path class=\"mark\" d=\"M{at:.1} {:.1}V{:.1}\"/>", self.top, self.bottom);
        }
    }

    /// Squares as one path; those side by side are one rectangle.
    fn draw_cells(&self, svg: &mut String, series: &Series, side: f64) {
        let mut rows: BTreeMap<i64, Vec<i64>> = BTreeMap::new();
        for [x, y] in series.points.iter().filter(|point| point.iter().all(|value| value.is_finite())) {
            rows.entry((y / side).floor() as i64).or_default().push((x / side).floor() as i64);
        }
        let mut path = String::new();
        for (row, mut columns) in rows {
            columns.sort_unstable();
            columns.dedup();
            for run in columns.chunk_by(|left, right| left + 1 == *right) {
                let corner = |column: i64, row: i64| self.pixel([column as f64 * side, row as f64 * side]);
                let ([left, bottom], [right, top]) = (corner(run[0], row), corner(run[0] + run.len() as i64, row + 1));
                let _ = write!(path, "M{left:.1} {top:.1}H{right:.1}V{bottom:.1}H{left:.1}z");
            }
        }
        if !path.is_empty() {
            let _ = writeln!(svg, "<path class=\"{}\" d=\"{path}\"/>", classes(series));
        }
    }

    fn draw_series(&self, svg: &mut String, series: &Series) {
        if let Stroke::Cells { side, .. } | Stroke::Hatched { side } = series.stroke {
            return self.draw_cells(svg, series, side);
        }
        if is_mark(series.stroke) {
            for &point in series.points.iter().filter(|point| point.iter().all(|value| value.is_finite())) {
                draw_mark(svg, series, self.pixel(point));
            }
            return;
        }
        // What is not finite must stay so on the way: the scale clamps infinities.
        let pixels = series.points.iter().map(|&point| match point.iter().all(|value| value.is_finite()) {
            true => self.pixel(point),
            false => [f64::NAN; 2],
        });
        let mut path = String::new();
        for piece in thin(pixels) {
            for (index, [x, y]) in piece.iter().enumerate() {
                let _ = write!(path, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
            }
            if piece.len() == 1 {
                // A line of no length: with round ends it shows as a dot.
                path.push_str("h0");
            }
        }
        if !path.is_empty() {
            let _ = writeln!(svg, "<path class=\"{}\"{} d=\"{path}\"/>", classes(series), width(series));
        }
    }
}

/// The width of a line as an attribute, where it is not that of the style sheet.
fn width(series: &Series) -> String {
    let Stroke::Nested(above, count) = series.stroke else { return String::new() };
    let step = NESTED[1].min(NESTED_MOST / f64::from(count.max(2) - 1));
    let width = NESTED[0] + step * f64::from(above);
    format!(" style=\"stroke-width:{}\"", (100.0 * width).round() / 100.0)
}

/// Dots of one series beyond which they are small, so that a cloud shows how dense it is.
const CROWD: usize = 100;

fn is_mark(stroke: Stroke) -> bool {
    matches!(stroke, Stroke::Dots | Stroke::Rings | Stroke::Crosses | Stroke::Squares)
}

fn is_cells(stroke: Stroke) -> bool {
    matches!(stroke, Stroke::Cells { .. } | Stroke::Hatched { .. })
}

/// Half the size of a mark with its stroke, px.
fn half(stroke: Stroke) -> f64 {
    match stroke {
        Stroke::Rings => 6.1,
        Stroke::Crosses | Stroke::Squares => 4.3,
        _ => 3.5,
    }
}

fn draw_mark(svg: &mut String, series: &Series, [x, y]: [f64; 2]) {
    let classes = classes(series);
    let _ = match series.stroke {
        Stroke::Crosses => {
            let (left, top) = (x - 3.6, y - 3.6);
            writeln!(svg, "<path class=\"{classes}\" d=\"M{left:.1} {top:.1}l7.2 7.2m0-7.2l-7.2 7.2\"/>")
        }
        Stroke::Squares => {
            let (left, top) = (x - 3.6, y - 3.6);
            writeln!(svg, "<path class=\"{classes}\" d=\"M{left:.1} {top:.1}h7.2v7.2h-7.2z\"/>")
        }
        _ => {
            let radius = match series.stroke {
                Stroke::Rings => 5.4,
                _ if series.points.len() > CROWD => 1.5,
                _ => 2.8,
            };
            writeln!(svg, "<circle class=\"{classes}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>")
        }
    };
}

fn classes(series: &Series) -> String {
    if is_cells(series.stroke) {
        return format!("cells {} {}", series.color.class(), series.stroke.class());
    }
    format!("line {} {}", series.color.class(), series.stroke.class())
}

/// Legend entries in rows that fit the width.
fn legend_rows(series: &[Series], width: f64) -> Vec<Vec<&Series>> {
    let mut rows: Vec<Vec<&Series>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in series.iter().filter(|entry| !entry.label.is_empty()) {
        let wanted = SAMPLE + text_width(&entry.label);
        if used + wanted > width {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += wanted;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

fn draw_legend(svg: &mut String, rows: &[Vec<&Series>], left: f64) {
    let mut y = ROW + 13.0;
    for row in rows {
        let mut x = left;
        for entry in row {
            if is_mark(entry.stroke) {
                draw_mark(svg, entry, [x + 11.0, y - 3.5]);
            } else if is_cells(entry.stroke) {
                let _ = writeln!(svg, "<path class=\"{}\" d=\"M{x:.1} {:.1}h22v-11h-22z\"/>", classes(entry), y + 1.0);
            } else {
                let (classes, width) = (classes(entry), width(entry));
                let _ = writeln!(svg, "<path class=\"{classes}\"{width} d=\"M{x:.1} {:.1}h22\"/>", y - 3.5);
            }
            let _ = writeln!(
                svg,
                "<text class=\"legend\" x=\"{:.1}\" y=\"{y:.1}\">{}</text>",
                x + 27.0,
                escape(&entry.label)
            );
            x += SAMPLE + text_width(&entry.label);
        }
        y += ROW;
    }
}

pub(super) fn text_width(text: &str) -> f64 {
    LETTER * text.chars().count() as f64
}

/// The label of a tick. Exponents have digits of the size of a note: the raised ones of a font are half as high.
fn tick(ticks: &Ticks, label: &str) -> String {
    match (ticks, label.split_once('^')) {
        (Ticks::Powers, Some((base, exponent))) => {
            let exponent = exponent.replace('-', "\u{2212}");
            format!("{base}<tspan dx=\"1\" dy=\"-5\" font-size=\"11\">{exponent}</tspan>")
        }
        _ => escape(label),
    }
}

/// Text as XML content or attribute. Control characters have no place in XML.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Attributes of the elements of a class that are written on lines of their own.
    fn elements(svg: &str, class: &str, names: [&str; 2]) -> Vec<[f64; 2]> {
        let value = |line: &str, name: &str| {
            let (_, rest) = line.split_once(&format!(" {name}=\"")).expect("an attribute");
            rest.split('"').next().and_then(|number| number.parse::<f64>().ok()).expect("a number")
        };
        let lines = svg.lines().filter(|line| line.contains(class));
        lines.map(|line| names.map(|name| value(line, name))).collect()
    }

    #[test]
    fn dots_of_a_cloud_are_small() {
        let axis = |label: &str| Axis { label: label.into(), range: [0.0, 1.0], ticks: Ticks::Round };
        let radii = |count: usize| {
            let points = (0..count).map(|index| [index as f64 / count as f64, 0.5]).collect();
            let chart = Chart {
                title: String::new(),
                area: [200.0, 200.0],
                x: axis("x"),
                y: axis("y"),
                series: vec![Series { label: String::new(), color: crate::Color::First, stroke: Stroke::Dots, points }],
                bands: Vec::new(),
                marks: Vec::new(),
                notes: Vec::new(),
            };
            elements(&chart.svg(), "dots", ["r", "cy"]).iter().map(|[r, _]| *r).collect::<Vec<_>>()
        };
        assert_eq!(radii(100), vec![2.8; 100]);
        assert_eq!(radii(101), vec![1.5; 101]);
    }

    /// A column of rings 13 px apart, each with a name.
    #[test]
    fn notes_cover_neither_marks_nor_each_other() {
        let axis = |label: &str| Axis { label: label.into(), range: [0.0, 100.0], ticks: Ticks::Round };
        let points: Vec<[f64; 2]> = (0..8).map(|row| [40.0, 20.0 + 6.5 * f64::from(row)]).collect();
        let note = |&at: &[f64; 2]| Note { at, text: "name".into(), meaning: String::new() };
        let chart = Chart {
            title: String::new(),
            area: [200.0, 200.0],
            x: axis("x"),
            y: axis("y"),
            notes: points.iter().map(note).collect(),
            series: vec![Series { label: String::new(), color: crate::Color::First, stroke: Stroke::Rings, points }],
            bands: Vec::new(),
            marks: Vec::new(),
        };
        let svg = chart.svg();
        let rings = elements(&svg, "rings", ["cx", "cy"]);
        let texts = svg.lines().filter(|line| line.contains("\"note\"")).map(|line| {
            // Four letters of at most 7 px, from the base line to 9 px above it.
            let [x, y] = elements(line, "note", ["x", "y"])[0];
            let before = if line.contains("\"end\"") {
                28.0
            } else if line.contains("\"middle\"") {
                14.0
            } else {
                0.0
            };
            [x - before, x - before + 28.0, y - 9.0, y]
        });
        let texts: Vec<[f64; 4]> = texts.collect();
        assert_eq!((rings.len(), texts.len()), (8, 8));
        for (index, [left, right, top, bottom]) in texts.iter().enumerate() {
            let is_free =
                |[x, y]: &[f64; 2]| x + 5.4 < *left || x - 5.4 > *right || y + 5.4 < *top || y - 5.4 > *bottom;
            assert!(rings.iter().all(is_free), "{svg}");
            let is_apart =
                |other: &[f64; 4]| other[1] < *left || other[0] > *right || other[3] < *top || other[2] > *bottom;
            assert!(texts[..index].iter().all(is_apart), "{svg}");
        }
    }

    /// Letters twice, the later one first.
    #[test]
    fn key_has_each_letter_once_in_order() {
        let axis = |label: &str| Axis { label: label.into(), range: [0.0, 100.0], ticks: Ticks::Powers };
        let note =
            |x: f64, text: &str, meaning: &str| Note { at: [x, 50.0], text: text.into(), meaning: meaning.into() };
        let mut chart = Chart {
            title: String::new(),
            area: [200.0, 200.0],
            x: axis("x"),
            y: axis("y"),
            notes: vec![note(20.0, "word", "")],
            series: Vec::new(),
            bands: Vec::new(),
            marks: Vec::new(),
        };
        let height = chart.height();
        assert!(!chart.svg().contains("\"letter\""));
        chart.notes.extend([note(60.0, "b", "closed form"), note(40.0, "a", "table"), note(80.0, "a", "table")]);
        let svg = chart.svg();
        let key: Vec<&str> = svg.lines().filter(|line| line.contains("\"letter\"")).collect();
        assert_eq!(key.len(), 2);
        assert!(key[0].contains(">a</text>") && key[0].contains(">table</text>"), "{svg}");
        assert!(key[1].contains(">b</text>") && key[1].contains(">closed form</text>"), "{svg}");
        assert_eq!(svg.matches(">table</text>").count(), 1);
        assert_eq!(chart.height(), height + ROW, "two columns");
        assert!(svg.contains(">10<tspan dx=\"1\" dy=\"-5\" font-size=\"11\">0</tspan></text>"), "{svg}");
    }
}
