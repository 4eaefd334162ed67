//! Kinds of faults and how often they come.

use std::str::FromStr;

/// Shares of frames that are hurt, independent of each other, 0..=1; and the length of a stall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFaults {
    /// The frame is lost.
    pub loss: f64,
    /// One to four bits of the frame are inverted.
    pub flip: f64,
    /// Two to eight neighbouring bytes are replaced by random ones.
    pub burst: f64,
    /// The frame ends early, without its delimiter.
    pub cut: f64,
    /// The frame comes twice.
    pub duplicate: f64,
    /// The frame comes after the next one.
    pub reorder: f64,
    /// One to 64 random bytes come before the frame.
    pub garbage: f64,
    /// All bytes of the frame are random, as at a wrong baud rate.
    pub wrong_baud: f64,
    /// The line stops before the frame, and hands everything on when it goes on.
    pub stall: f64,
    /// Length of a stall, us.
    pub stall_us: u64,
}

/// A word of the command line that is no link fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkFaultError {
    /// No such fault.
    #[error(
        "{word:?} is no link fault; there are loss, flip, burst, cut, duplicate, reorder, garbage, wrong-baud and stall"
    )]
    Unknown {
        /// The word.
        word: String,
    },
    /// Not `NAME=SHARE`, or a share outside of 0 to 1.
    #[error("{name} = {value:?} is not allowed: a share of the frames, 0 to 1, as in {name}=0.01")]
    Share {
        /// Name of the fault.
        name: String,
        /// The value as it was typed.
        value: String,
    },
    /// A stall without a length that is understood.
    #[error("stall = {value:?} is not allowed: share and length up to 60 s, as in stall=0.001:600ms")]
    Stall {
        /// The value as it was typed.
        value: String,
    },
}

impl LinkFaults {
    /// A perfect line. A stall lasts 600 ms unless it is told otherwise.
    pub const NONE: Self = Self {
        loss: 0.0,
        flip: 0.0,
        burst: 0.0,
        cut: 0.0,
        duplicate: 0.0,
        reorder: 0.0,
        garbage: 0.0,
        wrong_baud: 0.0,
        stall: 0.0,
        stall_us: 600_000,
    };

    fn set(&mut self, name: &str, value: &str) -> Result<(), LinkFaultError> {
        let place = match name {
            "loss" => &mut self.loss,
            "flip" => &mut self.flip,
            "burst" => &mut self.burst,
            "cut" => &mut self.cut,
            "duplicate" => &mut self.duplicate,
            "reorder" => &mut self.reorder,
            "garbage" => &mut self.garbage,
            "wrong-baud" => &mut self.wrong_baud,
            "stall" => return self.set_stall(value),
            _ => return Err(LinkFaultError::Unknown { word: name.to_owned() }),
        };
        *place =
            share(value).ok_or_else(|| LinkFaultError::Share { name: name.to_owned(), value: value.to_owned() })?;
        Ok(())
    }

    fn set_stall(&mut self, value: &str) -> Result<(), LinkFaultError> {
        let parsed = match value.split_once(':') {
            Some((often, length)) => share(often).zip(length_us(length)),
            None => share(value).map(|often| (often, Self::NONE.stall_us)),
        };
        (self.stall, self.stall_us) = parsed.ok_or_else(|| LinkFaultError::Stall { value: value.to_owned() })?;
        Ok(())
    }
}

impl FromStr for LinkFaults {
    type Err = LinkFaultError;

    /// `loss=0.05,flip=0.01,stall=0.001:600ms`: shares of the frames; those not named are 0.
    fn from_str(words: &str) -> Result<Self, LinkFaultError> {
        let mut faults = Self::NONE;
        for word in words.split(',') {
            let (name, value) = word.split_once('=').unwrap_or((word, ""));
            faults.set(name.trim(), value.trim())?;
        }
        Ok(faults)
    }
}

fn share(value: &str) -> Option<f64> {
    value.parse().ok().filter(|share| (0.0..=1.0).contains(share))
}

fn length_us(value: &str) -> Option<u64> {
    let (number, unit_us) = match value.strip_suffix("ms") {
        Some(number) => (number, 1e3),
        None => (value.strip_suffix('s')?, 1e6),
    };
    let length_us = number.trim().parse::<f64>().ok()? * unit_us;
    (0.0..=6e7).contains(&length_us).then_some(length_us as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_shares_and_a_length() {
        let faults: LinkFaults = "loss=0.05, flip=0.01,stall=0.001:1.5s".parse().unwrap();
        let expected = LinkFaults { loss: 0.05, flip: 0.01, stall: 0.001, stall_us: 1_500_000, ..LinkFaults::NONE };
        assert_eq!(faults, expected);
        assert_eq!("stall=1".parse::<LinkFaults>().unwrap().stall_us, 600_000);
    }

    #[test]
    fn wrong_words_are_named_with_what_is_allowed() {
        for (words, told) in [
            ("los=0.1", "\"los\" is no link fault"),
            ("", "\"\" is no link fault"),
            ("loss", "loss = \"\" is not allowed: a share of the frames, 0 to 1"),
            ("flip=1.5", "flip = \"1.5\""),
            ("flip=NaN", "flip = \"NaN\""),
            ("stall=0.1:600", "stall = \"0.1:600\" is not allowed"),
            ("stall=0.1:61s", "up to 60 s"),
        ] {
            let error = words.parse::<LinkFaults>().unwrap_err().to_string();
            assert!(error.contains(told), "{words}: {error}");
        }
    }
}
