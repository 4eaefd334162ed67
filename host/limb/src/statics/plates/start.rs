//! Where Newton's method begins: tubes that move with the sections of a rod.

use std::ops::Range;

use fra_model::Motion;
use nalgebra::{DVector, Isometry3, Matrix4x2, Translation3, UnitQuaternion, Vector3, Vector6};

use super::tube::Held;
use super::{Bay, Plates};
use crate::statics::bundle::energy;
use crate::statics::load::LoadedLimb;
use crate::statics::rod::{Piece, Rod, UNKNOWNS};
use crate::statics::tube::Tangent;

/// The shortest step of the loads, of all of them.
const LEAST_STEP: f64 = 1.0 / 256.0;

impl LoadedLimb {
    /// The limb with every tube a rod of its own, from the unknowns `q` of `rod`, which may have each module in several pieces.
    ///
    /// With `fine` 2 a tube has two pieces in a bay and at least four in a module, with 1, 4 and 8 half, twice and four times as many. Bending
    /// modules are the rods that they are to the kinematics. `None` where Newton's method finds no shape near, or where it is no minimum.
    pub fn tubes_near(&self, rod: &Rod, q: &DVector<f64>, fine: usize) -> Option<Plates> {
        let mut plates = self.between(rod, q, fine)?;
        plates.settle(1.0)?;
        Some(plates)
    }

    /// The same without load; `None` where tubes of unequal length do not get along with one another.
    pub fn tubes_at_rest(&self, fine: usize) -> Option<Plates> {
        let mut plates = self.between(&self.rod, &DVector::zeros(self.rod.unknowns()), fine)?;
        plates.settle(0.0)?;
        Some(plates)
    }

    /// The same under pressures and loads that grow together from zero; `None` where the limb at rest does not lead there.
    pub fn tubes_grown(&self, fine: usize) -> Option<Plates> {
        let full = self.between(&self.rod, &DVector::zeros(self.rod.unknowns()), fine)?;
        let mut plates = full.at_rest();
        let (mut share, mut step) = (0.0, 0.25);
        while share < 1.0 {
            let mut next = plates.clone();
            let to = f64::min(share + step, 1.0);
            next.pressurize(&full, to);
            if next.settle(to).is_some() {
                (plates, share, step) = (next, to, 2.0 * step);
            } else if step <= LEAST_STEP {
                return None;
            } else {
                step *= 0.5;
            }
        }
        Some(plates)
    }

    /// Plates and tubes where the shape of a rod has them.
    fn between(&self, rod: &Rod, q: &DVector<f64>, fine: usize) -> Option<Plates> {
        let parts = (rod.pieces.len() / self.rod.pieces.len().max(1)).max(1);
        let mut bays = Vec::new();
        let mut before_m = 0.0;
        for (number, piece) in self.rod.pieces.iter().enumerate() {
            let bundle = &self.bundles[number];
            let bending = self.motions[number] == Motion::Bending;
            let count = if bending { 1 } else { bundle.bays(piece.length_m) };
            let pieces = (fine * (4_usize).div_ceil(count).max(2)).div_ceil(2);
            let mount = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), piece.mount_angle_rad);
            for bay in 0..count {
                let place = |end: usize| (bay * pieces + end) as f64 / (count * pieces) as f64;
                let strains: Vec<Strains> = (0..pieces)
                    .map(|index| {
                        Strains::of(rod, q, number * parts..(number + 1) * parts, [place(index), place(index + 1)])
                    })
                    .collect();
                let tube = |[x, y]: [f64; 2], like: Piece| {
                    let length_m = piece.length_m / (count * pieces) as f64;
                    let like = Piece { length_m, mount_angle_rad: 0.0, rigid_m: 0.0, masses: Vec::new(), ..like };
                    let q: Vec<f64> = strains.iter().flat_map(|strains| strains.unknowns([x, y], &like)).collect();
                    let rod = Rod { base: Isometry3::identity(), pieces: vec![like; pieces], ..self.rod.clone() };
                    let at = Isometry3::from_parts(Translation3::from(mount * Vector3::new(x, y, 0.0)), mount);
                    Held { at, rod, q: DVector::from_vec(q), forces_n: Vector6::zeros() }
                };
                let middle = tube(
                    [0.0; 2],
                    Piece { free: [1.0, 0.0, 0.0, 0.0], free_shear: [0.0; 2], sway: 0.0, ..piece.clone() },
                );
                let way = middle.rod.potential(&middle.q, 0.0).poses.last().copied()?;
                let tubes = if bending {
                    vec![tube([0.0; 2], piece.clone())]
                } else {
                    let kg_per_m = piece.kg_per_m / bundle.tubes.len() as f64;
                    let alone = |(place, tangent): &([f64; 2], Tangent)| {
                        tube(*place, alone(self.motions[number], tangent, kg_per_m))
                    };
                    bundle.tubes.iter().map(alone).collect()
                };
                bays.push(Bay {
                    bundle: number,
                    before_m: std::mem::take(&mut before_m),
                    tubes,
                    way: middle.at * way * middle.at.inverse(),
                    masses: if bay + 1 == count { piece.masses.clone() } else { Vec::new() },
                });
            }
            before_m = piece.rigid_m;
        }
        Some(Plates {
            base: self.rod.base,
            bays,
            tool_m: before_m,
            gravity_m_per_s2: self.rod.gravity_m_per_s2,
            tip_force_n: self.rod.tip_force_n,
            tangent: nalgebra::DMatrix::zeros(0, 0),
            fine,
        })
    }
}

impl Plates {
    /// The same tubes without pressure and load.
    fn at_rest(&self) -> Self {
        let mut plates = self.clone();
        for bay in &mut plates.bays {
            let of_tube = |tube: &Held| tube.rod.pieces.iter().map(|piece| piece.length_m).sum::<f64>();
            let length_m = bay.tubes.first().map_or(0.0, of_tube);
            bay.way = Isometry3::translation(0.0, 0.0, length_m);
            for tube in &mut bay.tubes {
                tube.q.fill(0.0);
                tube.forces_n.fill(0.0);
            }
        }
        plates.pressurize(self, 0.0);
        plates
    }

    /// Gives the tubes a share of the pressures of `full`.
    fn pressurize(&mut self, full: &Self, share: f64) {
        let tubes = self.bays.iter_mut().flat_map(|bay| &mut bay.tubes);
        for (tube, full) in tubes.zip(full.bays.iter().flat_map(|bay| &bay.tubes)) {
            tube.rod.pieces = full.rod.grown(share).pieces;
        }
    }
}

/// What a rod has along a part of a module: turn at both ends and shift in the middle, per length at rest.
struct Strains {
    turns: [Vector3<f64>; 2],
    shift: Vector3<f64>,
}

impl Strains {
    /// Between two places of a module, 0 to 1, which is some pieces of the rod.
    fn of(rod: &Rod, q: &DVector<f64>, pieces: Range<usize>, places: [f64; 2]) -> Self {
        let at = |place: f64, inwards: f64| {
            let place = place * pieces.len() as f64;
            let part = ((place + inwards) as usize).min(pieces.len() - 1);
            let index = pieces.start + part;
            let own = &q.as_slice()[index * UNKNOWNS..][..UNKNOWNS];
            rod.pieces[index].strain(own, 2.0 * (place - part as f64) - 1.0)
        };
        let [from, to] = places;
        Self { turns: [at(from, 1e-9)[0], at(to, -1e-9)[0]], shift: at(0.5 * (from + to), 0.0)[2] }
    }

    /// The unknowns of a tube at a place of the section, m, that moves with the sections of the rod.
    fn unknowns(&self, [x, y]: [f64; 2], tube: &Piece) -> [f64; UNKNOWNS] {
        let [from, to] = self.turns;
        let (turn, slope) = (0.5 * (from + to), 0.5 * (to - from));
        let shift = self.shift + turn.cross(&Vector3::new(x, y, 0.0));
        let ([stretch, bend_x, bend_y, twist], [shear_x, shear_y]) = (tube.free, tube.free_shear);
        [
            turn.x + bend_y,
            slope.x,
            turn.y - bend_x,
            slope.y,
            turn.z - twist,
            shift.x - shear_x,
            shift.y - shear_y,
            shift.z - stretch,
        ]
    }
}

/// One tube of a bundle as a separate rod, with sections parallel to the plates.
fn alone(motion: Motion, tangent: &Tangent, kg_per_m: f64) -> Piece {
    let (stiffness, rest) = energy(motion, [0.0; 2], tangent);
    Piece {
        free: [rest[0], 0.0, 0.0, rest[3]],
        free_shear: [0.0; 2],
        stiffness,
        coupled: Matrix4x2::zeros(),
        shear_n: tangent.shear_n,
        sway: 0.0,
        length_m: 0.0,
        mount_angle_rad: 0.0,
        kg_per_m,
        rigid_m: 0.0,
        masses: Vec::new(),
    }
}
