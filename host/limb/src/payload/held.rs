//! A module in the shape of a pose: its actuators as they are held, and the bending stiffness of their walls.

use fra_model::{Link, Motion, State, Status};
use nalgebra::{Vector2, Vector3, Vector6};

use super::bundle::{Bundle, Hold, Mounted, PayloadError};
use super::capacity::Linearised;
use crate::LimbModule;
use crate::statics::{Bundle as Tubes, Tangent, column_n, shear_n};

/// A module in the states of its drives.
pub(super) struct Held<'a> {
    pub(super) module: &'a LimbModule,
    /// One a drive.
    pub(super) states: &'a [State<f64>],
    pub(super) link: &'a Link<f64>,
}

impl Held<'_> {
    /// What the module has to balance, and the force that each actuator buckles at, N.
    pub(super) fn station(
        &self,
        constant: Vector6<f64>,
        per_load: Vector6<f64>,
        (buckling_share, spacers): (f64, u32),
    ) -> Result<(Linearised, Vec<f64>), PayloadError> {
        let module = self.module;
        let count = module.channels.len();
        // Plates hold twisting actuators back: those are not in the state of their module.
        let pressures_pa = vec![self.states[0].pressure_pa; count];
        let tubes = module.is_restrained().then(|| Tubes::new(module, &pressures_pa, module.bays())).flatten();
        let leaning = |i: usize| tubes.as_ref().and_then(|tubes| tubes.leaning(module.motion, i));
        let shape = |i: usize| {
            leaning(i)
                .map_or_else(|| self.shape(i), |leaning| [leaning.stretch, leaning.twist_rad_per_m * module.length_m()])
        };
        let mounted = |i: usize| {
            let mounted = self.mounted(i, shape(i))?;
            let restraint =
                leaning(i).map_or_else(Vector2::zeros, |leaning| Vector2::new(leaning.pull_n, -leaning.moment_nm));
            Ok::<_, PayloadError>(Mounted { restraint, ..mounted })
        };
        let bundle = Bundle { actuators: (0..count).map(mounted).collect::<Result<_, _>>()?, walls: self.walls()? };
        let critical = |i: usize| self.critical_n(i, shape(i), spacers);
        let columns = if module.motion == Motion::Bending { 0 } else { count };
        let critical_n = (0..columns).map(critical).collect::<Result<Vec<_>, _>>()?;
        let push_max = |i: usize| critical_n.get(i).map_or(f64::INFINITY, |critical_n| critical_n * buckling_share);
        let rows = match module.motion {
            Motion::Extension | Motion::Expansion => [false, false, true, true, true, false],
            Motion::Twisting => [false, false, false, true, true, true],
            Motion::Bending => [false, false, false, false, true, false],
        };
        // The pressures end where the device stops, or where the branch of the unloaded actuator does.
        let most = module.reference_max_pa.min(module.curve.pressure_max_pa());
        let station = Linearised {
            name: module.name.clone(),
            bundle,
            rows,
            constant,
            per_load,
            limits_pa: vec![[0.0, most]; count],
            push_max_n: (0..count).map(push_max).collect(),
        };
        Ok((station, critical_n))
    }

    /// The state of an actuator.
    fn state(&self, actuator: usize) -> &State<f64> {
        &self.states[if self.module.is_steering() { actuator } else { 0 }]
    }

    /// Stretch and twist, rad, that an actuator is held at where no plates hold it back.
    fn shape(&self, actuator: usize) -> [f64; 2] {
        let state = self.state(actuator);
        if !self.module.is_steering() {
            return [state.axial_stretch, state.twist_rad];
        }
        // That of its line beside the arc.
        let [x, y] = self.module.positions_m()[actuator];
        let (sin, cos) = self.towards_rad().sin_cos();
        let length_m = self.link.segment.length_m - self.link.segment.bend_angle_rad * (x * cos + y * sin);
        [length_m / self.module.length_m(), 0.0]
    }

    /// Direction that a steering module bends towards, from its first actuator, rad.
    fn towards_rad(&self) -> f64 {
        self.link.mount_angle_rad - self.module.mount_angle_rad()
    }

    fn mounted(&self, actuator: usize, [axial_stretch, twist_rad]: [f64; 2]) -> Result<Mounted, PayloadError> {
        let bends = self.module.motion == Motion::Bending;
        let hold = if bends {
            Hold::Bent { bend_angle_rad: self.state(actuator).bend_angle_rad }
        } else {
            Hold::Straight { axial_stretch, twist_rad }
        };
        let [x, y] = self.module.positions_m()[actuator];
        let axis = if bends { Vector3::y() } else { Vector3::z() };
        let name = format!("{} {}", self.module.name, actuator + 1);
        let mounted = Mounted::new(&name, self.module.actuator, hold, Vector3::new(x, y, 0.0), axis)?;
        let law = self.module.law().cloned();
        if self.module.is_by_section() && law.is_none() {
            return Err(self.no_balance(self.state(actuator)));
        }
        Ok(Mounted { law, ..mounted })
    }

    /// Moment that the bent walls of a steering module's actuators turn its far connector back with, N m.
    fn walls(&self) -> Result<Vector6<f64>, PayloadError> {
        let mut wrench = Vector6::zeros();
        if !self.module.is_steering() {
            return Ok(wrench);
        }
        let bending = |state: &State<f64>| {
            let tangent = Tangent::of(&self.module.actuator, state.pressure_pa);
            tangent.map(|tangent| tangent.bending_nm2).ok_or_else(|| self.no_balance(state))
        };
        let stiffness_nm2: f64 = self.states.iter().map(bending).sum::<Result<f64, _>>()?;
        let moment_nm = stiffness_nm2 * self.link.segment.bend_angle_rad / self.module.length_m();
        let (sin, cos) = self.towards_rad().sin_cos();
        (wrench[3], wrench[4]) = (moment_nm * sin, -moment_nm * cos);
        Ok(wrench)
    }

    fn no_balance(&self, state: &State<f64>) -> PayloadError {
        PayloadError::NoBalance { name: self.module.name.clone(), pressure_pa: state.pressure_pa }
    }

    /// As [`column_n`] has it, with `E I = (dN/dl) l (r_i^2 + r_o^2)/4`: the section as a ring whose axial stiffness is the model's own.
    fn critical_n(
        &self,
        actuator: usize,
        [axial_stretch, twist_rad]: [f64; 2],
        spacers: u32,
    ) -> Result<f64, PayloadError> {
        let (module, state) = (self.module, self.state(actuator));
        let held = module.actuator.blocked(state.pressure_pa, axial_stretch, twist_rad)?;
        if held.status != Status::Solved {
            return Err(self.no_balance(state));
        }
        let stretch = if module.is_steering() { axial_stretch } else { state.axial_stretch };
        let length = module.length_m() * stretch;
        let radii = held.state.inner_radius_m.powi(2) + held.state.outer_radius_m.powi(2);
        let bending = held.stiffness[0][0] * length * radii / 4.0;
        let bay = length / f64::from(spacers + 1);
        // Stiffness per length is that of the length as it is.
        Ok(column_n(bending, shear_n(&module.actuator) * stretch, bay))
    }
}
