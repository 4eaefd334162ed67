//! The simulated limb as a true body: tubes with memory between plates, in equilibrium at every sample.
//!
//! Quasi-static, as the simple limb under weight, unless the scene lets it swing. The body follows the chambers' pressures; that its shape changes
//! the chambers' volumes in its turn is left out, and the plant's volumes are those of free actuators.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fra_model::{ActuatorParameters, Motion, State, StateQuantity};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use softlimb_body::{
    Assembly, Ball, Bay, Body, Effects, Fallen, Hanging, Law, Mass, MemoryParameters, Moving, Plate, Solid, Stiffness,
    Tolerance, Tube, TubeStrain,
};
use softlimb_sim::plant::{TrueParameters, Truth};

use super::hanging::{FALLS, Hung, SYSTEM};
use super::tube_law;
use super::tube_law::Wound;
use crate::record::{ContactRecord, FaultRecord};
use softlimb_limb::{Drive, Limb, LimbModule};
use softlimb_scene::{BodyEffects, Scene, collision};

const GRAVITY_M_PER_S2: f64 = 9.806_65;
/// Time that the limb has rested before the first sample of the first run, and of others, s.
const NEW_S: f64 = 600.0;
const RESTED_S: f64 = 60.0;
/// Pressures of the laws, of the module's highest: a loop overshoots a little.
const COVERED: f64 = 1.05;
/// Pressure that ends a run, of the highest of a law: the fit holds a little beyond its points.
const BEYOND: f64 = 1.03;
/// Bend and twist of a beam at the highest pressure, rad, above which a tube between two plates has more beams.
const BEND_RAD: f64 = 0.3;
const TWIST_RAD: f64 = 0.4;
/// Longest time step of a limb that swings, s.
const STEP_S: f64 = 5e-3;
/// Least distance of two balls with which a rigid part touches obstacles, m.
const LEAST_BALL_M: f64 = 5e-3;
/// Smallest contact force that is reported, N.
const LEAST_N: f64 = 0.01;
/// Beams of a tube between plates without spacers, at least.
const LONE_BEAMS: usize = 4;

/// Laws of tubes that runs share, since finite elements take longer than a run, and the limb that one leaves to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Laws(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    /// By module, the springs of its nominal actuator.
    springs: HashMap<usize, Stiffness>,
    /// By channel, the law of its true actuator with the actuator and the second winding that it is for.
    laws: HashMap<usize, (Wound, Arc<Law>)>,
    /// The limb after the last run, with the seed of its specimen and the highest pressures of its laws: what it has been through stays.
    rested: Option<(u64, Moving, Vec<f64>)>,
}

impl Laws {
    fn known(&self) -> MutexGuard<'_, Known> {
        // Nothing panics while it is locked.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The specimen `seed` as the last run has left it.
    fn rested(&self, seed: u64) -> Option<(Moving, Vec<f64>)> {
        let (of, body, highest_pa) = self.known().rested.take()?;
        (of == seed).then_some((body, highest_pa))
    }

    /// The law of a channel's true actuator, or the reason why there is none.
    fn of(&self, module: (usize, &LimbModule), channel: usize, made: &TrueParameters) -> Result<Arc<Law>, String> {
        let wound = (made.actuator, made.second_fiber);
        let mut known = self.known();
        if let Some((_, law)) = known.laws.get(&channel).filter(|(other, _)| *other == wound) {
            return Ok(law.clone());
        }
        let (index, module) = module;
        let highest_pa = COVERED * module.pressure_max_pa;
        let lacking =
            || format!("the section of an actuator of `{}` has too few equilibria up to {highest_pa} Pa", module.name);
        let nominal = (*module.actuator.parameters(), module.second_fiber().copied());
        let springs = match known.springs.get(&index) {
            Some(springs) => springs.clone(),
            None => {
                let found = tube_law::stiffness(&nominal, highest_pa).map_err(|error| error.to_string())?;
                let found = found.ok_or_else(lacking)?;
                known.springs.insert(index, found.clone());
                found
            }
        };
        let springs = scaled(springs, stiffer(&made.actuator) / stiffer(&nominal.0));
        let law = tube_law::law(&wound, &springs, highest_pa).map_err(|error| error.to_string())?;
        let law = Arc::new(law.ok_or_else(lacking)?);
        known.laws.insert(channel, (wound, law.clone()));
        Ok(law)
    }
}

impl Drop for Bodied<'_> {
    /// Leaves the limb to the next run.
    fn drop(&mut self) {
        if let Some(body) = self.body.take() {
            self.laws.known().rested = Some((self.seed, body, std::mem::take(&mut self.highest_pa)));
        }
    }
}

/// Scale of a wall's stiffness: modulus and thickness.
fn stiffer(parameters: &ActuatorParameters<f64>) -> f64 {
    let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
    parameters.material.shear_modulus_pa() * wall_m * (parameters.outer_radius_m + parameters.inner_radius_m)
}

fn scaled(mut springs: Stiffness, by: f64) -> Stiffness {
    let [towards, across] = &mut springs.bending_nm2;
    for value in towards.iter_mut().chain(across).chain(&mut springs.torsion_nm2) {
        *value *= by;
    }
    springs.strip_n *= by;
    springs.shear_n *= by;
    springs
}

/// A true body in a run.
pub(super) struct Bodied<'a> {
    scene: &'a Scene,
    plant: &'a Scene,
    limb: &'a Limb,
    effects: BodyEffects,
    seed: u64,
    laws: Laws,
    /// Known from the first sample on.
    body: Option<Moving>,
    /// The highest pressure of each channel's law, Pa.
    highest_pa: Vec<f64>,
    last_us: u64,
    lost: bool,
    /// Largest force of each obstacle so far, by its index.
    touched: BTreeMap<usize, ContactRecord>,
}

/// An obstacle as a stop.
#[derive(Debug)]
struct Obstacle(collision::Shape);

impl Solid for Obstacle {
    fn distance(&self, point_m: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let found = self.0.distance(point_m);
        (found.distance_m, found.gradient)
    }
}

impl<'a> Bodied<'a> {
    /// The limb of `plant` among the obstacles of `scene`, with its objects.
    pub(super) fn new(
        scene: &'a Scene,
        (plant, limb): (&'a Scene, &'a Limb),
        effects: BodyEffects,
        seed: u64,
        laws: Laws,
    ) -> Self {
        let (body, highest_pa, touched) = (None, Vec::new(), BTreeMap::new());
        Self { scene, plant, limb, effects, seed, laws, body, highest_pa, last_us: 0, lost: false, touched }
    }

    /// Obstacles that stopped the limb so far.
    pub(super) fn contacts(&self) -> Vec<ContactRecord> {
        self.touched.values().cloned().collect()
    }

    /// The shape at a time of the run, us, with a mass at the tip, kg, of an object of the scene, and the fault that ends it; `free` are the
    /// drives' states without load.
    ///
    /// `None` from the moment on at which the limb falls.
    pub(super) fn at(
        &mut self,
        at: (u64, f64, Option<usize>),
        truth: &Truth,
        free: &[State<f64>],
    ) -> (Option<Hung>, Option<FaultRecord>) {
        if self.lost {
            return (None, None);
        }
        match self.settled(at, truth) {
            Ok(()) => (self.body.as_ref().map(|body| self.seen(body.body(), free)), None),
            Err(why) => {
                self.lost = true;
                let text = format!("{why}: the limb's shape is not known from here on");
                let time_s = at.0 as f64 * 1e-6;
                (None, Some(FaultRecord { time_s, channel: SYSTEM, code: FALLS, value: 0, text }))
            }
        }
    }

    fn settled(
        &mut self,
        (time_us, payload_kg, object): (u64, f64, Option<usize>),
        truth: &Truth,
    ) -> Result<(), String> {
        let begins = self.body.is_none();
        let (mut body, span_s, rests) = match self.body.take() {
            Some(body) => (body, time_us.saturating_sub(self.last_us) as f64 * 1e-6, !self.effects.swing),
            None => match self.laws.rested(self.seed) {
                Some((body, highest_pa)) => {
                    self.highest_pa = highest_pa;
                    (body, RESTED_S, true)
                }
                None => (Moving::new(self.assembled(truth)?), NEW_S, true),
            },
        };
        self.last_us = time_us;
        for ((channel, module), highest_pa) in truth.channels.iter().zip(self.modules()).zip(&self.highest_pa) {
            if channel.pressure_pa > BEYOND * highest_pa {
                return Err(format!(
                    "an actuator of `{}` is beyond the pressures that its section was solved for",
                    module.name
                ));
            }
        }
        let pressures_pa: Vec<f64> = truth.channels.iter().map(|channel| channel.pressure_pa.max(0.0)).collect();
        let payload_kg = if self.has_weight() { payload_kg } else { 0.0 };
        let falls = |_: Fallen| "the limb falls: it has no stable equilibrium near the last one".to_owned();
        let span_s = if begins && object.is_some() && self.effects.contact {
            // An object is grasped by a limb that has its shape.
            body.carry(None);
            body.settle(&pressures_pa, 0.0, span_s).map_err(falls)?;
            0.0
        } else {
            span_s
        };
        body.carry(object.map(|index| self.hanging(index)));
        if rests {
            body.settle(&pressures_pa, payload_kg, span_s).map_err(falls)?;
        } else if span_s > 0.0 {
            body.advance_by(&pressures_pa, payload_kg, span_s, STEP_S).map_err(falls)?;
        }
        self.note_contacts(body.body(), time_us);
        self.body = Some(body);
        Ok(())
    }

    /// An object of the scene, from the tip that holds it.
    fn hanging(&self, object: usize) -> Hanging {
        let object = &self.scene.objects()[object];
        Hanging { above_m: object.height_m - object.grasp_m, below_m: object.grasp_m, radius_m: object.radius_m }
    }

    fn note_contacts(&mut self, body: &Body, time_us: u64) {
        let time_s = time_us as f64 * 1e-6;
        for contact in body.contacts() {
            let force_n = Vector3::from(contact.force_n).norm();
            if force_n < LEAST_N {
                continue;
            }
            let carried = contact.carried;
            let obstacle = || self.scene.obstacles()[contact.solid].name.value.clone();
            let new = || ContactRecord { obstacle: obstacle(), force_n, time_s, first_s: time_s, carried };
            let known = self.touched.entry(contact.solid).or_insert_with(new);
            known.carried &= carried;
            if force_n > known.force_n {
                (known.force_n, known.time_s) = (force_n, time_s);
            }
        }
    }

    /// The module of each channel.
    fn modules(&self) -> impl Iterator<Item = &LimbModule> {
        self.limb.modules().iter().flat_map(|module| module.channels.clone().map(move |_| module))
    }

    fn has_weight(&self) -> bool {
        !self.plant.weightless()
    }

    fn assembled(&mut self, truth: &Truth) -> Result<Body, String> {
        let BodyEffects { hysteresis, creep, softening, assembly, contact, swing } = self.effects;
        let effects = Effects { hysteresis, creep, damping: swing, softening };
        let mut seats = Assembly::new(self.seed, if assembly { Tolerance::default() } else { Tolerance::NONE });
        let base = self.limb.base() * seats.base();
        let (mut bays, mut plates, mut balls) = (Vec::new(), Vec::new(), Vec::new());
        let mut highest_pa = Vec::new();
        // Length of the rigid part below the next bay, and its masses in the frame of the plate that it is fixed to.
        let mut rigid_m = 0.0;
        for (index, module) in self.limb.modules().iter().enumerate() {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), module.mount_angle_rad());
            let tubes = module.channels.clone().zip(module.positions_m());
            let tubes = tubes.map(|(channel, [x, y])| {
                let made = &truth.channels[channel].parameters;
                let actuator = &made.actuator;
                // The axis of a bender is its strip, on the side that it bends to.
                let strip_m = if module.motion == Motion::Bending { actuator.outer_radius_m } else { 0.0 };
                let place = turn * Translation3::new(x + strip_m, y, 0.0);
                let law = self.laws.of((index, module), channel, made)?;
                highest_pa.push(law.potential.units[2]);
                Ok((channel, law, [place * seats.seat(), place * seats.seat()], place))
            });
            let tubes: Vec<_> = tubes.collect::<Result<_, String>>()?;
            let (count, bay_m) = (module.bays(), module.bay_m());
            let wall_kg = self.wall_kg(index, truth) / count as f64;
            for bay in 0..count {
                let below_m = if bay == 0 { rigid_m } else { 0.0 };
                let lift = Translation3::new(0.0, 0.0, below_m);
                let tube = |(channel, law, seats, place): &(usize, Arc<Law>, [Isometry3<f64>; 2], Isometry3<f64>)| {
                    let lower = lift * if bay == 0 { seats[0] } else { *place };
                    let upper = if bay + 1 == count { seats[1] } else { *place };
                    let memory = MemoryParameters::drawn(self.seed, *channel).with(effects);
                    Tube::new(law.clone(), *channel, [lower, upper], (bay_m, beams(module, law, count)), memory)
                };
                let rest = Isometry3::translation(0.0, 0.0, below_m + bay_m);
                bays.push(Bay { rest, tubes: tubes.iter().map(tube).collect() });
                // Half of a bay's walls hang on each of its plates.
                if let Some(Plate { masses }) = plates.last_mut() {
                    masses.extend(self.section_masses(module, below_m, 0.5 * wall_kg));
                }
                let spacer_kg = if bay + 1 == count { 0.0 } else { self.plant.modules()[index].spacer_mass_kg };
                balls.push(Ball { plate: plates.len(), place_m: [0.0; 3], radius_m: rest_radius_m(module) });
                plates.push(Plate { masses: self.section_masses(module, 0.0, 0.5 * wall_kg + spacer_kg) });
            }
            balls.extend(self.rigid_balls(module, index, plates.len() - 1));
            rigid_m = module.rigid_length_m() + seats.length_m();
            if let Some(plate) = plates.last_mut() {
                plate.masses.extend(self.rigid_masses(module, index));
            }
        }
        self.highest_pa = highest_pa;
        let gravity = if self.has_weight() { -GRAVITY_M_PER_S2 } else { 0.0 };
        let mut body = Body::new(&base, bays, plates, [0.0, 0.0, rigid_m], [0.0, 0.0, gravity]);
        if contact {
            let solid =
                |obstacle: &softlimb_scene::Obstacle| -> Arc<dyn Solid> { Arc::new(Obstacle(obstacle.shape.clone())) };
            body.surround(self.scene.obstacles().iter().map(solid).collect(), balls);
        }
        Ok(body)
    }

    /// Balls along the connector and the tool behind a module, no farther apart than their radius.
    fn rigid_balls(&self, module: &LimbModule, index: usize, plate: usize) -> Vec<Ball> {
        let [connector_m, tool_m] = module.rigid_parts_m();
        let along = |from_m: f64, length_m: f64, radius_m: f64| {
            let count = if length_m > 0.0 { (length_m / radius_m.max(LEAST_BALL_M)).ceil() as usize } else { 0 };
            let place_m = move |step: usize| [0.0, 0.0, from_m + length_m * step as f64 / count as f64];
            (1..=count).map(move |step| Ball { plate, place_m: place_m(step), radius_m })
        };
        let tool_radius_m = self.plant.limb().end_effector.as_ref().map_or(0.0, |tool| tool.radius_m);
        let tool_m = if index + 1 == self.limb.modules().len() { tool_m } else { 0.0 };
        along(0.0, connector_m, rest_radius_m(module)).chain(along(connector_m, tool_m, tool_radius_m)).collect()
    }

    /// Mass of a module's true walls, kg.
    fn wall_kg(&self, module: usize, truth: &Truth) -> f64 {
        let channels = self.limb.modules()[module].channels.clone();
        let wall_m3 = |channel: usize| {
            let actuator = &truth.channels[channel].parameters.actuator;
            let (inner, outer) = (actuator.inner_radius_m, actuator.outer_radius_m);
            std::f64::consts::PI * (outer - inner) * (outer + inner) * actuator.length_m
        };
        channels.map(wall_m3).sum::<f64>() * self.plant.modules()[module].density_kg_per_m3
    }

    /// Connector and tool behind a module.
    fn rigid_masses(&self, module: &LimbModule, index: usize) -> Vec<Mass> {
        let [connector_m, tool_m] = module.rigid_parts_m();
        let limb = self.plant.limb();
        let solid = |middle_m: f64, kg: f64, length_m: f64, radius_m: f64| {
            if self.effects.swing { cylinder(middle_m, kg, length_m, radius_m) } else { vec![on_axis(middle_m, kg)] }
        };
        let radius_m = rest_radius_m(module);
        let mut masses = solid(0.5 * connector_m, limb.connector_mass_kg, connector_m, radius_m);
        if let Some(tool) = limb.end_effector.as_ref().filter(|_| index + 1 == self.limb.modules().len()) {
            masses.extend(solid(connector_m + 0.5 * tool_m, tool.mass_kg, tool_m, tool.radius_m));
        }
        masses
    }

    /// Mass of tubes and spacers at a height of a plate: on the axis, or with its inertia against turns where the limb swings.
    fn section_masses(&self, module: &LimbModule, height_m: f64, kg: f64) -> Vec<Mass> {
        if !self.effects.swing {
            return vec![on_axis(height_m, kg)];
        }
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), module.mount_angle_rad());
        let parameters = module.actuator.parameters();
        // Four points have the moments of inertia of a ring, and that the one of a tube.
        let ring_m = (0.5 * (parameters.inner_radius_m.powi(2) + parameters.outer_radius_m.powi(2))).sqrt();
        let places = module.positions_m();
        let own_kg = 0.25 * kg / places.len() as f64;
        let around = [[ring_m, 0.0], [-ring_m, 0.0], [0.0, ring_m], [0.0, -ring_m]];
        let of_tube = |[x, y]: [f64; 2]| {
            around.map(|[dx, dy]| Mass { place_m: (turn * Vector3::new(x + dx, y + dy, height_m)).into(), kg: own_kg })
        };
        places.into_iter().flat_map(of_tube).collect()
    }

    /// Shape and deformations of the body as it is.
    fn seen(&self, body: &Body, free: &[State<f64>]) -> Hung {
        let base = body.base();
        let poses: Vec<Isometry3<f64>> = std::iter::once(base).chain(body.poses()).collect();
        let mut solid = collision::Body::new(&base);
        let (mut values, mut rigid_m, mut bay) = (Vec::new(), 0.0, 0);
        let pieces = self.limb.modules().iter().map(LimbModule::bays).max().unwrap_or(1);
        for (index, module) in self.limb.modules().iter().enumerate() {
            let radius_m = rest_radius_m(module);
            let mut strains: Vec<Vec<TubeStrain>> = Vec::new();
            let mut twist_rad = 0.0;
            for between in 0..module.bays() {
                let lift = if strains.is_empty() { rigid_m } else { 0.0 };
                let across = Translation3::new(0.0, 0.0, -lift) * (poses[bay].inverse() * poses[bay + 1]);
                let (turn, shift) = screw(&across);
                // A body for viewers has as many pieces in each module.
                let [before, after] = [between, between + 1].map(|bays| bays * pieces / module.bays());
                let share = 1.0 / (after - before) as f64;
                (before..after).for_each(|_| solid.screw(&(turn * share), &(shift * share), radius_m));
                twist_rad += turn.z;
                strains.push(body.strains(bay));
                bay += 1;
            }
            values.extend(self.limb.drives_of(index).map(|index| {
                let drive = self.limb.drive(index);
                value(&drive, &strains, twist_rad).unwrap_or_else(|| drive.measure(&free[index]))
            }));
            let [connector_m, tool_m] = module.rigid_parts_m();
            solid.rigid(connector_m, radius_m);
            solid.rigid(tool_m, self.plant.limb().end_effector.as_ref().map_or(0.0, |tool| tool.radius_m));
            rigid_m = module.rigid_length_m();
        }
        let ends = solid.pieces().iter().map(|piece| piece.point_m(1.0).into());
        let line_m = std::iter::once(base.translation.vector.into()).chain(ends).collect();
        Hung { tip_m: body.tip_m(), values, line_m, body: solid }
    }
}

/// Radius of a module without pressure, m.
fn rest_radius_m(module: &LimbModule) -> f64 {
    module.radius_m(&module.curve.states()[0])
}

fn on_axis(height_m: f64, kg: f64) -> Mass {
    Mass { place_m: [0.0, 0.0, height_m], kg }
}

/// Six points with mass, middle and moments of inertia of a full cylinder about the axis.
fn cylinder(middle_m: f64, kg: f64, length_m: f64, radius_m: f64) -> Vec<Mass> {
    let (side_m, end_m) = (0.75_f64.sqrt() * radius_m, 0.5 * length_m);
    let places = [
        [side_m, 0.0, 0.0],
        [-side_m, 0.0, 0.0],
        [0.0, side_m, 0.0],
        [0.0, -side_m, 0.0],
        [0.0, 0.0, end_m],
        [0.0, 0.0, -end_m],
    ];
    places.map(|[x, y, z]| Mass { place_m: [x, y, middle_m + z], kg: kg / 6.0 }).to_vec()
}

/// Beams of a tube between two of a module's plates.
fn beams(module: &LimbModule, law: &Law, bays: usize) -> usize {
    let [deformation, _] = law.elastic.end();
    let angle = deformation * module.bay_m();
    let needed = match module.motion {
        Motion::Extension | Motion::Expansion => 1.0,
        Motion::Bending => (angle / BEND_RAD).ceil(),
        Motion::Twisting => (angle / TWIST_RAD).ceil(),
    };
    (needed.max(1.0) as usize).max(if bays == 1 { LONE_BEAMS } else { 1 })
}

/// Setpoint value of a drive by the strains of its tubes in each bay of its module; `None` of a quantity that no strain tells.
fn value(drive: &Drive<'_>, strains: &[Vec<TubeStrain>], twist_rad: f64) -> Option<f64> {
    let own = || strains.iter().flatten().filter(|strain| drive.channels.contains(&strain.channel));
    let mean = |value: fn(&TubeStrain) -> f64| own().map(value).sum::<f64>() / own().count().max(1) as f64;
    match drive.kind {
        StateQuantity::AxialStretch => Some(mean(|strain| strain.stretch)),
        StateQuantity::BendAngle => Some(mean(|strain| strain.bend_rad_per_m[0]) * drive.length_m()),
        StateQuantity::Twist => Some(twist_rad),
        StateQuantity::Pressure | StateQuantity::OuterRadius | StateQuantity::InnerRadius => None,
    }
}

/// Turn and shift whose exponential is a pose.
fn screw(pose: &Isometry3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let turn = pose.rotation.scaled_axis();
    let angle = turn.norm();
    let square = if angle < 1e-4 {
        1.0 / 12.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half / half.tan()) / (angle * angle)
    };
    let cross = turn.cross_matrix();
    let inverse = Matrix3::identity() - cross * 0.5 + cross * cross * square;
    (turn, inverse * pose.translation.vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_cylinder_have_its_inertia() {
        let (kg, length_m, radius_m) = (0.3, 0.12, 0.05);
        let masses = cylinder(0.4, kg, length_m, radius_m);
        let sum =
            |value: &dyn Fn([f64; 3]) -> f64| masses.iter().map(|mass| mass.kg * value(mass.place_m)).sum::<f64>();
        assert!((sum(&|_| 1.0) - kg).abs() < 1e-15 && (sum(&|[_, _, z]| z) / kg - 0.4).abs() < 1e-15);
        let about = 0.5 * kg * radius_m * radius_m;
        let across = kg * (length_m * length_m / 12.0 + 0.25 * radius_m * radius_m);
        assert!((sum(&|[x, y, _]| x * x + y * y) - about).abs() < 1e-15);
        assert!((sum(&|[x, _, z]| x * x + (z - 0.4).powi(2)) - across).abs() < 1e-15);
    }

    #[test]
    fn screw_of_a_pose_leads_to_it() {
        for turn in [Vector3::new(0.3, -0.8, 1.1), Vector3::new(1e-6, 0.0, 2e-6), Vector3::zeros()] {
            let pose = Isometry3::new(Vector3::new(0.1, 0.02, 0.3), turn);
            let (turn, shift) = screw(&pose);
            let mut solid = collision::Body::new(&Isometry3::identity());
            solid.screw(&turn, &shift, 0.01);
            let apart = pose.inverse() * solid.end();
            assert!(apart.translation.vector.norm() < 1e-9 && apart.rotation.angle() < 1e-9, "{apart}");
        }
    }
}
