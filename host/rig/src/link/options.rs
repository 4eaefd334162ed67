//! Every time-out and choice of a run, in one place.

use std::sync::atomic::AtomicBool;

use softlimb_protocol::RetryPolicy;

use super::sampling::Sampling;

/// Settings of a streamed run. Times in us.
#[derive(Clone, Copy, Debug)]
pub struct StreamOptions<'a> {
    /// Number of the session; should differ from the last one's.
    pub session: u16,
    /// When a reliable message is repeated and given up. A setpoint is repeated after the same silence.
    pub retry: RetryPolicy,
    /// Time between two heartbeats: a quarter of the device's link timeout, or less.
    pub heartbeat_us: u64,
    /// Knots in a frame while more are pending: limited to the number that fits, at most 16.
    pub batch: u8,
    /// Samples to request beside the telemetry.
    pub sampling: Option<Sampling>,
    /// Silence of a connected device after which the link counts as lost: longer than a USB port pauses at times. The device does not
    /// wait for it, but acts by its own `link_timeout_us`.
    pub silence_max_us: u64,
    /// Longest time to wait for a device whose last host is silent, but not yet for long enough to be followed by another.
    pub occupied_max_us: u64,
    /// Longest time of a configured device to find its sensors plausible and to take their zeros. After 5 s it names a reading that does not
    /// come to rest.
    pub ready_max_us: u64,
    /// Longest time of the reservoir to reach the configuration's lowest supply pressure.
    pub supply_max_us: u64,
    /// Time from filling the buffer to the start in the first attempt; each further one doubles it.
    pub lead_us: u64,
    /// Attempts to have the setpoints on the device before their start.
    pub attempts_max: u32,
    /// Stretch of setpoints that is buffered before the start, and that a full buffer must cover: the pause of the host that it bridges.
    pub buffer_us: u64,
    /// Vent the limb once the last knot has passed. `false` leaves the device holding: only for a simulated device that is not used again. A
    /// run that fails vents in either case.
    pub vents: bool,
    /// Longest time of the pressures to go down.
    pub vent_max_us: u64,
    /// Longest time to try to vent after an error.
    pub abort_max_us: u64,
    /// Time to listen to the device after an error, unless it is ready before: its reaction belongs to the run.
    pub aftermath_us: u64,
    /// Clear a fault that is latched from before, instead of refusing to run.
    pub clear_faults: bool,
    /// The run ends, vented, soon after this becomes true.
    pub cancel: Option<&'a AtomicBool>,
}

impl StreamOptions<'_> {
    /// The defaults with a session number.
    #[must_use]
    pub fn new(session: u16) -> Self {
        Self {
            session,
            retry: RetryPolicy { attempts_max: 20, ..RetryPolicy::default() },
            heartbeat_us: 25_000,
            batch: 8,
            sampling: None,
            silence_max_us: 1_000_000,
            occupied_max_us: 0,
            ready_max_us: 6_000_000,
            supply_max_us: 120_000_000,
            lead_us: 300_000,
            attempts_max: 5,
            buffer_us: 500_000,
            vents: true,
            vent_max_us: 60_000_000,
            abort_max_us: 500_000,
            aftermath_us: 5_000_000,
            clear_faults: false,
            cancel: None,
        }
    }
}
