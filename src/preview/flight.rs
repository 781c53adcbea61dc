//! A flight from the entrance along the longest passages, at the height of a robot's camera.
//!
//! The exposure follows the light slowly, as an eye does. It is found on small images of all frames first.

mod film;
mod path;

use rayon::prelude::*;

use self::path::Path;
use super::image::Image;
use super::inside::{Pose, exposed, lit, mean_exposure};
use super::{Drawn, Format, Order, PreviewError, Size, Subject};

/// Maximum speed of the camera, m/s. Tuned: faster is dizzying.
const FASTEST: f64 = 2.5;
/// Reduction factor of the images for determining the exposure.
const SMALLER: u32 = 8;
/// Seconds over which the exposure is smoothed.
const SLOWNESS_S: f64 = 1.0;

/// Maximum number of pixels of all frames, which are in memory together: 3 GB.
const MOST_PIXELS: u64 = 1_000_000_000;

/// Frame rate and length of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Frames per second, 1 to 50.
    pub fps: u32,
    /// Seconds, up to 600.
    pub seconds: f64,
}

impl Pace {
    /// A pace within the limits.
    ///
    /// # Errors
    /// When it is not.
    pub fn new(fps: u32, seconds: f64) -> Result<Self, PreviewError> {
        let fits = (1..=50).contains(&fps) && seconds > 0.0 && seconds <= 600.0;
        if fits { Ok(Self { fps, seconds }) } else { Err(PreviewError::Pace) }
    }

    fn frames(self) -> usize {
        (libm::round(self.seconds * f64::from(self.fps)) as usize).max(1)
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self { fps: 10, seconds: 6.0 }
    }
}

/// The frames, as an animated file or one by one.
pub fn flight(subject: &Subject, order: &Order, size: Size) -> Result<Drawn, PreviewError> {
    if order.pace.frames() as u64 * u64::from(size.width) * u64::from(size.height) > MOST_PIXELS {
        return Err(PreviewError::Long);
    }
    let poses = poses(subject, order.pace)?;
    let exposures = exposures(subject, order, &poses, size)?;
    let frames: Vec<Image> = poses
        .iter()
        .zip(exposures)
        .map(|(&pose, exposure)| Ok(exposed(&lit(subject.field, subject, pose, size, order.stop)?, size, exposure)))
        .collect::<Result<_, PreviewError>>()?;
    Ok(match order.format {
        Format::Frames => Drawn::Frames(frames.par_iter().map(Image::png).collect()),
        Format::Gif => Drawn::File(film::gif(&frames, order.pace.fps)),
        _ => Drawn::File(film::animated_png(&frames, order.pace.fps)),
    })
}

/// A pose for each frame, evenly along the way.
fn poses(subject: &Subject, pace: Pace) -> Result<Vec<Pose>, PreviewError> {
    let path = Path::longest(subject)?;
    let frames = pace.frames();
    let way_m = path.length_m().min(FASTEST * pace.seconds);
    let step_m = way_m / frames.saturating_sub(1).max(1) as f64;
    Ok((0..frames).map(|frame| path.pose(frame as f64 * step_m)).collect())
}

/// An exposure for each frame.
fn exposures(subject: &Subject, order: &Order, poses: &[Pose], size: Size) -> Result<Vec<f32>, PreviewError> {
    let small = Size { width: size.width.div_ceil(SMALLER), height: size.height.div_ceil(SMALLER) };
    let of = |pose: &Pose| Ok(mean_exposure(&lit(subject.field, subject, *pose, small, order.stop)?));
    let sharp = poses.iter().map(of).collect::<Result<Vec<f32>, PreviewError>>()?;
    let reach = (SLOWNESS_S * f64::from(order.pace.fps)) as usize;
    let level = |frame: usize| {
        let around = &sharp[frame.saturating_sub(reach)..sharp.len().min(frame + reach + 1)];
        around.iter().sum::<f32>() / around.len() as f32
    };
    Ok((0..sharp.len()).map(level).collect())
}
