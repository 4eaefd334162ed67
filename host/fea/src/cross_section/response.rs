//! Stress and stiffness at one point of the section: elastomer, pressure and fibers.

use super::build::{Direction, Fibers};
use super::spot::{Spot, V3, cross, dot};
use crate::elastomer::Elastomer;

/// `I4`, the squared stretch along a direction.
pub(super) fn squared_stretch(f: &[V3; 3], direction: Direction) -> f64 {
    let fs = stretched(f, direction);
    dot(&fs, &fs)
}

/// `F S`.
pub(super) fn stretched(f: &[V3; 3], [hoop, axial]: Direction) -> V3 {
    std::array::from_fn(|axis| hoop * f[1][axis] + axial * f[2][axis])
}

/// Stress and stiffness at one spot.
pub(super) struct Response<'a> {
    f: &'a [V3; 3],
    pub(super) energy: f64,
    pub(super) volume_excess: f64,
    /// `dJ/dF`.
    cofactor: [V3; 3],
    /// First Piola-Kirchhoff stress.
    stress: [V3; 3],
    /// Its third column with the carried tensions.
    pub(super) carried_axial: V3,
    /// `2 W'`, `4 W''` and the pressure.
    isotropic: f64,
    stiffening: f64,
    pressure: f64,
    /// For each family: direction, `F S`, twice the carried tension, four times the stiffness.
    fibers: [(Direction, V3, f64, f64); 2],
    families: usize,
}

impl<'a> Response<'a> {
    pub(super) fn new(f: &'a [V3; 3], spot: &Spot, elastomer: Elastomer, tensions: &[f64; 2], pressure: f64) -> Self {
        let mut response = Self {
            f,
            energy: 0.0,
            volume_excess: 0.0,
            cofactor: [[0.0; 3]; 3],
            stress: [[0.0; 3]; 3],
            carried_axial: [0.0; 3],
            isotropic: 0.0,
            stiffening: 0.0,
            pressure,
            fibers: [([0.0; 2], [0.0; 3], 0.0, 0.0); 2],
            families: 0,
        };
        if spot.pressure.is_some() {
            response.add_wall(elastomer);
        }
        response.carried_axial = response.stress[2];
        if let Some(fibers) = &spot.fibers {
            response.add_fibers(fibers, tensions);
        }
        response
    }

    fn add_wall(&mut self, elastomer: Elastomer) {
        let f = self.f;
        let squares: f64 = f.iter().map(|column| dot(column, column)).sum();
        let [energy, slope, curvature] = elastomer.at(squares - 3.0);
        self.cofactor = [cross(&f[1], &f[2]), cross(&f[2], &f[0]), cross(&f[0], &f[1])];
        self.volume_excess = dot(&f[2], &self.cofactor[2]) - 1.0;
        let isotropic = 2.0 * slope;
        (self.isotropic, self.stiffening) = (isotropic, 4.0 * curvature);
        self.energy = energy - self.pressure * self.volume_excess;
        for (column, stress) in self.stress.iter_mut().enumerate() {
            *stress =
                std::array::from_fn(|axis| isotropic * f[column][axis] - self.pressure * self.cofactor[column][axis]);
        }
    }

    fn add_fibers(&mut self, fibers: &Fibers, tensions: &[f64; 2]) {
        self.families = fibers.families;
        for (family, &tension) in tensions.iter().enumerate().take(fibers.families) {
            let direction = fibers.directions[family];
            let fs = stretched(self.f, direction);
            let strain = dot(&fs, &fs) - 1.0;
            self.energy += 0.5 * fibers.stiffness * strain * strain;
            for (axis, component) in fs.iter().enumerate() {
                let pull = 2.0 * fibers.stiffness * strain * component;
                self.stress[1][axis] += direction[0] * pull;
                self.stress[2][axis] += direction[1] * pull;
                self.carried_axial[axis] += 2.0 * tension * direction[1] * component;
            }
            self.fibers[family] = (direction, fs, 2.0 * tension, 4.0 * fibers.stiffness);
        }
    }

    pub(super) fn scale(&mut self, weight: f64) {
        let scale = |vector: &mut V3| vector.iter_mut().for_each(|entry| *entry *= weight);
        self.stress.iter_mut().for_each(scale);
        self.cofactor.iter_mut().for_each(scale);
        scale(&mut self.carried_axial);
        for value in
            [&mut self.energy, &mut self.volume_excess, &mut self.isotropic, &mut self.stiffening, &mut self.pressure]
        {
            *value *= weight;
        }
        for (_, _, tension, stiffness) in &mut self.fibers {
            *tension *= weight;
            *stiffness *= weight;
        }
    }

    pub(super) fn work(&self, df: &[V3; 3]) -> f64 {
        dot(&self.stress[0], &df[0]) + dot(&self.stress[1], &df[1]) + dot(&self.stress[2], &df[2])
    }

    pub(super) fn volume_change(&self, df: &[V3; 3]) -> f64 {
        dot(&self.cofactor[0], &df[0]) + dot(&self.cofactor[1], &df[1]) + dot(&self.cofactor[2], &df[2])
    }

    /// Change of the stress for a change of the deformation gradient.
    pub(super) fn stress_change(&self, df: &[V3; 3]) -> [V3; 3] {
        let f = self.f;
        let mut change = [[0.0; 3]; 3];
        if self.isotropic != 0.0 || self.pressure != 0.0 {
            let along = self.stiffening * (dot(&f[0], &df[0]) + dot(&f[1], &df[1]) + dot(&f[2], &df[2]));
            for column in 0..3 {
                let (next, last) = ((column + 1) % 3, (column + 2) % 3);
                let (u, v) = (cross(&df[next], &f[last]), cross(&f[next], &df[last]));
                for axis in 0..3 {
                    change[column][axis] = self.isotropic * df[column][axis] + along * f[column][axis]
                        - self.pressure * (u[axis] + v[axis]);
                }
            }
        }
        for (direction, fs, tension, stiffness) in &self.fibers[..self.families] {
            let dfs = stretched(df, *direction);
            let stretch = stiffness * dot(fs, &dfs);
            for axis in 0..3 {
                let pull = stretch * fs[axis] + tension * dfs[axis];
                change[1][axis] += direction[0] * pull;
                change[2][axis] += direction[1] * pull;
            }
        }
        change
    }
}
