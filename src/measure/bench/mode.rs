//! The ways to make a picture between which a user can choose.

use crate::error::Result;
use crate::intersect::{Backend, BuildQuality, Intersector, IntersectorBuilder, Precision};
use crate::scene::{AdaptiveSampling, FilmSettings, Scene};

/// What has to be built before the first ray: one serves pictures of any number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Who finds the hits.
    pub backend: Backend,
    /// How far the hits can be trusted.
    pub precision: Precision,
    /// How good Embree's trees are; nothing where there is no Embree.
    pub quality: Option<BuildQuality>,
}

/// One way to make a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// What is built.
    pub setup: Setup,
    /// Samples per pixel.
    pub samples: Samples,
}

/// How many samples a pixel has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// As many as any other.
    Regular(u32),
    /// From some to others, with the usual threshold; see [`AdaptiveSampling`].
    Adaptive(u32, u32),
}

impl Setup {
    /// Every setup of this build, Embree's before the pure-Rust ones, and its better trees before
    /// the worse.
    pub fn all() -> Vec<Self> {
        let backends = [Backend::default(), Backend::Rust];
        let backends = if backends[0] == backends[1] { &backends[1..] } else { &backends[..] };
        let mut all = Vec::new();
        for &backend in backends {
            let qualities: &[_] = match backend {
                Backend::Rust => &[None],
                #[cfg(feature = "embree")]
                Backend::Embree => &[Some(BuildQuality::Medium), Some(BuildQuality::Low)],
            };
            for precision in [Precision::Fast, Precision::Certified] {
                all.extend(qualities.iter().map(|&quality| Self { backend, precision, quality }));
            }
        }
        all
    }

    /// What it is called, such as `embree fast low`; what has no quality or the better one says
    /// nothing of it.
    pub fn name(&self) -> String {
        let quality = match self.quality {
            Some(BuildQuality::Low) => " low",
            _ => "",
        };
        format!("{} {}{quality}", self.backend.name(), self.precision.name())
    }

    /// Builds it for a checked scene, on the current rayon pool.
    ///
    /// # Errors
    /// When Embree cannot be started or runs out of memory.
    pub fn build<'s>(&self, scene: &'s Scene) -> Result<Box<dyn Intersector + 's>> {
        let builder =
            IntersectorBuilder::new(self.backend, self.precision, rayon::current_num_threads());
        let quality = self.quality.unwrap_or(BuildQuality::Medium);
        builder.with_quality(quality).build(scene)
    }
}

impl Mode {
    /// What it is called, such as `embree fast 4 spp`.
    pub fn name(&self) -> String {
        format!("{} {} spp", self.setup.name(), self.samples.name())
    }
}

impl Samples {
    /// What they are called, such as `4` or `1..25`.
    pub fn name(self) -> String {
        match self {
            Samples::Regular(spp) => spp.to_string(),
            Samples::Adaptive(min, max) => format!("{min}..{max}"),
        }
    }

    /// The film settings of pictures with so many.
    pub fn film(self, film: &FilmSettings) -> FilmSettings {
        let (spp, adaptive) = match self {
            Samples::Regular(spp) => (spp, None),
            Samples::Adaptive(min, max) => {
                (min, Some(AdaptiveSampling { max, threshold: AdaptiveSampling::THRESHOLD }))
            }
        };
        FilmSettings { spp, adaptive, ..film.clone() }
    }

    /// The most that a pixel has.
    pub fn most(self) -> u32 {
        match self {
            Samples::Regular(spp) => spp,
            Samples::Adaptive(_, max) => max,
        }
    }
}
