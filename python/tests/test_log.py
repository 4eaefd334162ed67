"""Logs as arrays and data frames, beside the command's tables."""

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import softlimb

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    return softlimb.Scene.load(SCENES / "single-bending.toml").run(folder)


@pytest.fixture(scope="module")
def log(run):
    return softlimb.read_log(run["log"])


def test_tables_are_those_of_the_command(run, log, tmp_path):
    words = [sys.executable, "-m", "softlimb", "export", str(run["log"]), "--csv", str(tmp_path)]
    subprocess.run(words, check=True, capture_output=True)
    files = sorted(tmp_path.glob("*.csv"))
    assert sorted(log) == [file.stem for file in files]
    for file in files:
        with file.open(newline="") as text:
            header, *rows = csv.reader(text)
        table = log[file.stem]
        assert list(table.dtype.names) == header and len(table) == len(rows)
        for name, cells in zip(header, zip(*rows, strict=True), strict=True):
            if table[name].dtype == object:
                assert table[name].tolist() == list(cells)
            else:
                expected = np.array([float(cell or "nan") for cell in cells])
                np.testing.assert_array_equal(table[name].astype(float), expected)


def test_summary_and_info_come_with_the_tables(run, log):
    assert log.info["scene_name"] == "single-bending"
    assert log.incomplete is None
    assert log.summary["tip"] == run["tip"]
    assert "single-bending" in repr(log)


def test_tables_become_data_frames(log):
    pytest.importorskip("pandas")
    frame = log.frame("telemetry")
    assert frame.index.name == "time_s"
    np.testing.assert_array_equal(frame["supply_pa"], log["telemetry"]["supply_pa"])
    assert log.frame("wire").columns.tolist() == ["host_us", "direction", "bytes_hex"]


def test_tables_become_data_sets(log):
    pytest.importorskip("xarray")
    truth = log.dataset("truth")
    assert truth.sizes == {"time_s": len(log["truth"])}
    assert truth["finger_bend_angle_rad"].attrs == {"units": "rad"} and truth["gripper_closure"].attrs == {}
    np.testing.assert_array_equal(truth["tip_achieved_x_m"], log["truth"]["tip_achieved_x_m"])
    np.testing.assert_array_equal(truth["time_s"], log["truth"]["time_s"])
    assert log.dataset("wire").sizes == {"row": len(log["wire"])}


def test_limb_as_a_solid_ends_at_its_tip(log):
    body, line = log["body"], log["body_line"]
    assert np.isnan(body["clearance_m"]).all() and set(body["nearest"]) == {""}, "a scene without obstacles"
    # Seen every tenth of a second, with the samples.
    assert np.diff(body["time_s"]) == pytest.approx(0.1, abs=0.021)
    last = line["point"].max()
    for at in body["time_s"][::20]:
        [tip] = line[(line["time_s"] == at) & (line["point"] == last)]
        [seen] = log["truth"][log["truth"]["time_s"] == at]
        for axis in "xyz":
            assert tip[f"{axis}_m"] == pytest.approx(seen[f"tip_achieved_{axis}_m"], abs=1e-9)
    assert (line["radius_m"] > 0.005).all()


def test_cut_log_is_read_up_to_there(run, tmp_path):
    whole = run["log"].read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) // 2])
    log = softlimb.read_log(cut)
    assert log.incomplete
    assert 0 < len(log["telemetry"]) < len(softlimb.read_log(run["log"])["telemetry"])


def test_other_files_are_no_logs(tmp_path):
    with pytest.raises(softlimb.LogError, match="not an MCAP file"):
        softlimb.read_log(SCENES / "single-bending.toml")
    with pytest.raises(softlimb.LogError):
        softlimb.read_log(tmp_path / "none.mcap")
