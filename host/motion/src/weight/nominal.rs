//! The nominal limb under load at pressures of its drives.

use std::ops::Range;

use fra_model::State;
use nalgebra::{DVector, Vector3, Vector4};

use softlimb_limb::statics::{
    Buckling, EquilibriumError, Fidelity, Judged, Load, LoadedLimb, Rod, Settled, Shape, by_tubes, cheapest_rod, choose,
};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::Scene;

/// Turns for the springs of leaning tubes after a step of a pressure.
const LEANING_TURNS: usize = 3;
/// By how much a pressure is moved for a derivative, as a share of its range: the model is smooth, and its pressures are good to 1e-10.
const STEP: f64 = 1e-5;
/// Error of the tip that tubes between plates may have, m.
const TUBES_M: f64 = 2e-5;

/// The limb of a scene as its plan knows it, under load: from pose to pose, each beginning from the one before.
#[derive(Clone, Debug)]
pub struct Nominal<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    bays: Vec<usize>,
    tier: Fidelity,
    /// Strains of the modules in the last pose, and its unknowns.
    last: Option<(Vec<Vector4<f64>>, DVector<f64>)>,
}

/// A pose with the pressure of one drive moved.
#[derive(Clone, Debug)]
pub(crate) struct Moved {
    /// The step of the pressure, Pa.
    pub(crate) step_pa: f64,
    /// By how much the tip moves, m.
    pub(crate) tip_m: Vector3<f64>,
    /// Unknowns and chain.
    pub(crate) q: DVector<f64>,
    pub(crate) rod: Rod,
}

/// A loaded shape of the nominal limb.
#[derive(Clone, Debug)]
pub struct Pose {
    /// The limb.
    pub limb: LoadedLimb,
    /// The chain that was solved.
    pub rod: Rod,
    /// Its shape.
    pub shape: Shape,
}

/// Why there is no shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoseError {
    /// An actuator has no equilibrium at its pressure.
    NoEquilibrium,
    /// The limb falls.
    EquilibriumError(EquilibriumError),
    /// A tube buckles between two plates.
    Buckles {
        /// Index of its module.
        module: usize,
        /// Its compression over that at which it buckles; >= 1.
        ratio: f64,
    },
}

impl Pose {
    /// Position of the tip, m.
    pub fn tip_m(&self) -> Vector3<f64> {
        self.shape.tip().translation.vector
    }

    /// The pose, where no tube buckles in it.
    ///
    /// # Errors
    /// [`PoseError::Buckles`].
    pub fn unbuckled(self) -> Result<Self, PoseError> {
        stands(self.limb.buckling(&self.rod, &self.shape))?;
        Ok(self)
    }
}

pub(super) fn stands(worst: Option<Buckling>) -> Result<(), PoseError> {
    match worst {
        Some(tube) if tube.ratio() >= 1.0 => Err(PoseError::Buckles { module: tube.module, ratio: tube.ratio() }),
        _ => Ok(()),
    }
}

impl<'a> Nominal<'a> {
    /// The limb by one tier.
    pub fn new(scene: &'a Scene, limb: &'a Limb, tier: Fidelity) -> Self {
        let bays = scene.modules().iter().map(|module| usize::from(module.spacers) + 1).collect();
        Self { scene, limb, bays, tier, last: None }
    }

    /// The tier.
    pub fn tier(&self) -> Fidelity {
        self.tier
    }

    /// The shape at gauge pressures, Pa, one a drive.
    ///
    /// # Errors
    /// [`PoseError`].
    pub fn at(&mut self, pressures_pa: &[f64], payload_kg: f64) -> Result<Pose, PoseError> {
        self.at_channels(&self.limb.channel_values(pressures_pa), payload_kg)
    }

    /// The shape at gauge pressures, Pa, one a channel: unequal ones bend a bundle of extending actuators.
    ///
    /// # Errors
    /// [`PoseError`].
    pub fn at_channels(&mut self, channels_pa: &[f64], payload_kg: f64) -> Result<Pose, PoseError> {
        let limb = self.loaded_at(channels_pa, payload_kg).ok_or(PoseError::NoEquilibrium)?;
        let limb = match &self.last {
            Some((strains, _)) => limb.at_strains(strains).unwrap_or(limb),
            None => limb,
        };
        let start = self.last.as_ref().map(|(_, q)| q);
        let Settled { limb, rod, shape } = limb.settle(self.tier, start).map_err(PoseError::EquilibriumError)?;
        self.last = Some((limb.strains(&rod, &shape.q), shape.q.clone()));
        Ok(Pose { limb, rod, shape })
    }

    /// The shape with the pressure of each drive moved by a step, to first order; `None` where a pose is not stable.
    pub(crate) fn moved(&self, pose: &Pose, pressures_pa: &[f64]) -> Option<Vec<Moved>> {
        let drives = self.limb.drives().map(|drive| (drive.index, drive.channels));
        let channels_pa = self.limb.channel_values(pressures_pa);
        self.moved_by(pose, &channels_pa, drives)
    }

    /// The same with the pressures of groups of channels moved, each of which belongs to a module, from those of all channels.
    fn moved_by(
        &self,
        pose: &Pose,
        channels_pa: &[f64],
        groups: impl Iterator<Item = (usize, Range<usize>)>,
    ) -> Option<Vec<Moved>> {
        let (parts, bends) = self.tier.pieces();
        let strains = pose.limb.strains(&pose.rod, &pose.shape.q);
        let responding = pose.shape.responding(&pose.rod, bends)?;
        let here = pose.limb.at_strains(&strains).ok()?;
        let of_group = |(module, group): (usize, Range<usize>)| {
            let mut moved_pa = channels_pa.to_vec();
            let step_pa = step_pa(&self.limb.modules()[module], channels_pa[group.start]);
            moved_pa[group].iter_mut().for_each(|pressure_pa| *pressure_pa += step_pa);
            // Springs go with the strains, which the response of these springs tells. Those of leaning tubes converge more slowly.
            let turns = if self.limb.modules()[module].is_restrained() { LEANING_TURNS } else { 1 };
            let mut there = self.beside(pose, &here, module, &moved_pa, &strains)?;
            for _ in 0..turns {
                let rod = there.rod.split(parts);
                let (_, change) = responding.to(&rod);
                there = there.at_strains(&there.strains(&rod, &(&pose.shape.q + change))).ok()?;
            }
            let rod = there.rod.split(parts);
            let (tip_m, change) = responding.to(&rod);
            Some(Moved { step_pa, tip_m, q: &pose.shape.q + change, rod })
        };
        groups.map(of_group).collect()
    }

    /// `here`, a pose with springs about its strains, with other pressures in the actuators of one module, Pa, one a channel.
    fn beside(
        &self,
        pose: &Pose,
        here: &LoadedLimb,
        index: usize,
        channels_pa: &[f64],
        strains: &[Vector4<f64>],
    ) -> Option<LoadedLimb> {
        let (before, rest) = self.limb.modules().split_at(index);
        let (module, first) = (rest.first()?, before.iter().map(|module| module.parts().len()).sum::<usize>());
        let own_pa = &channels_pa[module.channels.clone()];
        let mut bundles = here.bundles().to_vec();
        for (at, part) in (first..).zip(module.parts()) {
            let moved = pose.limb.bundles()[at].at_pressures(part, own_pa)?;
            bundles[at] = moved.strained(part.motion, &strains[at])?;
        }
        Some(here.clone().with_bundles(bundles, strains.to_vec()))
    }

    /// Velocity of the tip of a pose by the pressure of each actuator, m/Pa, in the order of the channels; `None` where the pose is not stable.
    pub fn velocities_m_per_pa(&self, pose: &Pose, pressures_pa: &[f64]) -> Option<Vec<Vector3<f64>>> {
        let modules = self.limb.modules().iter().enumerate();
        let single = modules.flat_map(|(index, module)| module.channels.clone().map(move |at| (index, at..at + 1)));
        let moved = self.moved_by(pose, &self.limb.channel_values(pressures_pa), single)?;
        Some(moved.into_iter().map(|moved| moved.tip_m / moved.step_pa).collect())
    }

    /// By how much tubes between plates have the tip elsewhere at gauge pressures, Pa, one a drive; `None` where either does not stand.
    pub fn tubes_shift_m(&mut self, pressures_pa: &[f64], payload_kg: f64) -> Option<Vector3<f64>> {
        let rods_m = self.at(pressures_pa, payload_kg).ok()?.tip_m();
        let length_m = self.scene.rest_length_m();
        let tubes = by_tubes(&self.loaded(pressures_pa, payload_kg)?, TUBES_M / length_m, length_m)?;
        Some(tubes.tip().translation.vector - rods_m)
    }

    /// The cheapest tier of rods for the shape at gauge pressures, Pa, one a drive, where it is finer than the present one.
    pub(crate) fn finer_tier(&mut self, pressures_pa: &[f64], payload_kg: f64, error: f64) -> Option<Fidelity> {
        let pose = self.at(pressures_pa, payload_kg).ok()?;
        let found = choose(&pose.limb.rod, error, self.scene.rest_length_m(), |_, _, _| Judged::default()).ok()?;
        Some(found.tier).filter(|tier| *tier > self.tier)
    }

    pub(super) fn loaded(&self, pressures_pa: &[f64], payload_kg: f64) -> Option<LoadedLimb> {
        self.loaded_at(&self.limb.channel_values(pressures_pa), payload_kg)
    }

    /// The limb at a gauge pressure, Pa, of each channel.
    fn loaded_at(&self, channels_pa: &[f64], payload_kg: f64) -> Option<LoadedLimb> {
        let load = Load { payload_kg, ..Load::default() };
        LoadedLimb::new(self.scene, self.limb, channels_pa, &self.bays, &load)
    }

    /// The limb at gauge pressures, Pa, one a drive, ready to be loaded.
    ///
    /// # Errors
    /// [`PoseError::NoEquilibrium`].
    pub(super) fn at_pressures(
        scene: &Scene,
        limb: &Limb,
        pressures_pa: &[f64],
        payload_kg: f64,
    ) -> Result<LoadedLimb, PoseError> {
        Nominal::new(scene, limb, Fidelity::Linear).loaded(pressures_pa, payload_kg).ok_or(PoseError::NoEquilibrium)
    }

    /// The same limb with another number of spacers in a module.
    pub(super) fn with_spacers(mut self, module: usize, spacers: usize) -> Self {
        self.bays[module] = spacers + 1;
        self
    }

    /// The cheapest tier of rods for a pose, from the linear one on, and the error that it says of itself, as a share of the limb's length.
    ///
    /// # Errors
    /// [`PoseError`].
    pub fn tier_for(
        scene: &Scene,
        limb: &Limb,
        pressures_pa: &[f64],
        payload_kg: f64,
        error: f64,
    ) -> Result<(Fidelity, f64), PoseError> {
        let loaded = Self::at_pressures(scene, limb, pressures_pa, payload_kg)?;
        let answer = cheapest_rod(&loaded, error, scene.rest_length_m()).map_err(PoseError::EquilibriumError)?;
        stands(answer.buckling)?;
        Ok((answer.tier.max(Fidelity::Linear), answer.error()))
    }
}

/// A step of a pressure of a module's actuators, Pa, towards the middle of its range: there is an equilibrium on that side.
pub(crate) fn step_pa(module: &LimbModule, pressure_pa: f64) -> f64 {
    let span_pa = module.single_valued_max_pa();
    if pressure_pa < 0.5 * span_pa { STEP * span_pa } else { -STEP * span_pa }
}

/// Pressures of states, Pa; below ambient pressure 0.
pub(crate) fn pressures_pa(states: &[State<f64>]) -> Vec<f64> {
    states.iter().map(|state| state.pressure_pa.max(0.0)).collect()
}
