//! The largest payload that a limb carries at a place of its tip: pressures follow the payload, and the margins of the statics are kept.

use nalgebra::{DVector, Matrix3xX, Vector3};

use crate::Limb;
use crate::statics::{Fidelity, Load, LoadedLimb, Settled};
use softlimb_scene::Scene;

/// Step of a pressure for a derivative, as a share of the lower of its limit and its limit point.
const STEP: f64 = 1e-4;
/// How near to its place the tip is, m, and iterations to get there.
const NEAR_M: f64 = 5e-5;
const ITERATIONS: usize = 12;
/// The largest payload that is sought, kg.
pub const PAYLOAD_MAX_KG: f64 = 50.0;
/// First step of the payload and its resolution, kg.
const FIRST_KG: f64 = 0.25;
const RESOLUTION_KG: f64 = 0.005;

/// Margins that a limb keeps while it carries a payload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarryLimits {
    /// Error of the statics, a share of the length; > 0.
    pub error: f64,
    /// Least load factor, >= 1.
    pub load_factor_min: f64,
    /// Least buckling margin of a tube, >= 1.
    pub buckling_margin_min: f64,
    /// Highest pressure over the lower of the scene's limit and the limit point.
    pub pressure_share_max: f64,
}

/// The margin that ends the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CarryLimit {
    /// The limb falls, or a tube has no equilibrium.
    Falls,
    /// No pressures bring the tip to its place.
    Reach,
    /// The pressure of a drive.
    Pressure {
        /// Its index.
        drive: usize,
    },
    /// The load factor.
    LoadFactor,
    /// The buckling margin of a tube.
    Buckling,
}

/// The largest payload at a place of the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedLoad {
    /// Mass at the tip, kg; 0 where not even the empty tip keeps the margins there.
    pub payload_kg: f64,
    /// Pressures of the drives with it, gauge Pa.
    pub pressures_pa: Vec<f64>,
    /// What ends it; `None` for [`PAYLOAD_MAX_KG`].
    pub limit: Option<CarryLimit>,
    /// Whether the payload at hand keeps the margins.
    pub keeps: bool,
}

/// The largest payload with the tip where gauge pressures `pressures_pa`, one a drive, hold `payload_kg`.
///
/// The payload grows in steps, and pressures that keep the tip in its place are those next to the pressures before. Margins are
/// [`LoadedLimb::stand`]'s at these pressures.
///
/// # Errors
/// [`CarryLimit::Falls`] where the limb does not stand with the payload at hand.
pub fn carried_load(
    scene: &Scene,
    limb: &Limb,
    (pressures_pa, payload_kg): (&[f64], f64),
    limits: &CarryLimits,
) -> Result<CarriedLoad, CarryLimit> {
    let carrying = Carrying { scene, limb, limits };
    let place_m = carrying.tip_m(pressures_pa, payload_kg).ok_or(CarryLimit::Falls)?;
    let mut found = CarriedLoad { payload_kg, pressures_pa: pressures_pa.to_vec(), limit: None, keeps: true };
    // Beyond the payload at hand, or, where that is too much, below it.
    if let Err(limit) = carrying.keeps(pressures_pa, payload_kg) {
        found = CarriedLoad { limit: Some(limit), keeps: false, ..found };
        let mut kg = payload_kg;
        loop {
            if kg <= 0.0 {
                return Ok(CarriedLoad { payload_kg: 0.0, ..found });
            }
            kg = f64::max(kg - FIRST_KG, 0.0);
            let Ok(pressures_pa) = carrying.placed(&place_m, &found.pressures_pa, kg) else { continue };
            found.pressures_pa = pressures_pa;
            if carrying.keeps(&found.pressures_pa, kg).is_ok() {
                found.payload_kg = kg;
                break;
            }
        }
    }
    // Where it was too much, half of the step is below what is known to be too much.
    let mut step = FIRST_KG * if found.keeps { 1.0 } else { 0.5 };
    while found.payload_kg < PAYLOAD_MAX_KG && 2.0 * step > RESOLUTION_KG {
        let kg = f64::min(found.payload_kg + step, PAYLOAD_MAX_KG);
        let next = carrying.placed(&place_m, &found.pressures_pa, kg);
        match next.and_then(|next| carrying.keeps(&next, kg).map(|()| next)) {
            Ok(next) => {
                (found.payload_kg, found.pressures_pa) = (kg, next);
            }
            Err(limit) => (found.limit, step) = (Some(limit), 0.5 * step),
        }
    }
    Ok(found)
}

struct Carrying<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    limits: &'a CarryLimits,
}

impl Carrying<'_> {
    fn loaded(&self, pressures_pa: &[f64], payload_kg: f64) -> Option<LoadedLimb> {
        let channels = self.limb.channel_values(pressures_pa);
        let bays: Vec<usize> = self.limb.modules().iter().map(crate::LimbModule::bays).collect();
        LoadedLimb::new(self.scene, self.limb, &channels, &bays, &Load { payload_kg, ..Load::default() })
    }

    fn settled(&self, pressures_pa: &[f64], payload_kg: f64, start: Option<&DVector<f64>>) -> Option<Settled> {
        self.loaded(pressures_pa, payload_kg)?.settle(Fidelity::Linear, start).ok()
    }

    fn tip_m(&self, pressures_pa: &[f64], payload_kg: f64) -> Option<Vector3<f64>> {
        Some(self.settled(pressures_pa, payload_kg, None)?.shape.tip().translation.vector)
    }

    /// Highest pressures that keep their margin, gauge Pa.
    fn most_pa(&self) -> Vec<f64> {
        self.limb.drives().map(|drive| self.limits.pressure_share_max * drive.ceiling_pa()).collect()
    }

    /// Pressures next to `pressures_pa` that hold the tip in a place under a payload: the smallest changes that lead there within the margin. A pressure
    /// at its margin stays there, and the others make up for it.
    fn placed(&self, place_m: &Vector3<f64>, pressures_pa: &[f64], payload_kg: f64) -> Result<Vec<f64>, CarryLimit> {
        let spans = self.most_pa();
        let mut pressures: Vec<f64> = pressures_pa.iter().zip(&spans).map(|(pa, most)| pa.min(*most)).collect();
        for _ in 0..ITERATIONS {
            let here = self.settled(&pressures, payload_kg, None).ok_or(CarryLimit::Falls)?;
            let tip = here.shape.tip().translation.vector;
            let off = place_m - tip;
            if off.norm() < NEAR_M {
                return Ok(pressures);
            }
            let mut slopes = Matrix3xX::zeros(pressures.len());
            for (drive, span) in spans.iter().enumerate() {
                // Towards the middle of the range: there is an equilibrium on that side.
                let step = if pressures[drive] < 0.5 * span { STEP * span } else { -STEP * span };
                let mut moved = pressures.clone();
                moved[drive] += step;
                let there = self.tip_m(&moved, payload_kg).ok_or(CarryLimit::Falls)?;
                slopes.set_column(drive, &((there - tip) * (span / step)));
            }
            let changes = smallest(slopes, &off, |drive, change| {
                let pressure = pressures[drive] + change * spans[drive];
                (pressures[drive] <= 0.0 && pressure < 0.0)
                    || (pressures[drive] >= spans[drive] && pressure > spans[drive])
            })?;
            for ((pressure, change), span) in pressures.iter_mut().zip(changes).zip(&spans) {
                *pressure = (*pressure + change.clamp(-0.2, 0.2) * span).clamp(0.0, *span);
            }
        }
        let at_margin = pressures.iter().zip(&spans).position(|(pa, most)| pa >= most);
        Err(at_margin.map_or(CarryLimit::Reach, |drive| CarryLimit::Pressure { drive }))
    }

    /// Whether the limb keeps its margins.
    fn keeps(&self, pressures_pa: &[f64], payload_kg: f64) -> Result<(), CarryLimit> {
        let limits = self.limits;
        let most_pa = self.most_pa();
        if let Some(drive) = pressures_pa.iter().zip(most_pa).position(|(pa, most)| *pa > most * (1.0 + 1e-9)) {
            return Err(CarryLimit::Pressure { drive });
        }
        let loaded = self.loaded(pressures_pa, payload_kg).ok_or(CarryLimit::Falls)?;
        let standing = loaded.stand(limits.error, self.scene.rest_length_m()).map_err(|_| CarryLimit::Falls)?;
        let kept = [
            (standing.load_factor >= limits.load_factor_min, CarryLimit::LoadFactor),
            (standing.buckling_margin >= limits.buckling_margin_min, CarryLimit::Buckling),
        ];
        kept.into_iter().find(|(kept, _)| !kept).map_or(Ok(()), |(_, limit)| Err(limit))
    }
}

/// The smallest changes whose sum by `slopes` is `off`; those of columns that are `held` at the end of their range are 0.
fn smallest(
    mut slopes: Matrix3xX<f64>,
    off: &Vector3<f64>,
    held: impl Fn(usize, f64) -> bool,
) -> Result<Vec<f64>, CarryLimit> {
    for _ in 0..=slopes.ncols() {
        let least = 1e-4 * slopes.norm();
        let changes = slopes.clone().svd(true, true).solve(off, least).map_err(|_| CarryLimit::Reach)?;
        let Some(drive) =
            (0..changes.len()).find(|drive| changes[*drive].abs() > 1e-12 && held(*drive, changes[*drive]))
        else {
            return Ok(changes.iter().copied().collect());
        };
        slopes.column_mut(drive).fill(0.0);
    }
    Err(CarryLimit::Reach)
}
