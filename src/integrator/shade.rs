//! What the lights and the surfaces themselves give to the rays of a wave, sixteen at a time.

use glam::{DVec3, Vec3};

use crate::geometry::{Departure, Found, Geometry, LANES, Lanes, PrimitiveId, Rays, Side};
use crate::integrator::counts::Cause;
use crate::integrator::look::is_detailed;
use crate::integrator::shadow::Through;
use crate::integrator::{Counts, Integrator, Wave};
use crate::intersect::Coherence;
use crate::scene::LightKind;
use crate::shading::{self, Reflectance};
use crate::surface::{Detail, Surfaces};

/// The light that a wave's rays bring back, and what it takes to work it out.
#[derive(Default)]
pub(super) struct Light {
    /// The radiance along each ray, but for what mirrors and glass show.
    pub radiance: Vec<Vec3>,
    /// Rays of which the radiance is not finite, and is NaN here, with what made it so.
    pub spoilt: Vec<(u32, Cause)>,
    /// The mirrors and the glass that were hit, by ray.
    pub bounces: Vec<u32>,
    /// Room for surfaces, and how many of them are in use.
    lit: (Vec<Lit>, usize),
    shadow: Shadows,
}

/// Sixteen surfaces that wait for light.
#[repr(C, align(64))]
struct Lit {
    /// Which sixteen of the wave.
    block: usize,
    surfaces: Surfaces,
    /// Those that scatter any light.
    here: Lanes<bool>,
    diffuse: [Lanes<f32>; 3],
    specular: [Lanes<f32>; 3],
    shininess: Lanes<f32>,
    /// Whether any has a highlight.
    shines: bool,
    /// The exponent of all highlights, where they have one, and it is whole.
    exponent: Option<u32>,
}

/// Shadow rays, side by side with what waits on them.
#[derive(Default)]
pub(super) struct Shadows {
    /// From the surfaces to one light.
    pub rays: Rays,
    /// The ray of the wave that met each one's surface, and the radiance that waits.
    pub waiting: Vec<(u32, Vec3)>,
    /// Whether anything stands in the way.
    pub blocked: Vec<bool>,
    /// What is left of the light where glass stands in the way.
    pub left: Vec<DVec3>,
    /// Room for those that go through glass.
    pub through: Through,
}

/// The radiance that a light gives of which the arrival is not finite; no finite factors make NaN.
const NO_LIGHT: Vec3 = Vec3::NAN;

impl Integrator<'_> {
    /// Works out the radiance along each ray of a wave.
    pub(super) fn shade(&self, wave: &Wave, light: &mut Light, counts: &mut Counts) {
        self.arch.dispatch(Meet { integrator: self, wave, light });
        let Light { radiance, spoilt, lit: (lit, filled), shadow, .. } = light;
        let lit = &lit[..*filled];
        for light in &self.scene.lights {
            if light.kind == LightKind::Ambient {
                for lit in lit {
                    for i in (0..LANES).filter(|&i| lit.here[i]) {
                        let ray = (lit.block * LANES + i) as u32;
                        add(ray, radiance, at(&lit.diffuse, i) * light.intensity, spoilt);
                    }
                }
                continue;
            }
            shadow.clear();
            let radiance = &mut *radiance;
            let to = Reached { radiance, spoilt, shadow };
            self.arch.dispatch(Reach { integrator: self, light, lit, wave, to });
            if shadow.rays.is_empty() {
                continue;
            }
            self.intersector.occluded_of(&shadow.rays, Coherence::Coherent, &mut shadow.blocked);
            counts.rays.shadow += shadow.rays.len() as u64;
            if self.transmits {
                self.let_through(light.shadow, wave, shadow, counts);
                for (&(i, with), &left) in shadow.waiting.iter().zip(&shadow.left) {
                    if left != DVec3::ZERO {
                        add(i, radiance, (with.as_dvec3() * left).as_vec3(), spoilt);
                    }
                }
                continue;
            }
            for (&(i, with), blocked) in shadow.waiting.iter().zip(&shadow.blocked) {
                if !blocked {
                    add(i, radiance, with, spoilt);
                }
            }
        }
    }

    /// What the rays meet: background, emission, the surfaces to be lit, mirrors and glass.
    #[inline(always)]
    fn meet(&self, wave: &Wave, light: &mut Light) {
        let Light { radiance, spoilt, bounces, lit: (lit, filled), .. } = light;
        radiance.clear();
        radiance.resize(wave.rays.len(), self.scene.film.background);
        spoilt.clear();
        bounces.clear();
        *filled = 0;
        for (block, found) in wave.hits.found().iter().enumerate() {
            if *filled == lit.len() {
                lit.push(Lit::default());
            }
            let lit = &mut lit[*filled];
            lit.surfaces.set(self.scene, &wave.rays, block, found);
            if lit.surfaces.kinds.any() {
                lit.block = block;
                self.look(found, lit, radiance, spoilt, bounces);
                *filled += usize::from(lit.here.contains(&true));
            }
        }
    }

    /// How sixteen surfaces look, before any light falls on them.
    #[inline(always)]
    fn look(
        &self,
        found: &Found,
        lit: &mut Lit,
        radiance: &mut [Vec3],
        spoilt: &mut Vec<(u32, Cause)>,
        bounces: &mut Vec<u32>,
    ) {
        lit.here = [false; LANES];
        lit.shines = false;
        let mut one_exponent = true;
        let mut exponent = None;
        for i in 0..LANES {
            let Some(hit) = found.hit(i) else { continue };
            let ray = lit.block * LANES + i;
            let material = lit.surfaces.material[i].0 as usize;
            let look = &self.looks[material];
            let Reflectance { mut diffuse, specular, shininess } = look.reflectance;
            let mut emission = look.emission;
            if self.has_detail && is_detailed(self.scene, look, &hit) {
                let (position, normal) =
                    (lit.surfaces.position(i), lit.surfaces.geometric_normal(i));
                let detail = Detail::new(self.scene, &hit, position, normal);
                let material = &self.scene.materials[material];
                (emission, diffuse) = look.with(self.scene, material, &detail);
            }
            let colors = emission.is_finite() && diffuse.is_finite();
            if !(colors && lit.surfaces.position(i).is_finite()) {
                spoil(ray as u32, &mut radiance[ray], Cause::Surface, spoilt);
                continue;
            }
            radiance[ray] = emission;
            lit.here[i] = diffuse != Vec3::ZERO || specular != Vec3::ZERO;
            put(&mut lit.diffuse, i, diffuse);
            put(&mut lit.specular, i, specular);
            lit.shininess[i] = shininess;
            if specular != Vec3::ZERO {
                lit.shines = true;
                one_exponent &= *exponent.get_or_insert(shininess) == shininess;
            }
            if self.follows && look.is_followed {
                bounces.push(ray as u32);
            }
        }
        lit.exponent = exponent.filter(|_| one_exponent).and_then(shading::whole);
    }

    /// The light of one source on sixteen surfaces: what reaches them for certain, and the shadow
    /// rays that ask whether the rest does.
    #[inline(always)]
    fn reach(
        &self,
        light: &crate::scene::Light,
        lit: &Lit,
        wave: &Wave,
        Reached { radiance, spoilt, shadow }: &mut Reached<'_>,
    ) {
        let found = &wave.hits.found()[lit.block];
        let Some(arrivals) = Arrivals::of(light, lit) else { return };
        let Some(shares) = lit.shares(&arrivals, &wave.rays, found) else { return };
        for i in (0..LANES).filter(|&i| shares.here[i]) {
            let share = at(&shares.share, i);
            let intensity = arrivals.intensity[i];
            let with = match (intensity.is_finite(), share.is_finite()) {
                (false, _) => NO_LIGHT,
                (true, false) => Vec3::INFINITY,
                (true, true) => share * intensity,
            };
            let Some(id) = found.id[i] else { continue };
            if share == Vec3::ZERO || with == Vec3::ZERO {
                continue;
            }
            let ray = (lit.block * LANES + i) as u32;
            if !light.casts_shadow() {
                add(ray, radiance, with, spoilt);
                continue;
            }
            let side = if shares.on_front[i] { Side::Front } else { Side::Back };
            shadow.rays.push_spawned(
                lit.surfaces.position(i),
                arrivals.toward(i),
                if arrivals.bounded { 1.0 } else { f64::INFINITY },
                Departure { id, side },
            );
            shadow.waiting.push((ray, with));
        }
    }
}

/// What a light's reach adds to.
struct Reached<'a> {
    radiance: &'a mut [Vec3],
    spoilt: &'a mut Vec<(u32, Cause)>,
    shadow: &'a mut Shadows,
}

/// [`Integrator::meet`], compiled for what the processor can do at once.
struct Meet<'a> {
    integrator: &'a Integrator<'a>,
    wave: &'a Wave,
    light: &'a mut Light,
}

impl pulp::WithSimd for Meet<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.integrator.meet(self.wave, self.light);
    }
}

/// [`Integrator::reach`], compiled for what the processor can do at once.
struct Reach<'a> {
    integrator: &'a Integrator<'a>,
    light: &'a crate::scene::Light,
    lit: &'a [Lit],
    wave: &'a Wave,
    to: Reached<'a>,
}

impl pulp::WithSimd for Reach<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        for lit in self.lit {
            self.integrator.reach(self.light, lit, self.wave, &mut self.to);
        }
    }
}

/// The light that arrives at sixteen points.
struct Arrivals {
    toward: [Lanes<f64>; 3],
    intensity: Lanes<Vec3>,
    /// Where any arrives.
    here: Lanes<bool>,
    bounded: bool,
}

impl Arrivals {
    #[inline(always)]
    fn of(light: &crate::scene::Light, lit: &Lit) -> Option<Self> {
        let mut arrivals = Self {
            toward: [[0.0; LANES]; 3],
            intensity: [light.intensity; LANES],
            here: lit.here,
            bounded: true,
        };
        match light.kind {
            LightKind::Ambient => return None,
            LightKind::Directional { direction } => {
                arrivals.toward = (-direction).to_array().map(|x| [x; LANES]);
                arrivals.bounded = false;
            }
            LightKind::Point { position, .. } if light.is_steady() => {
                for axis in 0..3 {
                    for i in 0..LANES {
                        arrivals.toward[axis][i] = position[axis] - lit.surfaces.position[axis][i];
                    }
                }
                for i in 0..LANES {
                    arrivals.here[i] &= arrivals.toward(i).length_squared() != 0.0;
                }
            }
            LightKind::Point { .. } | LightKind::Spot { .. } => {
                for i in (0..LANES).filter(|&i| lit.here[i]) {
                    match light.arrival(lit.surfaces.position(i)) {
                        None => arrivals.here[i] = false,
                        Some(arrival) => {
                            for axis in 0..3 {
                                arrivals.toward[axis][i] = arrival.toward[axis];
                            }
                            arrivals.intensity[i] = arrival.intensity;
                        }
                    }
                }
            }
        }
        Some(arrivals)
    }

    #[inline(always)]
    fn toward(&self, i: usize) -> DVec3 {
        DVec3::new(self.toward[0][i], self.toward[1][i], self.toward[2][i])
    }
}

/// What sixteen surfaces send to the eye of one light, in units of its intensity.
struct Shares {
    share: [Lanes<f32>; 3],
    /// Those that face the light.
    here: Lanes<bool>,
    /// Whether the light is on the side of the geometric normal.
    on_front: Lanes<bool>,
}

impl Lit {
    /// As [`shading::direct`], to the bit; `None` where none faces the light.
    #[inline(always)]
    fn shares(&self, arrivals: &Arrivals, rays: &Rays, found: &Found) -> Option<Shares> {
        let surfaces = &self.surfaces;
        let mut shares =
            Shares { share: [[0.0; LANES]; 3], here: [false; LANES], on_front: [false; LANES] };
        let mut any = false;
        let mut cosines = [0.0; LANES];
        for i in 0..LANES {
            let toward = arrivals.toward(i);
            let cosine = shading::lambert(surfaces.normal(i), toward);
            let over = surfaces.geometric_normal(i).dot(toward);
            shares.on_front[i] = over > 0.0;
            // On a smooth-shaded mesh the shading normal may see a light that is behind the
            // surface itself.
            let facing = if surfaces.is_back[i] { -over } else { over };
            let behind = is_triangle(found.id[i]) & (facing <= 0.0);
            let here = arrivals.here[i] & !(cosine <= 0.0) & !behind;
            shares.here[i] = here;
            any |= here;
            cosines[i] = cosine;
        }
        if !any {
            return None;
        }
        for axis in 0..3 {
            for i in 0..LANES {
                shares.share[axis][i] = self.diffuse[axis][i] * cosines[i] as f32;
            }
        }
        if self.shines {
            self.add_highlights(arrivals, rays, &mut shares);
        }
        Some(shares)
    }

    #[inline(always)]
    fn add_highlights(&self, arrivals: &Arrivals, rays: &Rays, shares: &mut Shares) {
        let lines = &rays.lines()[self.block];
        let mut toward = [0.0; LANES];
        for i in 0..LANES {
            let view = lines.line(i).1;
            toward[i] = shading::phong(self.surfaces.normal(i), view, arrivals.toward(i));
        }
        let highlight = match self.exponent {
            Some(exponent) => shading::power_of_all(toward, exponent),
            None => {
                let mut each = [0.0; LANES];
                for i in (0..LANES).filter(|&i| shares.here[i]) {
                    each[i] = shading::power(toward[i], self.shininess[i]);
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

impl Default for Lit {
    fn default() -> Self {
        Self {
            block: 0,
            surfaces: Surfaces::default(),
            here: [false; LANES],
            diffuse: [[0.0; LANES]; 3],
            specular: [[0.0; LANES]; 3],
            shininess: [0.0; LANES],
            shines: false,
            exponent: None,
        }
    }
}

impl Light {
    /// Takes the radiance along each ray as its sample, and counts what spoilt any.
    pub fn take_samples(&mut self, samples: &mut Vec<Vec3>, counts: &mut Counts) {
        std::mem::swap(samples, &mut self.radiance);
        self.spoilt.drain(..).for_each(|(_, cause)| cause.count(counts));
    }
}

impl Shadows {
    fn clear(&mut self) {
        self.rays.clear();
        self.waiting.clear();
    }
}

#[inline(always)]
fn is_triangle(id: Option<PrimitiveId>) -> bool {
    matches!(id, Some(PrimitiveId { geometry: Geometry::Mesh(_), .. }))
}

#[inline(always)]
fn at(v: &[Lanes<f32>; 3], i: usize) -> Vec3 {
    Vec3::new(v[0][i], v[1][i], v[2][i])
}

#[inline(always)]
fn put(v: &mut [Lanes<f32>; 3], i: usize, value: Vec3) {
    for axis in 0..3 {
        v[axis][i] = value[axis];
    }
}

/// Adds to the radiance along ray `i`, unless it is spoilt already.
#[inline(always)]
fn add(i: u32, radiance: &mut [Vec3], with: Vec3, spoilt: &mut Vec<(u32, Cause)>) {
    let to = &mut radiance[i as usize];
    let sum = *to + with;
    if sum.is_finite() {
        *to = sum;
    } else if with.is_nan() {
        spoil(i, to, Cause::Light, spoilt);
    } else {
        spoil(i, to, Cause::Sum, spoilt);
    }
}

/// Makes the radiance along ray `i` NaN, so that it stays out of the picture, and keeps what did
/// it first.
#[cold]
fn spoil(i: u32, radiance: &mut Vec3, cause: Cause, spoilt: &mut Vec<(u32, Cause)>) {
    if !radiance.is_nan() {
        spoilt.push((i, cause));
    }
    *radiance = Vec3::NAN;
}
