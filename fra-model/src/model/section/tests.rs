//! The nodes that a bend takes against many more of them.

extern crate std;

use std::println;
use std::vec::Vec;

use super::moment::{Bend, Pair};
use super::nodes::{Digits, Wall, angles};
use super::*;
use crate::number::scalar::Scalar;

/// Nodes of Gauss-Legendre on (-1, 1) by Newton's method on the recurrence of the polynomials.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for j in 2..=n {
            let j = j as f64;
            (before, here) = (here, ((2.0 * j - 1.0) * x * here - (j - 1.0) * before) / j);
        }
        (here, n as f64 * (x * here - before) / (x * x - 1.0))
    };
    let node = |i: usize| {
        let mut x = (core::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..10 {
            let (value, slope) = legendre(x);
            x -= value / slope;
        }
        let (_, slope) = legendre(x);
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(node).collect()
}

/// A section by its ratios.
fn section(inner: f64, winding: f64, a: f64, b: f64) -> Section<f64> {
    let fiber = crate::Fiber {
        angle_rad: 0.0,
        families: crate::Families::Two,
        modulus_pa: 0.0,
        placement: crate::Placement::Sheet,
        thickness_m: 1e-4,
        radius_m: winding,
    };
    Section::new(&ActuatorParameters {
        motion: crate::Motion::Bending,
        inner_radius_m: inner,
        outer_radius_m: 1.0,
        length_m: 1.0,
        material: Material::Yeoh { c_pa: [0.5, 0.5 * a, b / 3.0] },
        fiber: Some(fiber),
    })
}

/// The moment and its slope by the midpoint rule of many angles and many nodes in `ln R`, which crowd towards the outer face.
fn by_many(s: &Section<f64>, k: f64) -> [f64; 2] {
    let bend = Bend::new(k, s.winding, s.a, s.b);
    let rule = gauss(24);
    let count = if k < 1.0 { 64 } else { 320 };
    let (mut to, mut width) = (0.0, if k < 1.0 { 0.3 } else { 0.3 / (k * k) + 0.02 });
    let end = 2.0 * s.inner.ln();
    let mut sums = [Sum::default(); 2];
    while to > end {
        let from = f64::max(to - width, end);
        for &(t, weight) in &rule {
            let square = (0.5 * (from + to) + 0.5 * (to - from) * t).exp();
            let weight = weight * 0.5 * (to - from) * square * core::f64::consts::PI / f64::from(count);
            let ring = bend.ring(square);
            for j in 0..count / 2 {
                let angle = core::f64::consts::PI * (f64::from(j) + 0.5) / f64::from(count);
                let (density, curve) = bend.summed::<Pair<f64>>(&ring, &[(angle.cos(), angle.sin())]);
                sums[0].add(weight * density);
                sums[1].add(weight * curve);
            }
        }
        (to, width) = (from, (width * 1.5).min(0.5));
    }
    sums.map(|sum| sum.value + sum.lost)
}

/// A sum with what its roundings have lost.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let next = self.value + term;
        let (large, small) = if self.value.abs() > term.abs() { (self.value, term) } else { (term, self.value) };
        self.lost += (large - next) + small;
        self.value = next;
    }
}

/// Relative error of a moment and its slope in their roundings: those of the wall's thickness and of a slope that is a difference.
fn error<T: Scalar + Into<f64>>(found: &Bent<T>, many: [f64; 2], inner: f64, k: f64) -> f64 {
    let thin = 1.0 / (1.0 - inner);
    let moment = (found.moment.into() / many[0] - 1.0).abs();
    let slope = (found.slope.into() - many[1]).abs() / many[1].abs().max(many[0] / k);
    moment.max(slope) / (5.0 + thin) / T::epsilon().into()
}

fn walls() -> impl Iterator<Item = (f64, f64, f64, f64)> {
    let inners = [0.03, 0.1, 0.2, 0.35, 0.5, 0.6, 0.7, 0.75, 0.82, 0.85, 0.9, 0.93, 0.97];
    inners.into_iter().flat_map(|inner| {
        [1.0, 0.5 * (1.0 + inner), inner + 0.01 * (1.0 - inner)].into_iter().enumerate().map(move |(i, winding)| {
            let law = if i == 1 { (0.2, 0.03) } else { (0.0, 0.0) };
            (inner, winding, law.0, law.1)
        })
    })
}

const BENDS: [f64; 17] =
    [1e-6, 1e-3, 4e-3, 0.01, 0.03, 0.05, 0.08, 0.12, 0.16, 0.2, 0.25, 0.299, 0.4, 0.7, 1.5, 6.0, 40.0];

#[test]
fn nodes_of_a_bend_are_as_good_as_many_more() {
    // Of slight bends, of others, and of all in single precision.
    let mut worst = [0.0_f64; 3];
    for (inner, winding, a, b) in walls() {
        let double = section(inner, winding, a, b);
        let single = Section::new(&parameters_in_single(inner, winding, a, b));
        for k in BENDS {
            let many = by_many(&double, k);
            let which = usize::from(k > 0.3);
            worst[which] = worst[which].max(error(&double.bent(k, &EndLoad::none()), many, inner, k));
            worst[2] = worst[2].max(error(&single.bent(k as f32, &EndLoad::none()), many, inner, k));
            let rough = double.sampled(k, &EndLoad::none(), Digits::Few);
            let off = (rough.moment / many[0] - 1.0).abs();
            assert!(off < 1e-3 || k > 0.3, "rough: {off:.1e} at {inner} {winding} {k}");
        }
    }
    println!("worst errors: {worst:.2?} roundings");
    assert!(worst[0] < 4.0 && worst[1] < 8.0 && worst[2] < 4.0, "{worst:?}");
}

fn parameters_in_single(inner: f64, winding: f64, a: f64, b: f64) -> ActuatorParameters<f32> {
    let s = section(inner, winding, a, b);
    ActuatorParameters {
        motion: crate::Motion::Bending,
        inner_radius_m: inner as f32,
        outer_radius_m: 1.0,
        length_m: 1.0,
        material: Material::Yeoh { c_pa: [0.5, 0.5 * s.a as f32, s.b as f32 / 3.0] },
        fiber: Some(crate::Fiber {
            angle_rad: 0.0,
            families: crate::Families::Two,
            modulus_pa: 0.0,
            placement: crate::Placement::Sheet,
            thickness_m: 1e-4,
            radius_m: winding as f32,
        }),
    }
}

/// Few nodes in a slight bend and a thin wall; the count, so that nobody loses it unawares.
#[test]
fn slight_bends_of_thin_walls_take_few_nodes() {
    let count = |inner: f64, k: f64| {
        let (s, mut radii) = (section(inner, 1.0, 0.0, 0.0), 0);
        let bend = Bend::new(k, 1.0, 0.0, 0.0);
        Wall::new(inner, 1.0).for_each(k, || bend.fold(), Digits::All, |_, _| radii += 1);
        (radii, angles(s.nearness(k), Digits::All))
    };
    assert_eq!(count(0.85, 0.0), (6, 2));
    assert_eq!(count(0.85, 0.04), (6, 6));
    assert_eq!(count(0.75, 0.1), (7, 8));
    assert_eq!(count(0.6, 0.2), (10, 10));
}

/// A neo-Hookean wall that is not very thick has one bend for every moment; a very thick one has not.
#[test]
fn moment_rises_throughout_where_it_is_taken_to() {
    for inner in [THICK, 0.13, 0.2, 0.4, 0.7, 0.95] {
        for part in 0..4 {
            for (a, b) in [(0.0, 0.0), (0.3, 0.0), (0.0, 0.1), (1.0, 1.0)] {
                let s = section(inner, 1.0 - (1.0 - inner) * f64::from(part) / 3.0, a, b);
                assert!(!s.may_turn());
                let mut k = 1e-4;
                while k < 50.0 {
                    assert!(s.bent(k, &EndLoad::none()).slope > 0.0, "{inner} {part} {a} {b} {k}");
                    k *= 1.1;
                }
            }
        }
    }
    let thick = section(0.02, 1.0, 0.0, 0.0);
    assert!(thick.may_turn() && thick.bent(0.23, &EndLoad::none()).slope < 0.0);
}
