//! A limb of a scene as a chain of rods, and what its tubes carry.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Vector3};

use super::bundle::Bundle;
use super::rod::{Piece, Rod, UNKNOWNS};
use super::solve::Shape;
use crate::design::{Limb, LimbModule};
use crate::scene::{Module, Scene};

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
    bundles: Vec<Bundle>,
    motions: Vec<fra_model::Motion>,
}

/// The tube that is closest to buckling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buckling {
    /// Index of its module.
    pub module: usize,
    /// Index in the module.
    pub tube: usize,
    /// Compressive force, N; negative where even this tube is pulled.
    pub compression_n: f64,
    /// Force that one tube between two plates buckles at: `4 pi^2 EI/a^2`, N.
    pub euler_n: f64,
}

impl Buckling {
    /// Compression over the force of buckling; 0 where the tube is pulled.
    pub fn ratio(&self) -> f64 {
        (self.compression_n / self.euler_n).max(0.0)
    }
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
        let walls_kg: Vec<f64> = scene.modules().iter().map(Module::elastomer_mass_kg).collect();
        Some(Self::of_bundles(scene, limb, bundles.collect::<Option<_>>()?, &walls_kg, load))
    }

    /// The limb of a scene whose modules are these bundles, with walls of these masses, kg.
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
        Self { rod, bundles, motions: modules.iter().map(|module| module.motion).collect() }
    }

    /// Tip without any load: the kinematics.
    pub fn free_tip(&self) -> Isometry3<f64> {
        let q = nalgebra::DVector::zeros(self.rod.unknowns());
        self.rod.potential(&q, 0.0).poses.last().copied().unwrap_or(self.rod.base)
    }

    /// The tube that is closest to buckling in a shape of `rod`, which may have each module in several pieces.
    pub fn buckling(&self, rod: &Rod, shape: &Shape) -> Option<Buckling> {
        let parts = rod.pieces.len() / self.bundles.len().max(1);
        let mut worst: Option<Buckling> = None;
        for (index, piece) in rod.pieces.iter().enumerate() {
            let module = index / parts.max(1);
            let [mean, linear] = piece.differences(&shape.q.as_slice()[index * UNKNOWNS..][..UNKNOWNS]);
            for end in [-1.0, 1.0] {
                let at = mean + linear * end;
                for tube in 0..self.bundles[module].tubes.len() {
                    let found = self.tube(module, tube, at.x, [at.y, at.z]);
                    if worst
                        .is_none_or(|worst| found.compression_n / found.euler_n > worst.compression_n / worst.euler_n)
                    {
                        worst = Some(found);
                    }
                }
            }
        }
        worst
    }

    /// The first bending module that is bent backwards anywhere, by more than `by_rad_per_m`: its lines do not shorten, so that this is
    /// beyond the model.
    pub fn bent_back(&self, rod: &Rod, shape: &Shape, by_rad_per_m: f64) -> Option<usize> {
        let parts = rod.pieces.len() / self.bundles.len().max(1);
        let back = |index: usize| {
            let piece = &rod.pieces[index];
            let [mean, linear] = piece.differences(&shape.q.as_slice()[index * UNKNOWNS..][..UNKNOWNS]);
            self.motions[index / parts.max(1)] == fra_model::Motion::Bending
                && piece.free[1] + mean.y - linear.y.abs() < -by_rad_per_m
        };
        (0..rod.pieces.len()).find(|index| back(*index)).map(|index| index / parts.max(1))
    }

    fn tube(&self, module: usize, tube: usize, strain: f64, bend: [f64; 2]) -> Buckling {
        let bundle = &self.bundles[module];
        let ([x, y], tangent) = bundle.tubes[tube];
        let euler_n = 4.0 * PI * PI * tangent.bending_nm2.min(tangent.across_nm2) / (bundle.bay_m * bundle.bay_m);
        let force_n = if self.motions[module] == fra_model::Motion::Bending {
            tangent.axial_n * strain
        } else {
            let [free_x, free_y] = bundle.free.bend_rad_per_m;
            let stretch = bundle.free.stretch + strain - (free_x + bend[0]) * x - (free_y + bend[1]) * y;
            let own =
                if self.motions[module] == fra_model::Motion::Twisting { bundle.free.stretch } else { tangent.stretch };
            tangent.axial_n * (stretch - own)
        };
        Buckling { module, tube, compression_n: -force_n, euler_n }
    }
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
    let free = bundle.free;
    Piece {
        free: [free.stretch, free.bend_rad_per_m[0], free.bend_rad_per_m[1], free.twist_rad_per_m],
        stiffness: bundle.stiffness,
        shear_n: bundle.shear_n,
        length_m: module.length_m(),
        mount_angle_rad: module.mount_angle_rad(),
        kg_per_m: wall_kg / module.length_m(),
        rigid_m: module.rigid_length_m(),
        masses,
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
