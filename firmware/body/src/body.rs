//! The limb: rigid plates in series, tubes between them, weight.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, SVector, Translation3, UnitQuaternion, Vector3};

use crate::beam::Node;
use crate::contact::{Contacts, Push, Shape};
use crate::motion::Inertia;
use crate::tridiagonal::{Block, Part, Tridiagonal};
use crate::tube::{Condensed, Tube};

/// Last step of an iteration, m and rad: stiffness and stability are those before it.
const SETTLED: f64 = 1e-9;
/// Longest step of an iteration, m and rad.
const LONGEST: f64 = 0.1;
/// The same among solids, which it must not take the limb through, m and rad.
const LONGEST_AMONG_SOLIDS: f64 = 0.02;
const ITERATIONS: u32 = 25;
/// Halvings of a change of pressures and load that does not settle in one go.
const HALVINGS: u32 = 6;

/// A mass fixed to a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Its place in the plate's frame, m.
    pub place_m: [f64; 3],
    /// kg.
    pub kg: f64,
}

/// A rigid part: a spacer, or a connector with what is fixed to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Its masses.
    pub masses: Vec<Mass>,
}

/// The tubes between a plate and the next.
#[derive(Clone, Debug)]
pub struct Bay {
    /// Pose of the upper plate in the frame of the lower one, where the tubes are straight and at rest.
    pub rest: Isometry3<f64>,
    /// The tubes.
    pub tubes: Vec<Tube>,
}

/// Mean strains of a tube in a bay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeStrain {
    /// Index of its pressure.
    pub channel: usize,
    /// Stretch of its axis.
    pub stretch: f64,
    /// Rates of bend towards `x` and `y` of the tube, rad/m.
    pub bend_rad_per_m: [f64; 2],
    /// Rate of twist, rad/m.
    pub twist_rad_per_m: f64,
}

/// The limb has no stable equilibrium near the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fallen;

/// A limb in equilibrium.
#[derive(Clone, Debug)]
pub struct Body {
    base: Node,
    pub(crate) plates: Vec<Plate>,
    bays: Vec<Bay>,
    gravity_m_per_s2: Vector3<f64>,
    /// The end of the limb in the frame of the last plate, where it carries its load.
    pub(crate) tip_m: Vector3<f64>,
    pub(crate) nodes: Vec<Node>,
    /// Pressures and load of the last equilibrium, or instant.
    pub(crate) pressures_pa: Vec<f64>,
    pub(crate) load: Load,
    pub(crate) contacts: Contacts,
}

/// What acts on the limb from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// Share of the weight of the limb.
    pub(crate) weight: f64,
    pub(crate) payload_kg: f64,
    pub(crate) tip_force_n: Vector3<f64>,
}

impl Load {
    pub(crate) fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + (b - a) * share;
        Self {
            weight: mix(self.weight, other.weight),
            payload_kg: mix(self.payload_kg, other.payload_kg),
            tip_force_n: self.tip_force_n.lerp(&other.tip_force_n, share),
        }
    }
}

impl Body {
    /// A straight limb, not yet loaded, on a fixed base. Each bay ends at the plate of the same index; the load acts on `tip_m` of the last.
    ///
    /// # Panics
    /// When there is no plate, or not a bay for each.
    pub fn new(
        base: &Isometry3<f64>,
        bays: Vec<Bay>,
        plates: Vec<Plate>,
        tip_m: [f64; 3],
        gravity_m_per_s2: [f64; 3],
    ) -> Self {
        assert!(!plates.is_empty() && plates.len() == bays.len(), "a bay a plate");
        let channels = bays.iter().flat_map(|bay| &bay.tubes).map(|tube| tube.channel() + 1).max().unwrap_or(0);
        let mut body = Self {
            base: node(base),
            plates,
            nodes: Vec::new(),
            bays,
            gravity_m_per_s2: Vector3::from(gravity_m_per_s2),
            tip_m: Vector3::from(tip_m),
            pressures_pa: vec![0.0; channels],
            load: Load { weight: 0.0, payload_kg: 0.0, tip_force_n: Vector3::zeros() },
            contacts: Contacts::default(),
        };
        let mut at = *base;
        for bay in &body.bays {
            at *= bay.rest;
            body.nodes.push(node(&at));
        }
        for index in 0..body.bays.len() {
            let ends = [*body.below(index), body.nodes[index]];
            body.bays[index].tubes.iter_mut().for_each(|tube| tube.straighten([&ends[0], &ends[1]]));
        }
        body
    }

    fn below(&self, bay: usize) -> &Node {
        bay.checked_sub(1).map_or(&self.base, |below| &self.nodes[below])
    }

    /// Takes the limb to its equilibrium at pressures, one a channel, with a mass at its tip, `span_s` after the last instant.
    ///
    /// # Errors
    /// [`Fallen`] where there is no stable one near the last; the limb must not be used afterwards.
    pub fn settle(&mut self, pressures_pa: &[f64], payload_kg: f64, span_s: f64) -> Result<(), Fallen> {
        self.settle_under(pressures_pa, payload_kg, [0.0; 3], span_s)
    }

    /// [`settle`](Self::settle) with a force on the tip, N, in space.
    ///
    /// # Errors
    /// As there.
    pub fn settle_under(
        &mut self,
        pressures_pa: &[f64],
        payload_kg: f64,
        tip_force_n: [f64; 3],
        span_s: f64,
    ) -> Result<(), Fallen> {
        let load = Load { weight: 1.0, payload_kg, tip_force_n: Vector3::from(tip_force_n) };
        self.approach(pressures_pa, &load, span_s, HALVINGS)
    }

    fn approach(&mut self, pressures_pa: &[f64], load: &Load, span_s: f64, halvings: u32) -> Result<(), Fallen> {
        let before = self.clone();
        if self.iterate(pressures_pa, load, span_s, None) {
            (self.pressures_pa, self.load) = (pressures_pa.to_vec(), *load);
            self.remember(span_s);
            return Ok(());
        }
        *self = before;
        let halvings = halvings.checked_sub(1).ok_or(Fallen)?;
        let half = self.halfway(pressures_pa);
        let halfway = self.load.between(load, 0.5);
        self.approach(&half, &halfway, 0.5 * span_s, halvings)?;
        self.approach(pressures_pa, load, 0.5 * span_s, halvings)
    }

    /// Pressures halfway from the last ones to others.
    pub(crate) fn halfway(&self, pressures_pa: &[f64]) -> Vec<f64> {
        self.pressures_pa.iter().zip(pressures_pa).map(|(a, b)| 0.5 * (a + b)).collect()
    }

    /// Its tubes remember their shapes, `span_s` after the last instant.
    pub(crate) fn remember(&mut self, span_s: f64) {
        for index in 0..self.bays.len() {
            let ends = [*self.below(index), self.nodes[index]];
            let pressures_pa = &self.pressures_pa;
            self.bays[index]
                .tubes
                .iter_mut()
                .for_each(|tube| tube.remember([&ends[0], &ends[1]], pressures_pa, span_s));
        }
        let tip = self.tip();
        self.contacts.remember(Shape { nodes: &self.nodes, tip, inertia: None });
    }

    /// Index of the plate that carries the load, and the place of the load in its frame.
    pub(crate) fn tip(&self) -> (usize, Vector3<f64>) {
        (self.nodes.len() - 1, self.tip_m)
    }

    /// Moves all nodes as far beyond their places as they have come since `start`.
    pub(crate) fn go_on(&mut self, start: &Self) {
        self.nodes.iter_mut().zip(&start.nodes).for_each(|(node, was)| *node = was.beyond(node));
        for (bay, was) in self.bays.iter_mut().zip(&start.bays) {
            bay.tubes.iter_mut().zip(&was.tubes).for_each(|(tube, was)| tube.go_on(was));
        }
    }

    /// Newton's method; whether it has found a stable equilibrium, or the next shape of a limb with inertia.
    pub(crate) fn iterate(
        &mut self,
        pressures_pa: &[f64],
        load: &Load,
        span_s: f64,
        inertia: Option<&Inertia>,
    ) -> bool {
        let most = if self.contacts.is_empty() { LONGEST } else { LONGEST_AMONG_SOLIDS };
        self.contacts.begin();
        for _ in 0..ITERATIONS {
            let tip = self.tip();
            self.contacts.hold(Shape { nodes: &self.nodes, tip, inertia });
            let Some((matrix, residual, tubes)) = self.system(pressures_pa, load, span_s, inertia) else {
                return false;
            };
            let Some(steps) = matrix.solve(&residual) else { return false };
            let longest = steps.iter().map(|step| step.amax()).fold(0.0, f64::max);
            if !longest.is_finite() {
                return false;
            }
            let scale = (most / longest).min(1.0);
            let mut tubes = tubes.into_iter();
            for (index, bay) in self.bays.iter_mut().enumerate() {
                let mut ends = SVector::<f64, 12>::zeros();
                if let Some(below) = index.checked_sub(1) {
                    ends.fixed_rows_mut::<6>(0).copy_from(&steps[below]);
                }
                ends.fixed_rows_mut::<6>(6).copy_from(&steps[index]);
                for (tube, condensed) in bay.tubes.iter_mut().zip(&mut tubes) {
                    tube.follow(&condensed, &ends, scale);
                }
            }
            for (node, step) in self.nodes.iter_mut().zip(&steps) {
                *node = node.moved(&(step * scale));
            }
            if longest < SETTLED && !self.contacts.release(Shape { nodes: &self.nodes, tip, inertia }) {
                return matrix.is_positive();
            }
        }
        false
    }

    /// Stiffness of the limb and the forces that are not balanced, with all tubes in order.
    fn system(
        &self,
        pressures_pa: &[f64],
        load: &Load,
        span_s: f64,
        inertia: Option<&Inertia>,
    ) -> Option<(Tridiagonal, Vec<Part>, Vec<Condensed>)> {
        let mut matrix = Tridiagonal::zeros(self.nodes.len());
        let mut residual = vec![Part::zeros(); self.nodes.len()];
        let mut tubes = Vec::new();
        for (index, bay) in self.bays.iter().enumerate() {
            let ends = [self.below(index), &self.nodes[index]];
            for tube in &bay.tubes {
                let condensed = tube.condensed(ends, pressures_pa, span_s)?;
                let (forces, slopes) = (&condensed.forces, &condensed.stiffness);
                let block =
                    |row: usize, column: usize| -> Block { slopes.fixed_view::<6, 6>(row, column).into_owned() };
                residual[index] -= forces.fixed_rows::<6>(6);
                matrix.diagonal[index] += block(6, 6);
                if let Some(below) = index.checked_sub(1) {
                    residual[below] -= forces.fixed_rows::<6>(0);
                    matrix.diagonal[below] += block(0, 0);
                    matrix.above[below] += block(0, 6);
                    matrix.below[below] += block(6, 0);
                }
                tubes.push(condensed);
            }
        }
        for (index, (node, plate)) in self.nodes.iter().zip(&self.plates).enumerate() {
            let mut push = |place_m: Vector3<f64>, kg: f64, mut force_n: Vector3<f64>| {
                let arm = node.turn * place_m;
                if let Some(inertia) = inertia {
                    let (inertial_n, slope, by_turn) = inertia.force(index, &place_m, node, kg);
                    force_n += inertial_n;
                    let (cross, diagonal) = (arm.cross_matrix(), &mut matrix.diagonal[index]);
                    let mut add = |row: usize, column: usize, block: Matrix3<f64>| {
                        let mut view = diagonal.fixed_view_mut::<3, 3>(row, column);
                        view += block * slope;
                    };
                    add(0, 0, Matrix3::identity());
                    add(0, 3, by_turn);
                    add(3, 0, cross);
                    add(3, 3, cross * by_turn);
                }
                let moment = arm.cross(&force_n);
                residual[index] += Part::new(force_n.x, force_n.y, force_n.z, moment.x, moment.y, moment.z);
                let mut turning = matrix.diagonal[index].fixed_view_mut::<3, 3>(3, 3);
                turning -= force_n.cross_matrix() * arm.cross_matrix();
            };
            for mass in &plate.masses {
                push(Vector3::from(mass.place_m), mass.kg, self.gravity_m_per_s2 * (load.weight * mass.kg));
            }
            if index + 1 == self.nodes.len() {
                push(self.tip_m, load.payload_kg, self.gravity_m_per_s2 * load.payload_kg + load.tip_force_n);
            }
        }
        for Push { plate, arm_m, force_n, settled_n, stiffness } in self.contacts.pushes(self.shape(inertia)) {
            let moment = arm_m.cross(&force_n);
            residual[plate] += Part::new(force_n.x, force_n.y, force_n.z, moment.x, moment.y, moment.z);
            let (cross, diagonal) = (arm_m.cross_matrix(), &mut matrix.diagonal[plate]);
            let mut add = |row: usize, column: usize, block: Matrix3<f64>| {
                let mut view = diagonal.fixed_view_mut::<3, 3>(row, column);
                view += block;
            };
            add(0, 0, stiffness);
            add(0, 3, -stiffness * cross);
            add(3, 0, cross * stiffness);
            add(3, 3, -cross * stiffness * cross - settled_n.cross_matrix() * cross);
        }
        Some((matrix, residual, tubes))
    }

    /// Pose of the base.
    pub fn base(&self) -> Isometry3<f64> {
        pose(&self.base)
    }

    /// Poses of the plates.
    pub fn poses(&self) -> impl Iterator<Item = Isometry3<f64>> + '_ {
        self.nodes.iter().map(pose)
    }

    /// The tip, m.
    pub fn tip_m(&self) -> [f64; 3] {
        let last = self.nodes.last().map_or(Isometry3::identity(), pose);
        (last * Point3::from(self.tip_m)).coords.into()
    }

    /// Mean strains of the tubes of a bay.
    pub fn strains(&self, bay: usize) -> Vec<TubeStrain> {
        let ends = [self.below(bay), &self.nodes[bay]];
        let mean = |tube: &Tube| {
            let strains = tube.strains(ends);
            let mean = |value: &dyn Fn(&crate::beam::Strain) -> f64| {
                strains.iter().map(value).sum::<f64>() / strains.len() as f64
            };
            TubeStrain {
                channel: tube.channel(),
                stretch: mean(&|strain| strain.stretch),
                bend_rad_per_m: [0, 1].map(|axis: usize| mean(&|strain| strain.bend_rad_per_m[axis])),
                twist_rad_per_m: mean(&|strain| strain.twist_rad_per_m),
            }
        };
        self.bays[bay].tubes.iter().map(mean).collect()
    }
}

fn node(pose: &Isometry3<f64>) -> Node {
    Node { place: pose.translation.vector, turn: *pose.rotation.to_rotation_matrix().matrix() }
}

fn pose(node: &Node) -> Isometry3<f64> {
    let turn: Matrix3<f64> = node.turn;
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    Isometry3::from_parts(Translation3::from(node.place), turn)
}
