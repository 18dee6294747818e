//! The cache of the BLASes that the frames of an animation share.

use std::sync::Arc;

use rayon::prelude::*;

use crate::scene::{Mesh, Scene};

/// The BLASes of meshes, by mesh index; each has its mesh, to tell it from another one with the
/// same index.
pub(in crate::intersect) struct BlasCache<T> {
    entries: Vec<Option<(Arc<Mesh>, Arc<T>)>>,
    built: u64,
}

impl<T> Default for BlasCache<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), built: 0 }
    }
}

impl<T: Send + Sync> BlasCache<T> {
    /// Returns the BLAS of each mesh that is `wanted`, from the cache or else as `build` builds it,
    /// several at a time; the cache, if there is one, then has those, too.
    ///
    /// # Errors
    /// The errors of `build`.
    pub fn get_or_build<E: Send>(
        cache: Option<&mut Self>,
        scene: &Scene,
        wanted: &[bool],
        build: impl Fn(usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<Option<Arc<T>>>, E> {
        let cached = cache.as_deref();
        let get_or_build = |i: usize| match cached.and_then(|c| c.get(i, &scene.meshes[i])) {
            _ if !wanted[i] => Ok(None),
            None => build(i).map(|blas| Some(Arc::new(blas))),
            blas => Ok(blas),
        };
        let all: Vec<_> =
            (0..wanted.len()).into_par_iter().map(get_or_build).collect::<Result<_, E>>()?;
        if let Some(cache) = cache {
            for (i, (blas, mesh)) in all.iter().zip(&scene.meshes).enumerate() {
                blas.iter().for_each(|blas| cache.insert(i, mesh, blas));
            }
        }
        Ok(all)
    }

    fn get(&self, index: usize, mesh: &Arc<Mesh>) -> Option<Arc<T>> {
        let (cached_mesh, blas) = self.entries.get(index)?.as_ref()?;
        Arc::ptr_eq(cached_mesh, mesh).then(|| blas.clone())
    }

    /// Puts a BLAS into the cache, unless it is there.
    fn insert(&mut self, index: usize, mesh: &Arc<Mesh>, blas: &Arc<T>) {
        if self.entries.len() <= index {
            self.entries.resize_with(index + 1, || None);
        }
        if !matches!(&self.entries[index], Some((_, cached)) if Arc::ptr_eq(cached, blas)) {
            self.entries[index] = Some((mesh.clone(), blas.clone()));
            self.built += 1;
        }
    }

    /// Counts a mesh that was built and is not cached.
    #[cfg(feature = "embree")]
    pub fn count_uncached(&mut self) {
        self.built += 1;
    }

    /// The number of meshes that were built.
    pub fn built(&self) -> u64 {
        self.built
    }
}

/// True for each mesh that has instances and triangles.
pub(in crate::intersect) fn meshes_in_use(scene: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.meshes.len()];
    for instance in &scene.instances {
        let mesh = instance.mesh.0 as usize;
        used[mesh] = !scene.meshes[mesh].triangles.is_empty();
    }
    used
}
