//! The light of one source that arrives at the surfaces of a wave.

use glam::DVec3;

use crate::geometry::{LANES, Lanes};
use crate::integrator::light_sources::LightSource;
use crate::integrator::radiance::set_lane;
use crate::integrator::wave_surfaces::LitSurface16;
use crate::scene::LightKind;

/// The light of one source that arrives at sixteen points, if nothing is in between.
#[derive(Default)]
#[repr(C, align(64))]
pub(super) struct IncidentLight16 {
    /// The vectors to the light, of any length.
    pub toward: [Lanes<f64>; 3],
    /// The intensities.
    pub intensity: [Lanes<f32>; 3],
    /// True in each lane at which light arrives.
    pub arrives: Lanes<bool>,
    /// The ends of rays along `toward`.
    pub tmax: f64,
}

impl IncidentLight16 {
    /// Sets it to the light that arrives at the surfaces that scatter any.
    #[inline(always)]
    pub fn set(&mut self, source: &LightSource<'_>, lit: &LitSurface16) {
        self.arrives = lit.scatters;
        self.tmax = if source.is_bounded() { 1.0 } else { f64::INFINITY };
        let &LightSource::Light(light) = source else { return self.set_each(source, lit) };
        for channel in 0..3 {
            self.intensity[channel] = [light.intensity[channel]; LANES];
        }
        match light.kind {
            LightKind::Directional { direction, .. } => {
                for axis in 0..3 {
                    self.toward[axis] = [-direction[axis]; LANES];
                }
            }
            LightKind::Point { position, .. } if light.has_constant_intensity() => {
                for axis in 0..3 {
                    for i in 0..LANES {
                        self.toward[axis][i] = position[axis] - lit.surface.position[axis][i];
                    }
                }
                for i in 0..LANES {
                    self.arrives[i] &= self.toward(i).length_squared() != 0.0;
                }
            }
            // Any other light is evaluated point by point.
            _ => self.set_each(source, lit),
        }
    }

    /// Sets it to the light of a source that is evaluated point by point.
    #[inline(always)]
    fn set_each(&mut self, source: &LightSource<'_>, lit: &LitSurface16) {
        for i in (0..LANES).filter(|&i| lit.scatters[i]) {
            match source.incident(lit.surface.position(i)) {
                None => self.arrives[i] = false,
                Some(incident) => {
                    for axis in 0..3 {
                        self.toward[axis][i] = incident.toward[axis];
                    }
                    set_lane(&mut self.intensity, i, incident.intensity);
                }
            }
        }
    }

    /// Returns the vector to the light in lane `i`.
    #[inline(always)]
    pub fn toward(&self, i: usize) -> DVec3 {
        DVec3::new(self.toward[0][i], self.toward[1][i], self.toward[2][i])
    }
}
