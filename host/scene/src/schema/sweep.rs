//! Studies: files of their own that say which scenes run with which values.

use super::section;

section! {
    /// Its rows are all combinations of scenes, values, drawn points and limbs; the limbs vary fastest, then the points, then the last parameter.
    study, "";
    FORMAT: Integer { name: "format", min: 1, max: 1, presence: Required } = "Version of this format.";
    SCENES: Nested { name: "scenes", shape: "array of texts", presence: Required } = "Scene files, in the folder of the study or by paths from there.";
    LIMBS: Integer { name: "limbs", min: 1, max: 1_000_000, presence: Default(1) } = "Simulated limbs of each design: the seeds of the plant are 1 to this number.";
    POINTS: Integer { name: "points", min: 1, max: 65_536, presence: Default(1) } = "Points that are drawn in the `range`s of the parameters.";
    SEED: Integer { name: "seed", min: 0, max: 4_294_967_295, presence: Default(1) } = "Seed of the drawn points.";
    PARAMETER: Nested { name: "parameter", shape: "array of tables", presence: Optional("the scenes as they are") } = "See `[[parameter]]`.";
}

section! {
    /// A value of the scenes that varies. It has `values`, each of which is combined with all others, or a `range` to draw from. Drawn points are
    /// those of a scrambled Sobol sequence over all ranges.
    parameter, "[[parameter]]";
    KEY: Text { name: "key", is_name: false, presence: Required } = "Place in the scene: names of tables and key with points between them. A table of an array goes by its `name`: `module.elbow.length`.";
    VALUES: Nested { name: "values", shape: "array of values as a scene has them", presence: Optional("required without `range`") } = "Values, quantities in one unit.";
    RANGE: Nested { name: "range", shape: "two values in one unit", presence: Optional("required without `values`") } = "Lower and upper value.";
}
