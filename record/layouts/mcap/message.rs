//! ROS 2 messages: their definitions, and how they are encoded.
//!
//! Encoded as Common Data Representation (CDR of OMG, little-endian, in its version 1): numbers are aligned to their size from behind
//! the four bytes of its head. Definitions are those of `common_interfaces`, without comments.

use nalgebra::Isometry3;

/// A kind of message.
pub struct Kind {
    /// Such as `sensor_msgs/msg/Image`.
    pub name: &'static str,
    /// Its fields.
    fields: &'static str,
    /// The kinds of its fields and theirs.
    parts: &'static [&'static Kind],
}

impl Kind {
    /// Its fields, and those of its parts.
    pub fn definition(&self) -> String {
        let line = "=".repeat(80);
        let part = |part: &&Kind| format!("{line}\nMSG: {}\n{}", part.name.replace("/msg/", "/"), part.fields);
        self.fields.to_owned() + &self.parts.iter().map(part).collect::<String>()
    }
}

const TIME: Kind = Kind { name: "builtin_interfaces/msg/Time", fields: "int32 sec\nuint32 nanosec\n", parts: &[] };
const HEADER: Kind =
    Kind { name: "std_msgs/msg/Header", fields: "builtin_interfaces/Time stamp\nstring frame_id\n", parts: &[] };
const POINT: Kind = Kind { name: "geometry_msgs/msg/Point", fields: "float64 x\nfloat64 y\nfloat64 z\n", parts: &[] };
const VECTOR: Kind =
    Kind { name: "geometry_msgs/msg/Vector3", fields: "float64 x\nfloat64 y\nfloat64 z\n", parts: &[] };
const QUATERNION: Kind = Kind {
    name: "geometry_msgs/msg/Quaternion",
    fields: "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    parts: &[],
};
const POSE: Kind = Kind {
    name: "geometry_msgs/msg/Pose",
    fields: "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    parts: &[],
};
const TWIST: Kind = Kind {
    name: "geometry_msgs/msg/Twist",
    fields: "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    parts: &[],
};
const SOME_POSE: Kind = Kind {
    name: "geometry_msgs/msg/PoseWithCovariance",
    fields: "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
    parts: &[],
};
const SOME_TWIST: Kind = Kind {
    name: "geometry_msgs/msg/TwistWithCovariance",
    fields: "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
    parts: &[],
};
const TRANSFORM: Kind = Kind {
    name: "geometry_msgs/msg/Transform",
    fields: "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    parts: &[],
};
const SOME_TRANSFORM: Kind = Kind {
    name: "geometry_msgs/msg/TransformStamped",
    fields: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    parts: &[],
};
const REGION: Kind = Kind {
    name: "sensor_msgs/msg/RegionOfInterest",
    fields: "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n",
    parts: &[],
};
const FIELD: Kind = Kind {
    name: "sensor_msgs/msg/PointField",
    fields: "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
        uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
    parts: &[],
};

/// An image.
pub const IMAGE: Kind = Kind {
    name: "sensor_msgs/msg/Image",
    fields: "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
    parts: &[&HEADER, &TIME],
};
/// A calibrated camera.
pub const CAMERA_INFO: Kind = Kind {
    name: "sensor_msgs/msg/CameraInfo",
    fields: "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n\
        float64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n",
    parts: &[&HEADER, &TIME, &REGION],
};
/// Points.
pub const POINTS: Kind = Kind {
    name: "sensor_msgs/msg/PointCloud2",
    fields: "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n\
        uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
    parts: &[&HEADER, &TIME, &FIELD],
};
/// A measurement of an IMU.
pub const IMU: Kind = Kind {
    name: "sensor_msgs/msg/Imu",
    fields: "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
        geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
        geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    parts: &[&HEADER, &TIME, &QUATERNION, &VECTOR],
};
/// A pose and speeds.
pub const ODOMETRY: Kind = Kind {
    name: "nav_msgs/msg/Odometry",
    fields: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
        geometry_msgs/TwistWithCovariance twist\n",
    parts: &[&HEADER, &TIME, &SOME_POSE, &POSE, &POINT, &QUATERNION, &SOME_TWIST, &TWIST, &VECTOR],
};
/// Frames in frames.
pub const TF: Kind = Kind {
    name: "tf2_msgs/msg/TFMessage",
    fields: "geometry_msgs/TransformStamped[] transforms\n",
    parts: &[&SOME_TRANSFORM, &HEADER, &TIME, &TRANSFORM, &VECTOR, &QUATERNION],
};

/// A message that is being encoded: its head, then what follows it.
pub struct Cdr(Vec<u8>);

/// Little-endian, version 1.
const HEAD: [u8; 4] = [0, 1, 0, 0];

impl Default for Cdr {
    fn default() -> Self {
        Self(HEAD.to_vec())
    }
}

impl Cdr {
    /// A message that begins with a header.
    pub fn stamped(time_ns: i64, frame: &str) -> Self {
        let mut cdr = Self::default();
        cdr.header(time_ns, frame);
        cdr
    }

    /// A header: a time and the name of a frame.
    pub fn header(&mut self, time_ns: i64, frame: &str) {
        self.u32(time_ns.div_euclid(1_000_000_000) as u32);
        self.u32(time_ns.rem_euclid(1_000_000_000) as u32);
        self.text(frame);
    }

    /// A position, or a translation, and a quaternion.
    pub fn pose(&mut self, pose: &Isometry3<f64>) {
        self.f64s(pose.translation.vector.as_slice());
        self.f64s(pose.rotation.coords.as_slice());
    }

    /// A byte, or whether something is so.
    pub fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    /// A number, or the length of what follows.
    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// An array of known length.
    pub fn f64s(&mut self, values: &[f64]) {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }

    /// A text, with a zero at its end.
    pub fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// An array of bytes with its length.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.u32(bytes.len() as u32);
        self.0.extend(bytes);
    }

    /// The message.
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, size: usize) {
        let end = (self.0.len() - HEAD.len()).next_multiple_of(size) + HEAD.len();
        self.0.resize(end, 0);
    }
}
