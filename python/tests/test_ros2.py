"""The example node beside the log of its own session, which the package writes without it."""

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rosbags")
from ros2_stand_in import STORE, Ros, encoded  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402

ROOT = Path(__file__).parents[2]
NODE = ROOT / "python" / "examples" / "ros2_node.py"
SCENE = ROOT / "scenes" / "weightless-a.toml"
ELBOW_RAD = 0.5
SCRIPT = {
    20: [("/softlimb/modules/command", {"name": ["elbow", "knee"], "position": [ELBOW_RAD, 1.0]})],
    150: [("/softlimb/modules/command", {"name": ["wrist"], "position": [9.0]})],
    160: [("/softlimb/vent", {})],
}


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """What the node published, and the log of the session."""
    folder = tmp_path_factory.mktemp("node")
    ros = Ros({"scene": str(SCENE), "log": str(folder), "seed": 3}, SCRIPT, 260)
    with pytest.MonkeyPatch.context() as patch:
        for name, module in ros.modules().items():
            patch.setitem(sys.modules, name, module)
        spec = importlib.util.spec_from_file_location("ros2_node", NODE)
        node = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(node)
        node.main()
    logged = {}
    with AnyReader([folder / "run.mcap"]) as reader:
        for connection, _, raw in reader.messages(c for c in reader.connections if c.topic in ros.published):
            logged.setdefault(connection.topic, []).append(STORE.deserialize_cdr(raw, connection.msgtype))
    return ros, logged


def content(message):
    """Numbers and words of a message but for its times."""
    if isinstance(message, (str, bytes)):
        return [message]
    if isinstance(message, (list, np.ndarray)):
        return [part for element in message for part in content(element)]
    if not hasattr(message, "__dataclass_fields__"):
        return [message]
    fields = [name for name in message.__dataclass_fields__ if name not in ("stamp", "__msgtype__")]
    return [part for name in fields for part in content(getattr(message, name))]


def test_messages_are_those_of_the_log(ran):
    ros, logged = ran
    moving = set(ros.published) - {"/robot_description", "/tf_static"}
    assert moving == {"/tf", "/softlimb/tip"} | {
        *(f"/softlimb/modules/{part}" for part in ("setpoint", "modelled", "achieved")),
        *(f"/softlimb/gauge_pressure/channel_{channel}" for channel in range(9)),
    }
    for topic in ("/robot_description", "/tf_static"):
        assert [content(message) for message in ros.published[topic]] == [content(message) for message in logged[topic]]
        assert ros.qualities[topic].durability == "transient local"
    for topic in moving:
        published = [content(message) for message in ros.published[topic]]
        # The log goes on where the node does not look: while the pressures go down, and behind its end.
        known = iter([content(message) for message in logged[topic]])
        assert len(published) > 40, topic
        assert all(message in known for message in published), f"{topic}: not the messages of the log in their order"


def test_limb_follows_the_commands(ran):
    ros, _ = ran
    names, elbow = ros.published["/softlimb/modules/setpoint"][0].name, []
    index = names.index("elbow")
    for part in ("setpoint", "achieved"):
        elbow.append([message.position[index] for message in ros.published[f"/softlimb/modules/{part}"]])
    setpoint, achieved = np.array(elbow)
    # 130 turns of 0.02 s lie between the two commands, and the limb is seen five times slower.
    assert setpoint[28] == pytest.approx(ELBOW_RAD, abs=1e-5)
    assert achieved[28] == pytest.approx(ELBOW_RAD, rel=0.25)
    assert abs(setpoint[-1]) < 1e-5 and abs(achieved[-1]) < 0.05
    assert [warning.split(":")[0] for warning in ros.warnings] == ["no module 'knee'", "refused"]
    assert ros.destroyed


def test_stand_in_refuses_what_ros_refuses():
    messages = Ros({}, {}, 0).messages
    with pytest.raises(AttributeError, match="has no field positon"):
        messages["sensor_msgs/msg/JointState"](positon=[1.0])
    pressure = encoded(messages["sensor_msgs/msg/FluidPressure"](fluid_pressure=math.pi))
    assert pressure.fluid_pressure == math.pi
