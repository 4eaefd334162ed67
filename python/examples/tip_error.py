"""Tip error of a run over time, by the tables of its log."""

import numpy as np

import softlimb


def main() -> None:
    scene = softlimb.Scene.load("scenes/single-bending.toml")
    result = scene.run("out/example", seed=1)
    log = softlimb.read_log(result["log"])
    setpoint, truth = log["setpoint"], log["truth"]
    desired = np.stack([setpoint[f"tip_setpoint_{axis}_m"] for axis in "xyz"], axis=-1)
    achieved = np.stack([truth[f"tip_achieved_{axis}_m"] for axis in "xyz"], axis=-1)
    error_mm = 1e3 * np.linalg.norm(desired - achieved, axis=1)
    worst = int(np.argmax(error_mm))
    print(f"{len(error_mm)} samples, tip error at most {error_mm[worst]:.1f} mm, {setpoint['time_s'][worst]:.2f} s into the run")


if __name__ == "__main__":
    main()
