//! All conversions of axes, UV origin and rotation notation for targets.
//!
//! The scene is in metres, right-handed, Z up, with the UV origin at the lower left of the image.
//!
//! ```
//! use plume_exporters::frame;
//!
//! // glTF is Y up; Unreal is left-handed, in centimetres.
//! assert_eq!(frame::gltf_from_scene([1.0, 2.0, 3.0]), [1.0, 3.0, -2.0]);
//! assert_eq!(frame::unreal_from_scene([1.0, 2.0, 3.0]), [100.0, -200.0, 300.0]);
//! ```

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A coordinate frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axes {
    /// The axis that points up.
    pub up: Up,
    /// Handedness: whether x, y and z are thumb, index and middle finger of the right or of the left hand.
    pub handedness: Handedness,
    /// Length of a unit in metres.
    pub metres_per_unit: f64,
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// The second, as in glTF.
    Y,
    /// The third, as in the scene.
    Z,
}

/// Handedness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Handedness {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl Axes {
    /// The scene: metres, right-handed, Z up.
    pub const SCENE: Self = Self { up: Up::Z, handedness: Handedness::Right, metres_per_unit: 1.0 };
    /// glTF: metres, right-handed, Y up.
    pub const GLTF: Self = Self { up: Up::Y, handedness: Handedness::Right, metres_per_unit: 1.0 };
    /// Unity: metres, left-handed, Y up.
    pub const UNITY: Self = Self { up: Up::Y, handedness: Handedness::Left, metres_per_unit: 1.0 };
}

/// A scene vector in the frame of glTF, which is Y up: a quarter turn about x, exact in any precision.
pub fn gltf_from_scene<T: Copy + std::ops::Neg<Output = T>>([x, y, z]: [T; 3]) -> [T; 3] {
    [x, z, -y]
}

/// A scene tangent in the frame of glTF.
///
/// The handedness stays: the rotation is proper, and the bitangent of glTF points up in the image like ours, against its
/// own v (<https://github.com/KhronosGroup/glTF-Sample-Models/issues/174>).
pub fn gltf_tangent_from_scene([x, y, z, w]: [f32; 4]) -> [f32; 4] {
    let [x, y, z] = gltf_from_scene([x, y, z]);
    [x, y, z, w]
}

/// A texture coordinate with the UV origin moved from the lower to the upper left of the image.
pub fn upper_left_uv([u, v]: [f32; 2]) -> [f32; 2] {
    [u, 1.0 - v]
}

/// A scene pose in the frame of glTF: position, and rotation as x, y, z, w.
pub fn gltf_pose_from_scene(scene_from_body: &Isometry3<f64>) -> ([f64; 3], [f64; 4]) {
    let turn = gltf_turn_from_scene() * scene_from_body.rotation.to_rotation_matrix().matrix();
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(turn));
    (gltf_from_scene(scene_from_body.translation.vector.into()), rotation.coords.into())
}

/// A turn of the scene as one of the frame of glTF: x, y, z, w.
pub fn gltf_rotation_from_scene(turn: &UnitQuaternion<f64>) -> [f64; 4] {
    let [x, y, z] = gltf_from_scene([turn.i, turn.j, turn.k]);
    [x, y, z, turn.w]
}

/// A pose of the scene as one of the frame of glTF, for a body whose own frame is that of glTF as well.
pub fn gltf_isometry_from_scene(pose: &Isometry3<f64>) -> Isometry3<f64> {
    let [x, y, z, w] = gltf_rotation_from_scene(&pose.rotation);
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(gltf_from_scene(<[f64; 3]>::from(pose.translation.vector)).into(), rotation)
}

fn gltf_turn_from_scene() -> Matrix3<f64> {
    Matrix3::from([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(gltf_from_scene::<f64>))
}

/// A scene vector in the frame of Unity, which is left-handed and Y up: the result of its FBX importer, which negates x, for
/// a file in the frame of glTF.
pub fn unity_from_scene<T: Copy + std::ops::Neg<Output = T>>(scene: [T; 3]) -> [T; 3] {
    let [x, y, z] = gltf_from_scene(scene);
    [-x, y, z]
}

/// A turn of the scene as one of the frame of Unity: x, y, z, w. It is about the mirrored axis, the other way round.
pub fn unity_rotation_from_scene(turn: &UnitQuaternion<f64>) -> [f64; 4] {
    let [x, y, z] = unity_from_scene([turn.i, turn.j, turn.k]);
    [-x, -y, -z, turn.w]
}

/// The pose of a body in the frame of Unity: position, and rotation as x, y, z, w. A body faces along its +X with +Z up in
/// the scene, and along its +Z with +Y up in Unity.
pub fn unity_pose_from_scene(scene_from_body: &Isometry3<f64>) -> ([f64; 3], [f64; 4]) {
    let axes = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let turned = axes.map(|axis| unity_from_scene((scene_from_body.rotation * Vector3::from(axis)).into()));
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(Matrix3::from(turned)));
    (unity_from_scene(scene_from_body.translation.vector.into()), rotation.coords.into())
}

/// The pose of a camera of USD or MuJoCo, which looks along its −Z with +Y up, from that of a body that looks along +X
/// with +Z up.
pub fn camera_from_body(scene_from_body: &Isometry3<f64>) -> Isometry3<f64> {
    let body_from_camera = Matrix3::new(0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    scene_from_body * UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(body_from_camera))
}

/// A pose as position and angles about fixed x, y, z: metres and radians.
pub fn euler_pose(pose: &Isometry3<f64>) -> ([f64; 3], [f64; 3]) {
    (pose.translation.vector.into(), roll_pitch_yaw(pose.rotation.to_rotation_matrix().matrix()))
}

/// A scene pose in the frame of glTF, as position and angles about fixed x, y, z: metres and radians.
pub fn gltf_euler_pose_from_scene(scene_from_body: &Isometry3<f64>) -> ([f64; 3], [f64; 3]) {
    let turn = gltf_turn_from_scene() * scene_from_body.rotation.to_rotation_matrix().matrix();
    (gltf_from_scene(scene_from_body.translation.vector.into()), roll_pitch_yaw(&turn))
}

/// A scene point in the frame of Unreal, which is left-handed and Z up, in centimetres: the result of its importer for a
/// file in the scene's frame and unit.
pub fn unreal_from_scene([x, y, z]: [f64; 3]) -> [f64; 3] {
    [100.0 * x, -100.0 * y, 100.0 * z]
}

/// A scene pose in the frame of Unreal: location in centimetres, and roll, pitch and yaw of its rotator in degrees.
///
/// A rotator rotates about x, then y, then z like our angles. Looking along +X, it rolls clockwise like ours, but pitches up
/// and yaws right, while ours go down and left.
pub fn unreal_pose_from_scene(scene_from_body: &Isometry3<f64>) -> ([f64; 3], [f64; 3]) {
    let (location, [roll, pitch, yaw]) = euler_pose(scene_from_body);
    (unreal_from_scene(location), [roll, -pitch, -yaw].map(f64::to_degrees))
}

/// A pose in the notation of SDF and URDF, `x y z roll pitch yaw`: metres and radians about fixed x, y, z, to the micrometre
/// and the microradian.
pub fn sdf_pose(pose: &Isometry3<f64>) -> String {
    let ([x, y, z], [roll, pitch, yaw]) = euler_pose(pose);
    [x, y, z, roll, pitch, yaw].map(micro).join(" ")
}

/// Angles about fixed x, y, z; not nalgebra's, because libm gives the same bits everywhere.
fn roll_pitch_yaw(m: &Matrix3<f64>) -> [f64; 3] {
    let cos_pitch = (m[(0, 0)] * m[(0, 0)] + m[(1, 0)] * m[(1, 0)]).sqrt();
    let pitch = libm::atan2(-m[(2, 0)], cos_pitch);
    // Gimbal lock: roll and yaw are one angle, which is assigned to yaw.
    if cos_pitch < 1e-9 {
        return [0.0, pitch, libm::atan2(-m[(0, 1)], m[(1, 1)])];
    }
    [libm::atan2(m[(2, 1)], m[(2, 2)]), pitch, libm::atan2(m[(1, 0)], m[(0, 0)])]
}

/// A number to a thousandth: a length in metres to millimetres.
pub fn milli(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// A number to six decimals, without trailing zeros and without minus zero.
pub fn micro(number: f64) -> String {
    let text = format!("{number:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Translation3};

    use super::*;

    #[test]
    fn up_and_handedness_are_preserved() {
        assert_eq!(gltf_from_scene([0.0, 0.0, 1.0]), [0.0, 1.0, 0.0]);
        let [x, y, z] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| Vector3::from(gltf_from_scene(axis)));
        assert_eq!(x.cross(&y), z);
    }

    #[test]
    fn a_pose_moves_points_as_the_frame_change_does() {
        let pose =
            Isometry3::from_parts(Translation3::new(1.0, -2.0, 3.0), UnitQuaternion::from_euler_angles(0.3, -0.4, 2.0));
        let ([x, y, z], [i, j, k, w]) = gltf_pose_from_scene(&pose);
        let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k));
        let body = Point3::new(0.5, 0.25, -1.5);
        let there = turn * body + Vector3::new(x, y, z);
        let expected = Point3::from(gltf_from_scene((pose * body).coords.into()));
        assert!((there - expected).norm() < 1e-12);
    }

    #[test]
    fn unity_is_left_handed() {
        assert_eq!(unity_from_scene([1.0, 2.0, 3.0]), [-1.0, 3.0, -2.0]);
        let [x, y, z] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| Vector3::from(unity_from_scene(axis)));
        assert_eq!(x.cross(&y), -z);
    }

    #[test]
    fn a_turn_in_unity_moves_points_as_the_frame_change_does() {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.4, 2.0);
        let [i, j, k, w] = unity_rotation_from_scene(&turn);
        let of_unity = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k));
        let point = Vector3::new(0.5, 0.25, -1.5);
        let expected = Vector3::from(unity_from_scene((turn * point).into()));
        assert!((of_unity * Vector3::from(unity_from_scene(point.into())) - expected).norm() < 1e-12);
    }

    #[test]
    fn a_body_in_unity_faces_as_in_the_scene() {
        let pose =
            Isometry3::from_parts(Translation3::new(1.0, -2.0, 3.0), UnitQuaternion::from_euler_angles(0.3, -0.4, 2.0));
        let (position, [i, j, k, w]) = unity_pose_from_scene(&pose);
        let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k));
        assert!((turn.norm() - 1.0).abs() < 1e-12);
        assert_eq!(position, unity_from_scene([1.0, -2.0, 3.0]));
        for (of_unity, of_scene) in
            [(Vector3::z(), Vector3::x()), (Vector3::y(), Vector3::z()), (Vector3::x(), -Vector3::y())]
        {
            let expected = Vector3::from(unity_from_scene((pose.rotation * of_scene).into()));
            assert!((turn * of_unity - expected).norm() < 1e-12);
        }
    }

    #[test]
    fn a_camera_faces_as_the_body() {
        let body =
            Isometry3::from_parts(Translation3::new(1.0, 2.0, 3.0), UnitQuaternion::from_euler_angles(0.1, -0.2, 0.7));
        let camera = camera_from_body(&body);
        assert!((camera * -Vector3::z() - body * Vector3::x()).norm() < 1e-12);
        assert!((camera * Vector3::y() - body * Vector3::z()).norm() < 1e-12);
        assert_eq!(camera.translation, body.translation);
    }

    #[test]
    fn sdf_poses_convert_back_to_the_rotation() {
        for (roll, pitch, yaw) in [(0.0, 0.0, 1.5), (0.2, -0.7, -3.0), (0.0, 1.0, 0.0)] {
            let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let angles = roll_pitch_yaw(rotation.to_rotation_matrix().matrix());
            for (angle, expected) in angles.into_iter().zip([roll, pitch, yaw]) {
                assert!((angle - expected).abs() < 1e-12);
            }
        }
        let down = UnitQuaternion::from_euler_angles(0.0, std::f64::consts::FRAC_PI_2, 0.4);
        let [roll, pitch, yaw] = roll_pitch_yaw(down.to_rotation_matrix().matrix());
        assert!(UnitQuaternion::from_euler_angles(roll, pitch, yaw).angle_to(&down) < 1e-7);
    }

    /// `FRotationTranslationMatrix` of Unreal, which multiplies rows: the first three are the axes of the body.
    fn unreal_matrix([x, y, z]: [f64; 3], degrees: [f64; 3]) -> nalgebra::Matrix4<f64> {
        let [[sr, cr], [sp, cp], [sy, cy]] = degrees.map(|angle| [libm::sin, libm::cos].map(|f| f(angle.to_radians())));
        nalgebra::Matrix4::from_row_slice(
            &[
                [cp * cy, cp * sy, sp, 0.0],
                [sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, -sr * cp, 0.0],
                [-(cr * sp * cy + sr * sy), cy * sr - cr * sp * sy, cr * cp, 0.0],
                [x, y, z, 1.0],
            ]
            .concat(),
        )
    }

    #[test]
    fn unreal_is_left_handed() {
        let [x, y, z] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| Vector3::from(unreal_from_scene(axis)));
        assert_eq!(x.cross(&y), -100.0 * z);
        assert_eq!(z, Vector3::z() * 100.0);
    }

    #[test]
    fn a_rotator_moves_points_as_the_pose_does() {
        for (roll, pitch, yaw) in [(0.0, 0.0, 0.5), (0.3, -0.4, 2.0), (-1.2, 1.1, -3.0), (0.7, 0.0, 0.0)] {
            let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let pose = Isometry3::from_parts(Translation3::new(1.0, -2.0, 3.0), turn);
            let (location, degrees) = unreal_pose_from_scene(&pose);
            let body = Point3::new(0.5, 0.25, -1.5);
            let [x, y, z] = unreal_from_scene(body.into());
            let there = nalgebra::RowVector4::new(x, y, z, 1.0) * unreal_matrix(location, degrees);
            let expected = Vector3::from(unreal_from_scene((pose * body).into()));
            assert!((there.fixed_columns::<3>(0).transpose() - expected).norm() < 1e-9);
        }
    }

    #[test]
    fn numbers_are_short() {
        let pose = Isometry3::translation(1.5, -0.0000001, 100.0);
        assert_eq!(sdf_pose(&pose), "1.5 0 100 0 0 0");
    }
}
