//! Limits and settings of the controller.

use crate::data::{
    BendingModel, Camera, Controller, Excess, Imu, InverseChoice, Limits, LinkLoss, MarginLimits, PressureLoop,
    Shaping, Swing, Weight,
};
use crate::error::{Problem, quoted};
use crate::reader::Reader;
use crate::schema;
use crate::schema::{Flag, Nested, Quantity, Section, controller as keys};
use crate::source::Span;

/// A number of seconds within the bounds of the schema, in whole microseconds.
pub(super) fn microseconds(seconds: f64) -> u64 {
    (seconds * 1e6).round() as u64
}

/// Reads a table that may be left out; then all its keys have their defaults.
pub(super) fn optional_table<'a, T>(
    parent: &Reader<'a>,
    key: &Nested,
    section: &'static Section,
    read: impl FnOnce(&Reader<'a>) -> Option<T>,
) -> Option<T> {
    match parent.value(key.name) {
        Some(value) => read(&Reader::open(parent.log(), value, section, &quoted(key.name))?),
        None => read(&parent.absent(section)),
    }
}

/// Smallest range of supply pressures that a scene may ask for, Pa; the pump is controlled in a tenth of it.
const SUPPLY_RANGE_MIN_PA: f64 = 1e3;

pub(super) fn limits(root: &Reader<'_>) -> Option<Limits> {
    optional_table(root, &schema::scene::LIMITS, &schema::limits::SECTION, |reader| {
        use schema::limits::*;
        let pressure_max = reader.quantity(&PRESSURE_MAX);
        let clearance = reader.quantity(&CLEARANCE);
        let supply_min = reader.quantity(&SUPPLY_MIN);
        let supply_max = reader.quantity(&SUPPLY_MAX);
        let valve_voltage_min = reader.maybe(&VALVE_VOLTAGE_MIN);
        let stretch = reader.maybe(&STRETCH_RATE_MAX);
        let radius = reader.maybe(&RADIUS_RATE_MAX);
        let angle = reader.maybe(&ANGLE_RATE_MAX);
        let load_factor = reader.quantity(&LOAD_FACTOR_MIN);
        let stiffness = reader.quantity(&TIP_STIFFNESS_MIN);
        let sag = reader.quantity(&SAG_MAX);
        let buckling_margin = reader.quantity(&BUCKLING_MARGIN_MIN);
        let pressure_share = reader.quantity(&PRESSURE_SHARE_MAX);
        let (supply_min, supply_max) = supply_min.zip(supply_max)?;
        if *supply_max - *supply_min < SUPPLY_RANGE_MIN_PA {
            let title = "`supply_min` must be at least 1 kPa below `supply_max`";
            let problem = Problem::at(supply_min.span, title, "the lower bound");
            return reader.log().note(problem.label(supply_max.span, "the upper bound"));
        }
        Some(Limits {
            pressure_max_pa: pressure_max?,
            clearance_m: *clearance?,
            supply_min_pa: *supply_min,
            supply_max_pa: *supply_max,
            valve_voltage_min_v: valve_voltage_min?,
            stretch_rate_max_per_s: stretch?.map(|rate| *rate),
            radius_rate_max_m_per_s: radius?.map(|rate| *rate),
            angle_rate_max_rad_per_s: angle?.map(|rate| *rate),
            standing: MarginLimits {
                load_factor: *load_factor?,
                stiffness_n_per_m: *stiffness?,
                sag_share: *sag?,
                buckling_margin: *buckling_margin?,
                pressure_share: *pressure_share?,
            },
        })
    })
}

pub(super) fn controller(root: &Reader<'_>) -> Option<Controller> {
    optional_table(root, &schema::scene::CONTROLLER, &keys::SECTION, |reader| {
        let knot = time(reader, &keys::KNOT_PERIOD, 1);
        let control = time(reader, &keys::CONTROL_PERIOD, TICK_US);
        let telemetry = time(reader, &keys::TELEMETRY_PERIOD, TICK_US);
        let timeout = time(reader, &keys::LINK_TIMEOUT, 1);
        let hold = time(reader, &keys::HOLD_TIME, 1);
        let link_loss = reader.choice(&keys::LINK_LOSS, &[LinkLoss::HoldThenRamp, LinkLoss::Hold, LinkLoss::Vent]);
        let vent_ramp = reader.quantity(&keys::VENT_RAMP);
        let loops = [PressureLoop::Pulses, PressureLoop::ProportionalIntegral, PressureLoop::OnOff];
        let pressure_loop = reader.choice(&keys::LOOP, &loops);
        let inverses = [InverseChoice::Auto, InverseChoice::Table, InverseChoice::Model];
        let inverse = reader.choice(&keys::INVERSE, &inverses);
        let inverse_error = reader.quantity(&keys::INVERSE_ERROR);
        let models = [BendingModel::Auto, BendingModel::Analytic, BendingModel::SectionFe];
        let bending = reader.choice(&keys::BENDING, &models);
        if let (Some(bending), Some(inverse)) = (&bending, &inverse)
            && (**bending, **inverse) == (BendingModel::SectionFe, InverseChoice::Model)
        {
            let problem = Problem::at(
                bending.span,
                "`bending = \"section-fe\"` needs tables",
                "the device has no model of a bending module",
            );
            return reader.log().note(problem.help("leave out `inverse = \"model\"`"));
        }
        Some(Controller {
            knot_period_us: knot?,
            control_period_us: control?,
            telemetry_period_us: telemetry?,
            link_timeout_us: timeout?,
            hold_time_us: hold?,
            link_loss: *link_loss?,
            vent_ramp_pa_per_s: *vent_ramp?,
            pressure_loop: *pressure_loop?,
            inverse: *inverse?,
            bending: *bending?,
            inverse_error: *inverse_error?,
        })
    })
}

pub(super) fn weight(root: &Reader<'_>) -> Option<Weight> {
    optional_table(root, &schema::scene::WEIGHT, &schema::weight::SECTION, |reader| {
        use schema::weight::*;
        let simulated = reader.flag(&SIMULATED);
        let compensated = reader.maybe_flag(&COMPENSATED);
        let error = reader.quantity(&ERROR);
        Some(Weight { simulated: simulated?, compensated: compensated?.or(simulated)?, error: *error? })
    })
}

pub(super) fn swing(root: &Reader<'_>, weight: Option<&Weight>) -> Option<Swing> {
    optional_table(root, &schema::scene::SWING, &schema::swing::SECTION, |reader| {
        use schema::swing::*;
        let loss_factor = reader.quantity(&LOSS_FACTOR);
        let shaping = reader
            .choice(&SHAPING, &[Shaping::None, Shaping::ZeroVibration, Shaping::ZeroDerivative, Shaping::Adapted]);
        let residual_max = reader.maybe(&RESIDUAL_MAX);
        let excess = reader.choice(&EXCESS, &[Excess::Refuse, Excess::Stretch]);
        let shaped = shaping.filter(|shaping| **shaping != Shaping::None).map(|shaping| shaping.span);
        let bounded = residual_max.flatten().map(|bound| bound.span);
        if let Some(span) = shaped.or(bounded).filter(|_| weight.is_some_and(|weight| !weight.compensated)) {
            let title = "swing is known of a limb whose setpoints are corrected for its weight";
            let problem = Problem::at(span, title, "`[weight]` turns that correction off");
            return reader.log().note(problem.help("leave out `simulated = false` and `compensated = false`"));
        }
        Some(Swing { loss_factor: *loss_factor?, shaping: *shaping?, residual_max_m: residual_max?, excess: *excess? })
    })
}

/// The inner `None` without the table.
pub(super) fn camera(root: &Reader<'_>) -> Option<Option<Camera>> {
    if root.value(schema::scene::CAMERA.name).is_none() {
        return Some(None);
    }
    optional_table(root, &schema::scene::CAMERA, &schema::camera::SECTION, |reader| {
        use schema::camera::*;
        let feedback = reader.flag(&FEEDBACK);
        let [period, latency, noise, offset, drop_outs] =
            [PERIOD, LATENCY, NOISE, OFFSET, DROP_OUTS].map(|key| reader.quantity(&key));
        Some(Some(Camera {
            feedback: feedback?,
            period_s: *period?,
            latency_s: *latency?,
            noise_m: *noise?,
            offset_m: *offset?,
            drop_outs: *drop_outs?,
        }))
    })
}

/// The inner `None` without the table.
pub(super) fn imu(root: &Reader<'_>, camera: Option<&Camera>) -> Option<Option<Imu>> {
    if root.value(schema::scene::IMU.name).is_none() {
        return Some(None);
    }
    optional_table(root, &schema::scene::IMU, &schema::imu::SECTION, |reader| {
        use schema::imu::*;
        let feedback = reader.flag(&FEEDBACK);
        let [period, latency, tilt, heading, noise, rate_noise, drop_outs] =
            [PERIOD, LATENCY, TILT_ERROR, HEADING_ERROR, NOISE, RATE_NOISE, DROP_OUTS].map(|key| reader.quantity(&key));
        if feedback == Some(true) && camera.is_some_and(|camera| camera.feedback) {
            let place = |table: &Nested, key: &Flag| root.place_of(table.name, &[key.name]);
            let title = "feedback has one observer, the camera or the IMUs";
            let problem = Problem::at(place(&schema::scene::IMU, &FEEDBACK), title, "the IMUs correct the setpoints")
                .label(place(&schema::scene::CAMERA, &schema::camera::FEEDBACK), "the camera corrects them, too");
            return reader.log().note(problem.help("set one of them to `false`"));
        }
        Some(Some(Imu {
            feedback: feedback?,
            period_s: *period?,
            latency_s: *latency?,
            tilt_error_rad: *tilt?,
            heading_error_rad: *heading?,
            noise_rad: *noise?,
            rate_noise_rad_per_s: *rate_noise?,
            drop_outs: *drop_outs?,
        }))
    })
}

/// Period of the controller's tick, microseconds.
const TICK_US: u32 = 1000;

/// A time in microseconds, a whole number of steps.
fn time(reader: &Reader<'_>, key: &Quantity, step_us: u32) -> Option<u32> {
    let found = reader.quantity(key)?;
    let time_us = u32::try_from(microseconds(*found)).ok()?;
    if time_us.is_multiple_of(step_us) {
        return Some(time_us);
    }
    let span: Span = found.span;
    let title = format!("`{}` must be a whole number of milliseconds", key.name);
    reader.log().note(Problem::at(span, title, "between two ticks of the controller"))
}
