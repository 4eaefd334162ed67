//! Settings beside the actuator's parameters: mesh, strain-limiting layer, symmetry, load.

use fra_model::{Load, Motion};

use super::error::SectionError;
use softlimb_files::range::{positive, require};

/// Most elements in either direction.
const MESH_MAX: usize = 128;

/// Size of the finer of the two meshes. The coarser one has half as many elements in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mesh {
    /// Elements through the wall: even, 2 to 128. A winding inside the wall splits them between its two sides, at least two each.
    /// Straight actuators have twice as many; two windings inside their wall add some, so that none is larger than without windings.
    pub radial: usize,
    /// Elements around half a turn: even, 4 to 128. Straight actuators are the same all around and need none.
    pub around: usize,
}

impl Default for Mesh {
    /// 4 elements through the wall and 16 around half a turn.
    fn default() -> Self {
        Self { radial: 4, around: 16 }
    }
}

/// Layer that keeps one side of the outer surface, in the direction of the bend, from lengthening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limiter {
    /// Nothing.
    None,
    /// A line that keeps its length, as in the bending model of [`fra_model`].
    Line,
    /// A strip along the outer surface.
    Strip {
        /// Half of the angle that the strip covers, seen from the axis, rad; 0.01 to pi/2.
        half_angle_rad: f64,
        /// Force per width and axial strain, N/m; > 0. Energy per area: an eighth of it times `(lambda^2 - 1)^2`.
        stiffness_n_per_m: f64,
    },
}

/// Which winding is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// The one that the parameters state, with its modulus. A bending actuator without one, or with one of no modulus, has the ideal one.
    Stated,
    /// Hoops that keep their length, at the stated winding radius or else at the outer one: that of [`fra_model`]'s bending model.
    Ideal,
}

/// Whether symmetry makes the model smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Straight actuators are a wedge, actuators that bend in their plane half a section.
    Exploit,
    /// Always the whole section with bends in both directions and twist. Gives the stiffness and sees bends to the side.
    Ignore,
}

/// All that a section is built from beside the actuator's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Size of the finer mesh.
    pub mesh: Mesh,
    /// The strain-limiting layer; `None` takes what belongs to the motion: a line in bending, nothing else.
    pub limiter: Option<Limiter>,
    /// Which winding is computed.
    pub winding: Winding,
    /// Whether symmetry is used.
    pub symmetry: Symmetry,
}

impl Default for Options {
    fn default() -> Self {
        Self { mesh: Mesh::default(), limiter: None, winding: Winding::Stated, symmetry: Symmetry::Exploit }
    }
}

impl Options {
    /// The strain-limiting layer of an actuator wound for a motion.
    pub(super) fn limiter_for(&self, motion: Motion) -> Limiter {
        self.limiter.unwrap_or(if motion == Motion::Bending { Limiter::Line } else { Limiter::None })
    }

    pub(super) fn check(&self) -> Result<(), SectionError> {
        let Mesh { radial, around } = self.mesh;
        let even = |n: usize, least: usize| n.is_multiple_of(2) && (least..=MESH_MAX).contains(&n);
        require(even(radial, 2), "mesh.radial", radial as f64, "even, 2 to 128")?;
        require(even(around, 4), "mesh.around", around as f64, "even, 4 to 128")?;
        if let Some(Limiter::Strip { half_angle_rad: angle, stiffness_n_per_m: stiffness }) = self.limiter {
            let right = std::f64::consts::FRAC_PI_2;
            require((0.01..=right).contains(&angle), "half_angle_rad", angle, "0.01 to pi/2")?;
            positive("stiffness_n_per_m", stiffness)?;
        }
        Ok(())
    }
}

/// External load on the end, in the frame of the section: it acts on the axis and turns with it.
///
/// The first bend is the one towards the strain-limiting layer, the second one a quarter turn further in the sense of the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndLoad {
    /// Force along the axis, N; tension is positive.
    pub force_n: f64,
    /// Bending moments, N m, each positive in the sense of its bend.
    pub bending_moments_nm: [f64; 2],
    /// Torque about the axis, N m.
    pub torque_nm: f64,
}

impl EndLoad {
    /// The load that [`fra_model::Load`] means on an actuator wound for a motion: in bending its torque is a bending moment.
    pub fn of(load: &Load<f64>, motion: Motion) -> Self {
        let bends = motion == Motion::Bending;
        let (bending, torque_nm) = if bends { (load.torque_nm, 0.0) } else { (0.0, load.torque_nm) };
        Self { force_n: load.force_n, bending_moments_nm: [bending, 0.0], torque_nm }
    }

    /// Force, the two bending moments, torque.
    pub(super) fn components(&self) -> [f64; 4] {
        [self.force_n, self.bending_moments_nm[0], self.bending_moments_nm[1], self.torque_nm]
    }

    pub(super) fn check(&self) -> Result<(), SectionError> {
        let names = ["force_n", "bending_moments_nm[0]", "bending_moments_nm[1]", "torque_nm"];
        for (name, value) in names.into_iter().zip(self.components()) {
            require(value.is_finite(), name, value, "finite")?;
        }
        Ok(())
    }
}
