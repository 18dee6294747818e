//! Light paths that are reversed.

use super::*;

/// Asserts that f is the same both ways, as far as f32 tells, where the index of refraction is `index`
/// within.
fn assert_reciprocal(name: &str, params: &MetallicRoughness, sides: [f64; 2]) {
    let bsdf = Bsdf::new(params, 1.0);
    let mut random = Random(17);
    let mut count = 0;
    for _ in 0..5000 {
        let mut random_on = |side: f64| {
            let w = random.direction();
            DVec3::new(w.x, w.y, w.z.abs() * side)
        };
        let [a, b] = sides.map(&mut random_on);
        // Sampled directions, too: narrow lobes are hardly hit by chance.
        let sampled = bsdf.sample(a, random.next(), random.pair());
        let b = sampled.filter(|s| !s.is_delta && s.wi.z * sides[1] > 0.0).map_or(b, |s| s.wi);
        let index = |w: DVec3| {
            if params.is_thin || w.z > 0.0 { 1.0 } else { f64::from(params.ior) }
        };
        let f = |wo: DVec3, wi: DVec3| {
            let scale = index(wo).powi(2) / wi.z.abs();
            bsdf.evaluate(wo, wi).as_dvec3() * scale
        };
        let (there, back) = (f(a, b), f(b, a));
        let difference = (there - back).abs().max_element();
        assert!(difference <= 2e-4 * there.max_element() + 1e-6, "{name}: {a} {b}: {there} {back}");
        count += usize::from(there.max_element() > 0.0);
    }
    assert!(count > 0 || sides[0] != sides[1], "{name} is black");
}

#[test]
fn reflection_is_the_same_both_ways() {
    for (name, params) in materials() {
        assert_reciprocal(name, &params, [1.0, 1.0]);
        assert_reciprocal(name, &params, [-1.0, -1.0]);
    }
}

#[test]
fn transmission_is_the_same_both_ways_but_for_the_squares_of_the_indices() {
    let is_of_one_index = |params: &MetallicRoughness| {
        // Each colour of a dispersive boundary has its own, and diffuse transmission has none.
        params.dispersion == 0.0 && (params.is_thin || params.diffuse_transmission == 0.0)
    };
    for (name, params) in materials().into_iter().filter(|(_, params)| is_of_one_index(params)) {
        assert_reciprocal(name, &params, [1.0, -1.0]);
    }
}
