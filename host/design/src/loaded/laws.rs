//! Bending moments of a module by finite elements of its section, interpolated over its radii.
//!
//! A search judges thousands of limbs, and finite elements of one section take a tenth of a second. The laws of sections at Chebyshev nodes of inner radius and
//! wall are made once. Between them the numbers of a law are polynomials in the logarithms of both sizes, so derivatives by the sizes are smooth.

use std::f64::consts::PI;
use std::num::NonZero;
use std::sync::{Arc, OnceLock};

use softlimb_fea::cross_section::BendingLaw;
use softlimb_limb::bending_law;
use softlimb_numerics::lagrange_weights;

use super::local_solve::abreast;
use super::space::ModuleSpace;
use crate::actuators::Bounds;

/// Nodes in each size that has a range.
const NODES: usize = 5;

/// The laws of all sections within the bounds of a module, made when they are first asked for.
///
/// Two are equal where they are one shared table.
#[derive(Clone, Debug, Default)]
pub struct Laws(Arc<OnceLock<Result<Nodes, [f64; 2]>>>);

impl PartialEq for Laws {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

#[derive(Debug)]
struct Nodes {
    /// Logarithms of inner radii and walls, m.
    along: [Vec<f64>; 2],
    /// By the inner radius, then by the wall. Several are scaled to an outer radius of 1 m: they then vary less from node to node.
    laws: Vec<Arc<BendingLaw>>,
}

impl Laws {
    /// The law of a section of a module with inner and outer radius, m.
    ///
    /// # Errors
    /// Inner and outer radius, m, of a section within the bounds that has no law.
    pub(crate) fn at(&self, module: &ModuleSpace, [inner_m, outer_m]: [f64; 2]) -> Result<Arc<BendingLaw>, [f64; 2]> {
        let nodes = self.0.get_or_init(|| Nodes::new(module)).as_ref().map_err(|radii_m| *radii_m)?;
        if let [law] = &nodes.laws[..] {
            return Ok(law.clone());
        }
        let [by_inner, by_wall] =
            [(0, inner_m), (1, outer_m - inner_m)].map(|(size, at)| lagrange_weights(&nodes.along[size], f64::ln(at)));
        let weights = by_inner.iter().flat_map(|inner| by_wall.iter().map(move |wall| inner * wall));
        let law = BendingLaw::between(weights.zip(nodes.laws.iter().map(Arc::as_ref)));
        law.map(|law| Arc::new(law.enlarged(outer_m))).ok_or([inner_m, outer_m])
    }
}

impl Nodes {
    fn new(module: &ModuleSpace) -> Result<Self, [f64; 2]> {
        let [inner_radii_m, walls_m] = [module.inner_radius_m, module.wall_m].map(nodes);
        let radii: Vec<[f64; 2]> =
            inner_radii_m.iter().flat_map(|inner| walls_m.iter().map(move |wall| [*inner, inner + wall])).collect();
        let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
        let shares: Vec<&[[f64; 2]]> = radii.chunks(radii.len().div_ceil(threads)).collect();
        let law = |radii_m: &[f64; 2]| {
            let (actuator, second) = module.wound(*radii_m);
            bending_law(&actuator, second.as_ref(), module.pressure_max_pa).ok_or(*radii_m)
        };
        let found = abreast(&shares, |share| share.iter().map(law).collect::<Result<Vec<_>, _>>());
        let mut laws = found.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
        if laws.len() > 1 {
            laws.iter_mut().zip(&radii).for_each(|(law, [_, outer_m])| *law = Arc::new(law.enlarged(1.0 / outer_m)));
        }
        let along = [inner_radii_m, walls_m].map(|sizes_m| sizes_m.into_iter().map(f64::ln).collect());
        Ok(Self { along, laws })
    }
}

/// Chebyshev nodes of bounds, even in the logarithm; one where they have no width.
fn nodes([low, high]: Bounds) -> Vec<f64> {
    let count = if high > low { NODES } else { 1 };
    let at = |index: usize| 0.5 - 0.5 * (PI * (index as f64 + 0.5) / count as f64).cos();
    (0..count).map(|index| low * (high / low).powf(at(index))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::from_scene::loaded_design;
    use softlimb_numerics::Random;
    use softlimb_scene::parse;

    /// A module whose bender is wound 15 deg from the hoop, within wide bounds.
    fn module() -> ModuleSpace {
        let text = include_str!("../../../../scenes/open/loaded-group-a.toml");
        let winding = "[windings.steep]\nangle = \"15 deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\n[limb]";
        let text = text.replace("[limb]", winding).replacen("\nspacing =", "\nwinding = \"steep\"\nspacing =", 1);
        loaded_design(&parse(&text, "wound.toml").unwrap()).unwrap().space.modules[1].clone()
    }

    #[test]
    fn laws_between_nodes_are_those_of_the_section() {
        let module = module();
        let mut random = Random::new(5, 0);
        let mut most = [0.0_f64; 3];
        for _ in 0..12 {
            let [inner_m, wall_m] =
                [module.inner_radius_m, module.wall_m].map(|[low, high]| low + random.uniform() * (high - low));
            let radii_m = [inner_m, inner_m + wall_m];
            let found = module.law(radii_m).unwrap().unwrap();
            let (actuator, second) = module.wound(radii_m);
            let exact = bending_law(&actuator, second.as_ref(), module.pressure_max_pa).unwrap();
            for share in [0.1, 0.3, 0.6, 1.0] {
                let pressure_pa = share * module.pressure_max_pa;
                let bends = [&found, &exact].map(|law| law.bend_rad_per_m(pressure_pa).unwrap());
                // A moment holds a tenth of the bend back.
                let held = [&found, &exact].map(|law| law.moment(0.9 * bends[1], pressure_pa).unwrap());
                let beside = [&found, &exact].map(|law| law.beside_nm2(pressure_pa)[1]);
                let off =
                    [bends, held.map(|held| held.moment_nm), beside].map(|[found, exact]| (found / exact - 1.0).abs());
                (0..3).for_each(|n| most[n] = most[n].max(off[n]));
            }
        }
        println!("bend, moment, torsional stiffness off by {:.1e}, {:.1e}, {:.1e}", most[0], most[1], most[2]);
        assert!(most[0] < 3e-4 && most[1] < 2.5e-3 && most[2] < 1e-4, "{most:?}");
    }
}
