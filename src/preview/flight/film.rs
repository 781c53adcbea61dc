//! Animated images.

use gif::{Encoder, Frame, Repeat};
use rayon::prelude::*;

use crate::preview::image::{Image, encoder};

/// Quality of the choice of the 256 colours of a GIF frame, 1 (best) to 30. Tuned: lower takes long without visible gain.
const COLOR_SPEED: i32 = 10;

/// As a looping GIF.
pub fn gif(images: &[Image], fps: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_gif(images, fps, &mut bytes).expect("memory takes all, and the images are of one size");
    bytes
}

fn write_gif(images: &[Image], fps: u32, bytes: &mut Vec<u8>) -> Result<(), gif::EncodingError> {
    // GIF sizes have 16 bits, enough for all our sizes.
    let (width, height) = (images[0].size.width as u16, images[0].size.height as u16);
    // Each frame ends on a whole hundredth of a second, so that the total time is right.
    let end = |number: usize| 100 * number / fps as usize;
    let frame = |(number, image): (usize, &Image)| {
        let mut frame = Frame::from_rgb_speed(width, height, &image.rgb, COLOR_SPEED);
        frame.delay = (end(number + 1) - end(number)) as u16;
        frame
    };
    let frames: Vec<Frame> = images.par_iter().enumerate().map(frame).collect();
    let mut encoder = Encoder::new(bytes, width, height, &[])?;
    encoder.set_repeat(Repeat::Infinite)?;
    frames.iter().try_for_each(|frame| encoder.write_frame(frame))
}

/// As a looping animated PNG; viewers that do not support it show the first frame.
pub fn animated_png(images: &[Image], fps: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_png(images, fps, &mut bytes).expect("memory takes all, and the images are of one size");
    bytes
}

fn write_png(images: &[Image], fps: u32, bytes: &mut Vec<u8>) -> Result<(), png::EncodingError> {
    let mut encoder = encoder(bytes, images[0].size);
    encoder.set_animated(images.len() as u32, 0)?;
    encoder.set_frame_delay(1, fps as u16)?;
    let mut writer = encoder.write_header()?;
    images.iter().try_for_each(|image| writer.write_image_data(&image.rgb))?;
    writer.finish()
}
