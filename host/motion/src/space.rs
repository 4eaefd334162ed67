//! Moves in the space of setpoints, and the proof that a move keeps the body clear.
//!
//! A move changes all setpoints in proportion, by a share 0 to 1 of the way. A change of a module's length by `dl` and of its screw by `dw`
//! moves no point of the body by more than `|dl| + (l/2 + d) |dw|`, with `l` its length and `d` the length of all that follows it; its
//! surface moves by the growth of its radius more. So where the body clears by `c` more than required at a share, it keeps clear at all
//! shares within `c/v`, `v` being the sum of these speeds. Halving what is left open proves the whole move, or finds where it is blocked.
//!
//! Under load the body at both ends of a stretch says how far its points move on it. Where that, with a margin for the way between, fits into
//! the clearance of both ends the stretch is clear; else it is halved. That is no proof: a body that goes far and comes back within a stretch
//! is not seen.
//!
//! The tilt of a held object is treated like a clearance, with the turn of the tip in place of the way of a point.

use fra_model::{Segment, State};

use super::carrier::Carrier;
use super::inverse_kinematics::Obstruction;
use super::upright::Upright;
use softlimb_limb::LimbModule;
use softlimb_scene::collision::{Body, Piece, Shape, TOLERANCE_M};

/// Speeds are those between nodes of the state curve; between nodes its cubic is this much steeper at most.
const STEEPER: f64 = 1.05;
/// A stretch of a move that is shorter than this share is not divided any more.
const SHORTEST: f64 = 1e-6;
/// Under load, the longest way of a point over the distance of its ends, and the way below which a stretch is not divided any more, m.
const DETOUR: f64 = 1.5;
const FINEST_M: f64 = 1e-5;
/// Under load, the turn of the tip below which a stretch is not divided any more, rad.
const FINEST_RAD: f64 = 1e-5;

/// What setpoints a limb may have among obstacles.
pub(super) struct Space<'a> {
    carrier: Carrier<'a>,
    obstacles: Vec<&'a Shape>,
    required_m: f64,
    /// What the gripper holds upright.
    upright: Option<Upright>,
    /// Cells of each drive's state curve.
    cells: Vec<Vec<Cell>>,
}

/// What a drive does of its module between two nodes of its state curve, per unit of its setpoint.
struct Cell {
    from: f64,
    to: f64,
    length_m: f64,
    stretches_m: f64,
    turns_rad: f64,
    grows_m: f64,
}

/// Bounds of what happens over a whole move: the way of a point of the surface, m, and the turn of the tip, rad.
#[derive(Clone, Copy)]
struct Speeds {
    way_m: f64,
    turn_rad: f64,
}

/// Where a move is blocked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blocked {
    /// Share of the move.
    pub(super) share: f64,
    /// By what.
    pub(super) by: Hindrance,
}

/// What blocks a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Hindrance {
    /// An obstacle is too near.
    Obstacle(Obstruction),
    /// The held object tilts by this, rad.
    Tilt(f64),
    /// The limb has no such shape.
    NoShape,
}

impl<'a> Space<'a> {
    /// The space of a limb that keeps `required_m` from each obstacle.
    pub(super) fn new(carrier: Carrier<'a>, obstacles: Vec<&'a Shape>, required_m: f64) -> Self {
        let cells = carrier.limb().drives().map(|drive| cells(&drive)).collect();
        Self { carrier, obstacles, required_m, upright: None, cells }
    }

    /// The same space with an object that is kept upright.
    pub(super) fn keeping(self, upright: Option<Upright>) -> Self {
        Self { upright: upright.filter(|upright| upright.most_rad().is_finite()), ..self }
    }

    /// The object that is kept upright.
    pub(super) fn upright(&self) -> Option<Upright> {
        self.upright
    }

    /// The tilt of the held object, rad, where that is more than it may be.
    pub(super) fn tilts_rad(&self, body: &Body) -> Option<f64> {
        let upright = self.upright?;
        Some(upright.tilt_rad(&body.end().rotation)).filter(|tilt_rad| *tilt_rad > upright.most_rad())
    }

    /// The same space with another clearance, m.
    pub(super) fn requiring(self, required_m: f64) -> Self {
        Self { required_m, ..self }
    }

    /// The limb with what it carries.
    pub(super) fn carrier(&self) -> &Carrier<'a> {
        &self.carrier
    }

    /// The states at setpoints; `None` where a drive has none.
    pub(super) fn states(&self, values: &[f64]) -> Option<Vec<State<f64>>> {
        self.carrier.limb().drives().zip(values).map(|(drive, value)| drive.state_at(*value)).collect()
    }

    /// The body at setpoints; `None` where the limb has no shape.
    pub(super) fn body(&self, values: &[f64]) -> Option<Body> {
        self.carrier.body_in(&self.states(values)?)
    }

    /// The obstacle nearest to the body where any is nearer than `enough_m`.
    pub(super) fn nearest(&self, body: &Body, enough_m: f64) -> Option<Obstruction> {
        let mut nearest: Option<Obstruction> = None;
        for (obstacle, shape) in self.obstacles.iter().enumerate() {
            let enough_m = nearest.map_or(enough_m, |known| known.clearance.distance_m);
            if let Some(clearance) = body.nearest(shape, enough_m) {
                nearest = Some(Obstruction { obstacle, clearance });
            }
        }
        nearest
    }

    /// Whether the held object might tilt too much where the tip turns by this, rad.
    fn may_tilt(&self, body: &Body, turn_rad: f64) -> bool {
        self.upright.is_some_and(|upright| upright.tilt_rad(&body.end().rotation) + turn_rad > upright.most_rad())
    }

    /// Where the straight move between two rows of setpoints is blocked; `None` when it is proven clear.
    pub(super) fn blocked(&self, from: &[f64], to: &[f64]) -> Option<Blocked> {
        if self.obstacles.is_empty() && self.upright.is_none() {
            return None;
        }
        if self.carrier.is_loaded() {
            let [Some(first), Some(last)] = [from, to].map(|values| self.body(values)) else {
                return Some(Blocked { share: 0.0, by: Hindrance::NoShape });
            };
            return self.blocked_between((from, to), (0.0, &first), (1.0, &last));
        }
        let speeds = self.speeds(from, to);
        self.blocked_within((from, to), (0.5, 0.5), speeds)
    }

    /// Looks between two shares of a move under load, whose bodies these are.
    fn blocked_between(&self, ends: (&[f64], &[f64]), before: (f64, &Body), after: (f64, &Body)) -> Option<Blocked> {
        let way_m = way_m(before.1, after.1);
        let turn_rad = before.1.end().rotation.angle_to(&after.1.end().rotation);
        let enough_m = self.required_m + 0.5 * DETOUR * way_m + TOLERANCE_M;
        let (mut near, mut tilted) = (false, false);
        for (share, body) in [before, after] {
            if let Some(found) = self.nearest(body, enough_m) {
                if found.clearance.distance_m < self.required_m {
                    return Some(Blocked { share, by: Hindrance::Obstacle(found) });
                }
                near = true;
            }
            if let Some(tilt_rad) = self.tilts_rad(body) {
                return Some(Blocked { share, by: Hindrance::Tilt(tilt_rad) });
            }
            tilted |= self.may_tilt(body, 0.5 * DETOUR * turn_rad);
        }
        if !(near && way_m >= FINEST_M || tilted && turn_rad >= FINEST_RAD) {
            return None;
        }
        let share = 0.5 * (before.0 + after.0);
        let Some(middle) = self.body(&between(ends, share)) else {
            return Some(Blocked { share, by: Hindrance::NoShape });
        };
        let first = self.blocked_between(ends, before, (share, &middle));
        first.or_else(|| self.blocked_between(ends, (share, &middle), after))
    }

    /// Looks at the shares `middle - half .. middle + half`.
    fn blocked_within(&self, ends: (&[f64], &[f64]), (middle, half): (f64, f64), speeds: Speeds) -> Option<Blocked> {
        let blocked = |by: Hindrance| Some(Blocked { share: middle, by });
        let Some(body) = self.body(&between(ends, middle)) else { return blocked(Hindrance::NoShape) };
        let found = self.nearest(&body, self.required_m + half * speeds.way_m + TOLERANCE_M);
        let tilted = self.may_tilt(&body, half * speeds.turn_rad);
        match found {
            Some(found) if found.clearance.distance_m < self.required_m || half < SHORTEST => {
                return blocked(Hindrance::Obstacle(found));
            }
            None if !tilted => return None,
            _ => {}
        }
        if let Some(upright) = self.upright.filter(|_| tilted) {
            let tilt_rad = upright.tilt_rad(&body.end().rotation);
            if tilt_rad > upright.most_rad() || half < SHORTEST {
                return blocked(Hindrance::Tilt(tilt_rad));
            }
        }
        let half = 0.5 * half;
        let first = self.blocked_within(ends, (middle - half, half), speeds);
        first.or_else(|| self.blocked_within(ends, (middle + half, half), speeds))
    }

    /// No point of the body's surface moves farther, and the tip does not turn more, than this over the whole move.
    fn speeds(&self, from: &[f64], to: &[f64]) -> Speeds {
        let (mut speed_m, mut behind_m, mut grows_m) = (0.0, 0.0_f64, 0.0_f64);
        let mut turn_rad = 0.0;
        let limb = self.carrier.limb();
        for (index, module) in limb.modules().iter().enumerate().rev() {
            behind_m += module.rigid_parts_m().iter().sum::<f64>();
            let drives: Vec<(f64, Cell)> = limb.drives_of(index).map(|drive| self.touched(drive, from, to)).collect();
            let length = drives.iter().map(|(_, cell)| cell.length_m).fold(0.0, f64::max);
            for (way, cell) in &drives {
                speed_m += way * (cell.stretches_m + (0.5 * length + behind_m) * cell.turns_rad);
                turn_rad += way * cell.turns_rad;
                grows_m = grows_m.max(way * cell.grows_m);
            }
            behind_m += length;
        }
        Speeds { way_m: speed_m + grows_m, turn_rad }
    }

    /// The way of a drive's setpoint, and the most that its module does on it.
    fn touched(&self, drive: usize, from: &[f64], to: &[f64]) -> (f64, Cell) {
        let (low, high) = (from[drive].min(to[drive]), from[drive].max(to[drive]));
        let none = Cell { from: low, to: high, length_m: 0.0, stretches_m: 0.0, turns_rad: 0.0, grows_m: 0.0 };
        let touched = self.cells[drive].iter().filter(|cell| cell.from <= high && cell.to >= low);
        let most = touched.fold(none, |most, cell| Cell {
            length_m: most.length_m.max(cell.length_m),
            stretches_m: most.stretches_m.max(cell.stretches_m),
            turns_rad: most.turns_rad.max(cell.turns_rad),
            grows_m: most.grows_m.max(cell.grows_m),
            ..most
        });
        (STEEPER * (high - low), most)
    }
}

/// The setpoints at a share of a move.
fn between((from, to): (&[f64], &[f64]), share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect()
}

/// The longest way of a point of the surface from one body to another, m.
fn way_m(from: &Body, to: &Body) -> f64 {
    let of_piece = |(a, b): (&Piece, &Piece)| {
        let ways = [0.0, 0.5, 1.0].map(|share| (b.point_m(share) - a.point_m(share)).norm());
        ways.into_iter().fold(0.0, f64::max) + (b.radius_m() - a.radius_m()).abs()
    };
    from.pieces().iter().zip(to.pieces()).map(of_piece).fold(0.0, f64::max)
}

fn cells(module: &LimbModule) -> Vec<Cell> {
    let states = module.curve.states();
    let drives = module.drives() as f64;
    let cell = |pair: &[State<f64>]| {
        let (a, b) = (&pair[0], &pair[1]);
        let (from, to) = (module.measure(a), module.measure(b));
        let pairs: Vec<_> = module.links(a).into_iter().zip(module.links(b)).collect();
        let per = |change: f64| if to == from { 0.0 } else { (change / (to - from)).abs() };
        // Of the links of a series each does its part.
        let sum = |of: fn(&Segment<f64>, &Segment<f64>) -> f64| {
            pairs.iter().map(|(before, after)| of(&before.segment, &after.segment)).sum::<f64>()
        };
        let length_m = sum(|before, after| before.length_m.max(after.length_m));
        let stretch_m = sum(|before, after| (after.length_m - before.length_m).abs());
        let turn = sum(|before, after| {
            (after.bend_angle_rad - before.bend_angle_rad).hypot(after.twist_rad - before.twist_rad)
        });
        // Each of the `n` actuators of a steering module on a circle of radius `r` moves its mean length by `1/n` and its bend by `2/(n r)` of
        // its own change.
        let [turn, share] = if module.is_steering() {
            [2.0 * stretch_m / (drives * module.reach_m()), 1.0 / drives]
        } else {
            [turn, 1.0]
        };
        Cell {
            from: from.min(to),
            to: from.max(to),
            length_m,
            stretches_m: share * per(stretch_m),
            turns_rad: per(turn),
            grows_m: per(b.outer_radius_m - a.outer_radius_m),
        }
    };
    states.windows(2).map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jacobian::Differential;
    use softlimb_limb::Limb;
    use softlimb_scene as scene;

    fn limb() -> Limb {
        let path = format!("{}/../../scenes/tip-waypoints.toml", env!("CARGO_MANIFEST_DIR"));
        Limb::new(&scene::load(path).unwrap()).unwrap()
    }

    /// Low-discrepancy rows of setpoints between rest and the highest pressure.
    fn row(limb: &Limb, index: usize) -> Vec<f64> {
        let share = |base: f64| (index as f64 * base).fract();
        let modules = limb.modules().iter().zip([0.754_877_666, 0.569_840_296, 0.430_159_709]);
        modules.map(|(m, base)| m.measure(&m.curve.at(share(base) * m.single_valued_max_pa()))).collect()
    }

    /// Samples of moves: what is proven clear is, and where a move is said to be blocked it is.
    #[test]
    fn verdicts_on_moves_agree_with_samples() {
        verdicts_agree_with_samples(&limb(), [[0.6, -0.1, 0.9], [0.5, 0.1, 1.25]], 0.05);
        verdicts_agree_with_samples(&series(), [[0.25, 0.02, 0.14], [0.28, -0.06, 0.1]], 0.02);
    }

    fn verdicts_agree_with_samples(limb: &Limb, centers: [[f64; 3]; 2], radius_m: f64) {
        let balls = centers.map(|center| Shape::sphere(center, radius_m).unwrap());
        let space = Space::new(Carrier::free(limb), balls.iter().collect(), 0.01);
        let least_at = |from: &[f64], to: &[f64], share: f64| {
            let values: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect();
            let body = limb.body(&space.states(&values).unwrap());
            balls.iter().map(|ball| body.clearance(ball).unwrap().distance_m).fold(f64::INFINITY, f64::min)
        };
        let mut blocked = 0;
        for index in 0..120 {
            let (from, to) = (row(limb, index), row(limb, index + 1));
            match space.blocked(&from, &to) {
                Some(found) => {
                    blocked += 1;
                    assert!(least_at(&from, &to, found.share) < 0.01 + 1e-5, "{index}");
                }
                None => (0..=200).for_each(|step| {
                    let least = least_at(&from, &to, f64::from(step) / 200.0);
                    assert!(least >= 0.01 - 1e-6, "{index} at {step}: {least}");
                }),
            }
        }
        assert!((10..110).contains(&blocked), "{blocked} of 120 are blocked");
    }

    /// Exact derivatives of tip and body against differences.
    #[test]
    fn derivatives_by_pressure_are_those_of_differences() {
        derivatives_are_those_of_differences(&limb());
        derivatives_are_those_of_differences(&series());
    }

    /// A twisting, a bending and an extending segment in one module between two others.
    fn series() -> Limb {
        let path = format!("{}/../../scenes/extend-and-bend.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        let helix =
            "[windings.helix]\nangle = \"30 deg\"\nfamilies = 1\nmodulus = \"200 MPa\"\nthickness = \"0.1 mm\"\n";
        let twisting = "[[module.segments]]\nmotion = \"twisting\"\nlength = \"50 mm\"\nwinding = \"helix\"\n";
        let plain = |name: &str, motion: &str| {
            format!(
                "[[module]]\nname = \"{name}\"\nmotion = \"{motion}\"\nactuators = 1\ninner_radius = \"6 mm\"\n\
                 outer_radius = \"9 mm\"\nlength = \"80 mm\"\nmaterial = \"dragon-skin-30\"\nwinding = \"hoop\"\n\n"
            )
        };
        let text = text.replacen("[limb]", &format!("{helix}\n[limb]"), 1);
        let text = text.replacen("[[module]]", &format!("{}[[module]]", plain("first", "bending")), 1);
        let text = text.replacen("[[module.segments]]", &format!("{twisting}\n[[module.segments]]"), 1);
        let text = text.replacen("length = \"100 mm\"", "length = \"100 mm\"\nbend_direction = \"70 deg\"", 1);
        let text = text.replacen("[weight]", &format!("{}[weight]", plain("last", "bending")), 1);
        Limb::new(&scene::parse(&text, "series.toml").unwrap()).unwrap()
    }

    fn derivatives_are_those_of_differences(limb: &Limb) {
        let pressures = [22e3, 31e3, 44e3];
        let at = |pressures: &[f64]| -> Vec<State<f64>> {
            limb.modules().iter().zip(pressures).map(|(m, p)| m.curve.at(*p)).collect()
        };
        let exact = Differential::new(limb, &pressures);
        let h = 1.0;
        for piece in 0..limb.body(exact.states()).pieces().len() {
            let body = limb.body(&at(&pressures));
            let point = body.pieces()[piece].point_m(0.3);
            let (velocities, growth) = exact.body_velocities(piece, 0.3, &point);
            for module in 0..3 {
                let moved = |way: f64| {
                    let mut p = pressures;
                    p[module] += way * h;
                    limb.body(&at(&p)).pieces()[piece]
                };
                let (after, before) = (moved(1.0), moved(-1.0));
                let velocity = (after.point_m(0.3) - before.point_m(0.3)) / (2.0 * h);
                assert!((velocities[module] - velocity).norm() < 1e-9, "{piece} {module}");
                assert!((growth[module] - (after.radius_m() - before.radius_m()) / (2.0 * h)).abs() < 1e-12);
            }
        }
        for (module, (velocity, rotation)) in exact.tip_velocities().iter().zip(exact.tip_rotations()).enumerate() {
            let moved = |way: f64| {
                let mut p = pressures;
                p[module] += way * h;
                limb.tip_pose(&at(&p))
            };
            let (after, before) = (moved(1.0), moved(-1.0));
            assert!((velocity - (after.translation.vector - before.translation.vector) / (2.0 * h)).norm() < 1e-9);
            let turn = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
            assert!((rotation - turn).norm() < 1e-9);
        }
    }
}
