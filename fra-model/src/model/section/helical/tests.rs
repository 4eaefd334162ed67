//! Bends with a helical winding, computed a second time from the coordinates of their map: all derivatives are finite differences.

use core::f64::consts::PI;

use super::super::nodes::equal_angles;
use super::super::*;
use crate::{Families, Fiber, Motion, Placement};

/// Settings of the check: points of half a turn, and steps of the differences.
const POINTS: u32 = 48;
const STEP: f64 = 1e-5;
const BEND_STEP: f64 = 2e-4;

/// Five points of Gauss on (-1, 1).
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

fn parameters(inner: f64, winding: f64, degrees: f64, c_pa: [f64; 3]) -> ActuatorParameters<f64> {
    let fiber = Fiber {
        angle_rad: degrees.to_radians(),
        families: Families::Two,
        modulus_pa: 1e9,
        placement: Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: winding,
    };
    ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: inner,
        outer_radius_m: 1.0,
        length_m: 1.0,
        material: Material::Yeoh { c_pa },
        fiber: Some(fiber),
    }
}

/// The map of a tube with a helical winding.
struct Map {
    k: f64,
    tangent: f64,
    winding: f64,
    radius: f64,
}

impl Map {
    /// The circle of the winding by bisection of its length before the bend.
    fn new(k: f64, tangent: f64, winding: f64) -> Self {
        let (mut low, mut high) = (0.3 * winding, winding);
        let mut map = Self { k, tangent, winding, radius: high };
        for _ in 0..60 {
            map.radius = 0.5 * (low + high);
            let half = map.before(PI);
            // A circle that is too large, or whose thread is too short for it.
            if half.is_nan() || half > PI { high = map.radius } else { low = map.radius }
        }
        map
    }

    fn line(&self) -> f64 {
        self.radius + 1.0 - self.winding
    }

    /// Stretch around the winding: each thread keeps its length.
    fn around(&self, angle: f64) -> f64 {
        let along = 1.0 + self.k * (self.line() - self.radius * angle.cos());
        (1.0 - self.tangent * self.tangent * (along * along - 1.0)).sqrt()
    }

    /// Angle before the bend of a point of the winding at `angle`, by Gauss's rule in panels.
    fn before(&self, angle: f64) -> f64 {
        let panels = 12;
        let width = angle / f64::from(panels);
        let mut sum = 0.0;
        for panel in 0..panels {
            for (t, weight) in GAUSS {
                let at = width * (f64::from(panel) + 0.5 + 0.5 * t);
                sum += 0.5 * width * weight * self.radius / (self.winding * self.around(at));
            }
        }
        sum
    }

    /// Radius of a point by bisection of the volume between it and the winding.
    fn radius_at(&self, before: f64, angle: f64) -> f64 {
        let rate = self.winding * self.around(angle) / self.radius;
        let (one, rho) = (1.0 + self.k * self.line(), self.radius);
        let wanted = 0.5 * (self.winding * self.winding - before * before);
        let (mut low, mut high) = (0.0, 1.5);
        for _ in 0..60 {
            let r = 0.5 * (low + high);
            let volume = one * (rho * rho - r * r) / 2.0 - self.k * angle.cos() * (rho.powi(3) - r.powi(3)) / 3.0;
            if volume * rate > wanted { low = r } else { high = r }
        }
        0.5 * (low + high)
    }

    fn place(&self, before: f64, angle: f64) -> [f64; 2] {
        let r = self.radius_at(before, angle);
        [r * angle.cos(), r * angle.sin()]
    }

    /// First invariant less three at a point, from the gradient of the places.
    fn invariant(&self, before: f64, angle: f64) -> f64 {
        let difference =
            |plus: [f64; 2], minus: [f64; 2], by: f64| [(plus[0] - minus[0]) / by, (plus[1] - minus[1]) / by];
        let outwards = difference(self.place(before + STEP, angle), self.place(before - STEP, angle), 2.0 * STEP);
        let turned = self.before(angle + STEP) - self.before(angle - STEP);
        let around = difference(self.place(before, angle + STEP), self.place(before, angle - STEP), before * turned);
        let along = 1.0 + self.k * (self.line() - self.radius_at(before, angle) * angle.cos());
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        let volume = (outwards[0] * around[1] - outwards[1] * around[0]) * along;
        assert!((volume - 1.0).abs() < 1e-4, "the map keeps volumes: {volume}");
        square(outwards) + square(around) + along * along - 3.0
    }

    fn energy(&self, inner: f64, c_pa: [f64; 3]) -> f64 {
        let panels = 3;
        let width = (1.0 - inner) / f64::from(panels);
        let mut sum = 0.0;
        for panel in 0..panels {
            for (t, weight) in GAUSS {
                let before = inner + width * (f64::from(panel) + 0.5 + 0.5 * t);
                for point in 0..POINTS {
                    let angle = PI * (f64::from(point) + 0.5) / f64::from(POINTS);
                    let rate = self.winding * self.around(angle) / self.radius;
                    let i = self.invariant(before, angle);
                    let energy = i * (c_pa[0] + i * (c_pa[1] + i * c_pa[2]));
                    sum += energy * before * width * weight * PI / f64::from(POINTS) / rate;
                }
            }
        }
        sum
    }

    fn volume(&self) -> f64 {
        PI * self.radius * self.radius * (1.0 + self.k * self.line())
    }
}

/// The pressure of a bend under a torque and a force on the axis.
fn pressure(p: &ActuatorParameters<f64>, tangent: f64, k: f64, (torque, force): (f64, f64)) -> f64 {
    let winding = p.fiber.expect("wound").radius_m;
    let Material::Yeoh { c_pa } = p.material else { panic!("a Yeoh wall") };
    let (plus, minus) = (Map::new(k + BEND_STEP, tangent, winding), Map::new(k - BEND_STEP, tangent, winding));
    let by_bend = |f: &dyn Fn(&Map) -> f64| (f(&plus) - f(&minus)) / (2.0 * BEND_STEP);
    let wall = by_bend(&|map| map.energy(p.inner_radius_m, c_pa));
    let axis = by_bend(&|map| map.k * map.line());
    (wall - torque - force * axis) / by_bend(&Map::volume)
}

#[test]
fn helical_winding_bends_as_its_map_does() {
    for (inner, winding, degrees, k, c_pa) in [
        (0.7, 1.0, 5.0, 0.3, [0.5, 0.0, 0.0]),
        (0.5, 1.0, 20.0, 0.2, [0.5, 0.05, -0.002]),
        (0.9, 1.0, 12.0, 0.4, [0.5, 0.0, 0.0]),
        (0.6, 0.8, 15.0, 0.15, [0.5, 0.0, 0.0]),
        (0.5, 0.9, 30.0, 0.03, [0.5, 0.1, 0.0]),
    ] {
        let p = parameters(inner, winding, degrees, c_pa);
        let section = Section::new(&p);
        for load in [(0.0, 0.0), (0.05, -0.1)] {
            let end = section.end_load(load.1, load.0);
            let found = section.pressure(&section.bent(k, &end), &end);
            let expected = pressure(&p, degrees.to_radians().tan(), k, load);
            assert!((found / expected - 1.0).abs() < 1e-5, "{inner} {winding} {degrees} {k}: {found} {expected}");
        }
    }
}

#[test]
fn hoop_is_the_limit_of_a_helical_winding() {
    for (inner, winding, k) in [(0.7, 1.0, 0.2), (0.5, 0.8, 0.02), (0.9, 1.0, 1e-4)] {
        let helical = Section::new(&parameters(inner, winding, 1e-4, [0.5, 0.02, 0.0]));
        let hoop = Section::new(&parameters(inner, winding, 0.0, [0.5, 0.02, 0.0]));
        assert!(helical.is_helical() && !hoop.is_helical());
        let (none_helical, none_hoop) = (helical.end_load(0.0, 0.0), hoop.end_load(0.0, 0.0));
        let (found, expected) = (helical.bent(k, &none_helical), hoop.bent(k, &none_hoop));
        for (found, expected) in [(found.moment, expected.moment), (found.slope, expected.slope)] {
            assert!((found / expected - 1.0).abs() < 1e-9, "{inner} {winding} {k}: {found} {expected}");
        }
    }
}

/// Slight bends are among them: their moments must not lose digits.
#[test]
fn nodes_of_a_helical_winding_are_as_good_as_many_more() {
    for (inner, winding, degrees) in [(0.9, 1.0, 5.0), (0.5, 1.0, 20.0), (0.7, 0.9, 28.0), (0.6, 1.0, 3.0)] {
        let section = Section::new(&parameters(inner, winding, degrees, [0.5, 0.01, 0.0]));
        let end = section.end_load(0.0, 0.0);
        for k in [1e-6, 1e-3, 0.02, 0.1, 0.2, 0.4] {
            let found = section.bent(k, &end);
            let many = section.integrated_helical(k, &end, Digits::All, &equal_angles::<f64, 96>());
            if !many.moment.is_finite() {
                assert!(!found.moment.is_finite(), "{inner} {degrees} {k}");
                continue;
            }
            for (found, many) in [(found.moment, many.moment), (found.slope, many.slope)] {
                assert!((found / many - 1.0).abs() < 1e-12, "{inner} {degrees} {k}: {found} {many}");
            }
        }
    }
}

#[test]
fn slope_is_the_derivative_of_the_moment() {
    let section = Section::new(&parameters(0.6, 1.0, 18.0, [0.5, 0.05, 0.0]));
    let end = section.end_load(-0.05, 0.02);
    for k in [0.02, 0.1, 0.2] {
        let h = 1e-4;
        let difference = (section.bent(k + h, &end).moment - section.bent(k - h, &end).moment) / (2.0 * h);
        let slope = section.bent(k, &end).slope;
        assert!((slope / difference - 1.0).abs() < 1e-5, "{k}: {slope} {difference}");
    }
}

#[test]
fn pressure_bends_no_tube_wound_beyond_its_neutral_angle() {
    // tan^2 of the angle from the hoop is a half.
    let neutral = 0.5_f64.sqrt().atan().to_degrees();
    let share = |degrees| Section::new(&parameters(0.7, 1.0, degrees, [0.5, 0.0, 0.0])).lever() / PI;
    assert!((share(20.0) - (1.0 - 2.0 * 20.0_f64.to_radians().tan().powi(2))).abs() < 1e-12);
    assert!(share(neutral - 1.0) > 0.03 && share(neutral + 1.0) <= LEAST_LEVER);
}
