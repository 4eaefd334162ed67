//! Natural vibrations and swing of the loaded limb, as `softlimb check` prints them.

use softlimb_motion::{Plan, Swing, Vibrations, carried};
use softlimb_scene::Scene;

/// A line a phase, two where a mass changes hands, with a heading; nothing of a limb whose setpoints are not corrected for weight.
pub(super) fn rows(scene: &Scene, plan: &Plan, swings: &[Swing]) -> Vec<String> {
    if swings.is_empty() {
        return Vec::new();
    }
    let loss_factor = scene.swing().loss_factor;
    let row = |words: [&str; 7]| {
        let [name, payload, first, second, damping, residual, worst] = words;
        format!("  {name:<16} {payload:>7} {first:>9} {second:>9} {damping:>9} {residual:>9} {worst:>9}")
    };
    let headings = [
        row(["vibrations", "payload", "first", "second", "damping", "swing", "worst"]),
        row(["", "kg", "Hz", "Hz", "%", "mm", "mm"]),
    ];
    let of_phase = |((phase, carried), swing): ((&softlimb_motion::PlannedPhase, softlimb_motion::Carried), &Swing)| {
        let line = |payload_kg: f64, vibrations: &Vibrations, left: [String; 2]| {
            let [first, second] = vibrations.frequency_hz.map(|hz| format!("{hz:.2}"));
            let damping = format!("{:.1}", 100.0 * vibrations.damping[0]);
            row([&phase.name, &format!("{payload_kg:.2}"), &first, &second, &damping, &left[0], &left[1]])
        };
        let left = [swing.residual_m, swing.residual_worst_m].map(|m| format!("{:.1}", 1e3 * m));
        let moved = line(carried.moved.payload_kg, &swing.moved, left);
        let held = swing.held.map(|held| line(carried.held.payload_kg, &held, [String::new(), String::new()]));
        std::iter::once(moved).chain(held.map(|line| line.trim_end().to_owned())).collect::<Vec<_>>()
    };
    let phases = plan.phases.iter().zip(carried(scene.phases())).zip(swings).flat_map(of_phase);
    let note = format!(
        "  swing of the tip after a move, and with frequencies up to 10 % off; damping by a loss factor of {loss_factor}"
    );
    headings.into_iter().chain(phases).chain([note]).collect()
}
