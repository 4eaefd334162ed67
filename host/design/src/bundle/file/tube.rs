//! Tubes in a problem file: what all actuators have in common, and what one has instead.

use fra_model::{Material, Placement};
use serde::Deserialize;

use super::super::problem::Tube;
use crate::actuators::file::{PLACEMENTS, families, material, stated_or_named, thickness_m, wall_share};
use crate::actuators::{Bounds, Winding};
use softlimb_files::object::NamedOr;
use softlimb_files::problem::{Refused, bounds_from, positive_bounds, require, superfluous};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialSpec {
    law: String,
    shear_modulus_pa: Option<f64>,
    c_pa: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiberSpec {
    families: u8,
    modulus_pa: f64,
    placement: Option<String>,
    thickness_m: Option<f64>,
    wall_share: Option<f64>,
    #[serde(default)]
    mirrored: bool,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoundsSpec {
    inner_radius_m: Bounds,
    wall_m: Bounds,
    length_m: Bounds,
    angle_deg: Bounds,
    pressure_max_pa: f64,
}

/// Bounds in place of the common ones.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OwnBoundsSpec {
    inner_radius_m: Option<Bounds>,
    wall_m: Option<Bounds>,
    length_m: Option<Bounds>,
    angle_deg: Option<Bounds>,
    pressure_max_pa: Option<f64>,
}

/// What a tube is made of and its bounds, and the fields that say so.
pub(super) struct TubeSpec<'a> {
    pub(super) material: (&'a NamedOr<MaterialSpec>, &'a str),
    pub(super) fiber: (&'a FiberSpec, &'a str),
    pub(super) bounds: (BoundsSpec, &'a str),
}

impl TubeSpec<'_> {
    pub(super) fn tube(&self) -> Result<Tube, Refused> {
        let (bounds, at) = self.bounds;
        bounds.check(at)?;
        let (fiber, wound) = self.fiber;
        Ok(Tube {
            material: stated_or_named(self.material.0, self.material.1, MaterialSpec::material)?,
            winding: fiber.winding(bounds.wall_m[0], wound)?,
            mirrored: fiber.mirrored,
            inner_radius_m: bounds.inner_radius_m,
            wall_m: bounds.wall_m,
            length_m: bounds.length_m,
            angle_rad: bounds.angle_deg.map(f64::to_radians),
            pressure_max_pa: bounds.pressure_max_pa,
        })
    }
}

impl OwnBoundsSpec {
    /// The common bounds with these in their place.
    pub(super) fn over(&self, common: &BoundsSpec) -> BoundsSpec {
        BoundsSpec {
            inner_radius_m: self.inner_radius_m.unwrap_or(common.inner_radius_m),
            wall_m: self.wall_m.unwrap_or(common.wall_m),
            length_m: self.length_m.unwrap_or(common.length_m),
            angle_deg: self.angle_deg.unwrap_or(common.angle_deg),
            pressure_max_pa: self.pressure_max_pa.unwrap_or(common.pressure_max_pa),
        }
    }

    /// Refuses sizes where all actuators have one geometry.
    pub(super) fn refuse_sizes(&self, at: &str) -> Result<(), Refused> {
        let sizes = [
            ("inner_radius_m", self.inner_radius_m),
            ("wall_m", self.wall_m),
            ("length_m", self.length_m),
            ("angle_deg", self.angle_deg),
        ];
        for (name, bounds) in sizes {
            superfluous(bounds.as_ref(), format!("{at}.{name}"), "shared_geometry gives all actuators one")?;
        }
        Ok(())
    }
}

impl BoundsSpec {
    fn check(&self, at: &str) -> Result<(), Refused> {
        positive_bounds(&format!("{at}.inner_radius_m"), self.inner_radius_m)?;
        positive_bounds(&format!("{at}.wall_m"), self.wall_m)?;
        positive_bounds(&format!("{at}.length_m"), self.length_m)?;
        let angle = format!("{at}.angle_deg");
        bounds_from(&angle, self.angle_deg, -90.0)?;
        let most = self.angle_deg[1];
        require(most <= 90.0, &format!("{angle}[1]"), most, "-90 to 90, from the hoop")?;
        require(self.pressure_max_pa > 0.0, &format!("{at}.pressure_max_pa"), self.pressure_max_pa, "> 0")
    }
}

impl MaterialSpec {
    fn material(&self, at: &str) -> Result<Material<f64>, Refused> {
        let material = material(&self.law, self.shear_modulus_pa, self.c_pa, at)?;
        let (field, value) = match material {
            Material::NeoHookean { shear_modulus_pa } => ("shear_modulus_pa", shear_modulus_pa),
            Material::Yeoh { c_pa } => ("c_pa[0]", c_pa[0]),
        };
        require(value > 0.0, &format!("{at}.{field}"), value, "> 0").map(|()| material)
    }
}

impl FiberSpec {
    /// The winding of walls of at least `thinnest_m`.
    fn winding(&self, thinnest_m: f64, at: &str) -> Result<Winding, Refused> {
        let families = families(self.families, at)?;
        require(self.modulus_pa >= 0.0, &format!("{at}.modulus_pa"), self.modulus_pa, ">= 0")?;
        let placement = match self.placement.as_deref() {
            None | Some("sheet") => Placement::Sheet,
            Some("layer") => Placement::Layer,
            Some("smeared") => Placement::Smeared,
            Some(_) => return Err((format!("{at}.placement"), PLACEMENTS.into())),
        };
        let field = format!("{at}.thickness_m");
        if placement == Placement::Smeared {
            superfluous(self.thickness_m.as_ref(), field.clone(), "a smeared winding is as thick as the wall")?;
        }
        let thickness_m = thickness_m(placement, self.thickness_m, thinnest_m, at)?;
        require(placement == Placement::Smeared || thickness_m > 0.0, &field, thickness_m, "> 0")?;
        let wall_share = wall_share(placement, self.wall_share, at)?;
        Ok(Winding { families, modulus_pa: self.modulus_pa, placement, thickness_m, wall_share })
    }
}

/// The actuator's own value or the common one, with its place in the file.
pub(super) fn own<'a, T>(own: Option<&'a T>, common: &'a T, [own_at, common_at]: [&'a str; 2]) -> (&'a T, &'a str) {
    own.map_or((common, common_at), |own| (own, own_at))
}
