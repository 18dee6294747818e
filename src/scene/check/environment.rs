//! The checks of an environment.

use super::require::require;
use crate::error::Result;
use crate::scene::Environment;

/// Checks an environment: its map has pixels, and its numbers are finite.
pub(super) fn check(environment: &Environment) -> Result<()> {
    require(environment.map().is_read(), || {
        format!("the environment: the image `{}` was not read", environment.map().name)
    })?;
    let intensity = environment.intensity;
    require(intensity.is_finite() && intensity.min_element() >= 0.0, || {
        format!("the environment: its intensity must be finite and not negative, found {intensity}")
    })?;
    require(environment.to_map.is_finite(), || {
        "the environment: its rotation must be finite".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use crate::scene::{Environment, Image, Scene, Transfer};

    #[test]
    fn an_environment_has_pixels_and_a_finite_intensity() {
        let scene = |environment| Scene { environment: Some(environment), ..Scene::default() };
        let unread = Environment::new(Arc::new(Image::unread("a.hdr")), Transfer::None);
        let odd = |x| Environment::even(Vec3::ONE).with_intensity(Vec3::splat(x));
        for environment in [unread, odd(f32::NAN), odd(-1.0)] {
            assert!(scene(environment).check().is_err());
        }
        assert!(scene(odd(0.0)).check().is_ok());
    }
}
