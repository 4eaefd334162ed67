//! The model behind a tube of a bundle: its springs about the strains that a load gives it.
//!
//! The wall of a tube is no linear spring: a straightened bender is stiffer than a free one, a stretched tube too. At a strain the model
//! gives the tube's force and slope, and these are the force and slope of a linear spring with a rest of its own. Springs about the strains of
//! a shape, and the shape of these springs, are found by turns; that is Newton's method on the walls, and a few turns do.

use std::sync::Arc;

use fra_model::{Actuator, ActuatorParameters, Blocked, Load, Motion, State, Status, Target};
use softlimb_fea::cross_section::BendingLaw;

use super::tube::{Tangent, bender_nm2};
use super::wall;

/// Strains of a tube per length at rest: stretch, bend (rad/m) and twist (rad/m).
pub type TubeStrain = [f64; 3];

/// A tube at a gauge pressure, by the model of its actuator.
#[derive(Clone, Debug)]
pub struct Spring {
    actuator: Actuator<f64>,
    /// The law of a bender whose moments are those of finite elements of its section.
    law: Option<Arc<BendingLaw>>,
    pressure_pa: f64,
    /// Strains without load less those of the model: creep.
    crept: TubeStrain,
    free: Tangent,
}

impl Spring {
    /// The tube of an actuator at a gauge pressure, Pa; `None` where the branch of its equilibria does not get there.
    pub fn new(actuator: &Actuator<f64>, pressure_pa: f64) -> Option<Self> {
        let free = Tangent::of(actuator, pressure_pa)?;
        Some(Self { actuator: *actuator, law: None, pressure_pa, crept: [0.0; 3], free })
    }

    /// The tube of a bending actuator at a gauge pressure, Pa, by the finite elements of its section; `None` beyond the pressures of its law.
    pub fn by_section(actuator: &Actuator<f64>, law: &Arc<BendingLaw>, pressure_pa: f64) -> Option<Self> {
        let bend_rad_per_m = law.bend_rad_per_m(pressure_pa)?;
        let [across_nm2, torsion_nm2] = law.beside_nm2(pressure_pa);
        let free = Tangent { across_nm2, torsion_nm2, ..Tangent::at(actuator, &actuator.rest())? };
        let mut spring = Self { actuator: *actuator, law: Some(law.clone()), pressure_pa, crept: [0.0; 3], free };
        spring.free = spring.bent(bend_rad_per_m)?;
        Some(spring)
    }

    /// The tube of an actuator in a state without load; `None` where that is not stable.
    pub(crate) fn at(actuator: &Actuator<f64>, state: &State<f64>) -> Option<Self> {
        let free = Tangent::at(actuator, state)?;
        Some(Self { actuator: *actuator, law: None, pressure_pa: state.pressure_pa, crept: [0.0; 3], free })
    }

    /// The same tube with another shape without load, that of `state`: one that has crept.
    pub fn about(mut self, state: &State<f64>) -> Self {
        let free = self.free.about(state, self.actuator.parameters().length_m);
        let crept = [
            free.stretch - self.free.stretch,
            free.bend_rad_per_m - self.free.bend_rad_per_m,
            free.twist_rad_per_m - self.free.twist_rad_per_m,
        ];
        self.crept = [0, 1, 2].map(|axis: usize| self.crept[axis] + crept[axis]);
        self.free = free;
        self
    }

    /// Whether another tube has the same pressure and shape without load, so the same springs where actuators are equal.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let has_law = |law: &Arc<BendingLaw>, other: &Arc<BendingLaw>| Arc::ptr_eq(law, other) || law == other;
        self.pressure_pa == other.pressure_pa
            && self.free == other.free
            && match (&self.law, &other.law) {
                (Some(law), Some(other)) => has_law(law, other),
                (law, other) => law.is_none() && other.is_none(),
            }
            && self.actuator.parameters() == other.actuator.parameters()
            && self.actuator.second_fiber() == other.actuator.second_fiber()
    }

    /// The parameters of its actuator.
    pub(super) fn parameters(&self) -> &ActuatorParameters<f64> {
        self.actuator.parameters()
    }

    /// Its gauge pressure, Pa.
    pub(super) fn pressure_pa(&self) -> f64 {
        self.pressure_pa
    }

    /// Its springs about the shape without load.
    pub fn tangent(&self) -> Tangent {
        self.free
    }

    /// Its springs about a strain: forces and slopes there are the model's. `None` where it has no equilibrium at the strain, or no stable one.
    ///
    /// A bender that is bent backwards, which is beyond the model, has the springs of a straight one; a tube that is wound to twist keeps those
    /// about the shape without load.
    pub fn tangent_at(&self, strain: &TubeStrain) -> Option<Tangent> {
        let [stretch, bend] = [0, 1].map(|axis: usize| strain[axis] - self.crept[axis]);
        let mut tangent = match self.actuator.parameters().motion {
            Motion::Twisting => return Some(self.free),
            Motion::Bending => self.bent(f64::max(bend, 0.0)),
            Motion::Extension | Motion::Expansion => self.stretched(stretch),
        }?;
        let [stretch, bend, twist] = self.crept;
        tangent.stretch += stretch;
        tangent.bend_rad_per_m += bend;
        tangent.twist_rad_per_m += twist;
        Some(tangent)
    }

    /// The same twisting tube with bending and shear stiffness of its wall where plates hold it at a strain, without axial force. `None` where that is not
    /// stable.
    pub(super) fn held_at(&self, strain: &TubeStrain) -> Option<Self> {
        let state = self.blocked(strain)?.state;
        let (bending_nm2, shear_n) = wall::bending_and_shear(&self.actuator, &state)?;
        Some(Self { free: Tangent { bending_nm2, across_nm2: bending_nm2, shear_n, ..self.free }, ..self.clone() })
    }

    /// Springs of a twisting tube that plates hold at a strain: forces, torques and their slopes there are the model's. `None` where it has no stable
    /// equilibrium.
    pub(super) fn wound_at(&self, strain: &TubeStrain) -> Option<Tangent> {
        let length_m = self.actuator.parameters().length_m;
        let blocked = self.blocked(strain)?;
        let [[axial, coupling], [_, torsion]] = blocked.stiffness.map(|row| row.map(|entry| entry * length_m));
        let (force, torque, whole) = (blocked.force_n, blocked.torque_nm, axial * torsion - coupling * coupling);
        (axial > 0.0 && whole > 0.0).then_some(Tangent {
            stretch: strain[0] - (torsion * force - coupling * torque) / whole,
            twist_rad_per_m: strain[2] - (axial * torque - coupling * force) / whole,
            axial_n: axial,
            torsion_nm2: torsion,
            coupling_nm: coupling,
            outer_radius_m: blocked.state.outer_radius_m,
            // Bending and shear stiffness stay: the lean of a tube is then one function of its bundle's strains.
            ..self.free
        })
    }

    /// The tube held at a stretch and a twist, which its model has without creep.
    fn blocked(&self, strain: &TubeStrain) -> Option<Blocked<f64>> {
        let [stretch, twist] = [0, 2].map(|axis: usize| strain[axis] - self.crept[axis]);
        let twist_rad = twist * self.actuator.parameters().length_m;
        self.actuator.blocked(self.pressure_pa, stretch, twist_rad).ok().filter(|found| found.status == Status::Solved)
    }

    fn stretched(&self, stretch: f64) -> Option<Tangent> {
        let length_m = self.actuator.parameters().length_m;
        let blocked = self.actuator.blocked(self.pressure_pa, stretch, 0.0).ok()?;
        let [[axial, coupling], [_, torsion]] = blocked.stiffness.map(|row| row.map(|entry| entry * length_m));
        let bending_nm2 = wall::bending_nm2(&self.actuator, &blocked.state)?;
        let stable = blocked.status == Status::Solved && axial > 0.0 && torsion > 0.0;
        // The rest of springs with this force at the strain.
        stable.then_some(Tangent {
            stretch: stretch - blocked.force_n / axial,
            bend_rad_per_m: 0.0,
            twist_rad_per_m: 0.0,
            axial_n: axial,
            bending_nm2,
            across_nm2: bending_nm2,
            torsion_nm2: torsion,
            coupling_nm: coupling,
            shear_n: self.free.shear_n,
            outer_radius_m: blocked.state.outer_radius_m,
        })
    }

    /// The springs of a bender about a bend.
    fn bent(&self, bend_rad_per_m: f64) -> Option<Tangent> {
        let [torque_nm, bending_nm2] = match &self.law {
            Some(law) => {
                let found = law.moment(bend_rad_per_m, self.pressure_pa)?;
                [found.moment_nm, found.by_bend_nm2]
            }
            None => self.moment(bend_rad_per_m)?,
        };
        let rest = bend_rad_per_m - torque_nm / bending_nm2;
        (bending_nm2 > 0.0 && bending_nm2.is_finite()).then_some(Tangent {
            // Of a line that keeps its length.
            stretch: 1.0 + self.free.outer_radius_m * rest,
            bend_rad_per_m: rest,
            bending_nm2,
            ..self.free
        })
    }

    /// Moment of a bender at a bend and its slope, by the analytic model.
    ///
    /// The moment on the wall is linear in the pressure: `M = (p_0 - p) dV/dtheta`, where `p_0` holds the bend without load.
    fn moment(&self, bend_rad_per_m: f64) -> Option<[f64; 2]> {
        let length_m = self.actuator.parameters().length_m;
        let solution = self.actuator.inverse(Target::BendAngle(bend_rad_per_m * length_m), &Load::none()).ok()?;
        if solution.status != Status::Solved {
            return None;
        }
        let short_pa = solution.state.pressure_pa - self.pressure_pa;
        let [by_bend, slope] = self.actuator.volume_by_bend(solution.state.bend_angle_rad)?;
        Some([short_pa * by_bend, bender_nm2(&self.actuator, &solution.state)? + short_pa * slope * length_m])
    }
}
