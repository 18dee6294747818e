//! The room: a loggia with an arcade to the left, two niches and a passage at the back.
//!
//! x runs to the right, y up, z towards the viewer. It has no floor: it stands on the ground of
//! the scene it is put in.

use glam::{DVec2, DVec3};
use serde_json::json;

use super::{paint, vase};
use crate::glb::{Glb, at, turned};
use crate::shape::{Shape, circle, smooth};

/// Width of a bay of the arcade, and how many there are to the left and at the back.
const BAY: f64 = 3.2;
const SIDE_BAYS: i32 = 4;
const BACK_BAYS: i32 = 3;
/// The arcade's wall: thickness, where the arches spring, where it ends, the arches' radius.
const THICK: f64 = 0.44;
const SPRING: f64 = 2.4;
const TOP: f64 = 4.5;
const RADIUS: f64 = 1.36;
/// Half the room's width, and where its back arcade stands.
const HALF: f64 = BAY * 1.5;
const BACK: f64 = -6.0;
/// The wall behind the niches, and the end of the room behind the viewer.
const END: f64 = BACK - 1.3;
const FRONT: f64 = BACK + BAY * 4.0;

fn profile(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&p| DVec2::from(p)).collect()
}

/// A column from the ground to where the arches spring: its square plates, and its round parts.
fn column() -> (Shape, Shape) {
    let plates = Shape::default().cuboid([-0.27, 0.0, -0.27], [0.27, 0.12, 0.27], 1.0).cuboid(
        [-0.27, SPRING - 0.1, -0.27],
        [0.27, SPRING, 0.27],
        1.0,
    );
    let bulge = |r: f64, y: f64, h: f64| {
        let rim = (0..=8).map(|k| {
            let c = circle(-0.25 + f64::from(k) / 16.0);
            DVec2::new(r + h * c.x, y + h * c.y)
        });
        rim.collect::<Vec<_>>()
    };
    let shaft: Vec<_> = (0..=8)
        .map(|k| {
            // Entasis: the shaft swells a little below its middle.
            let t = f64::from(k) / 8.0;
            DVec2::new(0.185 - 0.035 * t * t, 0.26 + t * (SPRING - 0.26 - 0.36))
        })
        .collect();
    let bell = profile(&[
        (0.15, SPRING - 0.32),
        (0.16, SPRING - 0.24),
        (0.19, SPRING - 0.16),
        (0.24, SPRING - 0.1),
    ]);
    let round = Shape::default()
        .lathe(&bulge(0.2, 0.17, 0.05), 32, [0.0, 1.0])
        .lathe(&bulge(0.185, 0.24, 0.025), 32, [0.0, 1.0])
        .lathe(&shaft, 32, [0.0, 1.0])
        .lathe(&bulge(0.15, SPRING - 0.34, 0.025), 32, [0.0, 1.0])
        .lathe(&bell, 32, [0.0, 1.0]);
    (plates, round)
}

/// A torus knot that winds three times around and twice through, about its centre.
fn knot() -> Shape {
    let count = 180;
    let curve: Vec<_> = (0..=count)
        .map(|k| {
            let t = f64::from(k % count) / f64::from(count);
            let (around, through) = (circle(2.0 * t), circle(3.0 * t));
            let r = 0.3 + 0.13 * through.x;
            DVec3::new(r * around.x, r * around.y, 0.13 * through.y)
        })
        .collect();
    Shape::default().tube(&curve, 0.07, 16)
}

/// Adds the garden that is seen through the arches: a hedge to the left and one at the back, and cypresses.
fn garden(glb: &mut Glb, hedge: usize, cypress: usize) {
    let garden = glb.node("garden", None, at(0.0, 0.0, 0.0));
    let row = Shape::default().cuboid([-7.0, 0.0, -0.4], [7.0, 1.9, 0.4], 1.0);
    let row = glb.mesh("hedge", &[(&row, hedge)]);
    let (left, back) = (-11.0, -14.0);
    glb.add_node("back hedge", Some(garden), row, at(left + 6.6, 0.0, back));
    let turn = turned([left, 0.0, back + 6.6], DVec3::X, DVec3::NEG_Z);
    glb.add_node("left hedge", Some(garden), row, turn);
    let flame =
        profile(&[(0.16, 0.0), (0.17, 0.35), (0.5, 0.6), (0.68, 1.3), (0.62, 2.6), (0.36, 4.3)]);
    let flame: Vec<_> = flame.iter().map(|p| DVec3::new(p.x, p.y, 0.0)).collect();
    let mut flame: Vec<_> = smooth(&flame, 3).into_iter().map(DVec3::truncate).collect();
    flame.push(DVec2::new(0.0, 5.4));
    let tree = glb.mesh("cypress", &[(&Shape::default().lathe(&flame, 20, [0.0, 1.0]), cypress)]);
    // Where each stands, and how much it has grown.
    let trees = [
        (left - 1.3, -13.0, 0.95),
        (left - 1.1, -9.4, 0.8),
        (left - 1.4, -6.4, 0.9),
        (-7.6, back - 1.3, 0.85),
        (-3.3, back - 1.2, 0.9),
        (-1.4, back - 1.5, 0.72),
        (1.3, back - 1.2, 0.85),
    ];
    for (i, (x, z, size)) in trees.into_iter().enumerate() {
        let mut place = at(x, 0.0, z);
        place["scale"] = json!([size, size, size]);
        glb.add_node(&format!("cypress {i}"), Some(garden), tree, place);
    }
}

/// The whole file.
pub fn glb() -> Vec<u8> {
    let mut glb = Glb::default();
    let wood = glb.picture("wood", &paint::wood());
    let tile = glb.picture("tile", &paint::tile());
    let landscape = glb.picture("landscape", &paint::landscape());
    let plaster = glb.material("plaster", [0.74, 0.60, 0.42], 0.0, 0.9);
    let stone = glb.material("stone", [0.70, 0.65, 0.56], 0.0, 0.6);
    let red = glb.material("pompeian red", [0.36, 0.07, 0.045], 0.0, 0.8);
    let bronze = glb.material("bronze", [0.80, 0.50, 0.22], 0.45, 0.38);
    let ivory = glb.material("ivory", [0.72, 0.68, 0.58], 0.0, 0.3);
    // The shade of the lamp is a thin sheet.
    let iron = glb.double_sided("iron", [0.05, 0.05, 0.055], 0.0, 0.5);
    let hedge = glb.material("hedge", [0.075, 0.135, 0.045], 0.0, 1.0);
    let cypress = glb.material("cypress", [0.035, 0.085, 0.04], 0.0, 1.0);
    let bulb = glb.glowing("bulb", [1.0, 0.85, 0.6]);
    let wood = glb.textured("wood", wood, 0.55);
    let tile = glb.textured("tile", tile, 0.3);
    let landscape = glb.textured("landscape", landscape, 0.9);

    // One bay and one column, each stored once.
    let arch = Shape::default().arch([BAY, THICK], [SPRING, TOP], RADIUS, 40);
    let band = Shape::default().band([RADIUS - 0.02, RADIUS + 0.16], THICK + 0.1, SPRING, 40);
    let bay = glb.mesh("bay", &[(&arch, plaster), (&band, stone)]);
    let (plates, round) = column();
    let column = glb.mesh("column", &[(&plates, stone), (&round, stone)]);
    let arcade = |glb: &mut Glb, name: &str, count: i32, columns: i32, place| {
        let parent = glb.node(name, None, place);
        for i in 0..columns {
            let x = f64::from(i) * BAY;
            glb.add_node(&format!("{name} column {i}"), Some(parent), column, at(x, 0.0, 0.0));
            if i < count {
                glb.add_node(
                    &format!("{name} bay {i}"),
                    Some(parent),
                    bay,
                    at(x + BAY / 2.0, 0.0, 0.0),
                );
            }
        }
    };
    // The column in the corner belongs to the back alone.
    arcade(&mut glb, "back", BACK_BAYS, BACK_BAYS + 1, at(-HALF, 0.0, BACK));
    arcade(
        &mut glb,
        "left",
        SIDE_BAYS,
        SIDE_BAYS,
        turned([-HALF, 0.0, FRONT], DVec3::X, DVec3::NEG_Z),
    );

    let (inner, outer) = (HALF - 0.2, HALF + 0.24);
    let half_bay = BAY / 2.0;
    let walls = Shape::default().cuboid([inner, 0.0, END - 0.3], [outer, TOP, FRONT], 1.0).cuboid(
        [-outer, 0.0, FRONT],
        [outer, TOP, FRONT + 0.3],
        1.0,
    );
    let (low, high) = ([-outer, TOP, END - 0.3], [outer, TOP + 0.3, FRONT]);
    let boards = Shape::default().cuboid(low, high, 0.8);
    let niches = Shape::default()
        .cuboid([-outer, 0.0, END - 0.3], [-half_bay + 0.1, TOP, END], 1.0)
        .cuboid([half_bay - 0.1, 0.0, END - 0.3], [outer, TOP, END], 1.0)
        .cuboid([-half_bay - 0.1, 0.0, END], [-half_bay + 0.1, TOP, BACK - 0.2], 1.0)
        .cuboid([half_bay - 0.1, 0.0, END], [half_bay + 0.1, TOP, BACK - 0.2], 1.0)
        .cuboid([-outer, 0.0, END - 0.3], [-outer + 0.3, TOP, BACK - 0.2], 1.0);
    let dado = Shape::default().cuboid([inner - 0.02, 0.08, BACK], [inner, 1.03, FRONT], 0.19);
    let cornice = Shape::default()
        .cuboid([inner - 0.05, 1.03, BACK], [inner, 1.09, FRONT], 1.0)
        .cuboid([inner - 0.05, 0.0, BACK], [inner, 0.08, FRONT], 1.0)
        .cuboid([-HALF, TOP - 0.3, BACK + 0.22], [inner, TOP - 0.2, BACK + 0.3], 1.0);
    let walls = glb.mesh(
        "walls",
        &[(&walls, plaster), (&boards, wood), (&niches, red), (&dado, tile), (&cornice, stone)],
    );
    glb.add_node("walls", None, walls, at(0.0, 0.0, 0.0));

    let beam = Shape::default().cuboid([-HALF, TOP - 0.2, -0.09], [inner, TOP, 0.09], 0.6);
    let beam = glb.mesh("beam", &[(&beam, wood)]);
    let ceiling = glb.node("ceiling", None, at(0.0, 0.0, BACK));
    for i in 1..16 {
        let z = f64::from(i) * 0.8;
        glb.add_node(&format!("beam {i}"), Some(ceiling), beam, at(0.0, 0.0, z));
    }

    // What stands in the niches, each on a plinth.
    let plinth = Shape::default()
        .cuboid([-0.42, 0.0, -0.36], [0.42, 0.12, 0.36], 1.0)
        .cuboid([-0.35, 0.12, -0.3], [0.35, 0.88, 0.3], 1.0)
        .cuboid([-0.4, 0.88, -0.34], [0.4, 0.96, 0.34], 1.0);
    let plinth = glb.mesh("plinth", &[(&plinth, stone)]);
    let knot = glb.mesh("knot", &[(&knot(), bronze)]);
    let urn = glb.mesh("urn", &[(&vase::body(), ivory), (&vase::fittings(), ivory)]);
    let left = glb.add_node("left plinth", None, plinth, at(-BAY, 0.0, BACK - 0.62));
    glb.add_node("knot", Some(left), knot, at(0.0, 1.46, 0.0));
    let right = glb.add_node("right plinth", None, plinth, at(BAY, 0.0, BACK - 0.62));
    glb.add_node("urn", Some(right), urn, at(0.0, 0.96, 0.0));

    // A bench and a picture along the right wall; both are made facing the viewer and turned.
    let bench = Shape::default()
        .cuboid([-0.95, 0.42, -0.22], [0.95, 0.48, 0.22], 0.5)
        .cuboid([-0.78, 0.0, -0.18], [-0.7, 0.42, 0.18], 0.5)
        .cuboid([0.7, 0.0, -0.18], [0.78, 0.42, 0.18], 0.5)
        .cuboid([-0.7, 0.14, -0.03], [0.7, 0.22, 0.03], 0.5);
    let bench = glb.mesh("bench", &[(&bench, wood)]);
    glb.add_node("bench", None, bench, turned([inner - 0.42, 0.0, -3.9], DVec3::Z, DVec3::NEG_X));
    let (w, h, rim) = (0.96, 0.64, 0.09);
    let mut canvas = Shape::default();
    let corners = [(-w, -h), (w, -h), (w, h), (-w, h)].map(|(x, y)| DVec3::new(x, y, 0.03));
    canvas.polygon(&corners, |p| DVec2::new(0.5 + 0.5 * p.x / w, 0.5 - 0.5 * p.y / h));
    let frame = Shape::default()
        .cuboid([-w - rim, h, 0.0], [w + rim, h + rim, 0.07], 0.5)
        .cuboid([-w - rim, -h - rim, 0.0], [w + rim, -h, 0.07], 0.5)
        .cuboid([-w - rim, -h, 0.0], [-w, h, 0.07], 0.5)
        .cuboid([w, -h, 0.0], [w + rim, h, 0.07], 0.5);
    let picture = glb.mesh("picture", &[(&canvas, landscape), (&frame, wood)]);
    glb.add_node("picture", None, picture, turned([inner, 2.15, -3.9], DVec3::Z, DVec3::NEG_X));

    // A lamp that hangs from the ceiling: its light is below the bulb, which would keep it.
    let shade = profile(&[(0.36, 0.0), (0.33, 0.07), (0.22, 0.17), (0.06, 0.24), (0.03, 0.3)]);
    let shade = Shape::default().lathe(&shade, 40, [0.0, 1.0]).cuboid(
        [-0.01, 0.3, -0.01],
        [0.01, 1.3, 0.01],
        1.0,
    );
    let globe: Vec<_> = (0..=12)
        .map(|k| circle(-0.25 + f64::from(k) / 24.0) * 0.07 + DVec2::new(0.0, 0.09))
        .map(|p| DVec2::new(if p.x < 1e-9 { 0.0 } else { p.x }, p.y))
        .collect();
    let globe = Shape::default().lathe(&globe, 24, [0.0, 1.0]);
    let lamp = glb.mesh("lamp", &[(&shade, iron), (&globe, bulb)]);
    let lamp = glb.add_node("lamp", None, lamp, at(2.4, TOP - 1.3, -2.4));
    let light = glb.node("lamp light", Some(lamp), at(0.0, -0.02, 0.0));
    glb.light(
        light,
        json!({ "name": "lamp", "type": "point", "color": [1.0, 0.78, 0.5], "intensity": 8.0 }),
    );
    let sun = turned([-8.0, 8.0, 4.0], DVec3::NEG_Z, DVec3::new(0.84, -0.4, -0.44));
    let sun = glb.node("sun", None, sun);
    glb.light(
        sun,
        json!({ "name": "sun", "type": "directional", "color": [1.0, 0.9, 0.74], "intensity": 4.6 }),
    );

    garden(&mut glb, hedge, cypress);

    let eye = DVec3::new(1.25, 1.55, 4.6);
    let target = DVec3::new(-0.35, 1.3, -4.0);
    let view = turned(eye.to_array(), DVec3::NEG_Z, target - eye);
    let view = glb.node("view", None, view);
    let lens = json!({ "yfov": 0.76, "aspectRatio": 1.7777778, "znear": 0.1 });
    glb.camera(view, json!({ "name": "view", "type": "perspective", "perspective": lens }));
    glb.finish("envers xtask make-assets")
}
