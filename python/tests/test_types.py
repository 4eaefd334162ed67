"""The types of the package, as a checker sees them."""

import subprocess
import sys
from pathlib import Path

PYTHON = Path(__file__).parents[1]


def checked(*words):
    done = subprocess.run([sys.executable, "-m", *words], cwd=PYTHON / "examples", capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_examples_pass_the_strict_checker(tmp_path):
    checked("mypy", "--strict", "--cache-dir", str(tmp_path), ".")


def test_package_passes_the_strict_checker(tmp_path):
    checked("mypy", "--strict", "--cache-dir", str(tmp_path), "-p", "softlimb")


def test_stubs_are_those_of_the_native_part():
    checked("mypy.stubtest", "softlimb._native")


def test_wrong_types_are_found(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import softlimb\nsoftlimb.NeoHookean(shear_modulus=1.0)\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), str(wrong)],
        capture_output=True,
        text=True,
    )
    assert "Unexpected keyword argument" in done.stdout
