"""Designs checked by the actuators that they describe."""

import numpy as np
import pytest

import softlimb
from softlimb import Actuator, CommandError, Fiber, InvalidParameter, NeoHookean

SILICONE = {"law": "neo-hookean", "shear_modulus_pa": 2e5}


def elbow(targets):
    bounds = dict(inner_radius_m=[6e-3, 10e-3], wall_m=[3e-3, 5e-3], length_m=[0.1, 0.3], pressure_max_pa=60e3)
    segment = dict(name="elbow", motion="bending", material=SILICONE, bounds=bounds, targets={"bend_angle_rad": targets})
    return dict(format=1, weights={"bend_angle_per_rad2": 1e4}, segments=[segment])


def test_designed_bender_reaches_its_targets():
    targets = np.array([0.0, 0.5, np.nan, 1.2])
    found = softlimb.design_actuators(elbow(targets))
    assert found["status"] == "reached"
    [segment] = found["segments"]
    sizes = {name: segment[name] for name in ("inner_radius_m", "outer_radius_m", "length_m")}
    bender = Actuator(motion="bending", material=NeoHookean(shear_modulus_pa=2e5), **sizes)
    phases = [phase for phase in segment["phases"] if phase["target"] is not None]
    assert [phase["target"] for phase in phases] == [0.0, 0.5, 1.2]
    bends = bender.forward([phase["pressure_pa"] for phase in phases]).bend_angle_rad
    np.testing.assert_allclose(bends, [0.0, 0.5, 1.2], atol=1e-6)


def test_designed_bundle_has_the_forces_of_its_tubes():
    thread = dict(families=2, modulus_pa=3.61e8, thickness_m=0.178e-3)
    bounds = dict(inner_radius_m=[6e-3, 12e-3], wall_m=[3e-3, 6e-3], length_m=[0.2, 0.24], angle_deg=[0, 30], pressure_max_pa=120e3)
    tubes = [dict(name=name, radius_m=[0.03, 0.05], azimuth_deg=[angle] * 2) for name, angle in (("a", 0), ("b", 120), ("c", 240))]
    problem = dict(
        format=1,
        shared_geometry=True,
        weights=dict(force_per_n=1, torque_per_nm=20),
        material=SILICONE,
        fiber=thread,
        bounds=bounds,
        actuators=tubes,
        samples=[dict(force_n=[0, 0, 15], torque_nm=[0, 0, 0])],
    )
    found = softlimb.design_bundle(problem)
    pushed = 0.0
    for tube in found["actuators"]:
        winding = Fiber(angle_rad=np.radians(tube["angle_deg"]), **thread)
        sizes = {name: tube[name] for name in ("inner_radius_m", "outer_radius_m", "length_m")}
        made = Actuator(motion="extension", material=NeoHookean(shear_modulus_pa=2e5), fiber=winding, **sizes)
        pushed -= made.blocked_force(tube["pressures_pa"][0]).force_n
    assert pushed == pytest.approx(15, rel=1e-3)


def test_bad_problems_are_named():
    with pytest.raises(CommandError, match="pressure_max_pa"):
        problem = elbow([0.5])
        problem["segments"][0]["bounds"]["pressure_max_pa"] = -1.0
        softlimb.design_actuators(problem)
    with pytest.raises(InvalidParameter, match="starts"):
        softlimb.design_actuators(elbow([0.5]), starts=0)
