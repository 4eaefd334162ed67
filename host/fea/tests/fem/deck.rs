//! The text of decks, read back: sets, ties, loads, cards of both programs.

use std::collections::{BTreeMap, BTreeSet};

use fra_model::{ActuatorParameters, Arrangement, Families, Fiber, Material, Motion, Placement};
use softlimb_fea::solid::{Around, Deck, FiberModel, Model, Options, Subject, SymmetryUse};

use crate::fem::motions;
use crate::fem::sample::{plain, wound};

const PRESSURES: [f64; 2] = [20e3, 40e3];

/// Elements of a deck: their nodes by their number.
type Elements = BTreeMap<usize, Vec<usize>>;
/// Terms of a tie: node, direction, factor.
type Tie = Vec<(usize, u8, f64)>;

/// A deck as a reader that knows nothing of how it was made sees it.
#[derive(Default)]
struct Read {
    nodes: BTreeMap<usize, [f64; 3]>,
    /// By type and set.
    elements: BTreeMap<(String, String), Elements>,
    ties: Vec<Tie>,
    held: BTreeSet<(usize, u8)>,
    cards: Vec<String>,
}

fn deck(subject: &Subject, options: &Options) -> Deck {
    Deck::new(&Model::new(subject, options).unwrap(), "part", &PRESSURES).unwrap()
}

fn read(text: &str) -> Read {
    let mut found = Read::default();
    let (mut card, mut numbers) = (String::new(), Vec::new());
    for line in text.lines().chain(["*END"]).filter(|line| !line.starts_with("**")) {
        assert!(line.len() <= 130, "CalculiX reads no more: {line}");
        if line.starts_with('*') {
            take(&mut found, &card, &numbers);
            (card, numbers) = (line.to_owned(), Vec::new());
            found.cards.push(card.clone());
        } else {
            let words = line.split(',').map(str::trim).filter(|word| !word.is_empty());
            numbers.push(
                words
                    .map(|word| {
                        assert!(word.len() <= 20, "CalculiX reads 20 characters: {word}");
                        word.parse::<f64>().unwrap_or(f64::NAN)
                    })
                    .collect::<Vec<_>>(),
            );
        }
    }
    found
}

fn take(found: &mut Read, card: &str, lines: &[Vec<f64>]) {
    let word = |key: &str| card.split(',').find_map(|part| part.trim().strip_prefix(key)).unwrap_or("").to_owned();
    if card.starts_with("*NODE,") {
        found.nodes.extend(lines.iter().map(|line| (line[0] as usize, [line[1], line[2], line[3]])));
    } else if card.starts_with("*ELEMENT") {
        let set = found.elements.entry((word("TYPE="), word("ELSET="))).or_default();
        let count = BTreeMap::from([("C3D20R", 21), ("C3D15", 16), ("T3D2", 3)])[word("TYPE=").as_str()];
        for record in lines.concat().chunks(count) {
            let nodes = record[1..].iter().map(|node| *node as usize).collect();
            assert!(set.insert(record[0] as usize, nodes).is_none());
        }
    } else if card == "*EQUATION" {
        let mut rest = &lines.concat()[..];
        while let [count, others @ ..] = rest {
            let (terms, next) = others.split_at(3 * *count as usize);
            found.ties.push(terms.chunks(3).map(|term| (term[0] as usize, term[1] as u8, term[2])).collect());
            rest = next;
        }
    } else if card == "*BOUNDARY" {
        for line in lines {
            found.held.extend((line[1] as u8..=line[2] as u8).map(|direction| (line[0] as usize, direction)));
        }
    }
}

fn threads(mm: f64) -> Options {
    Options { fibers: FiberModel::Threads { spacing_m: Some(mm * 1e-3) }, ..Options::default() }
}

fn subjects() -> Vec<(Subject, Options)> {
    let bundle = Subject {
        actuators: 3,
        arrangement: Arrangement::Circle { radius_m: 11e-3 },
        ..Subject::single(plain(Motion::Bending))
    };
    let coarse = Options { around: Some(8), along: Some(6), ..Options::default() };
    let singles = motions().map(Subject::single);
    let smeared = singles.iter().map(|subject| (*subject, Options::default()));
    smeared.chain(singles.iter().map(|subject| (*subject, threads(2.0)))).chain([(bundle, coarse)]).collect()
}

#[test]
fn ties_reproduce_every_linear_field_that_has_the_model_s_symmetry() {
    for (subject, options) in subjects() {
        let deck = read(&deck(&subject, &options).model);
        assert!(!deck.ties.is_empty());
        // u = G X with any gradient; where sectors turn into each other, one that turns with them: radial stretch, turn, axial stretch.
        let turning = [[0.3, -0.2, 0.0], [0.2, 0.3, 0.0], [0.0, 0.0, 0.7]];
        let any = [[0.3, -0.5, 0.2], [0.7, 0.1, -0.4], [-0.6, 0.9, 0.7]];
        let sector = matches!(Model::new(&subject, &options).unwrap().symmetry().around, Around::Sector(_));
        let gradient = if sector { turning } else { any };
        let field = |(node, direction, factor): &(usize, u8, f64)| -> f64 {
            let row = gradient[usize::from(*direction) - 1];
            factor * (0..3).map(|n| row[n] * deck.nodes[node][n]).sum::<f64>()
        };
        for tie in &deck.ties {
            assert!(tie.iter().map(field).sum::<f64>().abs() < 1e-8, "{tie:?}");
            let shift: f64 = tie.iter().filter(|term| term.1 == 3).map(|term| term.2).sum();
            assert!(shift.abs() < 1e-9, "a shift along the axis strains {tie:?}");
        }
    }
}

#[test]
fn displacements_are_determined_once() {
    for (subject, options) in subjects() {
        let deck = read(&deck(&subject, &options).model);
        let dependent: Vec<_> = deck.ties.iter().map(|tie| (tie[0].0, tie[0].1)).collect();
        let once: BTreeSet<_> = dependent.iter().copied().collect();
        assert_eq!(once.len(), dependent.len(), "two ties of one displacement");
        assert!(once.is_disjoint(&deck.held), "held and tied: {:?}", once.intersection(&deck.held).next());
        let masters: BTreeSet<_> = deck.ties.iter().flat_map(|tie| &tie[1..]).map(|term| (term.0, term.1)).collect();
        assert!(masters.is_disjoint(&once), "a tie to a tied displacement");
    }
}

#[test]
fn nodes_and_elements_are_whole() {
    for (subject, options) in subjects() {
        let deck = read(&deck(&subject, &options).model);
        let mut used = BTreeSet::new();
        let mut numbers = BTreeSet::new();
        for ((kind, _), elements) in &deck.elements {
            for (number, nodes) in elements {
                assert!(numbers.insert(*number), "element {number} is there twice");
                assert_eq!(nodes.iter().collect::<BTreeSet<_>>().len(), nodes.len(), "{kind} {number}: {nodes:?}");
                used.extend(nodes.iter().copied());
            }
        }
        let all: BTreeSet<_> = deck.nodes.keys().copied().collect();
        assert_eq!(used, all, "nodes without an element, or none for an element's number");
        for (_, place) in deck.nodes {
            assert!(place.iter().all(|x| x.is_finite()));
        }
    }
}

/// Length of thread in a deck, mm, and the longest piece.
fn thread_length(deck: &Read) -> (f64, f64) {
    let trusses = &deck.elements[&("T3D2".to_owned(), "THREADS".to_owned())];
    let length = |ends: &Vec<usize>| {
        let (a, b) = (deck.nodes[&ends[0]], deck.nodes[&ends[1]]);
        (0..3).map(|n| (a[n] - b[n]).powi(2)).sum::<f64>().sqrt()
    };
    let lengths = trusses.values().map(length);
    lengths.fold((0.0, 0.0), |(sum, longest), length| (sum + length, length.max(longest)))
}

#[test]
fn threads_have_the_length_of_their_winding() {
    // Of a family with spacing d on the area A of the winding there is A/d of thread; whole threads make 2 mm into what the model says.
    for (parameters, families) in motions().into_iter().zip([2.0, 2.0, 2.0, 1.0]) {
        let options = Options { symmetry: SymmetryUse::Whole, nodes_max: 400_000, ..threads(2.0) };
        let model = Model::new(&Subject::single(parameters), &options).unwrap();
        let deck = read(&Deck::new(&model, "part", &PRESSURES).unwrap().model);
        let spacing = model.thread_spacing_m().unwrap() * 1e3;
        assert!((1.5..2.8).contains(&spacing), "{spacing}");
        let area = std::f64::consts::TAU * 8.0 * 60.0;
        let (found, longest) = thread_length(&deck);
        // Chords of 7.5 degrees are shorter than their arcs by 7e-4 at most.
        let off = found * spacing / (area * families) - 1.0;
        assert!((-8e-4..1e-6).contains(&off), "{:?}: {off}", parameters.motion);
        assert!(longest < 3.0, "{longest}");
    }
}

#[test]
fn rings_and_lengthwise_threads_are_wound_too() {
    // Of rings 1.5 mm apart 27 would be nearest to 40 mm: an odd number, the middle one in the plane of symmetry.
    let cases = [
        (Motion::Extension, 0.0, 60.0, 2.0),
        (Motion::Extension, 0.0, 40.0, 1.5),
        (Motion::Expansion, 90.0, 60.0, 2.0),
    ];
    for (motion, angle, length, wish) in cases {
        let parameters = ActuatorParameters { length_m: 1e-3 * length, ..wound(motion, angle, Families::One) };
        let model = Model::new(&Subject::single(parameters), &threads(wish)).unwrap();
        assert!(model.symmetry().half_length);
        let deck = read(&Deck::new(&model, "part", &PRESSURES).unwrap().model);
        let share = match model.symmetry().around {
            Around::Sector(count) => 0.5 / f64::from(count),
            other => panic!("{other:?}"),
        };
        let wanted = std::f64::consts::TAU * 8.0 * length * share / (model.thread_spacing_m().unwrap() * 1e3);
        let off = thread_length(&deck).0 / wanted - 1.0;
        assert!((-8e-4..1e-6).contains(&off), "{motion:?} {length}: {off}");
    }
}

/// Lines behind the card that begins with `card`, up to the next.
fn block<'a>(text: &'a str, card: &str) -> Vec<&'a str> {
    let mut lines = text.lines().skip_while(|line| !line.starts_with(card)).skip(1);
    lines.by_ref().take_while(|line| !line.starts_with('*')).collect()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(',').map(|word| word.trim().parse().unwrap()).collect()
}

#[test]
fn fibers_are_the_same_on_the_cards_of_both_programs() {
    let deck = deck(&Subject::single(wound(Motion::Extension, 30.0, Families::Two)), &Options::default());
    let calculix: Vec<f64> =
        block(&deck.calculix, "*USER MATERIAL, CONSTANTS=10").iter().flat_map(|l| numbers(l)).collect();
    let abaqus = numbers(block(&deck.abaqus, "*ANISOTROPIC HYPERELASTIC, HOLZAPFEL, LOCAL DIRECTIONS=2")[0]);
    assert_eq!(calculix[..2], abaqus[..2]);
    // mu2 t / t' = 361 MPa 0.178 mm / 0.04 mm; direction (r, hoop) = (0, cos 30).
    let modulus = 361.0 * 0.178 / 0.04;
    for family in [&calculix[2..6], &calculix[6..10]] {
        assert!((family[0], (family[1].abs() - 0.75_f64.sqrt()).abs() < 1e-9) == (0.0, true), "{family:?}");
        assert!((family[2] / modulus - 1.0).abs() < 1e-9, "{family:?}");
    }
    assert_eq!(calculix[3], -calculix[7]);
    assert!((abaqus[2] / modulus - 1.0).abs() < 1e-9 && abaqus[4] == 0.0);
    // Half of the layer is wall: half of C10 = mu/2.
    assert!((calculix[0] - 0.05).abs() < 1e-9);
    let axes = block(&deck.abaqus, "*ORIENTATION, NAME=AXIS_1, SYSTEM=CYLINDRICAL, LOCAL DIRECTIONS=2");
    for (line, side) in axes[2..].iter().zip([1.0, -1.0]) {
        let [r, hoop, axial] = numbers(line)[..] else { panic!("{line}") };
        assert!(r == 0.0 && (hoop - side * 0.75_f64.sqrt()).abs() < 1e-9 && (axial - 0.5).abs() < 1e-9);
    }
    for text in [&deck.calculix, &deck.abaqus] {
        assert!(text.contains("*INCLUDE, INPUT=part-model.inc\n"));
        assert_eq!(text.matches("*STEP, NLGEOM").count(), 2);
    }
    assert!(!deck.abaqus.contains("USER MATERIAL") && !deck.calculix.contains("ANISOTROPIC"));
}

#[test]
fn winding_of_no_modulus_bends_as_an_ideal_one_at_its_radius() {
    let stated = |motion, radius_m| {
        let mut parameters = wound(motion, 30.0, Families::Two);
        if let Some(fiber) = &mut parameters.fiber {
            (fiber.modulus_pa, fiber.radius_m) = (0.0, radius_m);
            // Bending alone has no use for it.
            fiber.thickness_m = if motion == Motion::Bending { 0.0 } else { fiber.thickness_m };
        }
        deck(&Subject::single(parameters), &Options::default())
    };
    for (radius_m, low) in [(8e-3, 7.98), (7e-3, 6.98)] {
        let deck = stated(Motion::Bending, radius_m);
        let constants: Vec<f64> =
            block(&deck.calculix, "*USER MATERIAL, CONSTANTS=6").iter().flat_map(|line| numbers(line)).collect();
        // Along the hoop, mu2 t = 1000 mu1 wall, in a layer of a fiftieth of the wall.
        assert_eq!(constants[2..4], [0.0, 1.0]);
        assert!((constants[4] / (1000.0 * 0.2 * 2.0 / 0.04) - 1.0).abs() < 1e-9, "{constants:?}");
        let read = read(&deck.model);
        let layer = &read.elements[&("C3D20R".to_owned(), "LAYER_1".to_owned())];
        let radii: Vec<f64> =
            layer.values().flatten().map(|node| read.nodes[node][0].hypot(read.nodes[node][1])).collect();
        let ends = [radii.iter().copied().fold(f64::INFINITY, f64::min), radii.iter().copied().fold(0.0, f64::max)];
        assert!((ends[0] - low).abs() < 1e-6 && (ends[1] - low - 0.04).abs() < 1e-6, "{radius_m}: {ends:?}");
    }
    // Other motions need no ideal winding: none is there.
    assert!(!stated(Motion::Extension, 7e-3).calculix.contains("USER MATERIAL"));
}

#[test]
fn increments_as_small_as_allowed_are_as_many_as_they_need() {
    for (share, least) in [(0.1, 1000.0), (0.001, 4000.0)] {
        let options = Options { increment: Some(share), ..Options::default() };
        let model = Model::new(&Subject::single(plain(Motion::Expansion)), &options).unwrap();
        let deck = Deck::new(&model, "part", &[20e3]).unwrap();
        for text in [deck.calculix, deck.abaqus] {
            let card = text.lines().find_map(|line| line.strip_prefix("*STEP, NLGEOM, INC=")).expect("a step");
            assert_eq!(card.parse::<f64>().unwrap(), least, "{share}");
        }
    }
}

#[test]
fn negative_angle_mirrors_the_fibers() {
    let hoop = |angle| {
        let deck = deck(&Subject::single(wound(Motion::Twisting, angle, Families::One)), &Options::default());
        let constants =
            block(&deck.calculix, "*USER MATERIAL, CONSTANTS=6").iter().flat_map(|l| numbers(l)).collect::<Vec<_>>();
        constants[3]
    };
    assert_eq!(hoop(30.0), -hoop(-30.0));
    assert!(hoop(30.0) > 0.86);
}

#[test]
fn materials_steps_and_loads_are_in_mm_and_mpa() {
    let yeoh = Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1466.1] };
    for (material, card, c10) in [
        (Material::NeoHookean { shear_modulus_pa: 0.2e6 }, "*HYPERELASTIC, NEO HOOKE", vec![0.1, 2.0 / 400.0]),
        (yeoh, "*HYPERELASTIC, YEOH", vec![0.08656, 0.013805, -0.0014661, 2.0 / (2000.0 * 0.17312), 0.0, 0.0]),
    ] {
        let parameters = ActuatorParameters { material, ..plain(Motion::Expansion) };
        let deck = deck(&Subject::single(parameters), &Options::default());
        let at = deck.model.split_once("*MATERIAL, NAME=WALL\n").expect("the wall's material").1;
        let found = numbers(block(at, card)[0]);
        assert_eq!(found.len(), c10.len());
        assert!(found.iter().zip(&c10).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs()), "{found:?} {c10:?}");
        let loads: Vec<_> = deck.calculix.lines().filter(|line| line.contains(", P6, ")).collect();
        assert_eq!(loads, ["LUMEN_6, P6, 2.0000000000e-2", "LUMEN_6, P6, 4.0000000000e-2"]);
        assert_eq!(
            block(&deck.calculix, "*STATIC"),
            ["1.0000000000e-1, 1.0000000000e0, 1.0000000000e-5, 2.0000000000e-1"]
        );
    }
}

#[test]
fn yeoh_wall_with_fibers_in_it_is_the_wall_and_the_fibers_on_top() {
    let mut parameters = wound(Motion::Extension, 3.0, Families::Two);
    parameters.material = Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1466.1] };
    if let Some(fiber) = &mut parameters.fiber {
        fiber.placement = Placement::Smeared;
    }
    let deck = read(&deck(&Subject::single(parameters), &Options::default()).model);
    let set = |name: &str| &deck.elements[&("C3D20R".to_owned(), name.to_owned())];
    let nodes = |name| set(name).values().collect::<BTreeSet<_>>();
    assert_eq!(nodes("WALL"), nodes("LAYER_1"));
}

#[test]
fn pressures_must_rise_from_zero() {
    let model = Model::new(&Subject::single(plain(Motion::Expansion)), &Options::default()).unwrap();
    for pressures in [&[][..], &[0.0], &[-1.0], &[2e4, 2e4], &[f64::NAN], &[1e4, f64::INFINITY]] {
        let text = Deck::new(&model, "part", pressures).unwrap_err().to_string();
        assert!(text.contains("pressure"), "{text}");
    }
}

/// CalculiX has both windings as families of one card. An Abaqus card has one stiffness, so a second set of elements overlays the first.
#[test]
fn second_winding_is_beside_the_first_in_the_layer() {
    let first = wound(Motion::Twisting, 30.0, Families::One);
    let fiber = first.fiber.unwrap();
    let second = Fiber { angle_rad: 70f64.to_radians(), families: Families::Two, modulus_pa: 36.1e6, ..fiber };
    let subject = Subject::single(first).with_second_fiber(Some(second));
    let text = deck(&subject, &Options::default());
    let constants: Vec<f64> =
        block(&text.calculix, "*USER MATERIAL, CONSTANTS=14").iter().flat_map(|line| numbers(line)).collect();
    let [cos, sin] = [30f64, 70f64].map(|angle_deg| angle_deg.to_radians().cos());
    for (family, hoop, ratio) in [(0, cos, 1.0), (1, sin, 0.1), (2, -sin, 0.1)] {
        let [x, y, modulus, _] = constants[2 + 4 * family..][..4] else { panic!("{constants:?}") };
        assert!(x == 0.0 && (y - hoop).abs() < 1e-9, "{constants:?}");
        // 361 MPa of 0.178 mm in a layer of 0.04 mm.
        assert!((modulus / (ratio * 361.0 * 0.178 / 0.04) - 1.0).abs() < 1e-9, "{constants:?}");
    }
    assert!(text.abaqus.contains("OLD SET=LAYER_1, SHIFT NODES=0, NEW SET=SECOND_1"));
    assert_eq!(text.abaqus.matches("*ANISOTROPIC HYPERELASTIC").count(), 2);
    assert_eq!(text.abaqus.matches("LOCAL DIRECTIONS=2").count(), 2);
    // The elastomer of the second elements is a thousandth of the first's.
    let stiffness: Vec<f64> = text
        .abaqus
        .lines()
        .zip(text.abaqus.lines().skip(1))
        .filter(|(card, _)| card.starts_with("*ANISOTROPIC"))
        .map(|(_, line)| numbers(line)[0])
        .collect();
    assert!((stiffness[1] / stiffness[0] - 1e-3).abs() < 1e-9, "{stiffness:?}");
    let threaded = deck(&subject, &threads(2.0));
    assert!(["THREADS", "SECOND_THREADS"].iter().all(|set| threaded.model.contains(&format!("ELSET={set}\n"))));
    assert_eq!(Model::new(&subject, &threads(2.0)).unwrap().symmetry().around, Around::Whole);
}

#[test]
fn second_winding_in_another_place_is_refused() {
    let first = wound(Motion::Extension, 3.0, Families::Two);
    let fiber = first.fiber.unwrap();
    for (second, message) in [
        (
            Fiber { radius_m: 7e-3, ..fiber },
            "second winding: radius_m = 0.007 is not allowed: the radius of the first winding",
        ),
        (
            Fiber { placement: Placement::Smeared, ..fiber },
            "second winding: radius_m = 0.008 is not allowed: placed as the first winding: a sheet, a layer or smeared",
        ),
        (Fiber { modulus_pa: 0.0, ..fiber }, "second winding: modulus_pa = 0 is not allowed: > 0, of both windings"),
        (Fiber { angle_rad: 2.0, ..fiber }, "second winding: angle_rad = 2 is not allowed: "),
    ] {
        let error = Subject::single(first).with_second_fiber(Some(second)).check().unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}
