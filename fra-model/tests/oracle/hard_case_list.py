"""The hard cases: named groups of actuators and what is done to them."""

from hard_cases import DS30, STIFFENING, case, fiber, nh

CASES = []
MAGIC = 35.264389682754654


def add(group, name, **rest):
    CASES.append(case(group, name, **rest))


WINDINGS = {
    "bare": None,
    "sheet_one_30": fiber("sheet", 1, 30, 1e3),
    "sheet_two_10": fiber("sheet", 2, 10, 1e3),
    "stiff_sheet_one_3": fiber("sheet", 1, 3, 1e5),
    "smeared_one_30": fiber("smeared", 1, 30, 5),
    "stiff_smeared_two_60": fiber("smeared", 2, 60, 1e5),
    "stiff_layer_one_50": fiber("layer", 1, 50, 1e5),
}

# Hardly any pressure, and none.
for name, wind in WINDINGS.items():
    for p in (0, 1e-3, 1, -1e-3):
        add("hardly_any_pressure", f"{name}_{p}", fiber=wind, p=p)
    add("hardly_any_pressure_yeoh", f"{name}_1mPa", fiber=wind, p=1e-3, material=DS30)

# Vacuum.
for name, wind in WINDINGS.items():
    for p in (-1e3, -20e3, -90e3):
        if not (name == "bare" and p == -90e3):
            add("vacuum", f"{name}_{p:.0f}", fiber=wind, p=p)
add("vacuum", "bare_thick", walls=(6, 18), p=-100e3)
add("vacuum", "thick_soft_smeared", walls=(6, 24), p=-60e3, fiber=fiber("smeared", 1, 40, 0.5))
add("vacuum", "soft_lumen_almost_closed", walls=(6, 18), p=-300e3, material=nh(0.1e6))
add("vacuum", "yeoh_layer", p=-50e3, material=DS30, fiber=fiber("layer", 2, 30, 50))

# One part in a million below the limit point, and above it.
LIMITS = {
    "bare": {},
    "bare_thin": {"walls": (6, 6.06)},
    "bare_thick": {"walls": (6, 24)},
    "axial_1": {"fiber": fiber("smeared", 2, 90, 1)},
    "axial_10": {"fiber": fiber("smeared", 2, 90, 10)},
    "axial_100": {"fiber": fiber("smeared", 2, 90, 100)},
    "axial_1e4": {"fiber": fiber("smeared", 2, 90, 1e4)},
    "axial_sheet_1e6": {"fiber": fiber("sheet", 2, 90, 1e6)},
    "yeoh_axial": {"fiber": fiber("smeared", 2, 90, 10), "material": DS30},
    "one_family_80": {"fiber": fiber("sheet", 1, 80, 0.3)},
    "two_families_75_soft": {"fiber": fiber("smeared", 2, 75, 0.5)},
    "two_families_80_soft": {"fiber": fiber("smeared", 2, 80, 1)},
    "pulled": {"force": 3.0},
    "pushed": {"force": -2.0},
    "turned": {"torque": 0.01, "fiber": fiber("layer", 1, 70, 0.2)},
}
for name, rest in LIMITS.items():
    add("just_below_the_limit", name, p=("limit", "0.999999"), **rest)
    add("just_above_the_limit", name, p=("limit", "1.000001"), **rest)
    add("far_above_the_limit", name, p=("limit", "3"), **rest)
for name in ("bare", "axial_10", "one_family_80", "pulled"):
    add("near_the_limit", name, p=("limit", "0.99"), **LIMITS[name])
    add("near_the_limit", f"{name}_nearer", p=("limit", "0.9999"), **LIMITS[name])

# A second stable equilibrium at the same pressure.
N75 = {"fiber": fiber("smeared", 2, 75, 0.5)}
N80 = {"fiber": fiber("smeared", 2, 80, 1)}
for p in (25.3e3, 26e3, 26.1e3):
    add("second_stable_equilibrium", f"two_75_{p:.0f}", p=p, **N75)
for p in (24.5e3, 26.3e3):
    add("second_stable_equilibrium", f"two_80_{p:.0f}", p=p, **N80)
add("second_stable_equilibrium", "yeoh_limit", p=("limit", "0.9"), material=DS30, fiber=fiber("smeared", 2, 85, 1))

# Angles at which something vanishes.
for special in (0, MAGIC, 54.735610317245346, 90):
    for off in (0, 1e-3, -1e-3, 1e-5):
        if not 0 <= special + off <= 90:
            continue
        for name, (placement, families, ratio) in {
            "sheet_one": ("sheet", 1, 1e3),
            "sheet_two": ("sheet", 2, 1e3),
            "stiff_sheet_one": ("sheet", 1, 1e5),
            "smeared_one": ("smeared", 1, 10),
            "stiff_smeared_two": ("smeared", 2, 1e5),
            "layer_one": ("layer", 1, 1e4),
        }.items():
            wind = fiber(placement, families, special + off, ratio)
            add(f"angle_near_{special:.0f}", f"{name}_{off}", p=20e3, fiber=wind)

# Stiff fibers.
for ratio in (1e5, 1e6):
    for placement in ("sheet", "layer", "smeared"):
        for families in (1, 2):
            for degrees in (3, 28, 50, 70, 85):
                target = "twist" if families == 1 else "stretch"
                if placement == "layer" and families == 1 and degrees in (50, 85):
                    target = None  # The twist turns back on the way.
                wind = fiber(placement, families, degrees, ratio)
                add("stiff_fibers", f"{placement}_{families}_{degrees}_{ratio:.0e}", p=30e3, fiber=wind, target=target)

# Thin and thick walls.
for ratio in (0.005, 0.01, 3, 4):
    walls = (6, 6 * (1 + ratio))
    p = 0.3 * 0.2e6 * min(ratio, 1)
    for name, wind in {
        "bare": None,
        "sheet_one_30": fiber("sheet", 1, 30, 1e3, 0.05 * ratio),
        "sheet_two_60": fiber("sheet", 2, 60, 1e3, 0.05 * ratio, 0.5),
        "layer_one_20": fiber("layer", 1, 20, 1e4),
        "smeared_two_70": fiber("smeared", 2, 70, 10),
        "stiff_smeared_one_40": fiber("smeared", 1, 40, 1e5),
    }.items():
        add("thin_and_thick_walls", f"{name}_{ratio}", walls=walls, p=p, fiber=wind, target="outer_radius")

# Large rotations.
for name, rest in {
    "soft_30": {"fiber": fiber("sheet", 1, 30, 10), "p": 61e3},
    "soft_20_long": {"fiber": fiber("smeared", 1, 20, 3), "p": 105e3, "length": 1000},
    "turned": {"fiber": fiber("sheet", 1, 45, 5), "p": 10e3, "torque": 0.4, "length": 500},
    "turned_back": {"fiber": fiber("layer", 1, 45, 5), "p": 10e3, "torque": -0.4, "length": 500},
    "stiff_50": {"fiber": fiber("sheet", 1, 50, 1e5), "p": 67e3},
    "bare_turned": {"torque": 0.05, "p": 5e3},
}.items():
    add("large_rotations", name, target="twist", **rest)

# Loads of both signs.
for force in (-4.0, 0.0, 4.0):
    for torque in (-0.02, 0.0, 0.02):
        if force == 0 and torque == 0:
            continue
        for name, wind in {
            "one": fiber("sheet", 1, 28, 1624),
            "two": fiber("sheet", 2, 10, 1e3),
            "stiff_smeared_two": fiber("smeared", 2, 40, 1e5),
            "stiff_layer_one": fiber("layer", 1, 60, 1e6),
        }.items():
            add("loads_of_both_signs", f"{name}_{force}_{torque}", p=20e3, force=force, torque=torque, fiber=wind, target="stretch")

# Yeoh.
for law, material in {"ds30": DS30, "stiffening": STIFFENING}.items():
    for name, wind in WINDINGS.items():
        add("yeoh", f"{law}_{name}", p=25e3, fiber=wind, material=material, target="outer_radius")

# Inverse problems of every kind.
for name, wind in WINDINGS.items():
    for target in ("stretch", "outer_radius", "inner_radius", "twist"):
        # A bare tube neither twists nor, to first order, stretches.
        if (target == "twist" and "one" not in name) or (target == "stretch" and name == "bare"):
            continue
        for p in (1, 15e3, -3e3):
            if p < 0 and name == "stiff_layer_one_50" and target in ("stretch", "twist"):
                continue  # It turns back on the way up: a pressure reaches that target too.
            add("inverse", f"{name}_{target}_{p:.0f}", p=p, fiber=wind, target=target)
add("inverse", "below_the_limit", p=("limit", "0.999"), target="outer_radius")
add("inverse", "axial_below_the_limit", p=("limit", "0.999999"), target="inner_radius", **LIMITS["axial_10"])

# Bending: degrees.
for name, rest in {
    "tiny": {"p": 1e-4},
    "small": {"p": 1},
    "right_angle": {"p": 90},
    "coil": {"p": 720},
    "tight_coil": {"p": 3600},
    "thin": {"walls": (6, 6.03), "p": 90},
    "thick": {"walls": (2, 10), "p": 60},
    "thick_coil": {"walls": (2, 10), "p": 720},
    "yeoh": {"material": DS30, "p": 90},
    "wound_inside": {"fiber": fiber("sheet", 2, 0, 1e3, 0.2, 0.5), "p": 90},
    "pushed": {"force": -2.0, "p": 60},
    "turned_back": {"torque": -0.05, "p": 60},
}.items():
    add("bending", name, kind="bend", **rest)
