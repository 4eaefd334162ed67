//! Orders of the operator, and the settings that they change.

use fra_model::StateQuantity;
use softlimb_limb::Drive;

/// Lengths of a step: mm, deg or kPa.
pub const STEPS: [f64; 3] = [1.0, 5.0, 20.0];
/// Speeds: mm/s, deg/s or kPa/s.
pub const SPEEDS: [f64; 3] = [5.0, 20.0, 50.0];

/// One order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Move the tip along an axis of the world, or the selected drive, by a step.
    Go(Way),
    /// Move likewise until [`Order::Stop`].
    Hold(Way),
    /// Stop where the limb is: the key was released.
    Stop,
    /// Close the gripper that is open, or open it.
    Gripper,
    /// Move the tip with the keys of directions.
    SelectTip,
    /// Move one drive, by its index.
    SelectDrive(usize),
    /// Move the drive behind the selected one; behind the last one the tip.
    SelectNext,
    /// The next longer step; behind the longest none.
    Longer,
    /// The next shorter step.
    Shorter,
    /// The next higher speed.
    Faster,
    /// The next lower speed.
    Slower,
}

/// A direction along an axis of the world. For a selected drive, `with` raises its pressure whatever the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// Axis, 0 to 2.
    pub axis: usize,
    /// Whether in the positive direction.
    pub with: bool,
}

/// Settings of the keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The drive that moves; `None` for the tip.
    pub drive: Option<usize>,
    step: usize,
    speed: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { drive: None, step: 1, speed: 1 }
    }
}

impl Settings {
    /// Length of a step, mm, deg or kPa.
    pub fn step(&self) -> f64 {
        STEPS[self.step]
    }

    /// Speed, mm/s, deg/s or kPa/s.
    pub fn speed(&self) -> f64 {
        SPEEDS[self.speed]
    }

    /// Takes an order that changes only settings, on a limb with `drives` drives.
    pub(super) fn take(&mut self, order: Order, drives: usize) {
        match order {
            Order::SelectTip => self.drive = None,
            Order::SelectDrive(index) if index < drives => self.drive = Some(index),
            Order::SelectNext => self.drive = Some(self.drive.map_or(0, |at| at + 1)).filter(|next| *next < drives),
            Order::Longer => self.step = (self.step + 1).min(STEPS.len() - 1),
            Order::Shorter => self.step = self.step.saturating_sub(1),
            Order::Faster => self.speed = (self.speed + 1).min(SPEEDS.len() - 1),
            Order::Slower => self.speed = self.speed.saturating_sub(1),
            _ => {}
        }
    }
}

/// The unit of a drive's steps.
pub fn unit_of(kind: StateQuantity) -> &'static str {
    match kind {
        StateQuantity::Pressure => "kPa",
        StateQuantity::AxialStretch | StateQuantity::OuterRadius | StateQuantity::InnerRadius => "mm",
        StateQuantity::Twist | StateQuantity::BendAngle => "deg",
    }
}

/// The change of a drive's setpoint for an amount in the unit of its steps; a positive amount raises its pressure.
pub(super) fn change_of(drive: &Drive<'_>, amount: f64) -> f64 {
    let (rest, end) = drive.range();
    let size = match drive.kind {
        StateQuantity::Pressure => 1e3 * amount,
        StateQuantity::AxialStretch => 1e-3 * amount / drive.length_m(),
        StateQuantity::OuterRadius | StateQuantity::InnerRadius => 1e-3 * amount,
        StateQuantity::Twist | StateQuantity::BendAngle => amount.to_radians(),
    };
    size * (end - rest).signum()
}
