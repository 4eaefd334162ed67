//! Problem files: JSON, described in `docs/design.md`. What is wrong is said with field, value, allowed range and line.

use fra_model::{Actuator, Families, Material, Motion, Placement};
use serde::Deserialize;

use super::locate::line_of;
use super::problem::{Bounds, GeometryBounds, Goal, MOST, Problem, Segment, Sizes, Winding};
use crate::eval::object::Object;

/// The share of the limit pressure that stays unused where a file does not say.
const LIMIT_MARGIN: f64 = 0.05;

/// What is wrong with a problem file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProblemError {
    /// It is no JSON, or not of this format.
    #[error("line {line}, column {column}: {message}")]
    Format {
        /// From 1.
        line: usize,
        /// From 1; 0 for the whole line.
        column: usize,
        /// In the words of the parser.
        message: String,
    },
    /// A value that is not accepted.
    #[error("line {line}: {field} {message}")]
    Value {
        /// From 1.
        line: usize,
        /// As in `segments[0].bounds.wall_m[1]`.
        field: String,
        /// Value and allowed range.
        message: String,
    },
}

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
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
enum Name {
    Extension,
    Expansion,
    Bending,
    Twisting,
    NeoHookean,
    Yeoh,
    Sheet,
    Smeared,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SegmentSpec {
    name: String,
    motion: Name,
    material: Object<MaterialSpec>,
    fiber: Option<Object<FiberSpec>>,
    bounds: Object<BoundsSpec>,
    targets: Object<TargetsSpec>,
    target_weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialSpec {
    law: Name,
    shear_modulus_pa: Option<f64>,
    c_pa: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FiberSpec {
    families: u8,
    modulus_pa: f64,
    placement: Option<Name>,
    thickness_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundsSpec {
    inner_radius_m: Option<Bounds>,
    outer_radius_m: Option<Bounds>,
    wall_m: Option<Bounds>,
    length_m: Bounds,
    angle_deg: Option<Bounds>,
    pressure_max_pa: f64,
    limit_margin: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TargetsSpec {
    length_m: Option<Vec<Option<f64>>>,
    outer_radius_m: Option<Vec<Option<f64>>>,
    bend_angle_rad: Option<Vec<Option<f64>>>,
    twist_rad: Option<Vec<Option<f64>>>,
}

/// A field and what is wrong with it; the line is found when the message is made.
type Refused = (String, String);

fn require(accepted: bool, field: &str, value: impl std::fmt::Display, allowed: &str) -> Result<(), Refused> {
    if accepted { Ok(()) } else { Err((field.into(), format!("= {value} is not allowed: {allowed}"))) }
}

fn missing<T>(value: Option<T>, field: String, what: &str) -> Result<T, Refused> {
    value.ok_or_else(|| (field, format!("is missing: {what}")))
}

fn superfluous<T>(value: Option<&T>, field: String, why: &str) -> Result<(), Refused> {
    if value.is_none() { Ok(()) } else { Err((field, format!("is not allowed: {why}"))) }
}

impl Problem {
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
        Ok(Problem { segments, shared_pressure: self.shared_pressure })
    }
}

impl Weights {
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

impl SegmentSpec {
    fn segment(&self, at: &str, weights: &Weights) -> Result<Segment, Refused> {
        let motion = match self.motion {
            Name::Extension => Motion::Extension,
            Name::Expansion => Motion::Expansion,
            Name::Bending => Motion::Bending,
            Name::Twisting => Motion::Twisting,
            _ => return Err((format!("{at}.motion"), MOTIONS.into())),
        };
        let bounds = &self.bounds.0;
        let margin = bounds.limit_margin.unwrap_or(LIMIT_MARGIN);
        let within = (1e-3..=0.9).contains(&margin);
        require(within, &format!("{at}.bounds.limit_margin"), margin, "0.001 to 0.9")?;
        let highest = bounds.pressure_max_pa;
        require(highest > 0.0, &format!("{at}.bounds.pressure_max_pa"), highest, "> 0")?;
        let segment = Segment {
            name: self.name.clone(),
            motion,
            material: self.material.0.material(&format!("{at}.material"))?,
            winding: self.winding(motion, &format!("{at}.fiber"))?,
            bounds: bounds.geometry(motion, &format!("{at}.bounds"))?,
            pressure_max_pa: highest,
            limit_margin: margin,
            goals: self.goals(motion, at, weights.of(motion)?)?,
        };
        let middle = segment.geometry(&[0.5; 4]);
        Actuator::new(&segment.parameters(&middle)).map_err(|error| {
            let part = if matches!(error.field, "modulus_pa" | "thickness_m") { "fiber" } else { "material" };
            (format!("{at}.{part}.{}", error.field), format!("= {} is not allowed: {}", error.value, error.allowed))
        })?;
        Ok(segment)
    }

    fn winding(&self, motion: Motion, at: &str) -> Result<Option<Winding>, Refused> {
        if motion == Motion::Bending {
            let why = "a bending actuator is wound along the hoop at its outer radius";
            return superfluous(self.fiber.as_ref(), at.into(), why).map(|()| None);
        }
        let Object(fiber) = missing(self.fiber.as_ref(), at.into(), "a straight actuator is wound")?;
        let families = match fiber.families {
            1 => Families::One,
            2 => Families::Two,
            n => return Err((format!("{at}.families"), format!("= {n} is not allowed: 1 or 2"))),
        };
        let placement = match fiber.placement {
            None | Some(Name::Sheet) => Placement::Sheet,
            Some(Name::Smeared) => Placement::Smeared,
            Some(_) => return Err((format!("{at}.placement"), "is not allowed: \"sheet\" or \"smeared\"".into())),
        };
        let thickness_m = match placement {
            Placement::Sheet => missing(fiber.thickness_m, format!("{at}.thickness_m"), "a sheet has one")?,
            _ => fiber.thickness_m.unwrap_or(0.0),
        };
        Ok(Some(Winding { families, modulus_pa: fiber.modulus_pa, placement, thickness_m }))
    }

    fn goals(&self, motion: Motion, at: &str, weight: f64) -> Result<Vec<Option<Goal>>, Refused> {
        let targets = &self.targets.0;
        let kinds = [
            (Motion::Extension, "length_m", &targets.length_m),
            (Motion::Expansion, "outer_radius_m", &targets.outer_radius_m),
            (Motion::Bending, "bend_angle_rad", &targets.bend_angle_rad),
            (Motion::Twisting, "twist_rad", &targets.twist_rad),
        ];
        let mut values = None;
        for (kind, name, given) in kinds {
            let field = format!("{at}.targets.{name}");
            if kind == motion {
                values = Some((missing(given.as_ref(), field.clone(), "one value for each phase")?, field));
            } else {
                superfluous(given.as_ref(), field, "not what this motion is measured by")?;
            }
        }
        let (values, field) = missing(values, format!("{at}.targets"), "one value for each phase")?;
        let count = values.len();
        require((1..=MOST).contains(&count), &field, format!("[{count} items]"), "1 to 1000 phases")?;
        let ones = vec![1.0; count];
        let factors = self.target_weights.as_ref().unwrap_or(&ones);
        let allowed = format!("as many as there are targets: {count}");
        require(
            factors.len() == count,
            &format!("{at}.target_weights"),
            format!("[{} items]", factors.len()),
            &allowed,
        )?;
        let mut goals = Vec::new();
        for (phase, (value, factor)) in values.iter().zip(factors).enumerate() {
            require(*factor >= 0.0, &format!("{at}.target_weights[{phase}]"), factor, ">= 0")?;
            let Some(value) = *value else {
                goals.push(None);
                continue;
            };
            let (accepted, allowed) = match motion {
                Motion::Extension | Motion::Expansion => (value > 0.0, "> 0"),
                Motion::Bending => (value >= 0.0, ">= 0"),
                Motion::Twisting => (true, "finite"),
            };
            require(accepted, &format!("{field}[{phase}]"), value, allowed)?;
            goals.push(Some(Goal { value, weight: weight * factor }));
        }
        Ok(goals)
    }
}

const MOTIONS: &str = "is not allowed: \"extension\", \"expansion\", \"bending\" or \"twisting\"";

impl MaterialSpec {
    fn material(&self, at: &str) -> Result<Material<f64>, Refused> {
        let (modulus, c_pa) = (format!("{at}.shear_modulus_pa"), format!("{at}.c_pa"));
        match self.law {
            Name::NeoHookean => {
                superfluous(self.c_pa.as_ref(), c_pa, "a neo-hookean material has none")?;
                let shear_modulus_pa = missing(self.shear_modulus_pa, modulus, "a number, Pa")?;
                Ok(Material::NeoHookean { shear_modulus_pa })
            }
            Name::Yeoh => {
                superfluous(self.shear_modulus_pa.as_ref(), modulus, "a yeoh material has c_pa")?;
                Ok(Material::Yeoh { c_pa: missing(self.c_pa, c_pa, "three numbers, Pa")? })
            }
            _ => Err((format!("{at}.law"), "is not allowed: \"neo-hookean\" or \"yeoh\"".into())),
        }
    }
}

impl BoundsSpec {
    fn geometry(&self, motion: Motion, at: &str) -> Result<GeometryBounds, Refused> {
        let (sizes, sizes_m) = match (self.inner_radius_m, self.outer_radius_m, self.wall_m) {
            (Some(inner), None, Some(wall)) => (Sizes::InnerAndWall, [inner, wall]),
            (Some(inner), Some(outer), None) => (Sizes::InnerAndOuter, [inner, outer]),
            (None, Some(outer), Some(wall)) => (Sizes::OuterAndWall, [outer, wall]),
            _ => {
                let rule = "needs exactly two of inner_radius_m, outer_radius_m and wall_m: the third follows";
                return Err((at.into(), rule.into()));
            }
        };
        let names = sizes.names().map(|name| format!("{at}.{name}"));
        for (name, bounds) in names.iter().zip(sizes_m) {
            ordered(name, bounds, 0.0)?;
        }
        let more = match sizes {
            Sizes::InnerAndWall => None,
            Sizes::InnerAndOuter => Some((&names[1], sizes_m[1][0], sizes_m[0][1], "inner_radius_m")),
            Sizes::OuterAndWall => Some((&names[0], sizes_m[0][0], sizes_m[1][1], "wall_m")),
        };
        if let Some((name, least, most, other)) = more {
            let allowed = format!("more than {most}, the largest {other}");
            require(least > most, &format!("{name}[0]"), least, &allowed)?;
        }
        ordered(&format!("{at}.length_m"), self.length_m, 0.0)?;
        let angle = format!("{at}.angle_deg");
        let angle_deg = if motion == Motion::Bending {
            superfluous(self.angle_deg.as_ref(), angle, "a bending actuator is wound along the hoop")?;
            [0.0; 2]
        } else {
            let bounds = missing(self.angle_deg, angle.clone(), "two numbers, from the hoop")?;
            for (end, value) in bounds.iter().enumerate() {
                require(value.abs() <= 90.0, &format!("{angle}[{end}]"), value, "-90 to 90, from the hoop")?;
            }
            ordered(&angle, bounds, f64::NEG_INFINITY)?;
            bounds
        };
        Ok(GeometryBounds { sizes, sizes_m, length_m: self.length_m, angle_rad: angle_deg.map(f64::to_radians) })
    }
}

/// Bounds of which the first is more than `least` and does not exceed the second.
fn ordered(field: &str, [low, high]: Bounds, least: f64) -> Result<(), Refused> {
    require(low > least, &format!("{field}[0]"), low, "> 0")?;
    require(high >= low, &format!("{field}[1]"), high, &format!("at least {low}, the lower bound"))
}
