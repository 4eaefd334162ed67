//! Why a run failed.

use softlimb_sim::{EmulatorError, SimError};

use super::RunFiles;
use crate::link::port::PortError;
use crate::link::{LinkError, SamplingError};
use crate::record::RecordError;
use softlimb_files::FileError;
use softlimb_scene::SceneError;

/// Why there is no run, or no whole one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scene asks for something the limb cannot do.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene corrects its runs by a camera, and the limb is not simulated.
    #[error(
        "`feedback = true` in `[camera]` needs a camera, and none is connected to a device behind a port: set `feedback = false`"
    )]
    NoCamera,
    /// The scene corrects its runs by IMUs, and the limb is not simulated.
    #[error(
        "`feedback = true` in `[imu]` needs IMUs, and none are connected to a device behind a port: set `feedback = false`"
    )]
    NoImus,
    /// The simulated device cannot be built.
    #[error("the simulated device cannot be built: {0}")]
    Simulation(#[from] SimError),
    /// The emulated processor does not run, or not any more.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The port cannot be opened.
    #[error(transparent)]
    Port(#[from] PortError),
    /// A device without measurements takes no request for samples.
    #[error(
        "the device sends no measurements, and so no samples: it has no configuration; `softlimb device sensors --scene SCENE --port ADDRESS` \
         gives it one"
    )]
    NoMeasurements,
    /// The samples are too many.
    #[error(transparent)]
    Sampling(#[from] SamplingError),
    /// The run did not begin.
    #[error("{0}")]
    Link(Box<LinkError>),
    /// The run began and did not end well; what happened until then is recorded.
    #[error("{cause}\nthe run up to there is in {} and {}", files.log.display(), files.report.display())]
    Stopped {
        /// Cause.
        cause: Box<LinkError>,
        /// Log, report, and what is in them.
        files: Box<RunFiles>,
    },
    /// The simulated limb does not take the setpoints of the plan.
    #[error("the scene of the simulated limb has other modules: {simulated}, where the plan has {planned}")]
    OtherLimb {
        /// Names of what has a setpoint in the plan.
        planned: String,
        /// The same in the scene of the simulated limb.
        simulated: String,
    },
    /// A fault on purpose that this run cannot have.
    #[error("{name}: {reason}")]
    Fault {
        /// Name of the fault.
        name: String,
        /// Reason.
        reason: String,
    },
    /// There is no tip to be seen: the limb fell, or the run ended before.
    #[error("{time_s:.2} s into the run the tip is not visible: the limb fell under its load, or the run ended before")]
    NotSeen {
        /// When, s after the start.
        time_s: f64,
    },
    /// The link ended well without anything to record.
    #[error("the device sent no measurements")]
    NotRecorded,
    /// The log cannot be written or read back.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The log could not be written to its end. The run went on without it.
    #[error("{cause}\n{}", without_log(*last_s, ended.as_deref()))]
    LogLost {
        /// Error of the log.
        cause: RecordError,
        /// Time of the last sample in it, s after the start of the run.
        last_s: Option<f64>,
        /// Error of the run itself, if there was one.
        ended: Option<Box<LinkError>>,
    },
    /// The folder of the results cannot be made, or the report cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}

fn without_log(last_s: Option<f64>, ended: Option<&LinkError>) -> String {
    let log = last_s.map_or_else(
        || "the log has no sample".to_owned(),
        |last_s| {
            format!("the log ends {last_s:.2} s into the run at the latest; `softlimb recover` saves what is there")
        },
    );
    match ended {
        None => format!("{log}\nthe limb was not disturbed: the run went on to its end without a log"),
        Some(error) => format!("{log}\n{error}"),
    }
}
