//! The meaning of scene files.

use envers::scene::{Filter, IntegratorKind, LightShape, SamplePosition, Transfer};
use envers::{
    AdaptiveSampling, AlphaMode, Camera, Falloff, FilmSettings, Light, LightKind, Material,
    Projection, Shadow, Sphere, Tone,
};
use glam::{DVec3, Vec3};

use super::{File, scene, seen};

#[test]
fn a_camera_alone_is_a_scene() {
    let scene = scene("[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n");
    assert_eq!((scene.cameras.len(), scene.lights.len(), scene.materials.len()), (1, 0, 0));
}

#[test]
fn a_film_left_out_has_the_librarys_defaults() {
    assert_eq!(seen("").film, FilmSettings::default());
}

#[test]
fn every_key_of_the_film_is_read() {
    let film = seen(
        "[film]\nsize = [1000, 500]\nspp = 4\ntransfer = \"none\"\nbackground = \"#323232\"\n\
         sample_position = \"corner\"\nexposure = -1.5\ntone = \"aces\"\nmax_depth = 16\ncutoff = 0.25\n\
         ambient_occlusion = 8\nintegrator = \"path\"\nseed = 7\n\
         soft_terminator = false\ntransparent = true\n",
    )
    .film;
    let expected = FilmSettings {
        size: [1000, 500],
        integrator: IntegratorKind::Path,
        seed: 7,
        spp: 4,
        adaptive: None,
        transfer: Transfer::None,
        exposure: -1.5,
        tone: Tone::Aces,
        background: Vec3::splat(50.0 / 255.0),
        transparent: true,
        sample_position: SamplePosition::Corner,
        max_depth: 16,
        ambient_occlusion: 8,
        cutoff: 0.25,
        soft_terminator: false,
    };
    assert_eq!(film, expected);
}

#[test]
fn adaptive_samples_are_read_with_their_threshold() {
    let film = seen("film.adaptive = [4, 36]\nfilm.threshold = 0.25\n").film;
    assert_eq!((film.spp, film.adaptive), (4, Some(AdaptiveSampling { max: 36, threshold: 0.25 })));
    let film = seen("film.adaptive = [1, 25]\n").film;
    assert_eq!(film.adaptive.map(|a| a.threshold), Some(AdaptiveSampling::THRESHOLD));
}

#[test]
fn hex_is_decoded_by_srgb_unless_the_film_says_otherwise() {
    let background = seen("film.background = \"#ff8000\"").film.background;
    assert_eq!((background.x, background.z), (1.0, 0.0));
    assert!((background.y - 0.215_860_5).abs() < 1e-6, "{background}");
}

#[test]
fn hex_is_the_byte_over_255_without_transfer() {
    let text = "[film]\ntransfer = \"none\"\n[[light]]\nkind = \"ambient\"\ncolor = \"#336699\"\n";
    assert_eq!(seen(text).lights[0].intensity, Vec3::new(51.0, 102.0, 153.0) / 255.0);
}

#[test]
fn short_hex_doubles_its_digits() {
    let [long, short] =
        ["#ffcc00", "#fC0"].map(|c| seen(&format!("film.background = \"{c}\"")).film.background);
    assert_eq!(long, short);
}

#[test]
fn numbers_are_linear_in_either_transfer() {
    for transfer in ["srgb", "none"] {
        let text = format!("[film]\ntransfer = \"{transfer}\"\nbackground = [0.25, 1, 2.5]\n");
        assert_eq!(seen(&text).film.background, Vec3::new(0.25, 1.0, 2.5));
    }
}

#[test]
fn one_number_is_a_grey() {
    assert_eq!(seen("film.background = 0.5").film.background, Vec3::splat(0.5));
}

#[test]
fn the_tutorials_camera_is_read() {
    let scene = scene(
        "[film]\nsize = [1000, 500]\n[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, 1]\n\
         up = [0, -1, 0]\nfocal_px = 500\n",
    );
    let lens = Projection::FocalPx { focal: 500.0, width: 1000 };
    let expected = Camera::look_at(DVec3::ZERO, DVec3::Z, -DVec3::Y, lens).unwrap();
    assert_eq!(scene.cameras, [expected]);
}

#[test]
fn a_camera_sees_45_degrees_from_bottom_to_top_by_default() {
    assert_eq!(seen("").cameras[0].projection, Projection::FovY(45f64.to_radians()));
}

#[test]
fn each_lens_is_read() {
    let lens = |key: &str| seen(&format!("camera.{key}")).cameras[0].projection;
    assert_eq!(lens("fov_y = 30"), Projection::FovY(30f64.to_radians()));
    assert_eq!(lens("fov_x = 30"), Projection::FovX(30f64.to_radians()));
    assert_eq!(lens("focal_px = 30"), Projection::FocalPx { focal: 30.0, width: 1280 });
    assert_eq!(lens("ortho_height = 30"), Projection::OrthoHeight(30.0));
}

#[test]
fn a_direction_of_any_length_is_as_good_as_a_point() {
    for direction in ["[0, 0, -1]", "[0, 0, -1e-300]", "[0, 0, -1e300]"] {
        let text = format!("[camera]\nposition = [1e15, 0, 0]\ndirection = {direction}\n");
        let camera = &scene(&text).cameras[0];
        assert_eq!((camera.forward, camera.position.x), (-DVec3::Z, 1e15));
    }
}

#[test]
fn several_cameras_keep_their_order_and_names() {
    let text = "[[camera]]\nname = \"front\"\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\n\
                [[camera]]\nname = \"side\"\nposition = [5, 0, 0]\nlook_at = [0, 0, 0]\n";
    let names: Vec<_> = scene(text).cameras.into_iter().map(|camera| camera.name).collect();
    assert_eq!(names, ["front", "side"]);
}

#[test]
fn every_key_of_a_material_is_read() {
    let scene = seen(
        "[[material]]\nname = \"m\"\ndiffuse = [0.1, 0.2, 0.3]\nspecular = 1\nshininess = 10\n\
         emission = [0, 0, 4]\nreflect = 0.5\ntransmit = [0.25, 0.5, 0]\nior = 1.33\n\
         absorption = [1, 2, 3]\nthin = true\npriority = -2\ndouble_sided = true\n",
    );
    let expected = Material {
        name: "m".to_owned(),
        diffuse: Vec3::new(0.1, 0.2, 0.3),
        specular: Vec3::ONE,
        shininess: 10.0,
        emission: Vec3::Z * 4.0,
        reflect: Vec3::splat(0.5),
        transmit: Vec3::new(0.25, 0.5, 0.0),
        ior: 1.33,
        absorption: Vec3::new(1.0, 2.0, 3.0),
        thin: true,
        priority: -2,
        double_sided: true,
        ..Material::default()
    };
    assert_eq!(scene.materials, [expected]);
}

#[test]
fn a_picture_that_nothing_shows_is_named_and_not_read() {
    let material = "[[material]]\nname = \"a\"\ndiffuse_map = \"dot.png\"\n";
    let file = File::new(format!("{}{material}", super::CAMERA));
    std::fs::write(file.beside("dot.png"), "no picture").unwrap();
    let mut scene = file.load().unwrap().scene;
    let image = scene.textures[0].image.clone();
    assert!(!image.is_read() && image.name.ends_with("dot.png"), "{image:?}");
    let ball = envers::Sphere::new(glam::DVec3::ZERO, 1.0, envers::MaterialId(0));
    scene.spheres.push(ball);
    let error = scene.check().unwrap_err();
    assert!(error.message().contains("the picture was not read"), "{error}");
}

#[test]
fn pictures_of_a_model_in_another_material_are_not_read() {
    let (camera, material) = (super::CAMERA, "[[material]]\nname = \"a\"\n");
    let model = "[[model]]\nfile = \"m.obj\"\n";
    let painted = format!("{model}material = \"a\"\n");
    for (models, read) in [(painted.clone(), false), (format!("{painted}{model}"), true)] {
        let file = File::new(format!("{camera}{material}{models}"));
        let dot = image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 255]));
        dot.save(file.beside("dot.png")).unwrap();
        std::fs::write(file.beside("m.mtl"), "newmtl m\nmap_Kd dot.png\n").unwrap();
        let text = "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        std::fs::write(file.beside("m.obj"), text).unwrap();
        let scene = file.load().unwrap().scene;
        assert_eq!(scene.textures[0].image.is_read(), read, "{models}");
    }
}

/// A scene file with these keys in a material, beside a picture of one pixel that is half clear.
fn with_dot(keys: &str) -> File {
    let material = format!("[[material]]\nname = \"a\"\n{keys}");
    let ball = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"a\"\n";
    let file = File::new(format!("{}{material}{ball}", super::CAMERA));
    let dot = image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 128]));
    dot.save(file.beside("dot.png")).unwrap();
    file
}

#[test]
fn a_normal_map_is_linear_and_other_maps_are_srgb() {
    let scene =
        with_dot("normal_map = \"dot.png\"\nspecular_map = \"dot.png\"\n").load().unwrap().scene;
    let material = &scene.materials[0];
    let transfer = |id: envers::TextureId| scene.textures[id.0 as usize].transfer;
    assert_eq!(transfer(material.normal_map.unwrap().texture), Transfer::None);
    assert_eq!(transfer(material.specular_map.unwrap()), Transfer::Srgb);
    // One file, decoded once.
    assert!(std::sync::Arc::ptr_eq(&scene.textures[0].image, &scene.textures[1].image));
}

#[test]
fn filters_of_pictures() {
    for (filter, expected) in [
        ("nearest", (Filter::Nearest, false)),
        ("linear", (Filter::Linear, false)),
        ("mipmap", (Filter::Linear, true)),
    ] {
        let scene = with_dot(&format!("diffuse_map = \"dot.png\"\nfilter = \"{filter}\"\n"));
        let scene = scene.load().unwrap().scene;
        assert_eq!((scene.textures[0].filter, scene.textures[0].mipmap), expected);
    }
}

#[test]
fn blended_alpha_makes_a_thin_sheet() {
    let scene =
        with_dot("diffuse_map = \"dot.png\"\nalpha_mode = \"blend\"\n").load().unwrap().scene;
    let material = &scene.materials[0];
    assert_eq!(material.coverage.unwrap().mode, AlphaMode::Blend);
    assert_eq!((material.thin, material.ior), (true, 1.0));
}

#[test]
fn a_mask_on_a_sphere_is_blended() {
    let scene = with_dot("diffuse_map = \"dot.png\"\nalpha_mode = \"mask\"\nalpha_cutoff = 0.7\n");
    let scene = scene.load().unwrap().scene;
    assert_eq!(scene.materials[0].coverage.unwrap().mode, AlphaMode::Mask { cutoff: 0.7 });
    let of_ball = scene.spheres[0].material;
    assert_eq!(scene.materials[of_ball.0 as usize].coverage.unwrap().mode, AlphaMode::Blend);
}

#[test]
fn a_picture_named_twice_is_read_once() {
    let text = format!(
        "{}[[material]]\nname = \"a\"\ndiffuse_map = \"dot.png\"\nemission_map = \"./dot.png\"\n",
        super::CAMERA
    );
    let file = File::new(text);
    let dot = image::RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 255]));
    dot.save(file.beside("dot.png")).unwrap();
    let scene = file.load().unwrap().scene;
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(scene.textures[0].transfer, Transfer::Srgb);
    assert_eq!(scene.materials[0].diffuse_map, scene.materials[0].emission_map);
    assert!(scene.materials[0].diffuse_map.is_some());
}

#[test]
fn every_key_of_a_sphere_is_read() {
    let scene = seen(
        "[[material]]\nname = \"a\"\n[[material]]\nname = \"b\"\n\
         [[sphere]]\ncenter = [1, 2.5, -3]\nradius = 2\nmaterial = \"b\"\ncasts_shadow = false\n",
    );
    let [sphere] = scene.spheres[..] else { panic!("one sphere") };
    assert_eq!((sphere.center, sphere.radius), (DVec3::new(1.0, 2.5, -3.0), 2.0));
    assert_eq!(scene.materials[sphere.material.0 as usize].name, "b");
    assert!(!sphere.casts_shadow);
}

#[test]
fn things_without_material_share_a_plain_grey() {
    let scene = seen(
        "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n[[sphere]]\ncenter = [9, 0, 0]\nradius = 1\n\
         [[plane]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n",
    );
    let plain = Material { name: "default".to_owned(), ..Material::default() };
    assert_eq!(scene.materials, [plain]);
    let expected = Sphere::new(DVec3::ZERO, 1.0, scene.planes[0].material);
    assert_eq!(scene.spheres[0], expected);
}

#[test]
fn every_key_of_a_plane_is_read() {
    let scene = seen(
        "[[material]]\nname = \"a\"\n[[plane]]\npoint = [0, -1, 0]\nnormal = [0, 5, 0]\n\
         material = \"a\"\nchecker = { colors = [[1, 0, 0], 0.5], size = 2 }\n\
         texture_size = 3\ncasts_shadow = false",
    );
    let plane = scene.planes[0];
    assert_eq!((plane.point, plane.normal, plane.casts_shadow), (-DVec3::Y, DVec3::Y, false));
    assert_eq!(plane.texture_size, 3.0);
    let checker = plane.checker.unwrap();
    assert_eq!((checker.colors, checker.size), ([Vec3::X, Vec3::splat(0.5)], 2.0));
}

#[test]
fn a_point_light_is_read() {
    let text = "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\ncolor = [1, 0.5, 0]\n\
                intensity = 4\nfalloff = \"inverse_square\"\nrange = 7\nshadow = false\n";
    let expected = Light {
        name: String::new(),
        kind: LightKind::Point {
            position: DVec3::new(1.0, 2.0, 3.0),
            falloff: Falloff::InverseSquare,
            range: 7.0,
        },
        intensity: Vec3::new(4.0, 2.0, 0.0),
        shadow: Shadow::None,
        samples: 16,
        shape: None,
    };
    assert_eq!(seen(text).lights, [expected]);
}

#[test]
fn a_point_light_left_plain_is_the_tutorials() {
    let light = &seen("[[light]]\nkind = \"point\"\nposition = [0, 1, 0]\n").lights[0];
    let (position, falloff, range) = (DVec3::Y, Falloff::None, f64::INFINITY);
    assert_eq!(light.kind, LightKind::Point { position, falloff, range });
    assert_eq!((light.intensity, light.shadow), (Vec3::ONE, Shadow::Tinted));
}

#[test]
fn a_directional_light_is_read() {
    let light = &seen("[[light]]\nkind = \"directional\"\ndirection = [0, -3, 0]\n").lights[0];
    assert_eq!(light.kind, LightKind::Directional { direction: -DVec3::Y, angle: 0.0 });
}

#[test]
fn a_spot_light_is_read_with_its_angles_in_degrees() {
    let text = "[[light]]\nkind = \"spot\"\nposition = [0, 5, 0]\ndirection = [0, -1, 0]\n\
                inner_angle = 10\nouter_angle = 90\n";
    let LightKind::Spot { inner_angle, outer_angle, .. } = seen(text).lights[0].kind else {
        panic!("a spot");
    };
    assert_eq!((inner_angle, outer_angle), (10f64.to_radians(), 90f64.to_radians()));
}

#[test]
fn an_ambient_light_is_read_and_casts_no_shadow() {
    let light = &seen("[[light]]\nkind = \"ambient\"\nintensity = 0.1\n").lights[0];
    assert_eq!((light.kind, light.shadow), (LightKind::Ambient, Shadow::None));
}

#[test]
fn a_sun_is_read_with_its_angle_in_degrees() {
    let text = "[[light]]\nkind = \"directional\"\ndirection = [0, -3, 0]\nangle = 0.53\n\
                samples = 64\n";
    let sun = Light::sun(-DVec3::Y).with_angle(0.53f64.to_radians()).with_samples(64);
    assert_eq!(seen(text).lights, [sun]);
}

#[test]
fn a_rectangle_light_is_read_and_seen_from_its_front() {
    let text = "[[light]]\nname = \"panel\"\nkind = \"rectangle\"\nposition = [1, 5, 0]\n\
                direction = [0, -2, 0]\nsize = [4, 1]\nintensity = 3\nsamples = 4\n";
    let scene = seen(text);
    // The height runs along z where the light shines straight down.
    let panel = Light::rectangle(DVec3::new(1.0, 5.0, 0.0), DVec3::X * 2.0, DVec3::Z * 0.5);
    let panel = panel.with_intensity(Vec3::splat(3.0)).with_samples(4).with_name("panel");
    let panel = panel.with_shape(LightShape::Instance(0));
    assert_eq!(scene.lights, [panel]);
    let [instance] = &scene.instances[..] else { panic!("one shape") };
    let material = &scene.materials[instance.material.0 as usize];
    assert_eq!((material.emission, material.cull_back_faces), (Vec3::splat(3.0), true));
    assert!(!instance.casts_shadow && !material.illuminates);
    assert_eq!(scene.bounds().lower, DVec3::new(-1.0, 5.0, -0.5));
    assert_eq!(scene.bounds().upper, DVec3::new(3.0, 5.0, 0.5));
    assert!(seen(&format!("{text}visible = false\n")).instances.is_empty());
    // Upright on a wall, and by its own `up`.
    let axes = |keys: &str| {
        let text = format!(
            "[[light]]\nkind = \"rectangle\"\nposition = [0, 0, 0]\nsize = [4, 1]\n{keys}\n"
        );
        let LightKind::Rectangle { u, v, .. } = seen(&text).lights[0].kind else { panic!() };
        [u, v]
    };
    assert_eq!(axes("direction = [0, 0, 1]"), [DVec3::X * 2.0, DVec3::Y * 0.5]);
    assert_eq!(axes("direction = [0, 0, 1]\nup = [1, 0, 5]"), [DVec3::Y * -2.0, DVec3::X * 0.5]);
}

#[test]
fn a_disk_light_and_a_sphere_light_are_read_and_seen() {
    let scene = seen(
        "[[light]]\nkind = \"disk\"\nposition = [0, 5, 0]\ndirection = [0, -2, 0]\nradius = 2\n\
         [[light]]\nkind = \"sphere\"\nposition = [9, 5, 0]\nradius = 0.5\n",
    );
    let center = DVec3::new(9.0, 5.0, 0.0);
    assert_eq!(
        scene.lights,
        [
            Light::disk(DVec3::Y * 5.0, -DVec3::Y, 2.0).with_shape(LightShape::Instance(0)),
            Light::sphere(center, 0.5).with_shape(LightShape::Sphere(0)),
        ]
    );
    assert_eq!((scene.instances.len(), scene.spheres.len()), (1, 1));
    assert!(!scene.spheres[0].casts_shadow && scene.spheres[0].center == center);
}

#[test]
fn a_visible_light_moves_with_its_shape() {
    let text = "[[light]]\nname = \"a\"\nkind = \"disk\"\nposition = [1, 0, 0]\n\
                direction = [1, 0, 0]\nradius = 0.5\n\
                [[light]]\nname = \"b\"\nkind = \"sphere\"\nposition = [0, 0, 0]\nradius = 0.5\n\
                [animation]\nframes = 24\n\
                [[animation.orbit]]\nobject = \"a\"\naround = [0, 0, 0]\nperiod = 4\nturn = true\n\
                [[animation.track]]\nobject = \"b\"\ntimes = [0, 1]\n\
                position = [[0, 0, 0], [0, 6, 0]]\ninterpolation = \"linear\"\n";
    let scene = seen(text).at_time(1.0).unwrap();
    // A quarter of the orbit later, about y.
    let LightKind::Disk { center, normal, .. } = scene.lights[0].kind else { panic!("a disk") };
    assert!((center - DVec3::NEG_Z).length() < 1e-12, "{center}");
    assert!((normal - DVec3::NEG_Z).length() < 1e-12, "{normal}");
    let shape = scene.instances[0].transform;
    assert!((shape.translation - center).length() < 1e-12);
    assert!((shape.matrix3.z_axis - normal).length() < 1e-12);
    assert_eq!(scene.lights[1].position(), Some(DVec3::Y * 6.0));
    assert_eq!(scene.spheres[0].center, DVec3::Y * 6.0);
}

#[test]
fn a_material_that_illuminates_is_read() {
    let text = "[[material]]\nname = \"lamp\"\nemission = 4\nilluminates = true\n";
    assert!(seen(text).materials[0].illuminates);
    assert!(!seen(&text.replace("true", "false")).materials[0].illuminates);
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_are_no_matter() {
    let text = "\u{feff}[camera]\r\nposition = [0, 0, 5]\r\nlook_at = [0, 0, 0]\r\n";
    assert_eq!(scene(text).cameras.len(), 1);
}

#[test]
fn a_diffuse_colour_in_bytes_is_a_warning() {
    let text = "[[material]]\nname = \"blue\"\ndiffuse = [52, 84, 216]\n";
    let warnings = File::new(format!("{}{text}", super::CAMERA)).load().unwrap().report.warnings;
    let expected = "scene.toml:5:11: the material `blue` scatters more light than it gets";
    assert!(warnings[0].contains(expected), "{warnings:?}");
}

#[test]
fn a_hundred_thousand_spheres_are_read() {
    let sphere = |i: u32| format!("[[sphere]]\ncenter = [{i}, 2, 3]\nradius = 0.5\n");
    assert_eq!(seen(&(0..100_000).map(sphere).collect::<String>()).spheres.len(), 100_000);
}
