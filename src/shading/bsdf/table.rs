//! Tables over evenly spaced parameters, with linear interpolation.

/// A place between two nodes of an axis of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The node before it.
    pub node: usize,
    /// Its distance from there, in \[0, 1\], in units of the distance of nodes.
    pub fraction: f32,
}

impl Place {
    /// The place of a number in \[0, 1\] among `count` nodes.
    pub fn new(x: f64, count: usize) -> Self {
        let x = x.clamp(0.0, 1.0) * (count - 1) as f64;
        let node = (x as usize).min(count - 2);
        Self { node, fraction: (x - node as f64) as f32 }
    }

    /// The same in single precision, of a number that is at least 0.
    #[inline(always)]
    pub fn of(x: f32, count: usize) -> Self {
        let x = x.min(1.0) * (count - 1) as f32;
        let node = (x as usize).min(count - 2);
        Self { node, fraction: x - node as f32 }
    }

    /// Returns the two nodes around the place, with their weights.
    #[inline(always)]
    pub fn ends(self) -> [(usize, f32); 2] {
        [(self.node, 1.0 - self.fraction), (self.node + 1, self.fraction)]
    }
}

/// Returns the number in \[0, 1\] at a node.
pub fn at_node(node: usize, count: usize) -> f64 {
    node as f64 / (count - 1) as f64
}

/// Returns the centres of `count` equal parts of \[0, 1\].
pub fn midpoints(count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| (i as f64 + 0.5) / count as f64)
}
