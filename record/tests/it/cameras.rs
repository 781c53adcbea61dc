//! What a camera tells of surfaces is where they are.

use crate::room::{CUBE, FAR, Room, bend, picture, rest};

const CAMERA: &str = "[[cameras]]\nname = \"cam0\"\nrate_hz = 1.0\nsize_px = [64, 48]\nfov_deg = 70.0\n";

fn camera(outputs: &str, rest: &str) -> String {
    format!("{CAMERA}outputs = {outputs}\n{rest}\n")
}

#[test]
fn depth_is_that_along_the_axis() {
    let (_, memory) =
        Room::new().record(&camera("[\"exact_depth\"]", ""), &rest([0.0, -1.0, 1.5], 0.0), &["tum"]).unwrap();
    let depth = picture(&memory, "exact_depth/0.000000.png").into_luma16();
    let wall = ((FAR[0] * 5000.0).round()) as u16;
    assert!(
        depth
            .enumerate_pixels()
            .filter(|(x, y, _)| (20..44).contains(x) && (16..32).contains(y))
            .all(|(_, _, pixel)| pixel.0[0] == wall)
    );
}

#[test]
fn a_fisheye_tells_the_distance_and_sees_sideways() {
    let fisheye =
        camera("[\"exact_depth\", \"normal\"]", "lens = { model = \"fisheye\", distortion = [0.01, 0.0, 0.0, 0.0] }")
            .replace("fov_deg = 70.0", "fov_deg = 190.0");
    let (_, memory) = Room::new().record(&fisheye, &rest([0.0, 0.0, 1.5], 0.0), &["tum"]).unwrap();
    let depth = picture(&memory, "exact_depth/0.000000.png").into_luma16();
    let left = f64::from(depth.get_pixel(2, 24).0[0]) / 5000.0;
    assert!((2.9..3.2).contains(&left), "the wall at the left is 3 m away: {left}");
    let normal = picture(&memory, "normal/0.000000.png").into_rgb16();
    assert!(normal.get_pixel(2, 24).0[0] > 65000, "its normal points to the right");
}

#[test]
fn a_thing_has_its_class_and_its_number() {
    let rig = camera("[\"label\", \"instance\"]", "");
    let (recording, memory) = Room::new().record(&rig, &rest([0.0, 1.25, 0.25], 0.0), &["tum"]).unwrap();
    let label = picture(&memory, "label/0.000000.png").into_luma8();
    let instance = picture(&memory, "instance/0.000000.png").into_luma16();
    let class = |x, y| {
        let label = label.get_pixel(x, y).0[0];
        recording.labels.iter().find(|known| known.label == label).unwrap().class.clone()
    };
    assert_eq!([class(32, 24), class(32, 47), class(2, 20), class(32, 0)], ["boulder", "floor", "wall", "wall"]);
    assert_eq!((recording.things.len(), recording.things[0].id, &*recording.things[0].class), (1, 77, "boulder"));
    assert_eq!(instance.get_pixel(32, 24).0[0], 1);
    let edge = instance.pixels().filter(|pixel| pixel.0[0] == 1).count() as f64 / (64.0 * 48.0);
    let seen = (CUBE[1][1] - CUBE[0][1]) / CUBE[0][0] * 32.0 / libm::tan(35_f64.to_radians());
    assert!((edge * 64.0 * 48.0 - seen * seen).abs() < 2.5 * seen, "{edge}");
}

/// The depth of a pixel, moved by the flow, is that of the next frame.
#[test]
fn flow_leads_to_the_same_point() {
    for lens in ["", "lens = { model = \"pinhole\", distortion = [-0.2, 0.05, 0.001, -0.001, 0.0] }"] {
        let rig = camera("[\"exact_depth\", \"flow\", \"label\"]", lens).replace("rate_hz = 1.0", "rate_hz = 10.0");
        let (_, memory) = Room::new().record(&rig, &bend(), &["tum"]).unwrap();
        let flow = picture(&memory, "flow/5.300000.png").into_rgb16();
        let [label, next_label] =
            ["5.300000", "5.400000"].map(|time| picture(&memory, &format!("label/{time}.png")).into_luma8());
        let mut same = 0;
        let mut all = 0;
        for (x, y, pixel) in flow.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[2] == 1) {
            let [right, down] = [0, 1].map(|k| (f64::from(pixel.0[k]) - 32768.0) / 64.0);
            let to = [f64::from(x) + right, f64::from(y) + down].map(|along| along.round() as u32);
            all += 1;
            same += u32::from(label.get_pixel(x, y) == next_label.get_pixel(to[0].min(63), to[1].min(47)));
        }
        assert!(all > 2500 && same * 100 > all * 97, "{same} of {all}");
    }
}

#[test]
fn noise_of_depth_grows_with_its_square() {
    let rig = camera("[\"depth\"]", "depth = { min_m = 0.3, max_m = 10.0, noise_m = 0.01 }");
    let room = Room::new();
    let spread = |x: f64| {
        let (_, memory) = room.record(&rig, &rest([x, -1.5, 1.5], 0.0), &["tum"]).unwrap();
        let depth = picture(&memory, "depth/0.000000.png").into_luma16();
        let away = FAR[0] - x;
        let shown = depth.enumerate_pixels().filter(|(x, y, _)| (24..40).contains(x) && (18..30).contains(y));
        let errors = shown.map(|(_, _, pixel)| f64::from(pixel.0[0]) / 5000.0 - away);
        let squares: Vec<f64> = errors.map(|error| error * error).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    for (x, expected) in [(2.0, 0.04), (0.0, 0.16)] {
        let found = spread(x);
        assert!((found / expected - 1.0).abs() < 0.2, "{found} {expected}");
    }
}
