//! Setpoints in the units of the link.

use softlimb_protocol as protocol;

use softlimb_scene::SetpointKind;

/// The link's word for what a setpoint means.
pub fn wire_kind(kind: SetpointKind) -> protocol::SetpointKind {
    match kind {
        SetpointKind::Pressure => protocol::SetpointKind::Pressure,
        SetpointKind::AxialStretch => protocol::SetpointKind::AxialStretch,
        SetpointKind::OuterRadius => protocol::SetpointKind::OuterRadius,
        SetpointKind::InnerRadius => protocol::SetpointKind::InnerRadius,
        SetpointKind::Twist => protocol::SetpointKind::Twist,
        SetpointKind::BendAngle => protocol::SetpointKind::BendAngle,
    }
}

/// A setpoint value on the wire; values beyond the wire's range, which no actuator reaches, go to its ends.
pub fn to_wire(kind: SetpointKind, value: f64) -> i32 {
    wire_kind(kind).to_wire(value).unwrap_or(if value > 0.0 { i32::MAX } else { i32::MIN })
}

/// A wire value as the value it stands for.
pub(super) fn from_wire(kind: SetpointKind, value: i32) -> f64 {
    wire_kind(kind).from_wire_f64(value)
}
