//! Pressure setpoints: step, ramp, sine.

use std::f64::consts::TAU;

use fra_model::Motion;
use softlimb_protocol::SetpointKind;

use crate::actuators::{NEO_HOOKEAN, Subject, tube};
use crate::bench::{Run, nominal, run};

/// A bending tube of 75 mL that follows pressures.
const FINGER: fn() -> Subject =
    || Subject { parameters: tube(Motion::Bending, NEO_HOOKEAN, None), kind: SetpointKind::Pressure };

fn follow(seconds: f64, pressure_pa: impl Fn(f64) -> f64) -> Run {
    let subjects = [FINGER()];
    let run = run(nominal(&subjects), &subjects, seconds, |_, time_s| pressure_pa(time_s));
    assert_eq!(run.faults, []);
    // A tick of 1 ms each, the first and the last one included.
    assert_eq!(run.moments.len(), (seconds * 1e3).round() as usize + 1);
    run
}

/// Start, s; level, Pa; and how long a valve that is simply left open would take, s.
///
/// Between 20 kPa (80 mL) and 60 kPa (91 mL) lie 59 mg of air. Filling is choked: 1.44e-9 x 1.185 x 301e3 = 0.51 g/s. Venting begins choked with
/// 0.27 g/s and ends with 0.13 g/s.
const STEPS: [(f64, f64, f64); 2] = [(0.5, 60e3, 0.115), (2.0, 20e3, 0.295)];

#[test]
fn step_up_and_a_step_down_settle() {
    // Two knots up and two down: the device takes no setpoint that crosses its limits in less than 100 ms.
    let ramp = |from_s: f64, time_s: f64| ((time_s - from_s) / 0.04 + 0.5).clamp(0.0, 1.0);
    let wanted_pa = |time_s: f64| 20e3 + 40e3 * (ramp(0.5, time_s) - ramp(2.0, time_s));
    let run = follow(3.5, wanted_pa);
    for (from_s, wanted_pa, open_s) in STEPS {
        let off = |moment: &&crate::bench::Moment| (moment.channels[0].0 - wanted_pa).abs() > 1e3;
        // The setpoint leaves with the last knot before the next step, 20 ms early, and the loop aims a control period ahead.
        let settled_s = run.between(from_s, from_s + 1.45).filter(off).last().unwrap().time_s - from_s;
        let steady_pa = run.pressure_rmse_pa(0, (from_s + 0.75, from_s + 1.45), |_| wanted_pa);
        println!(
            "step to {:.0} kPa: settled in {:.0} ms, then {steady_pa:.0} Pa RMS",
            wanted_pa * 1e-3,
            settled_s * 1e3
        );
        // Half as much again for the tube, the delays and the last small pulses.
        assert!(settled_s < 1.5 * open_s, "{settled_s} s");
        assert!(steady_pa < 450.0, "{steady_pa} Pa");
    }
}

#[test]
fn ramp_is_followed_without_lag() {
    let wanted_pa = |time_s: f64| 10e3 + 20e3 * (time_s - 0.5).clamp(0.0, 3.0);
    let run = follow(4.0, wanted_pa);
    let ramp = run.between(1.0, 3.5);
    let (sum, count) = ramp.fold((0.0, 0.0), |(s, n), m| (s + m.channels[0].0 - wanted_pa(m.time_s), n + 1.0));
    let (mean_pa, rmse_pa) = (sum / count, run.pressure_rmse_pa(0, (1.0, 3.5), wanted_pa));
    println!("ramp of 20 kPa/s: mean error {mean_pa:.0} Pa, RMSE {rmse_pa:.0} Pa");
    // A lag of one control period would be 400 Pa of mean error.
    assert!(mean_pa.abs() < 250.0, "{mean_pa} Pa");
    assert!(rmse_pa < 450.0, "{rmse_pa} Pa");
}

#[test]
fn sine_is_followed() {
    let wanted_pa = |time_s: f64| 45e3 + 20e3 * (TAU * 0.5 * (time_s - 0.5).max(0.0)).sin();
    let run = follow(4.5, wanted_pa);
    let rmse_pa = run.pressure_rmse_pa(0, (0.5, 4.5), wanted_pa);
    println!("0.5 Hz +-20 kPa: RMSE {rmse_pa:.0} Pa");
    // Its RMS rate is 44 kPa/s: 0.9 kPa in a control period, of which an ideal pulse in every period leaves 1/sqrt(12), 0.26 kPa.
    assert!(rmse_pa < 400.0, "{rmse_pa} Pa");
    assert!(rmse_pa > 100.0, "closer than pulses of 20 ms can be: {rmse_pa} Pa");
}
