//! Drawings of the tutorial's chapters I and II.

use glam::{DVec2, dvec2};

use super::drawing::{
    Anchor::{End, Middle, Start},
    BODY, DASHED, Drawing, FINE, INK, LIGHT, OTHER, SIGHT,
};
use crate::shape::circle;

/// Their names, without `.svg`, and the drawings.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![
        ("1-forwards", forwards()),
        ("1-backwards", backwards()),
        ("2-frame", frame()),
        ("2-pixels", pixels()),
        ("2-cases", cases()),
        ("2-distance", distance()),
    ]
}

/// Returns the point where a line from `from` along `along`, of length 1, first meets a circle.
fn intersect_circle(from: DVec2, along: DVec2, center: DVec2, radius: f64) -> Option<DVec2> {
    let middle = (center - from).dot(along);
    let nearest = from + along * middle;
    let half = radius * radius - (center - nearest).length_squared();
    (half >= 0.0).then(|| nearest - along * half.sqrt())
}

/// A source that sends light to all sides, of which hardly any reaches the eye.
fn forwards() -> Drawing {
    let mut d = Drawing::new(640.0, 320.0, "L → M → O");
    let (light, center, radius, eye) =
        (dvec2(110.0, 100.0), dvec2(340.0, 210.0), 80.0, dvec2(590.0, 90.0));
    // Up and to the left stands the label.
    for i in (0..36).filter(|i| !(22..=24).contains(i)) {
        let along = circle(f64::from(i) / 36.0);
        match intersect_circle(light, along, center, radius)
            .filter(|m| (*m - light).dot(along) > 0.0)
        {
            Some(lit) => {
                d.line(light, lit, FINE);
                let normal = (lit - center).normalize();
                let away = along - normal * (2.0 * along.dot(normal));
                d.arrow(lit, lit + away * 60.0, FINE);
            }
            None => d.arrow(light, light + along * 85.0, FINE),
        }
    }
    d.circle(center, radius, BODY, INK);
    let lit = center + dvec2(0.05, -1.0).normalize() * radius;
    d.ray(light, lit, LIGHT);
    d.ray(lit, eye, LIGHT);
    for point in [light, lit, eye] {
        d.dot(point);
    }
    d.label(light + dvec2(-20.0, -16.0), "L", Middle);
    d.label(lit + dvec2(2.0, 24.0), "M", Middle);
    d.label(eye + dvec2(12.0, 6.0), "O", Start);
    d
}

/// The eye that asks through each pixel what stands there.
fn backwards() -> Drawing {
    let mut d = Drawing::new(640.0, 320.0, "O → P → M → L");
    let (eye, center, radius, light) =
        (dvec2(60.0, 190.0), dvec2(450.0, 200.0), 75.0, dvec2(300.0, 40.0));
    let (screen, pixel) = (200.0, 26.0);
    d.circle(center, radius, BODY, INK);
    for i in -4..=3 {
        let through = dvec2(screen, eye.y + (f64::from(i) + 0.5) * pixel);
        let along = (through - eye).normalize();
        let (end, pen) = match intersect_circle(eye, along, center, radius) {
            Some(met) => (met, SIGHT),
            None => (eye + along * ((600.0 - eye.x) / along.x), FINE),
        };
        d.line(eye, end, pen);
        if i == -1 {
            d.ray(end, light, LIGHT);
            d.dot(end);
            d.label(end + dvec2(12.0, -2.0), "M", Start);
            d.label(through + dvec2(7.0, -10.0), "P", Start);
        }
        let met = intersect_circle(eye, along, center, radius).is_some();
        let (top, side) = (through.y - pixel / 2.0, dvec2(0.0, pixel));
        let corner = dvec2(screen - 5.0, top);
        let wide = dvec2(10.0, 0.0);
        let fill = if met { "#3454d8" } else { "#ffffff" };
        d.polygon(&[corner, corner + wide, corner + wide + side, corner + side], fill, INK);
    }
    d.dot(eye);
    d.dot(light);
    d.label(eye + dvec2(-12.0, 6.0), "O", End);
    d.label(light + dvec2(-12.0, 4.0), "L", End);
    d
}

/// The observer's axes, the image at D, and the line through a pixel.
fn frame() -> Drawing {
    let mut d = Drawing::new(640.0, 330.0, "O, x, y, z, D, P, M, Ω");
    let eye = dvec2(90.0, 170.0);
    let at = |x: f64, y: f64, z: f64| {
        eye + dvec2(0.62, 0.42) * x + dvec2(0.0, 1.0) * y + dvec2(0.96, -0.1) * z
    };
    let (z, wide, high) = (200.0, 90.0, 60.0);
    let (pixel, middle) = (at(45.0, -30.0, z), at(0.0, 0.0, z));
    let (center, radius) = (at(80.0, -60.0, 400.0), 52.0);
    let along = (pixel - eye).normalize();
    let hit = intersect_circle(eye, along, center, radius).expect("ok: the drawing is made so");
    // What the image hides in part.
    d.arrow(eye, at(0.0, 0.0, 540.0), FINE);
    d.circle(center, radius, BODY, INK);
    d.line(pixel, hit, SIGHT);
    let corners = [(-wide, -high), (wide, -high), (wide, high), (-wide, high)];
    let image = corners.map(|(x, y)| at(x, y, z));
    d.polygon(&image, "#f4f6fc", INK);
    for i in 1..4 {
        let [x, y] = [wide, high].map(|half| -half + 2.0 * half * f64::from(i) / 4.0);
        d.line(at(x, -high, z), at(x, high, z), FINE);
        d.line(at(-wide, y, z), at(wide, y, z), FINE);
    }
    // What is in front of it.
    d.arrow(eye, at(110.0, 0.0, 0.0), FINE);
    d.arrow(eye, at(0.0, 120.0, 0.0), FINE);
    d.line(eye, middle, FINE);
    d.line(eye, pixel, SIGHT);
    let below = at(0.0, 90.0, z);
    d.line(at(0.0, high, z), below, DASHED);
    d.measure(at(0.0, 90.0, 0.0), below, "D", dvec2(0.0, 24.0));
    for point in [eye, pixel, hit, center, middle] {
        d.dot(point);
    }
    d.label(eye + dvec2(-10.0, 0.0), "O", End);
    d.label(at(0.0, 0.0, 540.0) + dvec2(4.0, -10.0), "z", Middle);
    d.label(at(110.0, 0.0, 0.0) + dvec2(6.0, 16.0), "x", Middle);
    d.label(at(0.0, 120.0, 0.0) + dvec2(-14.0, 0.0), "y", Middle);
    d.label(pixel + dvec2(14.0, 1.0), "P", Middle);
    d.label(hit + dvec2(-8.0, -12.0), "M", End);
    d.label(center + dvec2(8.0, 8.0), "Ω", Start);
    d
}

/// The drawing of the way from the image's own coordinates to those of space.
fn pixels() -> Drawing {
    let mut d = Drawing::new(640.0, 330.0, "(0 ; 0) → O");
    let (corner, size) = (dvec2(110.0, 60.0), dvec2(420.0, 210.0));
    let (right, down) = (dvec2(size.x, 0.0), dvec2(0.0, size.y));
    d.polygon(&[corner, corner + right, corner + size, corner + down], "#f4f6fc", INK);
    let middle = corner + size / 2.0;
    d.line(middle - right / 2.0, middle + right / 2.0, DASHED);
    d.line(middle - down / 2.0, middle + down / 2.0, DASHED);
    let p = corner + dvec2(330.0, 60.0);
    d.line(dvec2(p.x, corner.y), p, DASHED);
    d.line(dvec2(corner.x, p.y), p, DASHED);
    d.arrow(corner, corner + right * 1.12, INK);
    d.arrow(corner, corner + down * 1.2, INK);
    d.arrow(corner, middle, OTHER);
    d.arrow(middle, middle + dvec2(70.0, 0.0), SIGHT);
    d.arrow(middle, middle + dvec2(0.0, 70.0), SIGHT);
    for point in [corner, middle, p] {
        d.dot(point);
    }
    d.label(corner + dvec2(-8.0, -10.0), "(0, 0)", Middle);
    d.label(corner + right * 1.12 + dvec2(8.0, -10.0), "x_p", Middle);
    d.label(corner + down * 1.2 + dvec2(-22.0, 2.0), "y_p", Middle);
    d.label(p + dvec2(10.0, -6.0), "P", Start);
    d.label(middle + dvec2(74.0, 24.0), "x", Middle);
    d.label(middle + dvec2(14.0, 84.0), "y", Middle);
    d.label((corner + middle) / 2.0 + dvec2(-6.0, 24.0), "→t", End);
    d
}

/// A line that misses, touches, crosses.
fn cases() -> Drawing {
    let mut d = Drawing::new(640.0, 230.0, "Δ < 0, Δ = 0, Δ > 0");
    let radius = 55.0;
    for (i, (height, label)) in
        [(-80.0, "Δ < 0"), (-55.0, "Δ = 0"), (-25.0, "Δ > 0")].into_iter().enumerate()
    {
        let center = dvec2(110.0 + 210.0 * i as f64, 120.0);
        d.circle(center, radius, BODY, INK);
        let half = (radius * radius - height * height).max(0.0).sqrt();
        let at = |x: f64| center + dvec2(x, height);
        d.arrow(at(-92.0), at(92.0), SIGHT);
        d.dot(center);
        d.label(center + dvec2(10.0, 10.0), "Ω", Start);
        if height >= -radius {
            d.dot(at(-half));
            d.dot(at(half));
        }
        if half > 0.0 {
            d.label(at(-half) + dvec2(-4.0, -10.0), "t_1", End);
            d.label(at(half) + dvec2(4.0, -10.0), "t_2", Start);
        }
        d.label(dvec2(center.x, 212.0), label, Middle);
    }
    d
}

/// The distance of the centre from the line, and half the chord.
fn distance() -> Drawing {
    let mut d = Drawing::new(640.0, 290.0, "r² = h² + s²");
    let (eye, center, radius) = (dvec2(50.0, 250.0), dvec2(450.0, 125.0), 105.0);
    let along = dvec2(0.985, -0.17).normalize();
    let foot = eye + along * (center - eye).dot(along);
    let half = (radius * radius - (center - foot).length_squared()).sqrt();
    let near = foot - along * half;
    d.circle(center, radius, BODY, INK);
    d.line(eye, center, DASHED);
    d.line(near, center, INK);
    d.line(center, foot, INK);
    d.line(eye, foot + along * 150.0, SIGHT);
    d.arrow(eye, eye + along * 110.0, SIGHT);
    d.right_angle(foot, center, near);
    for point in [eye, center, foot, near] {
        d.dot(point);
    }
    d.label(eye + dvec2(-10.0, 4.0), "O", End);
    d.label(center + dvec2(4.0, -12.0), "Ω", Start);
    d.label(foot + dvec2(8.0, 24.0), "H", Start);
    d.label(near + dvec2(-4.0, 26.0), "M", End);
    d.label((near + center) / 2.0 + dvec2(8.0, 16.0), "r", Start);
    d.label((center + foot) / 2.0 + dvec2(10.0, 4.0), "h", Start);
    d.label((near + foot) / 2.0 + dvec2(4.0, 22.0), "s", Middle);
    d.label(eye + along * 90.0 + dvec2(0.0, 28.0), "→d", Middle);
    d
}
