"""The example environment by Gymnasium's own checker, and by a limb whose target is known to be in reach."""

import importlib.util
import warnings
from pathlib import Path

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "weightless-a.toml"


@pytest.fixture(scope="module")
def module():
    spec = importlib.util.spec_from_file_location("reach_env", ROOT / "python" / "examples" / "reach_env.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_checker_accepts_the_environment(module):
    from gymnasium.utils.env_checker import check_env

    env = module.ReachEnv(SCENE)
    with warnings.catch_warnings():
        # The checker warns of bounds that are infinite, and of what is not registered.
        warnings.simplefilter("ignore")
        check_env(env, skip_render_check=True)
    env.close()


def episode(env, seed):
    env.action_space.seed(7)
    rows = [env.reset(seed=seed)[0]]
    for _ in range(5):
        observation, reward, *_ = env.step(env.action_space.sample())
        rows.append(np.append(observation, reward))
    return np.concatenate(rows)


def test_seeds_give_the_same_bits(module):
    env = module.ReachEnv(SCENE)
    first = episode(env, 1)
    np.testing.assert_array_equal(episode(env, 1), first)
    assert not np.array_equal(episode(env, 2), first)
    env.close()


def test_target_is_reached_where_it_was_seen(module):
    env = module.ReachEnv(SCENE)
    env.reset(seed=4)
    drives = env.action_space.shape[0]
    for _ in range(3):
        env.step(np.full(drives, 0.8))
    # Time to settle.
    for _ in range(5):
        env.step(np.zeros(drives))
    target_m = env.session.observation.tip_achieved_m.copy()
    # The same seed draws the same limb.
    _, info = env.reset(seed=4, options={"target_m": target_m})
    start_m, rewards = info["distance_m"], []
    for action in [0.8] * 3 + [0.0] * 5:
        _, reward, terminated, truncated, info = env.step(np.full(drives, action))
        rewards.append(reward)
        if terminated:
            break
    assert terminated and not truncated and info["distance_m"] < module.WITHIN_M < start_m
    # The way, over the length of the limb, and 1 for the arrival.
    assert sum(rewards) == pytest.approx((start_m - info["distance_m"]) / env.length_m + 1.0, rel=1e-9)
    env.close()


def test_refused_moves_leave_the_limb(module):
    env = module.ReachEnv(SCENE)
    env.reset(seed=1)
    _, _, _, _, info = env.step(np.full(env.action_space.shape, -1.0))
    assert info["refusal"] is None
    assert np.allclose(env.session.observation.setpoint, env.rest)
    env.close()
