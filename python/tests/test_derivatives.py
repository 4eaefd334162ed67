"""Derivatives, stiffness and windings against differences and equivalent actuators."""

import numpy as np
import pytest

from softlimb import Fiber, InvalidParameter, Model, NeoHookean, Status

THREAD = dict(modulus_pa=2e7, thickness_m=2e-4)
STATE = ("axial_stretch", "inner_radius_m", "outer_radius_m", "twist_rad", "bend_angle_rad", "volume_m3")


@pytest.mark.parametrize(
    ("motion", "of", "value"),
    [
        ("extension", "outer_radius_m", 8e-3),
        ("extension", "fiber.angle_rad", 0.4),
        ("twisting", "fiber.angle_rad", 0.4),
        ("twisting", "fiber.modulus_pa", 2e7),
        ("expansion", "material.shear_modulus_pa", 0.2e6),
        ("bending", "outer_radius_m", 8e-3),
        ("bending", "length_m", 0.1),
    ],
)
def test_derivatives_are_the_limits_of_differences(tube, motion, of, value):
    families = {"extension": 2, "twisting": 1}.get(motion)

    def made(step):
        angle, modulus = (value + step if of == f"fiber.{name}" else other for name, other in (("angle_rad", 0.4), ("modulus_pa", 2e7)))
        # The winding stays where it is while the outer radius changes.
        winding = Fiber(angle_rad=angle, families=families or 2, modulus_pa=modulus, thickness_m=2e-4, radius_m=7e-3)
        changes = {of: value + step} if of.endswith("_m") else {}
        if of == "material.shear_modulus_pa":
            changes = {"material": NeoHookean(shear_modulus_pa=value + step)}
        return tube(motion=motion, fiber=winding if families else None, **changes)

    pressures = np.array([4e3, 1.2e4])
    exact = made(0.0).sensitivity(of, pressure_pa=pressures)
    step = 1e-5 * value
    ahead, behind = made(step).forward(pressures), made(-step).forward(pressures)
    assert exact.status.tolist() == [Status.OK] * 2
    for name in STATE:
        difference = (getattr(ahead, name) - getattr(behind, name)) / (2 * step)
        size = np.abs(getattr(ahead, name)) / value
        assert np.all(np.abs(getattr(exact, name) - difference) <= 1e-7 * size + 1e-6 * np.abs(difference)), name
    assert exact.pressure_pa.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("pair", [False, True])
def test_winding_at_the_outside_follows_the_outer_radius(tube, pair):
    made = [Fiber(angle_rad=angle, families=1 if pair else 2, **THREAD) for angle in (0.4, 1.2)]
    fiber = tuple(made) if pair else made[0]
    exact = tube(fiber=fiber).sensitivity("outer_radius_m", pressure_pa=1e4)
    ahead, behind = (tube(fiber=fiber, outer_radius_m=8e-3 + step).forward(1e4) for step in (1e-8, -1e-8))
    difference = (ahead.axial_stretch - behind.axial_stretch) / 2e-8
    np.testing.assert_allclose(exact.axial_stretch, difference, rtol=1e-6)


def test_pressure_follows_where_the_deformation_is_kept(tube):
    step, angle = 1e-7, np.radians([20.0, 60.0])
    exact = tube(motion="bending").sensitivity("inner_radius_m", bend_angle_rad=angle)
    ahead, behind = (tube(motion="bending", inner_radius_m=6e-3 + d).inverse(bend_angle_rad=angle) for d in (step, -step))
    np.testing.assert_allclose(exact.pressure_pa, (ahead.pressure_pa - behind.pressure_pa) / (2 * step), rtol=1e-6)
    assert np.abs(exact.bend_angle_rad).max() < 1e-9


def test_what_an_actuator_does_not_have_is_no_input(tube):
    with pytest.raises(InvalidParameter, match="fiber.angle_rad"):
        tube().sensitivity("fiber.angle_rad", pressure_pa=1e4)
    with pytest.raises(InvalidParameter, match="inner_radius_m, outer_radius_m"):
        tube().sensitivity("inner_radius", pressure_pa=1e4)


def test_stiffness_and_lever_arms_are_the_limits_of_differences(tube):
    actuator = tube(motion="twisting", fiber=Fiber(angle_rad=0.5, families=1, **THREAD))
    at = dict(axial_stretch=1.02, twist_rad=-0.1)
    blocked = actuator.blocked_force(2e4, **at)
    pull, turn = 1e-6, 1e-6

    def loads(pressure=2e4, **changes):
        found = actuator.blocked_force(pressure, **{**at, **changes})
        return np.array([found.force_n, found.torque_nm])

    # By the length, which is 0.1 m times the stretch; by the twist; by the pressure.
    by_length = (loads(axial_stretch=1.02 + pull) - loads(axial_stretch=1.02 - pull)) / (2 * pull * 0.1)
    by_twist = (loads(twist_rad=-0.1 + turn) - loads(twist_rad=-0.1 - turn)) / (2 * turn)
    np.testing.assert_allclose(blocked.stiffness, np.stack([by_length, by_twist], axis=-1), rtol=1e-5)
    np.testing.assert_allclose(blocked.by_pressure, (loads(2e4 + 1) - loads(2e4 - 1)) / 2, rtol=1e-6)


def test_two_mirrored_windings_are_one_of_two_families(tube):
    pair = tuple(Fiber(angle_rad=angle, families=1, **THREAD) for angle in (0.4, -0.4))
    one = Fiber(angle_rad=0.4, families=2, **THREAD)
    pressures = [5e3, 2e4]
    two, both = tube(fiber=pair).forward(pressures), tube(fiber=one).forward(pressures)
    np.testing.assert_allclose(two.axial_stretch, both.axial_stretch, rtol=1e-10)
    assert np.abs(two.twist_rad).max() < 1e-9
    # With its mirror image gone, a family twists the tube.
    alone = tube(fiber=(pair[0], Fiber(angle_rad=np.pi / 2, families=1, **THREAD))).forward(pressures)
    assert np.all(np.abs(alone.twist_rad) > 1e-3)


def test_second_winding_is_named_in_errors(tube):
    pair = (Fiber(angle_rad=0.4, families=1, **THREAD), Fiber(angle_rad=[0.1, 2.0], families=1, **THREAD))
    with pytest.raises(InvalidParameter) as caught:
        tube(fiber=pair)
    assert (caught.value.field, caught.value.index) == ("fiber[1].angle_rad", (1,))
    with pytest.raises(InvalidParameter, match=r"fiber\[1\].angle_rad"):
        tube(fiber=pair[0]).sensitivity("fiber[1].angle_rad", pressure_pa=1e4)


def helix_and_axial(tube, angle=0.5, axial=np.pi / 2):
    windings = (Fiber(angle_rad=turn, families=1, **THREAD) for turn in (angle, axial))
    return tube(motion="twisting", fiber=tuple(windings))


def test_blocked_loads_of_two_windings(tube):
    pair = tuple(Fiber(angle_rad=angle, families=1, **THREAD) for angle in (0.4, -0.4))
    one = Fiber(angle_rad=0.4, families=2, **THREAD)
    at = dict(axial_stretch=[0.99, 1.03], twist_rad=0.2)
    two, both = (tube(fiber=fiber).blocked_force(2e4, **at) for fiber in (pair, one))
    assert two.status.tolist() == [Status.OK] * 2
    for name in ("force_n", "torque_nm", "by_pressure", "stiffness", "volume_m3"):
        expected = getattr(both, name)
        np.testing.assert_allclose(getattr(two, name), expected, rtol=1e-8, atol=1e-9 * np.abs(expected).max(), err_msg=name)
    # Free ends carry nothing.
    rod = helix_and_axial(tube)
    free = rod.forward(2e4)
    held = rod.blocked_force(2e4, axial_stretch=free.axial_stretch, twist_rad=free.twist_rad)
    stiff = rod.blocked_force(2e4)
    assert abs(held.force_n) < 1e-7 * abs(stiff.force_n) and abs(held.torque_nm) < 1e-7 * abs(stiff.torque_nm)


def test_derivatives_by_either_winding_are_the_limits_of_differences(tube):
    step = 1e-5
    for of, ahead, behind in (
        ("fiber[0].angle_rad", dict(angle=0.5 + step), dict(angle=0.5 - step)),
        ("fiber.angle_rad", dict(angle=0.5 + step), dict(angle=0.5 - step)),
        ("fiber[1].angle_rad", dict(axial=1.5 + step), dict(axial=1.5 - step)),
    ):
        exact = helix_and_axial(tube, axial=1.5 if "1" in of else np.pi / 2).sensitivity(of, pressure_pa=2e4)
        whole = dict(axial=1.5) if "1" in of else {}
        ahead, behind = (helix_and_axial(tube, **{**whole, **changed}).forward(2e4) for changed in (ahead, behind))
        for name in ("axial_stretch", "twist_rad", "volume_m3"):
            difference = (getattr(ahead, name) - getattr(behind, name)) / (2 * step)
            assert getattr(exact, name) == pytest.approx(difference, rel=1e-5), (of, name)
            assert difference != 0


def test_finite_elements_and_all_solutions_know_both_windings(tube):
    rod = helix_and_axial(tube)
    analytic, elements = (rod.forward(2e4, model=model) for model in ("analytic", "section-fe"))
    assert elements.model == Model.SECTION_FE
    assert elements.twist_rad == pytest.approx(analytic.twist_rad, rel=1e-5)
    found = rod.inverse_all(twist_rad=analytic.twist_rad, pressure_range_pa=(0, 1e5))
    assert found.count == 1 and found.pressure_pa[..., 0] == pytest.approx(2e4, rel=1e-8)


def test_leaning_windings_of_benders_agree_with_finite_elements(tube):
    bender = tube(motion="bending", fiber=Fiber(angle_rad=np.radians(20), families=2, modulus_pa=3.6e8, thickness_m=1.8e-4))
    analytic = bender.forward(2e4, model="analytic")
    elements = bender.forward(2e4, model="section-fe")
    assert (analytic.model, elements.model) == (Model.ANALYTIC, Model.SECTION_FE)
    difference = abs(analytic.bend_angle_rad / elements.bend_angle_rad - 1)
    assert difference <= analytic.model_error + elements.discretisation_error
    # As a hoop it would bend farther.
    assert tube(motion="bending").forward(2e4).bend_angle_rad > 1.1 * elements.bend_angle_rad
