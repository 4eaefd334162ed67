//! Contact: solids that stop the limb, with friction.
//!
//! The limb touches with balls: fixed to its plates, or of an object that hangs upright from its tip. A ball that is `depth` deep in a solid is
//! pushed out by `stiffness (depth + T d(depth)/dt)`, never pulled. `T` brakes an approach and takes the energy of an impact; forces of an
//! impact are therefore not predicted. In the midpoint rule's step, contact acts as at the end of the step: its oscillations are too fast for
//! the middle.
//!
//! Friction is a spring along the surface that slides where its force exceeds the friction of the normal force of the last instant: a limb at
//! rest does not creep.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use crate::beam::Node;
use crate::body::Body;
use crate::motion::Inertia;

/// Stiffness of a solid's surface, N/m: it gives by 1 um/N.
const STIFFNESS_N_PER_M: f64 = 1e6;
/// Stiffness of the surface along itself, N/m: two thirds, as of spheres of an incompressible elastomer (R. D. Mindlin 1949).
const SPRING_N_PER_M: f64 = 2.0 / 3.0 * STIFFNESS_N_PER_M;
/// Coefficient of friction. Assumed: cast silicone or a printed part on a table.
const FRICTION: f64 = 0.5;
/// Time over which an approach is braked, s.
pub(crate) const BRAKING_S: f64 = 1e-3;
/// Gap of a contact within which a limb counts as near, m, however slow it is.
const NEAR_M: f64 = 0.02;
/// Largest ratio of a trial normal force to that of the last instant with which the force counts in the stiffness.
const SETTLED: f64 = 2.0;
/// Share of a limit within which a force is that limit.
const ROUNDING: f64 = 1e-9;
/// Step of the difference that gives the curvature of a surface, m.
const STEP_M: f64 = 1e-7;

/// A solid that stops the limb.
pub trait Solid: Debug + Send + Sync {
    /// Distance of a point from its surface, m, negative inside, and the unit vector along which it grows fastest.
    fn distance(&self, point_m: &Vector3<f64>) -> (f64, Vector3<f64>);
}

/// A ball that is fixed to a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Index of its plate.
    pub plate: usize,
    /// Its center in the plate's frame, m.
    pub place_m: [f64; 3],
    /// Its radius, m; 0 for a point.
    pub radius_m: f64,
}

/// An object that hangs upright from the tip: a capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hanging {
    /// Its height above the tip, m.
    pub above_m: f64,
    /// Its height below the tip, m.
    pub below_m: f64,
    /// Its radius, m.
    pub radius_m: f64,
}

/// Force of a solid on the limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Index of the solid.
    pub solid: usize,
    /// Force on the limb and what it carries, N, in space; without that which brakes an approach.
    pub force_n: [f64; 3],
    /// Whether it acts on the carried object alone.
    pub carried: bool,
}

/// Solids, the balls of the limb, and the springs of friction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contacts {
    solids: Arc<[Arc<dyn Solid>]>,
    balls: Arc<[Ball]>,
    /// The balls of the carried object.
    carried: Vec<Carried>,
    /// Frictions of the last instant.
    sticking: Vec<Sticking>,
    /// Balls and solids that count as touching while an equilibrium is sought. They may pull until it is found: a contact that comes and goes
    /// with every iteration has none.
    held: Vec<(usize, usize)>,
}

/// A ball below or above the tip.
#[derive(Clone, Copy, Debug)]
struct Carried {
    up_m: f64,
    radius_m: f64,
}

/// Friction of a ball on a solid.
#[derive(Clone, Copy, Debug)]
struct Sticking {
    /// Indices of ball and solid.
    pair: (usize, usize),
    /// Normal force of the last instant, N.
    normal_n: f64,
    /// Strain of the spring along the surface, m.
    spring_m: Vector3<f64>,
    /// The point that touched at the last instant: from the origin of its plate, in the frame of the plate, and in space, m.
    own_m: Vector3<f64>,
    point_m: Vector3<f64>,
}

/// A ball on the limb as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) plate: usize,
    /// Its point of suspension from the origin of the plate, in the frame of the plate, m.
    place_m: Vector3<f64>,
    /// From there to its center, in space, m.
    offset_m: Vector3<f64>,
    radius_m: f64,
    /// Whether it is of the carried object.
    hangs: bool,
}

impl Placed {
    fn center_m(&self, node: &Node) -> Vector3<f64> {
        node.place + node.turn * self.place_m + self.offset_m
    }

    /// The point that carries a force of the surface with a normal: on the ball, or where an object hangs.
    fn own_m(&self, node: &Node, normal: &Vector3<f64>) -> Vector3<f64> {
        if self.hangs { self.place_m } else { self.place_m - node.turn.tr_mul(normal) * self.radius_m }
    }
}

/// A force of contact on a plate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub(crate) plate: usize,
    /// From the origin of the plate to where it acts, in space, m.
    pub(crate) arm_m: Vector3<f64>,
    pub(crate) force_n: Vector3<f64>,
    /// The part of it whose change by turns counts, N.
    pub(crate) settled_n: Vector3<f64>,
    /// Its decrease by a shift of that point, N/m; symmetric.
    pub(crate) stiffness: Matrix3<f64>,
}

/// How a point moves in the step that is solved: its shift and velocity at the end, and their change by a shift now.
struct Ahead {
    shift_m: Vector3<f64>,
    velocity_m_per_s: Vector3<f64>,
    by_shift: [f64; 2],
}

impl Contacts {
    fn new(solids: Vec<Arc<dyn Solid>>, balls: Vec<Ball>) -> Self {
        Self { solids: solids.into(), balls: balls.into(), ..Self::default() }
    }

    /// Whether nothing can touch the limb.
    pub(crate) fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    fn placed<'a>(&'a self, tip: (usize, Vector3<f64>)) -> impl Iterator<Item = Placed> + 'a {
        let own = self.balls.iter().map(|ball| Placed {
            plate: ball.plate,
            place_m: Vector3::from(ball.place_m),
            offset_m: Vector3::zeros(),
            radius_m: ball.radius_m,
            hangs: false,
        });
        let carried = self.carried.iter().map(move |ball| Placed {
            plate: tip.0,
            place_m: tip.1,
            offset_m: Vector3::z() * ball.up_m,
            radius_m: ball.radius_m,
            hangs: true,
        });
        own.chain(carried)
    }

    /// Begins with the contacts of the last instant.
    pub(crate) fn begin(&mut self) {
        self.held = self.sticking.iter().map(|known| known.pair).collect();
    }

    /// Adds the balls that are in a solid.
    pub(crate) fn hold(&mut self, shape: Shape<'_>) {
        let deep = |(pair, ball, solid): (_, Placed, &dyn Solid)| {
            (shape.deep_m(&ball, solid) > 0.0 && !self.held.contains(&pair)).then_some(pair)
        };
        let deep: Vec<_> = self.pairs(shape.tip).filter_map(deep).collect();
        self.held.extend(deep);
    }

    /// Drops the contacts that pull; whether there were any.
    pub(crate) fn release(&mut self, shape: Shape<'_>) -> bool {
        let pulls = |(pair, ball, solid): (_, Placed, &dyn Solid)| (shape.deep_m(&ball, solid) <= 0.0).then_some(pair);
        let pulling: Vec<_> = self.pairs(shape.tip).filter_map(pulls).collect();
        let before = self.held.len();
        self.held.retain(|pair| !pulling.contains(pair));
        self.held.len() < before
    }

    /// Every ball with every solid.
    fn pairs(&self, tip: (usize, Vector3<f64>)) -> impl Iterator<Item = ((usize, usize), Placed, &dyn Solid)> + '_ {
        let of = move |(index, ball): (usize, Placed)| {
            let solids = self.solids.iter().enumerate();
            solids.map(move |(number, solid)| ((index, number), ball, solid.as_ref()))
        };
        self.placed(tip).enumerate().flat_map(of)
    }

    /// Forces on the plates.
    pub(crate) fn pushes(&self, shape: Shape<'_>) -> Vec<Push> {
        let held = self.pairs(shape.tip).filter(|(pair, ..)| self.held.contains(pair));
        let push = |(pair, ball, solid): (_, Placed, &dyn Solid)| {
            shape.push(&ball, solid, self.sticking.iter().find(|known| known.pair == pair))
        };
        held.map(push).collect()
    }

    /// Keeps the frictions of the shape that has been reached.
    pub(crate) fn remember(&mut self, shape: Shape<'_>) {
        let stick = |(pair, ball, solid): (_, Placed, &dyn Solid)| {
            let node = shape.node(&ball);
            let (distance_m, normal) = solid.distance(&ball.center_m(node));
            let normal_n = STIFFNESS_N_PER_M * (ball.radius_m - distance_m);
            if normal_n <= 0.0 {
                return None;
            }
            let own_m = ball.own_m(node, &normal);
            let before = self.sticking.iter().find(|known| known.pair == pair);
            let strained = |known: &Sticking| along(&(known.spring_m + shift_m(known, node)), &normal);
            let strain_m = before.map_or_else(Vector3::zeros, strained);
            let longest_m = FRICTION * normal_n.min(before.map_or(0.0, |known| known.normal_n)) / SPRING_N_PER_M;
            let spring_m = if strain_m.norm() > longest_m { strain_m.normalize() * longest_m } else { strain_m };
            Some(Sticking { pair, normal_n, spring_m, own_m, point_m: node.place + node.turn * own_m })
        };
        self.sticking = self.pairs(shape.tip).filter_map(stick).collect();
    }

    /// Forces of the solids that are touched, as the shape is.
    fn forces(&self, shape: Shape<'_>) -> Vec<Contact> {
        let balls: Vec<Placed> = self.placed(shape.tip).collect();
        let of = |solid: usize| {
            let touched = self.sticking.iter().filter(move |known| known.pair.1 == solid);
            let carried = touched.clone().all(|known| known.pair.0 >= self.balls.len());
            let force = |known: &Sticking| {
                let ball = balls.get(known.pair.0)?;
                let (_, normal) = self.solids[solid].distance(&ball.center_m(shape.node(ball)));
                Some(normal * known.normal_n - known.spring_m * SPRING_N_PER_M)
            };
            let force_n: [f64; 3] = touched.filter_map(force).reduce(|a, b| a + b)?.into();
            Some(Contact { solid, force_n, carried })
        };
        (0..self.solids.len()).filter_map(of).collect()
    }
}

/// Shift of the point that touched since the last instant, m.
fn shift_m(known: &Sticking, node: &Node) -> Vector3<f64> {
    node.place + node.turn * known.own_m - known.point_m
}

/// The part along a surface.
fn along(vector: &Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    vector - normal * normal.dot(vector)
}

/// The limb as it is, in a step of the midpoint rule where there is inertia.
#[derive(Clone, Copy)]
pub(crate) struct Shape<'a> {
    pub(crate) nodes: &'a [Node],
    pub(crate) tip: (usize, Vector3<f64>),
    pub(crate) inertia: Option<&'a Inertia>,
}

impl Shape<'_> {
    fn node(&self, ball: &Placed) -> &Node {
        &self.nodes[ball.plate]
    }

    /// How a point of a ball's plate goes on.
    fn ahead(&self, ball: &Placed, point_m: Vector3<f64>) -> Ahead {
        let Some(inertia) = self.inertia else {
            return Ahead { shift_m: Vector3::zeros(), velocity_m_per_s: Vector3::zeros(), by_shift: [1.0, 0.0] };
        };
        let node = self.node(ball);
        let [shift_m, velocity_m_per_s] = inertia.ahead(ball.plate, &(point_m - node.place), node);
        Ahead { shift_m, velocity_m_per_s, by_shift: inertia.ahead_by_shift() }
    }

    /// How a ball's center goes on, where that is at the end, and the normal of a solid and how deep the ball is in it there.
    fn end(&self, ball: &Placed, solid: &dyn Solid) -> (Ahead, Vector3<f64>, Vector3<f64>, f64) {
        let center_m = ball.center_m(self.node(ball));
        let end = self.ahead(ball, center_m - ball.offset_m);
        let at_m = center_m + end.shift_m;
        let (distance_m, normal) = solid.distance(&at_m);
        let deep_m = ball.radius_m - distance_m - BRAKING_S * normal.dot(&end.velocity_m_per_s);
        (end, at_m, normal, deep_m)
    }

    fn deep_m(&self, ball: &Placed, solid: &dyn Solid) -> f64 {
        self.end(ball, solid).3
    }

    fn push(&self, ball: &Placed, solid: &dyn Solid, sticking: Option<&Sticking>) -> Push {
        let (end, at_m, normal, deep_m) = self.end(ball, solid);
        let node = self.node(ball);
        let normal_n = STIFFNESS_N_PER_M * deep_m;
        let by_shift = end.by_shift[0] + BRAKING_S * end.by_shift[1];
        let curvature = Matrix3::from_fn(|row, column| {
            let moved = solid.distance(&(at_m + Vector3::ith(column, STEP_M))).1;
            (moved[row] - normal[row]) / STEP_M
        });
        let mut force_n = normal * normal_n;
        let mut stiffness = normal * normal.transpose() * (STIFFNESS_N_PER_M * by_shift);
        // A force that is not yet balanced may be a hundred times the true one: it must not decide how stiff the limb is.
        let settled = match sticking {
            Some(known) if normal_n > 0.0 => (SETTLED * known.normal_n / normal_n).min(1.0),
            _ => 0.0,
        };
        stiffness -= (curvature + curvature.transpose()) * (0.5 * settled * normal_n * end.by_shift[0]);
        if let Some(known) = sticking {
            let limit_n = FRICTION * known.normal_n;
            let end = self.ahead(ball, node.place + node.turn * known.own_m);
            let strain_m = known.spring_m + shift_m(known, node) + end.shift_m + end.velocity_m_per_s * BRAKING_S;
            let strain_m = along(&strain_m, &normal);
            let (length_m, plane) = (strain_m.norm(), Matrix3::identity() - normal * normal.transpose());
            // A spring that has just slid is stretched to its limit, where it may go back.
            if SPRING_N_PER_M * length_m <= limit_n * (1.0 + ROUNDING) {
                force_n -= strain_m * SPRING_N_PER_M;
                stiffness += plane * (SPRING_N_PER_M * by_shift);
            } else {
                let way = strain_m / length_m;
                force_n -= way * limit_n;
                stiffness += (plane - way * way.transpose()) * (limit_n / length_m * by_shift);
            }
        }
        let arm_m = node.turn * ball.own_m(node, &normal);
        Push { plate: ball.plate, arm_m, force_n, settled_n: force_n * settled, stiffness }
    }
}

impl Body {
    /// Solids that stop the limb from now on, and the balls with which it touches them.
    ///
    /// # Panics
    /// When there is no plate of a ball's index.
    pub fn surround(&mut self, solids: Vec<Arc<dyn Solid>>, balls: Vec<Ball>) {
        assert!(balls.iter().all(|ball| ball.plate < self.nodes.len()), "a ball is fixed to a plate");
        self.contacts = Contacts::new(solids, balls);
    }

    /// Hangs an object at the tip, or takes it away. An object that would stand in a solid is grasped higher, so that it stands on it.
    pub fn carry(&mut self, object: Option<Hanging>) {
        let Some(object) = object else {
            self.contacts.carried.clear();
            return;
        };
        if !self.contacts.carried.is_empty() {
            return;
        }
        let Hanging { above_m, below_m, radius_m } = object;
        let middle_m = 0.5 * (above_m - below_m);
        let ends_m = [(above_m - radius_m).max(middle_m), (radius_m - below_m).min(middle_m)];
        self.contacts.carried = ends_m.map(|up_m| Carried { up_m, radius_m }).to_vec();
        let tip = self.tip();
        let node = self.nodes[tip.0];
        let balls = self.contacts.placed(tip).skip(self.contacts.balls.len());
        let above_m = |center_m: &Vector3<f64>, radius_m: f64| {
            let deep = self.contacts.solids.iter().map(|solid| {
                let (distance_m, normal) = solid.distance(center_m);
                // A wall beside an object does not lift it.
                if normal.z > 0.5 { (radius_m - distance_m) / normal.z } else { 0.0 }
            });
            deep.fold(0.0, f64::max)
        };
        let lift_m = balls.map(|ball| above_m(&ball.center_m(&node), ball.radius_m)).fold(0.0, f64::max);
        self.contacts.carried.iter_mut().for_each(|ball| ball.up_m += lift_m);
    }

    /// Forces of the solids that limb or object touch.
    pub fn contacts(&self) -> Vec<Contact> {
        self.contacts.forces(self.shape(None))
    }

    pub(crate) fn shape<'a>(&'a self, inertia: Option<&'a Inertia>) -> Shape<'a> {
        Shape { nodes: &self.nodes, tip: self.tip(), inertia }
    }

    /// Whether the limb may come to a solid while it moves by a distance, m.
    pub(crate) fn is_near_solid(&self, way_m: f64) -> bool {
        let contacts = &self.contacts;
        contacts.placed(self.tip()).any(|ball| {
            let center_m = ball.center_m(&self.nodes[ball.plate]);
            contacts.solids.iter().any(|solid| solid.distance(&center_m).0 - ball.radius_m < way_m.max(NEAR_M))
        })
    }
}
