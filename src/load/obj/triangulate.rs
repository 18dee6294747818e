//! The triangulation of polygons.

use glam::DVec3;

/// The most corners of a polygon whose ears are cut, which takes time with the square of them.
const MAX_EARS: usize = 20_000;

/// The number of corners up to which cutting ears never takes long, whatever the polygon.
const FEW: usize = 100;

/// Returns the triangles of a polygon, as indices of its corners, wound as it is.
///
/// A convex polygon becomes a fan around its first corner, as everywhere; a concave one has its
/// ears cut, as seen along the axis nearest to its normal. A polygon that crosses itself there,
/// as a bent one may, has no right answer and becomes a fan too, so that nothing is lost.
pub fn triangulate(corners: &[DVec3]) -> Vec<[usize; 3]> {
    let fan = || (2..corners.len()).map(|i| [0, i - 1, i]).collect();
    let finite = corners.iter().all(|c| c.is_finite());
    if corners.len() <= 3 || corners.len() > MAX_EARS || !finite {
        return fan();
    }
    // A fan is right for a convex polygon, and one of two for a quadrilateral.
    let flat = project(corners);
    if is_convex(&flat) {
        return fan();
    }
    if let [a, b, c, d] = flat[..] {
        // The other diagonal is all that is left to try.
        let fits = cross(b, c, d) >= 0.0 && cross(b, d, a) >= 0.0;
        return if fits { vec![[1, 2, 3], [1, 3, 0]] } else { fan() };
    }
    if flat.len() > FEW && is_tangled(&flat) {
        return fan();
    }
    // The ears, all wound as the polygon.
    let point = |i: usize| flat.get(i).copied().unwrap_or_default();
    let twice_area = |t: &[usize; 3]| cross(point(t[0]), point(t[1]), point(t[2]));
    let coordinates: Vec<f64> = flat.iter().flatten().copied().collect();
    let mut ears = earcutr::earcut(&coordinates, &[], 2).unwrap_or_default();
    let ears = ears.as_chunks_mut().0;
    for ear in ears.iter_mut().filter(|ear| twice_area(ear) < 0.0) {
        ear.swap(1, 2);
    }
    // They are right if they cover as much as the polygon.
    let fan: Vec<[usize; 3]> = fan();
    let whole: f64 = fan.iter().map(twice_area).sum();
    let cut: f64 = ears.iter().map(twice_area).sum();
    if (cut - whole).abs() <= 1e-9 * whole { ears.to_vec() } else { fan }
}

/// Projects a polygon along the axis that its normal is nearest to, so that it winds
/// counter-clockwise.
fn project(corners: &[DVec3]) -> Vec<[f64; 2]> {
    let next = corners.iter().cycle().skip(1);
    let origin = corners.first().copied().unwrap_or_default();
    // Newell's normal: twice the area of the polygon's shadow along each axis.
    let normal: DVec3 =
        corners.iter().zip(next).map(|(&a, &b)| (a - origin).cross(b - origin)).sum();
    let size = normal.abs();
    let project_corner = |p: &DVec3| {
        let p = *p - origin;
        if size.z >= size.x && size.z >= size.y {
            [p.x * normal.z.signum(), p.y]
        } else if size.y >= size.x {
            [p.z * normal.y.signum(), p.x]
        } else {
            [p.y * normal.x.signum(), p.z]
        }
    };
    corners.iter().map(project_corner).collect()
}

/// True if a polygon that winds counter-clockwise turns left at every corner, and around once.
fn is_convex(flat: &[[f64; 2]]) -> bool {
    let corner = |i: usize| flat.get(i % flat.len()).copied().unwrap_or_default();
    let turns_left = (0..flat.len()).all(|i| cross(corner(i), corner(i + 1), corner(i + 2)) >= 0.0);
    // A pentagram turns left everywhere too: it is told by the fan's triangles.
    turns_left && (2..flat.len()).all(|i| cross(corner(0), corner(i - 1), corner(i)) >= 0.0)
}

/// True if a polygon crosses itself, or comes back to its corners again and again. Ears have no
/// right answer then, and looking for one takes time with the cube of the corners.
fn is_tangled(flat: &[[f64; 2]]) -> bool {
    let mut distinct: Vec<[u64; 2]> = flat.iter().map(|p| p.map(|x| (x + 0.0).to_bits())).collect();
    distinct.sort_unstable();
    distinct.dedup();
    if distinct.len() < flat.len() / 2 {
        return true;
    }
    // Edges in the order of their left ends: only those that overlap can cross.
    let mut edges: Vec<_> =
        flat.iter().copied().zip(flat.iter().copied().cycle().skip(1)).collect();
    let left = |edge: &([f64; 2], [f64; 2])| edge.0[0].min(edge.1[0]);
    edges.sort_unstable_by(|e, f| left(e).total_cmp(&left(f)));
    edges.iter().enumerate().any(|(i, &(a, b))| {
        let overlaps = |edge: &&([f64; 2], [f64; 2])| left(edge) <= a[0].max(b[0]);
        edges.iter().skip(i + 1).take_while(overlaps).any(|&(c, d)| {
            cross(a, b, c) * cross(a, b, d) < 0.0 && cross(c, d, a) * cross(c, d, b) < 0.0
        })
    })
}

/// Returns twice the signed area of a triangle.
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
    fn no_corner_of_a_bent_or_crossing_polygon_is_lost() {
        let bent = [[0.0, 0.0, 0.0], [0.0, 0.7, 0.1], [0.1, 0.05, 0.1], [0.1, 0.8, 0.0]];
        let crossing = [[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.], [-1., 0.5, 0.]];
        assert_eq!(triangulate(&bent.map(DVec3::from)).len(), 2);
        assert_eq!(triangulate(&crossing.map(DVec3::from)).len(), 3);
    }

    #[test]
    fn larger_concave_polygon_keeps_its_area() {
        // A comb of five teeth.
        let mut corners = vec![DVec3::new(10.0, -1.0, 2.0), DVec3::new(0.0, -1.0, 2.0)];
        let tooth = |i: usize| {
            let x = 2.0 * i as f64;
            [[x, 0.0], [x, 3.0], [x + 1.0, 3.0], [x + 1.0, 0.0]]
        };
        corners.extend((0..5).flat_map(tooth).map(|[x, y]| DVec3::new(x, y, 2.0)));
        let triangles = triangulate(&corners);
        let areas: Vec<f64> = triangles.iter().map(|t| area(&corners, &[*t]).z).collect();
        assert!(areas.iter().all(|a| *a <= 0.0), "{areas:?}");
        // The teeth; the bar below reaches to 10 and slopes up to the last tooth's foot at 9.
        assert!((areas.iter().sum::<f64>() + 5.0 * 3.0 + 9.5).abs() < 1e-9, "{areas:?}");
    }

    #[test]
    fn tangled_polygons_do_not_hang() {
        let n = 9_999;
        let star =
            |i: usize| (std::f64::consts::TAU * (i * (n / 2 - 1)) as f64 / n as f64).sin_cos();
        let star: Vec<DVec3> = (0..n).map(star).map(|(y, x)| DVec3::new(x, y, 0.0)).collect();
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        for corners in [star, square.repeat(n / 4)] {
            assert_eq!(triangulate(&corners).len(), corners.len() - 2);
        }
    }

    #[test]
    fn polygon_without_area_does_not_hang() {
        assert_eq!(triangulate(&[DVec3::ZERO; 6]).len(), 4);
    }
}
