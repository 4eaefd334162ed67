//! Measured actuators beside the models: what the page says, and what it must say.
//!
//! The page is made by `cargo xtask lab measured --svg docs/evidence/measured.svg --page docs/evidence/measured.md`.

use softlimb_lab::generated_section::replaced;
use softlimb_lab::measured::{PLACE, STATED_PA, Set, page, picture, sets};

fn set(sets: &[Set], angle_deg: f64) -> &Set {
    sets.iter().find(|set| set.angle_deg == angle_deg && set.length_m == 0.18).expect("a set")
}

#[test]
fn benders_near_the_hoop_are_predicted_with_nothing_fitted() {
    let sets = sets().unwrap();
    let (near, wound) = (set(&sets, 5.0), set(&sets, 15.0));
    let readings = |set: &Set| set.rows.iter().map(|row| row.readings.len()).sum::<usize>();
    assert_eq!((near.rows.len(), readings(near), readings(wound)), (4, 12, 3));
    assert!(near.rms(|row| row.default) <= 0.047 && near.rms(|row| row.section) <= 0.047);
    assert!(wound.rms(|row| row.default) <= 0.1 && wound.rms(|row| row.analytic) <= 0.1);
    for set in [near, wound] {
        assert!(set.rows.iter().all(|row| row.default == row.section), "{}", set.angle_deg);
        assert!(set.rms(|row| row.fitted) <= set.rms(|row| row.section) + 1e-6);
        assert!((0.9..1.15).contains(&(set.fitted_pa / STATED_PA)), "{}", set.fitted_pa);
    }
}

#[test]
fn page_and_picture_show_the_comparison() {
    let read = |name: &str| {
        let file = format!("{}/../../docs/evidence/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(&file).expect(&file)
    };
    let (sets, document) = (sets().unwrap(), read("measured.md"));
    let now = page(&sets).unwrap();
    assert_eq!(replaced(&document, PLACE, &now).as_deref(), Some(document.as_str()), "see the head of this test");
    assert!(picture(&sets) == read("measured.svg"), "docs/evidence/measured.svg is not of the comparison");
}
