"""A ROS 2 node: the limb of a scene on the simulated device, led by messages. Topics, types and frames are those of a log.

    source /opt/ros/jazzy/setup.bash                 # rclpy is part of ROS 2, not of PyPI
    python ros2_node.py --ros-args -p scene:=scenes/weightless-a.toml
    ros2 topic pub --once /softlimb/modules/command sensor_msgs/msg/JointState "{name: [elbow], position: [0.5]}"
"""

import rclpy
from geometry_msgs.msg import PoseStamped, TransformStamped
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Bool, Empty, Header, String
from tf2_msgs.msg import TFMessage

import softlimb

PERIOD_S = 0.02
"""Time of the limb in one turn of the timer: it keeps the time of the computer."""
DEPTH = 10
PARTS = ("setpoint", "modelled", "achieved")


class LimbNode:
    """The limb and its topics."""

    def __init__(self) -> None:
        node = self.node = rclpy.create_node("softlimb")
        scene = softlimb.Scene.load(node.declare_parameter("scene", "scenes/weightless-a.toml").value)
        log = node.declare_parameter("log", "").value
        self.session = scene.session(log or None, seed=node.declare_parameter("seed", 1).value)
        self.commands: list[JointState] = []
        self.gripping: bool | None = None
        self.vents = False

        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        urdf, frames = scene.description()
        node.create_publisher(String, "/robot_description", latched).publish(String(data=urdf))
        node.create_publisher(TFMessage, "/tf_static", latched).publish(self.transforms(frames))
        self.tf = node.create_publisher(TFMessage, "/tf", DEPTH)
        self.tip = node.create_publisher(PoseStamped, "/softlimb/tip", DEPTH)
        self.modules = {part: node.create_publisher(JointState, f"/softlimb/modules/{part}", DEPTH) for part in PARTS}
        self.pressures = [
            node.create_publisher(FluidPressure, f"/softlimb/gauge_pressure/channel_{channel}", DEPTH)
            for channel in range(len(self.session.observation.pressure_pa))
        ]
        node.create_subscription(JointState, "/softlimb/modules/command", self.commands.append, DEPTH)
        node.create_subscription(Bool, "/softlimb/gripper/command", self.grip, DEPTH)
        node.create_subscription(Empty, "/softlimb/vent", self.vent, DEPTH)
        self.timer = node.create_timer(PERIOD_S, self.advance)

    def grip(self, message: Bool) -> None:
        self.gripping = message.data

    def vent(self, _: Empty) -> None:
        self.vents = True

    def advance(self) -> None:
        """One turn of the timer: hands over what was commanded, lets the limb move, publishes."""
        if self.vents:
            self.vents, self.gripping = False, None
            self.commands.clear()
            seen = self.session.vent()
        elif self.gripping is not None:
            gripping, self.gripping = self.gripping, None
            seen = self.refused(self.session.step(PERIOD_S, gripping=gripping))
        elif self.commands:
            seen = self.refused(self.session.step(PERIOD_S, self.setpoints()))
        else:
            seen = self.session.step(PERIOD_S)
        # The limb is observed at 10 Hz, as in a log.
        if seen.frames_time_s == seen.time_s:
            self.publish(seen)

    def setpoints(self) -> list[float]:
        """The last setpoints with the positions of all commands since; names that the limb does not have are reported."""
        wanted = dict(zip(self.session.drives, self.session.observation.setpoint.tolist(), strict=True))
        for command in self.commands:
            for name, position in zip(command.name, command.position, strict=False):
                if name in wanted:
                    wanted[name] = position
                else:
                    self.node.get_logger().warning(f"no module {name!r}: {', '.join(wanted)}")
        self.commands.clear()
        return list(wanted.values())

    def refused(self, seen: softlimb.Observation) -> softlimb.Observation:
        if seen.refusal is not None:
            self.node.get_logger().warning(f"refused: {seen.refusal}")
        return seen

    def publish(self, seen: softlimb.Observation) -> None:
        header = self.header()
        self.tf.publish(self.transforms(seen.frames))
        tip = PoseStamped(header=header)
        place, turn = tip.pose.position, tip.pose.orientation
        place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = seen.frames["tip"]
        self.tip.publish(tip)
        for part, publisher in self.modules.items():
            positions = getattr(seen, part).tolist()
            publisher.publish(JointState(header=header, name=list(self.session.drives), position=positions))
        for publisher, pressure_pa in zip(self.pressures, seen.pressure_pa.tolist(), strict=True):
            # A gauge pressure, as the name of the topic says.
            publisher.publish(FluidPressure(header=header, fluid_pressure=pressure_pa))

    def transforms(self, frames: dict[str, tuple[float, ...]]) -> TFMessage:
        """Frames in the world."""
        transforms = []
        for name, pose in frames.items():
            moved = TransformStamped(header=self.header(), child_frame_id=name)
            place, turn = moved.transform.translation, moved.transform.rotation
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = pose
            transforms.append(moved)
        return TFMessage(transforms=transforms)

    def header(self) -> Header:
        return Header(stamp=self.node.get_clock().now().to_msg(), frame_id="world")


def main() -> None:
    rclpy.init()
    limb = LimbNode()
    try:
        rclpy.spin(limb.node)
    except KeyboardInterrupt:
        pass
    finally:
        limb.session.close()
        limb.node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
