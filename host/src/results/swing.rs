//! Natural vibrations of the loaded limb, and the swing that moves leave.

use serde::Serialize;

use softlimb_motion::Swing;

/// Vibrations and swing of a phase in `--json`.
#[derive(Serialize)]
pub(super) struct PrintedSwing {
    /// The first two at the end of the move, Hz.
    frequency_hz: [f64; 2],
    /// Their damping ratios.
    damping: [f64; 2],
    /// The same at the end of the hold, where a mass changes hands in it.
    held_frequency_hz: Option<[f64; 2]>,
    held_damping: Option<[f64; 2]>,
    /// Largest distance of the tip from its resting place after the move, m; and with frequencies up to 10 % off.
    residual_swing_m: f64,
    residual_swing_worst_m: f64,
}

impl PrintedSwing {
    pub(super) fn new(swing: &Swing) -> Self {
        Self {
            frequency_hz: swing.moved.frequency_hz,
            damping: swing.moved.damping,
            held_frequency_hz: swing.held.map(|held| held.frequency_hz),
            held_damping: swing.held.map(|held| held.damping),
            residual_swing_m: swing.residual_m,
            residual_swing_worst_m: swing.residual_worst_m,
        }
    }
}
