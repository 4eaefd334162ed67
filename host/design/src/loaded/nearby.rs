//! Equilibria beside another one: sizes and pressures that differ a little.
//!
//! The springs of a limb in equilibrium are about its own strains. A change of a size or a pressure changes springs, then shape and strains, and so the springs
//! once more. With `s` the strains and `B` their response to springs about other strains, what a change moves is
//!
//! ```text
//! ds = ds_0 + B ds,  so  ds = (1 - B)^-1 ds_0
//! ```
//!
//! where `ds_0` is the response with the springs about the same strains as before. `B` and the slopes of the springs are made once for an equilibrium; a limb
//! beside it then costs the model of the modules that differ, and one step of Newton's method. It is right to first order.

use fra_model::Motion;
use nalgebra::{DMatrix, DVector, Dyn, LU, Vector4};

use super::built::Built;
use softlimb_limb::statics::{Bundle, Fidelity, LoadedLimb, Neighbours, Rod, Settled, Tangent};

/// Strains of a module: stretch, bends and twist.
const STRAINS: usize = 4;
/// Most turns until springs are about the strains of the shape, and the change up to which they are.
const TURNS: usize = 6;
const SETTLED: f64 = 1e-9;
/// Step of a strain for the slopes of springs, a rate times the radius of a tube.
const STEP: f64 = 1e-5;
/// Step of a strain for its response, which is linear.
const RESPONSE: f64 = 1e-6;

/// An equilibrium with what its neighbours need.
#[derive(Debug)]
pub(super) struct Nearby {
    /// The limb at rest, its shares, and its payload.
    built: Built,
    shares: Vec<f64>,
    settled: Settled,
    neighbours: Neighbours,
    /// By module and tube, the slope of its springs by its own strain.
    slopes: Vec<Slopes>,
    /// By strain, the change of the unknowns with springs about it.
    by_strain: DMatrix<f64>,
    /// `1 - B`.
    left: LU<f64, Dyn, Dyn>,
}

/// How the springs of a module follow its strains.
#[derive(Debug)]
enum Slopes {
    /// Not at all.
    Fixed,
    /// Each tube by its own strain.
    Tubes(Vec<Tangent>),
    /// As the model has it: tubes that plates hold back.
    Held,
}

impl Nearby {
    /// An equilibrium at shares of the pressures with a payload, kg, settled to the last digits; `None` where it has no stable one.
    pub(super) fn of(built: &Built, shares: &[f64], kg: f64, mut settled: Settled) -> Option<Self> {
        for _ in 0..TURNS {
            if settled.unsettled() <= SETTLED {
                break;
            }
            settled = settled.turned(Fidelity::Linear).ok()?;
        }
        let neighbours = settled.shape.neighbours()?;
        let slopes =
            (0..built.modules.len()).map(|module| slopes(built, module, &settled.limb)).collect::<Option<_>>()?;
        let count = STRAINS * built.modules.len();
        let (by_strain, left) = (DMatrix::zeros(neighbours.q().len(), count), DMatrix::identity(count, count));
        let mut own = Self {
            built: built.clone(),
            shares: shares.to_vec(),
            settled,
            neighbours,
            slopes,
            by_strain,
            left: left.clone().lu(),
        };
        own.left = own.response(left, kg)?.lu();
        Some(own)
    }

    /// `1 - B` from 1, with the changes of the unknowns by strain.
    fn response(&mut self, mut left: DMatrix<f64>, kg: f64) -> Option<DMatrix<f64>> {
        let limb = &self.settled.limb;
        let rest = self.change(&limb.rod);
        let mut by_strain = self.by_strain.clone();
        for (module, slopes) in self.slopes.iter().enumerate() {
            // Stretch and bends; of a bender the bend in its plane.
            let axes = match slopes {
                Slopes::Fixed => 0..0,
                Slopes::Tubes(_) if self.built.is_bending(module) => 1..2,
                Slopes::Tubes(_) => 0..3,
                Slopes::Held => 0..STRAINS,
            };
            for axis in axes {
                let mut by = Vector4::zeros();
                by[axis] = RESPONSE;
                let bundle = self.bundle(module, &limb.bundles()[module], &by)?;
                let mut there = limb.rod.clone();
                there.pieces[module] = self.built.piece(module, &bundle, kg);
                let (q, strains) = self.change(&there);
                let column = STRAINS * module + axis;
                by_strain.column_mut(column).copy_from(&((q - &rest.0) / RESPONSE));
                left.column_mut(column).axpy(-1.0 / RESPONSE, &(strains - &rest.1), 1.0);
            }
        }
        self.by_strain = by_strain;
        Some(left)
    }

    /// That of another limb at shares of its pressures, beside this one; `None` where an actuator has no equilibrium.
    pub(super) fn beside(&self, built: &Built, shares: &[f64], kg: f64) -> Option<Settled> {
        let base = &self.settled.limb;
        let free = built.loaded(shares, kg)?;
        let strains = base.spring_strains();
        let bundle = |module: usize| {
            let drives = built.drives_of(module);
            if built.modules[module].is(&self.built.modules[module]) && shares[drives.clone()] == self.shares[drives] {
                return Some(base.bundles()[module].clone());
            }
            free.bundles()[module].strained(built.motion(module), &strains[module])
        };
        let bundles = (0..strains.len()).map(bundle).collect::<Option<Vec<_>>>()?;
        let limb = free.with_bundles(bundles, strains.to_vec());
        let (q, strain_change) = self.change(&limb.rod);
        let change = self.left.solve(&strain_change)?;
        let changes: Vec<Vector4<f64>> = change.as_slice().chunks(STRAINS).map(Vector4::from_column_slice).collect();
        let bundle = |(module, bundle)| self.bundle(module, bundle, &changes[module]);
        let bundles = limb.bundles().iter().enumerate().map(bundle).collect::<Option<Vec<_>>>()?;
        let strains = strains.iter().zip(&changes).map(|(strain, by)| strain + by).collect();
        let limb = limb.with_bundles(bundles, strains);
        let shape = self.neighbours.shape(&limb.rod, &(q + &self.by_strain * change));
        Some(Settled { rod: limb.rod.clone(), limb, shape })
    }

    /// Change of the unknowns where the rod becomes another, with springs about the same strains, and of the strains from these.
    fn change(&self, rod: &Rod) -> (DVector<f64>, DVector<f64>) {
        let change = self.neighbours.change(rod);
        let strains = self.settled.limb.strains(rod, &(self.neighbours.q() + &change));
        let changes = strains.iter().zip(self.settled.limb.spring_strains()).map(|(there, here)| there - here);
        (change, DVector::from_iterator(STRAINS * strains.len(), changes.flat_map(<[f64; STRAINS]>::from)))
    }

    /// A bundle of a module with springs about strains that differ by so much; `None` where a tube has no equilibrium there.
    fn bundle(&self, module: usize, bundle: &Bundle, by: &Vector4<f64>) -> Option<Bundle> {
        let motion = self.built.motion(module);
        match &self.slopes[module] {
            Slopes::Fixed => Some(bundle.clone()),
            Slopes::Held => bundle.strained(motion, &(self.settled.limb.spring_strains()[module] + by)),
            Slopes::Tubes(slopes) => {
                let tubes = bundle.tubes.iter().zip(slopes);
                let tubes = tubes.map(|((place, tube), slope)| (*place, moved(tube, slope, own(motion, *place, by))));
                Bundle::of_tubes(motion, tubes.collect(), bundle.bay_m)
            }
        }
    }
}

/// Change of the strain that the springs of a tube follow, where the strains of its bundle change.
fn own(motion: Motion, [x, y]: [f64; 2], by: &Vector4<f64>) -> f64 {
    if motion == Motion::Bending { by.y } else { by.x - by.y * x - by.z * y }
}

/// Slopes of the springs of a module of a settled limb; `None` where a tube has no equilibrium beside its own.
fn slopes(built: &Built, module: usize, limb: &LoadedLimb) -> Option<Slopes> {
    let (motion, bundle) = (built.motion(module), &limb.bundles()[module]);
    if motion == Motion::Twisting {
        let held = bundle.tubes.iter().any(|([x, y], _)| *x != 0.0 || *y != 0.0);
        return Some(if held { Slopes::Held } else { Slopes::Fixed });
    }
    // Of a bender the bend counts, of other tubes the stretch, which is the same all over the section.
    let outer_m = bundle.tubes.first()?.1.outer_radius_m;
    let (axis, step) = if motion == Motion::Bending { (1, STEP / outer_m) } else { (0, STEP) };
    let side = |by: f64| {
        let mut strain = limb.spring_strains()[module];
        strain[axis] += by;
        bundle.strained(motion, &strain)
    };
    let (high, low) = (side(step)?, side(-step)?);
    let tubes = high.tubes.iter().zip(&low.tubes);
    Some(Slopes::Tubes(tubes.map(|((_, high), (_, low))| slope(high, low, 2.0 * step)).collect()))
}

/// All numbers of springs, by those of others.
fn each(a: &Tangent, b: &Tangent, of: impl Fn(f64, f64) -> f64) -> Tangent {
    Tangent {
        stretch: of(a.stretch, b.stretch),
        bend_rad_per_m: of(a.bend_rad_per_m, b.bend_rad_per_m),
        twist_rad_per_m: of(a.twist_rad_per_m, b.twist_rad_per_m),
        axial_n: of(a.axial_n, b.axial_n),
        bending_nm2: of(a.bending_nm2, b.bending_nm2),
        across_nm2: of(a.across_nm2, b.across_nm2),
        torsion_nm2: of(a.torsion_nm2, b.torsion_nm2),
        coupling_nm: of(a.coupling_nm, b.coupling_nm),
        shear_n: of(a.shear_n, b.shear_n),
        outer_radius_m: of(a.outer_radius_m, b.outer_radius_m),
    }
}

fn slope(high: &Tangent, low: &Tangent, width: f64) -> Tangent {
    each(high, low, |high, low| (high - low) / width)
}

fn moved(tube: &Tangent, slope: &Tangent, by: f64) -> Tangent {
    each(tube, slope, |value, slope| value + slope * by)
}
