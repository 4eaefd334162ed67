//! Results of the section model.

use std::f64::consts::PI;

use fra_model::State;

use super::build::Build;
use super::path::{Point, Work};

/// The equilibrium of a section, everything per undeformed length where a length belongs to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionState {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Stretch of the axis, which is the middle of the winding's surface, else of the outer one.
    pub axial_stretch: f64,
    /// `axial_stretch - 1`.
    pub axial_strain: f64,
    /// Bend per length, rad/m: towards the strain-limiting layer, and a quarter turn further.
    pub bend_rates_rad_per_m: [f64; 2],
    /// Twist per length, rad/m.
    pub twist_rate_rad_per_m: f64,
    /// Radius of a circle of the lumen's mean area, m.
    pub inner_radius_m: f64,
    /// Radius of a circle of the section's mean area, m.
    pub outer_radius_m: f64,
    /// Enclosed volume per length, m2.
    pub volume_m2: f64,
    /// Relative change of the enclosed volume.
    pub volume_strain: f64,
    /// Change of the enclosed volume per length by the pressure at constant load, m2/Pa.
    pub compliance_m2_per_pa: f64,
    /// Strain energy per length, J/m.
    pub energy_j_per_m: f64,
}

impl SectionState {
    /// The state of an actuator of some length, m, that is all such section. Bends in both directions become one angle.
    pub fn over(&self, length_m: f64) -> State<f64> {
        let [first, second] = self.bend_rates_rad_per_m;
        State {
            pressure_pa: self.pressure_pa,
            axial_stretch: self.axial_stretch,
            axial_strain: self.axial_strain,
            inner_radius_m: self.inner_radius_m,
            outer_radius_m: self.outer_radius_m,
            twist_rad: self.twist_rate_rad_per_m * length_m,
            bend_angle_rad: if second == 0.0 { first * length_m } else { first.hypot(second) * length_m },
            volume_m3: self.volume_m2 * length_m,
            volume_strain: self.volume_strain,
            compliance_m3_per_pa: self.compliance_m2_per_pa * length_m,
        }
    }
}

/// Error of discretisation: how far the answer of the finer mesh is from that of infinitely many elements, estimated from both meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Of the axial strain.
    pub axial_strain: f64,
    /// Of the bend rates, rad/m.
    pub bend_rates_rad_per_m: [f64; 2],
    /// Of the twist rate, rad/m.
    pub twist_rate_rad_per_m: f64,
    /// Of the outer radius, m.
    pub outer_radius_m: f64,
    /// Of the relative change of the volume.
    pub volume_strain: f64,
}

impl ErrorEstimate {
    /// Of the finer state, as `factor` times the difference.
    pub(super) fn between(fine: &SectionState, coarse: &SectionState, factor: f64) -> Self {
        let error = |fine: f64, coarse: f64| factor * (fine - coarse).abs();
        let bends = |i: usize| error(fine.bend_rates_rad_per_m[i], coarse.bend_rates_rad_per_m[i]);
        Self {
            axial_strain: error(fine.axial_strain, coarse.axial_strain),
            bend_rates_rad_per_m: [bends(0), bends(1)],
            twist_rate_rad_per_m: error(fine.twist_rate_rad_per_m, coarse.twist_rate_rad_per_m),
            outer_radius_m: error(fine.outer_radius_m, coarse.outer_radius_m),
            volume_strain: error(fine.volume_strain, coarse.volume_strain),
        }
    }
}

/// Change of the load on the section by small changes at constant pressure. Order: stretch, two bends, twist (1, 1/m, 1/m, 1/m), and
/// the loads that work on them: force, two bending moments, torque (N, N m, N m, N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Change of the loads by the strains, at constant pressure; symmetric.
    pub by_strain: [[f64; 4]; 4],
    /// Minus the change of the loads by the pressure at constant strains, which is the change of the volume per length by the strains at
    /// constant pressure: what the pressure pushes with, m2 and m3.
    pub lever: [f64; 4],
}

/// An equilibrium with what is known about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// The state on the finer mesh.
    pub state: SectionState,
    /// Its error of discretisation; `None` where the coarser mesh has no equilibrium, close below a limit pressure.
    pub error: Option<ErrorEstimate>,
    /// The stiffness; `None` where symmetry was used, since part of a section cannot tell.
    pub stiffness: Option<Stiffness>,
}

/// Outcome of the search for an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "a curve holds few of them, and they are copied like the numbers they are"
)]
pub enum Outcome {
    /// The stable equilibrium on the branch that begins without pressure.
    Equilibrium(Equilibrium),
    /// That branch ends before the pressure asked for.
    NoEquilibrium {
        /// About where it ends, gauge Pa.
        limit_pressure_pa: f64,
    },
    /// The branch ends before the load is applied, without pressure.
    LoadNotCarried,
    /// The iteration stopped without showing that the branch ends.
    NotConverged {
        /// Highest pressure reached, gauge Pa.
        reached_pressure_pa: f64,
    },
}

/// The answer to one pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The gauge pressure asked for, Pa.
    pub pressure_pa: f64,
    /// Outcome.
    pub outcome: Outcome,
}

impl Answer {
    /// The equilibrium, if there is one.
    pub fn equilibrium(&self) -> Option<&Equilibrium> {
        match &self.outcome {
            Outcome::Equilibrium(equilibrium) => Some(equilibrium),
            _ => None,
        }
    }

    /// Highest gauge pressure that the curve was followed to, Pa, at most that asked for.
    pub fn end_pa(&self) -> f64 {
        match self.outcome {
            Outcome::Equilibrium(_) => self.pressure_pa,
            Outcome::NoEquilibrium { limit_pressure_pa } => limit_pressure_pa,
            Outcome::LoadNotCarried => 0.0,
            Outcome::NotConverged { reached_pressure_pa } => reached_pressure_pa,
        }
    }
}

/// Work done for a curve on one of its two meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Steps of load and pressure that were taken.
    pub increments: u32,
    /// Steps that were taken back and shortened.
    pub rejected: u32,
    /// Linear systems solved in all, those of rejected steps included.
    pub newton_iterations: u32,
    /// Unknowns: displacements, pressures and strains.
    pub unknowns: usize,
}

impl Budget {
    pub(super) fn of(work: Work, unknowns: usize) -> Self {
        Self { increments: work.increments, rejected: work.rejected, newton_iterations: work.newton, unknowns }
    }
}

/// The state of a point, `rest_volume` being that of the undeformed mesh.
pub(super) fn state(build: &Build, point: &Point, rest_volume: f64) -> SectionState {
    let [stretch, first, second, twist] = point.state.form.strain;
    let (radius, area) = (build.radius_m, PI * build.radius_m * build.radius_m);
    // Relative to the mesh's own lumen, which is a little less than the circle.
    let strain = point.linear.volume / rest_volume - 1.0;
    let lumen = 1.0 + strain;
    let section = lumen + build.outer * build.outer - 1.0;
    SectionState {
        pressure_pa: point.state.pressure * build.modulus_pa,
        axial_stretch: stretch,
        axial_strain: stretch - 1.0,
        bend_rates_rad_per_m: [first / radius, second / radius],
        twist_rate_rad_per_m: twist / radius,
        inner_radius_m: radius * (lumen / stretch).sqrt(),
        outer_radius_m: radius * (section / stretch).sqrt(),
        volume_m2: area * lumen,
        volume_strain: strain,
        compliance_m2_per_pa: area * point.linear.compliance / (rest_volume * build.modulus_pa),
        energy_j_per_m: radius * radius * build.modulus_pa * point.linear.energy,
    }
}

/// The stiffness at a point, with units.
pub(super) fn stiffness(build: &Build, point: &Point) -> Stiffness {
    let units = build.load_units();
    let per_strain = [1.0, build.radius_m, build.radius_m, build.radius_m];
    Stiffness {
        by_strain: std::array::from_fn(|i| {
            std::array::from_fn(|j| point.linear.stiffness[i][j] * units[i] * per_strain[j])
        }),
        lever: std::array::from_fn(|i| point.linear.lever[i] * units[i] / build.modulus_pa),
    }
}
