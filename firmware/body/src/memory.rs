//! An actuator's memory: the pressure that its deformation takes beyond that of its elastic curve.
//!
//! `p = pel(q) (1 + a s) + stops(q) + Prony(pel)`, with the deformation `q` (stretch less one, bend or twist rate). Stops are springs
//! with sliders (Maxwell slip), which make loops that do not depend on the rate. A Prony series makes creep and damping. Layers of the
//! curve soften as the deformation first travels above them.
//!
//! All of it lives in the deformation, so that loads act as pressures do, and a path that closes in pressure and deformation gains no work.

use nalgebra::ComplexField;

use crate::curve::Curve;

/// Sliders of the loop.
const STOPS: usize = 6;
/// Thresholds of the sliders, of the range of the deformation.
const THRESHOLDS: [f64; STOPS] = [0.02, 0.056, 0.092, 0.128, 0.164, 0.2];
/// Terms of creep and of damping.
const SLOW: usize = 3;
const TERMS: usize = 6;
/// Time constants of creep, then of damping, s.
const TIMES_S: [f64; TERMS] = [3.0, 20.0, 150.0, 0.02, 0.1, 0.4];
/// Share of a creeping term in the whole creep.
const CREEP_SHARES: [f64; SLOW] = [0.3, 0.3, 0.4];
/// Layers of the curve that soften.
const LAYERS: usize = 5;
/// Travel in which a layer loses all but 1/e of its excess stiffness, of the range.
const SOFTENING_TRAVEL: f64 = 0.6;

/// Effects that a memory has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Loops that do not depend on the rate.
    pub hysteresis: bool,
    /// Creep and damping.
    pub creep: bool,
    /// Damping, also without creep.
    pub damping: bool,
    /// Softening in the first cycles.
    pub softening: bool,
}

impl Effects {
    /// No memory: elastic.
    pub const NONE: Self = Self { hysteresis: false, creep: false, damping: false, softening: false };
    /// Full memory.
    pub const ALL: Self = Self { hysteresis: true, creep: true, damping: true, softening: true };
}

/// Strengths of the effects, in units of the range of pressure and deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryParameters {
    /// Stiffness of all sliders before they slide.
    pub loop_stiffness: f64,
    /// Pressure that creep takes back in all, of the elastic one.
    pub creep: f64,
    /// The same of damping, which is over within two seconds.
    pub damping: f64,
    /// Excess stiffness of a wall that was never loaded, of the elastic one.
    pub softening: f64,
}

impl MemoryParameters {
    /// Only these effects.
    #[must_use]
    pub fn with(self, effects: Effects) -> Self {
        let keep = |kept: bool, value: f64| if kept { value } else { 0.0 };
        Self {
            loop_stiffness: keep(effects.hysteresis, self.loop_stiffness),
            creep: keep(effects.creep, self.creep),
            damping: keep(effects.creep || effects.damping, self.damping),
            softening: keep(effects.softening, self.softening),
        }
    }

    fn is_none(&self) -> bool {
        [self.loop_stiffness, self.creep, self.damping, self.softening].iter().all(|strength| *strength == 0.0)
    }

    /// Strength of a term of the series.
    fn term(&self, term: usize) -> f64 {
        CREEP_SHARES.get(term).map_or(self.damping / (TERMS - SLOW) as f64, |share| self.creep * share)
    }
}

/// State of the memory of one piece of wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    parameters: MemoryParameters,
    /// Deformation at which the range ends, and the elastic pressure there, Pa.
    range: [f64; 2],
    /// Elastic pressure at the bottom of each layer and at the top of the last, of the range.
    layers: [f64; LAYERS + 1],
    /// Deformation at the last instant, of the range, and its elastic pressure.
    place: f64,
    elastic: f64,
    /// Force of each slider.
    stops: [f64; STOPS],
    /// Elastic pressure to which each term has relaxed, of the range.
    relaxed: [f64; TERMS],
    /// Remaining share of the excess stiffness of each layer.
    fresh: [f64; LAYERS],
}

impl Memory {
    /// Of a wall that was never loaded, with its elastic pressure over its deformation. The range is up to the curve's last node.
    pub fn new(curve: &Curve, parameters: MemoryParameters) -> Self {
        let range = curve.end();
        let bottom = |layer: usize| curve.at(range[0] * layer as f64 / LAYERS as f64) / range[1];
        Self {
            parameters,
            range,
            layers: std::array::from_fn(bottom),
            place: 0.0,
            elastic: curve.at(0.0) / range[1],
            stops: [0.0; STOPS],
            relaxed: [curve.at(0.0) / range[1]; TERMS],
            fresh: [1.0; LAYERS],
        }
    }

    /// Pressure beyond the elastic one, Pa, once the deformation has gone evenly to `deformation` within `span_s` >= 0.
    pub fn excess_pa(&self, curve: &Curve, deformation: f64, span_s: f64) -> f64 {
        if self.parameters.is_none() { 0.0 } else { self.moved(curve, deformation, span_s).excess() * self.range[1] }
    }

    /// Takes the deformation there.
    pub fn advance(&mut self, curve: &Curve, deformation: f64, span_s: f64) {
        if !self.parameters.is_none() {
            *self = self.moved(curve, deformation, span_s);
        }
    }

    fn excess(&self) -> f64 {
        let slides: f64 = self.stops.iter().sum();
        let flows = self.relaxed.iter().enumerate().map(|(term, y)| self.parameters.term(term) * (self.elastic - y));
        let softens = (0..LAYERS).map(|layer| self.parameters.softening * self.fresh[layer] * self.in_layer(layer));
        slides + flows.sum::<f64>() + softens.sum::<f64>()
    }

    /// Share of the elastic pressure in a layer. The first layer includes all below it, the last one all above it.
    fn in_layer(&self, layer: usize) -> f64 {
        let low = if layer == 0 { f64::NEG_INFINITY } else { self.layers[layer] };
        let high = if layer + 1 == LAYERS { f64::INFINITY } else { self.layers[layer + 1] };
        self.elastic.clamp(low, high) - self.layers[layer]
    }

    fn moved(&self, curve: &Curve, deformation: f64, span_s: f64) -> Self {
        let mut next = self.clone();
        next.place = deformation / self.range[0];
        next.elastic = curve.at(deformation) / self.range[1];
        let step = next.place - self.place;
        let stiffness = self.parameters.loop_stiffness / STOPS as f64;
        for (force, threshold) in next.stops.iter_mut().zip(THRESHOLDS) {
            *force = (*force + stiffness * step).clamp(-stiffness * threshold, stiffness * threshold);
        }
        if span_s > 0.0 {
            // The exact answer to a pressure that changes evenly.
            for (relaxed, time_s) in next.relaxed.iter_mut().zip(TIMES_S) {
                let lag = (next.elastic - self.elastic) * time_s / span_s;
                *relaxed = next.elastic - lag + (*relaxed - self.elastic + lag) * ComplexField::exp(-span_s / time_s);
            }
        }
        for (layer, fresh) in next.fresh.iter_mut().enumerate() {
            let bottom = layer as f64 / LAYERS as f64;
            let travel = (next.place.max(bottom) - self.place.max(bottom)).abs();
            *fresh *= ComplexField::exp(-travel / SOFTENING_TRAVEL);
        }
        next
    }
}
