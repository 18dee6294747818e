//! Smooth surfaces, and what a nearly smooth one comes close to.

use super::*;
use crate::shading::bsdf::BsdfSample;

/// Returns the delta samples of a material, the reflection first.
fn delta_samples(params: &MetallicRoughness, wo: DVec3) -> Vec<BsdfSample> {
    let bsdf = Bsdf::new(params, 1.0);
    let mut found: Vec<BsdfSample> = Vec::new();
    for u in midpoints(301) {
        let sample = bsdf.sample(wo, u, [0.3, 0.6]).filter(|sample| sample.is_delta);
        found.extend(sample.filter(|sample| !found.contains(sample)));
    }
    found.sort_by_key(|sample| sample.is_transmission);
    found
}

fn schlick(f0: f64, cosine: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cosine).powi(5)
}

#[test]
fn smooth_metal_is_a_mirror() {
    let wo = at(60.0, 25.0);
    let gold = Vec3::new(1.0, 0.7, 0.3);
    let found = delta_samples(&MetallicRoughness { base_color: gold, ..metal(0.0) }, wo);
    let [mirror] = found[..] else { panic!("{found:?}") };
    assert!((mirror.wi - DVec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-12);
    let expected = gold.as_dvec3().map(|f0| schlick(f0, 0.5));
    assert!((mirror.value.as_dvec3() - expected).length() < 1e-6);
    assert_eq!((mirror.pdf, mirror.is_transmission), (1.0, false));
}

#[test]
fn smooth_glass_refracts_by_snells_law_and_reflects_by_schlicks_formula() {
    let ior = 1.5;
    for (angle, cosine) in [
        (50.0, 50f64.to_radians().cos()),
        (155.0, {
            // From within, Schlick's cosine is that of the refracted angle.
            (1.0 - (1.5 * 25f64.to_radians().sin()).powi(2)).sqrt()
        }),
    ] {
        let wo = at(angle, 70.0);
        let found = delta_samples(&glass(0.0, ior), wo);
        let [mirror, refraction] = found[..] else { panic!("{found:?}") };
        let reflected = schlick(0.04, cosine);
        assert!((f64::from(mirror.value.x) - reflected).abs() < 1e-6, "{mirror:?}");
        assert!((f64::from(refraction.value.x) - (1.0 - reflected)).abs() < 1e-6);
        let eta = if wo.z > 0.0 { 1.5 } else { 1.0 / 1.5 };
        let [o, i] = [wo, refraction.wi].map(|w| w.truncate());
        assert!((o + i * eta).length() < 1e-12, "{refraction:?}");
        assert!((mirror.pdf + refraction.pdf - 1.0).abs() < 1e-6);
    }
}

#[test]
fn beyond_the_critical_angle_glass_is_a_mirror() {
    let found = delta_samples(&glass(0.0, 1.5), at(130.0, 0.0));
    let [mirror] = found[..] else { panic!("{found:?}") };
    assert_eq!((mirror.value, mirror.is_transmission), (Vec3::ONE, false));
}

#[test]
fn light_goes_straight_through_thin_surfaces_and_equal_indices() {
    let pane = MetallicRoughness { is_thin: true, ..glass(0.0, 1.5) };
    for params in [pane, glass(0.0, 1.0), glass(0.8, 1.0)] {
        for wo in [at(40.0, 10.0), at(140.0, 10.0)] {
            let found = delta_samples(&params, wo);
            let straight = found.iter().find(|sample| sample.is_transmission).unwrap();
            assert!((straight.wi + wo).length() < 1e-12, "{straight:?}");
        }
    }
}

#[test]
fn nothing_goes_through_a_surface_with_index_zero() {
    let params = MetallicRoughness { base_color: Vec3::splat(0.5), ..plastic(0.0, 0.0) };
    let wo = at(40.0, 0.0);
    let [reflected, transmitted] = furnace(&params, wo, 64);
    assert!((reflected - 1.0).abs().max_element() < 1e-5);
    assert_eq!(transmitted, Vec3::ZERO);
}

#[test]
fn nearly_smooth_surfaces_send_on_as_much_as_smooth_ones() {
    // Roughness 0.0099 is the greatest that counts as smooth.
    for params in [metal(0.0), plastic(0.0, 1.5), glass(0.0, 1.5), glass(0.0, 2.4)] {
        for angle in [20.0, 60.0, 80.0, 150.0, 170.0] {
            let wo = at(angle, 30.0);
            let sum = |roughness: f32| {
                let bsdf = Bsdf::new(&MetallicRoughness { roughness, ..params }, 1.0);
                let mut random = Random(2);
                let mut sum = Vec3::ZERO;
                for _ in 0..20_000 {
                    if let Some(s) = bsdf.sample(wo, random.next(), random.pair()) {
                        sum += s.value / s.pdf as f32 / 20_000.0;
                    }
                }
                sum
            };
            let [smooth, rough] = [0.0, 0.011].map(sum);
            let difference = (smooth - rough).abs().max_element();
            assert!(difference < 0.01, "{params:?} at {angle}°: {smooth} {rough}");
        }
    }
}

#[test]
fn default_material_is_rough_white_metal() {
    let bsdf = Bsdf::new(&MetallicRoughness::default(), 1.0);
    assert_eq!(bsdf, Bsdf::new(&metal(1.0), 1.0));
    // α = 1: D = 1/π and G₂ = 1; the rest is scattered often.
    let once = f64::from(bsdf.evaluate(DVec3::Z, DVec3::Z).x)
        - bsdf.base.multiple_part(DVec3::Z, DVec3::Z);
    assert!((once - 1.0 / (4.0 * PI)).abs() < 1e-6, "{once}");
}

#[test]
fn the_lobe_of_a_rough_metal_is_the_formula_of_the_specification() {
    // B.3: D, V and F written out for one pair of directions.
    let (roughness, f0) = (0.5f64, 0.6f64);
    let params = MetallicRoughness { base_color: Vec3::splat(0.6), ..metal(0.5) };
    let (wo, wi) = (at(30.0, 0.0), at(50.0, 160.0));
    let (alpha, h) = (roughness * roughness, (wo + wi).normalize());
    let square = alpha * alpha;
    let d = square / (PI * (h.z * h.z * (square - 1.0) + 1.0).powi(2));
    let part = |w: DVec3| (square + (1.0 - square) * w.z * w.z).sqrt();
    let v = 0.5 / (wi.z * part(wo) + wo.z * part(wi));
    let single = d * v * schlick(f0, wo.dot(h)) * wi.z;
    let bsdf = Bsdf::new(&params, 1.0);
    let found = f64::from(bsdf.evaluate(wo, wi).x) - bsdf.base.multiple_part(wo, wi);
    assert!((found - single).abs() < 1e-6, "{found} {single}");
}

#[test]
fn albedos_of_the_lobes_of_an_opaque_material_add_up_to_its_albedo() {
    let varnish =
        MetallicRoughness { clearcoat: 0.7, clearcoat_roughness: 0.2, ..plastic(0.4, 1.5) };
    let leaf = MetallicRoughness { diffuse_transmission: 0.4, ..plastic(0.6, 1.4) };
    for params in [metal(0.3), plastic(0.5, 1.5), varnish, leaf] {
        let (bsdf, wo) = (Bsdf::new(&params, 1.0), at(40.0, 0.0));
        let lobes = bsdf.lobe_albedos(wo);
        let sum = lobes.reflection
            + lobes.diffuse
            + lobes.diffuse_transmission
            + lobes.clearcoat
            + lobes.sheen;
        assert_eq!(lobes.transmissive, 0.0);
        assert!((sum - bsdf.albedo(wo)).abs().max_element() < 1e-6, "{params:?}");
    }
}
