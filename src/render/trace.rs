//! The tracing of a picture with an intersector that is built: strips of rows, shared by all threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::options::RenderOptions;
use super::stopwatch::{Elapsed, Stopwatch};
use crate::film::Film;
use crate::integrator::{Counts, Integrator, PixelRecord, RefineStrip, Scratch};
use crate::intersect::Intersector;
use crate::scene::Scene;

/// A callback that is told the share of the work that is done, in (0, 1]; any thread may call it.
pub type Progress<'s> = dyn Fn(f32) + Sync + 's;

/// A film that was traced, with its counts and the time from the first ray to the last pixel.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Traced {
    /// The picture.
    pub film: Film,
    /// Rays and other counts.
    pub counts: Counts,
    /// The time from the first ray to the last pixel.
    pub elapsed: Elapsed,
}

/// Traces a checked scene with an intersector that is built, on the current rayon pool.
///
/// # Panics
/// When the scene has no such camera.
pub fn trace(
    scene: &Scene,
    options: &RenderOptions,
    intersector: &dyn Intersector,
    progress: &Progress<'_>,
) -> Traced {
    // An empty film, and the integrator that gives its pixels their radiance.
    let size = scene.film.size;
    let mut film = Film::new(size, options.view);
    let camera = &scene.cameras[options.camera];
    let RenderOptions { view, tiling, .. } = *options;
    let integrator = Integrator::new(scene, intersector, camera, view, tiling);
    if integrator.has_alpha() {
        film.alpha = Some(vec![0.0; film.pixels.len()]);
    }

    // Threads share strips of whole rows.
    let rows = tiling.rows;
    let strip = size[0] as usize * rows;
    let strips = film.pixels.len().div_ceil(strip);
    let passes = if integrator.is_adaptive() { 2 } else { 1 };
    let (counts, done) = (Mutex::new(Counts::default()), AtomicU64::new(0));
    let finish_strip = |of_strip: Counts| {
        // A poisoned lock still holds the counts; the panic that caused it is reported anyway.
        *counts.lock().unwrap_or_else(|e| e.into_inner()) += of_strip;
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f32 / (passes * strips) as f32);
    };

    // First pass: the samples that every pixel has, and a record of what they hit where more follow.
    let stopwatch = Stopwatch::start();
    let recorded = if passes == 2 { film.pixels.len() } else { 0 };
    let mut records = vec![PixelRecord::default(); recorded];
    let alpha = film.alpha.as_deref_mut().unwrap_or_default();
    let others = strips_of(alpha, strip, strips).into_par_iter();
    let others = others.zip(strips_of(&mut records, strip, strips));
    let first_pass = film.pixels.par_chunks_mut(strip).zip(others).enumerate();
    first_pass.for_each_init(Scratch::default, |scratch, (i, (pixels, (alpha, records)))| {
        finish_strip(integrator.render_strip(i * rows, pixels, alpha, records, scratch));
    });

    // Second pass: more samples for the pixels that disagree with themselves or their neighbours.
    if passes == 2 {
        let refined = integrator.pixels_to_refine(&film.pixels, &records);
        let pixels = film.pixels.par_chunks_mut(strip).zip(strips_of(alpha, strip, strips));
        let parts = pixels.zip(records.par_chunks(strip).zip(refined.par_chunks(strip)));
        let parts = parts.enumerate();
        parts.for_each_init(Scratch::default, |scratch, (i, parts)| {
            let ((pixels, alpha), (records, refined)) = parts;
            let strip = RefineStrip { first_row: i * rows, pixels, alpha, records, refined };
            finish_strip(integrator.refine_strip(strip, scratch));
        });
    }
    let counts = counts.into_inner().unwrap_or_else(|e| e.into_inner());
    Traced { film, counts, elapsed: stopwatch.elapsed() }
}

/// Returns the strips of values of all pixels, or as many empty ones where there are no values.
fn strips_of<T>(values: &mut [T], strip: usize, count: usize) -> Vec<&mut [T]> {
    let mut strips: Vec<_> = values.chunks_mut(strip).collect();
    strips.resize_with(count, Default::default);
    strips
}
