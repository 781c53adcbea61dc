//! Pictures of what stops a robot.

use nalgebra::{Point3, Vector3};

use super::{CaveError, Certified};
use crate::field::Field;
use crate::pipeline::{self, Observer};
use crate::preview::{Drawn, Format, Order, Pace, Size, Theme, view};
use plume_graph::StationId;

/// Largest distance of the camera from what it shows, in metres.
const BACK_M: f64 = 3.0;
/// How far above what stops a robot the camera looks, in metres: that is mostly on the floor.
const ABOVE_M: f64 = 0.3;
/// Width and height of a picture in pixels.
const SIZE: Size = Size { width: 960, height: 540 };

impl Certified<'_> {
    /// A PNG of each of its [`stops`](Self::stops) as a camera in its passage sees it, with the things of the cave; `None`
    /// where there is no place for a camera.
    ///
    /// # Errors
    /// If a model or a map of the recipe cannot be read; if work was stopped.
    pub fn pictures(&self, observer: &dyn Observer) -> Result<Vec<Option<Vec<u8>>>, CaveError> {
        pipeline::with_large_stacks(|| self.pictures_here(observer))
    }

    /// [`Certified::pictures`] on the threads of the caller.
    fn pictures_here(&self, observer: &dyn Observer) -> Result<Vec<Option<Vec<u8>>>, CaveError> {
        let files = pipeline::user_files(self.recipe, observer)?;
        let field = pipeline::field_with(self.recipe, self.graph, &files);
        let stock = pipeline::stock(self.recipe, &files);
        let subject = pipeline::furnished(self.recipe, self.graph, &field, stock.as_ref());
        let inside = view("inside").expect("it is a view");
        let picture = |(number, _, at_m): (usize, _, [f64; 3])| {
            let Some((eye, look_rad)) = self.camera(number, at_m, &field) else { return Ok(None) };
            let order = Order {
                format: Format::Png,
                theme: Theme::default(),
                size: Some(SIZE),
                at: Some(eye),
                look_rad: Some(look_rad),
                pace: Pace::default(),
                stop: observer.stop(),
            };
            match inside.draw(&subject, &order)? {
                Drawn::File(png) => Ok(Some(png)),
                Drawn::Frames(_) => Ok(None),
            }
        };
        self.stops().map(picture).collect()
    }

    /// Where a camera in a passage stands to look at a place, and its yaw and pitch.
    fn camera(&self, passage: usize, at_m: [f64; 3], field: &dyn Field) -> Option<([f32; 3], [f32; 2])> {
        let target = Point3::from(at_m) + Vector3::z() * ABOVE_M;
        let station = |end: StationId| self.graph[end].position;
        let ends = self.graph.edges[passage].map(station);
        let near = |end: Point3<f64>| target + (end - target).cap_magnitude(BACK_M);
        let places = [near(ends[0]), near(ends[1]), ends[0], ends[1]];
        let is_fit = |place: &&Point3<f64>| {
            let eye = place.coords.map(|coordinate| coordinate as f32).into();
            (**place - target).norm() > ABOVE_M && field.distances_at(&[eye])[0] < 0.0
        };
        let eye = places.iter().find(is_fit)?;
        let way = target - eye;
        let look_rad = [libm::atan2(way.y, way.x), libm::atan2(way.z, way.xy().norm())].map(|angle| angle as f32);
        Some((eye.coords.map(|coordinate| coordinate as f32).into(), look_rad))
    }
}
