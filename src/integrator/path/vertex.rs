//! The vertices of light paths: surfaces that scatter light, in either shading model.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::{Departure, Hit, Ray, Side};
use crate::integrator::Integrator;
use crate::integrator::material_cache::scattered_reflectance;
use crate::integrator::nested_dielectrics::InteriorList;
use crate::integrator::pbr_surfaces::{facing, local_frame};
use crate::integrator::secondary_rays::{Scattered, scatter_light};
use crate::integrator::wave::PathState;
use crate::integrator::wave_surfaces::SpecularHit;
use crate::shading::{Bsdf, PhongBsdf};
use crate::surface::{self, PbrParams, Surface, TextureContext};

/// A surface that a ray of a path hit.
pub(super) struct PathVertex<'a> {
    pub surface: Surface,
    /// The radiance that it emits to the viewer.
    pub emission: Vec3,
    /// True if what it emits is a picture, which lights nothing.
    pub is_unlit: bool,
    /// The probability that light goes straight on, as if there were nothing.
    pub uncovered: f64,
    scattering: Scattering<'a>,
    /// The dielectrics on the side of the incident light, and on the other.
    media: [InteriorList; 2],
}

/// The way in which a vertex scatters light.
enum Scattering<'a> {
    /// A physically based surface, in its local frame.
    Pbr { bsdf: BsdfOf<'a>, frame: DMat3, wo: DVec3 },
    /// Lambert's and Phong's model, with what is mirrored and transmitted.
    Phong { bsdf: PhongBsdf, sharp: Box<Scattered> },
}

/// The BSDF of a vertex: of its material, or its own.
enum BsdfOf<'a> {
    Material(&'a Bsdf),
    Own(Box<Bsdf>),
}

impl std::ops::Deref for BsdfOf<'_> {
    type Target = Bsdf;

    fn deref(&self) -> &Bsdf {
        match self {
            Self::Material(bsdf) => bsdf,
            Self::Own(bsdf) => bsdf,
        }
    }
}

/// The ray by which a path goes on from a vertex.
pub(super) struct SampledRay {
    pub ray: Ray,
    /// f |cos θ| divided by the density.
    pub weight: Vec3,
    /// The density per steradian; 0 for a direction that is the only one.
    pub pdf: f64,
    /// True if light went through the surface.
    pub is_transmission: bool,
    /// The dielectrics that the ray is in.
    pub interior: InteriorList,
}

impl<'a> PathVertex<'a> {
    /// Evaluates the surface that a ray hit. `surface` has the normal of its normal map.
    pub fn new(
        integrator: &'a Integrator<'_>,
        ray: &Ray,
        hit: &Hit,
        surface: Surface,
        context: &TextureContext,
        is_varied: bool,
        path: &PathState,
    ) -> Self {
        let scene = integrator.scene;
        let material = &scene.materials[surface.material.0 as usize];
        let cached = integrator.materials.get(surface.material);
        let dielectrics = &integrator.media.dielectrics;
        let media = dielectrics.interface(surface.id, surface.side, &path.interior);
        let viewer = -ray.direction.normalize();
        if !cached.is_pbr {
            let params = if is_varied {
                surface::shading_params(scene, material, context)
            } else {
                cached.params
            };
            let reflectance = scattered_reflectance(&params);
            let bsdf = PhongBsdf::new(reflectance, turned(surface.normal, viewer), viewer);
            let specular = SpecularHit { ray: 0, surface, params };
            let sharp = Box::new(scatter_light(integrator, &specular, &media, -viewer));
            return Self {
                surface,
                emission: params.emission,
                is_unlit: material.unlit,
                uncovered: 0.0,
                scattering: Scattering::Phong { bsdf, sharp },
                media: [media.incident, media.transmitted],
            };
        }
        let own = |params: &PbrParams, outside: f32| {
            BsdfOf::Own(Box::new(Bsdf::new(&params.factors, outside)))
        };
        let cached = integrator.materials.pbr(surface.material).filter(|_| !is_varied);
        let varied;
        let params = match cached {
            Some(cached) => &cached.params,
            None => {
                varied = surface::pbr_params(scene, material, context);
                &varied
            }
        };
        // The local frame, with z on the outside of a volume, and the index of refraction there.
        let is_inside = surface.side == Side::Back && !params.factors.is_thin;
        let normal = turned(surface.normal, viewer);
        let normal = if is_inside { -normal } else { normal };
        let frame = local_frame(integrator, hit, &surface, normal, &params.factors);
        let wo = facing(frame.transpose() * viewer, is_inside);
        let outside = if is_inside { &media.transmitted } else { &media.incident };
        let outside = dielectrics.medium(outside).ior() as f32;
        let bsdf = match cached {
            Some(cached) if outside == 1.0 => BsdfOf::Material(&cached.bsdf),
            _ => own(params, outside),
        };
        Self {
            surface,
            emission: params.emission,
            is_unlit: material.unlit,
            uncovered: f64::from(1.0 - params.alpha),
            scattering: Scattering::Pbr { bsdf, frame, wo },
            media: [media.incident, media.transmitted],
        }
    }

    /// Returns f |cos θ| for light from a direction of length 1, without sharp mirrors and clear glass, and the
    /// density with which it is sampled, per steradian.
    pub fn evaluate(&self, light: DVec3) -> (Vec3, f64) {
        let is_above = self.is_above(light);
        let (value, pdf) = match &self.scattering {
            Scattering::Pbr { bsdf, frame, wo } => {
                let wi = frame.transpose() * light;
                // The shading normal and the surface itself must agree on the side.
                if (wi.z * wo.z > 0.0) != is_above {
                    return (Vec3::ZERO, 0.0);
                }
                (bsdf.evaluate(*wo, wi), bsdf.pdf(*wo, wi))
            }
            Scattering::Phong { bsdf, sharp } if is_above => {
                (bsdf.evaluate(light), bsdf.pdf(light) * Shares::new(bsdf, sharp).scattered)
            }
            Scattering::Phong { .. } => (Vec3::ZERO, 0.0),
        };
        let covered = 1.0 - self.uncovered;
        (value * covered as f32, pdf * covered)
    }

    /// Samples a direction: `choice` chooses the lobe, and `u` the direction in it. `None` where the path ends.
    pub fn sample(&self, ray: &Ray, hit: &Hit, choice: f64, u: [f64; 2]) -> Option<SampledRay> {
        let opposite = self.surface.side.opposite();
        // Straight on, through what is left uncovered.
        if choice < self.uncovered {
            return Some(SampledRay {
                ray: ray.continue_past(hit, opposite),
                weight: Vec3::ONE,
                pdf: 0.0,
                is_transmission: true,
                interior: self.media[1].clone(),
            });
        }
        let covered = 1.0 - self.uncovered;
        let choice = ((choice - self.uncovered) / covered).min(1.0 - f64::EPSILON);
        match &self.scattering {
            Scattering::Pbr { bsdf, frame, wo } => {
                let sample = bsdf.sample(*wo, choice, u)?;
                let wi = *frame * sample.wi;
                let goes_through = !self.is_above(wi);
                if goes_through != sample.is_transmission {
                    return None;
                }
                let weight = sample.value * (1.0 / sample.pdf) as f32;
                let pdf = if sample.is_delta { 0.0 } else { sample.pdf * covered };
                Some(self.departing(wi, weight, pdf))
            }
            Scattering::Phong { bsdf, sharp } => {
                let shares = Shares::new(bsdf, sharp);
                if choice < shares.scattered {
                    let choice = choice / shares.scattered;
                    let light = bsdf.sample(choice, u);
                    let pdf = bsdf.pdf(light) * shares.scattered;
                    if !self.is_above(light) || pdf <= 0.0 {
                        return None;
                    }
                    return Some(self.departing(
                        light,
                        bsdf.evaluate(light) * (1.0 / pdf) as f32,
                        pdf,
                    ));
                }
                if choice < shares.scattered + shares.reflected {
                    let weight = sharp.reflected_share / shares.reflected;
                    return Some(self.departing(sharp.reflected, weight.as_vec3(), 0.0));
                }
                let rest = 1.0 - shares.scattered - shares.reflected;
                let weight = (sharp.refracted_share / rest).as_vec3();
                if weight == Vec3::ZERO {
                    return None;
                }
                Some(match sharp.refracted {
                    Some(direction) => self.departing(direction, weight, 0.0),
                    None => SampledRay {
                        ray: ray.continue_past(hit, opposite),
                        weight,
                        pdf: 0.0,
                        is_transmission: true,
                        interior: self.media[1].clone(),
                    },
                })
            }
        }
    }

    /// True if a direction leads away on the viewer's side of the surface itself.
    pub fn is_above(&self, direction: DVec3) -> bool {
        self.surface.facing_normal().dot(direction) > 0.0
    }

    fn departing(&self, direction: DVec3, weight: Vec3, pdf: f64) -> SampledRay {
        let is_transmission = !self.is_above(direction);
        let side = if is_transmission { self.surface.side.opposite() } else { self.surface.side };
        let departure = Some(Departure { id: self.surface.id, side });
        SampledRay {
            ray: Ray { departure, ..Ray::new(self.surface.position, direction) },
            weight,
            pdf,
            is_transmission,
            interior: self.media[usize::from(is_transmission)].clone(),
        }
    }
}

/// The probabilities of the lobes of a surface of Lambert's and Phong's model; the rest is what is refracted.
struct Shares {
    scattered: f64,
    reflected: f64,
}

impl Shares {
    fn new(bsdf: &PhongBsdf, sharp: &Scattered) -> Self {
        let scattered = f64::from(bsdf.strength());
        let [reflected, refracted] =
            [sharp.reflected_share, sharp.refracted_share].map(DVec3::max_element);
        let sum = scattered + reflected + refracted;
        if sum > 0.0 {
            Self { scattered: scattered / sum, reflected: reflected / sum }
        } else {
            Self { scattered: 0.0, reflected: 0.0 }
        }
    }
}

/// Returns a normal, turned to the viewer's side.
fn turned(normal: DVec3, viewer: DVec3) -> DVec3 {
    if normal.dot(viewer) < 0.0 { -normal } else { normal }
}
