//! What surfaces are made of.

use glam::Vec3;

use crate::scene::{AlphaMode, Channel, Coverage, MetallicRoughnessMaps, ShadingParams, TextureId};

/// The index of a material in `Scene::materials`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);

/// A Lambert and Phong material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name, unique in a scene file; model files may repeat names.
    pub name: String,
    /// Share of light scattered to all sides, linear Rec. 709; without Lambert's 1/π, as in the
    /// tutorial.
    pub diffuse: Vec3,
    /// Colours multiplied with `diffuse`, by the surface's texture coordinates.
    pub diffuse_map: Option<TextureId>,
    /// Share of light in the highlight, linear Rec. 709.
    pub specular: Vec3,
    /// Colours multiplied with `specular`.
    pub specular_map: Option<TextureId>,
    /// The tutorial's α, above 0: the greater, the smaller the highlight.
    pub shininess: f32,
    /// What changes `shininess` from point to point.
    pub shininess_map: Option<ShininessMap>,
    /// Radiance of its own, linear Rec. 709; it lights nothing else.
    pub emission: Vec3,
    /// Colours multiplied with `emission`, by the surface's texture coordinates.
    pub emission_map: Option<TextureId>,
    /// Whether the colours of a mesh's vertices are multiplied with `emission`: what is unlit shows
    /// its colour as radiance.
    pub unlit: bool,
    /// Share of what is seen in it as in a mirror, linear Rec. 709.
    pub reflect: Vec3,
    /// Share of what is seen through it as through glass, linear Rec. 709; of it Fresnel's law
    /// splits off what is reflected. `reflect` and `transmit` are at most 1 together.
    pub transmit: Vec3,
    /// The index of refraction of its inside, relative to empty space, in \[0.01, 100\].
    pub ior: f64,
    /// What is lost in its inside for each unit of length: light falls to e^(−absorption).
    pub absorption: Vec3,
    /// Whether it is a thin sheet with no inside: light goes straight through.
    pub thin: bool,
    /// Which of two things holds where both are: the one with the greater priority; of two equal
    /// ones, the smaller thing.
    pub priority: i32,
    /// Whether a sphere is lit on its inside too. Planes and meshes always are, on the side that
    /// the viewer sees.
    pub double_sided: bool,
    /// A picture of normals that bends the surface's own.
    pub normal_map: Option<NormalMap>,
    /// A picture of how much of the ambient light comes to each point.
    pub occlusion_map: Option<OcclusionMap>,
    /// How much of what lies behind it it covers, if it may be less than all.
    pub coverage: Option<Coverage>,
    /// A metallic-roughness material, whose diffuse, specular, shininess, reflect and transmit stand
    /// in place of the material's own wherever a map or a vertex colour counts.
    pub metallic: Option<Box<MetallicRoughnessMaps>>,
}

/// A picture that changes the shininess.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShininessMap {
    /// It is multiplied with the channel, and at least 1.
    Factor(Channel),
    /// It is that of a surface of roughness 1 − factor · channel.
    Gloss(Channel, f32),
}

/// A picture of normals in tangent space: red, green and blue from 0 to 1 are x, y and z from −1 to
/// 1; x points along u, y up in the picture and z out of the surface, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// The picture; its colours are linear.
    pub texture: TextureId,
    /// What x and y are multiplied with.
    pub scale: f32,
}

/// A picture of how much ambient light comes to each point: 1 + strength · (channel − 1) of it. Other
/// light is not affected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionMap {
    /// The picture's channel.
    pub map: Channel,
    /// How much it counts, in \[0, 1\].
    pub strength: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            diffuse: Vec3::splat(0.8),
            diffuse_map: None,
            specular: Vec3::ZERO,
            specular_map: None,
            shininess: 50.0,
            shininess_map: None,
            emission: Vec3::ZERO,
            emission_map: None,
            unlit: false,
            reflect: Vec3::ZERO,
            transmit: Vec3::ZERO,
            ior: 1.5,
            absorption: Vec3::ZERO,
            thin: false,
            priority: 0,
            double_sided: false,
            normal_map: None,
            occlusion_map: None,
            coverage: None,
            metallic: None,
        }
    }
}

impl Material {
    /// What it does with light where nothing changes it.
    pub fn shading_params(&self) -> ShadingParams {
        let Self { diffuse, specular, shininess, emission, reflect, transmit, .. } = *self;
        ShadingParams { diffuse, specular, shininess, emission, reflect, transmit }
    }

    /// Makes it a metallic-roughness material: a plain one where its base colour is just the
    /// diffuse one.
    pub fn set_metallic_roughness(&mut self, maps: MetallicRoughnessMaps) {
        let ShadingParams { diffuse, specular, shininess, reflect, transmit, .. } =
            maps.factors.shading_params();
        (self.diffuse, self.specular, self.shininess) = (diffuse, specular, shininess);
        (self.reflect, self.transmit) = (reflect, transmit);
        let is_plain = MetallicRoughnessMaps { base: None, ..maps.clone() }
            == MetallicRoughnessMaps::new(maps.factors)
            && maps.factors.metallic == 0.0
            && maps.factors.transmission == 0.0;
        match is_plain {
            true => (self.diffuse_map, self.metallic) = (maps.base, None),
            false => (self.diffuse_map, self.metallic) = (None, Some(Box::new(maps))),
        }
    }

    /// Whether it is a mirror anywhere.
    pub fn may_reflect(&self) -> bool {
        self.reflect != Vec3::ZERO || self.metallic.as_ref().is_some_and(|m| m.may_reflect())
    }

    /// Whether it lets light through anywhere, but for what a mask cuts out.
    pub fn may_transmit(&self) -> bool {
        self.transmit != Vec3::ZERO
            || self.metallic.as_ref().is_some_and(|m| m.may_transmit())
            || self.coverage.is_some_and(|c| c.mode == AlphaMode::Blend)
    }

    /// Whether light goes on from it, off it or through it, anywhere.
    pub fn spawns_rays(&self) -> bool {
        self.may_reflect() || self.may_transmit()
    }

    /// Whether what it covers is a body that light goes through, with an inside.
    pub fn is_dielectric(&self) -> bool {
        self.may_transmit() && !self.thin
    }

    /// Whether light that comes from a medium with index of refraction `ior`, and goes on into one,
    /// may pass as if nothing were there.
    pub fn is_clear_in(&self, ior: f64) -> bool {
        let is_clear = match self.varies() {
            true => self.may_transmit(),
            false => self.transmit == Vec3::ONE && self.emission == Vec3::ZERO,
        };
        is_clear && self.ior == ior
    }

    /// Whether what it lets through differs from point to point.
    fn varies(&self) -> bool {
        self.metallic.is_some() || self.coverage.is_some()
    }

    /// Whether it has holes that rays pass.
    pub fn is_masked(&self) -> bool {
        self.coverage.is_some_and(|c| matches!(c.mode, AlphaMode::Mask { .. }))
    }

    /// Whether shading it needs texture coordinates.
    pub fn is_textured(&self) -> bool {
        self.textures().next().is_some()
    }

    /// Its textures; one stands twice that it uses for two things.
    pub fn textures(&self) -> impl Iterator<Item = TextureId> + use<> {
        let of_channel = |channel: Option<Channel>| channel.map(|c| c.texture);
        let shininess = self.shininess_map.map(|map| match map {
            ShininessMap::Factor(map) | ShininessMap::Gloss(map, _) => map.texture,
        });
        let own = [
            self.diffuse_map,
            self.specular_map,
            shininess,
            self.emission_map,
            self.normal_map.map(|map| map.texture),
            of_channel(self.occlusion_map.map(|o| o.map)),
            of_channel(self.coverage.and_then(|c| c.map)),
        ];
        let metallic = self.metallic.as_deref().map(|m| {
            let channels = [m.metallic, m.roughness, m.specular, m.transmission].map(of_channel);
            let [a, b, c, d] = channels;
            [m.base, m.specular_color, a, b, c, d]
        });
        own.into_iter().chain(metallic.into_iter().flatten()).flatten()
    }

    /// The references to its textures, to be changed.
    pub fn textures_mut(&mut self) -> impl Iterator<Item = &mut TextureId> {
        fn of_channel(channel: &mut Option<Channel>) -> Option<&mut TextureId> {
            channel.as_mut().map(|c| &mut c.texture)
        }
        let shininess = self.shininess_map.as_mut().map(|map| match map {
            ShininessMap::Factor(map) | ShininessMap::Gloss(map, _) => &mut map.texture,
        });
        let own = [
            self.diffuse_map.as_mut(),
            self.specular_map.as_mut(),
            shininess,
            self.emission_map.as_mut(),
            self.normal_map.as_mut().map(|map| &mut map.texture),
            self.occlusion_map.as_mut().map(|o| &mut o.map.texture),
            self.coverage.as_mut().and_then(|c| of_channel(&mut c.map)),
        ];
        let metallic = self.metallic.as_deref_mut().map(|m| {
            [
                m.base.as_mut(),
                m.specular_color.as_mut(),
                of_channel(&mut m.metallic),
                of_channel(&mut m.roughness),
                of_channel(&mut m.specular),
                of_channel(&mut m.transmission),
            ]
        });
        own.into_iter().chain(metallic.into_iter().flatten()).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MetallicRoughness;

    /// A material with a different texture in each place.
    fn full() -> Material {
        let mut next = 0;
        let mut id = || {
            next += 1;
            TextureId(next - 1)
        };
        let mut channel = || Channel { texture: id(), channel: 0 };
        let factors = MetallicRoughness {
            base: Vec3::ONE,
            metallic: 1.0,
            roughness: 1.0,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            ior: 1.5,
        };
        Material {
            diffuse_map: Some(channel().texture),
            specular_map: Some(channel().texture),
            shininess_map: Some(ShininessMap::Factor(channel())),
            emission_map: Some(channel().texture),
            normal_map: Some(NormalMap { texture: channel().texture, scale: 1.0 }),
            occlusion_map: Some(OcclusionMap { map: channel(), strength: 1.0 }),
            coverage: Some(Coverage { alpha: 1.0, map: Some(channel()), mode: AlphaMode::Blend }),
            metallic: Some(Box::new(MetallicRoughnessMaps {
                base: Some(channel().texture),
                specular_color: Some(channel().texture),
                metallic: Some(channel()),
                roughness: Some(channel()),
                specular: Some(channel()),
                transmission: Some(channel()),
                ..MetallicRoughnessMaps::new(factors)
            })),
            ..Material::default()
        }
    }

    #[test]
    fn every_texture_of_a_material_is_listed() {
        let all: Vec<u32> = full().textures().map(|id| id.0).collect();
        assert_eq!(all, (0..13).collect::<Vec<_>>());
    }

    #[test]
    fn every_texture_of_a_material_can_be_changed() {
        let mut material = full();
        material.textures_mut().for_each(|id| id.0 += 100);
        let all: Vec<u32> = material.textures().map(|id| id.0).collect();
        assert_eq!(all, (100..113).collect::<Vec<_>>());
    }
}
