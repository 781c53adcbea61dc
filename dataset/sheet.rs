//! The contact sheet of a dataset: views from inside some of its caves.

use std::io::Cursor;

use image::{ImageFormat, RgbImage, imageops};
use plume::cave::{self, CaveError};
use plume::pipeline::Observer;
use plume::preview::{Drawn, Format, Order, Pace, Size, Theme, view};
use rayon::prelude::*;

use crate::item::Record;
use crate::plan::{DIFFICULTY, Plan};

/// Most views in a row.
const COLUMNS: u32 = 4;
/// Size of a view in pixels.
const SIZE: Size = Size { width: 320, height: 180 };
/// Between views, in pixels.
const GAP: u32 = 4;

/// A PNG of caves, spread evenly over those with a view and sorted by difficulty, if that varies; `None` if there is none.
///
/// # Errors
/// If a recipe cannot be read any more; if work was stopped.
pub fn sheet(plan: &Plan, records: &[Record], observer: &dyn Observer) -> Result<Option<Vec<u8>>, CaveError> {
    let mut sorted: Vec<&Record> = records.iter().collect();
    let difficulty = |record: &Record| record.drawn.get(DIFFICULTY).and_then(serde_json::Value::as_f64).unwrap_or(0.0);
    sorted.sort_by(|a, b| difficulty(a).total_cmp(&difficulty(b)));
    let count = sorted.len().min(plan.spec().sheet);
    let chosen: Vec<&Record> = (0..count).map(|place| sorted[place * sorted.len() / count]).collect();
    let views: Vec<Option<RgbImage>> =
        chosen.into_par_iter().map(|record| inside(plan, record, observer)).collect::<Result<_, _>>()?;
    let views: Vec<RgbImage> = views.into_iter().flatten().collect();
    if views.is_empty() {
        return Ok(None);
    }
    let columns = COLUMNS.min(views.len() as u32);
    let rows = (views.len() as u32).div_ceil(columns);
    let mut sheet = RgbImage::new(columns * (SIZE.width + GAP) - GAP, rows * (SIZE.height + GAP) - GAP);
    for (place, view) in (0..).zip(&views) {
        let [x, y] = [place % columns * (SIZE.width + GAP), place / columns * (SIZE.height + GAP)];
        imageops::replace(&mut sheet, view, x.into(), y.into());
    }
    let mut png = Cursor::new(Vec::new());
    sheet
        .write_to(&mut png, ImageFormat::Png)
        .map_err(|error| CaveError::Failed(format!("the contact sheet: {error}")))?;
    Ok(Some(png.into_inner()))
}

/// The view from inside a cave; `None` where there is no place for a camera.
fn inside(plan: &Plan, record: &Record, observer: &dyn Observer) -> Result<Option<RgbImage>, CaveError> {
    let input = plan.input(&plan.item(record.item))?;
    let order = Order {
        format: Format::Png,
        theme: Theme::default(),
        size: Some(SIZE),
        at: None,
        look_rad: None,
        pace: Pace::default(),
        stop: observer.stop(),
    };
    let Drawn::File(png) = (match cave::preview(&input, view("inside").expect("it is a view"), &order, observer) {
        Err(CaveError::Usage { .. }) => return Ok(None),
        drawn => drawn?,
    }) else {
        return Ok(None);
    };
    let image =
        image::load_from_memory(&png).map_err(|error| CaveError::Failed(format!("the contact sheet: {error}")))?;
    Ok(Some(image.to_rgb8()))
}
