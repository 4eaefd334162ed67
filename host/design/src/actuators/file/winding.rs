//! Material and winding of a segment in a problem file.

use fra_model::{Families, Material, Placement};
use serde::Deserialize;

use super::segment::Name;
use super::{Refused, missing, require, superfluous};
use crate::actuators::problem::Winding;

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
}

impl MaterialSpec {
    pub(super) fn material(&self, at: &str) -> Result<Material<f64>, Refused> {
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

impl FiberSpec {
    /// The winding; `thinnest_m` is the least wall within the bounds.
    pub(super) fn winding(&self, at: &str, thinnest_m: f64) -> Result<Winding, Refused> {
        let families = match self.families {
            1 => Families::One,
            2 => Families::Two,
            n => return Err((format!("{at}.families"), format!("= {n} is not allowed: 1 or 2"))),
        };
        let placement = match self.placement {
            None | Some(Name::Sheet) => Placement::Sheet,
            Some(Name::Layer) => Placement::Layer,
            Some(Name::Smeared) => Placement::Smeared,
            Some(_) => return Err((format!("{at}.placement"), PLACEMENTS.into())),
        };
        let field = format!("{at}.thickness_m");
        let thickness_m = match placement {
            Placement::Sheet => missing(self.thickness_m, field, "a sheet has one")?,
            Placement::Layer => {
                let thickness_m = missing(self.thickness_m, field.clone(), "a layer has one")?;
                let allowed = format!("> 0, at most {thinnest_m}, the thinnest wall");
                require(thickness_m > 0.0 && thickness_m <= thinnest_m, &field, thickness_m, &allowed)?;
                thickness_m
            }
            Placement::Smeared => self.thickness_m.unwrap_or(0.0),
        };
        Ok(Winding { families, modulus_pa: self.modulus_pa, placement, thickness_m })
    }
}

const PLACEMENTS: &str = "is not allowed: \"sheet\", \"layer\" or \"smeared\"";
