//! The shortest time of a move: within the rates of `[limits]`, and what valves and supply can do.

use super::air::{Air, Bottleneck, Reservoir};
use super::profile::PEAK_RATE;
use fra_model::StateQuantity;
use softlimb_limb::Limb;
use softlimb_scene::{Limits, Scene};

/// Shortest move, s; also that of a move to where the limb is.
const SHORTEST_S: f64 = 0.1;
/// Longest move that is considered, s, the longest a scene may ask for.
const LONGEST_S: f64 = 600.0;
/// Times are rounded up to this, s.
const STEP_S: f64 = 0.01;

/// The shortest time of a move, and its cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shortest {
    /// The shortest time, s.
    pub(super) time_s: f64,
    /// Its cause; `None` for the shortest of all moves.
    pub(super) because: Option<Bottleneck>,
}

/// The shortest time of a straight move between two rows of setpoints with the supply as it is; `None` where the supply never allows it,
/// within ten minutes.
pub(super) fn shortest(
    scene: &Scene,
    limb: &Limb,
    air: &Air<'_>,
    rows: (&[f64], &[f64]),
    supply: Reservoir,
) -> Option<Shortest> {
    let (mut time_s, mut because) = (SHORTEST_S, None);
    for (index, (drive, (a, b))) in limb.drives().zip(rows.0.iter().zip(rows.1)).enumerate() {
        let Some(limit) = rate_max(scene.limits(), drive.kind) else { continue };
        let needed_s = PEAK_RATE * (b - a).abs() / limit;
        if needed_s > time_s {
            (time_s, because) = (needed_s, Some(Bottleneck::Rate(index)));
        }
    }
    let Some(draw) = air.draw(rows.0, rows.1) else { return Some(rounded(time_s, because)) };
    let Err(first) = air.after(&draw, time_s, supply) else { return Some(rounded(time_s, because)) };
    // Doubled until it is enough, then halved between.
    let (mut short_s, mut long_s, mut why) = (time_s, time_s, first);
    while let Err(bottleneck) = air.after(&draw, long_s, supply) {
        (short_s, why) = (long_s, bottleneck);
        long_s *= 2.0;
        if short_s > LONGEST_S {
            return None;
        }
    }
    while long_s - short_s > 0.25 * STEP_S {
        let middle = 0.5 * (short_s + long_s);
        match air.after(&draw, middle, supply) {
            Ok(_) => long_s = middle,
            Err(bottleneck) => (short_s, why) = (middle, bottleneck),
        }
    }
    Some(rounded(long_s, Some(why)))
}

fn rounded(time_s: f64, because: Option<Bottleneck>) -> Shortest {
    Shortest { time_s: (time_s / STEP_S - 1e-6).ceil() * STEP_S, because }
}

/// The largest rate of a quantity, in its unit per second.
pub(super) fn rate_max(limits: &Limits, kind: StateQuantity) -> Option<f64> {
    match kind {
        StateQuantity::AxialStretch => limits.stretch_rate_max_per_s,
        StateQuantity::OuterRadius | StateQuantity::InnerRadius => limits.radius_rate_max_m_per_s,
        StateQuantity::Twist | StateQuantity::BendAngle => limits.angle_rate_max_rad_per_s,
        StateQuantity::Pressure => None,
    }
}
