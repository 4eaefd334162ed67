//! The equations of `docs/explanation/model.md`, sections 2 to 6, 10 and 11, once in quantities with dimensions: that they compile is the audit. Each is a
//! function, named after the paper's equation it is or replaces where there is one; the tests compare its value with the crate's.
//!
//! Equations of the paper that fail the audit as printed:
//! - (1), general form: the entry `r dtheta/dTheta` is a length, the others are numbers.
//! - (6), second line: `d sigma_rt/d sigma_rt` is a number among terms in Pa/m.
//! - (11), (13): the factor `L` makes a moment N m2 and a pressure N/m (`eq_11_and_13_printed_*`).
//! - (14): adds m2 and rad2 under weights without units (`eq_14_printed_*`).
//! - (18): squares a wrench, and so adds N2 and N2 m2 (`eq_18_printed_*`).
//!
//! What is wrong with (7), (8), (9), (10) and (12) has the right dimension; other tests find that.

mod bending;
mod derivatives;
mod materials;
mod printed;
mod strains;
mod tube;

use std::f64::consts::{PI, TAU};
use std::marker::PhantomData;

use crate::common::*;
use fra_model::*;
use uom::si::angle::radian;
use uom::si::area::square_meter;
use uom::si::f64::{Angle, Area, Energy, Force, Length, Pressure, Ratio, ReciprocalLength, Torque, Volume};
use uom::si::force::newton;
use uom::si::length::{meter, millimeter};
use uom::si::pressure::pascal;
use uom::si::torque::{newton_meter, newton_millimeter};
use uom::si::volume::cubic_meter;
use uom::si::{Dimension, ISQ, Quantity, SI};
use uom::typenum::{N2, N4, P1, P2, P3, P4, Z0};

use bending::*;
use materials::*;
use tube::*;

type Q<D> = Quantity<D, SI<f64>, f64>;
/// Length to the power `L`, times mass over time squared.
type Mechanical<L> = Q<ISQ<L, P1, N2, Z0, Z0, Z0, Z0>>;
/// N/m: energy per area, tension of a sheet, stiffness.
type ForcePerLength = Mechanical<Z0>;
/// N2 for `P2`, N2 m2 for `P4`.
type Squared<L> = Q<ISQ<L, P2, N4, Z0, Z0, Z0, Z0>>;
type Tensor = [[Ratio; 3]; 3];

/// Panels of Simpson's rule.
const PANELS: u32 = 200;
/// Step of the numerical derivatives, as a share of the quantity or of 1 rad.
const STEP: f64 = 1e-3;
const ONE: Ratio = Ratio { dimension: PhantomData, units: PhantomData, value: 1.0 };

fn m(value: f64) -> Length {
    Length::new::<meter>(value)
}

fn pa(value: f64) -> Pressure {
    Pressure::new::<pascal>(value)
}

fn rad(value: f64) -> Angle {
    Angle::new::<radian>(value)
}

/// Mean over a range of which shares from 0 to 1 are given, by Simpson's rule; times the range it is the integral.
fn mean<D>(panels: u32, f: impl Fn(f64) -> Q<D>) -> Q<D>
where
    D: Dimension<Kind = dyn uom::Kind> + ?Sized,
{
    let weighted = |i: u32| {
        let weight = if i == 0 || i == 2 * panels { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        f(f64::from(i) / f64::from(2 * panels)) * (weight / f64::from(6 * panels))
    };
    (1..=2 * panels).fold(weighted(0), |sum, i| sum + weighted(i))
}

/// Change of `f` over one step, from values up to two steps away; over the step it is the derivative.
fn change<D>(f: impl Fn(f64) -> Q<D>) -> Q<D>
where
    D: Dimension<Kind = dyn uom::Kind> + ?Sized,
{
    (f(1.0) - f(-1.0)) * (2.0 / 3.0) - (f(2.0) - f(-2.0)) * (1.0 / 12.0)
}

#[track_caller]
fn close<D: Dimension + ?Sized>(found: Q<D>, expected: Q<D>, tolerance: Q<D>) {
    let error = (found.value - expected.value).abs();
    assert!(error <= tolerance.value, "{} against {}: off by {error:e}", found.value, expected.value);
}
