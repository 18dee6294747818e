//! The construction of a tree by the binned surface-area heuristic (SAH).
//!
//! Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies* (2007): the centres are
//! sorted into bins along the widest axis, and the split between two bins that costs least is
//! taken. Large halves are built in parallel; the tree is the same on any number of threads.

use glam::DVec3;

use crate::geometry::Bounds;
use crate::intersect::bvh::tree::{MAX_DEPTH, Node, Tree};

/// The number of bins along the split axis.
const BINS: usize = 16;
/// The most items of a leaf, and fewer where a split costs less.
const MAX_LEAF_ITEMS: usize = 8;
/// The most items of a subtree that one thread builds.
const MAX_SERIAL_ITEMS: usize = 4096;
/// The cost of visiting a node, in units of testing an item.
const VISIT_COST: f64 = 1.0;

/// An item of the tree: a box and its number.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    center: DVec3,
    index: u32,
}

/// Builds the tree over boxes numbered from 0.
pub fn build(boxes: &[Bounds]) -> Tree {
    let mut items: Vec<Item> = (0..)
        .zip(boxes)
        .map(|(index, &bounds)| Item { bounds, center: bounds.center(), index })
        .collect();
    let mut nodes = Vec::new();
    if !items.is_empty() {
        nodes = build_subtree(&mut items, 0, 0);
    }
    Tree { nodes, items: items.iter().map(|i| i.index).collect() }
}

/// Builds the nodes over `items`, which begin at `first` in the whole list; the indices of children are
/// relative to the first node that is returned.
fn build_subtree(items: &mut [Item], first: u32, depth: usize) -> Vec<Node> {
    // Make a leaf of a single item, or where splitting costs more.
    let bounds = items.iter().fold(Bounds::EMPTY, |b, i| b.union(i.bounds));
    let leaf = || vec![Node { bounds, start: first, count: items.len() as u32 }];
    if items.len() == 1 {
        return leaf();
    }
    let middle = match best_split(items, &bounds) {
        Split::Leaf => return leaf(),
        // Deeper down nodes are split in the middle, which halves at most 2³² items 32 times.
        Split::At { axis, bin, bins } if depth < MAX_DEPTH / 2 => {
            let middle = partition(items, |i| bins.index(i.center[axis]) < bin);
            if middle == 0 || middle == items.len() { split_at_median(items) } else { middle }
        }
        _ => split_at_median(items),
    };
    // Build both halves.
    let large = items.len() > MAX_SERIAL_ITEMS;
    let (low, high) = items.split_at_mut(middle);
    let after = first + middle as u32;
    let left = |low: &mut [Item]| build_subtree(low, first, depth + 1);
    let right = |high: &mut [Item]| build_subtree(high, after, depth + 1);
    let (left, right) =
        if large { rayon::join(|| left(low), || right(high)) } else { (left(low), right(high)) };
    // Join them behind their parent.
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    let second = 1 + left.len() as u32;
    nodes.push(Node { bounds, start: second, count: 0 });
    for (children, offset) in [(left, 1), (right, second)] {
        nodes.extend(children.into_iter().map(|mut node| {
            if node.count == 0 {
                node.start += offset;
            }
            node
        }));
    }
    nodes
}

/// The best way to split the items of a node.
enum Split {
    /// No split: a leaf costs less.
    Leaf,
    /// At the median of the centres, where no bins tell them apart.
    Middle,
    /// Before a bin of an axis.
    At { axis: usize, bin: usize, bins: Bins },
}

/// Bins of equal width along an axis.
#[derive(Clone, Copy)]
struct Bins {
    lower: f64,
    scale: f64,
}

impl Bins {
    /// The bin of a coordinate.
    fn index(&self, x: f64) -> usize {
        (((x - self.lower) * self.scale) as usize).min(BINS - 1)
    }
}

/// Finds the split that costs least, or a leaf.
fn best_split(items: &[Item], bounds: &Bounds) -> Split {
    let centers = Bounds::from_points(items.iter().map(|i| i.center));
    let size = centers.size();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let bins = Bins { lower: centers.lower[axis], scale: BINS as f64 / size[axis] };
    // All centres in one point, or too close for the reciprocal: no bins to tell them apart.
    if !bins.scale.is_finite() {
        return if items.len() <= MAX_LEAF_ITEMS { Split::Leaf } else { Split::Middle };
    }
    // Sort the items into bins.
    let mut filled = [(Bounds::EMPTY, 0usize); BINS];
    for item in items {
        let (bounds, count) = &mut filled[bins.index(item.center[axis])];
        *bounds = bounds.union(item.bounds);
        *count += 1;
    }
    // Sum up from the right, then from the left, and compare the costs of all splits.
    let mut right = [(0.0, 0usize); BINS];
    let mut sum = (Bounds::EMPTY, 0);
    for i in (1..BINS).rev() {
        sum = (sum.0.union(filled[i].0), sum.1 + filled[i].1);
        right[i] = (sum.0.half_area(), sum.1);
    }
    let mut best = (f64::INFINITY, 0);
    let mut sum = (Bounds::EMPTY, 0);
    for i in 1..BINS {
        sum = (sum.0.union(filled[i - 1].0), sum.1 + filled[i - 1].1);
        let cost = sum.0.half_area() * sum.1 as f64 + right[i].0 * right[i].1 as f64;
        if sum.1 > 0 && right[i].1 > 0 && cost < best.0 {
            best = (cost, i);
        }
    }
    // Compare with the cost of a leaf.
    let area = bounds.half_area();
    if items.len() <= MAX_LEAF_ITEMS && VISIT_COST * area + best.0 >= items.len() as f64 * area {
        return Split::Leaf;
    }
    if best.0.is_finite() { Split::At { axis, bin: best.1, bins } } else { Split::Middle }
}

/// Moves the items for which `low` holds to the front, and returns their number.
fn partition(items: &mut [Item], low: impl Fn(&Item) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..items.len() {
        if low(&items[i]) {
            items.swap(middle, i);
            middle += 1;
        }
    }
    middle
}

/// Splits at the median of the widest axis, and returns the size of the lower half.
fn split_at_median(items: &mut [Item]) -> usize {
    let size = Bounds::from_points(items.iter().map(|i| i.center)).size();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.center[axis].total_cmp(&b.center[axis]).then(a.index.cmp(&b.index))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(nodes: &[Node], index: usize) -> usize {
        let node = &nodes[index];
        if node.count > 0 {
            return 1;
        }
        1 + depth(nodes, index + 1).max(depth(nodes, node.start as usize))
    }

    fn cube(center: DVec3, half: f64) -> Bounds {
        Bounds { lower: center - half, upper: center + half }
    }

    #[test]
    fn every_item_is_in_exactly_one_leaf() {
        let boxes: Vec<Bounds> = (0..5000)
            .map(|i| cube(DVec3::new((i % 17) as f64, (i % 29) as f64, (i % 31) as f64), 0.4))
            .collect();
        let mut items = build(&boxes).items;
        items.sort_unstable();
        assert_eq!(items, (0..5000).collect::<Vec<u32>>());
    }

    #[test]
    fn children_lie_within_their_parents() {
        let boxes: Vec<Bounds> =
            (0..500).map(|i| cube(DVec3::splat((i * i % 97) as f64), 1.0)).collect();
        let tree = build(&boxes);
        for (i, node) in tree.nodes.iter().enumerate().filter(|(_, n)| n.count == 0) {
            for child in [i + 1, node.start as usize] {
                assert_eq!(node.bounds.union(tree.nodes[child].bounds), node.bounds);
            }
        }
    }

    #[test]
    fn depth_is_bounded_when_the_heuristic_peels_off_one_at_a_time() {
        // Boxes that double in size and distance: every split by area cuts off the largest.
        let boxes: Vec<Bounds> = (0..1000)
            .map(|i| cube(DVec3::X * 1.9f64.powi(i - 500), 1.9f64.powi(i - 502)))
            .collect();
        let tree = build(&boxes);
        assert!(depth(&tree.nodes, 0) <= MAX_DEPTH, "{}", depth(&tree.nodes, 0));
    }

    #[test]
    fn equal_boxes_make_a_shallow_tree() {
        let tree = build(&vec![cube(DVec3::ONE, 1.0); 10_000]);
        assert!(depth(&tree.nodes, 0) < 20);
    }
}
