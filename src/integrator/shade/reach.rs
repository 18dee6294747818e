//! The light of one source on the surfaces: what reaches them for certain, and the shadow rays that
//! ask whether the rest does.

use glam::{DVec3, Vec3};

use crate::geometry::{Hit16, LANES, Lanes, PrimitiveId16, RayBatch};
use crate::integrator::Wave;
use crate::integrator::counts::FeatureCounts;
use crate::integrator::radiance::{all_finite, any, at, put};
use crate::integrator::shade::sums::RadianceSums;
use crate::integrator::shade::{For, LitSurface16, PendingLight, ShadowQueue};
use crate::scene::LightKind;
use crate::shading;

/// The radiance that a light gives of which the arrival is not finite; no finite factors make NaN.
const NO_LIGHT: Vec3 = Vec3::NAN;

/// What one light gives to the surfaces.
pub(super) struct Reach<'a, 'b> {
    pub light: &'a crate::scene::Light,
    /// Whether shadow rays go out to it.
    pub asks: bool,
    pub lit: &'a [LitSurface16],
    pub wave: &'a Wave,
    pub to: &'a mut RadianceSums<'b>,
    pub shadow: &'a mut ShadowQueue,
    pub work: &'a mut FeatureCounts,
}

impl<const HIGHLIGHTS: bool> pulp::WithSimd for For<Reach<'_, '_>, HIGHLIGHTS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.reach::<HIGHLIGHTS>();
    }
}

impl Reach<'_, '_> {
    #[inline(always)]
    fn reach<const HIGHLIGHTS: bool>(self) {
        let Self { light, asks, lit: all, wave, to, shadow, work } = self;
        let (mut arrivals, mut shares) = (IncidentLight16::default(), Reflected16::default());
        let tmax = if light.is_bounded() { 1.0 } else { f64::INFINITY };
        for lit in all {
            let found = &wave.hits.blocks()[lit.block];
            arrivals.set(light, lit);
            shares.set::<HIGHLIGHTS>(lit, &arrivals, &wave.rays, found, work);
            if !any(&shares.here) {
                continue;
            }
            let mut bright = [false; LANES];
            let mut with = [[0.0f32; LANES]; 3];
            for axis in 0..3 {
                for i in 0..LANES {
                    with[axis][i] = shares.share[axis][i] * arrivals.intensity[axis][i];
                }
            }
            for i in 0..LANES {
                let [x, y, z] = [with[0][i], with[1][i], with[2][i]];
                bright[i] = shares.here[i] & ((x != 0.0) | (y != 0.0) | (z != 0.0));
            }
            if !all_finite(&with) {
                mark_odd(&arrivals, &shares, &mut with, &mut bright);
            } else if !any(&bright) {
                continue;
            }
            if !asks {
                to.add_all(lit.block, &with, &bright);
                continue;
            }
            let (lines, left) = shadow.rays.push_block();
            for axis in 0..3 {
                lines.origin[axis] = lit.surfaces.position[axis];
                lines.direction[axis] = arrivals.toward[axis];
            }
            for i in 0..LANES {
                lines.tmax[i] = if bright[i] { tmax } else { 0.0 };
                left.is_back[i] = !shares.on_front[i];
            }
            left.id.geometry = found.id.geometry;
            left.id.primitive = found.id.primitive;
            left.id.instance = found.id.instance;
            shadow.waiting.push(PendingLight { block: lit.block, with, here: bright });
        }
    }
}

/// Tells apart, among sums that are not finite, what made them so: NaN where the light's arrival is
/// not finite, infinite where the surface's share of it is not. What overflows only in their product
/// is infinite by itself.
#[cold]
fn mark_odd(
    arrivals: &IncidentLight16,
    shares: &Reflected16,
    with: &mut [Lanes<f32>; 3],
    bright: &mut Lanes<bool>,
) {
    for i in (0..LANES).filter(|&i| shares.here[i]) {
        let (share, intensity) = (at(&shares.share, i), at(&arrivals.intensity, i));
        if share == Vec3::ZERO {
            bright[i] = false;
        } else if !intensity.is_finite() {
            put(with, i, NO_LIGHT);
            bright[i] = true;
        } else if !share.is_finite() {
            put(with, i, Vec3::INFINITY);
            bright[i] = true;
        }
    }
}

/// The light that arrives at sixteen points.
#[derive(Default)]
#[repr(C, align(64))]
struct IncidentLight16 {
    toward: [Lanes<f64>; 3],
    intensity: [Lanes<f32>; 3],
    /// Where any arrives.
    here: Lanes<bool>,
}

impl IncidentLight16 {
    #[inline(always)]
    fn set(&mut self, light: &crate::scene::Light, lit: &LitSurface16) {
        self.intensity = light.intensity.to_array().map(|x| [x; LANES]);
        self.here = lit.here;
        match light.kind {
            LightKind::Directional { direction } => {
                self.toward = (-direction).to_array().map(|x| [x; LANES]);
            }
            LightKind::Point { position, .. } if light.has_constant_intensity() => {
                for axis in 0..3 {
                    for i in 0..LANES {
                        self.toward[axis][i] = position[axis] - lit.surfaces.position[axis][i];
                    }
                }
                for i in 0..LANES {
                    self.here[i] &= self.toward(i).length_squared() != 0.0;
                }
            }
            _ => {
                for i in (0..LANES).filter(|&i| lit.here[i]) {
                    match light.incident(lit.surfaces.position(i)) {
                        None => self.here[i] = false,
                        Some(arrival) => {
                            for axis in 0..3 {
                                self.toward[axis][i] = arrival.toward[axis];
                            }
                            put(&mut self.intensity, i, arrival.intensity);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn toward(&self, i: usize) -> DVec3 {
        DVec3::new(self.toward[0][i], self.toward[1][i], self.toward[2][i])
    }
}

/// What sixteen surfaces send to the eye of one light, in units of its intensity.
#[derive(Default)]
#[repr(C, align(64))]
struct Reflected16 {
    share: [Lanes<f32>; 3],
    /// Those that face the light.
    here: Lanes<bool>,
    /// Whether the light is on the side of the geometric normal.
    on_front: Lanes<bool>,
}

impl Reflected16 {
    /// As [`shading::direct`], to the bit.
    #[inline(always)]
    fn set<const HIGHLIGHTS: bool>(
        &mut self,
        lit: &LitSurface16,
        arrivals: &IncidentLight16,
        rays: &RayBatch,
        found: &Hit16,
        work: &mut FeatureCounts,
    ) {
        let surfaces = &lit.surfaces;
        let (mut cosines, mut over, mut mirrored) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let light = shading::normalize16(&arrivals.toward, &arrivals.here);
        let light = |i: usize| DVec3::new(light[0][i], light[1][i], light[2][i]);
        for i in 0..LANES {
            cosines[i] = shading::lambert(surfaces.normal(i), light(i));
        }
        if HIGHLIGHTS && lit.shines {
            let view = shading::normalize16(&rays.blocks()[lit.block].direction, &arrivals.here);
            for i in 0..LANES {
                let view = DVec3::new(view[0][i], view[1][i], view[2][i]);
                mirrored[i] = shading::phong(surfaces.normal(i), view, light(i));
            }
        }
        for i in 0..LANES {
            over[i] = surfaces.geometric_normal(i).dot(arrivals.toward(i));
        }
        for i in 0..LANES {
            self.here[i] = arrivals.here[i] & ((cosines[i] > 0.0) | cosines[i].is_nan());
            self.on_front[i] = over[i] > 0.0;
        }
        if surfaces.kinds.triangles {
            for i in 0..LANES {
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let facing = if surfaces.is_back[i] { -over[i] } else { over[i] };
                self.here[i] &=
                    !((found.id.geometry[i] >= PrimitiveId16::MESHES) & (facing <= 0.0));
            }
        }
        if lit.is_bent {
            // So may a normal that a picture bends on anything else.
            for i in 0..LANES {
                let facing = if surfaces.is_back[i] { -over[i] } else { over[i] };
                let is_inside =
                    surfaces.is_back[i] & (found.id.geometry[i] == PrimitiveId16::SPHERES);
                self.here[i] &= (facing > 0.0) | is_inside;
            }
        }
        if !any(&self.here) {
            return;
        }
        for axis in 0..3 {
            for i in 0..LANES {
                self.share[axis][i] = lit.diffuse[axis][i] * cosines[i] as f32;
            }
        }
        if HIGHLIGHTS && lit.shines {
            work.highlights += LANES as u64;
            lit.add_highlights(mirrored, self);
        }
    }
}

impl LitSurface16 {
    #[inline(always)]
    fn add_highlights(&self, mirrored: Lanes<f64>, shares: &mut Reflected16) {
        let highlight = match self.exponent {
            Some(exponent) => shading::power16(mirrored, exponent),
            None => {
                let mut each = [0.0; LANES];
                for i in (0..LANES).filter(|&i| shares.here[i]) {
                    each[i] = shading::power(mirrored[i], self.shininess[i]);
                }
                each
            }
        };
        for axis in 0..3 {
            for i in 0..LANES {
                let specular = self.specular[axis][i];
                let more = specular * highlight[i] as f32;
                shares.share[axis][i] += if specular == 0.0 { 0.0 } else { more };
            }
        }
    }
}
