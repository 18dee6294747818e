//! Textures on surfaces: normals, occlusion, alpha, and pictures seen from afar. The
//! radiances are worked out by hand, and every backend must give them.

use envers::scene::{
    Channel, Coverage, Filter, MetallicRoughness, MetallicRoughnessMaps, NormalMap, OcclusionMap,
    ShadingModel, Transfer,
};
use envers::{
    AlphaMode, Backend, BruteForce, Bvh, Camera, Coherence, Geometry, Hit, Image, Instance,
    Intersector, Light, LightKind, Material, MaterialId, Mesh, Plane, Precision, Projection, Ray,
    RenderOptions, Renderer, Scene, Sphere, Texture, TextureId,
};
use envers_testing::Random;
use glam::{DAffine3, DVec3, Vec3};

/// A matt white material, and one pixel that looks along −z at the origin from `z = 5`.
fn scene() -> Scene {
    let mut scene = Scene::default();
    scene.add_material(Material { diffuse: Vec3::ONE, ..Material::default() });
    scene.film.size = [1, 1];
    let eye = DVec3::Z * 5.0;
    scene
        .cameras
        .push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::FovY(0.01)).unwrap());
    scene
}

/// A texture of one pixel, whose values are linear.
fn dot(scene: &mut Scene, texel: [u8; 4]) -> TextureId {
    picture(scene, [1, 1], vec![texel])
}

fn picture(scene: &mut Scene, size: [u32; 2], texels: Vec<[u8; 4]>) -> TextureId {
    let image = Image::from_bytes("", size, texels);
    scene.add_texture(Texture {
        transfer: Transfer::None,
        filter: Filter::Nearest,
        ..Texture::new(image.into())
    })
}

/// A square of side 2 about the origin, across z, whose picture stands upright.
fn square() -> Mesh {
    Mesh {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]].into(),
        uvs: vec![[0., 1.], [1., 1.], [1., 0.], [0., 0.]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn stand(scene: &mut Scene, mesh: Mesh, transform: DAffine3) {
    let mesh = scene.add_mesh(mesh);
    scene.instances.push(Instance::new(mesh, transform, MaterialId(0)));
}

fn sun(toward: DVec3) -> Light {
    Light::new(LightKind::Directional { direction: -toward.normalize(), angle: 0.0 })
}

fn ambient() -> Light {
    Light { kind: LightKind::Ambient, ..sun(DVec3::Z) }
}

/// The pixel, the same from every backend in either precision.
fn radiance(scene: &Scene) -> [f32; 3] {
    let with = |backend, precision| {
        let options = RenderOptions {
            backend: Some(backend),
            precision,
            threads: 1,
            ..RenderOptions::default()
        };
        Renderer::new(scene).options(options.clone()).render().unwrap().film.pixel(0, 0)
    };
    let rust = with(Backend::Rust, Precision::Fast);
    for precision in [Precision::Fast, Precision::Certified] {
        assert_eq!(with(Backend::default(), precision), rust, "{precision:?}");
    }
    rust
}

#[track_caller]
fn assert_near(pixel: [f32; 3], expected: impl Into<Vec3>) {
    let expected = expected.into();
    assert!((Vec3::from(pixel) - expected).length() < 1e-4, "{pixel:?} instead of {expected}");
}

/// The normal (0.6, 0, 0.8) as a colour.
const RIGHT: [u8; 4] = [204, 128, 230, 255];
/// The normal (0, 0.6, 0.8).
const UP: [u8; 4] = [128, 204, 230, 255];

/// Returns the radiance of a surface under the light of a sun that stands where the normal of its map points.
fn bent(texel: [u8; 4], toward: DVec3, place: impl Fn(&mut Scene)) -> [f32; 3] {
    let mut scene = scene();
    let texture = dot(&mut scene, texel);
    scene.materials[0].normal_map = Some(NormalMap { texture, scale: 1.0 });
    place(&mut scene);
    scene.lights.push(sun(toward));
    radiance(&scene)
}

#[track_caller]
fn assert_bent(place: impl Fn(&mut Scene)) {
    for (texel, toward) in [(RIGHT, DVec3::new(0.6, 0.0, 0.8)), (UP, DVec3::new(0.0, 0.6, 0.8))] {
        let pixel = bent(texel, toward, &place);
        assert!((pixel[0] - 1.0).abs() < 1e-3, "{pixel:?} at {toward}");
    }
}

#[test]
fn a_normal_map_on_a_plane_bends_to_the_right_and_up_as_it_says() {
    assert_bent(|scene| scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, MaterialId(0))));
}

#[test]
fn a_normal_map_on_a_sphere_bends_to_the_right_and_up_as_it_says() {
    assert_bent(|scene| scene.spheres.push(Sphere::new(DVec3::ZERO, 1.0, MaterialId(0))));
}

#[test]
fn a_normal_map_on_a_flat_mesh_bends_to_the_right_and_up_as_it_says() {
    assert_bent(|scene| stand(scene, square(), DAffine3::IDENTITY));
}

#[test]
fn a_normal_map_on_a_mesh_with_tangents_bends_to_the_right_and_up_as_it_says() {
    assert_bent(|scene| {
        let (normals, tangents) = (vec![[0., 0., 1.]; 4], vec![[1., 0., 0., 1.]; 4]);
        stand(scene, Mesh { normals, tangents, ..square() }, DAffine3::IDENTITY);
    });
}

#[test]
fn a_normal_map_on_a_mirrored_mesh_is_mirrored() {
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    for with_tangents in [false, true] {
        let place = |scene: &mut Scene| {
            let mut mesh = square();
            if with_tangents {
                mesh.normals = vec![[0., 0., 1.]; 4];
                mesh.tangents = vec![[1., 0., 0., 1.]; 4];
            }
            stand(scene, mesh, mirror);
        };
        for (texel, toward) in
            [(RIGHT, DVec3::new(-0.6, 0.0, 0.8)), (UP, DVec3::new(0.0, 0.6, 0.8))]
        {
            let pixel = bent(texel, toward, place);
            assert!((pixel[0] - 1.0).abs() < 1e-3, "{pixel:?} at {toward}, {with_tangents}");
        }
    }
}

#[test]
fn a_normal_map_seen_from_behind_bends_the_other_side() {
    let place = |scene: &mut Scene| {
        let around = DAffine3::from_rotation_y(std::f64::consts::PI);
        stand(scene, square(), around);
    };
    // From behind the picture's right is on the right again, turned with the square to the left.
    let pixel = bent(RIGHT, DVec3::new(0.6, 0.0, 0.8), place);
    assert!((pixel[0] - 1.0).abs() < 1e-3, "{pixel:?}");
}

#[test]
fn a_flat_normal_map_changes_nothing() {
    let toward = DVec3::new(0.3, 0.2, 0.7);
    let place = |scene: &mut Scene| {
        let normals = vec![[0.1, 0., 1.], [0., 0.2, 1.], [0.3, 0., 1.], [0., 0., 1.]];
        stand(scene, Mesh { normals, ..square() }, DAffine3::IDENTITY);
    };
    for flat in [127, 128] {
        let mapped = bent([flat, flat, 255, 255], toward, place);
        let mut plain = scene();
        place(&mut plain);
        plain.lights.push(sun(toward));
        assert_eq!(mapped, radiance(&plain));
    }
}

#[test]
fn occlusion_takes_ambient_light_only() {
    let with = |light: Light| {
        let mut scene = scene();
        let map = Channel { texture: dot(&mut scene, [51, 0, 0, 255]), channel: 0 };
        scene.materials[0].occlusion_map = Some(OcclusionMap { map, strength: 0.5 });
        stand(&mut scene, square(), DAffine3::IDENTITY);
        scene.lights.push(light);
        radiance(&scene)
    };
    // 1 + 0.5 · (0.2 − 1).
    assert_near(with(ambient()), Vec3::splat(0.6));
    assert_near(with(sun(DVec3::Z)), Vec3::ONE);
}

/// A red square whose alpha is `alpha` in front of a white one, under ambient light.
fn blended(alpha: u8) -> Scene {
    let mut scene = scene();
    let map = Some(Channel { texture: dot(&mut scene, [255, 255, 255, alpha]), channel: 3 });
    scene.materials[0] = Material {
        diffuse: Vec3::X,
        coverage: Some(Coverage { alpha: 1.0, map, mode: AlphaMode::Blend }),
        thin: true,
        ior: 1.0,
        ..Material::default()
    };
    // Aside, so that the ray meets no edge, where both triangles would be met.
    stand(&mut scene, square(), DAffine3::from_translation(DVec3::new(0.3, 0.1, 1.0)));
    let white = scene.add_material(Material { diffuse: Vec3::ONE, ..Material::default() });
    stand(&mut scene, square(), DAffine3::IDENTITY);
    scene.instances[1].material = white;
    scene
}

#[test]
fn what_is_blended_covers_its_share_of_what_lies_behind() {
    let mut scene = blended(51);
    scene.lights.push(ambient());
    assert_near(radiance(&scene), Vec3::new(1.0, 0.8, 0.8));
}

#[test]
fn what_is_blended_keeps_its_share_of_the_light_from_what_lies_behind() {
    let mut scene = blended(51);
    scene.lights.push(sun(DVec3::Z));
    // Seen through it, and lit through it: 0.8 of 0.8.
    assert_near(radiance(&scene), Vec3::new(0.2 + 0.64, 0.64, 0.64));
}

#[test]
fn what_has_no_alpha_left_is_no_surface() {
    let mut scene = blended(0);
    scene.film.max_depth = 0;
    scene.lights.push(ambient());
    assert_near(radiance(&scene), Vec3::ONE);
}

/// A square with a picture of 8 by 8 pixels that are clear or solid in turn, with another square
/// behind it.
fn lattice(place: &dyn Fn(&mut Scene, Mesh)) -> Scene {
    let mut scene = scene();
    let alpha = |i: usize| if (i + i / 8).is_multiple_of(2) { 255 } else { 0 };
    let texels = (0..64).map(|i| [255, 255, 255, alpha(i)]).collect();
    let map = Some(Channel { texture: picture(&mut scene, [8, 8], texels), channel: 3 });
    let mode = AlphaMode::Mask { cutoff: 0.5 };
    scene.materials[0].coverage = Some(Coverage { alpha: 1.0, map, mode });
    place(&mut scene, square());
    let solid = scene.add_material(Material::default());
    let at = scene.instances.len();
    stand(&mut scene, square(), DAffine3::from_scale(DVec3::splat(3.0)));
    scene.instances[at].transform.translation = DVec3::NEG_Z;
    scene.instances[at].material = solid;
    scene.check().unwrap();
    scene
}

fn intersectors(scene: &Scene) -> Vec<(String, Box<dyn Intersector + '_>)> {
    let mut all: Vec<(String, Box<dyn Intersector + '_>)> = Vec::new();
    for precision in [Precision::Fast, Precision::Certified] {
        let name = precision.name();
        all.push((format!("brute {name}"), Box::new(BruteForce::new(scene, precision))));
        all.push((format!("bvh {name}"), Box::new(Bvh::build(scene, precision))));
        #[cfg(feature = "embree")]
        {
            use envers::Embree;
            let packets = Embree::build(scene, precision, 1).unwrap();
            let single = Embree::build_single(scene, precision, 1).unwrap();
            all.push((format!("embree {name}"), Box::new(packets)));
            all.push((format!("embree, ray by ray, {name}"), Box::new(single)));
        }
    }
    all
}

/// Rays straight down on points of the square, not within 1e-3 of a pixel's edge, and whether they
/// pass it.
fn probes() -> Vec<(Ray, bool)> {
    let mut random = Random(11);
    let mut probes = Vec::new();
    while probes.len() < 400 {
        let (x, y) = (random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        let [u, v] = [(x + 1.0) * 4.0, (1.0 - y) * 4.0];
        if [u, v].iter().any(|c| (c - c.round()).abs() < 1e-3) {
            continue;
        }
        let is_clear = (u as usize + v as usize) % 2 == 1;
        probes.push((Ray::new(DVec3::new(x, y, 3.0), DVec3::NEG_Z * 2.0), is_clear));
    }
    probes
}

#[track_caller]
fn assert_passes(scene: &Scene) {
    let (rays, clear): (Vec<Ray>, Vec<bool>) = probes().into_iter().unzip();
    let last = scene.instances.len() as u32 - 1;
    for (name, intersector) in intersectors(scene) {
        let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
        intersector.closest(&rays, Coherence::Coherent, &mut hits);
        for (hit, &clear) in hits.iter().zip(&clear) {
            let hit = hit.unwrap();
            assert!(matches!(hit.id.geometry, Geometry::Mesh(_)));
            assert_eq!(hit.id.instance == last, clear, "{name}");
        }
        let short: Vec<Ray> = rays.iter().map(|ray| Ray { tmax: 1.75, ..*ray }).collect();
        let mut blocked = vec![false; rays.len()];
        intersector.occluded(&short, Coherence::Coherent, &mut blocked);
        for (&blocked, &clear) in blocked.iter().zip(&clear) {
            assert_eq!(blocked, !clear, "{name}: a shadow ray");
        }
    }
}

#[test]
fn every_intersector_passes_the_holes_of_a_mask() {
    assert_passes(&lattice(&|scene, mesh| stand(scene, mesh, DAffine3::IDENTITY)));
}

#[test]
fn every_intersector_passes_the_holes_of_a_mesh_that_stands_twice() {
    assert_passes(&lattice(&|scene, mesh| {
        stand(scene, mesh, DAffine3::IDENTITY);
        let aside = DAffine3::from_translation(DVec3::X * 7.0);
        scene.instances.push(Instance { transform: aside, ..scene.instances[0].clone() });
    }));
}

#[test]
fn the_shadow_of_a_mask_has_its_holes() {
    let mut scene = lattice(&|scene, mesh| {
        stand(scene, mesh, DAffine3::from_translation(DVec3::new(4.0, 0.0, 0.0)));
    });
    // The sun shines past the eye's line, through the lattice, on the origin of what lies behind.
    let through = |x: f64, y: f64| DVec3::new(4.0 + x, y, 0.0) - DVec3::NEG_Z;
    scene.lights.push(sun(through(0.125, -0.125)));
    assert_near(radiance(&scene), Vec3::splat(0.0));
    scene.lights = vec![sun(through(0.125, 0.125))];
    let lit = radiance(&scene)[0];
    let cosine = through(0.125, 0.125).normalize().z as f32;
    assert!((lit - 0.8 * cosine).abs() < 1e-4, "{lit} instead of {}", 0.8 * cosine);
}

/// A chequered ground of 8 by 8 squares to the picture, up to the horizon.
fn ground(mipmap: bool, spp: u32) -> Vec<Vec3> {
    let mut scene = Scene::default();
    let texel = |i: usize| {
        if (i / 8 + i / 512).is_multiple_of(2) { [230, 200, 160, 255] } else { [30, 40, 60, 255] }
    };
    let image = Image::from_bytes("", [64, 64], (0..64 * 64).map(texel).collect());
    let texture = scene.add_texture(Texture { mipmap, ..Texture::new(image.into()) });
    let material =
        Material { diffuse: Vec3::ONE, diffuse_map: Some(texture), ..Material::default() };
    let material = scene.add_material(material);
    let mut plane = Plane::new(DVec3::ZERO, DVec3::Y, material);
    plane.texture_size = 4.0;
    scene.planes.push(plane);
    scene.lights.push(ambient());
    let (eye, target) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.3, 0.7, 3.0));
    scene.cameras.push(
        Camera::look_at(eye, target, DVec3::Y, Projection::FovY(45f64.to_radians())).unwrap(),
    );
    (scene.film.size, scene.film.spp) = ([160, 90], spp);
    let film = Renderer::new(&scene)
        .options(RenderOptions { threads: 1, ..RenderOptions::default() })
        .render()
        .unwrap()
        .film;
    (0..90)
        .flat_map(|y| (0..160).map(move |x| (x, y)))
        .map(|(x, y)| film.pixel(x, y).into())
        .collect()
}

/// The root of the mean square of what two pictures differ by.
fn rmse(a: &[Vec3], b: &[Vec3]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from((*a - *b).length_squared() / 3.0)).sum();
    (sum / a.len() as f64).sqrt()
}

#[test]
fn mipmaps_leave_less_than_a_fifth_of_the_error_of_a_ground_seen_by_single_samples() {
    let reference = ground(false, 256);
    let [linear, mipmap] = [false, true].map(|mipmap| rmse(&ground(mipmap, 1), &reference));
    println!("RMSE against 256 samples: linear {linear:.4}, mipmap {mipmap:.4}");
    assert!(mipmap < linear / 5.0, "linear {linear:.4}, mipmap {mipmap:.4}");
}

#[test]
fn with_many_samples_mipmaps_change_little() {
    let reference = ground(false, 256);
    let difference = rmse(&ground(true, 256), &reference);
    println!("RMSE at 256 samples: {difference:.4}");
    assert!(difference < 0.02, "{difference:.4}");
}

#[test]
fn lights_shine_on_a_clearcoat_by_its_own_normal() {
    // The base is black, so that the clearcoat alone is seen; the light stands where it mirrors.
    let factors = MetallicRoughness {
        base_color: Vec3::ZERO,
        metallic: 0.0,
        specular: 0.0,
        clearcoat: 1.0,
        clearcoat_roughness: 0.5,
        ..MetallicRoughness::default()
    };
    let seen = |on_base: bool, on_clearcoat: bool| {
        let mut scene = scene();
        let map = |texture| NormalMap { texture, scale: 1.0 };
        let texture = dot(&mut scene, RIGHT);
        let mut material = Material { shading: ShadingModel::Pbr, ..Material::default() };
        material.set_metallic_roughness(MetallicRoughnessMaps::new(factors));
        material.normal_map = on_base.then(|| map(texture));
        material.clearcoat_normal_map = on_clearcoat.then(|| map(texture));
        scene.materials[0] = material;
        scene.planes.push(Plane::new(DVec3::ZERO, DVec3::Z, MaterialId(0)));
        scene.lights.push(sun(DVec3::new(0.96, 0.0, 0.28)));
        radiance(&scene)[0]
    };
    let [flat, own, both] = [seen(false, false), seen(false, true), seen(true, true)];
    assert!((own / both - 1.0).abs() < 1e-5 && own > 3.0 * flat, "{flat} {own} {both}");
}
