//! Equilibrium of rods whose tubes are springs by their models: springs about the strains of the shape, and the shape of these springs, by turns.

use nalgebra::{DVector, Matrix4x2, Vector4};

use super::fidelity::{Fidelity, by_fidelity};
use super::load::LoadedLimb;
use super::rod::{Piece, Rod, UNKNOWNS};
use super::solve::{EquilibriumError, Shape};

/// Most turns, and the change of a strain, times the length of its module where it is a rate, up to which springs are right: what they are off by
/// goes with its square.
const TURNS: usize = 12;
const CONVERGED: f64 = 1e-5;
/// The same of leaning tubes, whose slides go with no strain: their turns converge linearly, to where rounding ends them.
const LEANING: f64 = 1e-9;
const ROUNDING: f64 = 1e-7;

/// A limb in equilibrium, with springs about the strains of its shape.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The limb; its springs have the model's forces and slopes at the mean strains of each module.
    pub limb: LoadedLimb,
    /// The chain that was solved.
    pub rod: Rod,
    /// Its shape.
    pub shape: Shape,
}

impl LoadedLimb {
    /// The equilibrium by one tier of rods; `start` are the unknowns of an earlier shape of it with nearly the same springs.
    ///
    /// A limb of linear springs ([`LoadedLimb::of_rod`]) keeps them.
    ///
    /// # Errors
    /// [`EquilibriumError`] where the limb does not carry the load, or a tube has no stable equilibrium at its strain.
    pub fn settle(&self, tier: Fidelity, start: Option<&DVector<f64>>) -> Result<Settled, EquilibriumError> {
        let (rod, shape) = by_fidelity(&self.rod, tier, start)?;
        let mut settled = Settled { limb: self.clone(), rod, shape };
        if tier == Fidelity::Kinematic || !self.bundles.iter().any(super::Bundle::has_springs) {
            return Ok(settled);
        }
        let leans = self.bundles.iter().any(|bundle| bundle.coupled != Matrix4x2::zeros());
        let (converged, rounding) = if leans { (LEANING, ROUNDING) } else { (CONVERGED, 0.0) };
        let mut last = f64::INFINITY;
        for _ in 0..TURNS {
            let strains = settled.limb.strains(&settled.rod, &settled.shape.q);
            let change = settled.limb.change(&strains);
            if change <= converged || (change <= rounding && change > 0.5 * last) {
                return Ok(settled);
            }
            last = change;
            let limb = settled.limb.at_strains(&strains)?;
            let q = rebased(&settled, &limb);
            let (rod, shape) = by_fidelity(&limb.rod, tier, Some(&q))?;
            settled = Settled { limb, rod, shape };
        }
        Err(EquilibriumError::Unsettled)
    }

    /// Mean strains of each bundle at unknowns `q` of `rod`, which may have each in several pieces: stretch, bends and twist.
    pub fn strains(&self, rod: &Rod, q: &DVector<f64>) -> Vec<Vector4<f64>> {
        let parts = (rod.pieces.len() / self.rod.pieces.len().max(1)).max(1);
        let of_module = |(pieces, q): (&[Piece], &[f64])| {
            let of_piece = |(piece, q): (&Piece, &[f64])| Vector4::from(piece.free) + piece.differences(q)[0];
            pieces.iter().zip(q.chunks(UNKNOWNS)).map(of_piece).sum::<Vector4<f64>>() / pieces.len() as f64
        };
        rod.pieces.chunks(parts).zip(q.as_slice().chunks(parts * UNKNOWNS)).map(of_module).collect()
    }

    /// The limb with its tubes' springs about strains of its bundles.
    ///
    /// # Errors
    /// [`EquilibriumError::Overstrained`] where a tube has no stable equilibrium there.
    pub fn at_strains(&self, strains: &[Vector4<f64>]) -> Result<Self, EquilibriumError> {
        let mut limb = self.clone();
        for (index, strain) in strains.iter().enumerate() {
            if !self.bundles[index].has_springs() {
                continue;
            }
            let bundle = self.bundles[index]
                .strained(self.motions[index], strain)
                .ok_or(EquilibriumError::Overstrained { module: self.modules[index] })?;
            limb.set_bundle(index, bundle);
        }
        limb.strains = strains.to_vec();
        Ok(limb)
    }

    /// Largest change of strains from those that the springs are about.
    fn change(&self, strains: &[Vector4<f64>]) -> f64 {
        let of_module = |((piece, a), b): ((&Piece, &Vector4<f64>), &Vector4<f64>)| {
            let change = a - b;
            change.x.abs().max(piece.length_m * change.fixed_rows::<3>(1).amax())
        };
        self.rod.pieces.iter().zip(strains).zip(&self.strains).map(of_module).fold(0.0, f64::max)
    }
}

impl Settled {
    /// One turn more: springs about the strains of the shape, and the shape of these springs.
    ///
    /// # Errors
    /// As [`LoadedLimb::settle`].
    pub fn turned(&self, tier: Fidelity) -> Result<Self, EquilibriumError> {
        let limb = self.limb.at_strains(&self.limb.strains(&self.rod, &self.shape.q))?;
        let q = rebased(self, &limb);
        let (rod, shape) = by_fidelity(&limb.rod, tier, Some(&q))?;
        Ok(Self { limb, rod, shape })
    }

    /// Largest change of the strains of the shape from those that its springs are about, times the length of a module where they are rates.
    pub fn unsettled(&self) -> f64 {
        self.limb.change(&self.limb.strains(&self.rod, &self.shape.q))
    }
}

/// Unknowns of the same strains with the springs of `limb`.
fn rebased(settled: &Settled, limb: &LoadedLimb) -> DVector<f64> {
    let parts = settled.rod.pieces.len() / limb.rod.pieces.len().max(1);
    let mut q = settled.shape.q.clone();
    for (index, (old, q)) in settled.rod.pieces.iter().zip(q.as_mut_slice().chunks_mut(UNKNOWNS)).enumerate() {
        let new = &limb.rod.pieces[index / parts];
        let [stretch, x, y, twist] = [0, 1, 2, 3].map(|a: usize| old.free[a] - new.free[a]);
        q[7] += stretch;
        q[2] += x;
        q[0] -= y;
        q[4] += twist;
    }
    q
}
