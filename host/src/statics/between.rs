//! What a rod leaves out of a bundle of tubes between plates, as a shift of the tip.
//!
//! A tube between two plates is a beam under an axial force (`P`, compression counted positive). Where plates turn against each other it is bent
//! to a bow, where they slide to an S, and its force makes it give way more, by its stability functions. For a bow of the rate `u` its energy
//! per length is `EI u^2/2 phi cot(phi)`, for a slide `g` it is `K g^2/2` with `1/K = 1/GA + (1 + P/GA) (tan(phi)/phi - 1)/P`, where
//! `phi^2 = P (1 + P/GA) a^2/(4 EI)`; `GA` is the shear of its wall, whose force is along its sections (Haringx). What is of the first power of `P`
//! in these the rod has, as far as it is the same for all tubes; forces of a moment on the bundle are of both signs and leave the square.
//!
//! With `D` the energy that the tubes have less than the rod at the same strains, the tip moves by `dx/dq K^-1 dD/dq` to first order in `D`.

use fra_model::Motion;
use nalgebra::{DVector, Vector3};

use super::buckling::Middle;
use super::bundle::{mean_nm2, shortening};
use super::load::LoadedLimb;
use super::rod::{Rod, UNKNOWNS};
use super::solve::{Bends, Shape};
use super::tube::Tangent;

/// Step of a difference of the stability functions by the force, of the least of shear and bending stiffness.
const STEP: f64 = 1e-4;

/// A beam per length as it is stretched: bending stiffness, shear stiffness and its length.
#[derive(Clone, Copy)]
struct Beam {
    bending_nm2: f64,
    shear_n: f64,
    long_m: f64,
}

impl Beam {
    fn new(tube: &Tangent, stretch: f64, bay_m: f64) -> Self {
        Self { bending_nm2: mean_nm2(tube) * stretch, shear_n: tube.shear_n * stretch, long_m: stretch * bay_m }
    }

    /// Share of a slide that is an S; the rest is shear of the wall.
    fn share(&self) -> f64 {
        let bent = self.long_m * self.long_m / (12.0 * self.bending_nm2);
        bent / (bent + 1.0 / self.shear_n)
    }

    /// Stiffness against a bow and against a slide that a compression takes beyond its first power: N m2 and N.
    fn lost(&self, compression_n: f64) -> [f64; 2] {
        let square = self.long_m * self.long_m / self.bending_nm2;
        let lean = 1.0 + compression_n / self.shear_n;
        let phi_2 = 0.25 * compression_n * lean * square;
        let phi = phi_2.abs().sqrt();
        // phi cot(phi), and (tan(phi)/phi - 1)/phi^2.
        let (bow, bent) = if phi_2.abs() < 1e-3 {
            (1.0 - phi_2 / 3.0 - phi_2 * phi_2 / 45.0, 1.0 / 3.0 + phi_2 * (2.0 / 15.0 + phi_2 * 17.0 / 315.0))
        } else if phi_2 > 0.0 {
            (phi / phi.tan(), (phi.tan() / phi - 1.0) / phi_2)
        } else {
            (phi / phi.tanh(), (phi.tanh() / phi - 1.0) / phi_2)
        };
        let slide = 1.0 / (1.0 / self.shear_n + 0.25 * lean * lean * square * bent);
        let rest = 1.0 / (1.0 / self.shear_n + square / 12.0);
        [
            self.bending_nm2 * (1.0 - 0.25 * compression_n * square / 3.0 - bow),
            rest - compression_n * shortening(self.share()) - slide,
        ]
    }

    /// The same and its slope by the compression.
    fn lost_with_slope(&self, compression_n: f64) -> ([f64; 2], [f64; 2]) {
        let step = STEP * self.shear_n.min(self.bending_nm2 / (self.long_m * self.long_m));
        let (more, less) = (self.lost(compression_n + step), self.lost(compression_n - step));
        (self.lost(compression_n), [0, 1].map(|a: usize| (more[a] - less[a]) / (2.0 * step)))
    }
}

impl LoadedLimb {
    /// By how much tubes between plates would have the tip elsewhere, m, where `shape` is one of `rod`, which may have each module in several
    /// pieces; to first order. Bending modules count as the rods that they are to the kinematics.
    ///
    /// `None` where the tangent is not positive definite, or where a tube carries all that it can before it buckles.
    pub fn tubes_shift_m(&self, rod: &Rod, shape: &Shape, bends: Bends) -> Option<Vector3<f64>> {
        if self.buckling(rod, shape).is_some_and(|tube| tube.ratio() >= 1.0) {
            return None;
        }
        let mut gradient = DVector::zeros(rod.unknowns());
        for middle in self.middles(rod, shape).filter(|middle| self.motions[middle.module] != Motion::Bending) {
            self.add_slope(&middle, &mut gradient);
        }
        let response = shape.held_tangent(bends).cholesky()?.solve(&gradient);
        Some(Vector3::from(shape.levers(rod, bends).map(|lever| lever.dot(&response))))
    }

    /// Adds the slope of the energy that the tubes about one middle have less than the rod.
    fn add_slope(&self, middle: &Middle, gradient: &mut DVector<f64>) {
        let bundle = &self.bundles[middle.module];
        let (q, stretch, bay_m) = (middle.q, bundle.free.stretch, bundle.bay_m);
        let u = [bundle.free.bend_rad_per_m[0] + middle.strain.y, bundle.free.bend_rad_per_m[1] + middle.strain.z];
        // All slide per slide of the rod, and what the rod shortens by, over half the square of its slide.
        let all = bundle.slides.map(|slide| slide.tubes * middle.piece.shear_n);
        let rods = bundle.slides.map(|slide| {
            let bends = slide.bends * middle.piece.shear_n;
            (1.2 * bends + 2.0) * bends + 2.0 * middle.piece.sway
        });
        let twist = middle.strain.w;
        // Slopes by stretch, both bends, both slides and the twist.
        let mut slope = [0.0; 6];
        for (tube, ([x, y], tangent)) in bundle.tubes.iter().enumerate() {
            let force_n = self.force_n(middle.module, tube, &middle.strain);
            let beam = Beam::new(tangent, stretch, bay_m);
            let ([bow, slide], [bow_slope, slide_slope]) = beam.lost_with_slope(-force_n);
            let g = [all[0] * q[5] - twist * y, all[1] * q[6] + twist * x];
            let (bent, slid) = (u[0] * u[0] + u[1] * u[1], g[0] * g[0] + g[1] * g[1]);
            let lean = shortening(beam.share());
            // The energy of a tube is bow bent/2 + (slide - N lean) slid/2 less, and that of the rod's own shortening more, all over the stretch.
            let own = rods[0] * q[5] * q[5] + rods[1] * q[6] * q[6];
            let by_force = -0.5 * (bow_slope * bent + slide_slope * slid) - 0.5 * (lean * slid - own);
            let by_strain = tangent.axial_n * by_force;
            slope[0] += by_strain;
            slope[1] += bow * u[0] - by_strain * x;
            slope[2] += bow * u[1] - by_strain * y;
            let by_slide = slide - force_n * lean;
            slope[3] += by_slide * g[0] * all[0] + force_n * rods[0] * q[5];
            slope[4] += by_slide * g[1] * all[1] + force_n * rods[1] * q[6];
            slope[5] += by_slide * (g[1] * x - g[0] * y);
        }
        let at = middle.index * UNKNOWNS;
        let by_slide = 2.0 * middle.piece.sway / stretch;
        let by = [
            -slope[2],
            -slope[2] * middle.eta,
            slope[1],
            slope[1] * middle.eta,
            slope[5],
            slope[3] + slope[0] * by_slide * q[5],
            slope[4] + slope[0] * by_slide * q[6],
            slope[0],
        ];
        (0..UNKNOWNS).for_each(|a| gradient[at + a] += by[a] * bay_m / stretch);
    }
}
