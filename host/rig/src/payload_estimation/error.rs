//! Errors of payload estimation.

/// Failure of a payload estimation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimationError {
    /// One pose alone gives no interval.
    #[error(
        "{phases} phase{} with and without the load: two are the fewest, because the interval comes from how much they disagree",
        if *.phases == 1 { "" } else { "s" }
    )]
    TooFewPhases {
        /// Their number.
        phases: usize,
    },
    /// An actuator has no equilibrium at its pressure.
    #[error("line {line}: an actuator has no equilibrium at the pressures of this row")]
    NoEquilibrium {
        /// Of the table, from 1.
        line: usize,
    },
    /// The limb falls under its own weight.
    #[error(
        "line {line}: by the model the limb does not carry itself at the pressures of this row: no shape to compare with"
    )]
    Falls {
        /// Of the table, from 1.
        line: usize,
    },
    /// The tip is too stiff.
    #[error(
        "by the model a kilogram moves the tip by {:.1e} mm at most in these poses: too little for a camera to tell a mass by", 1e3 * .most_m_per_kg
    )]
    NotMoved {
        /// Largest displacement of the tip under a small mass, m/kg.
        most_m_per_kg: f64,
    },
    /// The displacement is larger than any under which the limb stands.
    #[error(
        "line {line}: the tip went further than under {carried_kg:.3} kg, and by the model the limb falls under more than that"
    )]
    TooFar {
        /// Of the table, from 1.
        line: usize,
        /// The largest trial mass that the limb carried, kg.
        carried_kg: f64,
    },
    /// The search did not converge.
    #[error(
        "the search for the mass did not settle after {steps} steps, at {kg:.3} kg: the ways of the tip are not those of a weight on it"
    )]
    NotSettled {
        /// Steps made.
        steps: usize,
        /// The last trial mass, kg.
        kg: f64,
    },
}
