//! A limb of a scene as a chain of rods.

use fra_model::{ActuatorParameters, Motion};
use nalgebra::{Isometry3, Vector3, Vector4};

use super::bundle::Bundle;
use super::rod::{Piece, Rod};
use super::spring::Spring;
use crate::{Limb, LimbModule};
use softlimb_scene::{Module, Scene};

/// Acceleration of gravity, m/s2, against the scene's third axis.
pub const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// What a limb carries beside itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// A mass at the tip, kg; >= 0.
    pub payload_kg: f64,
    /// A force on the tip, N, in the scene's frame.
    pub force_n: [f64; 3],
}

/// A limb at given pressures, ready to be loaded.
#[derive(Clone, Debug)]
pub struct LoadedLimb {
    /// The chain, a piece a module.
    pub rod: Rod,
    pub(super) bundles: Vec<Bundle>,
    pub(super) motions: Vec<Motion>,
    /// Tip without load: that of the springs about the shape without load.
    free_tip: Isometry3<f64>,
    /// Factor of all stiffnesses.
    stiffer: f64,
    /// Strains of each module that the springs are about: stretch, bends and twist.
    pub(super) strains: Vec<Vector4<f64>>,
}

impl LoadedLimb {
    /// The limb of a scene with a gauge pressure, Pa, in each channel and `bays` stretches between plates in each module.
    ///
    /// `None` where an actuator has no equilibrium at its pressure, or pressures or bays are not as many as channels and modules.
    pub fn new(scene: &Scene, limb: &Limb, pressures_pa: &[f64], bays: &[usize], load: &Load) -> Option<Self> {
        if pressures_pa.len() != limb.channels() || bays.len() != limb.modules().len() {
            return None;
        }
        let modules = limb.modules().iter().zip(bays);
        let bundles = modules.map(|(module, bays)| Bundle::new(module, &pressures_pa[module.channels.clone()], *bays));
        // As many spacers as there are plates between the connectors, which need not be those of the scene.
        let mass_kg = |(module, bays): (&Module, &usize)| {
            module.elastomer_mass_kg() + bays.saturating_sub(1) as f64 * module.spacer_mass_kg
        };
        let walls_kg: Vec<f64> = scene.modules().iter().zip(bays).map(mass_kg).collect();
        Some(Self::of_bundles(scene, limb, bundles.collect::<Option<_>>()?, &walls_kg, load))
    }

    /// The limb of a scene whose actuators are these tubes, one a channel: other ones than the scene's own, between the scene's plates.
    ///
    /// `None` where a bundle of them has no shape without load, or where there are not as many tubes as channels.
    pub fn of_springs(scene: &Scene, limb: &Limb, tubes: &[Spring], load: &Load) -> Option<Self> {
        if tubes.len() != limb.channels() {
            return None;
        }
        let modules = || limb.modules().iter().map(|module| (module, &tubes[module.channels.clone()]));
        let bundle = |(module, tubes): (&LimbModule, &[Spring])| {
            let places = module.positions_m().into_iter().zip(tubes.iter().cloned());
            Bundle::of_springs(module.motion, places.collect(), module.bay_m())
        };
        let wall_kg = |((_, tubes), described): ((&LimbModule, &[Spring]), &Module)| {
            let walls_m3: f64 = tubes.iter().map(|tube| wall_m3(tube.parameters())).sum();
            walls_m3 * described.density_kg_per_m3 + described.spacers_mass_kg()
        };
        let walls_kg: Vec<f64> = modules().zip(scene.modules()).map(wall_kg).collect();
        Some(Self::of_bundles(scene, limb, modules().map(bundle).collect::<Option<_>>()?, &walls_kg, load))
    }

    /// The limb of a scene whose modules are these bundles, with walls and spacers of these masses, kg.
    ///
    /// # Panics
    /// When there are not as many bundles and masses as modules.
    pub fn of_bundles(scene: &Scene, limb: &Limb, bundles: Vec<Bundle>, walls_kg: &[f64], load: &Load) -> Self {
        let modules = limb.modules();
        assert_eq!((bundles.len(), walls_kg.len()), (modules.len(), modules.len()), "a bundle and a mass a module");
        let parts = modules.iter().zip(&bundles).zip(walls_kg).enumerate();
        let pieces = parts.map(|(index, ((module, bundle), kg))| piece(scene, module, index, (bundle, *kg), load));
        let rod = Rod {
            base: *limb.base(),
            pieces: pieces.collect(),
            gravity_m_per_s2: Vector3::new(0.0, 0.0, -GRAVITY_M_PER_S2),
            tip_force_n: Vector3::from(load.force_n),
        };
        Self::whole(rod, bundles, modules.iter().map(|module| module.motion).collect())
    }

    fn whole(rod: Rod, bundles: Vec<Bundle>, motions: Vec<Motion>) -> Self {
        let q = nalgebra::DVector::zeros(rod.unknowns());
        let free_tip = rod.potential(&q, 0.0).poses.last().copied().unwrap_or(rod.base);
        let strains = rod.pieces.iter().map(|piece| Vector4::from(piece.free)).collect();
        Self { rod, bundles, motions, free_tip, stiffer: 1.0, strains }
    }

    /// A chain at hand, with the kind and the bundle of each of its pieces.
    ///
    /// # Panics
    /// When there are not as many bundles as pieces.
    pub fn of_rod(rod: Rod, bundles: Vec<(Motion, Bundle)>) -> Self {
        assert_eq!(rod.pieces.len(), bundles.len(), "a bundle a piece");
        let (motions, bundles) = bundles.into_iter().unzip();
        Self::whole(rod, bundles, motions)
    }

    /// The same limb with all stiffnesses times a factor; its shape without load stays.
    #[must_use]
    pub fn stiffened(mut self, factor: f64) -> Self {
        self.stiffer *= factor;
        for piece in &mut self.rod.pieces {
            piece.stiffness *= factor;
            piece.coupled *= factor;
            piece.shear_n *= factor;
        }
        self
    }

    /// The bundles of its modules.
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }

    /// Strains of each module that its springs are about: stretch, bends and twist.
    pub fn spring_strains(&self) -> &[Vector4<f64>] {
        &self.strains
    }

    /// The limb with other bundles in its modules, whose springs are about these strains.
    ///
    /// # Panics
    /// When there are not as many bundles and strains as modules.
    #[must_use]
    pub fn with_bundles(mut self, bundles: Vec<Bundle>, strains: Vec<Vector4<f64>>) -> Self {
        assert_eq!((bundles.len(), strains.len()), (self.bundles.len(), self.bundles.len()), "one a module");
        bundles.into_iter().enumerate().for_each(|(module, bundle)| self.set_bundle(module, bundle));
        self.strains = strains;
        self
    }

    /// Puts a bundle in the place of a module's own.
    pub(super) fn set_bundle(&mut self, module: usize, bundle: Bundle) {
        let piece = &mut self.rod.pieces[module];
        let Piece { free, free_shear, stiffness, coupled, shear_n, sway, .. } = bundle.piece(piece.length_m);
        (piece.free, piece.free_shear, piece.sway) = (free, free_shear, sway);
        piece.coupled = coupled * self.stiffer;
        (piece.stiffness, piece.shear_n) = (stiffness * self.stiffer, shear_n * self.stiffer);
        self.bundles[module] = bundle;
    }

    /// Tip without any load: the kinematics.
    pub fn free_tip(&self) -> Isometry3<f64> {
        self.free_tip
    }
}

/// Volume of a tube's wall, m3.
fn wall_m3(parameters: &ActuatorParameters<f64>) -> f64 {
    let (inner, outer) = (parameters.inner_radius_m, parameters.outer_radius_m);
    std::f64::consts::PI * (outer - inner) * (outer + inner) * parameters.length_m
}

fn piece(scene: &Scene, module: &LimbModule, index: usize, (bundle, wall_kg): (&Bundle, f64), load: &Load) -> Piece {
    let [connector_m, tool_m] = module.rigid_parts_m();
    let mut masses = vec![(0.5 * connector_m, scene.limb().connector_mass_kg)];
    if index + 1 == scene.modules().len() {
        if let Some(tool) = &scene.limb().end_effector {
            masses.push((connector_m + 0.5 * tool_m, tool.mass_kg));
        }
        masses.push((module.rigid_length_m(), load.payload_kg));
    }
    Piece {
        mount_angle_rad: module.mount_angle_rad(),
        kg_per_m: wall_kg / module.length_m(),
        rigid_m: module.rigid_length_m(),
        masses,
        ..bundle.piece(module.length_m())
    }
}

impl Rod {
    /// The same rod with every piece in `parts` >= 1 pieces, which bend more freely.
    pub fn split(&self, parts: usize) -> Self {
        let mut pieces = Vec::with_capacity(self.pieces.len() * parts);
        for piece in &self.pieces {
            let inner =
                Piece { length_m: piece.length_m / parts as f64, rigid_m: 0.0, masses: Vec::new(), ..piece.clone() };
            let last = Piece { rigid_m: piece.rigid_m, masses: piece.masses.clone(), ..inner.clone() };
            pieces.extend(std::iter::repeat_n(inner, parts.saturating_sub(1)));
            pieces.push(last);
        }
        Self { pieces, ..self.clone() }
    }
}
