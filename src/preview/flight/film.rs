//! Images that follow each other, in one file.

use gif::{Encoder, Frame, Repeat};
use rayon::prelude::*;

use crate::preview::image::{Image, encoder};

/// How thoroughly the 256 colours of a GIF frame are chosen, 1 to 30. Tuned: less is not seen and takes long.
const COLOR_SPEED: i32 = 10;

/// As GIF, over and over.
pub fn gif(images: &[Image], fps: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_gif(images, fps, &mut bytes).expect("memory takes all, and the images are of one size");
    bytes
}

fn write_gif(images: &[Image], fps: u32, bytes: &mut Vec<u8>) -> Result<(), gif::EncodingError> {
    // GIF counts sizes in 16 bits, which hold every size of ours.
    let (width, height) = (images[0].size.width as u16, images[0].size.height as u16);
    // Each frame ends on a whole hundredth of a second, so that all of them take the time that they should.
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

/// As animated PNG, over and over; viewers that do not know it show the first frame.
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
