//! Closed forms, conservation laws and bounds of the gas of one channel.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::curve::Node;
use crate::gas::{REFERENCE_DENSITY_KG_PER_M3, tube_conductance};

const C: f64 = 1.44e-9;
const B: f64 = 0.3;
const ROOM_K: f64 = 293.15;
const AMBIENT: f64 = 101_325.0;
const VOLUME: f64 = 80e-6;
/// `R T C rho0 / V`, 1/s.
const RATE: f64 = R_AIR * ROOM_K * C * REFERENCE_DENSITY_KG_PER_M3 / VOLUME;

const FILL: Openings = Openings { fill: true, vent: false };
const VENT: Openings = Openings { fill: false, vent: true };
const SHUT: Openings = Openings { fill: false, vent: false };

/// A rigid chamber right behind its valves: the tube is so wide that it does nothing.
fn vessel(wall_w_per_k: f64) -> Piping {
    Piping {
        fill: Orifice::new(C, B, ROOM_K),
        vent: Orifice::new(C, B, ROOM_K),
        tube: Orifice::new(1e-3, B, ROOM_K),
        leak: None,
        line_volume_m3: 1e-12,
        wall_w_per_k,
        ambient_abs_pa: AMBIENT,
        room_k: ROOM_K,
        volume: VolumeCurve::rigid(VOLUME),
    }
}

/// Behind walls that hold the gas at room temperature.
fn isothermal() -> Piping {
    vessel(1e4)
}

/// A channel with its tube and a chamber that widens linearly with pressure.
fn channel(tube_m: f64, bore_m: f64, volume_m3: f64, compliance_per_pa: f64) -> Piping {
    let (c, b) = tube_conductance(tube_m, bore_m);
    let slope = compliance_per_pa * volume_m3;
    let node =
        |pressure_pa: f64| Node { pressure_pa, volume_m3: volume_m3 + slope * pressure_pa, slope_m3_per_pa: slope };
    Piping {
        tube: Orifice::new(c, b, ROOM_K),
        line_volume_m3: 0.785 * bore_m * bore_m * tube_m + 1e-7,
        volume: VolumeCurve::through(&[node(0.0), node(100e3), node(200e3)], 100e3).unwrap(),
        ..vessel(0.5)
    }
}

fn run(gas: &mut Gas, piping: &Piping, open: Openings, supply: f64, seconds: f64, h_s: f64) {
    for _ in 0..(seconds / h_s).round() as usize {
        gas.step(piping, open, supply, h_s);
    }
}

#[test]
fn choked_fill_is_linear_in_time() {
    let piping = isothermal();
    let supply = 1.2e6;
    for seconds in [0.01, 0.1] {
        let mut gas = Gas::at_rest(&piping);
        run(&mut gas, &piping, FILL, supply, seconds, 1e-4);
        // Choked up to 0.3 x 1.2 MPa = 360 kPa.
        let rise = RATE * supply * seconds;
        assert!(AMBIENT + rise < B * supply);
        assert!(((gas.chamber_abs_pa - AMBIENT) / rise - 1.0).abs() < 5e-4);
    }
}

#[test]
fn subsonic_fill_follows_the_sine() {
    let piping = isothermal();
    let supply = 301_325.0;
    let theta = ((AMBIENT / supply - B) / (1.0 - B)).asin();
    for seconds in [0.05f64, 0.1, 0.2] {
        let mut gas = Gas::at_rest(&piping);
        run(&mut gas, &piping, FILL, supply, seconds, 1e-4);
        let r = B + (1.0 - B) * (theta + RATE * seconds / (1.0 - B)).sin();
        assert!((gas.chamber_abs_pa - r * supply).abs() < 50.0);
    }
}

#[test]
fn filling_eighty_millilitres_to_100_kpa_takes_196_ms() {
    let piping = isothermal();
    let mut gas = Gas::at_rest(&piping);
    let mut steps = 0;
    while gas.chamber_abs_pa < AMBIENT + 100e3 {
        gas.step(&piping, FILL, AMBIENT + 200e3, 1e-4);
        steps += 1;
    }
    assert!((1_950..1_970).contains(&steps), "{steps}");
}

#[test]
fn choked_vent_is_exponential() {
    let piping = isothermal();
    let start = 1.5e6;
    for seconds in [0.1, 0.5] {
        let mut gas = Gas::at(&piping, start);
        run(&mut gas, &piping, VENT, start, seconds, 1e-4);
        let expected = start * (-RATE * seconds).exp();
        assert!(AMBIENT < B * expected);
        assert!((gas.chamber_abs_pa / expected - 1.0).abs() < 5e-4);
    }
}

#[test]
fn shut_valves_hold_the_pressure() {
    let piping = channel(1.0, 2.5e-3, 80e-6, 1.5e-6);
    let mut gas = Gas::at(&piping, 180e3);
    run(&mut gas, &piping, SHUT, 301e3, 10.0, 1e-3);
    assert!((gas.chamber_abs_pa - 180e3).abs() < 1e-6);
    assert!((gas.line_abs_pa - 180e3).abs() < 1e-6);
}

#[test]
fn slow_compression_without_walls_is_adiabatic() {
    let piping = vessel(0.0);
    let mut gas = Gas::at_rest(&piping);
    for k in 1..=1_000 {
        gas.displace(&piping, -0.25 * VOLUME * f64::from(k) / 1_000.0);
    }
    let expected = AMBIENT * (1.0f64 / 0.75).powf(1.4);
    assert!((gas.chamber_abs_pa / expected - 1.0).abs() < 1e-6);
    let expected_k = ROOM_K * (1.0f64 / 0.75).powf(0.4);
    assert!((gas.temperature_k(&piping) / expected_k - 1.0).abs() < 1e-6);
}

#[test]
fn filling_without_walls_brings_in_enthalpy() {
    // U + W of the chamber rises by cp T0 per mass: with V = V0 + s P,
    // P V/(g-1) + s P^2/2 = const + g/(g-1) R T0 dm.
    let mut piping = channel(1.0, 2.5e-3, 80e-6, 1.5e-6);
    piping.wall_w_per_k = 0.0;
    let energy = |gas: &Gas| {
        let p = gas.chamber_abs_pa;
        let slope = 1.5e-6 * 80e-6;
        let volume = 80e-6 + slope * (p - AMBIENT);
        p * volume / (GAMMA - 1.0) + slope * p * p / 2.0
    };
    let mut gas = Gas::at_rest(&piping);
    let (before, mass) = (energy(&gas), gas.chamber_kg);
    run(&mut gas, &piping, FILL, 301_325.0, 0.2, 1e-4);
    let brought = GAMMA / (GAMMA - 1.0) * R_AIR * ROOM_K * (gas.chamber_kg - mass);
    assert!(gas.chamber_abs_pa > 180e3);
    assert!(((energy(&gas) - before) / brought - 1.0).abs() < 5e-4);
}

#[test]
fn venting_without_walls_cools_isentropically() {
    let piping = vessel(0.0);
    let mut gas = Gas::at(&piping, 300e3);
    let mass = gas.chamber_kg;
    run(&mut gas, &piping, VENT, 300e3, 0.3, 1e-5);
    let expected = 300e3 * (gas.chamber_kg / mass).powf(1.4);
    assert!(gas.chamber_abs_pa < 200e3);
    assert!((gas.chamber_abs_pa / expected - 1.0).abs() < 1e-4);
}

#[test]
fn wall_heat_decays_with_its_time_constant() {
    // Rigid and closed: m cv dT/dt = -hA (T - T0).
    let piping = vessel(0.5);
    let mut gas = Gas::at_rest(&piping);
    gas.chamber_abs_pa *= 1.1;
    gas.line_abs_pa = gas.chamber_abs_pa;
    let tau = gas.chamber_kg * R_AIR / (GAMMA - 1.0) / 0.5;
    let line = gas.line_abs_pa;
    for _ in 0..2_000 {
        gas.exchange_heat(&piping, tau / 2_000.0);
    }
    let excess = gas.temperature_k(&piping) - ROOM_K;
    assert!((excess / (0.1 * ROOM_K) - (-1.0f64).exp()).abs() < 2e-4);
    assert_eq!(gas.line_abs_pa, line);
}

#[test]
fn manifold_reads_high_while_filling_through_a_metre() {
    // An independent integration gives about 18 kPa at 60 kPa gauge, 200 kPa supply, 80 mL.
    let piping = channel(1.0, 2.5e-3, 80e-6, 1.5e-6);
    let mut gas = Gas::at_rest(&piping);
    while gas.chamber_abs_pa < AMBIENT + 60e3 {
        gas.step(&piping, FILL, AMBIENT + 200e3, 1e-4);
    }
    let excess = gas.line_abs_pa - gas.chamber_abs_pa;
    assert!((14e3..22e3).contains(&excess), "{excess}");
}

#[test]
fn full_stroke_times_agree_with_an_independent_integration() {
    // Volume, mL; from and to, kPa gauge; first entry into 1 kPa about the goal, ms, delays included:
    // 200 kPa supply, 1 m of tube. That entry may use what the line still delivers after closing, at
    // most 5 ms earlier than here.
    for (volume_ml, from_kpa, to_kpa, expected_ms) in [
        (30.0, 0.0, 100.0, 97.0),
        (30.0, 100.0, 0.0, 344.0),
        (80.0, 0.0, 100.0, 235.0),
        (80.0, 100.0, 50.0, 225.0),
        (80.0, 100.0, 0.0, 855.0),
        (80.0, 0.0, 150.0, 422.0),
        (150.0, 0.0, 100.0, 428.0),
        (150.0, 100.0, 0.0, 1_570.0),
    ] {
        let mut piping = channel(1.0, 2.5e-3, volume_ml * 1e-6, 1.5e-6);
        piping.line_volume_m3 = 5.9e-6;
        let mut gas = Gas::at(&piping, AMBIENT + from_kpa * 1e3);
        let open = if to_kpa > from_kpa { FILL } else { VENT };
        let mut ms = 3.5;
        while (gas.chamber_abs_pa - AMBIENT - to_kpa * 1e3).abs() > 1e3 && ms < 5e3 {
            gas.step(&piping, open, AMBIENT + 200e3, 2e-5);
            ms += 0.02;
        }
        let late_ms = ms - expected_ms;
        assert!((-0.01 * expected_ms..=6.0 + 0.01 * expected_ms).contains(&late_ms), "{volume_ml} {to_kpa}: {ms}");
    }
}

#[test]
fn hot_gas_leaves_slower_by_the_root_of_temperature() {
    let piping = Piping { tube: Orifice::new(C, B, ROOM_K), line_volume_m3: 1.0, ..vessel(0.0) };
    let mut gas = Gas::at(&piping, AMBIENT);
    gas.chamber_abs_pa = 1e6;
    gas.chamber_kg = 1e6 * VOLUME / (R_AIR * 4.0 * ROOM_K);
    let before = gas.chamber_kg;
    gas.step(&piping, SHUT, AMBIENT, 1e-7);
    let choked = C * REFERENCE_DENSITY_KG_PER_M3 * 1e6 * 1e-7;
    assert!(((before - gas.chamber_kg) / choked - 0.5).abs() < 1e-4);
}

/// Openings by two bits of a pattern.
fn openings(pattern: u32, k: u32) -> Openings {
    Openings { fill: pattern >> (2 * (k % 16)) & 1 == 1, vent: pattern >> (2 * (k % 16) + 1) & 1 == 1 }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(2026), ..ProptestConfig::default() })]

    #[test]
    fn mass_is_conserved(
        pattern: u32,
        tube_m in 0.05f64..2.0,
        volume_ml in 5f64..150.0,
        leak in 0f64..1e-9,
        displaced in -0.1f64..0.1,
    ) {
        let volume = volume_ml * 1e-6;
        let mut piping = channel(tube_m, 2.5e-3, volume, 1.5e-6);
        piping.leak = Some(Orifice::new(leak, B, ROOM_K));
        let mut gas = Gas::at_rest(&piping);
        let before = gas.total_kg(&piping);
        for k in 0..2_000 {
            gas.displace(&piping, displaced * volume * f64::from(k % 100) / 100.0);
            gas.step(&piping, openings(pattern, k / 50), 301_325.0, 1e-4);
        }
        let balance = gas.total_kg(&piping) - (before + gas.filled_kg - gas.released_kg);
        prop_assert!(balance.abs() < 1e-9 * before, "{balance:e}");
    }

    #[test]
    fn pressure_stays_between_atmosphere_and_supply(
        pattern: u32,
        tube_m in 0.01f64..2.0,
        bore_mm in 1f64..8.0,
        volume_ml in 5f64..150.0,
        conductance in 1e-10f64..1e-8,
        wall in 0f64..5.0,
        h_us in 1f64..1_000.0,
    ) {
        let mut piping = channel(tube_m, bore_mm * 1e-3, volume_ml * 1e-6, 1.5e-6);
        piping.fill = Orifice::new(conductance, B, ROOM_K);
        piping.vent = piping.fill;
        piping.wall_w_per_k = wall;
        let supply = 301_325.0;
        let mut gas = Gas::at_rest(&piping);
        for k in 0..2_000 {
            gas.step(&piping, openings(pattern, k / 50), supply, h_us * 1e-6);
            // Cooling of shut-in gas may take the chamber below the atmosphere, never far.
            let allowed = 0.7 * AMBIENT..supply * 1.3;
            prop_assert!(allowed.contains(&gas.line_abs_pa), "line {}", gas.line_abs_pa);
            prop_assert!(allowed.contains(&gas.chamber_abs_pa), "chamber {}", gas.chamber_abs_pa);
            prop_assert!((0.5 * ROOM_K..2.0 * ROOM_K).contains(&gas.temperature_k(&piping)));
        }
    }
}
