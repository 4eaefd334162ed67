"""Design, simulate and run a limb of fiber-reinforced actuators (FRA).

Quantities are in SI units, with the unit in the name. Pressures are gauge pressures. Fiber angles count from the hoop direction.

>>> import numpy as np
>>> import softlimb
>>> silicone = softlimb.NeoHookean(shear_modulus_pa=0.2e6)
>>> bender = softlimb.Actuator(motion="bending", inner_radius_m=6e-3, outer_radius_m=8e-3, length_m=0.1, material=silicone)
>>> bent = bender.forward(np.array([10e3, 20e3, 30e3]))
>>> np.degrees(bent.bend_angle_rad).round(1).tolist()
[12.9, 27.2, 43.0]
"""

from softlimb._native import __version__
from softlimb.actuator import Actuator
from softlimb.calibrate import calibrate_pressure, calibrate_tension
from softlimb.cli import CommandResult, command
from softlimb.design import design_actuators, design_bundle
from softlimb.errors import CommandError, Diagnostic, InvalidParameter, LogError, RunError, SceneError
from softlimb.log import Log, read_log
from softlimb.material import CastableElastomer, NeoHookean, Yeoh, castable_elastomers
from softlimb.scene import Plan, Scene
from softlimb.series import SegmentState, Series, SeriesSolution
from softlimb.session import Observation, Session
from softlimb.solution import Blocked, Model, Sensitivity, Solution, Solutions, Status
from softlimb.study import sweep
from softlimb.winding import Fiber

__all__ = [
    "Actuator",
    "Blocked",
    "CastableElastomer",
    "CommandError",
    "CommandResult",
    "Diagnostic",
    "Fiber",
    "InvalidParameter",
    "Log",
    "LogError",
    "Model",
    "NeoHookean",
    "Observation",
    "Plan",
    "RunError",
    "Scene",
    "SceneError",
    "SegmentState",
    "Sensitivity",
    "Series",
    "SeriesSolution",
    "Session",
    "Solution",
    "Solutions",
    "Status",
    "Yeoh",
    "__version__",
    "calibrate_pressure",
    "calibrate_tension",
    "castable_elastomers",
    "command",
    "design_actuators",
    "design_bundle",
    "read_log",
    "sweep",
]
