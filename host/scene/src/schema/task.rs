//! Solids around the limb, and a motion given by a measured or drawn path.

use super::section;

section! {
    /// A solid that the limb keeps clear of. A `sphere` has `center` and `radius`; a `capsule`, all points within `radius` of a line, has
    /// `from`, `to` and `radius`; a `box` has `center` and `size` and may have a `rotation`.
    obstacle, "[[obstacle]]";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name.";
    SHAPE: Choice { name: "shape", words: &["sphere", "capsule", "box"], presence: Required } = "Kind of solid.";
    CENTER: Vector { name: "center", unit: Unit::M, max: 100.0, presence: Optional("required for `sphere` and `box`") } = "Centre.";
    RADIUS: Quantity { name: "radius", unit: Unit::MM, min: 0.1, max: 1e5, presence: Optional("required for `sphere` and `capsule`") } = "Radius.";
    FROM: Vector { name: "from", unit: Unit::M, max: 100.0, presence: Optional("required for `capsule`") } = "One end of the line.";
    TO: Vector { name: "to", unit: Unit::M, max: 100.0, presence: Optional("required for `capsule`") } = "The other end.";
    SIZE: Vector { name: "size", unit: Unit::M, max: 100.0, presence: Optional("required for `box`") } = "Lengths of the edges along the box's own axes, each at least 0.1 mm.";
    ROTATION: Vector { name: "rotation", unit: Unit::DEG, max: 360.0, presence: Default([0.0, 0.0, 0.0]) } = "`box`: turns about the scene's first, second and third axis, in this order.";
}

section! {
    /// A box as a goal of the tip.
    region, "[[region]]";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name; phases use it.";
    CENTER: Vector { name: "center", unit: Unit::M, max: 100.0, presence: Required } = "Centre.";
    SIZE: Vector { name: "size", unit: Unit::M, max: 100.0, presence: Required } = "Lengths of the edges along the box's own axes, each at least 0.1 mm.";
    ROTATION: Vector { name: "rotation", unit: Unit::DEG, max: 360.0, presence: Default([0.0, 0.0, 0.0]) } = "Turns about the scene's first, second and third axis, in this order.";
}

section! {
    /// A thing that the tip carries: upright, hanging from where it is grasped, as a bottle by its neck. It is taken for a capsule.
    object, "[[object]]";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name; phases use it.";
    RADIUS: Quantity { name: "radius", unit: Unit::MM, min: 0.1, max: 1e4, presence: Required } = "Radius about its vertical axis.";
    HEIGHT: Quantity { name: "height", unit: Unit::MM, min: 0.1, max: 1e4, presence: Required } = "Height.";
    GRASP: Quantity { name: "grasp", unit: Unit::MM, min: 0.0, max: 1e4, presence: Required } = "Height above its bottom at which the tip holds it, at most `height`.";
    MASS: Quantity { name: "mass", unit: Unit::KG, min: 0.0, max: 100.0, presence: Required } = "Mass.";
    TILT_MAX: Quantity { name: "tilt_max", unit: Unit::DEG, min: 0.1, max: 180.0, presence: Default(35.0) } = "Largest angle of its axis from the vertical, where it was upright as the gripper took it. Goals, ways and pauses that carry it keep this angle, and so does a designed limb. `180 deg` lets it tilt freely.";
}

section! {
    /// Positions of the tip by time. The limb first moves to the first position; the series runs from there.
    markers, "[markers]";
    FILE: Text { name: "file", is_name: false, presence: Required } = "A CSV file in the scene's folder with the columns `time_s,x_m,y_m,z_m` and 2 to 10000 rows; times rise, from any value.";
}

section! {
    /// Corrections of the planned setpoints in a run, as `softlimb learn --csv` writes them for one limb. They are linear between the rows,
    /// also from one phase to the next, and constant from the last row of a phase to its end. A run without a row at its start begins without a correction. A corrected setpoint ends where its module's range ends.
    corrections, "[corrections]";
    FILE: Text { name: "file", is_name: false, presence: Required } = "A CSV file in the scene's folder with the columns `phase`, `move`, `hold_s` and one per module, by the modules' names and in their order, and at most 10000 rows. `phase` is the name of a phase. Each phase of the scene has at least one row; rows of other phases are ignored. `move` is the fraction of the move, 0 to 1. `hold_s` is the time since the end of the move, and 0 during it. The rows of a phase are in order of time. Columns `name.1`, `name.2` and so on instead of `name` correct the actuators of a module one by one. Values are in m, rad or Pa as the module's setpoints are, without unit for a stretch. Columns `name.planned` may follow, with the planned setpoints that were corrected. A phase that ends at others causes a warning.";
}
