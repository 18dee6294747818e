//! A binary tree of boxes, and its traversal by a ray.

use glam::DVec3;

use crate::geometry::Bounds;

/// The greatest number of nodes on a path from the root of a tree.
pub const MAX_DEPTH: usize = 96;

/// A binary tree of boxes over numbered items, stored depth first.
#[derive(Default)]
pub struct Tree {
    pub(super) nodes: Vec<Node>,
    /// The item numbers, sorted so that those of a leaf are contiguous.
    pub(super) items: Vec<u32>,
}

/// A box, and the items or nodes in it.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    pub(super) bounds: Bounds,
    /// The first item of a leaf, or the second child of an inner node (the first one is the next
    /// node).
    pub(super) start: u32,
    /// The number of items in a leaf; 0 for an inner node.
    pub(super) count: u32,
}

/// The bound on the error of the slab test, relative to the coordinates.
const SLAB_ERROR: f64 = 64.0 * f64::EPSILON;

/// A ray prepared for the traversal: with reciprocals, and a margin for rounding errors.
pub struct TraversalRay {
    inverse: DVec3,
    origin: DVec3,
    /// The distance by which boxes are widened, apart from the part that depends on the boxes.
    margin: f64,
}

impl TraversalRay {
    /// Makes a ray that may be off by `error` on each axis, anywhere in the box of the tree.
    ///
    /// The slab test below is off by a few ulp of |origin| + |box|: each box is widened by
    /// [`SLAB_ERROR`] times that, and by the ray's own error, so that no box is missed whose
    /// primitive is hit.
    pub fn new(origin: DVec3, direction: DVec3, error: f64) -> Self {
        let margin = error + SLAB_ERROR * origin.abs().max_element();
        Self { inverse: direction.recip(), origin, margin }
    }

    /// The t at which the ray enters the box, if it passes through it at some t in \[0, `limit`\].
    #[inline(always)]
    fn entry_t(&self, bounds: &Bounds, margin: f64, limit: f64) -> Option<f64> {
        let a = (bounds.lower - margin - self.origin) * self.inverse;
        let b = (bounds.upper + margin - self.origin) * self.inverse;
        // A component of direction 0 gives infinities of both signs within the slab and of one
        // outside it; `min` and `max` pass over the NaN of a 0 times infinity on its border.
        let (near, far) = (a.min(b), a.max(b));
        let enter = near.x.max(near.y).max(near.z).max(0.0);
        let leave = far.x.min(far.y).min(far.z).min(limit);
        // The quotients are off by 2 ulp each (Ize, Robust BVH Ray Traversal, 2013).
        (enter <= leave * (1.0 + 8.0 * f64::EPSILON)).then_some(enter)
    }
}

impl Tree {
    /// The box around all items.
    pub fn bounds(&self) -> Bounds {
        self.nodes.first().map_or(Bounds::EMPTY, |root| root.bounds)
    }

    /// Calls `test` with each item whose leaf the ray enters before `limit`, the nearer child
    /// first, until it returns true; returns whether it did. `test` may lower the limit.
    #[inline]
    pub fn traverse(
        &self,
        ray: &TraversalRay,
        limit: &mut f64,
        mut test: impl FnMut(u32, &mut f64) -> bool,
    ) -> bool {
        let Some(root) = self.nodes.first() else { return false };
        let margin = ray.margin + SLAB_ERROR * root.bounds.max_abs();
        let mut stack = [(0u32, 0.0f64); MAX_DEPTH + 1];
        let mut top = 0;
        let mut current = ray.entry_t(&root.bounds, margin, *limit).map(|_| 0u32);
        loop {
            let Some(index) = current else {
                // Take the nearest node that was put off and is not behind the best hit by now.
                current = loop {
                    if top == 0 {
                        return false;
                    }
                    top -= 1;
                    let (index, enter) = stack[top];
                    if enter <= *limit {
                        break Some(index);
                    }
                };
                continue;
            };
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                let items = node.start as usize..(node.start + node.count) as usize;
                for &item in &self.items[items] {
                    if test(item, limit) {
                        return true;
                    }
                }
                current = None;
                continue;
            }
            let (left, right) = (index + 1, node.start);
            let enter =
                |child: u32| ray.entry_t(&self.nodes[child as usize].bounds, margin, *limit);
            current = match (enter(left), enter(right)) {
                (Some(a), Some(b)) => {
                    let (first, second) =
                        if a <= b { (left, (right, b)) } else { (right, (left, a)) };
                    stack[top] = second;
                    top += 1;
                    Some(first)
                }
                (Some(_), None) => Some(left),
                (None, Some(_)) => Some(right),
                (None, None) => None,
            };
        }
    }
}
