"""The thickest wall that still bends far enough: 400 actuators at 60 pressures in one call."""

import numpy as np

import softlimb

INNER_RADIUS_M = 6e-3
PRESSURE_MAX_PA = 40e3
BEND_RAD = np.radians(45.0)


def main() -> None:
    # One row an actuator, one column a pressure.
    walls_m = np.linspace(1e-3, 4e-3, 400).reshape(-1, 1)
    benders = softlimb.Actuator(
        motion="bending",
        inner_radius_m=INNER_RADIUS_M,
        outer_radius_m=INNER_RADIUS_M + walls_m,
        length_m=0.1,
        material="Dragon Skin 30",
    )
    bent = benders.forward(np.linspace(0.0, PRESSURE_MAX_PA, 60))
    # Beyond its limit point an actuator has no equilibrium: NaN, which no comparison holds for.
    reached = np.any(bent.bend_angle_rad >= BEND_RAD, axis=1)
    widest_m = walls_m[reached].max()
    exact = softlimb.Actuator(
        motion="bending",
        inner_radius_m=INNER_RADIUS_M,
        outer_radius_m=INNER_RADIUS_M + widest_m,
        length_m=0.1,
        material="Dragon Skin 30",
    ).inverse(bend_angle_rad=BEND_RAD)
    print(f"thickest wall that bends 45 deg: {1e3 * widest_m:.2f} mm, at {1e-3 * float(exact.pressure_pa):.1f} kPa")


if __name__ == "__main__":
    main()
