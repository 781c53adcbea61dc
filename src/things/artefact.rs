//! Shapes of objects for search tasks: those of the DARPA Subterranean Challenge that have a shape (its artefact specification,
//! 2021), with the sizes of common ones. They stand on the origin; x is their front.

use nalgebra::{Point3, Vector3};
use plume_graph::rng::Rng;

use super::solid::Solid;
use super::substance::{NYLON_RED, ORANGE_PLASTIC, RED_PAINT, ROPE, RUBBER, SCREEN, YELLOW_PLASTIC, ZINC};

/// A backpack that leans on nothing: a bag with a lid, a pocket and two straps.
pub fn backpack(_: &mut Rng) -> Solid {
    let outline = |half_m: f64| [[0.55 * half_m, -0.14], [half_m, -0.08], [half_m, 0.08], [0.55 * half_m, 0.14]];
    let bag = Solid::bar(&outline(0.11), 0.40, &NYLON_RED).at(0.0, 0.0, 0.21);
    let lid = Solid::bar(&outline(0.12), 0.08, &NYLON_RED).at(0.01, 0.0, 0.44);
    let pocket = Solid::cuboid([0.07, 0.20, 0.20], &RUBBER).at(0.12, 0.0, 0.17);
    let strap = |y: f64| {
        let arc = |n: usize| {
            let share = n as f64 / 6.0;
            Point3::new(-0.10 - 0.055 * libm::sin(std::f64::consts::PI * share), y, 0.08 + 0.32 * share)
        };
        Solid::tube(&(0..=6).map(arc).collect::<Vec<_>>(), 0.014, 6, &RUBBER)
    };
    bag.and(lid).and(pocket).and(strap(-0.08)).and(strap(0.08))
}

/// A coil of climbing rope: turns on each other.
pub fn rope(rng: &mut Rng) -> Solid {
    let turn = |n: u32, rng: &mut Rng| {
        let (radius_m, z) = (0.13 + rng.between(-0.012, 0.02), 0.008 + 0.011 * f64::from(n / 2));
        let [x, y] = [0, 1].map(|_| rng.between(-0.012, 0.012));
        let start = rng.between(0.0, std::f64::consts::TAU);
        let at = |step: usize| {
            // Not quite round, so that its ends are caps of a tube.
            let around = start + 0.985 * std::f64::consts::TAU * step as f64 / 24.0;
            Point3::new(x + radius_m * libm::cos(around), y + radius_m * libm::sin(around), z)
        };
        Solid::tube(&(0..=24).map(at).collect::<Vec<_>>(), 0.0075, 6, &ROPE)
    };
    (1..9).fold(turn(0, rng), |all, n| all.and(turn(n, rng)))
}

/// A miner's helmet with a brim and a lamp.
pub fn helmet(_: &mut Rng) -> Solid {
    let dome = [[0.012, 0.112], [0.05, 0.108], [0.09, 0.090], [0.12, 0.060], [0.135, 0.025]];
    let brim = Solid::cylinder(0.135, 0.012, 20, &ORANGE_PLASTIC).at(0.02, 0.0, 0.006);
    let lamp = Solid::cylinder(0.028, 0.04, 12, &RUBBER).towards(Vector3::x()).at(0.11, 0.0, 0.075);
    Solid::lathe(&dome, 20, &ORANGE_PLASTIC).and(brim).and(lamp)
}

/// A cordless drill that stands on its battery.
pub fn drill(_: &mut Rng) -> Solid {
    let battery = Solid::cuboid([0.12, 0.075, 0.06], &RUBBER).at(0.0, 0.0, 0.03);
    let handle = Solid::cuboid([0.045, 0.035, 0.13], &YELLOW_PLASTIC).at(-0.01, 0.0, 0.115);
    let body = Solid::cylinder(0.033, 0.17, 14, &YELLOW_PLASTIC).towards(Vector3::x()).at(0.02, 0.0, 0.205);
    let chuck = Solid::cylinder(0.022, 0.05, 12, &RUBBER).towards(Vector3::x()).at(0.125, 0.0, 0.205);
    let bit = Solid::cylinder(0.004, 0.10, 6, &ZINC).towards(Vector3::x()).at(0.19, 0.0, 0.205);
    battery.and(handle).and(body).and(chuck).and(bit)
}

/// A fire extinguisher of six kilograms, with valve, grip and hose.
pub fn extinguisher(_: &mut Rng) -> Solid {
    let body = [[0.006, 0.072], [0.03, 0.08], [0.38, 0.08], [0.43, 0.06], [0.45, 0.028]];
    let valve = Solid::cylinder(0.016, 0.06, 10, &ZINC).at(0.0, 0.0, 0.475);
    let grip = Solid::cuboid([0.12, 0.02, 0.014], &RUBBER).at(-0.03, 0.0, 0.51);
    // From its nozzle upwards: a tube that points straight down has no shortest turn from up.
    let bend = |n: usize| {
        let share = 1.0 - n as f64 / 8.0;
        let out = 0.10 * libm::sin(std::f64::consts::PI * share.min(0.75));
        Point3::new(0.015 + out, 0.0, 0.47 - 0.34 * share)
    };
    let hose = Solid::tube(&(0..=8).map(bend).collect::<Vec<_>>(), 0.011, 8, &RUBBER);
    Solid::lathe(&body, 18, &RED_PAINT).and(valve).and(grip).and(hose)
}

/// A mobile phone on its back.
pub fn phone(_: &mut Rng) -> Solid {
    let case = Solid::cuboid([0.148, 0.072, 0.009], &RUBBER).at(0.0, 0.0, 0.0045);
    let screen = Solid::cuboid([0.138, 0.064, 0.003], &SCREEN).at(0.0, 0.0, 0.0095);
    case.and(screen)
}

/// A square air vent with slats.
pub fn vent(_: &mut Rng) -> Solid {
    let frame = |y: f64, z: f64, size: [f64; 3]| Solid::cuboid(size, &ZINC).at(0.0, y, z);
    let sides = [-0.24, 0.24].map(|y| frame(y, 0.25, [0.12, 0.02, 0.5]));
    let ends = [0.01, 0.49].map(|z| frame(0.0, z, [0.12, 0.46, 0.02]));
    let slat = |n: u32| Solid::cuboid([0.07, 0.46, 0.008], &ZINC).at(0.0, 0.0, 0.06 + 0.055 * f64::from(n));
    let [left, right] = sides;
    let grille = (0..8).fold(left.and(right), |all, n| all.and(slat(n)));
    ends.into_iter().fold(grille, Solid::and)
}
