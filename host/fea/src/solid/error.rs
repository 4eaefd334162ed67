//! Why a deck was not written or a run gave nothing, in words for whoever asked.

use std::io;
use std::path::PathBuf;

use fra_model::InvalidParameter;

use softlimb_files::FileError;
use softlimb_files::range::OutOfRange;

/// Error of a deck or its run. A point that did not converge is no error: it has a status of its own.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FemError {
    /// An option or a value derived from it is out of range; fields are those of [`Options`](super::Options), [`Subject`](super::Subject) or
    /// [`Runner`](super::Runner); `layer_mm` and `spacing_mm` are their lengths in mm.
    #[error(transparent)]
    Invalid(#[from] OutOfRange),
    /// Threads are asked for, and the winding fills a layer or the wall.
    #[error("fibers as threads want a winding that is placed as a sheet")]
    NoSheet,
    /// The mesh would have more nodes than the options allow.
    #[error(
        "the mesh would have about {nodes} nodes, and nodes_max allows {allowed}: make it coarser with radial, around and along, or allow more"
    )]
    TooFine {
        /// An estimate, right to a tenth.
        nodes: usize,
        /// The most that are allowed.
        allowed: u32,
    },
    /// The actuator's parameters are refused by the model.
    #[error(transparent)]
    Parameters(#[from] InvalidParameter<f64>),
    /// The second winding is refused.
    #[error("second winding: {0}")]
    SecondWinding(InvalidParameter<f64>),
    /// A file or folder could not be used.
    #[error(transparent)]
    File(#[from] FileError),
    /// There is no such program.
    #[error(
        "CalculiX is not installed: there is no program `{}`. Debian, Ubuntu: apt-get install calculix-ccx. Elsewhere name it with \
         --ccx PATH", program.display()
    )]
    Missing {
        /// The program asked for.
        program: PathBuf,
    },
    /// The program could not be started or waited for.
    #[error("cannot run {}: {source}", program.display())]
    Program {
        /// The program.
        program: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A signal ended the run. Nothing it wrote is used.
    #[error(
        "CalculiX was killed by signal {signal} at {reached} of the load{}: nothing of this run is used",
        if *signal == 9 { " (signal 9 is often the system running out of memory)" } else { "" }
    )]
    Killed {
        /// The signal.
        signal: i32,
        /// The share of the load it had reached, in words.
        reached: String,
    },
    /// The run ended in a way that is neither success nor divergence. Nothing it wrote is used.
    #[error("CalculiX failed with exit code {code}: {diagnosis}")]
    Failed {
        /// Its exit code.
        code: i32,
        /// Diagnosis from its output.
        diagnosis: String,
    },
    /// The disk was full when CalculiX had ended, and what it wrote is not whole.
    #[error(
        "the disk is full: nothing of this run is used. Free some space, or set TMPDIR to a folder on another disk"
    )]
    DiskFull,
    /// CalculiX ended as if all were well, and there is no output.
    #[error("CalculiX says that it is done, but wrote no .dat file, or an empty one: there is nothing to use")]
    NoOutput,
    /// A file of the run is not what CalculiX writes, or ends in the middle.
    #[error("{file}{}: {what}: nothing of this run is used", if *line == 0 { String::new() } else { format!(", line {line}") })]
    Garbage {
        /// Name of the file.
        file: &'static str,
        /// The line, from 1; 0 where no line is to blame.
        line: usize,
        /// Reason.
        what: String,
    },
}

impl FemError {
    /// The error, with a full disk named as its cause if it was full.
    pub(super) fn blaming(self, disk_is_full: bool) -> Self {
        match self {
            Self::Failed { .. } | Self::NoOutput | Self::Garbage { .. } if disk_is_full => Self::DiskFull,
            error => error,
        }
    }
}

#[test]
fn full_disk_explains_output_that_is_not_whole_and_nothing_else() {
    let torn = || FemError::Garbage { file: "the .dat file", line: 3, what: "it ends".to_owned() };
    let failed = || FemError::Failed { code: 201, diagnosis: "no reason is given".to_owned() };
    for error in [torn(), failed(), FemError::NoOutput] {
        assert!(error.blaming(true).to_string().starts_with("the disk is full"));
    }
    assert!(matches!(torn().blaming(false), FemError::Garbage { .. }));
    let killed = FemError::Killed { signal: 9, reached: "1 step".to_owned() };
    assert!(matches!(killed.blaming(true), FemError::Killed { .. }));
}
