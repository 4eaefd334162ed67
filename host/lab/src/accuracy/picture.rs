//! Error against cost as a picture: a chart for each problem, both axes in powers of ten, with the methods that no other one beats.

use super::report::{Report, Row};
use softlimb_chart::{Axis, Chart, Color, Note, Series, Stroke, Ticks, sheet};

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 340.0];
const ROOM: f64 = 400.0;
/// Errors below this are drawn on it: nothing in double precision is better.
const LEAST_ERROR: f64 = 1e-17;
/// And errors above this on that: they are no approximation.
const MOST_ERROR: f64 = 1e2;
/// A method is drawn if it applies to so many of the four motions.
const MOTIONS: usize = 3;
/// Marks of one name that are nearer to each other have it once, px.
const NEAR: f64 = 14.0;

const CAPTION: &str =
    "Largest error over all motions. In color: nothing cheaper is as accurate. Rings: single precision.";

/// A method over all motions.
struct Mark<'a> {
    method: &'a str,
    /// Exponents of cost and error.
    at: [f64; 2],
}

/// The picture as a document that stands by itself. Cost is the number of instructions where they were counted for every line, else
/// the time over that of the baseline.
pub fn picture(report: &Report) -> String {
    let counted = report.rows.iter().all(|row| row.cost.count.is_some());
    let cost = |row: &Row| if counted { row.cost.counted().0 } else { row.cost.time };
    let label = if counted { "instructions of one answer" } else { "time over that of the baseline" };
    let charts = ["forward", "inverse"].map(|problem| {
        let marks = ["f64", "f32"].map(|scalar| marks(report, (problem, scalar), &cost));
        chart(problem, &marks, label)
    });
    sheet(&[charts.to_vec()], ROOM, CAPTION)
}

/// The methods of a problem in a scalar: the largest error and the mean cost over the motions.
fn marks<'a>(report: &'a Report, (problem, scalar): (&str, &str), cost: &dyn Fn(&Row) -> Option<f64>) -> Vec<Mark<'a>> {
    let rows = || report.rows.iter().filter(|row| row.names[0] == problem && row.names[3] == scalar);
    let mut methods: Vec<&str> = Vec::new();
    for row in rows() {
        if !methods.contains(&row.names[1].as_str()) {
            methods.push(&row.names[1]);
        }
    }
    let mark = |method: &'a str| {
        let found: Vec<(f64, f64)> = rows()
            .filter(|row| row.names[1] == method)
            .filter_map(|row| Some((cost(row)?, row.accuracy.max_error.clamp(LEAST_ERROR, MOST_ERROR))))
            .collect();
        let mean = found.iter().map(|(cost, _)| cost).sum::<f64>() / found.len() as f64;
        let worst = found.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        let at = [mean.log10(), worst.log10()];
        (found.len() >= MOTIONS && at.iter().all(|value| value.is_finite())).then_some(Mark { method, at })
    };
    methods.into_iter().filter_map(mark).collect()
}

/// The marks that no other one beats in both, by rising cost.
fn front<'m, 'a>(marks: &'m [Mark<'a>]) -> Vec<&'m Mark<'a>> {
    let beats = |a: &Mark<'_>, b: &Mark<'_>| a.at[0] <= b.at[0] && a.at[1] <= b.at[1] && a.at != b.at;
    let mut front: Vec<&Mark<'_>> = marks.iter().filter(|mark| !marks.iter().any(|other| beats(other, mark))).collect();
    front.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    front
}

fn chart(problem: &str, marks: &[Vec<Mark<'_>>; 2], label: &str) -> Chart {
    let range = |axis: usize| {
        let values = marks.iter().flatten().map(|mark| mark.at[axis]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], e| [low.min(e), high.max(e)]);
        if low > high { [0.0, 1.0] } else { [(low - 0.2).floor(), (high + 0.2).ceil()] }
    };
    let (x, y) = (range(0), range(1));
    let (mut series, mut notes): (Vec<Series>, Vec<Note>) = (Vec::new(), Vec::new());
    let letters = letters(marks);
    for (marks, stroke) in marks.iter().zip([Stroke::Dots, Stroke::Rings]) {
        let points = marks.iter().map(|mark| mark.at).collect();
        series.push(Series { label: String::new(), color: Color::Faint, stroke, points });
    }
    let looks = [("double precision", Color::First, Stroke::Dots), ("single", Color::Second, Stroke::Rings)];
    for (marks, (name, color, stroke)) in marks.iter().zip(looks) {
        let front = front(marks);
        let points: Vec<[f64; 2]> = front.iter().map(|mark| mark.at).collect();
        series.push(Series { label: String::new(), color, stroke: Stroke::Dotted, points: points.clone() });
        series.push(Series { label: name.into(), color, stroke, points });
        for mark in front {
            let meaning = short(mark.method);
            let text = letters
                .iter()
                .find(|(_, name)| *name == meaning)
                .map_or(String::new(), |(letter, _)| letter.to_string());
            let px = |at: &[f64; 2], axis: usize| AREA[axis] * at[axis] / ([x, y][axis][1] - [x, y][axis][0]);
            let far = |at: &[f64; 2]| (px(at, 0) - px(&mark.at, 0)).hypot(px(at, 1) - px(&mark.at, 1));
            if !notes.iter().any(|note| note.text == text && far(&note.at) < NEAR) {
                notes.push(Note { at: mark.at, text, meaning });
            }
        }
    }
    let axis = |label: &str, range| Axis { label: label.to_owned(), range, ticks: Ticks::Powers };
    Chart {
        title: problem.to_owned(),
        area: AREA,
        x: axis(label, x),
        y: axis("largest relative error", y),
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes,
    }
}

/// Letters for the methods of both fronts, by rising cost.
fn letters(marks: &[Vec<Mark<'_>>; 2]) -> Vec<(char, String)> {
    let mut front: Vec<&Mark<'_>> = marks.iter().flat_map(|marks| front(marks)).collect();
    front.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    let mut names: Vec<String> = Vec::new();
    for name in front.into_iter().map(|mark| short(mark.method)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    ('a'..).zip(names).collect()
}

/// A method in the key.
fn short(method: &str) -> String {
    let words = [
        ("Newton, warm, ", "Newton, "),
        ("Newton, cold, to ", "Newton to "),
        ("Chebyshev, degree ", "Chebyshev "),
        ("table, degree ", "table "),
        ("forward, sheet", "model, sheet"),
        ("inverse, sheet", "model, sheet"),
        ("forward_from", "model, warm"),
        ("inverse_from", "model, warm"),
        ("inverse_near", "model, near"),
    ];
    let plain = words.iter().fold(method.to_owned(), |text, (from, to)| text.replace(from, to));
    if plain == "forward" || plain == "inverse" { "model".to_owned() } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_has_what_nothing_beats() {
        let mark = |method, at| Mark { method, at };
        let marks = [mark("dear", [3.0, -3.0]), mark("cheap", [1.0, -1.0]), mark("beaten", [3.0, -1.0])];
        let names: Vec<&str> = front(&marks).iter().map(|mark| mark.method).collect();
        assert_eq!(names, ["cheap", "dear"]);
    }
}
