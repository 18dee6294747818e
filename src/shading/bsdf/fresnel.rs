//! Fresnel's reflectance in Schlick's approximation, with the thin film of iridescent materials.

use glam::Vec3;

use super::iridescence::ThinFilm;
use super::table::at_node;

/// The number of cosines between which a reflectance is interpolated where its mean is taken.
pub const COSINES: usize = 33;

/// The reflectance of microfacets by the cosine of the angle to their normal: F₀ + (F₉₀ − F₀)(1 − c)⁵
/// (Schlick, 1994; glTF 2.0, B.3.4), mixed with that of a thin film.
#[derive(Clone, Debug, PartialEq)]
pub struct Fresnel {
    /// The reflectance at normal incidence.
    f0: Vec3,
    /// The reflectance at grazing angles.
    f90: Vec3,
    /// The thin film, if there is one; few surfaces have any.
    film: Option<Box<Film>>,
}

/// A thin film in a reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Film {
    film: ThinFilm,
    /// The share of the film's reflectance in the whole.
    share: f32,
    /// The whole reflectance at `COSINES` cosines: it takes long to compute.
    reflectances: [Vec3; COSINES],
}

impl Fresnel {
    /// The reflectance of a metal with this colour at normal incidence (`conductor_fresnel`).
    pub fn conductor(f0: Vec3) -> Self {
        Self { f0, f90: Vec3::ONE, film: None }
    }

    /// The reflectance of the surface between two indices of refraction (`fresnel_mix`), with the factor
    /// and the colour of KHR_materials_specular.
    pub fn dielectric(outside: f32, inside: f32, factor: f32, color: Vec3) -> Self {
        let r = (inside - outside) / (inside + outside);
        Self { f0: (color * (r * r)).min(Vec3::ONE) * factor, f90: Vec3::splat(factor), film: None }
    }

    /// The same with a thin film over it, which has a share in it.
    pub fn with_film(self, outside: f32, ior: f32, thickness: f32, share: f32) -> Self {
        if share <= 0.0 {
            return self;
        }
        let film = ThinFilm::new(outside, ior, thickness, self.f0, self.f90);
        let reflectances = [Vec3::ZERO; COSINES];
        let mut film = Box::new(Film { film, share, reflectances });
        film.reflectances = std::array::from_fn(|k| self.mixed(at_node(k, COSINES), &film));
        Self { film: Some(film), ..self }
    }

    /// Returns the reflectance at an angle with this cosine, in \[0, 1\].
    pub fn at(&self, cosine: f64) -> Vec3 {
        match &self.film {
            None => self.f0 + (self.f90 - self.f0) * grazing(cosine) as f32,
            Some(film) => self.mixed(cosine, film),
        }
    }

    fn mixed(&self, cosine: f64, film: &Film) -> Vec3 {
        let schlick = self.f0 + (self.f90 - self.f0) * grazing(cosine) as f32;
        schlick.lerp(film.film.reflectance(cosine), film.share)
    }

    /// Returns the reflectance at evenly spread cosines from 0 to 1 where it is not Schlick's.
    pub fn reflectances(&self) -> Option<&[Vec3; COSINES]> {
        self.film.as_ref().map(|film| &film.reflectances)
    }

    /// Returns F₀ and F₉₀ of a reflectance that is Schlick's; `None` where there is a thin film.
    pub fn schlick(&self) -> Option<[Vec3; 2]> {
        self.film.is_none().then_some([self.f0, self.f90])
    }
}

/// Returns Schlick's (1 − c)⁵.
pub fn grazing(cosine: f64) -> f64 {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    let square = x * x;
    square * square * x
}
