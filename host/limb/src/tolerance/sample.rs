//! The other route: limbs made by seed, each asked of the model. The same on any number of threads.

use nalgebra::Vector3;

use super::input::{Kind, Place, Varied};
use super::linear::{Linear, only};
use super::parallel::parallel;
use super::section::Specimens;
use super::shape::{Tube, arc, shape, tip};
use super::study::{Study, actuator};
use crate::LimbModule;
use crate::arc::Arc;
use crate::statics::{Spring, Tangent};
use softlimb_numerics::Random;

/// Where the tip of one limb is in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Displacement of the tip, m; or the index of the first module that has no equilibrium at its pressure.
    pub displacement_m: Result<Vector3<f64>, usize>,
    /// What the linear route says of the same limb, m.
    pub linear_m: Vector3<f64>,
    /// Square of the displacement, m2, with only some parameters off, in the order of [`Varied::all`]; `None` without equilibrium.
    pub parts_m2: Vec<Option<f64>>,
}

/// One limb: a deviation for each pose.
pub type Sample = Vec<Deviation>;

/// Limbs, the first ones the same however many there are. A limb depends on the seed and its number alone.
pub fn sample(study: &Study<'_>, linear: &[Linear], count: usize, seed: u64, threads: usize) -> Vec<Sample> {
    let pressures = pressures(study);
    let maker = Maker::new(study, linear, &pressures, threads);
    parallel(&Vec::from_iter(0..count), threads, |number| maker.limb(seed, *number))
}

/// By channel: its pressures, each once, and which of them each pose has.
type Pressures = Vec<(Vec<f64>, Vec<usize>)>;

fn pressures(study: &Study<'_>) -> Pressures {
    let of_drive = |drive: usize| {
        let mut each: Vec<f64> = Vec::new();
        let index = |pressure: f64| {
            each.iter().position(|known| *known == pressure).unwrap_or_else(|| {
                each.push(pressure);
                each.len() - 1
            })
        };
        let of_pose = study.poses.iter().map(|pose| pose.pressures_pa[drive]).map(index).collect();
        (each, of_pose)
    };
    study.limb.channel_values(&(0..study.limb.drives().len()).map(of_drive).collect::<Vec<_>>())
}

/// Tubes of one actuator, by pressure; `None` where it has no equilibrium there.
type Tubes = Vec<Option<Tube>>;

struct Maker<'a> {
    study: &'a Study<'a>,
    linear: &'a [Linear],
    nominal_tips_m: Vec<Vector3<f64>>,
    varied: Vec<Varied>,
    pressures: &'a Pressures,
    /// Of each module that bends by finite elements of its section.
    specimens: Vec<Option<Specimens<'a>>>,
}

impl<'a> Maker<'a> {
    fn new(study: &'a Study<'a>, linear: &'a [Linear], pressures: &'a Pressures, threads: usize) -> Self {
        let modules = study.limb.modules().len();
        let specimens = |(index, module): (usize, &'a LimbModule)| {
            module.is_by_section().then_some(())?;
            // All its actuators have one pressure.
            let (each, of_pose) = &pressures[module.channels.start];
            let tube = |at: usize| {
                let pose = of_pose.iter().position(|of_pose| *of_pose == at)?;
                Some(study.nominal[pose][index].tubes[0].1.tangent())
            };
            let nominal: Vec<Tangent> = (0..each.len()).filter_map(tube).collect();
            Some(Specimens::new(module, &study.settings.tolerances, each, &nominal, threads))
        };
        Self {
            study,
            linear,
            nominal_tips_m: (0..study.poses.len()).map(|pose| study.nominal_tip_m(pose)).collect(),
            varied: Varied::all(modules),
            pressures,
            specimens: study.limb.modules().iter().enumerate().map(specimens).collect(),
        }
    }

    fn limb(&self, seed: u64, number: usize) -> Sample {
        let places = self.places(seed, number);
        let all: Vec<Vec<Tubes>> = self.tubes(&places);
        let alone = Kind::ALL.map(|kind| {
            let one = |place: &Place| only(kind, place[kind.index()]);
            self.tubes(&places.iter().map(one).collect::<Vec<_>>())
        });
        (0..self.study.poses.len()).map(|pose| self.deviation(pose, &places, &all, &alone)).collect()
    }

    /// Every parameter is drawn, whatever its tolerance, so that switching one off leaves the others as they were.
    fn places(&self, seed: u64, number: usize) -> Vec<Place> {
        let mut random = Random::new(seed, number as u64);
        let mut symmetric = || 2.0 * random.uniform() - 1.0;
        let own: Vec<Place> = self.study.batch.iter().map(|_| [symmetric(), symmetric(), symmetric()]).collect();
        let modulus = Kind::Modulus.index();
        let with_batch = |(place, batch): (&Place, &usize)| {
            let mut place = *place;
            place[modulus] = own[*batch][modulus];
            place
        };
        own.iter().zip(&self.study.batch).map(with_batch).collect()
    }

    /// By module and actuator.
    fn tubes(&self, places: &[Place]) -> Vec<Vec<Tubes>> {
        let of_module = |(module, specimens): (&LimbModule, &Option<Specimens<'_>>)| {
            let tubes = |channel: usize| {
                if let Some(specimens) = specimens {
                    return specimens.tubes(&places[channel]);
                }
                let actuator = actuator(module, &self.study.settings.tolerances, &places[channel]);
                let at = |pressure: &f64| Some(Tube::Model(Box::new(Spring::new(actuator.as_ref()?, *pressure)?)));
                self.pressures[channel].0.iter().map(at).collect()
            };
            module.channels.clone().map(tubes).collect()
        };
        self.study.limb.modules().iter().zip(&self.specimens).map(of_module).collect()
    }

    fn deviation(&self, pose: usize, places: &[Place], all: &[Vec<Tubes>], alone: &[Vec<Vec<Tubes>>; 3]) -> Deviation {
        let nominal = &self.study.nominal[pose];
        let off = |arcs: &[Arc]| tip(self.study.limb, arcs) - self.nominal_tips_m[pose];
        let arcs = |tubes: &[Vec<Tubes>]| -> Vec<Option<Arc>> {
            (0..nominal.len()).map(|module| self.arc(pose, module, &tubes[module])).collect()
        };
        let made = arcs(all);
        let whole = |arcs: &[Option<Arc>]| arcs.iter().copied().collect::<Option<Vec<Arc>>>();
        let part = |varied: &Varied| {
            let arcs = match *varied {
                Varied::Kind(kind) => whole(&arcs(&alone[kind.index()])),
                Varied::Module(index) => made[index].map(|own| {
                    let arcs = nominal.iter().enumerate();
                    arcs.map(|(other, module)| if other == index { own } else { module.arc }).collect()
                }),
            };
            arcs.map(|arcs| off(&arcs).norm_squared())
        };
        let lost = made.iter().position(Option::is_none);
        Deviation {
            displacement_m: whole(&made).map(|arcs| off(&arcs)).ok_or(lost.unwrap_or(0)),
            linear_m: self.linear[pose].displacement_m(places),
            parts_m2: self.varied.iter().map(part).collect(),
        }
    }

    fn arc(&self, pose: usize, index: usize, tubes: &[Tubes]) -> Option<Arc> {
        let module = &self.study.limb.modules()[index];
        let at = self.pressures[module.channels.clone()].iter().map(|(_, of_pose)| of_pose[pose]);
        let places = self.study.places_m[index].iter().zip(tubes).zip(at);
        let each: Option<Vec<_>> = places.map(|((place, tubes), at)| Some((*place, tubes[at].clone()?))).collect();
        Some(arc(module, &shape(module, &each?)?))
    }
}
