//! Drawings of the tutorial's chapters I to III.

use glam::{DVec2, dvec2};

use super::drawing::{Anchor, BODY, DASHED, Drawing, INK, SIGHT};

/// Their names, without `.svg`, and the drawings.
pub fn all() -> Vec<(&'static str, Drawing)> {
    vec![("2-distance", distance())]
}

/// The distance of the centre from the line, and half the chord.
fn distance() -> Drawing {
    let mut d = Drawing::new(640.0, 300.0, "O, Ω, H, M: r² = h² + s²");
    let (eye, center, radius) = (dvec2(60.0, 250.0), dvec2(440.0, 130.0), 100.0);
    let along = dvec2(0.985, -0.17).normalize();
    let foot = eye + along * (center - eye).dot(along);
    let half = (radius * radius - (center - foot).length_squared()).sqrt();
    let near = foot - along * half;
    d.circle(center, radius, BODY, INK);
    d.line(eye, center, DASHED);
    d.line(near, center, INK);
    d.line(center, foot, INK);
    d.arrow(eye, foot + along * 165.0, SIGHT);
    d.right_angle(foot, center, near);
    for point in [eye, center, foot, near] {
        d.dot(point);
    }
    d.label(eye + dvec2(-8.0, 24.0), "O", Anchor::End);
    d.label(center + dvec2(4.0, -12.0), "Ω", Anchor::Start);
    let below = |p: DVec2| p + dvec2(6.0, 24.0);
    d.label(below(foot), "H", Anchor::Start);
    d.label(below(near), "M", Anchor::Middle);
    d.label((near + center) / 2.0 + dvec2(-4.0, -10.0), "r", Anchor::End);
    d.label((center + foot) / 2.0 + dvec2(8.0, 4.0), "h", Anchor::Start);
    d.label((near + foot) / 2.0 + dvec2(0.0, 22.0), "s", Anchor::Middle);
    d
}
