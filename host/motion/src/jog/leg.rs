//! A stretch of setpoints at constant speed.

/// Setpoints of a limb, and where they bring its tip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// One value a drive.
    pub(super) values: Vec<f64>,
    pub(super) tip_m: [f64; 3],
}

/// From row to row of setpoints, in equal times.
#[derive(Clone, Debug)]
pub(super) struct Leg {
    /// At least two.
    pub(super) rows: Vec<Vec<f64>>,
    pub(super) start_us: u64,
    /// Time of the whole, us; > 0.
    pub(super) move_us: u64,
    /// The tip at its start and end, m.
    pub(super) tips_m: [[f64; 3]; 2],
    /// Mass at the tip at its start and end, kg.
    pub(super) payloads_kg: [f64; 2],
    /// Whether it runs to its end in spite of new orders.
    pub(super) whole: bool,
}

impl Leg {
    /// Time of its end, us.
    pub(super) fn end_us(&self) -> u64 {
        self.start_us + self.move_us
    }

    /// Its share at a time, 0 to 1.
    pub(super) fn share(&self, time_us: u64) -> f64 {
        (time_us.saturating_sub(self.start_us) as f64 / self.move_us as f64).min(1.0)
    }

    /// Setpoints at a time, us.
    pub(super) fn at(&self, time_us: u64) -> Vec<f64> {
        let last = self.rows.len() - 1;
        let place = self.share(time_us) * last as f64;
        let before = (place as usize).min(last - 1);
        let share = place - before as f64;
        self.rows[before].iter().zip(&self.rows[before + 1]).map(|(a, b)| a + (b - a) * share).collect()
    }

    /// The tip at a time, on the straight line between those of its ends, m.
    pub(super) fn tip_m(&self, time_us: u64) -> [f64; 3] {
        let ([from, to], share) = (self.tips_m, self.share(time_us));
        std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * share)
    }

    /// Mass at the tip at a time, kg.
    pub(super) fn payload_kg(&self, time_us: u64) -> f64 {
        let [from, to] = self.payloads_kg;
        from + (to - from) * self.share(time_us)
    }
}
