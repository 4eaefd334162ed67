//! Motion of the limb and its control.

use super::section;

section! {
    /// One part of the motion: a move, then a pause. It has one of `targets`, `tip` and `inside`.
    phase, "[[phase]]";
    NAME: Text { name: "name", is_name: true, presence: Required } = "Name.";
    DURATION: Quantity { name: "duration", unit: Unit::S, min: 0.02, max: 600.0, presence: Optional("the shortest that limits, valves and supply allow, with a reserve") } = "Time of the move.";
    PAYLOAD: Quantity { name: "payload", unit: Unit::KG, min: 0.0, max: 100.0, presence: Default(0.0) } = "Mass that the tip carries in this phase, beside the end effector; refused where the limb is weightless (`simulated = false` in `[weight]`). Where the gripper closes at the end of the move, the mass is taken up then; where it opens, it is put down then. A mass in an open gripper, or another one in a closed gripper, is refused; in a scene without `gripper` it is fixed to the tip.";
    OBJECT: Text { name: "object", is_name: true, presence: Optional("none") } = "A name from `[[object]]`, instead of `payload`: the tip carries its mass, and a design keeps it clear of obstacles.";
    HOLD: Quantity { name: "hold", unit: Unit::S, min: 0.0, max: 600.0, presence: Default(0.0) } = "Time at rest after the move.";
    TARGETS: Nested { name: "targets", shape: "table `{ MODULE = { QUANTITY = VALUE }, ... }`", presence: Optional("none, if the phase has another goal") } = "Deformation or pressure of modules at the end of the move; a module that is left out keeps its own.";
    TIP: Vector { name: "tip", unit: Unit::M, max: 100.0, presence: Optional("none, if the phase has another goal") } = "Way-point of the tip at the end of the move; the deformations follow by inverse kinematics.";
    INSIDE: Text { name: "inside", is_name: true, presence: Optional("none, if the phase has another goal") } = "A name from `[[region]]`: the tip is in this box at the end of the move, as near as possible to its former place.";
    DIRECTION: Vector { name: "direction", unit: Unit::NUMBER, max: 1e6, presence: Optional("any direction") } = "`tip`, `inside`: direction of the end effector's axis at the end of the move; any length but zero.";
    DIRECTION_TOLERANCE: Quantity { name: "direction_tolerance", unit: Unit::DEG, min: 0.01, max: 180.0, presence: Default(1.0) } = "Largest angle between the end effector's axis and `direction`.";
    GRIPPER: Choice { name: "gripper", words: &["open", "close"], presence: Optional("no command") } = "Command to the gripper. The device closes it at the end of the move, or opens it `gripper_time` before the end of the `hold`.";
}

section! {
    /// The target of one module: one quantity that fits its motion, the same one in every phase.
    target, "phase.targets.MODULE";
    AXIAL_STRETCH: Quantity { name: "axial_stretch", unit: Unit::NUMBER, min: 0.5, max: 3.0, presence: Optional("-") } = "`extension`: length over length at rest.";
    OUTER_RADIUS: Quantity { name: "outer_radius", unit: Unit::MM, min: 0.2, max: 500.0, presence: Optional("-") } = "`expansion`: outer radius.";
    INNER_RADIUS: Quantity { name: "inner_radius", unit: Unit::MM, min: 0.2, max: 500.0, presence: Optional("-") } = "`expansion`: inner radius.";
    TWIST: Quantity { name: "twist", unit: Unit::DEG, min: -720.0, max: 720.0, presence: Optional("-") } = "`twisting`: twist of the far end. A winding with a positive angle twists negatively.";
    BEND_ANGLE: Quantity { name: "bend_angle", unit: Unit::DEG, min: 0.0, max: 360.0, presence: Optional("-") } = "`bending`: angle between the ends.";
    PRESSURE: Quantity { name: "pressure", unit: Unit::KPA, min: 0.0, max: 600.0, presence: Optional("-") } = "Any motion: gauge pressure, at most the module's `pressure_max`.";
}

section! {
    /// Bounds that hold for all modules.
    limits, "[limits]";
    PRESSURE_MAX: Quantity { name: "pressure_max", unit: Unit::KPA, min: 1.0, max: 600.0, presence: Default(100.0) } = "Largest gauge pressure in a chamber.";
    CLEARANCE: Quantity { name: "clearance", unit: Unit::MM, min: 0.0, max: 1000.0, presence: Default(0.0) } = "Least distance of the limb's surface from every `[[obstacle]]` at all times.";
    SUPPLY_MIN: Quantity { name: "supply_min", unit: Unit::KPA, min: 0.0, max: 1000.0, presence: Default(50.0) } = "Below this supply pressure the controller faults. At least 1 kPa below `supply_max`.";
    SUPPLY_MAX: Quantity { name: "supply_max", unit: Unit::KPA, min: 1.0, max: 1000.0, presence: Default(300.0) } = "Above this supply pressure the controller faults. Its sensor must read to it.";
    VALVE_VOLTAGE_MIN: Quantity { name: "valve_voltage_min", unit: Unit::V, min: 1.0, max: 36.0, presence: Optional("not watched") } = "Below this voltage of the valves' supply the controller faults, and takes no zeros. Below the `voltage` of the valves. The board needs the [divider](hardware.md#wiring).";
    STRETCH_RATE_MAX: Quantity { name: "stretch_rate_max", unit: Unit::PERCENT_PER_S, min: 0.1, max: 1e4, presence: Optional("no bound") } = "Largest rate of the axial stretch.";
    RADIUS_RATE_MAX: Quantity { name: "radius_rate_max", unit: Unit::MM_PER_S, min: 0.01, max: 1e4, presence: Optional("no bound") } = "Largest rate of a radius.";
    ANGLE_RATE_MAX: Quantity { name: "angle_rate_max", unit: Unit::DEG_PER_S, min: 0.1, max: 1e4, presence: Optional("no bound") } = "Largest rate of a bend angle or twist.";
    LOAD_FACTOR_MIN: Quantity { name: "load_factor_min", unit: Unit::NUMBER, min: 1.0, max: 4.0, presence: Default(1.5) } = "Least factor on all loads at which the limb under weight loses its stability. `check` warns of less, `design limb` keeps it; so with the next four.";
    TIP_STIFFNESS_MIN: Quantity { name: "tip_stiffness_min", unit: Unit::N_PER_M, min: 0.0, max: 1e5, presence: Default(40.0) } = "Least vertical stiffness of the tip.";
    SAG_MAX: Quantity { name: "sag_max", unit: Unit::PERCENT, min: 1.0, max: 200.0, presence: Default(40.0) } = "Largest sag of the tip, of the length at rest.";
    BUCKLING_MARGIN_MIN: Quantity { name: "buckling_margin_min", unit: Unit::NUMBER, min: 1.0, max: 100.0, presence: Default(3.0) } = "Least buckling load of a tube between two plates over its axial force.";
    PRESSURE_SHARE_MAX: Quantity { name: "pressure_share_max", unit: Unit::PERCENT, min: 10.0, max: 100.0, presence: Default(85.0) } = "Highest pressure of a module, of the lower of its `pressure_max` and its limit point. The planner seeks such pressures first.";
}

section! {
    /// The limb's own weight and the `payload` of each phase. The simulated limb hangs under them, and its setpoints make up for them, unless
    /// `simulated = false`. Gravity points against the scene's third axis.
    weight, "[weight]";
    SIMULATED: Flag { name: "simulated", presence: Default(true) } = "Whether the simulated limb carries its weight and the payloads, on its true actuators and spacers. With `false` it is weightless, every figure of a run says so, and a `payload` is refused.";
    COMPENSATED: Flag { name: "compensated", presence: Optional("the value of `simulated`") } = "Whether setpoints are corrected by the nominal limb's statics, so that the tip under load is where the plan has it without.";
    ERROR: Quantity { name: "error", unit: Unit::PERCENT, min: 0.001, max: 10.0, presence: Default(0.1) } = "Error of the tip that the correction's statics may have, of the limb's length; the cheapest model that keeps it is taken.";
}

section! {
    /// Swing of the limb under weight after its moves. The planner knows it by the limb's natural vibrations at the end of each move; `check` prints
    /// them. Moves along a marker series are not shaped.
    swing, "[swing]";
    LOSS_FACTOR: Quantity { name: "loss_factor", unit: Unit::NUMBER, min: 0.0, max: 0.5, presence: Default(0.05) } = "Loss factor of the elastomer: twice the damping ratio of a vibration whose stiffness is the elastomer's alone. The default is assumed, not measured.";
    SHAPING: Choice { name: "shaping", words: &["none", "zv", "zvd", "adapted"], presence: Default("none") } = "Input shaping of the moves. Against one of the first three natural vibrations, that which leaves the least swing, `zv` (zero vibration) makes a move longer than its `duration` by half a period, `zvd` (zero vibration and derivative) by a whole one and tolerates a wrong frequency. `adapted` takes as long as `zvd`, on a curve in time that leaves the least swing of all vibrations. A move by via points gets as much longer for each of its legs.";
    RESIDUAL_MAX: Quantity { name: "residual_max", unit: Unit::MM, min: 0.01, max: 1000.0, presence: Optional("no bound") } = "Largest swing of the tip after a move, predicted for natural frequencies up to 10 % off.";
    EXCESS: Choice { name: "excess", words: &["refuse", "stretch"], presence: Default("refuse") } = "A move with more swing than `residual_max` is refused, with the duration that would be enough, or gets that duration.";
}

section! {
    /// A camera that observes the tip of the simulated limb, in `run` and in `learn`. It takes images when the device reports, at intervals of at
    /// least 95 % of `period`.
    camera, "[camera]";
    FEEDBACK: Flag { name: "feedback", presence: Default(false) } = "Whether a run corrects its setpoints by the images while it goes on. Runs of `learn` are not corrected in this way. A device behind a port has no camera: such a run is refused.";
    PERIOD: Quantity { name: "period", unit: Unit::MS, min: 1.0, max: 1000.0, presence: Default(20.0) } = "Interval of the images.";
    LATENCY: Quantity { name: "latency", unit: Unit::MS, min: 0.0, max: 1000.0, presence: Default(30.0) } = "Delay from an image to its position, which arrives with the first report of the device after that delay.";
    NOISE: Quantity { name: "noise", unit: Unit::MM, min: 0.0, max: 100.0, presence: Default(0.2) } = "Standard deviation of a coordinate in one image. `--camera` replaces it in `learn`.";
    OFFSET: Quantity { name: "offset", unit: Unit::MM, min: 0.0, max: 100.0, presence: Default(0.2) } = "Standard deviation of the calibration's error in a coordinate: drawn once, by the seed of the limb.";
    DROP_OUTS: Quantity { name: "drop_outs", unit: Unit::PERCENT, min: 0.0, max: 95.0, presence: Default(0.0) } = "Share of the images in which the tip is not found.";
}

section! {
    /// An inertial measurement unit (IMU) on the end plate of each module of the simulated limb, in `run`. All take readings together, when the
    /// device reports, at intervals of at least 95 % of `period`. A reading has an orientation and an angular rate; accelerations are not simulated.
    imu, "[imu]";
    FEEDBACK: Flag { name: "feedback", presence: Default(false) } = "Whether a run corrects its setpoints by the orientations while it goes on. Not with `feedback = true` in `[camera]`. Runs of `learn` are not corrected in this way. A device behind a port has no IMUs: such a run is refused.";
    PERIOD: Quantity { name: "period", unit: Unit::MS, min: 1.0, max: 1000.0, presence: Default(10.0) } = "Interval of the readings.";
    LATENCY: Quantity { name: "latency", unit: Unit::MS, min: 0.0, max: 1000.0, presence: Default(10.0) } = "Delay from a reading to its arrival, with the first report of the device after that delay.";
    TILT_ERROR: Quantity { name: "tilt_error", unit: Unit::DEG, min: 0.0, max: 45.0, presence: Default(1.5) } = "Standard deviation of the constant error of an orientation about each of two horizontal axes: drawn once for each IMU, by the seed of the limb.";
    HEADING_ERROR: Quantity { name: "heading_error", unit: Unit::DEG, min: 0.0, max: 180.0, presence: Default(3.0) } = "Standard deviation of the constant error of an orientation about the vertical.";
    NOISE: Quantity { name: "noise", unit: Unit::DEG, min: 0.0, max: 45.0, presence: Default(0.1) } = "Standard deviation of an orientation about each axis in one reading.";
    RATE_NOISE: Quantity { name: "rate_noise", unit: Unit::DEG_PER_S, min: 0.0, max: 100.0, presence: Default(0.05) } = "Standard deviation of the angular rate about each axis in one reading.";
    DROP_OUTS: Quantity { name: "drop_outs", unit: Unit::PERCENT, min: 0.0, max: 95.0, presence: Default(0.0) } = "Share of the readings of each IMU that are lost.";
}

section! {
    /// Settings of the pressure controller. Times are rounded to whole microseconds.
    controller, "[controller]";
    KNOT_PERIOD: Quantity { name: "knot_period", unit: Unit::MS, min: 10.0, max: 1000.0, presence: Default(20.0) } = "Time between two streamed setpoints; the controller interpolates linearly.";
    CONTROL_PERIOD: Quantity { name: "control_period", unit: Unit::MS, min: 10.0, max: 100.0, presence: Default(20.0) } = "Period of the valve pulses, a whole number of milliseconds.";
    TELEMETRY_PERIOD: Quantity { name: "telemetry_period", unit: Unit::MS, min: 1.0, max: 1000.0, presence: Default(20.0) } = "Time between two telemetry messages, a whole number of milliseconds.";
    LINK_TIMEOUT: Quantity { name: "link_timeout", unit: Unit::MS, min: 100.0, max: 10_000.0, presence: Default(250.0) } = "Silence of the host after which the link counts as lost.";
    HOLD_TIME: Quantity { name: "hold_time", unit: Unit::S, min: 0.0, max: 60.0, presence: Default(2.0) } = "`hold-then-ramp`: how long pressures are held first.";
    LINK_LOSS: Choice { name: "link_loss", words: &["hold-then-ramp", "hold", "vent"], presence: Default("hold-then-ramp") } = "Reaction to a lost link: hold and then ramp down, hold, or vent at once.";
    VENT_RAMP: Quantity { name: "vent_ramp", unit: Unit::KPA_PER_S, min: 0.1, max: 1000.0, presence: Default(20.0) } = "Rate at which pressures ramp down.";
    LOOP: Choice { name: "loop", words: &["pulses", "pi", "on-off"], presence: Default("pulses") } = "Pressure loop of the controller. `pulses`: predicted pulses, which the device adapts to its valves and chambers. The other two are for comparison: `pi` is a PI controller with feed-forward by the model of valve and chamber, `on-off` opens a valve while the reading is more than 1 kPa off. They have no balance of the air: the device then raises neither ExcessAir nor MissingAir.";
    INVERSE: Choice { name: "inverse", words: &["auto", "table", "model"], presence: Default("auto") } = "How the controller finds the pressure for a deformation: `table` looks it up in tables that the host builds and compares with the model, `model` has the device solve the model in each control period, `auto` takes tables where they keep `inverse_error` and the device's model elsewhere. The device solves the model of straight, neo-Hookean tubes alone, bare or wound with a sheet; that other modules have no tables is an error, as with `table` that any module has none.";
    BENDING: Choice { name: "bending", words: &["auto", "analytic", "section-fe"], presence: Default("auto") } = "Model of bending modules. `auto`: finite elements of the section are the model, under load, too, of a module with a stated winding whose analytic bend errs by more than 0.5 % at some pressure; the analytic model is that of all others. `analytic` has the analytic model everywhere. `section-fe` plans by it and builds the inverse tables from a cubic, fitted to the finite elements of the section and verified from a twentieth of `pressure_max` on; more than 1 % of error is refused, and so is a goal beyond the bend that it reaches. Not with `inverse = \"model\"`.";
    INVERSE_ERROR: Quantity { name: "inverse_error", unit: Unit::PERCENT, min: 1e-4, max: 1.0, presence: Default(0.01) } = "Largest error of such a table, as a share of the highest pressure of its module.";
}
