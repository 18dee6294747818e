//! The chapters' drawings as SVG: a few strokes, labels in the letters of the mathematics.
//!
//! Points are in the drawing's own units with y down, as in the tutorial and in SVG. Numbers are
//! rounded to hundredths, and angles are worked out by [`circle`], so that the bytes are the same
//! on every platform. Labels need no translation: both languages of a chapter share a drawing.

use std::fmt::Write;

use glam::{DVec2, dvec2};

use crate::shape::circle;

/// The style of a line.
#[derive(Clone, Copy)]
pub struct Pen {
    color: &'static str,
    width: f64,
    dashed: bool,
}

/// Outlines, surfaces, what the drawing is about.
pub const INK: Pen = Pen { color: "#1f2430", width: 2.0, dashed: false };
/// Axes, measures, what helps to see.
pub const FINE: Pen = Pen { color: "#7a8294", width: 1.2, dashed: false };
/// The pen for construction lines: prolongations, perpendiculars.
pub const DASHED: Pen = Pen { dashed: true, ..FINE };
/// The way of the light.
pub const LIGHT: Pen = Pen { color: "#d98200", width: 2.2, dashed: false };
/// The way of the ray that the eye sends out.
pub const SIGHT: Pen = Pen { color: "#2450c8", width: 2.2, dashed: false };
/// A second thing to tell apart: a wrong way, another curve.
pub const OTHER: Pen = Pen { color: "#b3263a", width: 2.0, dashed: false };

/// The fill of a body: the tutorial's blue, pale.
pub const BODY: &str = "#dde4f8";
/// The fill of what light fills.
pub const GLOW: &str = "#fdecc2";
/// The fill of what no light reaches.
pub const SHADE: &str = "#d5d8df";
/// No fill.
pub const HOLLOW: &str = "none";

/// The part of a label that stands at its point.
#[derive(Clone, Copy)]
pub enum Anchor {
    /// The left end.
    Start,
    /// Its middle.
    Middle,
    /// The right end.
    End,
}

/// Sizes of labels and of their indices.
const FONT: f64 = 20.0;
const SMALL: f64 = 14.0;

/// A drawing in the making.
pub struct Drawing {
    size: DVec2,
    title: &'static str,
    body: String,
}

impl Drawing {
    /// An empty drawing on a white card, readable on dark pages too.
    pub fn new(width: f64, height: f64, title: &'static str) -> Self {
        Self { size: dvec2(width, height), title, body: String::new() }
    }

    fn push(&mut self, element: std::fmt::Arguments) {
        writeln!(self.body, "{element}").expect("ok: a String takes all that is written");
    }

    /// A straight line.
    pub fn line(&mut self, from: DVec2, to: DVec2, pen: Pen) {
        self.curve(&[from, to], pen);
    }

    /// A line through all the points.
    pub fn curve(&mut self, points: &[DVec2], pen: Pen) {
        self.push(format_args!("<path d=\"M{}\" {} fill=\"none\"/>", path(points), stroke(pen)));
    }

    /// A filled area with straight edges, outlined.
    pub fn polygon(&mut self, points: &[DVec2], fill: &str, pen: Pen) {
        self.push(format_args!("<path d=\"M{}Z\" {} fill=\"{fill}\"/>", path(points), stroke(pen)));
    }

    /// A filled area with straight edges, without an outline.
    pub fn area(&mut self, points: &[DVec2], fill: &str) {
        self.push(format_args!("<path d=\"M{}Z\" fill=\"{fill}\"/>", path(points)));
    }

    /// A line with an arrowhead at its end.
    pub fn arrow(&mut self, from: DVec2, to: DVec2, pen: Pen) {
        let along = (to - from).normalize();
        self.line(from, to - along * 6.0, pen);
        self.head(to, along, pen);
    }

    /// A line with an arrowhead in its middle: a ray on its way.
    pub fn ray(&mut self, from: DVec2, to: DVec2, pen: Pen) {
        self.line(from, to, pen);
        let along = (to - from).normalize();
        self.head((from + to) / 2.0 + along * 6.0, along, pen);
    }

    /// An arrowhead with its tip at `tip`.
    fn head(&mut self, tip: DVec2, along: DVec2, pen: Pen) {
        let (back, aside) = (tip - along * 12.0, along.perp() * 4.5);
        self.area(&[tip, back + aside, back - aside], pen.color);
    }

    /// A circle, filled.
    pub fn circle(&mut self, center: DVec2, radius: f64, fill: &str, pen: Pen) {
        self.push(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {} fill=\"{fill}\"/>",
            number(center.x),
            number(center.y),
            number(radius),
            stroke(pen)
        ));
    }

    /// A point that a label names.
    pub fn dot(&mut self, at: DVec2) {
        self.push(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"3.6\" fill=\"{}\"/>",
            number(at.x),
            number(at.y),
            INK.color
        ));
    }

    /// Part of a circle, from one angle to another in full turns; a quarter turn is down.
    pub fn arc(&mut self, center: DVec2, radius: f64, from: f64, to: f64, pen: Pen) {
        let at = |i| center + circle(from + (to - from) * f64::from(i) / 48.0) * radius;
        self.curve(&(0..=48).map(at).collect::<Vec<_>>(), pen);
    }

    /// Marks the angle at `vertex` between the directions of `a` and `b`, less than half a turn,
    /// and labels it in its middle.
    pub fn angle(&mut self, vertex: DVec2, a: DVec2, b: DVec2, radius: f64, label: &str, pen: Pen) {
        let (from, to) = ((a - vertex).normalize(), (b - vertex).normalize());
        // Halving again and again needs no trigonometry.
        let mut directions = vec![from, to];
        for _ in 0..5 {
            let pairs = directions.windows(2);
            let mut finer: Vec<_> = pairs.flat_map(|p| [p[0], (p[0] + p[1]).normalize()]).collect();
            finer.push(to);
            directions = finer;
        }
        let points: Vec<_> = directions.iter().map(|d| vertex + *d * radius).collect();
        self.curve(&points, Pen { width: 1.4, ..pen });
        let middle = vertex + (from + to).normalize() * (radius + 14.0);
        self.label(middle + dvec2(0.0, 6.0), label, Anchor::Middle);
    }

    /// Marks a right angle at `vertex` between the directions of `a` and `b`.
    pub fn right_angle(&mut self, vertex: DVec2, a: DVec2, b: DVec2) {
        let (a, b) = ((a - vertex).normalize() * 11.0, (b - vertex).normalize() * 11.0);
        self.curve(&[vertex + a, vertex + a + b, vertex + b], FINE);
    }

    /// A length, with a stroke at each end and its name beside its middle.
    pub fn measure(&mut self, from: DVec2, to: DVec2, label: &str, aside: DVec2) {
        self.line(from, to, FINE);
        let across = (to - from).normalize().perp() * 6.0;
        for end in [from, to] {
            self.line(end - across, end + across, FINE);
        }
        self.label((from + to) / 2.0 + aside, label, Anchor::Middle);
    }

    /// A label whose baseline begins, ends or has its middle at `at`. `→` before letters makes them
    /// a vector; what follows `_` is an index.
    pub fn label(&mut self, at: DVec2, text: &str, anchor: Anchor) {
        let (name, index) = text.split_once('_').unwrap_or((text, ""));
        let runs = runs(name);
        let wide = runs.iter().map(|(run, _)| width(run)).sum::<f64>() * FONT;
        let narrow = width(index) * SMALL;
        let mut left = match anchor {
            Anchor::Start => at.x,
            Anchor::Middle => at.x - (wide + narrow) / 2.0,
            Anchor::End => at.x - wide - narrow,
        };
        let mut vectors = Vec::new();
        // Set from their middles, so that the arrows stand above the letters in any font.
        for (run, is_vector) in runs {
            let wide = width(run) * FONT;
            self.text(dvec2(left + wide / 2.0, at.y), FONT, run);
            if is_vector {
                vectors.push((left, left + wide + 3.0));
            }
            left += wide;
        }
        if !index.is_empty() {
            self.text(dvec2(left + narrow / 2.0, at.y + 5.0), SMALL, index);
        }
        for (tail, tip) in vectors {
            let pen = Pen { width: 1.2, ..INK };
            let (tail, tip) = (dvec2(tail, at.y - 18.0), dvec2(tip, at.y - 18.0));
            self.line(tail, tip, pen);
            self.curve(&[tip - dvec2(4.0, 3.0), tip, tip - dvec2(4.0, -3.0)], pen);
        }
    }

    fn text(&mut self, middle: DVec2, size: f64, text: &str) {
        let (x, y, text) = (number(middle.x), number(middle.y), escaped(text));
        self.push(format_args!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\">{text}</text>"));
    }

    /// The file.
    pub fn finish(self) -> Vec<u8> {
        let (width, height) = (number(self.size.x), number(self.size.y));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"STIX Two Text, Latin \
             Modern Roman, Times New Roman, Times, serif\" font-style=\"italic\" \
             text-anchor=\"middle\" fill=\"{}\">\n<title>{}</title>\n<rect width=\"{width}\" \
             height=\"{height}\" rx=\"10\" fill=\"#ffffff\"/>\n{}</svg>\n",
            INK.color,
            escaped(self.title),
            self.body
        )
        .into_bytes()
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Returns the parts of a label in order, and of each if it is a vector.
fn runs(name: &str) -> Vec<(&str, bool)> {
    let mut parts = name.split('→');
    let mut runs = vec![(parts.next().unwrap_or_default(), false)];
    for part in parts {
        let (vector, rest) =
            part.split_at(part.find(|c: char| !c.is_alphabetic()).unwrap_or(part.len()));
        runs.extend([(vector, true), (rest, false)]);
    }
    runs.retain(|(run, _)| !run.is_empty());
    runs
}

/// About how wide a text is, in units of its size.
fn width(text: &str) -> f64 {
    let width = |c: char| match c {
        'm' | 'w' => 0.72,
        'M' | 'Ω' => 0.8,
        c if c.is_uppercase() => 0.66,
        ' ' | '(' | ')' | ',' | '·' | '|' | '‖' => 0.3,
        _ => 0.5,
    };
    text.chars().map(width).sum()
}

/// Hundredths, without needless zeros.
fn number(x: f64) -> String {
    let rounded = (x * 100.0).round() / 100.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn path(points: &[DVec2]) -> String {
    let points: Vec<_> = points.iter().map(|p| number(p.x) + " " + &number(p.y)).collect();
    points.join("L")
}

fn stroke(pen: Pen) -> String {
    let dashes = if pen.dashed { " stroke-dasharray=\"6 5\"" } else { "" };
    format!(
        "stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dashes}",
        pen.color, pen.width
    )
}
