//! Drawings of the tutorial's chapter IV: shadows, mirrors, glass.

use glam::{DVec2, dvec2};

use super::drawing::{
    Anchor, BODY, DASHED, Drawing, FINE, GLOW, HOLLOW, INK, LIGHT, OTHER, SHADE, SIGHT,
};
use crate::shape::circle;

/// Their names, without `.svg`, and the drawings.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![
        ("4-1-shadow-ray", shadow_ray()),
        ("4-1-acne", acne()),
        ("4-2-mirror", mirror()),
        ("4-2-mirror-sphere", mirror_sphere()),
        ("4-3-refraction", refraction()),
        ("4-3-fresnel", fresnel()),
        ("4-3-interiors", interiors()),
    ]
}

/// The direction in which a mirror sends `u`.
fn reflect(u: DVec2, normal: DVec2) -> DVec2 {
    u - normal * (2.0 * u.dot(normal))
}

/// The direction in which unit `u` goes on behind a surface; `normal` is on the side it comes from.
fn refract(u: DVec2, normal: DVec2, eta: f64) -> DVec2 {
    let cosine = -u.dot(normal);
    u * eta + normal * (eta * cosine - (1.0 - eta * eta * (1.0 - cosine * cosine)).sqrt())
}

/// Returns the point where a line in unit direction `u` leaves a circle that it is in.
fn exit(from: DVec2, u: DVec2, center: DVec2, radius: f64) -> DVec2 {
    let f = from - center;
    let half = f.dot(u);
    from + u * (-half + (half * half - f.length_squared() + radius * radius).sqrt())
}

/// A light, with a few strokes around it.
pub fn lamp(d: &mut Drawing, at: DVec2) {
    for turn in 0..8 {
        let out = circle(f64::from(turn) / 8.0);
        d.line(at + out * 9.0, at + out * 16.0, LIGHT);
    }
    d.circle(at, 5.0, GLOW, LIGHT);
}

fn shadow_ray() -> Drawing {
    let mut d = Drawing::new(640.0, 330.0, "M + t ML");
    let (eye, light) = (dvec2(60.0, 290.0), dvec2(150.0, 50.0));
    let (center, radius) = (dvec2(430.0, 210.0), 80.0);
    let lit = center + dvec2(-0.6, -0.8) * radius;
    let shaded = center - DVec2::X * radius;
    let (blocker, small) = ((shaded + light) / 2.0, 26.0);
    d.circle(center, radius, BODY, INK);
    d.line(shaded, light, DASHED);
    d.circle(blocker, small, SHADE, INK);
    d.ray(eye, lit, SIGHT);
    d.ray(eye, shaded, SIGHT);
    d.ray(lit, light, LIGHT);
    let toward = (light - shaded).normalize();
    d.arrow(shaded, blocker - toward * small, OTHER);
    lamp(&mut d, light);
    [eye, lit, shaded, center].into_iter().for_each(|point| d.dot(point));
    d.label(eye + dvec2(-8.0, 24.0), "O", Anchor::End);
    d.label(light + dvec2(-22.0, 6.0), "L", Anchor::End);
    d.label(lit + dvec2(10.0, -10.0), "M", Anchor::Start);
    d.label(shaded + dvec2(12.0, 8.0), "M'", Anchor::Start);
    d.label(center + dvec2(8.0, 22.0), "Ω", Anchor::Start);
    d.label(light + dvec2(24.0, -10.0), "t = 1", Anchor::Start);
    d
}

fn acne() -> Drawing {
    let mut d = Drawing::new(640.0, 260.0, "M, t");
    // A circle so large that its top looks almost flat.
    for (middle, off) in [(160.0, -16.0), (480.0, 16.0)] {
        let (center, radius) = (dvec2(middle, 760.0), 600.0);
        let height = |x: f64| center.y - (radius * radius - x * x).sqrt();
        let steps = -14..=14;
        let edge = steps.map(|i| dvec2(middle + f64::from(i) * 10.0, height(f64::from(i) * 10.0)));
        let edge: Vec<_> = edge.collect();
        let corners = [dvec2(middle + 140.0, 235.0), dvec2(middle - 140.0, 235.0)];
        d.area(&[&edge[..], &corners].concat(), BODY);
        d.curve(&edge, INK);
        let point = dvec2(middle, center.y - radius + off);
        let u = dvec2(0.8, -0.6);
        if off > 0.0 {
            let out = exit(point, u, center, radius);
            d.line(out, out + u * 120.0, DASHED);
            d.line(point, out, OTHER);
            d.circle(out, 6.0, HOLLOW, OTHER);
            d.label(out + dvec2(12.0, 20.0), "t > 0", Anchor::Start);
        } else {
            d.arrow(point, point + u * 140.0, LIGHT);
        }
        d.dot(point);
        d.label(point + dvec2(-10.0, 6.0 + off * 0.4), "M", Anchor::End);
        let tip = point + u * 150.0;
        d.label(tip + dvec2(8.0, 4.0), "L", Anchor::Start);
    }
    d.line(dvec2(320.0, 30.0), dvec2(320.0, 230.0), FINE);
    d
}

fn mirror() -> Drawing {
    let mut d = Drawing::new(640.0, 400.0, "r = u − 2(u·n)n");
    let (eye, at) = (dvec2(90.0, 60.0), dvec2(310.0, 215.0));
    let thing = at + reflect(at - eye, DVec2::NEG_Y) * 0.9;
    let image = dvec2(thing.x, 2.0 * at.y - thing.y);
    let n = at - DVec2::Y * 120.0;
    d.area(&[(20.0, 215.0), (620.0, 215.0), (620.0, 229.0), (20.0, 229.0)].map(DVec2::from), SHADE);
    d.line(dvec2(20.0, 215.0), dvec2(620.0, 215.0), INK);
    d.line(at, image, DASHED);
    d.line(thing, image, DASHED);
    d.ray(eye, at, SIGHT);
    d.ray(at, thing, SIGHT);
    d.arrow(at, n, INK);
    d.angle(at, eye, n, 44.0, "θ", FINE);
    d.angle(at, n, thing, 44.0, "θ", FINE);
    [eye, at, thing, image].into_iter().for_each(|point| d.dot(point));
    d.label(eye + dvec2(-10.0, 0.0), "O", Anchor::End);
    d.label(at + dvec2(0.0, 42.0), "M", Anchor::Middle);
    d.label(n + dvec2(10.0, 8.0), "→n", Anchor::Start);
    d.label((eye + at) / 2.0 + dvec2(-14.0, 26.0), "→u", Anchor::End);
    d.label((thing + at) / 2.0 + dvec2(14.0, 26.0), "→r", Anchor::Start);
    d.label(thing + dvec2(10.0, 0.0), "A", Anchor::Start);
    d.label(image + dvec2(10.0, 6.0), "A'", Anchor::Start);
    d
}

fn mirror_sphere() -> Drawing {
    let mut d = Drawing::new(640.0, 300.0, "1/p' = 1/p + 2/r");
    let (center, radius) = (dvec2(470.0, 160.0), 190.0);
    let (source, top) = (dvec2(50.0, 160.0), center - DVec2::X * radius);
    let height = 52.0f64;
    let at = center - dvec2((radius * radius - height * height).sqrt(), height);
    let normal = (at - center) / radius;
    let out = reflect((at - source).normalize(), normal);
    // Where the reflected ray, drawn backward, meets the axis.
    let image = at - out * ((at.y - center.y) / out.y);
    d.arc(center, radius, 0.39, 0.61, INK);
    d.line(dvec2(20.0, 160.0), dvec2(620.0, 160.0), FINE);
    d.line(center, at + normal * 90.0, DASHED);
    d.line(image, at, DASHED);
    d.ray(source, at, LIGHT);
    d.ray(at, at + out * 150.0, LIGHT);
    d.line(at, dvec2(at.x, center.y), FINE);
    for (from, to, label) in [(source, top, "p"), (top, image, "p'"), (top, center, "r")] {
        let y = if label == "r" { 262.0 } else { 222.0 };
        let (from, to) = (dvec2(from.x, y), dvec2(to.x, y));
        d.line(from, to, FINE);
        for end in [from, to] {
            d.line(end - DVec2::Y * 6.0, end + DVec2::Y * 6.0, FINE);
        }
        d.label((from + to) / 2.0 + dvec2(0.0, 20.0), label, Anchor::Middle);
    }
    [source, top, at, image, center].into_iter().for_each(|point| d.dot(point));
    d.label(source + dvec2(0.0, -12.0), "A", Anchor::Middle);
    d.label(top + dvec2(-6.0, 22.0), "S", Anchor::End);
    d.label(at + dvec2(14.0, -6.0), "M", Anchor::Start);
    d.label(image + dvec2(4.0, 22.0), "A'", Anchor::Start);
    d.label(center + dvec2(6.0, -10.0), "Ω", Anchor::Start);
    d.label(dvec2(at.x + 10.0, center.y - 10.0), "h", Anchor::Start);
    d
}

fn refraction() -> Drawing {
    let mut d = Drawing::new(640.0, 380.0, "t = η u + (η cos θ₁ − cos θ₂) n");
    let (at, up) = (dvec2(320.0, 190.0), DVec2::NEG_Y);
    let u = dvec2(0.75, (1.0f64 - 0.75 * 0.75).sqrt());
    let t = refract(u, up, 1.0 / 1.5);
    let water = [(20.0, 190.0), (620.0, 190.0), (620.0, 360.0), (20.0, 360.0)];
    d.area(&water.map(DVec2::from), BODY);
    d.line(dvec2(20.0, 190.0), dvec2(620.0, 190.0), INK);
    d.line(at, at - up * 150.0, DASHED);
    d.line(at, at + u * 170.0, DASHED);
    d.ray(at - u * 210.0, at, SIGHT);
    d.arrow(at, at + t * 175.0, SIGHT);
    d.arrow(at, at + up * 110.0, INK);
    d.arrow(at, at + DVec2::X * 110.0, INK);
    d.angle(at, at - u, at + up, 46.0, "θ_1", FINE);
    d.angle(at, at + t, at - up, 62.0, "θ_2", FINE);
    d.dot(at);
    d.label(at + dvec2(-12.0, 24.0), "M", Anchor::End);
    d.label(at - u * 120.0 + dvec2(-10.0, 24.0), "→u", Anchor::End);
    d.label(at + t * 160.0 + dvec2(12.0, 2.0), "→t", Anchor::Start);
    d.label(at + up * 110.0 + dvec2(10.0, 8.0), "→n", Anchor::Start);
    d.label(at + dvec2(112.0, -12.0), "→m", Anchor::Start);
    d.label(dvec2(40.0, 176.0), "n_1", Anchor::Start);
    d.label(dvec2(40.0, 214.0), "n_2", Anchor::Start);
    d
}

/// The share that is reflected, from the squares of sine and cosine of the angle: by s and p.
fn share(turns: f64, eta: f64) -> f64 {
    let (cosine, sine) = circle(turns).into();
    let rest = 1.0 - eta * eta * sine * sine;
    if rest <= 0.0 {
        return 1.0;
    }
    let beyond = rest.sqrt();
    let s = (eta * cosine - beyond) / (eta * cosine + beyond);
    let p = (cosine - eta * beyond) / (cosine + eta * beyond);
    (s * s + p * p) / 2.0
}

fn fresnel() -> Drawing {
    let mut d = Drawing::new(640.0, 360.0, "F(θ₁)");
    let at = |degrees: f64, f: f64| dvec2(80.0 + degrees * 5.6, 300.0 - f * 250.0);
    for (value, label) in [(0.0, "0"), (0.5, "0.5"), (1.0, "1")] {
        d.line(at(0.0, value), at(90.0, value), FINE);
        d.label(at(0.0, value) + dvec2(-12.0, 6.0), label, Anchor::End);
    }
    for (degrees, label) in [(0.0, "0°"), (30.0, "30°"), (60.0, "60°"), (90.0, "90°")] {
        d.line(at(degrees, 0.0), at(degrees, 0.0) + DVec2::Y * 6.0, FINE);
        d.label(at(degrees, 0.0) + dvec2(0.0, 26.0), label, Anchor::Middle);
    }
    for (eta, pen, label, x) in [(1.0 / 1.5, SIGHT, "η = 2/3", 62.0), (1.5, OTHER, "η = 3/2", 28.0)]
    {
        let points = (0..=360).map(|i| f64::from(i) / 4.0);
        let points: Vec<_> = points.map(|a| at(a, share(a / 360.0, eta))).collect();
        d.curve(&points, pen);
        d.label(at(x, 0.3), label, Anchor::Middle);
    }
    // The critical angle, of which the sine is 2/3.
    d.label(at(43.5, 0.75), "θ_c", Anchor::Start);
    d.line(at(41.81, 0.0), at(41.81, 1.0), DASHED);
    d.label(at(45.0, 0.0) + dvec2(0.0, 48.0), "θ_1", Anchor::Middle);
    d.label(at(0.0, 1.0) + dvec2(0.0, -14.0), "F", Anchor::Middle);
    d
}

fn interiors() -> Drawing {
    let mut d = Drawing::new(640.0, 380.0, "(), (1), (1, 2), (2)");
    let (center, radius, level) = (dvec2(330.0, 190.0), 115.0, 205.0);
    let water = [(20.0, level), (620.0, level), (620.0, 360.0), (20.0, 360.0)];
    d.area(&water.map(DVec2::from), BODY);
    d.line(dvec2(20.0, level), dvec2(620.0, level), INK);
    d.circle(center, radius, GLOW, INK);
    let chord = |x: f64| dvec2(center.x + x, level);
    let half = (radius * radius - (level - center.y) * (level - center.y)).sqrt();
    d.line(chord(-half), chord(half), DASHED);
    let start = center + dvec2(-0.8, -0.6) * radius;
    let u = dvec2(0.94, 0.342).normalize();
    let inside = refract(u, (start - center) / radius, 1.0 / 1.5);
    let end = exit(start, inside, center, radius);
    let out = refract(inside, (center - end) / radius, 1.5 / 1.33);
    d.ray(start - u * 170.0, start, SIGHT);
    d.line(start, end, SIGHT);
    d.arrow(end, end + out * 150.0, SIGHT);
    let crossing = start + inside * ((level - start.y) / inside.y);
    [start, crossing, end].into_iter().for_each(|point| d.dot(point));
    d.label(start - u * 110.0 + dvec2(10.0, -14.0), "( )", Anchor::Start);
    d.label((start + crossing) / 2.0 + dvec2(4.0, -14.0), "(1)", Anchor::Start);
    d.label((crossing + end) / 2.0 + dvec2(-8.0, 26.0), "(1, 2)", Anchor::End);
    d.label(end + out * 80.0 + dvec2(6.0, -12.0), "(2)", Anchor::Start);
    d.label(center + dvec2(60.0, -60.0), "1", Anchor::Middle);
    d.label(dvec2(60.0, 330.0), "2", Anchor::Middle);
    d
}
