//! The Whitted integrator: the radiance along camera rays, by direct lighting, mirrors and glass.
//!
//! The loop over a tile is in `tile_loop`: camera rays, closest hits, surfaces, for each
//! light shadow rays and what they let through, secondary rays, samples, pixels. Each stage is one
//! file. All rays of a tile that are at the same stage form a wave, which is traced by one call and
//! shaded sixteen rays at a time.

mod adaptive_sampling;
mod alpha;
mod ambient_occlusion;
mod back_faces;
mod camera_rays;
mod counts;
mod debug_view;
mod direct_lighting;
mod emissive_lights;
mod environment_lighting;
mod light_sources;
mod material_cache;
mod nested_dielectrics;
mod null_interfaces;
mod opaque_surfaces;
mod path;
mod pbr_evaluation;
mod pbr_surfaces;
mod pixel_sums;
mod radiance;
#[cfg(test)]
mod reciprocity;
mod refinement;
mod sample_pattern;
mod secondary_rays;
mod shadow_rays;
mod simd;
mod surface_evaluation;
mod texture_lod;
mod tile_loop;
mod tiling;
mod transmissive_bounds;
mod transmissive_shadows;
mod wave;
mod wave_surfaces;

use rayon::prelude::*;

use crate::film::{Pixel, View};
use crate::intersect::Intersector;
use crate::scene::{
    Camera, Feature, FilmSettings, IntegratorKind, Material, RayGenerator, Scene, SceneFeatures,
};
use adaptive_sampling::ContrastRow;
pub use adaptive_sampling::PixelRecord;
use back_faces::BackFaces;
pub use counts::{Counts, FeatureCounts, NotFinite, RayCounts};
use light_sources::LightSources;
use material_cache::MaterialCache;
use nested_dielectrics::{InteriorList, NestedDielectrics};
use path::PathTracer;
pub use refinement::RefineStrip;
use sample_pattern::SamplePattern;
#[cfg(all(feature = "measure", any(feature = "embree", test)))]
pub use sample_pattern::sample_positions;
pub use sample_pattern::sample_steps;
#[cfg(feature = "cli")]
pub use secondary_rays::MAX_LAYERS;
use texture_lod::TextureLod;
pub use tile_loop::Scratch;
pub use tiling::Tiling;
use transmissive_bounds::TransmissiveBounds;

/// An integrator for the pictures of one camera.
pub struct Integrator<'a> {
    scene: &'a Scene,
    intersector: &'a dyn Intersector,
    camera: RayGenerator,
    view: View,
    /// True if the picture has alpha.
    has_alpha: bool,
    tiling: Tiling,
    /// The samples of a pixel.
    samples: SamplePattern,
    /// The least difference of colours that disagree, in an adaptive picture.
    contrast_threshold: Option<f32>,
    features: ShadingFeatures,
    materials: MaterialCache,
    texture_lod: TextureLod,
    media: TransparentMedia,
    back_faces: BackFaces,
    light_sources: LightSources<'a>,
    /// The path tracer, if the picture is made by it.
    path_tracer: Option<PathTracer<'a>>,
    /// The instruction sets of the processor, for which inner loops are compiled.
    arch: pulp::Arch,
}

/// The parts of shading that a scene needs.
struct ShadingFeatures {
    /// True if textures, checkers or vertex colours are looked up.
    textures: bool,
    /// True if vertex normals are interpolated.
    smooth_normals: bool,
    /// True if materials are physically based.
    pbr: bool,
    /// True if materials have highlights.
    highlights: bool,
    /// True if light fades out toward the terminator of smooth meshes.
    soft_terminator: bool,
    /// True if materials reflect as mirrors or transmit light.
    secondary_rays: bool,
    /// True if light may pass a surface: materials transmit it, or are not there for it from behind.
    transmission: bool,
}

/// The transparent parts of a scene.
struct TransparentMedia {
    dielectrics: NestedDielectrics,
    /// The interior list of camera rays, if they start at one point.
    camera_interior: Option<InteriorList>,
    /// True if rays may be absorbed on their way, or hit null interfaces.
    may_alter_rays: bool,
    /// True if camera rays may be absorbed on their way, or hit null interfaces.
    may_alter_camera_rays: bool,
    /// The bounding boxes of the transmissive objects.
    bounds: TransmissiveBounds,
    /// True if all of them are meshes that only leave light uncovered: then it does not matter in which
    /// order light crosses them.
    are_layers: bool,
}

impl TransparentMedia {
    fn new(scene: &Scene, intersector: &dyn Intersector, camera: &RayGenerator) -> Self {
        let dielectrics = NestedDielectrics::new(scene);
        let empty = InteriorList::default();
        let camera_interior = if dielectrics.is_empty() {
            Some(empty.clone())
        } else {
            camera.eye().map(|eye| dielectrics.interior_at(eye, scene, intersector))
        };
        let starts_outside = camera_interior.as_ref() == Some(&empty);
        // In empty space nothing hides a surface.
        let is_clear = |material: &Material| material.is_clear_in(1.0);
        Self {
            may_alter_rays: !starts_outside
                || dielectrics.may_absorb_or_hide()
                || null_interfaces::may_match_indices(scene),
            may_alter_camera_rays: !starts_outside || scene.materials_in_use().any(is_clear),
            dielectrics,
            camera_interior,
            bounds: TransmissiveBounds::new(scene),
            are_layers: are_layers(scene),
        }
    }
}

/// True if everything in a scene that lets light through is a mesh that neither reflects nor refracts it
/// there.
fn are_layers(scene: &Scene) -> bool {
    let is_layer =
        |material: &Material| material.may_transmit() && material.thin && material.ior == 1.0;
    let in_shapes = scene.spheres.iter().map(|sphere| sphere.material);
    let mut in_shapes = in_shapes.chain(scene.planes.iter().map(|plane| plane.material));
    scene.materials_in_use().filter(|material| !material.blocks_light()).all(is_layer)
        && in_shapes.all(|id| scene.materials[id.0 as usize].blocks_light())
}

impl<'a> Integrator<'a> {
    /// Builds an integrator for the rays of `camera`, with the scene's film settings.
    pub fn new(
        scene: &'a Scene,
        intersector: &'a dyn Intersector,
        camera: &Camera,
        view: View,
        tiling: Tiling,
    ) -> Self {
        // Debug views are not averages: one sample.
        let film = match view {
            View::Beauty => scene.film.clone(),
            _ => FilmSettings { spp: 1, adaptive: None, ..scene.film.clone() },
        };
        let camera = camera.ray_generator(scene.film.size);
        // Made now, on all threads: a thread that waits for another's result could not be shared.
        let is_path = film.integrator == IntegratorKind::Path && view == View::Beauty;
        let path_tracer = is_path.then(|| PathTracer::new(scene, film.seed));
        if !is_path {
            environment_lighting::prepare(scene);
        }
        let features = SceneFeatures::from_scene(scene);
        let has = |feature| features.uses(feature);
        let textures = [Feature::Uv, Feature::Checkers, Feature::VertexColors, Feature::NormalMaps];
        let samples = SamplePattern::new(&film);
        Self {
            scene,
            intersector,
            view,
            has_alpha: scene.film.transparent && view == View::Beauty,
            tiling,
            light_sources: if is_path {
                LightSources::none()
            } else {
                LightSources::new(scene, samples.offsets.len())
            },
            path_tracer,
            samples,
            contrast_threshold: film.adaptive.map(|adaptive| adaptive.threshold),
            features: ShadingFeatures {
                textures: textures.into_iter().any(has),
                smooth_normals: has(Feature::SmoothNormals),
                pbr: scene.materials_in_use().any(Material::is_pbr),
                highlights: has(Feature::Highlights),
                soft_terminator: scene.film.soft_terminator && has(Feature::SmoothNormals),
                secondary_rays: has(Feature::Reflection) || has(Feature::Refraction),
                transmission: !scene.materials_in_use().all(Material::blocks_light),
            },
            materials: MaterialCache::new(scene),
            texture_lod: TextureLod::new(has(Feature::Mipmaps), &camera, &film),
            media: TransparentMedia::new(scene, intersector, &camera),
            back_faces: BackFaces::new(scene),
            camera,
            arch: pulp::Arch::new(),
        }
    }

    /// True if the picture has alpha: a transparent background, and the view is the beauty.
    pub fn has_alpha(&self) -> bool {
        self.has_alpha
    }

    /// True if rays find how much of the light from all around arrives.
    fn has_ambient_occlusion(&self) -> bool {
        self.scene.film.ambient_occlusion > 0
    }

    /// True if some pixels may get more samples than others.
    pub fn is_adaptive(&self) -> bool {
        self.samples.first + 1 < self.samples.steps.len()
    }

    /// Returns true for each pixel that needs more samples after the first pass; `pixels` are the
    /// means of the first samples of all pixels of the picture, and `records` their records.
    pub fn pixels_to_refine(&self, pixels: &[Pixel], records: &[PixelRecord]) -> Vec<bool> {
        let width = self.scene.film.size[0] as usize;
        let height = pixels.len() / width;
        let threshold = self.contrast_threshold.unwrap_or(0.0);
        let rows = self.tiling.rows;
        let mut refined = vec![false; pixels.len()];
        let strips = refined.par_chunks_mut(width * rows).enumerate();
        strips.for_each(|(strip, refined)| {
            let [mut row, mut below] = [ContrastRow::default(), ContrastRow::default()];
            let set = |row: &mut ContrastRow, y: usize| {
                let range = y * width..(y + 1) * width;
                row.set(&pixels[range.clone()], &records[range]);
            };
            // Each row is compared with the one below, from the row above the strip on.
            let first = strip * rows;
            let end = (first + refined.len() / width).min(height);
            set(&mut row, first.saturating_sub(1));
            for y in first.saturating_sub(1)..end {
                let is_last = y + 1 == height;
                if !is_last {
                    set(&mut below, y + 1);
                }
                let next = (!is_last).then_some(&mut below);
                row.mark_contrast(self.arch, next, threshold);
                if y >= first {
                    let written = &mut refined[(y - first) * width..][..width];
                    written.copy_from_slice(&row.disagrees);
                }
                std::mem::swap(&mut row, &mut below);
            }
        });
        refined
    }
}
