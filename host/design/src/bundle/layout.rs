//! The unit box of a problem: which number of which actuator each axis is.

use crate::actuators::Bounds;

use super::problem::{Attachment, ForceProblem, Place};

/// What an axis of the box is, of one actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    InnerRadius,
    Wall,
    Length,
    Angle,
    Radius,
    Azimuth,
    X,
    Y,
    Height,
    SlopeX,
    SlopeY,
    /// The pressure in a sample.
    Pressure(usize),
}

/// Number of quantities of geometry and place, which are before the pressures.
pub(super) const PLACED: usize = 9;

/// These of an actuator, in this order.
fn placed(place: &Place) -> [Quantity; PLACED] {
    let [first, second] = match place {
        Place::Polar { .. } => [Quantity::Radius, Quantity::Azimuth],
        Place::Cartesian { .. } => [Quantity::X, Quantity::Y],
    };
    [
        Quantity::InnerRadius,
        Quantity::Wall,
        Quantity::Length,
        Quantity::Angle,
        first,
        second,
        Quantity::Height,
        Quantity::SlopeX,
        Quantity::SlopeY,
    ]
}

impl Quantity {
    /// As in messages and answers.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::InnerRadius => "inner_radius_m",
            Self::Wall => "wall_m",
            Self::Length => "length_m",
            Self::Angle => "angle_deg",
            Self::Radius => "radius_m",
            Self::Azimuth => "azimuth_deg",
            Self::X => "x_m",
            Self::Y => "y_m",
            Self::Height => "height_m",
            Self::SlopeX => "slope_x",
            Self::SlopeY => "slope_y",
            Self::Pressure(_) => "pressure_pa",
        }
    }

    /// Whether one value holds for all actuators where geometry is shared.
    fn is_shared(self) -> bool {
        matches!(self, Self::InnerRadius | Self::Wall | Self::Length | Self::Angle | Self::Radius)
    }

    fn bounds(self, attachment: &Attachment) -> Bounds {
        let tube = &attachment.tube;
        let [first, second] = match attachment.place {
            Place::Polar { radius_m, azimuth_rad } => [radius_m, azimuth_rad],
            Place::Cartesian { x_m, y_m } => [x_m, y_m],
        };
        match self {
            Self::InnerRadius => tube.inner_radius_m,
            Self::Wall => tube.wall_m,
            Self::Length => tube.length_m,
            Self::Angle => tube.angle_rad,
            Self::Radius | Self::X => first,
            Self::Azimuth | Self::Y => second,
            Self::Height => attachment.height_m,
            Self::SlopeX => attachment.slopes[0],
            Self::SlopeY => attachment.slopes[1],
            Self::Pressure(_) => [0.0, tube.pressure_max_pa],
        }
    }
}

/// A number of an actuator: an axis of the box, or fixed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) quantity: Quantity,
    bounds: Bounds,
    pub(super) axis: Option<usize>,
}

impl Slot {
    pub(super) fn value(&self, place: &[f64]) -> f64 {
        let [low, high] = self.bounds;
        self.axis.map_or(low, |axis| low + (high - low) * place[axis])
    }

    /// Its change over the whole axis.
    pub(super) fn range(&self) -> f64 {
        self.bounds[1] - self.bounds[0]
    }
}

/// All numbers of all actuators.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) slots: Vec<Vec<Slot>>,
    pub width: usize,
}

impl Layout {
    pub(super) fn new(problem: &ForceProblem) -> Self {
        let mut layout = Self { slots: Vec::new(), width: 0 };
        for attachment in &problem.actuators {
            let pressures = (0..problem.samples.len()).map(Quantity::Pressure);
            let mut slots = Vec::new();
            for quantity in placed(&attachment.place).into_iter().chain(pressures) {
                let known = layout.slots.iter().flatten().filter(|_| problem.shared && quantity.is_shared());
                let same = known.copied().find(|slot: &Slot| slot.quantity == quantity);
                slots.push(same.unwrap_or_else(|| layout.slot(quantity, quantity.bounds(attachment))));
            }
            layout.slots.push(slots);
        }
        layout
    }

    fn slot(&mut self, quantity: Quantity, bounds: Bounds) -> Slot {
        let free = bounds[1] > bounds[0];
        let axis = free.then_some(self.width);
        self.width += usize::from(free);
        Slot { quantity, bounds, axis }
    }
}
