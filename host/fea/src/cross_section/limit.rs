//! The limit point at the end of a branch: Newton's method at a given volume goes past it, where the pressure falls.
//!
//! Pressures and their slopes by the volume on both sides are those of one cubic, whose largest value is the limit pressure.

use super::chain::Linear;
use super::model::{Form, State};
use super::path::{Path, Point, SETTLED};

/// Steps of the volume up to the limit point.
const STEPS: u32 = 8;
/// Iterations of a step.
const NEWTON_STEPS: u32 = 12;
/// Largest change that is still taken for an iteration on its way.
const FAR: f64 = 1.0;
/// Change of the form of which the change of the volume is taken.
const PROBE: f64 = 1e-4;

/// Volume, pressure and the slope of the pressure by the volume.
#[derive(Clone, Copy, Debug)]
struct Node {
    volume: f64,
    pressure: f64,
    slope: f64,
}

impl Node {
    fn at(state: &State, linear: &Linear) -> Self {
        Self { volume: linear.volume, pressure: state.pressure, slope: linear.compliance.recip() }
    }
}

impl Path<'_> {
    /// The limit pressure next to an equilibrium, whose slope falls with the volume at a rate; `None` where no equilibrium is found behind it.
    pub(super) fn limit(&mut self, here: &Point, mut fall: f64) -> Option<f64> {
        let (mut state, mut linear) = (here.state.clone(), here.linear.clone());
        for _ in 0..STEPS {
            let before = Node::at(&state, &linear);
            (state, linear) = self.at_volume(&state, &linear, 2.0 * before.slope / fall)?;
            let behind = Node::at(&state, &linear);
            if behind.slope < 0.0 {
                return Some(highest(&before, &behind));
            }
            fall = (before.slope - behind.slope) / (behind.volume - before.volume);
            (fall > 0.0).then_some(())?;
        }
        None
    }

    /// The equilibrium whose volume is larger than that of another one.
    fn at_volume(&mut self, state: &State, linear: &Linear, more: f64) -> Option<(State, Linear)> {
        let target = linear.volume + more;
        let mut state = state.clone();
        let mut along = Form::none(&self.chain.grid);
        along.add(more / linear.compliance, &linear.by_pressure);
        self.step(&mut state, &along);
        let load = self.load;
        let mut change = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            self.work.newton += 1;
            let linear = self.chain.solve(&state, &load).ok()?;
            if change < SETTLED {
                return Some((state, linear));
            }
            // Newton's step at constant pressure, and as much of the change by the pressure as leads to the volume.
            let share = f64::min(1.0, PROBE / linear.step.largest());
            let mut probe = state.form.clone();
            probe.add(share, &linear.step);
            let by_step = (self.chain.potential(&probe).1 - linear.volume) / share;
            let rise = (target - linear.volume - by_step) / linear.compliance;
            let mut step = linear.step;
            step.add(rise, &linear.by_pressure);
            change = step.largest();
            if change.is_nan() || change > FAR {
                return None;
            }
            state.pressure += rise;
            self.step(&mut state, &step);
        }
        None
    }
}

/// The highest pressure of the cubic between two nodes, the first before it and the second behind.
fn highest(first: &Node, second: &Node) -> f64 {
    let length = second.volume - first.volume;
    let [m0, m1] = [first, second].map(|node| node.slope * length);
    let rise = second.pressure - first.pressure;
    // p = p0 + m0 t + b t^2 + a t^3
    let (a, b) = (m0 + m1 - 2.0 * rise, 3.0 * rise - 2.0 * m0 - m1);
    let mut t = m0 / (m0 - m1);
    for _ in 0..20 {
        t = (t - (m0 + t * (2.0 * b + 3.0 * a * t)) / (2.0 * b + 6.0 * a * t)).clamp(0.0, 1.0);
    }
    first.pressure + t * (m0 + t * (b + a * t))
}
