"""Reads logs as viewers do: with mcap-ros2-support, with rosbags, and with rerun's conversion.

    python3 log.py LOG...

Prints one line for each thing that is wrong, and the bytes of the viewers' topics. Ends with 1 where something is wrong.
"""

import collections
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib
import xml.etree.ElementTree as xml

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

VIEWED = {
    "/robot_description": "std_msgs/msg/String",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/softlimb/tip": "geometry_msgs/msg/PoseStamped",
    "/softlimb/path/setpoint": "nav_msgs/msg/Path",
    "/softlimb/path/tip": "nav_msgs/msg/Path",
    "/softlimb/markers": "visualization_msgs/msg/MarkerArray",
}
# Half of a tenth of a second, in which topics of other rates meet.
NEAR_NS = 50_000_000

VIEWERS = pathlib.Path(__file__).parents[4] / "docs" / "viewers"

wrong = []


def check(holds, text):
    if not holds:
        wrong.append(text)


# --- arithmetic -------------------------------------------------------------------------------------------------------


def vector(point):
    return [point.x, point.y, point.z]


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def norm(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return [p / norm(a) for p in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def times(a, b):
    return [[dot(row, column) for column in zip(*b)] for row in a]


def matrix(q):
    """Rotation matrix of a quaternion."""
    x, y, z, w = q.x, q.y, q.z, q.w
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def about(axis, angle):
    """Rodrigues' formula."""
    x, y, z = unit(axis)
    s, c, t = math.sin(angle), math.cos(angle), 1 - math.cos(angle)
    return [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]


def difference(a, b):
    return max(abs(p - q) for row, other in zip(a, b) for p, q in zip(row, other))


def off_line(point, line):
    """Distance of a point from a polyline."""
    least = math.inf
    for start, end in zip(line, line[1:]):
        along = minus(end, start)
        square = dot(along, along)
        share = max(0.0, min(1.0, dot(minus(point, start), along) / square)) if square else 0.0
        least = min(least, norm(minus(point, [s + share * a for s, a in zip(start, along)])))
    return least


def si(value):
    """A length or an angle of a scene, m or rad."""
    if not isinstance(value, str):
        return float(value)
    number, name = value.split()
    return float(number) * {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "deg": math.pi / 180, "rad": 1.0}[name]


# --- the log by mcap-ros2-support -------------------------------------------------------------------------------------


def decoded(log):
    messages = collections.defaultdict(list)
    sizes = collections.Counter()
    with open(log, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for schema, channel, message, sample in reader.iter_decoded_messages():
            messages[channel.topic].append((message.log_time, sample))
            sizes[channel.topic] += len(message.data)
            if channel.topic in VIEWED:
                check(schema.name == VIEWED[channel.topic], f"{channel.topic} is a {schema.name}")
    with open(log, "rb") as file:
        reader = make_reader(file)
        scene = tomllib.loads(next(reader.iter_attachments()).data.decode())
        info = next(data.metadata for data in reader.iter_metadata() if data.name == "softlimb.run")
    return messages, sizes, scene, info


def at(messages, time):
    """The message of a time."""
    found = min(messages, key=lambda message: abs(message[0] - time))
    return found[1] if abs(found[0] - time) < NEAR_NS else None


def frames_of(message):
    return {transform.child_frame_id: transform for transform in message.transforms}


def check_frames(name, messages, scene, info):
    """Frames are where scene, observer and kinematics have them."""
    limb = scene["limb"]
    static = frames_of(messages["/tf_static"][0][1])
    for message in [messages["/tf_static"][0][1], *(message for _, message in messages["/tf"])]:
        for transform in message.transforms:
            check(transform.header.frame_id == "world", f"{name}: {transform.child_frame_id} hangs in {transform.header.frame_id}")
            rotation = transform.transform.rotation
            length = math.hypot(rotation.x, rotation.y, rotation.z, rotation.w)
            check(abs(length - 1) < 1e-9, f"{name}: a rotation of {transform.child_frame_id} has length {length}")

    position = [si(value) for value in limb.get("base_position", [0, 0, 0])]
    along = unit(limb.get("base_direction", [0, 0, 1]))
    up = limb.get("base_up", [1, 0, 0])
    x = unit(minus(up, [dot(up, along) * value for value in along]))
    base = [list(row) for row in zip(x, cross(along, x), along)]
    seen = static["base"].transform
    check(norm(minus(vector(seen.translation), position)) < 1e-9, f"{name}: the base is not at base_position")
    check(difference(matrix(seen.rotation), base) < 1e-9, f"{name}: the base does not point along base_direction")

    for kind, key in [("obstacle", "obstacle"), ("region", "region")]:
        for solid in scene.get(key, []):
            pose = static[f"{kind}_{solid['name']}"].transform
            place, turn = vector(pose.translation), matrix(pose.rotation)
            if solid.get("shape") == "capsule":
                start, end = ([si(value) for value in solid[side]] for side in ("from", "to"))
                middle = [(p + q) / 2 for p, q in zip(start, end)]
                axis = [row[2] for row in turn]
                check(norm(cross(axis, unit(minus(end, start)))) < 1e-9, f"{name}: {solid['name']} points elsewhere")
            else:
                middle = [si(value) for value in solid["center"]]
            check(norm(minus(place, middle)) < 1e-9, f"{name}: {solid['name']} is not at its place")

    weightless = info["weightless"] == "true"
    worst = collections.Counter()
    modules = [module["name"] for module in scene["module"]]
    for time, message in messages["/tf"]:
        frames = frames_of(message)
        check(len(frames) == len(message.transforms), f"{name}: a frame comes twice in a message")
        tip = frames["tip"].transform
        pose = at(messages["/softlimb/tip"], time).pose
        check(vector(pose.position) == vector(tip.translation), f"{name}: /softlimb/tip is not at the frame of the tip")
        truth = at(messages["/softlimb/truth"], time)
        worst["tip"] = max(worst["tip"], norm(minus(vector(tip.translation), vector(truth.tip))))
        line = [vector(point) for point in at(messages["/softlimb/body"], time).line]
        for frame, transform in frames.items():
            if frame.startswith(("limb_", "connector_")):
                worst["line"] = max(worst["line"], off_line(vector(transform.transform.translation), line))
        check(set(f"connector_{module}" for module in modules) <= set(frames), f"{name}: a connector has no frame")
        if weightless:
            # Each bending module turns the tip about an axis across, each twisting one about its own.
            turn = base
            joints = at(messages["/softlimb/modules/achieved"], time)
            kinds = {module["name"]: module["quantity"] for module in json.loads(info["modules"])}
            for module, value in zip(joints.name, joints.position):
                mount = next(si(part.get("mount_angle", 0)) for part in scene["module"] if part["name"] == module)
                if kinds[module] == "bend_angle":
                    turn = times(turn, about([-math.sin(mount), math.cos(mount), 0], value))
                elif kinds[module] == "twist":
                    turn = times(turn, about([0, 0, 1], value))
                worst["turn"] = max(worst["turn"], difference(matrix(frames[f"connector_{module}"].transform.rotation), turn))
            worst["turn"] = max(worst["turn"], difference(matrix(tip.rotation), turn))
    check(worst["tip"] < 1e-9, f"{name}: the frame of the tip is {worst['tip']} m from the observed tip")
    # The middle of a chord is beside the arc.
    check(worst["line"] < 3e-3, f"{name}: a link is {worst['line']} m from the observed line")
    check(not weightless or worst["turn"] < 1e-9, f"{name}: a connector or the tip is turned by {worst['turn']}")
    check(len(messages["/tf"]) > 10, f"{name}: {len(messages['/tf'])} messages on /tf")


def check_carried(name, messages, info):
    """A carried object is at the tip while it is carried, and stays where the tip let it go."""
    carried = json.loads(info.get("carried", "[]"))
    for thing in carried:
        frame = f"object_{thing['name']}"
        places = [(time * 1e-9, frames_of(message)) for time, message in messages["/tf"]]
        check(all(frame in frames for _, frames in places), f"{name}: {frame} is not in every message")
        held = [(vector(frames[frame].transform.translation), vector(frames["tip"].transform.translation)) for time, frames in places if thing["from_s"] <= time <= thing["to_s"]]
        check(len(held) > 10 and all(norm(minus(*pair)) < 1e-12 for pair in held), f"{name}: {frame} is not at the tip")
        behind = [vector(frames[frame].transform.translation) for time, frames in places if time > thing["to_s"]]
        check(all(norm(minus(place, held[-1][0])) < 1e-12 for place in behind), f"{name}: {frame} moves by itself")
        start = frames_of(messages["/tf"][0][1])[frame].transform.translation
        check(norm(minus(vector(start), held[0][1])) < 0.1, f"{name}: {frame} does not start where it is taken")
    return carried


def check_description(name, messages, scene):
    """The description draws the limb, and obstacles with the sizes of the scene, in frames that exist."""
    robot = xml.fromstring(messages["/robot_description"][0][1].data)
    links = {link.get("name"): link for link in robot.iter("link")}
    known = set(frames_of(messages["/tf_static"][0][1])) | set(frames_of(messages["/tf"][0][1])) | {"world"}
    check(set(links) == known, f"{name}: links without a frame, or frames without a link: {set(links) ^ known}")
    children = [joint.find("child").get("link") for joint in robot.iter("joint")]
    check(sorted(children) == sorted(set(links) - {"world"}), f"{name}: a link does not hang in the world")
    static = frames_of(messages["/tf_static"][0][1])
    for joint in robot.iter("joint"):
        child = joint.find("child").get("link")
        check((joint.get("type") == "fixed") == (child in static), f"{name}: the joint of {child} is {joint.get('type')}")
        if child in static:
            roll, pitch, yaw = map(float, joint.find("origin").get("rpy").split())
            turn = times(about([0, 0, 1], yaw), times(about([0, 1, 0], pitch), about([1, 0, 0], roll)))
            check(difference(turn, matrix(static[child].transform.rotation)) < 1e-9, f"{name}: {child} is turned in the description")
            place = list(map(float, joint.find("origin").get("xyz").split()))
            check(norm(minus(place, vector(static[child].transform.translation))) < 1e-9, f"{name}: {child} is elsewhere in the description")
    for solid in scene.get("obstacle", []):
        link = links[f"obstacle_{solid['name']}"]
        shape = solid["shape"]
        if shape == "capsule":
            cylinder = link.find(".//cylinder")
            length = norm(minus(*([si(value) for value in solid[side]] for side in ("to", "from"))))
            sizes, expected = [cylinder.get("radius"), cylinder.get("length")], [si(solid["radius"]), length]
            check(len(link.findall(".//sphere")) == 2, f"{name}: the ends of {solid['name']} are not round")
        elif shape == "box":
            sizes, expected = link.find(".//box").get("size").split(), [si(value) for value in solid["size"]]
        else:
            sizes, expected = [link.find(".//sphere").get("radius")], [si(solid["radius"])]
        check(norm(minus(list(map(float, sizes)), expected)) < 1e-9, f"{name}: {solid['name']} has another size")
    return robot, links


def check_gaps(name, messages, links):
    """Neighbouring cylinders touch at every time."""
    count = sum(link.startswith("limb_") for link in links)
    sizes = [links[f"limb_{index}"].find(".//cylinder") for index in range(count)]
    widest = 0.0
    for _, message in messages["/tf"]:
        frames = frames_of(message)
        ends = []
        for index in range(count):
            pose = frames[f"limb_{index}"].transform
            place, axis = vector(pose.translation), [row[2] for row in matrix(pose.rotation)]
            half = float(sizes[index].get("length")) / 2
            ends.append([[p + side * half * a for p, a in zip(place, axis)] for side in (-1, 1)])
        for (_, end), (start, to) in zip(ends, ends[1:]):
            # How far the end of one falls short of the start of the next, along the next.
            widest = max(widest, dot(minus(start, end), unit(minus(to, start))))
    check(widest < 1e-4, f"{name}: a gap of {widest} m between cylinders")
    return count


def check_lines(name, messages, info):
    """The planned way is the setpoints' way; the trail is the tip's."""
    [(_, plan)] = messages["/softlimb/path/setpoint"]
    setpoints = messages["/softlimb/setpoint"]
    for place in plan.poses:
        stamp = place.header.stamp.sec * 10**9 + place.header.stamp.nanosec
        setpoint = at(setpoints, stamp)
        if setpoint:
            apart = norm(minus(vector(place.pose.position), vector(setpoint.tip)))
            check(apart < 0.02, f"{name}: the planned path is {apart} m from the setpoint")
    end = max(phase["start_s"] + phase["move_s"] + phase["hold_s"] for phase in json.loads(info["phases"]))
    check(abs(stamp * 1e-9 - end) < 1e-6, f"{name}: the planned path ends at {stamp * 1e-9} s")
    tips = messages["/softlimb/tip"]
    for time, trail in messages["/softlimb/path/tip"]:
        last = trail.poses[-1]
        check(vector(last.pose.position) == vector(at(tips, time).pose.position), f"{name}: the trail does not end at the tip")
        check(len(trail.poses) <= 102, f"{name}: a trail of {len(trail.poses)} poses")
    texts = [marker.text for _, array in messages["/softlimb/markers"] for marker in array.markers if marker.type == 9]
    check(len(texts) > 10 and all(text.startswith("tip error ") for text in texts), f"{name}: markers without text")
    lines = [marker for _, array in messages["/softlimb/markers"] for marker in array.markers if marker.type == 4]
    for (time, _), line in zip(messages["/softlimb/markers"], lines):
        setpoint = at(messages["/softlimb/shape"], time).setpoint
        check([vector(point) for point in line.points] == [vector(point) for point in setpoint], f"{name}: another line")


def check_imus(name, messages):
    """IMUs without errors have the orientations of the plates, and the rates at which these turn."""
    frames = {time: frames_of(message) for time, message in messages["/tf"]}
    last, count, moved = {}, 0, 0.0
    for time, reading in messages["/softlimb/imu"]:
        frame, turn = reading.header.frame_id, matrix(reading.orientation)
        check(reading.linear_acceleration_covariance[0] == -1, f"{name}: an acceleration of {frame}")
        if time in frames:
            apart = difference(turn, matrix(frames[time][frame].transform.rotation))
            check(apart < 1e-9, f"{name}: the IMU at {frame} is turned by {apart}")
            count += 1
        rate = vector(reading.angular_velocity)
        if frame in last:
            before, start = last[frame]
            angle = norm(rate) * (time - before) * 1e-9
            expected = times(start, about(rate, angle)) if angle else start
            check(difference(turn, expected) < 1e-7, f"{name}: the IMU at {frame} turns otherwise than at its rate")
            moved = max(moved, norm(rate))
        last[frame] = (time, turn)
    check(count > 100 and moved > 0.05, f"{name}: {count} orientations, {moved} rad/s")


def check_layout(name, messages):
    """Every topic and field of the layout for Foxglove is in the log, and the blueprint for rerun is written."""
    layout = json.loads((VIEWERS / "foxglove.json").read_text())["configById"]
    for topic in layout["3D!limb"]["topics"]:
        check(topic in messages, f"{name}: the layout shows {topic}, which is not in the log")
    paths = [path["value"] for panel in layout.values() for path in panel.get("paths", [])]
    check(len(paths) > 10, f"{name}: the layout plots {paths}")
    for path in paths:
        topic, field, index = re.fullmatch(r"(\S+)\.(\w+)(?:\[(\d+)\])?", path).groups()
        value = getattr(messages[topic][0][1], field, None) if topic in messages else None
        value = value[int(index)] if index and value else value
        check(isinstance(value, float), f"{name}: the layout plots {path}, which is not in the log")
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "run.mcap"
        subprocess.run([sys.executable, VIEWERS / "blueprint.py", log], check=True, env={**os.environ, "HOME": folder})
        check(log.with_suffix(".rbl").stat().st_size > 1000, f"{name}: no blueprint")


# --- the log by rosbags -----------------------------------------------------------------------------------------------


def check_rosbags(name, log):
    """Every message is deserialised, and the standard types are those of ROS 2."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    counts = collections.Counter()
    with AnyReader([log]) as reader:
        for connection, _, raw in reader.messages():
            reader.deserialize(raw, connection.msgtype)
            counts[connection.topic] += 1
        for connection in reader.connections:
            if connection.msgtype.startswith("softlimb_msgs"):
                continue
            own = get_typestore(Stores.EMPTY)
            own.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
            same = own.hash_rihs01(connection.msgtype) == store.hash_rihs01(connection.msgtype)
            check(same, f"{name}: {connection.msgtype} is not that of ROS 2")
            latched = connection.topic in ("/robot_description", "/tf_static", "/softlimb/path/setpoint")
            quality = connection.ext.offered_qos_profiles
            check(bool(quality) == latched, f"{name}: {connection.topic} offers {quality}")
            check(not latched or quality[0].durability.name == "TRANSIENT_LOCAL", f"{name}: {connection.topic} is not kept")
    check(set(VIEWED) <= set(counts), f"{name}: rosbags misses {set(VIEWED) - set(counts)}")


# --- the log by rerun -------------------------------------------------------------------------------------------------


def check_rerun(name, log, robot, links):
    """The limb and the obstacles are shapes that move with their frames, not opaque messages."""
    with tempfile.TemporaryDirectory() as folder:
        # In an empty home rerun sends no usage report, and leaves no settings.
        environment = {**os.environ, "HOME": folder}
        recording = pathlib.Path(folder) / "log.rrd"
        rerun = [sys.executable, "-m", "rerun_cli"]
        subprocess.run([*rerun, "mcap", "convert", log, "-o", recording], check=True, env=environment, capture_output=True)
        printed = subprocess.run([*rerun, "rrd", "print", recording], check=True, env=environment, capture_output=True, text=True).stdout
    entities = collections.defaultdict(str)
    for entity, columns in re.findall(r"^Chunk\(\w+\) with \d+ rows \([^)]*\) - (\S+) - .*data columns: \[(.*)\]", printed, re.MULTILINE):
        entities[entity] += columns
    drawn = collections.Counter()
    for link, element in links.items():
        visuals = "".join(columns for entity, columns in entities.items() if entity.startswith(f"/{robot}/visual_geometries/{link}/"))
        for tag, shape in [("cylinder", "Cylinders3D:"), ("box", "Boxes3D:"), ("sphere", "Ellipsoids3D:")]:
            if element.find(f".//{tag}") is not None:
                check(shape in visuals, f"{name}: rerun draws no {tag} for {link}")
                drawn[tag] += 1
    check("Transform3D:" in entities["/tf"] and "Transform3D:" in entities["/tf_static"], f"{name}: no transforms for rerun")
    check("InstancePoses3D:" in entities["/softlimb/tip"], f"{name}: no tip for rerun")
    return drawn


def main():
    for log in map(pathlib.Path, sys.argv[1:]):
        name = log.parent.name
        messages, sizes, scene, info = decoded(log)
        check(set(VIEWED) <= set(messages), f"{name}: no {set(VIEWED) - set(messages)}")
        check_frames(name, messages, scene, info)
        check_carried(name, messages, info)
        robot, links = check_description(name, messages, scene)
        cylinders = check_gaps(name, messages, links)
        check_lines(name, messages, info)
        check_layout(name, messages)
        check(("imu" in scene) == ("/softlimb/imu" in messages), f"{name}: readings of IMUs that the scene does not have, or none")
        if "imu" in scene:
            check_imus(name, messages)
        check_rosbags(name, log)
        drawn = check_rerun(name, log, robot.get("name"), links)
        seconds = (messages["/tf"][-1][0] - messages["/tf"][0][0]) * 1e-9
        viewed = sum(sizes[topic] for topic in VIEWED)
        print(f"{name}: {cylinders} links; in rerun {dict(drawn)}; {viewed / seconds:.0f} bytes a second for viewers of {sum(sizes.values()) / seconds:.0f}; file {log.stat().st_size} bytes")
        print("  " + ", ".join(f"{topic} {sizes[topic]}" for topic in VIEWED))
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
