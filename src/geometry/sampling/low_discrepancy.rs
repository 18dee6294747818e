//! Points that are spread evenly over the unit square, in an order of which every part is even, too.

/// Point `index` of Sobol's (0, 2)-sequence: of each 2ᵏ points that follow one another from a multiple of
/// 2ᵏ, one is in each of the 2ᵏ equal boxes of any division of the square into halves (Sobol', *On the
/// distribution of points in a cube*, 1967; Kollig and Keller, *Efficient Multidimensional Sampling*,
/// Eurographics 2002).
///
/// The first `count` points, a power of two, are multiples of 1/count. They are moved by half of that,
/// around the square, so that their mean is its middle; and every other digit of the second coordinate is
/// turned over, since the first points of the plain sequence lie along a diagonal.
pub fn sobol_point(index: u32, count: u32) -> [f64; 2] {
    let (mut second, mut column, mut rest) = (0u32, 1u32 << 31, index);
    while rest != 0 {
        if rest & 1 != 0 {
            second ^= column;
        }
        column ^= column >> 1;
        rest >>= 1;
    }
    let offset = 0.5 / f64::from(count);
    let digits = count.next_power_of_two().trailing_zeros();
    second ^= 0x5555_5555 & !u32::MAX.checked_shr(digits).unwrap_or(0);
    [index.reverse_bits(), second].map(|bits| {
        let x = f64::from(bits) / 4_294_967_296.0 + offset;
        if x < 1.0 { x } else { x - 1.0 }
    })
}

/// The weights of the second and third vertex of a triangle at a point that is uniform in area for `u`
/// uniform in the unit square (Heitz, *A Low-Distortion Map Between Triangle and Square*, 2019).
pub fn triangle_weights([x, y]: [f64; 2]) -> [f64; 2] {
    if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_aligned_block_has_one_point_in_every_box() {
        let count = 256;
        for block in [4u32, 16, 64, 256] {
            for first in (0..count).step_by(block as usize) {
                for columns in (0..=block.ilog2()).map(|bits| 1u32 << bits) {
                    let rows = block / columns;
                    let mut boxes = vec![0; block as usize];
                    for i in first..first + block {
                        let [x, y] = sobol_point(i, count);
                        let cell = |x: f64, n: u32| (x * f64::from(n)) as usize;
                        boxes[cell(y, rows) * columns as usize + cell(x, columns)] += 1;
                    }
                    assert!(boxes.iter().all(|&n| n == 1), "{block} {first} {columns}");
                }
            }
        }
    }

    #[test]
    fn the_mean_of_a_whole_set_is_the_middle() {
        for count in [1, 2, 16, 64] {
            for axis in 0..2 {
                let sum: f64 = (0..count).map(|i| sobol_point(i, count)[axis]).sum();
                assert!((sum / f64::from(count) - 0.5).abs() < 1e-15, "{count}");
            }
        }
    }

    #[test]
    fn the_mean_of_a_triangles_points_is_its_centroid() {
        let count = 1024;
        let mut mean = [0.0; 2];
        for i in 0..count {
            let [v, w] = triangle_weights(sobol_point(i, count));
            assert!(v >= 0.0 && w >= 0.0 && v + w <= 1.0);
            mean = [mean[0] + v, mean[1] + w];
        }
        for sum in mean {
            assert!((sum / f64::from(count) - 1.0 / 3.0).abs() < 1e-3);
        }
    }
}
