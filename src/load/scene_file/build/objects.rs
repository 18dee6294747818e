//! The objects of a scene file that have names, by which they are moved and looked at.

use std::collections::HashMap;

use glam::DVec3;

use crate::error::Result;
use crate::load::scene_file::schema::light_tables::Kind;
use crate::load::scene_file::schema::spanned::Spanned;
use crate::load::scene_file::schema::tables::SceneTable;
use crate::load::scene_file::schema::values::PointOrName;
use crate::load::scene_file::source::{Source, Span};
use crate::load::spelling;

/// The kind of an object with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ObjectKind {
    /// A sphere.
    Sphere,
    /// A model.
    Model,
    /// A light of this kind.
    Light(Kind),
    /// A camera.
    Camera,
}

impl ObjectKind {
    /// Returns the kind's noun with its article, for messages.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Sphere => "a sphere",
            Self::Model => "a model",
            Self::Light(Kind::Point) => "a point light",
            Self::Light(Kind::Directional) => "a directional light",
            Self::Light(Kind::Spot) => "a spot light",
            Self::Light(Kind::Ambient) => "an ambient light",
            Self::Light(Kind::Rectangle) => "a rectangle light",
            Self::Light(Kind::Disk) => "a disk light",
            Self::Light(Kind::Sphere) => "a sphere light",
            Self::Camera => "a camera",
        }
    }
}

/// An object with a name.
#[derive(Clone, Debug)]
pub struct NamedObject {
    /// The name.
    pub name: String,
    /// The span of the name in the text.
    pub span: Span,
    /// The kind of the object.
    pub kind: ObjectKind,
    /// The position that the object's own table gives it; none for a light that has no position.
    pub position: Option<DVec3>,
}

/// The objects that have names, sorted by kind, then in the file's order.
#[derive(Debug, Default)]
pub struct NamedObjects {
    /// The objects.
    pub objects: Vec<NamedObject>,
    by_name: HashMap<String, usize>,
}

/// A point that a key gives by its coordinates or by the name of an object.
#[derive(Clone, Copy)]
pub struct ResolvedPoint {
    /// The index of the object, if it is named.
    pub object: Option<usize>,
    /// The point, or the position of the object in its own table.
    pub position: DVec3,
}

impl NamedObjects {
    /// Collects the names in a file.
    ///
    /// # Errors
    /// When two objects have the same.
    pub fn from_tables(source: &Source<'_>, tables: &SceneTable) -> Result<Self> {
        let cameras = tables.camera.iter();
        let cameras = cameras.map(|t| (&t.name, ObjectKind::Camera, Some(t.position.0)));
        let spheres = tables.sphere.iter();
        let spheres = spheres.map(|t| (&t.name, ObjectKind::Sphere, Some(t.center.0)));
        let models = tables
            .model
            .iter()
            .map(|t| (&t.name, ObjectKind::Model, Some(t.translate.map_or(DVec3::ZERO, |t| t.0))));
        let lights = tables.light.iter().map(|t| {
            let position = t.position.as_ref().map(|p| p.value.0);
            (&t.name, ObjectKind::Light(t.kind.value), position)
        });
        // An object without a name is none of these.
        let mut objects = Self::default();
        for (name, kind, position) in cameras.chain(spheres).chain(models).chain(lights) {
            let Some(Spanned { span, value: name }) = name else { continue };
            if let Some(first) = objects.by_name.insert(name.clone(), objects.objects.len()) {
                let first = &objects.objects[first];
                let message = format!("there is {} `{name}` already", first.kind.noun());
                let line = source.line(&first.span);
                let help = format!("it is in line {line}; give each a name of its own");
                return Err(source.error(span, message).help(help));
            }
            let (name, span) = (name.clone(), span.clone());
            objects.objects.push(NamedObject { name, span, kind, position });
        }
        Ok(objects)
    }

    /// Returns the index of an object by its name.
    ///
    /// # Errors
    /// When there is none of this name; the message says which there are.
    pub fn index(&self, source: &Source<'_>, name: &Spanned<String>) -> Result<usize> {
        let Spanned { span, value: name } = name;
        self.by_name.get(name).copied().ok_or_else(|| {
            let error = source.error(span, format!("there is no object `{name}`"));
            let names: Vec<&str> = self.objects.iter().map(|o| &*o.name).collect();
            error.help(match &names[..] {
                [] => "give a sphere, a model, a light or a camera this `name`".to_owned(),
                names => spelling::advice(name, names, "the objects with names are"),
            })
        })
    }

    /// Resolves a point that may be given by the name of an object.
    ///
    /// # Errors
    /// When there is no such object, or it has no position.
    pub fn resolve(
        &self,
        source: &Source<'_>,
        point: &Spanned<PointOrName>,
    ) -> Result<ResolvedPoint> {
        let Spanned { span, value } = point;
        let name = match value {
            &PointOrName::Point(position) => return Ok(ResolvedPoint { object: None, position }),
            PointOrName::Name(name) => name,
        };
        let index = self.index(source, &Spanned { span: span.clone(), value: name.clone() })?;
        let object = &self.objects[index];
        let Some(position) = object.position else {
            let message = format!("`{name}` is {}, which is nowhere", object.kind.noun());
            let help = "name a sphere, a model, a camera, or a light that has a position";
            return Err(source.error(span, message).help(help));
        };
        Ok(ResolvedPoint { object: Some(index), position })
    }
}
