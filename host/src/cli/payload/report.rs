//! The report of a scene as JSON and as text.

use std::fmt::Write;

use serde::Serialize;

use softlimb_design::blocked::BlockedDesign;
use softlimb_design::bundle::ActuatorAnswer;
use softlimb_limb::Limb;
use softlimb_limb::payload::{Active, Capacity, CarriedLoad, CarryLimit, LimbCapacity, LoadCase, Outcome as Ended};
use softlimb_limb::statics::GRAVITY_M_PER_S2;
use softlimb_scene::Scene;

/// Heading of the payloads by the statics, and of the loads that pressures alone hold.
const CARRIED: &str = "carried: largest payload by `statics`, pressures that keep the tip in its place; load factor, buckling and pressure as in `check`\n\
                       pose          load, N       kg  limit\n";
const HELD: &str = "\nheld: largest load that pressures alone balance in the shape that they have without weight\n";

/// A pose with its largest loads.
pub(super) struct Pose {
    pub(super) name: String,
    /// The largest payload by the statics, with the tip in its place and the margins of `check` kept; `None` where the plan has no weight.
    pub(super) carried: Option<Result<CarriedLoad, CarryLimit>>,
    pub(super) holding: LimbCapacity,
    pub(super) found: Capacity,
    /// The largest load if tubes did not buckle.
    pub(super) unbuckled: Capacity,
    /// The largest multiple of its own weights that the limb holds, without the load.
    pub(super) own: Capacity,
    /// Modules that no pressures balance, whatever the load.
    pub(super) unbalanced: Vec<String>,
}

/// Everything that is shown.
pub(super) struct Report<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limb: &'a Limb,
    pub(super) case: LoadCase,
    pub(super) poses: Vec<Pose>,
    pub(super) designs: Option<(String, Vec<BlockedDesign>)>,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    mass_kg: f64,
    direction: [f64; 3],
    /// One a module.
    spacers: Vec<u32>,
    buckling_share: f64,
    structure: &'static str,
    motions: Vec<&'static str>,
    poses: Vec<PrintedPose<'a>>,
    designs: Vec<PrintedDesign<'a>>,
}

#[derive(Serialize)]
struct PrintedPose<'a> {
    name: &'a str,
    tip_m: [f64; 3],
    carried: Option<PrintedCarried>,
    outcome: &'static str,
    load_n: Option<f64>,
    certified_bound_n: Option<f64>,
    load_to_weight: Option<f64>,
    load_without_buckling_n: Option<f64>,
    own_weights_held: Option<f64>,
    unbalanced_modules: &'a [String],
    push_to_critical: f64,
    limits: Vec<String>,
    remainder: f64,
    modules: Vec<PrintedModule<'a>>,
}

#[derive(Serialize)]
struct PrintedModule<'a> {
    name: &'a str,
    weight_moment_nm: f64,
    arm_m: f64,
    /// One an actuator; none for a bending module.
    critical_n: &'a [f64],
    ends_at_limit_point: bool,
    pressures_pa: Option<&'a Vec<f64>>,
    pushes_n: Option<&'a Vec<f64>>,
}

/// The largest payload by the statics.
#[derive(Serialize)]
struct PrintedCarried {
    load_n: f64,
    payload_kg: f64,
    keeps_margins: bool,
    limit: Option<String>,
    pressures_pa: Vec<f64>,
}

#[derive(Serialize)]
struct PrintedDesign<'a> {
    wanted_n: f64,
    objective: f64,
    actuator: Option<&'a ActuatorAnswer>,
    push_n_by_pressure_pa: &'a [[f64; 2]],
    printed_jacobian_n: f64,
}

impl Pose {
    /// Whether the limb's own weight can be held.
    pub(super) fn holds(&self) -> bool {
        match self.found.outcome {
            Ended::Solved => self.found.load_n >= 0.0,
            Ended::Infeasible => false,
            Ended::Unbounded => true,
        }
    }

    /// Whether the limb does not keep its margins with what the phase carries.
    pub(super) fn falls_short(&self) -> bool {
        self.carried.as_ref().is_some_and(|carried| !carried.as_ref().is_ok_and(|carried| carried.keeps))
    }

    /// The margin that ends the payload, in words.
    fn carry_limit(limb: &Limb, limit: CarryLimit) -> String {
        match limit {
            CarryLimit::Falls => "the limb falls".to_owned(),
            CarryLimit::Reach => "no pressures reach the place".to_owned(),
            CarryLimit::Pressure { drive } => format!("pressure of {}", limb.drive(drive).name()),
            CarryLimit::LoadFactor => "load factor".to_owned(),
            CarryLimit::Buckling => "buckling".to_owned(),
        }
    }

    fn printed_carried(&self, limb: &Limb) -> Option<PrintedCarried> {
        let nothing = |limit| PrintedCarried {
            load_n: 0.0,
            payload_kg: 0.0,
            keeps_margins: false,
            limit: Some(Self::carry_limit(limb, limit)),
            pressures_pa: Vec::new(),
        };
        let carried = self.carried.as_ref()?;
        Some(carried.as_ref().map_or_else(
            |limit| nothing(*limit),
            |found| PrintedCarried {
                load_n: found.payload_kg * GRAVITY_M_PER_S2,
                payload_kg: found.payload_kg,
                keeps_margins: found.keeps,
                limit: found.limit.map(|limit| Self::carry_limit(limb, limit)),
                pressures_pa: found.pressures_pa.clone(),
            },
        ))
    }

    /// The limits that hold, in words, those of one kind and module together.
    fn limits(&self) -> Vec<String> {
        let mut said: Vec<String> = Vec::new();
        for active in &self.found.active {
            let (bundle, what) = match active {
                Active::PressureMax { bundle, .. } if self.holding.modules[*bundle].ends_at_limit_point => {
                    (bundle, "limit point")
                }
                Active::PressureMax { bundle, .. } => (bundle, "highest pressure"),
                Active::PressureMin { bundle, .. } => (bundle, "no pressure"),
                Active::Push { bundle, .. } => (bundle, "buckling"),
            };
            let one = format!("{} {what}", self.holding.modules[*bundle].name);
            if !said.contains(&one) {
                said.push(one);
            }
        }
        said
    }

    /// The largest push over the load that its bay buckles at.
    fn buckling(&self) -> f64 {
        let pairs = self.found.pushes_n.iter().zip(&self.holding.modules);
        let shares = pairs.flat_map(|(pushes, module)| {
            pushes.iter().zip(&module.critical_n).map(|(push, critical_n)| push / critical_n)
        });
        shares.fold(0.0, f64::max)
    }

    /// Error of the linearized wrench at the answer, over the largest component.
    pub(super) fn off(&self) -> f64 {
        self.found.remainder()
    }

    fn printed(&self, limb: &Limb) -> PrintedPose<'_> {
        let load = |found: &Capacity| (found.outcome == Ended::Solved).then_some(found.load_n);
        let modules = self.holding.modules.iter().enumerate().map(|(index, module)| PrintedModule {
            name: &module.name,
            weight_moment_nm: module.weight_moment_nm,
            arm_m: module.arm_m,
            critical_n: &module.critical_n,
            ends_at_limit_point: module.ends_at_limit_point,
            pressures_pa: self.found.pressures_pa.get(index),
            pushes_n: self.found.pushes_n.get(index),
        });
        PrintedPose {
            name: &self.name,
            tip_m: self.holding.tip_m,
            carried: self.printed_carried(limb),
            outcome: match self.found.outcome {
                Ended::Solved => "solved",
                Ended::Infeasible => "infeasible",
                Ended::Unbounded => "unbounded",
            },
            load_n: load(&self.found),
            certified_bound_n: load(&self.found).map(|_| self.found.bound_n),
            load_to_weight: load(&self.found).map(|load| load / self.holding.weight_n),
            load_without_buckling_n: load(&self.unbuckled),
            own_weights_held: load(&self.own),
            unbalanced_modules: &self.unbalanced,
            push_to_critical: self.buckling(),
            limits: self.limits(),
            remainder: self.off(),
            modules: modules.collect(),
        }
    }

    fn row(&self) -> String {
        let kpa = self.found.pressures_pa.iter().flatten().copied().fold(0.0, f64::max) * 1e-3;
        let free = match self.unbuckled.outcome {
            Ended::Solved => format!("{:.1}", self.unbuckled.load_n),
            _ => "-".into(),
        };
        let own = match self.own.outcome {
            // Rounding below zero is nothing.
            Ended::Solved => format!("{:.2}", if self.own.load_n.abs() < 5e-3 { 0.0 } else { self.own.load_n }),
            Ended::Infeasible => "none".into(),
            Ended::Unbounded => "-".into(),
        };
        let begin = |load: &str, ratio: &str| format!("{:<12} {load:>8} {ratio:>8} {free:>12} {own:>8}", self.name);
        match self.found.outcome {
            Ended::Solved => {
                let load = self.found.load_n;
                format!(
                    "{} {kpa:>8.1} {:>8.2} {:>9.1e} {:>9.2}  {}",
                    begin(&format!("{load:.2}"), &format!("{:.2}", load / self.holding.weight_n)),
                    self.buckling(),
                    self.found.bound_n - load,
                    self.off() * 100.0,
                    self.limits().join(", ")
                )
            }
            Ended::Infeasible if self.unbalanced.is_empty() => {
                format!("{}  no pressures balance the modules together", begin("none", "-"))
            }
            Ended::Infeasible => {
                format!(
                    "{}  no pressures balance {}, whatever the load",
                    begin("none", "-"),
                    self.unbalanced.join(", ")
                )
            }
            Ended::Unbounded => {
                format!(
                    "{}  no pressure acts on this load; `held` does not judge the walls that carry it",
                    begin("-", "-")
                )
            }
        }
    }
}

impl Report<'_> {
    fn motions(&self) -> Vec<&'static str> {
        let mut names = Vec::new();
        for module in self.limb.modules() {
            let name = module.motion.name();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    pub(super) fn answer(&self) -> impl Serialize {
        let designs = self.designs.iter().flat_map(|(_, designs)| designs).map(|design| PrintedDesign {
            wanted_n: design.wanted_n,
            objective: design.answer.objective,
            actuator: design.answer.actuators.first(),
            push_n_by_pressure_pa: &design.curve,
            printed_jacobian_n: design.printed_n,
        });
        Printed {
            scene: self.scene.name(),
            mass_kg: self.scene.mass_kg(),
            direction: self.case.direction,
            spacers: self.spacers(),
            buckling_share: self.case.buckling_share,
            structure: "soft",
            motions: self.motions(),
            poses: self.poses.iter().map(|pose| pose.printed(self.limb)).collect(),
            designs: designs.collect(),
        }
    }

    /// Spacers of each module.
    fn spacers(&self) -> Vec<u32> {
        let own = self.scene.modules().iter().map(|module| u32::from(module.spacers));
        own.map(|own| self.case.spacers.unwrap_or(own)).collect()
    }

    /// Writing to a string cannot fail.
    pub(super) fn table(&self) -> String {
        let [x, y, z] = self.case.direction;
        let spacers: Vec<String> = self.spacers().iter().map(u32::to_string).collect();
        let mut text = format!(
            "{}: soft; {}; {:.2} kg; load at the tip along ({x}, {y}, {z})\n",
            self.scene.name(),
            self.motions().join(", "),
            self.scene.mass_kg()
        );
        let _ = writeln!(
            text,
            "{} spacers in the modules; a push may reach {} of what its bay buckles at\n",
            spacers.join(", "),
            self.case.buckling_share
        );
        if self.poses.iter().any(|pose| pose.carried.is_some()) {
            text.push_str(CARRIED);
            for pose in &self.poses {
                let Some(carried) = pose.printed_carried(self.limb) else { continue };
                let limit = carried.limit.unwrap_or_else(|| "none up to here".to_owned());
                let _ =
                    writeln!(text, "{:<12} {:>8.2} {:>8.3}  {limit}", pose.name, carried.load_n, carried.payload_kg);
            }
            text.push_str(HELD);
        }
        text.push_str("pose          load, N  /weight unbuckled, N     own highest,   push/ certified      off\n");
        text.push_str(
            "                                           weights      kPa   buckle    within affine,%  limits\n",
        );
        self.poses.iter().for_each(|pose| text.push_str(&format!("{}\n", pose.row())));
        if let Some((name, designs)) = &self.designs {
            let _ =
                writeln!(text, "\n{name} held at rest length, designs by eq. (18): push by the model against pressure");
            text.push_str("wanted, N  R_i, mm  R_o, mm  angle, deg  at kPa  push, N: a quarter, half, all of the pressure   n P pi R_i^2\n");
            for design in designs {
                let Some(one) = design.answer.actuators.first() else { continue };
                let push = [5, 10, 20].map(|index: usize| format!("{:9.2}", design.curve[index][1])).join(" ");
                let _ = writeln!(
                    text,
                    "{:>9.2} {:>8.3} {:>8.3} {:>11.2} {:>7.1}          {push}          {:>9.2}",
                    design.wanted_n,
                    one.inner_radius_m * 1e3,
                    one.outer_radius_m * 1e3,
                    one.angle_deg,
                    one.pressures_pa[0] * 1e-3,
                    design.printed_n
                );
            }
        }
        text
    }
}
