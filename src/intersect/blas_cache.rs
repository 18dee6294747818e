//! What was built of meshes, kept from one frame of an animation to the next.

use std::sync::Arc;

#[cfg(feature = "embree")]
use rayon::prelude::*;

#[cfg(feature = "embree")]
use crate::error::Result;
use crate::scene::{Mesh, Scene};

/// What was built of meshes, by their index; the mesh itself is kept with it, to tell it from
/// another one in its place.
pub(in crate::intersect) struct BlasCache<T> {
    of: Vec<Option<(Arc<Mesh>, Arc<T>)>>,
    built: u64,
}

impl<T> Default for BlasCache<T> {
    fn default() -> Self {
        Self { of: Vec::new(), built: 0 }
    }
}

impl<T> BlasCache<T> {
    /// What was built of a mesh, if it was.
    pub fn get(&self, index: usize, mesh: &Arc<Mesh>) -> Option<Arc<T>> {
        let (of, built) = self.of.get(index)?.as_ref()?;
        Arc::ptr_eq(of, mesh).then(|| built.clone())
    }

    /// Keeps what was built of a mesh, unless it is what is kept already.
    pub fn keep(&mut self, index: usize, mesh: &Arc<Mesh>, built: &Arc<T>) {
        if self.of.len() <= index {
            self.of.resize_with(index + 1, || None);
        }
        if !matches!(&self.of[index], Some((_, kept)) if Arc::ptr_eq(kept, built)) {
            self.of[index] = Some((mesh.clone(), built.clone()));
            self.built += 1;
        }
    }

    /// For each mesh that is `wanted`, what was built of it, or else what `make` builds, several at a
    /// time; that is then kept where there is a place for it.
    ///
    /// # Errors
    /// Those of `make`.
    #[cfg(feature = "embree")]
    pub fn all(
        kept: Option<&mut Self>,
        scene: &Scene,
        wanted: &[bool],
        make: impl Fn(usize) -> Result<T> + Sync,
    ) -> Result<Vec<Option<Arc<T>>>>
    where
        T: Send + Sync,
    {
        let there = kept.as_deref();
        let one = |i: usize| match there.and_then(|kept| kept.get(i, &scene.meshes[i])) {
            _ if !wanted[i] => Ok(None),
            None => make(i).map(|made| Some(Arc::new(made))),
            found => Ok(found),
        };
        let all: Vec<_> = (0..wanted.len()).into_par_iter().map(one).collect::<Result<_>>()?;
        if let Some(kept) = kept {
            for (i, (built, mesh)) in all.iter().zip(&scene.meshes).enumerate() {
                built.iter().for_each(|built| kept.keep(i, mesh, built));
            }
        }
        Ok(all)
    }

    /// Counts a mesh that was built and cannot be kept.
    #[cfg(feature = "embree")]
    pub fn count_one(&mut self) {
        self.built += 1;
    }

    /// How many were built.
    pub fn built(&self) -> u64 {
        self.built
    }
}

/// Whether each mesh stands anywhere, with any triangles.
pub(in crate::intersect) fn meshes_in_use(scene: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.meshes.len()];
    for instance in &scene.instances {
        let mesh = instance.mesh.0 as usize;
        used[mesh] = !scene.meshes[mesh].triangles.is_empty();
    }
    used
}
