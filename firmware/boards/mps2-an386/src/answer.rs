//! Answers as the line of a table.

use fra_model::{
    Actuator, Blocked, InvalidParameter, Load, Lookup, NoDerivative, NotFinite, SeriesSolution, Solution, State,
    Status, Tracker, Volume,
};
use nalgebra::Isometry3;

/// One answer in the form in which it is printed and compared.
pub(crate) struct Note {
    pub(crate) iterations: u32,
    pub(crate) status: &'static str,
    /// Bits of the number that stands for the answer.
    pub(crate) value: u32,
    /// Over the bits of all numbers.
    pub(crate) digest: u32,
}

impl Note {
    /// An answer that is the given numbers, the first of which stands for it.
    pub(crate) fn of(status: &'static str, iterations: u32, numbers: impl IntoIterator<Item = f32>) -> Self {
        let mut numbers = numbers.into_iter().map(f32::to_bits).peekable();
        let value = numbers.peek().copied().unwrap_or(0);
        // Fowler, Noll, Vo, over words in place of bytes.
        let digest = numbers.fold(0x811c_9dc5, |sum: u32, bits| (sum ^ bits).wrapping_mul(0x0100_0193));
        Self { iterations, status, value, digest }
    }
}

/// An answer that can be noted.
pub(crate) trait Answer {
    /// The line of the table.
    fn note(&self) -> Note;
}

impl Answer for () {
    fn note(&self) -> Note {
        Note::of("-", 0, [])
    }
}

impl Answer for State<f32> {
    fn note(&self) -> Note {
        Note::of("-", 0, numbers(self))
    }
}

impl Answer for Solution<f32> {
    fn note(&self) -> Note {
        Note::of(name(self.status), self.iterations, numbers(&self.state).into_iter().chain([self.residual]))
    }
}

impl Answer for SeriesSolution<f32> {
    fn note(&self) -> Note {
        let state = &self.state;
        let shape = [state.length_m, state.extension_m, state.twist_rad, state.bend_angle_rad];
        let volume = [state.volume_m3, state.volume_change_m3, state.compliance_m3_per_pa, self.residual];
        let numbers = [state.pressure_pa].into_iter().chain(shape).chain(volume);
        Note::of(name(self.status), self.iterations, numbers)
    }
}

impl Answer for Load<f32> {
    fn note(&self) -> Note {
        Note::of("-", 0, [self.force_n, self.torque_nm])
    }
}

impl Answer for Blocked<f32> {
    fn note(&self) -> Note {
        let loads = [self.force_n, self.torque_nm].into_iter().chain(self.by_pressure);
        Note::of(name(self.status), self.iterations, loads.chain(self.stiffness.into_iter().flatten()))
    }
}

impl Answer for Isometry3<f32> {
    fn note(&self) -> Note {
        let place = &self.translation.vector;
        let turn = &self.rotation.coords;
        Note::of("-", 0, [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w])
    }
}

impl Answer for Tracker<f32> {
    fn note(&self) -> Note {
        self.rest().note()
    }
}

impl Answer for Actuator<f32> {
    fn note(&self) -> Note {
        self.rest().note()
    }
}

impl<A: Answer> Answer for Option<A> {
    fn note(&self) -> Note {
        self.as_ref().map_or_else(|| Note::of("none", 0, []), Answer::note)
    }
}

impl<A: Answer> Answer for Result<A, InvalidParameter<f32>> {
    fn note(&self) -> Note {
        self.as_ref().map_or_else(|refused| Note::of(refused.field, 0, [refused.value]), Answer::note)
    }
}

impl Answer for f32 {
    fn note(&self) -> Note {
        Note::of("-", 0, [*self])
    }
}

impl Answer for Result<Lookup<f32>, NotFinite> {
    fn note(&self) -> Note {
        self.map_or_else(|_| Note::of("not finite", 0, []), |found| Note::of("-", 0, [found.pressure_pa, found.beyond]))
    }
}

impl Answer for Result<Volume<f32>, NotFinite> {
    fn note(&self) -> Note {
        let numbers = |found: Volume<f32>| [found.volume_m3, found.compliance_m3_per_pa];
        self.map_or_else(|_| Note::of("not finite", 0, []), |found| Note::of("-", 0, numbers(found)))
    }
}

impl<A: Answer> Answer for Result<A, NoDerivative<f32>> {
    fn note(&self) -> Note {
        self.as_ref().map_or_else(|_| Note::of("no derivative", 0, []), Answer::note)
    }
}

fn name(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::NoSolution => "no solution",
        Status::NotConverged => "not converged",
    }
}

fn numbers(state: &State<f32>) -> [f32; 10] {
    [
        state.pressure_pa,
        state.axial_stretch,
        state.axial_strain,
        state.inner_radius_m,
        state.outer_radius_m,
        state.twist_rad,
        state.bend_angle_rad,
        state.volume_m3,
        state.volume_strain,
        state.compliance_m3_per_pa,
    ]
}
