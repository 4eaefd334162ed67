"""Scenes beside the command, and against what a scene states."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import softlimb
from softlimb import InvalidParameter, Scene, SceneError

SCENES = Path(__file__).parents[2] / "scenes"
SINGLE = SCENES / "single-bending.toml"


@pytest.fixture(scope="module")
def scene():
    return Scene.load(SINGLE)


def by_command(*words):
    """Standard output of the command as JSON."""
    done = subprocess.run([sys.executable, "-m", "softlimb", *map(str, words), "--json"], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    return json.loads(done.stdout)


def test_results_are_those_of_the_command(scene):
    assert scene.check() == by_command("check", SINGLE)
    found = scene.statics(payload_kg=0.1)
    assert {name: found[name] for name in found if name != "warnings"} == by_command("statics", SINGLE, "--payload", "0.1kg")
    result, tips = scene.workspace(samples=2000)
    assert result == by_command("workspace", SINGLE, "--samples", "2000")
    assert tips.shape == (2000, 3)
    [x] = [extent for extent in result["extents"] if extent["measure"] == "x"]
    assert x["least"]["value_m"] - 1e-5 <= tips[:, 0].min() <= tips[:, 0].max() <= x["largest"]["value_m"] + 1e-5


def test_plan_holds_the_targets_of_the_scene(scene):
    plan = scene.plan()
    assert plan.setpoint.shape == plan.pressure_pa.shape == (len(plan.time_s), len(plan.drives))
    assert plan.tip_m.shape == (len(plan.time_s), 3)
    assert plan.quantities == ("bend_angle_rad",)
    assert np.all(np.diff(plan.time_s) > 0)
    # The targets that the file states, in degrees.
    targets = [line.split('"')[1] for line in SINGLE.read_text().splitlines() if "bend_angle" in line and "deg" in line]
    degrees = [float(text.removesuffix("deg")) for text in targets]
    assert degrees
    for target in degrees:
        assert np.abs(np.degrees(plan.setpoint) - target).min() < 1e-3


def test_run_is_recorded(scene, tmp_path):
    result = scene.run(tmp_path / "out", seed=3)
    assert result["log"].is_file() and result["report"].read_text().startswith("<!")
    assert result == {**by_command("report", result["log"], "--out", tmp_path / "again.html"), "warnings": result["warnings"]} | {
        "log": result["log"],
        "report": result["report"],
    }
    assert scene.run(tmp_path / "same", seed=3)["tip"] == result["tip"]
    assert scene.run(tmp_path / "other", seed=4)["tip"] != result["tip"]


def test_interrupt_ends_a_run(tmp_path):
    # A process that a shell began in the background ignores interrupts, and hands that on.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    script = heed + "import softlimb; s = softlimb.Scene.load('pick-and-place-a.toml'); print('begun', flush=True); s.run(OUT); print('ended')"
    words = [sys.executable, "-c", script.replace("OUT", repr(str(tmp_path)))]
    with subprocess.Popen(words, cwd=SCENES, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline() == "begun\n"
        running.send_signal(signal.SIGINT)
        output, errors = running.communicate()
    assert "KeyboardInterrupt" in errors and "ended" not in output


def test_unknown_faults_are_named(scene, tmp_path):
    with pytest.raises(ValueError, match='faults = "earthquake@1" is not allowed'):
        scene.run(tmp_path, faults=["earthquake@1"])
    with pytest.raises(ValueError, match="link_fault"):
        scene.run(tmp_path, link_fault="loss=7")


def test_problems_of_a_scene_have_places(tmp_path):
    text = SINGLE.read_text().replace("name =", "nmae =", 1)
    with pytest.raises(SceneError) as caught:
        Scene.parse(text, "mine.toml")
    first = next(d for d in caught.value.diagnostics if "nmae" in d.message)
    line = text.splitlines()[first.line - 1]
    assert line.startswith("nmae") and first.column == 1
    assert "name" in first.help
    assert "mine.toml" in str(caught.value) and "nmae" in str(caught.value)
    with pytest.raises(SceneError, match="no such file") as caught:
        Scene.load(tmp_path / "none.toml")
    assert caught.value.diagnostics[0].line is None


def test_target_out_of_reach_is_reported_at_its_line():
    text = SINGLE.read_text()
    target = next(line for line in text.splitlines() if "bend_angle" in line and "deg" in line)
    far = text.replace(target, target.replace(target.split('"')[1], "3000 deg"), 1)
    with pytest.raises(SceneError) as caught:
        Scene.parse(far).check()
    assert "3000 deg" in far.splitlines()[caught.value.diagnostics[0].line - 1]


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda scene: scene.statics(payload_kg=-1), "payload_kg"),
        (lambda scene: scene.statics(spacers=99), "spacers"),
        (lambda scene: scene.statics(tolerance=float("nan")), "tolerance"),
        (lambda scene: scene.workspace(samples=0), "samples"),
        (lambda scene: scene.workspace(cell_m=2.0), "cell_m"),
        (lambda scene: scene.workspace(points="some"), "points"),
        (lambda scene: scene.run(seed=-1), "seed"),
        (lambda scene: scene.session(seed=2**64), "seed"),
    ],
)
def test_bad_options_are_named(scene, call, field):
    with pytest.raises(InvalidParameter) as caught:
        call(scene)
    assert caught.value.field == field
