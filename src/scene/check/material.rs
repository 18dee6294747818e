//! The validity checks of a material.

use glam::Vec3;

use super::require::{require, require_color, require_index};
use crate::error::Result;
use crate::scene::{AlphaMode, Coverage, Material, MetallicRoughnessMaps, ShininessMap};

/// The tolerance of a sum of shares, which may exceed 1 by rounding, as 0.7 + 0.3 does in f32.
const SUM_TOLERANCE: f32 = 1e-6;

/// Checks material `i` of a scene with `texture_count` textures.
pub(super) fn check(i: usize, material: &Material, texture_count: usize) -> Result<()> {
    let label = format!("material {i} (`{}`)", material.name);
    check_factors(&label, material)?;
    let mut maps = material.textures();
    maps.try_for_each(|id| require_index(|| label.clone(), "texture", id.0, texture_count))?;
    check_channels(&label, material)?;
    material.metallic.iter().try_for_each(|metallic| check_metallic_roughness(&label, metallic))?;
    if let Some(map) = &material.normal_map {
        require(map.scale.is_finite(), || {
            format!("{label}: the scale of its normal map must be finite, found {}", map.scale)
        })?;
    }
    if let Some(map) = &material.occlusion_map {
        require_fraction(&label, "the strength of its occlusion map", map.strength)?;
    }
    if let Some(ShininessMap::Gloss(_, factor)) = material.shininess_map {
        require_fraction(&label, "the gloss", factor)?;
    }
    material.coverage.iter().try_for_each(|coverage| check_coverage(&label, coverage, material))
}

/// Checks the factors: the values that are not textures.
fn check_factors(label: &str, material: &Material) -> Result<()> {
    require_color(|| format!("{label}: diffuse"), material.diffuse)?;
    require_color(|| format!("{label}: specular"), material.specular)?;
    require_color(|| format!("{label}: emission"), material.emission)?;
    require(material.shininess > 0.0 && material.shininess.is_finite(), || {
        format!("{label}: shininess must be above 0, found {}", material.shininess)
    })?;
    require_color(|| format!("{label}: reflect"), material.reflect)?;
    require_color(|| format!("{label}: transmit"), material.transmit)?;
    require((material.reflect + material.transmit).max_element() <= 1.0 + SUM_TOLERANCE, || {
        format!("{label}: reflect and transmit are more than 1 together")
    })?;
    require((0.01..=100.0).contains(&material.ior), || {
        format!("{label}: ior must be from 0.01 to 100, found {}", material.ior)
    })?;
    require_color(|| format!("{label}: absorption"), material.absorption)
}

/// Checks that the channel of every single-channel map is from 0 to 3.
fn check_channels(label: &str, material: &Material) -> Result<()> {
    let channels = material.coverage.and_then(|c| c.map).into_iter();
    let channels = channels.chain(material.occlusion_map.map(|o| o.map));
    let metallic = material.metallic.as_deref();
    let mut maps = channels.chain(metallic.into_iter().flat_map(MetallicRoughnessMaps::channels));
    maps.try_for_each(|map| {
        require(map.channel < 4, || {
            format!("{label}: a picture has channels 0 to 3, not {}", map.channel)
        })
    })
}

/// Checks the factors of a metallic-roughness material.
fn check_metallic_roughness(label: &str, metallic: &MetallicRoughnessMaps) -> Result<()> {
    let f = &metallic.factors;
    require_color(|| format!("{label}: the base colour"), f.base_color)?;
    require_color(|| format!("{label}: the specular colour"), f.specular_color)?;
    require_fraction(label, "metallic", f.metallic)?;
    require_fraction(label, "roughness", f.roughness)?;
    require_fraction(label, "the specular factor", f.specular)?;
    require_fraction(label, "the transmission", f.transmission)?;
    require_fraction(label, "the clearcoat", f.clearcoat)?;
    require_fraction(label, "the clearcoat's roughness", f.clearcoat_roughness)?;
    require_color(|| format!("{label}: the sheen's colour"), f.sheen_color)?;
    require_fraction(label, "the sheen's roughness", f.sheen_roughness)?;
    require_fraction(label, "the anisotropy", f.anisotropy)?;
    require_fraction(label, "the iridescence", f.iridescence)?;
    require_fraction(label, "the diffuse transmission", f.diffuse_transmission)?;
    let color = f.diffuse_transmission_color;
    require_color(|| format!("{label}: the colour of the diffuse transmission"), color)?;
    let minimum = metallic.iridescence_thickness_minimum;
    let film = [f.iridescence_ior, f.iridescence_thickness, minimum, f.dispersion];
    require(film.iter().all(|x| x.is_finite() && *x >= 0.0), || {
        format!("{label}: its thin film and its dispersion must be finite and at least 0")
    })?;
    require(f.anisotropy_rotation.is_finite(), || {
        format!("{label}: the rotation of its anisotropy must be finite")
    })?;
    require(f.ior == 0.0 || (0.01..=100.0).contains(&f.ior), || {
        format!("{label}: the ior of its metal must be 0 or from 0.01 to 100, found {}", f.ior)
    })
}

/// Checks the alpha coverage.
fn check_coverage(label: &str, coverage: &Coverage, material: &Material) -> Result<()> {
    require_fraction(label, "alpha", coverage.alpha)?;
    let is_plain = material.thin && material.ior == 1.0 && material.transmit == Vec3::ZERO;
    require(coverage.mode != AlphaMode::Blend || is_plain, || {
        format!(
            "{label}: what is blended must be thin, with an ior of 1 and no transmit of its own"
        )
    })
}

/// Requires that `x` is in \[0, 1\].
fn require_fraction(label: &str, name: &str, x: f32) -> Result<()> {
    require((0.0..=1.0).contains(&x), || format!("{label}: {name} must be from 0 to 1, found {x}"))
}
