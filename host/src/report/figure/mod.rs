//! Line charts as SVG, made for the report: colors come from the page's style sheet,
//! so one drawing serves light, dark and paper; missing values are gaps; nothing that
//! is not a finite number reaches the text.

mod scale;
mod svg;
mod thin;

pub(super) use scale::span;

/// Color of a line, resolved by the page's style sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Color {
    /// As the text.
    Ink,
    /// For what stays in the background.
    Faint,
    /// First of the distinguishable colors.
    First,
    /// Second of the distinguishable colors.
    Second,
    /// Third of the distinguishable colors.
    Third,
    /// Fourth of the distinguishable colors.
    Fourth,
}

impl Color {
    /// The colors that tell lines apart, repeating.
    pub(super) fn nth(index: usize) -> Self {
        [Self::First, Self::Second, Self::Third, Self::Fourth][index % 4]
    }

    /// Class name in the style sheet.
    fn class(self) -> &'static str {
        match self {
            Self::Ink => "ink",
            Self::Faint => "faint",
            Self::First => "c1",
            Self::Second => "c2",
            Self::Third => "c3",
            Self::Fourth => "c4",
        }
    }
}

/// Stroke of a line: a second sign beside the color.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stroke {
    /// What was measured or happened.
    Solid,
    /// What was asked for.
    Dashed,
    /// What a model says.
    Dotted,
}

impl Stroke {
    /// Class name in the style sheet.
    fn class(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Dashed => "dashed",
            Self::Dotted => "dotted",
        }
    }
}

/// One line of a chart.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// Entry in the legend; none when empty.
    pub(super) label: String,
    /// Color.
    pub(super) color: Color,
    /// Stroke.
    pub(super) stroke: Stroke,
    /// Points in the units of the axes; a point that is not finite makes a gap.
    pub(super) points: Vec<[f64; 2]>,
}

/// One axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Quantity and unit.
    pub(super) label: String,
    /// Ends, ascending.
    pub(super) range: [f64; 2],
}

/// A stretch of the horizontal axis that is set off and named.
#[derive(Debug, Clone)]
pub(super) struct Band {
    /// Ends in the unit of the axis.
    pub(super) range: [f64; 2],
    /// Name, shown above where it fits.
    pub(super) label: String,
    /// True for every second one.
    pub(super) shaded: bool,
}

/// A word at a point.
#[derive(Debug, Clone)]
pub(super) struct Note {
    /// The point, in the units of the axes.
    pub(super) at: [f64; 2],
    /// The word.
    pub(super) text: String,
}

/// A chart. [`svg`](Chart::svg) draws it.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    /// What the chart shows, as a heading and for screen readers.
    pub(super) title: String,
    /// Width and height of the area between the axes, px.
    pub(super) area: [f64; 2],
    /// Horizontal axis.
    pub(super) x: Axis,
    /// Vertical axis.
    pub(super) y: Axis,
    /// Lines, the last on top.
    pub(super) series: Vec<Series>,
    /// Bands behind the lines.
    pub(super) bands: Vec<Band>,
    /// Vertical marks across the chart, in the unit of the horizontal axis.
    pub(super) marks: Vec<f64>,
    /// Words beside the lines.
    pub(super) notes: Vec<Note>,
}
