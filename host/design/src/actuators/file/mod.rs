//! Problem files: JSON, described in `docs/reference/actuator-problem.md`. Errors name field, value, allowed range and line.

mod bounds;
mod segment;
mod winding;

use fra_model::Motion;
use serde::Deserialize;

use super::problem::{MOST, Problem, Segment};
use segment::SegmentSpec;
use softlimb_files::object::Object;
use softlimb_files::problem;
use softlimb_files::problem::{ProblemError, Refused, missing, require};
pub(crate) use winding::{PLACEMENTS, families, material, stated_or_named, thickness_m, wall_share};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    #[serde(default)]
    shared_pressure: bool,
    weights: Object<Weights>,
    segments: Vec<Object<SegmentSpec>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weights {
    length_per_m2: Option<f64>,
    outer_radius_per_m2: Option<f64>,
    bend_angle_per_rad2: Option<f64>,
    twist_per_rad2: Option<f64>,
    #[serde(default)]
    effort: f64,
    reference_pressure_pa: Option<f64>,
}

impl Problem {
    /// Reads a problem file.
    ///
    /// # Errors
    /// [`ProblemError`] at the first value that is not accepted.
    pub fn read(text: &str) -> Result<Self, ProblemError> {
        problem::read(text, File::problem)
    }
}

impl File {
    fn problem(&self) -> Result<Problem, Refused> {
        require(self.format == 1, "format", self.format, "1")?;
        let count = self.segments.len();
        require((1..=MOST).contains(&count), "segments", format!("[{count} items]"), "1 to 1000 items")?;
        let mut segments: Vec<Segment> = Vec::new();
        for (index, Object(spec)) in self.segments.iter().enumerate() {
            let at = format!("segments[{index}]");
            let segment = spec.segment(&at, &self.weights.0)?;
            let (phases, first) =
                (segment.goals.len(), segments.first().map_or(segment.goals.len(), |s| s.goals.len()));
            let allowed = format!("as many as the first segment has: {first}");
            require(phases == first, &format!("{at}.targets"), format!("[{phases} phases]"), &allowed)?;
            segments.push(segment);
        }
        self.weights.0.effort(&mut segments)?;
        Ok(Problem { segments, shared_pressure: self.shared_pressure })
    }
}

impl Weights {
    /// Shares the effort, a mean over segments and phases, among the squared pressures.
    fn effort(&self, segments: &mut [Segment]) -> Result<(), Refused> {
        require(self.effort >= 0.0, "weights.effort", self.effort, ">= 0")?;
        let field = "weights.reference_pressure_pa";
        if let Some(reference) = self.reference_pressure_pa {
            require(reference > 0.0, field, reference, "> 0")?;
        }
        let pressures: usize = segments.iter().map(|segment| segment.goals.len()).sum();
        for segment in segments {
            let reference_pa = self.reference_pressure_pa.unwrap_or(segment.pressure_max_pa);
            segment.effort_per_pa2 = self.effort / pressures as f64 / reference_pa.powi(2);
            let allowed = "large enough for a finite weight, effort/P_ref^2";
            require(segment.effort_per_pa2.is_finite(), field, reference_pa, allowed)?;
        }
        Ok(())
    }

    fn of(&self, motion: Motion) -> Result<f64, Refused> {
        let (name, value) = match motion {
            Motion::Extension => ("length_per_m2", self.length_per_m2),
            Motion::Expansion => ("outer_radius_per_m2", self.outer_radius_per_m2),
            Motion::Bending => ("bend_angle_per_rad2", self.bend_angle_per_rad2),
            Motion::Twisting => ("twist_per_rad2", self.twist_per_rad2),
        };
        let value = missing(value, format!("weights.{name}"), "a segment has such targets")?;
        require(value >= 0.0, &format!("weights.{name}"), value, ">= 0")?;
        Ok(value)
    }
}
