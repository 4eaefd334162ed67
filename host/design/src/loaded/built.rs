//! A limb of certain sizes whose pressures can be chosen.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use fra_model::{Actuator, Load, Motion, Status};
use nalgebra::{Isometry3, Vector3};

use super::laws::Laws;
use super::space::{LimbSizes, LimbSpace};
use super::task::LoadedTask;
use softlimb_fea::cross_section::BendingLaw;
use softlimb_limb::statics::{Bundle, GRAVITY_M_PER_S2, LoadedLimb, Piece, Rod, Spring};

/// One module of it, or one segment of its actuator.
#[derive(Clone, Debug)]
pub(super) struct BuiltModule {
    motion: Motion,
    actuator: Actuator<f64>,
    /// The bending law of a bender that finite elements bend.
    law: Option<Arc<BendingLaw>>,
    /// The table that the law is taken from.
    laws: Option<Laws>,
    positions_m: Vec<[f64; 2]>,
    /// Length of the part that moves, m.
    pub(super) length_m: f64,
    bay_m: f64,
    mount_angle_rad: f64,
    pressure_max_pa: f64,
    /// Whether each actuator has its own pressure.
    steering: bool,
    /// Highest pressure that keeps the margin, Pa.
    span_pa: f64,
    /// Mass of walls and spacers, kg.
    between_kg: f64,
    /// Tubes at the pressures that were asked for.
    springs: Arc<Mutex<Vec<(f64, Spring)>>>,
    /// Radius of the module about its centre line at rest, m.
    pub(super) radius_m: f64,
    /// Length of the rigid part behind it but for the tool, m: a connector between two ends.
    pub(super) connector_m: f64,
    /// Mass of the connector, kg.
    connector_kg: f64,
    /// Whether it is a segment of the actuator before it.
    joined: bool,
}

/// A limb of certain sizes. Pressures, one a drive, are shares of the highest that keep the margin.
#[derive(Clone, Debug)]
pub struct Built {
    base: Isometry3<f64>,
    pub(super) modules: Vec<BuiltModule>,
    /// The module of each drive, or the first of the segments that it drives.
    owners: Vec<usize>,
    /// The reserve that its pressures keep.
    pub(super) reserve: f64,
    /// Length and mass of the tool, m and kg.
    tool: [f64; 2],
    /// Length at rest from base to tip, m.
    pub length_m: f64,
}

impl Built {
    /// The limb of sizes, whose pressures keep their margin with a reserve; `None` where the model cannot take an actuator.
    pub fn new(task: &LoadedTask, space: &LimbSpace, sizes: &LimbSizes, reserve: f64) -> Option<Self> {
        Self::with(task, space, sizes, reserve, |_| None)
    }

    /// The same near another limb of the task and the space, whose modules are taken where they are the same.
    pub(super) fn near(
        task: &LoadedTask,
        space: &LimbSpace,
        sizes: &LimbSizes,
        reserve: f64,
        (near, near_sizes): (&Self, &LimbSizes),
    ) -> Option<Self> {
        let alike = |index: usize| {
            sizes.modules[index] == near_sizes.modules[index]
                && reserve == near.reserve
                && space.modules[index].pressure_max_pa == near.modules[index].pressure_max_pa
                && space.modules[index].laws == near.modules[index].laws
        };
        // Segments share the highest pressure.
        let same = |index: usize| near.chamber(index).all(alike);
        Self::with(task, space, sizes, reserve, |index| same(index).then(|| near.modules[index].clone()))
    }

    fn with(
        task: &LoadedTask,
        space: &LimbSpace,
        sizes: &LimbSizes,
        reserve: f64,
        known: impl Fn(usize) -> Option<BuiltModule>,
    ) -> Option<Self> {
        let mut modules = Vec::with_capacity(space.modules.len());
        for (index, (module, size)) in space.modules.iter().zip(&sizes.modules).enumerate() {
            if let Some(module) = known(index) {
                modules.push(module);
                continue;
            }
            let actuator = module.actuator(size)?;
            let law = module.law(size.radii_m).ok()?;
            let limit_pa = match &law {
                Some(law) => law.pressure_max_pa().min(module.pressure_max_pa),
                None => ceiling_pa(&actuator, module.pressure_max_pa)?,
            };
            let arrangement = module.arrangement(size);
            let moving_m = module.moving_m(size);
            let next = space.modules.get(index + 1);
            let joint = next.is_some_and(|next| next.joined);
            let next_m = next.map_or(0.0, |next| next.ends_m[0]);
            let [inner_m, outer_m] = size.radii_m;
            let section_m2 = PI * (outer_m - inner_m) * (outer_m + inner_m);
            modules.push(BuiltModule {
                motion: module.motion,
                springs: Arc::default(),
                pressure_max_pa: module.pressure_max_pa,
                steering: module.steering,
                span_pa: task.limits.pressure_share / (1.0 + reserve) * limit_pa,
                actuator,
                law,
                laws: module.laws.clone(),
                positions_m: arrangement.positions_m(module.actuators).collect(),
                length_m: moving_m,
                bay_m: moving_m / (f64::from(size.spacers) + 1.0),
                mount_angle_rad: size.mount_angle_rad,
                between_kg: f64::from(module.actuators) * section_m2 * size.length_m * module.density_kg_per_m3
                    + f64::from(size.spacers) * module.spacer_kg,
                radius_m: arrangement.reach_m(module.actuators) + outer_m,
                connector_m: if joint { 0.0 } else { module.ends_m[1] + task.connector_m + next_m },
                connector_kg: if joint { 0.0 } else { task.connector_kg },
                joined: module.joined,
            });
        }
        let connectors = modules.iter().filter(|module| !module.joined).count();
        let rigid_m = connectors as f64 * task.connector_m + task.tool_m[0];
        let mut built = Self {
            base: space.base(sizes),
            length_m: sizes.modules.iter().map(|module| module.length_m).sum::<f64>() + rigid_m,
            modules,
            owners: space.owners(),
            reserve,
            tool: [task.tool_m[0], task.tool_kg],
        };
        for index in 0..built.modules.len() {
            let spans_pa = built.modules[built.chamber(index)].iter().map(|module| module.span_pa);
            built.modules[index].span_pa = spans_pa.fold(f64::INFINITY, f64::min);
        }
        Some(built)
    }

    /// All segments of the actuator of a module; the module alone if it has no segments.
    fn chamber(&self, index: usize) -> Range<usize> {
        let first = self.first(index);
        let more = self.modules[first + 1..].iter().take_while(|module| module.joined).count();
        first..first + 1 + more
    }

    /// The first segment of the actuator of a module.
    fn first(&self, index: usize) -> usize {
        (0..=index).rev().find(|index| !self.modules[*index].joined).unwrap_or(0)
    }

    /// Motion of a module.
    pub(super) fn motion(&self, module: usize) -> Motion {
        self.modules[module].motion
    }

    /// Whether a module bends.
    pub(super) fn is_bending(&self, module: usize) -> bool {
        self.modules[module].motion == Motion::Bending
    }

    /// Number of drives: modules, but each actuator of a steering one.
    pub fn drives(&self) -> usize {
        self.owners.len()
    }

    /// The module of a drive, or all segments of its actuator.
    pub(super) fn driven(&self, drive: usize) -> Range<usize> {
        self.chamber(self.owners[drive])
    }

    /// The drives of a module; segments of one actuator have the same.
    pub(super) fn drives_of(&self, module: usize) -> Range<usize> {
        let first = self.first(module);
        let from = |module: usize| self.owners.partition_point(|owner| *owner < module);
        from(first)..from(first + 1)
    }

    /// Pressures of shares, Pa.
    pub fn pressures_pa(&self, shares: &[f64]) -> Vec<f64> {
        shares.iter().zip(&self.owners).map(|(share, owner)| share * self.modules[*owner].span_pa).collect()
    }

    /// Mass without payload, kg.
    pub fn mass_kg(&self) -> f64 {
        let walls: f64 = self.modules.iter().map(|module| module.between_kg).sum();
        let connectors: f64 = self.modules.iter().map(|module| module.connector_kg).sum();
        walls + connectors + self.tool[1]
    }

    /// The bundle of a module at shares of its pressures, one a drive of it; `None` where it has no equilibrium.
    pub(super) fn bundle(&self, index: usize, shares: &[f64]) -> Option<Bundle> {
        let module = &self.modules[index];
        let spring = |actuator: usize| module.spring(shares[if module.steering { actuator } else { 0 }]);
        let places = module.positions_m.iter().enumerate();
        let springs = places.map(|(actuator, place)| Some((*place, spring(actuator)?))).collect::<Option<_>>()?;
        Bundle::of_springs(module.motion, springs, module.bay_m)
    }

    /// The rod of a module with a bundle, with what is fixed behind it.
    pub(super) fn piece(&self, index: usize, bundle: &Bundle, payload_kg: f64) -> Piece {
        let module = &self.modules[index];
        let mut rigid_m = module.connector_m;
        let mut masses = vec![(0.5 * rigid_m, module.connector_kg)];
        if index + 1 == self.modules.len() {
            let [tool_m, tool_kg] = self.tool;
            masses.push((rigid_m + 0.5 * tool_m, tool_kg));
            rigid_m += tool_m;
            masses.push((rigid_m, payload_kg));
        }
        Piece {
            mount_angle_rad: module.mount_angle_rad,
            kg_per_m: module.between_kg / module.length_m,
            rigid_m,
            masses,
            ..bundle.piece(module.length_m)
        }
    }

    /// The limb at shares of its pressures with a payload, kg; `None` where an actuator has no equilibrium.
    pub fn loaded(&self, shares: &[f64], payload_kg: f64) -> Option<LoadedLimb> {
        let bundle = |index: usize| self.bundle(index, &shares[self.drives_of(index)]);
        let bundles = (0..self.modules.len()).map(bundle).collect::<Option<Vec<_>>>()?;
        let pieces = bundles.iter().enumerate().map(|(index, bundle)| self.piece(index, bundle, payload_kg));
        let rod = Rod {
            base: self.base,
            pieces: pieces.collect(),
            gravity_m_per_s2: Vector3::new(0.0, 0.0, -GRAVITY_M_PER_S2),
            tip_force_n: Vector3::zeros(),
        };
        let motions = self.modules.iter().map(|module| module.motion);
        Some(LoadedLimb::of_rod(rod, motions.zip(bundles).collect()))
    }
}

impl BuiltModule {
    /// Whether it is another one's clone.
    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.springs, &other.springs)
    }

    /// A tube at a share of its pressure; `None` where it has no equilibrium.
    fn spring(&self, share: f64) -> Option<Spring> {
        let pressure_pa = share * self.span_pa;
        let springs = || self.springs.lock().unwrap_or_else(PoisonError::into_inner);
        let known = springs().iter().find(|(at, _)| *at == pressure_pa).map(|(_, spring)| spring.clone());
        known.or_else(|| {
            let spring = match &self.law {
                Some(law) => Spring::by_section(&self.actuator, law, pressure_pa),
                None => Spring::new(&self.actuator, pressure_pa),
            }?;
            springs().push((pressure_pa, spring.clone()));
            Some(spring)
        })
    }
}

/// The lower of the highest pressure and the limit point, Pa.
fn ceiling_pa(actuator: &Actuator<f64>, pressure_max_pa: f64) -> Option<f64> {
    let solution = actuator.forward(pressure_max_pa, &Load::none()).ok()?;
    if solution.status == Status::Solved {
        return Some(pressure_max_pa);
    }
    solution.limit_pressure_pa.map(|limit| limit.min(pressure_max_pa)).filter(|limit| *limit > 0.0)
}
