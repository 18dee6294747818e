//! Samples, and the density that they are said to have.

use super::*;

const ANGLES: [f64; 5] = [3.0, 45.0, 78.0, 118.0, 165.0];

/// Returns the share of samples that have light and are of no delta lobe, and that of delta lobes.
fn accepted(bsdf: &Bsdf, wo: DVec3, steps: usize) -> [f64; 2] {
    let mut random = Random(7);
    let mut counts = [0usize; 2];
    for u in midpoints(steps) {
        for v in midpoints(steps) {
            if let Some(sample) = bsdf.sample(wo, random.next(), [u, v]) {
                counts[usize::from(sample.is_delta)] += 1;
            }
        }
    }
    counts.map(|count| count as f64 / (steps * steps) as f64)
}

#[test]
fn densities_integrate_to_the_share_of_accepted_samples() {
    for (name, params) in materials() {
        let bsdf = Bsdf::new(&params, 1.0);
        let index = if params.is_thin { 1.0 } else { f64::from(params.ior) };
        for angle in ANGLES {
            let wo = at(angle, 35.0);
            let eta = if wo.z < 0.0 { 1.0 / index } else { index };
            let parts = integrate(wo, eta, 160, |wi| Vec3::splat(bsdf.pdf(wo, wi) as f32));
            let integral = f64::from((parts[0] + parts[1]).x);
            let [expected, delta] = accepted(&bsdf, wo, 400);
            let error = (integral - expected).abs();
            assert!(error < 0.006, "{name} at {angle}°: {integral} is {expected}");
            assert!(integral + delta < 1.005, "{name} at {angle}°: {integral} + {delta}");
        }
    }
}

#[test]
fn values_and_densities_of_samples_are_those_of_evaluation() {
    let mut random = Random(3);
    for (name, params) in materials() {
        let bsdf = Bsdf::new(&params, 1.0);
        for _ in 0..2000 {
            let wo = random.direction();
            let Some(sample) = bsdf.sample(wo, random.next(), random.pair()) else { continue };
            assert_eq!(sample.is_transmission, sample.wi.z * wo.z < 0.0, "{name}");
            assert!((sample.wi.length() - 1.0).abs() < 1e-9, "{name}");
            if sample.is_delta {
                continue;
            }
            let (value, pdf) = (bsdf.evaluate(wo, sample.wi), bsdf.pdf(wo, sample.wi));
            let difference = (sample.value - value).abs().max_element();
            assert!(difference <= 1e-5 * value.max_element(), "{name}: {sample:?} {value}");
            assert!((sample.pdf - pdf).abs() <= 1e-6 * pdf, "{name}: {sample:?} {pdf}");
        }
    }
}

#[test]
fn no_sample_has_much_more_light_than_its_density() {
    let mut random = Random(5);
    let mut worst = (0.0, "");
    for (name, params) in materials() {
        let bsdf = Bsdf::new(&params, 1.0);
        for _ in 0..20_000 {
            let wo = random.direction();
            let Some(sample) = bsdf.sample(wo, random.next(), random.pair()) else { continue };
            let weight = f64::from(sample.value.max_element()) / sample.pdf;
            if weight > worst.0 {
                worst = (weight, name);
            }
        }
    }
    println!("greatest weight {worst:?}");
    assert!(worst.0 < 22.0, "{worst:?}");
}

#[test]
fn the_mean_of_samples_is_what_the_furnace_finds() {
    for (name, params) in materials() {
        let bsdf = Bsdf::new(&params, 1.0);
        for angle in [10.0, 70.0, 130.0] {
            let wo = at(angle, 35.0);
            let mut random = Random(11);
            let (steps, mut sum) = (300, Vec3::ZERO);
            for u in midpoints(steps) {
                for v in midpoints(steps) {
                    if let Some(s) = bsdf.sample(wo, random.next(), [u, v]) {
                        sum += s.value / s.pdf as f32;
                    }
                }
            }
            let found = sum / (steps * steps) as f32;
            let expected: Vec3 = furnace(&params, wo, 160).into_iter().sum();
            let error = (found - expected).abs().max_element();
            assert!(error < 0.01, "{name} at {angle}°: {found} is {expected}");
        }
    }
}

/// The number of cells of the sphere, by angle from z and by azimuth, and of samples in a χ² test.
const CELLS: [usize; 2] = [20, 40];
const SAMPLES: usize = 100_000;

/// The logarithm of the gamma function (Lanczos's approximation).
fn ln_gamma(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 6] = [
        76.180_091_729_471_46,
        -86.505_320_329_416_77,
        24.014_098_240_830_91,
        -1.231_739_572_450_155,
        0.120_865_097_386_617_9e-2,
        -0.539_523_938_495_3e-5,
    ];
    let series: f64 = COEFFICIENTS.iter().enumerate().map(|(i, c)| c / (x + 1.0 + i as f64)).sum();
    let t = x + 5.5;
    (x + 0.5) * t.ln() - t + (2.506_628_274_631_000_5 * (1.000_000_000_190_015 + series) / x).ln()
}

/// The probability that a χ² variable with this many degrees of freedom is greater: the upper
/// regularized gamma function, by its series or its continued fraction.
fn chi_square_tail(chi_square: f64, freedom: usize) -> f64 {
    let (a, x) = (freedom as f64 / 2.0, chi_square / 2.0);
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..2000 {
            term *= x / (a + f64::from(n));
            sum += term;
        }
        return 1.0 - sum * scale;
    }
    // Lentz's method.
    let (mut b, mut c) = (x + 1.0 - a, 1e300);
    let mut d = 1.0 / b;
    let mut h = d;
    for n in 1..2000 {
        let n = f64::from(n);
        let factor = -n * (n - a);
        b += 2.0;
        d = 1.0 / (factor * d + b);
        c = b + factor / c;
        h *= d * c;
    }
    h * scale
}

#[test]
fn the_tail_of_chi_square_is_that_of_its_tables() {
    for (x, freedom, expected) in
        [(3.841459, 1, 0.05), (18.307038, 10, 0.05), (149.449253, 100, 0.001)]
    {
        assert!((chi_square_tail(x, freedom) - expected).abs() < 1e-6);
    }
}

/// Returns the cell of a direction.
fn cell(w: DVec3) -> usize {
    let z = ((w.z.clamp(-1.0, 1.0).acos() / PI * CELLS[0] as f64) as usize).min(CELLS[0] - 1);
    let azimuth = (w.y.atan2(w.x) / TAU).rem_euclid(1.0);
    z * CELLS[1] + ((azimuth * CELLS[1] as f64) as usize).min(CELLS[1] - 1)
}

/// Returns the share of samples that the density expects in each cell, by integration.
fn expected_shares(bsdf: &Bsdf, wo: DVec3) -> Vec<f64> {
    // Points within each cell, by angle and by azimuth.
    const POINTS: [usize; 2] = [24, 8];
    let [rows, columns] = CELLS;
    let area = PI * TAU / (rows * columns * POINTS[0] * POINTS[1]) as f64;
    let mut shares = vec![0.0; rows * columns];
    for theta in midpoints(rows * POINTS[0]).map(|theta| PI * theta) {
        let (sine, z) = theta.sin_cos();
        for phi in midpoints(columns * POINTS[1]).map(|phi| TAU * phi) {
            let wi = DVec3::new(sine * phi.cos(), sine * phi.sin(), z);
            shares[cell(wi)] += bsdf.pdf(wo, wi) * sine * area;
        }
    }
    shares
}

/// Returns the probability of samples that differ at least as much from the density, by the χ² test
/// (Pearson). Cells in which less than five samples are expected are taken together.
fn chi_square_test(bsdf: &Bsdf, wo: DVec3, seed: u64) -> f64 {
    let mut random = Random(seed);
    let mut found = vec![0usize; CELLS[0] * CELLS[1]];
    for _ in 0..SAMPLES {
        let sample = bsdf.sample(wo, random.next(), random.pair());
        if let Some(sample) = sample.filter(|sample| !sample.is_delta) {
            found[cell(sample.wi)] += 1;
        }
    }
    let mut cells: Vec<_> = expected_shares(bsdf, wo)
        .into_iter()
        .map(|share| share * SAMPLES as f64)
        .zip(found.into_iter().map(|count| count as f64))
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut chi_square, mut count, mut pooled) = (0.0, 0, (0.0, 0.0));
    for (expected, found) in cells {
        if expected == 0.0 && found > 1e-5 * SAMPLES as f64 {
            return 0.0;
        }
        pooled = (pooled.0 + expected, pooled.1 + found);
        if pooled.0 > 5.0 {
            chi_square += (pooled.1 - pooled.0) * (pooled.1 - pooled.0) / pooled.0;
            count += 1;
            pooled = (0.0, 0.0);
        }
    }
    if count < 2 { 1.0 } else { chi_square_tail(chi_square, count - 1) }
}

#[test]
fn samples_are_spread_by_their_density() {
    let tests: Vec<_> =
        materials().into_iter().flat_map(|m| ANGLES.map(|angle| (m, angle))).collect();
    // A significance of 0.01 for all tests together (Šidák).
    let significance = 1.0 - 0.99f64.powf(1.0 / tests.len() as f64);
    let mut least = (1.0, String::new());
    for (seed, ((name, params), angle)) in tests.into_iter().enumerate() {
        let wo = at(angle, 35.0);
        let probability = chi_square_test(&Bsdf::new(&params, 1.0), wo, seed as u64);
        if probability < least.0 {
            least = (probability, format!("{name} at {angle}°"));
        }
    }
    println!("least probability {least:?}, significance {significance}");
    assert!(least.0 > significance, "{least:?}");
}

/// A test that finds nothing wrong with anything shows nothing.
#[test]
fn samples_of_another_roughness_are_found_out() {
    let wo = at(45.0, 35.0);
    let (a, b) = (Bsdf::new(&metal(0.5), 1.0), Bsdf::new(&metal(0.52), 1.0));
    let mut random = Random(1);
    let mut chi_square = 0.0;
    let mut found = vec![0.0; CELLS[0] * CELLS[1]];
    for _ in 0..SAMPLES {
        if let Some(sample) = a.sample(wo, random.next(), random.pair()) {
            found[cell(sample.wi)] += 1.0;
        }
    }
    let expected = expected_shares(&b, wo).into_iter().map(|share| share * SAMPLES as f64);
    let pairs: Vec<_> = expected.zip(found).filter(|(expected, _)| *expected > 5.0).collect();
    for (expected, found) in &pairs {
        chi_square += (found - expected) * (found - expected) / expected;
    }
    assert!(chi_square_tail(chi_square, pairs.len() - 1) < 1e-6);
}
