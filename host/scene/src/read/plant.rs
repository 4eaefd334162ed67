//! The pneumatics.

use super::settings::optional_table;
use crate::data::{Ambient, BodyEffects, Chamber, Line, Plant, Sensor, Spread, Supply, TrueLimb, Valve};
use crate::error::Problem;
use crate::reader::Reader;
use crate::schema;

pub(super) fn plant(root: &Reader<'_>) -> Option<Plant> {
    let obstacles = root.value(schema::scene::OBSTACLE.name).is_some();
    optional_table(root, &schema::scene::PLANT, &schema::plant::SECTION, |reader| {
        use schema::plant::*;
        let ambient = optional_table(reader, &AMBIENT, &schema::ambient::SECTION, ambient);
        let supply = optional_table(reader, &SUPPLY, &schema::supply::SECTION, supply);
        let valve = optional_table(reader, &VALVE, &schema::valve::SECTION, valve);
        let line = optional_table(reader, &LINE, &schema::line::SECTION, line);
        let chamber = optional_table(reader, &CHAMBER, &schema::chamber::SECTION, chamber);
        let sensor = optional_table(reader, &SENSOR, &schema::sensor::SECTION, sensor);
        let spread = optional_table(reader, &SPREAD, &schema::spread::SECTION, spread);
        let truth = optional_table(reader, &TRUTH, &schema::truth::SECTION, |reader| truth(reader, obstacles));
        Some(Plant {
            ambient: ambient?,
            supply: supply?,
            valve: valve?,
            line: line?,
            chamber: chamber?,
            sensor: sensor?,
            spread: spread?,
            truth: truth?,
        })
    })
}

fn ambient(reader: &Reader<'_>) -> Option<Ambient> {
    use schema::ambient::*;
    let (pressure, temperature) = (reader.quantity(&PRESSURE), reader.quantity(&TEMPERATURE));
    Some(Ambient { pressure_pa: *pressure?, temperature_k: *temperature? })
}

fn supply(reader: &Reader<'_>) -> Option<Supply> {
    use schema::supply::*;
    let pressure = reader.quantity(&PRESSURE);
    let flow = reader.quantity(&FLOW);
    let stall = reader.quantity(&STALL_PRESSURE);
    let volume = reader.quantity(&RESERVOIR_VOLUME);
    let is_pump = *reader.choice(&KIND, &[true, false])?;
    if !is_pump {
        let of_a_pump = [FLOW.name, STALL_PRESSURE.name, RESERVOIR_VOLUME.name];
        reader.forbid(&of_a_pump, "for a regulated supply")?;
        return Some(Supply::Regulated { pressure_pa: *pressure? });
    }
    let (pressure, stall) = pressure.zip(stall)?;
    if *pressure > *stall {
        let title = "the pump cannot reach `pressure`: it stalls at `stall_pressure`";
        let problem = Problem::at(pressure.span, title, "above the stall pressure");
        return reader.log().note(problem.label(stall.span, "the pump stalls here"));
    }
    Some(Supply::Pump {
        pressure_pa: *pressure,
        flow_m3_per_s: *flow?,
        stall_pressure_pa: *stall,
        reservoir_volume_m3: *volume?,
    })
}

fn valve(reader: &Reader<'_>) -> Option<Valve> {
    use schema::valve::*;
    let [conductance, ratio, on, off, jitter, leak, voltage] =
        [CONDUCTANCE, CRITICAL_RATIO, ON_DELAY, OFF_DELAY, JITTER, LEAK, VOLTAGE].map(|key| reader.quantity(&key));
    Some(Valve {
        conductance_m3_per_s_pa: *conductance?,
        critical_ratio: *ratio?,
        on_delay_s: *on?,
        off_delay_s: *off?,
        jitter_s: *jitter?,
        leak_m3_per_s_pa: *leak?,
        voltage_v: *voltage?,
    })
}

fn line(reader: &Reader<'_>) -> Option<Line> {
    use schema::line::*;
    let [length, diameter] = [LENGTH, INNER_DIAMETER].map(|key| reader.quantity(&key));
    Some(Line { length_m: *length?, inner_diameter_m: *diameter? })
}

fn chamber(reader: &Reader<'_>) -> Option<Chamber> {
    use schema::chamber::*;
    let [volume, heat, share, time] =
        [DEAD_VOLUME, WALL_HEAT, CREEP_SHARE, CREEP_TIME].map(|key| reader.quantity(&key));
    Some(Chamber { dead_volume_m3: *volume?, wall_heat_w_per_k: *heat?, creep_share: *share?, creep_time_s: *time? })
}

fn sensor(reader: &Reader<'_>) -> Option<Sensor> {
    use schema::sensor::*;
    let [full_scale, supply, noise, lag] = [FULL_SCALE, SUPPLY_FULL_SCALE, NOISE, LAG].map(|key| reader.quantity(&key));
    let bits = reader.integer(&BITS);
    Some(Sensor {
        full_scale_pa: *full_scale?,
        supply_full_scale_pa: *supply?,
        bits: u8::try_from(*bits?).ok()?,
        noise_pa: *noise?,
        lag_s: *lag?,
    })
}

fn spread(reader: &Reader<'_>) -> Option<Spread> {
    use schema::spread::*;
    let [modulus, wall, angle, volume] = [MODULUS, WALL, FIBER_ANGLE, DEAD_VOLUME].map(|key| reader.quantity(&key));
    let [conductance, delay, offset, gain] =
        [VALVE_CONDUCTANCE, VALVE_DELAY, SENSOR_OFFSET, SENSOR_GAIN].map(|key| reader.quantity(&key));
    Some(Spread {
        modulus: *modulus?,
        wall: *wall?,
        fiber_angle_rad: *angle?,
        dead_volume: *volume?,
        valve_conductance: *conductance?,
        valve_delay: *delay?,
        sensor_offset: *offset?,
        sensor_gain: *gain?,
    })
}

fn truth(reader: &Reader<'_>, obstacles: bool) -> Option<TrueLimb> {
    use schema::truth::*;
    let [hysteresis, creep, softening, assembly, contact, swing] =
        [HYSTERESIS, CREEP, SOFTENING, ASSEMBLY, CONTACT, SWING].map(|key| reader.flag(&key));
    let is_body = *reader.choice(&LIMB, &[false, true])?;
    if !is_body {
        let of_a_body = [HYSTERESIS.name, CREEP.name, SOFTENING.name, ASSEMBLY.name, CONTACT.name, SWING.name];
        reader.forbid(&of_a_body, "for the simple limb: `limb = \"body\"` has them")?;
        return Some(TrueLimb::Simple);
    }
    Some(TrueLimb::Body(BodyEffects {
        hysteresis: hysteresis?,
        creep: creep?,
        softening: softening?,
        assembly: assembly?,
        // Nothing stops a limb among no obstacles.
        contact: contact? && obstacles,
        swing: swing?,
    }))
}
