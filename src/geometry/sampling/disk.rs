//! Uniform points of a disk.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;

use super::tangents;

/// A point of the unit disk, uniform in area for `u` uniform in the unit square: squares about the
/// centre become circles (Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, Journal of
/// Graphics Tools 2(3), 1997).
pub fn concentric_disk(u: [f64; 2]) -> [f64; 2] {
    let [x, y] = u.map(|u| 2.0 * u - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0; 2];
    }
    let (radius, angle) = if x.abs() > y.abs() {
        (x, FRAC_PI_4 * (y / x))
    } else {
        (y, FRAC_PI_2 - FRAC_PI_4 * (x / y))
    };
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}

/// A point of the disk with this centre, unit normal and radius, uniform in area.
pub fn disk_point(center: DVec3, normal: DVec3, radius: f64, u: [f64; 2]) -> DVec3 {
    let ([a, b], [x, y]) = (tangents(normal), concentric_disk(u));
    center + (a * x + b * y) * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_uniform_in_area() {
        // Of a grid of points, the share within each radius is the square of that radius.
        let n = 200;
        let points: Vec<f64> = (0..n * n)
            .map(|i| [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n)))
            .map(|u| {
                let [x, y] = concentric_disk(u);
                x.hypot(y)
            })
            .collect();
        assert!(points.iter().all(|&r| r < 1.0));
        for radius in [0.1, 0.5, 0.9] {
            let within = points.iter().filter(|&&r| r < radius).count() as f64;
            let share = within / f64::from(n * n);
            assert!((share - radius * radius).abs() < 0.01, "{radius}: {share}");
        }
        assert_eq!(concentric_disk([0.5, 0.5]), [0.0, 0.0]);
    }
}
