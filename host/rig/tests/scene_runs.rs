//! A scene that is called sound is not refused by the device or by the simulated plant: both ends of the ranges that the reference promises.

use std::sync::atomic::AtomicBool;

use softlimb_limb::Limb;
use softlimb_rig::run::{Mcu, RunError, RunOptions, run};
use softlimb_rig::simulate::settings;
use softlimb_scene::{Scene, parse, reference};
use softlimb_sim::SimulatedMcu;

const ONE_FINGER: &str = r#"
format = 1
name = "minimal"
weight.simulated = false
materials.silicone = { law = "neo-hookean", shear_modulus = "0.2 MPa" }
limb.connector = { length = 0, mass = 0 }
module = [{ name = "a", motion = "bending", actuators = 1, inner_radius = 0.010, outer_radius = 0.014, length = 0.2, material = "silicone" }]
phase = [{ name = "p", duration = 0.1, targets = { a = { pressure = "20 kPa" } } }]
"#;

/// The smallest scene with each quantity of these tables at both ends of its range, without those that the reader refuses.
fn scenes_at_the_ends(tables: &str) -> Vec<(String, Scene)> {
    let page = reference();
    let mut scenes = Vec::new();
    for part in page.split("\n## `").skip(1) {
        let header = part.split('`').next().unwrap().trim_matches(['[', ']']);
        if !header.starts_with(tables) {
            continue;
        }
        for row in part.lines().filter(|line| line.starts_with("| `")) {
            let cells: Vec<&str> = row.split(" | ").collect();
            let key = cells[0].trim_matches(['|', ' ', '`']);
            let Some((min, max)) = cells[1].split_once(" to ") else { continue };
            for end in [min, max] {
                let value = if end.contains(' ') { format!("\"{end}\"") } else { end.to_owned() };
                let said = format!("{header}.{key} = {value}");
                let text = format!("{ONE_FINGER}\n[{header}]\n{key} = {value}\n");
                scenes.extend(parse(&text, "end.toml").ok().map(|scene| (said, scene)));
            }
        }
    }
    scenes
}

fn plant_takes(scene: &Scene) -> Result<(), String> {
    let limb = Limb::new(scene).map_err(|error| error.render(false))?;
    SimulatedMcu::new(&settings(scene, &limb, 1)).map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn plant_takes_the_ends_of_every_range() {
    let scenes = scenes_at_the_ends("plant");
    assert!(scenes.len() >= 40, "{}", scenes.len());
    for (said, scene) in scenes {
        assert_eq!(plant_takes(&scene), Ok(()), "{said}");
    }
}

#[test]
fn device_takes_the_ends_of_every_range() {
    let scenes = scenes_at_the_ends("controller");
    assert!(scenes.len() >= 10, "{}", scenes.len());
    for (said, scene) in scenes {
        let out = tempfile::tempdir().unwrap();
        let options =
            RunOptions { seed: 1, out: out.path().join("run"), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
        let ended = run(&scene, &options, &AtomicBool::new(false), |_| ());
        // The slowest ramp takes longer to vent than a run waits for; that is no refusal.
        let began = match &ended {
            Ok(_) => true,
            Err(RunError::Stopped { files, .. }) => !files.run.samples.is_empty(),
            Err(_) => false,
        };
        assert!(began, "{said}: {}", ended.err().map(|error| error.to_string()).unwrap_or_default());
    }
}

/// A bound that nobody needs would also pass the tests above.
#[test]
fn smallest_reservoir_is_the_one_the_plant_takes() {
    let valve = "[plant.valve]\nconductance = \"5 dm3/(s bar)\"\n[plant.supply]\nreservoir_volume = ";
    // One valve: 25 C / (5e-3 per s and Pa) = 25 x 5e-8 / 5e-3 m3 = 0.25 L.
    let sound = parse(&format!("{ONE_FINGER}\n{valve}\"0.251 L\""), "a.toml").unwrap();
    assert_eq!(plant_takes(&sound), Ok(()));
    let error = parse(&format!("{ONE_FINGER}\n{valve}\"0.249 L\""), "a.toml").unwrap_err().render(false);
    assert!(error.contains("the reservoir is too small"), "{error}");
    let mut refused = settings(&sound, &Limb::new(&sound).unwrap(), 1);
    let softlimb_sim::plant::Supply::Pump(pump) = &mut refused.plant.supply else { panic!("regulated") };
    pump.reservoir_volume_m3 = 0.249e-3;
    assert!(SimulatedMcu::new(&refused).is_err());
}

/// The solid of the limb in a log ends at the observed tip. Its clearance is that of the nearest of its points, or up to half their distance less.
#[test]
fn solids_of_the_limb_end_at_its_tip_and_clear_the_obstacles_as_logged() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/reach-past-post.toml"));
    let scene = parse(&text.unwrap(), "reach-past-post.toml").unwrap();
    let out = tempfile::tempdir().unwrap();
    let options =
        RunOptions { seed: 1, out: out.path().to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    let log = run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap().run;
    assert!(log.bodies.len() as f64 >= 10.0 * log.samples.last().unwrap().time_s - 1.0, "{}", log.bodies.len());
    let mut points = log.bodies.iter().map(|body| body.line_m.len()).collect::<Vec<_>>();
    points.dedup();
    assert_eq!(points.len(), 1, "each solid has as many points");
    for body in &log.bodies {
        let sample = log.samples.iter().find(|sample| sample.time_s == body.time_s).unwrap();
        let (tip, end) = (sample.tip_achieved_m.unwrap(), *body.line_m.last().unwrap());
        assert!((0..3).all(|axis| (tip[axis] - end[axis]).abs() < 1e-9), "{tip:?} {end:?}");
        let (clearance_m, name) = body.nearest.as_ref().unwrap();
        let of_points = |shape: &softlimb_scene::collision::Shape| {
            let points = body.line_m.iter().zip(&body.radius_m);
            let distances = points.map(|(point, radius_m)| shape.distance(&(*point).into()).distance_m - radius_m);
            distances.fold(f64::INFINITY, f64::min)
        };
        let spacing_m = body
            .line_m
            .windows(2)
            .map(|pair| (0..3).map(|axis| (pair[1][axis] - pair[0][axis]).powi(2)).sum::<f64>().sqrt());
        let half_m = 0.5 * spacing_m.fold(0.0, f64::max);
        let least_m = scene.obstacles().iter().map(|obstacle| of_points(&obstacle.shape)).fold(f64::INFINITY, f64::min);
        assert!(*clearance_m <= least_m + 1e-5 && *clearance_m >= least_m - half_m, "{clearance_m} {least_m}");
        assert!(scene.obstacles().iter().any(|obstacle| obstacle.name.value == *name));
    }
    assert!(log.bodies.iter().all(|body| body.tip_unloaded_m.is_none()), "a weightless limb does not sag");
    assert!(log.info.solids.iter().all(|solid| solid.shape.is_some()));
}
