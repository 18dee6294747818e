//! Any parameters and directions.

use super::*;

/// A number that is often one of the extremes.
fn number(random: &mut Random) -> f32 {
    const EXTREMES: [f32; 8] = [0.0, 1.0, 1e-3, 0.0099, 0.0101, 0.999_999, 1e-20, 0.5];
    if random.next() < 0.5 {
        EXTREMES[(random.next() * 8.0) as usize]
    } else {
        random.next() as f32
    }
}

fn color(random: &mut Random) -> Vec3 {
    match (random.next() * 4.0) as usize {
        0 => Vec3::ZERO,
        1 => Vec3::ONE,
        _ => Vec3::new(number(random), number(random), number(random)),
    }
}

pub(super) fn material(random: &mut Random) -> MetallicRoughness {
    // Most factors are 0, so that each is often alone.
    let rare = |random: &mut Random| if random.next() < 0.6 { 0.0 } else { number(random) };
    let iors = [0.0, 1.0, 1.5, 1.000_001, 50.0, 1.0 + 2.0 * random.next() as f32];
    MetallicRoughness {
        base_color: color(random),
        metallic: number(random),
        roughness: number(random),
        ior: iors[(random.next() * 6.0) as usize],
        specular: number(random),
        specular_color: color(random) * if random.next() < 0.2 { 1e6 } else { 1.0 },
        transmission: rare(random),
        is_thin: random.next() < 0.5,
        clearcoat: rare(random),
        clearcoat_roughness: number(random),
        sheen_color: if random.next() < 0.7 { Vec3::ZERO } else { color(random) },
        sheen_roughness: number(random),
        anisotropy: rare(random),
        anisotropy_rotation: random.next() as f32 * 7.0 - 3.0,
        iridescence: rare(random),
        iridescence_ior: 1.0 + number(random) * 2.0,
        iridescence_thickness: number(random) * 1200.0,
        dispersion: rare(random) * 10.0,
        diffuse_transmission: rare(random),
        diffuse_transmission_color: color(random),
    }
}

/// A direction that is often grazing or along the normal.
fn direction(random: &mut Random) -> DVec3 {
    const HEIGHTS: [f64; 8] = [0.0, 1.0, 1e-300, 1e-17, 1e-9, 1e-4, 1.0 - 1e-12, 0.5];
    if random.next() < 0.5 {
        return random.direction();
    }
    let z = HEIGHTS[(random.next() * 8.0) as usize];
    let phi = if random.next() < 0.5 { 0.0 } else { random.next() * TAU };
    let sine = (1.0 - z * z).max(0.0).sqrt();
    let z = if random.next() < 0.5 { -z } else { z };
    DVec3::new(sine * phi.cos(), sine * phi.sin(), z)
}

#[test]
fn nothing_is_negative_or_not_finite() {
    let mut random = Random(23);
    let is_sound = |value: Vec3| value.is_finite() && value.cmpge(Vec3::ZERO).all();
    for _ in 0..100_000 {
        let params = material(&mut random);
        let outside = [1.0, 1.33, 1.5][(random.next() * 3.0) as usize];
        let bsdf = Bsdf::new(&params, outside);
        for _ in 0..10 {
            let (wo, wi) = (direction(&mut random), direction(&mut random));
            let (value, pdf) = (bsdf.evaluate(wo, wi), bsdf.pdf(wo, wi));
            assert!(is_sound(value), "{value} {wo:?} {wi:?} {params:?}");
            assert!(pdf.is_finite() && pdf >= 0.0, "{pdf} {wo:?} {wi:?} {params:?}");
            let albedo = bsdf.albedo(wo);
            assert!(is_sound(albedo) && albedo.max_element() < 1.01, "{albedo} {wo:?} {params:?}");
            let u = [random.next(), random.next(), random.next()].map(|u| {
                let at_end = [0.0, 1.0 - f64::EPSILON / 2.0, u][(u * 3.0) as usize];
                if u < 0.3 { at_end } else { u }
            });
            let Some(sample) = bsdf.sample(wo, u[0], [u[1], u[2]]) else { continue };
            let weight = f64::from(sample.value.max_element()) / sample.pdf;
            let is_unit = (sample.wi.length() - 1.0).abs() < 1e-6;
            assert!(
                is_sound(sample.value) && is_unit && weight.is_finite(),
                "{sample:?} {params:?}"
            );
            assert!(sample.pdf > 0.0 && sample.pdf.is_finite(), "{sample:?} {params:?}");
            // The least share of a lobe is 1/20 of the light, of at most six.
            assert!(weight < 40.0, "{weight} {sample:?} {wo:?} {params:?}");
        }
    }
}

#[test]
fn parameters_out_of_range_count_as_the_nearest_in_range() {
    let wild = MetallicRoughness {
        base_color: Vec3::new(-1.0, 2.0, f32::NAN),
        metallic: -3.0,
        roughness: f32::INFINITY,
        ior: 0.3,
        ..Default::default()
    };
    let tame = MetallicRoughness {
        base_color: Vec3::new(0.0, 1.0, 1.0),
        metallic: 0.0,
        roughness: 1.0,
        ior: 1.0,
        ..Default::default()
    };
    assert_eq!(Bsdf::new(&wild, 1.0), Bsdf::new(&tame, 1.0));
}
