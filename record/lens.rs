//! Lenses: from pixels to rays and back.
//!
//! Pixel `[0, 0]` has its centre at `(0, 0)`, as in OpenCV. The optical frame is x right, y down, z ahead.
//!
//! Pinhole: D. C. Brown, "Close-Range Camera Calibration" (1971) with OpenCV's five coefficients. Fisheye: J. Kannala and S. Brandt,
//! "A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye Lenses" (2006) with OpenCV's four.

use nalgebra::Vector3;

use crate::rig::{self, Camera};

/// Steps of undistortion.
const MOST_STEPS: usize = 100;
/// A pixel that does not come back within this distance is outside of what the lens shows.
const WITHIN_PX: f64 = 1e-6;

/// A lens in front of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Focal length in pixels, of both axes.
    pub focal: f64,
    /// Principal point in pixels.
    pub centre: [f64; 2],
    /// The model and its distortion.
    pub model: rig::Lens,
    /// The angle from its axis up to which it shows something, in radians: beyond, its formula leads back.
    edge_rad: f64,
}

impl Lens {
    /// That of a camera.
    pub fn of(camera: &Camera) -> Self {
        let [width, height] = camera.size_px.map(f64::from);
        let half = 0.5 * camera.fov_deg.to_radians();
        let focal = match camera.lens {
            rig::Lens::Pinhole { .. } => 0.5 * width / libm::tan(half),
            rig::Lens::Fisheye { .. } => 0.5 * width / half,
        };
        let centre = [0.5 * (width - 1.0), 0.5 * (height - 1.0)];
        Self { size: camera.size_px, focal, centre, model: camera.lens.clone(), edge_rad: edge_rad(&camera.lens) }
    }

    /// Whether it shows what is beside and behind it, where depth along the axis means nothing.
    pub fn is_fisheye(&self) -> bool {
        matches!(self.model, rig::Lens::Fisheye { .. })
    }

    /// The direction, of length 1, that is seen at a place of the image; `None` where the lens shows nothing.
    pub fn ray(&self, pixel: [f64; 2]) -> Option<Vector3<f64>> {
        let distorted = [0, 1].map(|axis| (pixel[axis] - self.centre[axis]) / self.focal);
        let ray = match &self.model {
            rig::Lens::Pinhole { distortion } => {
                let [x, y] = undistorted(distorted, distortion);
                Vector3::new(x, y, 1.0).normalize()
            }
            rig::Lens::Fisheye { distortion } => {
                let bent = libm::hypot(distorted[0], distorted[1]);
                let angle = unbent(bent, distortion);
                let share = if bent > 0.0 { libm::sin(angle) / bent } else { 1.0 };
                Vector3::new(distorted[0] * share, distorted[1] * share, libm::cos(angle))
            }
        };
        let back = self.pixel(&ray)?;
        let is_same = (0..2).all(|axis| (back[axis] - pixel[axis]).abs() < WITHIN_PX);
        is_same.then_some(ray)
    }

    /// Where a point of the optical frame is in the image, or beside it; `None` beyond what the lens shows.
    pub fn pixel(&self, point: &Vector3<f64>) -> Option<[f64; 2]> {
        let across = libm::hypot(point.x, point.y);
        let angle = libm::atan2(across, point.z);
        if angle >= self.edge_rad {
            return None;
        }
        let place = match &self.model {
            rig::Lens::Pinhole { distortion } => distorted([point.x / point.z, point.y / point.z], distortion),
            rig::Lens::Fisheye { distortion } => {
                let bent = bent(angle, distortion);
                let share = if across > 0.0 { bent / across } else { 0.0 };
                [point.x * share, point.y * share]
            }
        };
        Some([0, 1].map(|axis| self.centre[axis] + self.focal * place[axis]))
    }
}

fn distorted([x, y]: [f64; 2], [k1, k2, p1, p2, k3]: &[f64; 5]) -> [f64; 2] {
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    [x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y]
}

/// By Newton's method, with differences for the derivative; wherever it ends, the caller tests it.
fn undistorted(target: [f64; 2], coefficients: &[f64; 5]) -> [f64; 2] {
    const STEP: f64 = 1e-6;
    let [mut x, mut y] = target;
    for _ in 0..MOST_STEPS {
        let here = distorted([x, y], coefficients);
        let miss = [target[0] - here[0], target[1] - here[1]];
        if miss[0].abs().max(miss[1].abs()) < 1e-14 {
            break;
        }
        let [along_x, along_y] = [[x + STEP, y], [x, y + STEP]]
            .map(|beside| distorted(beside, coefficients))
            .map(|there| [(there[0] - here[0]) / STEP, (there[1] - here[1]) / STEP]);
        let determinant = along_x[0] * along_y[1] - along_y[0] * along_x[1];
        if determinant.abs() < 1e-9 {
            break;
        }
        x += (miss[0] * along_y[1] - miss[1] * along_y[0]) / determinant;
        y += (miss[1] * along_x[0] - miss[0] * along_x[1]) / determinant;
    }
    [x, y]
}

/// The smallest angle at which a larger one no longer leads further from the centre.
fn edge_rad(model: &rig::Lens) -> f64 {
    match model {
        rig::Lens::Pinhole { distortion: [k1, k2, _, _, k3] } => first_fall(std::f64::consts::FRAC_PI_2, |angle| {
            let r2 = libm::tan(angle) * libm::tan(angle);
            1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3))
        }),
        rig::Lens::Fisheye { distortion } => first_fall(std::f64::consts::PI, |angle| bent_slope(angle, distortion)),
    }
}

fn first_fall(most_rad: f64, slope: impl Fn(f64) -> f64) -> f64 {
    const STEP_RAD: f64 = 1e-3;
    let mut angles = (0..(most_rad / STEP_RAD) as u32).map(|step| f64::from(step) * STEP_RAD);
    angles.find(|angle| slope(*angle) <= 0.0).unwrap_or(most_rad)
}

fn bent(angle: f64, [k1, k2, k3, k4]: &[f64; 4]) -> f64 {
    let a2 = angle * angle;
    angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))))
}

fn bent_slope(angle: f64, [k1, k2, k3, k4]: &[f64; 4]) -> f64 {
    let a2 = angle * angle;
    1.0 + a2 * (3.0 * k1 + a2 * (5.0 * k2 + a2 * (7.0 * k3 + a2 * 9.0 * k4)))
}

fn unbent(target: f64, coefficients: &[f64; 4]) -> f64 {
    let mut angle = target;
    for _ in 0..MOST_STEPS {
        let miss = bent(angle, coefficients) - target;
        let slope = bent_slope(angle, coefficients);
        if miss.abs() < 1e-14 || slope.abs() < 1e-9 {
            break;
        }
        angle -= miss / slope;
    }
    angle.clamp(0.0, std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(fov_deg: f64, model: rig::Lens) -> Lens {
        let camera = Camera { fov_deg, lens: model, ..rig::Rig::preset("rgbd").unwrap().cameras[0].clone() };
        Lens::of(&camera)
    }

    #[test]
    fn rays_come_back_to_their_pixels() {
        let lenses = [
            lens(69.0, rig::Lens::default()),
            lens(80.0, rig::Lens::Pinhole { distortion: [-0.28, 0.074, 1.9e-4, 1.8e-5, 0.0] }),
            lens(150.0, rig::Lens::Fisheye { distortion: [-0.013, 0.02, -0.012, 0.0025] }),
            lens(220.0, rig::Lens::Fisheye { distortion: [0.0; 4] }),
        ];
        for lens in lenses {
            for y in (0..480).step_by(53) {
                for x in (0..640).step_by(71) {
                    let pixel = [f64::from(x), f64::from(y)];
                    let ray = lens.ray(pixel).unwrap();
                    assert!((ray.norm() - 1.0).abs() < 1e-12);
                    let back = lens.pixel(&(ray * 3.7)).unwrap();
                    assert!((back[0] - pixel[0]).abs() < 1e-6 && (back[1] - pixel[1]).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn the_field_of_view_is_that_of_the_rig() {
        for (fov_deg, model) in [(69.0, rig::Lens::default()), (200.0, rig::Lens::Fisheye { distortion: [0.0; 4] })] {
            let lens = lens(fov_deg, model);
            let edge = lens.ray([-0.5, lens.centre[1]]).unwrap();
            assert!((libm::atan2(-edge.x, edge.z).to_degrees() - fov_deg / 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn nothing_is_seen_where_the_lens_folds_back() {
        let lens = lens(120.0, rig::Lens::Pinhole { distortion: [-0.4, 0.0, 0.0, 0.0, 0.0] });
        assert!(lens.ray([0.0, 0.0]).is_none() && lens.ray(lens.centre).is_some());
    }
}
