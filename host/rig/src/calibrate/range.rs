//! The Yeoh law of a tensile test over the widest range of stretch that it describes.

use fra_model::Material;
use nalgebra::{DMatrix, DVector};

use super::tension::{Law, Tension, shares, solve};

/// Largest root mean square of the relative residuals.
const RMS_MAX: f64 = 0.05;
/// Largest relative residual.
const WORST_MAX: f64 = 0.1;
/// Least stretch that the range must reach: a law of less is of no use in an actuator.
const REACH: f64 = 2.0;
/// Fewest readings of a range: twice the coefficients.
const FEWEST: usize = 6;

/// A Yeoh law, and the part of a tensile test that it describes.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeFit {
    /// Coefficients C1, C2, C3, Pa.
    pub c_pa: [f64; 3],
    /// Least and largest stretch of the readings in the range.
    pub stretch: [f64; 2],
    /// Root mean square of the relative residuals in the range.
    pub rms: f64,
    /// Largest relative residual in the range.
    pub worst: f64,
}

impl RangeFit {
    /// The law for the model.
    pub fn material(&self) -> Material<f64> {
        Material::Yeoh { c_pa: self.c_pa }
    }

    /// The law's nominal stress at a stretch, Pa.
    pub fn stress_pa(&self, stretch: f64) -> f64 {
        shares(Law::Yeoh, stretch).iter().zip(self.c_pa).map(|(share, c)| share * c).sum()
    }
}

/// Fits the Yeoh law to the relative stresses of the widest range of a tensile test.
///
/// The range begins at the first reading from which any range serves: a slack specimen reads too little stress there. It ends at the last
/// reading up to which the law is within 5 % rms and 10 % of each reading, and its stress grows with the stretch in tension,
/// equibiaxial tension and pure shear. `None` where no range reaches a stretch of 2.
pub fn fit_range(test: &Tension) -> Option<RangeFit> {
    let mut points: Vec<[f64; 2]> = test.points().iter().filter(|point| point[0] > 1.0).copied().collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let ranges = (0..points.len()).flat_map(|from| (from + FEWEST..=points.len()).rev().map(move |to| (from, to)));
    let mut reaching = ranges.filter(|(_, to)| points[to - 1][0] >= REACH);
    reaching.find_map(|(from, to)| fit(&points[from..to]))
}

fn fit(points: &[[f64; 2]]) -> Option<RangeFit> {
    if points.iter().any(|point| point[1] <= 0.0) {
        return None;
    }
    let rows: Vec<Vec<f64>> = points.iter().map(|point| shares(Law::Yeoh, point[0])).collect();
    let matrix = DMatrix::from_fn(points.len(), 3, |i, k| rows[i][k] / points[i][1]);
    let found = solve(&matrix, &DVector::from_element(points.len(), 1.0));
    let residuals = (&matrix * &found).add_scalar(-1.0);
    let c_pa = [found[0], found[1], found[2]];
    let fit = RangeFit {
        c_pa,
        stretch: [points.first()?[0], points.last()?[0]],
        rms: (residuals.norm_squared() / points.len() as f64).sqrt(),
        worst: residuals.amax(),
    };
    (fit.rms <= RMS_MAX && fit.worst <= WORST_MAX && is_stable(c_pa, fit.stretch[1])).then_some(fit)
}

/// Whether the nominal stress grows with the stretch in tension, equibiaxial tension and pure shear, up to the first invariant at a stretch
/// in tension.
fn is_stable([c1, c2, c3]: [f64; 3], stretch: f64) -> bool {
    let most = stretch * stretch + 2.0 / stretch - 3.0;
    let stiffness = |x: f64| c1 + 2.0 * c2 * x + 3.0 * c3 * x * x;
    // First invariant less 3, and the factor of 2 W' in the nominal stress, of an incompressible wall at a stretch l.
    let tension = |l: f64| (l * l + 2.0 / l - 3.0, l - l.powi(-2));
    let biaxial = |l: f64| (2.0 * l * l + l.powi(-4) - 3.0, l - l.powi(-5));
    let shear = |l: f64| (l * l + 1.0 + l.powi(-2) - 3.0, l - l.powi(-3));
    let grows = |state: &dyn Fn(f64) -> (f64, f64)| {
        let stretches = (1..).map(|step| 1.0 + 1e-3 * f64::from(step));
        let states = stretches.map(state).take_while(|(x, _)| *x <= most);
        let mut stresses = states.map(|(x, lever)| stiffness(x) * lever);
        stresses.try_fold(0.0, |last, stress| (stress > last).then_some(stress)).is_some()
    };
    grows(&tension) && grows(&biaxial) && grows(&shear)
}
