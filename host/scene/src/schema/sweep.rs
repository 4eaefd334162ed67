//! Schema of study files.

use super::section;

section! {
    /// Rows are all combinations of scenes, values, drawn points and limbs. Limbs vary fastest, then points, then the last parameter.
    study, "";
    FORMAT: Integer { name: "format", min: 1, max: 1, presence: Required } = "Version of this format.";
    SCENES: Nested { name: "scenes", shape: "array of texts", presence: Required } = "Scene files; paths are relative to the folder of the study.";
    LIMBS: Integer { name: "limbs", min: 1, max: 1_000_000, presence: Default(1) } = "Number of simulated limbs of each design. The seeds of the plant are 1 to this number.";
    POINTS: Integer { name: "points", min: 1, max: 65_536, presence: Default(1) } = "Number of points drawn in the `range`s of the parameters.";
    SEED: Integer { name: "seed", min: 0, max: 4_294_967_295, presence: Default(1) } = "Seed of the drawn points.";
    EXPERIMENT: Choice { name: "experiment", words: &["run", "learn"], presence: Default("run") } = "What each limb does: one run, or iterative learning control as `softlimb learn` does it, whose noise has seed 1.";
    ITERATIONS: Integer { name: "iterations", min: 0, max: 200, presence: Default(10) } = "Iterations of learning.";
    TRIALS: Integer { name: "trials", min: 1, max: 200, presence: Default(5) } = "Runs that measure the tip error, before and after learning.";
    CAMERA: Quantity { name: "camera", unit: Unit::MM, min: 0.0, max: 100.0, presence: Default(0.2) } = "Standard deviation of a coordinate in one observation of the camera.";
    PARAMETER: Nested { name: "parameter", shape: "array of tables", presence: Optional("the scenes as they are") } = "See `[[parameter]]`.";
}

section! {
    /// A varied parameter. It has either listed `values` or a `range` of drawn values. Listed values are combined with those of all other parameters.
    /// Drawn points follow a scrambled Sobol sequence over all ranges.
    parameter, "[[parameter]]";
    KEY: Text { name: "key", is_name: false, presence: Required } = "Place in the scene: names of tables, then the key, separated by points. Tables of an array are named by their key `name`: `module.elbow.length`.";
    VALUES: Nested { name: "values", shape: "array of values as a scene has them", presence: Optional("required without `range`") } = "Values, all in the same unit.";
    RANGE: Nested { name: "range", shape: "two values in one unit", presence: Optional("required without `values`") } = "Lower and upper value.";
}
