//! The objects of a scene, as `info` lists them.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use crate::cli::messages;
use crate::load::{Asset, AssetAnimation, LoadReport};
use crate::scene::{Camera, Falloff, Image, Light, LightKind, Projection, Scene};

/// The files that were read.
#[derive(Serialize)]
pub struct Files {
    /// The path of the file that was named.
    path: String,
    /// The bytes of that file.
    pub own_bytes: u64,
    /// The number of files that were read, that one included.
    pub count: u64,
    /// The bytes of all of them.
    pub bytes: u64,
}

/// A glTF file.
#[derive(Serialize)]
pub struct GltfFile {
    file: String,
    version: String,
    pub generator: Option<String>,
    pub copyright: Option<String>,
    pub animations: Vec<GltfAnimation>,
}

/// An animation of a glTF file.
#[derive(Serialize)]
pub struct GltfAnimation {
    pub name: Option<String>,
    /// The time of its last key; null if the file does not declare it.
    pub seconds: Option<f64>,
}

/// An image that textures show.
#[derive(Serialize)]
pub struct ImageSummary {
    /// The path of its file, or its place in the file that contains it.
    pub name: String,
    /// The width and the height in pixels; null if no material in use shows it, so that it was not read.
    pub width: Option<u32>,
    pub height: Option<u32>,
}

/// A light.
#[derive(Serialize)]
pub struct LightSummary {
    pub kind: &'static str,
    name: String,
    /// The colour times the intensity, linear Rec. 709.
    intensity: [f32; 3],
    /// The position; null for a light that has none.
    position: Option<[f64; 3]>,
    /// The direction in which the light travels; null for a light that has none.
    direction: Option<[f64; 3]>,
    /// `none` or `inverse_square`; null for a light without a position.
    falloff: Option<&'static str>,
    /// The distance at which the light has faded to nothing; null if there is none.
    range: Option<f64>,
    /// The half-angles of a spot, in degrees; null for other lights.
    inner_angle: Option<f64>,
    outer_angle: Option<f64>,
    /// The angular diameter of a sun, in degrees; null for a point and for other lights.
    angle: Option<f64>,
    /// The width and height of a rectangle; null for other lights.
    size: Option<[f64; 2]>,
    /// The radius of a disk or a sphere; null for other lights.
    radius: Option<f64>,
    /// The number of samples of a light with an extent; null for other lights.
    samples: Option<u32>,
    casts_shadow: bool,
}

/// A camera.
#[derive(Serialize)]
pub struct CameraSummary {
    name: String,
    position: [f64; 3],
    /// The viewing direction.
    direction: [f64; 3],
    /// The direction to the top of the picture.
    up: [f64; 3],
    /// The key of a scene file that sets the projection: `fov_y`, `fov_x`, `focal_px`, `ortho_height`.
    projection: &'static str,
    /// Its value: degrees, pixels or world units.
    value: f64,
}

impl Files {
    pub fn new(path: &Path, report: &LoadReport) -> Self {
        let &LoadReport { own_bytes, bytes, ref files, .. } = report;
        let count = files.len() as u64;
        Self { path: path.display().to_string(), own_bytes, count, bytes }
    }
}

impl From<&Asset> for GltfFile {
    fn from(asset: &Asset) -> Self {
        let Asset { file, version, generator, copyright, animations } = asset.clone();
        let animations = animations.into_iter();
        Self {
            file: file.display().to_string(),
            version,
            generator,
            copyright,
            animations: animations.map(GltfAnimation::from).collect(),
        }
    }
}

impl From<AssetAnimation> for GltfAnimation {
    fn from(animation: AssetAnimation) -> Self {
        Self { name: animation.name, seconds: animation.seconds }
    }
}

impl GltfFile {
    /// Returns the lines about who made the file, with their keys.
    pub fn origin(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let lines = [("made by", &self.generator), ("copyright", &self.copyright)];
        lines.into_iter().filter_map(|(key, value)| Some((key, value.as_deref()?)))
    }

    /// Returns the names and the lengths of the animations.
    pub fn animations(&self) -> impl Iterator<Item = String> {
        self.animations.iter().enumerate().map(|(i, GltfAnimation { name, seconds })| {
            let name = name.as_ref().map_or(i.to_string(), |name| format!("`{name}`"));
            seconds.map_or(name.clone(), |seconds| format!("{name} ({seconds:.3} s)"))
        })
    }
}

/// Returns the images that the textures of a scene show, each once, in the order of the textures.
pub fn images(scene: &Scene) -> Vec<ImageSummary> {
    let mut known = HashSet::new();
    let images = scene.textures.iter().map(|texture| &texture.image);
    let images = images.filter(|image| known.insert(Arc::as_ptr(image)));
    let size = |image: &Image, side: u32| image.is_read().then_some(side);
    images
        .map(|image| ImageSummary {
            name: image.name.clone(),
            width: size(image, image.width),
            height: size(image, image.height),
        })
        .collect()
}

impl ImageSummary {
    /// The number of pixels; 0 if it was not read.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width.unwrap_or(0)) * u64::from(self.height.unwrap_or(0))
    }
}

impl From<&Light> for LightSummary {
    fn from(light: &Light) -> Self {
        let mut summary = Self {
            kind: "ambient",
            name: light.name.clone(),
            intensity: light.intensity.into(),
            position: None,
            direction: None,
            falloff: None,
            range: None,
            inner_angle: None,
            outer_angle: None,
            angle: None,
            size: None,
            radius: None,
            samples: light.has_extent().then_some(light.samples),
            casts_shadow: light.casts_shadow(),
        };
        match light.kind {
            LightKind::Ambient => {}
            LightKind::Directional { direction, angle } => {
                summary.kind = "directional";
                summary.direction = Some(direction.into());
                summary.angle = (angle != 0.0).then(|| angle.to_degrees());
            }
            LightKind::Point { position, falloff, range } => {
                summary.kind = "point";
                summary.set_position(position.into(), falloff, range);
            }
            LightKind::Spot { position, direction, falloff, range, inner_angle, outer_angle } => {
                summary.kind = "spot";
                summary.set_position(position.into(), falloff, range);
                summary.direction = Some(direction.into());
                summary.inner_angle = Some(inner_angle.to_degrees());
                summary.outer_angle = Some(outer_angle.to_degrees());
            }
            LightKind::Rectangle { center, u, v } => {
                summary.kind = "rectangle";
                summary.position = Some(center.into());
                summary.direction = Some(u.cross(v).normalize().into());
                summary.size = Some([u, v].map(|half| 2.0 * half.length()));
            }
            LightKind::Disk { center, normal, radius } => {
                summary.kind = "disk";
                summary.position = Some(center.into());
                summary.direction = Some(normal.into());
                summary.radius = Some(radius);
            }
            LightKind::Sphere { center, radius } => {
                summary.kind = "sphere";
                summary.position = Some(center.into());
                summary.radius = Some(radius);
            }
        }
        summary
    }
}

impl LightSummary {
    fn set_position(&mut self, position: [f64; 3], falloff: Falloff, range: f64) {
        self.position = Some(position);
        self.falloff = Some(match falloff {
            Falloff::None => "none",
            Falloff::InverseSquare => "inverse_square",
        });
        self.range = range.is_finite().then_some(range);
    }

    /// The kind and the name.
    pub fn label(&self) -> String {
        messages::labelled(self.kind, &self.name)
    }
}

impl From<&Camera> for CameraSummary {
    fn from(camera: &Camera) -> Self {
        let (projection, value) = match camera.projection {
            Projection::FovY(angle) => ("fov_y", angle.to_degrees()),
            Projection::FovX(angle) => ("fov_x", angle.to_degrees()),
            Projection::FocalPx { focal, .. } => ("focal_px", focal),
            Projection::OrthoHeight(height) => ("ortho_height", height),
        };
        Self {
            name: camera.name.clone(),
            position: camera.position.into(),
            direction: camera.forward.into(),
            up: camera.up.into(),
            projection,
            value,
        }
    }
}

impl CameraSummary {
    /// The projection and the name.
    pub fn label(&self) -> String {
        let Self { projection, value, .. } = self;
        let projection = match *projection {
            "fov_y" | "fov_x" => format!("{projection} {value:.4}"),
            _ => format!("{projection} {value}"),
        };
        messages::labelled(&projection, &self.name)
    }
}
