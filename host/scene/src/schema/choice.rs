//! Bounds of a design.

use super::section;

section! {
    /// Bounds of `softlimb design`. A pair is a lower and an upper value; equal ones fix the quantity, and a quantity without a pair keeps the
    /// module's own value.
    design, "[design]";
    INNER_RADIUS: Pair { name: "inner_radius", unit: Unit::MM, min: 0.2, max: 200.0, presence: Optional("the module's own") } = "Inner radius at rest.";
    WALL: Pair { name: "wall", unit: Unit::MM, min: 0.1, max: 100.0, presence: Optional("the module's own") } = "Thickness of the wall at rest.";
    LENGTH: Pair { name: "length", unit: Unit::MM, min: 5.0, max: 5000.0, presence: Optional("the module's own") } = "Length at rest, with both ends.";
    FIBER_ANGLE: Pair { name: "fiber_angle", unit: Unit::DEG, min: -90.0, max: 90.0, presence: Optional("that of the module's winding") } = "Fiber angle from the hoop direction. A bending module has none.";
    CIRCLE_RADIUS: Pair { name: "circle_radius", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("the module's own") } = "Distance from the connector's center to each actuator's axis, of modules whose actuators stand on a circle. Not of a weightless limb.";
    SPACING: Pair { name: "spacing", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("the module's own") } = "Distance between neighbouring axes, of modules whose actuators stand in a row. Not of a weightless limb.";
    BAY: Quantity { name: "bay", unit: Unit::MM, min: 5.0, max: 1000.0, presence: Default(35.0) } = "Largest distance of the plates of a module; it gets as few `spacers` as keep it. Not of a weightless limb.";
    BASE_PITCH: Pair { name: "base_pitch", unit: Unit::DEG, min: -90.0, max: 90.0, presence: Optional("the direction of `[limb]`") } = "Angle by which the first module's axis may be turned from `base_direction` towards `base_up`. Not of a weightless limb.";
    BASE_REGION: Text { name: "base_region", is_name: true, presence: Optional("the position of `[limb]`") } = "A name from `[[region]]`, of a box without `rotation`: the limb may start anywhere in it. Not of a weightless limb.";
    LIMIT_MARGIN: Quantity { name: "limit_margin", unit: Unit::NUMBER, min: 0.001, max: 0.9, presence: Default(0.05) } = "Share of the pressure at the limit point that is kept free.";
    PRESSURE_RESERVE: Quantity { name: "pressure_reserve", unit: Unit::PERCENT, min: 0.0, max: 50.0, presence: Default(0.0) } = "Share of the highest pressure that a device follows which is kept free, for a limb that turns out stiffer than its model.";
    MASS_MAX: Quantity { name: "mass_max", unit: Unit::KG, min: 0.01, max: 1000.0, presence: Optional("any mass") } = "Largest mass of the limb with its connectors and its end effector, without what it carries. Not of a weightless limb.";
    SHARED_SUPPLY_LINE: Flag { name: "shared_supply_line", presence: Default(false) } = "Whether all modules have the same pressure.";
    MOUNT_ANGLE: Choice { name: "mount_angle", words: &["fixed", "free"], presence: Default("fixed") } = "Whether modules keep their `mount_angle` or may be turned.";
    MODULES: Pair { name: "modules", unit: Unit::NUMBER, min: 1.0, max: 9.0, presence: Optional("as many as there are") } = "Least and greatest number of modules where their kinds and order are chosen, too.";
    MOTIONS: Nested { name: "motions", shape: "array of `extension`, `expansion`, `bending`, `twisting`", presence: Optional("all four, where `modules` is given") } = "The kinds to choose from.";
}

section! {
    /// Bounds of one segment of a module for `softlimb design limb`; a quantity without a pair keeps the segment's own value.
    segment_bounds, "module.segments.bounds";
    LENGTH: Pair { name: "length", unit: Unit::MM, min: 5.0, max: 5000.0, presence: Optional("the segment's own") } = "Length at rest, of the first and of the last segment with their end.";
    FIBER_ANGLE: Pair { name: "fiber_angle", unit: Unit::DEG, min: -90.0, max: 90.0, presence: Optional("that of the segment's winding") } = "Fiber angle from the hoop direction. A bending segment has none.";
}

section! {
    /// Bounds of one module; as in `[design]`. One with `segments` has those of its radii here: lengths and fiber angles are in
    /// `[module.segments.bounds]`, and those of `[design]` are not for it.
    bounds, "module.bounds";
    INNER_RADIUS: Pair { name: "inner_radius", unit: Unit::MM, min: 0.2, max: 200.0, presence: Optional("that of `[design]`") } = "Inner radius at rest.";
    WALL: Pair { name: "wall", unit: Unit::MM, min: 0.1, max: 100.0, presence: Optional("that of `[design]`") } = "Thickness of the wall at rest.";
    LENGTH: Pair { name: "length", unit: Unit::MM, min: 5.0, max: 5000.0, presence: Optional("that of `[design]`") } = "Length at rest, with both ends.";
    FIBER_ANGLE: Pair { name: "fiber_angle", unit: Unit::DEG, min: -90.0, max: 90.0, presence: Optional("that of `[design]`") } = "Fiber angle from the hoop direction.";
    CIRCLE_RADIUS: Pair { name: "circle_radius", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("that of `[design]`") } = "Distance from the connector's center to each actuator's axis, of modules whose actuators stand on a circle. Not of a weightless limb.";
    SPACING: Pair { name: "spacing", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("that of `[design]`") } = "Distance between neighbouring axes, of modules whose actuators stand in a row. Not of a weightless limb.";
}
