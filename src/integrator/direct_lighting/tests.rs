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
    reflected.set::<true, true>(&lit, &incident, &lanes(view), &hits.blocks()[0]);
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

/// What a white face along +y, whose shading normal is turned by `bend` toward +x, reflects of a light
/// that is turned by `light` from +y toward +x.
fn of_bent_face(bend: f64, light: f64) -> f32 {
    let lanes = |v: DVec3| v.to_array().map(|x| [x; LANES]);
    let at = |angle: f64| DVec3::new(angle.sin(), angle.cos(), 0.0);
    let mut lit = matte();
    lit.surface.normal = lanes(at(bend));
    lit.surface.geometric_normal = lanes(DVec3::Y);
    lit.surface.has_triangles = true;
    let arrives = [true; LANES];
    let incident = IncidentLight16 { toward: lanes(at(light)), arrives, ..Default::default() };
    let mut hits = crate::geometry::HitBatch::default();
    hits.resize(LANES)[0].id.geometry = [PrimitiveId16::MESHES; LANES];
    let mut reflected = Reflected16::default();
    reflected.set::<false, true>(&lit, &incident, &lanes(DVec3::NEG_Y), &hits.blocks()[0]);
    if reflected.faces_light[0] { reflected.share[0][0] } else { 0.0 }
}

#[test]
fn light_fades_out_toward_the_edge_of_a_face_and_is_whole_where_the_face_sees_it_well() {
    // By g = (m·l) / ((n·l) (n·m)) = cos 80° / (cos 50° cos 30°), for a normal turned by 30°.
    let [bend, light] = [30f64, 80.0].map(f64::to_radians);
    let g = light.cos() / ((light - bend).cos() * bend.cos());
    let expected = (light - bend).cos() * (g + g * g - g * g * g);
    assert!((f64::from(of_bent_face(bend, light)) - expected).abs() < 1e-7);
    // At the edge nothing is left; beside it, next to nothing.
    assert!(of_bent_face(bend, 90f64.to_radians()) < 1e-15);
    assert!(of_bent_face(bend, 89.9f64.to_radians()) < 0.01);
    // Where the face is turned to the light more than its normal, and without a bend, nothing is lost.
    assert_eq!(of_bent_face(bend, -30f64.to_radians()), 60f64.to_radians().cos() as f32);
    for degrees in [1f64, 45.0, 89.0] {
        let light = degrees.to_radians();
        assert!((f64::from(of_bent_face(0.0, light)) - light.cos()).abs() < 1e-7);
    }
}
