//! Parts of the limb.

use super::section;

/// Density of platinum-cure silicone, kg/m3.
pub(crate) const DENSITY_KG_PER_M3: f64 = 1080.0;

section! {
    /// Name of the scene, and its tables.
    scene, "";
    FORMAT: Integer { name: "format", min: 1, max: 1, presence: Required } = "Version of this schema.";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name of the scene; results go to a folder of this name.";
    DESCRIPTION: Text { name: "description", is_name: false, presence: Default("") } = "Purpose of the scene, in a sentence.";
    SEED: Integer { name: "seed", min: 0, max: i64::MAX, presence: Default(0) } = "Seed of everything random in the simulated plant. The same scene and seed give the same run.";
    MATERIALS: Nested { name: "materials", shape: "tables `[materials.NAME]`", presence: Optional("castable elastomers by trade name only") } = "Elastomers.";
    WINDINGS: Nested { name: "windings", shape: "tables `[windings.NAME]`", presence: Optional("no windings") } = "Fiber windings.";
    LIMB: Nested { name: "limb", shape: "table `[limb]`", presence: Required } = "Base of the limb, and its rigid parts.";
    MODULE: Nested { name: "module", shape: "tables `[[module]]`, 1 to 27", presence: Required } = "Modules from the base to the tip.";
    PHASE: Nested { name: "phase", shape: "tables `[[phase]]`, 1 to 200", presence: Optional("required without `[markers]`") } = "Moves of the limb, in order. It starts at rest.";
    MARKERS: Nested { name: "markers", shape: "table `[markers]`", presence: Optional("none") } = "The motion as a series of tip positions, instead of phases.";
    CORRECTIONS: Nested { name: "corrections", shape: "table `[corrections]`", presence: Optional("none") } = "Corrections of the planned setpoints, so that a limb that differs from its model follows the plan.";
    OBSTACLE: Nested { name: "obstacle", shape: "tables `[[obstacle]]`, up to 50", presence: Optional("none") } = "Solids that the limb keeps clear of.";
    REGION: Nested { name: "region", shape: "tables `[[region]]`, up to 50", presence: Optional("none") } = "Boxes that phases name.";
    OBJECT: Nested { name: "object", shape: "tables `[[object]]`, up to 50", presence: Optional("none") } = "Things that the tip carries in phases that name them.";
    DESIGN: Nested { name: "design", shape: "table `[design]`", presence: Optional("nothing is left open") } = "Bounds of what `softlimb design` may choose.";
    LIMITS: Nested { name: "limits", shape: "table `[limits]`", presence: Optional("the defaults below") } = "Bounds that hold for all modules.";
    CONTROLLER: Nested { name: "controller", shape: "table `[controller]`", presence: Optional("the defaults below") } = "Settings of the pressure controller.";
    WEIGHT: Nested { name: "weight", shape: "table `[weight]`", presence: Optional("the defaults below") } = "Effect of the limb's weight and its payloads on a run.";
    SWING: Nested { name: "swing", shape: "table `[swing]`", presence: Optional("the defaults below") } = "Swing of the limb after a move.";
    CAMERA: Nested { name: "camera", shape: "table `[camera]`", presence: Optional("no camera in a run, and one without calibration error in `learn`") } = "A camera that observes the tip.";
    IMU: Nested { name: "imu", shape: "table `[imu]`", presence: Optional("no IMUs") } = "IMUs on the end plates of the modules.";
    PLANT: Nested { name: "plant", shape: "table `[plant]`", presence: Optional("the defaults below") } = "Nominal pneumatics, which the controller gets, and the deviation of the simulated truth from them.";
}

section! {
    /// An elastomer. A neo-Hookean one has `shear_modulus`, a Yeoh one has `c`.
    material, "[materials.NAME]";
    LAW: Choice { name: "law", words: &["neo-hookean", "yeoh"], presence: Required } = "Strain-energy function: mu/2 (I1-3), or C1 (I1-3) + C2 (I1-3)^2 + C3 (I1-3)^3.";
    SHEAR_MODULUS: Quantity { name: "shear_modulus", unit: Unit::MPA, min: 0.001, max: 100.0, presence: Optional("required for `neo-hookean`") } = "Shear modulus mu.";
    C: Nested { name: "c", shape: "three pressures", presence: Optional("required for `yeoh`") } = "Coefficients C1, C2, C3; C1 from 0.0005 to 50 MPa, the others from -50 to 50 MPa.";
    STRETCH_MAX: Quantity { name: "stretch_max", unit: Unit::NUMBER, min: 1.0, max: 20.0, presence: Optional("not known") } = "Largest stretch of the test behind the law; `check` warns of walls that stretch further.";
    DENSITY: Quantity { name: "density", unit: Unit::KG_PER_M3, min: 100.0, max: 10_000.0, presence: Default(super::DENSITY_KG_PER_M3) } = "Density; the default is that of platinum-cure silicone.";
}

section! {
    /// A fiber winding.
    winding, "[windings.NAME]";
    ANGLE: Quantity { name: "angle", unit: Unit::DEG, min: -90.0, max: 90.0, presence: Required } = "Fiber angle from the hoop direction; the sign mirrors the twist.";
    FAMILIES: Integer { name: "families", min: 1, max: 2, presence: Required } = "One helix, or two mirrored ones that do not twist.";
    THREAD: Nested { name: "thread", shape: "table", presence: Optional("no thread; `modulus` and `thickness` state a sheet") } = "Thread that `fabricate` winds. `modulus` and `thickness` follow from it, with the loss by the distance of its turns, unless both are stated. Only for `sheet`.";
    MODULUS: Quantity { name: "modulus", unit: Unit::MPA, min: 0.0, max: 1e6, presence: Optional("required without `thread`") } = "Fiber modulus mu2 of each family; the stiffness along the fiber is 4 mu2.";
    PLACEMENT: Choice { name: "placement", words: &["sheet", "layer", "smeared"], presence: Default("sheet") } = "Thin sheet at `radius`; layer from `radius` to the outer surface; or the whole wall.";
    THICKNESS: Quantity { name: "thickness", unit: Unit::MM, min: 0.001, max: 20.0, presence: Optional("required for `sheet` without `thread`") } = "Thickness of the sheet.";
    RADIUS: Quantity { name: "radius", unit: Unit::MM, min: 0.2, max: 200.0, presence: Optional("the outer radius of the actuator; required for `layer`") } = "Winding radius, within the wall. `smeared` has none.";
}

section! {
    /// The thread of a winding.
    thread, "windings.NAME.thread";
    STIFFNESS: Quantity { name: "stiffness", unit: Unit::N, min: 0.001, max: 1e6, presence: Required } = "Force per strain `E A` of one thread.";
    DIAMETER: Quantity { name: "diameter", unit: Unit::MM, min: 0.01, max: 5.0, presence: Required } = "Diameter.";
    STARTS: Integer { name: "starts", min: 1, max: 1000, presence: Default(1) } = "Threads side by side in each family. With the angle they make the distance of the turns, which must exceed the diameter.";
}

section! {
    /// Base of the limb, in a frame whose third axis points up.
    limb, "[limb]";
    BASE_POSITION: Vector { name: "base_position", unit: Unit::M, max: 100.0, presence: Default([0.0, 0.0, 0.0]) } = "Start of the first module.";
    BASE_DIRECTION: Vector { name: "base_direction", unit: Unit::NUMBER, max: 1e6, presence: Default([1.0, 0.0, 0.0]) } = "Direction of the first module's axis; any length but zero.";
    BASE_UP: Vector { name: "base_up", unit: Unit::NUMBER, max: 1e6, presence: Default([0.0, 0.0, 1.0]) } = "Direction towards which a bending module with `mount_angle` 0 bends. Only the part normal to `base_direction` counts.";
    CONNECTOR: Nested { name: "connector", shape: "table", presence: Required } = "The plate at the far end of every module.";
    END_EFFECTOR: Nested { name: "end_effector", shape: "table", presence: Optional("no end effector") } = "Tool on the last connector.";
}

section! {
    /// The rigid plate at the far end of every module.
    connector, "limb.connector";
    LENGTH: Quantity { name: "length", unit: Unit::MM, min: 0.0, max: 500.0, presence: Required } = "Length along the limb.";
    MASS: Quantity { name: "mass", unit: Unit::KG, min: 0.0, max: 20.0, presence: Required } = "Mass of one connector.";
}

section! {
    /// The tool on the last connector.
    end_effector, "limb.end_effector";
    NAME: Text { name: "name", is_name: true, presence: Default("tool") } = "Name.";
    LENGTH: Quantity { name: "length", unit: Unit::MM, min: 0.0, max: 1000.0, presence: Required } = "Distance from the last connector to the tip.";
    RADIUS: Quantity { name: "radius", unit: Unit::MM, min: 0.0, max: 1000.0, presence: Default(20.0) } = "Radius of the tool about its axis, for the clearance; it ends in a ball about the tip.";
    MASS: Quantity { name: "mass", unit: Unit::KG, min: 0.0, max: 20.0, presence: Required } = "Mass.";
    GRIPPER_TIME: Quantity { name: "gripper_time", unit: Unit::S, min: 0.0, max: 10.0, presence: Default(0.3) } = "Time that its gripper takes to close, and to open.";
}

section! {
    /// A bundle of equal actuators in parallel. All modules together have at most 27 actuators.
    module, "[[module]]";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name; targets use it.";
    MOTION: Choice { name: "motion", words: &["extension", "expansion", "bending", "twisting"], presence: Required } = "The motion the actuators are wound for.";
    ACTUATORS: Integer { name: "actuators", min: 1, max: 9, presence: Default(3) } = "Actuators in parallel. Each has its own channel.";
    ARRANGEMENT: Choice { name: "arrangement", words: &["circle", "row"], presence: Default("circle") } = "Places of the actuators: evenly on a circle, the first towards `mount_angle`; or in a row along the axis of bending, at right angles to `mount_angle`. Several bending actuators need a row, because on a circle their strips hold each other. Twisting actuators need a circle.";
    CIRCLE_RADIUS: Quantity { name: "circle_radius", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("circle only: 0 for one actuator, else required") } = "Distance from the connector's center to each actuator's axis. The actuators must not overlap.";
    SPACING: Quantity { name: "spacing", unit: Unit::MM, min: 0.0, max: 500.0, presence: Optional("row only: 0 for one actuator, else required") } = "Distance between the axes of neighbouring actuators of a row, at least their outer diameter.";
    STEERING: Flag { name: "steering", presence: Default(false) } = "Whether each actuator has its own setpoint: unequal setpoints bend the module in two directions. For three or more `extension` actuators on a circle.";
    MOUNT_ANGLE: Quantity { name: "mount_angle", unit: Unit::DEG, min: -360.0, max: 360.0, presence: Default(0.0) } = "Rotation of the module about the limb's axis.";
    SPACERS: Integer { name: "spacers", min: 0, max: 50, presence: Default(0) } = "Rigid plates that hold the actuators together, evenly between the connectors. They keep the tubes from buckling.";
    SPACER_MASS: Quantity { name: "spacer_mass", unit: Unit::KG, min: 0.0, max: 5.0, presence: Default(0.0) } = "Mass of one of its spacers; counted as spread along the module.";
    INNER_RADIUS: Quantity { name: "inner_radius", unit: Unit::MM, min: 0.2, max: 200.0, presence: Required } = "Inner radius at rest.";
    OUTER_RADIUS: Quantity { name: "outer_radius", unit: Unit::MM, min: 0.2, max: 200.0, presence: Required } = "Outer radius at rest, above `inner_radius`.";
    LENGTH: Quantity { name: "length", unit: Unit::MM, min: 5.0, max: 5000.0, presence: Optional("required without `segments`") } = "Length at rest.";
    END_LENGTH: Quantity { name: "end_length", unit: Unit::MM, min: 0.0, max: 500.0, presence: Default(0.0) } = "Length at each end that the cap takes out of the motion, less than half of `length`; `softlimb fea calibrate` prints it. The rest moves.";
    MATERIAL: Text { name: "material", is_name: false, presence: Required } = "A name from `[materials]`, or the trade name of an elastomer that `softlimb materials` lists.";
    WINDING: Text { name: "winding", is_name: true, presence: Optional("hoop winding at the outer radius for `bending`; none with `segments`; else required") } = "A name from `[windings]`, or an array of two names: the actuators are then wound twice, as with a helix and an axial thread. `twisting` needs a winding of one family. A bending actuator with two windings is solved by finite elements and twists, too, where a helix of one family is among them.";
    SEGMENTS: Nested { name: "segments", shape: "tables `[[module.segments]]`, 2 to 8", presence: Optional("one segment") } = "Segments of different winding along its one actuator, from the base to the tip, in place of `length` and `winding`. They share one chamber. `motion` is that of a segment; the setpoint is the total over all: bend angle, twist, or stretch of the whole length. Not for `expansion`, nor with `spacers`, nor for a limb whose `truth` is a body.";
    PRESSURE_MAX: Quantity { name: "pressure_max", unit: Unit::KPA, min: 1.0, max: 600.0, presence: Optional("`pressure_max` of `[limits]`") } = "Largest gauge pressure in its chambers.";
    BOUNDS: Nested { name: "bounds", shape: "table `[module.bounds]`", presence: Optional("those of `[design]`") } = "Bounds of this module, where they differ from `[design]`.";
}

section! {
    /// A segment of an actuator that is wound differently along its length. Radii, material and pressure are those of the module.
    segment, "[[module.segments]]";
    MOTION: Choice { name: "motion", words: &["extension", "expansion", "bending", "twisting"], presence: Required } = "The motion the segment is wound for.";
    LENGTH: Quantity { name: "length", unit: Unit::MM, min: 5.0, max: 5000.0, presence: Required } = "Length at rest.";
    WINDING: Text { name: "winding", is_name: true, presence: Optional("hoop winding at the outer radius for `bending`, else required") } = "As `winding` of `[[module]]`.";
    BEND_DIRECTION: Quantity { name: "bend_direction", unit: Unit::DEG, min: -360.0, max: 360.0, presence: Default(0.0) } = "Direction a bending segment bends towards, from that of the module, on the actuator at rest; the twist of the segments before it turns it.";
    BOUNDS: Nested { name: "bounds", shape: "table `[module.segments.bounds]`", presence: Optional("its own values") } = "Bounds of this segment.";
}
