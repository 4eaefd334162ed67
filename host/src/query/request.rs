//! One question to the actuator model, as a line of JSON.

use std::fmt;

use fra_model::{ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, PressureRange, Target};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::Value;

use softlimb_fea::cross_section::BEND_TOLERANCE;
use softlimb_files::object::{NamedOr, Object};
use softlimb_scene::castable_elastomer;

/// A line of a batch, as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Request {
    /// Copied to the answer.
    #[serde(default)]
    pub(super) id: Value,
    #[serde(default)]
    pub(super) model: Model,
    pub(super) motion: MotionName,
    pub(super) problem: Problem,
    pub(super) inner_radius_m: f64,
    pub(super) outer_radius_m: f64,
    pub(super) length_m: f64,
    pub(super) material: NamedOr<MaterialSpec>,
    pub(super) fiber: Option<Fibers>,
    pub(super) pressure_pa: Option<f64>,
    pub(super) target: Option<Object<TargetSpec>>,
    pub(super) pressure_range: Option<[f64; 2]>,
    pub(super) solutions: Option<Solutions>,
    pub(super) tolerance: Option<f64>,
    pub(super) errors: Option<bool>,
    pub(super) external_force_n: Option<f64>,
    pub(super) external_torque_nm: Option<f64>,
}

/// Model that answers.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum Model {
    /// Analytic where its error is within the tolerance, else finite elements.
    #[default]
    Auto,
    /// The equations of the tube and of the bending section.
    Analytic,
    /// Finite elements of the section.
    SectionFe,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum MotionName {
    Extension,
    Expansion,
    Bending,
    Twisting,
}

/// Requested solutions of an inverse problem.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum Solutions {
    /// The answer by the rule.
    First,
    /// Every solution.
    All,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum Problem {
    Forward,
    Inverse,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum Law {
    NeoHookean,
    Yeoh,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialSpec {
    pub(super) law: Law,
    pub(super) shear_modulus_pa: Option<f64>,
    pub(super) c_pa: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum PlacementName {
    #[default]
    Sheet,
    Layer,
    Smeared,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiberSpec {
    pub(super) angle_deg: Option<f64>,
    pub(super) families: Option<u8>,
    pub(super) modulus_pa: Option<f64>,
    #[serde(default)]
    pub(super) placement: PlacementName,
    pub(super) thickness_m: Option<f64>,
    pub(super) radius_m: Option<f64>,
}

/// One winding, or a list of windings.
#[derive(Debug)]
pub(super) enum Fibers {
    One(FiberSpec),
    List(Vec<Object<FiberSpec>>),
}

impl<'de> Deserialize<'de> for Fibers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ObjectOrList)
    }
}

struct ObjectOrList;

impl<'de> Visitor<'de> for ObjectOrList {
    type Value = Fibers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object or an array of objects")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Fibers, A::Error> {
        FiberSpec::deserialize(MapAccessDeserializer::new(map)).map(Fibers::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Fibers, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Fibers::List)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TargetSpec {
    #[serde(default, deserialize_with = "present")]
    pub(super) axial_stretch: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    pub(super) outer_radius_m: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    pub(super) inner_radius_m: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    pub(super) twist_rad: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    pub(super) bend_angle_rad: Option<f64>,
}

/// A number; `null` is none.
pub(super) fn present<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}

/// The given quantity of a query.
#[derive(Clone, Copy, Debug)]
pub enum Question<T> {
    /// Pressure to deformation.
    Forward {
        /// Gauge pressure, Pa.
        pressure_pa: f64,
    },
    /// Deformation to pressure.
    Inverse {
        /// The deformation.
        target: T,
    },
}

/// A request in the terms of the model.
pub(super) struct Case {
    pub(super) model: Model,
    pub(super) parameters: ActuatorParameters<f64>,
    pub(super) second_fiber: Option<Fiber<f64>>,
    /// Largest stretch of the test behind the law of a named elastomer.
    pub(super) stretch_max: Option<f64>,
    pub(super) question: Question<Target<f64>>,
    /// Range of the answers to an inverse question, and whether all of them are requested.
    pub(super) range: PressureRange<f64>,
    pub(super) all: bool,
    pub(super) load: Load<f64>,
    /// Largest relative error of the analytic bend that model `auto` accepts.
    pub(super) tolerance: f64,
    /// Whether the answer has all its errors.
    pub(super) errors: bool,
    /// Whether the answer of a wound bender has the effect of its winding's error.
    pub(super) winding: bool,
}

impl Request {
    /// The case, or what the request leaves out or has too much of. Values are the model's to check.
    pub(super) fn case(&self) -> Result<Case, String> {
        let motion = self.motion.motion();
        let (material, stretch_max) = material(&self.material)?;
        let [fiber, second_fiber] = match &self.fiber {
            None => [None, None],
            Some(fibers) => fibers.windings(motion, self.outer_radius_m)?,
        };
        let question = self.problem.question(self.pressure_pa, self.target.as_ref(), TargetSpec::target)?;
        let all = self.solutions == Some(Solutions::All);
        for (field, given) in
            [("pressure_range", self.pressure_range.is_some()), ("solutions", self.solutions.is_some())]
        {
            if given && matches!(question, Question::Forward { .. }) {
                return Err(format!("a forward problem takes no `{field}`"));
            }
        }
        let stated = self.pressure_range.map(|[least_pa, most_pa]| PressureRange { least_pa, most_pa });
        Ok(Case {
            model: self.model,
            parameters: ActuatorParameters {
                motion,
                inner_radius_m: self.inner_radius_m,
                outer_radius_m: self.outer_radius_m,
                length_m: self.length_m,
                material,
                fiber,
            },
            second_fiber,
            stretch_max,
            question,
            range: stated.unwrap_or_else(PressureRange::physical),
            all,
            load: load(self.external_force_n, self.external_torque_nm),
            tolerance: tolerance(self.tolerance, self.model)?,
            errors: self.errors == Some(true),
            winding: self.errors != Some(false),
        })
    }
}

impl MotionName {
    pub(super) fn motion(self) -> Motion {
        match self {
            Self::Extension => Motion::Extension,
            Self::Expansion => Motion::Expansion,
            Self::Bending => Motion::Bending,
            Self::Twisting => Motion::Twisting,
        }
    }
}

impl Problem {
    /// The query, or the missing or superfluous fields.
    pub(super) fn question<S, T>(
        self,
        pressure_pa: Option<f64>,
        target: Option<&Object<S>>,
        read: impl Fn(&S) -> Result<T, String>,
    ) -> Result<Question<T>, String> {
        match (self, pressure_pa, target) {
            (Self::Forward, Some(pressure_pa), None) => Ok(Question::Forward { pressure_pa }),
            (Self::Inverse, None, Some(Object(target))) => Ok(Question::Inverse { target: read(target)? }),
            (Self::Forward, None, _) => Err("a forward problem needs `pressure_pa`".into()),
            (Self::Inverse, _, None) => Err("an inverse problem needs `target`".into()),
            (Self::Forward, Some(_), Some(_)) => Err("a forward problem takes no `target`".into()),
            (Self::Inverse, Some(_), Some(_)) => Err("an inverse problem takes no `pressure_pa`".into()),
        }
    }
}

/// The error of the analytic bend that a model accepts.
pub(super) fn tolerance(stated: Option<f64>, model: Model) -> Result<f64, String> {
    match (stated, model) {
        (None, _) => Ok(BEND_TOLERANCE),
        (Some(value), Model::Auto) if value > 0.0 && value.is_finite() => Ok(value),
        (Some(value), Model::Auto) => Err(format!("tolerance = {value} is not allowed: finite and > 0")),
        (Some(_), _) => Err("`tolerance` is for `model` \"auto\"".into()),
    }
}

/// Loads that are not stated are none.
pub(super) fn load(force_n: Option<f64>, torque_nm: Option<f64>) -> Load<f64> {
    Load { force_n: force_n.unwrap_or(0.0), torque_nm: torque_nm.unwrap_or(0.0) }
}

/// The one target given.
pub(super) fn only<T>(fields: impl IntoIterator<Item = Option<T>>) -> Result<T, String> {
    let mut given = fields.into_iter().flatten();
    match (given.next(), given.next()) {
        (Some(target), None) => Ok(target),
        _ => Err("`target` must have exactly one field".into()),
    }
}

/// The law of a material; of a castable elastomer by trade name the largest stretch of its test, too.
pub(super) fn material(material: &NamedOr<MaterialSpec>) -> Result<(Material<f64>, Option<f64>), String> {
    match material {
        NamedOr::Object(spec) => Ok((spec.material()?, None)),
        NamedOr::Name(name) => match castable_elastomer(name) {
            Ok(known) => Ok((known.material(), Some(known.stretch[1]))),
            Err(help) => Err(format!("material = \"{name}\" is no known elastomer: {help}")),
        },
    }
}

impl MaterialSpec {
    fn material(&self) -> Result<Material<f64>, String> {
        match (self.law, self.shear_modulus_pa, self.c_pa) {
            (Law::NeoHookean, Some(shear_modulus_pa), None) => Ok(Material::NeoHookean { shear_modulus_pa }),
            (Law::Yeoh, None, Some(c_pa)) => Ok(Material::Yeoh { c_pa }),
            (Law::NeoHookean, None, _) => Err("`material.shear_modulus_pa` is missing".into()),
            (Law::Yeoh, _, None) => Err("`material.c_pa` is missing: three numbers".into()),
            (Law::NeoHookean, Some(_), Some(_)) => Err("a neo-hookean material takes no `c_pa`".into()),
            (Law::Yeoh, Some(_), Some(_)) => Err("a yeoh material takes no `shear_modulus_pa`".into()),
        }
    }
}

impl Fibers {
    /// The first and the second winding. In a list, a winding is one family unless it states two.
    pub(super) fn windings(&self, motion: Motion, outer_radius_m: f64) -> Result<[Option<Fiber<f64>>; 2], String> {
        let listed = |spec: &FiberSpec, place: &str, motion: Motion| {
            let spec = FiberSpec { families: spec.families.or(Some(1)), ..*spec };
            let winding = spec.fiber(motion, outer_radius_m);
            winding.map_err(|message| format!("fiber, {place} winding: {}", message.replace("fiber.", "")))
        };
        match self {
            Self::One(spec) => Ok([Some(spec.fiber(motion, outer_radius_m)?), None]),
            Self::List(list) => match list.as_slice() {
                [Object(one)] => Ok([Some(listed(one, "first", motion)?), None]),
                // Of two windings every field counts, on a bending actuator, too.
                [Object(first), Object(second)] => {
                    let straight = Motion::Extension;
                    Ok([Some(listed(first, "first", straight)?), Some(listed(second, "second", straight)?)])
                }
                _ => Err(format!("fiber has {} windings: 1 or 2 are allowed", list.len())),
            },
        }
    }
}

impl FiberSpec {
    pub(super) fn fiber(&self, motion: Motion, outer_radius_m: f64) -> Result<Fiber<f64>, String> {
        // A bending actuator's winding only keeps its radius.
        let bending = motion == Motion::Bending;
        let needed = |value: Option<f64>, name: &str, needed: bool| match value {
            Some(value) => Ok(value),
            None if needed && !bending => Err(format!("`fiber.{name}` is missing")),
            None => Ok(0.0),
        };
        let placement = match self.placement {
            PlacementName::Sheet => Placement::Sheet,
            PlacementName::Layer => Placement::Layer,
            PlacementName::Smeared => Placement::Smeared,
        };
        let families = match self.families {
            Some(1) => Families::One,
            Some(2) => Families::Two,
            None if bending => Families::Two,
            None => return Err("`fiber.families` is missing: 1 or 2".into()),
            Some(n) => return Err(format!("fiber.families = {n} is not allowed: 1 or 2")),
        };
        Ok(Fiber {
            angle_rad: needed(self.angle_deg, "angle_deg", true)?.to_radians(),
            families,
            modulus_pa: needed(self.modulus_pa, "modulus_pa", true)?,
            placement,
            thickness_m: needed(self.thickness_m, "thickness_m", placement == Placement::Sheet)?,
            radius_m: self.radius_m.unwrap_or(outer_radius_m),
        })
    }
}

impl TargetSpec {
    fn target(&self) -> Result<Target<f64>, String> {
        only([
            self.axial_stretch.map(Target::AxialStretch),
            self.outer_radius_m.map(Target::OuterRadius),
            self.inner_radius_m.map(Target::InnerRadius),
            self.twist_rad.map(Target::Twist),
            self.bend_angle_rad.map(Target::BendAngle),
        ])
    }
}
