//! Deformation in, deformation out: the whole controller, from setpoints on the wire to chambers of other parameters.
//!
//! Run with `--nocapture` for the numbers.

use crate::common::Bench;
use crate::common::fixture::{Fixture, NOMINAL, Truth};
use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, State};
use softlimb_protocol::*;

/// The actuator that `crate::common::channel` states, in f64.
fn bender() -> Actuator<f64> {
    Actuator::new(&ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: None,
    })
    .unwrap()
}

/// Bend angle over time, rad: rest, up, rest, down.
fn wanted_rad(t: f64) -> f64 {
    let knots = [0.2, 1.2, 1.2, 2.0, 2.0, 0.6, 0.6];
    let k = (t.floor().max(0.0) as usize).min(5);
    let s = (t - k as f64).clamp(0.0, 1.0);
    knots[k] + (knots[k + 1] - knots[k]) * s * s * (3.0 - 2.0 * s)
}

/// A chamber whose volume follows the bender only in the mean: rest volume and slope are those of the secant to 2 rad.
fn chambers() -> Vec<Fixture> {
    let actuator = bender();
    let at = |rad| actuator.inverse(fra_model::Target::BendAngle(rad), &Load::none()).unwrap().state;
    let (rest, bent) = (actuator.rest(), at(2.0));
    let compliance_m3_per_pa = (bent.volume_m3 - rest.volume_m3) / bent.pressure_pa;
    let nominal = Truth { rest_volume_m3: rest.volume_m3, compliance_m3_per_pa, ..NOMINAL };
    let small = Truth { rest_volume_m3: 0.8 * rest.volume_m3, ..nominal };
    let slow = Truth { valve_c: 0.8 * nominal.valve_c, on_us: 4_200, off_us: 2_600, ..nominal };
    [nominal, small, slow].map(|truth| Fixture::new(truth, 0.0)).into()
}

#[test]
fn bend_angles_are_followed_by_three_different_chambers() {
    let mut bench = Bench::ready(&[SetpointKind::BendAngle; 3]);
    bench.fixtures = chambers();
    let first_us = bench.now_us + 20_000;
    let (mut index, actuator) = (0, bender());
    let mut squares = [(0.0, 0.0); 3];
    let mut started = false;
    let mut samples = 0;
    while started == (bench.controller.state() == DeviceState::Running) {
        while index < 326 && bench.controller.queue().free() > 0 {
            // Half a second to arrive, then six seconds of motion.
            let value = SetpointKind::BendAngle.to_wire(wanted_rad(f64::from(index) * 0.02 - 0.5)).unwrap();
            let ack = bench.setpoint(index, first_us + u64::from(index) * 20_000, &[value; 3]);
            assert_eq!(ack.result, ResultCode::Ok);
            index += 1;
        }
        if !started {
            assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
            started = true;
        }
        bench.tick();
        let t = (bench.now_us as f64 - first_us as f64) * 1e-6 - 0.5;
        if !(0.0..6.0).contains(&t) {
            continue;
        }
        let target = fra_model::Target::BendAngle(wanted_rad(t));
        let wanted_pa = actuator.inverse(target, &Load::none()).unwrap().state.pressure_pa;
        samples += 1;
        for (fixture, (pressure, angle)) in bench.fixtures.iter().zip(&mut squares) {
            let achieved = actuator.forward(fixture.gauge_pa(), &Load::none()).unwrap().state.bend_angle_rad;
            *pressure += (fixture.gauge_pa() - wanted_pa).powi(2);
            *angle += (achieved - wanted_rad(t)).powi(2);
        }
    }
    assert_eq!(samples, 6_000);
    for (index, (pressure, angle)) in squares.into_iter().enumerate() {
        let rms = |sum: f64| (sum / f64::from(samples)).sqrt();
        let edges = f64::from(bench.fixtures[index].edges) / 6.5;
        let (rmse_kpa, rmse_deg) = (rms(pressure) * 1e-3, rms(angle).to_degrees());
        println!("chamber {index}: {rmse_kpa:.2} kPa, {rmse_deg:.2} deg, {edges:.0} switchings/s");
        assert!(rmse_kpa < 0.8 && rmse_deg < 1.0 && edges <= 80.0, "chamber {index}");
    }
    assert_eq!(bench.told_faults(), [(FaultCode::SetpointsExhausted, SYSTEM_CHANNEL)]);
}

#[test]
fn twenty_seven_channels_run_at_once() {
    let mut bench = Bench::running(27, 60_000, 64);
    bench.attach(27, 0.0);
    bench.ticks(1_200);
    for (index, fixture) in bench.fixtures.iter().enumerate() {
        assert!((fixture.gauge_pa() - 60e3).abs() < 1e3, "channel {index}: {}", fixture.gauge_pa());
    }
    assert!(bench.told_faults().is_empty());
}

/// A wound actuator as the wire states it and as the model does, in f64.
fn wound(index: usize, motion: MotionKind, angle_deg: f64, families: u8) -> (ConfigChannel, Actuator<f64>) {
    let kind = match motion {
        MotionKind::Extension => SetpointKind::AxialStretch,
        MotionKind::Expansion => SetpointKind::OuterRadius,
        MotionKind::Bending => SetpointKind::BendAngle,
        MotionKind::Twisting => SetpointKind::Twist,
    };
    let wire = ConfigChannel {
        motion: motion.into(),
        families,
        fiber_angle_rad: angle_deg.to_radians() as f32,
        fiber_modulus_pa: 10e6,
        fiber_thickness_m: 0.2e-3,
        fiber_radius_m: 20e-3,
        setpoint_min: i32::MIN,
        setpoint_max: i32::MAX,
        ..crate::common::channel(index, kind)
    };
    let wire = match kind {
        SetpointKind::BendAngle => ConfigChannel { setpoint_min: 0, ..wire },
        SetpointKind::Twist => wire,
        _ => ConfigChannel { setpoint_min: 1, ..wire },
    };
    let actuator = Actuator::new(&ActuatorParameters {
        motion: [Motion::Extension, Motion::Expansion, Motion::Bending, Motion::Twisting][motion as usize],
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
        fiber: Some(Fiber {
            angle_rad: angle_deg.to_radians(),
            families: if families == 1 { Families::One } else { Families::Two },
            modulus_pa: 10e6,
            placement: Placement::Sheet,
            thickness_m: 0.2e-3,
            radius_m: 20e-3,
        }),
    });
    (wire, actuator.unwrap())
}

/// The setpoint that asks for a state.
fn setpoint(kind: SetpointKind, state: &State<f64>) -> i32 {
    let value = match kind {
        SetpointKind::Pressure => state.pressure_pa,
        SetpointKind::AxialStretch => state.axial_stretch,
        SetpointKind::OuterRadius => state.outer_radius_m,
        SetpointKind::InnerRadius => state.inner_radius_m,
        SetpointKind::Twist => state.twist_rad,
        SetpointKind::BendAngle => state.bend_angle_rad,
    };
    kind.to_wire(value).unwrap()
}

#[test]
fn every_motion_gets_the_pressure_that_the_model_in_f64_bends_it_with() {
    let (wires, actuators): (Vec<_>, Vec<_>) = [
        wound(0, MotionKind::Extension, 5.0, 2),
        wound(1, MotionKind::Expansion, 80.0, 2),
        wound(2, MotionKind::Bending, 0.0, 2),
        wound(3, MotionKind::Twisting, 30.0, 1),
    ]
    .into_iter()
    .unzip();
    let mut bench = Bench::new();
    bench.hello();
    bench.configure(&crate::common::system(), &wires);
    bench.attach(4, 0.0);
    bench.ticks(550);
    let first_us = bench.now_us + 20_000;
    const TOP_PA: f64 = 24e3;
    for index in 0..60_u32 {
        let pressure_pa = TOP_PA * (f64::from(index) / 40.0).min(1.0);
        let values: Vec<_> = wires
            .iter()
            .zip(&actuators)
            .map(|(wire, actuator)| {
                let state = actuator.forward(pressure_pa, &Load::none()).unwrap().state;
                setpoint(wire.setpoint_kind.known().unwrap(), &state)
            })
            .collect();
        let ack = bench.setpoint(index, first_us + u64::from(index) * 20_000, &values);
        assert_eq!(ack.result, ResultCode::Ok);
    }
    assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
    bench.ticks(1_150);
    for (index, fixture) in bench.fixtures.iter().enumerate() {
        let channel = bench.controller.channel(index).unwrap();
        let reference_pa = f64::from(channel.reference_pa(bench.now_us).unwrap());
        println!("motion {index}: reference {reference_pa:.1} Pa, chamber {:.0} Pa", fixture.gauge_pa());
        assert!((reference_pa - TOP_PA).abs() < 50.0, "motion {index}: {reference_pa}");
        assert!((fixture.gauge_pa() - TOP_PA).abs() < 1e3, "motion {index}: {}", fixture.gauge_pa());
        let status = channel.inverse().status();
        assert!(!status.limited && !status.failed);
    }
    assert!(bench.told_faults().is_empty(), "{:?}", bench.told_faults());
}
