"""Writes the blueprint of a log for rerun, beside it: the limb in 3D above pressures and deformations.

    pip install rerun-sdk
    python3 blueprint.py run.mcap
    rerun run.mcap run.rbl
"""

import pathlib
import sys

import rerun.blueprint as rrb

# rerun applies a blueprint to recordings of the same name, and names the recording of a log by its file.
log = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "run.mcap")
limb = rrb.Spatial3DView(
    name="limb",
    origin="/",
    contents="/**",
    spatial_information=rrb.SpatialInformation(target_frame="world"),
)
pressures = rrb.TimeSeriesView(name="gauge pressure, Pa", origin="/softlimb/gauge_pressure")
modules = rrb.TimeSeriesView(
    name="deformation of the modules",
    origin="/softlimb/modules",
    contents=["/softlimb/modules/setpoint/position", "/softlimb/modules/achieved/position"],
)
blueprint = rrb.Blueprint(
    rrb.Vertical(limb, rrb.Horizontal(pressures, modules), row_shares=[2, 1]),
    rrb.TimePanel(state="collapsed", timeline="message_log_time"),
    collapse_panels=True,
)
blueprint.save(log.stem, log.with_suffix(".rbl"))
