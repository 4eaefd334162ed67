//! From rest to a pressure: the steps in which load and pressure are raised.
//!
//! A step is taken back where Newton's method does not settle, where it settles far from what the tangent predicted (another branch), or
//! where the equilibrium it finds is unstable. When steps have become short, the branch has ended: there is no equilibrium beyond.

use std::f64::consts::PI;

use super::chain::{Chain, Linear};
use super::model::{Form, State};

/// Change of a displacement or strain, in units of the inner radius, after which one more step of Newton's method changes nothing.
pub(super) const SETTLED: f64 = 1e-9;
const NEWTON_STEPS: u32 = 12;
/// Largest change that is still taken for an iteration on its way.
const FAR: f64 = 1e2;
/// Growth of the changes from one iteration to the next that is still taken for one on its way.
const GROWTH: f64 = 4.0;
/// Largest distance of the end of a step from its prediction by the tangent, relative to its length.
pub(super) const STRAY: f64 = 0.6;
/// Shortest step of the pressure, in units of the pressure asked for, and of the load.
pub(super) const SHORTEST: f64 = 1e-4;

/// An equilibrium and the linear system at it.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) state: State,
    pub(super) linear: Linear,
    /// Change of the fibers' tensions by the pressure.
    tensions_by_pressure: Vec<[f64; 2]>,
}

/// End of a path.
#[derive(Clone, Debug)]
pub(super) enum Reached {
    Equilibrium(Box<Point>),
    /// The branch ends near this pressure.
    End {
        pressure: f64,
    },
    /// The branch ends before the load is applied at zero pressure.
    EndOfLoad,
    /// The iteration does not get beyond this pressure, and it does not show why.
    Stuck {
        pressure: f64,
    },
}

/// Why a step was taken back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    Unsettled,
    Strayed,
    Unstable,
}

/// Work done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Work {
    pub(super) increments: u32,
    pub(super) rejected: u32,
    pub(super) newton: u32,
}

/// A section under a load, led through rising pressures.
#[derive(Debug)]
pub(super) struct Path<'a> {
    pub(super) chain: &'a mut Chain,
    pub(super) load: [f64; 4],
    here: Option<Point>,
    /// The equilibrium before, at another pressure.
    before: Option<Point>,
    /// Answer to everything beyond.
    end: Option<Reached>,
    pub(super) work: Work,
}

impl<'a> Path<'a> {
    pub(super) fn new(chain: &'a mut Chain, load: [f64; 4]) -> Self {
        Self { chain, load, here: None, before: None, end: None, work: Work::default() }
    }

    /// The equilibrium at a pressure that is not lower than the last one.
    pub(super) fn to(&mut self, pressure: f64) -> Reached {
        if self.here.is_none() && self.end.is_none() {
            match self.apply_load() {
                Ok(point) => self.here = Some(point),
                Err(end) => self.end = Some(end),
            }
        }
        match (&self.end, self.here.take()) {
            (None, Some(here)) => self.raise(here, pressure),
            (end, here) => {
                let end = end.clone().unwrap_or(Reached::EndOfLoad);
                self.here = here;
                end
            }
        }
    }

    /// Raises the pressure in steps, the first all the way.
    fn raise(&mut self, mut here: Point, pressure: f64) -> Reached {
        let mut step = pressure - here.state.pressure;
        while here.state.pressure < pressure {
            let left = pressure - here.state.pressure;
            let target = if step >= 0.999 * left { pressure } else { here.state.pressure + step };
            match self.advance(&here, target) {
                Ok(next) => {
                    self.work.increments += 1;
                    self.before = Some(std::mem::replace(&mut here, next));
                    step *= 2.0;
                }
                Err(refusal) => {
                    self.work.rejected += 1;
                    step = 0.5 * (target - here.state.pressure);
                    if step < SHORTEST * pressure {
                        let end = self.end_at(&here, 2.0 * step, refusal);
                        self.end = Some(end.clone());
                        return end;
                    }
                }
            }
        }
        let reached = Reached::Equilibrium(Box::new(here.clone()));
        self.here = Some(here);
        reached
    }

    /// Why there is nothing within `gap` above an equilibrium. The slope of the pressure falls linearly in the volume near a limit point,
    /// which tells where the pressure is highest; a branch can also lose its stability without that.
    fn end_at(&mut self, here: &Point, gap: f64, refusal: Refusal) -> Reached {
        let from = here.state.pressure;
        let slope = |point: &Point| point.linear.compliance.recip();
        let fall = self
            .before
            .as_ref()
            .map(|before| (slope(before) - slope(here)) / (here.linear.volume - before.linear.volume));
        let more = |fall: f64| 0.5 * slope(here) * slope(here) / fall;
        match fall.filter(|fall| *fall > 0.0 && more(*fall) <= 2.0 * gap) {
            Some(fall) => {
                let limit = self.limit(here, fall).filter(|limit| *limit >= from && *limit <= from + 4.0 * gap);
                Reached::End { pressure: limit.unwrap_or(from + more(fall).min(gap)) }
            }
            None if refusal == Refusal::Unstable => Reached::End { pressure: from + 0.5 * gap },
            None => Reached::Stuck { pressure: from },
        }
    }

    /// One step of the pressure.
    fn advance(&mut self, here: &Point, pressure: f64) -> Result<Point, Refusal> {
        let rise = pressure - here.state.pressure;
        let tangent = |change: &Form, volume: f64| {
            let mut form = here.state.form.clone();
            form.add(rise, change);
            signature(&form, here.linear.volume + rise * volume)
        };
        let predicted = tangent(&here.linear.by_pressure, here.linear.compliance);
        let mut state = self.extrapolated(here, rise);
        state.pressure = pressure;
        let load = self.load;
        let next = self.settle(state, &load)?;
        let from = signature(&here.state.form, here.linear.volume);
        let to = signature(&next.state.form, next.linear.volume);
        let near = distance(&to, &predicted) <= STRAY * distance(&to, &from);
        if near { Ok(next) } else { Err(Refusal::Strayed) }
    }

    /// The state after a rise of the pressure by the tangent here and, to second order, by that at the equilibrium before. The tensions
    /// follow their own tangents: those of stiff fibers are not what strains extrapolated to second order mean.
    fn extrapolated(&self, here: &Point, rise: f64) -> State {
        let before = self
            .before
            .as_ref()
            .map(|before| (before, 0.5 * rise * rise / (here.state.pressure - before.state.pressure)));
        // Not where the steps grow so much that the second order would do harm.
        let (before, times) = before.filter(|(_, times)| *times <= 1.5 * rise).unwrap_or((here, 0.0));
        let mut state = here.state.clone();
        for (point, times) in [(here, rise + times), (before, -times)] {
            state.form.add(times, &point.linear.by_pressure);
            for (tension, slope) in state.tensions.iter_mut().zip(&point.tensions_by_pressure) {
                (0..2).for_each(|family| tension[family] += times * slope[family]);
            }
        }
        state
    }

    /// Newton's method at constant pressure and load.
    pub(super) fn settle(&mut self, mut state: State, load: &[f64; 4]) -> Result<Point, Refusal> {
        let mut before = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            self.work.newton += 1;
            let mut linear = self.chain.solve(&state, load).map_err(|_| Refusal::Unsettled)?;
            let change = linear.step.largest();
            if change.is_nan() || change > f64::min(FAR, GROWTH * before) {
                return Err(Refusal::Unsettled);
            }
            before = change;
            self.step(&mut state, &linear.step);
            if change < SETTLED {
                let stable = linear.instabilities == 0;
                // Those of the system are from before its step.
                (linear.energy, linear.volume) = self.chain.potential(&state.form);
                return if stable { Ok(self.point(state, linear)) } else { Err(Refusal::Unstable) };
            }
        }
        Err(Refusal::Unsettled)
    }

    fn point(&self, state: State, linear: Linear) -> Point {
        let still = self.chain.tensions_after(&state.form, &Form::none(&self.chain.grid));
        let mut slopes = self.chain.tensions_after(&state.form, &linear.by_pressure);
        for (slope, still) in slopes.iter_mut().zip(still) {
            (0..2).for_each(|family| slope[family] -= still[family]);
        }
        Point { state, linear, tensions_by_pressure: slopes }
    }

    /// Moves on, and carries the tensions along the tangent of the fibers' strains.
    pub(super) fn step(&self, state: &mut State, change: &Form) {
        state.tensions = self.chain.tensions_after(&state.form, change);
        state.form.add(1.0, change);
    }
}

/// Strains and volume: what shows whether two states are near.
pub(super) fn signature(form: &Form, volume: f64) -> [f64; 5] {
    let [stretch, first, second, twist] = form.strain;
    [stretch, first, second, twist, volume / PI]
}

pub(super) fn distance(a: &[f64; 5], b: &[f64; 5]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
