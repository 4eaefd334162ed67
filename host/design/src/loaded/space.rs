//! What a limb may be: bounds, and their unit box.

use std::sync::Arc;

use fra_model::{Actuator, ActuatorParameters, Arrangement, Fiber, Material, Motion};
use nalgebra::{Isometry3, Translation3, Vector3};
use serde::Serialize;

use super::laws::Laws;
use crate::actuators::{Bounds, Geometry, Winding};
use softlimb_fea::cross_section::{BEND_TOLERANCE, BendingLaw, largest_bend_error};
use softlimb_limb::{StateCurve, base_pose, reference_max_pa};

/// Air between actuators side by side, m.
const APART_M: f64 = 1e-3;
/// Name of the variables that are no sizes: the pressures that poses stay near to.
pub(super) const HOME: &str = "home";

/// Where a limb may start.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSpace {
    /// Bounds of the position along each axis, m.
    pub position_m: [Bounds; 3],
    /// Direction of the first module at a pitch of 0; not zero.
    pub direction: [f64; 3],
    /// Direction towards which modules bend at a mount angle of 0; not along `direction`.
    pub up: [f64; 3],
    /// Bounds of the pitch, rad: from `direction` towards `up`.
    pub pitch_rad: Bounds,
}

/// What one module, or one segment of its actuator, may be.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleSpace {
    /// Its name.
    pub name: String,
    /// Its motion.
    pub motion: Motion,
    /// Number of actuators, 1 to 9.
    pub actuators: u8,
    /// Whether they stand in a row along the axis of bending, not on a circle.
    pub in_row: bool,
    /// The elastomer.
    pub material: Material<f64>,
    /// Its density, kg/m3; > 0.
    pub density_kg_per_m3: f64,
    /// The winding but for its angle; `None` for a bender wound as a hoop.
    pub winding: Option<Winding>,
    /// A second winding that is given, and its angle from the hoop, rad.
    pub second: Option<(Winding, f64)>,
    /// The laws of a bender by finite elements of its section; `None` where the analytic model has the bends, which takes one winding.
    pub laws: Option<Laws>,
    /// Bounds of the inner radius, m; > 0.
    pub inner_radius_m: Bounds,
    /// Bounds of the wall, m; > 0.
    pub wall_m: Bounds,
    /// Bounds of the length, m; more than its ends.
    pub length_m: Bounds,
    /// Lengths at the base and at the tip that caps take out of the motion, m; >= 0.
    pub ends_m: [f64; 2],
    /// Whether it continues the actuator of the space before it, as its next segment. Both share radii, pressure and mount angle, with nothing rigid
    /// between them. Their bounds of radii are equal.
    pub joined: bool,
    /// Bounds of the fiber angle, rad; unused for bending.
    pub angle_rad: Bounds,
    /// Bounds of the circle's radius or of the distance of neighbours in the row, m. Actuators never overlap, whatever this says.
    pub spread_m: Bounds,
    /// Largest distance of its plates, m; > 0. Each module has as few spacers as keep it.
    pub bay_m: f64,
    /// Mass of a spacer, kg; >= 0.
    pub spacer_kg: f64,
    /// Whether each actuator has its own pressure.
    pub steering: bool,
    /// Bounds of the mount angle, rad.
    pub mount_angle_rad: Bounds,
    /// Highest gauge pressure, Pa; > 0.
    pub pressure_max_pa: f64,
}

/// What a limb may be.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbSpace {
    /// Where it starts.
    pub base: BaseSpace,
    /// Its modules from the base outwards.
    pub modules: Vec<ModuleSpace>,
}

/// Sizes of one module.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModuleSizes {
    /// Inner and outer radius, m.
    pub radii_m: [f64; 2],
    /// Length with both ends, m.
    pub length_m: f64,
    /// Fiber angle, rad.
    pub angle_rad: f64,
    /// Radius of the circle or distance of neighbours in the row, m; 0 for one actuator.
    pub spread_m: f64,
    /// Plates between its connectors.
    pub spacers: u8,
    /// Mount angle, rad.
    pub mount_angle_rad: f64,
}

/// Sizes of a limb and where it starts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimbSizes {
    /// Where it starts, m.
    pub position_m: [f64; 3],
    /// Its pitch, rad.
    pub pitch_rad: f64,
    /// Its modules.
    pub modules: Vec<ModuleSizes>,
    /// Pressures of the drives, as shares of the highest, that inverse kinematics keep poses near to where several pressures do.
    #[serde(skip)]
    pub home: Vec<f64>,
}

/// One open variable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Variable {
    /// The module it belongs to; `None` for the base.
    pub module: Option<usize>,
    /// Its name as in a scene.
    pub name: &'static str,
    /// Its bounds in SI units.
    pub bounds: Bounds,
}

fn at([low, high]: Bounds, share: f64) -> f64 {
    low + share * (high - low)
}

impl LimbSpace {
    /// All variables that are open, in the order of the unit box.
    pub fn variables(&self) -> Vec<Variable> {
        let mut all: Vec<(Option<usize>, &'static str, Bounds)> =
            self.base.position_m.iter().map(|bounds| (None, "base_position", *bounds)).collect();
        all.push((None, "base_pitch", self.base.pitch_rad));
        for (index, module) in self.modules.iter().enumerate() {
            all.extend(module.axes().map(|(name, bounds)| (Some(index), name, bounds)));
        }
        all.extend(self.owners().into_iter().map(|owner| (Some(owner), HOME, [0.0, 1.0])));
        let open = all.into_iter().filter(|(_, _, [low, high])| high > low);
        open.map(|(module, name, bounds)| Variable { module, name, bounds }).collect()
    }

    /// The module of each drive: of a module, the first of the segments of an actuator, or of an actuator of a steering one.
    pub(super) fn owners(&self) -> Vec<usize> {
        let drives = |module: &ModuleSpace| match module {
            ModuleSpace { joined: true, .. } => 0,
            ModuleSpace { steering: true, actuators, .. } => usize::from(*actuators),
            _ => 1,
        };
        let owners = self.modules.iter().enumerate();
        owners.flat_map(|(index, module)| std::iter::repeat_n(index, drives(module))).collect()
    }

    /// The sizes at a point of the unit box, which has as many axes as there are [`variables`](Self::variables).
    pub fn sizes(&self, point: &[f64]) -> LimbSizes {
        let mut shares = point.iter().copied();
        // What is not open takes no share.
        let mut next =
            |bounds: Bounds| if bounds[1] > bounds[0] { at(bounds, shares.next().unwrap_or(0.5)) } else { bounds[0] };
        let position_m = self.base.position_m.map(&mut next);
        let pitch_rad = next(self.base.pitch_rad);
        let mut modules: Vec<ModuleSizes> = Vec::with_capacity(self.modules.len());
        for (index, module) in self.modules.iter().enumerate() {
            let before = modules.last().filter(|_| module.joined).map(|sizes| (&self.modules[index - 1], *sizes));
            modules.push(module.sizes(&mut next, before));
        }
        let home = self.owners().iter().map(|_| next([0.0, 1.0])).collect();
        LimbSizes { position_m, pitch_rad, modules, home }
    }

    /// The point of the unit box nearest to values of the variables, in their order.
    pub fn point(&self, mut value_of: impl FnMut(&Variable) -> f64) -> Vec<f64> {
        let share = |variable: &Variable| {
            let [low, high] = variable.bounds;
            ((value_of(variable) - low) / (high - low)).clamp(0.0, 1.0)
        };
        self.variables().iter().map(share).collect()
    }

    /// The same with other bounds of one of its [`variables`](Self::variables).
    pub(super) fn with_bounds(&self, variable: usize, bounds: Bounds) -> Self {
        let mut space = self.clone();
        let base = space.base.position_m.iter_mut().chain(std::iter::once(&mut space.base.pitch_rad));
        let sizes = space.modules.iter_mut().flat_map(ModuleSpace::axes_mut);
        let open = base.map(Some).chain(sizes).flatten().filter(|[low, high]| high > low);
        open.skip(variable).take(1).for_each(|old| *old = bounds);
        for index in 1..space.modules.len() {
            let [.., before, own] = &mut space.modules[..=index] else { break };
            if own.joined {
                (own.inner_radius_m, own.wall_m) = (before.inner_radius_m, before.wall_m);
                own.mount_angle_rad =
                    before.mount_angle_rad.map(|angle| angle + own.mount_angle_rad[0] - before.mount_angle_rad[0]);
            }
        }
        let modules = space.modules.iter_mut().zip(&self.modules);
        modules.filter(|(own, before)| own != before).for_each(|(own, _)| own.forget_laws());
        space
    }

    /// The same with another highest pressure of all modules, by a factor.
    pub(super) fn with_pressures(&self, factor: f64) -> Self {
        let mut space = self.clone();
        for module in &mut space.modules {
            module.pressure_max_pa *= factor;
            module.forget_laws();
        }
        space
    }

    /// The same for a limb of these radii, whose laws are not interpolated.
    pub(super) fn at_radii(&self, sizes: &LimbSizes) -> Self {
        let mut space = self.clone();
        for (module, sizes) in space.modules.iter_mut().zip(&sizes.modules) {
            let [inner_m, outer_m] = sizes.radii_m;
            (module.inner_radius_m, module.wall_m) = ([inner_m; 2], [outer_m - inner_m; 2]);
            module.forget_laws();
        }
        space
    }

    /// A first guess: sizes that have stood level with a bottle, as far as the bounds allow.
    pub fn first_guess(&self) -> Vec<f64> {
        self.point(|variable| {
            let middle = 0.5 * (variable.bounds[0] + variable.bounds[1]);
            let Some(module) = variable.module else { return middle };
            // A lone tube has no spread that would make it stiff.
            if self.modules[module].actuators == 1 && variable.name != HOME {
                return middle;
            }
            // Of a bender, of the module at the base, of others.
            let of = |values: [f64; 3]| match (self.modules[module].motion, module) {
                (Motion::Bending, _) => values[0],
                (_, 0) => values[1],
                _ => values[2],
            };
            match variable.name {
                "inner_radius" => of([14e-3, 12e-3, 10e-3]),
                "wall" => of([8e-3, 6e-3, 5e-3]),
                "length" => 0.19,
                "circle_radius" => 0.062,
                HOME => 0.4,
                _ => middle,
            }
        })
    }

    /// Pose of the start of the part that moves: behind the first end.
    pub fn base(&self, sizes: &LimbSizes) -> Isometry3<f64> {
        let [direction, up] = self.directions(sizes.pitch_rad);
        let end_m = self.modules.first().map_or(0.0, |module| module.ends_m[0]);
        base_pose(sizes.position_m, direction, up) * Translation3::new(0.0, 0.0, end_m)
    }

    /// Unit vectors along the first module and towards which modules bend at a mount angle of 0, at a pitch, rad.
    pub fn directions(&self, pitch_rad: f64) -> [[f64; 3]; 2] {
        let along = Vector3::from(self.base.direction).normalize();
        let up = Vector3::from(self.base.up);
        let normal = (up - along * along.dot(&up)).normalize();
        let (sin, cos) = pitch_rad.sin_cos();
        [(along * cos + normal * sin).into(), (normal * cos - along * sin).into()]
    }
}

impl ModuleSpace {
    fn axes(&self) -> [(&'static str, Bounds); 6] {
        // A bender keeps the angle of its winding.
        let angle_rad = if self.motion == Motion::Bending { [self.angle_rad[0]; 2] } else { self.angle_rad };
        let spread_m = if self.actuators == 1 { [0.0; 2] } else { self.spread_m };
        // A joined segment takes these from the segment before it.
        let own = |bounds: Bounds| if self.joined { [bounds[0]; 2] } else { bounds };
        [
            ("inner_radius", own(self.inner_radius_m)),
            ("wall", own(self.wall_m)),
            ("length", self.length_m),
            ("fiber_angle", angle_rad),
            (if self.in_row { "spacing" } else { "circle_radius" }, spread_m),
            ("mount_angle", own(self.mount_angle_rad)),
        ]
    }

    /// The bounds of [`axes`](Self::axes), in their order; `None` for those that are none of it.
    fn axes_mut(&mut self) -> [Option<&mut Bounds>; 6] {
        let (wound, many, own) = (self.motion != Motion::Bending, self.actuators != 1, !self.joined);
        [
            own.then_some(&mut self.inner_radius_m),
            own.then_some(&mut self.wall_m),
            Some(&mut self.length_m),
            wound.then_some(&mut self.angle_rad),
            many.then_some(&mut self.spread_m),
            own.then_some(&mut self.mount_angle_rad),
        ]
    }

    /// Length that its caps take out of the motion, m.
    pub(super) fn capped_m(&self) -> f64 {
        self.ends_m.iter().sum()
    }

    /// Discards the laws, which hold for the bounds and the pressure that they were made for.
    fn forget_laws(&mut self) {
        self.laws = self.laws.as_ref().map(|_| Laws::default());
    }

    /// `before` is the segment of the same actuator before it, with its sizes.
    fn sizes(&self, mut next: impl FnMut(Bounds) -> f64, before: Option<(&Self, ModuleSizes)>) -> ModuleSizes {
        let [inner, wall, length, angle, spread, mount] = self.axes().map(|(_, bounds)| bounds);
        let [inner_m, wall_m, length_m, angle_rad] = [inner, wall, length, angle].map(&mut next);
        let [inner_m, outer_m] = before.map_or([inner_m, inner_m + wall_m], |(_, sizes)| sizes.radii_m);
        // Its range begins where the actuators have room, so that sizes have no kink there.
        let least_m = if self.actuators == 1 { 0.0 } else { self.least_spread_m(outer_m) };
        let share = if spread[1] > spread[0] { (next(spread) - spread[0]) / (spread[1] - spread[0]) } else { 0.0 };
        let spread_m = at([spread[0].max(least_m), spread[1].max(least_m)], share);
        let turned = |(before, sizes): (&Self, ModuleSizes)| sizes.mount_angle_rad - before.mount_angle_rad[0];
        let mount_angle_rad = next(mount) + before.map_or(0.0, turned);
        let spacers = (((length_m - self.capped_m()) / self.bay_m).ceil() - 1.0).clamp(0.0, 50.0) as u8;
        ModuleSizes { radii_m: [inner_m, outer_m], length_m, angle_rad, spread_m, spacers, mount_angle_rad }
    }

    /// The least spread at which actuators of an outer radius have room, m.
    fn least_spread_m(&self, outer_m: f64) -> f64 {
        let apart_m = 2.0 * outer_m + APART_M;
        if self.in_row { apart_m } else { 0.5 * apart_m / (std::f64::consts::PI / f64::from(self.actuators)).sin() }
    }

    /// Places of its actuators.
    pub(crate) fn arrangement(&self, sizes: &ModuleSizes) -> Arrangement<f64> {
        if self.in_row {
            Arrangement::Row { spacing_m: sizes.spread_m }
        } else {
            Arrangement::Circle { radius_m: sizes.spread_m }
        }
    }

    /// Length of the part that moves, m.
    pub(super) fn moving_m(&self, sizes: &ModuleSizes) -> f64 {
        sizes.length_m - self.capped_m()
    }

    /// One of its actuators, as long as the part that moves, by the analytic model; of a bender without its second winding. `None` where the model refuses it.
    pub(super) fn actuator(&self, sizes: &ModuleSizes) -> Option<Actuator<f64>> {
        let geometry = geometry(sizes.radii_m, self.moving_m(sizes), sizes.angle_rad);
        let actuator = Actuator::new(&self.parameters(&geometry)).ok()?;
        match self.second_fiber(&geometry).filter(|_| self.motion != Motion::Bending) {
            Some(second) => actuator.with_second_fiber(&second).ok(),
            None => Some(actuator),
        }
    }

    /// A bender of inner and outer radius, m, and its second winding, for finite elements of its section. These have no length.
    pub(crate) fn wound(&self, radii_m: [f64; 2]) -> (ActuatorParameters<f64>, Option<Fiber<f64>>) {
        let geometry = geometry(radii_m, self.length_m[0] - self.capped_m(), self.angle_rad[0]);
        (self.parameters(&geometry), self.second_fiber(&geometry))
    }

    fn parameters(&self, geometry: &Geometry) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion: self.motion,
            inner_radius_m: geometry.inner_radius_m,
            outer_radius_m: geometry.outer_radius_m,
            length_m: geometry.length_m,
            material: self.material,
            fiber: self.winding.map(|winding| winding.fiber(geometry, geometry.angle_rad)),
        }
    }

    fn second_fiber(&self, geometry: &Geometry) -> Option<Fiber<f64>> {
        self.second.map(|(winding, angle_rad)| winding.fiber(geometry, angle_rad))
    }

    /// Whether the analytic bend of a section within the bounds may err by more than is accepted, or takes not all its windings.
    pub(crate) fn bends_err(&self) -> bool {
        if self.second.is_some() {
            return true;
        }
        let ends = |[low, high]: Bounds| [low, 0.5 * (low + high), high];
        let [inner, wall] = [self.inner_radius_m, self.wall_m].map(ends);
        let mut radii = inner.iter().flat_map(|inner| wall.iter().map(move |wall| [*inner, inner + wall]));
        radii.any(|radii_m| {
            let (parameters, _) = self.wound(radii_m);
            let Ok(actuator) = Actuator::new(&parameters) else { return false };
            let analytic = StateCurve::new(&actuator, reference_max_pa(self.pressure_max_pa));
            largest_bend_error(&parameters, &analytic.states()[1..]).is_none_or(|error| error > BEND_TOLERANCE)
        })
    }

    /// The law of a bender with inner and outer radius, m, where finite elements have its bends.
    ///
    /// # Errors
    /// As [`Laws::at`].
    pub(crate) fn law(&self, radii_m: [f64; 2]) -> Result<Option<Arc<BendingLaw>>, [f64; 2]> {
        self.laws.as_ref().map(|laws| laws.at(self, radii_m)).transpose()
    }
}

fn geometry([inner_radius_m, outer_radius_m]: [f64; 2], length_m: f64, angle_rad: f64) -> Geometry {
    Geometry { inner_radius_m, outer_radius_m, length_m, angle_rad }
}
