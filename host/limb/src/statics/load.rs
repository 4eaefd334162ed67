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
    /// The chain, a piece a module, or a segment of one in series.
    pub rod: Rod,
    pub(super) bundles: Vec<Bundle>,
    pub(super) motions: Vec<Motion>,
    /// The module of each piece.
    pub(super) modules: Vec<usize>,
    /// Tip without load: that of the springs about the shape without load.
    free_tip: Isometry3<f64>,
    /// Factor of all stiffnesses.
    stiffer: f64,
    /// Strains of each piece that the springs are about: stretch, bends and twist.
    pub(super) strains: Vec<Vector4<f64>>,
}

impl LoadedLimb {
    /// The limb of a scene with a gauge pressure, Pa, in each channel and `bays` stretches between plates in each module; a series has no plates.
    ///
    /// `None` where an actuator has no equilibrium at its pressure, or pressures or bays are not as many as channels and modules.
    pub fn new(scene: &Scene, limb: &Limb, pressures_pa: &[f64], bays: &[usize], load: &Load) -> Option<Self> {
        if pressures_pa.len() != limb.channels() || bays.len() != limb.modules().len() {
            return None;
        }
        let modules = limb.modules().iter().zip(bays);
        let bundles = modules.flat_map(|(module, bays)| {
            let (own_pa, bays) = (&pressures_pa[module.channels.clone()], if module.is_series() { 1 } else { *bays });
            module.parts().iter().map(move |part| Bundle::new(part, own_pa, bays))
        });
        // As many spacers as there are plates between the connectors, which need not be those of the scene.
        let masses_kg = |(module, bays): (&Module, &usize)| {
            module.spread_kg(module.elastomer_mass_kg() + bays.saturating_sub(1) as f64 * module.spacer_mass_kg)
        };
        let walls_kg: Vec<f64> = scene.modules().iter().zip(bays).flat_map(masses_kg).collect();
        Some(Self::of_bundles(scene, limb, bundles.collect::<Option<_>>()?, &walls_kg, load))
    }

    /// The limb of a scene whose actuators are these tubes, one a channel, in a series one a segment: other ones than the scene's own, between the
    /// scene's plates.
    ///
    /// `None` where a bundle of them has no shape without load, or where there are not as many tubes.
    pub fn of_springs(scene: &Scene, limb: &Limb, tubes: &[Spring], load: &Load) -> Option<Self> {
        let (mut bundles, mut walls_kg) = (Vec::new(), Vec::new());
        let mut rest = tubes;
        for (module, described) in limb.modules().iter().zip(scene.modules()) {
            for (part, spacers_kg) in module.parts().iter().zip(described.spread_kg(described.spacers_mass_kg())) {
                let (own, others) = rest.split_at_checked(part.channels.len())?;
                let places = part.positions_m().into_iter().zip(own.iter().cloned());
                bundles.push(Bundle::of_springs(part.motion, places.collect(), part.bay_m())?);
                let walls_m3: f64 = own.iter().map(|tube| wall_m3(tube.parameters())).sum();
                walls_kg.push(walls_m3 * described.density_kg_per_m3 + spacers_kg);
                rest = others;
            }
        }
        rest.is_empty().then(|| Self::of_bundles(scene, limb, bundles, &walls_kg, load))
    }

    /// The limb of a scene whose modules, and segments of those in series, are these bundles, with walls and spacers of these masses, kg.
    ///
    /// # Panics
    /// When there are not as many bundles and masses.
    pub fn of_bundles(scene: &Scene, limb: &Limb, bundles: Vec<Bundle>, walls_kg: &[f64], load: &Load) -> Self {
        let of_module = |(index, module): (usize, &'_ LimbModule)| std::iter::repeat_n(index, module.parts().len());
        let modules: Vec<usize> = limb.modules().iter().enumerate().flat_map(of_module).collect();
        let count = modules.len();
        assert_eq!((bundles.len(), walls_kg.len()), (count, count), "a bundle and a mass a module or segment");
        let is_end = |index: usize| modules.get(index + 1) != Some(&modules[index]);
        let parts = limb.parts().zip(&bundles).zip(walls_kg).enumerate();
        let pieces = parts.map(|(index, ((part, bundle), kg))| {
            let masses = is_end(index).then(|| masses(scene, part, index + 1 == count, load));
            piece(part, (bundle, *kg), masses.unwrap_or_default())
        });
        let rod = Rod {
            base: *limb.base(),
            pieces: pieces.collect(),
            gravity_m_per_s2: Vector3::new(0.0, 0.0, -GRAVITY_M_PER_S2),
            tip_force_n: Vector3::from(load.force_n),
        };
        Self::whole(rod, bundles, limb.parts().map(|part| part.motion).collect(), modules)
    }

    fn whole(rod: Rod, bundles: Vec<Bundle>, motions: Vec<Motion>, modules: Vec<usize>) -> Self {
        let q = nalgebra::DVector::zeros(rod.unknowns());
        let free_tip = rod.potential(&q, 0.0).poses.last().copied().unwrap_or(rod.base);
        let strains = rod.pieces.iter().map(|piece| Vector4::from(piece.free)).collect();
        Self { rod, bundles, motions, modules, free_tip, stiffer: 1.0, strains }
    }

    /// A chain at hand, with the kind and the bundle of each of its pieces.
    ///
    /// # Panics
    /// When there are not as many bundles as pieces.
    pub fn of_rod(rod: Rod, bundles: Vec<(Motion, Bundle)>) -> Self {
        assert_eq!(rod.pieces.len(), bundles.len(), "a bundle a piece");
        let (motions, bundles): (Vec<_>, Vec<_>) = bundles.into_iter().unzip();
        let modules = (0..bundles.len()).collect();
        Self::whole(rod, bundles, motions, modules)
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

    /// The bundles of its pieces.
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }

    /// Strains of each piece that its springs are about: stretch, bends and twist.
    pub fn spring_strains(&self) -> &[Vector4<f64>] {
        &self.strains
    }

    /// The limb with other bundles in its pieces, whose springs are about these strains.
    ///
    /// # Panics
    /// When there are not as many bundles and strains as pieces.
    #[must_use]
    pub fn with_bundles(mut self, bundles: Vec<Bundle>, strains: Vec<Vector4<f64>>) -> Self {
        assert_eq!((bundles.len(), strains.len()), (self.bundles.len(), self.bundles.len()), "one a piece");
        bundles.into_iter().enumerate().for_each(|(index, bundle)| self.set_bundle(index, bundle));
        self.strains = strains;
        self
    }

    /// Puts a bundle in the place of a piece's own.
    pub(super) fn set_bundle(&mut self, index: usize, bundle: Bundle) {
        let piece = &mut self.rod.pieces[index];
        let Piece { free, free_shear, stiffness, coupled, shear_n, sway, .. } = bundle.piece(piece.length_m);
        (piece.free, piece.free_shear, piece.sway) = (free, free_shear, sway);
        piece.coupled = coupled * self.stiffer;
        (piece.stiffness, piece.shear_n) = (stiffness * self.stiffer, shear_n * self.stiffer);
        self.bundles[index] = bundle;
    }

    /// Length between plates of the column that a tube of a bundle is part of, m, where its own stretch is `stretch`. Nothing holds the segments of
    /// a series between its ends: those beside it count, as long as they are without load.
    pub(super) fn column_m(&self, index: usize, stretch: f64) -> f64 {
        let of_series = |other: &usize| *other != index && self.modules[*other] == self.modules[index];
        let free_m = |other: usize| self.bundles[other].free.stretch * self.rod.pieces[other].length_m;
        stretch * self.bundles[index].bay_m + (0..self.bundles.len()).filter(of_series).map(free_m).sum::<f64>()
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

/// Masses on the rigid part behind a module; at the tip also the tool and the payload.
fn masses(scene: &Scene, module: &LimbModule, is_tip: bool, load: &Load) -> Vec<(f64, f64)> {
    let [connector_m, tool_m] = module.rigid_parts_m();
    let mut masses = vec![(0.5 * connector_m, scene.limb().connector_mass_kg)];
    if is_tip {
        if let Some(tool) = &scene.limb().end_effector {
            masses.push((connector_m + 0.5 * tool_m, tool.mass_kg));
        }
        masses.push((module.rigid_length_m(), load.payload_kg));
    }
    masses
}

fn piece(part: &LimbModule, (bundle, wall_kg): (&Bundle, f64), masses: Vec<(f64, f64)>) -> Piece {
    Piece {
        mount_angle_rad: part.mount_angle_rad(),
        kg_per_m: wall_kg / part.length_m(),
        rigid_m: part.rigid_length_m(),
        masses,
        ..bundle.piece(part.length_m())
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
