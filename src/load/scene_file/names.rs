//! The names of objects, by which they are moved and looked at.

use std::collections::HashMap;

use glam::DVec3;

use super::source::{Source, Span};
use super::spanned::At;
use super::tables::{Kind, SceneTable};
use super::values::PointOrName;
use crate::error::Result;
use crate::load::spelling;

/// What kind of object a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum What {
    /// A sphere.
    Sphere,
    /// A model.
    Model,
    /// A light of this kind.
    Light(Kind),
    /// A camera.
    Camera,
}

impl What {
    /// What it is called in messages.
    pub fn name(self) -> &'static str {
        match self {
            What::Sphere => "a sphere",
            What::Model => "a model",
            What::Light(Kind::Point) => "a point light",
            What::Light(Kind::Directional) => "a directional light",
            What::Light(Kind::Spot) => "a spot light",
            What::Light(Kind::Ambient) => "an ambient light",
            What::Camera => "a camera",
        }
    }
}

/// An object with a name.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Where its name stands.
    pub span: Span,
    /// What it is.
    pub what: What,
    /// Where its own table places it; none for what is nowhere.
    pub position: Option<DVec3>,
}

/// All objects with names, in the file's order of kinds.
#[derive(Debug, Default)]
pub struct Names {
    /// The objects.
    pub objects: Vec<Object>,
    by_name: HashMap<String, usize>,
}

impl Names {
    /// The names in a file.
    ///
    /// # Errors
    /// When two objects have the same.
    pub fn of(source: &Source<'_>, tables: &SceneTable) -> Result<Self> {
        let mut names = Self::default();
        for table in tables.camera.0.iter().map(|t| &t.value.0) {
            names.add(source, &table.name, What::Camera, Some(table.position.0))?;
        }
        for table in tables.sphere.0.iter().map(|t| &t.value.0) {
            names.add(source, &table.name, What::Sphere, Some(table.center.0))?;
        }
        for table in tables.model.0.iter().map(|t| &t.value.0) {
            let position = table.translate.map_or(DVec3::ZERO, |t| t.0);
            names.add(source, &table.name, What::Model, Some(position))?;
        }
        for table in tables.light.0.iter().map(|t| &t.value.0) {
            let position = table.position.as_ref().map(|p| p.value.0);
            names.add(source, &table.name, What::Light(table.kind.value), position)?;
        }
        Ok(names)
    }

    fn add(
        &mut self,
        source: &Source<'_>,
        name: &Option<At<String>>,
        what: What,
        position: Option<DVec3>,
    ) -> Result<()> {
        let Some(At { span, value: name }) = name else { return Ok(()) };
        if let Some(&first) = self.by_name.get(name) {
            let first = &self.objects[first];
            let message = format!("there is {} `{name}` already", first.what.name());
            let line = source.line(&first.span);
            let help = format!("it is in line {line}; give each a name of its own");
            return Err(source.error(span, message).help(help));
        }
        self.by_name.insert(name.clone(), self.objects.len());
        let (name, span) = (name.clone(), span.clone());
        self.objects.push(Object { name, span, what, position });
        Ok(())
    }

    /// The index of the object with a name that is written at `span`.
    ///
    /// # Errors
    /// When there is none; the message says which there are.
    pub fn find(&self, source: &Source<'_>, name: &str, span: &Span) -> Result<usize> {
        self.by_name.get(name).copied().ok_or_else(|| {
            let error = source.error(span, format!("there is no object `{name}`"));
            let names: Vec<&str> = self.objects.iter().map(|o| &*o.name).collect();
            error.help(match &names[..] {
                [] => "give a sphere, a model, a light or a camera this `name`".to_owned(),
                names => spelling::advice(name, names, "the objects with names are"),
            })
        })
    }

    /// The index of the object that a key names as a place, if it names one, and the place at
    /// which the tables put it.
    ///
    /// # Errors
    /// When there is no such object, or it has no place.
    pub fn spot(
        &self,
        source: &Source<'_>,
        spot: &At<PointOrName>,
    ) -> Result<(Option<usize>, DVec3)> {
        let name = match &spot.value {
            PointOrName::Point(point) => return Ok((None, *point)),
            PointOrName::Name(name) => name,
        };
        let found = self.find(source, name, &spot.span)?;
        let object = &self.objects[found];
        match object.position {
            Some(position) => Ok((Some(found), position)),
            None => {
                let message = format!("`{name}` is {}, which is nowhere", object.what.name());
                let help = "name a sphere, a model, a camera, or a point or spot light";
                Err(source.error(&spot.span, message).help(help))
            }
        }
    }
}
