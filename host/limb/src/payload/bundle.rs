//! Bundles: actuators between two connectors, and the wrench they exert on the far one.
//!
//! ```text
//! w = sum_i D_i (F_i, M_i),   D_i = [ a_i       0  ]      (15), (16)
//!                                   [ d_i x a_i a_i ]
//! (F_i, M_i) = -(N_ext, M_ext)(P_i, stretch_i, twist_i)     of the model, in place of J_q^T P_i in (17)
//! ```

use std::sync::Arc;

use fra_model::{Actuator, InvalidParameter, Load, Motion, Status, Target};
use nalgebra::{DMatrix, Matrix6x2, Vector2, Vector3, Vector6};
use softlimb_fea::cross_section::BendingLaw;

/// Singular values below this share of the largest count as none.
const RANK: f64 = 1e-10;

/// Why a force cannot be said.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PayloadError {
    /// A number that is not accepted.
    #[error("{field} = {value} is not allowed: {allowed}")]
    Invalid {
        /// Name of the field; its unit is in the name.
        field: String,
        /// The value found.
        value: f64,
        /// What is accepted.
        allowed: String,
    },
    /// No state of the actuator balances this pressure in this shape.
    #[error("{name}: no state balances {pressure_pa} Pa in the shape it is held in")]
    NoBalance {
        /// The actuator.
        name: String,
        /// Gauge pressure, Pa.
        pressure_pa: f64,
    },
    /// The conic solver stopped early.
    #[error("the solver of the program stopped: {0}")]
    Solver(String),
}

impl From<InvalidParameter<f64>> for PayloadError {
    fn from(error: InvalidParameter<f64>) -> Self {
        Self::Invalid { field: error.field.into(), value: error.value, allowed: error.allowed.into() }
    }
}

/// `Err` that names the field unless `accepted`.
pub(super) fn require(accepted: bool, field: &str, value: f64, allowed: &str) -> Result<(), PayloadError> {
    if accepted { Ok(()) } else { Err(PayloadError::Invalid { field: field.into(), value, allowed: allowed.into() }) }
}

/// The shape an actuator is held in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// A straight one: axial stretch, > 0, and twist, rad.
    Straight {
        /// `l/L`.
        axial_stretch: f64,
        /// Twist of its far end, rad.
        twist_rad: f64,
    },
    /// A bending one: bend angle, rad, >= 0.
    Bent {
        /// Angle between its ends, rad.
        bend_angle_rad: f64,
    },
}

/// An actuator in its place: its far end pushes on the connector.
#[derive(Clone, Debug)]
pub struct Mounted {
    /// For messages.
    pub name: String,
    /// The actuator.
    pub actuator: Actuator<f64>,
    /// The law of a bending one whose moments are those of finite elements of its section.
    pub law: Option<Arc<BendingLaw>>,
    /// The shape it is held in.
    pub hold: Hold,
    /// Where it is attached, `d_i`, m from the point that moments are about.
    pub point_m: Vector3<f64>,
    /// Its axis `a_i`, a unit vector towards the connector. Of a bending actuator the axis it bends about.
    pub axis: Vector3<f64>,
    /// Force along the axis, N, and moment about it, N m, on the connector that do not come from the shape it is held in: those of plates
    /// that hold a twisting actuator back.
    pub restraint: Vector2<f64>,
}

/// What one actuator does at a pressure, and how that changes with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Force along its axis, N, and moment about it, N m, on the connector; positive pushes. Of a bending actuator 0 and the moment that bends.
    pub load: Vector2<f64>,
    /// Their derivatives by the pressure, m2 and m3.
    pub by_pressure: Vector2<f64>,
}

/// `D_i` of eqs. (15) and (16): the wrench, N and N m, of a unit force along and a unit moment about an axis at a point.
pub fn lever(point_m: &Vector3<f64>, axis: &Vector3<f64>) -> Matrix6x2<f64> {
    let (arm, zero) = (point_m.cross(axis), Vector3::zeros());
    let mut d = Matrix6x2::zeros();
    d.fixed_view_mut::<3, 1>(0, 0).copy_from(axis);
    d.fixed_view_mut::<3, 1>(3, 0).copy_from(&arm);
    d.fixed_view_mut::<3, 1>(0, 1).copy_from(&zero);
    d.fixed_view_mut::<3, 1>(3, 1).copy_from(axis);
    d
}

impl Mounted {
    /// An actuator in its place.
    ///
    /// # Errors
    /// [`PayloadError::Invalid`] for numbers that are not finite, an axis that is no direction, or a shape that is not this motion's.
    pub fn new(
        name: &str,
        actuator: Actuator<f64>,
        hold: Hold,
        point_m: Vector3<f64>,
        axis: Vector3<f64>,
    ) -> Result<Self, PayloadError> {
        let bends = actuator.parameters().motion == Motion::Bending;
        match hold {
            Hold::Straight { axial_stretch, twist_rad } => {
                require(!bends, "axial_stretch", axial_stretch, "a shape of straight actuators only")?;
                require(
                    axial_stretch.is_finite() && axial_stretch > 0.0,
                    "axial_stretch",
                    axial_stretch,
                    "finite and > 0",
                )?;
                require(twist_rad.is_finite(), "twist_rad", twist_rad, "finite")?;
            }
            Hold::Bent { bend_angle_rad } => {
                require(bends, "bend_angle_rad", bend_angle_rad, "a shape of bending actuators only")?;
                let some = bend_angle_rad.is_finite() && bend_angle_rad >= 0.0;
                require(some, "bend_angle_rad", bend_angle_rad, "finite and >= 0")?;
            }
        }
        for value in &point_m {
            require(value.is_finite(), "point_m", *value, "finite")?;
        }
        let norm = axis.norm();
        require(norm.is_finite() && norm > 0.0, "axis", norm, "a finite direction of length > 0")?;
        let (axis, restraint) = (axis / norm, Vector2::zeros());
        Ok(Self { name: name.into(), actuator, law: None, hold, point_m, axis, restraint })
    }

    /// What it does at a gauge pressure, Pa.
    ///
    /// # Errors
    /// [`PayloadError`] where no state balances the pressure in this shape.
    pub fn push(&self, pressure_pa: f64) -> Result<Push, PayloadError> {
        match self.hold {
            Hold::Straight { axial_stretch, twist_rad } => {
                let held = self.actuator.blocked(pressure_pa, axial_stretch, twist_rad)?;
                if held.status != Status::Solved {
                    return Err(self.no_balance(pressure_pa));
                }
                let [force, torque] = held.by_pressure;
                let load = self.restraint - Vector2::new(held.force_n, held.torque_nm);
                Ok(Push { pressure_pa, load, by_pressure: Vector2::new(-force, -torque) })
            }
            Hold::Bent { bend_angle_rad } => self.bend(pressure_pa, bend_angle_rad),
        }
    }

    /// The energy of a bent section is that of the wall less `P V`: the moment is `(P - P_free) dV/dphi`, without remainder.
    fn bend(&self, pressure_pa: f64, bend_angle_rad: f64) -> Result<Push, PayloadError> {
        if let Some(law) = &self.law {
            let bend_rad_per_m = bend_angle_rad / self.actuator.parameters().length_m;
            let held = law.moment(bend_rad_per_m, pressure_pa).ok_or_else(|| self.no_balance(pressure_pa))?;
            let [load, by_pressure] = [held.moment_nm, held.by_pressure_m3].map(|moment| Vector2::new(0.0, -moment));
            return Ok(Push { pressure_pa, load, by_pressure });
        }
        let free = self.actuator.inverse(Target::BendAngle(bend_angle_rad), &Load::none())?;
        let growth = self.actuator.volume_by_bend(bend_angle_rad);
        let (Status::Solved, Some([per_pascal, _])) = (free.status, growth) else {
            return Err(self.no_balance(pressure_pa));
        };
        let moment = (pressure_pa - free.state.pressure_pa) * per_pascal;
        Ok(Push { pressure_pa, load: Vector2::new(0.0, moment), by_pressure: Vector2::new(0.0, per_pascal) })
    }

    fn no_balance(&self, pressure_pa: f64) -> PayloadError {
        PayloadError::NoBalance { name: self.name.clone(), pressure_pa }
    }
}

/// Actuators side by side.
#[derive(Clone, Debug, Default)]
pub struct Bundle {
    /// The actuators.
    pub actuators: Vec<Mounted>,
    /// Wrench of walls in the shape that they are held in, N and N m, at any pressures: that of bent ones.
    pub walls: Vector6<f64>,
}

impl Bundle {
    /// The wrench on the far connector at gauge pressures, Pa: forces N, then moments N m about the reference point.
    ///
    /// # Errors
    /// [`PayloadError`] for a wrong number of pressures, or as [`Mounted::push`].
    pub fn wrench(&self, pressures_pa: &[f64]) -> Result<Vector6<f64>, PayloadError> {
        let count = self.actuators.len();
        require(pressures_pa.len() == count, "pressures_pa", pressures_pa.len() as f64, "one for each actuator")?;
        let mut sum = self.walls;
        for (actuator, pressure_pa) in self.actuators.iter().zip(pressures_pa) {
            sum += lever(&actuator.point_m, &actuator.axis) * actuator.push(*pressure_pa)?.load;
        }
        Ok(sum)
    }

    /// Derivatives of the wrench by the pressures, a column for each, m2 and m3.
    ///
    /// # Errors
    /// As [`Bundle::wrench`].
    pub fn by_pressure(&self, pressures_pa: &[f64]) -> Result<Vec<Vector6<f64>>, PayloadError> {
        let count = self.actuators.len();
        require(pressures_pa.len() == count, "pressures_pa", pressures_pa.len() as f64, "one for each actuator")?;
        let pairs = self.actuators.iter().zip(pressures_pa);
        pairs.map(|(a, pressure_pa)| Ok(lever(&a.point_m, &a.axis) * a.push(*pressure_pa)?.by_pressure)).collect()
    }
}

/// How many independent wrenches pressures can give: the rank of their columns. `arm_m` makes moments comparable with forces.
pub fn rank(columns: &[Vector6<f64>], arm_m: f64) -> usize {
    let scaled =
        DMatrix::from_fn(6, columns.len(), |row, i| if row < 3 { columns[i][row] } else { columns[i][row] / arm_m });
    let values = scaled.singular_values();
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|value| **value > RANK * largest).count()
}
