"""Actuators that several tests use."""

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
