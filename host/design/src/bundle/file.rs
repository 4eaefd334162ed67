//! Problem files: JSON, described in `docs/reference/bundle-problem.md`. What is wrong is said with field, value, allowed range and line.

use fra_model::{Material, Placement};
use serde::Deserialize;

use super::problem::{Attachment, ForceProblem, Sample};
use crate::actuators::file::{families, material};
use crate::actuators::{Bounds, Winding};
use softlimb_files::object::Object;
use softlimb_files::problem;
use softlimb_files::problem::{ProblemError, Refused, bounds_from, positive_bounds, require};

/// Most actuators and samples of a file.
const MOST: usize = 100;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: u32,
    #[serde(default)]
    shared_geometry: bool,
    weights: Object<Weights>,
    material: Object<MaterialSpec>,
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
struct MaterialSpec {
    law: String,
    shear_modulus_pa: Option<f64>,
    c_pa: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FiberSpec {
    families: u8,
    modulus_pa: f64,
    thickness_m: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundsSpec {
    inner_radius_m: Bounds,
    wall_m: Bounds,
    length_m: Bounds,
    angle_deg: Bounds,
    pressure_max_pa: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AttachmentSpec {
    name: String,
    radius_m: Bounds,
    azimuth_deg: Bounds,
    #[serde(default)]
    height_m: Bounds,
    #[serde(default)]
    slope_x: Bounds,
    #[serde(default)]
    slope_y: Bounds,
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
        let bounds = self.bounds.0.checked()?;
        let Weights { force_per_n, torque_per_nm, effort, reference_pressure_pa } = self.weights.0;
        let reference_pressure_pa = reference_pressure_pa.unwrap_or(bounds.pressure_max_pa);
        require(force_per_n >= 0.0, "weights.force_per_n", force_per_n, ">= 0")?;
        require(torque_per_nm >= 0.0, "weights.torque_per_nm", torque_per_nm, ">= 0")?;
        require(effort >= 0.0, "weights.effort", effort, ">= 0")?;
        let field = "weights.reference_pressure_pa";
        require(reference_pressure_pa > 0.0, field, reference_pressure_pa, "> 0")?;
        let attachment = |(index, Object(spec)): (usize, &Object<AttachmentSpec>)| spec.attachment(index);
        let sample = |(index, Object(spec)): (usize, &Object<SampleSpec>)| spec.sample(index);
        Ok(ForceProblem {
            shared: self.shared_geometry,
            material: self.material.0.material()?,
            winding: self.fiber.0.winding()?,
            inner_radius_m: bounds.inner_radius_m,
            wall_m: bounds.wall_m,
            length_m: bounds.length_m,
            angle_rad: bounds.angle_deg.map(f64::to_radians),
            pressure_max_pa: bounds.pressure_max_pa,
            actuators: self.actuators.iter().enumerate().map(attachment).collect::<Result<_, _>>()?,
            samples: self.samples.iter().enumerate().map(sample).collect::<Result<_, _>>()?,
            force_per_n,
            torque_per_nm,
            effort,
            reference_pressure_pa,
        })
    }
}

impl BoundsSpec {
    fn checked(&self) -> Result<&Self, Refused> {
        positive_bounds("bounds.inner_radius_m", self.inner_radius_m)?;
        positive_bounds("bounds.wall_m", self.wall_m)?;
        positive_bounds("bounds.length_m", self.length_m)?;
        bounds_from("bounds.angle_deg", self.angle_deg, -90.0)?;
        require(self.angle_deg[1] <= 90.0, "bounds.angle_deg[1]", self.angle_deg[1], "-90 to 90, from the hoop")?;
        require(self.pressure_max_pa > 0.0, "bounds.pressure_max_pa", self.pressure_max_pa, "> 0")?;
        Ok(self)
    }
}

impl MaterialSpec {
    fn material(&self) -> Result<Material<f64>, Refused> {
        let material = material(&self.law, self.shear_modulus_pa, self.c_pa, "material")?;
        let (field, value) = match material {
            Material::NeoHookean { shear_modulus_pa } => ("material.shear_modulus_pa", shear_modulus_pa),
            Material::Yeoh { c_pa } => ("material.c_pa[0]", c_pa[0]),
        };
        require(value > 0.0, field, value, "> 0").map(|()| material)
    }
}

impl FiberSpec {
    fn winding(&self) -> Result<Winding, Refused> {
        let families = families(self.families, "fiber")?;
        require(self.modulus_pa >= 0.0, "fiber.modulus_pa", self.modulus_pa, ">= 0")?;
        require(self.thickness_m > 0.0, "fiber.thickness_m", self.thickness_m, "> 0")?;
        let (modulus_pa, thickness_m) = (self.modulus_pa, self.thickness_m);
        Ok(Winding { families, modulus_pa, placement: Placement::Sheet, thickness_m })
    }
}

impl AttachmentSpec {
    fn attachment(&self, index: usize) -> Result<Attachment, Refused> {
        let at = format!("actuators[{index}]");
        bounds_from(&format!("{at}.radius_m"), self.radius_m, 0.0)?;
        let signed = [("azimuth_deg", self.azimuth_deg), ("height_m", self.height_m)];
        for (name, bounds) in signed.into_iter().chain([("slope_x", self.slope_x), ("slope_y", self.slope_y)]) {
            bounds_from(&format!("{at}.{name}"), bounds, -1e4)?;
        }
        Ok(Attachment {
            name: self.name.clone(),
            radius_m: self.radius_m,
            azimuth_rad: self.azimuth_deg.map(f64::to_radians),
            height_m: self.height_m,
            slopes: [self.slope_x, self.slope_y],
        })
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
