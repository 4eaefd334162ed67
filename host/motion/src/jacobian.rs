//! Exact derivatives of points and axes of a limb without steering modules by the pressures of its modules.
//!
//! The end of a module's centre line moves with its parameters as [`Arc::change`] says; their change by the pressure is that of the state
//! curve, which the poses are made from, too.

use fra_model::{Motion, Segment, State};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::carrier::Carrier;
use softlimb_limb::arc::{Arc, Twist};
use softlimb_limb::{Limb, LimbModule};

/// A limb at given pressures, ready for derivatives.
pub(super) struct Differential<'a> {
    limb: &'a Limb,
    states: Vec<State<f64>>,
    slopes: Vec<State<f64>>,
    /// Pose of the start of each module, and of the tip.
    starts: Vec<Isometry3<f64>>,
    /// Position of each module's end, and what its pressure does there.
    ends: Vec<(Vector3<f64>, Twist)>,
}

impl<'a> Differential<'a> {
    /// At gauge pressures, Pa, one per module.
    pub(super) fn new(limb: &'a Limb, pressures_pa: &[f64]) -> Self {
        let modules = limb.modules();
        let states: Vec<_> = modules.iter().zip(pressures_pa).map(|(m, p)| m.curve.at(*p)).collect();
        let slopes: Vec<_> = modules.iter().zip(pressures_pa).map(|(m, p)| m.curve.slope_at(*p)).collect();
        let (mut starts, mut ends) = (vec![*limb.base()], Vec::new());
        for (index, module) in modules.iter().enumerate() {
            let start = starts[index];
            ends.push(place(module, &states[index], &slopes[index], &start, 1.0));
            starts.push(start * module.link(&states[index]).pose());
        }
        Self { limb, states, slopes, starts, ends }
    }

    /// The states.
    pub(super) fn states(&self) -> &[State<f64>] {
        &self.states
    }

    /// Pose of the tip.
    pub(super) fn tip(&self) -> &Isometry3<f64> {
        &self.starts[self.ends.len()]
    }

    /// Velocity of the tip by each pressure, m/Pa.
    pub(super) fn tip_velocities(&self) -> Vec<Vector3<f64>> {
        self.velocities(&self.tip().translation.vector, self.ends.len())
    }

    /// Rotation of the tip by each pressure, rad/Pa.
    pub(super) fn tip_rotations(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.ends.iter().map(|(_, twist)| twist.rotation)
    }

    /// Velocity by each pressure, m/Pa, of a point behind the first `count` modules that moves with the end of the last of them.
    fn velocities(&self, point_m: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
        let behind = |(end, twist): &(Vector3<f64>, Twist)| twist.velocity + twist.rotation.cross(&(point_m - end));
        let mut all: Vec<_> = self.ends.iter().take(count).map(behind).collect();
        all.resize(self.ends.len(), Vector3::zeros());
        all
    }

    /// Velocity by each pressure, m/Pa, of a point of the body: in `piece` of [`Limb::body`], or of what hangs from the tip behind it, at a share
    /// of its length; and the growth of the body's radius there.
    pub(super) fn body_velocities(
        &self,
        piece: usize,
        share: f64,
        point_m: &Vector3<f64>,
    ) -> (Vec<Vector3<f64>>, Vec<f64>) {
        let mut growth = vec![0.0; self.ends.len()];
        // What hangs from the tip does not turn with it.
        let Some((index, flexible)) = owner(self.limb, piece) else { return (self.tip_velocities(), growth) };
        if !flexible {
            return (self.velocities(point_m, index + 1), growth);
        }
        let mut all = self.velocities(point_m, index);
        let module = &self.limb.modules()[index];
        let (_, twist) = place(module, &self.states[index], &self.slopes[index], &self.starts[index], share);
        all[index] = twist.velocity;
        growth[index] = self.slopes[index].outer_radius_m;
        (all, growth)
    }
}

/// The module that a piece of the body belongs to, and whether it is its flexible part.
fn owner(limb: &Limb, piece: usize) -> Option<(usize, bool)> {
    let parts = limb.modules().iter().enumerate().flat_map(|(index, module)| {
        let rigid = module.rigid_parts_m().into_iter().filter(|length| *length > 0.0).map(move |_| (index, false));
        std::iter::once((index, true)).chain(rigid)
    });
    parts.into_iter().nth(piece)
}

/// The place at a share of a module's length, and what the module's pressure does there.
fn place(
    module: &LimbModule,
    state: &State<f64>,
    slope: &State<f64>,
    start: &Isometry3<f64>,
    share: f64,
) -> (Vector3<f64>, Twist) {
    let link = module.link(state);
    let mount = start.rotation * UnitQuaternion::from_scaled_axis(Vector3::z() * link.mount_angle_rad);
    let scaled = |segment: Segment<f64>| Segment {
        length_m: segment.length_m * share,
        bend_angle_rad: segment.bend_angle_rad * share,
        twist_rad: segment.twist_rad * share,
    };
    let arc = |segment| Arc::from(&scaled(segment));
    let local = arc(link.segment).change(&arc(segment_slope(module, slope)));
    let at = (start * link.pose_at(share)).translation.vector;
    (at, Twist { velocity: mount * local.velocity, rotation: mount * local.rotation })
}

/// Derivative of a module's centre line by its pressure, 1/Pa; that of [`LimbModule::link`].
fn segment_slope(module: &LimbModule, slope: &State<f64>) -> Segment<f64> {
    let [bend_angle_rad, twist_rad] = match module.motion {
        Motion::Extension | Motion::Expansion => [0.0; 2],
        Motion::Bending => [slope.bend_angle_rad, slope.twist_rad],
        Motion::Twisting => [0.0, slope.twist_rad],
    };
    Segment { length_m: module.length_m() * slope.axial_stretch, bend_angle_rad, twist_rad }
}

/// How the tip moves without load, m/Pa, and the drive's setpoint, per Pa, with the pressure of each drive.
pub fn tip_slopes(limb: &Limb, states: &[State<f64>]) -> Vec<(Vector3<f64>, f64)> {
    let pressures_pa: Vec<f64> = states.iter().map(|state| state.pressure_pa).collect();
    // A limb without load always has a posture.
    let velocities = Carrier::free(limb).posture(&pressures_pa).map_or_else(Vec::new, |at| at.tip_velocities());
    let drives = limb.drives().zip(&pressures_pa);
    let slopes = drives.map(|(drive, pressure_pa)| drive.measure(&drive.curve.slope_at(*pressure_pa)));
    velocities.into_iter().zip(slopes).collect()
}
