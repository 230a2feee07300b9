//! Numbered pictures along a way of the camera.

use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::{DVec3, Vec3};

use super::cli::motion::MotionArgs;
use super::console;
use super::output::{PendingFile, check_apart, check_ending};
use crate::render::{Picture, RenderSettings};
use crate::scene::camera_path::PathSpec;
use crate::scene::{CameraPath, CameraSpec, Geometry, Lens};
use crate::{Error, Result};

/// Frames to draw: which, along which way, into which files.
#[derive(Debug)]
pub struct Animation {
    spec: PathSpec,
    names: Numbered,
    frames: Option<(u32, u32)>,
    /// The first file, reserved before the long work begins.
    reserved: Option<PendingFile>,
}

/// The name of a frame's file: what stands before and after its number, and its digits.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Numbered {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Numbered {
    fn new(output: &Path) -> Result<Self> {
        let wrong = || {
            Error::file(
                output,
                "output: the name of frames needs one place for their number, as frame-%04d.png",
            )
        };
        let name = output
            .file_name()
            .and_then(|n| n.to_str())
            .ok_or_else(wrong)?;
        let (before, rest) = name.split_once('%').ok_or_else(wrong)?;
        let (digits, after) = rest.split_once('d').ok_or_else(wrong)?;
        let width = match digits {
            "" => Some(1),
            _ => digits.strip_prefix('0').unwrap_or("x").parse().ok(),
        };
        let digits = width.filter(|d| (1..=12).contains(d)).ok_or_else(wrong)?;
        if after.contains('%') {
            return Err(wrong());
        }
        Ok(Self {
            folder: output.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.to_owned(),
            digits,
            after: after.to_owned(),
        })
    }

    /// Of a single frame: the name as it is.
    fn alone(output: &Path) -> Self {
        let name = output.file_name().unwrap_or_default();
        Self {
            folder: output.parent().map(Path::to_owned).unwrap_or_default(),
            before: name.to_string_lossy().into_owned(),
            digits: 0,
            after: String::new(),
        }
    }

    fn path(&self, frame: u32) -> PathBuf {
        let Self { before, after, .. } = self;
        let digits = self.digits;
        if digits == 0 {
            return self.folder.join(before);
        }
        self.folder.join(format!("{before}{frame:0digits$}{after}"))
    }
}

impl Animation {
    /// What the arguments ask for; none where they name no way.
    ///
    /// # Errors
    /// A way or a name that is none, a file that cannot be read or written.
    pub fn new(args: &MotionArgs, output: &Path) -> Result<Option<Self>> {
        Self::of_files(args, output, &["png", "jpg", "jpeg"])
    }

    /// As [`Animation::new`], for files that end in one of `endings`. A single frame needs no
    /// place for its number.
    ///
    /// # Errors
    /// As [`Animation::new`].
    pub fn of_files(args: &MotionArgs, output: &Path, endings: &[&str]) -> Result<Option<Self>> {
        let Some(text) = &args.camera_path else {
            return Ok(None);
        };
        let spec = PathSpec::named(text, args.fps)?;
        check_ending(output, endings)?;
        let frames = args.frames.map(|f| (f.first, f.last));
        let plain = !output.to_string_lossy().contains('%');
        let names = if plain && frames.is_some_and(|(first, last)| first == last) {
            Numbered::alone(output)
        } else {
            Numbered::new(output)?
        };
        let first = names.path(frames.map_or(0, |f| f.0));
        check_apart(&first, spec.file())?;
        let reserved = Some(PendingFile::create(&first)?);
        Ok(Some(Self {
            spec,
            names,
            frames,
            reserved,
        }))
    }

    /// The way about a subject.
    ///
    /// # Errors
    /// Frames are asked for that the way does not have.
    pub fn path(&self, geometry: &Geometry, settings: &RenderSettings) -> Result<CameraPath> {
        let lens = Lens {
            fov: settings.fov,
            aspect: f64::from(settings.size[0]) / f64::from(settings.size[1]),
            margin: settings.margin,
        };
        let points = geometry.positions.iter().copied();
        self.path_about(&settings.camera, lens, geometry.origin, points)
    }

    /// The way about `points` (relative to `origin`), which begins where `start` sees them through
    /// `lens`.
    ///
    /// # Errors
    /// Frames are asked for that the way does not have.
    pub fn path_about(
        &self,
        start: &CameraSpec,
        lens: Lens,
        origin: DVec3,
        points: impl Iterator<Item = Vec3> + Clone,
    ) -> Result<CameraPath> {
        let path = self.spec.resolve(start, lens, origin, points);
        match self.frames {
            Some((_, last)) if last > path.last() => Err(Error::usage(format!(
                "--frames: there is no frame {last}; the last of {} is {}",
                self.spec,
                path.last()
            ))),
            _ => Ok(path),
        }
    }

    /// Draws and writes the frames one after the other, each whole or not at all. Returns the
    /// files.
    ///
    /// # Errors
    /// What `draw` says, or a file that cannot be written; frames before it stay.
    pub fn write(
        self,
        path: &CameraPath,
        mut draw: impl FnMut(u32) -> Result<Picture>,
    ) -> Result<Vec<PathBuf>> {
        self.write_bytes(path, |frame, path| encoded(&draw(frame)?, path))
    }

    /// As [`Animation::write`], of files whose bytes `draw` makes.
    ///
    /// # Errors
    /// As [`Animation::write`].
    pub fn write_bytes(
        mut self,
        path: &CameraPath,
        mut draw: impl FnMut(u32, &Path) -> Result<Vec<u8>>,
    ) -> Result<Vec<PathBuf>> {
        let (first, last) = self.frames.unwrap_or((0, path.last()));
        let working = console::working("drawing");
        let start = Instant::now();
        let mut files = Vec::new();
        for frame in first..=last {
            let done = frame - first;
            working.step(&progress(
                done,
                last - first + 1,
                start.elapsed().as_secs_f64(),
            ));
            let file = match self.reserved.take() {
                Some(file) => file,
                None => PendingFile::create(&self.names.path(frame))?,
            };
            let path = file.path().to_owned();
            let bytes = draw(frame, &path)?;
            file.commit(&bytes)?;
            files.push(path);
        }
        Ok(files)
    }
}

/// PNG, or JPEG where the name says so.
fn encoded(picture: &Picture, path: &Path) -> Result<Vec<u8>> {
    super::command::render::encode(picture, path)
}

/// Which frame is being drawn, how fast, and how long it will still take.
fn progress(done: u32, frames: u32, seconds: f64) -> String {
    let mut text = format!("frame {} of {frames}", done + 1);
    if done > 0 && seconds > 0.0 {
        let rate = f64::from(done) / seconds;
        let left = (f64::from(frames - done) / rate).ceil() as u64;
        text += &format!(", {rate:.2} a second, {}:{:02} left;", left / 60, left % 60);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_one_place_for_the_number() {
        let name = |text: &str| Numbered::new(Path::new(text)).map(|n| n.path(7));
        assert_eq!(name("a/f-%04d.png").unwrap(), Path::new("a/f-0007.png"));
        assert_eq!(name("%d.jpg").unwrap(), Path::new("7.jpg"));
        assert_eq!(
            name("f%012dx.png").unwrap(),
            Path::new("f000000000007x.png")
        );
        for bad in [
            "f.png",
            "%04d/f.png",
            "f%4d.png",
            "f%04x.png",
            "f%04d%04d.png",
            "f%099d.png",
        ] {
            assert!(name(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn progress_tells_rate_and_end() {
        assert_eq!(progress(0, 10, 0.0), "frame 1 of 10");
        let text = progress(4, 10, 20.0);
        assert_eq!(text, "frame 5 of 10, 0.20 a second, 0:30 left;");
    }
}
