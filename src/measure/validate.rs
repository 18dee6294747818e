//! Embree against the pure-Rust intersector: hit by hit and pixel by pixel.

use std::fmt;

use serde::Serialize;

use crate::error::Result;
use crate::film::Film;
use crate::scene::Scene;

/// Why two intersectors may rightly disagree about a ray in precision `fast`: Embree traverses
/// with f32 rays, which stay within a derived margin of the exact ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Causes {
    /// The ray passes the edge of a triangle within the margin.
    pub edge: u64,
    /// Two surfaces lie, along the ray, as close together as the margin, or a surface lies as
    /// close to the end of a shadow ray.
    pub tie: u64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Validation {
    /// Primary and shadow rays traced by both.
    pub rays_compared: u64,
    /// Of these, rays from the eye.
    pub primary_rays: u64,
    /// Rays about which the two disagree: which primitive, or whether any.
    pub primitive_mismatches: u64,
    /// Those of them that f32 explains, by cause.
    pub explained: Causes,
    /// Those that nothing explains.
    pub unexplained_mismatches: u64,
    /// Largest difference of t, in units in the last place, where both hit the same primitive.
    pub max_t_error_ulp: u64,
    /// Pixels compared.
    pub pixels: u64,
    /// Pixels of which a channel of the PNG differs by more than 1 of 255.
    pub pixels_differing: u64,
    /// Largest difference of a channel of the PNG, of 255.
    pub max_channel_difference: u8,
    /// No unexplained mismatch, at most 1e-4 of the rays explained ones, at most 1e-5 of the
    /// pixels differing.
    pub passed: bool,
    /// Where they differ: red an unexplained mismatch, yellow an explained one, blue a pixel that
    /// differs; and grey where they agree that something is hit.
    #[serde(skip)]
    pub heatmap: Film,
}

impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {} rays compared, {} mismatches ({} edge, {} tie, {} unexplained), \
             t within {} ulp; {} of {} pixels differ, by at most {} of 255",
            if self.passed { "passed" } else { "FAILED" },
            self.rays_compared,
            self.primitive_mismatches,
            self.explained.edge,
            self.explained.tie,
            self.unexplained_mismatches,
            self.max_t_error_ulp,
            self.pixels_differing,
            self.pixels,
            self.max_channel_difference
        )
    }
}

/// Renders a scene with both intersectors, and compares every primary hit, every shadow ray and
/// every pixel.
///
/// # Errors
/// When the scene is not valid, has no such camera, or this build has no Embree.
#[cfg(not(feature = "embree"))]
pub fn validate(_: &Scene, _: usize, _: usize) -> Result<Validation> {
    Err(crate::error::Error::input("this envers was built without Embree: nothing to compare")
        .help("build with the feature `embree` (run scripts/setup first)"))
}

/// Renders a scene with both intersectors, and compares every primary hit, every shadow ray and
/// every pixel. `threads` 0 means all there are.
///
/// # Errors
/// When the scene is not valid, has no such camera, or Embree cannot be started.
#[cfg(feature = "embree")]
pub fn validate(scene: &Scene, camera: usize, threads: usize) -> Result<Validation> {
    use crate::intersect::{Bvh, Embree, Precision};
    use crate::render;

    scene.check()?;
    render::check_camera(scene, camera)?;
    render::in_pool(threads, || {
        let embree = Embree::build(scene, Precision::Fast, rayon::current_num_threads())?;
        let judge = Bvh::build(scene, Precision::Fast);
        Ok(compare::Comparer { scene, embree: &embree, judge: &judge, camera }.run())
    })
}

#[cfg(feature = "embree")]
mod compare {
    use rayon::prelude::*;

    use super::{Causes, Validation};
    use crate::film::{Film, View};
    use crate::geometry::{Hit, Ray};
    use crate::integrator::sample_positions;
    use crate::intersect::{Backend, Bvh, Coherence, Embree, Intersector};
    use crate::measure::dispute::{Cause, Disputes};
    use crate::render::{self, Options};
    use crate::scene::{LightKind, RayMaker, Scene};
    use crate::surface::Surface;
    use crate::write::{Settings, png_bytes};

    pub struct Comparer<'a> {
        pub scene: &'a Scene,
        pub embree: &'a Embree<'a>,
        pub judge: &'a Bvh<'a>,
        pub camera: usize,
    }

    /// What was found in one row.
    #[derive(Default)]
    struct Tally {
        primary: u64,
        shadow: u64,
        explained: Causes,
        unexplained: u64,
        max_ulp: u64,
    }

    const RED: [f32; 3] = [1.0, 0.0, 0.0];
    const YELLOW: [f32; 3] = [1.0, 1.0, 0.0];
    const BLUE: [f32; 3] = [0.2, 0.4, 1.0];
    const GREY: [f32; 3] = [0.15; 3];

    impl Comparer<'_> {
        pub fn run(&self) -> Validation {
            let size = self.scene.film.size;
            let rays = self.scene.cameras[self.camera].rays(size);
            let mut heatmap = Film::new(size, View::Beauty);
            let width = size[0] as usize;
            let tallies: Vec<Tally> = heatmap
                .pixels
                .par_chunks_mut(width)
                .enumerate()
                .map(|(y, row)| self.row(&rays, y, row))
                .collect();
            let mut sum = Tally::default();
            for t in tallies {
                sum.primary += t.primary;
                sum.shadow += t.shadow;
                sum.explained.edge += t.explained.edge;
                sum.explained.tie += t.explained.tie;
                sum.unexplained += t.unexplained;
                sum.max_ulp = sum.max_ulp.max(t.max_ulp);
            }
            let (pixels_differing, max_channel_difference) = self.pictures(&mut heatmap);
            let explained = sum.explained.edge + sum.explained.tie;
            let rays_compared = sum.primary + sum.shadow;
            let pixels = heatmap.pixels.len() as u64;
            Validation {
                rays_compared,
                primary_rays: sum.primary,
                primitive_mismatches: explained + sum.unexplained,
                explained: sum.explained,
                unexplained_mismatches: sum.unexplained,
                max_t_error_ulp: sum.max_ulp,
                pixels,
                pixels_differing,
                max_channel_difference,
                passed: sum.unexplained == 0
                    && explained as f64 <= 1e-4 * rays_compared as f64
                    && pixels_differing as f64 <= 1e-5 * pixels as f64,
                heatmap,
            }
        }

        /// Traces a row with both; marks in `row` what they make of it.
        fn row(&self, maker: &RayMaker, y: usize, row: &mut [[f32; 3]]) -> Tally {
            let mut tally = Tally::default();
            for [dx, dy] in sample_positions(&self.scene.film) {
                let rays: Vec<Ray> =
                    (0..row.len()).map(|x| maker.through(x as f64 + dx, y as f64 + dy)).collect();
                let (found, truth) = (closest(self.embree, &rays), closest(self.judge, &rays));
                tally.primary += rays.len() as u64;
                for (x, ray) in rays.iter().enumerate() {
                    if truth[x].is_some() && row[x] == [0.0; 3] {
                        row[x] = GREY;
                    }
                    match (found[x], truth[x]) {
                        (None, None) => {}
                        (Some(a), Some(b)) if a.id == b.id => {
                            tally.max_ulp =
                                tally.max_ulp.max(a.t.to_bits().abs_diff(b.t.to_bits()));
                        }
                        (a, b) => {
                            let cause = self.disputes().primary(ray, a.as_ref(), b.as_ref());
                            tally.count(cause, &mut row[x]);
                        }
                    }
                }
                self.shadows(&rays, &truth, row, &mut tally);
            }
            tally
        }

        /// Compares the shadow rays from the judge's hits to each light.
        fn shadows(
            &self,
            rays: &[Ray],
            hits: &[Option<Hit>],
            row: &mut [[f32; 3]],
            tally: &mut Tally,
        ) {
            let surfaces: Vec<(usize, Surface)> = (0..)
                .zip(rays.iter().zip(hits))
                .filter_map(|(x, (ray, hit))| {
                    Some((x, Surface::new(self.scene, ray, hit.as_ref()?)))
                })
                .collect();
            let casting = |l: &&crate::scene::Light| l.casts_shadow && l.kind != LightKind::Ambient;
            for light in self.scene.lights.iter().filter(casting) {
                let (columns, rays): (Vec<usize>, Vec<Ray>) = surfaces
                    .iter()
                    .filter_map(|(x, s)| Some((*x, s.shadow_ray(&light.arrival(s.position)?))))
                    .unzip();
                let (found, truth) = (occluded(self.embree, &rays), occluded(self.judge, &rays));
                tally.shadow += rays.len() as u64;
                for i in (0..rays.len()).filter(|&i| found[i] != truth[i]) {
                    let cause = self.disputes().shadow(&rays[i], truth[i]);
                    tally.count(cause, &mut row[columns[i]]);
                }
            }
        }

        fn disputes(&self) -> Disputes<'_> {
            Disputes { scene: self.scene, margin: self.embree.margin() }
        }

        /// Renders the picture twice and compares the PNGs; says how many pixels differ by more
        /// than 1 of 255, and the largest difference of a channel.
        fn pictures(&self, heatmap: &mut Film) -> (u64, u8) {
            let options = Options { camera: self.camera, backend: Backend::Rust, ..<_>::default() };
            let settings = Settings { transfer: self.scene.film.transfer, ..Settings::default() };
            let picture = |intersector: &dyn Intersector| {
                let (film, ..) =
                    render::with_intersector(self.scene, &options, intersector, &|_| {});
                png_bytes(&film, &settings)
            };
            let (a, b) = (picture(self.embree), picture(self.judge));
            let (mut differing, mut max) = (0, 0);
            for ((p, q), mark) in a.chunks(3).zip(b.chunks(3)).zip(&mut heatmap.pixels) {
                let largest = p.iter().zip(q).map(|(x, y)| x.abs_diff(*y)).max().unwrap_or(0);
                max = max.max(largest);
                if largest > 1 {
                    differing += 1;
                    if *mark != RED && *mark != YELLOW {
                        *mark = BLUE;
                    }
                }
            }
            (differing, max)
        }
    }

    impl Tally {
        fn count(&mut self, cause: Option<Cause>, mark: &mut [f32; 3]) {
            match cause {
                Some(Cause::Edge) => self.explained.edge += 1,
                Some(Cause::Tie) => self.explained.tie += 1,
                None => self.unexplained += 1,
            }
            if cause.is_none() {
                *mark = RED;
            } else if *mark != RED {
                *mark = YELLOW;
            }
        }
    }

    fn closest(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<Option<Hit>> {
        let mut hits = vec![None; rays.len()];
        intersector.closest(rays, Coherence::Coherent, &mut hits);
        hits
    }

    fn occluded(intersector: &dyn Intersector, rays: &[Ray]) -> Vec<bool> {
        let mut blocked = vec![false; rays.len()];
        intersector.occluded(rays, Coherence::Coherent, &mut blocked);
        blocked
    }
}
