//! A configuration upload in progress. Nothing of it is in force before the commit.

use heapless::Vec;
use softlimb_protocol::{
    ConfigBegin, ConfigChannel, ConfigHash, ConfigInverse, ConfigSystem, ConfigVolume, MAX_CHANNELS,
};

use super::{ActiveConfig, ChannelConfig, ConfigError, SystemConfig, number, within};

/// Why a part of an upload was refused. The upload so far is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StagingError {
    /// A field is not accepted.
    Field(ConfigError),
    /// No upload was begun.
    NotBegun,
    /// Parts are missing, came twice, do not fit together, or the hash differs.
    Mismatch,
    /// A channel has no tables, and its actuator is none whose model the device solves.
    TablesMissing {
        /// The channel, from 0.
        channel: u8,
    },
}

impl From<ConfigError> for StagingError {
    fn from(error: ConfigError) -> Self {
        Self::Field(error)
    }
}

impl core::fmt::Display for StagingError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Field(error) => error.fmt(f),
            Self::NotBegun => f.write_str("no configuration upload was begun"),
            Self::Mismatch => f.write_str("the upload is incomplete or differs from its hash"),
            Self::TablesMissing { channel } => {
                write!(f, "channel {channel} has no tables, and the device does not solve the model of its actuator")
            }
        }
    }
}

impl core::error::Error for StagingError {}

/// The parts that have arrived, each checked.
#[derive(Clone, Debug)]
pub struct StagedConfig<const N: usize = MAX_CHANNELS> {
    count: u8,
    hash: ConfigHash,
    system: Option<SystemConfig>,
    channels: Vec<ChannelConfig, N>,
}

impl<const N: usize> StagedConfig<N> {
    /// No upload was begun.
    pub const fn new() -> Self {
        Self { count: 0, hash: ConfigHash::NONE, system: None, channels: Vec::new() }
    }

    /// Begins an upload; forgets the one before.
    ///
    /// # Errors
    /// [`ConfigError`] unless the number of channels is `1..=N`; the upload so far is kept.
    pub fn begin(&mut self, wire: &ConfigBegin) -> Result<(), ConfigError> {
        let count = within(number!(ConfigBegin, "channels"), wire.channels, 1..=N as u8)?;
        self.forget();
        (self.count, self.hash) = (count, ConfigHash::begin(wire));
        Ok(())
    }

    /// Discards the upload.
    pub fn forget(&mut self) {
        (self.count, self.system) = (0, None);
        self.channels.clear();
    }

    /// Nothing can be added to an upload that was not begun.
    fn begun(&self) -> Result<(), StagingError> {
        if self.count > 0 { Ok(()) } else { Err(StagingError::NotBegun) }
    }

    /// Takes the system part, once.
    ///
    /// # Errors
    /// [`StagingError`]; nothing of the part is kept.
    pub fn add_system(&mut self, wire: &ConfigSystem) -> Result<(), StagingError> {
        self.begun()?;
        if self.system.is_some() {
            return Err(StagingError::Mismatch);
        }
        self.system = Some(SystemConfig::try_from(wire)?);
        self.hash.add_system(wire);
        Ok(())
    }

    /// Takes the next channel; channels come in order.
    ///
    /// # Errors
    /// [`StagingError`]; nothing of the part is kept.
    pub fn add_channel(&mut self, wire: &ConfigChannel) -> Result<(), StagingError> {
        self.begun()?;
        // At most 27 channels are kept.
        let next = self.channels.len() as u8;
        if next >= self.count {
            return Err(StagingError::Mismatch);
        }
        within(number!(ConfigChannel, "channel"), wire.channel, next..=next)?;
        let channel = ChannelConfig::try_from(wire)?;
        self.channels.push(channel).map_err(|_| StagingError::Mismatch)?;
        self.hash.add_channel(wire);
        Ok(())
    }

    /// Takes the volume table of the last channel, once.
    ///
    /// # Errors
    /// [`StagingError`]; nothing of the part is kept.
    pub fn add_volume(&mut self, wire: &ConfigVolume) -> Result<(), StagingError> {
        self.last_channel(wire.channel)?.set_volume(wire)?;
        self.hash.add_volume(wire);
        Ok(())
    }

    /// Takes the inverse table of the last channel, once, behind its volume table.
    ///
    /// # Errors
    /// [`StagingError`]; nothing of the part is kept.
    pub fn add_inverse(&mut self, wire: &ConfigInverse) -> Result<(), StagingError> {
        self.last_channel(wire.channel)?.set_inverse(wire)?;
        self.hash.add_inverse(wire);
        Ok(())
    }

    /// The channel that came last, if that is the one a table names.
    fn last_channel(&mut self, number: u8) -> Result<&mut ChannelConfig, StagingError> {
        self.begun()?;
        // At most 27 channels are kept.
        let last = (self.channels.len() as u8).checked_sub(1).ok_or(StagingError::Mismatch)?;
        within(number!(ConfigVolume, "channel"), number, last..=last)?;
        self.channels.last_mut().ok_or(StagingError::Mismatch)
    }

    /// Puts the upload in the place of `active`, as a whole, if it is complete, has the host's hash, and its parts fit together.
    /// The channels change places instead of being copied: they are too large for a small stack.
    ///
    /// # Errors
    /// [`StagingError`]; `active` and the upload are as before.
    pub fn commit(&mut self, config_hash: u32, active: &mut Option<ActiveConfig<N>>) -> Result<(), StagingError> {
        self.begun()?;
        let system = self.system.ok_or(StagingError::Mismatch)?;
        let complete = self.channels.len() == usize::from(self.count);
        let measurable = self.channels.iter().all(|channel| channel.pressure_max_pa <= system.sensor_max_pa);
        let tabulated = self.channels.iter().all(ChannelConfig::has_all_tables_or_none);
        if !complete || !measurable || !tabulated || self.hash.value() != config_hash {
            return Err(StagingError::Mismatch);
        }
        if let Some(channel) = self.channels.iter().position(ChannelConfig::lacks_tables) {
            return Err(StagingError::TablesMissing { channel: channel as u8 });
        }
        let active = active.get_or_insert_with(|| ActiveConfig { system, channels: Vec::new(), hash: config_hash });
        active.system = system;
        active.hash = config_hash;
        core::mem::swap(&mut active.channels, &mut self.channels);
        Ok(())
    }
}

impl<const N: usize> Default for StagedConfig<N> {
    fn default() -> Self {
        Self::new()
    }
}
