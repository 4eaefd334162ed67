//! How far a bundle of bending actuators bends between its plates, of the bend of one alone.
//!
//! Plates that bend by `k` ask a strip line at the height `y` for the length `(1 + k y) L`. Lines at one height share a length and bend freely;
//! lines at different heights would have to stretch. `docs/explanation/bundles.md` derives the shares.

use fra_model::Motion;
use nalgebra::{Matrix2, Vector2};
use softlimb_scene::{Module, Scene, SceneError};

use super::bundle::energy;
use super::tube::{LINE, Tangent};
use crate::LimbModule;

/// Least share of the bend of one actuator that a bundle reaches; below it the kinematics of a limb would not be the bundle's.
pub const BEND_SHARE_MIN: f64 = 0.9;

/// Shares of the bend of one actuator alone that a bundle of equal ones reaches between rigid plates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendShare {
    /// Where each line holds, pulled or pushed.
    pub held: f64,
    /// Where a line that is pushed goes slack and leaves its wall alone; the larger of the two.
    pub slack: f64,
}

impl BendShare {
    /// Of equal bending actuators at places `[x, y]` of the section, m, that bend towards `x`.
    ///
    /// Small strains about the shape of one actuator, by the energies that [`Bundle`](super::Bundle) has. `None` where the actuator does not
    /// bend, or for no actuators.
    pub fn of(positions_m: &[[f64; 2]], tube: &Tangent) -> Option<Self> {
        let stiff = |is_slack: bool| if is_slack { Tangent { axial_n: tube.axial_n / LINE, ..*tube } } else { *tube };
        let mut slack = vec![false; positions_m.len()];
        let held = shape(positions_m, &slack, stiff)?;
        // A line is slack where the plates are closer than its length. No more than a few lines change, each at most a few times.
        let mut found = held;
        for _ in 0..=positions_m.len() {
            let own = tube.line_stretch();
            let strain = |[x, _]: &[f64; 2]| found[0] - found[1] * (x + tube.outer_radius_m) - own;
            let pushed: Vec<bool> = positions_m.iter().map(|at| strain(at) < -1e-12).collect();
            if pushed == slack {
                break;
            }
            slack = pushed;
            found = shape(positions_m, &slack, stiff)?;
        }
        let share = |bend: f64| bend / tube.bend_rad_per_m;
        let (held, slack) = (share(held[1]), share(found[1]));
        (held.is_finite() && slack.is_finite()).then_some(Self { held, slack: slack.max(held) })
    }

    /// Of a module at the highest pressure of its curve that has an equilibrium; `None` for another motion than bending.
    pub fn of_module(module: &LimbModule) -> Option<Self> {
        (module.motion == Motion::Bending).then_some(())?;
        let pressed = module.curve.states().iter().rev().filter(|state| state.pressure_pa > 0.0);
        let tangent = pressed.filter_map(|state| Tangent::of(&module.actuator, state.pressure_pa)).next()?;
        Self::of(&module.positions_m(), &tangent)
    }
}

/// Stretch and bend of the bundle at which its energy is least.
fn shape(positions_m: &[[f64; 2]], slack: &[bool], tube: impl Fn(bool) -> Tangent) -> Option<Vector2<f64>> {
    let (mut stiffness, mut force) = (Matrix2::zeros(), Vector2::zeros());
    for (at, is_slack) in positions_m.iter().zip(slack) {
        let (own, rest) = energy(Motion::Bending, *at, &tube(*is_slack));
        stiffness += own.fixed_view::<2, 2>(0, 0);
        force += (own * rest).fixed_rows::<2>(0);
    }
    Some(stiffness.cholesky()?.solve(&force))
}

/// Refuses modules whose bending actuators hold each other: between rigid plates they would bend by less than [`BEND_SHARE_MIN`] of one alone.
///
/// # Errors
/// A diagnostic at the first such module, with its shares and the arrangements that bend.
///
/// # Panics
/// When there are not as many modules as the scene has.
pub fn check_bundles(scene: &Scene, modules: &[LimbModule]) -> Result<(), SceneError> {
    assert_eq!(scene.modules().len(), modules.len(), "a module of the limb for each of the scene");
    scene.modules().iter().zip(modules).try_for_each(|(module, built)| check(scene, module, built))
}

fn check(scene: &Scene, module: &Module, built: &LimbModule) -> Result<(), SceneError> {
    if module.actuators == 1 {
        return Ok(());
    }
    let Some(share) = BendShare::of_module(built).filter(|share| share.slack < BEND_SHARE_MIN) else { return Ok(()) };
    let title = format!("the bending actuators of `{}` hold each other", *module.name);
    let label = format!(
        "on a circle this bundle reaches {:.1} % of the free bend; {:.0} % if pushed strips go slack",
        100.0 * share.held,
        100.0 * share.slack
    );
    let help = format!(
        "at least {:.0} % is needed: `arrangement = \"row\"` with a `spacing` from {:.3} mm on, or `actuators = 1`",
        100.0 * BEND_SHARE_MIN,
        2e3 * *module.outer_radius_m
    );
    Err(scene.diagnostic(module.span, &title, &label, Some(&help)))
}
