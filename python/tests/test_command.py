"""The command from Python, calibration from arrays, and the table of verbs."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import softlimb
from softlimb import Actuator, CommandError, NeoHookean

ROOT = Path(__file__).parents[2]
SINGLE = ROOT / "scenes" / "single-bending.toml"


def verbs():
    """Names of the command's verbs, by its own help."""
    _, text = softlimb.command("--help").output.split("Commands:\n")
    lines = text.split("\n\n")[0].splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ") and line[2] != " "]


def test_table_names_a_function_for_every_verb():
    page = (ROOT / "docs" / "guide" / "python.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([a-z ]+)` \| (.+?) \|$", page, re.MULTILINE)
    listed = {row[0].split()[0] for row in rows}
    found = [verb for verb in verbs() if verb != "help"]
    assert len(found) > 15 and listed == set(found)
    for verb, functions in rows:
        if verb == "console":
            assert functions.startswith("none")
            continue
        names = re.findall(r"`([A-Za-z_.]+)", functions)
        assert names
        for name in names:
            place = softlimb
            for part in name.split("."):
                place = getattr(place, part)
            assert callable(place), name


def test_failure_has_code_and_message():
    with pytest.raises(CommandError, match="no such file") as caught:
        softlimb.command("check", "none.toml")
    assert caught.value.code == 1
    with pytest.raises(CommandError, match="unrecognized") as caught:
        softlimb.command("chekc")
    assert caught.value.code == 2
    assert softlimb.command("--version").output.strip() == f"softlimb {softlimb.__version__}"


def test_interrupt_ends_a_command():
    # So many samples take minutes.
    words = [sys.executable, "-m", "softlimb", "workspace", str(SINGLE), "--samples", "100000000", "--json"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        time.sleep(2.0)
        # A busy computer may not have come to the command by then.
        for _ in range(60):
            running.send_signal(signal.SIGINT)
            try:
                output, _ = running.communicate(timeout=1)
                break
            except subprocess.TimeoutExpired:
                continue
        else:
            running.kill()
            pytest.fail("it does not end")
    assert running.returncode != 0 and not output


def test_tensile_test_gives_its_law():
    # Uniaxial stress of an incompressible Yeoh wall: 2 (l - l^-2) dW/dI1.
    c1, c2, c3 = 86560.0, 13805.0, -1466.1
    stretch = np.linspace(1.05, 2.0, 20)
    i1 = stretch**2 + 2 / stretch - 3
    stress = 2 * (stretch - stretch**-2) * (c1 + 2 * c2 * i1 + 3 * c3 * i1**2)
    found = softlimb.calibrate_tension({"stretch": stretch, "nominal_stress_pa": stress})
    text = str(found)
    values = [float(number) for number in re.findall(r"-?\d+\.\d+(?:e-?\d+)?", text)]
    for value in (c1, c2, c3):
        assert min(abs(other / value - 1) for other in values) < 1e-6, found


@pytest.mark.parametrize("kind", ["dictionary", "frame"])
def test_modulus_is_found_from_bends(kind, tmp_path):
    # The finger of the scene with a wall that is a tenth stiffer than the scene's.
    stiffer = NeoHookean(shear_modulus_pa=1.1 * 0.223e6)
    finger = Actuator(motion="bending", inner_radius_m=10e-3, outer_radius_m=14e-3, length_m=0.24, material=stiffer)
    pressures = np.linspace(5e3, 3e4, 8)
    data = {"module": "finger", "pressure_pa": pressures, "bend_angle_rad": finger.forward(pressures).bend_angle_rad}
    if kind == "frame":
        data = pytest.importorskip("pandas").DataFrame(data)
    written = tmp_path / "calibrated.toml"
    found = softlimb.calibrate_pressure(data, SINGLE, fit=["shear_modulus"], write=written)
    [estimate] = found["estimates"]
    assert estimate["value"] == pytest.approx(1.1 * 0.223e6, rel=1e-6)
    line = next(line for line in written.read_text().splitlines() if line.startswith("shear_modulus"))
    assert "0.2453" in line


def test_what_was_not_measured_is_nan():
    tube = {"inner_radius_m": 10e-3, "outer_radius_m": 14e-3, "length_m": 0.24, "material": NeoHookean(shear_modulus_pa=0.245e6)}
    pressures = np.linspace(5e3, 3e4, 8)
    bends = Actuator(motion="bending", **tube).forward(pressures).bend_angle_rad
    gaps = np.where(np.arange(8) % 2 == 0, bends, np.nan)
    data = {"module": "finger", "pressure_pa": pressures, "bend_angle_rad": gaps}
    [estimate] = softlimb.calibrate_pressure(data, SINGLE, fit=["shear_modulus"])["estimates"]
    assert estimate["value"] == pytest.approx(0.245e6, rel=1e-6)


def test_bad_rows_are_named():
    with pytest.raises(CommandError, match="bend_angle_rad"):
        softlimb.calibrate_pressure({"pressure_pa": [1e4], "bend_angle_rad": ["far"]}, SINGLE, fit=["shear_modulus"])
