//! Tests of the rig, one module a subject.

mod body;
mod calibrate;
mod feedback;
mod jog;
mod learning;
mod link_commissioning;
mod link_common;
mod link_direct;
mod link_disturbance;
mod link_faults;
mod link_line;
mod link_log;
mod link_power_cut;
mod link_session;
mod link_stream;
mod log_viewers;
mod port;
mod record_log;
mod replay;
mod report_browser;
mod report_motion;
mod report_moving;
mod report_still;
mod report_summary;
#[path = "../../../tests/support/samples.rs"]
mod samples;
mod scene_runs;
mod segments;
mod sound_plants;
mod synthetic_run;
mod table_scenes;
mod weight;
mod wound_once;
mod wound_twice;
