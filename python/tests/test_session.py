"""A limb that is led step by step, beside its log and the scene's statements."""

from pathlib import Path

import numpy as np
import pytest

import softlimb
from softlimb import InvalidParameter, RunError, Scene

SCENES = Path(__file__).parents[2] / "scenes"
BENT_RAD = np.radians(40.0)


@pytest.fixture(scope="module")
def scene():
    return Scene.load(SCENES / "single-bending.toml")


def axis(pose):
    """The z axis of a frame."""
    x, y, z, w = pose[3:]
    return np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])


def test_limb_goes_where_it_is_led(scene, tmp_path):
    with scene.session(tmp_path, seed=2) as session:
        assert (session.drives, session.quantities) == (("finger",), ("bend_angle_rad",))
        assert session.observation.state == "running" and not session.observation.is_moving
        first = session.step(0.02, [BENT_RAD])
        assert first.is_moving and first.refusal is None
        seen = session.step(3.0)
        assert seen.time_s == pytest.approx(session.observation.time_s) and not seen.is_moving
        assert seen.setpoint[0] == pytest.approx(BENT_RAD, abs=1e-6)
        # The simulated finger is not the nominal one.
        assert seen.achieved[0] == pytest.approx(BENT_RAD, rel=0.2) and seen.achieved[0] != seen.modelled[0]
        assert seen.pressure_pa[0] == pytest.approx(seen.reference_pa[0], abs=2e3)
        # The tip has turned by the bend, at the last look.
        urdf, resting = scene.description()
        turned = np.arccos(np.dot(axis(seen.frames["tip"]), axis(resting["base"])))
        assert turned == pytest.approx(seen.achieved[0], abs=2e-3)
        assert all(f'<link name="{frame}"' in urdf for frame in [*seen.frames, *resting])
        closed = session.close()
    log = softlimb.read_log(closed["log"])
    at = np.flatnonzero(log["setpoint"]["time_s"] == seen.time_s)
    assert len(at) == 1
    assert log["setpoint"]["finger_bend_angle_rad"][at] == seen.setpoint
    assert log["truth"]["finger_bend_angle_rad"][log["truth"]["time_s"] == seen.time_s] == seen.achieved
    assert log["telemetry"]["channel_0_pressure_pa"][at] == seen.pressure_pa[0]
    assert log["telemetry"]["channel_0_pressure_pa"][-1] < 2e3, "vented at the end"
    assert closed["report"].is_file() and session.close() is None


def walked(scene, seed):
    with scene.session(seed=seed) as session:
        return [session.step(0.1, [bend]).pressure_pa[0] for bend in (0.1, 0.3, 0.5, 0.2)]


def test_same_seed_and_steps_give_the_same_bits(scene):
    assert walked(scene, 5) == walked(scene, 5) != walked(scene, 6)


def test_moves_out_of_range_are_refused_and_the_limb_holds(scene):
    with scene.session() as session:
        session.step(2.0, [BENT_RAD])
        seen = session.step(0.5, [20.0])
        assert seen.refusal == "`finger` is at its highest pressure" and not seen.is_moving
        assert seen.setpoint[0] == pytest.approx(BENT_RAD, abs=1e-6)
        assert session.step(0.5, [-0.1]).refusal == "`finger` has no pressure left"
        low, high = session.setpoint_range[0]
        assert session.step(0.1, [0.5 * (low + high)]).refusal is None


def test_vented_limb_goes_on_from_rest(scene):
    with scene.session() as session:
        bent = session.step(2.0, [BENT_RAD])
        rest = session.vent()
        assert rest.pressure_pa[0] < 0.05 * bent.pressure_pa[0] and rest.state == "running"
        assert session.step(2.0, [BENT_RAD]).setpoint[0] == pytest.approx(BENT_RAD, abs=1e-6)


def test_gripper_takes_commands():
    with Scene.load(SCENES / "weightless-a.toml").session() as session:
        assert not session.observation.gripping
        assert session.step(1.0, gripping=True).gripping
        assert session.step(0.1, gripping=True).gripping
        assert not session.step(1.0, gripping=False).gripping
        with pytest.raises(TypeError, match="not both"):
            session.step(0.1, session.observation.setpoint, gripping=True)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((0.0,), "duration_s = 0 is not allowed: above 0, up to 600"),
        ((float("nan"),), "duration_s"),
        ((0.1, [0.1, 0.2]), "setpoints = .* is not allowed: shape .1,.: finger"),
        ((0.1, [float("inf")]), r"setpoints\[0\] = inf is not allowed: finite"),
        ((0.1, ["far"]), "setpoints"),
    ],
)
def test_bad_steps_are_refused(scene, words, message):
    with scene.session() as session, pytest.raises(InvalidParameter, match=message):
        session.step(*words)


def test_session_that_is_over_says_so(scene, tmp_path):
    session = scene.session()
    assert session.close() is None
    with pytest.raises(RunError, match="the session is over"):
        session.step(0.1)
    (tmp_path / "file").write_text("")
    with pytest.raises(RunError, match="file"):
        scene.session(tmp_path / "file" / "below")


def test_other_threads_run_while_the_limb_moves(scene, counted_during):
    with scene.session() as session:
        assert counted_during(lambda: session.step(5.0, [BENT_RAD])) > 10
