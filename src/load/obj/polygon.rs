//! Polygons into triangles.

use glam::DVec3;

/// Corners of a polygon up to which ears are cut, which takes time with the square of them.
const MAX_EARS: usize = 20_000;

/// The triangles of a polygon, as indices of its corners, wound as it is.
///
/// A convex polygon becomes a fan around its first corner, as everywhere; a concave one has its
/// ears cut, in the plane that fits its corners best.
pub fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let fan = || (2..corners.len()).map(|i| [0, i - 1, i]).collect();
    let finite = corners.iter().all(|c| c.is_finite());
    if corners.len() <= 3 || corners.len() > MAX_EARS || !finite {
        return fan();
    }
    let flat = flatten(corners);
    if is_convex(&flat) {
        return fan();
    }
    let coordinates: Vec<f64> = flat.iter().flatten().copied().collect();
    let ears = earcutr::earcut(&coordinates, &[], 2).unwrap_or_default();
    let wound = |t: &[usize; 3]| {
        let [a, b, c] = *t;
        let point = |i: usize| flat.get(i).copied().unwrap_or_default();
        if cross(point(a), point(b), point(c)) < 0.0 { [a, c, b] } else { [a, b, c] }
    };
    let triangles: Vec<[usize; 3]> = ears.as_chunks().0.iter().map(wound).collect();
    // A polygon that crosses itself or has no area may leave no ear.
    if triangles.is_empty() { fan() } else { triangles }
}

/// The polygon as seen along the axis that its normal is nearest to, turned so that it winds
/// counter-clockwise.
fn flatten(corners: &[DVec3]) -> Vec<[f64; 2]> {
    let next = corners.iter().cycle().skip(1);
    let origin = corners.first().copied().unwrap_or_default();
    // Newell's normal: twice the area of the polygon's shadow along each axis.
    let normal: DVec3 =
        corners.iter().zip(next).map(|(&a, &b)| (a - origin).cross(b - origin)).sum();
    let size = normal.abs();
    let project = |p: &DVec3| {
        let p = *p - origin;
        if size.z >= size.x && size.z >= size.y {
            [p.x * normal.z.signum(), p.y]
        } else if size.y >= size.x {
            [p.z * normal.y.signum(), p.x]
        } else {
            [p.y * normal.x.signum(), p.z]
        }
    };
    corners.iter().map(project).collect()
}

/// Whether a polygon that winds counter-clockwise turns left at every corner, and around once.
fn is_convex(flat: &[[f64; 2]]) -> bool {
    let at = |i: usize| flat.get(i % flat.len()).copied().unwrap_or_default();
    let turns_left = (0..flat.len()).all(|i| cross(at(i), at(i + 1), at(i + 2)) >= 0.0);
    // A pentagram turns left everywhere too: it is told by the fan's triangles.
    turns_left && (2..flat.len()).all(|i| cross(at(0), at(i - 1), at(i)) >= 0.0)
}

/// Twice the signed area of a triangle.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec3], triangles: &[[usize; 3]]) -> DVec3 {
        triangles
            .iter()
            .map(|t| t.map(|i| corners[i]))
            .map(|[a, b, c]| (b - a).cross(c - a) * 0.5)
            .sum()
    }

    #[test]
    fn square_is_a_fan() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        assert_eq!(triangulate(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_polygons_keep_area_and_winding_from_every_side() {
        // An arrowhead whose fan from its first corner would reach outside.
        let flat = [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]];
        let place: [fn([f64; 2]) -> DVec3; 3] = [
            |[a, b]| DVec3::new(a, b, 0.3),
            |[a, b]| DVec3::new(0.3, a, b),
            |[a, b]| DVec3::new(b, 0.3, a),
        ];
        for place in place {
            for rotation in 0..4 {
                for turned in [false, true] {
                    let mut corners = flat.map(place);
                    corners.rotate_left(rotation);
                    if turned {
                        corners.reverse();
                    }
                    let triangles = triangulate(&corners);
                    let whole = area(&corners, &[[0, 1, 2], [0, 2, 3]]);
                    assert!((area(&corners, &triangles) - whole).length() < 1e-12);
                    for t in triangles {
                        assert!(area(&corners, &[t]).dot(whole) > 0.0, "{corners:?}: {t:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn polygon_without_area_does_not_hang() {
        assert_eq!(triangulate(&[DVec3::ZERO; 6]).len(), 4);
    }
}
