//! The nodes of an animation: coordinate spaces that move.

use std::f64::consts::TAU;

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::curve::Curve;

/// The index of a node in `Animation::nodes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

/// A coordinate space that moves within its parent's, or within the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The parent, which comes before it; none for the world.
    pub parent: Option<NodeId>,
    /// The fixed transform, applied after the motion, to the parent's space.
    pub base: DAffine3,
    /// The motion.
    pub motion: Motion,
}

/// The motion of a node.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Motion {
    /// A transform by keyframes: scale, then rotation, then translation.
    Keyframes(Keyframes),
    /// A rotation about a centre, which may move. The node's space at time 0 is the world's, and the
    /// node has neither parent nor base transform.
    Orbit(Orbit),
}

/// The keyframes of a transform: a curve for each of glTF's target paths `translation`, `rotation` and
/// `scale`.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    /// The translation.
    pub translation: Curve<DVec3>,
    /// The rotation.
    pub rotation: Rotation,
    /// The scale along the node's own axes.
    pub scale: Curve<DVec3>,
    /// The time in seconds after which it repeats, above 0; none if it does not.
    pub period: Option<f64>,
}

/// The curve of a rotation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rotation {
    /// Angles in radians about the fixed x axis, then y, then z, interpolated separately: 0 to 4π is
    /// two turns.
    Angles(Curve<DVec3>),
    /// Quaternions, interpolated along the shorter arc.
    Quaternions(Curve<DQuat>),
}

/// A point that is attached to a node, or fixed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The node; none for the world.
    pub node: Option<NodeId>,
    /// The point, in the node's space.
    pub point: DVec3,
}

/// A rotation about an axis through a centre that may move.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// The centre.
    pub around: Anchor,
    /// The position of the centre at time 0, in world space.
    pub center: DVec3,
    /// The position at time 0 of the point that orbits, in world space.
    pub start: DVec3,
    /// The axis, of length 1; the rotation is by the right-hand rule: counterclockwise, seen against
    /// the axis.
    pub axis: DVec3,
    /// The time of one turn in seconds, not 0; infinite for what only moves along with its centre.
    pub period: f64,
    /// True if the node's space turns too, so that the same side always faces the centre.
    pub turns_with_orbit: bool,
}

impl Keyframes {
    /// The keyframes of the identity transform, to be replaced in part.
    pub fn identity() -> Self {
        Self {
            translation: Curve::constant(DVec3::ZERO),
            rotation: Rotation::Quaternions(Curve::constant(DQuat::IDENTITY)),
            scale: Curve::constant(DVec3::ONE),
            period: None,
        }
    }

    fn transform(&self, time: f64) -> DAffine3 {
        let time = self.period.map_or(time, |period| time.rem_euclid(period));
        let rotation = match &self.rotation {
            Rotation::Angles(curve) => about_fixed_axes(curve.sample(time)),
            Rotation::Quaternions(curve) => DMat3::from_quat(curve.sample(time)),
        };
        let scale = DMat3::from_diagonal(self.scale.sample(time));
        DAffine3 { matrix3: rotation * scale, translation: self.translation.sample(time) }
    }
}

impl Anchor {
    /// A point that is fixed in the world.
    pub fn fixed(point: DVec3) -> Self {
        Self { node: None, point }
    }

    /// The position in world space, given the nodes' transforms to world space.
    pub(super) fn position(&self, worlds: &[DAffine3]) -> DVec3 {
        let in_world = |NodeId(node)| worlds[node as usize].transform_point3(self.point);
        self.node.map_or(self.point, in_world)
    }
}

impl Orbit {
    fn transform(&self, time: f64, center: DVec3) -> DAffine3 {
        // Whole turns are dropped first, so that the angle is as exact after a million of them.
        let turn = DMat3::from_axis_angle(self.axis, TAU * (time / self.period).fract());
        if self.turns_with_orbit {
            let translation = center - turn * self.center;
            DAffine3 { matrix3: turn, translation }
        } else {
            let there = center + turn * (self.start - self.center);
            DAffine3::from_translation(there - self.start)
        }
    }
}

/// The transforms of all nodes to world space, at a time in seconds.
pub(super) fn world_transforms(nodes: &[Node], time: f64) -> Vec<DAffine3> {
    let mut worlds = Vec::with_capacity(nodes.len());
    for node in nodes {
        let local = match &node.motion {
            Motion::Keyframes(keys) => node.base * keys.transform(time),
            Motion::Orbit(orbit) => orbit.transform(time, orbit.around.position(&worlds)),
        };
        // Parents come first, so that theirs is known.
        worlds.push(node.parent.map_or(local, |NodeId(parent)| worlds[parent as usize] * local));
    }
    worlds
}

/// The rotation by angles in radians about the fixed x axis, then y, then z.
fn about_fixed_axes(angles: DVec3) -> DMat3 {
    DMat3::from_rotation_z(angles.z)
        * DMat3::from_rotation_y(angles.y)
        * DMat3::from_rotation_x(angles.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn orbit(turn: bool) -> Orbit {
        Orbit {
            around: Anchor::fixed(DVec3::X),
            center: DVec3::X,
            start: DVec3::X * 3.0,
            axis: DVec3::Y,
            period: 4.0,
            turns_with_orbit: turn,
        }
    }

    fn free(motion: Motion) -> Node {
        Node { parent: None, base: DAffine3::IDENTITY, motion }
    }

    #[test]
    fn a_quarter_of_the_period_is_a_quarter_turn_by_the_right_hand_rule() {
        for turn in [false, true] {
            let world = world_transforms(&[free(Motion::Orbit(orbit(turn)))], 1.0)[0];
            let there = world.transform_point3(DVec3::X * 3.0);
            assert!((there - DVec3::new(1.0, 0.0, -2.0)).length() < 1e-15, "{there}");
        }
    }

    #[test]
    fn what_does_not_turn_keeps_its_directions() {
        let facing = |turn| orbit(turn).transform(1.0, DVec3::X).matrix3 * DVec3::X;
        assert_eq!(facing(false), DVec3::X);
        assert!((facing(true) - DVec3::NEG_Z).length() < 1e-15);
    }

    #[test]
    fn time_zero_and_whole_periods_leave_everything_where_it_was() {
        for time in [0.0, 4.0, 4e6] {
            assert_eq!(orbit(true).transform(time, DVec3::X), DAffine3::IDENTITY);
        }
    }

    #[test]
    fn without_a_period_it_keeps_beside_its_centre() {
        let follows = Orbit { period: f64::INFINITY, ..orbit(false) };
        let moved = follows.transform(7.0, DVec3::new(1.0, 5.0, 0.0));
        assert_eq!(moved, DAffine3::from_translation(DVec3::Y * 5.0));
    }

    #[test]
    fn a_moon_goes_round_a_planet_that_goes_round_a_sun() {
        let planet = Orbit {
            around: Anchor::fixed(DVec3::ZERO),
            center: DVec3::ZERO,
            start: DVec3::X * 10.0,
            axis: DVec3::Y,
            period: 8.0,
            turns_with_orbit: false,
        };
        let moon = Orbit {
            around: Anchor { node: Some(NodeId(0)), point: DVec3::X * 10.0 },
            center: DVec3::X * 10.0,
            start: DVec3::X * 11.0,
            period: 4.0,
            ..planet.clone()
        };
        let nodes = [free(Motion::Orbit(planet)), free(Motion::Orbit(moon))];
        let there = world_transforms(&nodes, 2.0)[1].transform_point3(DVec3::X * 11.0);
        // The planet after a quarter turn, the moon beside it after half a one.
        assert!((there - DVec3::new(-1.0, 0.0, -10.0)).length() < 1e-14, "{there}");
    }

    #[test]
    fn a_child_moves_within_its_parent() {
        let mut parent = Keyframes::identity();
        parent.translation = Curve::constant(DVec3::X);
        parent.scale = Curve::constant(DVec3::splat(2.0));
        let mut child = Keyframes::identity();
        child.translation = Curve::constant(DVec3::Y);
        let nodes = [
            free(Motion::Keyframes(parent)),
            Node {
                parent: Some(NodeId(0)),
                base: DAffine3::from_translation(DVec3::Z),
                motion: Motion::Keyframes(child),
            },
        ];
        assert_eq!(
            world_transforms(&nodes, 0.0)[1].transform_point3(DVec3::ZERO),
            DVec3::new(1., 2., 2.)
        );
    }

    #[test]
    fn angles_turn_as_often_as_they_say() {
        let angles = Curve {
            times: vec![0.0, 8.0],
            values: vec![DVec3::ZERO, DVec3::Y * (2.0 * TAU)],
            interpolation: super::super::Interpolation::Linear,
        };
        let keys = Keyframes { rotation: Rotation::Angles(angles), ..Keyframes::identity() };
        // After an eighth of two turns, a quarter turn.
        let turned = keys.transform(1.0).matrix3 * DVec3::Z;
        assert!((turned - DVec3::X).length() < 1e-15, "{turned}");
    }

    #[test]
    fn what_repeats_begins_again() {
        let translation = Curve {
            times: vec![0.0, 2.0],
            values: vec![DVec3::ZERO, DVec3::X],
            interpolation: super::super::Interpolation::Linear,
        };
        let keys = Keyframes { translation, period: Some(2.0), ..Keyframes::identity() };
        assert_eq!(keys.transform(5.0).translation, DVec3::X * 0.5);
    }
}
