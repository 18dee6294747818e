//! The film: the picture while it is made, in linear f32 pixels.

use rayon::iter::ParallelIterator;

use crate::error::{Error, Result};

/// The quantity that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// Radiance, linear Rec. 709.
    #[default]
    Beauty,
    /// The shading normal in world space; 0 where nothing is hit.
    Normal,
    /// The distance from the camera to the hit in world units, in the first channel; infinite where
    /// nothing is hit.
    Depth,
    /// The id of what is hit: 0 for nothing, 1 for a sphere, 2 for a plane, 3 + i for mesh i; the
    /// primitive's index; the instance's index. Exact below 2²⁴.
    Id,
}

impl View {
    /// Returns the names of the channels in an EXR file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            View::Beauty => &["R", "G", "B"],
            View::Normal => &["N.X", "N.Y", "N.Z"],
            View::Depth => &["Z"],
            View::Id => &["id.geometry", "id.primitive", "id.instance"],
        }
    }
}

/// The three values of a pixel; the [`View`] tells their meaning.
pub type Pixel = [f32; 3];

/// A picture in linear f32, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The width and the height.
    pub size: [u32; 2],
    /// The quantity that it shows.
    pub view: View,
    /// The `width · height` pixels. With alpha their radiance is premultiplied (associated): it is what
    /// reaches the camera from the share that is covered.
    pub pixels: Vec<Pixel>,
    /// The share of each of the `width · height` pixels that something covers, from 0 to 1; `None` for
    /// an opaque picture.
    pub alpha: Option<Vec<f32>>,
}

impl Film {
    /// Creates an opaque film whose pixels are 0.
    pub fn new(size: [u32; 2], view: View) -> Self {
        let count = size[0] as usize * size[1] as usize;
        // The system maps memory when it is first written, which takes a while for a large picture: all
        // threads write a share, in chunks that make the parallel loop worth it.
        const CHUNK: usize = 64;
        let chunks: Vec<[Pixel; CHUNK]> =
            rayon::iter::repeat_n([[0.0; 3]; CHUNK], count.div_ceil(CHUNK)).collect();
        let mut pixels = chunks.into_flattened();
        pixels.truncate(count);
        Self { size, view, pixels, alpha: None }
    }

    /// Checks that there is memory for a film of this size, with or without alpha.
    ///
    /// # Errors
    /// When there is not.
    pub(crate) fn check_memory(size: [u32; 2], has_alpha: bool) -> Result<()> {
        let [width, height] = size;
        let of_alpha = if has_alpha { size_of::<f32>() } else { 0 };
        let bytes = width as usize * height as usize * (size_of::<Pixel>() + of_alpha);
        Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| {
            Error::failed(format!(
                "there is not enough memory for {width}x{height} pixels, which take {bytes} bytes"
            ))
            .help("render a smaller picture")
        })
    }

    /// Returns the pixel in column `x` and row `y`.
    ///
    /// # Panics
    /// When there is no such pixel.
    pub fn pixel(&self, x: u32, y: u32) -> Pixel {
        assert!(x < self.size[0], "column {x} of {}", self.size[0]);
        self.pixels[y as usize * self.size[0] as usize + x as usize]
    }
}
