//! Charts as SVG, made for the report: colors come from the page's style sheet,
//! so one drawing serves light, dark and paper; missing values are gaps; nothing that
//! is not a finite number reaches the text.

mod label;
mod scale;
mod sheet;
mod svg;
mod thin;

pub use label::{WEIGHTLESS, labelled};
pub use scale::{span, steps};
pub use sheet::sheet;

/// Color of a line, resolved by the page's style sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Color {
    /// As the text.
    Ink,
    /// For what stays in the background.
    Faint,
    /// As the grid, for lines that stand in its place.
    Grid,
    /// First of the distinguishable colors.
    First,
    /// Second of the distinguishable colors.
    Second,
    /// Third of the distinguishable colors.
    Third,
    /// Fourth of the distinguishable colors.
    Fourth,
    /// Fifth of the distinguishable colors.
    Fifth,
}

impl Color {
    /// The colors that tell lines apart, repeating.
    pub fn nth(index: usize) -> Self {
        [Self::First, Self::Second, Self::Third, Self::Fourth][index % 4]
    }

    /// Class name in the style sheet.
    fn class(self) -> &'static str {
        match self {
            Self::Ink => "ink",
            Self::Faint => "faint",
            Self::Grid => "grid",
            Self::First => "c1",
            Self::Second => "c2",
            Self::Third => "c3",
            Self::Fourth => "c4",
            Self::Fifth => "c5",
        }
    }
}

/// Stroke of a line: a second sign beside the color.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stroke {
    /// Measurements.
    Solid,
    /// Measurements under others of about the same values: their edges stay in sight. The number of lines above this one, and of all.
    Nested(u8, u8),
    /// Set points.
    Dashed,
    /// Predictions of a model.
    Dotted,
    /// Lines beside those.
    DashDotted,
    /// Marks without a line: filled ...
    Dots,
    /// ... open, wide enough to show around a filled one ...
    Rings,
    /// ... two strokes across each other ...
    Crosses,
    /// ... and open squares.
    Squares,
    /// Squares about the points: their side in the units of the axes, and a shade from 1, the palest, to 5.
    Cells {
        /// Length of a side.
        side: f64,
        /// The shade.
        shade: u8,
    },
    /// Squares as those, hatched.
    Hatched {
        /// Length of a side.
        side: f64,
    },
}

impl Stroke {
    /// Class name in the style sheet.
    fn class(self) -> &'static str {
        match self {
            Self::Solid | Self::Nested(..) => "solid",
            Self::Dashed => "dashed",
            Self::Dotted => "dotted",
            Self::DashDotted => "dashdotted",
            Self::Dots => "dots",
            Self::Rings => "rings",
            Self::Crosses => "crosses",
            Self::Squares => "squares",
            Self::Hatched { .. } => "hatched",
            Self::Cells { shade, .. } => {
                ["shade1", "shade2", "shade3", "shade4", "shade5"][usize::from(shade.clamp(1, 5)) - 1]
            }
        }
    }
}

/// One line of a chart.
#[derive(Debug, Clone)]
pub struct Series {
    /// Entry in the legend; none when empty.
    pub label: String,
    /// Color.
    pub color: Color,
    /// Stroke.
    pub stroke: Stroke,
    /// Points in the units of the axes; a point that is not finite makes a gap.
    pub points: Vec<[f64; 2]>,
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Ends, ascending.
    pub range: [f64; 2],
    /// The marks along it.
    pub ticks: Ticks,
}

/// Marks along an axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ticks {
    /// Round values.
    Round,
    /// Powers of ten: the values are their exponents.
    Powers,
    /// A name for each of the values 0, 1, 2 ...; an axis without names has no line.
    Names(Vec<String>),
}

/// A stretch of the horizontal axis that is set off and named.
#[derive(Debug, Clone)]
pub struct Band {
    /// Ends in the unit of the axis.
    pub range: [f64; 2],
    /// Name, shown above where it fits.
    pub label: String,
    /// True for every second one.
    pub shaded: bool,
}

/// A word at a point.
#[derive(Debug, Clone)]
pub struct Note {
    /// The point, in the units of the axes.
    pub at: [f64; 2],
    /// The word.
    pub text: String,
    /// The meaning of a letter that stands for longer words, for a key below the chart; empty for other words.
    pub meaning: String,
}

/// A chart. [`svg`](Chart::svg) draws it.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Heading, also for screen readers.
    pub title: String,
    /// Width and height of the area between the axes, px.
    pub area: [f64; 2],
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Lines, the last on top.
    pub series: Vec<Series>,
    /// Bands behind the lines.
    pub bands: Vec<Band>,
    /// Vertical marks across the chart, in the unit of the horizontal axis.
    pub marks: Vec<f64>,
    /// Words beside the lines.
    pub notes: Vec<Note>,
}
