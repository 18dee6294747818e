//! One ray again, asked of every intersector.

use std::fmt;

use glam::DVec3;
use serde::Serialize;

use crate::error::Result;
use crate::geometry::{Geometry, Hit, Ray};
use crate::intersect::{BruteForce, Bvh, Coherence, Intersector, Precision};
use crate::measure::oracle::Oracle;
use crate::render;
use crate::scene::Scene;
use crate::scene::check::MAX_COORDINATE;
use crate::surface::Surface;

/// What everyone says of a ray.
#[derive(Clone, Debug, Serialize)]
pub struct Replay {
    /// The ray, as [`ray_from_text`] takes it.
    pub ray: String,
    /// The answers; the first one is the reference.
    pub answers: Vec<Answer>,
}

/// What one intersector says of a ray, and of the shadow rays from what the reference hits.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Who says so.
    pub name: &'static str,
    /// The closest hit; null for none.
    pub hit: Option<Met>,
    /// How far t is from the reference, in units in the last place; null where the two do not hit
    /// the same primitive.
    pub t_error_ulp: Option<u64>,
    /// Whether each light that casts shadows is hidden from the point that the reference hits.
    pub hidden: Vec<Hidden>,
}

/// A hit in words and numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Met {
    /// `sphere`, `plane` or `triangle`.
    pub kind: &'static str,
    /// Its index; a triangle's within its mesh.
    pub primitive: u32,
    /// The mesh and the instance of a triangle; null for spheres and planes.
    pub mesh: Option<u32>,
    /// See `mesh`.
    pub instance: Option<u32>,
    /// Distance, in units of the direction's length.
    pub t: f64,
    /// Weight of a triangle's second corner.
    pub u: f64,
    /// Weight of a triangle's third corner.
    pub v: f64,
}

/// Whether a light is hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Hidden {
    /// The light's index.
    pub light: usize,
    /// Whether something stands before it.
    pub blocked: bool,
}

/// Asks the exact oracle, brute force, the BVH and, where it is built in, Embree, in both
/// precisions, what `ray` meets in `scene`. The oracle and brute force try every primitive.
///
/// # Errors
/// When the scene is not valid, or Embree cannot be started.
pub fn replay(scene: &Scene, ray: &Ray) -> Result<Replay> {
    use Precision::{Certified, Fast};
    scene.check()?;
    render::in_pool(0, || {
        let others: [Named<'_>; 5] = [
            ("oracle", Box::new(Oracle::new(scene))),
            ("brute certified", Box::new(BruteForce::new(scene, Certified))),
            ("brute fast", Box::new(BruteForce::new(scene, Fast))),
            ("rust certified", Box::new(Bvh::build(scene, Certified))),
            ("rust fast", Box::new(Bvh::build(scene, Fast))),
        ];
        let asked = others.into_iter().chain(embree(scene)?).collect::<Vec<_>>();
        let asked: Vec<(&'static str, &dyn Intersector)> =
            asked.iter().map(|(name, intersector)| (*name, &**intersector)).collect();
        Ok(ask(scene, ray, &asked))
    })
}

/// An intersector, and what it is called here.
type Named<'s> = (&'static str, Box<dyn Intersector + 's>);

/// Embree in both precisions, where it is built in.
#[cfg(feature = "embree")]
fn embree(scene: &Scene) -> Result<Vec<Named<'_>>> {
    let names = [("embree certified", Precision::Certified), ("embree fast", Precision::Fast)];
    let build = |(name, precision)| -> Result<Named<'_>> {
        Ok((name, crate::intersect::Backend::Embree.build(scene, precision, 0)?))
    };
    names.into_iter().map(build).collect()
}

/// Embree, which this build is without.
#[cfg(not(feature = "embree"))]
fn embree(_: &Scene) -> Result<[Named<'_>; 0]> {
    Ok([])
}

/// Asks each of `asked`; the first one is the reference.
fn ask(scene: &Scene, ray: &Ray, asked: &[(&'static str, &dyn Intersector)]) -> Replay {
    let hits: Vec<Option<Hit>> = asked
        .iter()
        .map(|(_, intersector)| {
            let mut hit = [None];
            intersector.closest(&[*ray], Coherence::Coherent, &mut hit);
            hit[0]
        })
        .collect();
    let reference = hits.first().copied().flatten();
    let surface = reference.map(|hit| Surface::new(scene, ray, &hit));
    let shadows: Vec<(usize, Ray)> = (0..)
        .zip(&scene.lights)
        .filter(|(_, light)| light.casts_shadow())
        .filter_map(|(i, light)| {
            let surface = surface.as_ref()?;
            Some((i, surface.shadow_ray(&light.incident(surface.position)?)))
        })
        .collect();
    let answers = asked.iter().zip(&hits).map(|((name, intersector), hit)| {
        let hidden = shadows.iter().map(|&(light, shadow)| {
            let mut blocked = [false];
            intersector.occluded(&[shadow], Coherence::Coherent, &mut blocked);
            Hidden { light, blocked: blocked[0] }
        });
        let same = hit.zip(reference).filter(|(a, b)| a.id == b.id);
        Answer {
            name,
            hit: hit.map(Met::from),
            t_error_ulp: same.map(|(a, b)| a.t.to_bits().abs_diff(b.t.to_bits())),
            hidden: hidden.collect(),
        }
    });
    Replay { ray: ray_to_text(ray), answers: answers.collect() }
}

impl From<Hit> for Met {
    fn from(hit: Hit) -> Self {
        let (kind, mesh) = match hit.id.geometry {
            Geometry::Spheres => ("sphere", None),
            Geometry::Planes => ("plane", None),
            Geometry::Mesh(mesh) => ("triangle", Some(mesh)),
        };
        let instance = mesh.map(|_| hit.id.instance);
        let Hit { t, u, v, id } = hit;
        Self { kind, primitive: id.primitive, mesh, instance, t, u, v }
    }
}

impl fmt::Display for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for answer in &self.answers {
            write!(f, "{:<16}  ", answer.name)?;
            match (&answer.hit, answer.t_error_ulp) {
                (None, _) => write!(f, "nothing")?,
                (Some(hit), None) => write!(f, "{hit}")?,
                (Some(hit), Some(ulp)) => write!(f, "{hit}  {ulp} ulp")?,
            }
            for Hidden { light, blocked } in &answer.hidden {
                let seen = if *blocked { "hidden" } else { "in sight" };
                write!(f, "  light {light} {seen}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

impl fmt::Display for Met {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.kind, self.primitive)?;
        if let (Some(mesh), Some(instance)) = (self.mesh, self.instance) {
            write!(f, " of mesh {mesh} in instance {instance}")?;
        }
        // As Debug, so that the shortest digits that give the number back stand there.
        write!(f, "  t {:?}", self.t)?;
        if self.mesh.is_some() { write!(f, "  u {:?}  v {:?}", self.u, self.v) } else { Ok(()) }
    }
}

/// A ray as six numbers with commas between them, origin and direction: the shortest decimals that
/// give every bit back.
pub fn ray_to_text(ray: &Ray) -> String {
    let numbers = [ray.origin, ray.direction].map(|v| v.to_array()).concat();
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
}

/// An unbounded ray that left no surface, from what [`ray_to_text`] writes.
///
/// # Errors
/// What is wrong, in words: it is not six finite numbers, the origin is beyond what a scene may
/// reach, or the direction is zero.
pub fn ray_from_text(text: &str) -> std::result::Result<Ray, String> {
    let form = "expected ox,oy,oz,dx,dy,dz: six numbers, origin and direction";
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let parts: [&str; 6] =
        parts.try_into().map_err(|p: Vec<_>| format!("{form}; found {} parts", p.len()))?;
    let mut numbers = [0.0; 6];
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = part.parse().map_err(|_| format!("{form}; `{part}` is not a number"))?;
        if !f64::is_finite(*number) {
            return Err(format!("{form}; `{part}` is not finite"));
        }
    }
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
    use crate::scene::{Falloff, Light, LightKind, Material, Plane, Shadow, Sphere};
    use glam::Vec3;
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
        let light =
            Light { name: String::new(), kind, intensity: Vec3::ONE, shadow: Shadow::default() };
        scene.lights.push(light);
        scene
    }

    #[test]
    fn everyone_is_asked_and_agrees_on_an_easy_ray() {
        let ray = Ray::new(DVec3::new(2.0, 2.0, 0.0), DVec3::new(-1.0, -1.0, 0.0));
        let found = replay(&scene(), &ray).unwrap();
        assert_eq!(found.answers.len(), if cfg!(feature = "embree") { 7 } else { 5 });
        for answer in &found.answers {
            let hit = answer.hit.as_ref().unwrap();
            assert_eq!((hit.kind, hit.t, answer.t_error_ulp), ("plane", 2.0, Some(0)));
            assert_eq!(answer.hidden, [Hidden { light: 0, blocked: true }]);
        }
    }

    #[test]
    fn what_hits_another_primitive_than_the_reference_has_no_error_of_t() {
        let (with, mut without) = (scene(), scene());
        without.spheres.clear();
        let ray = Ray::new(DVec3::Y * 9.0, DVec3::NEG_Y);
        let asked: [(_, &dyn Intersector); 2] = [
            ("with", &BruteForce::new(&with, Precision::Fast)),
            ("without", &BruteForce::new(&without, Precision::Fast)),
        ];
        let found = ask(&with, &ray, &asked);
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
