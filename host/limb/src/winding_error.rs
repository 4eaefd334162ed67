//! Effect of an error of the winding angle on a bend.

use std::f64::consts::{FRAC_PI_2, PI};

use fra_model::{Actuator, ActuatorParameters, Fiber, Load, Motion, Status};

use softlimb_fea::cross_section::{EndLoad, Options, Section, is_wound_bender};

use crate::LimbModule;

/// Error of the winding angle that answers state the effect of, rad.
pub const WINDING_ERROR_RAD: f64 = 2.0 * PI / 180.0;

/// A gauge pressure and the bend that an actuator has there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Bend angle, rad.
    pub bend_angle_rad: f64,
}

/// The largest relative change of the bends of a wound bender if every winding is [`WINDING_ERROR_RAD`] nearer to the hoop, or farther from it.
///
/// Finite elements give the changed bends; without `by_section` it is the analytic model, where that follows the angle. `None` of other actuators, and where a changed
/// winding has no bend at any of the pressures.
pub fn winding_effect(
    parameters: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    bends: &[Bent],
    load: &Load<f64>,
    by_section: bool,
) -> Option<f64> {
    let bends: Vec<Bent> = bends.iter().copied().filter(|bent| bent.pressure_pa > 0.0).collect();
    if !is_wound_bender(parameters) || bends.is_empty() {
        return None;
    }
    let follows_angle = second_fiber.is_none() && parameters.fiber.is_some_and(|fiber| fiber.shrinks_bends());
    let pressures_pa: Vec<f64> = bends.iter().map(|bent| bent.pressure_pa).collect();
    let changed = [-WINDING_ERROR_RAD, WINDING_ERROR_RAD].map(|error| {
        let second = second_fiber.map(|fiber| turned(*fiber, error));
        let wound = ActuatorParameters { fiber: parameters.fiber.map(|fiber| turned(fiber, error)), ..*parameters };
        if by_section || !follows_angle {
            by_finite_elements(&wound, second.as_ref(), &pressures_pa, load)
        } else {
            analytic(&wound, &pressures_pa, load)
        }
    });
    let change = |(index, bent): (usize, &Bent)| {
        let changes = changed.iter().map(|bends| Some((bends.get(index).copied()?? / bent.bend_angle_rad - 1.0).abs()));
        changes.collect::<Option<Vec<_>>>()?.into_iter().reduce(f64::max)
    };
    bends.iter().enumerate().filter_map(change).filter(|change| change.is_finite()).reduce(f64::max)
}

/// The [`winding_effect`] on the bends of an actuator without load, up to a gauge pressure, Pa; the bends are by the same model.
pub fn winding_effect_up_to(
    parameters: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressure_max_pa: f64,
    by_section: bool,
) -> Option<f64> {
    let (load, pressures_pa) = (Load::none(), SHARES.map(|share| share * pressure_max_pa));
    if !is_wound_bender(parameters) || pressure_max_pa <= 0.0 {
        return None;
    }
    let angles = if by_section || second_fiber.is_some() {
        by_finite_elements(parameters, second_fiber, &pressures_pa, &load)
    } else {
        analytic(parameters, &pressures_pa, &load)
    };
    let bent = |(pressure_pa, angle): (f64, Option<f64>)| Some(Bent { pressure_pa, bend_angle_rad: angle? });
    let bends: Vec<Bent> = pressures_pa.into_iter().zip(angles).filter_map(bent).collect();
    winding_effect(parameters, second_fiber, &bends, &load, by_section)
}

/// Pressures at which an actuator states the effect, as shares of the highest.
const SHARES: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];

impl LimbModule {
    /// The [`winding_effect`] on its bends over its pressures; of a series the largest of its segments. `None` where nothing bends by a stated winding.
    pub fn winding_effect(&self) -> Option<f64> {
        let of_part = |part: &Self| {
            let most_pa = part.curve.pressure_max_pa();
            let bent = |share: f64| Bent {
                pressure_pa: share * most_pa,
                bend_angle_rad: part.curve.at(share * most_pa).bend_angle_rad,
            };
            let parameters = part.actuator.parameters();
            winding_effect(parameters, part.second_fiber(), &SHARES.map(bent), &Load::none(), part.is_by_section())
        };
        self.parts().iter().filter_map(of_part).reduce(f64::max)
    }
}

/// Farther from the hoop or nearer to it, on either side. Beyond the axis it is a winding of the other hand.
fn turned(fiber: Fiber<f64>, error_rad: f64) -> Fiber<f64> {
    let angle_rad = fiber.angle_rad + error_rad * fiber.angle_rad.signum();
    let beyond = if angle_rad.abs() > FRAC_PI_2 { PI * angle_rad.signum() } else { 0.0 };
    Fiber { angle_rad: angle_rad - beyond, ..fiber }
}

fn by_finite_elements(
    wound: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressures_pa: &[f64],
    load: &Load<f64>,
) -> Vec<Option<f64>> {
    let section = match second_fiber {
        None => Section::new(wound, &Options::default()),
        Some(second) => Section::with_two_windings(wound, second, &Options::default()),
    };
    let curve = section.and_then(|section| section.curve(pressures_pa, &EndLoad::of(load, Motion::Bending)));
    let answers = curve.map(|curve| curve.answers).unwrap_or_default();
    answers.iter().map(|answer| Some(answer.equilibrium()?.state.over(wound.length_m).bend_angle_rad)).collect()
}

fn analytic(wound: &ActuatorParameters<f64>, pressures_pa: &[f64], load: &Load<f64>) -> Vec<Option<f64>> {
    let Ok(actuator) = Actuator::new(wound) else { return Vec::new() };
    let bend = |pressure_pa: &f64| {
        let solution = actuator.forward(*pressure_pa, load).ok()?;
        (solution.status == Status::Solved).then_some(solution.state.bend_angle_rad)
    };
    pressures_pa.iter().map(bend).collect()
}
