//! What the tubes of a loaded shape carry, and which of them is closest to buckling.
//!
//! Between two plates a tube's force is the same all along, but for its weight: it is that of the rod's strains in the middle between the plates.

use std::f64::consts::PI;

use fra_model::Motion;
use nalgebra::Vector4;

use super::load::LoadedLimb;
use super::rod::{Rod, UNKNOWNS};
use super::solve::Shape;
use super::tube::Tangent;

/// The tube that is closest to buckling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buckling {
    /// Index of its module.
    pub module: usize,
    /// Index in the module.
    pub tube: usize,
    /// Compressive force, N; negative where even this tube is pulled.
    pub compression_n: f64,
    /// Force that a tube between two plates buckles at, N: with `E = 4 pi^2 EI/a^2` of Euler and the shear stiffness `G` of its wall it is
    /// `G/2 (sqrt(1 + 4 E/G) - 1)` (Haringx). Plates close together leave a tube that shears rather than bends.
    pub critical_n: f64,
}

impl Buckling {
    /// Compression over the force of buckling; 0 where the tube is pulled.
    pub fn ratio(&self) -> f64 {
        (self.compression_n / self.critical_n).max(0.0)
    }
}

/// The middle between two plates in a shape.
struct Middle {
    /// Index of the bundle.
    index: usize,
    /// Strains in the terms of the stiffness, less those without load.
    strain: Vector4<f64>,
}

impl LoadedLimb {
    /// The middles between plates of all bundles in a shape of `rod`, which may have each in several pieces.
    fn middles<'a>(&'a self, rod: &'a Rod, shape: &'a Shape) -> impl Iterator<Item = Middle> {
        let parts = (rod.pieces.len() / self.bundles.len().max(1)).max(1);
        self.bundles.iter().enumerate().flat_map(move |(own, bundle)| {
            let length_m = rod.pieces[own * parts].length_m * parts as f64;
            let bays = bundle.bays(length_m);
            (0..bays).map(move |bay| {
                let place = (bay as f64 + 0.5) / bays as f64 * parts as f64;
                let part = (place as usize).min(parts - 1);
                let (index, eta) = (own * parts + part, 2.0 * (place - part as f64) - 1.0);
                let q = &shape.q.as_slice()[index * UNKNOWNS..][..UNKNOWNS];
                let [mean, linear] = rod.pieces[index].differences(q);
                Middle { index: own, strain: mean + linear * eta }
            })
        })
    }

    /// The tube that is closest to buckling in a shape of `rod`, which may have each module in several pieces.
    pub fn buckling(&self, rod: &Rod, shape: &Shape) -> Option<Buckling> {
        let of_middle = |middle: Middle| {
            let index = middle.index;
            (0..self.bundles[index].tubes.len()).map(move |tube| {
                let compression_n = -self.force_n(index, tube, &middle.strain);
                let bundle = &self.bundles[index];
                let stretch = bundle.free.stretch + middle.strain.x;
                let critical_n = critical_n(&bundle.tubes[tube].1, stretch, self.column_m(index, stretch));
                Buckling { module: self.modules[index], tube, compression_n, critical_n }
            })
        };
        let share = |tube: &Buckling| tube.compression_n / tube.critical_n;
        self.middles(rod, shape).flat_map(of_middle).max_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// The first bending module that is bent backwards anywhere, by more than `by_rad_per_m`: its lines do not shorten, so that this is
    /// beyond the model.
    pub fn bent_back(&self, rod: &Rod, shape: &Shape, by_rad_per_m: f64) -> Option<usize> {
        let parts = rod.pieces.len() / self.bundles.len().max(1);
        let back = |index: usize| {
            let piece = &rod.pieces[index];
            let [mean, linear] = piece.differences(&shape.q.as_slice()[index * UNKNOWNS..][..UNKNOWNS]);
            self.motions[index / parts.max(1)] == Motion::Bending
                && piece.free[1] + mean.y - linear.y.abs() < -by_rad_per_m
        };
        (0..rod.pieces.len()).find(|index| back(*index)).map(|index| self.modules[index / parts.max(1)])
    }

    /// Axial force of a tube where its bundle is strained, N; positive where it is pulled.
    pub(super) fn force_n(&self, index: usize, tube: usize, strain: &Vector4<f64>) -> f64 {
        let bundle = &self.bundles[index];
        let ([x, y], tangent) = &bundle.tubes[tube];
        if self.motions[index] == Motion::Bending {
            let line = |stretch: f64, bend: f64| stretch - (x + tangent.outer_radius_m) * bend;
            let all = line(bundle.free.stretch + strain.x, bundle.free.bend_rad_per_m[0] + strain.y);
            return tangent.axial_n * (all - tangent.line_stretch());
        }
        let [free_x, free_y] = bundle.free.bend_rad_per_m;
        let stretch = bundle.free.stretch + strain.x - (free_x + strain.y) * x - (free_y + strain.z) * y;
        let own = if self.motions[index] == Motion::Twisting { bundle.free.stretch } else { tangent.stretch };
        tangent.axial_n * (stretch - own)
    }
}

/// Force at which a tube buckles where its bundle has a stretch, as a column of this length, m.
pub(super) fn critical_n(tube: &Tangent, stretch: f64, column_m: f64) -> f64 {
    // Stiffness is per length at rest: that of the stretched tube is greater by the stretch.
    column_n(tube.bending_nm2.min(tube.across_nm2) * stretch, tube.shear_n * stretch, column_m)
}

/// Force at which a column that shears buckles between clamped ends, N (Haringx); of its bending and shear stiffness, N m2 and N, and its length.
pub(crate) fn column_n(bending_nm2: f64, shear_n: f64, length_m: f64) -> f64 {
    let euler_n = 4.0 * PI * PI * bending_nm2 / (length_m * length_m);
    0.5 * shear_n * ((1.0 + 4.0 * euler_n / shear_n).sqrt() - 1.0)
}
