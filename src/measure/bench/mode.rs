//! The ways to make a picture between which a user can choose.

use crate::error::Result;
use crate::intersect::{Backend, Intersector, Precision};
use crate::scene::{FilmSettings, Scene};

/// What has to be built before the first ray: one serves pictures of any number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Who finds the hits.
    pub backend: Backend,
    /// How far the hits can be trusted.
    pub precision: Precision,
}

/// One way to make a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// What is built.
    pub setup: Setup,
    /// Samples per pixel.
    pub spp: u32,
}

impl Setup {
    /// Every setup of this build, Embree's before the pure-Rust ones.
    pub fn all() -> Vec<Self> {
        let backends = [Backend::default(), Backend::Rust];
        let backends = if backends[0] == backends[1] { &backends[1..] } else { &backends[..] };
        let of = |&backend| {
            [Precision::Fast, Precision::Certified].map(|precision| Self { backend, precision })
        };
        backends.iter().flat_map(of).collect()
    }

    /// What it is called, such as `embree fast`.
    pub fn name(&self) -> String {
        format!("{} {}", self.backend.name(), self.precision.name())
    }

    /// Builds it for a checked scene, on the current rayon pool.
    ///
    /// # Errors
    /// When Embree cannot be started or runs out of memory.
    pub fn build<'s>(&self, scene: &'s Scene) -> Result<Box<dyn Intersector + 's>> {
        self.backend.build(scene, self.precision, rayon::current_num_threads())
    }
}

impl Mode {
    /// What it is called, such as `embree fast 4 spp`.
    pub fn name(&self) -> String {
        format!("{} {} spp", self.setup.name(), self.spp)
    }

    /// The film settings of its pictures.
    pub fn film(&self, film: &FilmSettings) -> FilmSettings {
        FilmSettings { spp: self.spp, ..film.clone() }
    }

    /// The most samples that it takes of a pixel.
    pub fn samples(&self) -> u32 {
        self.spp
    }
}
