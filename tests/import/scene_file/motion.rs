//! `[animation]`: what it makes of a scene, and what it refuses.

use super::{CAMERA, File, refused, scene, seen};
use envers::{Error, LightKind, Projection, Scene};
use glam::{DVec3, Vec3};

/// Two seconds in four frames a second.
const FRAMES: &str = "[animation]\nframes = 8\nfps = 4\n";
const BALL: &str = "[[sphere]]\nname = \"ball\"\ncenter = [2, 0, 0]\nradius = 1\n";
const LAMP: &str = "[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 1, 0]\n";

/// An orbit of the ball about the origin, in four seconds.
const ORBIT: &str = "[[animation.orbit]]\nobject = \"ball\"\naround = [0, 0, 0]\nperiod = 4\n";

fn track(object: &str, keys: &str) -> String {
    format!("[[animation.track]]\nobject = \"{object}\"\n{keys}\n")
}

/// A scene with the ball, as it is at a time.
fn moved(text: &str, time: f64) -> Scene {
    seen(&format!("{FRAMES}{BALL}{text}")).at_time(time).unwrap()
}

fn near(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from(b)).length() < 1e-12
}

/// Returns the error of a scene with the ball; its place is that of the mark.
fn refused_of_the_ball(text: &str) -> Error {
    refused(&format!("{CAMERA}{FRAMES}{BALL}{text}"))
}

fn help(error: &Error) -> &str {
    error.advice().unwrap_or_default()
}

#[test]
fn frames_are_at_their_times_from_zero_on() {
    let animation = seen(FRAMES).animation.unwrap();
    assert_eq!((animation.frames, animation.fps, animation.duration()), (8, 4.0, 2.0));
    assert_eq!([1, 2, 8].map(|frame| animation.time(frame)), [0.0, 0.25, 1.75]);
}

#[test]
fn a_rate_left_out_is_24() {
    assert_eq!(seen("[animation]\nframes = 8\n").animation.unwrap().fps, 24.0);
}

#[test]
fn a_file_without_the_table_does_not_move() {
    assert_eq!(seen(BALL).animation, None);
}

#[test]
fn an_orbit_starts_where_the_object_stands_and_turns_by_the_right_hand() {
    assert!(near(moved(ORBIT, 0.0).spheres[0].center, [2., 0., 0.]));
    assert!(near(moved(ORBIT, 1.0).spheres[0].center, [0., 0., -2.]));
    let over = format!("{ORBIT}axis = [0, 0, 9]\n");
    assert!(near(moved(&over, 1.0).spheres[0].center, [0., 2., 0.]));
}

#[test]
fn an_orbit_goes_round_what_moves_itself() {
    let moon = "[[sphere]]\nname = \"moon\"\ncenter = [3, 0, 0]\nradius = 0.1\n\
        [[animation.orbit]]\nobject = \"moon\"\naround = \"ball\"\nperiod = 2\n";
    // Whichever comes first in the file.
    for text in [format!("{ORBIT}{moon}"), format!("{moon}{ORBIT}")] {
        assert!(near(moved(&text, 1.0).spheres[1].center, [-1., 0., -2.]), "{text}");
    }
}

#[test]
fn an_orbit_without_a_period_keeps_beside_its_centre() {
    let lamp = "[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [2, 1, 0]\n\
        [[animation.orbit]]\nobject = \"lamp\"\naround = \"ball\"\n";
    let scene = moved(&format!("{ORBIT}{lamp}"), 1.0);
    let LightKind::Point { position, .. } = scene.lights[0].kind else { panic!("a point light") };
    assert!(near(position, [0., 1., -2.]));
}

#[test]
fn an_orbit_goes_round_what_a_track_moves() {
    let centre = "[[sphere]]\nname = \"hub\"\ncenter = [9, 9, 9]\nradius = 0.1\n";
    let moves = track("hub", "times = [0, 2]\ncenter = [[0, 0, 0], [0, 4, 0]]");
    let orbit = ORBIT.replace("[0, 0, 0]", "\"hub\"");
    let scene = moved(&format!("{centre}{moves}{orbit}"), 1.0);
    assert!(near(scene.spheres[0].center, [0., 2., -2.]), "{}", scene.spheres[0].center);
}

#[test]
fn a_camera_keeps_looking_at_a_point_as_it_goes_round() {
    let text = format!(
        "[camera]\nname = \"eye\"\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n{FRAMES}\
        [[animation.orbit]]\nobject = \"eye\"\naround = [0, 0, 0]\nperiod = 4\n"
    );
    let camera = &scene(&text).at_time(1.0).unwrap().cameras[0];
    assert!(near(camera.position, [5., 0., 0.]) && near(camera.forward, [-1., 0., 0.]));
}

#[test]
fn a_camera_keeps_looking_at_an_object_that_moves() {
    let text =
        format!("camera.position = [0, 0, 5]\ncamera.look_at = \"ball\"\n{FRAMES}{BALL}{ORBIT}");
    let camera = &scene(&text).at_time(1.0).unwrap().cameras[0];
    assert!(near(camera.forward, [0., 0., -1.]));
    let toward = DVec3::new(2.0, 0.0, -5.0).normalize();
    assert!(near(scene(&text).cameras[0].forward, toward.to_array()));
}

#[test]
fn a_camera_with_a_direction_keeps_it_unless_it_turns() {
    let text = format!(
        "[camera]\nname = \"eye\"\nposition = [0, 0, 5]\ndirection = [0, 0, -1]\n{FRAMES}\
        [[animation.orbit]]\nobject = \"eye\"\naround = [0, 0, 0]\nperiod = 4\n"
    );
    let forward = |text: &str| scene(text).at_time(1.0).unwrap().cameras[0].forward;
    assert!(near(forward(&text), [0., 0., -1.]));
    assert!(near(forward(&format!("{text}turn = true\n")), [-1., 0., 0.]));
}

#[test]
fn tracks_change_a_spheres_centre_and_radius() {
    let keys = "times = [0, 1]\ncenter = [[0, 0, 0], [4, 0, 0]]\nradius = [1, 3]";
    let sphere = moved(&track("ball", keys), 0.25).spheres[0];
    assert!(near(sphere.center, [1., 0., 0.]) && sphere.radius == 1.5);
}

#[test]
fn interpolation_is_linear_step_or_smooth() {
    let radius = |interpolation: &str| {
        let keys = format!("times = [0, 1]\nradius = [1, 3]\ninterpolation = \"{interpolation}\"");
        moved(&track("ball", &keys), 0.25).spheres[0].radius
    };
    // Smooth between two keys is 3s² − 2s³.
    assert_eq!(["linear", "step", "smooth"].map(radius), [1.5, 1.0, 1.3125]);
}

#[test]
fn tracks_change_a_lights_place_and_intensity() {
    let keys = "times = [0, 1]\nposition = [[0, 0, 0], [0, 8, 0]]\nintensity = [0, 4]";
    let scene = moved(&format!("{LAMP}color = [1, 0.5, 0]\n{}", track("lamp", keys)), 0.5);
    let LightKind::Point { position, .. } = scene.lights[0].kind else { panic!("a point light") };
    assert!(near(position, [0., 4., 0.]));
    assert_eq!(scene.lights[0].intensity, Vec3::new(2.0, 1.0, 0.0));
}

#[test]
fn a_track_changes_where_a_directional_light_travels() {
    let sun = "[[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n";
    let keys = "times = [0, 1]\ndirection = [[0, -1, 0], [-1, 0, 0]]";
    let scene = moved(&format!("{sun}{}", track("sun", keys)), 0.5);
    let LightKind::Directional { direction, .. } = scene.lights[0].kind else { panic!("the sun") };
    assert!(near(direction, [-0.5f64.sqrt(), -0.5f64.sqrt(), 0.]));
}

#[test]
fn tracks_change_a_cameras_view_and_lens() {
    let camera = "[camera]\nname = \"eye\"\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n";
    let keys = "times = [0, 1]\nlook_at = [[0, 0, 0], [10, 0, 5]]\nfov_x = [20, 60]";
    let posed = scene(&format!("{camera}{FRAMES}{}", track("eye", keys))).at_time(1.0).unwrap();
    assert!(near(posed.cameras[0].forward, [1., 0., 0.]));
    assert_eq!(posed.cameras[0].projection, Projection::FovX(60f64.to_radians()));
}

/// A file with a model in it, one triangle from the origin along x and y.
fn with_model(text: &str) -> Scene {
    let file = File::new(format!("{CAMERA}{FRAMES}{text}"));
    std::fs::write(file.beside("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    file.load().unwrap_or_else(|e| panic!("{e}")).scene
}

#[test]
fn tracks_turn_and_scale_a_model_about_its_own_origin() {
    let model = "[[model]]\nname = \"m\"\nfile = \"m.obj\"\ntranslate = [5, 0, 0]\n";
    let keys = "times = [0, 2]\nrotate = [[0, 0, 0], [0, 0, 720]]\nscale = [2, 2]";
    let scene = with_model(&format!("{model}{}", track("m", keys))).at_time(0.25).unwrap();
    // An eighth of two turns.
    assert!(near(scene.instances[0].to_world([1., 0., 0.]), [5., 2., 0.]));
}

#[test]
fn a_model_that_turns_with_its_orbit_faces_the_centre() {
    let model = "[[model]]\nname = \"m\"\nfile = \"m.obj\"\ntranslate = [5, 0, 0]\n";
    let orbit = "[[animation.orbit]]\nobject = \"m\"\naround = [0, 0, 0]\nperiod = 4\n";
    let tip =
        |text: &str| with_model(text).at_time(1.0).unwrap().instances[0].to_world([1., 0., 0.]);
    assert!(near(tip(&format!("{model}{orbit}")), [1., 0., -5.]));
    assert!(near(tip(&format!("{model}{orbit}turn = true\n")), [0., 0., -6.]));
}

#[test]
fn a_camera_that_comes_to_where_it_looks_is_named_with_the_time() {
    let camera = "[camera]\nname = \"eye\"\nposition = [0, 0, 5]\nlook_at = \"ball\"\n";
    let keys = "times = [0, 1]\nposition = [[0, 0, 5], [2, 0, 0]]\n";
    let scene = scene(&format!("{camera}{FRAMES}{BALL}{}", track("eye", keys)));
    let error = scene.at_time(1.0).unwrap_err();
    let expected = "at 1.000 s, camera `eye`: the camera looks at the point where it stands";
    assert_eq!(error.message(), expected);
}

#[test]
fn frames_are_a_whole_number_from_1_to_a_million() {
    for frames in ["0", "3.5", "4000000000"] {
        let error = refused(&format!("{CAMERA}[animation]\nframes = ¦{frames}\n"));
        let expected = "`frames`: expected a whole number from 1 to 1000000, found";
        assert_eq!(error.message(), format!("{expected} `{frames}`"));
    }
}

#[test]
fn a_number_of_frames_is_needed_and_whole() {
    let error = refused(&format!("{CAMERA}¦[animation]\nfps = 24\n"));
    assert!(error.message().contains("needs the key `frames`"), "{error}");
    for bad in ["-1", "1.5", "\"1\"", "nan"] {
        refused(&format!("{CAMERA}[animation]\nframes = ¦{bad}\n"));
    }
}

#[test]
fn a_rate_that_cannot_be_is_refused() {
    for bad in ["0", "-24", "nan", "inf", "1001"] {
        let error = refused(&format!("{CAMERA}[animation]\nframes = 8\nfps = ¦{bad}\n"));
        assert!(error.message().contains("a number above 0 (and at most 1000)"), "{error}");
    }
}

#[test]
fn an_object_that_is_not_there_is_refused_with_those_that_are() {
    let error = refused_of_the_ball(&ORBIT.replace("\"ball\"", "¦\"bal\""));
    assert_eq!(error.message(), "there is no object `bal`");
    assert_eq!(help(&error), "did you mean `ball`?");
    let error = refused_of_the_ball(&ORBIT.replace("[0, 0, 0]", "¦\"sun\""));
    assert_eq!(help(&error), "the objects with names are `ball`");
    let error = refused("camera.position = [0, 0, 5]\ncamera.look_at = ¦\"sun\"\n");
    assert_eq!(help(&error), "give a sphere, a model, a light or a camera this `name`");
}

#[test]
fn a_name_is_unique_among_all_objects() {
    let lamp = LAMP.replace("\"lamp\"", "¦\"ball\"");
    let error = refused_of_the_ball(&lamp);
    assert_eq!(error.message(), "there is a sphere `ball` already");
}

#[test]
fn an_orbit_around_itself_is_refused() {
    let error = refused_of_the_ball(&ORBIT.replace("[0, 0, 0]", "¦\"ball\""));
    assert_eq!(error.message(), "`ball` cannot go round itself");
}

#[test]
fn orbits_in_a_circle_are_refused() {
    let moon = "[[sphere]]\nname = \"moon\"\ncenter = [3, 0, 0]\nradius = 0.1\n\
        [[animation.orbit]]\nobject = \"moon\"\naround = \"ball\"\n";
    let error = refused_of_the_ball(&format!("{}{moon}", ORBIT.replace("[0, 0, 0]", "¦\"moon\"")));
    assert_eq!(error.message(), "`ball` goes round `moon`, which goes round `ball`");
}

#[test]
fn orbits_in_a_greater_circle_are_told_as_what_they_are() {
    let link = |name: &str, around: &str| {
        format!(
            "[[sphere]]\nname = \"{name}\"\ncenter = [3, 0, 0]\nradius = 0.1\n\
            [[animation.orbit]]\nobject = \"{name}\"\naround = \"{around}\"\n"
        )
    };
    let rest = link("moon", "speck") + &link("speck", "ball");
    let error = refused_of_the_ball(&format!("{}{rest}", ORBIT.replace("[0, 0, 0]", "¦\"moon\"")));
    assert_eq!(error.message(), "`ball` goes round `moon`, which in the end goes round `ball`");
}

#[test]
fn a_chain_of_ten_thousand_orbits_is_no_matter() {
    let link = |i: usize| {
        format!(
            "[[sphere]]\nname = \"{i}\"\ncenter = [{i}, 0, 0]\nradius = 0.1\n\
            [[animation.orbit]]\nobject = \"{i}\"\naround = \"{}\"\nperiod = 1\n",
            i + 1
        )
    };
    let chain: String = (0..10_000).map(link).collect();
    let end = "[[sphere]]\nname = \"10000\"\ncenter = [10000, 0, 0]\nradius = 0.1\n";
    assert_eq!(moved(&format!("{chain}{end}"), 0.5).spheres.len(), 10_002);
}

#[test]
fn two_orbits_of_one_object_are_refused() {
    let second = ORBIT.replace("\"ball\"", "¦\"ball\"");
    let error = refused_of_the_ball(&format!("{ORBIT}{second}"));
    assert_eq!(error.message(), "`ball` has an orbit already");
}

#[test]
fn an_orbit_and_a_track_of_one_place_are_refused() {
    let keys = "times = [0]\ncenter = ¦[[0, 0, 0]]";
    let error = refused_of_the_ball(&format!("{ORBIT}{}", track("ball", keys)));
    assert_eq!(error.message(), "`ball` is moved by its orbit already");
}

#[test]
fn what_is_nowhere_cannot_go_round_or_be_gone_round() {
    let haze = "[[light]]\nname = \"haze\"\nkind = \"ambient\"\n";
    let orbit = ORBIT.replace("\"ball\"", "¦\"haze\"");
    let error = refused_of_the_ball(&format!("{haze}{orbit}"));
    assert!(error.message().contains("an ambient light, which is nowhere"), "{error}");
    let orbit = ORBIT.replace("[0, 0, 0]", "¦\"haze\"");
    let error = refused_of_the_ball(&format!("{haze}{orbit}"));
    assert!(error.message().contains("an ambient light, which is nowhere"), "{error}");
}

#[test]
fn a_period_that_is_no_time_is_refused() {
    for bad in ["0", "-1", "nan", "inf"] {
        refused_of_the_ball(&ORBIT.replace("period = 4", &format!("period = ¦{bad}")));
    }
}

#[test]
fn times_that_do_not_increase_are_refused() {
    let keys = "times = [0, 2, ¦1]\nradius = [1, 2, 3]";
    let error = refused_of_the_ball(&track("ball", keys));
    assert_eq!(error.message(), "times must increase, and 1 comes after 2");
    refused_of_the_ball(&track("ball", "times = ¦[]\nradius = []"));
}

#[test]
fn more_or_fewer_values_than_times_are_refused() {
    let error = refused_of_the_ball(&track("ball", "times = [0, 2]\nradius = ¦[1]"));
    assert_eq!(error.message(), "`radius`: 1 value for 2 times");
}

#[test]
fn a_key_that_the_object_has_not_is_refused_with_those_that_it_has() {
    let error = refused_of_the_ball(&track("ball", "times = [0]\n¦rotate = [[0, 0, 0]]"));
    assert_eq!(error.message(), "`ball` is a sphere, which has no `rotate`");
    assert_eq!(help(&error), "what can change of it is `center` and `radius`");
}

#[test]
fn a_track_of_nothing_is_refused() {
    let error = refused_of_the_ball(&track("ball", "times = [0]").replace("\"ball\"", "¦\"ball\""));
    assert!(error.message().contains("says nothing of what changes"), "{error}");
}

#[test]
fn two_tracks_of_one_key_are_refused() {
    let first = track("ball", "times = [0]\nradius = [1]");
    let second = track("ball", "times = [1]\n¦radius = [2]");
    let error = refused_of_the_ball(&format!("{first}{second}"));
    assert_eq!(error.message(), "another track says how `radius` of `ball` changes");
}

#[test]
fn a_value_that_its_key_refuses_is_refused_in_a_track() {
    refused_of_the_ball(&track("ball", "times = [0, 1]\nradius = [1, ¦0]"));
    refused_of_the_ball(&track("ball", "times = [0, ¦nan]\nradius = [1, 1]"));
    refused_of_the_ball(&track("ball", "times = [0]\ncenter = [[0, ¦2e15, 0]]"));
}

#[test]
fn an_unknown_key_of_an_orbit_is_at_the_key() {
    let error = refused_of_the_ball(&format!("{ORBIT}¦centre = [0, 0, 0]\n"));
    assert!(error.message().contains("has no key `centre`"), "{error}");
}

#[test]
fn a_model_without_animations_plays_none() {
    let model = "[[model]]\nfile = \"m.obj\"\nanimation = \"walk\"\n";
    let file = File::new(format!("{CAMERA}{FRAMES}{model}"));
    std::fs::write(file.beside("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let error = file.load().unwrap_err();
    assert!(error.to_string().contains("an OBJ file has no animations"), "{error}");
}
