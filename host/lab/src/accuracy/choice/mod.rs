//! Error and cost of the models to choose from for a bender: analytic, cubic, device table, section FE, CalculiX.
//!
//! [`measure`] asks them about a seeded set of wound benders. `docs/evidence/accuracy.md` shows the record, `tests/golden/choice.tsv`.

mod benders;
mod command;
mod measure;
mod page;
mod picture;
mod tsv;

use serde::Serialize;
use softlimb::comparison::Comparison;
use softlimb_numerics::statistics::percentile;

pub(crate) use command::Command;
pub use measure::measure;
pub use page::{PLACE, page};
pub use picture::picture;

/// Seed of the published record.
pub const SEED: u64 = 18;
/// Number of benders of the published record.
pub const BENDERS: usize = 24;

/// A model of a bender.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The equations of `docs/explanation/model.md`.
    Analytic,
    /// The cubic that `fea calibrate` fits to the section.
    Cubic,
    /// The table of the device, built from the section.
    Table,
    /// Finite elements of the cross-section on the default mesh.
    Section,
    /// Finite elements in three dimensions.
    Calculix,
}

impl Model {
    /// All models, in the order of the record.
    pub const ALL: [Self; 5] = [Self::Analytic, Self::Cubic, Self::Table, Self::Section, Self::Calculix];

    /// Name in tables and pictures.
    pub fn name(self) -> &'static str {
        ["analytic", "cubic", "table", "section FE", "CalculiX"][self as usize]
    }

    /// Tasks that the model is the right one for.
    fn purpose(self) -> &'static str {
        match self {
            Self::Analytic => "straight actuators, where it is exact; benders whose stated error is small enough",
            Self::Cubic => "one bender on a controller of your own; fea calibrate states its error",
            Self::Table => "actuators on the device, if a table keeps its error",
            Self::Section => "wound benders and two windings; default where the analytic error is above 0.5 %",
            Self::Calculix => "caps, ends and the pitch of threads, by fea run",
        }
    }
}

/// Seconds that a model takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Before the first answer, for one bender.
    pub preparation: Option<f64>,
    /// A sixth of a curve of six pressures.
    pub answer: Option<f64>,
}

/// Errors of the models for one bender.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Radii, law, winding angle and highest pressure.
    pub bender: String,
    /// Largest relative error of the bend over six pressures, of all models but CalculiX; `None` where the model gives no answer.
    pub errors: [Option<f64>; 4],
    /// Largest estimated error of the reference itself.
    pub reference: f64,
}

/// The record.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Choice {
    /// Seed of the benders.
    pub seed: u64,
    /// One for each bender.
    pub rows: Vec<Row>,
    /// Of each model; the median of the benders, and of CalculiX that of one bender.
    pub seconds: [Seconds; 5],
}

/// Figures of a model over its benders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// The model.
    pub model: Model,
    /// Benders with an answer.
    pub count: usize,
    /// Median and largest error.
    pub errors: Option<[f64; 2]>,
    /// Its times.
    pub seconds: Seconds,
}

impl Choice {
    /// The figures of each model. Those of CalculiX are differences from the section in the published comparison.
    pub fn summaries(&self, validation: &Comparison) -> Vec<Summary> {
        let solid = || validation.lines().into_iter().filter(|line| line.case.starts_with("bending"));
        let summary = |model: Model| {
            let errors: Vec<f64> = match model {
                Model::Calculix => solid().filter_map(|line| line.worst[2].map(f64::abs)).collect(),
                _ => self.rows.iter().filter_map(|row| row.errors[model as usize]).collect(),
            };
            let [median, largest] = [50, 100].map(|percent| percentile(errors.iter().copied(), percent));
            Summary {
                model,
                count: errors.len(),
                errors: median.zip(largest).map(|(median, largest)| [median, largest]),
                seconds: self.seconds[model as usize],
            }
        };
        Model::ALL.map(summary).to_vec()
    }
}
