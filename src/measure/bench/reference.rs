//! The picture that every other is held against.

use std::time::Duration;

use super::mode::Mode;
use crate::error::Result;
use crate::film::{Film, View};
use crate::intersect::Intersector;
use crate::measure::flip::{Flip, Seen};
use crate::measure::{Comparison, Picture, compare};
use crate::render::{Renderer, Traced};
use crate::scene::{Scene, Transfer};
use crate::write::{Settings, png_bytes};

/// The picture that every other is held against, and what its rays hit.
pub struct Reference {
    radiance: Picture,
    seen: Seen,
    /// The bytes of its PNG.
    pub bytes: Vec<u8>,
    ids: Film,
    /// Time to build its intersector.
    pub build: Duration,
    /// Time to render it.
    pub render: Duration,
}

/// How far a picture is from the reference.
pub struct Distance {
    /// Of the radiance.
    pub radiance: Comparison,
    /// Of the PNGs.
    pub flip: Flip,
    /// The bytes of its PNG.
    pub bytes: Vec<u8>,
}

impl Reference {
    /// Renders it.
    pub fn new(
        scene: &Scene,
        mode: Mode,
        camera: usize,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self> {
        let start = std::time::Instant::now();
        let intersector = mode.setup.build(scene)?;
        let build = start.elapsed();
        let of_mode = Scene { film: mode.samples.film(&scene.film), ..scene.clone() };
        let renderer = Renderer::new(&of_mode).camera(camera).on_progress(progress);
        let Traced { film, duration: render, .. } = renderer.render_with(&*intersector);
        let ids = ids(scene, camera, &*intersector);
        let (shown, bytes) = shown(&film, scene);
        let seen = seen(&shown);
        Ok(Self { radiance: radiance(&film), seen, bytes, ids, build, render })
    }

    /// How far a picture of the same scene and size is from this one.
    ///
    /// # Errors
    /// When the size is another one.
    pub fn distance(&self, film: &Film, scene: &Scene) -> Result<Distance> {
        let (shown, bytes) = shown(film, scene);
        let radiance = compare(&self.radiance, &radiance(film), 0.0)?;
        Ok(Distance { radiance, flip: self.seen.flip(&seen(&shown)), bytes })
    }

    /// In how many pixels the ray through the centre hits something else, or not what is there.
    pub fn wrong_hits(&self, scene: &Scene, camera: usize, by: &dyn Intersector) -> u64 {
        let ids = ids(scene, camera, by);
        ids.pixels.iter().zip(&self.ids.pixels).filter(|(a, b)| a != b).count() as u64
    }
}

/// What one ray of each pixel hits.
fn ids(scene: &Scene, camera: usize, intersector: &dyn Intersector) -> Film {
    Renderer::new(scene).camera(camera).view(View::Id).render_with(intersector).film
}

/// The values of an EXR.
fn radiance(film: &Film) -> Picture {
    let channels = film.view.channels().iter().map(|c| c.to_string()).collect();
    Picture { size: film.size, channels, values: film.pixels.as_flattened().to_vec() }
}

/// The values of a PNG, and its bytes.
fn shown(film: &Film, scene: &Scene) -> (Picture, Vec<u8>) {
    let bytes = png_bytes(film, &Settings::from_film(&scene.film));
    let values = bytes.iter().map(|&b| f32::from(b) / 255.0).collect();
    (Picture { values, ..radiance(film) }, bytes)
}

fn seen(shown: &Picture) -> Seen {
    Seen::of(shown, Transfer::Srgb).expect("a film has the channels R, G and B")
}
