//! Drawings of the tutorial's chapters V and VI: planes, Fermat's principle, normals, an eclipse.

use glam::{DVec2, dvec2};

use super::drawing::{Anchor, BODY, DASHED, Drawing, FINE, GLOW, INK, LIGHT, OTHER, SHADE, SIGHT};
use super::drawings_4::lamp;

/// Their names, without `.svg`, and the drawings.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![
        ("5-height", height()),
        ("5-horizon", horizon()),
        ("6-1-reflection", reflection()),
        ("6-1-refraction", refraction()),
        ("6-3-normals", normals()),
        ("6-4-eclipse", eclipse()),
    ]
}

/// A level surface with something below it.
fn ground(d: &mut Drawing, level: f64, depth: f64, fill: &str) {
    let [left, right] = [20.0, 620.0];
    let corners = [(left, level), (right, level), (right, level + depth), (left, level + depth)];
    d.area(&corners.map(DVec2::from), fill);
    d.line(dvec2(left, level), dvec2(right, level), INK);
}

fn height() -> Drawing {
    let mut d = Drawing::new(640.0, 320.0, "t = OA·n / u·n");
    let (eye, level) = (dvec2(110.0, 70.0), 260.0);
    ground(&mut d, level, 14.0, SHADE);
    let foot = dvec2(eye.x, level);
    let point = dvec2(250.0, level);
    let hit = dvec2(530.0, level);
    let along = (hit - eye).normalize();
    // Both unit vectors are equally long.
    let one = 110.0;
    let unit = eye + along * one;
    d.line(eye, foot, DASHED);
    d.arrow(eye, point, DASHED);
    d.line(eye, hit, SIGHT);
    d.arrow(eye, unit, INK);
    d.line(unit, dvec2(unit.x, eye.y), FINE);
    d.line(eye, dvec2(unit.x, eye.y), DASHED);
    d.arrow(point, point - DVec2::Y * one, INK);
    d.right_angle(point, point - DVec2::Y, point + DVec2::X);
    d.right_angle(foot, foot - DVec2::Y, foot + DVec2::X);
    [eye, point, hit].into_iter().for_each(|point| d.dot(point));
    d.label(eye + dvec2(-10.0, 0.0), "O", Anchor::End);
    d.label(point + dvec2(0.0, 36.0), "A", Anchor::Middle);
    d.label(hit + dvec2(0.0, 36.0), "M", Anchor::Middle);
    d.label(point + dvec2(12.0, -80.0), "→n", Anchor::Start);
    d.label(eye + along * 66.0 + dvec2(4.0, 34.0), "→u", Anchor::Start);
    d.label(dvec2(150.0, 210.0), "→OA", Anchor::Middle);
    d.label(dvec2(unit.x + 12.0, (unit.y + eye.y) / 2.0 + 6.0), "|→u · →n|", Anchor::Start);
    d.label(dvec2(eye.x - 12.0, 180.0), "|→OA · →n|", Anchor::End);
    d
}

fn horizon() -> Drawing {
    let mut d = Drawing::new(640.0, 270.0, "z = hD/k");
    let (eye, level, distance, pixel) = (dvec2(50.0, 60.0), 220.0, 70.0, 13.0);
    ground(&mut d, level, 12.0, SHADE);
    d.line(eye, dvec2(620.0, eye.y), DASHED);
    let screen = eye.x + distance;
    d.line(dvec2(screen, eye.y - 30.0), dvec2(screen, eye.y + 120.0), INK);
    for k in -2..=9 {
        let y = eye.y + f64::from(k) * pixel;
        d.line(dvec2(screen - 4.0, y), dvec2(screen + 4.0, y), INK);
    }
    for k in 2..=8 {
        let z = (level - eye.y) * distance / (f64::from(k) * pixel);
        let hit = dvec2(eye.x + z, level);
        d.line(eye, hit, SIGHT);
        d.dot(hit);
        if k <= 4 {
            d.label(hit + dvec2(0.0, 36.0), &format!("z_{k}"), Anchor::Middle);
        }
    }
    d.measure(dvec2(22.0, eye.y), dvec2(22.0, level), "h", dvec2(-10.0, 6.0));
    d.measure(eye - DVec2::Y * 38.0, dvec2(screen, 22.0), "D", dvec2(0.0, -6.0));
    d.dot(eye);
    d.label(eye + dvec2(-2.0, -12.0), "O", Anchor::Middle);
    d
}

fn reflection() -> Drawing {
    let mut d = Drawing::new(640.0, 400.0, "AM + MB ≥ A'B");
    let (a, b, level) = (dvec2(110.0, 60.0), dvec2(530.0, 110.0), 210.0);
    let image = dvec2(a.x, 2.0 * level - a.y);
    let across = |from: DVec2, to: DVec2| from + (to - from) * ((level - from.y) / (to.y - from.y));
    let (best, other) = (across(image, b), dvec2(430.0, level));
    ground(&mut d, level, 12.0, SHADE);
    d.line(a, image, DASHED);
    d.line(image, best, DASHED);
    d.line(image, other, DASHED);
    d.curve(&[a, other, b], OTHER);
    d.ray(a, best, LIGHT);
    d.ray(best, b, LIGHT);
    let up = best - DVec2::Y * 110.0;
    d.line(best, up, FINE);
    d.angle(best, a, up, 46.0, "θ", FINE);
    d.angle(best, up, b, 46.0, "θ", FINE);
    [a, b, image, best, other].into_iter().for_each(|point| d.dot(point));
    d.label(a + dvec2(-10.0, 0.0), "A", Anchor::End);
    d.label(b + dvec2(10.0, 0.0), "B", Anchor::Start);
    d.label(image + dvec2(-10.0, 6.0), "A'", Anchor::End);
    d.label(best + dvec2(14.0, 34.0), "M", Anchor::Start);
    d
}

fn refraction() -> Drawing {
    let mut d = Drawing::new(640.0, 400.0, "n₁ sin θ₁ = n₂ sin θ₂");
    let (level, at) = (200.0, dvec2(370.0, 200.0));
    let a = dvec2(120.0, 50.0);
    let u = (at - a).normalize();
    let sine = u.x / 1.5;
    let t = dvec2(sine, (1.0 - sine * sine).sqrt());
    let b = at + t * (140.0 / t.y);
    ground(&mut d, level, 180.0, BODY);
    let [over, under] = [dvec2(a.x, level), dvec2(b.x, level)];
    d.line(a, b, DASHED);
    d.line(a, over, FINE);
    d.line(b, under, FINE);
    d.line(at - DVec2::Y * 120.0, at + DVec2::Y * 150.0, DASHED);
    d.ray(a, at, LIGHT);
    d.ray(at, b, LIGHT);
    d.angle(at, a, at - DVec2::Y, 46.0, "θ_1", FINE);
    d.angle(at, b, at + DVec2::Y, 66.0, "θ_2", FINE);
    d.measure(over + DVec2::Y * 26.0, at + DVec2::Y * 26.0, "x", dvec2(0.0, 20.0));
    d.measure(over + DVec2::Y * 62.0, under + DVec2::Y * 62.0, "d", dvec2(-90.0, 20.0));
    [a, b, at].into_iter().for_each(|point| d.dot(point));
    d.label(a + dvec2(-10.0, 0.0), "A", Anchor::End);
    d.label(b + dvec2(10.0, 8.0), "B", Anchor::Start);
    d.label(at + dvec2(10.0, -10.0), "M", Anchor::Start);
    d.label((a + over) / 2.0 + dvec2(-10.0, 6.0), "a", Anchor::End);
    d.label((b + under) / 2.0 + dvec2(10.0, 6.0), "b", Anchor::Start);
    d.label(dvec2(600.0, level - 12.0), "n_1", Anchor::End);
    d.label(dvec2(600.0, level + 26.0), "n_2", Anchor::End);
    d
}

fn normals() -> Drawing {
    let mut d = Drawing::new(640.0, 300.0, "n");
    let corners = [(60.0, 250.0), (210.0, 160.0), (430.0, 150.0), (580.0, 230.0)].map(DVec2::from);
    // Each corner has the mean of its neighbours' normals; the ends have their own.
    let across: Vec<_> =
        corners.windows(2).map(|side| (side[0] - side[1]).perp().normalize()).collect();
    let at = [
        across[0],
        (across[0] + across[1]).normalize(),
        (across[1] + across[2]).normalize(),
        across[2],
    ];
    let below = [dvec2(580.0, 280.0), dvec2(60.0, 280.0)];
    d.area(&[&corners[..], &below].concat(), BODY);
    d.curve(&corners, INK);
    for side in 0..3 {
        for step in 1..6 {
            let share = f64::from(step) / 6.0;
            let point = corners[side].lerp(corners[side + 1], share);
            let normal = at[side].lerp(at[side + 1], share).normalize();
            d.line(point, point + normal * 48.0, SIGHT);
        }
    }
    for (corner, normal) in corners.into_iter().zip(at) {
        d.arrow(corner, corner + normal * 72.0, INK);
        d.dot(corner);
    }
    for (i, label) in [(1, "→n_A"), (2, "→n_B")] {
        d.label(corners[i] + at[i] * 72.0 + dvec2(10.0, -2.0), label, Anchor::Start);
    }
    d.label(corners[1] + dvec2(6.0, 26.0), "A", Anchor::Middle);
    d.label(corners[2] + dvec2(-6.0, 26.0), "B", Anchor::Middle);
    d
}

fn eclipse() -> Drawing {
    let mut d = Drawing::new(640.0, 320.0, "sin γ = r/LQ");
    let light = dvec2(80.0, 190.0);
    let (planet, large) = (dvec2(500.0, 170.0), 84.0);
    let (moon, small) = (dvec2(350.0, 148.0), 26.0);
    // Unit directions of the tangents from the light to a circle.
    let tangents = |center: DVec2, radius: f64| {
        let to = center - light;
        let (length, along) = (to.length(), to.normalize());
        let sine = radius / length;
        let cosine = (1.0 - sine * sine).sqrt();
        [-1.0, 1.0].map(|side| along * cosine + along.perp() * (side * sine))
    };
    let touch = |center: DVec2, tangent: DVec2| light + tangent * (center - light).dot(tangent);
    let [up, down] = tangents(moon, small);
    let [start_up, start_down] = [touch(moon, up), touch(moon, down)];
    let far = |tangent: DVec2| light + tangent * (530.0 / tangent.x);
    d.circle(planet, large, BODY, INK);
    d.area(&[start_up, far(up), far(down), start_down], SHADE);
    d.circle(planet, large, "none", INK);
    for tangent in [up, down] {
        d.line(light, far(tangent), LIGHT);
    }
    for tangent in tangents(planet, large) {
        d.line(light, far(tangent), DASHED);
    }
    d.line(light, moon, DASHED);
    d.line(light, planet, DASHED);
    d.circle(moon, small, BODY, INK);
    d.circle(light, 30.0, GLOW, LIGHT);
    lamp(&mut d, light);
    d.angle(light, planet, moon, 130.0, "", FINE);
    [light, planet, moon].into_iter().for_each(|point| d.dot(point));
    d.label(light + dvec2(0.0, 52.0), "L", Anchor::Middle);
    d.label(planet + dvec2(10.0, 20.0), "P", Anchor::Start);
    d.label(moon + dvec2(0.0, -36.0), "Q", Anchor::Middle);
    let [edge, rim] = [planet + dvec2(0.6, 0.8) * large, moon - dvec2(0.8, 0.6) * small];
    d.line(planet, edge, FINE);
    d.line(moon, rim, FINE);
    d.label((planet + edge) / 2.0 + dvec2(12.0, 4.0), "R", Anchor::Start);
    d.label(rim + dvec2(-6.0, 0.0), "r", Anchor::End);
    d.label(light + dvec2(160.0, -8.0), "δ", Anchor::Start);
    d
}
