//! A small chamber of its own: isothermal gas, ISO 6358 valves with delays, a line node, in f64.

use softlimb_firmware::ValvePulse;

/// Absolute pressure of the atmosphere, Pa.
pub(crate) const ATMOSPHERE_PA: f64 = 101_325.0;
/// Gauge pressure of the supply, Pa.
pub(crate) const SUPPLY_PA: f64 = 200e3;

/// ISO 6358 flow, kg/s, signed from `p1` to `p2` (absolute).
fn iso_6358(c: f64, b: f64, p1: f64, p2: f64) -> f64 {
    if p2 > p1 {
        return -iso_6358(c, b, p2, p1);
    }
    let phi = |r: f64| (1.0 - ((r - b) / (1.0 - b)).powi(2)).sqrt();
    let r = p2 / p1;
    let share = if r <= b {
        1.0
    } else if r < 0.999 {
        phi(r)
    } else {
        phi(0.999) * (1.0 - r) / 0.001
    };
    c * 1.185 * p1 * share
}

/// One valve: the command takes effect after a delay, and a change within the delay cancels it.
#[derive(Clone, Copy)]
struct Valve {
    delays_us: (i64, i64),
    command: bool,
    changed_us: i64,
    open: bool,
}

impl Valve {
    fn update(&mut self, now_us: i64, command: bool) {
        if command != self.command {
            self.command = command;
            self.changed_us = now_us;
        }
        let delay = if command { self.delays_us.0 } else { self.delays_us.1 };
        if now_us - self.changed_us >= delay {
            self.open = self.command;
        }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Truth {
    pub(crate) rest_volume_m3: f64,
    pub(crate) compliance_m3_per_pa: f64,
    pub(crate) valve_c: f64,
    pub(crate) on_us: i64,
    pub(crate) off_us: i64,
    pub(crate) leak_c: f64,
    pub(crate) line_c: f64,
}

/// The chamber that the controller believes in.
pub(crate) const NOMINAL: Truth = Truth {
    rest_volume_m3: 80e-6,
    compliance_m3_per_pa: 0.12e-9,
    valve_c: 1.44e-9,
    on_us: 3_500,
    off_us: 2_000,
    leak_c: 1e-13,
    line_c: 3.78e-9,
};

#[derive(Clone)]
pub(crate) struct Fixture {
    truth: Truth,
    line_pa: f64,
    chamber_kg: f64,
    chamber_pa: f64,
    fill: Valve,
    vent: Valve,
    now_us: i64,
    /// Coil edges so far.
    pub(crate) edges: u32,
}

const LINE_M3: f64 = 5.9e-6;
const RT: f64 = 287.05 * 293.15;

impl Fixture {
    /// At rest at a gauge pressure.
    pub(crate) fn new(truth: Truth, gauge_pa: f64) -> Self {
        let valve =
            Valve { delays_us: (truth.on_us, truth.off_us), command: false, changed_us: -1_000_000, open: false };
        let pa = ATMOSPHERE_PA + gauge_pa;
        let volume = truth.rest_volume_m3 + truth.compliance_m3_per_pa * gauge_pa;
        Self {
            truth,
            line_pa: pa,
            chamber_kg: pa * volume / RT,
            chamber_pa: pa,
            fill: valve,
            vent: valve,
            now_us: 0,
            edges: 0,
        }
    }

    /// Gauge pressure at the manifold, where the sensor sits, Pa.
    pub(crate) fn manifold_pa(&self) -> f64 {
        self.line_pa - ATMOSPHERE_PA
    }

    /// Gauge pressure of the chamber, Pa.
    pub(crate) fn gauge_pa(&self) -> f64 {
        self.chamber_pa - ATMOSPHERE_PA
    }

    /// One tick of 1 ms in steps of 20 us.
    pub(crate) fn tick(&mut self, coils: ValvePulse) {
        const STEP_US: i64 = 20;
        for step in 0..50 {
            let into_tick = step * STEP_US;
            let before = (self.fill.command, self.vent.command);
            self.fill.update(self.now_us, into_tick < i64::from(coils.fill_us));
            self.vent.update(self.now_us, into_tick < i64::from(coils.vent_us));
            self.edges += u32::from(before.0 != self.fill.command) + u32::from(before.1 != self.vent.command);
            assert!(!(self.fill.open && self.vent.open), "both valves open");
            self.flow(STEP_US as f64 * 1e-6);
            self.now_us += STEP_US;
        }
    }

    fn flow(&mut self, dt: f64) {
        let t = self.truth;
        let fill = if self.fill.open { iso_6358(t.valve_c, 0.3, ATMOSPHERE_PA + SUPPLY_PA, self.line_pa) } else { 0.0 };
        let vent = if self.vent.open { iso_6358(t.valve_c, 0.3, self.line_pa, ATMOSPHERE_PA) } else { 0.0 };
        let line = iso_6358(t.line_c, 0.29, self.line_pa, self.chamber_pa);
        let leak = iso_6358(t.leak_c, 0.3, self.chamber_pa, ATMOSPHERE_PA);
        self.line_pa += RT / LINE_M3 * (fill - vent - line) * dt;
        self.chamber_kg += (line - leak) * dt;
        // P (V0 + c (P - Pa)) = m R T, solved for P.
        let rigid = t.rest_volume_m3 - t.compliance_m3_per_pa * ATMOSPHERE_PA;
        let c = t.compliance_m3_per_pa;
        self.chamber_pa = if c == 0.0 {
            self.chamber_kg * RT / rigid
        } else {
            ((rigid * rigid + 4.0 * c * self.chamber_kg * RT).sqrt() - rigid) / (2.0 * c)
        };
    }
}
