//! Every tube of a bundle as its own geometrically exact rod, clamped to rigid plates at both ends; no code in common with the product.
//!
//! What is sought are the poses of the plates. Between two given plates a tube is shot: Runge-Kutta from the wrench at its start, and Newton's
//! method on that wrench until its end is where the plate has it. The wrenches of all tubes, weights and the load leave nothing on a plate.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, Rotation3, Translation3, UnitQuaternion, Vector3, Vector6};

use crate::statics::beam::{Fitted, Tube, end_wrench, fit, gap};

/// Tubes between two plates, and the rigid part behind the second one with masses at distances from that plate.
#[derive(Clone, Debug)]
pub(crate) struct Bay {
    pub(crate) tubes: Vec<Tube>,
    pub(crate) rest_m: f64,
    pub(crate) rigid_m: f64,
    pub(crate) masses: Vec<(f64, f64)>,
}

/// Bays in series.
#[derive(Clone, Debug)]
pub(crate) struct Tubes {
    pub(crate) base: Isometry3<f64>,
    pub(crate) bays: Vec<Bay>,
    pub(crate) gravity_m_per_s2: Vector3<f64>,
    /// Dead force and couple at the tip.
    pub(crate) tip_n: Vector3<f64>,
    pub(crate) tip_nm: Vector3<f64>,
}

/// Poses of the plates, and the tubes of each bay between them.
type Balanced = (Vec<Isometry3<f64>>, Vec<Vec<Fitted>>);

/// What the tubes of a bay do to its two plates: force and moment about each plate's origin, in the frame of the scene.
fn forces(bay: &Bay, plates: [&Isometry3<f64>; 2], gravity: &Vector3<f64>, fitted: &[Fitted]) -> [Vector6<f64>; 2] {
    let mut sums = [Vector6::zeros(); 2];
    for (tube, fitted) in bay.tubes.iter().zip(fitted) {
        let place = Translation3::new(tube.at_m[0], tube.at_m[1], 0.0);
        let (start, stop) = (plates[0] * place, plates[1] * place);
        let weight = start.rotation.inverse() * gravity * tube.kg_per_m;
        let here = tube.shoot(bay.rest_m, &fitted.wrench, &weight);
        // To first order the wrench that closes what is left; nothing is left but where plates are moved for the tangent.
        let change = -fitted.close * gap(&here, &start.inv_mul(&stop));
        let wrenches = [fitted.wrench + change, -(end_wrench(&here) + fitted.end * change)];
        for ((sum, wrench), (plate, at)) in sums.iter_mut().zip(wrenches).zip(plates.into_iter().zip([start, stop])) {
            let force = start.rotation * Vector3::from(wrench.fixed_rows::<3>(0));
            let moment = start.rotation * Vector3::from(wrench.fixed_rows::<3>(3))
                + (at.translation.vector - plate.translation.vector).cross(&force);
            *sum += Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        }
    }
    sums
}

fn moved(pose: &Isometry3<f64>, by: &[f64]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(pose.translation.vector + Vector3::new(by[0], by[1], by[2])),
        UnitQuaternion::from_scaled_axis(Vector3::new(by[3], by[4], by[5])) * pose.rotation,
    )
}

fn unit(axis: usize, size: f64) -> [f64; 6] {
    std::array::from_fn(|a| if a == axis { size } else { 0.0 })
}

impl Tubes {
    /// Rigid part's share of a plate's balance.
    fn dead(&self, bay: usize, plate: &Isometry3<f64>, share: f64) -> Vector6<f64> {
        let axis = plate.rotation * Vector3::z();
        let mut sum = Vector6::zeros();
        let mut add = |arm: f64, force: Vector3<f64>, couple: Vector3<f64>| {
            let moment = (axis * arm).cross(&force) + couple;
            sum += Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z);
        };
        for (distance, kg) in &self.bays[bay].masses {
            add(*distance, self.gravity_m_per_s2 * (kg * share), Vector3::zeros());
        }
        if bay + 1 == self.bays.len() {
            add(self.bays[bay].rigid_m, self.tip_n * share, self.tip_nm * share);
        }
        sum
    }

    /// Where a bay starts.
    fn start(&self, plates: &[Isometry3<f64>], bay: usize) -> Isometry3<f64> {
        if bay == 0 {
            return self.base;
        }
        plates[bay - 1] * Translation3::new(0.0, 0.0, self.bays[bay - 1].rigid_m)
    }

    /// Balance of all plates and its derivative by their poses.
    fn balance(
        &self,
        plates: &[Isometry3<f64>],
        share: f64,
        fitted: &mut [Vec<Fitted>],
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let count = 6 * plates.len();
        let (mut left, mut slope) = (DVector::zeros(count), DMatrix::zeros(count, count));
        let gravity = self.gravity_m_per_s2 * share;
        for (index, bay) in self.bays.iter().enumerate() {
            let start = self.start(plates, index);
            let tubes = bay.tubes.iter().zip(&mut fitted[index]);
            for (tube, fitted) in tubes {
                let place = Translation3::new(tube.at_m[0], tube.at_m[1], 0.0);
                let goal = (start * place).inv_mul(&(plates[index] * place));
                let weight = start.rotation.inverse() * gravity * tube.kg_per_m;
                *fitted = fit(tube, bay.rest_m, &goal, &weight, &fitted.wrench)?;
            }
            // Forces on the plate that the bay starts at and on the one behind it, by the poses of both.
            let on = |before: Option<&Isometry3<f64>>, after: &Isometry3<f64>| {
                let origin = before.map_or(self.base, |plate| *plate);
                let arm = if index == 0 { 0.0 } else { self.bays[index - 1].rigid_m };
                let start = origin * Translation3::new(0.0, 0.0, arm);
                let [mut first, mut second] = forces(bay, [&start, after], &gravity, &fitted[index]);
                let force = Vector3::from(first.fixed_rows::<3>(0));
                let moment = (origin.rotation * Vector3::z() * arm).cross(&force);
                (0..3).for_each(|axis| first[3 + axis] += moment[axis]);
                second += self.dead(index, after, share);
                [first, second]
            };
            let before = index.checked_sub(1).map(|before| &plates[before]);
            let here = on(before, &plates[index]);
            let mut put = |row: usize, values: &Vector6<f64>| {
                (0..6).for_each(|a| left[6 * row + a] += values[a]);
            };
            put(index, &here[1]);
            if index > 0 {
                put(index - 1, &here[0]);
            }
            for (column, which) in [(index.checked_sub(1), 0), (Some(index), 1)] {
                let Some(column) = column else { continue };
                for axis in 0..6 {
                    let step = 1e-6;
                    let at = |size: f64| {
                        let by = moved(&plates[column], &unit(axis, size));
                        if which == 0 { on(Some(&by), &plates[index]) } else { on(before, &by) }
                    };
                    let (more, less) = (at(step), at(-step));
                    for (row, plate) in [(index.checked_sub(1), 0), (Some(index), 1)] {
                        let Some(row) = row else { continue };
                        for a in 0..6 {
                            slope[(6 * row + a, 6 * column + axis)] += (more[plate][a] - less[plate][a]) / (2.0 * step);
                        }
                    }
                }
            }
        }
        Some((left, slope))
    }

    fn newton(&self, start: &[Isometry3<f64>], share: f64, fitted: &[Vec<Fitted>]) -> Option<Balanced> {
        let (mut plates, mut fitted) = (start.to_vec(), fitted.to_vec());
        for _ in 0..15 {
            let (left, slope) = self.balance(&plates, share, &mut fitted)?;
            let step = (-&slope).lu().solve(&left)?;
            if step.amax() < 1e-9 {
                // A minimum of the potential: the stiffness is positive.
                let stiffness = -0.5 * (&slope + slope.transpose());
                return stiffness.cholesky().map(|_| (plates, fitted));
            }
            if step.amax() >= 0.5 || !step.amax().is_finite() {
                return None;
            }
            for (plate, by) in plates.iter_mut().zip(step.as_slice().chunks(6)) {
                *plate = moved(plate, by);
            }
        }
        None
    }

    /// Pose of the tip in the shape that growing loads lead to; `None` where they do not get there.
    pub(crate) fn tip(&self) -> Option<Isometry3<f64>> {
        let mut pose = self.base;
        let mut plates = Vec::new();
        let mut fitted = Vec::new();
        for bay in &self.bays {
            let mean = bay.tubes.iter().map(|tube| tube.stretch).sum::<f64>() / bay.tubes.len() as f64;
            pose *= Translation3::new(0.0, 0.0, mean * bay.rest_m);
            plates.push(pose);
            pose *= Translation3::new(0.0, 0.0, bay.rigid_m);
            let none = Fitted { wrench: Vector6::zeros(), close: Matrix6::zeros(), end: Matrix6::zeros() };
            fitted.push(vec![none; bay.tubes.len()]);
        }
        // Unequal tubes find their shape without load first, in steps of their difference.
        let parts = 2;
        for part in 0..=parts {
            let part = f64::from(part) / f64::from(parts);
            let mut like = self.clone();
            for bay in &mut like.bays {
                let mean = bay.tubes.iter().map(|tube| tube.stretch).sum::<f64>() / bay.tubes.len() as f64;
                bay.tubes.iter_mut().for_each(|tube| tube.stretch = mean + (tube.stretch - mean) * part);
            }
            (plates, fitted) = like.newton(&plates, 0.0, &fitted)?;
        }
        let (mut share, mut step) = (0.0, 0.5);
        while share < 1.0 {
            let next = f64::min(share + step, 1.0);
            match self.newton(&plates, next, &fitted) {
                Some(found) => {
                    (plates, fitted) = found;
                    (share, step) = (next, 1.5 * step);
                }
                None if step < 2e-3 => return None,
                None => step *= 0.5,
            }
        }
        let last = self.bays.last()?;
        Some(plates.last()? * Translation3::new(0.0, 0.0, last.rigid_m))
    }
}

/// Places of `count` tubes on a circle.
pub(crate) fn around(count: usize, radius_m: f64) -> Vec<[f64; 2]> {
    let place = |index: usize| {
        let turned =
            Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::TAU * index as f64 / count as f64)
                * Vector3::new(radius_m, 0.0, 0.0);
        [turned.x, turned.y]
    };
    (0..count).map(place).collect()
}
