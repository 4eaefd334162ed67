//! The sheet of a wound thread: its stretch, and the wall that bulges between its turns.

use std::f64::consts::{PI, TAU};

/// Waves that are summed, as a multiple of the distance over the diameter; beyond them the terms fall with the third power.
const WAVES: f64 = 30.0;
/// Fewest and most waves.
const WAVES_RANGE: [f64; 2] = [50.0, 1e4];
/// Product of wave number and depth above which a layer is a half-space.
const DEEP: f64 = 20.0;

/// A thread of a winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Force per strain `E A`, N; > 0.
    pub stiffness_n: f64,
    /// Diameter, m; > 0.
    pub diameter_m: f64,
    /// Threads side by side in each family, at least 1.
    pub starts: u32,
}

/// The wall that a thread is wound on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WoundWall {
    /// Inner radius, m; > 0.
    pub inner_radius_m: f64,
    /// Outer radius, m; above the inner one.
    pub outer_radius_m: f64,
    /// Radius of the thread's centre line, m; within the wall.
    pub winding_radius_m: f64,
    /// Angle from the hoop, rad; not 0.
    pub angle_rad: f64,
    /// Shear modulus at small strain, Pa; > 0.
    pub shear_modulus_pa: f64,
}

impl Thread {
    /// Distance of neighbouring threads of one family, measured across them, m.
    pub fn spacing_m(&self, wall: &WoundWall) -> f64 {
        TAU * wall.winding_radius_m * wall.angle_rad.abs().sin() / f64::from(self.starts)
    }

    /// `modulus x thickness` of one family of threads as close as a sheet, N/m: `E A/(4 spacing)`.
    pub fn ideal_n_per_m(&self, wall: &WoundWall) -> f64 {
        self.stiffness_n / (4.0 * self.spacing_m(wall))
    }

    /// `modulus x thickness` of one family, N/m, with the wall that bulges between its threads.
    ///
    /// Under the pressure `q` of threads at the distance `d`, the mean surface of the wall yields by `B q` more than the threads do. A fiber
    /// of the curvature `cos^2 a/R` has that as the strain `B q cos^2 a/R`, beside `q R d/(cos^2 a E A)` of the thread itself. In total
    /// `1/(4 km) = d/(E A) + B cos^4 a/R^2`.
    pub fn sheet_n_per_m(&self, wall: &WoundWall) -> f64 {
        let spacing_m = self.spacing_m(wall);
        let cos = wall.angle_rad.cos();
        let bulge = bulge_m_per_pa(wall, spacing_m, self.diameter_m) * cos.powi(4) / wall.winding_radius_m.powi(2);
        0.25 / (spacing_m / self.stiffness_n + bulge)
    }
}

/// Mean displacement of the wall over that of the threads, for a unit of mean pressure, m/Pa.
///
/// A pressure on strips as wide as the thread is a sum of waves, `2 sinc(n pi w/d)` each. The displacement of a wave over its pressure is that
/// of the layers on both sides of the threads, and its mean on the strips has the same factor once more.
fn bulge_m_per_pa(wall: &WoundWall, spacing_m: f64, width_m: f64) -> f64 {
    let inside_m = wall.winding_radius_m - wall.inner_radius_m;
    let outside_m = wall.outer_radius_m - wall.winding_radius_m;
    let count = (WAVES * spacing_m / width_m).clamp(WAVES_RANGE[0], WAVES_RANGE[1]) as usize;
    let of_wave = |n: usize| {
        let half = n as f64 * PI * width_m / spacing_m;
        let wave = n as f64 * TAU / spacing_m;
        let stiffness = [inside_m, outside_m].map(|depth_m| layer(wave * depth_m)).iter().sum::<f64>();
        2.0 * (half.sin() / half).powi(2) / (2.0 * wall.shear_modulus_pa * wave * stiffness)
    };
    (1..=count).map(of_wave).sum()
}

/// Stiffness of an incompressible elastic layer under a wave of pressure, over that of a half-space; its other face is free. `x` is the
/// product of wave number and depth. Plane strain, Airy's function; for small `x` it is that of a bent plate, `x^3/6`.
fn layer(x: f64) -> f64 {
    if x > DEEP {
        return 1.0;
    }
    // The differences of the closed form cancel here.
    if x < 1e-2 {
        return x.powi(3) / 6.0;
    }
    (x.sinh().powi(2) - x * x) / (x.sinh() * x.cosh() + x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layer_runs_from_a_plate_to_a_half_space() {
        // D = mu h^3/3 of an incompressible plate; 2 mu k of a half-space.
        assert!((layer(0.02) / (0.02_f64.powi(3) / 6.0) - 1.0).abs() < 1e-3);
        assert!((layer(0.0101) / layer(0.0099) - (0.0101_f64 / 0.0099).powi(3)).abs() < 1e-3);
        assert!((layer(12.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn close_and_soft_threads_are_the_ideal_sheet() {
        let wall = WoundWall {
            inner_radius_m: 0.010,
            outer_radius_m: 0.014,
            winding_radius_m: 0.014,
            angle_rad: 0.05,
            shear_modulus_pa: 0.2e6,
        };
        let soft = Thread { stiffness_n: 0.01, diameter_m: 0.1e-3, starts: 4 };
        let ratio = soft.sheet_n_per_m(&wall) / soft.ideal_n_per_m(&wall);
        assert!((0.999..1.0).contains(&ratio), "{ratio}");
    }
}
