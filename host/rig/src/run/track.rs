//! Keeps the setpoints of a limb that is moved by hand, for as long as measurements may refer to them.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fra_model::State;

use super::reference::Reference;
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_motion::Nominal;
use softlimb_motion::jog::JogKnot;
use softlimb_scene::Scene;

/// Number of knots that are kept: they span more than the delay of any measurement.
const KNOTS: usize = 512;

/// Knots by their times, us.
#[derive(Debug, Default)]
pub(super) struct Track {
    knots: VecDeque<(u64, JogKnot)>,
}

impl Track {
    /// Takes a knot; one at the time of the last replaces it.
    pub(super) fn push(&mut self, time_us: u64, knot: JogKnot) {
        if self.knots.back().is_some_and(|(last_us, _)| *last_us >= time_us) {
            self.knots.pop_back();
        }
        if self.knots.len() == KNOTS {
            self.knots.pop_front();
        }
        self.knots.push_back((time_us, knot));
    }

    /// Value at a time of a function of two knots and the share between them.
    fn at<R>(&self, time_us: u64, of: impl FnOnce(&JogKnot, &JogKnot, f64) -> R) -> Option<R> {
        let after = self.knots.partition_point(|(knot_us, _)| *knot_us <= time_us);
        let (from_us, from) = self.knots.get(after.saturating_sub(1))?;
        let (to_us, to) = self.knots.get(after).unwrap_or(&self.knots[after - 1]);
        let share =
            if to_us > from_us { (time_us.saturating_sub(*from_us)) as f64 / (to_us - from_us) as f64 } else { 0.0 };
        Some(of(from, to, share))
    }
}

/// A track of the hand and of the log, which may be on two threads.
#[derive(Clone, Debug, Default)]
pub(super) struct SharedTrack(Arc<Mutex<Track>>);

impl SharedTrack {
    pub(super) fn lock(&self) -> MutexGuard<'_, Track> {
        // Nothing panics while it is locked.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A track as the log's reference.
pub(super) struct Tracked<'a> {
    pub(super) limb: &'a Limb,
    pub(super) track: SharedTrack,
    /// The limb under its load; `None` without load.
    nominal: Option<RefCell<Nominal<'a>>>,
}

impl<'a> Tracked<'a> {
    pub(super) fn new(scene: &'a Scene, limb: &'a Limb, tier: Option<Fidelity>, track: SharedTrack) -> Self {
        Self { limb, track, nominal: tier.map(|tier| RefCell::new(Nominal::new(scene, limb, tier))) }
    }

    fn states(&self, time_us: u64) -> Vec<State<f64>> {
        let drives = self.limb.drives().zip(self.values_at(time_us));
        drives.map(|(drive, value)| drive.state_at(value).unwrap_or_else(|| drive.actuator.rest())).collect()
    }
}

impl Reference for Tracked<'_> {
    fn values_at(&self, time_us: u64) -> Vec<f64> {
        let between = |from: &JogKnot, to: &JogKnot, share: f64| {
            from.setpoints.iter().zip(&to.setpoints).map(|(a, b)| a + (b - a) * share).collect()
        };
        let rest = || self.limb.drives().map(|drive| drive.measure(&drive.actuator.rest())).collect();
        self.track.lock().at(time_us, between).unwrap_or_else(rest)
    }

    fn payload_kg(&self, time_us: u64) -> f64 {
        let between =
            |from: &JogKnot, to: &JogKnot, share: f64| from.payload_kg + (to.payload_kg - from.payload_kg) * share;
        self.track.lock().at(time_us, between).unwrap_or(0.0)
    }

    fn tip_m(&self, time_us: u64) -> [f64; 3] {
        let between = |from: &JogKnot, to: &JogKnot, share: f64| {
            std::array::from_fn(|axis| from.tip_m[axis] + (to.tip_m[axis] - from.tip_m[axis]) * share)
        };
        let loaded = self.nominal.as_ref().and_then(|_| self.track.lock().at(time_us, between));
        loaded.unwrap_or_else(|| self.limb.tip(&self.states(time_us)))
    }

    fn line_m(&self, time_us: u64) -> Vec<[f64; 3]> {
        let states = self.states(time_us);
        let pressures_pa: Vec<f64> = states.iter().map(|state| state.pressure_pa.max(0.0)).collect();
        let loaded = self.nominal.as_ref().and_then(|nominal| {
            let pose = nominal.borrow_mut().at(&pressures_pa, self.payload_kg(time_us)).ok()?;
            Some(pose.rod.line_m(&pose.shape))
        });
        loaded.unwrap_or_else(|| self.limb.backbone(&states))
    }
}
