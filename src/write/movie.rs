//! The writer of animations, as GIF or animated PNG, frame by frame.
//!
//! Only the rectangle of a frame that differs from the frame before is stored, so that static parts do
//! not change their colours and take no space.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use gif::{DisposalMethod, Repeat};

use crate::error::{Error, Result};
use crate::film::Film;
use crate::write::{Format, Settings, atomic::PendingFile, bytes_per_pixel, png_bytes};

/// The sampling factor of NeuQuant, which chooses a GIF's colours: from 1 (all pixels) to 30.
const GIF_SAMPLING: i32 = 10;
/// The least delay of a GIF's frame, in hundredths of a second: browsers turn a shorter one into 10.
const GIF_MIN_DELAY: u16 = 2;

/// An animation that is being written; the file appears when it is finished.
pub struct Movie {
    file: PendingFile,
    encoder: Encoder,
    size: [u32; 2],
    /// True if the frames have alpha.
    has_alpha: bool,
    /// The frame rate in frames per second.
    fps: f64,
    frames: u32,
    /// The bytes of the frame before; `None` for the first.
    previous: Option<Vec<u8>>,
}

/// The encoder of one of the two formats.
enum Encoder {
    Gif(Box<gif::Encoder<BufWriter<File>>>),
    /// Unbuffered, since an error of flushing a buffer at the end would be lost; PNG writes large pieces.
    Apng(Box<png::Writer<File>>),
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rectangle {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
}

impl Movie {
    /// Begins a looping animation of `frames` frames, with or without alpha, at `fps` frames per second,
    /// in the format that the extension names.
    ///
    /// # Errors
    /// When the format is not animated or cannot have such a size or alpha, or the file cannot be written.
    pub fn create(
        path: &Path,
        size: [u32; 2],
        has_alpha: bool,
        frames: u32,
        fps: f64,
    ) -> Result<Self> {
        let format = Format::from_path(path)?;
        format.check_size(size, path)?;
        if has_alpha {
            format.check_alpha(path)?;
        }
        let mut file = PendingFile::new(path)?;
        let failed = |e: io::Error| Error::writing(path, &e);
        let handle = file.handle().map_err(failed)?;
        // The header of the format.
        let encoder = match format {
            Format::Gif => begin_gif(handle, size).map_err(gif_error).map(Encoder::Gif),
            Format::Apng => begin_apng(handle, size, has_alpha, frames, fps).map(Encoder::Apng),
            _ => {
                return Err(Error::input("this format holds one frame").at(path));
            }
        }
        .map_err(failed)?;
        Ok(Self { file, encoder, size, has_alpha, fps, frames: 0, previous: None })
    }

    /// Appends a frame, with the bytes that a PNG of it would have.
    ///
    /// # Errors
    /// When it cannot be written.
    ///
    /// # Panics
    /// When its size is not that of the animation, or only one of the two has alpha.
    pub fn push(&mut self, film: &Film, settings: &Settings) -> Result<()> {
        // The part of the picture that is not as it was in the frame before.
        assert_eq!(film.size, self.size, "all frames of a picture are of one size");
        assert_eq!(film.alpha.is_some(), self.has_alpha, "all frames have alpha, or none");
        let bytes = png_bytes(film, settings);
        let (width, depth) = (self.size[0] as usize, bytes_per_pixel(film));
        let part = match &self.previous {
            Some(previous) => changed_rectangle(previous, &bytes, width, depth),
            None => Rectangle { left: 0, top: 0, width: film.size[0], height: film.size[1] },
        };
        let pixels = crop(&bytes, width, depth, part);
        // Its bytes, in the encoder's format.
        let delay = gif_delay(self.frames, self.fps);
        match &mut self.encoder {
            Encoder::Gif(encoder) => write_gif(encoder, &pixels, part, delay),
            Encoder::Apng(writer) => write_apng(writer, &pixels, part),
        }
        .map_err(|e| Error::writing(self.file.path(), &e))?;
        self.frames += 1;
        self.previous = Some(bytes);
        Ok(())
    }

    /// Completes the file, and replaces an older one.
    ///
    /// # Errors
    /// When it cannot be written; an older file then stays as it was.
    pub fn finish(self) -> Result<()> {
        let path = self.file.path().to_owned();
        match self.encoder {
            Encoder::Gif(encoder) => {
                let writer = encoder.into_inner().map_err(gif_error);
                writer.and_then(|mut writer| writer.flush())
            }
            Encoder::Apng(writer) => writer.finish().map_err(io::Error::from),
        }
        .map_err(|e| Error::writing(&path, &e))?;
        self.file.commit()
    }
}

/// Converts an error of the GIF encoder.
fn gif_error(error: gif::EncodingError) -> io::Error {
    match error {
        gif::EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// The delay after frame `index`, from 0, in hundredths of a second: until the next frame is due, so
/// that rounding errors do not add up.
fn gif_delay(index: u32, fps: f64) -> u16 {
    let due = |index: f64| (100.0 * index / fps).round();
    let delay = due(f64::from(index) + 1.0) - due(f64::from(index));
    (delay as u16).max(GIF_MIN_DELAY)
}

/// The delay after each frame as a fraction of a second: the simplest fraction that is exact, or else
/// the nearest one that a file can hold.
fn apng_delay(fps: f64) -> (u16, u16) {
    let mut best = (f64::INFINITY, (u16::MAX, 1));
    for denominator in 1..=u16::MAX {
        let exact = f64::from(denominator) / fps;
        let numerator = exact.round().clamp(1.0, 65535.0);
        let error = (numerator / exact - 1.0).abs();
        if error < best.0 - 1e-12 {
            best = (error, (numerator as u16, denominator));
        }
    }
    best.1
}

/// Begins a looping GIF.
fn begin_gif(
    file: File,
    [width, height]: [u32; 2],
) -> Result<Box<gif::Encoder<BufWriter<File>>>, gif::EncodingError> {
    let mut encoder = gif::Encoder::new(BufWriter::new(file), width as u16, height as u16, &[])?;
    encoder.set_repeat(Repeat::Infinite)?;
    Ok(Box::new(encoder))
}

/// Begins an animated PNG.
fn begin_apng(
    file: File,
    [width, height]: [u32; 2],
    has_alpha: bool,
    frames: u32,
    fps: f64,
) -> io::Result<Box<png::Writer<File>>> {
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder.set_animated(frames, 0)?;
    let (numerator, denominator) = apng_delay(fps);
    encoder.set_frame_delay(numerator, denominator)?;
    Ok(Box::new(encoder.write_header()?))
}

/// Writes one rectangle as a frame of an animated PNG.
fn write_apng(writer: &mut png::Writer<File>, pixels: &[u8], part: Rectangle) -> io::Result<()> {
    // First to the corner, where any dimension is valid.
    writer.reset_frame_position()?;
    writer.set_frame_dimension(part.width, part.height)?;
    writer.set_frame_position(part.left, part.top)?;
    Ok(writer.write_image_data(pixels)?)
}

/// Writes one rectangle as a frame of a GIF.
fn write_gif(
    encoder: &mut gif::Encoder<BufWriter<File>>,
    pixels: &[u8],
    part: Rectangle,
    delay: u16,
) -> io::Result<()> {
    let [width, height, left, top] =
        [part.width, part.height, part.left, part.top].map(|x| x as u16);
    let mut frame = gif::Frame::from_rgb_speed(width, height, pixels, GIF_SAMPLING);
    (frame.left, frame.top, frame.delay) = (left, top, delay);
    frame.dispose = DisposalMethod::Keep;
    encoder.write_frame(&frame).map_err(gif_error)
}

/// The smallest rectangle around all pixels in which two pictures of this width and of `depth` bytes a
/// pixel differ; one pixel for equal pictures, since no frame can be empty.
fn changed_rectangle(before: &[u8], after: &[u8], width: usize, depth: usize) -> Rectangle {
    let height = after.len() / (depth * width);
    let (mut rows, mut columns) = (height..0, width..0);
    let lines = before.chunks_exact(depth * width).zip(after.chunks_exact(depth * width));
    for (y, (a, b)) in lines.enumerate().filter(|(_, (a, b))| a != b) {
        // The first and the last pixel of the row that differ; there are some, since the rows do.
        let differs = |x: &usize| a[depth * x..][..depth] != b[depth * x..][..depth];
        let first = (0..width).find(differs).unwrap_or(0);
        let last = (0..width).rfind(differs).unwrap_or(0);
        columns = columns.start.min(first)..columns.end.max(last + 1);
        rows = rows.start.min(y)..y + 1;
    }
    if rows.is_empty() {
        return Rectangle { left: 0, top: 0, width: 1, height: 1 };
    }
    let [left, top] = [columns.start, rows.start].map(|x| x as u32);
    Rectangle { left, top, width: columns.len() as u32, height: rows.len() as u32 }
}

/// The bytes of a rectangle of a picture of this width and of `depth` bytes a pixel.
fn crop(bytes: &[u8], width: usize, depth: usize, part: Rectangle) -> Vec<u8> {
    let [left, top, columns, rows] =
        [part.left, part.top, part.width, part.height].map(|x| x as usize);
    let lines = bytes.chunks_exact(depth * width).skip(top).take(rows);
    lines.flat_map(|line| &line[depth * left..depth * (left + columns)]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_of_a_gif_add_up_to_the_right_time() {
        let delays: Vec<u16> = (0..24).map(|i| gif_delay(i, 24.0)).collect();
        assert_eq!(delays[..6], [4, 4, 5, 4, 4, 4]);
        assert_eq!(delays.iter().sum::<u16>(), 100);
    }

    #[test]
    fn a_gif_is_not_faster_than_browsers_show_it() {
        assert_eq!(gif_delay(0, 1000.0), 2);
    }

    #[test]
    fn delays_of_a_png_are_exact_where_they_can_be() {
        assert_eq!(
            [24.0, 12.0, 1000.0, 24.0 / 7.0].map(apng_delay)[..3],
            [(1, 24), (1, 12), (1, 1000)]
        );
        assert_eq!(apng_delay(24.0 / 7.0), (7, 24));
        let (n, d) = apng_delay(23.976);
        assert!((f64::from(n) / f64::from(d) * 23.976 - 1.0).abs() < 1e-4, "{n}/{d}");
        assert_eq!(apng_delay(1e-6), (65535, 1));
    }

    #[test]
    fn only_what_changed_is_cut_out() {
        let mut after = vec![0; 3 * 4 * 3];
        after[3 * (4 + 1)] = 9;
        after[3 * (8 + 2) + 2] = 7;
        let part = changed_rectangle(&[0; 3 * 4 * 3], &after, 4, 3);
        assert_eq!(part, Rectangle { left: 1, top: 1, width: 2, height: 2 });
        assert_eq!(crop(&after, 4, 3, part), [9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7]);
    }

    #[test]
    fn equal_frames_differ_in_one_pixel() {
        let part = changed_rectangle(&[5; 12], &[5; 12], 2, 3);
        assert_eq!(part, Rectangle { left: 0, top: 0, width: 1, height: 1 });
    }
}
