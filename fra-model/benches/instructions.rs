//! One warm inverse in single precision, to be counted in instructions:
//!
//! ```text
//! cargo bench -p fra-model --bench instructions --no-run
//! valgrind --tool=callgrind --callgrind-out-file=/dev/null '--toggle-collect=*one_percent_further*' target/release/deps/instructions-*
//! ```

use std::hint::black_box;

use fra_model::*;

/// From a state to a stretch one percent farther.
#[inline(never)]
fn one_percent_further(actuator: &Actuator<f32>, start: &State<f32>, target: Target<f32>) -> Solution<f32> {
    actuator.inverse_near(start, target, &Load::none(), 200).expect("finite")
}

fn main() {
    let fiber = Fiber {
        angle_rad: 0.2,
        families: Families::Two,
        modulus_pa: 2e7,
        placement: Placement::Sheet,
        thickness_m: 2e-4,
        radius_m: 8e-3,
    };
    let actuator = Actuator::new(&ActuatorParameters {
        motion: Motion::Extension,
        inner_radius_m: 6e-3,
        outer_radius_m: 8e-3,
        length_m: 0.1,
        material: Material::NeoHookean { shear_modulus_pa: 0.2e6_f32 },
        fiber: Some(fiber),
    })
    .expect("valid");
    let start = actuator.forward(20e3, &Load::none()).expect("finite").state;
    let target = Target::AxialStretch(1.0 + 1.01 * start.axial_strain);
    let there = one_percent_further(&actuator, &start, black_box(target));
    println!("{:?} after {} evaluations at {:.0} Pa", there.status, there.iterations, there.state.pressure_pa);
}
