use super::*;
use crate::intersect::Bvh;
use crate::scene::{Camera, Falloff, Light, LightKind, Material, Plane, Projection, Sphere};
use glam::{DVec3, Vec3};

/// Returns a sphere over the ground and a light, in 16 × 16 pixels.
fn scene() -> Scene {
    let mut scene = Scene::default();
    scene.film.size = [16, 16];
    let material = scene.add_material(Material::default());
    let eye = DVec3::new(0.0, 2.0, 6.0);
    let camera = Camera::look_at(eye, DVec3::Y, DVec3::Y, Projection::FovY(0.7)).unwrap();
    scene.cameras.push(camera);
    scene.spheres.push(Sphere::new(DVec3::Y * 1.2, 1.0, material));
    scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, material));
    let kind = LightKind::Point {
        position: DVec3::new(3.0, 5.0, 4.0),
        falloff: Falloff::None,
        range: f64::INFINITY,
    };
    let light = Light::new(kind);
    scene.lights.push(light);
    scene
}

/// Returns the same scene with a mirror for a sphere, in which the ground is reflected.
fn mirror() -> Scene {
    let mut scene = scene();
    let mirror = Material { reflect: Vec3::ONE, ..Material::default() };
    scene.spheres[0].material = scene.add_material(mirror);
    scene
}

#[test]
fn rays_off_a_mirror_are_compared_too() {
    let scene = mirror();
    let reference = Bvh::build(&scene, Precision::Certified);
    let tested = Faulty(Bvh::build(&scene, Precision::Certified), |ray, hit| {
        if ray.departure.is_some() {
            *hit = None;
        }
    });
    let (tested, reference): (&dyn Intersector, &dyn Intersector) = (&tested, &reference);
    let precision = Precision::Fast;
    let found =
        Comparer { scene: &scene, precision, tested, margin: 1e-6, reference, camera: 0 }.run();
    assert!(found.secondary_rays > 20, "{found}");
    assert!(found.causes.other > 20 && !found.passed, "{found}");
}

#[test]
fn without_mirrors_there_are_no_secondary_rays() {
    assert_eq!(compared(Precision::Certified, |_, _| {}).secondary_rays, 0);
}

/// A certified intersector whose hits the function alters.
struct Faulty<'s>(Bvh<'s>, fn(&Ray, &mut Option<Hit>));

impl Intersector for Faulty<'_> {
    fn name(&self) -> &'static str {
        "faulty"
    }

    fn version(&self) -> String {
        String::new()
    }

    fn closest(&self, rays: &[Ray], coherence: Coherence, hits: &mut [Option<Hit>]) {
        self.0.closest(rays, coherence, hits);
        rays.iter().zip(hits).for_each(|(ray, hit)| self.1(ray, hit));
    }

    fn occluded(&self, rays: &[Ray], coherence: Coherence, blocked: &mut [bool]) {
        self.0.occluded(rays, coherence, blocked);
    }
}

fn compared(precision: Precision, fault: fn(&Ray, &mut Option<Hit>)) -> Validation {
    let scene = scene();
    let reference = Bvh::build(&scene, Precision::Certified);
    let tested = Faulty(Bvh::build(&scene, Precision::Certified), fault);
    let (tested, reference): (&dyn Intersector, &dyn Intersector) = (&tested, &reference);
    Comparer { scene: &scene, precision, tested, margin: 1e-6, reference, camera: 0 }.run()
}

/// True if the ray is the one through the centre of pixel (8, 9), which hits the sphere.
fn is_chosen(ray: &Ray) -> bool {
    *ray == scene().cameras[0].ray_generator([16, 16]).ray(8.5, 9.5)
}

#[test]
fn equal_hits_pass_in_both_precisions() {
    for precision in [Precision::Fast, Precision::Certified] {
        let found = compared(precision, |_, _| {});
        assert!(found.passed && found.worst.is_none(), "{found}");
        assert!(found.rays_compared > 300 && found.values_differing == 0, "{found}");
    }
}

#[test]
fn an_ulp_of_t_is_a_figure_in_fast_and_a_failure_in_certified() {
    let fault: fn(&Ray, &mut Option<Hit>) = |ray, hit| {
        if let Some(hit) = hit.as_mut().filter(|_| is_chosen(ray)) {
            hit.t = hit.t.next_up();
        }
    };
    let fast = compared(Precision::Fast, fault);
    assert!(fast.passed && fast.max_t_error_ulp == 1, "{fast}");
    assert_eq!((fast.worst.as_ref().unwrap().pixel, fast.primitive_mismatches), ([8, 9], 0));
    let certified = compared(Precision::Certified, fault);
    assert!(!certified.passed && certified.causes.other == 1, "{certified}");
}

#[test]
fn a_hit_of_another_primitive_has_no_error_of_t() {
    let found = compared(Precision::Fast, |ray, hit| {
        if let Some(hit) = hit.as_mut().filter(|_| is_chosen(ray)) {
            hit.t *= 2.0;
            hit.id.geometry = crate::geometry::Geometry::Planes;
        }
    });
    let worst = found.worst.unwrap();
    assert_eq!((found.max_t_error_ulp, worst.t_error_ulp), (0, None));
    assert_eq!((worst.pixel, worst.cause), ([8, 9], Some("other")));
}

#[test]
fn a_weight_that_differs_fails_in_certified() {
    let found = compared(Precision::Certified, |ray, hit| {
        if let Some(hit) = hit.as_mut().filter(|_| is_chosen(ray)) {
            hit.u = f64::MIN_POSITIVE;
        }
    });
    assert!(!found.passed && found.causes.other == 1, "{found}");
}

#[test]
fn a_sphere_that_is_not_hit_is_unexplained_and_the_worst_ray_finds_it_again() {
    let found = compared(Precision::Fast, |ray, hit| {
        if is_chosen(ray) {
            *hit = None;
        }
    });
    assert!(!found.passed && found.unexplained_mismatches == 1, "{found}");
    assert_eq!(found.heatmap.pixel(8, 9), RED);
    let worst = found.worst.unwrap();
    assert_eq!((worst.pixel, worst.cause, worst.is_shadow_ray), ([8, 9], Some("other"), false));
    assert!(is_chosen(&crate::measure::ray_from_text(&worst.ray).unwrap()));
}
