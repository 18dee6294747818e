//! From the command line to a scene.

use crate::cli::args::Tracing;
use crate::cli::{files, loss};
use crate::error::{Error, Result};
use crate::scene::{Scene, Skips};

impl Tracing {
    /// Loads the scene as it is at one moment, as [`Tracing::load_animated`].
    ///
    /// # Errors
    /// As there.
    pub fn load(&self) -> Result<(Scene, usize)> {
        let (scene, camera) = self.load_animated(Skips::default())?;
        Ok((scene.at(0.0)?, camera))
    }

    /// Loads the scene and applies the flags; says which camera is asked for. Where `--time` asks
    /// for a moment the scene is that. What nothing shows is left out as `skips` says.
    ///
    /// # Errors
    /// When the scene cannot be loaded, or the flags do not fit it.
    pub fn load_animated(&self, skips: Skips) -> Result<(Scene, usize)> {
        files::check_input(&self.scene)?;
        // Loading and writing keep to them, too. Fails only where the pool is there already.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build_global();
        let mut scene =
            crate::load::load_with(&self.scene, &self.loading.options(self.size, skips))?;
        if self.strict {
            loss::check_strictly(&scene, &self.scene)?;
        }
        if let Some(spp) = self.spp {
            (scene.film.spp, scene.film.adaptive) = (spp, None);
        }
        if let Some(depth) = self.max_depth {
            scene.film.max_depth = depth;
        }
        let camera = match &self.camera {
            None => 0,
            Some(wanted) => find_camera(&scene, wanted)?,
        };
        if let Some(time) = self.time {
            if scene.animation.is_none() {
                let error = Error::input("the scene has no animation, and so no --time");
                return Err(error.at(&self.scene).help("leave --time out"));
            }
            scene = scene.at(time).map_err(|e| e.at(&self.scene))?;
        }
        Ok((scene, camera))
    }

    /// The number of threads; 0 means all.
    pub fn threads(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }
}

fn find_camera(scene: &Scene, wanted: &str) -> Result<usize> {
    if let Some(index) = scene.cameras.iter().position(|c| c.name == wanted) {
        return Ok(index);
    }
    match wanted.parse::<usize>() {
        Ok(index) if index < scene.cameras.len() => Ok(index),
        _ => {
            let names: Vec<String> =
                (0..).zip(&scene.cameras).map(|(i, c)| shown(i, &c.name)).collect();
            Err(Error::input(format!("there is no camera `{wanted}`"))
                .help(format!("the scene has {}", names.join(", "))))
        }
    }
}

fn shown(index: usize, name: &str) -> String {
    if name.is_empty() { index.to_string() } else { format!("{index} `{name}`") }
}
