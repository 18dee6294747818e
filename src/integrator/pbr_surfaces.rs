//! The physically based surfaces of a wave: their BSDFs, and what of their light is looked up or traced.

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::sampling::sobol_point;
use crate::geometry::{Hit, LANES, Side};
use crate::integrator::Integrator;
use crate::integrator::material_cache::MaterialCache;
use crate::integrator::opaque_surfaces::{OpaqueMaterial, OpaqueSurfaces16};
use crate::integrator::wave::Wave;
use crate::scene::{Material, MaterialId, MetallicRoughness, ray_share};
use crate::shading::{self, Bsdf, LobeAlbedos};
use crate::surface::{self, PbrParams, Surface, TextureContext};

/// The least cosine between a shading normal and the direction to the viewer: an interpolated normal may be
/// turned away from it.
const MIN_COSINE: f64 = 1e-3;

/// The least number of samples of a pixel that show a blurred reflection by different microfacets.
const MIN_MICROFACETS: usize = 4;

/// A physically based surface that a ray of a wave hit.
pub(super) struct PbrHit {
    /// The lane of the ray in its block.
    pub lane: usize,
    /// The place of the BSDF.
    pub bsdf: BsdfPlace,
    /// The axes of the BSDF's local frame in world space: tangent, bitangent and normal.
    pub frame: DMat3,
    /// The direction to the viewer, in the local frame.
    pub wo: DVec3,
    /// The normal of the clearcoat, turned to the viewer, if it has one of its own.
    pub clearcoat_normal: Option<DVec3>,
    /// The share of what lies behind it that the surface covers.
    pub alpha: f32,
    /// True if it transmits light diffusely.
    pub is_translucent: bool,
    /// The share of the light of its blurred reflection that arrives.
    pub reflection_share: f32,
    /// The light that is looked up in the environment: diffuse lobes, and what of the others is blurred.
    pub blurred: BlurredLobes,
}

/// The place of the BSDF of a surface.
#[derive(Clone, Copy)]
pub(super) enum BsdfPlace {
    /// The BSDF of a material without textures.
    Material(MaterialId),
    /// The number of the BSDF among those that were made for the points of the wave.
    Point(usize),
}

/// The physically based surfaces of a wave.
#[derive(Default)]
pub(super) struct PbrHits {
    /// The surfaces, by block and lane.
    pub hits: Vec<PbrHit>,
    /// The BSDFs of those whose material varies.
    bsdfs: Vec<Bsdf>,
    /// The shares of light that are traced in place of what a surface's parameters reflect, of those surfaces that
    /// have any, by ray.
    pub traced: Vec<TracedLobes>,
    /// The opaque ones, which are not among the others, block by block.
    pub opaque: Vec<OpaqueSurfaces16>,
}

impl PbrHit {
    /// Returns f |cos θi| of its BSDF for light from a direction of world space, of length 1.
    pub fn evaluate(&self, bsdf: &Bsdf, light: DVec3) -> Vec3 {
        let wi = self.frame.transpose() * light;
        let value = bsdf.evaluate(self.wo, wi);
        let Some(normal) = self.clearcoat_normal else { return value };
        // The clearcoat, by its own normal.
        let (x, y) = normal.any_orthonormal_pair();
        let to_own = DMat3::from_cols(x, y, normal).transpose();
        let (wo, own_wi) = (to_own * (self.frame * self.wo), to_own * light);
        value - bsdf.evaluate_clearcoat(self.wo, wi) + bsdf.evaluate_clearcoat(wo, own_wi)
    }
}

impl PbrHits {
    /// Removes all.
    pub fn clear(&mut self) {
        self.hits.clear();
        self.bsdfs.clear();
        self.opaque.clear();
        self.traced.clear();
    }

    /// Adds a block of opaque surfaces of one material, in all lanes or in none yet, and returns its number.
    #[inline(never)]
    pub fn add_opaque(&mut self, material: &OpaqueMaterial, in_all_lanes: bool) -> usize {
        self.opaque.push(OpaqueSurfaces16::new(material, in_all_lanes));
        self.opaque.len() - 1
    }

    /// Returns the BSDF of a surface.
    #[inline]
    pub fn bsdf<'a>(&'a self, hit: &PbrHit, materials: &'a MaterialCache) -> &'a Bsdf {
        match hit.bsdf {
            BsdfPlace::Point(index) => &self.bsdfs[index],
            BsdfPlace::Material(id) => {
                &materials.pbr(id).expect("a physically based material").bsdf
            }
        }
    }
}

/// The lobes whose light is looked up in a filtered environment.
pub(super) struct BlurredLobes {
    /// The albedos, without the shares that reflected rays see.
    pub albedos: LobeAlbedos,
    /// The mirrored direction, and the roughness, of the base.
    pub mirrored: DVec3,
    pub roughness: f32,
    /// The mirrored direction, and the roughness, of the clearcoat.
    pub clearcoat_mirrored: DVec3,
    pub clearcoat_roughness: f32,
}

/// The shares of a physically based surface's light that secondary rays see.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracedLobes {
    /// The number of the ray in its wave.
    pub ray: u32,
    /// The share of the reflection.
    pub reflection: Vec3,
    /// The normal of the microfacet that mirrors and refracts, turned to the viewer.
    pub microfacet: DVec3,
    /// The roughness by which an environment in the reflection, and in what is transmitted, is blurred.
    pub roughness: f32,
    /// The share of the clearcoat's reflection.
    pub clearcoat: Vec3,
    /// The roughness of the clearcoat.
    pub clearcoat_roughness: f32,
    /// The normal of the clearcoat, turned to the viewer.
    pub clearcoat_normal: DVec3,
    /// The share of which Fresnel's law reflects a part, and transmits the rest.
    pub transmissive: f32,
    /// The colour of what is transmitted.
    pub transmission_color: Vec3,
}

impl TracedLobes {
    /// True if there is no such share.
    pub fn is_empty(&self) -> bool {
        self.reflection == Vec3::ZERO && self.clearcoat == Vec3::ZERO && self.transmissive == 0.0
    }
}

/// A point of a surface that a ray of a wave hit.
pub(super) struct SurfacePoint<'a> {
    /// The number of the ray in its wave.
    pub ray: usize,
    pub hit: &'a Hit,
    /// The surface, with the normal of its normal map.
    pub surface: &'a Surface,
    pub context: &'a TextureContext,
}

/// Adds a physically based surface, and returns the shares of its light that are traced. Its parameters are those of
/// the material where none are given that vary.
pub(super) fn evaluate(
    integrator: &Integrator<'_>,
    wave: &Wave,
    at: &SurfacePoint<'_>,
    varied: Option<&PbrParams>,
    pbr: &mut PbrHits,
) -> TracedLobes {
    let &SurfacePoint { ray, hit, surface, context } = at;
    let (scene, lane) = (integrator.scene, ray % LANES);
    let (_, incoming) = wave.rays.blocks()[ray / LANES].origin_and_direction(lane);
    let incoming = incoming.normalize();
    let material = &scene.materials[surface.material.0 as usize];
    let cached = integrator.materials.pbr(surface.material);
    let cached = if varied.is_some() { None } else { cached };
    let made;
    let PbrParams { factors: params, alpha, .. } = match (varied, cached) {
        (Some(varied), _) => varied,
        (None, Some(cached)) => &cached.params,
        (None, None) => {
            made = surface::pbr_params(scene, material, context);
            &made
        }
    };
    let alpha = *alpha;
    // The local frame, with z on the outside of a volume.
    let is_inside = surface.side == Side::Back && !params.is_thin;
    let normal = if is_inside { -surface.normal } else { surface.normal };
    let frame = local_frame(integrator, hit, surface, normal, params);
    let viewer = -incoming;
    let wo = facing(frame.transpose() * viewer, is_inside);
    // The shares of its light that are looked up, and those that are traced.
    let (place, mut albedos) = match cached {
        Some(cached) => (BsdfPlace::Material(surface.material), cached.lobe_albedos(wo)),
        None => {
            pbr.bsdfs.push(Bsdf::new(params, 1.0));
            let index = pbr.bsdfs.len() - 1;
            (BsdfPlace::Point(index), pbr.bsdfs[index].lobe_albedos(wo))
        }
    };
    let clearcoat_normal = clearcoat_normal(integrator, material, hit, surface, context);
    let blurred_by = |normal: DVec3| shading::reflect(incoming, normal);
    let mut traced = TracedLobes {
        ray: ray as u32,
        reflection: take(&mut albedos.reflection, ray_share(params.roughness)) * alpha,
        microfacet: surface.normal,
        roughness: params.roughness,
        clearcoat: take(&mut albedos.clearcoat, ray_share(params.clearcoat_roughness)) * alpha,
        clearcoat_roughness: params.clearcoat_roughness,
        clearcoat_normal,
        transmissive: albedos.transmissive * alpha,
        transmission_color: albedos.transmission_color,
    };
    let blurred = BlurredLobes {
        albedos,
        mirrored: dominant_direction(
            surface.normal,
            blurred_by(bent_normal(surface.normal, viewer, &frame, params)),
            params.roughness,
        ),
        roughness: params.roughness,
        clearcoat_mirrored: blurred_by(clearcoat_normal),
        clearcoat_roughness: params.clearcoat_roughness,
    };
    let is_translucent = albedos.diffuse_transmission != Vec3::ZERO;
    let reflection_share = 1.0;
    let bsdf = place;
    let clearcoat_normal = Some(clearcoat_normal).filter(|&own| own != surface.normal);
    let hit = PbrHit {
        lane,
        bsdf,
        frame,
        wo,
        clearcoat_normal,
        alpha,
        is_translucent,
        reflection_share,
        blurred,
    };
    if !traced.is_empty() {
        let bsdf = pbr.bsdf(&hit, &integrator.materials);
        let (normal, rest) = microfacet(integrator, wave.sample, bsdf, &frame, wo, surface.normal);
        (traced.microfacet, traced.roughness) = (normal, params.roughness * rest);
    }
    pbr.hits.push(hit);
    traced
}

/// Returns the normal of the microfacet that stands for those of a surface in this sample of the pixels, and the
/// share of the roughness by which what it mirrors is still to be blurred.
///
/// The samples of a pixel have different microfacets, spread like those that the viewer sees: together they show a
/// blurred reflection, without noise, since they are the same for all pixels. The first mirrors by the surface's own
/// normal, and so do all where there are few. Each stands for a part of the microfacets, with α less by the root of
/// their number.
fn microfacet(
    integrator: &Integrator<'_>,
    sample: usize,
    bsdf: &Bsdf,
    frame: &DMat3,
    wo: DVec3,
    normal: DVec3,
) -> (DVec3, f32) {
    let samples = integrator.samples.offsets.len();
    if samples < MIN_MICROFACETS {
        return (normal, 1.0);
    }
    let rest = (samples as f32).powf(-0.25);
    if sample == 0 {
        return (normal, rest);
    }
    let h = *frame * bsdf.sample_microfacet(wo, sobol_point(sample as u32, samples as u32));
    (h, rest)
}

/// Returns the direction about which a surface of a roughness reflects: the rougher it is, the nearer to the normal
/// (Lagarde and de Rousiers, *Moving Frostbite to Physically Based Rendering*, 2014, listing 23).
fn dominant_direction(normal: DVec3, mirrored: DVec3, roughness: f32) -> DVec3 {
    let alpha = f64::from(roughness * roughness);
    let smoothness = (1.0 - alpha).clamp(0.0, 1.0);
    normal.lerp(mirrored, smoothness * (smoothness.sqrt() + alpha)).normalize_or(normal)
}

/// Takes a share away from a colour, and returns it.
fn take(color: &mut Vec3, share: f32) -> Vec3 {
    let taken = *color * share;
    *color -= taken;
    taken
}

/// Returns a direction to the viewer that is on its side of the surface by at least the least cosine.
pub(super) fn facing(wo: DVec3, is_inside: bool) -> DVec3 {
    let height = if is_inside { -wo.z } else { wo.z };
    if height >= MIN_COSINE {
        return wo;
    }
    let across = wo.truncate().normalize_or(glam::DVec2::X);
    let scale = (1.0 - MIN_COSINE * MIN_COSINE).sqrt();
    let height = if is_inside { -MIN_COSINE } else { MIN_COSINE };
    (across * scale).extend(height)
}

/// Returns tangent, bitangent and normal of the local frame.
pub(super) fn local_frame(
    integrator: &Integrator<'_>,
    hit: &Hit,
    surface: &Surface,
    normal: DVec3,
    params: &MetallicRoughness,
) -> DMat3 {
    if params.anisotropy > 0.0 {
        let scene = integrator.scene;
        let material = &scene.materials[surface.material.0 as usize];
        let maps = material.metallic.as_deref();
        let map = maps.and_then(|maps| maps.anisotropy);
        let map = map.or(material.normal_map.map(|map| map.texture));
        let tangent = surface::tangent(scene, surface, hit, map);
        let across = tangent.and_then(|t| (t - normal * normal.dot(t)).try_normalize());
        if let Some(tangent) = across {
            return DMat3::from_cols(tangent, normal.cross(tangent), normal);
        }
    }
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    DMat3::from_cols(tangent, bitangent, normal)
}

/// Returns the normal at which a brushed surface mirrors the middle of what it shows: toward the plane across
/// the direction of less roughness (as Khronos' sample viewer has it, after McAuley, *Rendering the World of
/// Far Cry 4*, 2015).
fn bent_normal(normal: DVec3, viewer: DVec3, frame: &DMat3, params: &MetallicRoughness) -> DVec3 {
    if params.anisotropy <= 0.0 {
        return normal;
    }
    let (sin, cos) = f64::from(params.anisotropy_rotation).sin_cos();
    let across = frame.y_axis * cos - frame.x_axis * sin;
    let bent = across.cross(viewer).cross(across).normalize_or(normal);
    let rest = 1.0 - f64::from(params.anisotropy) * (1.0 - f64::from(params.roughness));
    bent.lerp(normal, rest.powi(4)).normalize_or(normal)
}

/// Returns the normal of the clearcoat, turned to the viewer.
fn clearcoat_normal(
    integrator: &Integrator<'_>,
    material: &Material,
    hit: &Hit,
    surface: &Surface,
    context: &TextureContext,
) -> DVec3 {
    match &material.clearcoat_normal_map {
        Some(map) => surface::perturbed_normal(integrator.scene, surface, hit, &context.point, map),
        None => surface.normal,
    }
}
