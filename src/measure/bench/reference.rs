//! The reference image of a benchmark, and the error of other images against it.

use std::time::{Duration, Instant};

use super::mode::Mode;
use crate::error::Result;
use crate::film::{Film, View};
use crate::intersect::Intersector;
use crate::measure::flip::{Flip, PerceivedImage};
use crate::measure::{Comparison, Picture, compare_pictures};
use crate::render::{Renderer, Traced};
use crate::scene::{Scene, Transfer};
use crate::write::{Settings, png_bytes};

/// The reference image, with the primitive that the ray through each pixel's centre hits.
pub struct Reference {
    /// The mode that it was rendered in.
    pub mode: Mode,
    radiance: Picture,
    perceived: PerceivedImage,
    /// The bytes of its PNG: red, green and blue of each pixel.
    pub bytes: Vec<u8>,
    ids: Film,
    /// The time to build the intersector.
    pub build: Duration,
    /// The time to render.
    pub render: Duration,
}

/// The error of an image against the reference.
pub struct ImageError {
    /// The difference of the radiance.
    pub radiance: Comparison,
    /// The perceived difference of the PNGs.
    pub flip: Flip,
    /// The bytes of the image's PNG.
    pub bytes: Vec<u8>,
}

impl Reference {
    /// Renders the reference of a checked scene.
    ///
    /// # Errors
    /// When the intersector cannot be built.
    pub fn render(
        scene: &Scene,
        mode: Mode,
        camera: usize,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self> {
        let start = Instant::now();
        let intersector = mode.setup.build(scene)?;
        let build = start.elapsed();
        let sampled = Scene { film: mode.samples.film(&scene.film), ..scene.clone() };
        let renderer = Renderer::new(&sampled).camera(camera).on_progress(progress);
        let Traced { film, elapsed, .. } = renderer.render_with(&*intersector);
        let ids = primitive_ids(scene, camera, &*intersector);
        let (perceived, bytes) = perceived(&film, scene);
        let render = elapsed.wall;
        Ok(Self { mode, radiance: radiance(&film), perceived, bytes, ids, build, render })
    }

    /// Returns the error of an image of the same scene and size.
    ///
    /// # Errors
    /// When the size is another one.
    pub fn error(&self, film: &Film, scene: &Scene) -> Result<ImageError> {
        let (perceived, bytes) = perceived(film, scene);
        let radiance = compare_pictures(&self.radiance, &radiance(film), 0.0)?;
        Ok(ImageError { radiance, flip: self.perceived.flip(&perceived), bytes })
    }

    /// Returns the number of pixels in which the ray through the centre hits another primitive than
    /// in the reference, or only one of the two hits anything.
    pub fn wrong_hits(&self, scene: &Scene, camera: usize, intersector: &dyn Intersector) -> u64 {
        let ids = primitive_ids(scene, camera, intersector);
        ids.pixels.iter().zip(&self.ids.pixels).filter(|(a, b)| a != b).count() as u64
    }
}

/// Renders the id of the primitive that one ray of each pixel hits.
fn primitive_ids(scene: &Scene, camera: usize, intersector: &dyn Intersector) -> Film {
    Renderer::new(scene).camera(camera).view(View::Id).render_with(intersector).film
}

/// Returns the values of a film's EXR.
fn radiance(film: &Film) -> Picture {
    let channels = film.view.channels().iter().map(|c| c.to_string()).collect();
    Picture { size: film.size, channels, values: film.pixels.as_flattened().to_vec() }
}

/// Returns a film's PNG as FLIP compares it, and its bytes.
fn perceived(film: &Film, scene: &Scene) -> (PerceivedImage, Vec<u8>) {
    let bytes = png_bytes(film, &Settings::from_film(&scene.film));
    let values = bytes.iter().map(|&b| f32::from(b) / 255.0).collect();
    let png = Picture { values, ..radiance(film) };
    let perceived = PerceivedImage::from_picture(&png, Transfer::Srgb);
    (perceived.expect("a film has the channels R, G and B"), bytes)
}
