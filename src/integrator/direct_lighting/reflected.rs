//! The light of one source that surfaces reflect to the viewer, in either shading model.

use std::f32::consts::PI;

use glam::DVec3;

use super::incident_light::IncidentLight16;
use crate::geometry::{Hit16, LANES, Lanes, PrimitiveId16};
use crate::integrator::opaque_surfaces::OpaqueSurfaces16;
use crate::integrator::pbr_surfaces::PbrHit;
use crate::integrator::radiance::{any, set_lane};
use crate::integrator::wave_surfaces::LitSurface16;
use crate::shading::{self, Bsdf};
use crate::surface::Surface16;

/// The physically based ones of sixteen surfaces, and their BSDFs.
pub(super) struct PbrLanes<'a> {
    /// The surfaces.
    pub hits: &'a [PbrHit],
    /// Returns the BSDF of one of them.
    pub bsdf: &'a dyn Fn(&PbrHit) -> &'a Bsdf,
    /// The surfaces that are shaded side by side, which are not among the others.
    pub opaque: Option<&'a OpaqueSurfaces16>,
}

/// The light that sixteen surfaces reflect to the viewer, in units of its intensity.
#[derive(Default)]
#[repr(C, align(64))]
pub(super) struct Reflected16 {
    /// The shares.
    pub share: [Lanes<f32>; 3],
    /// True in each lane whose surface faces the light.
    pub faces_light: Lanes<bool>,
    /// True in each lane whose geometric normal points to the light's side.
    pub is_light_in_front: Lanes<bool>,
}

impl Reflected16 {
    /// Computes what surfaces, seen along `directions`, reflect of the incident light: Lambert's
    /// n·l, without 1/π, and Phong's max(0, r·l)^α with r = u − 2(u·n)n, both as in the tutorial
    /// (III.2, III.3; Bui Tuong Phong, *Illumination for Computer Generated Pictures*, 1975).
    /// A surface that faces away from the light reflects nothing.
    #[inline(always)]
    pub fn set<const HIGHLIGHTS: bool, const SOFT_TERMINATOR: bool>(
        &mut self,
        lit: &LitSurface16,
        pbr: &PbrLanes<'_>,
        incident: &IncidentLight16,
        directions: &[Lanes<f64>; 3],
        hits: &Hit16,
    ) {
        // The cosines of Lambert and Phong.
        let surface = &lit.surface;
        let (mut diffuse, mut mirrored) = ([0.0; LANES], [0.0; LANES]);
        let unit = shading::normalize_lanes(&incident.toward, &incident.arrives);
        let light = |i: usize| DVec3::new(unit[0][i], unit[1][i], unit[2][i]);
        for i in 0..LANES {
            diffuse[i] = shading::lambert(surface.normal(i), light(i));
        }
        if HIGHLIGHTS && lit.has_highlights {
            let view = shading::normalize_lanes(directions, &incident.arrives);
            for i in 0..LANES {
                let view = DVec3::new(view[0][i], view[1][i], view[2][i]);
                mirrored[i] = shading::phong(surface.normal(i), view, light(i));
            }
        }
        self.set_facing(lit, incident, &diffuse, hits);
        // Light from behind comes through what transmits it diffusely.
        for hit in pbr.hits.iter().filter(|hit| hit.is_translucent) {
            self.faces_light[hit.lane] = incident.arrives[hit.lane];
        }
        if !any(&self.faces_light) {
            return;
        }
        // The shares by the material's colours.
        for channel in 0..3 {
            for i in 0..LANES {
                self.share[channel][i] = lit.diffuse[channel][i] * diffuse[i] as f32;
            }
        }
        if HIGHLIGHTS && lit.has_highlights {
            self.add_highlights(lit, mirrored);
        }
        self.set_pbr(pbr, &unit);
        if let Some(opaque) = pbr.opaque {
            opaque.reflect(&unit, &diffuse, &mut self.share);
        }
        // Toward the terminator of a smooth mesh, light fades out.
        if SOFT_TERMINATOR && surface.has_triangles {
            self.fade_to_terminator(surface, &diffuse);
        }
    }

    /// Sets the shares of physically based surfaces. Intensities are irradiances divided by π, hence the factor.
    #[inline(always)]
    fn set_pbr(&mut self, pbr: &PbrLanes<'_>, toward: &[Lanes<f64>; 3]) {
        for hit in pbr.hits.iter().filter(|hit| self.faces_light[hit.lane]) {
            let i = hit.lane;
            let light = DVec3::new(toward[0][i], toward[1][i], toward[2][i]);
            let value = hit.evaluate((pbr.bsdf)(hit), light);
            set_lane(&mut self.share, i, value * (PI * hit.alpha));
        }
    }

    /// Sets which surfaces face the light: by the cosine of the shading normal, and by the side of
    /// the geometric normal where the two may disagree.
    #[inline(always)]
    fn set_facing(
        &mut self,
        lit: &LitSurface16,
        incident: &IncidentLight16,
        cosine: &Lanes<f64>,
        hits: &Hit16,
    ) {
        let surface = &lit.surface;
        let mut geometric = [0.0; LANES];
        for i in 0..LANES {
            geometric[i] = surface.geometric_normal(i).dot(incident.toward(i));
        }
        for i in 0..LANES {
            self.faces_light[i] = incident.arrives[i] & ((cosine[i] > 0.0) | cosine[i].is_nan());
            self.is_light_in_front[i] = geometric[i] > 0.0;
        }
        if surface.has_triangles {
            for i in 0..LANES {
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let facing = if surface.is_back[i] { -geometric[i] } else { geometric[i] };
                self.faces_light[i] &=
                    !((hits.id.geometry[i] >= PrimitiveId16::MESHES) & (facing <= 0.0));
            }
        }
        if lit.has_mapped_normals {
            // On anything else a normal from a normal map may see such a light.
            for i in 0..LANES {
                let facing = if surface.is_back[i] { -geometric[i] } else { geometric[i] };
                let is_inside_sphere =
                    surface.is_back[i] & (hits.id.geometry[i] == PrimitiveId16::SPHERES);
                self.faces_light[i] &= (facing > 0.0) | is_inside_sphere;
            }
        }
    }

    /// Adds Phong's highlights, by the cosines r·l.
    #[inline(always)]
    fn add_highlights(&mut self, lit: &LitSurface16, mirrored: Lanes<f64>) {
        let highlight = match lit.common_exponent {
            Some(exponent) => shading::power_lanes(mirrored, exponent),
            None => {
                let mut highlight = [0.0; LANES];
                for i in (0..LANES).filter(|&i| self.faces_light[i]) {
                    highlight[i] = shading::power(mirrored[i], lit.shininess[i]);
                }
                highlight
            }
        };
        for channel in 0..3 {
            for i in 0..LANES {
                let specular = lit.specular[channel][i];
                let product = specular * highlight[i] as f32;
                self.share[channel][i] += if specular == 0.0 { 0.0 } else { product };
            }
        }
    }

    /// Multiplies the shares on smooth meshes by g + g² − g³, with g = 1 − tan θ tan δ, where θ is the angle
    /// of the light and δ that of the faces about the point, both from the shading normal.
    ///
    /// This is the factor of Chiang, Li and Burley (*Taming the Shadow Terminator*, SIGGRAPH Talks 2019),
    /// g = (m·l) / ((n·l) (n·m)), for a face m that is turned from the light as far as any about the
    /// point. For the face that was hit itself it would make each of the flat faces visible; so it is as
    /// smooth as the normals are, and 0 before the light reaches the edge of a face that is turned away.
    #[inline(always)]
    fn fade_to_terminator(&mut self, surface: &Surface16, cosine: &Lanes<f64>) {
        let mut fade = [1.0; LANES];
        for i in 0..LANES {
            let tangent = (1.0 - cosine[i] * cosine[i]).max(0.0).sqrt() / cosine[i];
            let g = (1.0 - tangent * surface.spread[i]).max(0.0);
            let fades = (surface.spread[i] > 0.0) & (cosine[i] > 0.0);
            fade[i] = if fades { (g + g * g - g * g * g) as f32 } else { 1.0 };
        }
        for channel in &mut self.share {
            for i in 0..LANES {
                channel[i] *= fade[i];
            }
        }
    }
}
