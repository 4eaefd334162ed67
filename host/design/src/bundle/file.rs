//! Problem files: JSON, described in `docs/reference/bundle-problem.md`. What is wrong is said with field, value, allowed range and line.

use fra_model::{Families, Material, Placement};
use serde::Deserialize;

use super::problem::{Attachment, ForceProblem, Sample};
use crate::actuators::{Bounds, ProblemError, Winding};
use softlimb_files::json_line::line_of;
use softlimb_files::object::Object;

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

/// A field and what is wrong with it; the line is found when the message is made.
type Refused = (String, String);

fn require(accepted: bool, field: &str, value: f64, allowed: &str) -> Result<(), Refused> {
    if accepted { Ok(()) } else { Err((field.into(), format!("= {value} is not allowed: {allowed}"))) }
}

/// Ordered bounds, the lower one at least `least`, or more than it.
fn ordered(field: &str, [low, high]: Bounds, least: f64, more: bool) -> Result<(), Refused> {
    let allowed = if more { format!("> {least}") } else { format!(">= {least}") };
    require(if more { low > least } else { low >= least }, &format!("{field}[0]"), low, &allowed)?;
    require(high >= low && high.is_finite(), &format!("{field}[1]"), high, &format!("at least {low}, the lower bound"))
}

impl ForceProblem {
    /// Reads a problem file.
    ///
    /// # Errors
    /// [`ProblemError`] at the first value that is not accepted.
    pub fn read(text: &str) -> Result<Self, ProblemError> {
        let Object(file) = serde_json::from_str::<Object<File>>(text).map_err(|error| {
            let message = error.to_string();
            let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message).to_owned();
            ProblemError::Format { line: error.line(), column: error.column(), message }
        })?;
        file.problem().map_err(|(field, message)| ProblemError::Value { line: line_of(text, &field), field, message })
    }
}

impl File {
    fn problem(&self) -> Result<ForceProblem, Refused> {
        require(self.format == 1, "format", f64::from(self.format), "1")?;
        for (field, count) in [("actuators", self.actuators.len()), ("samples", self.samples.len())] {
            let allowed = "1 to 100 items";
            require((1..=MOST).contains(&count), field, count as f64, allowed)?;
        }
        let bounds = self.bounds.0.checked()?;
        let Weights { force_per_n, torque_per_nm } = self.weights.0;
        require(force_per_n >= 0.0, "weights.force_per_n", force_per_n, ">= 0")?;
        require(torque_per_nm >= 0.0, "weights.torque_per_nm", torque_per_nm, ">= 0")?;
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
        })
    }
}

impl BoundsSpec {
    fn checked(&self) -> Result<&Self, Refused> {
        ordered("bounds.inner_radius_m", self.inner_radius_m, 0.0, true)?;
        ordered("bounds.wall_m", self.wall_m, 0.0, true)?;
        ordered("bounds.length_m", self.length_m, 0.0, true)?;
        ordered("bounds.angle_deg", self.angle_deg, -90.0, false)?;
        require(self.angle_deg[1] <= 90.0, "bounds.angle_deg[1]", self.angle_deg[1], "-90 to 90, from the hoop")?;
        require(self.pressure_max_pa > 0.0, "bounds.pressure_max_pa", self.pressure_max_pa, "> 0")?;
        Ok(self)
    }
}

impl MaterialSpec {
    fn material(&self) -> Result<Material<f64>, Refused> {
        let wrong = |field: &str, message: &str| Err((format!("material.{field}"), message.into()));
        match (self.law.as_str(), self.shear_modulus_pa, self.c_pa) {
            ("neo-hookean", Some(shear_modulus_pa), None) => {
                require(shear_modulus_pa > 0.0, "material.shear_modulus_pa", shear_modulus_pa, "> 0")?;
                Ok(Material::NeoHookean { shear_modulus_pa })
            }
            ("yeoh", None, Some(c_pa)) => {
                require(c_pa[0] > 0.0, "material.c_pa[0]", c_pa[0], "> 0")?;
                Ok(Material::Yeoh { c_pa })
            }
            ("neo-hookean", None, None) => wrong("shear_modulus_pa", "is missing: a number, Pa"),
            ("yeoh", None, None) => wrong("c_pa", "is missing: three numbers, Pa"),
            ("neo-hookean", ..) => wrong("c_pa", "is not allowed: a neo-hookean material has none"),
            ("yeoh", ..) => wrong("shear_modulus_pa", "is not allowed: a yeoh material has c_pa"),
            _ => wrong("law", "is not allowed: \"neo-hookean\" or \"yeoh\""),
        }
    }
}

impl FiberSpec {
    fn winding(&self) -> Result<Winding, Refused> {
        let families = match self.families {
            1 => Families::One,
            2 => Families::Two,
            n => return Err(("fiber.families".into(), format!("= {n} is not allowed: 1 or 2"))),
        };
        require(self.modulus_pa >= 0.0, "fiber.modulus_pa", self.modulus_pa, ">= 0")?;
        require(self.thickness_m > 0.0, "fiber.thickness_m", self.thickness_m, "> 0")?;
        let (modulus_pa, thickness_m) = (self.modulus_pa, self.thickness_m);
        Ok(Winding { families, modulus_pa, placement: Placement::Sheet, thickness_m })
    }
}

impl AttachmentSpec {
    fn attachment(&self, index: usize) -> Result<Attachment, Refused> {
        let at = format!("actuators[{index}]");
        ordered(&format!("{at}.radius_m"), self.radius_m, 0.0, false)?;
        let signed = [("azimuth_deg", self.azimuth_deg), ("height_m", self.height_m)];
        for (name, bounds) in signed.into_iter().chain([("slope_x", self.slope_x), ("slope_y", self.slope_y)]) {
            ordered(&format!("{at}.{name}"), bounds, -1e4, false)?;
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
