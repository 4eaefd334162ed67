//! Exact derivatives of points and axes of a limb without steering modules by the pressures of its modules.
//!
//! The end of a module's centre line moves with its parameters as [`Arc::change`] says; their change by the pressure is that of the state
//! curve, which the poses are made from, too.

use fra_model::{Link, Segment, State};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::carrier::Carrier;
use softlimb_limb::Limb;
use softlimb_limb::arc::{Arc, Twist};

/// A limb at given pressures, ready for derivatives.
pub(super) struct Differential<'a> {
    limb: &'a Limb,
    states: Vec<State<f64>>,
    /// From the base outwards.
    links: Vec<Moved>,
    tip: Isometry3<f64>,
}

/// A link and its derivatives by the pressure of its module.
struct Moved {
    /// Index of its module; a series has several links.
    module: usize,
    link: Link<f64>,
    /// Derivative of its centre line by the pressure, 1/Pa.
    slope: Segment<f64>,
    /// Growth of its radius, m/Pa.
    growth: f64,
    /// Pose of its start.
    start: Isometry3<f64>,
    /// Position of the end of its centre line, and its derivatives by the pressure.
    end: (Vector3<f64>, Twist),
}

impl<'a> Differential<'a> {
    /// At gauge pressures, Pa, one per module.
    pub(super) fn new(limb: &'a Limb, pressures_pa: &[f64]) -> Self {
        let modules = limb.modules();
        let states: Vec<_> = modules.iter().zip(pressures_pa).map(|(m, p)| m.curve.at(*p)).collect();
        let (mut tip, mut links) = (*limb.base(), Vec::new());
        for (module, state) in states.iter().enumerate() {
            let slopes = modules[module].link_slopes(state.pressure_pa);
            for (link, (slope, growth)) in modules[module].links(state).into_iter().zip(slopes) {
                let end = place(&link, &slope, &tip, 1.0);
                links.push(Moved { module, link, slope, growth, start: tip, end });
                tip *= link.pose();
            }
        }
        Self { limb, states, links, tip }
    }

    /// The states.
    pub(super) fn states(&self) -> &[State<f64>] {
        &self.states
    }

    /// Pose of the tip.
    pub(super) fn tip(&self) -> &Isometry3<f64> {
        &self.tip
    }

    /// Velocity of the tip by each pressure, m/Pa.
    pub(super) fn tip_velocities(&self) -> Vec<Vector3<f64>> {
        self.velocities(&self.tip.translation.vector, self.links.len())
    }

    /// Rotation of the tip by each pressure, rad/Pa.
    pub(super) fn tip_rotations(&self) -> impl Iterator<Item = Vector3<f64>> {
        let mut all = vec![Vector3::zeros(); self.states.len()];
        self.links.iter().for_each(|moved| all[moved.module] += moved.end.1.rotation);
        all.into_iter()
    }

    /// Velocity by each pressure, m/Pa, of a point behind the first `count` links that moves with the end of the last of them.
    fn velocities(&self, point_m: &Vector3<f64>, count: usize) -> Vec<Vector3<f64>> {
        let mut all = vec![Vector3::zeros(); self.states.len()];
        for Moved { module, end: (end, twist), .. } in self.links.iter().take(count) {
            all[*module] += twist.velocity + twist.rotation.cross(&(point_m - end));
        }
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
        let mut growth = vec![0.0; self.states.len()];
        // What hangs from the tip does not turn with it.
        let Some((index, flexible)) = owner(self.limb, piece) else { return (self.tip_velocities(), growth) };
        if !flexible {
            return (self.velocities(point_m, index + 1), growth);
        }
        let mut all = self.velocities(point_m, index);
        let moved = &self.links[index];
        let (_, twist) = place(&moved.link, &moved.slope, &moved.start, share);
        all[moved.module] += twist.velocity;
        growth[moved.module] = moved.growth;
        (all, growth)
    }
}

/// The link that a piece of the body belongs to, and whether it is its flexible part.
fn owner(limb: &Limb, piece: usize) -> Option<(usize, bool)> {
    let mut before = 0;
    let parts = limb.modules().iter().flat_map(|module| {
        let first = before;
        before += module.segments().len().max(1);
        let rigid = module.rigid_parts_m().into_iter().filter(|length| *length > 0.0);
        let last = before - 1;
        (first..before).map(|link| (link, true)).chain(rigid.map(move |_| (last, false)))
    });
    parts.into_iter().nth(piece)
}

/// The place at a share of a link's length, and its derivatives by the pressure of the module.
fn place(link: &Link<f64>, slope: &Segment<f64>, start: &Isometry3<f64>, share: f64) -> (Vector3<f64>, Twist) {
    let mount = start.rotation * UnitQuaternion::from_scaled_axis(Vector3::z() * link.mount_angle_rad);
    let scaled = |segment: &Segment<f64>| Segment {
        length_m: segment.length_m * share,
        bend_angle_rad: segment.bend_angle_rad * share,
        twist_rad: segment.twist_rad * share,
    };
    let arc = |segment| Arc::from(&scaled(segment));
    let local = arc(&link.segment).change(&arc(slope));
    let at = (start * link.pose_at(share)).translation.vector;
    (at, Twist { velocity: mount * local.velocity, rotation: mount * local.rotation })
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
