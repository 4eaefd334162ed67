//! From rest to the external load, without pressure.

use super::path::{Path, Point, Reached, Refusal, SHORTEST, STRAY, distance, signature};

impl Path<'_> {
    /// From rest to the load, without pressure.
    pub(super) fn apply_load(&mut self) -> Result<Point, Reached> {
        let (rest, stuck) = (self.chain.rest(), |_| Reached::Stuck { pressure: 0.0 });
        let (mut here, mut share, mut step) = (self.settle(rest, &[0.0; 4]).map_err(stuck)?, 0.0, 1.0);
        // Shares of the load and the squared stiffness against it, which near a limit point falls linearly.
        let mut passed: Vec<[f64; 2]> = Vec::new();
        while share < 1.0 && self.load != [0.0; 4] {
            let to = f64::min(share + step, 1.0);
            let (stiffness, advanced) = self.advance_load(&here, share, to);
            if passed.last().is_none_or(|last| last[0] < share) {
                passed.push([share, stiffness * stiffness]);
            }
            match advanced {
                Ok(next) => {
                    self.work.increments += 1;
                    (here, share, step) = (next, to, 2.0 * step);
                }
                Err(refusal) => {
                    self.work.rejected += 1;
                    step *= 0.5;
                    if step < SHORTEST {
                        let ends = refusal == Refusal::Unstable || vanishes_within(&passed, 8.0 * step);
                        return Err(if ends { Reached::EndOfLoad } else { Reached::Stuck { pressure: 0.0 } });
                    }
                }
            }
        }
        Ok(here)
    }

    /// One step of the load from a share of it to another; the first of Newton's steps is the prediction. Also the stiffness against the
    /// load where the step begins.
    fn advance_load(&mut self, here: &Point, from: f64, to: f64) -> (f64, Result<Point, Refusal>) {
        let load = self.load.map(|component| to * component);
        self.work.newton += 1;
        let Ok(linear) = self.chain.solve(&here.state, &load) else { return (f64::NAN, Err(Refusal::Unsettled)) };
        let work: f64 = self.load.iter().zip(&linear.step.strain).map(|(force, strain)| force * strain).sum();
        let stiffness = (to - from) / work;
        let mut state = here.state.clone();
        self.step(&mut state, &linear.step);
        let predicted = signature(&state.form, here.linear.volume);
        let settled = self.settle(state, &load);
        let near = |next: &Point| {
            let ends = [&here.state.form, &next.state.form].map(|form| signature(form, here.linear.volume));
            distance(&ends[1], &predicted) <= STRAY * distance(&ends[1], &ends[0])
        };
        (stiffness, settled.and_then(|next| if near(&next) { Ok(next) } else { Err(Refusal::Strayed) }))
    }
}

/// Whether the line through the last two of (argument, value) falls to zero within `gap` of the last.
fn vanishes_within(passed: &[[f64; 2]], gap: f64) -> bool {
    let [.., before, last] = passed else { return false };
    let more = last[1] * (last[0] - before[0]) / (before[1] - last[1]);
    (0.0..=gap).contains(&more)
}
