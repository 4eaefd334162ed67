//! Bending and shear stiffness of a straight wall under pressure, by the second variation of its energy.
//!
//! A point of the section goes from `(r, theta)` to `(r + U cos, V sin, W sin)` while the axis bends by `kappa`. Shapes turned by 90 deg about the axis,
//! `(u sin, -v cos, -w cos)`, are zero there and have the slopes `u'`, `v'` and `w'` along the wall. The deformation gradient has the columns
//!
//! ```text
//! d/dR:      r' + U' c,                         V' s,                                 W' s
//! d/R dth:   -(U + V) s,                        r + (U + V) c,                        W c
//! d/dZ:      k c s W - s (T (U + V) - u'),      T r + c (T (U + V) - v') - k s2 W,    l - k r c + (T W - w') c + k (V s2 - U c2)
//! ```
//!
//! where `l` and `T` are the wall's stretch and twist rate. The wall keeps its volume: `U + V` follows from `U` and `w'`. The energy to
//! second order is that of the elastomer and of the threads, less the constraint by the wall's own pressure, less the work of the lumen's. `U` and `W` are
//! four functions each, five where threads begin at two radii within the wall.
//!
//! *Bending.* Without slopes the least energy at `kappa = 1` is half of the stiffness `EI`. In a frame that turns by `t` per length the slopes are `t` times
//! the shapes.
//!
//! *Shear.* Where a moment grows along the wall by a shear force `Q`, the bend is `Z` times that of `kappa = Q/EI`, `x`, turned by 90 deg, and a shape `y`
//! is added that is the same all along. With the energy `y A y/2 + y B x + x C x/2` of a shape `y` and slopes `x` the equilibrium is
//! `A y + (B + B') x = 0`. To `y` a bend across the force is added, with the moment that plates at both ends need to keep the sections from turning: it is that
//! of least energy (Castigliano), and lowers it by `(x B x)^2/2EI`. The energy where the moment is zero is `Q^2/(2 GA)`.
//! `docs/explanation/statics.md` has the accuracy.

use std::f64::consts::PI;

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Material, Placement, State};
use nalgebra::{Cholesky, Const, SMatrix, SVector};
use softlimb_numerics::gauss::GAUSS_6;

/// Functions of the radius for each of `U` and `W`, without the one of a second kink.
const FUNCTIONS: usize = 4;

type Row<const N: usize> = SVector<f64, N>;

/// Bending stiffness of a straight tube in a state, per length at rest, N m2; the bend stays in a plane. `None` where its section is not stable.
pub(super) fn bending_nm2(actuator: &Actuator<f64>, state: &State<f64>) -> Option<f64> {
    if kinks_m(actuator).count() < 2 { bending::<9, 8>(actuator, state) } else { bending::<11, 10>(actuator, state) }
}

/// The same and the shear stiffness between plates, which keep its sections from turning, N; of a state without axial force.
pub(super) fn bending_and_shear(actuator: &Actuator<f64>, state: &State<f64>) -> Option<(f64, f64)> {
    if kinks_m(actuator).count() < 2 {
        sheared::<9, 8, 18>(actuator, state)
    } else {
        sheared::<11, 10, 22>(actuator, state)
    }
}

/// With `S` unknowns, `I` of them beside the bend.
fn bending<const S: usize, const I: usize>(actuator: &Actuator<f64>, state: &State<f64>) -> Option<f64> {
    let whole = Wall::<S, S>::new(actuator, state, 0.0).form();
    let across = whole.fixed_view::<I, 1>(1, 0);
    Some(whole[(0, 0)] - across.dot(&inside::<S, I>(&whole)?.0.solve(&across)))
}

/// The same with `N` unknowns and slopes.
fn sheared<const S: usize, const I: usize, const N: usize>(
    actuator: &Actuator<f64>,
    state: &State<f64>,
) -> Option<(f64, f64)> {
    let [own, mixed, slopes] = parts::<S, N>(&Wall::<S, N>::new(actuator, state, 0.0).form());
    let inside = inside::<S, I>(&own)?;
    let bend = inside.bend(&own);
    let added = inside.answer(&((mixed + mixed.transpose()) * bend));
    let bending_nm2 = bend.dot(&(own * bend));
    let bent = added.dot(&(own * added)) + 2.0 * added.dot(&(mixed * bend)) + bend.dot(&(slopes * bend));
    // Plates leave the sections upright: a bend of the axis across the force goes with the shear, so that they do not turn.
    let energy = bent - bend.dot(&(mixed * bend)).powi(2) / bending_nm2;
    // The arm of the force is the length as it is stretched.
    let arm_nm2 = bending_nm2 / state.axial_stretch;
    (energy > 0.0).then_some((bending_nm2, arm_nm2 * arm_nm2 / energy))
}

/// The form of the unknowns, of them with their slopes, and of the slopes.
fn parts<const S: usize, const N: usize>(whole: &SMatrix<f64, N, N>) -> [SMatrix<f64, S, S>; 3] {
    [(0, 0), (0, S), (S, S)].map(|(row, column)| whole.fixed_view::<S, S>(row, column).into_owned())
}

/// The form of all unknowns but the bend.
struct Inside<const I: usize>(Cholesky<f64, Const<I>>);

fn inside<const S: usize, const I: usize>(whole: &SMatrix<f64, S, S>) -> Option<Inside<I>> {
    whole.fixed_view::<I, I>(1, 1).into_owned().cholesky().map(Inside)
}

impl<const I: usize> Inside<I> {
    /// Equilibrium without a bend under a force less.
    fn answer<const S: usize>(&self, force: &Row<S>) -> Row<S> {
        let own = -self.0.solve(&force.fixed_rows::<I>(1).into_owned());
        Row::from_fn(|index, _| if index == 0 { 0.0 } else { own[index - 1] })
    }

    /// The shape of least energy of a unit of bend.
    fn bend<const S: usize>(&self, whole: &SMatrix<f64, S, S>) -> Row<S> {
        let mut bend = self.answer(&whole.column(0).into_owned());
        bend[0] = 1.0;
        bend
    }
}

/// The windings that resist.
fn windings(actuator: &Actuator<f64>) -> impl Iterator<Item = &Fiber<f64>> {
    let both = actuator.parameters().fiber.iter().chain(actuator.second_fiber());
    both.filter(|fiber| fiber.modulus_pa > 0.0)
}

/// Radii at rest within the wall where threads begin or lie, m, each once.
fn kinks_m(actuator: &Actuator<f64>) -> impl Iterator<Item = f64> {
    let ActuatorParameters { inner_radius_m, outer_radius_m, .. } = *actuator.parameters();
    let mut last_m = inner_radius_m;
    windings(actuator)
        .filter(|fiber| fiber.placement != Placement::Smeared)
        .map(|fiber| fiber.radius_m)
        .filter(move |radius_m| *radius_m > inner_radius_m && *radius_m < outer_radius_m)
        .filter(move |radius_m| *radius_m != std::mem::replace(&mut last_m, *radius_m))
}

/// A wall in a state that is the same all around, with `S` unknowns of the section; `N` are these, with or without their slopes.
struct Wall<'a, const S: usize, const N: usize> {
    parameters: &'a ActuatorParameters<f64>,
    windings: [Option<&'a Fiber<f64>>; 2],
    pressure_pa: f64,
    stretch: f64,
    lumen_m: f64,
    /// Twist, and turn of the frame in which shapes are constant where they have slopes of their own, rad/m.
    twist: f64,
    turn: f64,
    /// Outer radius, m.
    outer_m: f64,
    /// Where threads within the wall begin, or the lumen, over the outer radius: the curvature of `U` and the slope of `W` change there.
    kinks: [f64; 2],
    /// What a unit of each unknown moves the middle of the outer surface by, and its slope.
    shift: [Row<N>; 2],
}

/// One radius of the wall.
struct Place {
    /// Radius at rest and now, m, and the change of the one by the other.
    rest_m: f64,
    r_m: f64,
    slope: f64,
    /// First and second derivative of the elastomer's energy by `I1`, Pa.
    energy: [f64; 2],
}

/// What a unit of each unknown moves at a radius: `kappa`, `U`, `V`, `W`, `U + V`, the slopes of the first three by the radius at rest, and the last column
/// of the gradient less what is of the second order, and the slopes of `U`, `V` and `W` along the wall.
struct Moves<const N: usize> {
    bend: Row<N>,
    u: Row<N>,
    v: Row<N>,
    w: Row<N>,
    around: Row<N>,
    by_radius: [Row<N>; 3],
    along: [Row<N>; 3],
    slopes: [Row<N>; 3],
}

/// A square form, of which the symmetric part counts.
struct Form<const N: usize>(SMatrix<f64, N, N>);

impl<const N: usize> Form<N> {
    /// Adds the product of two rows. Inlined at each of its calls it would be 100 kB of the binary.
    #[inline(never)]
    fn add(&mut self, a: &Row<N>, b: &Row<N>) {
        // Arrays of a known size take whole registers; nalgebra's own update goes entry by entry.
        let (rows, columns): (&[f64; N], &[f64; N]) = (&a.data.0[0], &b.data.0[0]);
        // Many entries of a row are zero.
        for (column, by) in self.0.data.0.iter_mut().zip(columns).filter(|(_, by)| **by != 0.0) {
            column.iter_mut().zip(rows).for_each(|(entry, row)| *entry += by * row);
        }
    }

    /// Adds the product of the bend and a row.
    fn add_bend(&mut self, row: &Row<N>) {
        self.0.row_mut(0).iter_mut().zip(row.iter()).for_each(|(entry, by)| *entry += by);
    }
}

impl<'a, const S: usize, const N: usize> Wall<'a, S, N> {
    fn new(actuator: &'a Actuator<f64>, state: &State<f64>, turn: f64) -> Self {
        let parameters = actuator.parameters();
        let mut own = windings(actuator);
        let mut wall = Self {
            parameters,
            windings: [own.next(), own.next()],
            pressure_pa: state.pressure_pa,
            stretch: state.axial_stretch,
            lumen_m: state.inner_radius_m,
            twist: state.twist_rad / parameters.length_m,
            turn,
            outer_m: 1.0,
            kinks: [0.0; 2],
            shift: [Row::zeros(); 2],
        };
        let surface = wall.place(parameters.outer_radius_m);
        wall.outer_m = surface.r_m;
        let mut kinks_m = kinks_m(actuator);
        wall.kinks =
            [(); 2].map(|()| wall.place(kinks_m.next().unwrap_or(parameters.inner_radius_m)).r_m / surface.r_m);
        let Moves { u, v, slopes: [u_z, v_z, _], .. } = wall.about(&surface);
        wall.shift = [u - v, u_z - v_z].map(|twice| twice * 0.5);
        wall
    }

    fn windings(&self) -> impl Iterator<Item = &'a Fiber<f64>> + use<'a, S, N> {
        self.windings.into_iter().flatten()
    }

    /// Twice the energy of a length.
    fn form(&self) -> SMatrix<f64, N, N> {
        let (inner, outer) = (self.parameters.inner_radius_m, self.parameters.outer_radius_m);
        let mut form = Form(SMatrix::zeros());
        for (rest_m, weight) in self.zones(inner, outer, &|fiber| fiber.radius_m) {
            let place = self.place(rest_m);
            self.add_elastomer(&mut form, &place, self.radial_pa(rest_m), weight);
            for fiber in self.windings().filter(|fiber| fills(fiber, rest_m)) {
                for angle in angles(fiber) {
                    let strain = self.thread(angle, &place).strain;
                    let [tension, stiffness] = [2.0 * strain, 1.0].map(|by| by * fiber.modulus_pa * weight);
                    self.add_thread(&mut form, angle, &place, tension, stiffness);
                }
            }
        }
        for fiber in self.windings().filter(|fiber| fiber.placement == Placement::Sheet) {
            let at_m = self.sheet_m(fiber);
            let place = self.place(at_m);
            let stiffness = fiber.modulus_pa * fiber.thickness_m * at_m;
            for angle in angles(fiber) {
                self.add_thread(&mut form, angle, &place, self.sheet_n_per_m(fiber, angle) * at_m, stiffness);
            }
        }
        self.add_lumen(&mut form);
        (form.0 + form.0.transpose()) * PI
    }

    /// Radii at rest between two, m, with `R dR`, by zones that end where one of the windings does.
    fn zones(
        &self,
        from_m: f64,
        to_m: f64,
        ends_m: &dyn Fn(&Fiber<f64>) -> f64,
    ) -> impl Iterator<Item = (f64, f64)> + use<S, N> {
        let end = |winding: Option<&Fiber<f64>>| winding.map_or(to_m, |fiber| ends_m(fiber).clamp(from_m, to_m));
        let [a, b] = self.windings.map(end);
        let (first, second) = (a.min(b), a.max(b));
        rule(from_m, first).chain(rule(first, second)).chain(rule(second, to_m))
    }

    fn sheet_m(&self, sheet: &Fiber<f64>) -> f64 {
        sheet.radius_m.clamp(self.parameters.inner_radius_m, self.parameters.outer_radius_m)
    }

    /// Twice the slope of the energy of a family of a sheet by `I4`, N/m.
    fn sheet_n_per_m(&self, sheet: &Fiber<f64>, angle: [f64; 2]) -> f64 {
        let at_m = self.sheet_m(sheet);
        let place = self.place(at_m);
        if self.windings[1].is_some() {
            return 2.0 * self.thread(angle, &place).strain * sheet.modulus_pa * sheet.thickness_m;
        }
        // The jump of the radial stress is what a single sheet carries; as a product of a small strain and a large modulus it would be rounding.
        let jump = (self.inwards_pa(at_m) - self.outwards_pa(at_m)) / place.slope;
        jump / angles(sheet).map(|angle| self.thread(angle, &place).pull_per_m).sum::<f64>()
    }

    fn place(&self, rest_m: f64) -> Place {
        let inner = self.parameters.inner_radius_m;
        let r_m = (self.lumen_m * self.lumen_m + (rest_m * rest_m - inner * inner) / self.stretch).sqrt();
        let slope = rest_m / (r_m * self.stretch);
        let squares = [slope, r_m / rest_m, r_m * self.twist, self.stretch].map(|entry| entry * entry);
        let excess = squares.iter().sum::<f64>() - 3.0;
        let energy = match self.parameters.material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0],
            Material::Yeoh { c_pa: [first, second, third] } => {
                [first + excess * (2.0 * second + 3.0 * third * excess), 2.0 * second + 6.0 * third * excess]
            }
        };
        Place { rest_m, r_m, slope, energy }
    }

    /// Radial stress at a radius at rest, Pa.
    fn radial_pa(&self, rest_m: f64) -> f64 {
        let is_within = |fiber: &&Fiber<f64>| fiber.placement == Placement::Sheet && rest_m > fiber.radius_m;
        match self.windings {
            [Some(sheet), None] if is_within(&sheet) => self.inwards_pa(rest_m),
            _ => {
                self.outwards_pa(rest_m)
                    + self.windings().filter(is_within).map(|sheet| self.jump_pa(sheet)).sum::<f64>()
            }
        }
    }

    /// By how much the radial stress rises at a sheet, Pa.
    fn jump_pa(&self, sheet: &Fiber<f64>) -> f64 {
        let place = self.place(self.sheet_m(sheet));
        let of = |angle| self.sheet_n_per_m(sheet, angle) * self.thread(angle, &place).pull_per_m;
        place.slope * angles(sheet).map(of).sum::<f64>()
    }

    /// The radial stress from the lumen outwards, and from the outer face inwards: they differ by what sheets between them carry.
    fn outwards_pa(&self, rest_m: f64) -> f64 {
        -self.pressure_pa + self.rise_pa(self.parameters.inner_radius_m, rest_m)
    }

    fn inwards_pa(&self, rest_m: f64) -> f64 {
        -self.rise_pa(rest_m, self.parameters.outer_radius_m)
    }

    /// By how much the radial stress rises between two radii at rest, Pa, without sheets.
    fn rise_pa(&self, from_m: f64, to_m: f64) -> f64 {
        let begins_m = |fiber: &Fiber<f64>| if fiber.placement == Placement::Layer { fiber.radius_m } else { from_m };
        let of = |(rest_m, weight): (f64, f64)| {
            let place = self.place(rest_m);
            let around = (place.r_m / rest_m).powi(2) + (place.r_m * self.twist).powi(2);
            let wall_pa = 2.0 * place.energy[0] * (around - place.slope * place.slope);
            let filling = self.windings().filter(|fiber| fills(fiber, rest_m));
            let threads = filling.flat_map(|fiber| angles(fiber).map(move |angle| (fiber, angle)));
            let threads_pa = threads.map(|(fiber, angle)| {
                let thread = self.thread(angle, &place);
                2.0 * fiber.modulus_pa * thread.strain * thread.along[1] * thread.along[1]
            });
            (wall_pa + threads_pa.sum::<f64>()) * place.slope / place.r_m * weight / rest_m
        };
        self.zones(from_m, to_m, &begins_m).map(of).sum()
    }

    /// What a unit of each unknown moves at a radius, without the way of the axis: the middle of the outer surface stays.
    fn moves(&self, place: &Place) -> Moves<N> {
        let mut moves = self.about(place);
        let [shift, shift_z] = self.shift;
        (moves.u, moves.v) = (moves.u - shift, moves.v + shift);
        let [u_z, v_z, w_z] = &mut moves.slopes;
        (*u_z, *v_z) = (*u_z - shift_z, *v_z + shift_z);
        moves.along = [
            moves.around * self.twist - *u_z,
            moves.around * self.twist - *v_z,
            moves.w * self.twist - *w_z - moves.bend * place.r_m,
        ];
        moves
    }

    fn about(&self, place: &Place) -> Moves<N> {
        let (r, outer_m) = (place.r_m, self.outer_m);
        let x = r / outer_m;
        // Of five functions the last counts in a wall with a second kink.
        let functions = (S - 1) / 2;
        let row = |own: [f64; FUNCTIONS + 1], at: usize| {
            let mut row = Row::<N>::zeros();
            row.as_mut_slice()[at..][..functions].copy_from_slice(&own[..functions]);
            row
        };
        let slope = |row: &Row<N>| {
            let mut slope = Row::<N>::zeros();
            slope.as_mut_slice()[S..].copy_from_slice(&row.as_slice()[..N - S]);
            slope
        };
        let [beyond, further] = self.kinks.map(|kink| f64::from(x > kink));
        let (y, z) = (beyond * (x - self.kinks[0]), further * (x - self.kinks[1]));
        let bend = Row::from_fn(|index, _| f64::from(index == 0));
        let u: Row<N> = row([x * x, 1.0 / (x * x), x.ln(), y * y, z * z], 1);
        let u_r = row([2.0 * x, -2.0 / x.powi(3), 1.0 / x, 2.0 * y, 2.0 * z], 1) / outer_m;
        let u_rr = row([2.0, 6.0 / x.powi(4), -1.0 / (x * x), 2.0 * beyond, 2.0 * further], 1) / (outer_m * outer_m);
        let w = row([x, x.powi(3), 1.0 / x, y, z], 1 + functions);
        let w_r = row([1.0, 3.0 * x * x, -1.0 / (x * x), beyond, further], 1 + functions) / outer_m;
        // The volume stays.
        let [bend_z, u_z, w_z, u_rz, w_rz] = [&bend, &u, &w, &u_r, &w_r].map(slope);
        let around = (bend * (r * r) + w_z * r) / self.stretch - u_r * r;
        let around_r = (bend * (2.0 * r) + w_z + w_rz * r) / self.stretch - u_r - u_rr * r;
        // A slope of a slope is that of a turning frame alone.
        let around_z = (bend_z * (r * r) + w * (self.turn * self.turn * r)) / self.stretch - u_rz * r;
        let slopes = [u_z, around_z - u_z, w_z];
        let by_radius = [u_r, around_r - u_r, w_r].map(|slope| slope * place.slope);
        Moves { bend, u, v: around - u, w, around, by_radius, along: [Row::zeros(); 3], slopes }
    }

    fn add_elastomer(&self, form: &mut Form<N>, place: &Place, radial_pa: f64, weight: f64) {
        let Place { rest_m, r_m: r, slope, energy } = *place;
        let Moves { u, v, w, around, by_radius: [u_r, v_r, w_r], along: [out, turned, along], .. } = &self.moves(place);
        let (hoop, twist) = (r / rest_m, self.twist * r);
        let elastic = energy[0] * weight;
        let per_area = elastic / (rest_m * rest_m);
        // The wall's own pressure times the change of its volume to second order.
        let volume = (radial_pa - 2.0 * energy[0] * slope * slope) * weight;
        let per_length = volume / rest_m;
        // One product a row, with all that multiplies it.
        form.add(u_r, &(u_r * elastic + (around * self.stretch - w * twist) * per_length + along * (volume * hoop)));
        form.add(v_r, &(v_r * elastic));
        form.add(w_r, &(w_r * elastic + out * (volume * hoop)));
        for row in [out, turned, along] {
            form.add(row, &(row * elastic));
        }
        let carried = (v_r * self.stretch - w_r * twist + along * slope) * per_length;
        form.add(around, &(around * (2.0 * per_area) + carried));
        form.add(w, &(w * per_area - turned * (per_length * slope)));
        form.add_bend(
            &((v - u) * (2.0 * elastic * self.stretch + volume / self.stretch) - w * (2.0 * elastic * twist)),
        );
        if energy[1] != 0.0 {
            let first = u_r * slope + around * (hoop / rest_m) + turned * twist + along * self.stretch;
            form.add(&first, &(first * (2.0 * energy[1] * weight)));
        }
    }

    /// A thread at an angle from the hoop: its direction now, its `I4 - 1`, and its pull outwards per length.
    fn thread(&self, [cos, sin]: [f64; 2], place: &Place) -> Thread {
        let hoop = place.r_m / place.rest_m * cos + self.twist * place.r_m * sin;
        let along = [0.0, hoop, self.stretch * sin];
        let by_radius = cos / place.rest_m + self.twist * sin;
        Thread { along, strain: hoop * hoop + along[2] * along[2] - 1.0, pull_per_m: hoop * by_radius }
    }

    /// Adds threads with twice the slope and with the curvature of their energy by `I4`.
    fn add_thread(&self, form: &mut Form<N>, angle: [f64; 2], place: &Place, tension: f64, stiffness: f64) {
        let [cos, sin] = angle;
        let [_, hoop, axial] = self.thread(angle, place).along;
        let Moves { u, v, w, around, along: [out, turned, along], .. } = &self.moves(place);
        let [around, w_around] = [around, w].map(|row| row * (cos / place.rest_m));
        let (outwards, sideways, lengthwise) = (around + out * sin, around + turned * sin, w_around + along * sin);
        for row in [outwards, sideways, lengthwise] {
            form.add(&row, &(row * (0.5 * tension)));
        }
        form.add_bend(&(((v - u) * axial - w * hoop) * (tension * sin)));
        let first = sideways * hoop + lengthwise * axial;
        form.add(&first, &(first * (2.0 * stiffness)));
    }

    /// Less the work of the lumen's pressure.
    fn add_lumen(&self, form: &mut Form<N>) {
        let inner = self.place(self.parameters.inner_radius_m);
        let Moves { bend, u, around, slopes: [_, _, w_z], .. } = &self.moves(&inner);
        let p = self.pressure_pa;
        form.add(around, &(around * (-0.5 * p * self.stretch)));
        form.add(u, &((bend * inner.r_m + w_z) * (p * inner.r_m)));
    }
}

struct Thread {
    along: [f64; 3],
    strain: f64,
    pull_per_m: f64,
}

/// Cosine and sine of the angle of each family.
fn angles(fiber: &Fiber<f64>) -> impl Iterator<Item = [f64; 2]> + use<> {
    let (sin, cos) = fiber.angle_rad.sin_cos();
    let signs: &[f64] = if fiber.families == Families::Two { &[1.0, -1.0] } else { &[1.0] };
    signs.iter().map(move |sign| [cos, sign * sin])
}

/// Whether the wall has threads through it at a radius at rest.
fn fills(fiber: &Fiber<f64>, rest_m: f64) -> bool {
    match fiber.placement {
        Placement::Sheet => false,
        Placement::Layer => rest_m >= fiber.radius_m,
        Placement::Smeared => true,
    }
}

/// Radii at rest between two, m, with `R dR`; none where they are equal.
fn rule(from_m: f64, to_m: f64) -> impl Iterator<Item = (f64, f64)> {
    let (middle, half) = (0.5 * (from_m + to_m), 0.5 * (to_m - from_m));
    GAUSS_6.iter().filter(move |_| half > 0.0).map(move |(x, weight)| {
        let rest_m = middle + half * x;
        (rest_m, weight * half * rest_m)
    })
}

#[cfg(test)]
mod tests;
