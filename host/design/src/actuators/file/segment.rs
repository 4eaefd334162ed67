//! A segment in a problem file.

use fra_model::{Actuator, Motion};
use serde::Deserialize;

use super::Weights;
use super::bounds::BoundsSpec;
use super::winding::{FiberSpec, MaterialSpec, stated_or_named};
use crate::actuators::problem::{Goal, MOST, Segment, Winding};
use softlimb_files::object::{NamedOr, Object};
use softlimb_files::problem::{Refused, missing, require, superfluous};

/// The share of the limit pressure that stays unused where a file does not say.
const LIMIT_MARGIN: f64 = 0.05;

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(variant_identifier, rename_all = "kebab-case")]
pub(super) enum Name {
    Extension,
    Expansion,
    Bending,
    Twisting,
    NeoHookean,
    Yeoh,
    Sheet,
    Layer,
    Smeared,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SegmentSpec {
    name: String,
    motion: Name,
    material: NamedOr<MaterialSpec>,
    fiber: Option<Object<FiberSpec>>,
    bounds: Object<BoundsSpec>,
    targets: Object<TargetsSpec>,
    target_weights: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TargetsSpec {
    length_m: Option<Vec<Option<f64>>>,
    outer_radius_m: Option<Vec<Option<f64>>>,
    bend_angle_rad: Option<Vec<Option<f64>>>,
    twist_rad: Option<Vec<Option<f64>>>,
}

impl SegmentSpec {
    pub(super) fn segment(&self, at: &str, weights: &Weights) -> Result<Segment, Refused> {
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
        let material = stated_or_named(&self.material, &format!("{at}.material"), MaterialSpec::material)?;
        let wound = format!("{at}.fiber");
        let fiber = self.fiber(motion, &wound)?;
        let geometry = bounds.geometry(fiber.is_some(), &format!("{at}.bounds"))?;
        let winding = fiber.map(|fiber| fiber.winding(motion, &wound, geometry.thinnest_m())).transpose()?;
        let is_wound_bender = |winding: &Winding| motion == Motion::Bending && winding.modulus_pa > 0.0;
        let segment = Segment {
            name: self.name.clone(),
            motion,
            material,
            winding,
            section: winding.filter(is_wound_bender),
            second: None,
            bounds: geometry,
            pressure_max_pa: highest,
            limit_margin: margin,
            goals: self.goals(motion, at, weights.of(motion)?)?,
            effort_per_pa2: 0.0,
        };
        let middle = segment.geometry(&[0.5; 4]);
        Actuator::new(&segment.parameters(&middle)).map_err(|error| {
            let part = if matches!(error.field, "modulus_pa" | "thickness_m") { "fiber" } else { "material" };
            (format!("{at}.{part}.{}", error.field), format!("= {} is not allowed: {}", error.value, error.allowed))
        })?;
        Ok(segment)
    }

    /// The file's winding; a bending actuator without one is wound along the hoop at its outer radius.
    fn fiber(&self, motion: Motion, at: &str) -> Result<Option<&FiberSpec>, Refused> {
        match &self.fiber {
            Some(Object(fiber)) => Ok(Some(fiber)),
            None if motion == Motion::Bending => Ok(None),
            None => missing(None, at.into(), "a straight actuator is wound"),
        }
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
                superfluous(given.as_ref(), field, "no quantity of this motion")?;
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
