//! Problem files: JSON, described in `docs/reference/bundle-problem.md`. Errors name field, value, allowed range and line.

mod tube;

use serde::Deserialize;

use super::problem::{Attachment, ForceProblem, Place, Sample, Tube};
use crate::actuators::Bounds;
use softlimb_files::object::{NamedOr, Object};
use softlimb_files::problem;
use softlimb_files::problem::{ProblemError, Refused, bounds_from, require};
use tube::{BoundsSpec, FiberSpec, MaterialSpec, OwnBoundsSpec, TubeSpec, own};

/// Most actuators and samples of a file.
const MOST: usize = 100;
/// Least coordinate, height and slope.
const LEAST: f64 = -1e4;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    #[serde(default)]
    shared_geometry: bool,
    weights: Object<Weights>,
    material: NamedOr<MaterialSpec>,
    fiber: Object<FiberSpec>,
    bounds: Object<BoundsSpec>,
    actuators: Vec<Object<AttachmentSpec>>,
    samples: Vec<Object<SampleSpec>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weights {
    force_per_n: f64,
    torque_per_nm: f64,
    #[serde(default)]
    effort: f64,
    reference_pressure_pa: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AttachmentSpec {
    name: String,
    radius_m: Option<Bounds>,
    azimuth_deg: Option<Bounds>,
    x_m: Option<Bounds>,
    y_m: Option<Bounds>,
    #[serde(default)]
    height_m: Bounds,
    #[serde(default)]
    slope_x: Bounds,
    #[serde(default)]
    slope_y: Bounds,
    material: Option<NamedOr<MaterialSpec>>,
    fiber: Option<Object<FiberSpec>>,
    bounds: Option<Object<OwnBoundsSpec>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SampleSpec {
    force_n: [f64; 3],
    #[serde(default)]
    torque_nm: [f64; 3],
    held_length_m: Option<f64>,
}

impl ForceProblem {
    /// Reads a problem file.
    ///
    /// # Errors
    /// [`ProblemError`] at the first value that is not accepted.
    pub fn read(text: &str) -> Result<Self, ProblemError> {
        problem::read(text, File::problem)
    }
}

impl File {
    fn problem(&self) -> Result<ForceProblem, Refused> {
        require(self.format == 1, "format", self.format, "1")?;
        for (field, count) in [("actuators", self.actuators.len()), ("samples", self.samples.len())] {
            let allowed = "1 to 100 items";
            require((1..=MOST).contains(&count), field, count, allowed)?;
        }
        let Weights { force_per_n, torque_per_nm, effort, reference_pressure_pa } = self.weights.0;
        require(force_per_n >= 0.0, "weights.force_per_n", force_per_n, ">= 0")?;
        require(torque_per_nm >= 0.0, "weights.torque_per_nm", torque_per_nm, ">= 0")?;
        require(effort >= 0.0, "weights.effort", effort, ">= 0")?;
        if let Some(reference) = reference_pressure_pa {
            require(reference > 0.0, "weights.reference_pressure_pa", reference, "> 0")?;
        }
        let sample = |(index, Object(spec)): (usize, &Object<SampleSpec>)| spec.sample(index);
        Ok(ForceProblem {
            shared: self.shared_geometry,
            actuators: self.attachments()?,
            samples: self.samples.iter().enumerate().map(sample).collect::<Result<_, _>>()?,
            force_per_n,
            torque_per_nm,
            effort,
            reference_pressure_pa,
        })
    }

    fn attachments(&self) -> Result<Vec<Attachment>, Refused> {
        // Common values are checked even if no actuator uses them.
        TubeSpec {
            material: (&self.material, "material"),
            fiber: (&self.fiber.0, "fiber"),
            bounds: (self.bounds.0, "bounds"),
        }
        .tube()?;
        let mut common_radius_m = None;
        let mut attachments = Vec::new();
        for (index, Object(spec)) in self.actuators.iter().enumerate() {
            let at = format!("actuators[{index}]");
            let attachment = spec.attachment(&at, self.tube(spec, &at)?)?;
            if let (true, Place::Polar { radius_m, .. }) = (self.shared_geometry, attachment.place) {
                let [low, high] = *common_radius_m.get_or_insert(radius_m);
                let allowed = format!("[{low}, {high}], as before: shared_geometry gives all actuators one radius");
                let field = format!("{at}.radius_m");
                require(radius_m == [low, high], &field, format!("[{}, {}]", radius_m[0], radius_m[1]), &allowed)?;
            }
            attachments.push(attachment);
        }
        Ok(attachments)
    }

    /// The tube of an actuator: its own values, or the common ones.
    fn tube(&self, spec: &AttachmentSpec, at: &str) -> Result<Tube, Refused> {
        let [material, fiber, bounds] = ["material", "fiber", "bounds"].map(|name| format!("{at}.{name}"));
        let none = OwnBoundsSpec::default();
        let own_bounds = spec.bounds.as_ref().map_or(&none, |Object(own)| own);
        if self.shared_geometry {
            own_bounds.refuse_sizes(&bounds)?;
        }
        TubeSpec {
            material: own(spec.material.as_ref(), &self.material, [&material, "material"]),
            fiber: own(spec.fiber.as_ref().map(|Object(own)| own), &self.fiber.0, [&fiber, "fiber"]),
            bounds: (own_bounds.over(&self.bounds.0), &bounds),
        }
        .tube()
    }
}

impl AttachmentSpec {
    fn attachment(&self, at: &str, tube: Tube) -> Result<Attachment, Refused> {
        let signed = [("height_m", self.height_m), ("slope_x", self.slope_x), ("slope_y", self.slope_y)];
        let place = self.place(at)?;
        for (name, bounds) in signed {
            bounds_from(&format!("{at}.{name}"), bounds, LEAST)?;
        }
        Ok(Attachment {
            name: self.name.clone(),
            tube,
            place,
            height_m: self.height_m,
            slopes: [self.slope_x, self.slope_y],
        })
    }

    fn place(&self, at: &str) -> Result<Place, Refused> {
        let bounds = |name: &str, bounds: Bounds, least: f64| bounds_from(&format!("{at}.{name}"), bounds, least);
        match (self.radius_m, self.azimuth_deg, self.x_m, self.y_m) {
            (Some(radius_m), Some(azimuth_deg), None, None) => {
                bounds("radius_m", radius_m, 0.0)?;
                bounds("azimuth_deg", azimuth_deg, LEAST)?;
                Ok(Place::Polar { radius_m, azimuth_rad: azimuth_deg.map(f64::to_radians) })
            }
            (None, None, Some(x_m), Some(y_m)) => {
                bounds("x_m", x_m, LEAST)?;
                bounds("y_m", y_m, LEAST)?;
                Ok(Place::Cartesian { x_m, y_m })
            }
            _ => Err((at.into(), "needs either radius_m and azimuth_deg or x_m and y_m".into())),
        }
    }
}

impl SampleSpec {
    fn sample(&self, index: usize) -> Result<Sample, Refused> {
        if let Some(length) = self.held_length_m {
            require(length > 0.0, &format!("samples[{index}].held_length_m"), length, "> 0")?;
        }
        let [x, y, z] = self.force_n;
        let [along_x, along_y, along_z] = self.torque_nm;
        Ok(Sample { wrench: [x, y, z, along_x, along_y, along_z], held_length_m: self.held_length_m })
    }
}
