//! Draws a chart.

use super::scale::Scale;
use super::thin::thin;
use super::{Axis, Band, Chart, Series, Stroke, Ticks};
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
/// Width of a letter at the size of the legend, px: a generous guess, as no font is
/// measured.
const LETTER: f64 = 6.8;
/// Length of the stroke in the legend with its margins, px.
const SAMPLE: f64 = 40.0;
/// Distance of a note from its point, and half the size of a mark, px.
const ASIDE: f64 = 5.0;

impl Chart {
    /// The chart as an `svg` element of its own width that a page can stretch.
    pub fn svg(&self) -> String {
        let legend = legend_rows(&self.series, self.area[0]);
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
        svg.push_str("</svg>\n");
        svg
    }

    /// Height of the chart with its frame, px.
    pub(super) fn height(&self) -> f64 {
        self.top(legend_rows(&self.series, self.area[0]).len()) + self.area[1] + BOTTOM
    }

    /// Room above the area, px.
    fn top(&self, legend_rows: usize) -> f64 {
        let named = self.bands.iter().any(|band| !band.label.is_empty());
        ROW * (1.0 + legend_rows as f64 + f64::from(u8::from(named))) + 6.0
    }

    /// The notes, each beside its point: of the four places at its corners the one that covers the fewest other notes and marks.
    fn draw_notes(&self, svg: &mut String, frame: &Frame) {
        let is_finite = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
        let marks = self.series.iter().filter(|series| is_mark(series.stroke)).flat_map(|series| &series.points);
        let marks: Vec<[f64; 2]> = marks.map(|&point| frame.pixel(point)).filter(is_finite).collect();
        let mut taken: Vec<[f64; 4]> = Vec::new();
        for (note, [x, y]) in self.notes.iter().map(|note| (note, frame.pixel(note.at))) {
            if !is_finite(&[x, y]) {
                continue;
            }
            let width = text_width(&note.text);
            let places = [(1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(across, down)| {
                let left = if across > 0.0 { x + ASIDE } else { x - ASIDE - width };
                let top = if down > 0.0 { y + 4.0 } else { y - 14.0 };
                (across, [left, left + width, top, top + 11.0])
            });
            let cost = |[left, right, top, bottom]: [f64; 4]| {
                let is_over =
                    |other: &[f64; 4]| left < other[1] && other[0] < right && top < other[3] && other[2] < bottom;
                let notes = taken.iter().filter(|other| is_over(other)).count();
                let marks = marks.iter().filter(|[x, y]| is_over(&[x - 3.0, x + 3.0, y - 3.0, y + 3.0])).count();
                let is_outside =
                    left < frame.left || right > frame.right + RIGHT || top < frame.top - 14.0 || bottom > frame.bottom;
                10_000 * usize::from(is_outside) + 100 * notes + marks
            };
            let Some((across, place)) = places.into_iter().min_by_key(|(_, place)| cost(*place)) else { continue };
            taken.push(place);
            let (x, anchor) = if across > 0.0 { (place[0], "") } else { (place[1], " text-anchor=\"end\"") };
            let _ = writeln!(
                svg,
                "<text class=\"note\" x=\"{x:.1}\" y=\"{:.1}\"{anchor}>{}</text>",
                place[3] - 2.0,
                escape(&note.text)
            );
        }
    }

    /// Room left of the area, px: more where the vertical axis has names.
    fn left(&self) -> f64 {
        let Ticks::Names(names) = &self.y.ticks else { return LEFT };
        let label = if self.y.label.is_empty() { 0.0 } else { ROW };
        names.iter().map(|name| text_width(name) + 12.0 + label).fold(LEFT, f64::max)
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
            let (at, label) = (self.x.pixel(value), escape(&label));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/>\
                 <text class=\"tick-x\" x=\"{at:.1}\" y=\"{:.1}\">{label}</text>",
                bottom + 14.0
            );
        }
        for (value, label) in self.y.marks(&y.ticks, [38.0, 30.0]) {
            let (at, label) = (self.y.pixel(value), escape(&label));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{right:.1}\"/>\
                 <text class=\"tick-y\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
                left - 6.0,
                at + 3.6
            );
        }
        let (middle, height) = ((left + right) / 2.0, (top + bottom) / 2.0);
        let _ = writeln!(
            svg,
            "<path class=\"axis\" d=\"M{left:.1} {top:.1}V{bottom:.1}H{right:.1}\"/>\n\
             <text class=\"label\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>\n\
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
        if let Stroke::Cells { side, .. } = series.stroke {
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
            let _ = writeln!(svg, "<path class=\"{}\" d=\"{path}\"/>", classes(series));
        }
    }
}

fn is_mark(stroke: Stroke) -> bool {
    matches!(stroke, Stroke::Dots | Stroke::Rings | Stroke::Crosses | Stroke::Squares)
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
            let radius = if series.stroke == Stroke::Rings { 5.4 } else { 2.8 };
            writeln!(svg, "<circle class=\"{classes}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>")
        }
    };
}

fn classes(series: &Series) -> String {
    if let Stroke::Cells { .. } = series.stroke {
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
            } else if let Stroke::Cells { .. } = entry.stroke {
                let _ = writeln!(svg, "<path class=\"{}\" d=\"M{x:.1} {:.1}h22v-11h-22z\"/>", classes(entry), y + 1.0);
            } else {
                let _ = writeln!(svg, "<path class=\"{}\" d=\"M{x:.1} {:.1}h22\"/>", classes(entry), y - 3.5);
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
