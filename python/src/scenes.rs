//! Scenes: a limb, its phases, its pneumatics.

use std::path::PathBuf;

use fra_model::StateQuantity;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use softlimb::limb::Limb;
use softlimb::limb::workspace::{Command, Points};
use softlimb::motion;
use softlimb::results::{
    CheckResult, LoadedWorkspaceResult, ResultError, StaticsOptions, StaticsResult, WorkspaceOptions, WorkspaceResult,
    json, with_bends,
};
use softlimb::rig::run::description;
use softlimb_scene as scene;

use super::answers::processors;
use super::failed::{not_computed, scene_error};
use super::runs;
use super::session::{Frames, flat};

/// Numbers in the flat order of an array.
type Flat<'py> = Bound<'py, PyArray1<f64>>;
/// Time of each knot; setpoint and pressure of each drive; tip.
type Knots<'py> = (Flat<'py>, Flat<'py>, Flat<'py>, Flat<'py>);

/// A checked scene and its limb.
#[pyclass(frozen, module = "softlimb._native")]
pub(crate) struct Scene {
    pub(crate) scene: scene::Scene,
    pub(crate) limb: Limb,
}

#[pymethods]
impl Scene {
    /// Reads a file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| scene::load(path).and_then(Self::new)).map_err(|error| scene_error(py, &error))
    }

    /// Reads a text; `name` stands for the file in diagnostics.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        py.detach(|| scene::parse(text, name).and_then(Self::new)).map_err(|error| scene_error(py, &error))
    }

    /// Its name.
    fn name(&self) -> &str {
        self.scene.name()
    }

    /// Names of the setpoints, and the quantity of each.
    fn drives(&self) -> Vec<(String, &'static str)> {
        self.limb.drives().map(|drive| (drive.name(), quantity(drive.kind))).collect()
    }

    /// Setpoints at rest and at the highest pressure, of each drive.
    fn ranges(&self) -> Vec<(f64, f64)> {
        self.limb.drives().map(|drive| drive.range()).collect()
    }

    /// The limb as viewers load it: URDF, and the frames that do not move.
    fn description(&self) -> (String, Frames) {
        let (urdf, frames) = description(&self.scene, &self.limb);
        (urdf, frames.into_iter().map(|(name, pose)| (name, flat(pose))).collect())
    }

    /// The result of `softlimb check --json`.
    fn check(&self, py: Python<'_>) -> PyResult<String> {
        let checked = py.detach(|| CheckResult::new(&self.scene, &self.limb).map(|result| json(&result.printed())));
        checked.map_err(|error| scene_error(py, &error))
    }

    /// Setpoints, pressures and tip at every knot of the plan, and its warnings.
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<(Knots<'py>, Vec<String>)> {
        let planned = py.detach(|| {
            let plan = motion::plan(&self.scene, &self.limb)?;
            let times: Vec<f64> =
                (0..plan.knots().len()).map(|knot| (knot as u64 * plan.knot_period_us()) as f64).collect();
            let setpoints = times.iter().flat_map(|&time_us| plan.values_at(time_us)).collect();
            let states = times.iter().flat_map(|&time_us| plan.states_at(time_us));
            let pressures = states.map(|state| state.pressure_pa).collect();
            let tips = times.iter().flat_map(|&time_us| plan.tip_m(&self.limb, time_us)).collect();
            Ok(([times.iter().map(|us| us * 1e-6).collect(), setpoints, pressures, tips], plan.warnings))
        });
        let (knots, warnings): ([Vec<f64>; 4], _) = planned.map_err(|error| scene_error(py, &error))?;
        let [times, setpoints, pressures, tips] = knots.map(|column| column.into_pyarray(py));
        Ok(((times, setpoints, pressures, tips), warnings))
    }

    /// The result of `softlimb statics --json`, and its warnings.
    fn statics(
        &self,
        py: Python<'_>,
        payload_kg: Option<f64>,
        spacers: Option<u8>,
        tolerance: f64,
    ) -> PyResult<(String, Vec<String>)> {
        let options = StaticsOptions { payload_kg, spacers, tolerance };
        let found = py.detach(|| {
            let result = StaticsResult::new(&self.scene, &self.limb, &options)?;
            let text = json(&result.printed());
            Ok((text, result.warnings))
        });
        found.map_err(|error| result_error(py, error))
    }

    /// The result of `softlimb workspace --json`, and the sampled tips; under weight with a payload.
    #[allow(clippy::too_many_arguments, reason = "one caller, in Python, which names them")]
    fn workspace<'py>(
        &self,
        py: Python<'py>,
        each_actuator: bool,
        samples: usize,
        points: &str,
        seed: u64,
        cell_m: f64,
        loaded: Option<(f64, Option<u8>)>,
    ) -> PyResult<(String, Flat<'py>)> {
        let command = if each_actuator { Command::Actuators } else { Command::Modules };
        let points = match points {
            "even" => Points::Even,
            "random" => Points::Random,
            _ => Points::Faces,
        };
        let options = WorkspaceOptions { command, points, samples, seed, threads: processors(), cell_m };
        let found = py.detach(|| match loaded {
            None => {
                let result = WorkspaceResult::new(&self.scene, &self.limb, &options)?;
                let tips = result.tips_m.iter().flatten().map(|&x| f64::from(x)).collect();
                Ok((json(&with_bends(&self.limb, &result.printed())), tips))
            }
            Some((payload_kg, spacers)) => {
                let result = LoadedWorkspaceResult::new(&self.scene, &self.limb, &options, payload_kg, spacers)?;
                Ok((
                    json(&with_bends(&self.limb, &result.printed())),
                    result.tips_m.iter().flatten().copied().collect(),
                ))
            }
        });
        let (text, tips): (String, Vec<f64>) = found.map_err(|error| result_error(py, error))?;
        Ok((text, tips.into_pyarray(py)))
    }

    /// Runs on the simulated device: the result of `softlimb run --json`, the log, the report.
    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        seed: Option<u64>,
        plant: Option<&Self>,
        link_fault: Option<&str>,
        faults: Vec<String>,
    ) -> PyResult<(String, PathBuf, PathBuf)> {
        runs::run(py, self, plant.unwrap_or(self), &runs::Simulation { out, seed, link_fault, faults: &faults })
    }
}

impl Scene {
    fn new(scene: scene::Scene) -> Result<Self, scene::SceneError> {
        let limb = Limb::new(&scene)?;
        Ok(Self { scene, limb })
    }
}

fn result_error(py: Python<'_>, error: ResultError) -> PyErr {
    match error {
        ResultError::Scene(error) => scene_error(py, &error),
        other => not_computed(py, other),
    }
}

/// Name of a quantity as a field.
fn quantity(kind: StateQuantity) -> &'static str {
    match kind {
        StateQuantity::Pressure => "pressure_pa",
        StateQuantity::AxialStretch => "axial_stretch",
        StateQuantity::OuterRadius => "outer_radius_m",
        StateQuantity::InnerRadius => "inner_radius_m",
        StateQuantity::Twist => "twist_rad",
        StateQuantity::BendAngle => "bend_angle_rad",
    }
}
