//! A run: everything that happens along a path, in the order of time.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::Point3;
use plume_exporters::package::Package;
use plume_exporters::scene::Scene;
use serde::Serialize;

use crate::camera::Eye;
use crate::error::RecordError;
use crate::exposure::Exposure;
use crate::inertial::{Unit, Wheels};
use crate::layout::{Layout, LayoutRow, Out};
use crate::library::Library;
use crate::lidar;
use crate::light::Lights;
use crate::picture::{Frame, Picture, Pixels};
use crate::rig::{Output, Rig};
use crate::trajectory::Trajectory;
use crate::world::{Label, Thing, World};

/// The file that tells what a recording is.
const ABOUT: &str = "recording.json";
/// Longest run in seconds: ten hours.
const MOST_S: f64 = 36_000.0;
/// Most frames and sweeps.
const MOST_FRAMES: usize = 1_000_000;

/// What is to be recorded.
pub struct Order<'a> {
    /// The body.
    pub rig: &'a Rig,
    /// Where it goes.
    pub path: &'a Trajectory,
    /// Seed of all noise.
    pub seed: u64,
    /// Layouts; each has a folder of its own if there are several.
    pub layouts: Vec<&'static LayoutRow>,
}

/// Follows a recording, and can stop it.
pub trait Watch: Sync {
    /// So many frames and sweeps will be made.
    fn begin(&self, total: usize);
    /// One of them is done.
    fn advance(&self);
    /// Set to stop.
    fn stop(&self) -> &AtomicBool;
}

/// What was recorded, as in `recording.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recording {
    /// The program that made it.
    pub generator: String,
    /// The scene.
    pub scene: String,
    /// SHA-256 of what the scene follows from.
    pub scene_fingerprint: String,
    /// Seed of all noise.
    pub seed: u64,
    /// The layouts, each in a folder of its name if there are several.
    pub layouts: Vec<&'static str>,
    /// Poses of the path.
    pub path_poses: usize,
    /// Time of its start, in nanoseconds.
    pub start_ns: i64,
    /// Length in time, in seconds.
    pub duration_s: f64,
    /// Length of the way, in metres.
    pub length_m: f64,
    /// Number of measurements by sensor.
    pub counts: BTreeMap<String, u64>,
    /// The body.
    pub rig: Rig,
    /// Labels of pixels; 0 is nothing.
    pub labels: Vec<Label>,
    /// Numbers of things in pixels; 0 is rock or gravel.
    pub things: Vec<Thing>,
}

/// Something that a sensor does. At the same moment, in this order.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Sensor {
    Imu,
    Odometry,
    Camera(usize),
    Lidar(usize),
}

struct Event {
    time_ns: i64,
    sensor: Sensor,
    number: u64,
}

/// Records a run through a scene.
///
/// # Errors
/// A rig that does not fit its layouts or the path, a scene that cannot be read, the disk, the watch's stop.
pub fn record(
    scene: &Scene,
    order: &Order,
    out: &mut dyn Package,
    watch: &dyn Watch,
) -> Result<Recording, RecordError> {
    let Order { rig, path, seed, .. } = *order;
    for row in &order.layouts {
        (row.check)(rig).map_err(|(fault, hint)| RecordError::Layout { layout: row.name, fault, hint })?;
    }
    let events = events(rig, path)?;
    let places: Vec<Point3<f64>> = places(path).collect();
    let world = World::load(scene, &places, rig.reach_m())?;
    let counts = counts(rig, &events);
    let mut run = Run::new(order, &world)?;
    watch.begin(events.iter().filter(|event| event.is_long()).count());
    for event in &events {
        if watch.stop().load(Ordering::Relaxed) {
            return Err(RecordError::Interrupted);
        }
        run.happen(event, out)?;
        if event.is_long() {
            watch.advance();
        }
    }
    run.finish(out)?;
    let recording = Recording {
        generator: scene.generator.clone(),
        scene: scene.name.clone(),
        scene_fingerprint: scene.fingerprint.clone(),
        seed,
        layouts: order.layouts.iter().map(|row| row.name).collect(),
        path_poses: path.poses(),
        start_ns: path.start_ns(),
        duration_s: (path.end_ns() - path.start_ns()) as f64 * 1e-9,
        length_m: places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum(),
        counts,
        rig: rig.clone(),
        labels: world.labels,
        things: world.things,
    };
    let text = serde_json::to_string_pretty(&recording).map_err(std::io::Error::from)? + "\n";
    out.text(ABOUT, &text)?;
    Ok(recording)
}

impl Event {
    /// Whether it takes time that someone may watch.
    fn is_long(&self) -> bool {
        matches!(self.sensor, Sensor::Camera(_) | Sensor::Lidar(_))
    }
}

/// Everything that happens. Times are whole microseconds after the start, so that files which tell microseconds tell all.
fn events(rig: &Rig, path: &Trajectory) -> Result<Vec<Event>, RecordError> {
    let span_ns = path.end_ns() - path.start_ns();
    if span_ns as f64 > MOST_S * 1e9 {
        return Err(RecordError::path(format!("takes more than {MOST_S} s"), "record it in parts"));
    }
    let mut sensors: Vec<(Sensor, f64)> = Vec::new();
    sensors.extend(rig.imu.as_ref().map(|imu| (Sensor::Imu, imu.rate_hz)));
    sensors.extend(rig.odometry.as_ref().map(|wheels| (Sensor::Odometry, wheels.rate_hz)));
    sensors.extend(rig.cameras.iter().enumerate().map(|(n, camera)| (Sensor::Camera(n), camera.rate_hz)));
    sensors.extend(rig.lidars.iter().enumerate().map(|(n, lidar)| (Sensor::Lidar(n), lidar.rate_hz)));
    let mut events = Vec::new();
    for (sensor, rate_hz) in sensors {
        let after_ns = |number: u64| (number as f64 * 1e6 / rate_hz).round() as i64 * 1000;
        // A sweep ends before the path does.
        let end_ns = if matches!(sensor, Sensor::Lidar(_)) { span_ns - (1e9 / rate_hz) as i64 } else { span_ns };
        let times = (0..).map(|number| (number, after_ns(number))).take_while(|(_, after)| *after <= end_ns);
        events.extend(times.map(|(number, after)| Event { time_ns: path.start_ns() + after, sensor, number }));
    }
    if events.iter().filter(|event| event.is_long()).count() > MOST_FRAMES {
        return Err(RecordError::path(format!("has more than {MOST_FRAMES} frames and sweeps"), "record it in parts"));
    }
    events.sort_by_key(|event| (event.time_ns, event.sensor));
    Ok(events)
}

/// Places every tenth of a second.
fn places(path: &Trajectory) -> impl Iterator<Item = Point3<f64>> {
    const STEP_NS: usize = 100_000_000;
    let times = (path.start_ns()..path.end_ns()).step_by(STEP_NS).chain([path.end_ns()]);
    times.map(|time_ns| Point3::from(path.at_ns(time_ns).pose.translation.vector))
}

fn counts(rig: &Rig, events: &[Event]) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for event in events {
        let name = match event.sensor {
            Sensor::Imu => "imu",
            Sensor::Odometry => "odometry",
            Sensor::Camera(number) => &rig.cameras[number].name,
            Sensor::Lidar(number) => &rig.lidars[number].name,
        };
        *counts.entry(name.to_owned()).or_default() += 1;
    }
    counts
}

/// The state of a run.
struct Run<'a> {
    order: &'a Order<'a>,
    world: &'a World,
    library: Library,
    eyes: Vec<Eye>,
    exposures: Vec<Exposure>,
    imu: Option<Unit>,
    wheels: Option<Wheels>,
    layouts: Vec<(String, Box<dyn Layout>)>,
}

impl<'a> Run<'a> {
    fn new(order: &'a Order, world: &'a World) -> Result<Self, RecordError> {
        let Order { rig, seed, .. } = *order;
        let shows_things = rig.cameras.iter().any(|camera| camera.outputs.contains(&Output::Instance));
        if shows_things && world.things.len() > usize::from(u16::MAX) {
            let fault = format!("passes {} things, more than 16 bits can tell apart", world.things.len());
            return Err(RecordError::path(fault, "record it in parts, or leave out the output `instance`"));
        }
        let folder = |name: &str| if order.layouts.len() > 1 { format!("{name}/") } else { String::new() };
        Ok(Self {
            order,
            world,
            library: Library::new(&world.materials),
            eyes: rig.cameras.iter().map(Eye::of).collect(),
            exposures: rig.cameras.iter().map(|camera| Exposure::new(&rig.light, camera.rate_hz)).collect(),
            imu: rig.imu.as_ref().map(|imu| Unit::new(imu, world.gravity, seed)),
            wheels: rig.odometry.as_ref().map(|wheels| Wheels::new(wheels, seed)),
            layouts: order.layouts.iter().map(|row| (folder(row.name), (row.begin)(rig, order.path))).collect(),
        })
    }

    fn happen(&mut self, event: &Event, out: &mut dyn Package) -> Result<(), RecordError> {
        match event.sensor {
            Sensor::Imu => self.inertia(event.time_ns),
            Sensor::Odometry => self.wheeled(event.time_ns),
            Sensor::Camera(camera) => {
                let frame = self.frame(camera, event)?;
                return self.each(out, |layout, out| layout.frame(&frame, out));
            }
            Sensor::Lidar(number) => {
                let lidar = (number, &self.order.rig.lidars[number]);
                let Order { path, seed, .. } = *self.order;
                let moment = (event.number, event.time_ns);
                let sweep = lidar::sweep(moment, lidar, path, self.world, &mut self.library, seed)?;
                return self.each(out, |layout, out| layout.sweep(&sweep, out));
            }
        }
        Ok(())
    }

    fn inertia(&mut self, time_ns: i64) {
        let Some(unit) = &mut self.imu else { return };
        let told = unit.measure(time_ns, &self.order.path.at_ns(time_ns));
        self.layouts.iter_mut().for_each(|(_, layout)| layout.inertia(&told));
    }

    fn wheeled(&mut self, time_ns: i64) {
        let Some(wheels) = &mut self.wheels else { return };
        let told = wheels.measure(time_ns, &self.order.path.at_ns(time_ns));
        self.layouts.iter_mut().for_each(|(_, layout)| layout.wheeled(&told));
    }

    fn finish(mut self, out: &mut dyn Package) -> Result<(), RecordError> {
        self.each(out, |layout, out| layout.finish(out))
    }

    fn each(
        &mut self,
        package: &mut dyn Package,
        write: impl Fn(&mut dyn Layout, &mut Out) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        self.layouts.iter_mut().try_for_each(|(folder, layout)| write(&mut **layout, &mut Out { package, folder }))
    }

    fn frame(&mut self, number: usize, event: &Event) -> Result<Frame, RecordError> {
        let Order { rig, path, seed, .. } = *self.order;
        let (camera, eye) = (&rig.cameras[number], &self.eyes[number]);
        let pose = path.at_ns(event.time_ns).pose;
        let view = eye.look(self.world, &pose);
        let mut pictures = Vec::new();
        for output in &camera.outputs {
            let pixels = match output {
                Output::Image => {
                    self.library.need(&view.materials())?;
                    let lights = Lights::at(self.world, &rig.light, &pose);
                    let image = view.image(&lights, &self.library);
                    let exposure = &mut self.exposures[number];
                    exposure.meter(&image, eye.width());
                    let name = format!("image {}", camera.name);
                    Pixels::Color(exposure.develop(&image, eye.width(), seed, &name, event.number))
                }
                Output::Depth => {
                    let name = format!("depth {}", camera.name);
                    Pixels::Metres(view.measured_depth(&camera.depth, seed, &name, event.number))
                }
                Output::ExactDepth => Pixels::Metres(view.depth()),
                Output::Normal => Pixels::Normals(view.normals()),
                Output::Label => Pixels::Labels(view.labels()),
                Output::Instance => Pixels::Things(view.things().into_iter().map(|thing| thing as u16).collect()),
                Output::Flow => {
                    let next_ns = ((event.number + 1) as f64 * 1e6 / camera.rate_hz).round() as i64 * 1000;
                    Pixels::Flow(view.flow(&path.at_ns(path.start_ns() + next_ns).pose))
                }
            };
            pictures.push(Picture { output: *output, size: eye.lens.size, pixels });
        }
        let scene_from_optical = view.scene_from_optical;
        Ok(Frame { camera: number, number: event.number, time_ns: event.time_ns, scene_from_optical, pictures })
    }
}
