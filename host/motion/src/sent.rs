//! The setpoints of single actuators, as they go over the link.

use std::ops::Range;

use fra_model::State;

use super::plan::Plan;
use super::track::{Track, owners, states};
use super::unreachable::Unreachable;
use super::wire::{from_wire, to_wire};
use softlimb_limb::{Drive, Limb, LimbModule};
use softlimb_scene::Corrections;

/// The setpoints of a plan with corrections, one value a channel at every knot.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    track: Track,
}

impl Sent {
    /// The setpoints of a plan: all actuators of a drive get the drive's.
    pub fn uncorrected(limb: &Limb, plan: &Plan) -> Self {
        let Track { period_us, kinds, knots, states } = &plan.track;
        let track = Track {
            period_us: *period_us,
            kinds: limb.channel_values(kinds),
            knots: knots.iter().map(|row| limb.channel_values(row)).collect(),
            states: states.iter().map(|row| limb.channel_values(row)).collect(),
        };
        Self { track }
    }

    /// The same with corrections, which end where the range of a module ends.
    ///
    /// # Errors
    /// [`Unreachable::OnTheWay`].
    pub(crate) fn corrected(limb: &Limb, plan: &Plan, corrections: &Corrections) -> Result<Self, Unreachable> {
        let plain = Self::uncorrected(limb, plan);
        let owners = limb.channel_values(&owners(limb));
        let Track { period_us, kinds, knots, .. } = plain.track;
        let knots: Vec<Vec<i32>> = (0_u64..)
            .zip(knots)
            .map(|(index, knot)| {
                let added = corrections.at((index * period_us) as f64 * 1e-6);
                let added = added.into_iter().chain(std::iter::repeat(0.0));
                let channels = owners.iter().zip(knot).zip(added);
                channels.map(|((owner, wire), added)| corrected(&limb.modules()[*owner], wire, added)).collect()
            })
            .collect();
        let states = states(limb, &plan.phases, &owners, &knots, period_us)?;
        Ok(Self { track: Track { period_us, kinds, knots, states } })
    }

    /// Time between two knots, us.
    pub fn knot_period_us(&self) -> u64 {
        self.track.period_us
    }

    /// Time of the last knot, us after the start.
    pub fn duration_us(&self) -> u64 {
        self.track.duration_us()
    }

    /// Wire values per channel at every knot.
    pub fn knots(&self) -> &[Vec<i32>] {
        &self.track.knots
    }

    /// Setpoint of every channel at a time, interpolated between knots as the device does.
    pub fn values_at(&self, time_us: f64) -> Vec<f64> {
        self.track.values_at(time_us)
    }

    /// Wire values per channel at a time with an addition to each setpoint; they end where the range of a module ends.
    pub fn corrected_at(&self, limb: &Limb, time_us: f64, added: &[f64]) -> Vec<i32> {
        let owners = limb.channel_values(&owners(limb));
        let setpoints = self.values_at(time_us).into_iter().zip(added).zip(owners);
        setpoints.map(|((value, added), owner)| within(&limb.modules()[owner], value + added)).collect()
    }

    /// States that the model gives for the setpoints at a time, one a channel.
    pub fn states_at(&self, time_us: f64) -> Vec<State<f64>> {
        self.track.states_at(time_us)
    }

    /// Highest gauge pressure of each module's actuators over the run, Pa.
    pub fn highest_pa(&self, limb: &Limb) -> Vec<f64> {
        let of_channels = |channels: &Range<usize>| {
            let rows = self.track.states.iter().flat_map(|row| &row[channels.clone()]);
            rows.map(|state| state.pressure_pa).fold(0.0, f64::max)
        };
        limb.modules().iter().map(|module| of_channels(&module.channels)).collect()
    }

    /// The plan whose drives have the means of their actuators' setpoints.
    #[must_use]
    pub fn averaged(&self, limb: &Limb, plan: &Plan) -> Plan {
        let mean_of = |drive: &Drive<'_>, row: &[i32]| {
            let own = &row[drive.channels.clone()];
            let sum: f64 = own.iter().map(|wire| from_wire(drive.kind, *wire)).sum();
            to_wire(drive.kind, sum / own.len() as f64)
        };
        let state_of = |drive: &Drive<'_>, row: &[State<f64>]| {
            let own = &row[drive.channels.clone()];
            let first = own[0];
            let sum = own[1..].iter().fold(first, |sum, state| State::combine([&sum, state], |[a, b]| a + b));
            State::combine([&sum], |[sum]| sum / own.len() as f64)
        };
        let mut averaged = plan.clone();
        for (index, (knot, states)) in self.track.knots.iter().zip(&self.track.states).enumerate() {
            averaged.track.knots[index] = limb.drives().map(|drive| mean_of(&drive, knot)).collect();
            averaged.track.states[index] = limb.drives().map(|drive| state_of(&drive, states)).collect();
        }
        averaged
    }
}

fn corrected(module: &LimbModule, wire: i32, added: f64) -> i32 {
    within(module, from_wire(module.kind, wire) + added)
}

/// Wire value of a setpoint, within the range of its module.
fn within(module: &LimbModule, value: f64) -> i32 {
    let (rest, last) = module.range();
    to_wire(module.kind, value.clamp(rest.min(last), rest.max(last)))
}
