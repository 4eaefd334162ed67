//! Places of the actuators of a bundle on its connector.

use crate::number::real::{Real, real};
use crate::number::sin_cos;

/// Places of equal actuators, seen along the bundle's axis; bending actuators bend towards the first coordinate, `x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrangement<T> {
    /// Evenly on a circle about the bundle's axis, the first one towards `x`.
    Circle {
        /// Distance of each axis from the bundle's, m; >= 0.
        radius_m: T,
    },
    /// In a row along `y`, centred on the bundle's axis: along the axis of bending, so that all strips are at one height.
    Row {
        /// Distance of neighbouring axes, m; > 0 for two or more actuators.
        spacing_m: T,
    },
}

/// A number of actuators as a scalar.
fn scalar<T: Real>(count: u8) -> T {
    real::<T>(f64::from(count))
}

impl<T: Real> Arrangement<T> {
    /// Place `[x, y]` of one of `count` actuators, m; `index` is from 0 to `count - 1`.
    pub fn position_m(&self, index: u8, count: u8) -> [T; 2] {
        match self {
            Self::Circle { radius_m } => {
                let turn = real::<T>(core::f64::consts::TAU) * scalar(index) / scalar(count.max(1));
                let (sin, cos) = sin_cos(turn);
                [*radius_m * cos, *radius_m * sin]
            }
            Self::Row { spacing_m } => {
                let middle = real::<T>(0.5) * scalar(count.saturating_sub(1));
                [T::zero(), *spacing_m * (scalar::<T>(index) - middle)]
            }
        }
    }

    /// Places `[x, y]` of `count` actuators, m.
    pub fn positions_m(&self, count: u8) -> impl ExactSizeIterator<Item = [T; 2]> + use<T> {
        let arrangement = *self;
        (0..count).map(move |index| arrangement.position_m(index, count))
    }

    /// Distance of the farthest of `count` axes from the bundle's axis, m.
    pub fn reach_m(&self, count: u8) -> T {
        match self {
            Self::Circle { radius_m } => *radius_m,
            Self::Row { spacing_m } => *spacing_m * real::<T>(0.5) * scalar(count.saturating_sub(1)),
        }
    }

    /// Distance of the axes of the nearest two of `count` actuators, m; `None` for one.
    pub fn nearest_m(&self, count: u8) -> Option<T> {
        (count > 1).then(|| match self {
            Self::Circle { radius_m } => {
                // A chord of the circle.
                let (sin, _) = sin_cos(real::<T>(core::f64::consts::PI) / scalar(count));
                *radius_m * (sin + sin)
            }
            Self::Row { spacing_m } => *spacing_m,
        })
    }
}
