//! Setpoints in the units of the link.

use fra_model::StateQuantity;
use softlimb_protocol as protocol;

/// The link's word for what a setpoint means.
pub fn wire_kind(kind: StateQuantity) -> protocol::SetpointKind {
    match kind {
        StateQuantity::Pressure => protocol::SetpointKind::Pressure,
        StateQuantity::AxialStretch => protocol::SetpointKind::AxialStretch,
        StateQuantity::OuterRadius => protocol::SetpointKind::OuterRadius,
        StateQuantity::InnerRadius => protocol::SetpointKind::InnerRadius,
        StateQuantity::Twist => protocol::SetpointKind::Twist,
        StateQuantity::BendAngle => protocol::SetpointKind::BendAngle,
    }
}

/// A setpoint value on the wire; values beyond the wire's range, which no actuator reaches, go to its ends.
pub fn to_wire(kind: StateQuantity, value: f64) -> i32 {
    wire_kind(kind).to_wire(value).unwrap_or(if value > 0.0 { i32::MAX } else { i32::MIN })
}

/// A wire value as the value it stands for.
pub(super) fn from_wire(kind: StateQuantity, value: i32) -> f64 {
    wire_kind(kind).from_wire_f64(value)
}
