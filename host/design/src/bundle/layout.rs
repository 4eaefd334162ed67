//! The unit box of a problem: which number of which actuator each axis is.

use crate::actuators::Bounds;

use super::problem::ForceProblem;

/// What an axis of the box is, of one actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    InnerRadius,
    Wall,
    Length,
    Angle,
    Radius,
    Azimuth,
    Height,
    SlopeX,
    SlopeY,
    /// The pressure in a sample.
    Pressure(usize),
}

/// The numbers of geometry and place, without pressures, in this order.
pub(super) const PLACED: [Quantity; 9] = [
    Quantity::InnerRadius,
    Quantity::Wall,
    Quantity::Length,
    Quantity::Angle,
    Quantity::Radius,
    Quantity::Azimuth,
    Quantity::Height,
    Quantity::SlopeX,
    Quantity::SlopeY,
];

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

    fn bounds(self, problem: &ForceProblem, actuator: usize) -> Bounds {
        let attachment = &problem.actuators[actuator];
        match self {
            Self::InnerRadius => problem.inner_radius_m,
            Self::Wall => problem.wall_m,
            Self::Length => problem.length_m,
            Self::Angle => problem.angle_rad,
            Self::Radius => attachment.radius_m,
            Self::Azimuth => attachment.azimuth_rad,
            Self::Height => attachment.height_m,
            Self::SlopeX => attachment.slopes[0],
            Self::SlopeY => attachment.slopes[1],
            Self::Pressure(_) => [0.0, problem.pressure_max_pa],
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
        for actuator in 0..problem.actuators.len() {
            let pressures = (0..problem.samples.len()).map(Quantity::Pressure);
            let mut slots = Vec::new();
            for quantity in PLACED.into_iter().chain(pressures) {
                let first = layout.slots.first().filter(|_| problem.shared && quantity.is_shared());
                let same = first.and_then(|slots: &Vec<Slot>| slots.iter().find(|slot| slot.quantity == quantity));
                slots.push(match same {
                    Some(slot) => *slot,
                    None => layout.slot(quantity, quantity.bounds(problem, actuator)),
                });
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
