//! What makes a scene valid, whoever built it.

use glam::{DVec3, Vec3};

use crate::error::{Error, Result};
use crate::geometry::Bounds;
use crate::scene::{
    Adaptive, AlphaMode, Camera, Lens, LightKind, Material, MaterialId, Mesh, Scene, ShininessMap,
    Texture,
};

/// The largest picture, in pixels: 2²⁸, whose film fills 3 GiB.
pub const MAX_PIXELS: u64 = 1 << 28;
/// The most samples a pixel can have.
pub const MAX_SPP: u32 = 1 << 16;
/// The most surfaces that light can be followed through.
pub const MAX_DEPTH: u32 = 1 << 16;
/// The greatest absolute coordinate in world space; Embree ignores what lies beyond 1.8e18, and
/// f32 products of coordinates must stay finite.
pub const MAX_COORDINATE: f64 = 1e15;

/// By how much shares that add up to 1 may exceed it: 0.7 + 0.3 does in f32.
const SLACK: f32 = 1e-6;

impl Scene {
    /// Checks what the rest of the program takes for granted: numbers are finite and in range,
    /// indices point at something.
    ///
    /// # Errors
    /// The first thing that is not so, with the object's index.
    pub fn check(&self) -> Result<()> {
        check_size(self.film.size)?;
        let Adaptive { max, threshold } = self
            .film
            .adaptive
            .unwrap_or(Adaptive { max: self.film.spp, threshold: Adaptive::THRESHOLD });
        check_samples(self.film.spp, max)?;
        require((0.0..=1.0).contains(&threshold), || {
            format!("the threshold must be from 0 to 1, found {threshold}")
        })?;
        color(|| "the background".to_owned(), self.film.background)?;
        require(self.film.max_depth <= MAX_DEPTH, || {
            format!("max_depth must be at most {MAX_DEPTH}, found {}", self.film.max_depth)
        })?;
        require((0.0..=1.0).contains(&self.film.cutoff), || {
            format!("the cutoff must be from 0 to 1, found {}", self.film.cutoff)
        })?;
        require(self.film.exposure.is_finite(), || {
            format!("the exposure must be finite, found {}", self.film.exposure)
        })?;
        for (i, material) in self.materials.iter().enumerate() {
            let what = format!("material {i} (`{}`)", material.name);
            color(|| format!("{what}: diffuse"), material.diffuse)?;
            color(|| format!("{what}: specular"), material.specular)?;
            color(|| format!("{what}: emission"), material.emission)?;
            require(material.shininess > 0.0 && material.shininess.is_finite(), || {
                format!("{what}: shininess must be above 0, found {}", material.shininess)
            })?;
            color(|| format!("{what}: reflect"), material.reflect)?;
            color(|| format!("{what}: transmit"), material.transmit)?;
            require((material.reflect + material.transmit).max_element() <= 1.0 + SLACK, || {
                format!("{what}: reflect and transmit are more than 1 together")
            })?;
            require((0.01..=100.0).contains(&material.ior), || {
                format!("{what}: ior must be from 0.01 to 100, found {}", material.ior)
            })?;
            color(|| format!("{what}: absorption"), material.absorption)?;
            material
                .textures()
                .try_for_each(|id| index(|| what.clone(), "texture", id.0, self.textures.len()))?;
            check_maps(&what, material)?;
        }
        (0..self.spheres.len()).try_for_each(|i| self.check_sphere(i))?;
        for (i, plane) in self.planes.iter().enumerate() {
            let what = format!("plane {i}");
            position(|| format!("{what}: point"), plane.point)?;
            unit(|| format!("{what}: normal"), plane.normal)?;
            index(|| what.clone(), "material", plane.material.0, self.materials.len())?;
            self.check_unmasked(|| what.clone(), plane.material)?;
            require(plane.texture_size > 0.0 && plane.texture_size.is_finite(), || {
                format!("{what}: texture_size must be above 0, found {}", plane.texture_size)
            })?;
            if let Some(checker) = plane.checker {
                checker.colors.iter().try_for_each(|&c| color(|| format!("{what}: checker"), c))?;
                require(checker.size > 0.0 && checker.size.is_finite(), || {
                    format!("{what}: the checker's size must be above 0, found {}", checker.size)
                })?;
            }
        }
        (0..self.meshes.len()).try_for_each(|i| self.check_mesh(i))?;
        let moved = self.animation.as_ref().map(|a| a.moved_instances(self.instances.len()));
        for i in 0..self.instances.len() {
            // What moves may be flat at one time; it then is not there.
            let may_be_flat = moved.as_ref().is_some_and(|moved| moved[i]);
            self.check_instance(i, may_be_flat)?;
        }
        let mut shown = vec![false; self.textures.len()];
        let maps = self.materials_in_use().flat_map(Material::textures);
        maps.for_each(|map| shown[map.0 as usize] = true);
        let mut textures = self.textures.iter().zip(shown).enumerate();
        textures.try_for_each(|(i, (texture, shown))| check_texture(i, texture, shown))?;
        check_extent(&self.bounds())?;
        self.check_lights_and_cameras()?;
        self.animation.iter().try_for_each(|animation| animation.check(self))
    }

    /// Checks sphere `i`.
    pub(in crate::scene) fn check_sphere(&self, i: usize) -> Result<()> {
        let sphere = &self.spheres[i];
        position(|| format!("sphere {i}: center"), sphere.center)?;
        require(sphere.radius > 0.0 && sphere.radius <= MAX_COORDINATE, || {
            let found = sphere.radius;
            format!("sphere {i}: radius must be above 0 (and at most 1e15), found {found}")
        })?;
        index(|| format!("sphere {i}"), "material", sphere.material.0, self.materials.len())?;
        self.check_unmasked(|| format!("sphere {i}"), sphere.material)
    }

    /// Checks that the material of what is no mesh has no mask.
    fn check_unmasked(&self, what: impl Fn() -> String, material: MaterialId) -> Result<()> {
        require(!self.materials[material.0 as usize].is_masked(), || {
            format!("{}: only meshes can have a mask", what())
        })
        .map_err(|e| e.help("blend its alpha instead"))
    }

    /// Checks mesh `i`.
    pub(in crate::scene) fn check_mesh(&self, i: usize) -> Result<()> {
        check_mesh(i, &self.meshes[i])
    }

    /// Checks instance `i`.
    pub(in crate::scene) fn check_instance(&self, i: usize, may_be_flat: bool) -> Result<()> {
        let instance = &self.instances[i];
        let what = || format!("instance {i}");
        index(what, "mesh", instance.mesh.0, self.meshes.len())?;
        index(what, "material", instance.material.0, self.materials.len())?;
        let is_sound = instance.transform.is_finite() && (may_be_flat || !instance.is_flat());
        require(is_sound, || {
            format!("{}: its transform cannot be inverted (a scale of 0?)", what())
        })
    }

    /// Checks what is cheap to check.
    pub(in crate::scene) fn check_lights_and_cameras(&self) -> Result<()> {
        self.lights.iter().enumerate().try_for_each(|(i, l)| {
            color(|| format!("light {i}: intensity"), l.intensity)?;
            check_light(i, &l.kind)
        })?;
        self.cameras.iter().enumerate().try_for_each(|(i, c)| check_camera(i, c))
    }
}

/// Checks that a scene within these bounds is not too large.
pub(in crate::scene) fn check_extent(bounds: &Bounds) -> Result<()> {
    let extent = bounds.max_abs();
    require(extent <= MAX_COORDINATE, || {
        format!("the scene reaches out to {extent:e}, beyond the {MAX_COORDINATE:e} supported")
    })
}

/// Checks the size of a picture.
///
/// # Errors
/// When a side is 0 or the picture has more than [`MAX_PIXELS`].
pub fn check_size(size: [u32; 2]) -> Result<()> {
    let [width, height] = size.map(u64::from);
    require(width > 0 && height > 0 && width * height <= MAX_PIXELS, || {
        format!("a picture of {width}x{height} pixels cannot be made")
    })
    .map_err(|e| e.help(format!("each side at least 1, and at most {MAX_PIXELS} pixels in all")))
}

/// Checks the fewest and the most samples of a pixel.
///
/// # Errors
/// When there are none or more than [`MAX_SPP`], or the most are fewer than the fewest.
pub fn check_samples(min: u32, max: u32) -> Result<()> {
    for spp in [min, max] {
        require((1..=MAX_SPP).contains(&spp), || {
            format!("samples per pixel must be from 1 to {MAX_SPP}, found {spp}")
        })?;
    }
    require(min <= max, || {
        format!("the most samples per pixel, {max}, are fewer than the fewest, {min}")
    })
}

fn check_texture(i: usize, texture: &Texture, shown: bool) -> Result<()> {
    let image = &texture.image;
    if !image.is_read() && image.texels.is_empty() {
        return require(!shown, || {
            format!(
                "texture {i} (`{}`): the picture was not read, and a material in use shows it",
                image.name
            )
        })
        .map_err(|e| e.help("load the scene without skipping `pictures`"));
    }
    let pixels = u64::from(image.width) * u64::from(image.height);
    require(pixels > 0 && pixels == image.texels.len() as u64, || {
        format!(
            "texture {i} (`{}`): {}x{} pixels declared, {} there",
            image.name,
            image.width,
            image.height,
            image.texels.len()
        )
    })?;
    require(texture.set < 2, || {
        format!(
            "texture {i}: there are two sets of texture coordinates, 0 and 1, not {}",
            texture.set
        )
    })?;
    require(texture.transform.is_finite(), || {
        format!("texture {i}: its transform must be finite, found {}", texture.transform)
    })
}

/// Checks what a material says beside its constants.
fn check_maps(what: &str, material: &Material) -> Result<()> {
    let channels = material.coverage.and_then(|c| c.map).into_iter();
    let channels = channels.chain(material.occlusion_map.map(|o| o.map));
    let metallic = material.metallic.as_deref();
    let of_metal = metallic.map(|m| [m.metallic, m.roughness, m.specular, m.transmission]);
    for map in channels.chain(of_metal.into_iter().flatten().flatten()) {
        require(map.channel < 4, || {
            format!("{what}: a picture has channels 0 to 3, not {}", map.channel)
        })?;
    }
    let share = |name: &str, x: f32| {
        require((0.0..=1.0).contains(&x), || {
            format!("{what}: {name} must be from 0 to 1, found {x}")
        })
    };
    if let Some(metallic) = metallic {
        let f = &metallic.factors;
        color(|| format!("{what}: the base colour"), f.base)?;
        color(|| format!("{what}: the specular colour"), f.specular_color)?;
        share("metallic", f.metallic)?;
        share("roughness", f.roughness)?;
        share("the specular factor", f.specular)?;
        share("the transmission", f.transmission)?;
        require(f.ior == 0.0 || (0.01..=100.0).contains(&f.ior), || {
            format!("{what}: the ior of its metal must be 0 or from 0.01 to 100, found {}", f.ior)
        })?;
    }
    if let Some(map) = &material.normal_map {
        require(map.scale.is_finite(), || {
            format!("{what}: the scale of its normal map must be finite, found {}", map.scale)
        })?;
    }
    if let Some(map) = &material.occlusion_map {
        share("the strength of its occlusion map", map.strength)?;
    }
    match material.shininess_map {
        Some(ShininessMap::Gloss(_, factor)) => share("the gloss", factor)?,
        Some(ShininessMap::Factor(_)) | None => {}
    }
    let Some(coverage) = material.coverage else { return Ok(()) };
    share("alpha", coverage.alpha)?;
    let is_plain = material.thin && material.ior == 1.0 && material.transmit == Vec3::ZERO;
    require(coverage.mode != AlphaMode::Blend || is_plain, || {
        format!("{what}: what is blended must be thin, with an ior of 1 and no transmit of its own")
    })
}

fn check_mesh(i: usize, mesh: &Mesh) -> Result<()> {
    let what = format!("mesh {i} (`{}`)", mesh.name);
    let count = mesh.positions.len();
    require(mesh.is_finite(), || format!("{what}: a vertex is not finite"))?;
    require(mesh.has_all_vertices(), || {
        format!("{what}: a triangle names a vertex that is not there ({count} vertices)")
    })?;
    for (name, length) in [
        ("normals", mesh.normals.len()),
        ("uvs", mesh.uvs.len()),
        ("second uvs", mesh.second_uvs.len()),
        ("colors", mesh.colors.len()),
        ("alphas", mesh.alphas.len()),
        ("tangents", mesh.tangents.len()),
    ] {
        require(length == 0 || length == count, || {
            format!("{what}: {length} {name} for {count} vertices")
        })?;
    }
    Ok(())
}

fn check_light(i: usize, kind: &LightKind) -> Result<()> {
    let what = format!("light {i}");
    match *kind {
        LightKind::Ambient => Ok(()),
        LightKind::Directional { direction } => unit(|| format!("{what}: direction"), direction),
        LightKind::Point { position: p, range, .. } => {
            position(|| format!("{what}: position"), p)?;
            require(range > 0.0, || format!("{what}: range must be above 0, found {range}"))
        }
        LightKind::Spot { position: p, direction, range, inner_angle, outer_angle, .. } => {
            position(|| format!("{what}: position"), p)?;
            unit(|| format!("{what}: direction"), direction)?;
            require(range > 0.0, || format!("{what}: range must be above 0, found {range}"))?;
            let right_angle = std::f64::consts::FRAC_PI_2 + 1e-12;
            let ordered = inner_angle >= 0.0 && inner_angle < outer_angle;
            require(ordered && outer_angle <= right_angle, || {
                format!(
                    "{what}: 0 <= inner_angle < outer_angle <= 90 degrees, found {} and {}",
                    inner_angle.to_degrees(),
                    outer_angle.to_degrees()
                )
            })
        }
    }
}

fn check_camera(i: usize, camera: &Camera) -> Result<()> {
    let what = format!("camera {i} (`{}`)", camera.name);
    position(|| format!("{what}: position"), camera.position)?;
    unit(|| format!("{what}: forward"), camera.forward)?;
    unit(|| format!("{what}: right"), camera.right)?;
    unit(|| format!("{what}: up"), camera.up)?;
    let (value, in_range) = match camera.lens {
        Lens::FovY(a) | Lens::FovX(a) => (a.to_degrees(), a > 0.0 && a < std::f64::consts::PI),
        Lens::FocalPx { focal, width } => (focal, focal > 0.0 && focal.is_finite() && width > 0),
        Lens::OrthoHeight(h) => (h, h > 0.0 && h.is_finite()),
    };
    require(in_range, || {
        format!("{what}: its field of view, focal length or height is out of range: {value}")
    })
}

fn require(holds: bool, message: impl FnOnce() -> String) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::input(message())) }
}

fn position(what: impl FnOnce() -> String, p: DVec3) -> Result<()> {
    require(p.is_finite() && p.abs().max_element() <= MAX_COORDINATE, || {
        format!("{}: must be finite and within 1e15 of the origin, found {p}", what())
    })
}

fn unit(what: impl FnOnce() -> String, v: DVec3) -> Result<()> {
    require((v.length() - 1.0).abs() < 1e-6, || {
        format!("{}: must have length 1, found {v}", what())
    })
}

fn color(what: impl FnOnce() -> String, c: Vec3) -> Result<()> {
    require(c.is_finite() && c.min_element() >= 0.0, || {
        format!("{}: must be finite and not negative, found {c}", what())
    })
}

fn index(what: impl FnOnce() -> String, kind: &str, index: u32, count: usize) -> Result<()> {
    require((index as usize) < count, || {
        format!("{}: there is no {kind} {index}, only {count} of them", what())
    })
}
