//! What the lights and the surfaces themselves give to the rays of a wave, sixteen at a time.

use glam::{DVec3, Vec3};

use crate::geometry::{Found, Ids, LANES, Lanes, Rays};
use crate::integrator::counts::Cause;
use crate::integrator::look::is_detailed;
use crate::integrator::shadow::Through;
use crate::integrator::{Counts, Integrator, Wave};
use crate::intersect::Coherence;
use crate::scene::LightKind;
use crate::shading::{self, Reflectance};
use crate::surface::{Detail, Surface, Surfaces};

/// The light that a wave's rays bring back, and what it takes to work it out.
#[derive(Default)]
pub(super) struct Light {
    /// The radiance along each ray, but for what mirrors and glass show.
    pub radiance: Vec<Radiance>,
    /// Rays of which the radiance is not finite, and is NaN here, with what made it so.
    pub spoilt: Vec<(u32, Cause)>,
    /// The mirrors and the glass that were hit, by ray.
    pub bounces: Vec<(u32, Surface)>,
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

/// The radiance along sixteen rays.
pub(super) type Radiance = [Lanes<f32>; 3];

/// Shadow rays, side by side with what waits on them.
#[derive(Default)]
pub(super) struct Shadows {
    /// From the surfaces to one light, in the lanes of the rays that met them.
    pub rays: Rays,
    /// What waits on each sixteen.
    pub waiting: Vec<Waiting>,
    /// Whether anything stands in the way, or may: what goes through glass is in `left`.
    pub blocked: Vec<bool>,
    /// The shadow rays that go through glass, and what is left of the light there.
    pub left: Vec<(usize, DVec3)>,
    /// Room for those that go through glass.
    pub through: Through,
}

/// The radiance that waits on sixteen shadow rays.
#[repr(C, align(64))]
pub(super) struct Waiting {
    /// Which sixteen of the wave.
    pub block: usize,
    with: Radiance,
    /// Where there is a shadow ray.
    here: Lanes<bool>,
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
            let to = &mut Sums { radiance, spoilt };
            if light.kind == LightKind::Ambient {
                for lit in lit {
                    let mut with = lit.diffuse;
                    for axis in 0..3 {
                        with[axis].iter_mut().for_each(|x| *x *= light.intensity[axis]);
                    }
                    to.add_all(lit.block, &with, &lit.here);
                }
                continue;
            }
            shadow.rays.clear();
            shadow.waiting.clear();
            self.arch.dispatch(Reach { integrator: self, light, lit, wave, to, shadow });
            if shadow.rays.is_empty() {
                continue;
            }
            self.intersector.occluded_of(&shadow.rays, Coherence::Coherent, &mut shadow.blocked);
            let asked = |waiting: &Waiting| waiting.here.iter().filter(|&&here| here).count();
            counts.rays.shadow += shadow.waiting.iter().map(asked).sum::<usize>() as u64;
            if self.transmits {
                self.let_through(light.shadow, wave, shadow, counts);
            }
            self.arch.dispatch(Settle { shadow, to });
            for &(i, left) in shadow.left.iter().filter(|(_, left)| *left != DVec3::ZERO) {
                let Waiting { block, with, .. } = &shadow.waiting[i / LANES];
                let with = (at(with, i % LANES).as_dvec3() * left).as_vec3();
                to.add(*block, i % LANES, with);
            }
            shadow.left.clear();
        }
    }

    /// What the rays meet: background, emission, the surfaces to be lit, mirrors and glass.
    #[inline(always)]
    fn meet(&self, wave: &Wave, light: &mut Light) {
        let Light { radiance, spoilt, bounces, lit: (lit, filled), .. } = light;
        let background = self.scene.film.background;
        radiance.resize(wave.hits.found().len(), [[0.0; LANES]; 3]);
        spoilt.clear();
        bounces.clear();
        *filled = 0;
        for (block, found) in wave.hits.found().iter().enumerate() {
            if *filled == lit.len() {
                lit.push(Lit::default());
            }
            let lit = &mut lit[*filled];
            lit.surfaces.set(self.scene, &wave.rays, block, found);
            for axis in 0..3 {
                radiance[block][axis] = [background[axis]; LANES];
            }
            if lit.surfaces.kinds.any() {
                lit.block = block;
                self.look(found, lit, &mut Sums { radiance, spoilt }, bounces);
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
        to: &mut Sums<'_>,
        bounces: &mut Vec<(u32, Surface)>,
    ) {
        if !self.has_detail && self.look_alike(found, lit, &mut to.radiance[lit.block]) {
            return;
        }
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
            let mut is_finite = look.is_finite;
            if self.has_detail && is_detailed(self.scene, look, &hit) {
                let (position, normal) =
                    (lit.surfaces.position(i), lit.surfaces.geometric_normal(i));
                let detail = Detail::new(self.scene, &hit, position, normal);
                let material = &self.scene.materials[material];
                (emission, diffuse) = look.with(self.scene, material, &detail);
                is_finite = emission.is_finite() && diffuse.is_finite();
            }
            if !(is_finite && lit.surfaces.position(i).is_finite()) {
                to.spoil(lit.block, i, Cause::Surface);
                continue;
            }
            put(&mut to.radiance[lit.block], i, emission);
            lit.here[i] = diffuse != Vec3::ZERO || specular != Vec3::ZERO;
            put(&mut lit.diffuse, i, diffuse);
            put(&mut lit.specular, i, specular);
            lit.shininess[i] = shininess;
            if specular != Vec3::ZERO {
                lit.shines = true;
                one_exponent &= *exponent.get_or_insert(shininess) == shininess;
            }
            if self.follows && look.is_followed {
                bounces.push((ray as u32, lit.surfaces.surface(i, hit.id)));
            }
        }
        lit.exponent = exponent.filter(|_| one_exponent).and_then(shading::whole);
    }

    /// As `look`, where sixteen rays hit one material without detail that sends nothing on; says
    /// whether they do.
    #[inline(always)]
    fn look_alike(&self, found: &Found, lit: &mut Lit, radiance: &mut Radiance) -> bool {
        let first = lit.surfaces.material[0];
        let mut alike = true;
        for i in 0..LANES {
            let [x, y, z] = lit.surfaces.position(i).to_array();
            alike &= (found.t[i] < f64::INFINITY)
                & (lit.surfaces.material[i] == first)
                & (x + y + z).is_finite();
        }
        let look = match alike {
            true => &self.looks[first.0 as usize],
            false => return false,
        };
        if look.is_followed || !look.is_finite {
            return false;
        }
        let Reflectance { diffuse, specular, shininess } = look.reflectance;
        for axis in 0..3 {
            lit.diffuse[axis] = [diffuse[axis]; LANES];
            lit.specular[axis] = [specular[axis]; LANES];
        }
        lit.here = [diffuse != Vec3::ZERO || specular != Vec3::ZERO; LANES];
        lit.shininess = [shininess; LANES];
        lit.shines = specular != Vec3::ZERO;
        lit.exponent = shading::whole(shininess);
        *radiance = look.emission.to_array().map(|x| [x; LANES]);
        true
    }

    /// The light of one source on the surfaces: what reaches them for certain, and the shadow rays
    /// that ask whether the rest does.
    #[inline(always)]
    fn reach(
        &self,
        light: &crate::scene::Light,
        all: &[Lit],
        wave: &Wave,
        to: &mut Sums<'_>,
        shadow: &mut Shadows,
    ) {
        let (mut arrivals, mut shares) = (Arrivals::default(), Shares::default());
        let tmax = if light.is_bounded() { 1.0 } else { f64::INFINITY };
        for lit in all {
            let found = &wave.hits.found()[lit.block];
            arrivals.set(light, lit);
            shares.set(lit, &arrivals, &wave.rays, found);
            if !shares.any {
                continue;
            }
            let mut bright = [false; LANES];
            let mut with = [[0.0f32; LANES]; 3];
            for axis in 0..3 {
                for i in 0..LANES {
                    with[axis][i] = shares.share[axis][i] * arrivals.intensity[axis][i];
                }
            }
            let (mut odd, mut any) = (false, false);
            for i in 0..LANES {
                let [x, y, z] = [with[0][i], with[1][i], with[2][i]];
                bright[i] = shares.here[i] & ((x != 0.0) | (y != 0.0) | (z != 0.0));
                odd |= shares.here[i] & !(x + y + z).is_finite();
                any |= bright[i];
            }
            if odd {
                mark_odd(&arrivals, &shares, &mut with, &mut bright);
            } else if !any {
                continue;
            }
            if !light.casts_shadow() {
                to.add_all(lit.block, &with, &bright);
                continue;
            }
            let (lines, left) = shadow.rays.push_sixteen();
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
            shadow.waiting.push(Waiting { block: lit.block, with, here: bright });
        }
    }
}

/// Tells apart, among sums that are not finite, what made them so: NaN where the light's arrival is
/// not finite, infinite where the surface's share of it is not. What overflows only in their product
/// is infinite by itself.
#[cold]
fn mark_odd(
    arrivals: &Arrivals,
    shares: &Shares,
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

/// The radiance along the rays of a wave, and which of it is spoilt.
struct Sums<'a> {
    radiance: &'a mut [Radiance],
    spoilt: &'a mut Vec<(u32, Cause)>,
}

impl Sums<'_> {
    /// Adds to the radiance along the rays that are `here`, unless it is spoilt already.
    #[inline(always)]
    fn add_all(&mut self, block: usize, with: &Radiance, here: &Lanes<bool>) {
        let radiance = &mut self.radiance[block];
        let mut sum = *radiance;
        let mut odd = false;
        for axis in 0..3 {
            for i in 0..LANES {
                let more = sum[axis][i] + with[axis][i];
                sum[axis][i] = if here[i] { more } else { sum[axis][i] };
            }
        }
        for i in 0..LANES {
            odd |= here[i] & !(sum[0][i] + sum[1][i] + sum[2][i]).is_finite();
        }
        if !odd {
            *radiance = sum;
            return;
        }
        for i in (0..LANES).filter(|&i| here[i]) {
            self.add(block, i, at(with, i));
        }
    }

    /// Adds to the radiance along one ray, unless it is spoilt already.
    fn add(&mut self, block: usize, i: usize, with: Vec3) {
        let sum = at(&self.radiance[block], i) + with;
        if sum.is_finite() {
            put(&mut self.radiance[block], i, sum);
        } else if with.is_nan() {
            self.spoil(block, i, Cause::Light);
        } else {
            self.spoil(block, i, Cause::Sum);
        }
    }

    /// Makes the radiance along one ray NaN, so that it stays out of the picture, and keeps what
    /// did it first.
    #[cold]
    fn spoil(&mut self, block: usize, i: usize, cause: Cause) {
        if !at(&self.radiance[block], i).is_nan() {
            self.spoilt.push(((block * LANES + i) as u32, cause));
        }
        put(&mut self.radiance[block], i, Vec3::NAN);
    }
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
struct Reach<'a, 'b> {
    integrator: &'a Integrator<'a>,
    light: &'a crate::scene::Light,
    lit: &'a [Lit],
    wave: &'a Wave,
    to: &'a mut Sums<'b>,
    shadow: &'a mut Shadows,
}

impl pulp::WithSimd for Reach<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.integrator.reach(self.light, self.lit, self.wave, self.to, self.shadow);
    }
}

/// Adds what waits on shadow rays that nothing blocks.
struct Settle<'a, 'b> {
    shadow: &'a Shadows,
    to: &'a mut Sums<'b>,
}

impl pulp::WithSimd for Settle<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Shadows { waiting, blocked, .. } = self.shadow;
        for (Waiting { block, with, here }, blocked) in waiting.iter().zip(blocked.chunks(LANES)) {
            let mut open = *here;
            for (open, blocked) in open.iter_mut().zip(blocked) {
                *open &= !blocked;
            }
            self.to.add_all(*block, with, &open);
        }
    }
}

/// The light that arrives at sixteen points.
#[derive(Default)]
#[repr(C, align(64))]
struct Arrivals {
    toward: [Lanes<f64>; 3],
    intensity: [Lanes<f32>; 3],
    /// Where any arrives.
    here: Lanes<bool>,
}

impl Arrivals {
    #[inline(always)]
    fn set(&mut self, light: &crate::scene::Light, lit: &Lit) {
        self.intensity = light.intensity.to_array().map(|x| [x; LANES]);
        self.here = lit.here;
        match light.kind {
            LightKind::Directional { direction } => {
                self.toward = (-direction).to_array().map(|x| [x; LANES]);
            }
            LightKind::Point { position, .. } if light.is_steady() => {
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
                    match light.arrival(lit.surfaces.position(i)) {
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
struct Shares {
    share: [Lanes<f32>; 3],
    /// Those that face the light.
    here: Lanes<bool>,
    /// Whether any does.
    any: bool,
    /// Whether the light is on the side of the geometric normal.
    on_front: Lanes<bool>,
}

impl Shares {
    /// As [`shading::direct`], to the bit.
    #[inline(always)]
    fn set(&mut self, lit: &Lit, arrivals: &Arrivals, rays: &Rays, found: &Found) {
        let surfaces = &lit.surfaces;
        let (mut cosines, mut over, mut mirrored) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        if lit.shines {
            // In one loop, since both ask for the way's length.
            let lines = &rays.lines()[lit.block];
            for i in 0..LANES {
                let (normal, toward) = (surfaces.normal(i), arrivals.toward(i));
                cosines[i] = shading::lambert(normal, toward);
                mirrored[i] = shading::phong(normal, lines.line(i).1, toward);
            }
        } else {
            for i in 0..LANES {
                cosines[i] = shading::lambert(surfaces.normal(i), arrivals.toward(i));
            }
        }
        for i in 0..LANES {
            over[i] = surfaces.geometric_normal(i).dot(arrivals.toward(i));
        }
        self.any = false;
        for i in 0..LANES {
            self.here[i] = arrivals.here[i] & ((cosines[i] > 0.0) | cosines[i].is_nan());
            self.on_front[i] = over[i] > 0.0;
        }
        if surfaces.kinds.triangles {
            for i in 0..LANES {
                // On a smooth-shaded mesh the shading normal may see a light that is behind the
                // surface itself.
                let facing = if surfaces.is_back[i] { -over[i] } else { over[i] };
                self.here[i] &= !((found.id.geometry[i] >= Ids::MESHES) & (facing <= 0.0));
            }
        }
        for i in 0..LANES {
            self.any |= self.here[i];
        }
        if !self.any {
            return;
        }
        for axis in 0..3 {
            for i in 0..LANES {
                self.share[axis][i] = lit.diffuse[axis][i] * cosines[i] as f32;
            }
        }
        if lit.shines {
            lit.add_highlights(mirrored, self);
        }
    }
}

impl Lit {
    #[inline(always)]
    fn add_highlights(&self, mirrored: Lanes<f64>, shares: &mut Shares) {
        let highlight = match self.exponent {
            Some(exponent) => shading::power_of_all(mirrored, exponent),
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
    /// The radiance along ray `i`.
    #[inline(always)]
    pub fn radiance(&self, i: usize) -> Vec3 {
        at(&self.radiance[i / LANES], i % LANES)
    }

    /// Takes the radiance along each of `count` rays as its sample, and counts what spoilt any.
    pub fn take_samples(&mut self, count: usize, samples: &mut Vec<Vec3>, counts: &mut Counts) {
        samples.resize(count, Vec3::ZERO);
        for (samples, radiance) in samples.chunks_mut(LANES).zip(&self.radiance) {
            for (i, sample) in samples.iter_mut().enumerate() {
                *sample = at(radiance, i);
            }
        }
        self.spoilt.drain(..).for_each(|(_, cause)| cause.count(counts));
    }
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
