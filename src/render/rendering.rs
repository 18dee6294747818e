//! The result of a rendering: the picture, with its counts and times.

use std::path::Path;

use super::options::RenderOptions;
use super::stopwatch::Elapsed;
use crate::error::Result;
use crate::film::Film;
use crate::integrator::Counts;
use crate::intersect::{BuildQuality, BuildStats, Precision};
use crate::write;

/// A picture, with its statistics and with the settings by which it is saved.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Rendering {
    /// The picture.
    pub film: Film,
    /// The settings by which [`save`](Rendering::save) encodes the film: those of the scene.
    pub settings: write::Settings,
    /// Counts and times.
    pub statistics: Statistics,
}

impl Rendering {
    /// Saves the picture as PNG, JPEG, WebP or EXR, by the extension of `path`.
    ///
    /// # Errors
    /// When the extension names no format or one that cannot hold such a size, or the file cannot be written; an old file at `path` is
    /// left as it was.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write::write(&self.film, path.as_ref(), &self.settings)
    }
}

/// The counts and times of a rendering.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Statistics {
    /// The name of the intersector.
    pub backend: &'static str,
    /// The version of the library that traces.
    pub backend_version: String,
    /// The precision of the hits.
    pub precision: Precision,
    /// The quality of Embree's trees; `None` without Embree.
    pub quality: Option<BuildQuality>,
    /// The number of threads.
    pub threads: usize,
    /// Rays and other counts.
    pub counts: Counts,
    /// Counts of what was built for the intersector, and of what was reused.
    pub built: BuildStats,
    /// The time to build the intersector.
    pub build: Elapsed,
    /// The time from the first ray to the last pixel.
    pub render: Elapsed,
}

impl Statistics {
    /// Zeroed statistics, to which those of frames are added.
    pub fn zero(options: &RenderOptions) -> Self {
        Self {
            backend: options.backend().name(),
            backend_version: String::new(),
            precision: options.precision,
            quality: None,
            threads: options.threads,
            counts: Counts::default(),
            built: BuildStats::default(),
            build: Elapsed::default(),
            render: Elapsed::default(),
        }
    }

    /// Adds the statistics of another frame of the same animation.
    pub fn add(&mut self, other: &Statistics) {
        self.backend = other.backend;
        self.backend_version.clone_from(&other.backend_version);
        self.threads = other.threads;
        self.quality = other.quality;
        self.counts += other.counts;
        self.built += other.built;
        self.build += other.build;
        self.render += other.render;
    }
}
