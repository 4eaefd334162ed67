//! The answers every method is measured against: another formulation, its own quadrature, its own way to the root, and twice the
//! digits.
//!
//! Straight tubes are solved from the equilibrium of stresses in the textbook form with 100 Gauss-Legendre nodes in `R`
//! ([`straight`]), bends from the energy of the deformed section ([`bend`]), both in double-double arithmetic. The branch is followed
//! from rest in double precision, by the same equations, so that no answer of the product is used on the way.

mod bend;
mod newton;
mod straight;
#[cfg(test)]
mod tests;

use fra_model::{ActuatorParameters, Motion};
use qd::Quad;
use serde::Serialize;

use self::bend::Section;
use self::newton::{Root, root};
use self::straight::Tube;
use super::gauss::Rule;
use super::number::Number;
use super::set::Sample;

/// Nodes across the wall, and those of the rule that tells how much the first leaves open.
const NODES: u32 = 100;
const FEWER_NODES: u32 = 80;
/// Nodes across the wall of a bend, whose energy is smoother, and of the rule beside it.
const BEND_NODES: u32 = 32;
const FEWER_BEND_NODES: u32 = 26;
/// Nodes on the way from rest.
const ROUGH_NODES: u32 = 24;
/// Shortest step on that way, as a share of the pressure.
const SHORTEST: f64 = 1e-4;

/// What is true of a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truth {
    /// At the sample's pressure: axial strain, relative change of the lumen's volume and twist rate times `R_i`; of a bend, the
    /// angle, rad.
    pub(super) deformation: [Quad; 3],
    /// The deformation an inverse is asked for, in its own unit and held exactly by single precision.
    pub(super) target: f64,
    /// The state at the target, in the terms of `deformation`.
    pub(super) at_target: [Quad; 3],
    /// The pressure at the target, Pa.
    pub(super) pressure: Quad,
    /// What is left open.
    pub(super) doubt: Doubt,
}

/// How well the truth is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Doubt {
    /// Largest residual of the equations in units of the shear modulus.
    pub residual: f64,
    /// Last step of Newton's method, over the largest coordinate.
    #[serde(rename = "last_step")]
    pub step: f64,
    /// What the solution moves by when the rule has fewer nodes, over the largest coordinate.
    pub quadrature: f64,
}

impl Doubt {
    /// The worse of both.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            residual: self.residual.max(other.residual),
            step: self.step.max(other.step),
            quadrature: self.quadrature.max(other.quadrature),
        }
    }
}

/// The rules, built once.
pub(super) struct Reference {
    rough: Rule<f64>,
    wall: [Rule<Quad>; 2],
    section: [Rule<Quad>; 2],
}

impl Reference {
    pub(super) fn new() -> Self {
        Self {
            rough: Rule::new(ROUGH_NODES),
            wall: [NODES, FEWER_NODES].map(Rule::new),
            section: [BEND_NODES, FEWER_BEND_NODES].map(Rule::new),
        }
    }

    /// The truth about a sample; `None` where the branch from rest does not reach its pressure.
    pub(super) fn truth(&self, sample: &Sample) -> Option<Truth> {
        match sample.parameters.motion {
            Motion::Bending => self.bend(sample),
            _ => self.straight(sample),
        }
    }

    fn straight(&self, sample: &Sample) -> Option<Truth> {
        let p = &sample.parameters;
        let rough = Tube::new(p, &self.rough);
        let unknowns = if rough.twists() { 3 } else { 2 };
        let wanted = sample.pressure_pa / p.material.shear_modulus_pa();
        let near = follow(unknowns, |share, at| {
            let [pressure, force, torque] = rough.loads(at);
            [pressure - share * wanted, force, torque]
        })?;
        let exact = |rule: &Rule<Quad>, start: [Quad; 3]| {
            let tube = Tube::new(p, rule);
            let wanted = Quad::of(sample.pressure_pa) / Quad::of(p.material.shear_modulus_pa());
            root(start, unknowns, 20, |at| {
                let [pressure, force, torque] = tube.loads(at);
                [pressure - wanted, force, torque]
            })
        };
        let found = exact(&self.wall[0], near.map(Quad::of))?;
        let doubt = doubt(&found, &exact(&self.wall[1], found.at)?);
        let target = f64::from(target(p, found.at).nearest() as f32);
        let tube = Tube::new(p, &self.wall[0]);
        let goal = goal(p, target);
        let reached = root(found.at, unknowns, 20, |at| {
            let [_, force, torque] = tube.loads(at);
            [goal(at), force, torque]
        })?;
        let pressure = tube.loads(reached.at)[0] * Quad::of(p.material.shear_modulus_pa());
        Some(Truth { deformation: found.at, target, at_target: reached.at, pressure, doubt })
    }

    fn bend(&self, sample: &Sample) -> Option<Truth> {
        let p = &sample.parameters;
        let mu = p.material.shear_modulus_pa();
        let zero = Quad::of(0.0);
        let rough = Section::new(p, &self.rough);
        let near = follow(1, |share, [k, _, _]| [rough.pressure(k) - share * sample.pressure_pa / mu, 0.0, 0.0])?;
        let exact = |rule: &Rule<Quad>, start: Quad| {
            let section = Section::new(p, rule);
            let wanted = Quad::of(sample.pressure_pa) / Quad::of(mu);
            root([start, zero, zero], 1, 20, |[k, _, _]| [section.pressure(k) - wanted, zero, zero])
        };
        let found = exact(&self.section[0], Quad::of(near[0]))?;
        let doubt = doubt(&found, &exact(&self.section[1], found.at[0])?);
        let per_curvature = Quad::of(p.length_m) / Quad::of(p.outer_radius_m);
        let angle = found.at[0] * per_curvature;
        let target = f64::from(angle.nearest() as f32);
        let k = Quad::of(target) / per_curvature;
        let pressure = Section::new(p, &self.section[0]).pressure(k) * Quad::of(mu);
        let bent = |angle: Quad| [angle, zero, zero];
        Some(Truth { deformation: bent(angle), target, at_target: bent(Quad::of(target)), pressure, doubt })
    }
}

/// Raises the pressure from rest in steps that Newton's method can follow.
fn follow(unknowns: usize, residuals: impl Fn(f64, [f64; 3]) -> [f64; 3]) -> Option<[f64; 3]> {
    let (mut at, mut before) = ([0.0; 3], [0.0; 3]);
    let (mut share, mut last_step, mut step) = (0.0f64, f64::INFINITY, 0.05f64);
    while share < 1.0 {
        let next = (share + step).min(1.0);
        let ahead = (next - share) / last_step;
        let guess = [0, 1, 2].map(|axis| at[axis] + (at[axis] - before[axis]) * ahead);
        let found = root(guess, unknowns, 12, |state| residuals(next, state));
        // A jump would leave the branch.
        let moved = |to: [f64; 3]| (0..3).map(|axis| (to[axis] - guess[axis]).abs()).fold(0.0, f64::max);
        match found.filter(|found| moved(found.at) < 0.1) {
            Some(found) => {
                (before, last_step) = (at, next - share);
                (at, share) = (found.at, next);
                step = (step * 1.5).min(0.1);
            }
            None => step *= 0.25,
        }
        if step < SHORTEST {
            return None;
        }
    }
    Some(at)
}

fn doubt(found: &Root<Quad>, beside: &Root<Quad>) -> Doubt {
    let size = found.at.iter().map(|value| value.nearest().abs()).fold(0.0, f64::max);
    let moved = found.at.iter().zip(beside.at).map(|(a, b)| (*a - b).nearest().abs()).fold(0.0, f64::max);
    Doubt { residual: found.residual, step: found.step, quadrature: moved / size }
}

/// The deformation a motion is made for: stretch, outer radius in m, twist in rad.
fn target(p: &ActuatorParameters<f64>, [e, w, g]: [Quad; 3]) -> Quad {
    let one = Quad::of(1.0);
    let (inner, outer) = (Quad::of(p.inner_radius_m), Quad::of(p.outer_radius_m));
    match p.motion {
        Motion::Expansion => Number::sqrt((inner * inner * (one + w) + outer * outer - inner * inner) / (one + e)),
        Motion::Twisting => g * Quad::of(p.length_m) / inner,
        Motion::Extension | Motion::Bending => one + e,
    }
}

/// How far a state is from a target.
fn goal(p: &ActuatorParameters<f64>, wanted: f64) -> impl Fn([Quad; 3]) -> Quad {
    let p = *p;
    // Over the size of the target, so that the equation is of the size of the others.
    move |at| (target(&p, at) - Quad::of(wanted)) / Quad::of(wanted)
}
