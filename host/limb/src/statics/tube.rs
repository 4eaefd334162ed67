//! One pressurised tube as a spring: its state without load, and the tangent of the model there.

use std::f64::consts::PI;

use fra_model::{Actuator, Load, Motion, State, Status};
use softlimb_fea::cross_section::Equilibrium;

use super::wall;

/// By how much stiffer than the wall the inextensible line of a bending actuator is taken to be.
pub(super) const LINE: f64 = 100.0;

/// A tube at a gauge pressure without load, per unit of its length at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Axial stretch of its axis.
    pub stretch: f64,
    /// Bend per length at rest, rad/m.
    pub bend_rad_per_m: f64,
    /// Twist per length at rest, rad/m.
    pub twist_rad_per_m: f64,
    /// Axial stiffness `EA`, N per unit of stretch, at constant pressure; of a bending actuator that of the line that keeps its length.
    pub axial_n: f64,
    /// Bending stiffness `EI` in the plane that a bending actuator bends in, N m2.
    pub bending_nm2: f64,
    /// Bending stiffness across that plane, N m2; the same for a straight actuator.
    pub across_nm2: f64,
    /// Torsional stiffness `GJ`, N m2.
    pub torsion_nm2: f64,
    /// Axial force per twist rate, N m/rad: not 0 for one family of fibers.
    pub coupling_nm: f64,
    /// Shear stiffness `GA`, N.
    pub shear_n: f64,
    /// Outer radius, m.
    pub outer_radius_m: f64,
}

impl Tangent {
    /// The tube at a pressure; `None` where the branch of its equilibria does not get there.
    ///
    /// Axial and torsional stiffness are those of the model at constant pressure ([`Actuator::blocked`]); the bending stiffness of a straight wall is that of
    /// its second variation. In the plane of a bending actuator `EI` is the model's own change of
    /// moment with the bend; its line is given a hundred times the stiffness of the wall. `GA` is half of `mu A`, as of a thin round tube; plates
    /// that hold twisting tubes back see that of their walls ([`super::Bundle::of_springs`]).
    pub fn of(actuator: &Actuator<f64>, pressure_pa: f64) -> Option<Self> {
        let solution = actuator.forward(pressure_pa, &Load::none()).ok()?;
        let solved = solution.status == Status::Solved;
        solved.then_some(())?;
        Self::at(actuator, &solution.state)
    }

    /// A bending actuator in an equilibrium without load of its whole section; `None` where that is not stable, and where symmetry was used.
    ///
    /// Axial and shear stiffness are those of [`Tangent::of`].
    pub(crate) fn of_section(actuator: &Actuator<f64>, found: &Equilibrium) -> Option<Self> {
        let stiffness = found.stiffness?.by_strain;
        // The axis stretches without an axial force.
        let bending_nm2 = stiffness[1][1] - stiffness[0][1] * stiffness[1][0] / stiffness[0][0];
        let tube = Self {
            bending_nm2,
            across_nm2: stiffness[2][2],
            torsion_nm2: stiffness[3][3],
            ..Self::at(actuator, &actuator.rest())?
        };
        let is_stable = bending_nm2 > 0.0 && bending_nm2.is_finite();
        is_stable.then(|| tube.about(&found.state.over(1.0), 1.0))
    }

    /// The tube in a state without load; `None` where that is not stable.
    pub(super) fn at(actuator: &Actuator<f64>, state: &State<f64>) -> Option<Self> {
        match actuator.parameters().motion {
            Motion::Bending => bending(actuator, state),
            Motion::Extension | Motion::Expansion | Motion::Twisting => straight(actuator, state),
        }
    }
}

impl Tangent {
    /// Stretch without load of the line of a bending actuator that keeps its length: at the outer radius, on the side that it bends to.
    pub(super) fn line_stretch(&self) -> f64 {
        self.stretch - self.outer_radius_m * self.bend_rad_per_m
    }

    /// The same springs about another shape without load: that of `state`, of a tube `length_m` long at rest.
    pub fn about(self, state: &State<f64>, length_m: f64) -> Self {
        let (bend_rad_per_m, twist_rad_per_m) = (state.bend_angle_rad / length_m, state.twist_rad / length_m);
        Self { stretch: state.axial_stretch, bend_rad_per_m, twist_rad_per_m, ..self }
    }
}

fn straight(actuator: &Actuator<f64>, state: &State<f64>) -> Option<Tangent> {
    let parameters = actuator.parameters();
    let held = actuator.blocked(state.pressure_pa, state.axial_stretch, state.twist_rad).ok()?;
    let length_m = parameters.length_m;
    let [[axial, coupling], [_, torsion]] = held.stiffness.map(|row| row.map(|entry| entry * length_m));
    let bending_nm2 = wall::bending_nm2(actuator, state)?;
    Some(Tangent {
        stretch: state.axial_stretch,
        bend_rad_per_m: 0.0,
        twist_rad_per_m: state.twist_rad / length_m,
        axial_n: axial,
        bending_nm2,
        across_nm2: bending_nm2,
        torsion_nm2: torsion,
        coupling_nm: coupling,
        shear_n: shear_n(actuator),
        outer_radius_m: state.outer_radius_m,
    })
    .filter(|tangent| tangent.axial_n > 0.0 && tangent.torsion_nm2 > 0.0)
}

fn bending(actuator: &Actuator<f64>, state: &State<f64>) -> Option<Tangent> {
    let parameters = actuator.parameters();
    // The wall alone, under its hoops: no radius changes, so that its axial modulus is 4 mu.
    let modulus_pa = 4.0 * parameters.material.shear_modulus_pa();
    let wall_n = modulus_pa * section_m2(actuator);
    let across_nm2 = wall_n * gyration_m2(state.inner_radius_m, state.outer_radius_m);
    Some(Tangent {
        stretch: state.axial_stretch,
        bend_rad_per_m: state.bend_angle_rad / parameters.length_m,
        twist_rad_per_m: 0.0,
        axial_n: LINE * wall_n,
        bending_nm2: bender_nm2(actuator, state)?,
        across_nm2,
        torsion_nm2: across_nm2 * 0.5,
        coupling_nm: 0.0,
        shear_n: shear_n(actuator),
        outer_radius_m: state.outer_radius_m,
    })
    .filter(|tangent| tangent.bending_nm2.is_finite() && tangent.bending_nm2 > 0.0)
}

/// Change of a bender's moment with its bend per length at constant pressure, N m2, at a state without load.
///
/// The moment is `(p - p_0(theta)) dV/dtheta`, and the compliance is `dV/dp_0`.
pub(super) fn bender_nm2(actuator: &Actuator<f64>, state: &State<f64>) -> Option<f64> {
    let [volume_by_bend, _] = actuator.volume_by_bend(state.bend_angle_rad)?;
    Some(actuator.parameters().length_m * volume_by_bend.powi(2) / state.compliance_m3_per_pa)
}

/// Mean square of the distance of the wall from a diameter, m2.
fn gyration_m2(inner_m: f64, outer_m: f64) -> f64 {
    0.25 * (inner_m * inner_m + outer_m * outer_m)
}

fn section_m2(actuator: &Actuator<f64>) -> f64 {
    let (inner, outer) = (actuator.parameters().inner_radius_m, actuator.parameters().outer_radius_m);
    PI * (outer - inner) * (outer + inner)
}

/// Shear stiffness `GA` of a wall, N: half of `mu A`, as of a thin round tube.
pub(crate) fn shear_n(actuator: &Actuator<f64>) -> f64 {
    0.5 * actuator.parameters().material.shear_modulus_pa() * section_m2(actuator)
}
