"""A Gymnasium environment: the tip of a limb on the simulated device reaches a target.

    env = ReachEnv("scenes/weightless-a.toml")
    observation, info = env.reset(seed=1)
"""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

import softlimb

Vector = npt.NDArray[np.float64]

STEP_S = 0.2
"""Time between two actions."""
STRIDE = 0.1
"""Largest change of a setpoint in one action, over its range."""
WITHIN_M = 0.015
"""Distance at which the target is reached."""


class ReachEnv(gymnasium.Env[Vector, Vector]):
    """Leads the drives of a limb until its tip is at a target.

    - Action: change of each setpoint, from -1 to 1, times a tenth of its range. A move that the limb refuses leaves it where it is.
    - Observation: setpoint of each drive and measured pressure of each channel, 0 at rest and 1 at the highest; tip, and target minus tip, over the length
      of the limb.
    - Reward: the way by which the tip came nearer, over the length of the limb; 1 more at the target.
    - Reset: a new simulated limb of its own moduli, walls and noise. ``options={"target_m": [x, y, z]}`` chooses the target.

    The same seed and actions give the same bits.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, scene: str | Path = "scenes/weightless-a.toml") -> None:
        self.scene = softlimb.Scene.load(scene)
        checked = self.scene.check()
        _, self.tips_m = self.scene.workspace(pressures="modules", samples=2000, points="random")
        self.length_m: float = checked["rest_length_m"]
        self.session = self.scene.session(seed=0)
        self.rest, self.end = self.session.setpoint_range.T
        drives, channels = len(self.rest), len(self.session.observation.pressure_pa)
        self.pressure_max_pa: float = max(module["pressure_max_pa"] for module in checked["modules"])
        self.target_m = np.zeros(3)
        self.action_space = spaces.Box(-1.0, 1.0, (drives,), np.float64)
        # Sensors have noise, and the limb may stretch: no sharp bound.
        self.observation_space = spaces.Box(-np.inf, np.inf, (drives + channels + 6,), np.float64)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Vector, dict[str, Any]]:
        super().reset(seed=seed)
        self.session.close()
        self.session = self.scene.session(seed=int(self.np_random.integers(2**31)))
        drawn = self.tips_m[self.np_random.integers(len(self.tips_m))]
        self.target_m = np.array((options or {}).get("target_m", drawn), dtype=float)
        seen = self.session.observation
        return self._observed(seen), self._info(seen)

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        before_m = self._distance_m(self.session.observation)
        share = (self.session.observation.setpoint - self.rest) / (self.end - self.rest)
        share = np.clip(share + STRIDE * np.clip(action, -1.0, 1.0), 0.0, 1.0)
        seen = self.session.step(STEP_S, self.rest + share * (self.end - self.rest))
        distance_m = self._distance_m(seen)
        is_there = distance_m < WITHIN_M
        reward = (before_m - distance_m) / self.length_m + float(is_there)
        return self._observed(seen), reward, is_there, False, self._info(seen)

    def close(self) -> None:
        self.session.close()

    def _distance_m(self, seen: softlimb.Observation) -> float:
        return float(np.linalg.norm(self.target_m - seen.tip_achieved_m))

    def _observed(self, seen: softlimb.Observation) -> Vector:
        share = (seen.setpoint - self.rest) / (self.end - self.rest)
        tip = seen.tip_achieved_m / self.length_m
        missing = (self.target_m - seen.tip_achieved_m) / self.length_m
        return np.concatenate([share, seen.pressure_pa / self.pressure_max_pa, tip, missing])

    def _info(self, seen: softlimb.Observation) -> dict[str, Any]:
        return {"distance_m": self._distance_m(seen), "refusal": seen.refusal, "faults": seen.faults}


def make(**options: Any) -> ReachEnv:
    """For Gymnasium's registry."""
    return ReachEnv(**options)


gymnasium.register("softlimb/Reach-v0", entry_point=make, max_episode_steps=100)


def main() -> None:
    env = gymnasium.make("softlimb/Reach-v0")
    _, info = env.reset(seed=1)
    start_m, rewards = info["distance_m"], 0.0
    env.action_space.seed(1)
    for _ in range(25):
        _, reward, terminated, truncated, info = env.step(env.action_space.sample())
        rewards += float(reward)
        if terminated or truncated:
            break
    print(f"at random: from {1e3 * start_m:.0f} to {1e3 * info['distance_m']:.0f} mm, reward {rewards:.3f}")
    env.close()


if __name__ == "__main__":
    main()
