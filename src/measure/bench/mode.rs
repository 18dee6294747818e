//! The modes that a benchmark compares: an intersector's setup and a number of samples per pixel.

use crate::error::Result;
use crate::intersect::{Backend, BuildQuality, Intersector, IntersectorBuilder, Precision};
use crate::scene::{AdaptiveSampling, FilmSettings, Scene};

/// The setup of an intersector, which is built once for pictures of any number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// The ray tracing backend.
    pub backend: Backend,
    /// The precision of the hits.
    pub precision: Precision,
    /// The build quality of Embree's BVH; none for the pure-Rust BVH.
    pub quality: Option<BuildQuality>,
}

/// A way to render a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// The intersector.
    pub setup: Setup,
    /// The samples per pixel.
    pub samples: Samples,
}

/// A number of samples per pixel; in order, regular ones come before adaptive ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Samples {
    /// The same number for every pixel.
    Regular(u32),
    /// Adaptive sampling with the default threshold; see [`AdaptiveSampling`].
    Adaptive {
        /// The fewest samples of a pixel.
        min: u32,
        /// The most samples of a pixel.
        max: u32,
    },
}

impl Setup {
    /// Returns every setup that can be used here: Embree's before the pure-Rust ones, and better build
    /// quality before lower.
    pub fn all() -> Vec<Self> {
        let mut setups = Vec::new();
        for &backend in Backend::available() {
            let qualities = match backend {
                #[cfg(feature = "embree")]
                Backend::Embree => &[Some(BuildQuality::Medium), Some(BuildQuality::Low)][..],
                Backend::Rust => &[None][..],
            };
            for precision in [Precision::Fast, Precision::Certified] {
                let setup = |&quality: &_| Self { backend, precision, quality };
                setups.extend(qualities.iter().map(setup));
            }
        }
        setups
    }

    /// Returns the name, such as `embree fast low`; medium quality is not mentioned.
    pub fn name(&self) -> String {
        let quality = if self.quality == Some(BuildQuality::Low) { " low" } else { "" };
        format!("{} {}{quality}", self.backend.name(), self.precision.name())
    }

    /// Builds the intersector of a checked scene, on the current rayon pool.
    ///
    /// # Errors
    /// When Embree cannot be started or runs out of memory.
    pub fn build<'s>(&self, scene: &'s Scene) -> Result<Box<dyn Intersector + 's>> {
        let threads = rayon::current_num_threads();
        let quality = self.quality.unwrap_or(BuildQuality::Medium);
        let builder = IntersectorBuilder::new(self.backend, self.precision, threads);
        builder.with_quality(quality).build(scene)
    }
}

impl Mode {
    /// Returns the name, such as `embree fast 4 spp`.
    pub fn name(&self) -> String {
        format!("{} {} spp", self.setup.name(), self.samples.name())
    }
}

impl Samples {
    /// Returns the name, such as `4` or `1..25`.
    pub fn name(self) -> String {
        match self {
            Samples::Regular(spp) => spp.to_string(),
            Samples::Adaptive { min, max } => format!("{min}..{max}"),
        }
    }

    /// Returns film settings with this number of samples and an opaque background: alpha has no FLIP.
    pub fn film(self, film: &FilmSettings) -> FilmSettings {
        let (spp, adaptive) = match self {
            Samples::Regular(spp) => (spp, None),
            Samples::Adaptive { min, max } => {
                (min, Some(AdaptiveSampling { max, threshold: AdaptiveSampling::THRESHOLD }))
            }
        };
        FilmSettings { spp, adaptive, transparent: false, ..film.clone() }
    }

    /// Returns the most samples that a pixel can have.
    pub fn max_spp(self) -> u32 {
        match self {
            Samples::Regular(spp) => spp,
            Samples::Adaptive { max, .. } => max,
        }
    }
}
