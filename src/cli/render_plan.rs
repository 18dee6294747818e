//! The plan of a rendering: its frames, and the names of their files.

use std::path::{Path, PathBuf};

use crate::cli::{args::Render, frame_range::FrameRange};
use crate::error::{Error, Result};
use crate::scene::{Scene, animation::Animation};
use crate::write::Format;

/// The frames and files of a rendering.
pub struct RenderPlan {
    pub frames: Vec<Frame>,
    /// The paths of images of one frame each; `#` in a file's name stands for the frame number.
    pub stills: Vec<PathBuf>,
    /// The paths of animated images.
    pub movies: Vec<PathBuf>,
    /// The frames per second of animated images.
    pub fps: f64,
    /// The number of frames that are skipped because their files exist.
    pub skipped: usize,
    /// True if frames whose files exist are skipped.
    skips_existing: bool,
}

/// A frame to render.
#[derive(Clone, Copy)]
pub struct Frame {
    /// The frame number; none for a scene without animation.
    pub number: Option<u32>,
    /// The time in seconds.
    pub time: f64,
}

impl RenderPlan {
    /// Creates the plan for a scene and the flags.
    ///
    /// # Errors
    /// When the flags do not fit the scene, or files of several frames would have the same name.
    pub fn new(arguments: &Render, scene: &Scene, outputs: Vec<PathBuf>) -> Result<Self> {
        let is_movie = |path: &PathBuf| Format::from_path(path).is_ok_and(Format::is_animated);
        let (movies, stills): (Vec<_>, Vec<_>) = outputs.into_iter().partition(is_movie);
        let mut plan = Self {
            frames: vec![Frame { number: None, time: 0.0 }],
            stills,
            movies,
            fps: 1.0,
            skipped: 0,
            skips_existing: false,
        };
        match &scene.animation {
            Some(animation) => plan.select_frames(arguments, animation)?,
            None => plan.check_still(arguments)?,
        }
        if arguments.skip_existing {
            plan.skip_existing()?;
        }
        Ok(plan)
    }

    /// Selects the frames of an animation, and checks the names of their files.
    fn select_frames(&mut self, arguments: &Render, animation: &Animation) -> Result<()> {
        // The range of frames: that of the flag, or the default of the outputs.
        let all = FrameRange { first: 1, last: animation.frames, step: 1 };
        let is_sequence = !self.movies.is_empty() || self.stills.iter().any(|p| has_placeholder(p));
        let range = match arguments.frames {
            Some(range) if range.last > animation.frames => {
                let message = format!("there is no frame {}", range.last);
                let help = format!("the animation has {} frames, counted from 1", animation.frames);
                return Err(Error::input(message).at(&arguments.trace.input.scene).help(help));
            }
            Some(range) => range,
            None if is_sequence => all,
            None => FrameRange { last: 1, ..all },
        };
        // The frames, which an animated image shows at the same speed when some are left out.
        let frames = (range.first..=range.last).step_by(range.step as usize);
        let frame = |number| Frame { number: Some(number), time: animation.time(number) };
        self.frames = frames.map(frame).collect();
        self.fps = animation.fps / f64::from(range.step);
        if self.frames.len() == 1 {
            return Ok(());
        }

        // Every frame needs a file name of its own.
        if arguments.output.is_empty() {
            for path in &mut self.stills {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                path.set_file_name(format!("{stem}-####.png"));
            }
        }
        if let Some(path) = self.stills.iter().find(|path| !has_placeholder(path)) {
            let message =
                format!("{} frames cannot all be written to this file", self.frames.len());
            let help = "put #### in place of the frame number, as in frame-####.png, or choose .gif \
                        or .apng";
            return Err(Error::input(message).at(path).help(help));
        }
        let last = self.frames.last().and_then(|frame| frame.number);
        for (i, path) in self.stills.iter().enumerate() {
            // Names that are equal for any frame are equal for the one with the most digits.
            if self.stills[..i].iter().any(|other| numbered(other, last) == numbered(path, last)) {
                return Err(Error::input("the frames of two outputs would have the same name")
                    .at(path)
                    .help("choose another name"));
            }
        }
        Ok(())
    }

    /// Checks that a single image is not to be rendered as an animation.
    fn check_still(&self, arguments: &Render) -> Result<()> {
        let reason = match arguments.trace.time {
            Some(_) => "--time selects a single image",
            None => "the scene has no animation",
        };
        if arguments.frames.is_some() {
            return Err(Error::input(format!("--frames needs an animation, and {reason}"))
                .at(&arguments.trace.input.scene)
                .help("a scene file has an animation in [animation], a glTF file may have one"));
        }
        let Some(path) = self.movies.first() else { return Ok(()) };
        let message = format!("an animated image needs an animation, and {reason}");
        Err(Error::input(message).at(path).help("choose .png, .jpg, .webp or .exr"))
    }

    /// Removes the frames whose files exist.
    fn skip_existing(&mut self) -> Result<()> {
        if let Some(path) = self.movies.first() {
            return Err(Error::input("an animated image needs every frame: none can be skipped")
                .at(path)
                .help("leave out --skip-existing, or this output"));
        }
        // The frames of which some file is missing.
        self.skips_existing = true;
        let mut frames = std::mem::take(&mut self.frames);
        let count = frames.len();
        frames.retain(|frame| self.files(frame.number).next().is_some());
        self.skipped = count - frames.len();
        self.frames = frames;
        Ok(())
    }

    /// Returns the summary of a finished rendering: a line for each output.
    pub fn summary(&self, seconds: f64) -> String {
        let mut text = String::new();
        match self.frames[..] {
            [] => {}
            // One frame: its files, by their own names.
            [Frame { number, .. }] => {
                let stills = self.stills.iter().map(|path| numbered(path, number));
                for path in stills.chain(self.movies.iter().cloned()) {
                    text += &format!("{} ({seconds:.2} s)\n", path.display());
                }
            }
            // Several: the outputs, as they were given.
            _ => {
                let count = self.frames.len();
                for path in self.stills.iter().chain(&self.movies) {
                    text += &format!("{}: {count} frames ({seconds:.2} s)\n", path.display());
                }
            }
        }
        match self.skipped {
            0 => {}
            1 => text += "1 frame existed already\n",
            count => text += &format!("{count} frames existed already\n"),
        }
        text
    }

    /// Returns the paths of the still images to write of a frame.
    pub fn files(&self, number: Option<u32>) -> impl Iterator<Item = PathBuf> {
        let named = self.stills.iter().map(move |path| numbered(path, number));
        named.filter(|path| !self.skips_existing || !path.is_file())
    }
}

/// True if the name of a file contains a placeholder for the frame number.
fn has_placeholder(path: &Path) -> bool {
    path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.contains('#'))
}

/// Returns the path of a frame's file: the last run of `#` is replaced by the frame number, padded
/// with zeros.
fn numbered(path: &Path, number: Option<u32>) -> PathBuf {
    let name = path.file_name().and_then(|name| name.to_str());
    let (Some(name), Some(number)) = (name, number) else { return path.to_owned() };
    let Some(end) = name.rfind('#') else { return path.to_owned() };
    let start = name[..end].trim_end_matches('#').len();
    let digits = end + 1 - start;
    path.with_file_name(format!("{}{number:0digits$}{}", &name[..start], &name[end + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_number_replaces_the_last_run_of_signs() {
        let named = |path: &str| numbered(Path::new(path), Some(42));
        assert_eq!(named("a#/f-####.png"), Path::new("a#/f-0042.png"));
        assert_eq!(named("C#-#.png"), Path::new("C#-42.png"));
        assert_eq!(named("f.png"), Path::new("f.png"));
        assert_eq!(numbered(Path::new("f-##.png"), Some(1234)), Path::new("f-1234.png"));
    }

    #[test]
    fn a_still_image_keeps_its_name() {
        assert_eq!(numbered(Path::new("C#.png"), None), Path::new("C#.png"));
    }
}
