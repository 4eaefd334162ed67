//! When the watchdog is fed: only while everything that has to run does.

/// Runs of each part so far; all may wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Slots of the schedule.
    pub slots: u32,
    /// Turns of the controller.
    pub turns: u32,
    /// Visits of the link's interrupt; the controller asks for one every turn.
    pub link: u32,
}

/// Says when to feed the watchdog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    fed_at: Counters,
}

impl Health {
    /// Nothing has run.
    #[must_use]
    pub const fn new() -> Self {
        Self { fed_at: Counters { slots: 0, turns: 0, link: 0 } }
    }

    /// Whether every part has run since the watchdog was last fed.
    pub fn is_time_to_feed(&mut self, now: Counters) -> bool {
        let before = self.fed_at;
        let alive = now.slots != before.slots && now.turns != before.turns && now.link != before.link;
        if alive {
            self.fed_at = now;
        }
        alive
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_part_that_stands_still_starves_the_watchdog() {
        let mut health = Health::new();
        let running = Counters { slots: 10, turns: 1, link: 1 };
        assert!(health.is_time_to_feed(running));
        assert!(!health.is_time_to_feed(running));
        let next = Counters { slots: 20, turns: 2, link: 2 };
        for stuck in [Counters { slots: 10, ..next }, Counters { turns: 1, ..next }, Counters { link: 1, ..next }] {
            assert!(!health.is_time_to_feed(stuck));
        }
        assert!(health.is_time_to_feed(next));
        assert!(health.is_time_to_feed(Counters { slots: 0, turns: 0, link: 0 }), "counters wrap");
    }
}
