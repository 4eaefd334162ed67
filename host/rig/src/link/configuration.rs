//! A configuration on its way to the device.

use softlimb_firmware::{ActiveConfig, StagedConfig, StagingError};
use softlimb_protocol::{
    ConfigBegin, ConfigChannel, ConfigCommit, ConfigHash, ConfigInverse, ConfigSystem, ConfigVolume, HostMessage,
    MAX_CHANNELS,
};

use super::error::LinkError;

/// Everything a device has to know before it can run.
///
/// Sessions, and the numbers of the channels, are filled in on upload, whatever they are here; a table names its channel.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceConfiguration {
    /// Common part of all channels.
    pub system: ConfigSystem,
    /// The channels in order; 1 to 27.
    pub channels: Vec<ConfigChannel>,
    /// Tables of volumes; channels without one have their model solved.
    pub volumes: Vec<ConfigVolume>,
    /// Tables of pressures; only beside one of the volume.
    pub inverses: Vec<ConfigInverse>,
}

impl DeviceConfiguration {
    /// The messages of an upload, in order, and the hash that names it.
    ///
    /// # Errors
    /// [`LinkError::ChannelCount`] for no channel or more than the wire carries.
    pub(super) fn upload(&self, session: u16) -> Result<(Vec<HostMessage>, u32), LinkError> {
        let count = self.channels.len();
        if !(1..=MAX_CHANNELS).contains(&count) {
            return Err(LinkError::ChannelCount { count, max: MAX_CHANNELS });
        }
        // At most 27 channels.
        let begin = ConfigBegin { session, channels: count as u8 };
        let mut hash = ConfigHash::begin(&begin);
        let system = ConfigSystem { session, ..self.system.clone() };
        hash.add_system(&system);
        let mut messages = vec![begin.into(), system.into()];
        for (number, channel) in (0..).zip(&self.channels) {
            let channel = ConfigChannel { session, channel: number, ..channel.clone() };
            hash.add_channel(&channel);
            messages.push(channel.into());
            for volume in self.volumes.iter().filter(|table| table.channel == number) {
                let volume = ConfigVolume { session, ..volume.clone() };
                hash.add_volume(&volume);
                messages.push(volume.into());
            }
            for inverse in self.inverses.iter().filter(|table| table.channel == number) {
                let inverse = ConfigInverse { session, ..inverse.clone() };
                hash.add_inverse(&inverse);
                messages.push(inverse.into());
            }
        }
        messages.push(ConfigCommit { session, config_hash: hash.value() }.into());
        Ok((messages, hash.value()))
    }
    /// The configuration as the device has it after the upload.
    ///
    /// # Errors
    /// [`StagingError`] that the device would answer.
    pub(super) fn active(&self) -> Result<ActiveConfig, StagingError> {
        let (messages, hash) = self.upload(0).map_err(|_| StagingError::Mismatch)?;
        let (mut staged, mut active) = (StagedConfig::new(), None);
        for message in &messages {
            match message {
                HostMessage::ConfigBegin(begin) => staged.begin(begin)?,
                HostMessage::ConfigSystem(system) => staged.add_system(system)?,
                HostMessage::ConfigChannel(channel) => staged.add_channel(channel)?,
                HostMessage::ConfigVolume(volume) => staged.add_volume(volume)?,
                HostMessage::ConfigInverse(inverse) => staged.add_inverse(inverse)?,
                _ => {}
            }
        }
        staged.commit(hash, &mut active)?;
        active.ok_or(StagingError::Mismatch)
    }
}
