//! Moves by hand: from setpoints to those of a step, or a refusal.

use fra_model::State;
use nalgebra::{DMatrix, DVector, Vector3};

use super::leg::Place;
use super::order::change_of;
use super::refusal::Refusal;
use crate::air::Air;
use crate::carrier::Carrier;
use crate::goal::{shapes, states_at, values};
use crate::inverse_kinematics::{Reach, TipGoal, TipTask, solve_step};
use crate::payload::Carrying;
use crate::schedule::{SPARE_M, TILT_SHARE};
use crate::space::Space;
use crate::timing::shortest;
use crate::upright::Upright;
use crate::weight::pressures_pa;
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Drive, Limb};
use softlimb_scene::Scene;

/// Parts of a drive's range after each of which a limb that is led is to stand.
const PARTS: f64 = 16.0;
/// Parts of a mass that changes hands.
const HANDED: usize = 4;
/// Share of a step beyond the drives' directions above which the direction counts as impossible.
const ACROSS: f64 = 0.3;
/// Distance from the end of a step, as a share of it, within which the limb takes it as well as it can: at the edge of its reach, where a limb
/// is straight or at an end of its pressures, it keeps few directions exactly.
const SLANT: f64 = 0.6;
/// Largest displacement of the tip while a load changes hands, m.
const SAGS_M: f64 = 0.01;
/// Setpoints beyond an end of their range by less than this are set to that end: sums of steps have rounding errors.
const ROUNDED: f64 = 1e-9;
/// A pressure closer to an end of its range than this share of the range counts as at that end.
const AT_END: f64 = 1e-6;
/// A step out of reach is blamed on an obstacle that is nearer than the clearance plus this, m.
const NEAR_M: f64 = 1e-3;

/// The limb, its load and its limits.
pub(super) struct Mover<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    air: Air<'a>,
    tier: Option<Fidelity>,
    carrying: Carrying,
    space: Space<'a>,
}

impl<'a> Mover<'a> {
    /// The limb of a scene that carries nothing, by the statics of a tier, or without load.
    pub(super) fn new(scene: &'a Scene, limb: &'a Limb, tier: Option<Fidelity>) -> Self {
        let carrying = Carrying::default();
        let space = space(scene, limb, tier, carrying, None);
        Self { scene, limb, air: Air::new(scene, limb), tier, carrying, space }
    }

    pub(super) fn limb(&self) -> &'a Limb {
        self.limb
    }

    pub(super) fn carrying(&self) -> Carrying {
        self.carrying
    }

    /// The statics that solve poses; `None` without load.
    pub(super) fn tier(&self) -> Option<Fidelity> {
        self.tier
    }

    /// The limb without pressure, with no load at its tip.
    pub(super) fn at_rest(&self) -> Vec<f64> {
        self.limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect()
    }

    /// Setpoints with their tip.
    pub(super) fn place(&self, values: Vec<f64>) -> Option<Place> {
        let tip_m = self.space.body(&values)?.end().translation.vector.into();
        Some(Place { values, tip_m })
    }

    /// The pose whose tip is displaced by a vector, m, from that of given setpoints; at the edge of the reach the nearest one.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn tip(&self, from: &Place, way_m: Vector3<f64>) -> Result<Place, Refusal> {
        let obstacles = shapes(self.scene);
        let goal = TipGoal::Point((Vector3::from(from.tip_m) + way_m).into());
        let clearance_m = self.scene.limits().clearance_m;
        let task = TipTask { goal, aim: None, upright: self.space.upright(), obstacles: &obstacles, clearance_m };
        let start_pa = self.pressures_pa(&from.values);
        let reach = solve_step(self.space.carrier(), &task, &start_pa);
        if !reach.allowed() || reach.distance_m > SLANT * way_m.norm() {
            return Err(self.why(&start_pa, &way_m, &reach));
        }
        let to = Place { values: values(self.limb, &reach), tip_m: reach.tip_m };
        self.check(&from.values, &to.values)?;
        Ok(to)
    }

    /// The pose with one drive's setpoint changed by an amount in the unit of its steps; a positive amount raises its pressure.
    ///
    /// # Errors
    /// [`Refusal`].
    pub(super) fn drive(&self, from: &Place, index: usize, amount: f64) -> Result<Place, Refusal> {
        let drive = self.limb.drive(index);
        let mut to = from.values.clone();
        to[index] = self.within(&drive, to[index] + change_of(&drive, amount))?;
        self.reached(from, to)
    }

    /// The pose at setpoints, one a drive.
    ///
    /// # Errors
    /// [`Refusal`]; [`Refusal::OutOfReach`] of a number that is not finite, and where there is not one for each drive.
    pub(super) fn to(&self, from: &Place, setpoints: &[f64]) -> Result<Place, Refusal> {
        if setpoints.len() != self.limb.drives().len() || !setpoints.iter().all(|value| value.is_finite()) {
            return Err(Refusal::OutOfReach);
        }
        let to = self.limb.drives().zip(setpoints).map(|(drive, value)| self.within(&drive, *value));
        let to: Vec<f64> = to.collect::<Result<_, _>>()?;
        let share = |((drive, a), b): ((Drive<'_>, &f64), &f64)| {
            let (rest, last) = drive.range();
            ((b - a) / (last - rest)).abs()
        };
        let longest = self.limb.drives().zip(&from.values).zip(&to).map(share).fold(0.0, f64::max);
        let parts = (longest * PARTS).ceil();
        // A limb that stands at both ends may fall on a long way between them.
        for part in 1..parts as usize {
            let at = part as f64 / parts;
            let on_the_way: Vec<f64> = from.values.iter().zip(&to).map(|(a, b)| a + (b - a) * at).collect();
            let stands = self.space.carrier().stands(&self.pressures_pa(&on_the_way));
            stands.map_err(|cause| Refusal::falls(self.scene, cause))?;
        }
        self.reached(from, to)
    }

    /// A drive's setpoint, or the end of its pressures that is in the way.
    fn within(&self, drive: &Drive<'_>, setpoint: f64) -> Result<f64, Refusal> {
        let (rest, last) = drive.range();
        let end = |is_last: bool| if is_last { Refusal::Highest(drive.name()) } else { Refusal::AtRest(drive.name()) };
        let within = setpoint.clamp(rest.min(last), rest.max(last));
        if (within - setpoint).abs() > ROUNDED {
            return Err(end(within == last));
        }
        let state = drive.state_at(within).ok_or_else(|| end(true))?;
        if state.pressure_pa < 0.0 || state.pressure_pa > self.highest_pa(drive) {
            return Err(end(state.pressure_pa > 0.0));
        }
        Ok(within)
    }

    /// The pose at setpoints within their ranges, if the way there is free and the limb stands there.
    fn reached(&self, from: &Place, to: Vec<f64>) -> Result<Place, Refusal> {
        self.check(&from.values, &to)?;
        self.place(to).ok_or_else(|| Refusal::of(self.scene, crate::space::Hindrance::NoShape))
    }

    /// Changes the load at the tip. Returns rows of setpoints that keep the tip in place while the mass changes hands.
    ///
    /// # Errors
    /// [`Refusal`]; it then carries what it carried.
    pub(super) fn carry(&mut self, from: &Place, carrying: Carrying) -> Result<(Vec<Vec<f64>>, Place), Refusal> {
        let other = space(self.scene, self.limb, self.tier, carrying, self.upright(&from.values, carrying));
        let mut rows = vec![from.values.clone()];
        let (before_kg, after_kg) = (self.carrying.payload_kg, carrying.payload_kg);
        let mut here = from.clone();
        if self.tier.is_some() && before_kg != after_kg {
            let carrier = Carrier::new(self.scene, self.limb, self.tier, Carrying { object: None, ..carrying });
            let goal = TipGoal::Point(from.tip_m);
            let task = TipTask { goal, aim: None, upright: None, obstacles: &[], clearance_m: 0.0 };
            for part in 1..=HANDED {
                carrier.load(before_kg + (after_kg - before_kg) * part as f64 / HANDED as f64);
                let start_pa = self.pressures_pa(&rows[part - 1]);
                let reach = solve_step(&carrier, &task, &start_pa);
                if reach.distance_m > SAGS_M {
                    return Err(self.why(&start_pa, &Vector3::zeros(), &reach));
                }
                carrier.stands(&reach.pressures_pa).map_err(|cause| Refusal::falls(self.scene, cause))?;
                rows.push(values(self.limb, &reach));
                here = Place { values: rows[part].clone(), tip_m: reach.tip_m };
            }
        } else {
            rows.push(from.values.clone());
        }
        let body = other.body(&here.values).ok_or(Refusal::OutOfReach)?;
        if let Some(found) = other.nearest(&body, self.scene.limits().clearance_m) {
            return Err(Refusal::of(self.scene, crate::space::Hindrance::Obstacle(found)));
        }
        (self.space, self.carrying) = (other, carrying);
        Ok((rows, here))
    }

    /// Carries nothing, wherever the limb is.
    pub(super) fn drop(&mut self) {
        self.take(Carrying::default(), None);
    }

    /// Carries a load at setpoints that a plan has brought it to.
    pub(super) fn hold(&mut self, values: &[f64], carrying: Carrying) {
        self.take(carrying, self.upright(values, carrying));
        self.judge(values);
    }

    fn take(&mut self, carrying: Carrying, upright: Option<Upright>) {
        self.carrying = carrying;
        self.space = space(self.scene, self.limb, self.tier, carrying, upright);
    }

    /// How far an object that is taken at given setpoints may tilt; `None` without one.
    fn upright(&self, values: &[f64], carrying: Carrying) -> Option<Upright> {
        let tip = self.space.body(values)?.end().rotation;
        let most_rad = self.scene.objects()[carrying.object?].tilt_max_rad;
        Some(Upright::taken(&tip, most_rad).within(TILT_SHARE))
    }

    /// Shortest time of a move through rows of setpoints, s.
    ///
    /// # Errors
    /// [`Refusal::NoSupply`].
    pub(super) fn shortest_s(&self, rows: &[Vec<f64>]) -> Result<f64, Refusal> {
        let leg = |pair: &[Vec<f64>]| {
            shortest(self.scene, self.limb, &self.air, (&pair[0], &pair[1]), self.air.full()).map(|found| found.time_s)
        };
        rows.windows(2).map(leg).sum::<Option<f64>>().ok_or(Refusal::NoSupply)
    }

    /// Changes to finer statics where the present pose needs them.
    pub(super) fn judge(&mut self, values: &[f64]) {
        let Some(weight) = self.scene.weight() else { return };
        let finer = self.space.carrier().finer_tier(&self.pressures_pa(values), weight.error);
        if finer.is_some() {
            self.tier = finer;
            self.space = space(self.scene, self.limb, self.tier, self.carrying, self.space.upright());
        }
    }

    /// Checks the straight move between two rows of setpoints, and that the limb stands at its end.
    fn check(&self, from: &[f64], to: &[f64]) -> Result<(), Refusal> {
        if let Some(blocked) = self.space.blocked(from, to) {
            return Err(Refusal::of(self.scene, blocked.by));
        }
        let stands = self.space.carrier().stands(&self.pressures_pa(to));
        stands.map_err(|cause| Refusal::falls(self.scene, cause))
    }

    /// Why a step ends elsewhere.
    fn why(&self, start_pa: &[f64], way_m: &Vector3<f64>, reach: &Reach) -> Refusal {
        let carrier = self.space.carrier();
        if let Err(cause) = carrier.stands(&reach.pressures_pa) {
            return Refusal::falls(self.scene, cause);
        }
        if self.is_across(start_pa, way_m) {
            return Refusal::NoWay;
        }
        let end = |(drive, pressure_pa): (Drive<'_>, &f64)| {
            let span_pa = self.highest_pa(&drive);
            match pressure_pa / span_pa {
                share if share >= 1.0 - AT_END => Some(Refusal::Highest(drive.name())),
                share if share <= AT_END => Some(Refusal::AtRest(drive.name())),
                _ => None,
            }
        };
        let body = carrier.body(&reach.pressures_pa);
        let near = body.and_then(|body| self.space.nearest(&body, self.scene.limits().clearance_m + NEAR_M));
        if let Some(found) = near {
            return Refusal::of(self.scene, crate::space::Hindrance::Obstacle(found));
        }
        if reach.tilt_rad > 0.0 {
            let most_rad = self.space.upright().map_or(0.0, |upright| upright.most_rad());
            return Refusal::Tilt(most_rad + reach.tilt_rad);
        }
        let drives = self.limb.drives().zip(&reach.pressures_pa);
        drives.filter_map(end).next().unwrap_or(Refusal::OutOfReach)
    }

    /// Whether hardly any part of a displacement lies along directions in which the drives move the tip.
    fn is_across(&self, start_pa: &[f64], way_m: &Vector3<f64>) -> bool {
        let Some(posture) = self.space.carrier().posture(start_pa) else { return false };
        let spans = self.limb.drives().map(|drive| self.highest_pa(&drive));
        let columns = posture.tip_velocities().into_iter().zip(spans).map(|(velocity, span_pa)| velocity * span_pa);
        let columns: Vec<Vector3<f64>> = columns.collect();
        let slopes = DMatrix::from_fn(3, columns.len(), |row, column| columns[column][row]);
        let way = DVector::from_column_slice(way_m.as_slice());
        let svd = slopes.clone().svd(true, true);
        let most = svd.singular_values.max();
        let Ok(shares) = svd.solve(&way, 1e-3 * most) else { return false };
        (&way - slopes * shares).norm() > ACROSS * way.norm()
    }

    /// The highest pressure that a drive may have, gauge Pa: each setpoint below has one state, and under load the scene's margin is kept.
    fn highest_pa(&self, drive: &Drive<'_>) -> f64 {
        let whole_pa = drive.single_valued_max_pa();
        match self.tier {
            None => whole_pa,
            Some(_) => whole_pa.min(self.scene.limits().standing.pressure_share * drive.ceiling_pa()),
        }
    }

    fn pressures_pa(&self, values: &[f64]) -> Vec<f64> {
        let states: Vec<State<f64>> = states_at(self.limb, values);
        pressures_pa(&states)
    }
}

/// The space of a limb that carries something.
fn space<'a>(
    scene: &'a Scene,
    limb: &'a Limb,
    tier: Option<Fidelity>,
    carrying: Carrying,
    upright: Option<Upright>,
) -> Space<'a> {
    let carrier = Carrier::new(scene, limb, tier, carrying);
    Space::new(carrier, shapes(scene), scene.limits().clearance_m + SPARE_M).keeping(upright)
}
