//! CPU seconds that encoding and writing the images of a cave folder takes: the floor of every benchmark.
//!
//! `cargo run --release --example png_floor CAVE_DIR` decodes every image first, so only encoding and writing count.

use std::error::Error;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;
use std::time::Duration;

use cpu_time::ProcessTime;
use plume::exporters::ImageFormat;
use plume::texture::encode::{Channels, MapWriter};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: png_floor CAVE_DIR")?;
    let mut images: Vec<PathBuf> = fs::read_dir(PathBuf::from(folder).join("textures"))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_, std::io::Error>>()?;
    images.retain(|path| path.extension().is_some_and(|extension| extension == "png"));
    images.sort();
    let mut floor = Duration::ZERO;
    for image in &images {
        floor += encode_again(image)?;
    }
    #[expect(clippy::print_stdout, reason = "the result of the example")]
    {
        println!("{:.3}", floor.as_secs_f64());
    }
    Ok(())
}

fn encode_again(path: &PathBuf) -> Result<Duration, Box<dyn Error>> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path)?)).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("image too large")?];
    let info = reader.next_frame(&mut pixels)?;
    let channels = if info.color_type == png::ColorType::Grayscale { Channels::Grey } else { Channels::LinearRgb };
    let target = path.with_extension("floor");
    let start = ProcessTime::now();
    let mut encoder = MapWriter::new(File::create(&target)?, channels, info.width, ImageFormat::Png)?;
    encoder.write(&pixels)?;
    encoder.finish()?;
    let taken = start.elapsed();
    fs::remove_file(target)?;
    Ok(taken)
}
