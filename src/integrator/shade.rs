//! What the lights and the surfaces themselves give to the rays of a wave, sixteen at a time.

mod meet;
mod reach;
mod sums;

use glam::{DVec3, Vec3};

use crate::geometry::{LANES, Lanes, RayBatch};
use crate::integrator::counts::NotFiniteCause;
use crate::integrator::radiance::{Radiance, at};
use crate::integrator::shadow::TransmissiveShadows;
use crate::integrator::{Counts, Integrator, Wave};
use crate::scene::{LightKind, ShadingParams};
use crate::surface::{Surface, Surface16};
use meet::Meet;
use reach::Reach;
use sums::{RadianceSums, Settle};

/// The light that a wave's rays bring back, and what it takes to work it out.
#[derive(Default)]
pub(super) struct WaveLighting {
    /// The radiance along each ray, but for what mirrors and glass show.
    pub radiance: Vec<Radiance>,
    /// Rays of which the radiance is not finite, and is NaN here, with what made it so.
    pub spoilt: Vec<(u32, NotFiniteCause)>,
    /// The mirrors and the glass that were hit, by ray.
    pub bounces: Vec<SpecularHit>,
    /// Room for surfaces, and how many of them are in use.
    lit: (Vec<LitSurface16>, usize),
    shadow: ShadowQueue,
}

/// A mirror or a glass that a ray of the wave hit.
pub(super) struct SpecularHit {
    /// The ray.
    pub ray: u32,
    /// The surface, its normal as a normal map bends it.
    pub surface: Surface,
    /// What it does with light there.
    pub finish: ShadingParams,
}

/// Sixteen surfaces that wait for light.
#[repr(C, align(64))]
struct LitSurface16 {
    /// Which sixteen of the wave.
    block: usize,
    surfaces: Surface16,
    /// Those that scatter any light.
    here: Lanes<bool>,
    diffuse: [Lanes<f32>; 3],
    specular: [Lanes<f32>; 3],
    shininess: Lanes<f32>,
    /// The share of the ambient light that comes there.
    ambient: Lanes<f32>,
    /// Whether a picture has bent any normal.
    is_bent: bool,
    /// Whether any has a highlight.
    shines: bool,
    /// The exponent of all highlights, where they have one, and it is whole.
    exponent: Option<u32>,
}

/// Shadow rays, side by side with what waits on them.
#[derive(Default)]
pub(super) struct ShadowQueue {
    /// From the surfaces to one light, in the lanes of the rays that met them.
    pub rays: RayBatch,
    /// What waits on each sixteen.
    pub waiting: Vec<PendingLight>,
    /// Whether anything stands in the way, or may: what goes through glass is in `left`.
    pub blocked: Vec<bool>,
    /// The shadow rays that go through glass, and what is left of the light there.
    pub left: Vec<(usize, DVec3)>,
    /// Room for those that go through glass.
    pub through: TransmissiveShadows,
}

/// The radiance that waits on sixteen shadow rays.
#[repr(C, align(64))]
pub(super) struct PendingLight {
    /// Which sixteen of the wave.
    pub block: usize,
    with: Radiance,
    /// Where there is a shadow ray.
    here: Lanes<bool>,
}

impl Integrator<'_> {
    /// Works out the radiance along each ray of a wave.
    pub(super) fn shade(&self, wave: &Wave, light: &mut WaveLighting, counts: &mut Counts) {
        let meet = Meet { integrator: self, wave, light, work: &mut counts.work };
        match (self.has_details, self.has_smooth_normals) {
            (false, false) => self.arch.dispatch(For::<_, false, false>(meet)),
            (false, true) => self.arch.dispatch(For::<_, false, true>(meet)),
            (true, false) => self.arch.dispatch(For::<_, true, false>(meet)),
            (true, true) => self.arch.dispatch(For::<_, true, true>(meet)),
        }
        let WaveLighting { radiance, spoilt, lit: (lit, filled), shadow, .. } = light;
        let lit = &lit[..*filled];
        for (light, &asks) in self.scene.lights.iter().zip(&self.asks) {
            let to = &mut RadianceSums { radiance, spoilt };
            if light.kind == LightKind::Ambient {
                for lit in lit {
                    let mut with = lit.diffuse;
                    for axis in 0..3 {
                        with[axis].iter_mut().for_each(|x| *x *= light.intensity[axis]);
                        if self.has_details {
                            with[axis].iter_mut().zip(lit.ambient).for_each(|(x, a)| *x *= a);
                        }
                    }
                    to.add_all(lit.block, &with, &lit.here);
                }
                continue;
            }
            shadow.rays.clear();
            shadow.waiting.clear();
            let reach = Reach { light, asks, lit, wave, to, shadow, work: &mut counts.work };
            match self.has_highlights {
                false => self.arch.dispatch(For::<_, false>(reach)),
                true => self.arch.dispatch(For::<_, true>(reach)),
            }
            if shadow.rays.is_empty() {
                continue;
            }
            self.occluded(&shadow.rays, &mut shadow.blocked, counts);
            let asked = |waiting: &PendingLight| waiting.here.iter().filter(|&&here| here).count();
            counts.rays.shadow += shadow.waiting.iter().map(asked).sum::<usize>() as u64;
            if !light.casts_shadow() {
                shadow.blocked.fill(false);
            } else if self.transmits {
                self.let_through(light.shadow, wave, shadow, counts);
            }
            self.arch.dispatch(Settle { shadow, to });
            for &(i, left) in shadow.left.iter().filter(|(_, left)| *left != DVec3::ZERO) {
                let PendingLight { block, with, .. } = &shadow.waiting[i / LANES];
                let with = (at(with, i % LANES).as_dvec3() * left).as_vec3();
                to.add(*block, i % LANES, with);
            }
            shadow.left.clear();
        }
    }
}

/// A kernel, compiled for what a scene has: so much of it as these constants say.
struct For<K, const A: bool, const B: bool = false>(K);

impl Default for LitSurface16 {
    fn default() -> Self {
        Self {
            block: 0,
            surfaces: Surface16::default(),
            here: [false; LANES],
            diffuse: [[0.0; LANES]; 3],
            specular: [[0.0; LANES]; 3],
            shininess: [0.0; LANES],
            ambient: [1.0; LANES],
            is_bent: false,
            shines: false,
            exponent: None,
        }
    }
}

impl WaveLighting {
    /// The radiance along ray `i`.
    #[inline(always)]
    pub fn radiance(&self, i: usize) -> Vec3 {
        at(&self.radiance[i / LANES], i % LANES)
    }

    /// Takes the radiance along each ray as its sample, and counts what spoilt any.
    pub fn take_samples(&mut self, samples: &mut Vec<Radiance>, counts: &mut Counts) {
        std::mem::swap(&mut self.radiance, samples);
        self.spoilt.drain(..).for_each(|(_, cause)| cause.count(counts));
    }
}
