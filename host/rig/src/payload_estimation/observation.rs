//! Tables of observations of the tip.

use nalgebra::Vector3;

use softlimb_files::table::{Known, Table, TableError};
use softlimb_limb::Limb;
use softlimb_motion::Plan;

/// The tip at the end of a phase, without or with the load.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// The line of the table, from 1.
    pub line: usize,
    /// Index of the phase in the plan.
    pub phase: usize,
    /// Whether the load was on the tip.
    pub loaded: bool,
    /// The tip, m, in the scene's frame.
    pub tip_m: Vector3<f64>,
    /// Accuracy of a coordinate, m; only the proportions between observations count.
    pub accuracy_m: f64,
    /// Gauge pressure of each module, Pa; a reading below zero counts as rest.
    pub pressures_pa: Vec<f64>,
}

const fn column(name: &'static str, factor: f64, range: [f64; 2]) -> Known<()> {
    Known { name, kind: (), factor, shift: 0.0, range }
}

const TIP: [Known<()>; 3] =
    [column("x_m", 1.0, [-100.0, 100.0]), column("y_m", 1.0, [-100.0, 100.0]), column("z_m", 1.0, [-100.0, 100.0])];
const ACCURACY: Known<()> = column("accuracy_mm", 1e-3, [1e-3, 100.0]);
/// Accuracy by default, m.
pub(crate) const ACCURACY_M: f64 = 1e-3;
/// Names of the columns of the phase and of the load.
const PHASE: &str = "phase";
const LOAD: &str = "load";
/// Values of the column of the load.
const NONE: &str = "none";
const UNKNOWN: &str = "unknown";
/// Range of a pressure, kPa gauge: a sensor at rest may read a little below zero.
const PRESSURE_KPA: [f64; 2] = [-5.0, 2e3];

impl Observation {
    /// Reads a table: `phase`, `load` (none or unknown), `x_m`, `y_m`, `z_m`, and optionally `accuracy_mm` and the measured pressures of modules,
    /// `<module>_kpa` (of a steering one `<module>.<actuator>_kpa`), in place of those of the plan at the end of the phase. Each phase that is there is there with and without the load.
    ///
    /// # Errors
    /// [`TableError`] with line, column, value and what is accepted.
    pub fn read(text: &str, limb: &Limb, plan: &Plan) -> Result<Vec<Self>, TableError> {
        let table = Table::cut(text)?;
        let pressures: Vec<String> = limb.drives().map(|drive| format!("{}_kpa", drive.name())).collect();
        let others: Vec<&str> = [PHASE, LOAD].into_iter().chain(pressures.iter().map(String::as_str)).collect();
        let known: Vec<Known<()>> = TIP.into_iter().chain([ACCURACY]).collect();
        table.only(&known, &others)?;
        let needed =
            |name: &str| table.place(name).ok_or_else(|| table.header_error(format!("give a column `{name}`")));
        let (phase_at, load_at) = (needed(PHASE)?, needed(LOAD)?);
        let [x, y, z] = &TIP;
        let tip = [(needed(x.name)?, x), (needed(y.name)?, y), (needed(z.name)?, z)];
        let accuracy = table.place(ACCURACY.name);
        let pressures: Vec<(Option<usize>, &String)> = pressures.iter().map(|name| (table.place(name), name)).collect();
        let phases: Vec<&str> = plan.phases.iter().map(|phase| phase.name.as_str()).collect();
        let mut found = Vec::new();
        for row in table.rows() {
            let refused = |place, column: &str, allowed: String| row.refused(place, column, allowed);
            let phase = phases.iter().position(|name| *name == row.text(phase_at));
            let phase = phase.ok_or_else(|| refused(phase_at, PHASE, format!("one of {}", phases.join(", "))))?;
            let loaded = match row.text(load_at) {
                NONE => false,
                UNKNOWN => true,
                _ => return Err(refused(load_at, LOAD, format!("one of {NONE}, {UNKNOWN}"))),
            };
            let coordinate = |(place, column): (usize, &Known<()>)| {
                row.number(place, column)?.ok_or_else(|| refused(place, column.name, "a number".into()))
            };
            let [x, y, z] = tip;
            let tip_m = Vector3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?);
            let accuracy_m = accuracy.map(|place| row.number(place, &ACCURACY)).transpose()?.flatten();
            let planned = &plan.phases[phase];
            let end_us = (planned.start_us + planned.move_us + planned.hold_us) as f64;
            let mut pressures_pa = Vec::with_capacity(pressures.len());
            for (state, (place, name)) in plan.states_at(end_us).iter().zip(&pressures) {
                let measured_kpa = place.map(|place| row.written(place, name, PRESSURE_KPA)).transpose()?.flatten();
                pressures_pa.push(measured_kpa.map_or(state.pressure_pa, |kpa| kpa * 1e3));
            }
            let accuracy_m = accuracy_m.unwrap_or(ACCURACY_M);
            found.push(Self { line: row.line, phase, loaded, tip_m, accuracy_m, pressures_pa });
        }
        let partner = |one: &&Self| !found.iter().any(|other| other.phase == one.phase && other.loaded != one.loaded);
        if let Some(lonely) = found.iter().find(partner)
            && let Some(row) = table.rows().iter().find(|row| row.line == lonely.line)
        {
            let (name, wanted) = (phases[lonely.phase], if lonely.loaded { NONE } else { UNKNOWN });
            let allowed = format!(
                "phase `{name}` needs a row with `{wanted}` too: the load is estimated from the difference of the two"
            );
            return Err(row.refused(load_at, LOAD, allowed));
        }
        Ok(found)
    }
}
