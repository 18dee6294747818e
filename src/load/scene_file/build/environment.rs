//! The environment.

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

use super::SceneBuilder;
use crate::error::Result;
use crate::load::environment::read_map;
use crate::load::scene_file::schema::light_tables::{BuiltIn, EnvironmentTable};
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::source::Span;
use crate::scene::{Environment, Sky, Transfer};

impl SceneBuilder<'_> {
    /// Sets the environment, and adds the sun of a sky.
    ///
    /// # Errors
    /// When its keys do not fit each other, or its map cannot be read.
    pub fn add_environment(&mut self, table: &EnvironmentTable, span: &Span) -> Result<()> {
        self.check_sources(table, span)?;
        self.check_sky_keys(table)?;
        // Turned about its vertical axis, and that axis to `up`.
        let up = table.up.as_ref().map_or(DVec3::Y, |up| up.value.0);
        let angle = table.rotation.map_or(0.0, |degrees| degrees.0.to_radians());
        let axes = DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Y, up));
        let intensity = table.intensity.map_or(1.0, |x| x.0 as f32);
        let environment = if let Some(name) = &table.file {
            self.map(name)?
        } else if let Some(color) = table.color {
            Environment::even(color.to_linear(self.scene.film.transfer))
        } else if let Some(BuiltIn::Studio) = table.built_in {
            Environment::studio().with_visible(true)
        } else {
            let (environment, sun) = Environment::sky(&sky(table));
            let turn = DAffine3::from_mat3(axes * DMat3::from_rotation_y(angle));
            let sun = sun.transformed(&turn);
            let of_sun = sun.intensity * intensity;
            if table.sun.unwrap_or(true) {
                self.scene.lights.push(sun.with_intensity(of_sun));
            }
            environment
        };
        let environment = environment.with_axes(axes).rotated(angle);
        let environment = environment.with_intensity(Vec3::splat(intensity));
        let visible = table.visible.unwrap_or(true);
        self.scene.environment = Some(environment.with_visible(visible));
        Ok(())
    }

    /// Returns the environment that a file shows.
    fn map(&mut self, name: &Spanned<String>) -> Result<Environment> {
        let source = self.source;
        let opened = self.sandbox.open(source.folder(), &[&name.value]);
        let file =
            opened.map_err(|e| source.unreadable(&name.span, "environment", &name.value, &e))?;
        let (map, warning) = read_map(file, self.sandbox)
            .map_err(|e| source.unreadable(&name.span, "environment", &name.value, &e))?;
        self.report.warnings.extend(warning);
        Ok(Environment::new(map, Transfer::Srgb))
    }

    /// Checks that there is one source of the light.
    fn check_sources(&self, table: &EnvironmentTable, span: &Span) -> Result<()> {
        let given = [table.file.is_some(), table.color.is_some(), table.built_in.is_some()];
        let message = match given.iter().filter(|is_given| **is_given).count() {
            1 => return Ok(()),
            0 => "the environment has no light",
            _ => "the environment has its light from several sources",
        };
        let help = "give one of `file`, `color` and `built_in`";
        Err(self.source.error(span, message).help(help))
    }

    /// Checks that keys of the sky are beside one.
    fn check_sky_keys(&self, table: &EnvironmentTable) -> Result<()> {
        let EnvironmentTable { sun_elevation, sun_azimuth, turbidity, .. } = table;
        let spans = [
            ("sun_elevation", sun_elevation.as_ref().map(|x| &x.span)),
            ("sun_azimuth", sun_azimuth.as_ref().map(|x| &x.span)),
            ("turbidity", turbidity.as_ref().map(|x| &x.span)),
        ];
        for (key, span) in spans {
            if let Some(span) = span
                && table.built_in != Some(BuiltIn::Sky)
            {
                let message = format!("`{key}` is about the built-in sky");
                let help = "add `built_in = \"sky\"`, or leave it out";
                let span = self.source.key_span(key, span);
                return Err(self.source.error(&span, message).help(help));
            }
        }
        Ok(())
    }
}

/// Returns the sky that a table describes.
fn sky(table: &EnvironmentTable) -> Sky {
    let default = Sky::default();
    let radians = |degrees: f64| degrees.to_radians();
    Sky {
        elevation: table.sun_elevation.as_ref().map_or(default.elevation, |x| radians(x.value.0)),
        azimuth: table.sun_azimuth.as_ref().map_or(default.azimuth, |x| radians(x.value.0)),
        turbidity: table.turbidity.as_ref().map_or(default.turbidity, |x| x.value.0),
        ..default
    }
}
