use super::*;

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
    reflected.set::<true>(&lit, &incident, &lanes(view), &hits.blocks()[0]);
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
