//! The view from inside: a ray-marched image of the field, with the colours of its rock and the light of its lamps.
//!
//! It shows the shape with all detail, base colour, roughness and occlusion as in the textures, the lamps of the world with
//! shadows and a headlamp of the camera. Indirect light is approximated.
//!
//! The image is computed in squares: 8 × 8 wide cones first find how far there is air for all of their pixels, then the
//! pixels of each cone continue from there together.

mod auto_camera;
mod camera;
mod light;
mod march;
mod tone;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

pub use self::auto_camera::{is_air, raised};
pub use self::camera::Pose;
use self::camera::{Camera, Ray};
use self::light::{Lamp, Sight};
use self::march::{Approach, BRISK, CAREFUL, FAR_M};
pub use self::tone::exposure as mean_exposure;
use super::image::Image;
use super::{Drawn, Furnishing, Order, PreviewError, Size, Subject};
use crate::field::{Aabb, Field, Surface, Texel};
use crate::things::Dressed;

/// Pixels along the edge of a cone.
const CONE: usize = 8;
/// Cones along the edge of a square.
const SQUARE: usize = 8;
/// Distance that cones keep from rock, metres. Tuned: with less, square parts of ledges are missed.
const LIP_M: f32 = 0.3;
/// Pixels of a cone that are further away than the next nearer ones by this factor are on another surface. Tuned.
const ONE_SURFACE: f32 = 1.1;

/// The picture from a pose.
pub fn inside(subject: &Subject, order: &Order, size: Size) -> Result<Drawn, PreviewError> {
    let pose = pose(subject, order)?;
    let light = match &subject.furnishing {
        None => lit(subject.field, subject, pose, size, order.stop)?,
        Some(furnishing) => {
            let things = furnishing.things_in(around(pose.eye), order.stop)?;
            let Furnishing { setting, shelf, .. } = furnishing;
            lit(&Dressed::new(setting.field, shelf, setting.library, &things), subject, pose, size, order.stop)?
        }
    };
    Ok(Drawn::File(exposed(&light, size, mean_exposure(&light)).png()))
}

/// Where things are shown: at the end of it, a cobble is a pixel or two wide.
fn around(eye: [f32; 3]) -> Aabb<f64> {
    /// Distance in metres. Tuned: nearly all that a camera in a passage sees.
    const SHOWN_M: f64 = 18.0;
    Aabb::from(eye.map(f64::from)).padded(SHOWN_M)
}

/// The requested pose, or one that shows most.
fn pose(subject: &Subject, order: &Order) -> Result<Pose, PreviewError> {
    let eye = match order.at {
        Some(eye) if !auto_camera::is_air(subject.field, eye) => return Err(PreviewError::InRock(eye)),
        at => at,
    };
    let mut pose = match eye {
        Some(eye) => auto_camera::furthest(subject.field, eye),
        None => auto_camera::best(subject)?,
    };
    if let Some([yaw_rad, pitch_rad]) = order.look_rad {
        (pose.yaw_rad, pose.pitch_rad) = (yaw_rad, pitch_rad);
    }
    Ok(pose)
}

/// Light as pixels.
pub fn exposed(light: &[[f32; 3]], size: Size, exposure: f32) -> Image {
    Image { size, rgb: light.iter().flat_map(|&light| tone::pixel(light, exposure)).collect() }
}

/// The light at every pixel, rows from the top: `scenery` is the cave, with its things or without.
pub fn lit<F: Field + Surface>(
    scenery: &F,
    subject: &Subject,
    pose: Pose,
    size: Size,
    stop: &AtomicBool,
) -> Result<Vec<[f32; 3]>, PreviewError> {
    let camera = Camera::new(pose, size);
    let mut lamps = light::lamps(subject, pose.eye);
    lamps.push(light::headlamp(&camera));
    let edge = CONE * SQUARE;
    let (width, height) = (size.width as usize, size.height as usize);
    let [across, down] = [width.div_ceil(edge), height.div_ceil(edge)];
    let squares: Option<Vec<Vec<Pixel>>> = (0..across * down)
        .into_par_iter()
        .map(|square| {
            let corner = [square % across * edge, square / across * edge];
            (!stop.load(Ordering::Relaxed)).then(|| square_of(scenery, &lamps, &camera, size, corner))
        })
        .collect();
    let mut light = vec![[0.0; 3]; width * height];
    for Pixel { at: [x, y], rgb } in squares.ok_or(PreviewError::Stopped)?.into_iter().flatten() {
        light[y * width + x] = rgb;
    }
    Ok(light)
}

struct Pixel {
    at: [usize; 2],
    rgb: [f32; 3],
}

fn square_of<F: Field + Surface>(
    field: &F,
    lamps: &[Lamp],
    camera: &Camera,
    size: Size,
    corner: [usize; 2],
) -> Vec<Pixel> {
    let corners: Vec<[usize; 2]> = (0..SQUARE * SQUARE)
        .map(|cone| [corner[0] + cone % SQUARE * CONE, corner[1] + cone / SQUARE * CONE])
        .filter(|[x, y]| *x < size.width as usize && *y < size.height as usize)
        .collect();
    let half = CONE as f32 / 2.0;
    let cones: Vec<Ray> = corners.iter().map(|[x, y]| camera.ray(*x as f32 + half, *y as f32 + half)).collect();
    // Twice the half diagonal of a cone, since the field is not an exact distance and jumps at the lips of ledges.
    let approach = Approach { share: 1.42 * CONE as f32 * camera.pixel, least_m: LIP_M, step: CAREFUL };
    let starts = march::march(field, &cones, approach);
    corners.iter().zip(starts).flat_map(|(&corner, start)| cone_of(field, lamps, camera, size, corner, start)).collect()
}

fn cone_of<F: Field + Surface>(
    field: &F,
    lamps: &[Lamp],
    camera: &Camera,
    size: Size,
    corner: [usize; 2],
    start: f32,
) -> Vec<Pixel> {
    let pixels: Vec<[usize; 2]> = (0..CONE * CONE)
        .map(|pixel| [corner[0] + pixel % CONE, corner[1] + pixel / CONE])
        .filter(|[x, y]| *x < size.width as usize && *y < size.height as usize)
        .collect();
    let ray = |[x, y]: &[usize; 2]| Ray { start, ..camera.ray(*x as f32 + 0.5, *y as f32 + 0.5) };
    let rays: Vec<Ray> = pixels.iter().map(ray).collect();
    let ends = march::march(field, &rays, Approach { share: 0.5 * camera.pixel, least_m: 0.001, step: BRISK });
    let mut hits: Vec<usize> = (0..rays.len()).filter(|&ray| ends[ray] < FAR_M).collect();
    // Surfaces behind an edge have the detail of their own distance.
    hits.sort_by(|&one, &other| ends[one].total_cmp(&ends[other]));
    let surfaces = hits.chunk_by(|&near, &next| ends[next] < ONE_SURFACE * ends[near]);
    let sights: Vec<Sight> = surfaces.flat_map(|hits| sights(field, camera, &rays, &ends, hits)).collect();
    let light = light::radiance(field, lamps, &sights);
    hits.iter().zip(light).map(|(&ray, rgb)| Pixel { at: pixels[ray], rgb }).collect()
}

/// The surface where these rays hit it.
fn sights<F: Field + Surface>(field: &F, camera: &Camera, rays: &[Ray], ends: &[f32], hits: &[usize]) -> Vec<Sight> {
    let points: Vec<[f32; 3]> = hits.iter().map(|&ray| rays[ray].at(ends[ray])).collect();
    let mean_m = hits.iter().map(|&ray| ends[ray]).sum::<f32>() / hits.len() as f32;
    let texels = texels(field, &points, mean_m * camera.pixel);
    let sight = |((&ray, point), texel): ((&usize, &[f32; 3]), Texel)| Sight {
        point: *point,
        to_eye: rays[ray].along.map(|c| -c),
        texel,
    };
    hits.iter().zip(&points).zip(texels).map(sight).collect()
}

/// The wall at nearby points, at least one, with the detail for pixels of this size.
fn texels<F: Field + Surface>(field: &F, points: &[[f32; 3]], texel_m: f32) -> Vec<Texel> {
    let bounds = Aabb::from_points(points.iter().copied()).expect("there is a point");
    let normals = field.normals_at(points);
    let mut texels = vec![Texel::default(); points.len()];
    field.texels(bounds, texel_m, points, &normals, &mut texels);
    texels
}
