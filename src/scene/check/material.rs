//! The validity checks of a material.

use glam::Vec3;

use super::require::{require, require_color, require_index};
use crate::error::Result;
use crate::scene::{AlphaMode, Coverage, Material, MetallicRoughnessMaps, ShininessMap};

/// The tolerance by which shares that add up to 1 may exceed it, as 0.7 + 0.3 does in f32.
const SLACK: f32 = 1e-6;

/// Checks material `i` of a scene with this many textures.
pub(super) fn check(i: usize, material: &Material, textures: usize) -> Result<()> {
    let what = format!("material {i} (`{}`)", material.name);
    check_constants(&what, material)?;
    let mut maps = material.textures();
    maps.try_for_each(|id| require_index(|| what.clone(), "texture", id.0, textures))?;
    check_channels(&what, material)?;
    material.metallic.iter().try_for_each(|metallic| check_metallic_roughness(&what, metallic))?;
    if let Some(map) = &material.normal_map {
        require(map.scale.is_finite(), || {
            format!("{what}: the scale of its normal map must be finite, found {}", map.scale)
        })?;
    }
    if let Some(map) = &material.occlusion_map {
        require_fraction(&what, "the strength of its occlusion map", map.strength)?;
    }
    if let Some(ShininessMap::Gloss(_, factor)) = material.shininess_map {
        require_fraction(&what, "the gloss", factor)?;
    }
    material.coverage.iter().try_for_each(|coverage| check_coverage(&what, coverage, material))
}

/// Checks the values that are not textures.
fn check_constants(what: &str, material: &Material) -> Result<()> {
    require_color(|| format!("{what}: diffuse"), material.diffuse)?;
    require_color(|| format!("{what}: specular"), material.specular)?;
    require_color(|| format!("{what}: emission"), material.emission)?;
    require(material.shininess > 0.0 && material.shininess.is_finite(), || {
        format!("{what}: shininess must be above 0, found {}", material.shininess)
    })?;
    require_color(|| format!("{what}: reflect"), material.reflect)?;
    require_color(|| format!("{what}: transmit"), material.transmit)?;
    require((material.reflect + material.transmit).max_element() <= 1.0 + SLACK, || {
        format!("{what}: reflect and transmit are more than 1 together")
    })?;
    require((0.01..=100.0).contains(&material.ior), || {
        format!("{what}: ior must be from 0.01 to 100, found {}", material.ior)
    })?;
    require_color(|| format!("{what}: absorption"), material.absorption)
}

/// Checks that every map that is one channel of a texture has a channel of 0 to 3.
fn check_channels(what: &str, material: &Material) -> Result<()> {
    let channels = material.coverage.and_then(|c| c.map).into_iter();
    let channels = channels.chain(material.occlusion_map.map(|o| o.map));
    let metallic = material.metallic.as_deref();
    let metallic = metallic.map(|m| [m.metallic, m.roughness, m.specular, m.transmission]);
    let mut maps = channels.chain(metallic.into_iter().flatten().flatten());
    maps.try_for_each(|map| {
        require(map.channel < 4, || {
            format!("{what}: a picture has channels 0 to 3, not {}", map.channel)
        })
    })
}

/// Checks the factors of a metallic-roughness material.
fn check_metallic_roughness(what: &str, metallic: &MetallicRoughnessMaps) -> Result<()> {
    let f = &metallic.factors;
    require_color(|| format!("{what}: the base colour"), f.base)?;
    require_color(|| format!("{what}: the specular colour"), f.specular_color)?;
    require_fraction(what, "metallic", f.metallic)?;
    require_fraction(what, "roughness", f.roughness)?;
    require_fraction(what, "the specular factor", f.specular)?;
    require_fraction(what, "the transmission", f.transmission)?;
    require(f.ior == 0.0 || (0.01..=100.0).contains(&f.ior), || {
        format!("{what}: the ior of its metal must be 0 or from 0.01 to 100, found {}", f.ior)
    })
}

/// Checks the alpha coverage.
fn check_coverage(what: &str, coverage: &Coverage, material: &Material) -> Result<()> {
    require_fraction(what, "alpha", coverage.alpha)?;
    let is_plain = material.thin && material.ior == 1.0 && material.transmit == Vec3::ZERO;
    require(coverage.mode != AlphaMode::Blend || is_plain, || {
        format!("{what}: what is blended must be thin, with an ior of 1 and no transmit of its own")
    })
}

/// Requires that `x` is in \[0, 1\].
fn require_fraction(what: &str, name: &str, x: f32) -> Result<()> {
    require((0.0..=1.0).contains(&x), || format!("{what}: {name} must be from 0 to 1, found {x}"))
}
