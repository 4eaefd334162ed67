//! The choice of motions and their order.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use fra_model::Motion;
use nalgebra::Vector3;
use softlimb_design::synthesis::kinds::{Kind, space};
use softlimb_design::synthesis::{Candidate, Choice, Choosing, ModuleMotion, Outcome, Space, Task, TaskError, choose};

fn kinds() -> Vec<Space> {
    [Motion::Extension, Motion::Expansion, Motion::Bending, Motion::Twisting].map(space).to_vec()
}

fn task() -> Task {
    let mut task = Kind::A.pose(2).unwrap().task;
    task.way_points.truncate(2);
    task.obstacles.truncate(1);
    task
}

const SHORT: Choosing = Choosing { modules: [1, 2], seed: 5, evaluations: 150, threads: 2 };

fn all(choosing: &Choosing) -> Choice {
    choose(&task(), &kinds(), choosing, Choice::default(), &|_| true).unwrap()
}

#[test]
fn choice_is_the_same_on_any_number_of_threads_and_when_it_is_resumed() {
    let whole = all(&SHORT);
    assert!(whole.finished() && whole.total == 4 + 16);
    assert_eq!(whole, all(&Choosing { threads: 1, ..SHORT }));
    assert_eq!(whole, all(&Choosing { threads: 3, ..SHORT }));
    // Stopped after three orders, written to a file, read again.
    let calls = AtomicUsize::new(0);
    let saved = Mutex::new(String::new());
    let stopped = choose(&task(), &kinds(), &SHORT, Choice::default(), &|choice| {
        *saved.lock().unwrap() = serde_json::to_string(choice).unwrap();
        calls.fetch_add(1, Ordering::SeqCst) < 2
    });
    let stopped = stopped.unwrap();
    assert!(!stopped.finished() && stopped.searched.len() >= 3);
    let read: Choice = serde_json::from_str(&saved.lock().unwrap()).unwrap();
    let resumed = choose(&task(), &kinds(), &SHORT, read.clone(), &|_| true).unwrap();
    assert_eq!(resumed, whole);
    // It is of no use for anything else.
    let other = Choosing { seed: 6, ..SHORT };
    assert_eq!(choose(&task(), &kinds(), &other, read, &|_| true).unwrap_err(), TaskError::OtherSearch);
}

fn figures(limb: &Candidate) -> [f64; 5] {
    let figures = &limb.figures;
    let error = if limb.figures.tip_error_max_m <= 1e-6 { 0.0 } else { figures.tip_error_rms_m };
    let spare = figures.spare_clearance_m.unwrap();
    [
        error,
        figures.pressure_max_pa,
        figures.mass_kg,
        -if spare.abs() < 4e-5 { spare.max(0.0) } else { spare },
        figures.air_m3,
    ]
}

#[test]
fn list_holds_what_nothing_is_better_than_and_nothing_else() {
    let choice = all(&SHORT);
    let list = choice.pareto();
    assert!(list.len() >= 2 && list[0].does_it(), "{:?}", list.iter().map(|limb| figures(limb)).collect::<Vec<_>>());
    let found: Vec<&Candidate> = choice
        .searched
        .iter()
        .filter_map(|searched| if let Outcome::Found(limbs) = &searched.outcome { Some(limbs) } else { None })
        .flatten()
        .collect();
    let better = |a: &Candidate, b: &Candidate| {
        let (a, b) = (figures(a), figures(b));
        a != b && a.iter().zip(&b).all(|(a, b)| a <= b)
    };
    for limb in &found {
        let beaten = found.iter().any(|other| better(other, limb));
        assert_eq!(list.contains(limb), !beaten, "{:?}", figures(limb));
    }
}

#[test]
fn order_is_left_out_only_where_it_could_not_do_it_or_another_does_the_same() {
    let choice = all(&SHORT);
    let mut left_out = 0;
    for searched in &choice.searched {
        let Outcome::LeftOut(reason) = &searched.outcome else { continue };
        left_out += 1;
        let motions: Vec<Motion> = searched.order.iter().map(|index| kinds()[*index].motion()).collect();
        let bends = motions.contains(&Motion::Bending);
        // The hidden limb bends in one plane, so nothing straight can do it.
        assert!(!bends || reason.contains("tip") || reason.contains("longest"), "{motions:?}: {reason}");
    }
    assert!(left_out >= 12, "{left_out}");
    // A task that only a bend out of a plane, turned by a twist, can do: points on a circle about the axis.
    let mut task = task();
    task.obstacles.clear();
    for (index, way_point) in task.way_points.iter_mut().enumerate() {
        let angle = 0.35 * index as f64;
        let point = Vector3::new(0.12 * angle.cos(), 0.12 * angle.sin(), 0.42);
        way_point.aim = Some(softlimb_design::synthesis::Aim::Point(point));
    }
    let choice =
        choose(&task, &kinds(), &Choosing { evaluations: 600, ..SHORT }, Choice::default(), &|_| true).unwrap();
    let list = choice.pareto();
    assert!(list[0].does_it());
    let motions: Vec<ModuleMotion> = list[0].modules.iter().map(|module| module.motion).collect();
    let twisted = motions == [ModuleMotion::Twisting, ModuleMotion::Bending];
    assert!(twisted || motions == [ModuleMotion::Bending, ModuleMotion::Bending], "{motions:?}");
}
