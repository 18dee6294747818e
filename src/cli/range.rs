//! Some of the frames of an animation.

/// Frames from one to another, all of them or every so many; counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub first: u32,
    pub last: u32,
    pub step: u32,
}

impl Range {
    /// `7`, `1-120` or `1-120x2`.
    pub fn from_text(text: &str) -> std::result::Result<Self, String> {
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
            Self { step: 0, .. } => Err("the step between frames is at least 1".to_owned()),
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
    fn a_frame_a_range_and_every_so_many() {
        let range = |first, last, step| Ok(Range { first, last, step });
        assert_eq!(Range::from_text("7"), range(7, 7, 1));
        assert_eq!(Range::from_text("1-120"), range(1, 120, 1));
        assert_eq!(Range::from_text("10-120x5"), range(10, 120, 5));
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for bad in ["", "0", "0-5", "5-1", "1-5x0", "1-", "-5", "1x2", "a", "1-5x", "99999999999"] {
            assert!(Range::from_text(bad).is_err(), "{bad}");
        }
    }
}
