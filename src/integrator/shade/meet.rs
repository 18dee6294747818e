//! What the rays of a wave meet, before any light falls on it.

use glam::Vec3;

use crate::geometry::{Hit16, LANES, PrimitiveId16};
use crate::integrator::counts::{FeatureCounts, NotFiniteCause};
use crate::integrator::look::scattered;
use crate::integrator::radiance::{Radiance, put};
use crate::integrator::shade::sums::RadianceSums;
use crate::integrator::shade::{For, LitSurface16, SpecularHit, WaveLighting};
use crate::integrator::{Integrator, Wave};
use crate::shading::{self, Reflectance};
use crate::surface;

/// What the rays meet: background, emission, the surfaces to be lit, mirrors and glass.
pub(super) struct Meet<'a> {
    pub integrator: &'a Integrator<'a>,
    pub wave: &'a Wave,
    pub light: &'a mut WaveLighting,
    pub work: &'a mut FeatureCounts,
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
        light: &mut WaveLighting,
        work: &mut FeatureCounts,
    ) {
        let WaveLighting { radiance, spoilt, bounces, lit: (lit, filled), .. } = light;
        let background = self.scene.film.background;
        radiance.resize(wave.hits.blocks().len(), [[0.0; LANES]; 3]);
        spoilt.clear();
        bounces.clear();
        *filled = 0;
        for (block, found) in wave.hits.blocks().iter().enumerate() {
            if *filled == lit.len() {
                lit.push(LitSurface16::default());
            }
            let lit = &mut lit[*filled];
            lit.surfaces.set::<SMOOTH>(self.scene, &wave.rays, block, found);
            for axis in 0..3 {
                radiance[block][axis] = [background[axis]; LANES];
            }
            if lit.surfaces.kinds.any() {
                lit.block = block;
                if SMOOTH {
                    let is_face = |&&geometry: &&u32| geometry >= PrimitiveId16::MESHES;
                    work.smooth_normals += found.id.geometry.iter().filter(is_face).count() as u64;
                }
                let to = &mut RadianceSums { radiance, spoilt };
                self.look::<DETAILS>(wave, found, lit, to, bounces, work);
                *filled += usize::from(lit.here.contains(&true));
            }
        }
    }

    /// How sixteen surfaces look, before any light falls on them.
    #[inline(always)]
    fn look<const DETAILS: bool>(
        &self,
        wave: &Wave,
        found: &Hit16,
        lit: &mut LitSurface16,
        to: &mut RadianceSums<'_>,
        bounces: &mut Vec<SpecularHit>,
        work: &mut FeatureCounts,
    ) {
        if !DETAILS && self.look_alike(found, lit, &mut to.radiance[lit.block]) {
            return;
        }
        lit.here = [false; LANES];
        lit.shines = false;
        lit.is_bent = false;
        lit.ambient = [1.0; LANES];
        let mut one_exponent = true;
        let mut exponent = None;
        for i in 0..LANES {
            let Some(hit) = found.hit(i) else { continue };
            let ray = lit.block * LANES + i;
            let material = lit.surfaces.material[i].0 as usize;
            let look = &self.looks[material];
            let (mut finish, mut reflectance) = (look.finish, look.reflectance);
            let (mut is_finite, mut is_followed) = (look.is_finite, look.is_followed);
            if DETAILS && self.details.are_asked(look, &hit) {
                let surface = lit.surfaces.surface(i, hit.id);
                let detail = self.detail(wave, ray, &hit, &surface, work);
                self.details.count(look, &hit, work);
                let material = &self.scene.materials[material];
                finish = surface::shading_params(self.scene, material, &detail);
                reflectance = scattered(&finish);
                is_finite = finish.emission.is_finite() && reflectance.diffuse.is_finite();
                is_followed &= finish.spawns_rays() || !material.spawns_rays();
                lit.ambient[i] = surface::occlusion(self.scene, material, &detail);
                if look.has_normals {
                    work.normal_maps += 1;
                    let normal = surface::mapped_normal(self.scene, &surface, &hit, &detail.point);
                    lit.is_bent |= normal != surface.normal;
                    lit.surfaces.set_normal(i, normal);
                }
            }
            let Reflectance { diffuse, specular, shininess } = reflectance;
            if !(is_finite && lit.surfaces.position(i).is_finite()) {
                to.spoil(lit.block, i, NotFiniteCause::Surface);
                continue;
            }
            put(&mut to.radiance[lit.block], i, finish.emission);
            lit.here[i] = diffuse != Vec3::ZERO || specular != Vec3::ZERO;
            put(&mut lit.diffuse, i, diffuse);
            put(&mut lit.specular, i, specular);
            lit.shininess[i] = shininess;
            if look.shines {
                lit.shines = true;
                one_exponent &= *exponent.get_or_insert(shininess) == shininess;
            }
            if is_followed {
                let surface = lit.surfaces.surface(i, hit.id);
                bounces.push(SpecularHit { ray: ray as u32, surface, finish });
            }
        }
        lit.exponent = exponent.filter(|_| one_exponent).and_then(shading::integer_exponent);
    }

    /// As `look`, where sixteen rays hit one material without detail that sends nothing on; says
    /// whether they do.
    #[inline(always)]
    fn look_alike(&self, found: &Hit16, lit: &mut LitSurface16, radiance: &mut Radiance) -> bool {
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
        lit.ambient = [1.0; LANES];
        lit.is_bent = false;
        lit.shines = look.shines;
        lit.exponent = shading::integer_exponent(shininess);
        *radiance = look.finish.emission.to_array().map(|x| [x; LANES]);
        true
    }
}
