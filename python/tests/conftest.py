"""Actuators that several tests use, and a thread beside their calls."""

import threading
import time

import pytest

from softlimb import Actuator, NeoHookean


@pytest.fixture
def tube():
    """Makes a neo-Hookean tube, with changes."""

    def make(**changes):
        sizes = dict(inner_radius_m=6e-3, outer_radius_m=8e-3, length_m=0.1)
        fields = dict(motion="extension", material=NeoHookean(shear_modulus_pa=0.2e6), **sizes)
        return Actuator(**{**fields, **changes})

    return make


@pytest.fixture
def counted_during():
    """Counts the turns of another thread during a call. A busy computer may give it none: a call with few is repeated, for 30 s at most."""

    def count_during(call):
        counted, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0)

        other = threading.Thread(target=count, daemon=True)
        other.start()
        end_s = time.monotonic() + 30.0
        try:
            while True:
                before = counted[0]
                call()
                during = counted[0] - before
                if during > 10 or time.monotonic() > end_s:
                    return during
        finally:
            done.set()
            other.join()

    return count_during
