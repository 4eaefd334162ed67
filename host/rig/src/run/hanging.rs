//! The simulated limb under its weight: true actuators at their true pressures, in equilibrium at every sample.
//!
//! Quasi-static: the limb has the shape that the loads of the moment lead to, and no inertia. Its walls follow the pressures within
//! milliseconds; what swings is left out.

use std::sync::Arc;

use fra_model::{Actuator, State};
use nalgebra::{DVector, Vector4};
use softlimb_fea::cross_section::BendingLaw;
use softlimb_sim::plant::{TrueSegment, Truth};

use crate::record::FaultRecord;
use softlimb_limb::statics::{EquilibriumError, Fidelity, Load, LoadedLimb, Settled, Spring};
use softlimb_limb::{Drive, Limb, bending_law};
use softlimb_scene::Scene;
use softlimb_scene::collision::Body;

/// The finest tier of rods: what plans a limb uses a coarser one.
const TIER: Fidelity = Fidelity::Fourfold;
/// Compression of a tube over its load of buckling from which no rod is right, and at which it has buckled.
const NEAR_BUCKLING: f64 = 0.5;
const BUCKLED: f64 = 1.0;
/// Bends backwards below this are those of a straight module whose tubes are not quite equal, rad/m.
const BACKWARDS_RAD_PER_M: f64 = 0.05;
/// Codes of what is seen on the limb; those of devices are below 240.
pub(super) const FALLS: u8 = 240;
const BUCKLES: u8 = 241;
const BENT_BACK: u8 = 242;
/// The channel of what concerns the whole system.
pub(super) const SYSTEM: u8 = 0xFF;

/// The simulated limb under load.
pub(super) struct Hanging<'a> {
    /// What is simulated.
    plant: &'a Scene,
    limb: &'a Limb,
    /// True actuators, one a channel, in a series one a segment; known from the first sample on.
    actuators: Option<Vec<Made>>,
    /// Strains of the modules at the last sample, and its unknowns.
    last: Option<(Vec<Vector4<f64>>, DVector<f64>)>,
    lost: bool,
    /// Faults reported so far, by code and module.
    told: Vec<(u8, usize)>,
}

/// A shape under load.
pub(super) struct Hung {
    /// Position of the tip, m.
    pub(super) tip_m: [f64; 3],
    /// Setpoint value of each drive, as its module is deformed.
    pub(super) values: Vec<f64>,
    /// The centre line, m.
    pub(super) line_m: Vec<[f64; 3]>,
    /// The limb as a solid.
    pub(super) body: Body,
}

impl<'a> Hanging<'a> {
    /// The limb that setpoints of a scene drive, before it hangs; `None` where the scene does not simulate its weight.
    pub(super) fn new(scene: &Scene, (plant, limb): (&'a Scene, &'a Limb)) -> Option<Self> {
        scene.weight().filter(|weight| weight.simulated)?;
        Some(Self { plant, limb, actuators: None, last: None, lost: false, told: Vec::new() })
    }

    /// The shape at a time of the run, us, with a mass at the tip, kg, and what happens to the limb there; `free` are the drives' states without load.
    ///
    /// `None` from the moment on at which the limb falls: where to is not in the model.
    pub(super) fn at(
        &mut self,
        (time_us, payload_kg): (u64, f64),
        truth: &Truth,
        free: &[State<f64>],
    ) -> (Option<Hung>, Vec<FaultRecord>) {
        if self.lost {
            return (None, Vec::new());
        }
        let mut faults = Vec::new();
        let mut tell = |code: u8, value: f64, text: String| {
            let time_s = time_us as f64 * 1e-6;
            faults.push(FaultRecord { time_s, channel: SYSTEM, code, value: value as i32, text });
        };
        let load = Load { payload_kg, ..Load::default() };
        let Some(limb) = self.loaded(truth, &load) else {
            self.lost = true;
            tell(
                FALLS,
                0.0,
                "an actuator has no equilibrium at its pressure: the limb's shape is not known from here on".into(),
            );
            return (None, faults);
        };
        let limb = match &self.last {
            Some((strains, _)) => limb.at_strains(strains).unwrap_or(limb),
            None => limb,
        };
        let Settled { limb, rod, shape } = match limb.settle(TIER, self.last.as_ref().map(|(_, q)| q)) {
            Ok(found) => found,
            Err(why @ (EquilibriumError::Overstrained { .. } | EquilibriumError::Unsettled)) => {
                self.lost = true;
                tell(FALLS, 0.0, format!("{why}: the limb's shape is not known from here on"));
                return (None, faults);
            }
            Err(EquilibriumError::Unstable { share }) => {
                self.lost = true;
                let carries =
                    format!("the limb falls: it carries {:.1} % of its load, and where to is not known", 100.0 * share);
                tell(FALLS, 1e3 * share, carries);
                return (None, faults);
            }
        };
        self.last = Some((limb.strains(&rod, &shape.q), shape.q.clone()));
        if let Some(tube) = limb.buckling(&rod, &shape).filter(|tube| tube.ratio() > NEAR_BUCKLING) {
            let (name, percent) = (&self.limb.modules()[tube.module].name, 100.0 * tube.ratio());
            if tube.ratio() >= BUCKLED {
                self.lost = true;
                tell(
                    FALLS,
                    10.0 * percent,
                    format!(
                        "a tube of `{name}` buckles between two plates: the limb's shape is not known from here on"
                    ),
                );
                return (None, faults);
            }
            if first(&mut self.told, (BUCKLES, tube.module)) {
                tell(
                    BUCKLES,
                    10.0 * percent,
                    format!(
                        "a tube of `{name}` carries {percent:.0} % of the load that it buckles at: the shape is not to be trusted"
                    ),
                );
            }
        }
        if let Some(module) = limb.bent_back(&rod, &shape, BACKWARDS_RAD_PER_M)
            && first(&mut self.told, (BENT_BACK, module))
        {
            let name = &self.limb.modules()[module].name;
            tell(
                BENT_BACK,
                0.0,
                format!(
                    "the load bends `{name}` backwards, where its lines would have to shorten: the shape is not to be trusted"
                ),
            );
        }
        let deformed = limb.deformed(&rod, &shape);
        let value = |(drive, free): (Drive<'_>, &State<f64>)| {
            drive.deformed_value(&deformed[drive.index]).unwrap_or_else(|| drive.measure(free))
        };
        let values = self.limb.drives().zip(free).map(value);
        let (tip_m, values) = (shape.tip().translation.vector.into(), values.collect());
        let mut body = Body::new(self.limb.base());
        self.limb.loaded_shape(&rod, &shape.q, free, &mut body);
        (Some(Hung { tip_m, values, line_m: rod.line_m(&shape), body }), faults)
    }

    /// The limb of the true actuators; `None` where one has no equilibrium.
    fn loaded(&mut self, truth: &Truth, load: &Load) -> Option<LoadedLimb> {
        if self.actuators.is_none() {
            self.actuators = Some(made(self.limb, truth)?);
        }
        let tubes: Option<Vec<Spring>> = self.actuators.as_ref()?.iter().map(|made| tube(made, truth)).collect();
        LoadedLimb::of_springs(self.plant, self.limb, &tubes?, load)
    }
}

/// A true actuator or segment, with the law of a bender whose model is the finite elements of its section.
struct Made {
    channel: usize,
    /// Index in the series.
    segment: Option<usize>,
    actuator: Actuator<f64>,
    law: Option<Arc<BendingLaw>>,
}

/// A true tube: springs at its pressure about the shape that it has, creep included. Below ambient pressure those at rest, as the plant has it.
fn tube(made: &Made, truth: &Truth) -> Option<Spring> {
    let channel = truth.channels.get(made.channel)?;
    let shape = made.segment.map_or(Some(&channel.shape), |segment| channel.segments.get(segment))?;
    let pressure_pa = channel.pressure_pa.max(0.0);
    let spring = match &made.law {
        Some(law) => Spring::by_section(&made.actuator, law, pressure_pa),
        None => Spring::new(&made.actuator, pressure_pa),
    };
    Some(spring?.about(shape))
}

/// The true actuators, part after part of the limb, those of all channels in each.
fn made(limb: &Limb, truth: &Truth) -> Option<Vec<Made>> {
    let mut all: Vec<(Made, TrueSegment)> = Vec::with_capacity(truth.channels.len());
    for module in limb.modules() {
        for (index, part) in module.parts().iter().enumerate() {
            for channel in part.channels.clone() {
                let parameters = &truth.channels.get(channel)?.parameters;
                let segment = module.is_series().then_some(index);
                let own = match segment {
                    Some(segment) => *parameters.segments.get(segment)?,
                    None => parameters.whole(),
                };
                let (actuator, law) = if part.is_by_section() {
                    let known = all.iter().find(|(made, other)| made.law.is_some() && *other == own);
                    let known = known.and_then(|(made, _)| made.law.clone());
                    let find = || bending_law(&own.actuator, own.second_fiber.as_ref(), part.pressure_max_pa);
                    (Actuator::new(&own.actuator).ok()?, Some(known.or_else(find)?))
                } else {
                    (own.model().ok()?, None)
                };
                all.push((Made { channel, segment, actuator, law }, own));
            }
        }
    }
    Some(all.into_iter().map(|(made, _)| made).collect())
}

/// Whether something is new, and notes it.
fn first(told: &mut Vec<(u8, usize)>, what: (u8, usize)) -> bool {
    let new = !told.contains(&what);
    if new {
        told.push(what);
    }
    new
}
