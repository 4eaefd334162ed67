//! Quantities of a state.

use crate::common::*;
use fra_model::*;

#[test]
fn inverse_of_a_quantity_has_its_value() {
    for motion in Motion::ALL {
        let bare = tube(motion, 6.0, 8.0, neo_hookean(2e5));
        let twists = motion == Motion::Twisting;
        let parameters = if twists { wound(bare, 30.0, Families::One, 1e7, Placement::Layer, 0.2) } else { bare };
        let actuator = Actuator::new(&parameters).unwrap();
        let state = actuator.forward(1e4, &Load::none()).unwrap().state;
        for quantity in StateQuantity::ALL.into_iter().filter(|quantity| quantity.fits(motion)) {
            let value = quantity.of(&state);
            let Some(target) = quantity.target(value) else {
                assert_eq!((quantity, value), (StateQuantity::Pressure, 1e4));
                continue;
            };
            let found = actuator.inverse(target, &Load::none()).unwrap();
            assert!((found.state.pressure_pa - 1e4).abs() < 1e-3, "{motion:?} {quantity:?}: {found:?}");
        }
    }
}

#[test]
fn rest_is_the_state_without_pressure() {
    for motion in Motion::ALL {
        let parameters = tube(motion, 6.0, 8.0, neo_hookean(2e5));
        let state = Actuator::new(&parameters).unwrap().forward(0.0, &Load::none()).unwrap().state;
        for quantity in StateQuantity::ALL {
            let (value, rest) = (quantity.of(&state), quantity.at_rest(&parameters));
            assert!((value - rest).abs() < 1e-12, "{motion:?} {quantity:?}: {value} {rest}");
        }
    }
}

#[test]
fn a_motion_takes_its_own_deformation_and_pressure() {
    let fitting = |motion: Motion| StateQuantity::ALL.into_iter().filter(move |q| q.fits(motion)).count();
    assert_eq!(Motion::ALL.map(fitting), [2, 3, 2, 2]);
    for motion in Motion::ALL {
        assert!(StateQuantity::natural(motion).fits(motion));
    }
}

#[test]
fn names_are_the_labels_joined() {
    for quantity in StateQuantity::ALL {
        assert_eq!(quantity.label().replace("gauge ", "").replace(' ', "_"), quantity.name());
    }
}
