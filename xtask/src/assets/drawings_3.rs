//! Drawings of the tutorial's chapter III.

use glam::{DVec2, dvec2};

use super::drawing::{
    Anchor::{End, Middle, Start},
    BODY, DASHED, Drawing, FINE, GLOW, INK, LIGHT, OTHER, SIGHT,
};

/// Their names, without `.svg`, and the drawings.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![("3-beam", beam()), ("3-angles", angles()), ("3-mirror", mirror()), ("3-powers", powers())]
}

/// One beam on a surface that faces it, and on one that is tilted.
fn beam() -> Drawing {
    let mut d = Drawing::new(640.0, 330.0, "w, w / cos θ");
    let (w, ground) = (90.0, 260.0);
    // Facing.
    let left = dvec2(120.0, ground);
    let right = left + dvec2(w, 0.0);
    d.area(&[left, right, dvec2(right.x, 40.0), dvec2(left.x, 40.0)], GLOW);
    for i in 0..4 {
        let x = left.x + w * f64::from(i) / 3.0;
        d.ray(dvec2(x, 40.0), dvec2(x, ground), LIGHT);
    }
    d.line(left - dvec2(60.0, 0.0), right + dvec2(60.0, 0.0), INK);
    d.arrow((left + right) / 2.0, (left + right) / 2.0 - dvec2(0.0, 95.0), INK);
    d.label((left + right) / 2.0 + dvec2(10.0, -80.0), "→n", Start);
    d.label((left + right) / 2.0 + dvec2(0.0, 28.0), "w", Middle);
    // Tilted by θ = 3/5, 4/5: the footprint is w / (4/5).
    let (along, normal) = (dvec2(0.8, -0.6), dvec2(-0.6, -0.8));
    let foot = dvec2(440.0, ground + 6.0);
    let end = foot + along * (w / 0.8);
    d.area(&[foot, end, dvec2(end.x, 40.0), dvec2(foot.x, 40.0)], GLOW);
    for i in 0..4 {
        let hit = foot.lerp(end, f64::from(i) / 3.0);
        d.ray(dvec2(hit.x, 40.0), hit, LIGHT);
    }
    d.line(foot - along * 45.0, end + along * 50.0, INK);
    let middle = (foot + end) / 2.0;
    d.arrow(middle, middle + normal * 95.0, INK);
    d.arrow(middle, middle - dvec2(0.0, 95.0), SIGHT);
    d.angle(middle, middle - dvec2(0.0, 10.0), middle + normal, 45.0, "θ", INK);
    d.label(middle + normal * 95.0 + dvec2(-6.0, -2.0), "→n", End);
    d.label(middle + dvec2(-3.0, -84.0), "→ℓ", End);
    d.label(middle + dvec2(62.0, 20.0), "w / cos θ", Start);
    let level = ground + 36.0;
    d.line(foot, dvec2(foot.x, level), DASHED);
    d.line(end, dvec2(end.x, level), DASHED);
    d.line(dvec2(foot.x, level), dvec2(end.x, level), FINE);
    d.label(dvec2(middle.x, level + 20.0), "w", Middle);
    d
}

/// The drawing of the angles that III.2 and III.3 measure at a point of the sphere.
fn angles() -> Drawing {
    let mut d = Drawing::new(640.0, 340.0, "M, n, ℓ, u, r, θ");
    let (center, radius) = (dvec2(400.0, 240.0), 90.0);
    let eye = dvec2(50.0, 250.0);
    let normal = dvec2(-0.8, -0.6);
    let hit = center + normal * radius;
    let u = (hit - eye).normalize();
    let r = u - normal * (2.0 * u.dot(normal));
    let light = dvec2(215.0, 20.0);
    d.circle(center, radius, BODY, INK);
    d.line(center, hit, DASHED);
    d.line(eye, hit, SIGHT);
    d.arrow(eye, eye + u * 90.0, SIGHT);
    d.line(hit, light, LIGHT);
    let l = (light - hit).normalize();
    d.arrow(hit, hit + l * 90.0, LIGHT);
    d.arrow(hit, hit + normal * 90.0, INK);
    d.arrow(hit, hit + r * 90.0, OTHER);
    d.angle(hit, hit + l, hit + normal, 46.0, "θ", INK);
    for point in [center, eye, light, hit] {
        d.dot(point);
    }
    d.label(center + dvec2(8.0, 12.0), "Ω", Start);
    d.label(hit + dvec2(12.0, 6.0), "M", Start);
    d.label(eye + dvec2(-4.0, 26.0), "O", Middle);
    d.label(light + dvec2(-12.0, 4.0), "L", End);
    d.label(eye + u * 80.0 + dvec2(0.0, 28.0), "→u", Middle);
    d.label(hit + l * 96.0 + dvec2(-10.0, 0.0), "→ℓ", End);
    d.label(hit + normal * 92.0 + dvec2(-8.0, 6.0), "→n", End);
    d.label(hit + r * 92.0 + dvec2(10.0, 0.0), "→r", Start);
    d
}

/// The mirrored direction: twice the part along the normal is taken away.
fn mirror() -> Drawing {
    let mut d = Drawing::new(640.0, 310.0, "r = u − 2 (u · n) n");
    // The four unit vectors are equally long.
    let (hit, one) = (dvec2(320.0, 185.0), 150.0);
    let (across, down) = (dvec2(0.8 * one, 0.0), dvec2(0.0, 0.6 * one));
    let (from, through, to) = (hit - across - down, hit + across + down, hit + across - down);
    let (up, along) = (hit - dvec2(0.0, one), hit + dvec2(one, 0.0));
    d.line(hit - dvec2(260.0, 0.0), hit + dvec2(260.0, 0.0), INK);
    d.arrow(hit, up, INK);
    d.arrow(hit, along, INK);
    d.arrow(from, hit, SIGHT);
    d.arrow(hit, through, DASHED);
    d.arrow(through, to, FINE);
    d.arrow(hit, to, OTHER);
    d.right_angle(dvec2(through.x, hit.y), hit, to);
    d.angle(hit, up, from, 50.0, "β", INK);
    d.angle(hit, up, to, 50.0, "β", INK);
    d.dot(hit);
    d.label(hit + dvec2(-4.0, 26.0), "M", End);
    d.label((from + hit) / 2.0 + dvec2(-12.0, 22.0), "→u", End);
    d.label((hit + through) / 2.0 + dvec2(-12.0, 22.0), "→u", End);
    d.label(to + dvec2(-14.0, -6.0), "→r", End);
    d.label(up + dvec2(10.0, 4.0), "→n", Start);
    d.label(through + dvec2(12.0, -40.0), "− 2 (→u · →n) →n", Start);
    d.label(along + dvec2(-6.0, -14.0), "→m", Start);
    d
}

/// x to the power of α, also where x is negative.
fn powers() -> Drawing {
    let mut d = Drawing::new(640.0, 330.0, "x ↦ x^α, α = 1, 2, 10, 30, 100");
    let (zero, side) = (dvec2(320.0, 270.0), dvec2(240.0, -210.0));
    let at = |x: f64, y: f64| zero + dvec2(x, y) * side;
    d.arrow(at(-1.12, 0.0), at(1.2, 0.0), FINE);
    d.arrow(at(0.0, -0.12), at(0.0, 1.2), FINE);
    d.line(at(1.0, 0.0), at(1.0, 1.0), DASHED);
    d.line(at(0.0, 1.0), at(1.0, 1.0), DASHED);
    let curve = |from: f64, to: f64, alpha: i32| -> Vec<DVec2> {
        let x = |i: i32| from + (to - from) * f64::from(i) / 100.0;
        // By multiplying alone, which rounds alike everywhere.
        let power = |x: f64| (0..alpha).fold(1.0, |product, _| product * x);
        (0..=100).map(|i| at(x(i), power(x(i)))).collect()
    };
    d.curve(&curve(0.0, 1.0, 1), FINE);
    for alpha in [2, 10, 30, 100] {
        d.curve(&curve(0.0, 1.0, alpha), SIGHT);
    }
    for alpha in [2, 10] {
        d.curve(&curve(-1.0, 0.0, alpha), OTHER);
    }
    for (x, y, label) in
        [(0.40, 0.24, "2"), (0.72, 0.17, "10"), (0.885, 0.14, "30"), (1.09, 0.3, "100")]
    {
        d.label(at(x, y), label, Middle);
    }
    d.label(at(-0.55, 0.42), "2", Middle);
    d.label(at(-0.8, 0.32), "10", Middle);
    d.label(at(-1.0, 0.0) + dvec2(0.0, 24.0), "−1", Middle);
    d.label(at(1.0, 0.0) + dvec2(0.0, 24.0), "1", Middle);
    d.label(at(0.0, 0.0) + dvec2(-12.0, 24.0), "0", Middle);
    d.label(at(0.0, 1.0) + dvec2(-14.0, 6.0), "1", Middle);
    d.label(at(1.2, 0.0) + dvec2(4.0, 24.0), "x", Middle);
    d
}
