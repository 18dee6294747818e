//! What the rays of a wave meet, before any light falls on it.

use glam::Vec3;

use crate::geometry::{Found, Ids, LANES};
use crate::integrator::counts::{Cause, WorkCounts};
use crate::integrator::radiance::{Radiance, put};
use crate::integrator::shade::sums::Sums;
use crate::integrator::shade::{For, Light, Lit};
use crate::integrator::{Integrator, Wave};
use crate::shading::{self, Reflectance};
use crate::surface::{Detail, Surface};

/// What the rays meet: background, emission, the surfaces to be lit, mirrors and glass.
pub(super) struct Meet<'a> {
    pub integrator: &'a Integrator<'a>,
    pub wave: &'a Wave,
    pub light: &'a mut Light,
    pub work: &'a mut WorkCounts,
}

impl<const DETAILS: bool, const SMOOTH: bool> pulp::WithSimd for For<Meet<'_>, DETAILS, SMOOTH> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Meet { integrator, wave, light, work } = self.0;
        integrator.meet::<DETAILS, SMOOTH>(wave, light, work);
    }
}

impl Integrator<'_> {
    #[inline(always)]
    fn meet<const DETAILS: bool, const SMOOTH: bool>(
        &self,
        wave: &Wave,
        light: &mut Light,
        work: &mut WorkCounts,
    ) {
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
            lit.surfaces.set::<SMOOTH>(self.scene, &wave.rays, block, found);
            for axis in 0..3 {
                radiance[block][axis] = [background[axis]; LANES];
            }
            if lit.surfaces.kinds.any() {
                lit.block = block;
                if SMOOTH {
                    let is_face = |&&geometry: &&u32| geometry >= Ids::MESHES;
                    work.smooth_normals += found.id.geometry.iter().filter(is_face).count() as u64;
                }
                let to = &mut Sums { radiance, spoilt };
                self.look::<DETAILS>(found, lit, to, bounces, work);
                *filled += usize::from(lit.here.contains(&true));
            }
        }
    }

    /// How sixteen surfaces look, before any light falls on them.
    #[inline(always)]
    fn look<const DETAILS: bool>(
        &self,
        found: &Found,
        lit: &mut Lit,
        to: &mut Sums<'_>,
        bounces: &mut Vec<(u32, Surface)>,
        work: &mut WorkCounts,
    ) {
        if !DETAILS && self.look_alike(found, lit, &mut to.radiance[lit.block]) {
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
            if DETAILS && self.details.are_asked(look, &hit) {
                let (position, normal) =
                    (lit.surfaces.position(i), lit.surfaces.geometric_normal(i));
                let detail = Detail::new(self.scene, &hit, position, normal, look.is_textured);
                self.details.count(look, &hit, work);
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
            if look.shines {
                lit.shines = true;
                one_exponent &= *exponent.get_or_insert(shininess) == shininess;
            }
            if look.is_followed {
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
        lit.shines = look.shines;
        lit.exponent = shading::whole(shininess);
        *radiance = look.emission.to_array().map(|x| [x; LANES]);
        true
    }
}
