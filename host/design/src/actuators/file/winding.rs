//! Material and winding of a segment in a problem file.

use fra_model::{Families, Material, Motion, Placement};
use serde::Deserialize;

use super::segment::Name;
use crate::actuators::problem::Winding;
use softlimb_files::object::NamedOr;
use softlimb_files::problem::{Refused, missing, require, superfluous};
use softlimb_scene::castable_elastomer;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialSpec {
    law: Name,
    shear_modulus_pa: Option<f64>,
    c_pa: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FiberSpec {
    families: u8,
    modulus_pa: f64,
    placement: Option<Name>,
    thickness_m: Option<f64>,
    wall_share: Option<f64>,
}

impl MaterialSpec {
    pub(super) fn material(&self, at: &str) -> Result<Material<f64>, Refused> {
        let law = match self.law {
            Name::NeoHookean => "neo-hookean",
            Name::Yeoh => "yeoh",
            _ => "",
        };
        material(law, self.shear_modulus_pa, self.c_pa, at)
    }
}

/// A material that is stated, or that of a castable elastomer by trade name.
pub(crate) fn stated_or_named<S>(
    material: &NamedOr<S>,
    at: &str,
    stated: impl Fn(&S, &str) -> Result<Material<f64>, Refused>,
) -> Result<Material<f64>, Refused> {
    match material {
        NamedOr::Object(spec) => stated(spec, at),
        NamedOr::Name(name) => match castable_elastomer(name) {
            Ok(known) => Ok(known.material()),
            Err(help) => Err((at.into(), format!("= \"{name}\" is no known elastomer: {help}"))),
        },
    }
}

/// A material by the name of its law, with the coefficients of that law and no other.
pub(crate) fn material(
    law: &str,
    shear_modulus_pa: Option<f64>,
    c_pa: Option<[f64; 3]>,
    at: &str,
) -> Result<Material<f64>, Refused> {
    let (modulus, c) = (format!("{at}.shear_modulus_pa"), format!("{at}.c_pa"));
    match law {
        "neo-hookean" => {
            superfluous(c_pa.as_ref(), c, "a neo-hookean material has none")?;
            Ok(Material::NeoHookean { shear_modulus_pa: missing(shear_modulus_pa, modulus, "a number, Pa")? })
        }
        "yeoh" => {
            superfluous(shear_modulus_pa.as_ref(), modulus, "a yeoh material has c_pa")?;
            Ok(Material::Yeoh { c_pa: missing(c_pa, c, "three numbers, Pa")? })
        }
        _ => Err((format!("{at}.law"), "is not allowed: \"neo-hookean\" or \"yeoh\"".into())),
    }
}

/// Families of helices by their number.
pub(crate) fn families(number: u8, at: &str) -> Result<Families, Refused> {
    match number {
        1 => Ok(Families::One),
        2 => Ok(Families::Two),
        n => Err((format!("{at}.families"), format!("= {n} is not allowed: 1 or 2"))),
    }
}

/// The place of a sheet in the wall.
pub(crate) fn wall_share(placement: Placement, share: Option<f64>, at: &str) -> Result<f64, Refused> {
    let field = format!("{at}.wall_share");
    if placement != Placement::Sheet {
        superfluous(share.as_ref(), field.clone(), "only a sheet has a place in the wall")?;
    }
    let share = share.unwrap_or(1.0);
    require((0.0..=1.0).contains(&share), &field, share, "0, the inner face, to 1, the outer one")?;
    Ok(share)
}

/// Thickness of a sheet, or of a layer within walls of at least `thinnest_m`.
pub(crate) fn thickness_m(
    placement: Placement,
    thickness_m: Option<f64>,
    thinnest_m: f64,
    at: &str,
) -> Result<f64, Refused> {
    let field = format!("{at}.thickness_m");
    match placement {
        Placement::Sheet => missing(thickness_m, field, "a sheet has one"),
        Placement::Layer => {
            let thickness_m = missing(thickness_m, field.clone(), "a layer has one")?;
            let allowed = format!("> 0, at most {thinnest_m}, the thinnest wall");
            require(thickness_m > 0.0 && thickness_m <= thinnest_m, &field, thickness_m, &allowed)?;
            Ok(thickness_m)
        }
        Placement::Smeared => Ok(thickness_m.unwrap_or(0.0)),
    }
}

impl FiberSpec {
    /// The winding; `thinnest_m` is the least wall within the bounds.
    pub(super) fn winding(&self, motion: Motion, at: &str, thinnest_m: f64) -> Result<Winding, Refused> {
        let families = families(self.families, at)?;
        // The model of a bend follows no other angle.
        if motion == Motion::Bending {
            let allowed = "2: the model of a bend follows two equal families alone";
            require(families == Families::Two, &format!("{at}.families"), self.families, allowed)?;
            let is_sheet = matches!(self.placement, None | Some(Name::Sheet));
            if !is_sheet {
                let allowed = "is not allowed: \"sheet\", the only one whose angle the model of a bend follows";
                return Err((format!("{at}.placement"), allowed.into()));
            }
        }
        let placement = match self.placement {
            None | Some(Name::Sheet) => Placement::Sheet,
            Some(Name::Layer) => Placement::Layer,
            Some(Name::Smeared) => Placement::Smeared,
            Some(_) => return Err((format!("{at}.placement"), PLACEMENTS.into())),
        };
        let thickness_m = thickness_m(placement, self.thickness_m, thinnest_m, at)?;
        let wall_share = wall_share(placement, self.wall_share, at)?;
        Ok(Winding { families, modulus_pa: self.modulus_pa, placement, thickness_m, wall_share })
    }
}

pub(crate) const PLACEMENTS: &str = "is not allowed: \"sheet\", \"layer\" or \"smeared\"";
