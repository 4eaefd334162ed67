"""Series and all solutions of an inverse problem, beside `softlimb eval --batch`, which has its own reader, writer and way into the model."""

import json

import numpy as np
import pytest

import softlimb
from softlimb import Actuator, Fiber, InvalidParameter, NeoHookean, Series, Status

MU = 0.2e6
SIZES = {"inner_radius_m": 6e-3, "outer_radius_m": 8e-3}
WOUND = {"angle_rad": np.radians(4.0), "families": 2, "modulus_pa": 3.61e8, "thickness_m": 0.178e-3}
SILICONE = NeoHookean(shear_modulus_pa=MU)


def part(motion, length_m=0.06, **fiber):
    winding = Fiber(**{**WOUND, **fiber}) if fiber or motion == "extension" else None
    return Actuator(motion=motion, length_m=length_m, material=SILICONE, fiber=winding, **SIZES)


def line(motion, length_m=0.06, direction_deg=0.0, **fiber):
    """The same segment as `eval` takes it."""
    segment = {**SIZES, "motion": motion, "length_m": length_m, "bend_direction_deg": direction_deg}
    segment["material"] = {"law": "neo-hookean", "shear_modulus_pa": MU}
    if fiber or motion == "extension":
        winding = {**WOUND, **fiber}
        segment["fiber"] = {"angle_deg": np.degrees(winding.pop("angle_rad")), **winding}
    return segment


def evaluated(lines, folder):
    """Answers of the command."""
    file = folder / "queries.jsonl"
    file.write_text("".join(json.dumps(each) + "\n" for each in lines))
    return [json.loads(answer) for answer in softlimb.command("eval", "--batch", file).output.splitlines()]


NAMES = ("pressure_pa", "length_m", "extension_m", "twist_rad", "bend_angle_rad", "volume_m3")
SEGMENT_NAMES = ("axial_stretch", "inner_radius_m", "outer_radius_m", "twist_rad", "bend_angle_rad")


def check(found, index, expected):
    assert found.status[index] == (Status.OK if expected["status"] == "ok" else Status.NO_SOLUTION)
    if expected["status"] != "ok":
        assert np.isnan(found.pressure_pa[index]) and np.isnan(found.tip_position_m[index]).all()
        assert found.limit_pressure_pa[index] == pytest.approx(expected["limit_pressure_pa"], rel=1e-12)
        assert found.limit_segment[index] == expected["limit_segment"]
        return
    for name in NAMES:
        assert getattr(found, name)[index] == pytest.approx(expected[name], rel=1e-12, abs=1e-15), name
    np.testing.assert_allclose(found.tip_position_m[index], expected["tip_position_m"], atol=1e-12)
    np.testing.assert_allclose(found.tip_quaternion[index], expected["tip_quaternion_wxyz"], atol=1e-12)
    for segment, of_segment in zip(found.segments, expected["segments"], strict=True):
        for name in SEGMENT_NAMES:
            assert getattr(segment, name)[index] == pytest.approx(of_segment[name], rel=1e-12, abs=1e-15), name


def test_series_are_answered_as_by_eval(tmp_path):
    lengths, pressures = np.array([[0.04], [0.09]]), np.array([5e3, 2e4, 9e5])
    # The last one is a bare tube, whose branch ends.
    segments = [part("extension"), part("bending", lengths), part("bending", 0.05), part("expansion", 0.02)]
    series = Series(segments, [0.0, 0.0, np.radians(90.0), 0.0])
    found = series.forward(pressures)
    assert series.shape == (2, 1) and found.status.shape == (2, 3) and found.tip_position_m.shape == (2, 3, 3)
    lines = [
        {
            "problem": "forward",
            "pressure_pa": pressure,
            "segments": [line("extension"), line("bending", length), line("bending", 0.05, 90.0), line("expansion", 0.02)],
        }
        for length in lengths[:, 0]
        for pressure in pressures
    ]
    for index, expected in zip(np.ndindex(2, 3), evaluated(lines, tmp_path), strict=True):
        check(found, index, expected)
    assert set(found.status.ravel()) == {Status.OK, Status.NO_SOLUTION}


def test_inverse_of_series_is_that_of_eval(tmp_path):
    helix = {"angle_rad": np.radians(30.0), "families": 1}
    series = Series([part("twisting", **helix), part("bending")])
    segments = [line("twisting", **helix), line("bending")]
    lines = []
    for name, targets in (("extension_m", [1e-3, 4e-3]), ("twist_rad", [-0.1, -0.4]), ("bend_angle_rad", [0.3, 1.2])):
        found = series.inverse(**{name: targets})
        lines = [{"problem": "inverse", "target": {name: target}, "segments": segments} for target in targets]
        for index, expected in enumerate(evaluated(lines, tmp_path)):
            check(found, index, expected)
    # The tip of two equal benders in one plane, by hand: an arc of twice the angle.
    twice = Series([part("bending"), part("bending")]).forward(2e4)
    angle, length = twice.bend_angle_rad, twice.length_m
    radius = length / angle
    np.testing.assert_allclose(twice.tip_position_m, [radius * (1 - np.cos(angle)), 0.0, radius * np.sin(angle)], atol=1e-12)


def test_halves_with_two_windings_are_the_whole():
    windings = tuple(Fiber(**{**WOUND, "angle_rad": angle, "families": 1}) for angle in (0.5, np.pi / 2))

    def rod(length_m):
        return Actuator(motion="twisting", length_m=length_m, material=SILICONE, fiber=windings, **SIZES)

    whole, pressures = rod(0.12), np.array([5e3, 2e4])
    expected = whole.forward(pressures, external_force_n=0.5)
    found = Series([rod(0.04), rod(0.08)]).forward(pressures, external_force_n=0.5)
    assert found.status.tolist() == [Status.OK] * 2
    np.testing.assert_allclose(found.twist_rad, expected.twist_rad, rtol=1e-10)
    np.testing.assert_allclose(found.length_m, 0.12 * expected.axial_stretch, rtol=1e-12)
    back = Series([rod(0.04), rod(0.08)]).inverse(twist_rad=expected.twist_rad, external_force_n=0.5)
    np.testing.assert_allclose(back.pressure_pa, pressures, rtol=1e-8)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Series([]), "segments"),
        (lambda: Series([part("bending")], [0.0, 1.0]), "bend_direction_rad"),
        (lambda: Series([part("bending")], float("nan")), r"bend_direction_rad\[0\]"),
        (lambda: Series([part("bending")]).inverse(twist_rad=0.1), "twist"),
        (lambda: Series([part("bending")]).forward([1e3, np.inf]), r"pressure_pa\[1\] = inf"),
        (lambda: Series([part("bending"), part("extension")]).forward(1e3, external_force_n=1.0), "external_force_n"),
        (
            lambda: Series(
                [part("bending"), Actuator(motion="bending", inner_radius_m=5e-3, outer_radius_m=8e-3, length_m=0.1, material=SILICONE)]
            ).forward(1e3),
            r"segments\[1\].inner_radius_m = 0.005 is not allowed: that of the first segment",
        ),
    ],
)
def test_bad_series_are_refused(make, field):
    with pytest.raises(InvalidParameter, match=field):
        make()


def test_all_solutions_are_those_of_eval(tmp_path):
    # Wound steeply, a tube first shortens and then lengthens: a stretch has two pressures, and vacuums beside them.
    angles = np.radians([40.0, 54.0, 62.0])
    tubes = Actuator(
        motion="extension",
        length_m=0.1,
        material=SILICONE,
        fiber=Fiber(angle_rad=angles.reshape(3, 1), families=2, modulus_pa=2e5, thickness_m=5e-4),
        **SIZES,
    )
    stretches = np.array([0.97, 0.995, 1.004, 1.2])
    found = tubes.inverse_all(axial_stretch=stretches)
    assert found.count.shape == found.complete.shape == (3, 4)
    fiber = {"families": 2, "modulus_pa": 2e5, "thickness_m": 5e-4}
    tube = {**SIZES, "motion": "extension", "length_m": 0.1, "material": {"law": "neo-hookean", "shear_modulus_pa": MU}}
    lines = [
        {**tube, "fiber": {"angle_deg": np.degrees(a), **fiber}, "problem": "inverse", "solutions": "all", "target": {"axial_stretch": s}}
        for a in angles
        for s in stretches
    ]
    counts = set()
    for index, expected in zip(np.ndindex(3, 4), evaluated(lines, tmp_path), strict=True):
        solutions = expected["solutions"]
        assert found.count[index] == len(solutions) and found.complete[index] == expected["solutions_complete"]
        counts.add(len(solutions))
        for name in ("pressure_pa", *SEGMENT_NAMES):
            np.testing.assert_allclose(
                getattr(found, name)[index][: len(solutions)], [solution[name] for solution in solutions], rtol=1e-12, atol=1e-15
            )
            assert np.isnan(getattr(found, name)[index][len(solutions) :]).all()
    assert len(counts) > 1 and max(counts) > 1, counts


def test_solutions_lie_in_the_range():
    bender = part("bending")
    pressures = np.array([8e3, 2e4])
    bends = bender.forward(pressures).bend_angle_rad
    found = bender.inverse_all(bend_angle_rad=bends, pressure_range_pa=(0.0, 1e4))
    assert found.count.tolist() == [1, 0]
    np.testing.assert_allclose(found.pressure_pa[:, 0], [8e3, np.nan], rtol=1e-10)
    with pytest.raises(InvalidParameter, match="pressure_range_pa"):
        bender.inverse_all(bend_angle_rad=0.1, pressure_range_pa=(2.0, 1.0))
    with pytest.raises(InvalidParameter, match="bend_angle_rad"):
        part("extension").inverse_all(bend_angle_rad=0.1)
    assert bender.inverse_all(bend_angle_rad=[]).pressure_pa.shape == (0, 0)
