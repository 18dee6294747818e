//! Light that goes on: off mirrors, into glass and out of it.

use glam::{DVec3, Vec3};

use crate::geometry::{Departure, Hit, HitBatch, LANES, Ray, RayBatch, Side};
use crate::integrator::bodies::{InterfaceMedia, InteriorList};
use crate::integrator::radiance::{DARK, at, put};
use crate::integrator::shade::SpecularHit;
use crate::integrator::{Counts, Integrator, Scratch, Wave};
use crate::intersect::Coherence;
use crate::scene::{Material, Scene, ShadingParams};
use crate::surface::{RayCone, Surface};

/// Where a ray comes from, and what it is worth.
#[derive(Clone, Debug)]
pub(super) struct PathState {
    /// The sample that it adds to.
    pub sample: u32,
    /// How many surfaces sent it on.
    pub depth: u32,
    /// The share that what it brings back has of the sample.
    pub throughput: DVec3,
    /// The bodies that it is in.
    pub inside: InteriorList,
    /// What of a surface it sees, where any picture is averaged.
    pub cone: RayCone,
}

/// A ray that a surface sent on.
#[derive(Clone, Debug)]
pub(super) struct SpawnedRay {
    /// The ray.
    pub ray: Ray,
    /// Whether it went through.
    pub is_refracted: bool,
    /// Its path.
    pub path: PathState,
}

/// The most rays that are traced together; so many more wait at most for each level of depth.
const WAVE: usize = 1 << 14;

/// A share of which even the greatest f32 is less than half of the least one: it changes no sum.
const NOTHING: f64 = 1.0 / (1u128 << 127) as f64 / (1u128 << 127) as f64 / (1u64 << 26) as f64;

impl Integrator<'_> {
    /// Works out the samples of a wave of primary rays that have their hits.
    ///
    /// The rays that surfaces send on form the next wave, in the order in which the surfaces were
    /// met; so that a sample's sum has one order. Where there are too many for one wave, it is cut:
    /// between samples, which do not depend on each other, or, if all are of one sample, in the
    /// middle, whatever else is traced with them.
    pub(super) fn follow(&self, scratch: &mut Scratch, counts: &mut Counts) {
        let Scratch { wave, sample, .. } = scratch;
        if self.may_pass_first {
            wave.paths = (0..wave.rays.len()).map(|i| self.path(wave, i)).collect();
            sample.clear();
            sample.resize(wave.rays.blocks().len(), DARK);
        }
        self.finish(scratch, counts);
        let mut waiting = vec![std::mem::take(&mut scratch.next)];
        while let Some(mut wave) = waiting.pop() {
            if wave.rays.len() > WAVE {
                let second = wave.split_off(middle(&wave.paths));
                waiting.extend([second, wave]);
                continue;
            }
            if wave.rays.is_empty() {
                scratch.next = wave; // Its memory serves the next tile.
                continue;
            }
            self.closest(&wave.rays, Coherence::Incoherent, &mut wave.hits, counts);
            let before = std::mem::replace(&mut scratch.wave, wave);
            scratch.next.clear();
            self.finish(scratch, counts);
            waiting.push(std::mem::replace(&mut scratch.next, before));
        }
    }

    /// Where ray `i` of a wave comes from, and what it is worth.
    pub(super) fn path(&self, wave: &Wave, i: usize) -> PathState {
        if let Some(path) = wave.paths.get(i) {
            return path.clone();
        }
        let inside = match &self.eye {
            Some(inside) => inside.clone(),
            None => {
                let origin = wave.rays.ray(i).origin;
                self.bodies.holding(origin, self.scene, self.intersector)
            }
        };
        let cone = self.cone(&wave.rays.ray(i));
        PathState { sample: i as u32, depth: 0, throughput: DVec3::ONE, inside, cone }
    }

    /// Adds what the rays of a wave bring back to their samples, and sends on what goes on from
    /// there, to `scratch.next`.
    fn finish(&self, scratch: &mut Scratch, counts: &mut Counts) {
        let Scratch { wave, light, sample, next, .. } = scratch;
        if self.may_pass && !wave.paths.is_empty() {
            self.pass_clear(wave, counts);
        }
        self.shade(wave, light, counts);
        if wave.paths.is_empty() {
            light.take_samples(sample, counts);
        }
        for (i, path) in wave.paths.iter().enumerate() {
            let radiance = light.radiance(i);
            let (block, lane) = (path.sample as usize / LANES, path.sample as usize % LANES);
            let so_far = at(&sample[block], lane);
            if !so_far.is_nan() && !radiance.is_nan() {
                let with = (path.throughput * radiance.as_dvec3()).as_vec3();
                put(&mut sample[block], lane, so_far + with);
            }
        }
        for (i, cause) in light.spoilt.drain(..) {
            let spoilt = wave.paths[i as usize].sample as usize;
            let to = &mut sample[spoilt / LANES];
            if !at(to, spoilt % LANES).is_nan() {
                cause.count(counts);
                put(to, spoilt % LANES, Vec3::NAN);
            }
        }
        for bounce in &light.bounces {
            let (i, ray) = (bounce.ray as usize, wave.rays.ray(bounce.ray as usize));
            if let Some(hit) = &wave.hits.get(i) {
                self.send_on(&ray, hit, bounce, &self.path(wave, i), &mut |sent| {
                    let of_kind = match sent.is_refracted {
                        true => &mut counts.rays.refraction,
                        false => &mut counts.rays.reflection,
                    };
                    *of_kind += 1;
                    next.rays.push(&sent.ray);
                    next.paths.push(sent.path);
                });
            }
        }
    }

    /// Takes rays through what is no surface, and off their throughput what is absorbed on their
    /// way. They go on in the same wave, so that nothing tells that something was there.
    fn pass_clear(&self, wave: &mut Wave, counts: &mut Counts) {
        let Wave { rays, hits, paths } = wave;
        let (mut passed, mut ahead, mut found) =
            (Vec::new(), RayBatch::default(), HitBatch::default());
        let mut open: Vec<u32> = (0..rays.len() as u32).collect();
        while !open.is_empty() {
            passed.clear();
            ahead.clear();
            for &i in &open {
                let at = i as usize;
                let (ray, path, hit) = (rays.ray(at), &mut paths[at], hits.get(at));
                let end = hit.map_or(f64::INFINITY, |hit| hit.t);
                path.throughput *= self.absorbed(&ray, end, &path.inside);
                let Some(hit) = &hit else { continue };
                let material = &self.scene.materials[self.scene.material_of(hit.id).0 as usize];
                if !material.may_transmit() {
                    continue;
                }
                let surface = Surface::new(self.scene, &ray, hit);
                let around = self.bodies.around(hit.id, surface.side, &path.inside);
                let finish = self.finish_at(&ray, hit, &surface, &path.cone);
                if self.is_clear(material, &finish, &around) {
                    let beyond = ray.continue_past(hit, surface.side.opposite());
                    rays.set(at, &beyond);
                    path.inside = around.behind;
                    passed.push(i);
                    ahead.push(&beyond);
                }
            }
            self.closest(&ahead, Coherence::Incoherent, &mut found, counts);
            counts.rays.refraction += ahead.len() as u64;
            for (&i, hit) in passed.iter().zip(found.iter()) {
                hits.set(i as usize, hit);
            }
            std::mem::swap(&mut open, &mut passed);
        }
    }

    /// Whether a surface is none: hidden in another body, or clear and with the same index of
    /// refraction on both sides.
    pub(super) fn is_clear(
        &self,
        material: &Material,
        finish: &ShadingParams,
        around: &InterfaceMedia,
    ) -> bool {
        let ior = |inside| self.bodies.medium(inside).ior;
        let behind = if material.thin { material.ior } else { ior(&around.behind) };
        let clear = finish.transmit == Vec3::ONE && finish.emission == Vec3::ZERO;
        around.is_hidden || (clear && ior(&around.before) == behind)
    }

    /// The rays that a surface sends on, which `ray` hit.
    pub(super) fn send_on(
        &self,
        ray: &Ray,
        hit: &Hit,
        bounce: &SpecularHit,
        path: &PathState,
        next: &mut impl FnMut(SpawnedRay),
    ) {
        if path.depth >= self.scene.film.max_depth {
            return;
        }
        let SpecularHit { surface, finish, .. } = bounce;
        let length = hit.t * ray.direction.length();
        let around = self.bodies.around(surface.id, surface.side, &path.inside);
        let scattered = self.scatter(finish, surface, &around, ray.direction.normalize());
        let mut send = |ray: Ray, share: DVec3, is_refracted: bool, inside: InteriorList| {
            let throughput = path.throughput * share;
            if throughput.max_element() > self.scene.film.cutoff.max(NOTHING) {
                let (sample, depth) = (path.sample, path.depth + 1);
                let cone = match ray.continuation {
                    Some(_) => path.cone,
                    None => self.cone_onward(&path.cone, length, surface, is_refracted),
                };
                let path = PathState { sample, depth, throughput, inside, cone };
                next(SpawnedRay { ray, is_refracted, path });
            }
        };
        let spawn = |direction: DVec3, side: Side| Ray {
            departure: Some(Departure { id: surface.id, side }),
            ..Ray::new(surface.position, direction)
        };
        let [back, through] = scattered.shares;
        send(spawn(scattered.reflected, surface.side), back, false, around.before);
        let onward = surface.side.opposite();
        let ray = match scattered.refracted {
            Some(direction) => spawn(direction, onward),
            None => ray.continue_past(hit, onward),
        };
        send(ray, through, true, around.behind);
    }
}

/// Whether anywhere in a scene light may pass a surface as if nothing were there, since the indices
/// of refraction are the same on both sides.
pub(super) fn may_be_clear(scene: &Scene) -> bool {
    let around = || {
        let bodies = scene.materials_in_use().filter(|material| material.is_dielectric());
        std::iter::once(1.0).chain(bodies.map(|material| material.ior))
    };
    scene.materials_in_use().any(|material| {
        // Its own index is among them once, and counts where another one is the same.
        let same = around().filter(|&ior| material.is_clear_in(ior)).count();
        same > usize::from(material.is_dielectric())
    })
}

/// Where to cut a wave: between two samples near its middle, or, if it is all of one, there.
fn middle(paths: &[PathState]) -> usize {
    let sample = |i: usize| paths[i].sample;
    let half = paths.len() / 2;
    let changes = |&i: &usize| sample(i - 1) != sample(i);
    let up = (half..paths.len()).find(changes);
    let down = (1..half).rev().find(changes);
    match (down, up) {
        (Some(down), Some(up)) if half - down < up - half => down,
        (_, Some(up)) => up,
        (Some(down), None) => down,
        (None, None) => half,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(samples: &[u32]) -> Vec<PathState> {
        let path = |&sample: &u32| PathState {
            sample,
            depth: 1,
            throughput: DVec3::ONE,
            inside: InteriorList::default(),
            cone: RayCone::default(),
        };
        samples.iter().map(path).collect()
    }

    #[test]
    fn a_wave_is_cut_between_samples_near_its_middle() {
        assert_eq!(middle(&wave(&[0, 0, 0, 1, 1, 1])), 3);
        assert_eq!(middle(&wave(&[0, 0, 1, 1, 1, 1])), 2);
        assert_eq!(middle(&wave(&[0, 0, 0, 0, 1, 1])), 4);
        assert_eq!(middle(&wave(&[0, 1, 1, 1, 1, 1, 1])), 1);
    }

    #[test]
    fn a_wave_of_one_sample_is_cut_in_its_middle() {
        assert_eq!(middle(&wave(&[7; 5])), 2);
    }

    #[test]
    fn the_least_share_that_counts_is_half_of_what_moves_the_least_f32() {
        assert_eq!(NOTHING, 2f64.powi(-280));
        assert_eq!((NOTHING * f64::from(f32::MAX)) as f32, 0.0);
    }
}
