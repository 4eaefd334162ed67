//! Bounds of a segment in a problem file.

use serde::Deserialize;

use crate::actuators::problem::{Bounds, GeometryBounds, Sizes};
use softlimb_files::problem::{Refused, missing, ordered, positive_bounds, require, superfluous};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoundsSpec {
    inner_radius_m: Option<Bounds>,
    outer_radius_m: Option<Bounds>,
    wall_m: Option<Bounds>,
    length_m: Bounds,
    angle_deg: Option<Bounds>,
    pub(super) pressure_max_pa: f64,
    pub(super) limit_margin: Option<f64>,
}

impl BoundsSpec {
    pub(super) fn geometry(&self, is_wound: bool, at: &str) -> Result<GeometryBounds, Refused> {
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
            positive_bounds(name, bounds)?;
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
        positive_bounds(&format!("{at}.length_m"), self.length_m)?;
        let angle = format!("{at}.angle_deg");
        let angle_deg = if !is_wound {
            superfluous(self.angle_deg.as_ref(), angle, "a bending actuator without `fiber` is wound along the hoop")?;
            [0.0; 2]
        } else {
            let bounds = missing(self.angle_deg, angle.clone(), "two numbers, from the hoop")?;
            for (end, value) in bounds.iter().enumerate() {
                require(value.abs() <= 90.0, &format!("{angle}[{end}]"), value, "-90 to 90, from the hoop")?;
            }
            ordered(&angle, bounds)?;
            bounds
        };
        Ok(GeometryBounds { sizes, sizes_m, length_m: self.length_m, angle_rad: angle_deg.map(f64::to_radians) })
    }
}
