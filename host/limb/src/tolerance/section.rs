//! Specimens of benders by finite elements of their section.
//!
//! A solution at four pressures takes some 40 ms, and a study has tens of thousands of specimens. A polynomial in wall, angle and modulus goes through the
//! solutions on a grid of the tolerances.

use fra_model::Actuator;
use softlimb_fea::cross_section::{EndLoad, Mesh, Options, Section, Symmetry};
use softlimb_numerics::lagrange_weights;

use super::input::{Kind, Place};
use super::made::made;
use super::parallel::parallel;
use super::shape::Tube;
use crate::LimbModule;
use crate::fabricate::Tolerances;
use crate::statics::Tangent;

/// Elements through the wall and around half of it, as laws of benders have them.
const MESH: Mesh = Mesh { radial: 4, around: 8 };
/// Nodes of the grid within the tolerances of wall, angle and modulus, with the middle and both ends. With the default tolerances displacements are
/// then within 6e-4 of their RMS, four times wider ones within 1 %.
const NODES: [usize; 3] = [3, 3, 5];

/// Tubes without load of a module's actuator at a place within tolerances, at gauge pressures, Pa; `None` where it has no stable equilibrium.
pub(super) fn tangents(
    module: &LimbModule,
    tolerances: &Tolerances,
    place: &Place,
    pressures_pa: &[f64],
) -> Vec<Option<Tangent>> {
    solved(module, tolerances, place, pressures_pa).unwrap_or_else(|| vec![None; pressures_pa.len()])
}

/// `None` for an actuator that the section refuses.
fn solved(
    module: &LimbModule,
    tolerances: &Tolerances,
    place: &Place,
    pressures_pa: &[f64],
) -> Option<Vec<Option<Tangent>>> {
    let (one, second) = made(module.actuator.parameters(), module.second_fiber(), tolerances, place);
    let actuator = Actuator::new(&one).ok()?;
    // The whole section has the stiffness.
    let options = Options { mesh: MESH, symmetry: Symmetry::Ignore, ..Options::default() };
    let section = match &second {
        None => Section::new(&one, &options),
        Some(second) => Section::with_two_windings(&one, second, &options),
    };
    let curve = section.and_then(|section| section.curve(pressures_pa, &EndLoad::default())).ok()?;
    Some(curve.answers.iter().map(|answer| Tangent::of_section(&actuator, answer.equilibrium()?)).collect())
}

/// Specimens of a module's actuator at gauge pressures.
pub(super) struct Specimens<'a> {
    module: &'a LimbModule,
    tolerances: &'a Tolerances,
    pressures_pa: &'a [f64],
    /// By pressure: the tube of the limb's curve, less that of the mesh here.
    offsets: Vec<Values>,
    /// `None` where some node has no equilibrium: then each specimen is solved.
    grid: Option<Grid>,
}

impl<'a> Specimens<'a> {
    /// The specimens, with the nominal tube at each pressure.
    pub(super) fn new(
        module: &'a LimbModule,
        tolerances: &'a Tolerances,
        pressures_pa: &'a [f64],
        nominal: &[Tangent],
        threads: usize,
    ) -> Self {
        let middle = tangents(module, tolerances, &[0.0; 3], pressures_pa);
        let offset = |(nominal, middle): (&Tangent, &Option<Tangent>)| {
            let (nominal, middle) = (values(nominal), values(&middle.unwrap_or(*nominal)));
            std::array::from_fn(|k| nominal[k] - middle[k])
        };
        let offsets = nominal.iter().zip(&middle).map(offset).collect();
        Self { module, tolerances, pressures_pa, offsets, grid: Grid::new(module, tolerances, pressures_pa, threads) }
    }

    /// The tubes of one at a place within the tolerances, by pressure.
    pub(super) fn tubes(&self, place: &Place) -> Vec<Option<Tube>> {
        let solved = || {
            let found = tangents(self.module, self.tolerances, place, self.pressures_pa);
            found.into_iter().map(|tangent| Some(values(&tangent?))).collect()
        };
        let found: Vec<Option<Values>> = self.grid.as_ref().map_or_else(solved, |grid| grid.at(place));
        let about = |(found, offset): (&Option<Values>, &Values)| {
            let found = (*found)?;
            Some(Tube::Section(tangent(std::array::from_fn(|k| found[k] + offset[k]))))
        };
        found.iter().zip(&self.offsets).map(about).collect()
    }
}

/// A tube as numbers.
type Values = [f64; 10];

fn values(tube: &Tangent) -> Values {
    let Tangent { stretch, bend_rad_per_m, twist_rad_per_m, axial_n, bending_nm2, .. } = *tube;
    let Tangent { across_nm2, torsion_nm2, coupling_nm, shear_n, outer_radius_m, .. } = *tube;
    [
        stretch,
        bend_rad_per_m,
        twist_rad_per_m,
        axial_n,
        bending_nm2,
        across_nm2,
        torsion_nm2,
        coupling_nm,
        shear_n,
        outer_radius_m,
    ]
}

fn tangent(values: Values) -> Tangent {
    let [stretch, bend_rad_per_m, twist_rad_per_m, axial_n, bending_nm2, ..] = values;
    let [.., across_nm2, torsion_nm2, coupling_nm, shear_n, outer_radius_m] = values;
    Tangent {
        stretch,
        bend_rad_per_m,
        twist_rad_per_m,
        axial_n,
        bending_nm2,
        across_nm2,
        torsion_nm2,
        coupling_nm,
        shear_n,
        outer_radius_m,
    }
}

/// Solutions on a grid of the tolerances.
struct Grid {
    /// By kind: places of its nodes; the middle alone where there is no tolerance.
    nodes: [Vec<f64>; 3],
    /// By pressure and node, the last kind first.
    values: Vec<Vec<Values>>,
}

impl Grid {
    fn new(module: &LimbModule, tolerances: &Tolerances, pressures_pa: &[f64], threads: usize) -> Option<Self> {
        let nodes = Kind::ALL.map(|kind| {
            let count = NODES[kind.index()];
            let node = |k: usize| -(std::f64::consts::PI * k as f64 / (count - 1) as f64).cos();
            if kind.of(tolerances) > 0.0 { (0..count).map(node).collect() } else { vec![0.0] }
        });
        let places = combinations(&nodes);
        let solve = |place: &Place| -> Option<Vec<Values>> {
            let found = tangents(module, tolerances, place, pressures_pa);
            found.iter().map(|tangent| tangent.as_ref().map(values)).collect()
        };
        let solutions = parallel(&places, threads, solve).into_iter().collect::<Option<Vec<_>>>()?;
        let of_pressure = |index: usize| solutions.iter().map(|solution| solution[index]).collect();
        Some(Self { nodes, values: (0..pressures_pa.len()).map(of_pressure).collect() })
    }

    /// By pressure.
    fn at(&self, place: &Place) -> Vec<Option<Values>> {
        let by_kind = std::array::from_fn(|kind| lagrange_weights(&self.nodes[kind], place[kind]));
        let weights: Vec<f64> = combinations(&by_kind).iter().map(|each| each.iter().product()).collect();
        let at = |values: &Vec<Values>| {
            std::array::from_fn(|k| values.iter().zip(&weights).map(|(value, weight)| value[k] * weight).sum())
        };
        self.values.iter().map(|values| Some(at(values))).collect()
    }
}

/// Every choice of a number from each list, the last list first.
fn combinations([first, second, third]: &[Vec<f64>; 3]) -> Vec<[f64; 3]> {
    let mut all = Vec::with_capacity(first.len() * second.len() * third.len());
    for a in first {
        for b in second {
            all.extend(third.iter().map(|c| [*a, *b, *c]));
        }
    }
    all
}
