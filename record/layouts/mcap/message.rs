//! The kinds of messages of a recording.

use plume_exporters::format::ros2::{HEADER, Kind, POINT, POSE, QUATERNION, TIME};

const VECTOR: Kind =
    Kind { name: "geometry_msgs/msg/Vector3", fields: "float64 x\nfloat64 y\nfloat64 z\n", parts: &[] };
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
