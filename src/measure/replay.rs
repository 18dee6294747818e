//! The replay of one ray with every intersector.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use glam::DVec3;
use serde::Serialize;

use crate::error::Result;
use crate::geometry::{Geometry, Hit, Ray};
use crate::intersect::{Backend, BruteForce, Coherence, Intersector, Precision};
use crate::measure::decimals::{DecimalAnswer, answer_by_decimals};
use crate::measure::oracle::Oracle;
use crate::measure::trace::{closest, occluded, ulps_between};
use crate::render;
use crate::scene::{Light, Provenance, Scene, check::MAX_COORDINATE};
use crate::surface::Surface;

/// The answers of all intersectors for one ray.
#[derive(Clone, Debug, Serialize)]
pub struct Replay<'s> {
    /// The ray, as [`ray_from_text`] parses it.
    pub ray: String,
    /// The answers; the first one is the reference.
    pub answers: Vec<Answer<'s>>,
    /// The answer by the decimals of the file, for the reference's hit; null if there is no hit, or no
    /// file.
    pub decimals: Option<DecimalAnswer>,
}

/// The answer of one intersector for a ray, and for the shadow rays from the reference's hit.
#[derive(Clone, Debug, Serialize)]
pub struct Answer<'s> {
    /// The name of the intersector and its precision.
    pub name: String,
    /// The closest hit; null for none.
    pub hit: Option<ReplayedHit<'s>>,
    /// The difference of t from the reference, in units in the last place; null unless the two hit
    /// the same primitive.
    pub t_error_ulp: Option<u64>,
    /// The occlusion of each light that casts shadows, seen from the reference's hit.
    #[serde(rename = "hidden")]
    pub lights: Vec<LightOcclusion>,
}

/// A hit as it is printed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReplayedHit<'s> {
    /// `sphere`, `plane` or `triangle`.
    pub kind: &'static str,
    /// The index of the primitive; of a triangle its index in the mesh.
    pub primitive: u32,
    /// The index of a triangle's mesh; null for spheres and planes.
    pub mesh: Option<u32>,
    /// The index of a triangle's instance; null for spheres and planes.
    pub instance: Option<u32>,
    /// The distance, in units of the ray's |direction|.
    pub t: f64,
    /// The weight of a triangle's second vertex.
    pub u: f64,
    /// The weight of a triangle's third vertex.
    pub v: f64,
    /// The place in the files that the primitive comes from; null if that is not recorded.
    pub provenance: Option<Provenance<'s>>,
}

/// The occlusion of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct LightOcclusion {
    /// The index of the light.
    pub light: usize,
    /// True if something blocks the shadow ray.
    #[serde(rename = "blocked")]
    pub is_occluded: bool,
}

/// Traces `ray` with the exact oracle, brute force, the BVH and, if it is built in, Embree, in both
/// precisions. The oracle and brute force test every primitive. If the scene was loaded from a `file`,
/// the distance by its decimals is computed, too.
///
/// # Errors
/// When the scene is not valid, or Embree cannot be started.
pub fn replay<'s>(scene: &'s Scene, ray: &Ray, file: Option<&Path>) -> Result<Replay<'s>> {
    use Precision::{Certified, Fast};
    scene.check()?;
    render::in_pool(0, || {
        let mut intersectors: Vec<Named<'_>> = vec![
            ("oracle".to_owned(), Box::new(Oracle::new(scene))),
            ("brute certified".to_owned(), Box::new(BruteForce::new(scene, Certified))),
            ("brute fast".to_owned(), Box::new(BruteForce::new(scene, Fast))),
        ];
        for backend in Backend::available().iter().rev() {
            for precision in [Certified, Fast] {
                let name = format!("{} {}", backend.name(), precision.name());
                intersectors.push((name, backend.build(scene, precision, 0)?));
            }
        }
        Ok(replay_with(scene, ray, file, &intersectors))
    })
}

/// An intersector and its name in the replay.
type Named<'s> = (String, Box<dyn Intersector + 's>);

/// Traces a ray with the intersectors, the first of which is the reference.
fn replay_with<'s>(
    scene: &'s Scene,
    ray: &Ray,
    file: Option<&Path>,
    intersectors: &[Named<'_>],
) -> Replay<'s> {
    let hit = |(_, of): &Named<'_>| closest(&**of, &[*ray], Coherence::Coherent)[0];
    let hits: Vec<Option<Hit>> = intersectors.iter().map(hit).collect();

    // The shadow rays from the reference's hit.
    let reference = hits.first().copied().flatten();
    let surface = reference.map(|hit| Surface::new(scene, ray, &hit));
    let lights = (0..).zip(&scene.lights).filter(|(_, light)| light.casts_shadow());
    let shadow_ray = |(i, light): (usize, &Light)| {
        let surface = surface.as_ref()?;
        Some((i, surface.shadow_ray(ray.direction, &light.incident(surface.position)?)))
    };
    let shadow_rays: Vec<(usize, Ray)> = lights.filter_map(shadow_ray).collect();

    // What each intersector finds for the ray and for these shadow rays.
    let answers = intersectors.iter().zip(&hits).map(|((name, intersector), hit)| {
        let lights = shadow_rays.iter().map(|&(light, ray)| {
            let is_occluded = occluded(&**intersector, &[ray], Coherence::Coherent)[0];
            LightOcclusion { light, is_occluded }
        });
        let same_primitive = hit.zip(reference).filter(|(a, b)| a.id == b.id);
        Answer {
            name: name.clone(),
            hit: hit.map(|hit| ReplayedHit::new(scene, hit)),
            t_error_ulp: same_primitive.map(|(a, b)| ulps_between(a.t, b.t)),
            lights: lights.collect(),
        }
    });
    let decimals = reference.zip(file);
    let decimals = decimals.map(|(hit, file)| answer_by_decimals(file, scene, ray, &hit));
    Replay { ray: ray_to_text(ray), answers: answers.collect(), decimals }
}

impl<'s> ReplayedHit<'s> {
    fn new(scene: &'s Scene, hit: Hit) -> Self {
        let (kind, mesh) = match hit.id.geometry {
            Geometry::Spheres => ("sphere", None),
            Geometry::Planes => ("plane", None),
            Geometry::Mesh(mesh) => ("triangle", Some(mesh)),
        };
        let instance = mesh.map(|_| hit.id.instance);
        let Hit { t, u, v, id } = hit;
        let provenance = scene.provenance_of(id);
        Self { kind, primitive: id.primitive, mesh, instance, t, u, v, provenance }
    }

    /// Returns the name of the primitive.
    fn primitive(&self) -> String {
        match (self.mesh, self.instance) {
            (Some(mesh), Some(instance)) => {
                format!("{} {} of mesh {mesh} in instance {instance}", self.kind, self.primitive)
            }
            _ => format!("{} {}", self.kind, self.primitive),
        }
    }
}

impl fmt::Display for Replay<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for answer in &self.answers {
            write!(f, "{:<16}  ", answer.name)?;
            match (&answer.hit, answer.t_error_ulp) {
                (None, _) => write!(f, "nothing")?,
                (Some(hit), None) => write!(f, "{hit}")?,
                (Some(hit), Some(ulp)) => write!(f, "{hit}  {ulp} ulp")?,
            }
            for LightOcclusion { light, is_occluded } in &answer.lights {
                let visibility = if *is_occluded { "hidden" } else { "in sight" };
                write!(f, "  light {light} {visibility}")?;
            }
            writeln!(f)?;
        }
        if let Some(answer) = &self.decimals {
            writeln!(f, "{:<16}  {answer}", "decimals")?;
        }
        // The provenance of each primitive that somebody found.
        let hits = self.answers.iter().filter_map(|answer| answer.hit.as_ref());
        let mut named = BTreeSet::new();
        for hit in hits.filter(|hit| named.insert(hit.primitive())) {
            if let Some(provenance) = &hit.provenance {
                writeln!(f, "{:<16}  {}: {provenance}", "provenance", hit.primitive())?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for ReplayedHit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.primitive())?;
        // Debug prints the shortest digits from which the number is read back exactly.
        write!(f, "  t {:?}", self.t)?;
        if self.mesh.is_some() { write!(f, "  u {:?}  v {:?}", self.u, self.v) } else { Ok(()) }
    }
}

/// Returns a ray as six numbers with commas between them, origin and direction: the shortest
/// decimals from which every bit is read back.
pub fn ray_to_text(ray: &Ray) -> String {
    let numbers = [ray.origin, ray.direction].map(|v| v.to_array()).concat();
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
}

/// Parses an unbounded ray without a departure, as [`ray_to_text`] writes it.
///
/// # Errors
/// A message, when the text is not six finite numbers, the origin is beyond the limit of a scene's
/// coordinates, or the direction is zero.
pub fn ray_from_text(text: &str) -> std::result::Result<Ray, String> {
    let expected = "expected ox,oy,oz,dx,dy,dz: six numbers, origin and direction";
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let parts: [&str; 6] =
        parts.try_into().map_err(|p: Vec<_>| format!("{expected}; found {} parts", p.len()))?;
    // Six finite numbers.
    let mut numbers = [0.0; 6];
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = part.parse().map_err(|_| format!("{expected}; `{part}` is not a number"))?;
        if !f64::is_finite(*number) {
            return Err(format!("{expected}; `{part}` is not finite"));
        }
    }
    // The ray, whose origin and direction the intersectors must be able to use.
    let [ox, oy, oz, dx, dy, dz] = numbers;
    let ray = Ray::new(DVec3::new(ox, oy, oz), DVec3::new(dx, dy, dz));
    if ray.direction == DVec3::ZERO {
        return Err("the direction is zero".to_owned());
    }
    if ray.origin.abs().max_element() > MAX_COORDINATE {
        return Err(format!("the origin lies beyond {MAX_COORDINATE:e}"));
    }
    Ok(ray)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Falloff, LightKind, Material, Plane, Sphere};
    use proptest::prelude::*;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::default());
        scene.spheres.push(Sphere::new(DVec3::Y * 3.0, 1.0, material));
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Y, material));
        let kind = LightKind::Point {
            position: DVec3::Y * 9.0,
            falloff: Falloff::None,
            range: f64::INFINITY,
        };
        let light = Light::new(kind);
        scene.lights.push(light);
        scene
    }

    #[test]
    fn all_intersectors_agree_on_an_easy_ray() {
        let ray = Ray::new(DVec3::new(2.0, 2.0, 0.0), DVec3::new(-1.0, -1.0, 0.0));
        let scene = scene();
        let found = replay(&scene, &ray, None).unwrap();
        assert_eq!(found.answers.len(), if cfg!(feature = "embree") { 7 } else { 5 });
        for answer in &found.answers {
            let hit = answer.hit.as_ref().unwrap();
            assert_eq!((hit.kind, hit.t, answer.t_error_ulp), ("plane", 2.0, Some(0)));
            assert_eq!(answer.lights, [LightOcclusion { light: 0, is_occluded: true }]);
        }
    }

    #[test]
    fn a_hit_of_another_primitive_than_the_reference_has_no_error_of_t() {
        let (with, mut without) = (scene(), scene());
        without.spheres[0].center = DVec3::X * 50.0;
        let ray = Ray::new(DVec3::Y * 9.0, DVec3::NEG_Y);
        let intersectors: [Named<'_>; 2] = [
            ("with".to_owned(), Box::new(BruteForce::new(&with, Precision::Fast))),
            ("without".to_owned(), Box::new(BruteForce::new(&without, Precision::Fast))),
        ];
        let found = replay_with(&with, &ray, None, &intersectors);
        let errors: Vec<_> = found.answers.iter().map(|a| a.t_error_ulp).collect();
        assert_eq!(errors, [Some(0), None]);
    }

    #[test]
    fn texts_that_are_no_ray_are_refused() {
        for (bad, why) in [
            ("", "1 parts"),
            ("1,2,3,4,5", "5 parts"),
            ("1,2,3,4,5,6,7", "7 parts"),
            ("1,2,3,4,5,x", "`x` is not a number"),
            ("1,2,3,4,5,", "`` is not a number"),
            ("1,2,3,4,5,nan", "`nan` is not finite"),
            ("inf,2,3,4,5,6", "`inf` is not finite"),
            ("1e400,2,3,4,5,6", "`1e400` is not finite"),
            ("1,2,3,0,-0,0", "the direction is zero"),
            ("1e16,2,3,4,5,6", "beyond 1e15"),
        ] {
            let message = ray_from_text(bad).unwrap_err();
            assert!(message.contains(why), "{bad}: {message}");
        }
    }

    proptest! {
        #[test]
        fn every_bit_of_a_ray_comes_back(
            origin in prop::array::uniform3(-1e15..1e15f64),
            direction in prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL),
        ) {
            let ray = Ray::new(origin.into(), direction.into());
            prop_assert_eq!(ray_from_text(&ray_to_text(&ray)), Ok(ray));
        }
    }
}
