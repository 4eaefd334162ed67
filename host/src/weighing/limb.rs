//! The nominal limb at the pressures of a sighting, under a mass.

use nalgebra::{DVector, Vector3};

use super::{Refusal, Sighting};
use crate::design::Limb;
use crate::scene::Scene;
use crate::statics::{GRAVITY_M_PER_S2, Load, LoadedLimb, Rod, Tier, by_tier};

/// The finest there is: a few poses cost nothing.
const TIER: Tier = Tier::Fourfold;

/// The limb of one sighting, from mass to mass, each beginning from the one before.
pub(super) struct Posed {
    line: usize,
    rod: Rod,
    last: Option<DVector<f64>>,
}

/// The tip under a mass.
pub(super) struct Tip {
    pub(super) at_m: Vector3<f64>,
    /// How it moves with the mass, m/kg.
    pub(super) slope_m_per_kg: Vector3<f64>,
}

impl Posed {
    /// `stiffer` is the factor of all of its stiffnesses; the shape without load stays.
    pub(super) fn new(scene: &Scene, limb: &Limb, seen: &Sighting, stiffer: f64) -> Result<Self, Refusal> {
        let of_module = limb.modules().iter().zip(&seen.pressures_pa);
        let channels: Vec<f64> =
            of_module.flat_map(|(module, pressure)| std::iter::repeat_n(*pressure, module.channels.len())).collect();
        let bays: Vec<usize> = scene.modules().iter().map(|module| usize::from(module.spacers) + 1).collect();
        let loaded = LoadedLimb::new(scene, limb, &channels, &bays, &Load::default());
        let mut rod = loaded.ok_or(Refusal::NoEquilibrium { line: seen.line })?.rod;
        for piece in &mut rod.pieces {
            piece.stiffness *= stiffer;
            piece.shear_n *= stiffer;
        }
        Ok(Self { line: seen.line, rod, last: None })
    }

    /// The tip under a mass, kg. Below zero it is lifted: a mass near zero has errors of both signs.
    pub(super) fn under(&mut self, kg: f64) -> Result<Tip, Refusal> {
        let weight_n = Vector3::new(0.0, 0.0, -GRAVITY_M_PER_S2);
        self.rod.tip_force_n = weight_n * kg;
        let falls = Refusal::Falls { line: self.line };
        let (rod, shape) = by_tier(&self.rod, TIER, self.last.as_ref()).map_err(|_| falls.clone())?;
        let compliance = shape.compliance_m_per_n(&rod, TIER.pieces().1).ok_or(falls)?;
        let at_m = shape.tip().translation.vector;
        self.last = Some(shape.q);
        Ok(Tip { at_m, slope_m_per_kg: compliance * weight_n })
    }
}
