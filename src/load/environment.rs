//! The environments of loads: the built-in ones, and maps in files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat3};

use crate::error::{Error, Result};
use crate::load::images::decode;
use crate::load::sandbox::{OpenedFile, Sandbox};
use crate::scene::{Environment, Image, Scene, Sky, Transfer};

/// The environment that a load is asked for, instead of the file's own.
///
/// ```
/// use envers::EnvironmentSource;
///
/// assert_eq!(EnvironmentSource::from_text("studio"), EnvironmentSource::Studio);
/// assert_eq!(EnvironmentSource::from_text("a.hdr"), EnvironmentSource::Map("a.hdr".into()));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EnvironmentSource {
    /// No environment.
    None,
    /// The built-in studio, which camera rays do not see.
    Studio,
    /// The built-in clear sky, with its sun as a light.
    Sky,
    /// An equirectangular map in a file: Radiance HDR, OpenEXR, or any format of textures.
    Map(PathBuf),
}

impl EnvironmentSource {
    /// The environment that a text names: `none`, `studio`, `sky`, or a file.
    pub fn from_text(text: &str) -> Self {
        match text {
            "none" => Self::None,
            "studio" => Self::Studio,
            "sky" => Self::Sky,
            file => Self::Map(file.into()),
        }
    }

    /// Gives a scene this environment, whose right, up and front are the columns of a rotation; returns the
    /// warnings about its map.
    pub(super) fn apply(
        &self,
        scene: &mut Scene,
        axes: DMat3,
        sandbox: &Sandbox,
    ) -> Result<Vec<String>> {
        let mut warnings = Vec::new();
        scene.environment = match self {
            Self::None => None,
            Self::Studio => Some(Environment::studio()),
            Self::Sky => {
                let (environment, sun) = Environment::sky(&Sky::default());
                scene.lights.push(sun.transformed(&DAffine3::from_mat3(axes)));
                Some(environment)
            }
            Self::Map(path) => {
                let file = sandbox.open_named(path).map_err(|error| match path.extension() {
                    Some(_) => error,
                    None => error.help("the built-in environments are `studio` and `sky`"),
                })?;
                let (map, warning) = read_map(file, sandbox)?;
                warnings.extend(warning);
                Some(Environment::new(map, Transfer::Srgb))
            }
        };
        scene.environment = scene.environment.take().map(|e| e.with_axes(axes));
        Ok(warnings)
    }
}

/// Reads a map, and a warning about it, if there is one.
///
/// # Errors
/// When the file is no image that can be read, or none of its pixels is a radiance.
pub fn read_map(file: OpenedFile, sandbox: &Sandbox) -> Result<(Arc<Image>, Option<String>)> {
    let path = file.path.clone();
    let (image, invalid) = decode::decode_one(file, sandbox)?;
    let pixels = u64::from(image.width) * u64::from(image.height);
    if invalid == 3 * pixels {
        return Err(Error::input("no pixel of the environment map is a finite radiance").at(&path));
    }
    Ok((Arc::new(image), warning(&path, invalid)))
}

fn warning(path: &Path, invalid: u64) -> Option<String> {
    (invalid > 0).then(|| {
        format!(
            "{}: {invalid} values of the environment map are negative or not finite and become 0",
            path.display()
        )
    })
}
