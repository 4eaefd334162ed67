"""The actuator model against closed forms, and the interface against itself."""

import pickle

import numpy as np
import pytest

import softlimb
from softlimb import Fiber, InvalidParameter, NeoHookean, Status, Yeoh

MU = 0.2e6

def wall_pressure(inner_m, outer_m, inner, stretch, mu):
    """Pressure of a bare neo-Hookean tube at a deformed inner radius and stretch, and the axial force of its closed end, both of the
    textbook's integrals over the wall (Rivlin): P = int mu (a^2 - 1/(a l)^2) / (a ...) dR, by Gauss quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    radius = 0.5 * (outer_m + inner_m) + 0.5 * (outer_m - inner_m) * nodes
    weights = 0.5 * (outer_m - inner_m) * weights
    deformed = np.sqrt(inner**2 + (radius**2 - inner_m**2) / stretch)
    hoop, radial = deformed / radius, radius / (deformed * stretch)
    pressure = np.sum(weights * mu * (hoop**2 - radial**2) * radius / (stretch * deformed**2))
    # Reduced axial force with closed ends: int (2 s_z - s_r - s_h) pi r dr = 0.
    reduced = np.sum(weights * mu * np.pi * (2 * stretch**2 - radial**2 - hoop**2) * radius / stretch)
    return pressure, reduced


def test_bare_tube_satisfies_the_integrals_over_its_wall(tube):
    solution = tube().forward(np.linspace(1e3, 2e4, 7))
    assert solution.ok.all()
    for p, r, l in zip(solution.pressure_pa, solution.inner_radius_m, solution.axial_stretch, strict=True):
        pressure, force = wall_pressure(6e-3, 8e-3, r, l, MU)
        assert pressure == pytest.approx(p, rel=1e-10)
        assert abs(force) < 1e-9 * MU * 8e-3**2


def test_volume_of_the_wall_is_kept(tube):
    solution = tube(material=Yeoh(c1_pa=86560, c2_pa=13805, c3_pa=-1466.1)).forward([5e3, 1e4])
    area = np.pi * (solution.outer_radius_m**2 - solution.inner_radius_m**2) * solution.axial_stretch
    np.testing.assert_allclose(area, np.pi * (8e-3**2 - 6e-3**2), rtol=1e-12)


def test_actuators_and_pressures_broadcast(tube):
    radii = np.linspace(7.5e-3, 9e-3, 5).reshape(5, 1)
    pressures = np.linspace(1e3, 1.2e4, 40)
    many = tube(outer_radius_m=radii).forward(pressures)
    assert many.shape == (5, 40)
    for i, radius in enumerate(radii[:, 0]):
        one = tube(outer_radius_m=radius)
        for j in (0, 17, 39):
            np.testing.assert_allclose(many.axial_stretch[i, j], one.forward(pressures[j]).axial_stretch, rtol=1e-12)


def test_many_are_answered_as_one_by_one(tube):
    radii = np.linspace(7.5e-3, 9e-3, 3000)
    many = tube(outer_radius_m=radii).forward(8e3)
    for i in (0, 1, 511, 512, 1777, 2999):
        np.testing.assert_allclose(many.volume_m3[i], tube(outer_radius_m=radii[i]).forward(8e3).volume_m3, rtol=1e-11)


def test_motions_in_one_array_are_answered_as_one_by_one(tube):
    """Rows of several parts, each with bending and straight actuators that do not begin at the first one."""
    motions = np.where(np.arange(70) % 3 == 0, "extension", "bending")
    radii = np.linspace(7e-3, 9.5e-3, 70)
    thread = Fiber(angle_rad=np.where(np.arange(70) % 2 == 0, 0.0, 0.05), families=2, modulus_pa=2e7, thickness_m=2e-4)
    mixed = tube(motion=motions, outer_radius_m=radii, fiber=thread)
    pressures = np.linspace(2e3, 9e3, 20).reshape(20, 1)
    many = mixed.forward(pressures, model="analytic")
    bent = tube(motion="bending", outer_radius_m=radii, fiber=thread)
    back = bent.inverse(bend_angle_rad=bent.forward(pressures, model="analytic").bend_angle_rad, model="analytic")
    np.testing.assert_allclose(back.pressure_pa, np.broadcast_to(pressures, (20, 70)), rtol=1e-10)
    for i in (0, 1, 2, 33, 68, 69):
        own = Fiber(angle_rad=thread.angle_rad[i], families=2, modulus_pa=2e7, thickness_m=2e-4)
        one = tube(motion=str(motions[i]), outer_radius_m=radii[i], fiber=own)
        for j in (0, 7, 19):
            single = one.forward(pressures[j, 0], model="analytic")
            for name in ("bend_angle_rad", "axial_stretch", "volume_m3", "compliance_m3_per_pa", "model_error"):
                np.testing.assert_allclose(getattr(many, name)[j, i], getattr(single, name), rtol=1e-10, err_msg=name)


def test_bad_target_among_many_is_named(tube):
    targets = np.full(1200, 0.3)
    targets[[530, 1100]] = -0.1, -0.2
    with pytest.raises(InvalidParameter) as caught:
        tube(motion="bending").inverse(bend_angle_rad=targets)
    assert (caught.value.field, caught.value.index, caught.value.value) == ("bend_angle_rad", (530,), -0.1)
    with pytest.raises(InvalidParameter) as caught:
        tube(motion="bending", outer_radius_m=np.full(600, 8e-3)).inverse(bend_angle_rad=targets[530:].reshape(-1, 1)[:3])
    assert (caught.value.field, caught.value.index) == ("bend_angle_rad", (0, 0))


WALL = {"motion": "extension", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.1, "material": NeoHookean(shear_modulus_pa=MU)}


def once(pressure_pa, **fields):
    """The answer of an actuator that is asked once, and of one that is built."""
    others = {name: fields.pop(name) for name in ("external_force_n", "external_torque_nm", "model") if name in fields}
    built = softlimb.Actuator(**{**WALL, **fields}).forward(pressure_pa, **others)
    return softlimb.Actuator.forward_once(pressure_pa, **{**WALL, **fields}, **others), built


@pytest.mark.parametrize(
    "fields",
    [
        {"outer_radius_m": np.linspace(7.5e-3, 9e-3, 700).reshape(100, 7)},
        {"motion": ["twisting", "extension"], "fiber": Fiber(angle_rad=0.3, families=[[1], [2]], modulus_pa=2e7, thickness_m=2e-4)},
        {"material": Yeoh(c1_pa=86560, c2_pa=13805, c3_pa=-1466.1), "external_force_n": [[0.5], [1.0]]},
        {"motion": ["bending", "extension"], "inner_radius_m": [[5e-3], [6e-3]]},
        {"fiber": [Fiber(angle_rad=a, families=1, modulus_pa=2e7, thickness_m=1e-4) for a in (0.4, 1.5)], "motion": "twisting"},
        {"motion": "bending", "model": "section-fe"},
        {"material": "Dragon Skin 30"},
    ],
)
def test_asked_once_is_answered_as_built(fields):
    rows = np.shape(fields.get("outer_radius_m", 0.0))[-1:] or (2,)
    found, built = once(np.linspace(4e3, 9e3, rows[0]), **fields)
    assert found.shape == built.shape and (found.status == built.status).all() and found.ok.all()
    for name in ("pressure_pa", "axial_stretch", "outer_radius_m", "twist_rad", "bend_angle_rad", "volume_m3"):
        np.testing.assert_allclose(getattr(found, name), getattr(built, name), rtol=1e-13, err_msg=name)
    np.testing.assert_allclose(found.compliance_m3_per_pa, built.compliance_m3_per_pa, rtol=1e-11)
    assert found.model.tolist() == built.model.tolist()


def test_asked_once_refuses_what_is_refused_when_built():
    found, built = once([1e3, 1e6])
    assert found.status.tolist() == built.status.tolist() == [Status.OK, Status.NO_SOLUTION]
    for fields, pressure_pa, field, index in (
        ({"outer_radius_m": [[8e-3], [5e-3]]}, [1e3, 2e3, 3e3], "outer_radius_m", (1, 0)),
        ({"length_m": -1.0}, [1e3, 2e3], "length_m", ()),
        ({"external_force_n": [[0.0], [np.nan]]}, [1e3, 2e3], "external_force_n", (1, 0)),
        ({}, [1e3, np.nan], "pressure_pa", (1,)),
    ):
        for ask in (once, lambda p, **given: softlimb.Actuator.forward_once(p, **{**WALL, **given})):
            with pytest.raises(InvalidParameter) as caught:
                ask(pressure_pa, **fields)
            assert (caught.value.field, caught.value.index) == (field, index)


def test_inverse_undoes_forward(tube):
    bender = tube(motion="bending")
    pressures = np.linspace(5e3, 4e4, 9)
    back = bender.inverse(bend_angle_rad=bender.forward(pressures).bend_angle_rad)
    np.testing.assert_allclose(back.pressure_pa, pressures, rtol=1e-10)


def test_effect_of_the_winding_is_that_of_the_batch():
    wall = {"motion": "bending", "inner_radius_m": 6e-3, "outer_radius_m": 8e-3, "length_m": 0.1, "material": NeoHookean(shear_modulus_pa=MU)}
    helices = Fiber(angle_rad=np.radians([20.0, 12.0, -20.0]), families=2, modulus_pa=3.61e8, thickness_m=0.178e-3)
    # winding_2deg of `softlimb eval --batch` for 20 and 12 deg.
    effect = softlimb.Actuator(**wall, fiber=helices).winding_effect(3e4)
    assert effect == pytest.approx([0.07363046, 0.02618564, 0.07363046], rel=1e-6)
    with pytest.raises(ValueError, match="bending actuators with a winding"):
        softlimb.Actuator(**wall).winding_effect(3e4)
    with pytest.raises(softlimb.InvalidParameter, match="pressure_pa"):
        softlimb.Actuator(**wall, fiber=helices).winding_effect([0.0, 3e4])
    steep = Fiber(angle_rad=np.radians(89.5), families=2, modulus_pa=3.61e8, thickness_m=0.178e-3)
    # 91.5 deg are -88.5 deg; winding_2deg of the batch again.
    assert softlimb.Actuator(**wall, fiber=steep).winding_effect(3e4) == pytest.approx(9.119529, rel=1e-6)


def test_blocked_force_is_the_load_that_holds_the_end(tube):
    actuator = tube(fiber=Fiber(angle_rad=0.05, families=2, modulus_pa=2e7, thickness_m=2e-4))
    blocked = actuator.blocked_force(2e4)
    held = actuator.forward(2e4, external_force_n=blocked.force_n, external_torque_nm=blocked.torque_nm)
    assert blocked.force_n < 0
    np.testing.assert_allclose(held.axial_stretch, 1.0, atol=1e-10)


def test_no_solution_is_a_status_and_nan(tube):
    solution = tube().forward([1e3, 1e6])
    assert solution.status.dtype == np.int8
    assert solution.status.tolist() == [Status.OK, Status.NO_SOLUTION]
    assert np.isnan(solution.axial_stretch).tolist() == [False, True]


@pytest.mark.parametrize(
    ("changes", "field", "index"),
    [
        ({"outer_radius_m": [8e-3, 5e-3]}, "outer_radius_m", (1,)),
        ({"length_m": np.nan}, "length_m", ()),
        ({"motion": ["bending", "bends"]}, "motion", (1,)),
        ({"fiber": Fiber(angle_rad=2.0, families=2, modulus_pa=1e6, thickness_m=1e-4)}, "fiber.angle_rad", ()),
        ({"fiber": Fiber(angle_rad=0.1, families=2, modulus_pa=1e6)}, "fiber.thickness_m", ()),
        ({"material": NeoHookean(shear_modulus_pa=[[1e5], [-1.0]])}, "material.shear_modulus_pa", (1, 0)),
    ],
)
def test_bad_parameters_name_field_index_and_range(changes, field, index, tube):
    with pytest.raises(InvalidParameter) as caught:
        tube(**changes)
    assert (caught.value.field, caught.value.index) == (field, index)
    assert caught.value.allowed and isinstance(caught.value, ValueError)


def test_bad_pressure_is_named_in_its_own_array(tube):
    with pytest.raises(InvalidParameter) as caught:
        tube(outer_radius_m=np.full((4, 1), 8e-3)).forward([1e3, 2e3, np.inf])
    assert (caught.value.field, caught.value.index) == ("pressure_pa", (2,))


def test_castable_elastomers_are_known_by_name(tube):
    names = [elastomer.name for elastomer in softlimb.castable_elastomers()]
    assert "Dragon Skin 30" in names
    assert tube(material=names).forward(1e2).shape == (len(names),)
    with pytest.raises(ValueError, match="did you mean"):
        tube(material="Dragon Skin 3O")


def test_actuators_are_frozen_and_travel(tube):
    actuator = tube()
    with pytest.raises(AttributeError):
        actuator.length_m = 1.0
    again = pickle.loads(pickle.dumps(actuator))
    assert again.forward(1e4).axial_stretch == actuator.forward(1e4).axial_stretch


def test_interpreter_is_free_while_answers_are_computed(tube, counted_during):
    bender, pressures_pa = tube(motion="bending"), np.linspace(1e3, 4e4, 200_000)
    # With the lock held for the whole call, the other thread could take a turn or two around it.
    assert counted_during(lambda: bender.forward(pressures_pa)) > 10


def test_every_motion_is_undone(tube):
    helix = Fiber(angle_rad=0.5, families=1, modulus_pa=2e7, thickness_m=2e-4)
    for motion, fiber, target in [
        ("extension", None, "axial_stretch"),
        ("expansion", None, "outer_radius_m"),
        ("twisting", helix, "twist_rad"),
        ("bending", None, "bend_angle_rad"),
    ]:
        actuator = tube(motion=motion, fiber=fiber)
        there = actuator.forward([3e3, 9e3])
        back = actuator.inverse(**{target: getattr(there, target)})
        np.testing.assert_allclose(back.pressure_pa, [3e3, 9e3], rtol=1e-9)


def test_exactly_one_target_is_taken(tube):
    for targets in ({}, {"axial_stretch": 1.1, "twist_rad": 0.0}):
        with pytest.raises(TypeError, match="exactly one of axial_stretch"):
            tube().inverse(**targets)
    with pytest.raises(InvalidParameter, match="bend_angle_rad"):
        tube().inverse(bend_angle_rad=0.5)


@pytest.mark.parametrize("kind", [list, tuple, np.float32, np.int64, "strided", "empty"])
def test_any_array_of_numbers_will_do(tube, kind):
    numbers = [1000, 2000, 4000]
    if kind == "strided":
        given = np.repeat(np.array(numbers, dtype=float), 2)[::2]
    elif kind == "empty":
        given, numbers = np.empty((0, 3)), []
    else:
        given = kind(numbers) if kind in (list, tuple) else np.array(numbers, dtype=kind)
    found = tube().forward(given)
    assert found.shape == np.shape(given)
    np.testing.assert_array_equal(found.pressure_pa.ravel(), numbers)


def test_words_are_no_numbers(tube):
    with pytest.raises(InvalidParameter, match="pressure_pa"):
        tube().forward("1 kPa")
    with pytest.raises(ValueError, match=r"the actuators \(2,\), pressure_pa \(3,\)"):
        tube(length_m=[0.1, 0.2]).forward([1e3, 2e3, 3e3])


def test_walls_beyond_their_test_are_reported(tube):
    thread = Fiber(angle_rad=0.05, families=2, modulus_pa=3e8, thickness_m=2e-4)
    # The law of this elastomer comes from a test up to a stretch of 5.
    named = tube(material="Ecoflex 00-10", fiber=thread)
    with pytest.warns(UserWarning, match="1 of 2 walls"):
        found = named.inverse(axial_stretch=[4.5, 5.5])
    assert found.beyond_test.tolist() == [False, True]


def test_arrays_of_an_actuator_are_its_own(tube):
    lengths = np.array([0.1, 0.2])
    actuator = tube(length_m=lengths)
    lengths[:] = 5.0
    assert actuator.length_m.tolist() == [0.1, 0.2]
    assert pickle.loads(pickle.dumps(actuator)).forward(1e3).volume_m3[1] == actuator.forward(1e3).volume_m3[1]
