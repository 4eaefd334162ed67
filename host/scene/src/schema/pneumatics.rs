//! The pneumatics: nominal values, which the controller is told, and the spread of the simulated truth about them.

use super::section;

section! {
    /// The pneumatics. Every key may be left out; the defaults describe small coil valves, a diaphragm pump with a reservoir, and ratiometric gauge sensors.
    plant, "[plant]";
    AMBIENT: Nested { name: "ambient", shape: "table", presence: Optional("the defaults below") } = "The air around.";
    SUPPLY: Nested { name: "supply", shape: "table", presence: Optional("the defaults below") } = "Where compressed air comes from.";
    VALVE: Nested { name: "valve", shape: "table", presence: Optional("the defaults below") } = "The fill and the vent valve of a channel.";
    LINE: Nested { name: "line", shape: "table", presence: Optional("the defaults below") } = "The tube from the valves to an actuator.";
    CHAMBER: Nested { name: "chamber", shape: "table", presence: Optional("the defaults below") } = "Properties of a chamber beyond its geometry.";
    SENSOR: Nested { name: "sensor", shape: "table", presence: Optional("the defaults below") } = "Pressure sensors, ratiometric: 10 % of the output at 0, 90 % at full scale.";
    SPREAD: Nested { name: "spread", shape: "table", presence: Optional("the defaults below") } = "How the simulated truth differs from the nominal values.";
    TRUTH: Nested { name: "truth", shape: "table", presence: Optional("the defaults below") } = "Which limb is simulated.";
}

section! {
    /// The air around.
    ambient, "plant.ambient";
    PRESSURE: Quantity { name: "pressure", unit: Unit::KPA, min: 50.0, max: 120.0, presence: Default(101.325) } = "Absolute pressure.";
    TEMPERATURE: Quantity { name: "temperature", unit: Unit::K, min: 250.0, max: 330.0, presence: Default(293.15) } = "Temperature; `\"20 degC\"` is understood.";
}

section! {
    /// The supply. A regulated one has only `pressure`.
    supply, "plant.supply";
    KIND: Choice { name: "kind", words: &["pump", "regulated"], presence: Default("pump") } = "A pump that fills a reservoir, or a source of constant pressure.";
    PRESSURE: Quantity { name: "pressure", unit: Unit::KPA, min: 10.0, max: 1000.0, presence: Default(200.0) } = "Gauge pressure of the source; with a pump: to which the reservoir is charged when the run starts. The controller stops the pump by itself, 10 % of `supply_max - supply_min` below `supply_max`; a relief valve opens at 1.1 times this pressure.";
    FLOW: Quantity { name: "flow", unit: Unit::NL_PER_MIN, min: 0.1, max: 500.0, presence: Default(6.0) } = "Flow of the pump without back pressure, as volume at the reference atmosphere (1.185 kg/m3).";
    STALL_PRESSURE: Quantity { name: "stall_pressure", unit: Unit::KPA, min: 10.0, max: 1000.0, presence: Default(250.0) } = "Gauge pressure at which the pump delivers nothing; the flow falls linearly to it.";
    RESERVOIR_VOLUME: Quantity { name: "reservoir_volume", unit: Unit::L, min: 0.05, max: 100.0, presence: Default(1.0) } = "Volume of the reservoir. All fill valves open together, or the pump at full flow, must not change its pressure by half in a millisecond; `check` names the smallest that is allowed.";
}

section! {
    /// A valve, by ISO 6358.
    valve, "plant.valve";
    CONDUCTANCE: Quantity { name: "conductance", unit: Unit::DM3_PER_S_BAR, min: 0.001, max: 10.0, presence: Default(0.144) } = "Sonic conductance C.";
    CRITICAL_RATIO: Quantity { name: "critical_ratio", unit: Unit::NUMBER, min: 0.05, max: 0.6, presence: Default(0.3) } = "Critical pressure ratio b.";
    ON_DELAY: Quantity { name: "on_delay", unit: Unit::MS, min: 0.0, max: 20.0, presence: Default(3.5) } = "From coil on to open.";
    OFF_DELAY: Quantity { name: "off_delay", unit: Unit::MS, min: 0.0, max: 20.0, presence: Default(2.0) } = "From coil off to closed.";
    JITTER: Quantity { name: "jitter", unit: Unit::MS, min: 0.0, max: 2.0, presence: Default(0.25) } = "Standard deviation of each delay from one switching to the next, uniformly distributed.";
    LEAK: Quantity { name: "leak", unit: Unit::M3_PER_S_PA, min: 0.0, max: 1e-9, presence: Default(1e-13) } = "Conductance of the closed valve.";
    VOLTAGE: Quantity { name: "voltage", unit: Unit::V, min: 3.0, max: 36.0, presence: Default(24.0) } = "Nominal voltage of all coils and of the pump, and of their supply.";
}

section! {
    /// The tube from the valves to an actuator.
    line, "plant.line";
    LENGTH: Quantity { name: "length", unit: Unit::M, min: 0.02, max: 10.0, presence: Default(1.0) } = "Length.";
    INNER_DIAMETER: Quantity { name: "inner_diameter", unit: Unit::MM, min: 0.5, max: 20.0, presence: Default(2.5) } = "Inner diameter.";
}

section! {
    /// Properties of a chamber beyond its geometry.
    chamber, "plant.chamber";
    DEAD_VOLUME: Quantity { name: "dead_volume", unit: Unit::ML, min: 0.0, max: 1000.0, presence: Default(1.0) } = "Volume of fittings, without the line.";
    WALL_HEAT: Quantity { name: "wall_heat", unit: Unit::W_PER_K, min: 0.0, max: 10.0, presence: Default(0.5) } = "Heat conductance from the air to the wall.";
    CREEP_SHARE: Quantity { name: "creep_share", unit: Unit::PERCENT, min: 0.0, max: 30.0, presence: Default(6.0) } = "Share of a deformation that follows slowly.";
    CREEP_TIME: Quantity { name: "creep_time", unit: Unit::S, min: 0.05, max: 1000.0, presence: Default(3.0) } = "Time constant of that share.";
}

section! {
    /// Pressure sensors and their converter.
    sensor, "plant.sensor";
    FULL_SCALE: Quantity { name: "full_scale", unit: Unit::PSI, min: 1.0, max: 150.0, presence: Default(30.0) } = "Gauge pressure at 90 % of the output of a channel's sensor. Every `pressure_max` must be below it.";
    SUPPLY_FULL_SCALE: Quantity { name: "supply_full_scale", unit: Unit::PSI, min: 1.0, max: 150.0, presence: Default(100.0) } = "The same of the supply's sensor. `supply_max` must not be above it.";
    BITS: Integer { name: "bits", min: 8, max: 16, presence: Default(12) } = "Resolution of the converter.";
    NOISE: Quantity { name: "noise", unit: Unit::KPA, min: 0.0, max: 10.0, presence: Default(0.05) } = "Standard deviation of one sample.";
    LAG: Quantity { name: "lag", unit: Unit::MS, min: 0.0, max: 100.0, presence: Default(1.0) } = "Time constant.";
}

section! {
    /// Standard deviations of the true values about the nominal ones, drawn once per channel and cut at three standard deviations.
    spread, "plant.spread";
    MODULUS: Quantity { name: "modulus", unit: Unit::PERCENT, min: 0.0, max: 20.0, presence: Default(3.0) } = "Moduli of the elastomer.";
    WALL: Quantity { name: "wall", unit: Unit::PERCENT, min: 0.0, max: 20.0, presence: Default(2.0) } = "Wall thickness.";
    FIBER_ANGLE: Quantity { name: "fiber_angle", unit: Unit::DEG, min: 0.0, max: 5.0, presence: Default(0.5) } = "Fiber angle.";
    DEAD_VOLUME: Quantity { name: "dead_volume", unit: Unit::PERCENT, min: 0.0, max: 30.0, presence: Default(10.0) } = "Dead volume.";
    VALVE_CONDUCTANCE: Quantity { name: "valve_conductance", unit: Unit::PERCENT, min: 0.0, max: 20.0, presence: Default(7.0) } = "Sonic conductance of each valve.";
    VALVE_DELAY: Quantity { name: "valve_delay", unit: Unit::PERCENT, min: 0.0, max: 30.0, presence: Default(10.0) } = "Delays of each valve.";
    SENSOR_OFFSET: Quantity { name: "sensor_offset", unit: Unit::PERCENT, min: 0.0, max: 5.0, presence: Default(0.25) } = "Offset of a sensor, of full scale.";
    SENSOR_GAIN: Quantity { name: "sensor_gain", unit: Unit::PERCENT, min: 0.0, max: 5.0, presence: Default(0.25) } = "Gain of a sensor.";
}

section! {
    /// The simulated limb. The other keys are for `limb = "body"`; `docs/explanation/body.md` has its parameters.
    truth, "plant.truth";
    LIMB: Choice { name: "limb", words: &["simple", "body"], presence: Default("simple") } = "`simple` is the planner's kinematics and statics with perturbed parameters. `body` is tubes with memory between plates, with finite elements of their sections.";
    HYSTERESIS: Flag { name: "hysteresis", presence: Default(true) } = "Loops of pressure and deformation that do not depend on the rate.";
    CREEP: Flag { name: "creep", presence: Default(true) } = "Creep over minutes, and damping.";
    SOFTENING: Flag { name: "softening", presence: Default(true) } = "Walls that soften in their first cycles.";
    ASSEMBLY: Flag { name: "assembly", presence: Default(true) } = "Tolerances of tubes on their plates, of connectors and of the base.";
    CONTACT: Flag { name: "contact", presence: Default(true) } = "Obstacles stop the limb and what it carries, with friction. With `false` it passes through them.";
    SWING: Flag { name: "swing", presence: Default(false) } = "Inertia of the limb and what it carries: it swings after a move. The tubes then damp also without `creep`.";
}
