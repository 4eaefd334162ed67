//! The nominal limb at the pressures of an observation, under a mass.

use nalgebra::{DVector, Vector3};

use super::creep::crept;
use super::{EstimationError, Observation};
use softlimb_limb::statics::{Bundle, Fidelity, GRAVITY_M_PER_S2, Load, LoadedLimb, Settled};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Module, Scene};

/// The finest tier of rods, by which the simulated limb hangs too: a few poses cost nothing.
const TIER: Fidelity = Fidelity::Fourfold;

/// The limb of one observation, from mass to mass; each solve starts from the last shape.
pub(super) struct Posed {
    line: usize,
    limb: LoadedLimb,
    last: Option<DVector<f64>>,
}

/// The tip under a mass.
pub(super) struct Tip {
    pub(super) at_m: Vector3<f64>,
    /// Its derivative by the mass, m/kg.
    pub(super) slope_m_per_kg: Vector3<f64>,
}

impl Posed {
    /// Walls have crept by these volumes, one a drive; `stiffer` is the factor of all stiffnesses, and the shape without load stays.
    pub(super) fn new(
        scene: &Scene,
        limb: &Limb,
        observation: &Observation,
        crept_m3: &[f64],
        stiffer: f64,
    ) -> Result<Self, EstimationError> {
        // The rig has no vacuum: a reading below zero is rest.
        let drives: Vec<(f64, f64)> = observation
            .pressures_pa
            .iter()
            .map(|pressure_pa| pressure_pa.max(0.0))
            .zip(crept_m3.iter().copied())
            .collect();
        let modules = limb.modules().iter().zip(scene.modules()).enumerate();
        let bundles = modules.map(|(index, (module, described))| {
            bundle(module, usize::from(described.spacers) + 1, &drives[limb.drives_of(index)])
        });
        let bundles =
            bundles.collect::<Option<_>>().ok_or(EstimationError::NoEquilibrium { line: observation.line })?;
        let walls_kg: Vec<f64> = scene.modules().iter().map(Module::mass_kg).collect();
        let limb = LoadedLimb::of_bundles(scene, limb, bundles, &walls_kg, &Load::default()).stiffened(stiffer);
        Ok(Self { line: observation.line, limb, last: None })
    }

    /// The tip under a mass, kg. Below zero it is lifted: a mass near zero has errors of both signs.
    pub(super) fn under(&mut self, kg: f64) -> Result<Tip, EstimationError> {
        let weight_n = Vector3::new(0.0, 0.0, -GRAVITY_M_PER_S2);
        self.limb.rod.tip_force_n = weight_n * kg;
        let falls = EstimationError::Falls { line: self.line };
        let Settled { limb, rod, shape } = self.limb.settle(TIER, self.last.as_ref()).map_err(|_| falls.clone())?;
        let compliance = shape.compliance_m_per_n(&rod, TIER.pieces().1).ok_or(falls)?;
        let at_m = shape.tip().translation.vector;
        self.last = Some(shape.q);
        // The next mass begins with these springs.
        self.limb = limb;
        Ok(Tip { at_m, slope_m_per_kg: compliance * weight_n })
    }
}

/// Springs at the pressures of their drives, Pa, about the shapes that they have with their creep, m3.
fn bundle(module: &LimbModule, bays: usize, drives: &[(f64, f64)]) -> Option<Bundle> {
    let spring = |(pressure_pa, crept_m3): &(f64, f64)| {
        Some(module.spring(*pressure_pa)?.about(&crept(module, *pressure_pa, *crept_m3)?))
    };
    let springs = drives.iter().map(spring).collect::<Option<Vec<_>>>()?;
    let tubes = module.positions_m().into_iter().zip(springs.into_iter().cycle()).collect();
    Bundle::of_springs(module.motion, tubes, module.length_m() / bays as f64)
}
