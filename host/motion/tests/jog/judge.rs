//! Limits of a limb, judged without the code that keeps them: pressures by the solver of the actuators, distances by points on the body.

use fra_model::{Load, Status};
use nalgebra::{UnitQuaternion, Vector3};
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Drive, Limb};
use softlimb_motion::Nominal;
use softlimb_motion::jog::{Jog, JogKnot};
use softlimb_scene::collision::{Body, Shape};
use softlimb_scene::{Limits, Scene};

/// Rounding of setpoints to the wire's units moves a pressure by less, Pa, and a point of the body, m.
const ROUNDED_PA: f64 = 60.0;
const ROUNDED_M: f64 = 3e-5;
/// A setpoint is rounded at both ends of a knot, in its unit: two steps of the wire's coarsest.
const ROUNDED: f64 = 2e-6;

pub(crate) struct Judge<'a> {
    name: &'a str,
    scene: &'a Scene,
    limb: &'a Limb,
    nominal: Nominal<'a>,
    last: Option<(u64, JogKnot)>,
    /// Rotation of the tip at the last knot, and when the object was taken: it was upright then.
    turn: UnitQuaternion<f64>,
    taken: Option<UnitQuaternion<f64>>,
    moved: usize,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(name: &'a str, scene: &'a Scene, limb: &'a Limb) -> Self {
        let nominal = Nominal::new(scene, limb, Fidelity::Double);
        Self { name, scene, limb, nominal, last: None, turn: UnitQuaternion::identity(), taken: None, moved: 0 }
    }

    /// Whether setpoints changed at all.
    pub(crate) fn moved(&self) -> bool {
        self.moved > 10
    }

    pub(crate) fn knot(&mut self, time_us: u64, knot: &JogKnot, jog: &Jog<'_>) {
        if let Some((before_us, before)) = self.last.take() {
            assert!(time_us > before_us);
            self.rates((time_us - before_us) as f64 * 1e-6, &before, knot);
            if before.values == knot.values && before.payload_kg == knot.payload_kg {
                self.last = Some((time_us, knot.clone()));
                return;
            }
            self.moved += 1;
        }
        let pressures_pa: Vec<f64> = self
            .limb
            .drives()
            .zip(&knot.setpoints)
            .map(|(drive, value)| self.pressure_pa(&drive, *value, jog))
            .collect();
        self.body(time_us, &pressures_pa, knot, jog);
        self.last = Some((time_us, knot.clone()));
    }

    fn rates(&self, seconds: f64, before: &JogKnot, knot: &JogKnot) {
        let limits: &Limits = self.scene.limits();
        for (drive, (a, b)) in self.limb.drives().zip(before.setpoints.iter().zip(&knot.setpoints)) {
            let most = match drive.kind.display_unit() {
                "deg" => limits.angle_rate_max_rad_per_s,
                "mm" => limits.radius_rate_max_m_per_s,
                "" => limits.stretch_rate_max_per_s,
                _ => None,
            };
            let rate = (b - a).abs() / seconds;
            assert!(
                most.is_none_or(|most| rate <= most + ROUNDED / seconds),
                "{}: {} at {rate}",
                self.name,
                drive.name()
            );
        }
    }

    /// The pressure of a setpoint by the actuator's own solver, within what the drive may have.
    fn pressure_pa(&self, drive: &Drive<'_>, value: f64, jog: &Jog<'_>) -> f64 {
        let pressure_pa = if drive.is_restrained() {
            drive.state_at(value).expect("a state").pressure_pa
        } else {
            match drive.target(value) {
                None => value,
                Some(target) => {
                    let solved = drive.actuator.inverse_from(&drive.actuator.rest(), target, &Load::none()).unwrap();
                    assert_eq!(solved.status, Status::Solved, "{}: {} at {value}", self.name, drive.name());
                    solved.state.pressure_pa
                }
            }
        };
        let limits = self.scene.limits();
        let most_pa = match jog.tier() {
            None => drive.pressure_max_pa.min(drive.reference_max_pa),
            Some(_) => drive.reference_max_pa.min(limits.standing.pressure_share * drive.ceiling_pa()),
        };
        let within = (-1.0..=most_pa + ROUNDED_PA).contains(&pressure_pa);
        assert!(within, "{}: {} at {pressure_pa} Pa of {most_pa}", self.name, drive.name());
        pressure_pa.max(0.0)
    }

    fn body(&mut self, time_us: u64, pressures_pa: &[f64], knot: &JogKnot, jog: &Jog<'_>) {
        let states: Vec<_> = self.limb.drives().zip(pressures_pa).map(|(drive, pa)| drive.curve.at(*pa)).collect();
        let mut body = self.limb.body(&states);
        if jog.tier().is_some() {
            let pose = self.nominal.at(pressures_pa, knot.payload_kg).and_then(softlimb_motion::Pose::unbuckled);
            let pose = pose.unwrap_or_else(|why| panic!("{} at {time_us} us: {why:?}", self.name));
            self.limb.loaded_shape(&pose.rod, &pose.shape.q, &states, &mut body);
        }
        let carried = jog.carrying().object.map(|index| &self.scene.objects()[index]);
        let tilt_max_rad = carried.map(|object| object.tilt_max_rad);
        let turn = body.end().rotation;
        if let Some(object) = carried {
            body.hanging(object.height_m - object.grasp_m, object.grasp_m, object.radius_m);
        }
        for obstacle in self.scene.obstacles() {
            let distance_m = distance_m(&body, &obstacle.shape);
            let least_m = self.scene.limits().clearance_m - ROUNDED_M;
            assert!(distance_m >= least_m, "{} at {time_us} us: {distance_m} m to {}", self.name, *obstacle.name);
        }
        if let Some(most_rad) = tilt_max_rad {
            let taken = *self.taken.get_or_insert(self.turn);
            let axis = turn * (taken.inverse() * Vector3::z());
            let tilt_rad = axis.angle(&Vector3::z());
            assert!(tilt_rad <= most_rad + 1e-4, "{} at {time_us} us: tilt {tilt_rad}", self.name);
        } else {
            self.taken = None;
        }
        self.turn = turn;
    }
}

/// Distance of points on the surface of a body from a solid.
fn distance_m(body: &Body, shape: &Shape) -> f64 {
    let points = body.pieces().iter().flat_map(|piece| (0..=6).map(move |part| (piece, f64::from(part) / 6.0)));
    points
        .map(|(piece, share)| shape.distance(&piece.point_m(share)).distance_m - piece.radius_m())
        .fold(f64::INFINITY, f64::min)
}
