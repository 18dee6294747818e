//! White furnaces: what a material sends back in a world of radiance 1.

use super::*;

const STEPS: usize = 256;
const ROUGHNESSES: [f32; 9] = [0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.0];
const ANGLES: [f64; 7] = [0.0, 30.0, 55.0, 70.0, 80.0, 86.0, 89.0];

/// The greatest distance from 1 of white materials, over a grid of roughness and angle.
fn worst(materials: impl Fn(f32) -> Vec<MetallicRoughness>) -> f32 {
    let mut worst = (0.0f32, String::new());
    for roughness in ROUGHNESSES {
        for params in materials(roughness) {
            for angle in ANGLES {
                let [reflected, transmitted] = furnace(&params, at(angle, 20.0), STEPS);
                let error = (reflected + transmitted - 1.0).abs().max_element();
                if error > worst.0 {
                    let MetallicRoughness { roughness, ior, metallic, .. } = params;
                    let place = format!("{roughness} metallic {metallic} ior {ior} at {angle}°");
                    worst = (error, place);
                }
            }
        }
    }
    println!("largest error {:.5} at roughness {}", worst.0, worst.1);
    worst.0
}

#[test]
fn white_metal_reflects_everything() {
    assert!(worst(|roughness| vec![metal(roughness)]) < 0.005);
}

#[test]
fn white_dielectrics_reflect_everything() {
    let iors = [1.0, 1.33, 1.5, 2.0, 3.0, 0.0];
    assert!(worst(|roughness| iors.map(|ior| plastic(roughness, ior)).into()) < 0.005);
}

#[test]
fn white_mixtures_of_metal_and_dielectric_reflect_everything() {
    let half =
        |metallic| move |roughness| MetallicRoughness { metallic, ..plastic(roughness, 1.5) };
    assert!(worst(|roughness| vec![half(0.25)(roughness), half(0.75)(roughness)]) < 0.005);
}

#[test]
fn thin_white_surfaces_send_on_everything() {
    let thin = |transmission, roughness| MetallicRoughness {
        transmission,
        is_thin: true,
        ..glass(roughness, 1.5)
    };
    assert!(worst(|roughness| vec![thin(1.0, roughness), thin(0.5, roughness)]) < 0.005);
}

#[test]
fn white_leaves_send_on_everything() {
    let leaf =
        |roughness| MetallicRoughness { diffuse_transmission: 0.7, ..plastic(roughness, 1.5) };
    assert!(worst(|roughness| vec![leaf(roughness)]) < 0.005);
}

#[test]
fn anisotropic_white_metal_reflects_everything() {
    let mut worst = 0.0f32;
    for (roughness, anisotropy) in [(0.2, 0.4), (0.35, 0.9), (0.6, 0.6), (0.85, 0.25), (0.15, 1.0)]
    {
        let params = MetallicRoughness { anisotropy, anisotropy_rotation: 0.3, ..metal(roughness) };
        for (angle, azimuth) in
            [(0.0, 0.0), (40.0, 10.0), (65.0, 100.0), (80.0, 50.0), (87.0, 200.0)]
        {
            let [reflected, _] = furnace(&params, at(angle, azimuth), 512);
            let error = (reflected - 1.0).abs().max_element();
            worst = worst.max(error);
        }
    }
    println!("largest error {worst:.5}");
    assert!(worst < 0.008, "{worst}");
}

#[test]
fn nothing_sends_on_more_light_than_it_receives() {
    let mut worst = (0.0f32, String::new());
    for (name, params) in materials() {
        for angle in [0.0, 40.0, 65.0, 80.0, 88.0, 92.0, 110.0, 125.0, 138.0, 150.0, 180.0] {
            for roughness in [params.roughness, 0.0, 1.0] {
                // Integration does not resolve a narrow ridge.
                let least = if params.anisotropy > 0.0 { 0.25 } else { 0.0 };
                let params = MetallicRoughness { roughness: roughness.max(least), ..params };
                let [reflected, transmitted] = furnace(&params, at(angle, 20.0), 256);
                let sum = (reflected + transmitted).max_element();
                if sum > worst.0 {
                    worst = (sum, format!("{name}, roughness {roughness}, at {angle}°"));
                }
            }
        }
    }
    println!("most light {} of {}", worst.0, worst.1);
    assert!(worst.0 < 1.005, "{worst:?}");
}

#[test]
fn the_albedo_is_what_the_furnace_finds() {
    // A sheen, a clearcoat and a rough volume lose what the table of the base does not know of.
    let is_exact = |params: &MetallicRoughness| {
        params.is_thin && params.clearcoat == 0.0 && params.sheen_color == Vec3::ZERO
    };
    for (name, params) in materials().into_iter().filter(|(_, params)| is_exact(params)) {
        let bsdf = Bsdf::new(&params, 1.0);
        for angle in [5.0, 45.0, 70.0, 84.0, 120.0] {
            let wo = at(angle, 20.0);
            let expected: Vec3 = furnace(&params, wo, STEPS).into_iter().sum();
            let found = bsdf.albedo(wo);
            let error = (found - expected).abs().max_element();
            assert!(error < 0.01, "{name} at {angle}°: {found} is {expected}");
        }
    }
}

/// Light that a rough boundary refracts after more than one reflection is missing, and beyond the critical
/// angle that is much of it. A smaller loss than these bounds is welcome.
#[test]
fn clear_glass_loses_no_more_than_the_documentation_says() {
    let greatest_loss = |roughnesses: &[f32]| {
        let mut worst = (0.0f32, String::new());
        for &roughness in roughnesses {
            for angle in [0.0, 40.0, 70.0, 85.0, 110.0, 130.0, 150.0, 180.0] {
                let [reflected, transmitted] =
                    furnace(&glass(roughness, 1.5), at(angle, 20.0), 200);
                let loss = 1.0 - (reflected + transmitted).x;
                if loss > worst.0 {
                    worst = (loss, format!("roughness {roughness} at {angle}°"));
                }
            }
        }
        println!("greatest loss {worst:?}");
        worst.0
    };
    assert!(greatest_loss(&[0.0, 0.1, 0.2, 0.3]) < 0.09);
    assert!(greatest_loss(&[1.0]) < 0.45);
}
