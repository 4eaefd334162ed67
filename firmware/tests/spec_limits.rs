//! The limits of every configuration field, as `protocol/SPEC.md` states them, are those at which the device refuses.

use crate::common::spec::table;
use crate::common::{Bench, SESSION, channel, system};
use softlimb_protocol::*;

/// Access to the numbers of a message by the names of their fields.
macro_rules! numbers {
    ($($message:ident { $($field:ident),+ $(,)? })+) => {$(
        impl Numbers for $message {
            const NUMBERS: &'static [&'static str] = &[$(stringify!($field)),+];

            fn set(&mut self, field: &str, value: f64) {
                match field {
                    $(stringify!($field) => self.$field = value as _,)+
                    other => panic!("no number {other}"),
                }
            }

            fn get(&self, field: &str) -> f64 {
                match field {
                    $(stringify!($field) => self.$field as f64,)+
                    other => panic!("no number {other}"),
                }
            }

            fn is_real(field: &str) -> bool {
                let layout = Self::FIELDS.iter().find(|layout| layout.name == field);
                layout.expect("a field of the message").wire_type == "f32"
            }

            fn number(field: &str) -> u32 {
                Self::field_number(field).expect("a field of the message")
            }
        }
    )+};
}

trait Numbers: Clone + Into<HostMessage> {
    /// All fields but the session and those that hold a code.
    const NUMBERS: &'static [&'static str];
    fn set(&mut self, field: &str, value: f64);
    fn get(&self, field: &str) -> f64;
    fn is_real(field: &str) -> bool;
    fn number(field: &str) -> u32;
    /// What has to be sent before it.
    fn before() -> Vec<HostMessage> {
        let base = ConfigChannel {
            motion: MotionKind::Twisting.into(),
            pressure_max_pa: 1e6,
            ..channel(0, SetpointKind::Twist)
        };
        match Self::NUMBERS.get(1) {
            Some(&"pressure_max_pa") => vec![base.into()],
            Some(&"steps") => vec![base.into(), volume().into()],
            _ => Vec::new(),
        }
    }
}

/// The volume of the actuator at rest, whatever the pressure.
fn volume() -> ConfigVolume {
    let rest_m3 = std::f32::consts::PI * 15e-3 * 15e-3 * 0.1132;
    let coefficients_m3 = List::from_slice(&[rest_m3]).unwrap();
    ConfigVolume { session: SESSION, channel: 0, pressure_max_pa: 1e6, coefficients_m3 }
}

numbers! {
    ConfigBegin { channels }
    ConfigSystem {
        telemetry_period_us, control_period_us, link_timeout_us, hold_time_us, vent_ramp_pa_per_s, supply_min_pa,
        supply_max_pa, atmosphere_pa, temperature_k, valve_conductance_m3_per_s_pa, valve_critical_ratio,
        valve_on_delay_us, valve_off_delay_us, line_conductance_m3_per_s_pa, sensor_min_pa, sensor_max_pa,
        supply_sensor_min_pa, supply_sensor_max_pa, adc_full_scale, valve_supply_scale_mv,
        valve_supply_min_mv,
    }
    ConfigChannel {
        channel, families, inner_radius_m, outer_radius_m, length_m, c_pa_1, c_pa_2, c_pa_3, fiber_angle_rad,
        fiber_modulus_pa, fiber_thickness_m, fiber_radius_m, pressure_max_pa, dead_volume_m3, setpoint_min,
        setpoint_max,
    }
    ConfigVolume { channel, pressure_max_pa }
    ConfigInverse { channel, steps, setpoint_from, setpoint_to, pressure_max_pa }
}

/// One row of the table.
struct Limits {
    field: String,
    lowest: String,
    highest: String,
    also: String,
}

fn limits_of(message: &str) -> Vec<Limits> {
    table(["Message", "Field", "Lowest", "Highest", "Also"])
        .into_iter()
        .filter(|row| row[0] == message)
        .map(|[_, field, lowest, highest, also]| Limits { field, lowest, highest, also })
        .collect()
}

/// A bound in numbers: "5", "field", "field + 5", each perhaps after "above ".
fn bound<M: Numbers>(base: &M, text: &str) -> (f64, bool) {
    let (text, open) = text.strip_prefix("above ").map_or((text, false), |rest| (rest, true));
    let term = |text: &str| text.parse().unwrap_or_else(|_| base.get(text));
    let value = text.split(" + ").map(term).sum();
    (value, open)
}

/// The next value of the field's type above or below.
fn neighbor<M: Numbers>(field: &str, value: f64, up: bool) -> f64 {
    match (M::is_real(field), up) {
        (true, true) => f64::from((value as f32).next_up()),
        (true, false) => f64::from((value as f32).next_down()),
        (false, true) => value + 1.0,
        (false, false) => value - 1.0,
    }
}

/// Whether the device accepts the field at a value, whatever it thinks of the others; `None` where the type has no such value.
fn accepts<M: Numbers>(base: &M, field: &str, value: f64) -> Option<bool> {
    let mut message = base.clone();
    message.set(field, value);
    // A real number is as near as its type comes; an integer is itself or does not exist.
    if !M::is_real(field) && message.get(field) != value {
        return None;
    }
    let mut bench = Bench::new();
    bench.hello();
    bench.request(&ConfigBegin { session: SESSION, channels: 1 }.into());
    for part in M::before() {
        assert_eq!(bench.request(&part).result, ResultCode::Ok);
    }
    let ack = bench.request(&message.into());
    match ack.result.known() {
        Some(ResultCode::Ok) => Some(true),
        Some(ResultCode::OutOfRange) => Some(ack.detail != M::number(field)),
        other => panic!("{field} = {value}: {other:?}"),
    }
}

/// Holds the table against the device; `base` is accepted as it is.
fn check<M: Numbers>(name: &str, base: &M) {
    let rows = limits_of(name);
    assert_eq!(rows.iter().map(|row| row.field.as_str()).collect::<Vec<_>>(), M::NUMBERS, "{name}");
    let layout = HostMessage::LAYOUT.iter().find(|layout| layout.name == name).expect("a message of the host");
    let is_number = |field: &&FieldLayout| {
        field.name != "session" && !field.wire_type.starts_with("Code") && !field.wire_type.starts_with("List")
    };
    assert_eq!(layout.fields.iter().filter(is_number).count(), M::NUMBERS.len(), "{name}: every number has a row");
    for Limits { field, lowest, highest, also } in rows {
        let ((low, low_open), (high, high_open)) = (bound(base, &lowest), bound(base, &highest));
        let expect = |value: f64, wanted: bool| {
            let accepted = accepts(base, &field, value);
            assert!(accepted.is_none_or(|accepted| accepted == wanted), "{field} = {value:e}: {accepted:?}");
        };
        expect(low, !low_open);
        expect(high, !high_open);
        expect(neighbor::<M>(&field, low, false), false);
        expect(neighbor::<M>(&field, high, true), false);
        if let Some(step) = also.strip_prefix("a multiple of ") {
            let step: f64 = step.parse().expect("a number");
            expect(low + step, true);
            expect(low + 1.0, false);
            expect(low - step, false);
            expect(high + step, false);
        } else if low_open {
            expect(neighbor::<M>(&field, low, true), true);
        }
        if M::is_real(&field) {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                expect(value, false);
            }
        }
    }
}

#[test]
fn limits_of_an_upload_are_those_of_the_table() {
    check("ConfigBegin", &ConfigBegin { session: SESSION, channels: 1 });
}

#[test]
fn limits_of_the_system_are_those_of_the_table() {
    check("ConfigSystem", &system());
}

#[test]
fn limits_of_a_channel_are_those_of_the_table() {
    check("ConfigChannel", &channel(0, SetpointKind::Pressure));
}

#[test]
fn limits_of_tables_are_those_of_the_table() {
    check("ConfigVolume", &volume());
    let rising = ConfigInverse {
        session: SESSION,
        channel: 0,
        argument: TableArgument::Linear.into(),
        steps: 1024,
        setpoint_from: 0.0,
        setpoint_to: 1.0,
        pressure_max_pa: 1e6,
        coefficients_pa: List::from_slice(&[1.0, 1.0]).unwrap(),
    };
    check("ConfigInverse", &rising);
}

#[test]
fn setpoints_outside_of_their_kinds_domain_are_refused() {
    let takes = |motion: MotionKind, kind: SetpointKind, setpoint: i32| {
        let one = ConfigChannel {
            motion: motion.into(),
            setpoint_kind: kind.into(),
            setpoint_min: setpoint,
            setpoint_max: setpoint,
            ..channel(0, kind)
        };
        accepts(&one, "setpoint_min", f64::from(setpoint)).unwrap()
    };
    use MotionKind::{Bending, Expansion, Extension, Twisting};
    use SetpointKind::{AxialStretch, BendAngle, InnerRadius, OuterRadius, Pressure, Twist};
    assert!(takes(Bending, BendAngle, 0) && !takes(Bending, BendAngle, -1));
    for kind in [AxialStretch, OuterRadius, InnerRadius, Twist] {
        assert!(!takes(Bending, kind, 1_000_000), "{kind:?} of a bending actuator");
    }
    for motion in [Extension, Expansion, Twisting] {
        assert!(!takes(motion, BendAngle, 0), "{motion:?} does not bend");
        assert!(takes(motion, Twist, -500_000) && takes(motion, Pressure, -1));
        for kind in [AxialStretch, OuterRadius, InnerRadius] {
            assert!(takes(motion, kind, 1) && !takes(motion, kind, 0), "{kind:?}");
        }
    }
}

#[test]
fn reference_stops_below_the_limit_as_far_as_the_specification_says() {
    for (pressure_max_pa, reference_max_pa) in [(150e3, 147e3), (20e3, 18e3)] {
        let mut bench = Bench::new();
        bench.hello();
        bench.configure(&system(), &[ConfigChannel { pressure_max_pa, ..channel(0, SetpointKind::Pressure) }]);
        let config = bench.controller.config().unwrap();
        let found_pa = config.channels[0].reference_max_pa();
        assert!((found_pa - reference_max_pa).abs() < 0.1, "{found_pa} of {pressure_max_pa}");
    }
}
