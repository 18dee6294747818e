//! Loading: from a path to a [`Scene`](crate::scene::Scene) and a [`LoadReport`]. The only parsers.
//!
//! A model file (`.gltf`, `.glb`, `.obj`) loads as a scene of its own; a scene file (`.toml`)
//! merges such scenes into another one. What leaves this module is resolved and checked:
//! nothing downstream parses, guesses or repairs.

mod defaults;
mod diagnostics;
mod duplicates;
mod environment;
mod framing;
mod gltf;
mod images;
mod limits;
mod merge;
mod mesh_repair;
mod obj;
mod report;
mod sandbox;
mod scene_file;
mod spelling;
mod uri;

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::{Material, MaterialId, Scene, ShadingModel, watertight};

pub use defaults::ground::add_ground;
pub use environment::EnvironmentSource;
pub use framing::{Framing, UpAxis};
pub use limits::{Limit, Limits};
pub use report::{Asset, AssetAnimation, DropReason, LoadReport, Loaded};
use sandbox::{OpenedFile, Sandbox};
pub use scene_file::schema;

/// The samples per pixel of a bare model file, which has no setting of its own.
const BARE_MODEL_SPP: u32 = 16;

/// The options of a load.
///
/// ```no_run
/// let loaded = envers::LoadOptions::default().size([640, 360]).load("model.glb")?;
/// # Ok::<(), envers::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct LoadOptions {
    /// The size of the picture in pixels, instead of the file's. A camera that is added to frame
    /// the scene depends on it.
    pub size: Option<[u32; 2]>,
    /// The width of the picture in pixels, instead of the file's, where `size` is not set; the height follows
    /// in the file's proportions.
    pub width: Option<u32>,
    /// The camera that frames a bare model. A direction of it comes before the file's own cameras; a scene
    /// file is refused with it.
    pub framing: Framing,
    /// The variant of the materials of a glTF file (`KHR_materials_variants`), instead of the
    /// default materials; in a scene file, for each model that has a variant of this name and
    /// names none itself.
    pub variant: Option<String>,
    /// The environment, instead of the file's own or of the studio that a bare model gets.
    pub environment: Option<EnvironmentSource>,
    /// The shading model of models' materials, instead of the one that their kind has: physically based for
    /// glTF's and for those of an MTL file that give roughness or metalness, else Lambert's and Phong's. In a
    /// scene file, for each model that says nothing itself.
    pub shading: Option<ShadingModel>,
    /// True if files may name others that are neither beside nor below the file that is loaded.
    pub allow_outside: bool,
    /// True if the viewer sees the back faces of one-sided materials, too, as path tracers show glTF
    /// files; see [`Material::cull_back_faces`](crate::scene::Material::cull_back_faces).
    pub double_sided: bool,
    /// True if the load is for ray queries alone: meshes, spheres and planes, as a load without this
    /// option has them, but none of what shades them.
    ///
    /// Every object gets the default material: no material, texture, texture coordinate or vertex
    /// colour is read, no MTL file or image is opened, and it does not matter whether they are there.
    /// Alpha masks are thus missing (a ray hits what a mask would cut out), and no surface is one-sided.
    /// Positions and normals stay, and so do cameras, lights and animations that the files have; none
    /// are added.
    pub geometry_only: bool,
    /// True if the load records which elements of the files primitives come from; see
    /// [`Scene::provenance_of`](crate::scene::Scene::provenance_of).
    pub provenance: bool,
    /// The limits on what the load may read, unpack and build.
    pub limits: Limits,
}

impl LoadOptions {
    /// Sets the size of the picture, in pixels.
    pub fn size(mut self, size: [u32; 2]) -> Self {
        self.size = Some(size);
        self
    }

    /// Sets the width of the picture, in pixels, and the height in the file's proportions.
    pub fn width(mut self, width: u32) -> Self {
        self.width = Some(width);
        self
    }

    /// Sets the camera that frames a bare model.
    pub fn framing(mut self, framing: Framing) -> Self {
        self.framing = framing;
        self
    }

    /// Sets the variant of the materials.
    pub fn variant(mut self, name: impl Into<String>) -> Self {
        self.variant = Some(name.into());
        self
    }

    /// Sets the environment.
    pub fn environment(mut self, environment: EnvironmentSource) -> Self {
        self.environment = Some(environment);
        self
    }

    /// Sets the shading model of models' materials.
    pub fn shading(mut self, shading: ShadingModel) -> Self {
        self.shading = Some(shading);
        self
    }

    /// Allows files to name others anywhere.
    pub fn allow_outside(mut self, allow: bool) -> Self {
        self.allow_outside = allow;
        self
    }

    /// Shows the back faces of one-sided materials.
    pub fn double_sided(mut self, double_sided: bool) -> Self {
        self.double_sided = double_sided;
        self
    }

    /// Loads only what rays hit, without materials and images; see [`LoadOptions::geometry_only`].
    pub fn geometry_only(mut self, geometry_only: bool) -> Self {
        self.geometry_only = geometry_only;
        self
    }

    /// Records which elements of the files primitives come from: up to four bytes for each triangle, and
    /// more for each name and instance.
    pub fn provenance(mut self, provenance: bool) -> Self {
        self.provenance = provenance;
        self
    }

    /// Sets the limits.
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// Loads a scene file or a bare model file, by its extension, as [`load`] does.
    ///
    /// # Errors
    /// The same as for [`load`]; when a file names another one outside, or asks for more than a
    /// limit allows, unless the options say otherwise; when no file has the variant; and when the framing
    /// is not finite, or is asked of a scene file.
    pub fn load(&self, path: impl AsRef<Path>) -> Result<Loaded> {
        // On a thread of the pool, where a parallel loop over little costs nothing: a file can have a
        // million meshes of a triangle.
        let path = path.as_ref();
        rayon::scope(|_| self.load_on_thread(path))
    }

    fn load_on_thread(&self, path: &Path) -> Result<Loaded> {
        let sandbox = Sandbox::new(path, self.allow_outside, self.limits)?;
        // The extension decides between a scene file and a bare model.
        let file = sandbox.open_named(path)?;
        let own_bytes = file.length();
        let is_scene_file = extension(path) == "toml";
        self.framing.check()?;
        if is_scene_file && !self.framing.is_default() {
            let message = "the framing of a bare model does not apply to a scene file";
            return Err(Error::input(message)
                .at(path)
                .help("set `up` and `position` of its [camera], or `rotate` of its [[model]]"));
        }
        let (Loaded { mut scene, mut report }, needs_lights) = if is_scene_file {
            scene_file::load(file, &sandbox, self)?
        } else {
            let variant = self.variant.as_deref();
            let options = ModelOptions {
                animation: None,
                variant,
                needs_images: true,
                geometry_only: self.geometry_only,
                provenance: self.provenance,
                shading: self.shading,
            };
            (model(file, &sandbox, &options)?, true)
        };

        // What the options ask for.
        if let Some(variant) = &self.variant {
            check_variant(variant, &report).map_err(|e| e.at(path))?;
        }
        if let Some(size) = self.size {
            scene.film.size = size;
        } else if let Some(width) = self.width {
            scene.film.size = size_of_width(width, scene.film.size);
        }
        if self.double_sided {
            scene.materials.iter_mut().for_each(|material| material.cull_back_faces = false);
        }
        // What stands at one place again and again would cost every ray that meets it.
        duplicates::remove_duplicates(&mut scene, &mut report);
        // Defaults for what the file leaves out.
        if self.geometry_only {
            share_default_material(&mut scene);
        } else {
            defaults::auto_camera::add_camera(&mut scene, &self.framing).map_err(|e| e.at(path))?;
            let axes = self.framing.axes();
            if let Some(environment) = &self.environment {
                report.warnings.extend(environment.apply(&mut scene, axes, &sandbox)?);
            }
            if !is_scene_file {
                scene.film.spp = BARE_MODEL_SPP;
                defaults::auto_lighting::light_model(&mut scene, axes, self.environment.is_some());
            } else if needs_lights && scene.environment.is_none() {
                defaults::auto_lighting::add_studio(&mut scene, axes);
            }
            defaults::complete(&mut scene);
        }

        // What is handed on is valid.
        scene.check().map_err(|e| e.at(path))?;
        report.own_bytes = own_bytes;
        (report.files, report.bytes) = sandbox.read_files();
        report.warnings.extend(watertight::open_dielectric_warnings(&scene));
        Ok(Loaded { scene, report })
    }
}

/// Gives all objects one default material, in place of those that importers made.
fn share_default_material(scene: &mut Scene) {
    let id = MaterialId(0);
    scene.materials = vec![Material::default()];
    scene.spheres.iter_mut().for_each(|sphere| sphere.material = id);
    scene.planes.iter_mut().for_each(|plane| (plane.material, plane.checker) = (id, None));
    scene.instances.iter_mut().for_each(|instance| instance.material = id);
}

/// Loads a scene file or a bare model file, by its extension.
///
/// A bare model gets a camera that frames it and lights where it has none of its own, a neutral
/// background, and 16 samples per pixel; a scene file with a model gets lights where neither has any.
///
/// ```no_run
/// let scene = envers::load("scene.toml")?.scene;
/// # Ok::<(), envers::Error>(())
/// ```
///
/// # Errors
/// When a file cannot be read, or is not what it should be; the error names file and place.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded> {
    LoadOptions::default().load(path)
}

/// Reads the files of pictures that are compared, within limits on all of them together.
///
/// # Errors
/// When one cannot be read, or they exceed a limit.
#[cfg(feature = "measure")]
pub(crate) fn read_for_comparison<const N: usize>(
    paths: [&Path; N],
    limits: Limits,
) -> Result<[Vec<u8>; N]> {
    let mut files = [const { Vec::new() }; N];
    let Some(first) = paths.first() else { return Ok(files) };
    let sandbox = Sandbox::new(first, true, limits)?;
    for (bytes, path) in files.iter_mut().zip(paths) {
        *bytes = images::decode::read_for_comparison(sandbox.open_named(path)?, &sandbox)?;
    }
    Ok(files)
}

/// The options of loading a model file.
struct ModelOptions<'a> {
    /// The name of the animation; none for the first.
    animation: Option<&'a str>,
    /// The name of the variant of its materials, if it has that; none for the default materials.
    variant: Option<&'a str>,
    /// True if its images are read, rather than only named.
    needs_images: bool,
    /// True if only what rays hit is read, and all of it gets a default material.
    geometry_only: bool,
    /// True if the provenance of its primitives is recorded.
    provenance: bool,
    /// The shading model of its materials; none for that which the kind of material has: physically based
    /// for glTF's and for those of an MTL file that give roughness or metalness, else Lambert's and Phong's.
    shading: Option<ShadingModel>,
}

/// Loads a model file as it is: with its own cameras and lights, or none.
fn model(file: OpenedFile, sandbox: &Sandbox, options: &ModelOptions) -> Result<Loaded> {
    match extension(&file.path).as_str() {
        "gltf" | "glb" | "vrm" => gltf::load(file, sandbox, options),
        "obj" if options.animation.is_some() => Err(Error::input("an OBJ file has no animations")
            .at(&file.path)
            .help("leave `animation` out")),
        "obj" => obj::load(file, sandbox, options),
        other => Err(Error::input(match other {
            "" => "the file has no extension that tells what it is".to_owned(),
            _ => format!("files that end in .{other} are not read"),
        })
        .at(&file.path)
        .help("a scene file ends in .toml, a model in .gltf, .glb or .obj")),
    }
}

/// Returns the size of a picture of this width in the proportions of another size.
fn size_of_width(width: u32, [old_width, old_height]: [u32; 2]) -> [u32; 2] {
    let height = f64::from(width) * f64::from(old_height) / f64::from(old_width);
    [width, height.round().max(1.0) as u32]
}

/// Checks that a file has a variant of this name.
fn check_variant(name: &str, report: &LoadReport) -> Result<()> {
    if report.variants.contains(name) {
        return Ok(());
    }
    let names: Vec<&str> = report.variants.iter().map(String::as_str).collect();
    let help = match &names[..] {
        [] => "no model has variants of its materials: leave it out".to_owned(),
        names => spelling::choice(name, names, "variants"),
    };
    Err(Error::input(format!("there is no variant `{name}`")).help(help))
}

/// Returns the extension in lower case; empty if there is none.
fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}
