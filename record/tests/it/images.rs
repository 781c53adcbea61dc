//! Light follows the laws of photometry.

use crate::room::{ALBEDO, CUBE, FAR, Room, picture, rest};

/// A camera without noise whose exposure is fixed; its light is at its side.
fn rig(light: &str) -> String {
    format!(
        "[[cameras]]\nname = \"cam0\"\nrate_hz = 1.0\nsize_px = [65, 49]\nfov_deg = 60.0\noutputs = [\"image\"]\n[light]\nwhite_cd_m2 = 2.0\nread_noise = 0.0\nfull_well = 1e6\nelectrons_per_cd_m2 = 1e9\nambient_cd_m2 = 0.0\n{light}\n"
    )
}

/// Luminance of a pixel in cd/m².
fn luminance(light: &str, place: [f64; 3], heading: f64, [x, y]: [u32; 2]) -> f64 {
    let (_, memory) = Room::new().record(&rig(light), &rest(place, heading), &["tum"]).unwrap();
    let value = f64::from(picture(&memory, "rgb/0.000000.png").into_rgb8().get_pixel(x, y).0[0]) / 255.0;
    let linear = if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) };
    2.0 * linear
}

const AT_THE_SIDE: &str = "headlamp_cd = 20.0\nheadlamp_position_m = [0.0, -0.001, 0.0]\n";

#[test]
fn light_falls_with_the_square_of_the_distance() {
    for away in [2.0, 3.0, 5.0] {
        let found = luminance(AT_THE_SIDE, [FAR[0] - away, -1.0, 1.5], 0.0, [32, 24]);
        let expected = ALBEDO / std::f64::consts::PI * 20.0 / (away * away);
        // Reflections, and the light between walls, add a little.
        assert!(found > expected && found < 1.35 * expected, "{away} m: {found} {expected}");
    }
}

#[test]
fn a_beam_has_half_its_intensity_at_its_edge() {
    let light = format!("{AT_THE_SIDE}headlamp_beam_deg = 40.0\n");
    let [middle, edge] = [32, 32 + (libm::tan(20_f64.to_radians()) / libm::tan(30_f64.to_radians()) * 32.5) as u32]
        .map(|x| luminance(&light, [0.0, 0.0, 1.5], 0.0, [x, 24]));
    let cosine = libm::cos(20_f64.to_radians());
    let expected = 0.5 * cosine * cosine * cosine;
    assert!((edge / middle / expected - 1.0).abs() < 0.12, "{edge} {middle}");
}

#[test]
fn a_thing_in_front_of_a_lamp_casts_a_shadow() {
    // The lamp is to the left of the cube, and the camera looks at the floor to its right.
    let light = "headlamp_cd = 20.0\nheadlamp_position_m = [0.0, 2.0, -0.75]\nheadlamp_beam_deg = 170.0\n";
    let [x, y] = [0, 1].map(|axis| (CUBE[0][axis] + CUBE[1][axis]) / 2.0);
    let place = [x - 3.0, y - 0.8, 1.0];
    let [shadow, beside] = [38, 48].map(|row| luminance(light, place, 0.0, [32, row]));
    assert!(shadow < 0.5 * beside, "{shadow} {beside}");
}

#[test]
fn lamps_of_the_scene_can_be_on_and_dust_glows() {
    let dark = luminance("headlamp_cd = 0.0\n", [0.0, 0.0, 1.5], 0.0, [32, 24]);
    let lit = luminance("headlamp_cd = 0.0\ncave_lamps = true\n", [0.0, 0.0, 1.5], 0.0, [32, 24]);
    assert!(dark == 0.0 && lit > 0.02, "{dark} {lit}");
    let near = "headlamp_cd = 20.0\nheadlamp_position_m = [0.0, 0.0, 0.1]\n";
    let [clear, dusty] =
        ["", "dust_per_m = 0.3\n"].map(|dust| luminance(&format!("{near}{dust}"), [-3.5, 0.0, 1.5], 0.0, [32, 24]));
    assert!(dusty > 1.5 * clear, "{dusty} {clear}");
}
