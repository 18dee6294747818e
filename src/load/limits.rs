//! The limits on what a load may read, unpack and build: files from strangers can ask for anything.

use crate::error::{Error, Remedy, Result};

/// A quantity that is limited, over all files of a load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Limit {
    /// The bytes of all files that are read, and those of views that are packed in them
    /// (EXT_meshopt_compression).
    Bytes,
    /// The bytes of memory that the JSON of a glTF file is estimated to take (640 for each object, 128
    /// for each list, 32 for each value), or the TOML of a scene file (128 for each bracket, comma and
    /// other sign, 48 for each space, 8 for all else).
    Json,
    /// The nodes of glTF files.
    Nodes,
    /// The depth of a glTF file's node tree: the nodes one below the other.
    Depth,
    /// The objects of the scene: instances of meshes, and the lights, cameras and animated objects of
    /// models.
    Instances,
    /// The stored vertices.
    Vertices,
    /// The stored triangles.
    Triangles,
    /// The vertices of the copies that nodes have of the meshes that they skin or morph, with each set
    /// of joints and every 16 morph targets that move them; the joints of a skin, for each such copy;
    /// and four for each joint of each skin.
    Deformed,
    /// The elements that a glTF file's accessors give, beyond one for each byte of its buffers: those
    /// without a buffer view, and those that several accessors read from the same bytes. A triangle
    /// that Draco has packed counts as four.
    Elements,
    /// The keys of glTF files' animations, those of all channels together; a channel of weights has
    /// one for each morph target and time.
    Keys,
    /// The decoded images.
    Pictures,
    /// The pixels of all images beyond 16 for each byte of their files, so that only images count that
    /// are much larger than their files; bytes that several images share account for one of them. A pixel of 16-bit numbers counts twice, one
    /// of floats four times.
    Pixels,
}

impl Limit {
    /// The limits, in the order in which messages list them.
    pub const ALL: [Self; 12] = [
        Self::Bytes,
        Self::Json,
        Self::Nodes,
        Self::Depth,
        Self::Instances,
        Self::Vertices,
        Self::Triangles,
        Self::Deformed,
        Self::Elements,
        Self::Keys,
        Self::Pictures,
        Self::Pixels,
    ];

    /// Returns its name in options and messages.
    pub const fn name(self) -> &'static str {
        self.properties().0
    }

    /// Returns its default. With the defaults a small file takes less than 1 GiB of memory, whatever it
    /// asks for.
    pub const fn default(self) -> u64 {
        self.properties().1
    }

    /// Returns its name, its default, and the plural of what is counted, for messages.
    const fn properties(self) -> (&'static str, u64, &'static str) {
        match self {
            Self::Bytes => ("bytes", 1 << 30, "bytes to read"),
            Self::Json => ("json", 1 << 29, "bytes that the JSON or TOML is estimated to take"),
            Self::Nodes => ("nodes", 1 << 20, "nodes"),
            Self::Depth => ("depth", 1 << 12, "nodes one below the other"),
            Self::Instances => ("instances", 1 << 20, "instances"),
            Self::Vertices => ("vertices", 1 << 27, "vertices"),
            Self::Triangles => ("triangles", 1 << 27, "triangles"),
            Self::Deformed => {
                ("deformed", 1 << 22, "vertices of copies that are skinned or morphed, and joints")
            }
            Self::Elements => {
                ("elements", 1 << 25, "elements of accessors beyond the bytes of the buffers")
            }
            Self::Keys => ("keys", 1 << 22, "keys of an animation"),
            Self::Pictures => ("pictures", 1 << 14, "images"),
            Self::Pixels => {
                ("pixels", 1 << 26, "pixels beyond 16 for each byte of the images' files")
            }
        }
    }
}

/// The maximum of each [`Limit`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits([u64; Limit::ALL.len()]);

impl Default for Limits {
    /// Returns [`Limit::default`] of each.
    fn default() -> Self {
        Self(Limit::ALL.map(Limit::default))
    }
}

impl Limits {
    /// Returns the maximum of something.
    pub const fn get(&self, limit: Limit) -> u64 {
        self.0[limit as usize]
    }

    /// Sets the maximum of something.
    #[must_use]
    pub const fn with_limit(mut self, limit: Limit, max: u64) -> Self {
        self.0[limit as usize] = max;
        self
    }

    /// Checks an amount of something against its limit.
    ///
    /// # Errors
    /// When it is more.
    pub fn check(&self, limit: Limit, found: u64) -> Result<()> {
        let max = self.get(limit);
        if found <= max {
            return Ok(());
        }
        let (name, _, noun) = limit.properties();
        Err(Error::input(format!("{found} {noun} are more than the limit of {max}"))
            .help(format!("raise the limit `{name}` to {found} if you trust the file"))
            .remedied_by(Remedy::RaiseLimit { name, least: Some(found) }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_the_most_that_there_may_be() {
        for limit in Limit::ALL {
            let limits = Limits::default().with_limit(limit, 7);
            assert!(limits.check(limit, 7).is_ok());
            let error = limits.check(limit, 8).unwrap_err();
            let remedy = Remedy::RaiseLimit { name: limit.name(), least: Some(8) };
            assert_eq!(error.remedy(), Some(remedy));
            let allows = format!("the limit `{}` to 8 ", limit.name());
            assert!(error.advice().is_some_and(|advice| advice.contains(&allows)), "{error}");
        }
    }

    #[test]
    fn other_limits_stay_as_they_are() {
        let limits = Limits::default().with_limit(Limit::Nodes, 7);
        for limit in Limit::ALL.into_iter().filter(|limit| *limit != Limit::Nodes) {
            assert_eq!(limits.get(limit), limit.default());
        }
    }
}
