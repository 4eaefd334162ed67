"""Sweeps on this computer, on processes, and on a Dask cluster that loses a worker."""

import os
import signal
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path

import pytest

import softlimb
from softlimb import InvalidParameter, SceneError

SCENES = Path(__file__).parents[2] / "scenes"

STUDY = """format = 1
scenes = ["../finger.toml"]
limbs = 2
points = 6
[[parameter]]
key = "module.finger.outer_radius"
range = ["7.5 mm", "8.5 mm"]
"""


@pytest.fixture
def study(tmp_path):
    """A study of twelve rows, in a folder beside its scene."""
    (tmp_path / "finger.toml").write_bytes((SCENES / "finger.toml").read_bytes())
    study = tmp_path / "studies" / "walls.toml"
    study.parent.mkdir()
    # With the line ends of Windows.
    study.write_bytes(STUDY.replace("\n", "\r\n").encode())
    return study


@pytest.fixture
def whole(study, tmp_path):
    """The table of one process."""
    table = softlimb.sweep(study, out=tmp_path / "whole.csv")
    assert len(table.read_text().splitlines()) == 2 + 12
    return table.read_bytes()


def test_workers_make_the_table_of_one_process(study, whole, tmp_path):
    with ProcessPoolExecutor(2) as processes:
        for shards in (1, 5, 40):
            table = softlimb.sweep(study, processes, out=tmp_path / "shared.csv", shards=shards)
            assert table.read_bytes() == whole
    assert not list(tmp_path.glob("*.parts"))


class Dying(ProcessPoolExecutor):
    """Workers that fail from the third part of a call on."""

    submitted = 0

    def submit(self, *words, **more):
        self.submitted += 1
        if self.submitted > 2:
            failed = Future()
            failed.set_exception(OSError("the cluster is gone"))
            return failed
        return super().submit(*words, **more)


def test_finished_parts_are_not_run_again(study, whole, tmp_path):
    out = tmp_path / "resumed.csv"
    finished = []
    while not out.exists():
        with Dying(1) as processes:
            try:
                softlimb.sweep(study, processes, out=out, shards=4)
            except OSError:
                finished.append(len(list(tmp_path.glob("resumed.csv.parts/*/*.csv"))))
        assert len(finished) < 20
    assert finished and finished == sorted(finished)
    assert out.read_bytes() == whole


@pytest.mark.filterwarnings("default")
def test_cluster_that_loses_a_worker_makes_the_same_table(study, whole, tmp_path):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            victim, stop = next(iter(client.run(os.getpid).values())), threading.Event()

            def kill_when_a_part_is_there():
                while not stop.wait(0.01):
                    if list(tmp_path.glob("cluster.csv.parts/*/*.csv")):
                        os.kill(victim, signal.SIGKILL)
                        return

            killer = threading.Thread(target=kill_when_a_part_is_there, daemon=True)
            killer.start()
            try:
                table = softlimb.sweep(study, client, out=tmp_path / "cluster.csv", shards=12)
            finally:
                stop.set()
                killer.join()
            assert victim not in client.run(os.getpid).values()
    assert table.read_bytes() == whole


def test_rows_without_figures_are_told(study, tmp_path):
    # Inner radii up to 12 mm, of an outer one of 8 mm.
    study.write_text(STUDY.replace("outer_radius", "inner_radius").replace("7.5 mm", "5 mm").replace("8.5 mm", "12 mm"))
    with pytest.warns(UserWarning, match="have no result"):
        softlimb.sweep(study, out=tmp_path / "thin.csv")


def test_bad_studies_are_refused(study, tmp_path):
    with pytest.raises(InvalidParameter, match="shards"):
        softlimb.sweep(study, shards=0)
    study.write_text(STUDY.replace("limbs = 2", "limbs = 0"))
    with pytest.raises(SceneError, match="limbs"):
        softlimb.sweep(study, out=tmp_path / "none.csv")
    study.write_text(STUDY.replace("../finger.toml", (tmp_path / "finger.toml").as_posix()))
    with ProcessPoolExecutor(1) as processes, pytest.raises(InvalidParameter, match="relative to the study"):
        softlimb.sweep(study, processes, out=tmp_path / "none.csv")
