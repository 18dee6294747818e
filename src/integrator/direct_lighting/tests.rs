use glam::DVec3;

use super::*;
use crate::geometry::PrimitiveId16;
use crate::shading;

const NO_PBR: PbrLanes<'_> = PbrLanes { hits: &[], bsdf: &|_| unreachable!(), opaque: None };

/// A white Lambert surface without a highlight.
fn matte() -> LitSurface16 {
    LitSurface16 { scatters: [true; LANES], diffuse: [[1.0; LANES]; 3], ..LitSurface16::default() }
}

/// A surface with a white highlight of this exponent, and this diffuse colour.
fn glossy(diffuse: f32, shininess: f32) -> LitSurface16 {
    LitSurface16 {
        diffuse: [[diffuse; LANES]; 3],
        specular: [[1.0; LANES]; 3],
        shininess: [shininess; LANES],
        has_highlights: true,
        common_exponent: shading::integer_exponent(shininess),
        ..matte()
    }
}

/// Returns what the surface, with a normal along +y, reflects of a light to a viewer who sees it along
/// `view`.
fn reflected(mut lit: LitSurface16, view: DVec3, light: DVec3) -> Vec3 {
    let lanes = |v: DVec3| v.to_array().map(|x| [x; LANES]);
    lit.surface.normal = lanes(DVec3::Y);
    lit.surface.geometric_normal = lanes(DVec3::Y);
    let arrives = [true; LANES];
    let incident = IncidentLight16 { toward: lanes(light), arrives, ..Default::default() };
    let mut reflected = Reflected16::default();
    let mut hits = crate::geometry::HitBatch::default();
    hits.reset_to_misses(LANES);
    reflected.set::<true, true>(&lit, &NO_PBR, &incident, &lanes(view), &hits.blocks()[0]);
    if reflected.faces_light[0] { lane(&reflected.share, 0) } else { Vec3::ZERO }
}

#[test]
fn lambert_at_sixty_degrees_is_a_half() {
    let light = DVec3::new(3f64.sqrt() / 2.0, 0.5, 0.0) * 7.0;
    let sum = reflected(matte(), DVec3::NEG_Y, light);
    assert!((sum - Vec3::splat(0.5)).length() < 1e-7);
}

#[test]
fn a_surface_that_faces_away_from_the_light_reflects_nothing() {
    assert_eq!(reflected(glossy(1.0, 2.0), DVec3::NEG_Y, DVec3::NEG_Y), Vec3::ZERO);
}

#[test]
fn highlight_is_whole_in_the_mirror_direction() {
    let view = DVec3::new(1.0, -1.0, 0.0);
    let sum = reflected(glossy(0.0, 100.0), view, DVec3::new(1.0, 1.0, 0.0));
    assert!((sum - Vec3::ONE).length() < 1e-6);
}

#[test]
fn even_exponent_does_not_light_what_faces_away_from_the_mirror_direction() {
    let view = DVec3::new(1.0, -0.1, 0.0);
    let light = DVec3::new(-1.0, 0.05, 0.0);
    assert_eq!(reflected(glossy(0.0, 2.0), view, light), Vec3::ZERO);
}

/// Returns what a white face of a smooth mesh reflects of a light at this angle from its shading normal, where
/// the faces about the point are turned from it by `spread`.
fn of_smooth_face(spread: f64, light: f64) -> f32 {
    let lanes = |v: DVec3| v.to_array().map(|x| [x; LANES]);
    let mut lit = matte();
    lit.surface.normal = lanes(DVec3::Y);
    lit.surface.geometric_normal = lanes(DVec3::Y);
    lit.surface.spread = [spread.tan(); LANES];
    lit.surface.has_triangles = true;
    let toward = lanes(DVec3::new(light.sin(), light.cos(), 0.0));
    let incident = IncidentLight16 { toward, arrives: [true; LANES], ..Default::default() };
    let mut hits = crate::geometry::HitBatch::default();
    hits.resize(LANES)[0].id.geometry = [PrimitiveId16::MESHES; LANES];
    let mut reflected = Reflected16::default();
    reflected.set::<false, true>(&lit, &NO_PBR, &incident, &lanes(DVec3::NEG_Y), &hits.blocks()[0]);
    reflected.share[0][0]
}

#[test]
fn light_fades_out_before_it_grazes_any_of_the_faces_about_a_point() {
    let [spread, light] = [15f64, 60.0].map(f64::to_radians);
    // By the paper, for a face that is turned from the light: (m·l) / ((n·l) (n·m)).
    let g = (light + spread).cos() / (light.cos() * spread.cos());
    let expected = light.cos() * (g + g * g - g * g * g);
    assert!((f64::from(of_smooth_face(spread, light)) - expected).abs() < 1e-7);
    assert!(of_smooth_face(spread, 74.9f64.to_radians()) < 2e-3);
    for beyond in [75.1f64, 80.0, 89.9] {
        assert_eq!(of_smooth_face(spread, beyond.to_radians()), 0.0);
    }
    // Light along the normal, and that on a flat mesh, is whole.
    assert_eq!(of_smooth_face(spread, 0.0), 1.0);
    assert!((f64::from(of_smooth_face(0.0, 1.5)) - 1.5f64.cos()).abs() < 1e-7);
}
