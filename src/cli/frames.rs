//! Which frames of an animation are asked for, and what their files are called.

use std::path::{Path, PathBuf};

use crate::cli::args::Render;
use crate::cli::range::Range;
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scene::animation::Animation;
use crate::write::Format;

/// What is to be rendered.
pub struct Plan {
    /// Frames and their times in seconds; one without a number where nothing is animated.
    pub frames: Vec<(Option<u32>, f64)>,
    /// Pictures of one frame each; `#` in a file's name stands for the number of the frame.
    pub stills: Vec<PathBuf>,
    /// Pictures of all frames.
    pub movies: Vec<PathBuf>,
    /// How many frames of a movie are shown in a second.
    pub fps: f64,
    /// How many frames are left out since their files are there.
    pub skipped: usize,
    /// Whether files that are there are left alone.
    keeps: bool,
}

impl Plan {
    /// What the command line asks of a scene.
    ///
    /// # Errors
    /// When that does not fit the scene, or files of several frames would have one name.
    pub fn new(arguments: &Render, scene: &Scene, outputs: Vec<PathBuf>) -> Result<Self> {
        let is_movie = |path: &PathBuf| Format::from_path(path).is_ok_and(Format::is_animated);
        let (movies, stills): (Vec<_>, Vec<_>) = outputs.into_iter().partition(is_movie);
        let mut plan =
            Self { frames: vec![(None, 0.0)], stills, movies, fps: 1.0, skipped: 0, keeps: false };
        match &scene.animation {
            Some(animation) => plan.choose(arguments, animation)?,
            None => plan.refuse(arguments)?,
        }
        if arguments.skip_existing {
            plan.skip_existing()?;
        }
        Ok(plan)
    }

    fn choose(&mut self, arguments: &Render, animation: &Animation) -> Result<()> {
        let all = Range { first: 1, last: animation.frames, step: 1 };
        let wants_many = !self.movies.is_empty() || self.stills.iter().any(|p| has_number(p));
        let range = match arguments.frames {
            Some(range) if range.last > animation.frames => {
                let message = format!("there is no frame {}", range.last);
                let help = format!("the animation has {}, from 1 on", animation.frames);
                return Err(Error::input(message).at(&arguments.tracing.scene).help(help));
            }
            Some(range) => range,
            None if wants_many => all,
            None => Range { last: 1, ..all },
        };
        let frames = (range.first..=range.last).step_by(range.step as usize);
        self.frames = frames.map(|frame| (Some(frame), animation.time(frame))).collect();
        self.fps = animation.fps / f64::from(range.step);
        if self.frames.len() == 1 {
            return Ok(());
        }
        if arguments.output.is_empty() {
            for path in &mut self.stills {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                path.set_file_name(format!("{stem}-####.png"));
            }
        }
        if let Some(path) = self.stills.iter().find(|path| !has_number(path)) {
            let message = format!("{} frames cannot all have this name", self.frames.len());
            return Err(Error::input(message).at(path).help(
                "put #### where the number of the frame belongs, as in frame-####.png, or name it \
                 .gif or .apng",
            ));
        }
        let last = self.frames.last().and_then(|(frame, _)| *frame);
        for (i, path) in self.stills.iter().enumerate() {
            // Names that are one for some frame are so for the one with the most digits.
            if self.stills[..i].iter().any(|other| numbered(other, last) == numbered(path, last)) {
                return Err(Error::input("frames of two outputs would have the same name")
                    .at(path)
                    .help("choose another name"));
            }
        }
        Ok(())
    }

    /// Refuses what only an animation can have.
    fn refuse(&self, arguments: &Render) -> Result<()> {
        let help = "in a scene file, [animation] says what moves; a glTF file may have its own";
        let still = match arguments.tracing.time {
            Some(_) => "--time asks for one moment",
            None => "the scene has no animation",
        };
        if arguments.frames.is_some() {
            let error = Error::input(format!("{still}, and so there are no --frames"));
            return Err(error.at(&arguments.tracing.scene).help(help));
        }
        match self.movies.first() {
            Some(path) => Err(Error::input(format!("{still}, and this picture is for one"))
                .at(path)
                .help("name it .png or .exr")),
            None => Ok(()),
        }
    }

    fn skip_existing(&mut self) -> Result<()> {
        if let Some(path) = self.movies.first() {
            return Err(Error::input("an animated picture needs every frame: none can be skipped")
                .at(path)
                .help("leave out --skip-existing, or this output"));
        }
        self.keeps = true;
        let all = std::mem::take(&mut self.frames);
        let count = all.len();
        self.frames = all.into_iter().filter(|(f, _)| self.files(*f).next().is_some()).collect();
        self.skipped = count - self.frames.len();
        Ok(())
    }

    /// What was done, a line for each output.
    pub fn summary(&self, seconds: f64) -> String {
        let mut text = String::new();
        let frames = |count: usize| match count {
            1 => "1 frame".to_owned(),
            _ => format!("{count} frames"),
        };
        match self.frames[..] {
            [] => {}
            [(frame, _)] => {
                let stills = self.stills.iter().map(|path| numbered(path, frame));
                for path in stills.chain(self.movies.iter().cloned()) {
                    text += &format!("{} ({seconds:.2} s)\n", path.display());
                }
            }
            _ => {
                let count = frames(self.frames.len());
                for path in self.stills.iter().chain(&self.movies) {
                    text += &format!("{}: {count} ({seconds:.2} s)\n", path.display());
                }
            }
        }
        match self.skipped {
            0 => {}
            1 => text += "1 frame was there already\n",
            n => text += &format!("{} were there already\n", frames(n)),
        }
        text
    }

    /// The files to write of one frame.
    pub fn files(&self, frame: Option<u32>) -> impl Iterator<Item = PathBuf> {
        let named = self.stills.iter().map(move |path| numbered(path, frame));
        named.filter(|path| !self.keeps || !path.is_file())
    }
}

/// Whether the name of a file has a place for the number of a frame.
fn has_number(path: &Path) -> bool {
    path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.contains('#'))
}

/// The name of a frame's file: its number, with zeros in front, in place of the last run of `#`.
fn numbered(path: &Path, frame: Option<u32>) -> PathBuf {
    let name = path.file_name().and_then(|name| name.to_str());
    let (Some(name), Some(frame)) = (name, frame) else { return path.to_owned() };
    let Some(end) = name.rfind('#') else { return path.to_owned() };
    let start = name[..end].trim_end_matches('#').len();
    let digits = end + 1 - start;
    path.with_file_name(format!("{}{frame:0digits$}{}", &name[..start], &name[end + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_stands_for_the_last_run_of_signs() {
        let named = |path: &str| numbered(Path::new(path), Some(42));
        assert_eq!(named("a#/f-####.png"), Path::new("a#/f-0042.png"));
        assert_eq!(named("C#-#.png"), Path::new("C#-42.png"));
        assert_eq!(named("f.png"), Path::new("f.png"));
        assert_eq!(numbered(Path::new("f-##.png"), Some(1234)), Path::new("f-1234.png"));
    }

    #[test]
    fn what_is_not_animated_keeps_its_name() {
        assert_eq!(numbered(Path::new("C#.png"), None), Path::new("C#.png"));
    }
}
