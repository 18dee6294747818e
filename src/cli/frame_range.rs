//! A range of an animation's frames.

/// A range of frames, counted from 1, with a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRange {
    pub first: u32,
    pub last: u32,
    pub step: u32,
}

impl FrameRange {
    /// Parses `7`, `1-120` or `1-120x2`.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let expected = "expected a frame, such as 7, or frames, such as 1-120 or 1-120x2";
        let number = |text: &str| text.trim().parse::<u32>().map_err(|_| expected.to_owned());
        let range = match text.split_once('-') {
            None => Self { first: number(text)?, last: number(text)?, step: 1 },
            Some((first, rest)) => {
                let (last, step) = rest.split_once(['x', 'X']).unwrap_or((rest, "1"));
                Self { first: number(first)?, last: number(last)?, step: number(step)? }
            }
        };
        match range {
            Self { first: 0, .. } => Err("frames count from 1".to_owned()),
            Self { step: 0, .. } => Err("the step between frames must be at least 1".to_owned()),
            Self { first, last, .. } if last < first => {
                Err(format!("frame {last} comes before frame {first}"))
            }
            range => Ok(range),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_a_range_and_a_range_with_a_step() {
        let range = |first, last, step| Ok(FrameRange { first, last, step });
        assert_eq!(FrameRange::from_text("7"), range(7, 7, 1));
        assert_eq!(FrameRange::from_text("1-120"), range(1, 120, 1));
        assert_eq!(FrameRange::from_text("10-120x5"), range(10, 120, 5));
    }

    #[test]
    fn texts_that_are_no_range_are_refused() {
        for bad in ["", "0", "0-5", "5-1", "1-5x0", "1-", "-5", "1x2", "a", "1-5x", "99999999999"] {
            assert!(FrameRange::from_text(bad).is_err(), "{bad}");
        }
    }
}
