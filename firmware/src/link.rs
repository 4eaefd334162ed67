//! Commander of the device, and whether it is still there.

/// Silence after which another host may take over while the configuration states none, us.
const TAKEOVER_US: u64 = 100_000;

/// The owner of the link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Link {
    session: Option<u16>,
    /// A session whose host speaks another interface.
    stranger: Option<u16>,
    heard_us: u64,
}

impl Link {
    pub(crate) const fn new() -> Self {
        Self { session: None, stranger: None, heard_us: 0 }
    }

    /// Whether `session` commands the device.
    pub(crate) fn is_owner(&self, session: u16) -> bool {
        self.session == Some(session)
    }

    /// The session that commands the device.
    pub(crate) fn owner(&self) -> Option<u16> {
        self.session
    }

    /// Opens a session; refused while another owner is still heard.
    pub(crate) fn open(&mut self, now_us: u64, session: u16, timeout_us: Option<u32>) -> bool {
        let timeout_us = timeout_us.map_or(TAKEOVER_US, u64::from);
        let free = self.session.is_none() || self.is_owner(session) || self.silence_us(now_us) > timeout_us;
        if free {
            self.session = Some(session);
            self.stranger = self.stranger.filter(|&stranger| stranger != session);
            self.heard_us = now_us;
        }
        free
    }

    /// Remembers the session of a host that speaks another interface; it loses the session if it had it.
    pub(crate) fn turn_away(&mut self, session: u16) {
        self.stranger = Some(session);
        self.session = self.session.filter(|&owner| owner != session);
    }

    /// Whether the host of this session speaks another interface.
    pub(crate) fn is_stranger(&self, session: u16) -> bool {
        self.stranger == Some(session)
    }

    /// A valid frame of the owner arrived.
    pub(crate) fn heard(&mut self, now_us: u64) {
        self.heard_us = now_us;
    }

    /// Time since the last valid frame of the owner, us.
    pub(crate) fn silence_us(&self, now_us: u64) -> u64 {
        now_us.saturating_sub(self.heard_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_host_takes_over_only_from_a_silent_one() {
        let mut link = Link::new();
        assert!(link.open(0, 7, None));
        link.heard(50_000);
        assert!(!link.open(150_000, 8, None));
        assert!(link.is_owner(7));
        assert!(link.open(150_001, 8, None));
        assert!(!link.is_owner(7));
        assert!(!link.open(250_000, 9, Some(200_000)), "the configured time counts once there is one");
    }
}
