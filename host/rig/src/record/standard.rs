//! Standard ROS messages beside our own, thinned, so that viewers plot a run
//! without knowing our types. Written only: everything in them is read back from
//! the full-rate topics.

use super::cdr::CdrWriter;
use super::messages::{HEADER, MessageType, QUATERNION, TIME, VECTOR, begin, stamp};

/// Rate of the standard topics, 1/s.
pub(super) const RATE_HZ: f64 = 10.0;

/// One pressure. The field holds *gauge* pressure, as the topic name says.
pub(super) const FLUID_PRESSURE: MessageType = MessageType::new(
    "sensor_msgs/msg/FluidPressure",
    "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
    &[HEADER, TIME],
);

/// Positions by name: a module's deformation in the SI unit of its quantity.
pub(super) const JOINT_STATE: MessageType = MessageType::new(
    "sensor_msgs/msg/JointState",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    &[HEADER, TIME],
);

/// Orientation and angular rate of an IMU.
pub(super) const IMU: MessageType = MessageType::new(
    "sensor_msgs/msg/Imu",
    "std_msgs/Header header\n\
     geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
     geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
     geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    &[HEADER, TIME, QUATERNION, VECTOR],
);

/// Topic of one channel's pressure.
pub(super) fn pressure_topic(channel: usize) -> String {
    format!("/softlimb/gauge_pressure/channel_{channel}")
}

/// Encodes one pressure; a variance of zero means "unknown" in this type.
pub(super) fn encode_fluid_pressure(unix_ns: u64, pressure_pa: f64) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(pressure_pa);
    cdr.f64(0.0);
    cdr.into_bytes()
}

/// Encodes a reading of an IMU in its frame. Covariances of zero mean "unknown" in this type, and one that begins with -1 that the value is not given.
pub(super) fn encode_imu(unix_ns: u64, frame: &str, orientation: [f64; 4], rate_rad_per_s: [f64; 3]) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    stamp(&mut cdr, unix_ns, frame);
    let [unknown, not_given] = [0.0, -1.0].map(|first| [first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let values = orientation.into_iter().chain(unknown).chain(rate_rad_per_s).chain(unknown);
    values.chain([0.0; 3]).chain(not_given).for_each(|value| cdr.f64(value));
    cdr.into_bytes()
}

/// Encodes named positions without velocities and efforts.
pub(super) fn encode_joint_state<'a>(
    unix_ns: u64,
    joints: impl ExactSizeIterator<Item = (&'a str, f64)> + Clone,
) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.length(joints.len());
    joints.clone().for_each(|(name, _)| cdr.string(name));
    cdr.f64_sequence(joints.map(|(_, position)| position));
    cdr.length(0);
    cdr.length(0);
    cdr.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imu_has_the_bytes_laid_out_by_hand() {
        let message = encode_imu(0, "connector_a", [0.0, 0.0, 0.0, 1.0], [2.0, 0.0, 0.0]);
        // Header of 8 bytes and a frame of 4 + 12, then 37 numbers from 24 on, after the 4 bytes of the representation.
        assert_eq!(message.len(), 4 + 24 + 37 * 8);
        let number = |index: usize| f64::from_le_bytes(message[28 + 8 * index..][..8].try_into().unwrap());
        let expected = [(3, 1.0), (13, 2.0), (28, -1.0)];
        for index in 0..37 {
            let value = expected.iter().find(|(at, _)| *at == index).map_or(0.0, |(_, value)| *value);
            assert_eq!(number(index), value, "{index}");
        }
        assert_eq!(&message[16..28], b"connector_a\0");
    }

    #[test]
    fn fluid_pressure_has_the_bytes_laid_out_by_hand() {
        let mut expected = vec![0, 1, 0, 0];
        expected.extend([2, 0, 0, 0]); // sec 2 at 0
        expected.extend([0x00, 0x65, 0xcd, 0x1d]); // nanosec 500 000 000 at 4
        expected.extend([6, 0, 0, 0, b'w', b'o', b'r', b'l', b'd', 0]); // frame at 8..18
        expected.extend([0; 6]); // padding to 24
        expected.extend([0, 0, 0, 0, 0, 0x6a, 0xf8, 0x40]); // 100 000.0 at 24
        expected.extend([0; 8]); // variance at 32
        assert_eq!(encode_fluid_pressure(2_500_000_000, 100_000.0), expected);
    }
}
