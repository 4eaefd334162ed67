//! From rest to a pressure: Newton's method, and the steps in which load and pressure are raised.
//!
//! A step is taken back where Newton's method does not settle, where it settles far from what the tangent predicted (another branch), or
//! where the equilibrium it finds is unstable. When steps have become short, the branch has ended: there is no equilibrium beyond.

use super::chain::{Chain, Linear};
use super::model::{Form, State};

/// Change of a displacement or strain, in units of the inner radius, after which one more step of Newton's method changes nothing.
const SETTLED: f64 = 1e-9;
const NEWTON_STEPS: u32 = 12;
/// Largest change that is still taken for an iteration on its way.
const FAR: f64 = 1e2;
/// Growth of the changes from one iteration to the next that is still taken for one on its way.
const GROWTH: f64 = 4.0;
/// How far from its prediction a step may end, relative to its length.
const STRAY: f64 = 0.6;
/// Shortest step of the pressure, in units of the pressure asked for, and of the load.
const SHORTEST: f64 = 1e-4;

/// An equilibrium and the linear system at it.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) state: State,
    pub(super) linear: Linear,
}

/// Where a path led.
#[derive(Clone, Debug)]
pub(super) enum Reached {
    Equilibrium(Box<Point>),
    /// The branch ends near this pressure.
    End {
        pressure: f64,
    },
    /// The branch ends before the load is applied at zero pressure.
    EndOfLoad,
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
    chain: &'a mut Chain,
    load: [f64; 4],
    here: Option<Point>,
    /// Where the branch is known to end.
    end: Option<f64>,
    pub(super) work: Work,
}

impl<'a> Path<'a> {
    pub(super) fn new(chain: &'a mut Chain, load: [f64; 4]) -> Self {
        Self { chain, load, here: None, end: None, work: Work::default() }
    }

    /// The equilibrium at a pressure that is not lower than the last one.
    pub(super) fn to(&mut self, pressure: f64) -> Reached {
        if self.here.is_none() {
            match self.apply_load() {
                Some(point) => self.here = Some(point),
                None => return Reached::EndOfLoad,
            }
        }
        if let Some(end) = self.end {
            return Reached::End { pressure: end };
        }
        let Some(mut here) = self.here.take() else { return Reached::EndOfLoad };
        let mut step = pressure - here.state.pressure;
        while here.state.pressure < pressure {
            let left = pressure - here.state.pressure;
            let target = if step >= 0.999 * left { pressure } else { here.state.pressure + step };
            match self.advance(&here, target) {
                Some(next) => {
                    self.work.increments += 1;
                    here = next;
                    step *= 2.0;
                }
                None => {
                    self.work.rejected += 1;
                    step = 0.5 * (target - here.state.pressure);
                    if step < SHORTEST * pressure {
                        let end = here.state.pressure + step;
                        self.end = Some(end);
                        self.here = Some(here);
                        return Reached::End { pressure: end };
                    }
                }
            }
        }
        let reached = Reached::Equilibrium(Box::new(here.clone()));
        self.here = Some(here);
        reached
    }

    /// From rest to the load, without pressure.
    fn apply_load(&mut self) -> Option<Point> {
        let rest = self.chain.rest();
        let (mut here, mut share, mut step) = (self.settle(rest, &[0.0; 4])?, 0.0, 1.0);
        if self.load == [0.0; 4] {
            return Some(here);
        }
        while share < 1.0 {
            let to = f64::min(share + step, 1.0);
            let load = self.load.map(|component| to * component);
            match self.settle(here.state.clone(), &load) {
                Some(next) => {
                    self.work.increments += 1;
                    (here, share, step) = (next, to, 2.0 * step);
                }
                None => {
                    self.work.rejected += 1;
                    step *= 0.5;
                    if step < SHORTEST {
                        return None;
                    }
                }
            }
        }
        Some(here)
    }

    /// One step of the pressure, or nothing if it does not stay on the branch.
    fn advance(&mut self, here: &Point, pressure: f64) -> Option<Point> {
        let rise = pressure - here.state.pressure;
        let mut state = here.state.clone();
        self.step(&mut state, rise, &here.linear.by_pressure);
        state.pressure = pressure;
        let predicted = self.signature(&state.form, here.linear.volume + rise * here.linear.compliance);
        let load = self.load;
        let next = self.settle(state, &load)?;
        let from = self.signature(&here.state.form, here.linear.volume);
        let to = self.signature(&next.state.form, next.linear.volume);
        (distance(&to, &predicted) <= STRAY * distance(&to, &from)).then_some(next)
    }

    /// Strains and volume: what shows whether two states are near.
    fn signature(&self, form: &Form, volume: f64) -> [f64; 5] {
        let [stretch, first, second, twist] = form.strain;
        [stretch, first, second, twist, volume / std::f64::consts::PI]
    }

    /// Newton's method at constant pressure.
    fn settle(&mut self, mut state: State, load: &[f64; 4]) -> Option<Point> {
        let mut before = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            self.work.newton += 1;
            let linear = self.chain.solve(&state, load).ok()?;
            let change = linear.step.largest();
            if change.is_nan() || change > f64::min(FAR, GROWTH * before) {
                return None;
            }
            before = change;
            let step = linear.step.clone();
            self.step(&mut state, 1.0, &step);
            if change < SETTLED {
                return (linear.instabilities == 0).then_some(Point { state, linear });
            }
        }
        None
    }

    /// Moves on, and carries the tensions along the tangent of the fibers' strains.
    fn step(&self, state: &mut State, times: f64, change: &Form) {
        state.tensions = self.chain.tensions_after(&state.form, times, change);
        state.form.add(times, change);
    }
}

fn distance(a: &[f64; 5], b: &[f64; 5]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
