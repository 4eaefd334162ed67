//! What a rod leaves out of a bundle of tubes between plates, as a shift of the tip.
//!
//! A tube between two plates is a beam under an axial force (`P`, compression counted positive). Where plates turn against each other it is bent
//! to a bow, where they slide to an S, and its force makes it give way more, by its stability functions. For a bow of the rate `u` its energy
//! per length is `EI u^2/2 phi cot(phi)`, for a slide `g` it is `K g^2/2` with `1/K = 1/GA + (1 + P/GA) (tan(phi)/phi - 1)/P`, where
//! `phi^2 = P (1 + P/GA) a^2/(4 EI)`; `GA` is the shear of its wall, whose force is along its sections (Haringx). What is of the first power of `P`
//! in these the rod has, as far as it is the same for all tubes; forces of a moment on the bundle are of both signs and leave the square.
//!
//! With `D` the energy that the tubes have less than the rod at the same strains, the tip moves by `dx/dq K^-1 dD/dq` to first order in `D`.
//! `D` is that of the mean strains between two plates, which may lie in several pieces.

use fra_model::Motion;
use nalgebra::{DVector, SMatrix, SVector, Vector3};

use super::bundle::{Bundle, mean_nm2, shortening};
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

/// Mean strains between two plates: stretch, bends, twist, and slides of the rod.
type Strains = SVector<f64, 6>;

/// The stretch between two plates: the parts of pieces that it has.
struct Bay {
    bundle: usize,
    /// Index of a piece, share of the bay, and the middle of the part in the piece, -1 to 1.
    parts: Vec<(usize, f64, f64)>,
}

impl Bay {
    /// Mean strains.
    fn strains(&self, rod: &Rod, q: &DVector<f64>) -> Strains {
        let of_part = |(index, share, eta): &(usize, f64, f64)| {
            let own = &q.as_slice()[index * UNKNOWNS..][..UNKNOWNS];
            let [mean, linear] = rod.pieces[*index].differences(own);
            let at = mean + linear * *eta;
            Strains::new(at.x, at.y, at.z, at.w, own[5], own[6]) * *share
        };
        self.parts.iter().map(of_part).sum()
    }

    /// How each unknown of one of its parts moves them.
    fn by_unknowns(rod: &Rod, q: &DVector<f64>, (index, share, eta): &(usize, f64, f64)) -> SMatrix<f64, 6, UNKNOWNS> {
        let piece = &rod.pieces[*index];
        let sway = 2.0 * piece.sway / piece.free[0];
        let mut by = SMatrix::zeros();
        let slides = [5, 6].map(|a: usize| q[index * UNKNOWNS + a]);
        let [by_x, by_y] = [1, 2].map(|bend: usize| eta * piece.stiffness[(0, bend)] / piece.stiffness[(0, 0)]);
        let entries = [
            (0, 1, by_y),
            (0, 3, -by_x),
            (2, 0, -1.0),
            (2, 1, -eta),
            (1, 2, 1.0),
            (1, 3, *eta),
            (3, 4, 1.0),
            (0, 5, sway * slides[0]),
            (0, 6, sway * slides[1]),
            (4, 5, 1.0),
            (5, 6, 1.0),
            (0, 7, 1.0),
        ];
        entries.iter().for_each(|(row, column, value)| by[(*row, *column)] = value * share);
        by
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
        for bay in self.bays(rod) {
            let slope = self.less(bay.bundle, &bay.strains(rod, &shape.q));
            for part in &bay.parts {
                let own = Bay::by_unknowns(rod, &shape.q, part).tr_mul(&slope);
                (0..UNKNOWNS).for_each(|a| gradient[part.0 * UNKNOWNS + a] += own[a]);
            }
        }
        let response = shape.held_tangent(bends).cholesky()?.solve(&gradient);
        Some(Vector3::from(shape.levers(rod, bends).map(|lever| lever.dot(&response))))
    }

    /// The bays of all modules but bending ones in a rod, which may have each module in several pieces.
    fn bays(&self, rod: &Rod) -> Vec<Bay> {
        let parts = (rod.pieces.len() / self.bundles.len().max(1)).max(1);
        let straight = self.bundles.iter().enumerate().filter(|(index, _)| self.motions[*index] != Motion::Bending);
        let of_module = |(index, bundle): (usize, &Bundle)| {
            let length_m = rod.pieces[index * parts].length_m * parts as f64;
            let bays = bundle.bays(length_m);
            let of_bay = move |bay: usize| {
                // Places in pieces of the module.
                let [from, to] = [bay, bay + 1].map(|plate| (plate * parts) as f64 / bays as f64);
                let part = |part: usize| {
                    let [from, to] = [from.max(part as f64), to.min(part as f64 + 1.0)];
                    let share = (to - from) * bays as f64 / parts as f64;
                    (share > 1e-9).then_some((index * parts + part, share, from + to - 2.0 * part as f64 - 1.0))
                };
                Bay { bundle: index, parts: (0..parts).filter_map(part).collect() }
            };
            (0..bays).map(of_bay)
        };
        straight.flat_map(of_module).collect()
    }

    /// Slope by the strains of a bay of the energy that its tubes have less than the rod.
    fn less(&self, index: usize, strains: &Strains) -> Strains {
        let bundle = &self.bundles[index];
        let (stretch, bay_m) = (bundle.free.stretch, bundle.bay_m);
        let [_, x, y, twist, slide_x, slide_y] = <[f64; 6]>::from(*strains);
        let u = [bundle.free.bend_rad_per_m[0] + x, bundle.free.bend_rad_per_m[1] + y];
        // All slide per slide of the rod, and what the rod shortens by, over half the square of its slide.
        let own_slide = bundle.own_slide();
        // Springs about leaning tubes have the first power of their forces.
        let softer = bundle.softer(self.motions[index]);
        let first = if softer.is_some() { 0.0 } else { 1.0 };
        let all = bundle.slides.map(|slide| slide.tubes / own_slide);
        let rods = bundle.slides.map(|slide| {
            let bends = slide.bends / own_slide;
            first * ((1.2 * bends + 2.0) * bends + 2.0 * bundle.sway)
        });
        let own = rods[0] * slide_x * slide_x + rods[1] * slide_y * slide_y;
        let mut slope = Strains::zeros();
        for (tube, ([x, y], tangent)) in bundle.tubes.iter().enumerate() {
            let force_n = self.force_n(index, tube, &strains.fixed_rows::<4>(0).into_owned());
            let beam = Beam::new(tangent, stretch, bay_m);
            let g = [all[0] * slide_x - twist * y, all[1] * slide_y + twist * x];
            let (bent, slid) = (u[0] * u[0] + u[1] * u[1], g[0] * g[0] + g[1] * g[1]);
            let lean = first * shortening(beam.share());
            // The energy of a tube is bow bent/2 + (slide - N lean) slid/2 less, and that of the rod's own shortening more, all over the stretch.
            let ([bow, slide], [bow_by, slide_by]) = beam.lost_with_slope(-force_n);
            let by_strain = -0.5 * tangent.axial_n * (bow_by * bent + slide_by * slid + lean * slid - own);
            slope[0] += by_strain;
            slope[1] += bow * u[0] - by_strain * x;
            slope[2] += bow * u[1] - by_strain * y;
            let by_slide = slide - force_n * lean;
            slope[3] += by_slide * (g[1] * x - g[0] * y);
            slope[4] += by_slide * g[0] * all[0] + force_n * rods[0] * slide_x;
            slope[5] += by_slide * g[1] * all[1] + force_n * rods[1] * slide_y;
        }
        slope *= bay_m / stretch;
        // Leaning tubes bend more easily than their second order has it.
        let moments = bundle.stiffness * strains.fixed_rows::<4>(0) + bundle.coupled * strains.fixed_rows::<2>(4);
        let more = softer.unwrap_or(0.0) * bay_m;
        slope[1] += more * moments[1];
        slope[2] += more * moments[2];
        slope
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Matrix4, Matrix4x2};

    use super::super::rod::Piece;
    use super::super::tube::Tangent;
    use super::*;

    fn limb() -> LoadedLimb {
        let tube = |(at_m, stretch)| {
            let tangent = Tangent {
                stretch,
                bend_rad_per_m: 0.0,
                twist_rad_per_m: 0.0,
                axial_n: 240.0,
                bending_nm2: 0.018,
                across_nm2: 0.018,
                torsion_nm2: 0.0107,
                coupling_nm: 0.0,
                shear_n: 33.0,
                outer_radius_m: 0.014,
            };
            (at_m, tangent)
        };
        let tubes = [([0.03, 0.0], 1.1), ([-0.015, 0.026], 1.12), ([-0.015, -0.026], 1.09)].map(tube).to_vec();
        let bundle = Bundle::of_tubes(Motion::Extension, tubes, 0.08).expect("a bundle");
        let piece = Piece {
            free: [bundle.free.stretch, 0.0, 0.0, 0.0],
            free_shear: [0.0; 2],
            stiffness: Matrix4::identity(),
            coupled: Matrix4x2::zeros(),
            shear_n: bundle.shear_n,
            sway: bundle.sway,
            length_m: 0.24,
            mount_angle_rad: 0.0,
            kg_per_m: 0.0,
            rigid_m: 0.0,
            masses: Vec::new(),
        };
        let rod = Rod {
            base: Isometry3::identity(),
            pieces: vec![piece],
            gravity_m_per_s2: Vector3::zeros(),
            tip_force_n: Vector3::zeros(),
        };
        LoadedLimb::of_rod(rod, vec![(Motion::Extension, bundle)])
    }

    /// What is given as the slope of an energy is one: its own slopes are symmetric.
    #[test]
    fn slopes_are_those_of_an_energy() {
        let limb = limb();
        let strains = Strains::new(-0.02, 0.8, -0.5, 0.4, 0.03, -0.02);
        let mut second = SMatrix::<f64, 6, 6>::zeros();
        for axis in 0..6 {
            let at = |step: f64| {
                let mut moved = strains;
                moved[axis] += step;
                limb.less(0, &moved)
            };
            second.set_column(axis, &((at(1e-5) - at(-1e-5)) / 2e-5));
        }
        let odd = (0..6).flat_map(|a| (0..a).map(move |b| (a, b)));
        for (a, b) in odd {
            let scale = (second[(a, a)] * second[(b, b)]).abs().sqrt().max(second[(a, b)].abs());
            assert!((second[(a, b)] - second[(b, a)]).abs() < 1e-4 * scale, "{a} {b}: {second}");
        }
    }

    /// The parts of all bays make up the module, whatever its pieces.
    #[test]
    fn bays_share_pieces_without_rest() {
        let limb = limb();
        for parts in [1, 2, 4] {
            let bays = limb.bays(&limb.rod.split(parts));
            assert_eq!(bays.len(), 3);
            for bay in &bays {
                assert!((bay.parts.iter().map(|part| part.1).sum::<f64>() - 1.0).abs() < 1e-12);
                // A bend that is linear along the module has its mean in the middle of the bay.
                let of_part =
                    |(index, share, eta): &(usize, f64, f64)| share * (2.0 * *index as f64 + 1.0 + eta) / parts as f64;
                let mean = bay.parts.iter().map(of_part).sum::<f64>() / 2.0;
                let middles = [1.0 / 6.0, 0.5, 5.0 / 6.0];
                assert!(middles.iter().any(|middle| (middle - mean).abs() < 1e-12), "{mean}");
            }
        }
    }
}
