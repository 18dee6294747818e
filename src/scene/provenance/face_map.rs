//! The faces of a file that the triangles of a mesh come from.

/// The number in its file of the face that each triangle of a mesh comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum FaceMap {
    /// No numbers were recorded.
    #[default]
    Unrecorded,
    /// The triangles are faces, one after the other from this number on.
    Consecutive(u32),
    /// The number for each triangle.
    Listed(Vec<u32>),
}

impl FaceMap {
    /// Returns the map of triangles to faces of these numbers, in the order of the triangles.
    pub fn from_numbers(numbers: Vec<u32>) -> Self {
        let first = numbers.first().copied().unwrap_or(0);
        let is_consecutive = (first..).zip(&numbers).all(|(expected, &found)| expected == found);
        if is_consecutive { Self::Consecutive(first) } else { Self::Listed(numbers) }
    }

    /// Returns the number of the face that a triangle comes from.
    pub fn face(&self, triangle: u32) -> Option<u32> {
        match self {
            Self::Unrecorded => None,
            Self::Consecutive(first) => first.checked_add(triangle),
            Self::Listed(numbers) => numbers.get(triangle as usize).copied(),
        }
    }

    /// Retains some of the triangles, by whether each `is_kept`.
    pub fn retain(&mut self, is_kept: impl Iterator<Item = bool>) {
        let kept = |(triangle, is_kept): (u32, bool)| is_kept.then_some(triangle);
        match self {
            Self::Unrecorded => {}
            _ => {
                let kept = (0..).zip(is_kept).filter_map(kept);
                *self = Self::from_numbers(kept.filter_map(|t| self.face(t)).collect());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_in_a_row_are_not_listed() {
        assert_eq!(FaceMap::from_numbers(vec![7, 8, 9]), FaceMap::Consecutive(7));
        assert_eq!(FaceMap::from_numbers(vec![7, 7, 8]), FaceMap::Listed(vec![7, 7, 8]));
    }

    #[test]
    fn triangles_that_stay_keep_their_faces() {
        let mut map = FaceMap::Consecutive(5);
        map.retain([true, false, true, true].into_iter());
        assert_eq!(map, FaceMap::Listed(vec![5, 7, 8]));
        map.retain([false, true, true].into_iter());
        assert_eq!(map, FaceMap::Consecutive(7));
        assert_eq!([0, 1].map(|triangle| map.face(triangle)), [Some(7), Some(8)]);
    }

    #[test]
    fn what_is_not_recorded_stays_so() {
        let mut map = FaceMap::Unrecorded;
        map.retain(std::iter::from_fn(|| unreachable!()));
        assert_eq!(map.face(0), None);
    }
}
