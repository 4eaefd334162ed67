"""The part of rclpy that the example node uses, in one process and in virtual time.

rclpy does not come from PyPI. Its messages are those of rosbags' tables of ROS 2 Jazzy: a field that a type does not have is refused, and every published
message passes through its encoding for the wire.
"""

import sys
from types import ModuleType, SimpleNamespace

import numpy as np
from rosbags.typesys import Stores, get_typestore
from rosbags.interfaces import Nodetype

STORE = get_typestore(Stores.ROS2_JAZZY)


class Message:
    """A message with the fields of its type, all at their defaults."""

    TYPE = ""

    def __init__(self, **fields):
        for name, kind in STORE.fielddefs[self.TYPE][1]:
            object.__setattr__(self, name, default(kind))
        for name, value in fields.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        if name not in self.__dict__:
            raise AttributeError(f"{self.TYPE} has no field {name}")
        object.__setattr__(self, name, value)


def of(name):
    """The class of a type."""
    return type(name.split("/")[-1], (Message,), {"TYPE": name})


def default(kind):
    node, of_kind = kind
    if node == Nodetype.BASE:
        return {"string": "", "bool": False}.get(of_kind[0], 0.0 if of_kind[0].startswith("float") else 0)
    return of(of_kind)() if node == Nodetype.NAME else []


def encoded(message):
    """The message of rosbags with the same content, through its encoding for the wire."""
    name = message.TYPE
    return STORE.deserialize_cdr(STORE.serialize_cdr(plain(message), name), name)


def plain(message):
    fields = {}
    for name, (node, kind) in STORE.fielddefs[message.TYPE][1]:
        value = getattr(message, name)
        if node == Nodetype.NAME:
            value = plain(value)
        elif node == Nodetype.SEQUENCE:
            (inner, of_inner), _ = kind
            if inner == Nodetype.NAME:
                value = [plain(element) for element in value]
            elif of_inner[0] != "string":
                value = np.array(value, dtype=of_inner[0])
        fields[name] = value
    return STORE.types[message.TYPE](**fields)


class Node:
    """A node whose timer turns as its script says."""

    def __init__(self, ros):
        self.ros = ros
        self.turn = None

    def declare_parameter(self, name, default):
        value = self.ros.parameters.get(name, default)
        assert type(value) is type(default)
        return SimpleNamespace(value=value)

    def create_publisher(self, kind, topic, quality):
        published = self.ros.published.setdefault(topic, [])
        self.ros.qualities[topic] = quality

        def publish(message):
            assert type(message) is kind
            published.append(encoded(message))

        return SimpleNamespace(publish=publish)

    def create_subscription(self, kind, topic, callback, depth):
        self.ros.subscribed[topic] = (kind, callback)

    def create_timer(self, period_s, callback):
        assert period_s > 0
        self.turn = callback

    def get_clock(self):
        stamp = self.ros.messages["builtin_interfaces/msg/Time"](sec=self.ros.turns // 50)
        return SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: stamp))

    def get_logger(self):
        return SimpleNamespace(warning=self.ros.warnings.append)

    def destroy_node(self):
        self.ros.destroyed = True


class Ros:
    """ROS with one node. ``script`` has messages to a topic by the turn of the timer before which they arrive."""

    def __init__(self, parameters, script, turns):
        self.parameters, self.script, self.length = parameters, script, turns
        self.published, self.qualities, self.subscribed, self.warnings = {}, {}, {}, []
        self.turns, self.destroyed = 0, False
        self.messages = {name: of(name) for name in STORE.fielddefs}

    def spin(self, node):
        """Ends like a node that is interrupted."""
        for self.turns in range(self.length):
            for topic, fields in self.script.get(self.turns, []):
                kind, callback = self.subscribed[topic]
                callback(kind(**fields))
            node.turn()
        raise KeyboardInterrupt

    def modules(self):
        """What the node imports."""
        rclpy = ModuleType("rclpy")
        rclpy.init = rclpy.try_shutdown = lambda: None
        rclpy.create_node = lambda name: Node(self)
        rclpy.spin = self.spin
        qos = ModuleType("rclpy.qos")
        qos.QoSProfile = SimpleNamespace
        qos.DurabilityPolicy = SimpleNamespace(TRANSIENT_LOCAL="transient local")
        made = {"rclpy": rclpy, "rclpy.qos": qos}
        for name, kind in self.messages.items():
            package, folder, short = name.split("/")
            made.setdefault(package, ModuleType(package))
            setattr(made.setdefault(f"{package}.{folder}", ModuleType(f"{package}.{folder}")), short, kind)
        assert not set(made) & set(sys.modules)
        return made
