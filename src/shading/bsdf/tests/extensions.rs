//! Each extension changes what it should, and nothing where its factor is 0.

use super::*;

const GRID: [f64; 4] = [5.0, 35.0, 60.0, 80.0];

/// Returns f |cos θi| of a grid of pairs of directions, on both sides.
fn values(params: &MetallicRoughness) -> Vec<Vec3> {
    let bsdf = Bsdf::new(params, 1.0);
    let directions = || GRID.into_iter().chain([125.0, 165.0]);
    let pairs = directions().flat_map(|a| directions().map(move |b| (a, b)));
    pairs.map(|(a, b)| bsdf.evaluate(at(a, 10.0), at(b, 200.0))).collect()
}

#[test]
fn extensions_at_zero_leave_the_base_as_it_is() {
    for base in [metal(0.5), plastic(0.5, 1.5), glass(0.5, 1.5)] {
        let with = |change: fn(&mut MetallicRoughness)| {
            let mut params = base;
            change(&mut params);
            assert_eq!(values(&params), values(&base), "{params:?}");
        };
        with(|p| p.clearcoat_roughness = 0.5);
        with(|p| p.sheen_roughness = 0.5);
        with(|p| p.iridescence_thickness = 700.0);
        with(|p| p.iridescence_ior = 2.0);
        with(|p| p.diffuse_transmission_color = Vec3::X);
        with(|p| p.specular_color = Vec3::ONE);
    }
}

#[test]
fn weak_extensions_are_close_to_none() {
    let base = plastic(0.5, 1.5);
    let with = |change: fn(&mut MetallicRoughness)| {
        let mut params = base;
        change(&mut params);
        let (found, expected) = (values(&params), values(&base));
        assert_ne!(found, expected, "{params:?}");
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs().max_element() < 0.01, "{params:?}");
        }
    };
    with(|p| p.clearcoat = 0.002);
    with(|p| p.sheen_color = Vec3::splat(0.002));
    with(|p| p.anisotropy = 0.02);
    with(|p| p.iridescence = 0.002);
    with(|p| p.diffuse_transmission = 0.002);
    with(|p| p.transmission = 0.002);
}

#[test]
fn sheen_brightens_dark_cloth_most_at_grazing_angles() {
    let color = Vec3::new(1.0, 0.5, 0.0);
    let black = MetallicRoughness { base_color: Vec3::ZERO, specular: 0.0, ..plastic(1.0, 1.5) };
    let cloth = MetallicRoughness { sheen_color: color, sheen_roughness: 0.4, ..black };
    let [head_on, grazing] = [5.0, 80.0].map(|angle| furnace(&cloth, at(angle, 0.0), 200)[0]);
    assert!(grazing.x > 2.0 * head_on.x && head_on.x > 0.0, "{head_on} {grazing}");
    assert!((grazing.y / grazing.x - 0.5).abs() < 1e-3 && grazing.z == 0.0, "{grazing}");
}

#[test]
fn sheen_takes_from_the_base_what_it_reflects() {
    let base = plastic(0.5, 1.5);
    let cloth = MetallicRoughness { sheen_color: Vec3::X, sheen_roughness: 0.5, ..base };
    let [plain, covered] = [base, cloth].map(|p| furnace(&p, at(60.0, 0.0), 200)[0]);
    assert!(covered.y < plain.y - 0.02, "{covered} {plain}");
    assert!(covered.x <= 1.005, "{covered}");
}

#[test]
fn clearcoat_adds_a_white_mirror_and_darkens_the_base() {
    let base = MetallicRoughness { base_color: Vec3::X, ..metal(0.6) };
    let coated = MetallicRoughness { clearcoat: 1.0, ..base };
    let wo = at(30.0, 0.0);
    let mirror = delta_lobes(&Bsdf::new(&coated, 1.0), wo)[0];
    // Schlick's 0.04 + 0.96 (1 − cos 30°)⁵.
    assert!((mirror - 0.040_041_6).abs().max_element() < 1e-5, "{mirror}");
    assert_eq!(delta_lobes(&Bsdf::new(&base, 1.0), wo)[0], Vec3::ZERO);
    let wi = at(45.0, 120.0);
    let [plain, covered] = [base, coated].map(|p| Bsdf::new(&p, 1.0).evaluate(wo, wi).x);
    assert!(covered < 0.97 * plain && covered > 0.9 * plain, "{covered} {plain}");
}

#[test]
fn a_clearcoat_is_not_met_from_within() {
    let coated = MetallicRoughness { clearcoat: 1.0, clearcoat_roughness: 0.4, ..glass(0.4, 1.5) };
    let (wo, wi) = (at(160.0, 0.0), at(150.0, 180.0));
    let [plain, covered] =
        [glass(0.4, 1.5), coated].map(|params| Bsdf::new(&params, 1.0).evaluate(wo, wi));
    assert_eq!(plain, covered);
}

#[test]
fn anisotropy_widens_the_lobe_along_its_direction() {
    for rotation in [0.0, 40.0] {
        let params = MetallicRoughness {
            anisotropy: 0.7,
            anisotropy_rotation: f64::to_radians(rotation) as f32,
            ..metal(0.4)
        };
        let bsdf = Bsdf::new(&params, 1.0);
        let along = bsdf.evaluate(DVec3::Z, at(30.0, rotation)).x;
        let across = bsdf.evaluate(DVec3::Z, at(30.0, rotation + 90.0)).x;
        assert!(along > 2.0 * across, "{along} {across}");
        let round = Bsdf::new(&metal(0.4), 1.0);
        assert!(across < round.evaluate(DVec3::Z, DVec3::Z).x);
    }
}

#[test]
fn iridescence_colors_white_metal_by_angle_and_thickness() {
    let film = |thickness: f32| MetallicRoughness {
        iridescence: 1.0,
        iridescence_ior: 1.8,
        iridescence_thickness: thickness,
        base_color: Vec3::splat(0.5),
        ..metal(0.0)
    };
    let color =
        |thickness, angle| delta_lobes(&Bsdf::new(&film(thickness), 1.0), at(angle, 0.0))[0];
    let hue = |c: Vec3| c / c.max_element();
    let reference = color(300.0, 10.0);
    assert!(hue(reference).min_element() < 0.9, "{reference}");
    for other in [color(400.0, 10.0), color(300.0, 60.0)] {
        assert!((hue(other) - hue(reference)).length() > 0.1, "{other} {reference}");
    }
    // Head-on, a film of no thickness is none.
    let none = color(0.0, 0.0);
    let plain = MetallicRoughness { iridescence: 0.0, ..film(0.0) };
    let expected = delta_lobes(&Bsdf::new(&plain, 1.0), at(0.0, 0.0))[0];
    assert!((none - expected).abs().max_element() < 1e-4, "{none} {expected}");
}

#[test]
fn dispersion_bends_blue_more_than_red_by_the_abbe_number() {
    // V = 20: nF − nC = 0.5/20 for n = 1.5.
    let params = MetallicRoughness { dispersion: 1.0, ..glass(0.0, 1.5) };
    let bsdf = Bsdf::new(&params, 1.0);
    let wo = at(50.0, 0.0);
    let mut found = [None; 3];
    for u in midpoints(300) {
        let sample = bsdf.sample(wo, u, [0.5; 2]).unwrap();
        if sample.is_transmission {
            let channel = (0..3).find(|i| sample.value[*i] > 0.0).unwrap();
            assert_eq!(sample.value[(channel + 1) % 3], 0.0);
            found[channel] = Some(wo.x / -sample.wi.x);
        }
    }
    let expected = [1.4875, 1.5, 1.5125];
    for (index, expected) in found.into_iter().zip(expected) {
        assert!((index.unwrap() - expected).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn diffuse_transmission_moves_light_to_the_other_side() {
    let leaf = |share| MetallicRoughness {
        diffuse_transmission: share,
        diffuse_transmission_color: Vec3::Y,
        ..plastic(0.5, 1.5)
    };
    let sums = [0.0, 0.5, 1.0].map(|share| furnace(&leaf(share), at(30.0, 0.0), 160));
    let transmitted = sums.map(|[_, transmitted]| transmitted);
    assert_eq!((transmitted[0], transmitted[2].x), (Vec3::ZERO, 0.0));
    assert!((transmitted[2].y - 2.0 * transmitted[1].y).abs() < 1e-4, "{transmitted:?}");
    // What is left is the reflection.
    assert!(transmitted[2].y > 0.9 && sums[2][0].x < 0.1, "{sums:?}");
}

#[test]
fn specular_sets_the_strength_and_the_color_of_a_dielectrics_reflection() {
    let params = |specular, specular_color| MetallicRoughness {
        specular,
        specular_color,
        ..plastic(0.0, 1.5)
    };
    let wo = at(5.0, 0.0);
    let mirror = |specular, color| delta_lobes(&Bsdf::new(&params(specular, color), 1.0), wo)[0];
    assert_eq!(mirror(0.0, Vec3::ONE), Vec3::ZERO);
    let half = mirror(0.5, Vec3::new(1.0, 2.0, 100.0));
    assert!((half - Vec3::new(0.02, 0.04, 0.5)).abs().max_element() < 1e-5, "{half}");
    // Without reflection the base is Lambert's.
    let matte = Bsdf::new(&params(0.0, Vec3::ONE), 1.0);
    let value = matte.evaluate(wo, at(60.0, 90.0)).x;
    assert!((value - 0.5 / PI as f32).abs() < 1e-5, "{value}");
}

#[test]
fn the_index_of_the_medium_around_counts() {
    let wo = at(0.0, 0.0);
    let mirror = |outside| delta_lobes(&Bsdf::new(&glass(0.0, 1.5), outside), wo)[0].x;
    assert!((mirror(1.0) - 0.04).abs() < 1e-6);
    assert!((mirror(1.33) - (0.17f32 / 2.83).powi(2)).abs() < 1e-6);
    assert_eq!(mirror(1.5), 0.0);
}
